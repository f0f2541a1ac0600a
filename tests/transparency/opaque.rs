//! The opaque technique: the nearest fragment's colour at the whole opacity.

use pelage::Frame;
use pelage::glam::Vec3;
use pelage::groom::{BuiltinGroom, builtin};
use pelage::raster::Raster;
use pelage::transparency::{Opaque, Transparency};
use pelage_reference::composite;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{lists, point_radiance, portrait, sunlight};

/// As of the A-buffer. Where two fragments are so near to one another that f32 cannot order them, the winner's colour
/// differs; they are too few for the percentile.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 3e-3,
    p99: 4e-3,
};

#[test]
fn the_nearest_fragment_gives_the_colour_and_all_of_them_the_opacity() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let size = [164, 215];
    for opacity in [1.0, 0.3] {
        hair.opacity = opacity;
        let hairs = [&hair];
        let lights = [sunlight()];
        let view = portrait(size);
        let mut frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view,
            transparency: None,
        };
        let colours = point_radiance(&frame);
        let lists = lists(&frame, size, None);
        let expected = composite::opaque(
            &lists,
            f64::from(opacity),
            composite::point_colours(&colours),
        );
        for raster in [Raster::Walk, Raster::Ribbons] {
            frame.transparency = Some(Transparency::Opaque(Opaque { raster }));
            let (actual, statistics) = render(&mut device, &frame, size);
            assert_close(
                &format!("opaque {opacity} {raster:?}"),
                &actual,
                &expected,
                TOLERANCE,
            );
            let off = statistics.fragments.produced as f64 / lists.fragments.len() as f64 - 1.0;
            assert!(
                off.abs() < 2e-3,
                "{} fragments, {}",
                statistics.fragments.produced,
                lists.fragments.len()
            );
            let (again, _) = render(&mut device, &frame, size);
            assert_identical("opaque again", &again, &actual);
        }
    }
}
