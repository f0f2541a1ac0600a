//! Sorted blending: exact where every segment of a pixel has a bin of its own, and near it where bins are fine.

use pelage::glam::{DMat4, DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::host::offscreen::Offscreen;
use pelage::transparency::{BlendOrder, SortedBlending, Transparency};
use pelage::wgpu::{self, Limits};
use pelage::{Error, Frame, Hair, Instance, Result, Target};
use pelage_reference::blending;
use pelage_reference::composite::point_colours;
use pelage_reference::error::{alpha_error, colour_error};

use super::{extent, portrait_distance};
use crate::common::images::{FORMAT, Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{
    WHITE, World, lists, pixel_view, point_radiance, portrait, reference, sunlight, unshadowed,
    world,
};
use crate::common::{Device, device};
use crate::limits::{least, open};

/// 32-bit floats: as of the A-buffer.
const FULL: Tolerance = Tolerance {
    rmse: 1e-3,
    p99: 4e-3,
};
const SIZE: [u32; 2] = [164, 215];

fn technique(settings: SortedBlending) -> Option<Transparency> {
    Some(Transparency::SortedBlending(settings))
}

const ORDERS: [BlendOrder; 2] = [BlendOrder::BackToFront, BlendOrder::FrontToBack];

/// Forty strands behind one another, in hashed order and colours, of two hairs.
fn pile(device: &mut Device) -> [Hair; 2] {
    [0, 1].map(|hair| {
        let of = |i: u32| (i * 17 + 5) % 40;
        let mine: Vec<u32> = (0..40).map(of).filter(|i| i % 2 == hair).collect();
        let points = mine.iter().flat_map(|&i| {
            let z = 30.0 - 1.5 * i as f32;
            [
                [-6.0, 0.3 * i as f32 - 6.0, z],
                [6.0, 6.0 - 0.3 * i as f32, z],
            ]
        });
        let colours = mine
            .iter()
            .map(|&i| [i as f32 / 40.0, (i % 7) as f32 / 6.0, 1.0 - i as f32 / 40.0])
            .collect();
        let strands = Strands::new(points.collect(), &[2; 20], 0.9)
            .unwrap()
            .with_colours(colours)
            .unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        (hair.shading, hair.opacity) = (WHITE, 0.3);
        hair
    })
}

#[test]
fn a_bin_for_each_segment_is_the_exact_order_across_hairs() {
    let Some(mut device) = device() else { return };
    let hairs = pile(&mut device);
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let size = [16, 16];
    let hairs = [&hairs[0], &hairs[1]];
    let mut frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(size, 64.0),
        transparency: None,
    };
    let expected = reference(&frame, size, None);
    for order in ORDERS {
        for full_precision in [true, false] {
            frame.transparency = technique(SortedBlending {
                order,
                full_precision,
                ..Default::default()
            });
            let (actual, _) = render(&mut device, &frame, size);
            let name = format!("pile {order:?}, full precision {full_precision}");
            // Half floats: 40 roundings of at most 2.4e-4.
            let tolerance = if full_precision { FULL } else { HALF };
            assert_close(&name, &actual, &expected, tolerance);
            let (again, _) = render(&mut device, &frame, size);
            assert_identical(&name, &again, &actual);
        }
    }
    // One bin has an order too, and a wrong one.
    frame.transparency = technique(SortedBlending {
        bins: 1,
        ..Default::default()
    });
    let (wrong, _) = render(&mut device, &frame, size);
    let (colour, alpha) = (
        colour_error(&wrong, &expected, None),
        alpha_error(&wrong, &expected, None),
    );
    assert!(colour.rmse > 0.02 && alpha.rmse < HALF.rmse, "{colour:?}");
}

/// Roundings of half floats to values below 1: half a step of 4.9e-4 each; measured.
const HALF: Tolerance = Tolerance {
    rmse: 2e-3,
    p99: 6e-3,
};

/// The bin of every segment of a groom, by its first point.
fn bins_of(world: &World, view: &pelage::View, extremes: [f64; 2], bins: usize) -> Vec<usize> {
    let distance = |at: usize| {
        -view
            .view_from_world
            .transform_point3(world.strands.points[at])
            .z
    };
    let count = world.strands.points.len();
    (0..count)
        .map(|at| {
            let next = (at + 1).min(count - 1);
            blending::bin_of([distance(at), distance(next)], extremes, bins)
        })
        .collect()
}

#[test]
fn finer_bins_come_nearer_to_the_exact_composite() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.3;
    let hairs = [&hair];
    let lights = [sunlight()];
    let mut frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    };
    let exact = reference(&frame, SIZE, None);
    let colours = point_radiance(&frame);
    let lists = lists(&frame, SIZE, None);
    let world = world(&hairs);
    let extremes = extent(&hair, &frame.view);
    // The box is that of the points, and no point lies outside it.
    assert!(
        world
            .strands
            .points
            .iter()
            .all(|p| -frame.view.view_from_world.transform_point3(*p).z >= extremes[0] - 1e-6)
    );
    assert!(portrait_distance(lists.fragments[0].depth) > extremes[0] - 1e-3);
    let mut errors = Vec::new();
    for bins in [1, 16, 256, 4096] {
        frame.transparency = technique(SortedBlending {
            bins,
            full_precision: true,
            ..Default::default()
        });
        let (actual, _) = render(&mut device, &frame, SIZE);
        let bin = bins_of(&world, &frame.view, extremes, bins as usize);
        let rule = blending::bin_sorted(
            &lists,
            0.3,
            |segment| bin[segment as usize],
            point_colours(&colours),
        );
        let [error, of_rule, from_rule] = [
            colour_error(&actual, &exact, None),
            colour_error(&rule, &exact, None),
            colour_error(&actual, &rule, None),
        ];
        eprintln!("{bins} bins: {error:?}\n  rule {of_rule:?}\n  from the rule {from_rule:?}");
        let alpha = alpha_error(&actual, &exact, None);
        assert!(alpha.rmse < FULL.rmse && alpha.p99 < FULL.p99, "{alpha:?}");
        if bins == 4096 {
            // The order within a bin is the library's own.
            assert_close("4096 bins", &actual, &rule, WITHIN_BINS);
        }
        errors.push(error.rmse);
    }
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
}

