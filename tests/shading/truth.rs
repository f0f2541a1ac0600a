//! A ball of 5,000 strands that other software has traced with Chiang's model: ../shared/truth/images.

use std::path::{Path, PathBuf};

use pelage::glam::{DVec3, Vec3};
use pelage::groom::formats;
use pelage::shading::{Chiang, DualScattering, Shading};
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::{Frame, Light, View};

use crate::common::{Device, device, images};

const SIZE: usize = 256;
/// Pixels a side of the blocks that are compared: single pixels of the truth are noisy.
const BLOCK: usize = 16;

/// The truth's folder; without it the test is skipped by name.
fn truth(test: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let found = root.join("../shared/truth/images");
    if !found.exists() {
        println!("skipped: {test}: ../shared/truth/images is not there");
        return None;
    }
    Some(found)
}

fn read(path: &Path) -> Vec<[f32; 4]> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![[0.0f32; 4]; size.width() * size.height()],
        |pixels, at, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[at.y() * SIZE + at.x()] = [r, g, b, a];
        },
    )
    .unwrap();
    image.layer_data.channel_data.pixels
}

/// Draws the ball.
fn draw(device: &mut Device, folder: &Path, chiang: Chiang, shadow: Shadow) -> Vec<[f32; 4]> {
    let bytes = std::fs::read(folder.join("ball.hair")).unwrap();
    let strands = formats::read_hair(&bytes)
        .unwrap()
        .with_root_tip_radii(0.0025, 0.0025)
        .unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.shading = Shading::Chiang(chiang);
    let frame = Frame {
        hairs: &[&hair],
        lights: &[Light {
            shadow: Some(shadow),
            ..Light::directional(
                DVec3::new(-0.6, -0.7, -0.6),
                Vec3::splat(std::f32::consts::PI),
            )
        }],
        ambient: Vec3::ZERO,
        view: View::perspective(
            DVec3::new(0.0, 0.4, 3.0),
            DVec3::ZERO,
            DVec3::Y,
            36f64.to_radians(),
            1.0,
            [0.1, 10.0],
        )
        .unwrap(),
        transparency: None,
    };
    // The first frame's pool is a guess; what does not fit would be merged.
    images::render(device, &frame, [SIZE as u32; 2]);
    let (image, _) = images::render(device, &frame, [SIZE as u32; 2]);
    image.pixels.iter().map(|p| p.map(|v| v as f32)).collect()
}

struct Comparison {
    /// Mean of the image over that of the truth, a channel.
    ratio: [f64; 3],
    /// Root of the mean square over blocks, of the truth's mean over all.
    rmse: f64,
    coverage: f64,
}

fn compare(name: &str, actual: &[[f32; 4]], expected: &[[f32; 4]]) -> Comparison {
    let mean = |image: &[[f32; 4]], c: usize| {
        image.iter().map(|p| f64::from(p[c])).sum::<f64>() / image.len() as f64
    };
    let ratio = [0, 1, 2].map(|c| mean(actual, c) / mean(expected, c));
    let blocks = SIZE / BLOCK;
    let block = |image: &[[f32; 4]], number: usize, c: usize| {
        let (row, column) = (number / blocks * BLOCK, number % blocks * BLOCK);
        (0..BLOCK * BLOCK)
            .map(|i| f64::from(image[(row + i / BLOCK) * SIZE + column + i % BLOCK][c]))
            .sum::<f64>()
            / (BLOCK * BLOCK) as f64
    };
    let (mut off, mut whole) = (0.0, 0.0);
    for number in 0..blocks * blocks {
        for c in 0..3 {
            let truth = block(expected, number, c);
            off += (block(actual, number, c) - truth).powi(2);
            whole += truth * truth;
        }
    }
    let comparison = Comparison {
        ratio,
        rmse: (off / whole).sqrt(),
        coverage: mean(actual, 3) / mean(expected, 3),
    };
    eprintln!(
        "ball {name}: mean {:.4?} of the truth's, blocks' rmse {:.4}, coverage {:.4}",
        comparison.ratio, comparison.rmse, comparison.coverage
    );
    comparison
}

fn ball() -> Chiang {
    Chiang {
        sigma_a: Vec3::new(0.06, 0.10, 0.20),
        ..Chiang::default()
    }
}

