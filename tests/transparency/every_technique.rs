//! What holds for every transparency technique, whatever it keeps of a pixel: the hard cases.

use pelage::glam::{DMat4, DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::host::offscreen::WantedOutputs;
use pelage::raster::Raster;
use pelage::shading::ShadingRate;
use pelage::transparency::{
    Atomics, BlendOrder, Culling, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass, KPlusBuffer,
    Moment, Opaque, RandomSubsets, Rest, SortedBlending, Storage, Transparency, Weight,
    WeightedBlended,
};
use pelage::{Error, Frame, Hair, Instance, Light, NO_STRAND, Target, View};
use pelage_reference::composite::Image;
use pelage_reference::error::alpha_error;

use crate::common::images::{FORMAT, Tolerance, assert_close, assert_identical, read, render};
use crate::common::scenes::{WHITE, a_buffer, pixel_view, portrait, reference, unshadowed};
use crate::common::{Device, device};

/// A technique, and what it promises.
pub struct Case {
    pub name: &'static str,
    pub technique: Transparency,
    /// A pixel's opacity is that of all its fragments.
    pub alpha: bool,
    /// Colour and opacity are off by no more, from what the technique promises.
    pub tolerance: Tolerance,
    /// Fragments of a pixel are composited in their order, if they are no more than eight.
    pub order: bool,
}

/// Every technique by either rasteriser, and settings that take another way through its shaders.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, technique, alpha, order| {
        cases.push(Case {
            name,
            technique,
            alpha,
            tolerance: TOLERANCE,
            order,
        })
    };
    for raster in [Raster::Walk, Raster::Ribbons] {
        let opaque = Transparency::Opaque(Opaque { raster });
        add("opaque", opaque, true, false);
        add("counted", a_buffer(Storage::Counted, raster), true, true);
        add("lists", a_buffer(Storage::Lists, raster), true, true);
        let settings = DbkBuffer {
            culling: Culling::Always,
            raster,
            ..Default::default()
        };
        add("dbk_buffer", Transparency::DbkBuffer(settings), true, true);
        let settings = KBuffer {
            raster,
            ..Default::default()
        };
        add("k_buffer", Transparency::KBuffer(settings), true, true);
        for (name, atomics, rest) in [
            ("k_plus_buffer", Atomics::Auto, Rest::Alpha),
            ("k_plus_buffer, 32 bits", Atomics::Bits32, Rest::Merged),
        ] {
            let settings = KPlusBuffer {
                atomics,
                rest,
                raster,
                ..Default::default()
            };
            add(name, Transparency::KPlusBuffer(settings), true, true);
        }
        let settings = KBufferSinglePass {
            raster,
            ..Default::default()
        };
        let technique = Transparency::KBufferSinglePass(settings);
        add("k_buffer_single_pass", technique, true, true);
        let moment = Transparency::Moment(Moment { raster });
        add("moment", moment, true, false);
        for (name, weight) in [
            ("weighted, uniform", Weight::Uniform),
            ("weighted, cubic", Weight::Cubic),
            ("weighted", Weight::Exponential { falloff: 12.0 }),
        ] {
            let settings = WeightedBlended { weight, raster };
            add(name, Transparency::WeightedBlended(settings), true, false);
        }
        for (name, peels) in [("one peel", 1), ("peels", 9)] {
            let settings = DepthPeeling { peels, raster };
            add(name, Transparency::DepthPeeling(settings), true, peels > 8);
        }
        for (name, exact_alpha) in [("subsets, published", false), ("subsets", true)] {
            let settings = RandomSubsets {
                raster,
                exact_alpha,
                ..Default::default()
            };
            let technique = Transparency::RandomSubsets(settings);
            add(name, technique, exact_alpha, false);
        }
    }
    for (name, order, full_precision) in [
        ("sorted", BlendOrder::BackToFront, false),
        ("sorted, full", BlendOrder::BackToFront, true),
        ("sorted, front to back", BlendOrder::FrontToBack, false),
    ] {
        let settings = SortedBlending {
            order,
            full_precision,
            ..Default::default()
        };
        add(name, Transparency::SortedBlending(settings), true, true);
    }
    for case in &mut cases {
        if let Transparency::SortedBlending(settings) = case.technique
            && !settings.full_precision
        {
            case.tolerance = HALF;
        }
    }
    cases
}

