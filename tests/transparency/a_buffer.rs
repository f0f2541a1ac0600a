//! The A-buffer against the reference's exact composite.

use pelage::Frame;
use pelage::glam::Vec3;
use pelage::groom::{BuiltinGroom, Curve, Strands, builtin};
use pelage::raster::Raster;
use pelage::transparency::Storage;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{
    A_BUFFERS, a_buffer, pixel_view, portrait, reference, reversed, sunlight,
};

/// What the project promises of the A-buffer.
const PROMISED: Tolerance = Tolerance {
    rmse: 1e-3,
    p99: 4e-3,
};

const SIZE: [u32; 2] = [328, 430];

#[test]
fn ten_thousand_strands_match_the_exact_composite_in_either_form_by_either_rasteriser() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 10_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    for opacity in [1.0, 0.3] {
        hair.opacity = opacity;
        let (hairs, lights) = ([&hair], [sunlight()]);
        let mut frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: None,
        };
        let expected = reference(&frame, SIZE, None);
        let images: Vec<_> = A_BUFFERS
            .iter()
            .map(|(name, storage, raster)| {
                frame.transparency = Some(a_buffer(*storage, *raster));
                let (actual, statistics) = render(&mut device, &frame, SIZE);
                assert_eq!(statistics.fragments.merged, 0);
                assert_close(
                    &format!("ten thousand {opacity} {name}"),
                    &actual,
                    &expected,
                    PROMISED,
                );
                let (again, _) = render(&mut device, &frame, SIZE);
                assert_identical(
                    &format!("ten thousand {opacity} {name} again"),
                    &again,
                    &actual,
                );
                actual
            })
            .collect();
        assert_close(
            &format!("counted, walk against ribbons, {opacity}"),
            &images[0],
            &images[1],
            PROMISED,
        );
        assert_close(
            &format!("lists, walk against ribbons, {opacity}"),
            &images[2],
            &images[3],
            PROMISED,
        );
        assert_identical(
            &format!("walk, counted against lists, {opacity}"),
            &images[0],
            &images[2],
        );
    }
}

#[test]
fn a_few_wavy_splines_match_the_exact_composite() {
    let Some(mut device) = device() else { return };
    let strand = |number: usize| {
        let phase = number as f32 * 1.7;
        let x = -24.0 + 4.0 * number as f32;
        (0..9).map(move |i| {
            let u = i as f32 / 8.0;
            [
                x + 5.0 * (9.0 * u + phase).sin(),
                28.0 - 56.0 * u,
                4.0 * (7.0 * u + phase).cos(),
            ]
        })
    };
    let points = (0..13).flat_map(strand).collect();
    let colours = (0..13)
        .map(|i| [0.2 + 0.06 * i as f32, 0.9 - 0.05 * i as f32, 0.5])
        .collect();
    let strands = Strands::new(points, &[9; 13], 0.7)
        .unwrap()
        .with_root_tip_radii(1.1, 0.2)
        .unwrap()
        .with_colours(colours)
        .unwrap()
        .with_curve(Curve::CatmullRom);
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.6;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let size = [64, 64];
    let view = pixel_view(size, 50.0);
    let mut frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view,
        transparency: None,
    };
    let expected = reference(&frame, size, None);
    for (name, storage, raster) in A_BUFFERS {
        frame.transparency = Some(a_buffer(storage, raster));
        let (actual, statistics) = render(&mut device, &frame, size);
        assert_eq!(
            statistics.segments,
            13 * 8 * u64::from(pelage::testing::curve_pieces(hair.strands())),
            "pieces of a spline's segment"
        );
        assert_close(&format!("wavy {name}"), &actual, &expected, PROMISED);
    }
}

#[test]
fn counters_add_up() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 500).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let hairs = [&hair];
    let size = [64, 84];
    let view = portrait(size);
    let mut frame = Frame {
        hairs: &hairs,
        lights: &[],
        ambient: Vec3::ONE,
        view,
        transparency: None,
    };
    let expected = crate::common::scenes::lists(&frame, size, None)
        .fragments
        .len() as f64;
    for (name, storage, raster) in A_BUFFERS {
        frame.transparency = Some(a_buffer(storage, raster));
        let (_, statistics) = render(&mut device, &frame, size);
        let fragments = statistics.fragments;
        assert_eq!(
            fragments.produced,
            fragments.stored + fragments.merged + fragments.culled,
            "{name}"
        );
        assert_eq!(statistics.strands, 500);
        // In f32 a sliver of a pixel may round to no coverage, or out of it.
        let off = (fragments.produced as f64 / expected - 1.0).abs();
        assert!(
            off < 2e-3,
            "{name}: {} fragments, {expected} expected",
            fragments.produced
        );
    }
}

