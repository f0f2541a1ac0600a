//! The WGSL of Sadeghi's model against the reference in f64.

use pelage::glam::Vec3;
use pelage::shading::{LobeControls, Sadeghi, Shading};
use pelage_reference::fibre::Direction;
use pelage_reference::furnace::furnace;

use super::harness::{Evaluator, case, hard_cases};
use super::reference::of_sadeghi;
use crate::common::device;

/// One glint angle for all strands.
pub fn plain() -> Sadeghi {
    Sadeghi {
        glint_angle: [0.65, 0.65],
        normalised: false,
        ..Sadeghi::default()
    }
}

/// f32's own rounding, next to the tangent: measured 2.7e-5.
const USUAL: f64 = 6e-5;
/// Widths of 1e-3: an f32 angle is exact to 1.2e-7; measured 2e-4.
const NARROW: f64 = 5e-4;

fn with_width(width: f32) -> Sadeghi {
    let mut model = plain();
    for lobe in [&mut model.r, &mut model.tt, &mut model.trt] {
        lobe.width = width;
    }
    (model.tt_azimuthal_width, model.glint_width) = (width, width);
    model
}

#[test]
fn values_are_the_reference_at_every_angle_and_parameter() {
    let Some(mut device) = device() else { return };
    let evaluator = Evaluator::new(&mut device, &Shading::Sadeghi(plain()));
    let mut wrong = Vec::new();
    for (name, model, tolerance) in [
        ("default", plain(), USUAL),
        ("widths 1e-3", with_width(1e-3), NARROW),
        ("widths 1", with_width(1.0), USUAL),
    ] {
        let sums = [model.r, model.tt, model.trt].map(|lobe| 2.0 * f64::from(lobe.shift));
        let name = format!("sadeghi {name}");
        let cases = hard_cases(&sums);
        let error = evaluator.worst(&name, &Shading::Sadeghi(model), &cases, &of_sadeghi(&model));
        if error > tolerance {
            wrong.push(format!("{name}: {error:e}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// The divisor is read between 128 rows of θ: measured 1.7e-3.
const NORMALISED: f64 = 3e-3;

#[test]
fn the_normalised_form_is_its_reference_and_makes_no_light() {
    let Some(mut device) = device() else { return };
    let evaluator = Evaluator::new(&mut device, &Shading::Sadeghi(plain()));
    let mut bright = Sadeghi {
        normalised: true,
        ..plain()
    };
    bright.r.intensity = 3.0;
    let truth = of_sadeghi(&bright).normalised();
    let error = evaluator.worst(
        "sadeghi normalised",
        &Shading::Sadeghi(bright),
        &hard_cases(&[0.0]),
        &truth,
    );
    assert!(error <= NORMALISED, "{error:e}");
    for theta in [-1.4, -0.4, 0.0, 0.9, 1.5] {
        let sum = evaluator.furnace(&Shading::Sadeghi(bright), theta, [400, 64]);
        let plain = evaluator.furnace(
            &Shading::Sadeghi(Sadeghi {
                normalised: false,
                ..bright
            }),
            theta,
            [400, 64],
        );
        eprintln!("sadeghi furnace at {theta}: {plain:.4} as published, {sum:.4} normalised");
        assert!(sum.max_element() <= 1.0 + NORMALISED, "{theta}: {sum}");
        let expected = furnace(&truth, Direction::new(theta, 0.0), 128);
        let [_, uniform] = evaluator.run(&Shading::Sadeghi(bright), &[case(0.0, theta, 0.0)])[0];
        assert!(
            (uniform - expected).abs().max_element() <= NORMALISED,
            "{theta}: {uniform} for {expected}"
        );
    }
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let lobe = |colour: Vec3, width: f32| LobeControls {
        colour,
        width,
        ..plain().r
    };
    let wrong = [
        (
            "r.colour",
            Sadeghi {
                r: lobe(Vec3::new(0.0, -1.0, 0.0), 0.1),
                ..plain()
            },
        ),
        (
            "tt.width",
            Sadeghi {
                tt: lobe(Vec3::ONE, 0.0),
                ..plain()
            },
        ),
        (
            "glint_angle",
            Sadeghi {
                glint_angle: [0.5, 0.4],
                ..plain()
            },
        ),
        (
            "glint_intensity",
            Sadeghi {
                glint_intensity: -0.1,
                ..plain()
            },
        ),
    ];
    for (name, model) in wrong {
        let error = Shading::Sadeghi(model).validate().unwrap_err().to_string();
        assert!(error.contains("sadeghi") && error.contains(name), "{error}");
    }
}