/// As of the A-buffer's overflow: opacities of 16 bits, and what lies behind a transmittance of 1/4096.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 2e-3,
    p99: 6e-3,
};
/// Blending into half floats rounds at every layer, by up to 2.4e-4 near 1, and loses layers fainter than that: measured RMSE
/// 2.5e-3 in wavy hair, with 0.05 in one pixel.
const HALF: Tolerance = Tolerance {
    rmse: 5e-3,
    p99: 0.012,
};

/// The steps of a half float below 1.
const HALF_STEP: f32 = 1.0 / 2048.0;

const SIZE: [u32; 2] = [32, 32];

fn light() -> Light {
    unshadowed(DVec3::NEG_Z, Vec3::new(1.0, 0.7, 0.4))
}

fn white(device: &mut Device, points: Vec<[f32; 3]>, counts: &[u32], radius: f32) -> Hair {
    let strands = Strands::new(points, counts, radius).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = WHITE;
    hair
}

fn frame<'a>(hairs: &'a [&'a Hair], lights: &'a [Light], case: &Case, view: View) -> Frame<'a> {
    Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view,
        transparency: Some(case.technique),
    }
}

fn finite(image: &Image) -> bool {
    let value = |v: &f64| v.is_finite() && *v >= 0.0;
    image
        .pixels
        .iter()
        .all(|p| p.iter().all(value) && p[3] <= 1.0 + 1e-6)
}

#[test]
fn strands_that_lie_side_by_side_look_alike_by_every_technique() {
    let Some(mut device) = device() else { return };
    let points = (0..8).flat_map(|i| {
        let y = 4.0 * i as f32 - 14.0;
        [[-12.0, y, i as f32], [12.0, y + 0.7, -i as f32]]
    });
    let mut hair = white(&mut device, points.collect(), &[2; 8], 0.6);
    let lights = [light()];
    for opacity in [1.0, 0.3, 0.004] {
        hair.opacity = opacity;
        for case in cases() {
            let hairs = [&hair];
            let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
            let (actual, _) = render(&mut device, &frame, SIZE);
            let name = format!("side by side, {}, {opacity}", case.name);
            assert_close(
                &name,
                &actual,
                &reference(&frame, SIZE, None),
                case.tolerance,
            );
        }
    }
}

#[test]
fn opacity_is_exact_and_a_frame_drawn_again_is_the_same() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 400).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let size = [48, 64];
    let lights = [light()];
    for opacity in [1.0, 0.2] {
        hair.opacity = opacity;
        let hairs = [&hair];
        let mut expected = None;
        for case in cases() {
            let frame = frame(&hairs, &lights, &case, portrait(size));
            let expected = expected.get_or_insert_with(|| reference(&frame, size, None));
            let (actual, _) = render(&mut device, &frame, size);
            let name = format!("{}, opacity {opacity}", case.name);
            let alpha = alpha_error(&actual, expected, None);
            let fine = alpha.rmse < case.tolerance.rmse && alpha.p99 < case.tolerance.p99;
            assert!(fine || !case.alpha, "{name}: {alpha:?}");
            assert!(finite(&actual), "{name}");
            let (again, _) = render(&mut device, &frame, size);
            assert_identical(&name, &again, &actual);
        }
    }
}

#[test]
fn fibres_without_opacity_leave_nothing() {
    let Some(mut device) = device() else { return };
    let mut hair = white(
        &mut device,
        vec![[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0]],
        &[2],
        2.0,
    );
    hair.opacity = 0.0;
    let hairs = [&hair];
    let lights = [light()];
    for case in cases() {
        let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
        let (image, _) = render(&mut device, &frame, SIZE);
        assert!(image.pixels.iter().all(|p| *p == [0.0; 4]), "{}", case.name);
    }
}

#[test]
fn strands_at_one_depth_make_one_picture() {
    let Some(mut device) = device() else { return };
    // Ten coplanar strands, as wide as the image and of one colour: whichever comes first, the picture is the same.
    let points = (0..10).flat_map(|_| [[-40.0, 0.0, 0.0], [40.0, 0.0, 0.0]]);
    let mut hair = white(&mut device, points.collect(), &[2; 10], 9.0);
    let lights = [light()];
    for opacity in [1.0, 0.4] {
        hair.opacity = opacity;
        for case in cases() {
            let hairs = [&hair];
            let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
            let (actual, _) = render(&mut device, &frame, SIZE);
            let name = format!("one depth, {}, {opacity}", case.name);
            if case.alpha {
                assert_close(
                    &name,
                    &actual,
                    &reference(&frame, SIZE, None),
                    case.tolerance,
                );
            }
            let (again, _) = render(&mut device, &frame, SIZE);
            assert_identical(&name, &again, &actual);
        }
    }
}

