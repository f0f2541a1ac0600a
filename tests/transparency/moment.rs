//! Moment-based transparency against the reference.

use pelage::raster::Raster;
use pelage::transparency::{Moment, Transparency};
use pelage_reference::composite::Image;
use pelage_reference::moment::{self, Range, Settings};

use super::kept::{SIZE, Scene, assert_shows, errors, pile, render_pile};
use crate::common::device;
use crate::common::images::Tolerance;

/// What single precision leaves of the moments, whose conditioning is that of a Hankel matrix: measured RMSE and 99th
/// percentile.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 2e-3,
    p99: 8e-3,
};

fn expected(scene: &Scene) -> Image {
    let settings = Settings {
        range: Range::Pixel,
        bias: 1e-5,
        overestimation: 0.5,
        steps: None,
    };
    moment::moment(&scene.lists, scene.opacity(), &settings, scene.colour())
}

fn technique(raster: Raster) -> Transparency {
    Transparency::Moment(Moment { raster })
}

#[test]
fn it_shows_what_the_reference_says_by_either_rasteriser() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    for opacity in [0.1, 0.3, 0.9, 1.0] {
        scene.hair.opacity = opacity;
        let (expected, exact) = (expected(&scene), scene.exact());
        for raster in [Raster::Walk, Raster::Ribbons] {
            let shown = assert_shows(&mut device, &scene, technique(raster), &expected, TOLERANCE);
            let [colour, alpha] = errors(&shown, &exact);
            eprintln!(
                "moment {opacity} {raster:?} against exact: colour {colour:?}, alpha {alpha:?}"
            );
            assert!(alpha.rmse < 1e-4, "{alpha:?}");
            // Of a white of about 0.5, at the opacity at which moments are worst.
            assert!(colour.rmse < 0.05, "{colour:?}");
        }
    }
}

#[test]
fn fragments_of_one_depth_are_averaged_by_opacity() {
    let Some(mut device) = device() else { return };
    let colours = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let hair = pile(&mut device, 100, &colours, 0.3);
    let (image, _) = render_pile(&mut device, &hair, technique(Raster::Walk));
    let middle = image.pixels[8 * 16 + 8];
    assert!(middle[3] > 0.999, "{middle:?}");
    for channel in [0, 2] {
        assert!((middle[channel] - 0.5).abs() < 2e-3, "{middle:?}");
    }
}

#[test]
fn its_memory_does_not_depend_on_the_hair() {
    let Some(mut device) = device() else { return };
    let scene = Scene::new(&mut device);
    let (_, statistics) = scene.render(&mut device, technique(Raster::Walk));
    let held: u64 = ["fill", "links", "overflow", "fragments"]
        .iter()
        .map(|name| {
            let label = format!("pelage.transparency.{name}");
            let held = statistics.bytes.iter().filter(|(held, _)| *held == label);
            held.map(|(_, bytes)| bytes).sum::<u64>()
        })
        .sum();
    let expected = u64::from(SIZE[0]) * u64::from(SIZE[1]) * 56;
    assert!(
        (expected..expected + 2048).contains(&held),
        "{held} {expected}"
    );
}
