//! Depth peeling: exact where there are enough peels, like the A-buffer; a tail of exact opacity where there are not.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::raster::Raster;
use pelage::transparency::{DepthPeeling, Storage, Transparency};
use pelage::{Error, Frame};
use pelage_reference::composite::{composite_with_tail, point_colours};

use crate::common::device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{
    WHITE, a_buffer, lists, pixel_view, point_radiance, portrait, reference, sunlight, unshadowed,
};

/// What the project promises of exact techniques.
const PROMISED: Tolerance = Tolerance {
    rmse: 1e-3,
    p99: 4e-3,
};
const SIZE: [u32; 2] = [64, 84];

fn technique(peels: u32, raster: Raster) -> Option<Transparency> {
    Some(Transparency::DepthPeeling(DepthPeeling { peels, raster }))
}

#[test]
fn with_enough_peels_it_is_the_a_buffer_and_with_few_the_rest_is_one_layer() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let lights = [sunlight()];
    for opacity in [1.0, 0.3] {
        hair.opacity = opacity;
        let hairs = [&hair];
        let mut frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: Some(a_buffer(Storage::Counted, Raster::Walk)),
        };
        let lists = lists(&frame, SIZE, None);
        let deepest = (0..lists.pixels()).map(|i| lists.pixel(i).len()).max();
        let deepest = deepest.unwrap() as u32;
        let (stored, _) = render(&mut device, &frame, SIZE);
        for raster in [Raster::Walk, Raster::Ribbons] {
            frame.transparency = technique(deepest + 1, raster);
            let (actual, statistics) = render(&mut device, &frame, SIZE);
            let name = format!("peeling, {deepest} deep, opacity {opacity}, {raster:?}");
            assert_close(&name, &actual, &reference(&frame, SIZE, None), PROMISED);
            assert_eq!(statistics.fragments.merged, 0, "{name}");
            if raster == Raster::Walk {
                assert_identical(&format!("{name}, against the A-buffer"), &actual, &stored);
            }
        }
        let colours = point_radiance(&frame);
        for peels in [1, 4] {
            let expected = composite_with_tail(
                &lists,
                f64::from(opacity),
                peels as usize,
                point_colours(&colours),
            );
            frame.transparency = technique(peels, Raster::Walk);
            let (actual, statistics) = render(&mut device, &frame, SIZE);
            let name = format!("{peels} peels, opacity {opacity}");
            assert_close(&name, &actual, &expected, FEW);
            assert!(
                statistics.fragments.merged > 0,
                "{name}: {:?}",
                statistics.fragments
            );
            let (again, _) = render(&mut device, &frame, SIZE);
            assert_identical(&name, &again, &actual);
        }
    }
}

/// Where two fragments are so near to one another that f32 cannot order them, another is the last peel: they are few.
const FEW: Tolerance = Tolerance {
    rmse: 3e-3,
    p99: 6e-3,
};

#[test]
fn fragments_at_one_depth_are_peeled_one_by_one() {
    let Some(mut device) = device() else { return };
    let points = (0..12)
        .flat_map(|_| [[-8.0, 0.0, 0.0], [8.0, 0.0, 0.0]])
        .collect();
    let colours = (0..12)
        .map(|i| [i as f32 / 11.0, 0.5, 1.0 - i as f32 / 11.0])
        .collect();
    let strands = Strands::new(points, &[2; 12], 3.0)
        .unwrap()
        .with_colours(colours)
        .unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.3);
    let size = [16, 16];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let mut frame = Frame {
        hairs: &[&hair],
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(size, 10.0),
        transparency: Some(a_buffer(Storage::Lists, Raster::Walk)),
    };
    let (stored, _) = render(&mut device, &frame, size);
    frame.transparency = technique(13, Raster::Walk);
    let (peeled, statistics) = render(&mut device, &frame, size);
    assert_identical("coplanar strands", &peeled, &stored);
    let fragments = statistics.fragments;
    assert_eq!(fragments.stored, fragments.produced, "{fragments:?}");
}

#[test]
fn peels_out_of_range_are_refused() {
    let Some(mut device) = device() else { return };
    let image = device
        .create_image(8, 8, crate::common::images::FORMAT, false)
        .unwrap();
    for peels in [0, 1025] {
        let frame = Frame {
            hairs: &[],
            lights: &[],
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: technique(peels, Raster::Auto),
        };
        let error = device.render(&frame, &pelage::Target::cleared(&image.colour));
        assert!(
            matches!(&error, Err(Error::InvalidValue(text)) if text.contains("peels")),
            "{error:?}"
        );
    }
}
