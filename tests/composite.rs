//! The composite into the host's colour and depth.

use pelage::glam::{DVec3, Vec3, Vec4};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::host::offscreen::Image as Held;
use pelage::raster::Raster;
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::transparency::{Opaque, Storage, Transparency};
use pelage::{Frame, Hair, Light, LightKind, ShadowImage, Statistics, Target, View, wgpu};
use pelage_reference::composite::{Image, nearest_depth};

use crate::common::images::{
    FORMAT, Tolerance, assert_close, image, pixels, read, render, write_depth, write_failure,
};
use crate::common::scenes::{
    A_BUFFERS, WHITE, a_buffer, lists, pixel_view, portrait, reference, reversed, sunlight,
};
use crate::common::{Device, device};

const SIZE: [u32; 2] = [120, 157];
/// As of the A-buffer.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 1e-3,
    p99: 4e-3,
};
/// Depths of the near plane's end are steps of 6e-8; interpolation in f32 costs a few.
const DEPTH: f64 = 1e-6;

fn scene(device: &mut Device, opacity: f32) -> Hair {
    let strands = builtin(BuiltinGroom::Straight, 1_500).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = opacity;
    hair
}

fn lights() -> [Light; 1] {
    [sunlight()]
}

/// A target with an opaque scene of one colour at these depths.
fn target(device: &mut Device, size: [u32; 2], colour: Vec4, depths: &[f32]) -> Held {
    let held = device.create_image(size[0], size[1], FORMAT, true).unwrap();
    device
        .write_colour(&held.colour, &vec![colour; (size[0] * size[1]) as usize])
        .unwrap();
    write_depth(device, held.depth.as_ref().unwrap(), depths);
    held
}

fn draw(
    device: &mut Device,
    frame: &Frame,
    held: &Held,
    write_depth: bool,
    receive_shadow: bool,
) -> (Image, Statistics) {
    let depth = held.depth.as_ref();
    let target = Target {
        colour: &held.colour,
        depth,
        clear: false,
        write_depth,
        receive_shadow,
        ..Target::cleared(&held.colour)
    };
    let statistics = device.render(frame, &target).unwrap();
    (read(device, &held.colour), statistics)
}

/// A wall through the middle of the hair, slanted over the image.
fn wall(frame: &Frame) -> Vec<f32> {
    let depths: Vec<f64> = lists(frame, SIZE, None)
        .fragments
        .iter()
        .map(|fragment| fragment.depth)
        .collect();
    let (low, high) = depths
        .iter()
        .fold((1.0f64, 0.0f64), |(l, h), d| (l.min(*d), h.max(*d)));
    let pixel = |i: usize| low + (high - low) * (i % SIZE[0] as usize) as f64 / f64::from(SIZE[0]);
    (0..(SIZE[0] * SIZE[1]) as usize)
        .map(|i| pixel(i) as f32)
        .collect()
}

#[test]
fn the_opaque_scene_hides_the_hair_behind_it_and_no_other() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.5);
    let (hairs, lights) = ([&hair], lights());
    let mut frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    };
    let wall = wall(&frame);
    let expected = reference(&frame, SIZE, Some(&wall));
    let visible = lists(&frame, SIZE, Some(&wall)).fragments.len() as f64;
    let all = lists(&frame, SIZE, None).fragments.len() as f64;
    assert!(
        visible > 0.1 * all && visible < 0.9 * all,
        "the wall parts the hair"
    );
    for (name, storage, raster) in A_BUFFERS {
        frame.transparency = Some(a_buffer(storage, raster));
        let held = target(&mut device, SIZE, Vec4::ZERO, &wall);
        let (actual, statistics) = draw(&mut device, &frame, &held, false, false);
        assert_close(&format!("host depth {name}"), &actual, &expected, TOLERANCE);
        let fragments = statistics.fragments;
        assert_eq!(
            fragments.produced,
            fragments.stored + fragments.merged + fragments.culled,
            "{name}: {fragments:?}"
        );
        // Segments that are hidden as a whole produce no fragment, so that only a part of the hidden ones is counted.
        let stored = fragments.stored as f64 / visible - 1.0;
        assert!(
            stored.abs() < 5e-3,
            "{name}: {fragments:?}, {visible} visible"
        );
        assert!(
            (fragments.culled as f64) < all - visible,
            "{name}: {fragments:?}, {} hidden",
            all - visible
        );
    }
}