#[test]
fn strands_through_the_near_plane_are_cut_there() {
    let Some(mut device) = device() else { return };
    let strand = |i: i32| {
        let angle = f64::from(i) * 0.26 + 0.05;
        let (x, y) = (0.3 * angle.cos() as f32, 0.3 * angle.sin() as f32);
        [
            [x, y, -3.0],
            [0.6 * x, 0.8 * y, -0.9],
            [0.9 * x, 0.5 * y, 0.8],
            [x, y, 2.0],
        ]
    };
    let points = (0..24).flat_map(strand).collect();
    let mut hair = white(&mut device, points, &[4; 24], 0.01);
    hair.opacity = 0.6;
    let view =
        View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.2, 1.0, [0.2, 10.0]).unwrap();
    let (hairs, lights) = ([&hair], [light()]);
    let size = [64, 64];
    for case in cases() {
        let frame = frame(&hairs, &lights, &case, view);
        let (actual, _) = render(&mut device, &frame, size);
        let expected = reference(&frame, size, None);
        let name = format!("near plane, {}", case.name);
        assert!(finite(&actual), "{name}");
        if case.order {
            assert_close(&name, &actual, &expected, case.tolerance);
        } else if case.alpha {
            let alpha = alpha_error(&actual, &expected, None);
            assert!(alpha.p99 < case.tolerance.p99, "{name}: {alpha:?}");
        }
    }
}

#[test]
fn viewports_of_one_pixel_and_of_one_row_are_drawn() {
    let Some(mut device) = device() else { return };
    for size in [[1, 1], [16384, 1], [1, 4099]] {
        let reach = 0.6 * size[0].max(size[1]) as f32;
        let points = vec![
            [-reach, -0.2, 0.0],
            [reach, 0.2, 0.0],
            [-0.1, -reach, 1.0],
            [0.1, reach, 1.0],
        ];
        device.forget();
        let mut hair = white(&mut device, points, &[2, 2], 0.3);
        hair.opacity = 0.8;
        let (hairs, lights) = ([&hair], [light()]);
        for case in cases() {
            let frame = frame(&hairs, &lights, &case, pixel_view(size, 10.0));
            let (actual, _) = render(&mut device, &frame, size);
            let expected = reference(&frame, size, None);
            let name = format!("{size:?}, {}", case.name);
            let alpha = alpha_error(&actual, &expected, None);
            assert!(
                !case.alpha || alpha.p99 < case.tolerance.p99,
                "{name}: {alpha:?}"
            );
            if case.order {
                assert_close(&name, &actual, &expected, case.tolerance);
            }
        }
    }
}

/// A target with an opaque scene at one depth, every output, and a colour that must stay.
fn draw_over(
    device: &mut Device,
    frame: &Frame,
    depth: f32,
) -> (Image, Vec<u32>, Vec<u32>, Vec<f32>) {
    let mut image = device.create_image(SIZE[0], SIZE[1], FORMAT, true).unwrap();
    let wanted = WantedOutputs {
        nearest_depth: true,
        coverage: true,
        motion: false,
        ids: true,
    };
    device.add_outputs(&mut image, wanted).unwrap();
    let count = (SIZE[0] * SIZE[1]) as usize;
    let scene = image.depth.clone().unwrap();
    device.write_depth(&scene, &vec![depth; count]).unwrap();
    let target = Target {
        depth: Some(&scene),
        write_depth: true,
        outputs: image.outputs(),
        ..Target::cleared(&image.colour)
    };
    device.render(frame, &target).unwrap();
    let colour = read(device, &image.colour);
    let ids = device
        .read_words(image.outputs.ids.as_ref().unwrap())
        .unwrap();
    let coverage = device
        .read_words(image.outputs.coverage.as_ref().unwrap())
        .unwrap();
    let depths = device.read_depth(&scene).unwrap();
    (colour, ids, coverage, depths)
}

