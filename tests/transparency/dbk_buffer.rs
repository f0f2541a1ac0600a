//! The DBK-buffer against the reference: the bound that it promises, and how little it stores.

use pelage::glam::Vec3;
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::raster::Raster;
use pelage::transparency::a_buffer::FRAGMENT_BYTES;
use pelage::transparency::{ABuffer, Culling, DbkBuffer, Transparency};
use pelage::{Frame, Hair, Light, Target, Viewport, wgpu};
use pelage_reference::composite::{self, Image};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::common::images::{assert_identical, pixels, read, render, write_failure};
use crate::common::scenes::{lists, pixel_view, point_radiance, portrait, reversed, sunlight};
use crate::common::{Device, device};

const SIZE: [u32; 2] = [164, 215];
/// The exact image is the A-buffer's, which has the same fragments and is held to the reference by its own tests. It stops
/// compositing at a transmittance of 1/4096.
const ROUNDING: f64 = 1.0 / 4096.0;

fn bounded(epsilon: f32, raster: Raster) -> Transparency {
    Transparency::DbkBuffer(DbkBuffer {
        culling: Culling::Always,
        epsilon,
        raster,
        ..DbkBuffer::default()
    })
}

fn frame<'a>(hairs: &'a [&'a Hair], lights: &'a [Light], transparency: Transparency) -> Frame<'a> {
    Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: Some(transparency),
    }
}

/// Asserts that no pixel is off by more than ε, of alpha and of the brightest fragment, and the rounding.
fn assert_bounded(name: &str, actual: &Image, expected: &Image, epsilon: f64, brightest: f64) {
    for (at, (a, e)) in actual.pixels.iter().zip(&expected.pixels).enumerate() {
        let alpha = (a[3] - e[3]).abs();
        let colour = (0..3).map(|c| (a[c] - e[c]).abs()).fold(0.0, f64::max);
        if alpha > epsilon + ROUNDING || colour > (epsilon + ROUNDING) * brightest {
            write_failure(name, actual, expected);
            panic!("{name}: pixel {at} is off by {alpha:.2e} in alpha and {colour:.2e} in colour");
        }
    }
}

fn brightest(frame: &Frame) -> f64 {
    let radiance = point_radiance(frame);
    radiance.iter().flatten().fold(0.0, |a: f64, b| a.max(*b))
}

#[test]
fn what_is_left_out_stays_within_the_tolerance_and_little_more_is_stored_than_that_asks_for() {
    let Some(mut device) = device() else { return };
    for groom in [BuiltinGroom::Straight, BuiltinGroom::Curly] {
        let strands = builtin(groom, 3_000).unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        for (opacity, epsilon) in [(1.0, 1.0 / 256.0), (0.9, 1.0 / 16.0), (0.6, 1.0 / 256.0)] {
            hair.opacity = opacity;
            let (hairs, lights) = ([&hair], [sunlight()]);
            let plain = frame(&hairs, &lights, Transparency::ABuffer(ABuffer::default()));
            let brightest = brightest(&plain);
            let (expected, all) = render(&mut device, &plain, SIZE);
            let lists = lists(&plain, SIZE, None);
            let fewest: usize =
                composite::fragments_needed(&lists, f64::from(opacity), f64::from(epsilon))
                    .iter()
                    .sum();
            for raster in [Raster::Walk, Raster::Ribbons] {
                let name = format!("dbk {} {opacity} {epsilon} {raster:?}", groom as u32);
                let cut = frame(&hairs, &lights, bounded(epsilon, raster));
                let (actual, statistics) = render(&mut device, &cut, SIZE);
                assert_bounded(&name, &actual, &expected, f64::from(epsilon), brightest);
                let (again, _) = render(&mut device, &cut, SIZE);
                assert_identical(&format!("{name} again"), &again, &actual);
                let counted = statistics.fragments;
                assert_eq!(counted.produced, all.fragments.produced, "{name}");
                assert_eq!(counted.stored + counted.culled, counted.produced, "{name}");
                assert_eq!(counted.merged, 0, "{name}");
                assert!(
                    counted.stored as f64 <= 1.6 * fewest as f64,
                    "{name}: {} stored, {fewest} needed",
                    counted.stored
                );
            }
        }
    }
}

