//! The shadow map against its model, by the radiance of white diffuse fibres.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::shadow::{Shadow, ShadowMap};
use pelage::{Frame, Raster};
use pelage_reference::error::colour_error;
use pelage_reference::shadow_maps::shadow_map;
use pelage_reference::transmittance::Light as Towards;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close};
use crate::common::scenes::{WHITE, portrait};

use super::support::{OPAQUE, directional, draw, exact, image_of, light, modelled};

const DIRECTION: DVec3 = DVec3::new(-0.4, -0.8, -0.5);
/// Decisions of yes or no at texels' centres: of the texels some hang on the last bit, one of which is a 9th of a point.
const DECISIONS: Tolerance = Tolerance {
    rmse: 8e-3,
    p99: 4e-2,
};

#[test]
fn it_is_what_its_model_says() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Wavy, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.7);
    for (pcf, strength, raster) in [
        (1, 1.0, Raster::Walk),
        (3, 0.6, Raster::Ribbons),
        (5, 1.0, Raster::Walk),
    ] {
        let settings = ShadowMap {
            resolution: 256,
            pcf,
            strength,
            raster,
        };
        let lights = [light(directional(DIRECTION), Shadow::ShadowMap(settings))];
        let frame = Frame {
            hairs: &[&hair],
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        let passed = modelled(&frame, 256, pcf, |_| {
            Box::new(move |occluders, depth| shadow_map(occluders, depth, f64::from(strength)))
        });
        let expected = image_of(&frame, size, &passed);
        let actual = draw(&mut device, &[&hair], &lights, size, frame.view);
        assert_close(
            &format!("shadow_map pcf {pcf}"),
            &actual,
            &expected,
            DECISIONS,
        );
    }
}

/// Opaque fibres, whose light is all or nothing: the filter's mean is then the light's, but for the filter's few samples.
#[test]
fn of_opaque_fibres_its_error_falls_with_the_filter_and_the_mean_is_right() {
    let Some(mut device) = device() else { return };
    let size = [164, 215];
    let strands = builtin(BuiltinGroom::Straight, 2_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    let hairs = [&hair];
    let errors = [1, 3, 5].map(|pcf| {
        let settings = ShadowMap {
            pcf,
            ..Default::default()
        };
        let lights = [light(directional(DIRECTION), Shadow::ShadowMap(settings))];
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        let towards = Towards::Directional {
            towards: -DIRECTION,
        };
        // The disc of the filter's own area: the hair's extent is about 0.55 m.
        let footprint = f64::from(pcf) * 0.55 / 512.0 / std::f64::consts::PI.sqrt();
        let expected = exact(&frame, size, towards, footprint);
        let actual = draw(&mut device, &hairs, &lights, size, frame.view);
        let error = colour_error(&actual, &expected, None);
        let mean = |image: &pelage_reference::composite::Image| {
            image.pixels.iter().map(|p| p[0]).sum::<f64>()
        };
        let bias = mean(&actual) / mean(&expected);
        eprintln!(
            "shadow_map, pcf {pcf}: RMSE {:.4}, mean {bias:.4} of exact",
            error.rmse
        );
        (error.rmse, bias)
    });
    assert!(errors[1].0 < errors[0].0 && errors[2].0 < errors[1].0);
    assert!((errors[2].1 - 1.0).abs() < 0.1, "{}", errors[2].1);
}