#[test]
fn reversed_depth_gives_the_same_image() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.5);
    let (hairs, lights) = ([&hair], lights());
    for transparency in [
        a_buffer(Storage::Counted, Raster::Walk),
        a_buffer(Storage::Lists, Raster::Ribbons),
        Transparency::Opaque(Opaque::default()),
    ] {
        let transparency = Some(transparency);
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency,
        };
        let wall = wall(&frame);
        let held = target(&mut device, SIZE, Vec4::ZERO, &wall);
        let (normal, _) = draw(&mut device, &frame, &held, true, false);
        let normal_depth = device.read_depth(held.depth.as_ref().unwrap()).unwrap();
        let turned: Vec<f32> = wall.iter().map(|depth| 1.0 - depth).collect();
        let held = target(&mut device, SIZE, Vec4::ZERO, &turned);
        let frame = Frame {
            view: reversed(&frame.view),
            ..frame
        };
        let (image, _) = draw(&mut device, &frame, &held, true, false);
        assert_close(
            &format!("reversed {transparency:?}"),
            &image,
            &normal,
            TOLERANCE,
        );
        let depth = device.read_depth(held.depth.as_ref().unwrap()).unwrap();
        let off = depth
            .iter()
            .zip(&normal_depth)
            .filter(|(r, n)| (1.0 - *r - *n).abs() > DEPTH as f32)
            .count();
        assert!(
            off * 1000 < depth.len(),
            "{transparency:?}: {off} depths differ"
        );
    }
}

#[test]
fn the_nearest_hairs_depth_is_written_and_the_scenes_kept() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.5);
    let (hairs, lights) = ([&hair], lights());
    let mut frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    };
    let wall = wall(&frame);
    let nearest = nearest_depth(&lists(&frame, SIZE, Some(&wall)));
    let expected: Vec<f64> = nearest
        .iter()
        .zip(&wall)
        .map(|(hair, wall)| hair.min(f64::from(*wall)))
        .collect();
    let mut techniques: Vec<Transparency> = A_BUFFERS
        .map(|(_, storage, raster)| a_buffer(storage, raster))
        .into();
    techniques.push(Transparency::Opaque(Opaque::default()));
    for technique in techniques {
        frame.transparency = Some(technique);
        let held = target(&mut device, SIZE, Vec4::ZERO, &wall);
        draw(&mut device, &frame, &held, true, false);
        let depth = device.read_depth(held.depth.as_ref().unwrap()).unwrap();
        let off: Vec<f64> = depth
            .iter()
            .zip(&expected)
            .map(|(a, e)| (f64::from(*a) - e).abs())
            .collect();
        // A sliver that f32 finds and f64 does not, or the other way round.
        let wrong = off.iter().filter(|off| **off > DEPTH).count();
        eprintln!("{technique:?}: {wrong} of {} depths differ", off.len());
        assert!(
            wrong * 1000 <= off.len(),
            "{technique:?}: {wrong} of {} depths differ",
            off.len()
        );
    }
}

#[test]
fn hair_is_laid_over_the_colour_that_is_there() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.5);
    let (hairs, lights) = ([&hair], lights());
    let transparency = Some(a_buffer(Storage::Counted, Raster::Walk));
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency,
    };
    let alone = reference(&frame, SIZE, None);
    let there = Vec4::new(3.0, 0.5, 0.125, 0.75);
    let over = |p: &[f64; 4]| std::array::from_fn(|c| p[c] + f64::from(there[c]) * (1.0 - p[3]));
    let expected = image(SIZE, alone.pixels.iter().map(over).collect());
    let held = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    device
        .write_colour(&held.colour, &vec![there; expected.pixels.len()])
        .unwrap();
    let (actual, _) = draw(&mut device, &frame, &held, false, false);
    assert_close(
        "over",
        &actual,
        &expected,
        Tolerance {
            rmse: 3e-3,
            p99: 12e-3,
        },
    );

    // Cleared first, nothing of it is left.
    device
        .render(&frame, &Target::cleared(&held.colour))
        .unwrap();
    let cleared = read(&mut device, &held.colour);
    assert_close("cleared", &cleared, &alone, TOLERANCE);
}