#[test]
fn any_strands_stay_within_any_tolerance() {
    let Some(device) = device() else { return };
    let size = [24, 20];
    let strand = prop::collection::vec((-14.0f32..14.0, -12.0f32..12.0, -9.0f32..9.0), 2..5);
    let scene = (
        prop::collection::vec(strand, 1..60),
        0.02f32..6.0,
        0.05f32..=1.0,
        1e-4f32..0.5,
        any::<bool>(),
    );
    let device = std::cell::RefCell::new(device);
    TestRunner::new(Config {
        failure_persistence: None,
        ..Config::with_cases(48)
    })
    .run(&scene, |(strands, radius, opacity, epsilon, reverse)| {
        let mut device = device.borrow_mut();
        let counts: Vec<u32> = strands.iter().map(|strand| strand.len() as u32).collect();
        let points = strands
            .concat()
            .iter()
            .map(|&(x, y, z)| [x, y, z])
            .collect();
        let strands = Strands::new(points, &counts, radius).unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        hair.opacity = opacity;
        let (hairs, lights) = ([&hair], [sunlight()]);
        let mut drawn = frame(&hairs, &lights, bounded(epsilon, Raster::Auto));
        drawn.view = pixel_view(size, 10.0);
        if reverse {
            drawn.view = reversed(&drawn.view);
        }
        let (actual, _) = render(&mut device, &drawn, size);
        drawn.transparency = Some(Transparency::ABuffer(ABuffer::default()));
        let (expected, _) = render(&mut device, &drawn, size);
        let bright = brightest(&drawn);
        for (a, e) in actual.pixels.iter().zip(&expected.pixels) {
            let bound = f64::from(epsilon) + ROUNDING;
            prop_assert!((a[3] - e[3]).abs() <= bound, "alpha {} for {}", a[3], e[3]);
            for c in 0..3 {
                prop_assert!(
                    (a[c] - e[c]).abs() <= bound * bright,
                    "{} for {}",
                    a[c],
                    e[c]
                );
            }
        }
        Ok(())
    })
    .unwrap();
}

#[test]
fn where_culling_cannot_pay_it_is_the_a_buffer() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.05;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let of = |transparency| frame(&hairs, &lights, transparency);
    let (cut, statistics) = render(&mut device, &of(Transparency::default()), SIZE);
    let all = Transparency::ABuffer(ABuffer::default());
    let (whole, _) = render(&mut device, &of(all), SIZE);
    assert_identical("dbk, faint hair", &cut, &whole);
    assert_eq!(statistics.fragments.culled, 0);
}

/// The mean error of the guess at what is left out of the alpha: 2.1e-4 here, and 2.7e-3 without a guess.
const GUESSED: f64 = 5e-4;

#[test]
fn what_is_stored_but_not_composited_stays_within_the_tolerance_and_hardly_changes_alpha() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    for opacity in [0.3, 0.9] {
        hair.opacity = opacity;
        let (hairs, lights) = ([&hair], [sunlight()]);
        let of = |transparency| frame(&hairs, &lights, transparency);
        let (actual, statistics) = render(&mut device, &of(Transparency::default()), SIZE);
        assert_eq!(statistics.fragments.culled, 0);
        let all = of(Transparency::ABuffer(ABuffer::default()));
        let (expected, _) = render(&mut device, &all, SIZE);
        let name = format!("dbk, nothing culled, {opacity}");
        let epsilon = f64::from(DbkBuffer::default().epsilon);
        assert_bounded(&name, &actual, &expected, epsilon, brightest(&all));
        let dense = || {
            actual
                .pixels
                .iter()
                .zip(&expected.pixels)
                .filter(|(_, e)| e[3] > 1.0 - epsilon)
        };
        let mean = dense().map(|(a, e)| (a[3] - e[3]).abs()).sum::<f64>() / dense().count() as f64;
        eprintln!("{name}: {mean}");
        assert!(mean < GUESSED, "{name}: {mean}");
        let off = dense().map(|(a, e)| (a[0] - e[0]).abs()).sum::<f64>();
        let part = off / dense().map(|(_, e)| e[0]).sum::<f64>();
        eprintln!("{name}: {part} of the light");
        assert!(part < GUESSED, "{name}: {part} of the light");
    }
}