#[test]
fn hair_that_is_nowhere_in_view_leaves_no_trace() {
    let Some(mut device) = device() else { return };
    let bar = |x: f32, z: f32| vec![[x - 9.0, 0.0, z], [x + 9.0, 0.0, z]];
    let beside = white(&mut device, bar(500.0, 0.0), &[2], 2.0);
    let behind = white(&mut device, bar(0.0, 60.0), &[2], 2.0);
    let hidden = white(&mut device, bar(0.0, 0.0), &[2], 2.0);
    let lights = [light()];
    // Depths from 0 at z = 10 to 1 at z = -10: the last hair lies at ½.
    for (place, hair, scene) in [
        ("beside the view", &beside, 1.0),
        ("behind the eye", &behind, 1.0),
        ("behind the scene", &hidden, 0.25),
    ] {
        for case in cases() {
            let hairs = [hair];
            let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
            let (colour, ids, coverage, depths) = draw_over(&mut device, &frame, scene);
            let name = format!("{place}, {}", case.name);
            assert!(colour.pixels.iter().all(|p| *p == [0.0; 4]), "{name}");
            assert!(ids.iter().all(|id| *id == NO_STRAND), "{name}");
            assert!(coverage.iter().all(|bits| *bits == 0), "{name}");
            assert!(depths.iter().all(|depth| *depth == scene), "{name}");
        }
    }
    // And the same hair is there before a scene that lies farther.
    for case in cases() {
        let hairs = [&hidden];
        let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
        let (colour, ids, coverage, depths) = draw_over(&mut device, &frame, 0.75);
        let middle = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
        let name = case.name;
        assert!(colour.pixels[middle][3] > 0.99, "{name}");
        assert_eq!(&ids[2 * middle..2 * middle + 2], [0, 0], "{name}");
        assert!(f32::from_bits(coverage[middle]) > 0.99, "{name}");
        assert!(
            (depths[middle] - 0.5).abs() < 1e-6 && depths[0] == 0.75,
            "{name}: {}",
            depths[middle]
        );
    }
}

#[test]
fn a_million_fragments_of_one_pixel_neither_overflow_nor_hang() {
    let Some(mut device) = device() else { return };
    // A hundred strands that run along the chords of a star around the pixel, a thousand each, ten times over. A star's tips
    // are so sharp that every chord is a crossing of its own; each covers the whole pixel.
    let strand = |s: i32| {
        (0..1001).map(move |i| {
            let angle = f64::from(i) * std::f64::consts::TAU * 3.0 / 7.0;
            let z = 9.0 - 1e-3 * f64::from(i) - 0.06 * f64::from(s);
            [4.0 * angle.cos() as f32, 4.0 * angle.sin() as f32, z as f32]
        })
    };
    let points = (0..100).flat_map(strand).collect();
    let mut hair = white(&mut device, points, &[1001; 100], 3.0);
    hair.instances = (0..10)
        .map(|i| Instance {
            object_from_instance: DMat4::from_translation(DVec3::new(
                0.0,
                0.0,
                -1e-4 * f64::from(i),
            )),
            previous_object_from_instance: None,
        })
        .collect();
    let (lights, size) = ([light()], [1, 1]);
    for opacity in [1.0, 2e-3] {
        hair.opacity = opacity;
        for case in cases() {
            if case.technique.raster() == Raster::Ribbons {
                continue;
            }
            let hairs = [&hair];
            let frame = frame(&hairs, &lights, &case, pixel_view(size, 10.0));
            let (image, statistics) = render(&mut device, &frame, size);
            let name = format!(
                "{}, opacity {opacity}: {:?}",
                case.name, statistics.fragments
            );
            eprintln!("{name}: {:?}", image.pixels[0]);
            let [red, green, blue, alpha] = image.pixels[0];
            let produced = statistics.fragments.produced;
            let sorted = matches!(case.technique, Transparency::SortedBlending(_));
            assert!(sorted || produced == 1_000_000, "{name}");
            if matches!(case.name, "counted" | "dbk_buffer" | "k_buffer") {
                assert!(statistics.fragments.stored <= 8192, "{name}");
            }
            if !case.alpha {
                continue;
            }
            // A half float near 1 steps by 2⁻¹¹: what a fibre of so little opacity adds is lost, and opacity stops short.
            let stop = 1.0 - f64::from(HALF_STEP / opacity);
            if sorted && case.tolerance.rmse == HALF.rmse && stop < 1.0 - case.tolerance.p99 {
                assert!(
                    alpha > stop - 1e-3,
                    "{name}: {alpha} where {stop} is reached"
                );
                continue;
            }
            assert!((alpha - 1.0).abs() < case.tolerance.p99, "{name}: {alpha}");
            // Moments say that next to nothing reaches any of them: each weighs two steps, and colour is lost to rounding.
            if matches!(case.technique, Transparency::Moment(_)) && opacity < 1.0 {
                continue;
            }
            // All have one colour, whatever their weights.
            for (got, expected) in [red, green, blue].into_iter().zip([1.0, 0.7, 0.4]) {
                assert!(
                    (got - expected).abs() < case.tolerance.p99,
                    "{name}: {:?}",
                    image.pixels[0]
                );
            }
        }
    }
}