#[test]
fn a_half_float_target_takes_the_same_image() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.5);
    let (hairs, lights) = ([&hair], lights());
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    };
    let held = device
        .create_image(SIZE[0], SIZE[1], wgpu::TextureFormat::Rgba16Float, false)
        .unwrap();
    device
        .render(&frame, &Target::cleared(&held.colour))
        .unwrap();
    let actual = read(&mut device, &held.colour);
    assert_close(
        "half floats",
        &actual,
        &reference(&frame, SIZE, None),
        TOLERANCE,
    );
    // What is written is read back.
    let written = pixels(&actual);
    device.write_colour(&held.colour, &written).unwrap();
    assert_eq!(device.read_colour(&held.colour).unwrap(), written);
}

/// A mat of parallel strands over the left half of a wall that faces the eye and the light; it covers 0.8 of itself,
/// and its pitch of 0.9 meets pixels at every phase.
fn mat(device: &mut Device, opacity: f32) -> Hair {
    let y = |i: i32| 0.9 * (i as f32 - 22.0);
    let points = (0..45)
        .flat_map(|i| [[-30.0, y(i), 0.0], [-2.0, y(i), 0.0]])
        .collect();
    let strands = Strands::new(points, &[2; 45], 0.36).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = opacity;
    hair.shading = WHITE;
    hair
}

#[test]
fn the_opaque_scene_receives_the_hairs_shadow_where_there_is_one() {
    let Some(mut device) = device() else { return };
    let size = [64, 64];
    let hair = mat(&mut device, 0.5);
    let hairs = [&hair];
    // The shadow falls 4 units to the right per 8 units of depth: the wall lies 8 behind the hair.
    let shadow = Some(Shadow::DeepOpacityMap(DeepOpacityMap {
        resolution: 256,
        depth: 1.0,
        ..Default::default()
    }));
    let slanted = Light {
        shadow,
        ..Light::directional(DVec3::new(0.5, 0.0, -1.0), Vec3::ONE)
    };
    let depth = |z: f64| ((16.0 - z) / 32.0) as f32;
    let wall = vec![depth(-8.0); 64 * 64];
    let transparency = Some(a_buffer(Storage::Counted, Raster::Walk));
    let view: View = pixel_view(size, 16.0);
    let frame = Frame {
        hairs: &hairs,
        lights: &[slanted],
        ambient: Vec3::ZERO,
        view,
        transparency,
    };
    let grey = Vec4::new(0.5, 0.5, 0.5, 1.0);
    let mut draw_with = |receive: bool| {
        let held = target(&mut device, size, grey, &wall);
        draw(&mut device, &frame, &held, false, receive).0
    };
    let (lit, shadowed) = (draw_with(false), draw_with(true));
    let mut inside = Vec::new();
    for (i, (lit, shadowed)) in lit.pixels.iter().zip(&shadowed.pixels).enumerate() {
        let (x, y) = (i % 64, i / 64);
        assert_eq!(lit[3], shadowed[3], "alpha at {x}, {y}");
        let ratio = shadowed[0] / lit[0];
        assert!(ratio <= 1.0 + 1e-6, "brighter at {x}, {y}: {ratio}");
        // The mat covers x from 2 to 30, y from 12 to 52; its shadow x from 6 to 34.
        if x > 38 || !(8..=56).contains(&y) {
            assert!(ratio > 1.0 - 1e-6, "darkened at {x}, {y}: {ratio}");
        }
        if (31..33).contains(&x) && (16..48).contains(&y) {
            inside.push(ratio);
        }
    }
    // Fibres that cover 0.8, half opaque, seen by the light at full pitch.
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    // The filter of a third of the pitch lies between what a fibre lets through, 0.5, and a gap, 1.
    if !(0.5..0.9).contains(&mean) {
        write_failure("receive", &shadowed, &lit);
        panic!("the shadow lets {mean} of the light through, not between 0.5 and 0.9");
    }

    // Ambient light is not shadowed: with as much of it as of the light's, the shadow is half as deep.
    let frame = Frame {
        ambient: Vec3::ONE,
        ..frame
    };
    let held = target(&mut device, size, grey, &wall);
    let (with_ambient, _) = draw(&mut device, &frame, &held, false, true);
    let at = 32 * 64 + 32;
    let part = (lit.pixels[at][0] - with_ambient.pixels[at][0])
        / (lit.pixels[at][0] - shadowed.pixels[at][0]);
    assert!((part - 0.5).abs() < 1e-3, "{part} of the shadow is left");
}

