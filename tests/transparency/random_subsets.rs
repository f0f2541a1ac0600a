//! Random subsets against the same rule in double precision.

use pelage::glam::Vec3;
use pelage::groom::{BuiltinGroom, builtin};
use pelage::raster::Raster;
use pelage::transparency::{Opaque, RandomSubsets, Transparency};
use pelage::{Error, Frame};
use pelage_reference::blending;
use pelage_reference::composite::point_colours;
use pelage_reference::error::colour_error;

use crate::common::device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render};
use crate::common::scenes::{lists, point_radiance, portrait, reference, sunlight, world};

/// Where two fragments are so near to one another that f32 cannot order them, a subset shows the other one; and slivers of
/// opacity below 1e-10 are none. As of the opaque technique.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 3e-3,
    p99: 6e-3,
};
const SIZE: [u32; 2] = [164, 215];

/// MurmurHash3's finaliser.
fn mix(word: u32) -> u32 {
    let a = (word ^ (word >> 16)).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}

/// The subset of a strand of a hair.
fn subset(hair: u32, strand: u32, seed: u32, subsets: u32) -> usize {
    let hash = mix(strand ^ mix(hair ^ mix(seed.wrapping_add(0x9e37_79b9)))) >> 16;
    ((hash * subsets) >> 16) as usize
}

#[test]
fn subsets_are_parted_evenly_and_anew_by_every_seed() {
    for (hair, seed) in [(0, 0), (3, 1), (0x0002_0001, 77)] {
        let mut counts = [0; 8];
        for strand in 0..8_000 {
            counts[subset(hair, strand, seed, 8)] += 1;
        }
        assert!(
            counts.iter().all(|count| (850..1150).contains(count)),
            "{counts:?}"
        );
        let same = (0..8_000).filter(|&s| subset(hair, s, seed, 8) == subset(hair, s, seed + 1, 8));
        assert!((850..1150).contains(&same.count()));
    }
}

#[test]
fn the_nearest_of_each_subset_are_composited() {
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
        let sources = world(&hairs).sources;
        let exact = reference(&frame, SIZE, None);
        for (subsets, seed, exact_alpha) in
            [(3, 5, true), (8, 0, true), (8, 0, false), (32, 9, true)]
        {
            let of = |strand: u32| subset(0, sources[strand as usize].1 as u32, seed, subsets);
            let expected = blending::random_subsets(
                &lists,
                f64::from(opacity),
                of,
                exact_alpha,
                point_colours(&colours),
            );
            let name = format!("{subsets} subsets, exact alpha {exact_alpha}, opacity {opacity}");
            let error = colour_error(&expected, &exact, None);
            eprintln!("{name}, against the exact composite: {error:?}");
            for raster in [Raster::Walk, Raster::Ribbons] {
                frame.transparency = Some(Transparency::RandomSubsets(RandomSubsets {
                    subsets,
                    seed,
                    exact_alpha,
                    raster,
                }));
                let (actual, _) = render(&mut device, &frame, SIZE);
                let name = format!("{name}, {raster:?}");
                assert_close(&name, &actual, &expected, TOLERANCE);
                let (again, _) = render(&mut device, &frame, SIZE);
                assert_identical(&name, &again, &actual);
            }
        }
        let mut of = |transparency| {
            frame.transparency = Some(transparency);
            render(&mut device, &frame, SIZE).0
        };
        let one = of(Transparency::RandomSubsets(RandomSubsets {
            subsets: 1,
            ..Default::default()
        }));
        let opaque = of(Transparency::Opaque(Opaque::default()));
        assert_close("one subset is opaque", &one, &opaque, TOLERANCE);
    }
}

#[test]
fn its_memory_is_that_of_its_words() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 100).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    // Hunz's image: 34.47 MiB at 8 bytes a pixel and subset, 43.09 with his depth buffers.
    let size = [656, 861];
    let frame = Frame {
        hairs: &[&hair],
        lights: &[],
        ambient: Vec3::ONE,
        view: portrait(size),
        transparency: Some(Transparency::RandomSubsets(RandomSubsets::default())),
    };
    let (_, statistics) = render(&mut device, &frame, size);
    let pixels = statistics
        .bytes
        .iter()
        .filter(|(label, _)| label.starts_with("pelage.transparency."))
        .map(|(_, bytes)| *bytes)
        .sum::<u64>();
    let stated = u64::from(size[0] * size[1]) * (8 * 8 + 4);
    assert!(
        pixels >= stated && pixels < stated + 4096,
        "{pixels} bytes, {stated} stated"
    );
    assert_eq!((stated as f64 / f64::from(1 << 20) * 100.0).round(), 3663.0);
}

#[test]
fn subsets_out_of_range_are_refused() {
    let Some(mut device) = device() else { return };
    let image = device
        .create_image(8, 8, crate::common::images::FORMAT, false)
        .unwrap();
    for subsets in [0, 33] {
        let frame = Frame {
            hairs: &[],
            lights: &[],
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: Some(Transparency::RandomSubsets(RandomSubsets {
                subsets,
                ..Default::default()
            })),
        };
        let error = device.render(&frame, &pelage::Target::cleared(&image.colour));
        assert!(
            matches!(&error, Err(Error::InvalidValue(text)) if text.contains("subsets")),
            "{error:?}"
        );
    }
}
