//! What the tests of the techniques that keep a few fragments of each pixel share: their scene, and its truth.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::transparency::{Rest, Transparency};
use pelage::{Fragments, Frame, Hair, Light, View};
use pelage_reference::composite::{self, Image};
use pelage_reference::error::{ImageError, alpha_error, colour_error};
use pelage_reference::fragments::{Fragment, FragmentLists};
use pelage_reference::k_buffer;

use crate::common::Device;
use crate::common::images::{Tolerance, assert_close, assert_identical, render, write_failure};
use crate::common::scenes::{
    WHITE, lists, pixel_view, point_radiance, portrait, sunlight, unshadowed,
};

pub const SIZE: [u32; 2] = [164, 215];

/// Three thousand straight strands: up to a hundred fragments a pixel.
pub struct Scene {
    pub hair: Hair,
    pub lights: [Light; 1],
    pub view: View,
    pub lists: FragmentLists,
    colours: Vec<[f64; 3]>,
}

impl Scene {
    pub fn new(device: &mut Device) -> Self {
        let strands = builtin(BuiltinGroom::Straight, 3_000).unwrap();
        let hair = device.renderer.create_hair(&strands).unwrap();
        let lights = [sunlight()];
        let view = portrait(SIZE);
        let mut scene = Self {
            hair,
            lights,
            view,
            lists: FragmentLists {
                width: 0,
                height: 0,
                offsets: vec![0],
                fragments: Vec::new(),
            },
            colours: Vec::new(),
        };
        let hairs = [&scene.hair];
        let frame = scene.frame(&hairs, Transparency::default());
        let (lists, colours) = (lists(&frame, SIZE, None), point_radiance(&frame));
        scene.lists = lists;
        scene.colours = colours;
        scene
    }

    pub fn frame<'a>(&'a self, hairs: &'a [&'a Hair], technique: Transparency) -> Frame<'a> {
        Frame {
            hairs,
            lights: &self.lights,
            ambient: Vec3::ZERO,
            view: self.view,
            transparency: Some(technique),
        }
    }

    pub fn render(
        &self,
        device: &mut Device,
        technique: Transparency,
    ) -> (Image, pelage::Statistics) {
        render(device, &self.frame(&[&self.hair], technique), SIZE)
    }

    pub fn colour(&self) -> impl Fn(&Fragment) -> [f64; 3] + Sync + '_ {
        composite::point_colours(&self.colours)
    }

    pub fn opacity(&self) -> f64 {
        f64::from(self.hair.opacity)
    }

    /// The exact sorted composite.
    pub fn exact(&self) -> Image {
        composite::composite(&self.lists, self.opacity(), self.colour())
    }

    /// What a k-buffer should show.
    pub fn kept(&self, k: u32, rest: Rest) -> Image {
        let rest = match rest {
            Rest::Merged => k_buffer::Rest::Merged,
            Rest::Alpha => k_buffer::Rest::Alpha,
            Rest::Dropped => k_buffer::Rest::Dropped,
        };
        k_buffer::k_buffer(&self.lists, self.opacity(), k as usize, rest, self.colour())
    }
}

/// Asserts that a technique shows what the reference says, twice the same, and that its counters add up.
pub fn assert_shows(
    device: &mut Device,
    scene: &Scene,
    technique: Transparency,
    expected: &Image,
    tolerance: Tolerance,
) -> Image {
    let name = format!(
        "{} {technique:?} opacity {}",
        technique.stem(),
        scene.hair.opacity
    );
    let (actual, statistics) = scene.render(device, technique);
    assert_close(&name, &actual, expected, tolerance);
    assert_sums(&name, &statistics.fragments, &scene.lists);
    let (again, _) = scene.render(device, technique);
    assert_identical(&format!("{name} again"), &again, &actual);
    actual
}