#[test]
fn what_lies_at_the_far_plane_receives_no_shadow() {
    let Some(mut device) = device() else { return };
    let size = [64, 64];
    let hair = mat(&mut device, 1.0);
    let hairs = [&hair];
    let frame = Frame {
        hairs: &hairs,
        lights: &[Light::directional(DVec3::NEG_Z, Vec3::ONE)],
        ambient: Vec3::ZERO,
        view: pixel_view(size, 16.0),
        transparency: None,
    };
    let grey = Vec4::new(0.5, 0.5, 0.5, 1.0);
    let [with, without] = [true, false].map(|receive| {
        let held = target(&mut device, size, grey, &[1.0; 64 * 64]);
        draw(&mut device, &frame, &held, false, receive).0
    });
    assert_eq!(with, without);
    let (bare, _) = render(&mut device, &frame, size);
    assert_eq!(bare.pixels.len(), with.pixels.len());
}

/// Both look the same map up by the same functions: half floats are left.
const SAME_SHADOW: f32 = 1e-3;

#[test]
fn the_shadow_is_received_wherever_a_shadow_image_has_it() {
    let Some(mut device) = device() else { return };
    let hair = scene(&mut device, 0.6);
    let hairs = [&hair];
    // Steps of scenery from before the hair to far behind it, with holes through which there is none.
    let depths: Vec<f32> = (0..SIZE[0] * SIZE[1])
        .map(|i| {
            let [x, y] = [i % SIZE[0], i / SIZE[0]];
            let distance = 0.6 + 0.25 * f64::from((x / 13 + y / 17) % 9);
            let hole = (40..90).contains(&x) && (64..100).contains(&y);
            let depth = 10.0 / 9.9 * (1.0 - 0.1 / distance);
            if hole { 1.0 } else { depth as f32 }
        })
        .collect();
    let shadow = Some(Shadow::DeepOpacityMap(DeepOpacityMap {
        pcf: 1,
        ..Default::default()
    }));
    let white = Vec3::ONE;
    let (above, inside) = (DVec3::new(0.1, 0.5, 0.4), DVec3::new(0.02, 0.0, 0.15));
    for light in [
        Light::directional(DVec3::new(-0.5, -0.6, -0.7), white),
        Light::directional(DVec3::new(0.9, 0.1, -0.2), white),
        Light::point(above, white),
        Light::spot(above, DVec3::new(-0.1, -0.6, -0.5), white, [0.3, 0.4]),
        Light::point(inside, white),
    ] {
        let lights = [Light { shadow, ..light }];
        for reverse in [false, true] {
            let view = portrait(SIZE);
            let frame = Frame {
                hairs: &hairs,
                lights: &lights,
                ambient: Vec3::ZERO,
                view: if reverse { reversed(&view) } else { view },
                transparency: None,
            };
            let depths: Vec<f32> = depths
                .iter()
                .map(|depth| if reverse { 1.0 - depth } else { *depth })
                .collect();
            let held = target(&mut device, SIZE, Vec3::ONE.extend(0.0), &depths);
            let format = wgpu::TextureFormat::Rgba16Float;
            let image = device
                .create_image(SIZE[0], SIZE[1], format, false)
                .unwrap();
            let wanted = [ShadowImage {
                light: 0,
                image: &image.colour,
                subresource: Default::default(),
            }];
            let target = Target {
                depth: held.depth.as_ref(),
                clear: false,
                receive_shadow: true,
                shadow_images: &wanted,
                ..Target::cleared(&held.colour)
            };
            device.render(&frame, &target).unwrap();
            let expected = device.read_colour(&image.colour).unwrap();
            let actual = device.read_colour(&held.colour).unwrap();
            let mut shadowed = [0, 0];
            for (i, (a, e)) in actual.iter().zip(&expected).enumerate() {
                // Where there is no hair the scene is seen. What a spot does not light has no shadow to receive.
                if a.w > 0.0 || matches!(light.kind, LightKind::Spot { .. }) && a.x == 1.0 {
                    continue;
                }
                shadowed[usize::from(e.x < 0.9)] += 1;
                assert!(
                    (a.x - e.x).abs() <= SAME_SHADOW,
                    "{light:?}, reversed {reverse}: pixel {i} has {a} for {e}"
                );
            }
            assert!(
                shadowed[0] > 100 && shadowed[1] > 100,
                "{light:?}: {shadowed:?}"
            );
        }
    }
}
