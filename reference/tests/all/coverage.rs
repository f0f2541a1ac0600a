use pelage_reference::coverage::{Band, HalfPlane, Ribbon, band_coverage, supersampled_coverage};
use pelage_reference::glam::DVec2;
use proptest::prelude::*;

const SAMPLES_PER_SIDE: usize = 64;

/// An edge crosses at most 2·64 cells, two edges and two ends 4·128: five standard errors of ½·√512 / 64².
const SAMPLING_TOLERANCE: f64 = 5.0 * 0.5 * 22.63 / (64.0 * 64.0);

/// Corners and areas of a unit square in f64: measured 1e-16.
const ROUNDING: f64 = 1e-15;

#[test]
fn a_band_through_the_centre_covers_its_width() {
    for half_width in [1e-6, 0.005, 0.1, 0.25, 0.5] {
        let band = Band {
            point: DVec2::new(3.5, -70.0),
            direction: DVec2::Y,
            half_width,
        };
        let area = band_coverage(DVec2::new(3.5, 8.5), &band, &[]);
        assert!(
            (area - 2.0 * half_width).abs() <= ROUNDING,
            "{half_width}: {area}"
        );
    }
}

#[test]
fn a_band_along_the_diagonal_leaves_two_corners() {
    let direction = DVec2::new(1.0, 1.0).normalize();
    let half_width = 0.3;
    let band = Band {
        point: DVec2::ZERO,
        direction,
        half_width,
    };
    let corner_height = std::f64::consts::FRAC_1_SQRT_2 - half_width;
    let area = band_coverage(DVec2::new(0.0, 0.0), &band, &[]);
    assert!(
        (area - (1.0 - 2.0 * corner_height * corner_height)).abs() <= ROUNDING,
        "{area}"
    );
}

#[test]
fn a_band_of_no_width_and_one_out_of_reach_cover_nothing_and_a_wide_one_all() {
    let band = |x: f64, half_width| Band {
        point: DVec2::new(x, 0.0),
        direction: DVec2::Y,
        half_width,
    };
    assert_eq!(band_coverage(DVec2::ZERO, &band(0.2, 0.0), &[]), 0.0);
    assert_eq!(band_coverage(DVec2::ZERO, &band(2.0, 1.4), &[]), 0.0);
    assert_eq!(band_coverage(DVec2::ZERO, &band(2.0, 3.0), &[]), 1.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn exact_area_agrees_with_supersampling(
        angle in 0.0..std::f64::consts::TAU,
        x in -1.5..1.5f64, y in -1.5..1.5f64,
        half_width in 0.005..1.5f64,
        back in 0.0..3.0f64, front in 0.0..3.0f64,
    ) {
        let direction = DVec2::from_angle(angle);
        let axis = DVec2::new(x, y);
        let points = [axis - direction * back, axis + direction * (front * 0.3), axis + direction * front];
        let ends = [
            HalfPlane { point: points[0], normal: direction },
            HalfPlane { point: points[2], normal: -direction },
        ];
        let exact = band_coverage(DVec2::ZERO, &Band { point: axis, direction, half_width }, &ends);
        let ribbon = Ribbon { points: &points, half_widths: &[half_width; 3] };
        let sampled = supersampled_coverage(&ribbon, DVec2::ZERO, SAMPLES_PER_SIDE);
        prop_assert!((exact - sampled).abs() <= SAMPLING_TOLERANCE, "{exact} {sampled}");
    }

    #[test]
    fn coverage_grows_with_width_and_lies_between_nothing_and_all(
        angle in 0.0..std::f64::consts::TAU, x in -2.0..2.0f64, half_width in 0.0..2.0f64, more in 0.0..1.0f64,
    ) {
        let band = |half_width| Band { point: DVec2::new(x, 0.3), direction: DVec2::from_angle(angle), half_width };
        let thin = band_coverage(DVec2::ZERO, &band(half_width), &[]);
        let wide = band_coverage(DVec2::ZERO, &band(half_width + more), &[]);
        prop_assert!((0.0..=1.0).contains(&thin) && (0.0..=1.0).contains(&wide));
        prop_assert!(thin <= wide + ROUNDING, "{thin} {wide}");
    }
}
