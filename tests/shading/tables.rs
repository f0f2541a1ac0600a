//! Lookup tables: what they cost in error by size and format, and that nothing is made that no setting in use needs.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::shading::{
    Chiang, DualScattering, KajiyaKay, Marschner, Precision, Sadeghi, Scheuermann, Shading, Tables,
};
use pelage::{Frame, Light, Target};

use super::harness::{Case, Evaluator, case};
use crate::common::images::FORMAT;
use crate::common::{Device, device, scenes};

/// Directions evenly over both angles, away from no one's nodes.
fn spread() -> Vec<Case> {
    let mut cases = Vec::new();
    for i in 0..24 {
        for j in 0..24 {
            for k in 0..37 {
                let theta = |n: i32| 1.5 * (f64::from(n) / 11.5 - 1.0);
                cases.push(case(
                    theta(i),
                    theta(j),
                    std::f64::consts::PI * f64::from(k) / 36.0,
                ));
            }
        }
    }
    cases
}

/// Root of the mean square of the differences, of the root of the mean square of the values.
fn rmse(actual: &[[DVec3; 2]], expected: &[[DVec3; 2]]) -> f64 {
    let difference: f64 = actual
        .iter()
        .zip(expected)
        .map(|(a, e)| (a[0] - e[0]).length_squared())
        .sum();
    let whole: f64 = expected.iter().map(|e| e[0].length_squared()).sum();
    (difference / whole).sqrt()
}

/// Errors of both models' tables against direct evaluation, by size and format; asserts a bound for each size.
fn errors(device: &mut Device, name: &str, with: &dyn Fn(Option<Tables>) -> Shading, bound: f64) {
    let evaluator = Evaluator::new(device, &with(None));
    let cases = spread();
    let exact = evaluator.run(&with(None), &cases);
    let mut before = f64::INFINITY;
    for size in [32, 64, 128, 256, 512] {
        let error = |precision| {
            let tables = Some(Tables { size, precision });
            rmse(&evaluator.run(&with(tables), &cases), &exact)
        };
        let [f16, f32] = [Precision::F16, Precision::F32].map(error);
        eprintln!("{name} tables {size}: rmse {f32:.2e} as f32, {f16:.2e} as f16");
        // Bilinear interpolation of a function with corners: the error falls at least as the step.
        let allowed = bound * 64.0 / f64::from(size) + F16;
        assert!(
            f32 <= allowed && f16 <= allowed,
            "{name} {size}: {f32:e}, {f16:e}"
        );
        assert!(f32 < before, "{name} {size}: {f32:e} after {before:e}");
        before = f32;
    }
}

/// An f16 keeps 11 bits: 2.4e-4 on average of a value's own size.
const F16: f64 = 5e-4;
/// At 64 rows and columns.
/// Measured 1e-3.
const CHIANG: f64 = 3e-3;
/// TT and TRT end at corners. Measured 1.2e-3.
const MARSCHNER: f64 = 3.5e-3;

#[test]
fn errors_of_tables_fall_with_their_size() {
    let Some(mut device) = device() else { return };
    let chiang = |tables| {
        Shading::Chiang(Chiang {
            tables,
            intervals: 128,
            sigma_a: Vec3::new(0.06, 0.1, 0.2),
            ..Chiang::default()
        })
    };
    errors(&mut device, "chiang", &chiang, CHIANG);
    let marschner = |tables| {
        Shading::Marschner(Marschner {
            tables,
            ..Marschner::default()
        })
    };
    errors(&mut device, "marschner", &marschner, MARSCHNER);
}

#[test]
fn only_what_a_model_needs_is_made() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 200).unwrap();
    let size = [64, 80];
    let image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    let direct = Chiang {
        tables: None,
        ..Chiang::default()
    };
    let tables = Tables {
        size: 32,
        precision: Precision::F32,
    };
    // The angles' table has 128 rows of 24 words; the azimuthal one 32² entries of 10.
    let (angles, azimuthal) = (128 * 24 * 4, 32 * 32 * 10 * 4);
    let dual = Some(DualScattering::default());
    for (shading, ambient, bytes) in [
        (Shading::KajiyaKay(KajiyaKay::default()), 0.1, 0),
        (Shading::Scheuermann(Scheuermann::default()), 0.1, 0),
        (
            Shading::Sadeghi(Sadeghi {
                normalised: false,
                ..Sadeghi::default()
            }),
            0.0,
            0,
        ),
        (Shading::Sadeghi(Sadeghi::default()), 0.0, angles),
        (Shading::Chiang(direct), 0.0, 0),
        (Shading::Chiang(direct), 0.1, angles),
        (
            Shading::Chiang(Chiang {
                tables: Some(tables),
                ..direct
            }),
            0.0,
            azimuthal,
        ),
        (
            Shading::Chiang(Chiang {
                tables: Some(tables),
                dual_scattering: dual,
                ..direct
            }),
            0.0,
            angles + 2 * azimuthal,
        ),
        (Shading::KajiyaKay(KajiyaKay::default()), 0.0, 0),
    ] {
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        hair.shading = shading;
        let frame = Frame {
            hairs: &[&hair],
            lights: &[Light::directional(DVec3::new(0.5, -0.7, -0.7), Vec3::ONE)],
            ambient: Vec3::splat(ambient),
            view: scenes::portrait(size),
            transparency: None,
        };
        // Tables are kept for as many frames as may be under way.
        let mut statistics = Default::default();
        for _ in 0..9 {
            statistics = device
                .render(&frame, &Target::cleared(&image.colour))
                .unwrap();
        }
        let held: u64 = statistics
            .bytes
            .iter()
            .filter(|(label, _)| label == "pelage.shading.tables")
            .map(|(_, bytes)| bytes)
            .sum();
        assert_eq!(held, bytes, "{} with ambient {ambient}", shading.stem());
    }
}

#[test]
fn tables_are_filled_once_and_again_when_a_parameter_changes() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 200).unwrap();
    let size = [64, 80];
    let image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let lights = [Light::directional(DVec3::new(0.5, -0.7, -0.7), Vec3::ONE)];
    let mut filled = Vec::new();
    // At the end two views that take turns.
    for sigma_a in [0.1, 0.1, 0.1, 0.4, 0.4, 0.1, 0.4] {
        hair.shading = Shading::Chiang(Chiang {
            sigma_a: Vec3::splat(sigma_a),
            ..Chiang::default()
        });
        let frame = Frame {
            hairs: &[&hair],
            lights: &lights,
            ambient: Vec3::ZERO,
            view: scenes::portrait(size),
            transparency: None,
        };
        // A frame recorded and dropped fills nothing, and must not count.
        if filled.len() == 3 {
            let device_of = device.renderer.device().clone();
            let mut encoder = device_of.create_command_encoder(&Default::default());
            device
                .renderer
                .record(&mut encoder, &frame, &Target::cleared(&image.colour))
                .unwrap();
        }
        let statistics = device
            .renderer
            .render_timed(&frame, &Target::cleared(&image.colour))
            .unwrap();
        filled.push(
            statistics
                .passes
                .iter()
                .any(|pass| pass.label == "pelage.shading.chiang.tables"),
        );
        let device_of = device.renderer.device().clone();
        device_of
            .poll(pelage::wgpu::PollType::wait_indefinitely())
            .unwrap();
        let pixels = device.read_colour(&image.colour).unwrap();
        assert!(pixels.iter().any(|p| p.x > 0.0));
    }
    assert_eq!(filled, [true, false, false, true, false, false, false]);
}