#[test]
fn many_grooms_of_one_view_are_composited_in_their_order() {
    let Some(mut device) = device() else { return };
    // Eyebrows, a beard and a head of hair, as far as order goes: layers of one lie between those of the others.
    let layer = |z: f32, turn: bool| {
        move |i: i32| {
            let c = 2.0 * i as f32 - 7.0;
            if turn {
                [[c, -12.0, z], [c, 12.0, z]]
            } else {
                [[-12.0, c, z], [12.0, c, z]]
            }
        }
    };
    let mut groom = |depths: [f32; 2], turn: bool, colour: [f32; 3]| {
        let points = depths
            .into_iter()
            .flat_map(|z| (0..8).flat_map(layer(z, turn)))
            .collect();
        let strands = Strands::new(points, &[2; 16], 0.9)
            .unwrap()
            .with_colours(vec![colour; 16])
            .unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        (hair.shading, hair.opacity) = (WHITE, 0.5);
        hair
    };
    let brows = groom([-4.0, 3.0], false, [1.0, 0.2, 0.1]);
    let beard = groom([-2.0, 5.0], true, [0.1, 1.0, 0.2]);
    let head = groom([0.5, -6.0], false, [0.1, 0.2, 1.0]);
    let lights = [light()];
    for case in cases() {
        let [one, other] = [[&brows, &beard, &head], [&head, &brows, &beard]].map(|hairs| {
            let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
            let (actual, _) = render(&mut device, &frame, SIZE);
            if case.order {
                let name = format!("three grooms, {}", case.name);
                assert_close(
                    &name,
                    &actual,
                    &reference(&frame, SIZE, None),
                    case.tolerance,
                );
            }
            actual
        });
        // Subsets are hashes of the hair's place in the frame.
        if !matches!(case.technique, Transparency::RandomSubsets(_)) {
            let name = format!("three grooms in another order, {}", case.name);
            assert_close(&name, &other, &one, case.tolerance);
        }
    }
}

#[test]
fn shading_at_fragments_is_taken_or_refused_by_name() {
    let Some(mut device) = device() else { return };
    let points = vec![[-12.0, 0.0, 0.0], [12.0, 0.0, 0.0]];
    let mut hair = white(&mut device, points, &[2], 1.0);
    hair.shading_rate = ShadingRate::Fragment;
    let lights = [light()];
    let hairs = [&hair];
    let mut taken = Vec::new();
    for case in cases() {
        let frame = frame(&hairs, &lights, &case, pixel_view(SIZE, 10.0));
        let image = device
            .create_image(SIZE[0], SIZE[1], FORMAT, false)
            .unwrap();
        let stem = case.technique.stem();
        match device.render(&frame, &Target::cleared(&image.colour)) {
            Ok(_) => {
                let (actual, expected) = (
                    read(&mut device, &image.colour),
                    reference(&frame, SIZE, None),
                );
                assert_close(
                    &format!("{}, fragments", case.name),
                    &actual,
                    &expected,
                    case.tolerance,
                );
                taken.push(stem);
            }
            Err(Error::Conflict(message)) => {
                assert!(
                    message.contains(stem) && message.contains("Fragment"),
                    "{message}"
                );
            }
            Err(error) => panic!("{}: {error}", case.name),
        }
    }
    taken.sort_unstable();
    taken.dedup();
    let all = [
        "a_buffer",
        "dbk_buffer",
        "k_buffer",
        "k_plus_buffer",
        "opaque",
    ];
    assert_eq!(taken, all);
}
