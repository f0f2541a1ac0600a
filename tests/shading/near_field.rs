//! Chiang's near field: the mean over the part of the fibre that a pixel sees, against the reference's near field.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::Strands;
use pelage::shading::{Chiang, Shading, ShadingRate};
use pelage::transparency::{Opaque, Transparency};
use pelage::{Frame, View};
use pelage_reference::composite::Image;
use pelage_reference::fibre::{Direction, FibreModel};

use super::chiang;
use super::harness::{Case, Evaluator, case, seen};
use super::reference::of_chiang;
use crate::common::images::{render, write_failure};
use crate::common::scenes::{pixel_view, unshadowed};
use crate::common::{Device, device};

fn near() -> Chiang {
    Chiang {
        sigma_a: Vec3::new(0.1, 0.3, 0.8),
        near_field: true,
        ..chiang::direct()
    }
}

/// The mean of the reference's near field over offsets.
fn mean(model: &Chiang, wi: Direction, wo: Direction, across: [f64; 2]) -> DVec3 {
    let steps = 200;
    (0..steps)
        .map(|i| {
            let part = (f64::from(i) + 0.5) / f64::from(steps);
            let h = across[0] + (across[1] - across[0]) * part;
            of_chiang(model).at(h).scatter(wi, wo)
        })
        .sum::<DVec3>()
        / f64::from(steps)
}

/// Eight intervals of γ_i with linear exits and weights: measured 2.3e-3 of the peak, over a whole side.
const NEAR: f64 = 5e-3;

#[test]
fn parts_of_a_fibre_are_the_mean_of_the_near_field() {
    let Some(mut device) = device() else { return };
    let evaluator = Evaluator::new(&mut device, &Shading::Chiang(near()));
    for (name, model) in [
        ("default", near()),
        (
            "smooth",
            Chiang {
                beta_n: 0.15,
                alpha: 0.1,
                ..near()
            },
        ),
    ] {
        let (mut worst, mut peak) = (0.0f64, 0.0f64);
        for across in [
            [-1.0, -0.9],
            [-0.6, -0.4],
            [0.0, 0.1],
            [0.3, 0.8],
            [0.85, 1.0],
            [-1.0, 0.0],
        ] {
            let mut cases = Vec::new();
            for (theta_i, theta_o) in [(0.1, -0.1), (0.8, -0.7), (-0.3, 0.5), (1.2, -1.1)] {
                for i in -6..=6 {
                    let phi = f64::from(i) * 0.5;
                    cases.push(Case {
                        across,
                        ..case(theta_i, theta_o, phi)
                    });
                }
            }
            let values = evaluator.run(&Shading::Chiang(model), &cases);
            for (case, [value, _]) in cases.iter().zip(values) {
                let expected = mean(&model, seen(case.wi), seen(case.wo), across);
                worst = worst.max((value - expected).abs().max_element());
                peak = peak.max(expected.max_element());
            }
        }
        eprintln!(
            "chiang near field, {name}: {:.2e} of the peak",
            worst / peak
        );
        assert!(worst / peak <= NEAR, "{name}: {worst} of {peak}");
    }
}

/// A lone vertical fibre of this half-width in the middle of an image, lit from the left.
fn lone(device: &mut Device, half_width: f32, shading: Chiang) -> (Image, View, DVec3) {
    let size = [64, 16];
    let strands =
        Strands::new(vec![[0.3, -20.0, 0.0], [0.3, 20.0, 0.0]], &[2], half_width).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = Shading::Chiang(shading);
    hair.shading_rate = ShadingRate::Fragment;
    let direction = DVec3::new(0.8, 0.1, -0.5);
    let view = pixel_view(size, 50.0);
    let frame = Frame {
        hairs: &[&hair],
        lights: &[unshadowed(direction, Vec3::ONE)],
        ambient: Vec3::ZERO,
        view,
        transparency: Some(Transparency::Opaque(Opaque::default())),
    };
    (render(device, &frame, size).0, view, direction)
}

/// Of the fibre's brightest pixel: measured 2.5e-5.
const PROFILE: f64 = 1e-3;

#[test]
fn a_wide_fibre_shows_its_profile_and_a_thin_one_the_mean() {
    let Some(mut device) = device() else { return };
    let model = near();
    let half_width = 12.0;
    let (actual, _, direction) = lone(&mut device, half_width, model);
    // The fibre runs from below upwards; its first axis is the way to the eye.
    let (tangent, to_eye) = (DVec3::Y, DVec3::Z);
    let wi = Direction::in_frame(-direction.normalize(), tangent, to_eye);
    let wo = Direction::in_frame(to_eye, tangent, to_eye);
    let row = 8;
    let mut worst = 0.0f64;
    let mut peak = 0.0f64;
    for x in 0..64 {
        let pixel = actual.pixels[row * 64 + x];
        // h of the pixel's edges, which grows against tangent × way to the eye: to the left.
        let edge = |x: f64| -((x - 32.3) / f64::from(half_width));
        let (low, high) = (edge(x as f64 + 1.0), edge(x as f64));
        if pixel[3] < 0.999 || low < -0.999 || high > 0.999 {
            continue;
        }
        let expected = mean(&model, wi, wo, [low, high]);
        for c in 0..3 {
            worst = worst.max((pixel[c] - expected[c]).abs());
            peak = peak.max(expected[c]);
        }
    }
    eprintln!("profile of a wide fibre: {worst:.2e} of {peak:.2e}");
    if worst.is_nan() || worst > PROFILE * peak {
        write_failure("near field", &actual, &actual);
        panic!("{worst} of {peak}");
    }

    // Narrower than a pixel: the far field, bit for bit.
    let (thin, ..) = lone(&mut device, 0.4, model);
    let far = Chiang {
        near_field: false,
        ..model
    };
    let (expected, ..) = lone(&mut device, 0.4, far);
    assert_eq!(thin.pixels, expected.pixels);
    let (wide_far, ..) = lone(&mut device, half_width, far);
    assert_ne!(actual.pixels, wide_far.pixels);
}