/// Segments of one bin of a thousandth of the groom's depth are in the library's order, not in the reference's; measured.
const WITHIN_BINS: Tolerance = Tolerance {
    rmse: 4e-3,
    p99: 0.015,
};

#[test]
fn an_order_is_kept_for_as_many_frames_as_said_and_not_for_other_hair() {
    let Some(mut device) = device() else { return };
    let hairs = pile(&mut device);
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let size = [16, 16];
    let image = device.create_image(16, 16, FORMAT, false).unwrap();
    let sorted = |device: &mut Device, hairs: &[&Hair]| {
        let frame = Frame {
            hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: pixel_view(size, 64.0),
            transparency: technique(SortedBlending {
                reuse: 2,
                ..Default::default()
            }),
        };
        let target = Target::cleared(&image.colour);
        let statistics = device.renderer.render_timed(&frame, &target).unwrap();
        let label = "pelage.transparency.sorted_blending.sort";
        statistics.passes.iter().any(|pass| pass.label == label)
    };
    let both = [&hairs[0], &hairs[1]];
    let found: Vec<bool> = (0..7).map(|_| sorted(&mut device, &both)).collect();
    assert_eq!(found, [true, false, false, true, false, false, true]);
    assert!(sorted(&mut device, &both[..1]));
    assert!(!sorted(&mut device, &both[..1]));
    let [mut one, other] = hairs;
    one.opacity = 0.5;
    assert!(sorted(&mut device, &[&one]));
    assert!(sorted(&mut device, &[&one, &other]));
}

