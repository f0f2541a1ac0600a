use pelage_reference::fibre::{Direction, FibreModel, TRT, TT};
use pelage_reference::furnace::{albedo, furnace};
use pelage_reference::glam::DVec3;
use pelage_reference::sadeghi::{LobeControls, Params, Sadeghi, glint_angle};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

/// Azimuths of furnaces. A glint whose centre lies its width from φ = 0 or π has a corner there, which midpoints meet with an
/// error in the square of their distance: of the narrowest glint drawn, 1.5e-4 by 512, 3.8e-5 by 1024, 9.5e-6 by these.
const AZIMUTHS: usize = 2048;

/// Two quadratures of the same integral: see [`AZIMUTHS`].
const FURNACE: f64 = 2e-5;

fn any_lobe() -> impl Strategy<Value = LobeControls> {
    (
        [0.0..2.0f64, 0.0..2.0, 0.0..2.0],
        0.0..5.0f64,
        -0.3..0.3f64,
        prop_oneof![1e-3..1.0f64, Just(1e-3), Just(1.0)],
    )
        .prop_map(|(colour, intensity, shift, width)| LobeControls {
            colour: DVec3::from_array(colour),
            intensity,
            shift,
            width,
        })
}

fn any_params() -> impl Strategy<Value = Params> {
    (
        [any_lobe(), any_lobe(), any_lobe()],
        [0.05..3.0f64, 0.05..3.0],
        0.0..5.0f64,
        0.0..PI,
    )
        .prop_map(
            |([r, tt, trt], widths, glint_intensity, glint_angle)| Params {
                r,
                tt,
                trt,
                tt_azimuthal_width: widths[0],
                glint_intensity,
                glint_width: widths[1],
                glint_angle,
            },
        )
}

#[test]
fn lobes_lie_where_their_controls_say() {
    let sadeghi = Sadeghi::new(Params::default()).unwrap();
    let shift = Params::default().trt.shift;
    assert_eq!(sadeghi.m_p(TRT, 0.3, 2.0 * shift - 0.3), 1.0);
    assert_eq!(sadeghi.n_p(TT, PI), 1.0);
    assert!(sadeghi.n_p(TT, -3.0) == sadeghi.n_p(TT, 3.0) && sadeghi.n_p(TT, 0.0) < 1e-10);
    let glint = Params::default().glint_angle;
    for phi in [glint, -glint] {
        assert!((sadeghi.n_p(TRT, phi) - (0.5 * glint).cos() - 0.5).abs() < 1e-15);
    }
}

#[test]
fn glints_of_strands_differ_within_their_range_and_stay() {
    let angles: Vec<f64> = (0..1000).map(|strand| glint_angle(strand, 7)).collect();
    assert!(angles.iter().all(|a| (FRAC_PI_6..FRAC_PI_4).contains(a)));
    let mean = angles.iter().sum::<f64>() / 1000.0;
    // Five standard errors of an even distribution 15 degrees wide.
    assert!((mean.to_degrees() - 37.5).abs() < 5.0 * 15.0 / 12f64.sqrt() / 1000f64.sqrt());
    assert_eq!(glint_angle(3, 7), angles[3]);
}

#[test]
fn the_albedo_is_the_integral_over_the_sphere() {
    let sadeghi = Sadeghi::new(Params::default()).unwrap();
    for theta in [-1.5, -0.6, 0.0, 1.0, 1.4, 1.57] {
        let integral = albedo(&sadeghi, Direction::new(theta, 0.3), AZIMUTHS);
        let own = sadeghi.albedo(theta);
        println!("theta {theta}: albedo {own:.5}");
        assert!(
            (integral - own).abs().max_element() < FURNACE,
            "{integral} {own}"
        );
    }
}

