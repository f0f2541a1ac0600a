//! The single-pass k-buffer against the reference.

use pelage::raster::Raster;
use pelage::transparency::a_buffer::NODE_BYTES;
use pelage::transparency::{ABuffer, KBufferSinglePass, Rest, Transparency};

use super::kept::{Scene, assert_overflows_gracefully, assert_shows, errors, pile, render_pile};
use crate::common::device;
use crate::common::images::Tolerance;

/// As of the k-buffer.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 2e-3,
    p99: 4e-3,
};
/// Of a hundredth, a tenth and half of the pool: which fragments miss out is the scheduler's choice, so that these are bounds
/// which it does not reach. A white point is about 0.5.
const OVERFLOW: [Tolerance; 3] = [Tolerance {
    rmse: 0.06,
    p99: 0.25,
}; 3];

fn single_pass(k: u32, rest: Rest) -> KBufferSinglePass {
    KBufferSinglePass {
        k,
        rest,
        raster: Raster::Walk,
        ..KBufferSinglePass::default()
    }
}

#[test]
fn the_k_nearest_and_the_rest_are_what_the_reference_says_bit_for_bit_each_time() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    for (opacity, k, rest) in [
        (0.3, 2, Rest::Merged),
        (0.3, 13, Rest::Alpha),
        (0.3, 33, Rest::Dropped),
        (1.0, 1, Rest::Merged),
    ] {
        scene.hair.opacity = opacity;
        let expected = scene.kept(k, rest);
        for raster in [Raster::Walk, Raster::Ribbons] {
            let technique = Transparency::KBufferSinglePass(KBufferSinglePass {
                raster,
                ..single_pass(k, rest)
            });
            // The first frame's pool is an estimate.
            scene.render(&mut device, technique);
            assert_shows(&mut device, &scene, technique, &expected, TOLERANCE);
        }
    }
}

#[test]
fn it_stores_less_than_all_and_more_than_k_of_each_pixel() {
    let Some(mut device) = device() else { return };
    let scene = Scene::new(&mut device);
    let technique = Transparency::KBufferSinglePass(single_pass(4, Rest::Merged));
    scene.render(&mut device, technique);
    let (_, statistics) = scene.render(&mut device, technique);
    let fragments = statistics.fragments;
    let kept: u64 = (0..scene.lists.pixels())
        .map(|pixel| scene.lists.pixel(pixel).len().min(4) as u64)
        .sum();
    assert!(fragments.stored > kept * 99 / 100, "{fragments:?} {kept}");
    assert!(
        fragments.stored < scene.lists.fragments.len() as u64 * 3 / 4,
        "{fragments:?}"
    );
}

#[test]
fn of_equal_depths_the_first_points_are_kept() {
    let Some(mut device) = device() else { return };
    let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let hair = pile(&mut device, 100, &colours, 0.3);
    let exact = Transparency::ABuffer(ABuffer::default());
    let (exact, _) = render_pile(&mut device, &hair, exact);
    let technique = Transparency::KBufferSinglePass(single_pass(64, Rest::Merged));
    render_pile(&mut device, &hair, technique);
    let (actual, _) = render_pile(&mut device, &hair, technique);
    let [colour, alpha] = errors(&actual, &exact);
    assert!(colour.max < 1e-5, "{colour:?}");
    assert!(alpha.max < 4e-4, "{alpha:?}");
}

#[test]
fn what_gives_up_at_once_is_merged_and_erases_nothing() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    scene.hair.opacity = 0.5;
    let exact = scene.exact();
    for rest in [Rest::Merged, Rest::Alpha] {
        let technique = Transparency::KBufferSinglePass(KBufferSinglePass {
            retries: 0,
            ..single_pass(16, rest)
        });
        scene.render(&mut device, technique);
        let (actual, _) = scene.render(&mut device, technique);
        let [colour, alpha] = errors(&actual, &exact);
        eprintln!("no retries, {rest:?}: colour {colour:?}, alpha {alpha:?}");
        assert!(alpha.rmse < 1e-3 && alpha.p99 < 2e-3, "{alpha:?}");
        assert!(colour.rmse < OVERFLOW[0].rmse, "{colour:?}");
    }
}

#[test]
fn a_pool_that_is_too_small_hides_nothing() {
    let Some(mut device) = device() else { return };
    let technique = |bytes| {
        Transparency::KBufferSinglePass(KBufferSinglePass {
            pool_bytes: Some(bytes),
            ..single_pass(16, Rest::Merged)
        })
    };
    assert_overflows_gracefully(
        &mut device,
        technique,
        NODE_BYTES,
        |_, scene| scene.lists.fragments.len() as u64,
        OVERFLOW,
        false,
    );
}

#[test]
fn settings_out_of_range_are_named() {
    let message = |settings| {
        let technique = Transparency::KBufferSinglePass(settings);
        technique.validate().unwrap_err().to_string()
    };
    assert_eq!(
        message(single_pass(0, Rest::Merged)),
        "k_buffer_single_pass: k 0 is not from 1 to 64"
    );
    let retries = 256;
    assert_eq!(
        message(KBufferSinglePass {
            retries,
            ..KBufferSinglePass::default()
        }),
        "k_buffer_single_pass: retries 256 is more than 255"
    );
}