#[test]
fn thousands_of_fragments_in_a_pixel_run_over_no_count() {
    let Some(mut device) = device() else { return };
    // More than a bin's count holds, at one depth and at many, so faint that all are needed, and opaque.
    for (opacity, spread) in [(2e-4, 0.0), (2e-4, 8.0), (1.0, 0.0), (1.0, 8.0)] {
        let count = 5_000;
        let points = (0..count)
            .flat_map(|i| {
                let z = spread * (i as f32 / count as f32 - 0.5);
                [[-6.0, 0.3, z], [6.0, 0.3, z]]
            })
            .collect();
        let strands = Strands::new(points, &vec![2; count], 1.5).unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        hair.opacity = opacity;
        let (hairs, lights) = ([&hair], [sunlight()]);
        let mut drawn = frame(&hairs, &lights, bounded(0.25, Raster::Walk));
        let size = [16, 8];
        drawn.view = pixel_view(size, 10.0);
        // No estimate foresees that opaque fibres at one depth are all kept: the first frame's pool may be too small, and the
        // next one's is not.
        let (first, _) = render(&mut device, &drawn, size);
        let (actual, statistics) = render(&mut device, &drawn, size);
        drawn.transparency = Some(Transparency::ABuffer(ABuffer::default()));
        let (expected, _) = render(&mut device, &drawn, size);
        let name = format!("dbk thousands {opacity} {spread}");
        assert_bounded(&name, &first, &expected, 0.25, brightest(&drawn));
        assert_bounded(&name, &actual, &expected, 0.25, brightest(&drawn));
        let fragments = statistics.fragments;
        assert_eq!(fragments.stored + fragments.culled, fragments.produced);
    }
}

/// A pool of a part of what is needed: nothing is erased.
#[test]
fn a_small_pool_merges_what_it_cannot_hold() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.9;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let whole = bounded(DbkBuffer::default().epsilon, Raster::Auto);
    let whole = frame(&hairs, &lights, whole);
    let (expected, statistics) = render(&mut device, &whole, SIZE);
    for part in [0.01, 0.1, 0.5] {
        let bytes = (statistics.fragments.stored as f64 * part) as u64 * FRAGMENT_BYTES;
        let small = Transparency::DbkBuffer(DbkBuffer {
            pool_bytes: Some(bytes),
            ..DbkBuffer::default()
        });
        let (actual, small) = render(&mut device, &frame(&hairs, &lights, small), SIZE);
        let fragments = small.fragments;
        assert!(fragments.merged > 0 && fragments.stored * FRAGMENT_BYTES <= bytes);
        assert_eq!(
            fragments.stored + fragments.merged + fragments.culled,
            fragments.produced
        );
        // What lies behind ε is left out, but not where it was merged with what does not.
        let bound = f64::from(DbkBuffer::default().epsilon) + ROUNDING;
        for (a, e) in actual.pixels.iter().zip(&expected.pixels) {
            assert!(
                (a[3] - e[3]).abs() <= bound,
                "{part}: {} for {}",
                a[3],
                e[3]
            );
        }
    }
}

#[test]
fn where_most_is_culled_the_pool_is_small_from_the_first_frame_on() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 20_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.95;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let bounded = |culling| {
        let settings = DbkBuffer {
            culling,
            ..DbkBuffer::default()
        };
        frame(&hairs, &lights, Transparency::DbkBuffer(settings))
    };
    let viewport = Viewport {
        width: SIZE[0],
        height: SIZE[1],
        ..Viewport::default()
    };
    let [all, kept] = [Culling::Auto, Culling::Always].map(|culling| {
        let estimate = device
            .renderer
            .memory_estimate(&bounded(culling), &viewport);
        estimate.unwrap().of("pelage.transparency.fragments")
    });
    eprintln!("pool: {kept} bytes of {all}");
    assert!(kept * 10 < all * 7, "{kept} bytes of {all}");
    let (_, statistics) = render(&mut device, &bounded(Culling::Always), SIZE);
    let fragments = statistics.fragments;
    assert!(
        fragments.merged == 0 && fragments.culled > 0,
        "{fragments:?}"
    );
}

