//! The approximated deep shadow map against its model and against exact transmittance.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::shadow::{ApproximatedDeepShadowMap, Shadow};
use pelage::{Frame, Raster};
use pelage_reference::composite::Image;
use pelage_reference::error::colour_error;
use pelage_reference::shadow_maps::{approximated_deep_shadow_map, nearest_depth};
use pelage_reference::transmittance::Light as Towards;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close};
use crate::common::scenes::{WHITE, portrait};

use super::support::{OPAQUE, directional, draw, exact, image_of, light, modelled};

const DIRECTION: DVec3 = DVec3::new(-0.4, -0.8, -0.5);
/// Decisions of yes or no, as in a shadow map: a texel's centre on a fibre's rim hangs on the last bit. With a filter, texels
/// beside the point in which a bent fibre is not where its segments at the point, prolonged, would be. Measured: RMSE
/// 0.028, 99th percentile 0.117 with one texel; 0.015 and 0.071 with 3×3.
const MODEL: [Tolerance; 2] = [
    Tolerance {
        rmse: 4e-2,
        p99: 1.5e-1,
    },
    Tolerance {
        rmse: 2e-2,
        p99: 8e-2,
    },
];

#[test]
fn it_is_what_its_model_says() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Wavy, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.7);
    for (pcf, opacity, spacing, raster) in [
        (1, Some(0.3), 0.02, Raster::Walk),
        (3, None, 0.05, Raster::Ribbons),
        (5, Some(0.05), 0.001, Raster::Walk),
    ] {
        let settings = ApproximatedDeepShadowMap {
            resolution: 128,
            pcf,
            opacity,
            spacing: Some(spacing),
            raster,
        };
        let lights = [light(
            directional(DIRECTION),
            Shadow::ApproximatedDeepShadowMap(settings),
        )];
        let frame = Frame {
            hairs: &[&hair],
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        let passed = modelled(&frame, 128, pcf, |map, seen| {
            let opacity = f64::from(opacity.unwrap_or(0.7));
            let own = seen.own.map(|own| seen.occluders[own].depth);
            let depth = nearest_depth(seen.depth, own, f64::from(map.values[2]));
            approximated_deep_shadow_map(seen.occluders, depth, opacity, f64::from(spacing))
        });
        let expected = image_of(&frame, size, &passed);
        let actual = draw(&mut device, &[&hair], &lights, size, frame.view);
        assert_close(
            &format!("approximated_deep_shadow_map pcf {pcf}"),
            &actual,
            &expected,
            MODEL[usize::from(pcf > 1)],
        );
    }
}

/// How far the mean may be from that of the light that truly reaches the hair's points, with opacity and spacing of the
/// library's own finding: 11 % above was measured with straight strands, and 18 % where α_s is said to be 0.2 of opaque fibres.
const BIAS: f64 = 0.2;

#[test]
fn spacing_and_opacity_found_from_the_groom_give_about_the_right_mean() {
    let Some(mut device) = device() else { return };
    let size = [164, 215];
    for (groom, strands, opacity) in [
        (BuiltinGroom::Straight, 2_000, 1.0),
        (BuiltinGroom::Curly, 500, 0.4),
    ] {
        let strands = builtin(groom, strands).unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        (hair.shading, hair.opacity) = (WHITE, opacity);
        let hairs = [&hair];
        let view = portrait(size);
        let mut drawn = |shadow| {
            let lights = [light(directional(DIRECTION), shadow)];
            draw(&mut device, &hairs, &lights, size, view)
        };
        let lit = drawn(Shadow::None);
        let settings = ApproximatedDeepShadowMap::default();
        let found = drawn(Shadow::ApproximatedDeepShadowMap(settings));
        let weaker = drawn(Shadow::ApproximatedDeepShadowMap(
            ApproximatedDeepShadowMap {
                opacity: Some(0.2),
                ..settings
            },
        ));
        let frame = Frame {
            hairs: &hairs,
            lights: &[light(directional(DIRECTION), Shadow::None)],
            ambient: Vec3::ZERO,
            view,
            transparency: OPAQUE,
        };
        let towards = Towards::Directional {
            towards: -DIRECTION,
        };
        // Three of 512 texels over 0.55 m; the disc of the same area.
        let expected = exact(&frame, size, towards, 0.0018);
        let mean = |image: &Image| image.pixels.iter().map(|p| p[0]).sum::<f64>();
        let rmse = |image: &Image| colour_error(image, &expected, None).rmse;
        let without = rmse(&lit);
        for (what, image) in [("found", &found), ("0.2", &weaker)] {
            let bias = mean(image) / mean(&expected);
            let error = rmse(image);
            eprintln!(
                "approximated_deep_shadow_map, {groom:?}, opacity {opacity}, α_s {what}: RMSE {error:.4} (no shadow: \
                 {without:.4}), mean {bias:.4} of exact"
            );
            assert!(error < 0.6 * without, "{groom:?}, α_s {what}: {error}");
            assert!((bias - 1.0).abs() < BIAS, "{groom:?}, α_s {what}: {bias}");
        }
    }
}