/// Asserts that every fragment was stored, merged or dropped. In f32 a sliver of a pixel may round to no coverage, or out
/// of it.
pub fn assert_sums(name: &str, fragments: &Fragments, lists: &FragmentLists) {
    assert_eq!(
        fragments.produced,
        fragments.stored + fragments.merged + fragments.culled,
        "{name}: {fragments:?}"
    );
    let expected = lists.fragments.len() as f64;
    assert!(
        (fragments.produced as f64 / expected - 1.0).abs() < 2e-3,
        "{name}: {fragments:?}, {expected} expected"
    );
}

/// With a pool of a hundredth, a tenth and half of the need: nothing is erased, and the error is bounded and said.
pub fn assert_overflows_gracefully(
    device: &mut Device,
    technique: impl Fn(u64) -> Transparency,
    each: u64,
    need: impl Fn(&mut Device, &Scene) -> u64,
    bounds: [Tolerance; 3],
    deterministic: bool,
) {
    /// As of the A-buffer: what the stored opacities' rounding leaves in a product, and what is not composited further.
    const ALPHA: f64 = 1e-3;
    const UNSEEN: f64 = 1.0 / 4096.0;
    for opacity in [1.0, 0.3] {
        let mut scene = Scene::new(device);
        scene.hair.opacity = opacity;
        let expected = scene.exact();
        let need = need(device, &scene);
        for (part, bound) in [100, 10, 2].into_iter().zip(bounds) {
            let technique = technique(need / part * each);
            let (actual, statistics) = scene.render(device, technique);
            let name = format!("{} pool 1/{part} opacity {opacity}", technique.stem());
            let fragments = statistics.fragments;
            assert_sums(&name, &fragments, &scene.lists);
            assert!(fragments.stored <= need / part, "{name}: {fragments:?}");
            assert!(fragments.merged > 0, "{name}: {fragments:?}");
            let colour = colour_error(&actual, &expected, None);
            let alpha = alpha_error(&actual, &expected, None);
            eprintln!("{name}: {fragments:?}\n  colour {colour:?}\n  alpha {alpha:?}");
            let fine =
                alpha.rmse <= ALPHA && alpha.p99 <= ALPHA + UNSEEN && alpha.max_elsewhere == 0.0;
            if !fine || colour.rmse > bound.rmse || colour.p99 > bound.p99 {
                write_failure(&name, &actual, &expected);
                panic!("{name}: colour {colour:?}, alpha {alpha:?}");
            }
            for (a, e) in actual.pixels.iter().zip(&expected.pixels) {
                assert!(
                    e[3] < 0.01 || a[3] > 0.9 * e[3],
                    "{name}: alpha {} where {} is exact",
                    a[3],
                    e[3]
                );
            }
            if deterministic {
                let (again, _) = scene.render(device, technique);
                assert_identical(&name, &again, &actual);
            }
        }
    }
}

/// `count` horizontal strands one unit wide, all at one depth, with these colours in turn, over 16×16 pixels.
pub fn pile(device: &mut Device, count: usize, colours: &[[f32; 3]], opacity: f32) -> Hair {
    let points = (0..count)
        .flat_map(|_| [[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
        .collect();
    let colours = (0..count).map(|i| colours[i % colours.len()]).collect();
    let strands = Strands::new(points, &vec![2; count], 1.0)
        .unwrap()
        .with_colours(colours)
        .unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = opacity;
    hair.shading = WHITE;
    hair
}

/// That pile, lit from the front.
pub fn render_pile(
    device: &mut Device,
    hair: &Hair,
    technique: Transparency,
) -> (Image, pelage::Statistics) {
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let size = [16, 16];
    let frame = Frame {
        hairs: &[hair],
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(size, 64.0),
        transparency: Some(technique),
    };
    render(device, &frame, size)
}

/// The error of a technique against the exact composite, for those that ask.
pub fn errors(actual: &Image, exact: &Image) -> [ImageError; 2] {
    [
        colour_error(actual, exact, None),
        alpha_error(actual, exact, None),
    ]
}
