//! Hard cases on the device and in the reference alike: finite, not negative, and continuous, over every model's parameters from end to
//! end.

use std::f64::consts::{FRAC_PI_2, PI};

use pelage::glam::{DVec3, Vec3};
use pelage::shading::{CausticRemoval, Chiang, Marschner, Sadeghi, Shading};
use pelage_reference::fibre::{Direction, FibreModel};

use super::harness::{Case, Evaluator, case};
use super::reference::{of_chiang, of_marschner, of_sadeghi};
use super::{chiang, marschner, sadeghi};
use crate::common::device;

/// A step in any angle, in widths of the narrowest lobe.
const STEP: f64 = 1e-3;
/// Values change by at most this many times the peak a width. Measured on the device and in the reference: Chiang 0.8, Marschner 1.9,
/// Sadeghi 5.4 (where its lobes are as wide as 1/cos² θ_d is steep). A jump by 1 % of the peak would be ten.
const SLOPE: f64 = 8.0;
/// Peaks are greater near the tangent: places whose cosines are below this, and the others, have their own.
const GRAZING: f64 = 0.3;
/// Nearer to the tangent an f32 direction has no azimuth, and what is seen along a fibre depends on it.
const ALONG: f64 = 1e-3;

/// θ_i, θ_o, φ.
type Angles = [f64; 3];

fn angles(sums: &[f64]) -> Vec<Angles> {
    let thetas = [
        -FRAC_PI_2,
        -FRAC_PI_2 + 2e-3,
        -0.9,
        0.0,
        0.4,
        1.2,
        FRAC_PI_2,
    ];
    let phis = [0.0, 0.4, 1.3, 1.9, 2.6, PI - 1e-3, PI];
    let mut all = Vec::new();
    for theta_i in thetas {
        let mirrored = sums
            .iter()
            .map(|sum| sum - theta_i)
            .filter(|t| t.abs() <= FRAC_PI_2);
        for theta_o in thetas.into_iter().chain(mirrored) {
            all.extend(phis.map(|phi| [theta_i, theta_o, phi]));
        }
    }
    all
}

/// Each place, and a step away from it in each angle.
fn stepped(places: &[Angles], step: f64) -> Vec<Angles> {
    let mut all = Vec::new();
    for place in places {
        all.push(*place);
        for axis in 0..3 {
            let mut moved = *place;
            // Towards 0, so that no angle leaves its range.
            moved[axis] -= if place[axis] > 0.0 { step } else { -step };
            all.push(moved);
        }
    }
    all
}

/// The greatest change over a step, of the peak; all values must be finite and not negative.
fn worst_change(name: &str, all: &[Angles], values: &[DVec3]) -> f64 {
    let (mut worst, mut peak) = ([0.0f64; 2], [1e-30f64; 2]);
    for (angles, values) in all.chunks_exact(4).zip(values.chunks_exact(4)) {
        for value in values {
            assert!(
                value.is_finite() && value.min_element() >= 0.0,
                "{name}: {value} at {angles:?}"
            );
        }
        let across = angles[0][0].cos().min(angles[0][1].cos());
        if across < ALONG {
            continue;
        }
        let class = usize::from(across < GRAZING);
        peak[class] = peak[class].max(values[0].max_element());
        for moved in &values[1..] {
            worst[class] = worst[class].max((*moved - values[0]).abs().max_element());
        }
    }
    (worst[0] / peak[0]).max(worst[1] / peak[1])
}

fn check(
    evaluator: &Evaluator,
    name: &str,
    shading: Shading,
    model: &impl FibreModel,
    width: f64,
    sums: &[f64],
) -> [f64; 2] {
    let all = stepped(&angles(sums), STEP * width);
    let cases: Vec<Case> = all.iter().map(|&[i, o, phi]| case(i, o, phi)).collect();
    let values: Vec<DVec3> = evaluator
        .run(&shading, &cases)
        .iter()
        .map(|[value, _]| *value)
        .collect();
    let device = worst_change(&format!("{name} on the device"), &all, &values) / STEP;
    // One in seven: the reference's far field is slow.
    let few: Vec<Angles> = all.chunks_exact(4).step_by(7).flatten().copied().collect();
    let exact: Vec<DVec3> = few
        .iter()
        .map(|&[i, o, phi]| model.scatter(Direction::new(i, 0.2), Direction::new(o, 0.2 + phi)))
        .collect();
    let reference = worst_change(&format!("{name} in the reference"), &few, &exact) / STEP;
    eprintln!("{name}: {device:.2} peaks a width on the device, {reference:.2} in the reference");
    [device, reference]
}

