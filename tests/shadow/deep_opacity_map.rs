//! The deep opacity map, by the radiance of white diffuse fibres, against exact transmittance.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::raster::Raster;
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::transparency::{Opaque, Transparency};
use pelage::{Frame, Hair, Light, LightKind};
use pelage_reference::composite::{self, Image};
use pelage_reference::error::{ImageError, colour_error};
use pelage_reference::transmittance::{Light as Towards, Occluders, Query};

use crate::common::images::{Tolerance, assert_close, image, render};
use crate::common::scenes::{
    WHITE, lists, pixel_view, point_radiance, portrait, unshadowed, world,
};
use crate::common::{Device, device};

const OPAQUE: Option<Transparency> = Some(Transparency::Opaque(Opaque {
    raster: Raster::Auto,
}));
/// Two 16-bit floats and their interpolation.
const HALF_FLOATS: f64 = 2e-3;

fn shadowed(kind: LightKind, settings: DeepOpacityMap) -> Light {
    Light {
        kind,
        shadow: Some(Shadow::DeepOpacityMap(settings)),
    }
}

fn directional(direction: DVec3) -> LightKind {
    LightKind::Directional {
        direction,
        irradiance: Vec3::ONE,
    }
}

fn draw(
    device: &mut Device,
    hairs: &[&Hair],
    lights: &[Light],
    size: [u32; 2],
    view: pelage::View,
) -> Image {
    let frame = Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view,
        transparency: OPAQUE,
    };
    render(device, &frame, size).0
}

/// Shadowed over unshadowed red where hair is opaque enough to tell.
fn ratios(shadowed: &Image, lit: &Image) -> Vec<f64> {
    let seen = |(_, lit): &(&[f64; 4], &[f64; 4])| lit[0] > 0.02;
    shadowed
        .pixels
        .iter()
        .zip(&lit.pixels)
        .filter(seen)
        .map(|(shadowed, lit)| shadowed[0] / lit[0])
        .collect()
}

