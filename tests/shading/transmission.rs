//! The TT lobe left out without a light behind the hair: its bound against the reference, and frames with and without it.

use std::f64::consts::PI;

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::shading::{Chiang, Marschner, Sadeghi, Shading, Tables};
use pelage::{Frame, Light, testing};
use pelage_reference::fibre::{Direction, FibreModel, TT};

use super::reference::{of_chiang, of_marschner, of_sadeghi};
use super::{chiang, marschner, sadeghi};
use crate::common::device;
use crate::common::images::render;
use crate::common::scenes::{portrait, unshadowed};

const SIZE: [u32; 2] = [164, 215];

/// The greatest TT value of a model over a grid of directions no further apart than `angle`.
fn greatest(model: &impl FibreModel, angle: f64) -> f64 {
    let steps = 24;
    let mut most = 0.0f64;
    for i in 0..=steps {
        let theta_i = PI * (f64::from(i) / f64::from(steps) - 0.5);
        for o in 0..=2 * steps {
            let theta_o = PI * (f64::from(o) / f64::from(2 * steps) - 0.5);
            let across = theta_i.cos() * theta_o.cos();
            let least = (angle.cos() - theta_i.sin() * theta_o.sin()) / across.max(1e-12);
            if least > 1.0 {
                continue;
            }
            let last = least.clamp(-1.0, 1.0).acos();
            for part in [0.5, 0.8, 0.95, 1.0] {
                let wi = Direction::new(theta_i, 0.0);
                let wo = Direction::new(theta_o, last * part);
                most = most.max(model.scatter_lobes(wi, wo)[TT].max_element());
            }
        }
    }
    most
}

#[test]
fn no_direction_is_brighter_than_the_bound() {
    let black = Chiang {
        sigma_a: Vec3::new(5.0, 1.0, 2.0),
        ..chiang::direct()
    };
    let narrow = Chiang {
        beta_m: 0.1,
        beta_n: 0.1,
        ..chiang::direct()
    };
    let tilted = Chiang {
        beta_n: 0.7,
        alpha: 0.4,
        eta: 1.3,
        sigma_a: Vec3::ZERO,
        ..chiang::direct()
    };
    for model in [chiang::direct(), black, narrow, tilted] {
        check("chiang", &Shading::Chiang(model), &of_chiang(&model));
    }
    let white = Marschner {
        sigma_a: Vec3::ZERO,
        ..marschner::direct()
    };
    let low = Marschner {
        eta: 1.05,
        beta: [0.3; 3],
        ..marschner::direct()
    };
    for model in [marschner::direct(), white, low] {
        check(
            "marschner",
            &Shading::Marschner(model),
            &of_marschner(&model),
        );
    }
    let model = sadeghi::plain();
    check("sadeghi", &Shading::Sadeghi(model), &of_sadeghi(&model));
}

fn check(name: &str, shading: &Shading, model: &impl FibreModel) {
    let mut said = String::new();
    for degrees in [0.0, 20.0, 50.0, 80.0, 100.0, 120.0, 140.0, 160.0, 180.0f64] {
        let angle = degrees.to_radians();
        let bound = f64::from(testing::transmission_bound(shading, angle).unwrap());
        let found = greatest(model, angle);
        said += &format!(" {degrees}°: {found:.2e} of {bound:.2e};");
        assert!(
            bound >= found,
            "{name} at {degrees}°: {found} above {bound}"
        );
    }
    eprintln!("{name}:{said}");
}

fn with_tolerance(shading: Shading, lobe_tolerance: f32) -> Shading {
    match shading {
        Shading::Chiang(model) => Shading::Chiang(Chiang {
            lobe_tolerance,
            ..model
        }),
        Shading::Marschner(model) => Shading::Marschner(Marschner {
            lobe_tolerance,
            ..model
        }),
        Shading::Sadeghi(model) => Shading::Sadeghi(Sadeghi {
            lobe_tolerance,
            ..model
        }),
        other => other,
    }
}

#[test]
fn a_frame_changes_by_less_than_the_tolerance_and_not_at_all_with_light_behind() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 300).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.8;
    // Light hair, whose TT is bright.
    let sigma_a = Vec3::new(0.06, 0.1, 0.2);
    let models = [
        Shading::Chiang(Chiang {
            sigma_a,
            ..Chiang::default()
        }),
        Shading::Chiang(Chiang {
            sigma_a,
            tables: None,
            ..Chiang::default()
        }),
        Shading::Marschner(Marschner {
            sigma_a,
            beta: [0.1, 0.1, 0.2],
            tables: Some(Tables::default()),
            ..Marschner::default()
        }),
        Shading::Marschner(Marschner {
            sigma_a,
            beta: [0.1, 0.1, 0.2],
            tables: None,
            ..Marschner::default()
        }),
        Shading::Sadeghi(Sadeghi {
            tt_azimuthal_width: 0.7,
            normalised: false,
            ..Sadeghi::default()
        }),
    ];
    let irradiance = Vec3::splat(3.0);
    let beside = unshadowed(DVec3::new(-1.0, -0.3, 0.1), irradiance);
    let behind = unshadowed(DVec3::new(0.1, -0.1, 1.0), irradiance);
    for shading in models {
        let name = shading.stem();
        let mut picture = |light: Light, tolerance: f32| {
            hair.shading = with_tolerance(shading, tolerance);
            let frame = Frame {
                hairs: &[&hair],
                lights: &[light],
                ambient: Vec3::splat(0.1),
                view: portrait(SIZE),
                transparency: None,
            };
            render(&mut device, &frame, SIZE).0
        };
        // The least power of two with which the lobe is left out from the side.
        let whole = picture(beside, 0.0);
        let mut left_out = None;
        for power in -12..10 {
            let tolerance = 2f32.powi(power);
            let without = picture(beside, tolerance);
            let worst = (0..whole.pixels.len())
                .flat_map(|i| (0..4).map(move |c| (i, c)))
                .map(|(i, c)| (whole.pixels[i][c] - without.pixels[i][c]).abs())
                .fold(0.0, f64::max);
            if worst > 0.0 {
                eprintln!(
                    "{name}: left out from a tolerance of {tolerance} on, changes a pixel by {worst:.2e}"
                );
                assert!(
                    worst <= f64::from(tolerance),
                    "{name}: {worst} for {tolerance}"
                );
                left_out = Some(tolerance);
                break;
            }
        }
        let tolerance = left_out.unwrap_or_else(|| panic!("{name}: never left out"));
        let kept = picture(behind, tolerance);
        assert_eq!(
            kept.pixels,
            picture(behind, 0.0).pixels,
            "{name}: light behind"
        );
    }
}