#[test]
fn the_two_storages_give_the_same_image() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Curly, 300).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.4;
    let (hairs, lights) = ([&hair], [sunlight()]);
    let size = [96, 128];
    let view = portrait(size);
    for raster in [Raster::Walk, Raster::Ribbons] {
        let images = [Storage::Counted, Storage::Lists].map(|storage| {
            let transparency = Some(a_buffer(storage, raster));
            let frame = Frame {
                hairs: &hairs,
                lights: &lights,
                ambient: Vec3::ZERO,
                view,
                transparency,
            };
            render(&mut device, &frame, size).0
        });
        assert_identical(&format!("storages {raster:?}"), &images[0], &images[1]);
    }
}

/// Counted arrays are ordered by ranks, lists by whole words: where depths are equal in twos, threes and by more than a round holds,
/// where keys are too fine for the ranks, and where a list is too long for them.
#[test]
fn fragments_of_equal_depth_and_of_fine_keys_are_in_the_same_order_in_either_storage() {
    let Some(mut device) = device() else { return };
    let (size, lights) = ([16, 8], [sunlight()]);
    let perspective = portrait(size);
    for (name, alike, groups, view) in [
        ("one by one", 1, 40, pixel_view(size, 10.0)),
        ("in twos", 2, 40, pixel_view(size, 10.0)),
        ("in threes", 3, 40, pixel_view(size, 10.0)),
        ("in seventeens", 17, 6, pixel_view(size, 10.0)),
        ("in hundreds", 100, 2, pixel_view(size, 10.0)),
        ("too many", 2, 1_000, pixel_view(size, 10.0)),
        ("around the eye", 2, 60, perspective),
    ] {
        let count = alike * groups;
        // A strand's colour is its own, and so tells its place in the order.
        let colours = (0..count)
            .map(|i| {
                [
                    (i % 7) as f32 / 7.0,
                    (i % 11) as f32 / 11.0,
                    (i % 13) as f32 / 13.0,
                ]
            })
            .collect();
        // Groups come in no order of depth; the last ones of a view from within lie behind it.
        let points = (0..count)
            .flat_map(|i| {
                let group = (i % groups) * 17 % groups;
                let z = 8.0 * (0.5 - group as f32 / groups as f32);
                [[-6.0, 0.3, z], [6.0, 0.3, z]]
            })
            .collect();
        let strands = Strands::new(points, &vec![2; count], 1.5)
            .unwrap()
            .with_colours(colours)
            .unwrap();
        let mut hair = device.renderer.create_hair(&strands).unwrap();
        // So much that what shows of the longest list is ordered, and none merged.
        hair.opacity = 0.05;
        let hairs = [&hair];
        let images = [Storage::Counted, Storage::Lists].map(|storage| {
            let frame = Frame {
                hairs: &hairs,
                lights: &lights,
                ambient: Vec3::ZERO,
                view,
                transparency: Some(a_buffer(storage, Raster::Walk)),
            };
            render(&mut device, &frame, size).0
        });
        assert!(
            images[0].pixels.iter().any(|pixel| pixel[3] > 0.3),
            "{name}"
        );
        assert_identical(name, &images[0], &images[1]);
    }
}

/// A million points and depths from the near plane on: a fragment's word has too few bits for all of them, and leaves out the
/// last of the depth's and the opacity's. Measured: RMSE of colour 2e-5, of alpha 6e-5.
#[test]
fn words_with_little_room_keep_the_order() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 2_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.5;
    // Around the eye, and all of it out of sight.
    let (count, each) = (550, 2_000);
    let point = |i: usize| [5.0, i as f32 * 1e-3 - 1.0, 3.0 - 5.0 * (i % 2) as f32];
    let points = (0..count).flat_map(|_| (0..each).map(point)).collect();
    let beside = Strands::new(points, &vec![each as u32; count], 0.001).unwrap();
    let beside = device.renderer.create_hair(&beside).unwrap();
    let lights = [sunlight()];
    let size = [164, 215];
    for view in [portrait(size), reversed(&portrait(size))] {
        for storage in [Storage::Counted, Storage::Lists] {
            let images = [&[&hair][..], &[&hair, &beside]].map(|hairs| {
                let frame = Frame {
                    hairs,
                    lights: &lights,
                    ambient: Vec3::ZERO,
                    view,
                    transparency: Some(a_buffer(storage, Raster::Walk)),
                };
                render(&mut device, &frame, size).0
            });
            let [alone, both] = images;
            let name = format!("little room, reversed {}, {storage:?}", view.reverse_z);
            assert!(both.pixels != alone.pixels, "{name}: words had room");
            assert_close(&name, &both, &alone, PROMISED);
        }
    }
}
