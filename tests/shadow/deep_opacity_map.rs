//! The deep opacity map, by the radiance of white diffuse fibres, against exact transmittance.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::raster::Raster;
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::{Frame, Light, LightKind};
use pelage_reference::composite::Image;
use pelage_reference::error::{ImageError, colour_error};
use pelage_reference::transmittance::Light as Towards;

use crate::common::images::{Tolerance, assert_close, image};
use crate::common::scenes::{WHITE, pixel_view, portrait, unshadowed};
use crate::common::{Device, device};

use super::support::{HALF_FLOATS, OPAQUE, directional, draw, exact};

fn shadowed(kind: LightKind, settings: DeepOpacityMap) -> Light {
    Light {
        kind,
        shadow: Some(Shadow::DeepOpacityMap(settings)),
    }
}

#[test]
fn the_error_falls_or_stays_with_the_number_of_layers() {
    let Some(mut device) = device() else { return };
    let size = [164, 215];
    let strands = builtin(BuiltinGroom::Straight, 2_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    let direction = DVec3::new(-0.4, -0.7, -0.6);
    for opacity in [1.0, 0.3] {
        hair.opacity = opacity;
        let hairs = [&hair];
        let lights = [unshadowed(direction, Vec3::ONE)];
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: OPAQUE,
        };
        // The hair's extent is about 0.55 m: one of 512 texels is 1.1 mm wide; the disc of the same area.
        let expected = exact(
            &frame,
            size,
            Towards::Directional {
                towards: -direction,
            },
            0.0011 / std::f64::consts::PI.sqrt(),
        );
        let lit = draw(&mut device, &hairs, &lights, size, frame.view);
        let unshadowed = colour_error(&lit, &expected, None);
        let errors: Vec<ImageError> = [2, 4, 8, 16, 32]
            .into_iter()
            .map(|layers| {
                let light = shadowed(directional(direction), DeepOpacityMap { layers, ..Default::default() });
                let actual = draw(&mut device, &hairs, &[light], size, frame.view);
                let error = colour_error(&actual, &expected, None);
                let mean = |image: &Image| image.pixels.iter().map(|p| p[0]).sum::<f64>();
                eprintln!(
                    "deep_opacity_map, opacity {opacity}, K = {layers}: RMSE {:.4}, p99 {:.4}, mean {:.4} of exact (no shadow: RMSE {:.4})",
                    error.rmse, error.p99, mean(&actual) / mean(&expected), unshadowed.rmse
                );
                error
            })
            .collect();
        // Where boundaries fall among the hair counts too: four times the layers, not twice, are sure to be no worse.
        for (more, fewer) in errors.iter().skip(2).zip(&errors) {
            assert!(
                more.rmse <= fewer.rmse * 1.05,
                "opacity {opacity}: {} after {}",
                more.rmse,
                fewer.rmse
            );
        }
        assert!(
            errors[4].rmse < 0.7 * errors[0].rmse,
            "opacity {opacity}: {errors:?}"
        );
        assert!(
            errors[2].rmse < 0.5 * unshadowed.rmse,
            "opacity {opacity}: {:?}",
            errors[2]
        );
    }
}

fn check_maps(name: &str, kind: LightKind) {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Wavy, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    hair.opacity = 0.7;
    let images = [Raster::Walk, Raster::Ribbons].map(|raster| {
        let light = shadowed(
            kind,
            DeepOpacityMap {
                resolution: 128,
                raster,
                ..Default::default()
            },
        );
        draw(&mut device, &[&hair], &[light], size, portrait(size))
    });
    assert_close(
        name,
        &images[1],
        &images[0],
        Tolerance {
            rmse: 1e-3,
            p99: 1e-3,
        },
    );
}

#[test]
fn both_rasterisers_fill_the_same_map_of_a_directional_light() {
    check_maps("directional map", directional(DVec3::new(-0.4, -0.8, -0.5)));
}

#[test]
fn both_rasterisers_fill_the_same_map_of_a_point_light() {
    let kind = LightKind::Point {
        position: DVec3::new(0.4, 0.6, 0.5),
        intensity: Vec3::splat(0.5),
    };
    check_maps("point map", kind);
}

#[test]
fn both_rasterisers_fill_the_same_maps_of_a_light_among_the_hair() {
    let kind = LightKind::Point {
        position: DVec3::new(0.0, 0.05, 0.0),
        intensity: Vec3::splat(0.02),
    };
    check_maps("cube map", kind);
}

/// Too small a map sees fibres wider than they are. By either rasteriser, the whole light that hair sends to the eye is that of exact shadows, within this part.
const CUBE: f64 = 0.25;

#[test]
fn a_light_among_the_hair_is_shadowed_about_exactly() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Wavy, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.7);
    let hairs = [&hair];
    let position = DVec3::new(0.0, 0.05, 0.0);
    let kind = LightKind::Point {
        position,
        intensity: Vec3::splat(0.02),
    };
    let lights = [Light {
        kind,
        shadow: Some(Shadow::None),
    }];
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(size),
        transparency: OPAQUE,
    };
    let sum = |image: &Image| image.pixels.iter().map(|p| p[0]).sum::<f64>();
    let expected = sum(&exact(&frame, size, Towards::Point { position }, 0.001));
    let lit = sum(&draw(&mut device, &hairs, &lights, size, frame.view));
    let sums = [Raster::Walk, Raster::Ribbons].map(|raster| {
        let light = shadowed(
            kind,
            DeepOpacityMap {
                resolution: 256,
                layers: 16,
                raster,
                ..Default::default()
            },
        );
        sum(&draw(&mut device, &hairs, &[light], size, frame.view))
    });
    eprintln!(
        "among the hair: exact {expected}, unshadowed {lit}, walk {}, ribbons {}",
        sums[0], sums[1]
    );
    for (raster, sum) in [Raster::Walk, Raster::Ribbons].into_iter().zip(sums) {
        assert!(
            (sum / expected - 1.0).abs() < CUBE,
            "{raster:?}: {sum}, exact {expected}, unshadowed {lit}"
        );
    }
}

