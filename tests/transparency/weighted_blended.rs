//! Weighted blended transparency against the same sums in double precision.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::raster::Raster;
use pelage::transparency::{Transparency, Weight, WeightedBlended};
use pelage::{Error, Frame};
use pelage_reference::blending;
use pelage_reference::composite::point_colours;
use pelage_reference::error::{alpha_error, colour_error};

use super::{extent, portrait_distance};
use crate::common::device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{
    lists, pixel_view, point_radiance, portrait, reference, reversed, sunlight, unshadowed,
};

/// As of the A-buffer: half floats of radiance and single precision of coverage.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 1e-3,
    p99: 4e-3,
};
const SIZE: [u32; 2] = [164, 215];

const WEIGHTS: [Weight; 4] = [
    Weight::Uniform,
    Weight::Cubic,
    Weight::Exponential { falloff: 4.0 },
    Weight::Exponential { falloff: 12.0 },
];

fn technique(weight: Weight, raster: Raster) -> Option<Transparency> {
    let settings = WeightedBlended { weight, raster };
    Some(Transparency::WeightedBlended(settings))
}

/// The weight at a place from 0 to 1, as the settings describe it.
fn weighed(weight: Weight, place: f64, opacity: f64) -> f64 {
    let least = 1.0 / 1024.0;
    match weight {
        Weight::Uniform => 1.0,
        Weight::Cubic => opacity * (1.0 - place).powi(3).max(least),
        Weight::Exponential { falloff } => (-f64::from(falloff) * place).exp().max(least),
    }
}

#[test]
fn every_weight_gives_the_sums_of_the_reference() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
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
            transparency: None,
        };
        let colours = point_radiance(&frame);
        let lists = lists(&frame, SIZE, None);
        let exact = reference(&frame, SIZE, None);
        let [near, far] = extent(&hair, &frame.view);
        for weight in WEIGHTS {
            let expected = blending::weighted_blended(
                &lists,
                f64::from(opacity),
                |fragment, opacity| {
                    let place = (portrait_distance(fragment.depth) - near) / (far - near);
                    weighed(weight, place.clamp(0.0, 1.0), opacity)
                },
                point_colours(&colours),
            );
            let error = colour_error(&expected, &exact, None);
            eprintln!("{weight:?}, opacity {opacity}, against the exact composite: {error:?}");
            for raster in [Raster::Walk, Raster::Ribbons] {
                frame.transparency = technique(weight, raster);
                let (actual, statistics) = render(&mut device, &frame, SIZE);
                let name = format!("weighted {weight:?} {opacity} {raster:?}");
                assert_close(&name, &actual, &expected, TOLERANCE);
                let off = statistics.fragments.produced as f64 / lists.fragments.len() as f64;
                assert!((off - 1.0).abs() < 2e-3, "{name}: {off}");
                let (again, _) = render(&mut device, &frame, SIZE);
                assert_identical(&name, &again, &actual);
            }
        }
        let forward = {
            frame.transparency = technique(WEIGHTS[2], Raster::Walk);
            render(&mut device, &frame, SIZE).0
        };
        frame.view = reversed(&frame.view);
        let (turned, _) = render(&mut device, &frame, SIZE);
        assert_close("weighted, reversed depth", &turned, &forward, TOLERANCE);
    }
}

#[test]
fn a_lone_faint_fibre_at_the_far_end_keeps_its_colour() {
    let Some(mut device) = device() else { return };
    // Two fibres far apart, so that the second one has the least weight there is.
    let points = vec![
        [-8.0, 4.0, 9.0],
        [8.0, 4.0, 9.0],
        [-8.0, -4.0, -9.0],
        [8.0, -4.0, -9.0],
    ];
    let strands = pelage::groom::Strands::new(points, &[2, 2], 0.02).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (crate::common::scenes::WHITE, 0.05);
    let size = [16, 16];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::new(1.0, 0.5, 0.25))];
    for weight in WEIGHTS
        .into_iter()
        .chain([Weight::Exponential { falloff: 100.0 }])
    {
        let frame = Frame {
            hairs: &[&hair],
            lights: &lights,
            ambient: Vec3::ZERO,
            view: pixel_view(size, 10.0),
            transparency: technique(weight, Raster::Walk),
        };
        let expected = reference(&frame, size, None);
        let (actual, _) = render(&mut device, &frame, size);
        let (colour, alpha) = (
            colour_error(&actual, &expected, None),
            alpha_error(&actual, &expected, None),
        );
        eprintln!("lone fibre, {weight:?}: {colour:?} {alpha:?}");
        // 2^-25 / w of the brightest for weights of 1/1024, and opacity² × that for the cubic one at 0.002: 0.02 there.
        let allowed = if weight == Weight::Cubic { 1e-3 } else { 1e-4 };
        assert!(colour.max < allowed && alpha.max < 1e-4, "{weight:?}");
    }
}

#[test]
fn a_falloff_out_of_range_is_refused() {
    let Some(mut device) = device() else { return };
    for falloff in [-1.0, 101.0, f32::NAN, f32::INFINITY] {
        let frame = Frame {
            hairs: &[],
            lights: &[],
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: technique(Weight::Exponential { falloff }, Raster::Auto),
        };
        let image = device
            .create_image(8, 8, crate::common::images::FORMAT, false)
            .unwrap();
        let error = device.render(&frame, &pelage::Target::cleared(&image.colour));
        assert!(
            matches!(&error, Err(Error::InvalidValue(text)) if text.contains("falloff")),
            "{error:?}"
        );
    }
}