#[test]
fn every_model_is_finite_not_negative_and_continuous() {
    let Some(mut device) = device() else { return };
    let mut wrong = Vec::new();
    let mut judge = |name: &str, found: [f64; 2]| {
        if found.iter().any(|slope| slope.is_nan() || *slope > SLOPE) {
            wrong.push(format!("{name}: {found:?}"));
        }
    };
    let sigmas = [Vec3::ZERO, Vec3::new(0.1, 5.0, 100.0)];

    let evaluator = Evaluator::new(&mut device, &Shading::Chiang(chiang::direct()));
    for (beta, eta, sigma_a) in [
        (1e-3, 1.55, sigmas[0]),
        (0.05, 1.0101, sigmas[1]),
        (0.3, 2.0, sigmas[0]),
        (0.3, 3.0, sigmas[1]),
        (1.0, 1.55, sigmas[1]),
    ] {
        let model = Chiang {
            beta_m: beta,
            // Narrower around the fibre than the intervals across it: their own test says what that costs.
            beta_n: beta.max(0.05),
            eta,
            sigma_a,
            ..chiang::direct()
        };
        let a = f64::from(model.alpha);
        let name = format!("chiang β {beta} η {eta} σ {sigma_a}");
        // TT's deviation, and the logistic's scale.
        let width = (0.36 * f64::from(beta)).min(0.17 * f64::from(model.beta_n));
        let sums = [-2.0 * a, a, 4.0 * a];
        judge(
            &name,
            check(
                &evaluator,
                &name,
                Shading::Chiang(model),
                &of_chiang(&model),
                width,
                &sums,
            ),
        );
    }

    let evaluator = Evaluator::new(&mut device, &Shading::Marschner(marschner::direct()));
    for (beta, eta, eccentricity, sigma_a) in [
        (1e-3, 1.55, 1.0, sigmas[0]),
        (0.05, 1.0101, 1.0, sigmas[1]),
        (0.2, 1.99, 1.0, sigmas[0]),
        (0.2, 2.0, 1.0, sigmas[0]),
        (0.2, 2.01, 1.0, sigmas[1]),
        (0.2, 3.0, 1.0, sigmas[1]),
        (1.0, 1.55, 1.0, sigmas[1]),
        (0.2, 1.55, 0.75, sigmas[0]),
        (0.2, 1.55, 1.3299, sigmas[1]),
    ] {
        let model = Marschner {
            beta: [beta, 0.5 * beta, 2.0 * beta],
            eta,
            eccentricity,
            sigma_a,
            ..marschner::direct()
        };
        let name = format!("marschner β {beta} η {eta} a {eccentricity} σ {sigma_a}");
        let glints = f64::from(CausticRemoval::default().w_c);
        let width = (f64::from(beta)).min(glints);
        let sums = model.alpha.map(|a| 2.0 * f64::from(a));
        judge(
            &name,
            check(
                &evaluator,
                &name,
                Shading::Marschner(model),
                &of_marschner(&model),
                width,
                &sums,
            ),
        );
    }

    let evaluator = Evaluator::new(&mut device, &Shading::Sadeghi(sadeghi::plain()));
    for width in [1e-3, 0.1, 1.0] {
        let mut model = sadeghi::plain();
        for lobe in [&mut model.r, &mut model.tt, &mut model.trt] {
            lobe.width = width;
        }
        (model.tt_azimuthal_width, model.glint_width) = (width, width);
        for normalised in [false, true] {
            let model = Sadeghi {
                normalised,
                ..model
            };
            let name = format!("sadeghi width {width}, normalised {normalised}");
            let sums = [model.r, model.tt, model.trt].map(|lobe| 2.0 * f64::from(lobe.shift));
            let shading = Shading::Sadeghi(model);
            let found = if normalised {
                check(
                    &evaluator,
                    &name,
                    shading,
                    &of_sadeghi(&model).normalised(),
                    f64::from(width),
                    &sums,
                )
            } else {
                check(
                    &evaluator,
                    &name,
                    shading,
                    &of_sadeghi(&model),
                    f64::from(width),
                    &sums,
                )
            };
            judge(&name, found);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
