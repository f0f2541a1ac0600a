//! Few guides to many strands.

use super::{strands_of, three_guides};
use pelage::groom::{
    ClumpSettings, Curve, Guides, InterpolationSettings, MAX_INTERPOLATED_STRANDS, Strands, Stray,
    interpolate_clumps, interpolate_on_mesh,
};
use proptest::prelude::*;

fn one_triangle() -> Guides {
    Guides::on_mesh(three_guides(), vec![[0, 1, 2]]).unwrap()
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).powi(2))
        .sum::<f32>()
        .sqrt()
}

/// The barycentrics of `p` in a triangle, by its x and z.
fn barycentrics(p: [f32; 3], [a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let cross = |p: [f32; 3], q: [f32; 3], r: [f32; 3]| {
        (q[0] - p[0]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[0] - p[0])
    };
    let area = cross(a, b, c);
    [
        cross(p, b, c) / area,
        cross(a, p, c) / area,
        cross(a, b, p) / area,
    ]
}

proptest! {
    #[test]
    fn without_strays_strands_stay_between_their_guides(clump in 0.0f32..=1.0, seed: u32) {
        let settings = InterpolationSettings { density: 100.0, clump, seed, ..Default::default() };
        let guides = one_triangle();
        let strands = interpolate_on_mesh(&guides, &settings).unwrap();
        for points in strands_of(&strands) {
            for (i, p) in points.iter().enumerate() {
                let corners = [0, 1, 2].map(|guide| guides.strands().points()[3 * guide + i]);
                let weights = barycentrics(*p, corners);
                // Rounding of the test's own cross products.
                prop_assert!(weights.iter().all(|w| *w > -1e-5), "{:?}", weights);
                // Weights that sum to 1 keep what is common to all guides: y, and the radius.
                prop_assert!((p[1] - i as f32).abs() < 1e-5);
            }
        }
        prop_assert!(strands.radii().iter().all(|r| (r - 0.01).abs() < 1e-7));
    }

    #[test]
    fn fully_clumped_tips_lie_on_the_nearest_guide(seed: u32) {
        let settings = InterpolationSettings { density: 100.0, clump: 1.0, seed, ..Default::default() };
        let guides = one_triangle();
        let strands = interpolate_on_mesh(&guides, &settings).unwrap();
        let [roots, tips] = [0, 2].map(|i| [0, 1, 2].map(|guide| guides.strands().points()[3 * guide + i]));
        for points in strands_of(&strands) {
            let weights = barycentrics(points[0], roots);
            let nearest = (0..3).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap();
            prop_assert!(distance(points[2], tips[nearest]) < 1e-5);
        }
    }

    #[test]
    fn the_number_of_strands_is_area_times_density(density in 0.0f32..5000.0, seed: u32) {
        let settings = InterpolationSettings { density, seed, ..Default::default() };
        let count = interpolate_on_mesh(&one_triangle(), &settings).unwrap().strand_count();
        prop_assert!((count as f32 - 0.5 * density).abs() <= 1.0);
    }

    #[test]
    fn the_same_seed_gives_the_same_strands(seed: u32) {
        let stray = Stray { fraction: 0.5, strength: 0.2 };
        let settings = InterpolationSettings { density: 50.0, stray, seed, ..Default::default() };
        let again = InterpolationSettings { seed: seed.wrapping_add(1), ..settings };
        let strands = interpolate_on_mesh(&one_triangle(), &settings).unwrap();
        prop_assert_eq!(&strands, &interpolate_on_mesh(&one_triangle(), &settings).unwrap());
        prop_assert_ne!(&strands, &interpolate_on_mesh(&one_triangle(), &again).unwrap());
    }

    #[test]
    fn followers_stay_within_their_disc(root_radius in 0.0f32..0.3, tip_factor in 0.0f32..2.0, seed: u32) {
        let settings = ClumpSettings { followers: 5, root_radius, tip_factor, seed, ..Default::default() };
        let guides = three_guides();
        let strands = interpolate_clumps(&guides, &settings).unwrap();
        prop_assert_eq!(strands.strand_count(), 18);
        for (strand, points) in strands_of(&strands).enumerate() {
            for (i, p) in points.iter().enumerate() {
                let at = 3 * (strand / 6) + i;
                let reach = root_radius * (1.0 + (tip_factor - 1.0) * guides.coordinates()[at]);
                prop_assert!(distance(*p, guides.points()[at]) <= reach + 1e-5);
            }
        }
    }
}

#[test]
fn fractions_of_strands_add_up_over_many_triangles() {
    const TRIANGLES: usize = 4000;
    let guides = Guides::on_mesh(three_guides(), vec![[0, 1, 2]; TRIANGLES]).unwrap();
    let settings = InterpolationSettings {
        density: 0.6,
        ..Default::default()
    };
    let count = interpolate_on_mesh(&guides, &settings)
        .unwrap()
        .strand_count() as f64;
    let (expected, deviation) = (
        0.3 * TRIANGLES as f64,
        (0.3 * 0.7 * TRIANGLES as f64).sqrt(),
    );
    // Four standard deviations of independent chances.
    assert!(
        (count - expected).abs() < 4.0 * deviation,
        "{count} strands for {expected}"
    );
}

#[test]
fn roots_are_uniform_over_the_triangle() {
    let settings = InterpolationSettings {
        density: 40_000.0,
        ..Default::default()
    };
    let strands = interpolate_on_mesh(&one_triangle(), &settings).unwrap();
    let count = strands.strand_count() as f64;
    let mean = |axis: usize| {
        strands_of(&strands)
            .map(|s| f64::from(s[0][axis]))
            .sum::<f64>()
            / count
    };
    // The centroid is (1/3, 1/3); 20,000 roots have a mean within 4 × 0.236/√20000.
    for axis in [0, 2] {
        assert!((mean(axis) - 1.0 / 3.0).abs() < 0.0067, "{}", mean(axis));
    }
}

#[test]
fn only_strays_leave_and_as_far_as_stated() {
    let calm = InterpolationSettings {
        density: 2000.0,
        ..Default::default()
    };
    let stray = Stray {
        fraction: 0.25,
        strength: 0.5,
    };
    let [calm, wild] = [calm, InterpolationSettings { stray, ..calm }]
        .map(|settings| interpolate_on_mesh(&one_triangle(), &settings).unwrap());
    let mut strays = 0;
    for (a, b) in strands_of(&calm).zip(strands_of(&wild)) {
        let length = distance(a[0], a[1]) + distance(a[1], a[2]);
        assert_eq!(a[0], b[0]);
        assert!(distance(a[2], b[2]) <= 0.5 * length + 1e-5);
        strays += usize::from(a != b);
    }
    // A quarter of 1000, within four standard deviations.
    assert!((196..=304).contains(&strays), "{strays}");
}

#[test]
fn guides_of_differing_point_counts_are_brought_to_the_longest() {
    let points = vec![
        [0.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.5, 0.0],
        [1.0, 2.0, 0.0],
        [0.0, 1.0, 1.0],
    ];
    let guides = Strands::new(points, &[2, 3, 1], 0.1)
        .unwrap()
        .with_curve(Curve::CatmullRom);
    let guides = Guides::on_mesh(guides, vec![[0, 1, 2]]).unwrap();
    let strands = interpolate_on_mesh(
        &guides,
        &InterpolationSettings {
            density: 20.0,
            ..Default::default()
        },
    )
    .unwrap();
    assert!(strands.strand_count() > 0 && strands_of(&strands).all(|s| s.len() == 3));
    assert_eq!(strands.curve(), Curve::CatmullRom);
}

#[test]
fn bad_settings_are_named() {
    let settings = InterpolationSettings {
        density: 1.0,
        ..Default::default()
    };
    let stray = |fraction, strength| Stray { fraction, strength };
    let bad = [
        (
            InterpolationSettings {
                density: f32::NAN,
                ..settings
            },
            "density NaN",
        ),
        (
            InterpolationSettings {
                density: -1.0,
                ..settings
            },
            "density -1",
        ),
        (
            InterpolationSettings {
                density: 1e12,
                ..settings
            },
            "density 1000000000000 makes",
        ),
        (
            InterpolationSettings {
                clump: 1.5,
                ..settings
            },
            "clump 1.5",
        ),
        (
            InterpolationSettings {
                stray: stray(-0.1, 0.0),
                ..settings
            },
            "stray.fraction -0.1",
        ),
        (
            InterpolationSettings {
                stray: stray(0.1, f32::INFINITY),
                ..settings
            },
            "stray.strength inf",
        ),
    ];
    for (settings, named) in bad {
        let error = interpolate_on_mesh(&one_triangle(), &settings)
            .unwrap_err()
            .to_string();
        assert!(error.contains(named), "{error}");
    }
    let clumps = ClumpSettings::default();
    let bad = [
        (
            ClumpSettings {
                followers: MAX_INTERPOLATED_STRANDS as u32,
                ..clumps
            },
            "followers 16777216",
        ),
        (
            ClumpSettings {
                root_radius: -1.0,
                ..clumps
            },
            "root_radius -1",
        ),
        (
            ClumpSettings {
                tip_factor: f32::NAN,
                ..clumps
            },
            "tip_factor NaN",
        ),
    ];
    for (settings, named) in bad {
        let error = interpolate_clumps(&three_guides(), &settings)
            .unwrap_err()
            .to_string();
        assert!(error.contains(named), "{error}");
    }
    let error = interpolate_on_mesh(&Guides::new(three_guides()), &settings)
        .unwrap_err()
        .to_string();
    assert!(error.contains("no mesh"), "{error}");
    let error = Guides::on_mesh(three_guides(), vec![[0, 1, 2], [0, 3, 1]])
        .unwrap_err()
        .to_string();
    assert!(error.contains("triangle 1: guide 3"), "{error}");
}

#[test]
fn no_guides_make_no_strands() {
    let none = interpolate_on_mesh(&Guides::default(), &InterpolationSettings::default()).unwrap();
    assert_eq!(none.strand_count(), 0);
    assert_eq!(
        interpolate_clumps(&Strands::default(), &ClumpSettings::default())
            .unwrap()
            .strand_count(),
        0
    );
}
