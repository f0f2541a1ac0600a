//! The WGSL of Scheuermann's model against the reference in f64.

use pelage::glam::{DVec3, Vec3};
use pelage::shading::{Highlight, Scheuermann, Shading};

use pelage_reference::scheuermann;

use super::harness::{Evaluator, case, frame, hard_cases};
use super::reference::of_scheuermann;
use crate::common::device;

fn with_exponent(exponent: f32) -> Scheuermann {
    let model = Scheuermann::default();
    Scheuermann {
        primary: Highlight {
            exponent,
            ..model.primary
        },
        secondary: Highlight {
            exponent,
            ..model.secondary
        },
        ..model
    }
}

/// An f32 cosine near 1 is exact to 1.2e-7, and so its m-th power to m times as much; of the peak.
fn tolerance(exponent: f32) -> f64 {
    1e-5 + 4e-7 * f64::from(exponent)
}

/// Views this near the tangent have a normal in f64 only: the eye's part across it is lost in an f32's rounding.
const ALONG: f64 = 1e-4;

#[test]
fn values_are_the_reference_at_every_angle_and_exponent() {
    let Some(mut device) = device() else { return };
    let evaluator = Evaluator::new(&mut device, &Shading::Scheuermann(Scheuermann::default()));
    for exponent in [1.0, 10.0, 120.0, 1e4, 1e5] {
        let model = with_exponent(exponent);
        let truth = of_scheuermann(&model);
        let shifts =
            [model.primary.shift, model.secondary.shift].map(|s| -2.0 * f64::from(s).atan());
        let cases = hard_cases(&shifts);
        let tangent = frame()[0].normalize();
        let mut worst = 0.0f64;
        let mut peak = 0.0f64;
        for (case, [value, _]) in cases
            .iter()
            .zip(evaluator.run(&Shading::Scheuermann(model), &cases))
        {
            assert!(
                value.is_finite() && value.min_element() >= 0.0,
                "{value} at {case:?}"
            );
            if tangent.cross(case.wo.normalize()).length() < ALONG {
                continue;
            }
            let expected = scheuermann::scatter(tangent, case.wi, case.wo, &truth);
            peak = peak.max(expected.max_element());
            worst = worst.max((value - expected).abs().max_element());
        }
        eprintln!(
            "scheuermann m {exponent}: worst {:.2e} of the peak",
            worst / peak
        );
        assert!(
            worst / peak <= tolerance(exponent),
            "m {exponent}: {worst} of {peak}"
        );
    }
}

/// As Kajiya-Kay's ambient term: it leaves out the lobe's cut at grazing angles, at most k 2π / (m + 2).
fn uniform_tolerance(model: &Scheuermann) -> f64 {
    let of = |h: &Highlight| {
        f64::from(h.colour.max_element() / (h.exponent + 2.0)) * std::f64::consts::TAU
    };
    1e-3 + of(&model.primary) + of(&model.secondary)
}

#[test]
fn the_ambient_term_is_the_integral_of_the_model_over_the_sphere() {
    let Some(mut device) = device() else { return };
    let evaluator = Evaluator::new(&mut device, &Shading::Scheuermann(Scheuermann::default()));
    let model = Scheuermann::default();
    for theta in [-1.2, -0.3, 0.0, 0.5, 1.4] {
        let [_, value] = evaluator.run(&Shading::Scheuermann(model), &[case(0.0, theta, 0.0)])[0];
        let expected: DVec3 = evaluator.furnace(&Shading::Scheuermann(model), theta, [400, 128]);
        let off = (value - expected).abs().max_element();
        eprintln!("scheuermann ambient at {theta}: {value:.4} for {expected:.4}");
        assert!(
            off <= uniform_tolerance(&model),
            "{theta}: {value} for {expected}"
        );
    }
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let model = Scheuermann::default();
    let wrong = [
        (
            "diffuse",
            Scheuermann {
                diffuse: Vec3::new(-1.0, 0.0, 0.0),
                ..model
            },
        ),
        ("primary.exponent", with_exponent(0.5)),
        (
            "secondary.shift",
            Scheuermann {
                secondary: Highlight {
                    shift: 11.0,
                    ..model.secondary
                },
                ..model
            },
        ),
    ];
    for (name, model) in wrong {
        let error = Shading::Scheuermann(model)
            .validate()
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("scheuermann") && error.contains(name),
            "{error}"
        );
    }
}
