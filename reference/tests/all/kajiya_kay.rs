use pelage_reference::glam::{DQuat, DVec3};
use pelage_reference::kajiya_kay::{KajiyaKay, scatter};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Products of unit vectors, to a power of up to 500: measured 2e-14.
const ROUNDING: f64 = 1e-12;

const DIFFUSE: KajiyaKay = KajiyaKay {
    diffuse: 1.0,
    specular: 0.0,
    exponent: 20.0,
};
const SPECULAR: KajiyaKay = KajiyaKay {
    diffuse: 0.0,
    specular: 1.0,
    exponent: 20.0,
};

fn direction() -> impl Strategy<Value = DVec3> {
    let at = |(angle, z): (f64, f64)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    };
    prop_oneof![
        (0.0..TAU, -1.0..1.0f64).prop_map(at),
        Just(DVec3::X),
        Just(-DVec3::X),
        Just(DVec3::Y)
    ]
}

proptest! {
    #[test]
    fn light_and_eye_may_change_places_in_the_specular_lobe(
        t in direction(), l in direction(), e in direction(), exponent in 0.0..500.0f64,
    ) {
        let model = KajiyaKay { exponent, ..SPECULAR };
        prop_assert!((scatter(t, l, e, &model) - scatter(t, e, l, &model)).abs() < ROUNDING);
    }

    #[test]
    fn values_lie_between_nothing_and_the_sum_of_the_coefficients(
        t in direction(), l in direction(), e in direction(),
        diffuse in 0.0..2.0f64, specular in 0.0..2.0f64, exponent in 0.0..500.0f64,
    ) {
        let value = scatter(t, l, e, &KajiyaKay { diffuse, specular, exponent });
        prop_assert!(value >= 0.0 && value <= diffuse + specular + ROUNDING, "{value}");
    }

    #[test]
    fn lengths_signs_of_the_tangent_and_turns_around_the_fibre_do_not_matter(
        t in direction(), l in direction(), e in direction(), turn in 0.0..TAU, scale in 1e-3..1e3f64,
    ) {
        let model = KajiyaKay { diffuse: 0.4, ..SPECULAR };
        let value = scatter(t, l, e, &model);
        let around = DQuat::from_axis_angle(t, turn) * e;
        for other in [
            scatter(-t, l, e, &model), scatter(t * scale, l * scale, e, &model), scatter(t, l, around, &model),
        ] {
            prop_assert!((value - other).abs() < ROUNDING, "{value} {other}");
        }
    }
}

#[test]
fn the_highlight_lies_on_the_mirror_cone() {
    for step in 1..60 {
        let angle = PI * step as f64 / 60.0;
        let l = DVec3::new(angle.cos(), angle.sin(), 0.0);
        // Mirrored in the normal plane, the component along the fibre turns round.
        let mirrored = DVec3::new(-angle.cos(), 0.6 * angle.sin(), 0.8 * angle.sin());
        assert!((scatter(DVec3::X, l, mirrored, &SPECULAR) - 1.0).abs() < ROUNDING);
        let behind = DVec3::new(angle.cos(), angle.sin(), 0.0);
        assert!(scatter(DVec3::X, l, behind, &SPECULAR) <= 1.0);
    }
}

#[test]
fn everything_stays_finite_where_light_or_eye_run_along_the_fibre() {
    for tilt in [0.0, 1e-300, 1e-160, 1e-17, 1e-9, 1e-4] {
        for l in [DVec3::new(1.0, tilt, 0.0), DVec3::new(-1.0, 0.0, tilt)] {
            for e in [DVec3::X, -DVec3::X, DVec3::Y, DVec3::new(1.0, -tilt, tilt)] {
                let model = KajiyaKay {
                    diffuse: 1.0,
                    ..SPECULAR
                };
                assert!(scatter(DVec3::X, l, e, &model).is_finite());
                let diffuse = scatter(DVec3::X, l, e, &DIFFUSE);
                // sin(atan x) = x - x³/2 + …; a length's squares vanish below 1e-154.
                let expected = tilt / (1.0 + tilt * tilt).sqrt();
                assert!(
                    (diffuse - expected).abs() <= 1e-12 * tilt + 1e-154,
                    "{diffuse} {tilt}"
                );
            }
        }
    }
}

#[test]
fn the_diffuse_lobe_sends_on_four_pi_times_its_coefficient() {
    // ∫ over all eyes, light at right angles: midpoints in cos θ.
    let steps = 2000;
    let sum: f64 = (0..steps)
        .map(|i| {
            let z = -1.0 + (i as f64 + 0.5) * 2.0 / steps as f64;
            let e = DVec3::new(z, (1.0 - z * z).sqrt(), 0.0);
            scatter(DVec3::X, DVec3::Y, e, &DIFFUSE) * TAU * 2.0 / steps as f64
        })
        .sum();
    assert!((sum - 4.0 * PI).abs() < 1e-9, "{sum}");
}