#[test]
fn transmittance_lies_between_0_and_1() {
    let Some(mut device) = device() else { return };
    let size = [82, 107];
    let strands = builtin(BuiltinGroom::Curly, 1_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    for opacity in [1.0, 0.4] {
        hair.opacity = opacity;
        for kind in [
            directional(DVec3::new(-0.4, -0.8, -0.5)),
            LightKind::Point {
                position: DVec3::new(0.5, 0.8, 0.9),
                intensity: Vec3::ONE,
            },
        ] {
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
            for pcf in [1, 3, 5] {
                let light = shadowed(
                    kind,
                    DeepOpacityMap {
                        resolution: 128,
                        pcf,
                        ..Default::default()
                    },
                );
                let image = draw(&mut device, &[&hair], &[light], size, view);
                let ratios = ratios(&image, &lit);
                let (low, high) = ratios
                    .iter()
                    .fold((1.0f64, 0.0f64), |(l, h), r| (l.min(*r), h.max(*r)));
                assert!(
                    low >= 0.0 && high <= 1.0 + HALF_FLOATS,
                    "{kind:?} pcf {pcf}: {low} to {high}"
                );
                assert!(low < 0.5, "{kind:?} pcf {pcf}: no shadow at all");
            }
        }
    }
}

/// `layers` mats of strands in front of a probe strand, towards +z.
fn mats(layers: usize) -> Strands {
    let mut points = vec![[-20.0, 0.3, -10.0], [20.0, 0.3, -10.0]];
    for layer in 0..layers {
        for i in 0..40 {
            let y = i as f32 - 20.0 + 0.37 * layer as f32;
            points.extend([[-20.0, y, layer as f32], [20.0, y, layer as f32]]);
        }
    }
    let counts = vec![2; points.len() / 2];
    Strands::new(points, &counts, 0.2).unwrap()
}

#[test]
fn more_hair_in_front_never_brightens() {
    let Some(mut device) = device() else { return };
    let size = [32, 32];
    // Seen from the side, so that nothing hides the probe.
    let mut view = pixel_view(size, 100.0);
    view.view_from_world = pelage_reference::scene::look_at(
        DVec3::new(0.0, -100.0, -10.0),
        DVec3::new(0.0, 0.0, -10.0),
        DVec3::Z,
    );
    let mut last = f64::INFINITY;
    for layers in 0..8 {
        let strands = mats(layers);
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        hair.shading = WHITE;
        hair.opacity = 0.5;
        let light = shadowed(
            directional(DVec3::NEG_Z),
            DeepOpacityMap {
                resolution: 256,
                pcf: 5,
                ..Default::default()
            },
        );
        let image = draw(&mut device, &[&hair], &[light], size, view);
        // The probe lies in the image's middle row.
        let probe: f64 = (12..20)
            .flat_map(|x| [15, 16].map(|y| image.pixels[y * 32 + x][0]))
            .sum();
        eprintln!("{layers} mats in front: {probe:.4}");
        assert!(
            probe > 0.0 && probe <= last,
            "{layers} mats: {probe} after {last}"
        );
        last = probe;
    }
}

/// The frame as it would be with exact transmittance at every strand point, averaged over the filter's footprint.
fn exact(frame: &Frame, size: [u32; 2], light: Towards, footprint: f64) -> Image {
    let world = world(frame.hairs);
    let occluders = Occluders::new(&world.strands);
    let alpha = f64::from(frame.hairs[0].opacity);
    let query = Query {
        light,
        alpha,
        footprint,
        samples: 32,
    };
    let mut points = Vec::new();
    for strand in 0..world.strands.len() {
        let range = world.strands.range(strand);
        points.extend(
            range
                .clone()
                .map(|at| (world.strands.points[at], Some(at.min(range.end - 2)))),
        );
    }
    let passed = occluders.transmittances(&points, &query);
    let colours: Vec<[f64; 3]> = point_radiance(frame)
        .iter()
        .zip(passed)
        .map(|(colour, passed)| colour.map(|c| c * passed))
        .collect();
    composite::opaque(
        &lists(frame, size, None),
        alpha,
        composite::point_colours(&colours),
    )
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
        for (more, fewer) in errors.iter().skip(1).zip(&errors) {
            // Where the filter's own error is all that is left, it wavers.
            assert!(
                more.rmse <= fewer.rmse * 1.02,
                "opacity {opacity}: {} after {}",
                more.rmse,
                fewer.rmse
            );
        }
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

#[test]
fn hair_of_opacity_0_casts_no_shadow() {
    let Some(mut device) = device() else { return };
    let size = [32, 32];
    let view = pixel_view(size, 100.0);
    let create = |device: &mut Device, z: f32, opacity: f32| {
        let points = (0..16)
            .flat_map(|i| [[-14.0, i as f32 - 8.0, z], [14.0, i as f32 - 8.0, z]])
            .collect();
        let mut hair = device
            .renderer
            .create_hair(&Strands::new(points, &[2; 16], 0.4).unwrap())
            .unwrap();
        (hair.shading, hair.opacity) = (WHITE, opacity);
        hair
    };
    let (behind, before) = (
        create(&mut device, -5.0, 1.0),
        create(&mut device, 5.0, 0.0),
    );
    let light = shadowed(
        directional(DVec3::NEG_Z),
        DeepOpacityMap {
            resolution: 128,
            ..Default::default()
        },
    );
    let lit = draw(
        &mut device,
        &[&behind],
        &[unshadowed(DVec3::NEG_Z, Vec3::ONE)],
        size,
        view,
    );
    let image = draw(&mut device, &[&before, &behind], &[light], size, view);
    assert_close(
        "opacity 0",
        &image,
        &lit,
        Tolerance {
            rmse: 1e-3,
            p99: 1e-3,
        },
    );
    // The test can fail: light from the other side meets the opaque hair first.
    let half = create(&mut device, 5.0, 0.5);
    let light = Light {
        kind: directional(DVec3::Z),
        ..light
    };
    let lit = draw(
        &mut device,
        &[&half, &behind],
        &[unshadowed(DVec3::Z, Vec3::ONE)],
        size,
        view,
    );
    let image = draw(&mut device, &[&half, &behind], &[light], size, view);
    assert!(ratios(&image, &lit).iter().any(|ratio| *ratio < 0.8));
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
