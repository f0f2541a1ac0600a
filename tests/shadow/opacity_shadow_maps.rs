//! Opacity shadow maps against their model and against exact transmittance.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::shadow::{OpacityShadowMaps, Shadow};
use pelage::{Frame, Raster};
use pelage_reference::error::colour_error;
use pelage_reference::shadow_maps::opacity_shadow_maps;
use pelage_reference::transmittance::Light as Towards;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close};
use crate::common::scenes::{WHITE, portrait};

use super::support::{OPAQUE, directional, draw, exact, image_of, light, modelled};

const DIRECTION: DVec3 = DVec3::new(-0.4, -0.8, -0.5);
/// 16-bit floats, fragments whose depth is a plane's to the last bit, and texels beside the point in which a bent fibre is not
/// where its segments at the point, prolonged, would be.
const MODEL: Tolerance = Tolerance {
    rmse: 8e-3,
    p99: 4e-2,
};

#[test]
fn they_are_what_their_model_says() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Wavy, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.7);
    for (layers, unevenness, pcf, raster) in [
        (1, 0.0, 1, Raster::Walk),
        (8, 1.0, 3, Raster::Ribbons),
        (64, 0.0, 3, Raster::Walk),
        (256, 0.5, 5, Raster::Walk),
    ] {
        let settings = OpacityShadowMaps {
            resolution: 96,
            layers,
            unevenness,
            pcf,
            raster,
        };
        let lights = [light(
            directional(DIRECTION),
            Shadow::OpacityShadowMaps(settings),
        )];
        let frame = Frame {
            hairs: &[&hair],
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        let passed = modelled(&frame, 96, pcf, |map, seen| {
            let plane = |i: u32| {
                let x = f64::from(i) / f64::from(layers);
                let u = f64::from(unevenness);
                map.extent * ((1.0 - u) * x + u * x * x)
            };
            let planes: Vec<f64> = (0..=layers).map(plane).collect();
            let mut others = seen.occluders.to_vec();
            if let Some(own) = seen.own {
                others.remove(own);
            }
            opacity_shadow_maps(&others, seen.depth, 0.7, &planes)
        });
        let expected = image_of(&frame, size, &passed);
        let actual = draw(&mut device, &[&hair], &lights, size, frame.view);
        assert_close(
            &format!("opacity_shadow_maps {layers}"),
            &actual,
            &expected,
            MODEL,
        );
    }
}

/// Of the error over the number of planes, from 16 to 128. Measured: -0.81; RMSE 0.206, 0.132, 0.048, 0.0245 with 4, 16, 64,
/// 128.
const SLOPE: f64 = -0.7;

#[test]
fn the_error_falls_with_the_number_of_planes() {
    let Some(mut device) = device() else { return };
    let size = [164, 215];
    let strands = builtin(BuiltinGroom::Straight, 2_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.5);
    let hairs = [&hair];
    let towards = Towards::Directional {
        towards: -DIRECTION,
    };
    let planes = [4, 16, 64, 128];
    let mut expected = None;
    let errors = planes.map(|layers| {
        let settings = OpacityShadowMaps {
            resolution: 512,
            layers,
            ..Default::default()
        };
        let shadow = Shadow::OpacityShadowMaps(settings);
        let lights = [light(directional(DIRECTION), shadow)];
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        // Three of 512 texels over 0.55 m; the disc of the same area.
        let expected = expected.get_or_insert_with(|| exact(&frame, size, towards, 0.0018));
        let actual = draw(&mut device, &hairs, &lights, size, frame.view);
        let error = colour_error(&actual, expected, None).rmse;
        eprintln!("opacity_shadow_maps, N = {layers}: RMSE {error:.4}");
        error
    });
    for pair in errors.windows(2) {
        assert!(pair[1] <= pair[0] * 1.02, "{errors:?}");
    }
    let slope = (errors[3] / errors[1]).log(8.0);
    eprintln!("opacity_shadow_maps: slope {slope:.2} from 16 to 128 planes");
    assert!(slope < SLOPE, "{slope}: {errors:?}");
}