#[test]
fn a_frame_that_is_never_submitted_leaves_no_order_behind() {
    let Some(mut device) = device() else { return };
    let hairs = pile(&mut device);
    let hairs = [&hairs[0], &hairs[1]];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let size = [16, 16];
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(size, 64.0),
        transparency: technique(SortedBlending {
            reuse: 1_000,
            full_precision: true,
            ..Default::default()
        }),
    };
    let image = device.create_image(16, 16, FORMAT, false).unwrap();
    let target = Target::cleared(&image.colour);
    let mut encoder = device
        .renderer
        .device()
        .create_command_encoder(&Default::default());
    device
        .renderer
        .record(&mut encoder, &frame, &target)
        .unwrap();
    drop(encoder);
    let expected = reference(&frame, size, None);
    for _ in 0..3 {
        let (actual, _) = render(&mut device, &frame, size);
        assert_close("after a lost frame", &actual, &expected, FULL);
    }
}

#[test]
fn bins_out_of_range_are_refused() {
    let Some(mut device) = device() else { return };
    let image = device.create_image(8, 8, FORMAT, false).unwrap();
    for bins in [0, 4097] {
        let frame = Frame {
            hairs: &[],
            lights: &[],
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: technique(SortedBlending {
                bins,
                ..Default::default()
            }),
        };
        let error = device.render(&frame, &Target::cleared(&image.colour));
        assert!(
            matches!(&error, Err(Error::InvalidValue(text)) if text.contains("bins")),
            "{error:?}"
        );
    }
}

/// Bytes of a binding on the small device, and what it holds of projected points, in multiples of 256 bytes, and of the histogram.
const SMALL_BINDING: u64 = 1 << 15;
const SMALL_POINTS: u64 = 1344;
const SMALL_WORDS: u64 = SMALL_BINDING / 4;

/// A device that binds so little at once.
fn small_device() -> Offscreen {
    let (device, queue, info) = open(Limits {
        max_storage_buffer_binding_size: SMALL_BINDING,
        ..least()
    });
    Offscreen::on(&device, &queue, info).unwrap()
}

/// A head of hair twice, and another of other colours and opacity among it: 65 points a strand of the one, 17 of the other.
fn heads(offscreen: &mut Offscreen, strands: [usize; 2]) -> [Hair; 2] {
    let grooms = [BuiltinGroom::Wavy, BuiltinGroom::Straight];
    let mut hairs = [0, 1].map(|number| {
        let strands = builtin(grooms[number], strands[number])
            .unwrap()
            .with_root_tip_radii(2e-3, 1e-3)
            .unwrap();
        let colours = (0..strands.strand_count())
            .map(|i| [(i % 5) as f32 / 4.0, number as f32, (i % 3) as f32 / 2.0])
            .collect();
        let strands = strands.with_colours(colours).unwrap();
        let mut hair = offscreen.renderer.create_hair(&strands).unwrap();
        (hair.shading, hair.opacity) = (WHITE, 0.3 + 0.3 * number as f32);
        hair
    });
    hairs[0].instances = vec![at(0.0), at(0.02)];
    hairs
}

fn at(x: f64) -> Instance {
    Instance {
        object_from_instance: DMat4::from_translation(DVec3::new(x, 0.0, 0.5 * x)),
        previous_object_from_instance: None,
    }
}

/// A frame of the heads: its pixels' bits, whether it was sorted, and how many bindings the points and the histogram that are
/// held take on the small device.
struct Drawn {
    pixels: Vec<[u32; 4]>,
    sorted: bool,
    parts: [u64; 2],
}

