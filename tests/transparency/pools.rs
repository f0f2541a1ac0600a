//! Every technique that keeps fragments in a pool, with a hundredth, a tenth and half of what it needs: nothing is erased,
//! what is lost is bounded and counted, and nothing is written outside of the pool.

use pelage::raster::Raster;
use pelage::testing;
use pelage::transparency::a_buffer::{FRAGMENT_BYTES, NODE_BYTES};
use pelage::transparency::{
    ABuffer, Culling, DbkBuffer, KBuffer, KBufferSinglePass, Storage, Transparency,
};
use pelage_reference::error::{alpha_error, colour_error};

use super::kept::{Scene, assert_sums};
use crate::common::device;
use crate::common::images::{Tolerance, write_failure};

/// A technique with a pool.
struct Pooled {
    name: &'static str,
    with_pool: fn(Option<u64>) -> Transparency,
    /// Bytes of a fragment.
    each: u64,
    /// The transmittance behind which it may store nothing.
    epsilon: f64,
}

fn pooled() -> Vec<Pooled> {
    let a_buffer: [(_, fn(_) -> _, _); 3] = [
        (
            "a_buffer, counted",
            |pool_bytes| {
                Transparency::ABuffer(ABuffer {
                    pool_bytes,
                    raster: Raster::Walk,
                    storage: Storage::Counted,
                })
            },
            FRAGMENT_BYTES,
        ),
        (
            "a_buffer, counted, ribbons",
            |pool_bytes| {
                Transparency::ABuffer(ABuffer {
                    pool_bytes,
                    raster: Raster::Ribbons,
                    storage: Storage::Counted,
                })
            },
            FRAGMENT_BYTES,
        ),
        (
            "a_buffer, lists",
            |pool_bytes| {
                Transparency::ABuffer(ABuffer {
                    pool_bytes,
                    raster: Raster::Walk,
                    storage: Storage::Lists,
                })
            },
            NODE_BYTES,
        ),
    ];
    let k_buffer: [(_, fn(_) -> _, _); 3] = [
        (
            "k_buffer, counted",
            |pool_bytes| {
                Transparency::KBuffer(KBuffer {
                    pool_bytes,
                    storage: Storage::Counted,
                    ..KBuffer::default()
                })
            },
            FRAGMENT_BYTES,
        ),
        (
            "k_buffer, lists",
            |pool_bytes| {
                Transparency::KBuffer(KBuffer {
                    pool_bytes,
                    storage: Storage::Lists,
                    ..KBuffer::default()
                })
            },
            NODE_BYTES,
        ),
        (
            "k_buffer_single_pass",
            |pool_bytes| {
                Transparency::KBufferSinglePass(KBufferSinglePass {
                    pool_bytes,
                    k: 16,
                    ..KBufferSinglePass::default()
                })
            },
            NODE_BYTES,
        ),
    ];
    let exact = a_buffer.into_iter().chain(k_buffer);
    let mut pooled: Vec<Pooled> = exact
        .map(|(name, with_pool, each)| Pooled {
            name,
            with_pool,
            each,
            epsilon: 0.0,
        })
        .collect();
    pooled.push(Pooled {
        name: "dbk_buffer",
        with_pool: |pool_bytes| {
            Transparency::DbkBuffer(DbkBuffer {
                culling: Culling::Always,
                pool_bytes,
                ..DbkBuffer::default()
            })
        },
        each: FRAGMENT_BYTES,
        epsilon: f64::from(DbkBuffer::default().epsilon),
    });
    pooled
}

/// Of transmittance: what the stored opacities' rounding leaves in a product, and what is not composited further.
const ALPHA: f64 = 1e-3;
const UNSEEN: f64 = 1.0 / 4096.0;
/// Of the colour with any pool, where a white point is about 0.5: as of lists at any opacity, whose lost fragments are the
/// scheduler's choice. Measured here: RMSE at most 0.0134 and p99 0.062 with a hundredth, 0.0119 and 0.055 with a tenth.
const COLOUR: Tolerance = Tolerance {
    rmse: 0.06,
    p99: 0.25,
};

#[test]
fn every_pool_that_is_too_small_erases_nothing_says_so_and_keeps_to_its_bounds() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    scene.hair.opacity = 0.3;
    let expected = scene.exact();
    for pooled in pooled() {
        // As many as it keeps where there is room for all.
        let mut need = 0;
        for _ in 0..2 {
            let (_, statistics) = scene.render(&mut device, (pooled.with_pool)(None));
            need = statistics.fragments.stored;
        }
        for part in [100, 10, 2] {
            testing::guard(&mut device.renderer);
            let room = need / part;
            let technique = (pooled.with_pool)(Some(room * pooled.each));
            let (actual, statistics) = scene.render(&mut device, technique);
            let fragments = statistics.fragments;
            let name = format!("{}, 1/{part} of the pool", pooled.name);
            assert_sums(&name, &fragments, &scene.lists);
            assert!(fragments.stored <= room, "{name}: {fragments:?} in {room}");
            assert!(
                fragments.merged >= need - room,
                "{name}: {fragments:?} of {need}"
            );

            let (guarded, broken) = testing::guards(&mut device.renderer);
            assert!(guarded >= 4, "{name}: {guarded} buffers are guarded");
            assert!(broken.is_empty(), "{name}: written behind {broken:?}");

            let colour = colour_error(&actual, &expected, None);
            let alpha = alpha_error(&actual, &expected, None);
            eprintln!("{name}: {fragments:?}\n  colour {colour:?}\n  alpha {alpha:?}");
            let fine = alpha.rmse <= ALPHA.max(pooled.epsilon)
                && alpha.p99 <= ALPHA + UNSEEN + pooled.epsilon
                && alpha.max_elsewhere == 0.0;
            if !fine || colour.rmse > COLOUR.rmse || colour.p99 > COLOUR.p99 {
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
        }
    }
}

#[test]
fn a_guard_that_is_written_to_is_seen() {
    let Some(mut device) = device() else { return };
    let scene = Scene::new(&mut device);
    testing::guard(&mut device.renderer);
    scene.render(&mut device, Transparency::ABuffer(ABuffer::default()));
    assert_eq!(testing::guards(&mut device.renderer).1, [""; 0]);
    testing::break_guard(&mut device.renderer);
    assert_eq!(
        testing::guards(&mut device.renderer).1,
        ["pelage.transparency.fill"]
    );
}