#[test]
fn furnaces_are_printed() {
    let sadeghi = Sadeghi::new(Params::default()).unwrap();
    let bright = Params {
        r: LobeControls {
            intensity: 3.0,
            ..Params::default().r
        },
        ..Params::default()
    };
    let bright = Sadeghi::new(bright).unwrap();
    for degrees in [0.0f64, 30.0, 60.0, 75.0, 85.0, 89.0] {
        let wo = Direction::new(degrees.to_radians(), 0.0);
        println!(
            "theta_o {degrees}: as published {:.4}, normalised {:.4}; bright {:.4}, normalised {:.4}",
            furnace(&sadeghi, wo, 256).x,
            furnace(&sadeghi.normalised(), wo, 256).x,
            furnace(&bright, wo, 256).x,
            furnace(&bright.normalised(), wo, 256).x,
        );
    }
}

#[test]
fn normalising_leaves_dim_hair_alone_and_keeps_reciprocity() {
    let mut params = Params::default();
    for lobe in [&mut params.r, &mut params.tt, &mut params.trt] {
        lobe.intensity *= 0.05;
    }
    let dim = Sadeghi::new(params).unwrap();
    let (a, b) = (Direction::new(0.4, 0.3), Direction::new(-0.5, 2.2));
    assert_eq!(dim.scatter(a, b), dim.normalised().scatter(a, b));
    params.r.intensity = 50.0;
    let bright = Sadeghi::new(params).unwrap().normalised();
    let forth = bright.scatter(a, b) / a.cos_theta();
    let back = bright.scatter(b, a) / b.cos_theta();
    assert!((forth - back).abs().max_element() < 1e-12 * forth.max_element());
}

#[test]
fn parameters_out_of_range_are_named() {
    let mut params = Params::default();
    params.tt.width = 0.0;
    assert_eq!(Sadeghi::new(params).unwrap_err().name, "width");
    params.tt.width = 0.1;
    params.glint_angle = -0.1;
    assert_eq!(Sadeghi::new(params).unwrap_err().name, "glint_angle");
}

#[test]
fn the_normalised_form_of_the_sharpest_glint_is_at_most_one_at_a_graze() {
    let mut params = Params::default();
    for lobe in [&mut params.r, &mut params.tt] {
        lobe.intensity = 0.0;
    }
    params.trt.intensity = 3.55;
    params.trt.width = 1.0;
    params.glint_intensity = 5.0;
    params.glint_width = 0.05;
    for angle in [0.5, 1.0, 2.0].map(|widths| widths * params.glint_width) {
        params.glint_angle = angle;
        let model = Sadeghi::new(params).unwrap().normalised();
        let seen = furnace(&model, Direction::new(1.56975, 0.0), AZIMUTHS).max_element();
        assert!(seen <= 1.0 + FURNACE, "{angle}: {seen}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_normalised_form_never_returns_more_than_it_gets(params in any_params(), theta in -1.57..1.57f64) {
        let model = Sadeghi::new(params).unwrap().normalised();
        let direction = Direction::new(theta, 0.0);
        let seen = furnace(&model, direction, AZIMUTHS);
        prop_assert!(seen.max_element() <= 1.0 + FURNACE, "{seen}");
        let sent = albedo(&model, direction, AZIMUTHS);
        prop_assert!(sent.max_element() <= 1.0 + FURNACE, "{sent}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn hard_cases_stay_finite_and_not_negative(
        params in any_params(),
        theta_i in crate::marschner::any_theta(), theta_o in crate::marschner::any_theta(),
        phi in crate::marschner::any_phi(),
    ) {
        let sadeghi = Sadeghi::new(params).unwrap();
        let (wi, wo) = (Direction::new(theta_i, phi), Direction::new(theta_o, 0.0));
        for value in [sadeghi.scatter(wi, wo), sadeghi.normalised().scatter(wi, wo)] {
            prop_assert!(value.is_finite() && value.min_element() >= 0.0, "{value}");
        }
        let albedo = sadeghi.albedo(theta_o.clamp(-FRAC_PI_2, FRAC_PI_2));
        prop_assert!(albedo.is_finite() && albedo.min_element() >= 0.0);
    }
}