/// Of the mean, and of the blocks' root mean square.
const UNSHADOWED: [f64; 2] = [0.02, 0.05];

#[test]
fn the_unshadowed_ball_is_that_of_another_renderer() {
    let Some(folder) = truth("the_unshadowed_ball_is_that_of_another_renderer") else {
        return;
    };
    let Some(mut device) = device() else { return };
    let expected = read(&folder.join("ball_unshadowed.exr"));
    for (name, model) in [
        ("tables", ball()),
        (
            "direct",
            Chiang {
                tables: None,
                ..ball()
            },
        ),
    ] {
        let actual = draw(&mut device, &folder, model, Shadow::None);
        let found = compare(&format!("unshadowed, {name}"), &actual, &expected);
        assert!(
            found.ratio.iter().all(|r| (r - 1.0).abs() <= UNSHADOWED[0]),
            "{:?}",
            found.ratio
        );
        assert!(found.rmse <= UNSHADOWED[1], "{}", found.rmse);
    }
}

/// Of the mean, and of the blocks' root mean square.
const SINGLE: [f64; 2] = [0.05, 0.10];

#[test]
fn the_singly_scattered_ball_is_that_of_another_renderer() {
    let Some(folder) = truth("the_singly_scattered_ball_is_that_of_another_renderer") else {
        return;
    };
    let Some(mut device) = device() else { return };
    let expected = read(&folder.join("ball_single.exr"));
    let map = DeepOpacityMap::default();
    let mut maps = vec![
        ("default", map),
        (
            "best",
            DeepOpacityMap {
                resolution: 1024,
                layers: 16,
                pcf: 3,
                ..map
            },
        ),
    ];
    if std::env::var_os("PELAGE_TEST_VARIANTS").is_some() {
        for pcf in [1, 3] {
            for resolution in [256, 512, 1024] {
                for layers in [4, 8, 16] {
                    maps.push((
                        "variant",
                        DeepOpacityMap {
                            resolution,
                            layers,
                            pcf,
                            ..map
                        },
                    ));
                }
            }
        }
    }
    for (name, map) in maps {
        let actual = draw(&mut device, &folder, ball(), Shadow::DeepOpacityMap(map));
        let found = compare(
            &format!("single scattering, {name} {map:?}"),
            &actual,
            &expected,
        );
        if name != "variant" {
            assert!(
                found.ratio.iter().all(|r| (r - 1.0).abs() <= SINGLE[0]),
                "{:?}",
                found.ratio
            );
            assert!(found.rmse <= SINGLE[1], "{}", found.rmse);
        }
    }
}

/// Of the mean, a channel, and of the blocks' root mean square. Measured: 0.98, 0.98, 1.08; 0.26. With `disorder` 0, which is the
/// papers' model, and densities of 1 the means are as near (1.01, 0.90, 0.81), but the blocks' rmse is 0.58: the lit rim too
/// bright by a half, the core without light, since all light keeps to the light's own way. What is left is that the fibres
/// towards the light say nothing of those aside and behind: a thin rim gets back what hair without end would send.
const FULL: [f64; 2] = [0.12, 0.3];

#[test]
fn the_fully_scattered_ball_is_near_that_of_another_renderer() {
    let Some(folder) = truth("the_fully_scattered_ball_is_near_that_of_another_renderer") else {
        return;
    };
    let Some(mut device) = device() else { return };
    let single = read(&folder.join("ball_single.exr"));
    let full = read(&folder.join("ball_full.exr"));
    let map = Shadow::DeepOpacityMap(DeepOpacityMap {
        resolution: 1024,
        ..Default::default()
    });
    let alone = draw(&mut device, &folder, ball(), map);
    compare("single scattering", &alone, &single);
    let dual = Chiang {
        dual_scattering: Some(DualScattering::default()),
        ..ball()
    };
    let actual = draw(&mut device, &folder, dual, map);
    let found = compare("fully scattered", &actual, &full);
    assert!(
        found.ratio.iter().all(|r| (r - 1.0).abs() <= FULL[0]),
        "{:?}",
        found.ratio
    );
    assert!(found.rmse <= FULL[1], "{}", found.rmse);
}