/// The part of a lone straight strand's light that its own map leaves, at an angle to the light's way.
fn left_of_a_lone_strand(device: &mut Device, radius: f32, angle: f64) -> f64 {
    let size = [64, 64];
    let view = pixel_view(size, 100.0);
    let points = (0..17).map(|i| [2.5 * i as f32 - 20.0, 0.3, 0.0]).collect();
    let mut hair = device
        .renderer
        .create_hair(&Strands::new(points, &[17], radius).unwrap())
        .unwrap();
    hair.shading = WHITE;
    let (sin, cos) = angle.to_radians().sin_cos();
    let kind = directional(DVec3::new(cos, 0.0, -sin));
    let lit = draw(
        device,
        &[&hair],
        &[Light {
            kind,
            shadow: Some(Shadow::None),
        }],
        size,
        view,
    );
    let image = draw(
        device,
        &[&hair],
        &[shadowed(kind, DeepOpacityMap::default())],
        size,
        view,
    );
    let sum = |image: &Image| image.pixels.iter().map(|p| p[0]).sum::<f64>();
    let left = sum(&image) / sum(&lit);
    eprintln!("lone strand, radius {radius}, at {angle}° to the light: {left:.4} of its light");
    left
}

#[test]
fn a_lone_strand_does_not_shadow_itself() {
    let Some(mut device) = device() else { return };
    for radius in [0.01, 0.1, 0.5] {
        for angle in [90.0, 75.0, 60.0] {
            let left = left_of_a_lone_strand(&mut device, radius, angle);
            assert!(
                left > 0.98,
                "radius {radius}, at {angle}° to the light: {left} of its light is left"
            );
        }
    }
}

/// Its neighbour texels lie nearer to the light by more than the bias of half a texel.
#[test]
fn a_lone_strand_along_the_light_does_not_shadow_itself() {
    let Some(mut device) = device() else { return };
    let angles = [45.0, 30.0, 10.0];
    let least = angles
        .map(|angle| left_of_a_lone_strand(&mut device, 0.01, angle))
        .into_iter()
        .fold(1.0, f64::min);
    assert!(least > 0.98, "{least} of its light is left");
}

#[test]
fn point_lights_inside_and_outside_the_hair_are_finite() {
    let Some(mut device) = device() else { return };
    let size = [41, 54];
    let strands = builtin(BuiltinGroom::Straight, 500).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    let on_a_point = Vec3::from(strands.points()[200]).as_dvec3();
    for position in [
        DVec3::ZERO,
        on_a_point,
        DVec3::new(0.0, 0.3, 0.1),
        DVec3::new(0.3, 0.3, 0.3),
        DVec3::new(30.0, 10.0, 5.0),
        DVec3::new(0.0, 1e6, 0.0),
    ] {
        let kind = LightKind::Point {
            position,
            intensity: Vec3::splat(0.1),
        };
        let view = portrait(size);
        let lit = draw(
            &mut device,
            &[&hair],
            &[Light {
                kind,
                shadow: Some(Shadow::None),
            }],
            size,
            view,
        );
        let light = shadowed(
            kind,
            DeepOpacityMap {
                resolution: 64,
                ..Default::default()
            },
        );
        let image = draw(&mut device, &[&hair], &[light], size, view);
        for (shadowed, lit) in image.pixels.iter().zip(&lit.pixels) {
            assert!(
                shadowed.iter().all(|v| v.is_finite()),
                "{position}: {shadowed:?}"
            );
            let most = lit[0] * (1.0 + HALF_FLOATS) + 1e-6;
            assert!(
                shadowed[0] >= 0.0 && shadowed[0] <= most,
                "{position}: {shadowed:?}, unshadowed {lit:?}"
            );
        }
    }
}

#[test]
fn several_lights_add_up() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Straight, 500).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    let settings = DeepOpacityMap {
        resolution: 128,
        ..Default::default()
    };
    let lights = [
        shadowed(directional(DVec3::new(-0.4, -0.8, -0.5)), settings),
        shadowed(
            directional(DVec3::new(0.9, -0.1, -0.5)),
            DeepOpacityMap {
                layers: 3,
                ..settings
            },
        ),
        unshadowed(DVec3::Z, Vec3::new(0.1, 0.2, 0.3)),
        shadowed(
            LightKind::Point {
                position: DVec3::new(0.6, 0.2, 0.4),
                intensity: Vec3::splat(0.3),
            },
            settings,
        ),
        shadowed(
            LightKind::Point {
                position: DVec3::ZERO,
                intensity: Vec3::splat(0.01),
            },
            settings,
        ),
    ];
    let view = portrait(size);
    let together = draw(&mut device, &[&hair], &lights, size, view);
    let mut sum = vec![[0.0; 4]; together.pixels.len()];
    for light in lights {
        let alone = draw(&mut device, &[&hair], &[light], size, view);
        for (sum, pixel) in sum.iter_mut().zip(&alone.pixels) {
            *sum = [
                sum[0] + pixel[0],
                sum[1] + pixel[1],
                sum[2] + pixel[2],
                pixel[3],
            ];
        }
    }
    // Six roundings to 16-bit floats, of values up to 2.
    assert_close(
        "lights",
        &together,
        &image(size, sum),
        Tolerance {
            rmse: 2e-3,
            p99: 4e-3,
        },
    );
}