fn draw(offscreen: &mut Offscreen, hairs: &[Hair; 2], settings: SortedBlending) -> Result<Drawn> {
    let [width, height] = SIZE;
    let format = wgpu::TextureFormat::Rgba16Float;
    let image = offscreen.create_image(width, height, format, false)?;
    let target = Target::cleared(&image.colour);
    let frame = Frame {
        hairs: &[&hairs[0], &hairs[1]],
        lights: &[sunlight()],
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: technique(settings),
    };
    let renderer = &mut offscreen.renderer;
    let estimate = renderer.memory_estimate(&frame, &(&target).into())?;
    let statistics = renderer.render_timed(&frame, &target)?;
    assert_eq!(estimate.bytes, statistics.bytes, "{settings:?}");
    let label = "pelage.transparency.sorted_blending.";
    let sort = format!("{label}sort");
    let points = estimate.of("pelage.geometry.projected") / 24;
    let words = estimate.of(&format!("{label}histogram")) / 4;
    let pixels = offscreen.read_colour(&image.colour)?;
    Ok(Drawn {
        pixels: (pixels
            .iter()
            .map(|pixel| pixel.to_array().map(f32::to_bits)))
        .collect(),
        sorted: statistics.passes.iter().any(|pass| pass.label == sort),
        parts: [points.div_ceil(SMALL_POINTS), words.div_ceil(SMALL_WORDS)],
    })
}

#[test]
fn points_and_histograms_of_several_bindings_are_drawn_as_those_of_one() {
    let Some(mut whole) = device() else { return };
    let mut small = small_device();
    // What is held grows; the last ones need less of it.
    for (strands, bins, parts) in [
        ([2, 8], [64, 1024], [[1, 1], [1, 1]]),
        ([13, 12], [1024, 1900], [[2, 2], [2, 3]]),
        ([24, 24], [1024, 1100], [[3, 3], [3, 3]]),
        ([28, 15], [1024, 1600], [[4, 3], [4, 4]]),
        ([13, 12], [64, 700], [[4, 4], [4, 4]]),
    ] {
        let expected_hairs = heads(&mut whole, strands);
        let hairs = heads(&mut small, strands);
        for ((order, bins), parts) in ORDERS.into_iter().zip(bins).zip(parts) {
            let settings = SortedBlending {
                bins,
                order,
                reuse: 1,
                ..Default::default()
            };
            let expected = draw(&mut whole, &expected_hairs, settings).unwrap();
            let covered = |pixel: &&[u32; 4]| f32::from_bits(pixel[3]) > 0.1;
            assert!(expected.pixels.iter().filter(covered).count() > 1000);
            for sorted in [true, false, true] {
                let drawn = draw(&mut small, &hairs, settings).unwrap();
                let name = format!("{strands:?} strands, {settings:?}");
                assert!(drawn.pixels == expected.pixels, "{name}");
                assert_eq!((drawn.sorted, drawn.parts), (sorted, parts), "{name}");
            }
        }
    }
}

#[test]
fn what_four_bindings_do_not_hold_is_refused_and_the_next_frame_is_drawn() {
    let Some(mut whole) = device() else { return };
    let refused = |drawn: Result<Drawn>, words: &[&str]| {
        let Err(Error::Unsupported(text)) = drawn else {
            panic!("it was drawn");
        };
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    let mut small = small_device();
    let hairs = heads(&mut small, [28, 15]);
    let fine = SortedBlending {
        bins: 4096,
        ..Default::default()
    };
    // Chunks of 256 points: six and three of each instance's two runs, and one of the other hair.
    let bytes = (4096 * 19 + 4096) * 4;
    let words = ["4096 bins", &format!("{bytes} of a histogram"), "32768"];
    refused(draw(&mut small, &hairs, fine), &words);
    draw(&mut small, &hairs, SortedBlending::default()).unwrap();

    let mut hairs = heads(&mut whole, [1, 1]);
    hairs[0].instances = vec![at(0.0); 1 << 15];
    let words = ["32769 runs", "32769 chunks", "32768 chunks are taken"];
    refused(draw(&mut whole, &hairs, SortedBlending::default()), &words);
    hairs[0].instances.clear();
    draw(&mut whole, &hairs, SortedBlending::default()).unwrap();
}