#[test]
fn a_depth_shift_draws_what_lies_beyond_as_one_layer() {
    let Some(mut device) = device() else { return };
    // Three walls of strands across the view, at depths 5, 2 and -5, each of its own brightness.
    let walls = [(5.0, 0.2), (2.0, 0.5), (-5.0, 0.9)];
    let points = walls
        .iter()
        .flat_map(|(z, _)| [[-20.0, 0.0, *z], [20.0, 0.0, *z]])
        .collect();
    let colours = walls.iter().map(|(_, grey)| [*grey; 3]).collect();
    let strands = Strands::new(points, &[2; 3], 6.0)
        .unwrap()
        .with_colours(colours)
        .unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.5;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let size = [16, 16];
    let mut drawn = frame(&hairs, &lights, Transparency::ABuffer(ABuffer::default()));
    drawn.view = pixel_view(size, 10.0);
    let radiance = point_radiance(&drawn);
    let by_shift = |shift| {
        Transparency::DbkBuffer(DbkBuffer {
            depth_shift: Some(shift),
            ..DbkBuffer::default()
        })
    };
    let mut middle = |transparency| {
        let frame = Frame {
            transparency: Some(transparency),
            ..drawn
        };
        let (image, statistics) = render(&mut device, &frame, size);
        (image.pixels[8 * 16 + 8], statistics.fragments)
    };
    let (whole, all) = middle(Transparency::ABuffer(ABuffer::default()));
    let (far, kept) = middle(by_shift(100.0));
    assert_eq!(far, whole);
    assert_eq!(kept.stored, all.stored);
    // Beyond a shift of 4: the last wall alone, so that one layer is exact.
    let (near, kept) = middle(by_shift(4.0));
    assert_eq!(kept.stored * 3, all.stored * 2);
    assert_eq!(kept.culled * 3, all.stored);
    for c in 0..4 {
        assert!((near[c] - whole[c]).abs() <= 1e-3, "{near:?} for {whole:?}");
    }
    // Beyond a shift of 0: two walls in the colour of the nearer one.
    let (none, kept) = middle(by_shift(0.0));
    assert_eq!(kept.stored * 3, all.stored);
    let [first, second] = [radiance[0][0], radiance[2][0]];
    let layer = 0.5 * first + 0.5 * 0.75 * second;
    assert!((none[0] - layer).abs() <= 2e-3, "{} for {layer}", none[0]);
    assert!((none[3] - 0.875).abs() <= 1e-3, "{}", none[3]);
}

#[test]
fn hair_behind_the_hosts_scene_counts_for_nothing() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let (hairs, lights) = ([&hair], [sunlight()]);
    for at in [0.0, 0.86, 1.0] {
        let depth = vec![at; (SIZE[0] * SIZE[1]) as usize];
        let mut image =
            |transparency| on_depth(&mut device, &frame(&hairs, &lights, transparency), &depth);
        let cut = image(bounded(1.0 / 256.0, Raster::Auto));
        let whole = image(Transparency::ABuffer(ABuffer::default()));
        for (a, e) in pixels(&cut).iter().zip(&pixels(&whole)) {
            let bound = 1.0 / 256.0 + ROUNDING as f32;
            assert!((a.w - e.w).abs() <= bound, "depth {at}: {a} for {e}");
        }
    }
}

/// Renders behind a host's depth.
fn on_depth(device: &mut Device, frame: &Frame, depth: &[f32]) -> Image {
    let image = device
        .create_image(SIZE[0], SIZE[1], wgpu::TextureFormat::Rgba32Float, true)
        .unwrap();
    let texture = image.depth.as_ref().unwrap();
    device.write_depth(texture, depth).unwrap();
    let target = Target {
        depth: Some(texture),
        ..Target::cleared(&image.colour)
    };
    device.render(frame, &target).unwrap();
    read(device, &image.colour)
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    for (settings, name) in [
        (
            DbkBuffer {
                epsilon: 0.0,
                ..Default::default()
            },
            "epsilon 0",
        ),
        (
            DbkBuffer {
                epsilon: f32::NAN,
                ..Default::default()
            },
            "epsilon NaN",
        ),
        (
            DbkBuffer {
                epsilon: 0.6,
                ..Default::default()
            },
            "epsilon 0.6",
        ),
        (
            DbkBuffer {
                depth_shift: Some(-1.0),
                ..Default::default()
            },
            "depth_shift -1",
        ),
        (
            DbkBuffer {
                depth_shift: Some(f32::INFINITY),
                ..Default::default()
            },
            "depth_shift inf",
        ),
        (
            DbkBuffer {
                pool_bytes: Some(3),
                ..Default::default()
            },
            "pool_bytes 3",
        ),
    ] {
        let error = Transparency::DbkBuffer(settings).validate().unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}
