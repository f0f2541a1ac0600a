//! The k-buffer from the A-buffer against the reference.

use pelage::raster::Raster;
use pelage::transparency::{ABuffer, KBuffer, Rest, Selection, Storage, Transparency};

use super::kept::{Scene, assert_overflows_gracefully, assert_shows, errors, pile, render_pile};
use crate::common::device;
use crate::common::images::{Tolerance, assert_identical};

/// As of the A-buffer. Where two fragments are so near to one another that f32 cannot order them, the K-th may be another
/// one; such pixels are too few for the percentile.
const TOLERANCE: Tolerance = Tolerance {
    rmse: 2e-3,
    p99: 4e-3,
};
/// Of a hundredth, a tenth and half of the pool against the exact composite, of which a white point is about 0.5.
const OVERFLOW: [Tolerance; 3] = [
    Tolerance {
        rmse: 0.05,
        p99: 0.2,
    },
    Tolerance {
        rmse: 0.015,
        p99: 0.07,
    },
    Tolerance {
        rmse: 0.015,
        p99: 0.07,
    },
];

fn k_buffer(k: u32, rest: Rest, selection: Selection) -> KBuffer {
    KBuffer {
        k,
        rest,
        selection,
        raster: Raster::Walk,
        ..KBuffer::default()
    }
}

#[test]
fn the_k_nearest_and_the_rest_are_what_the_reference_says_whatever_the_selection() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    for (opacity, k, rest) in [
        (0.3, 2, Rest::Merged),
        (0.3, 13, Rest::Alpha),
        (0.3, 64, Rest::Dropped),
        (0.9, 8, Rest::Dropped),
        (1.0, 1, Rest::Merged),
    ] {
        scene.hair.opacity = opacity;
        let expected = scene.kept(k, rest);
        let images = [Selection::Registers, Selection::Rounds, Selection::Sort].map(|selection| {
            let technique = Transparency::KBuffer(k_buffer(k, rest, selection));
            assert_shows(&mut device, &scene, technique, &expected, TOLERANCE)
        });
        for image in &images[1..] {
            assert_identical(&format!("selections, k {k} {rest:?}"), image, &images[0]);
        }
    }
}

#[test]
fn either_storage_and_either_rasteriser_give_the_same() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    scene.hair.opacity = 0.4;
    let expected = scene.kept(8, Rest::Merged);
    let images = [
        (Storage::Counted, Raster::Walk),
        (Storage::Lists, Raster::Walk),
        (Storage::Lists, Raster::Ribbons),
    ]
    .map(|(storage, raster)| {
        let technique = Transparency::KBuffer(KBuffer {
            k: 8,
            storage,
            raster,
            ..KBuffer::default()
        });
        assert_shows(&mut device, &scene, technique, &expected, TOLERANCE)
    });
    assert_identical("walk, counted against lists", &images[1], &images[0]);
}

#[test]
fn with_enough_of_them_it_is_the_a_buffer() {
    let Some(mut device) = device() else { return };
    let mut scene = Scene::new(&mut device);
    scene.hair.opacity = 0.8;
    let a_buffer = Transparency::ABuffer(ABuffer::default());
    let (expected, _) = scene.render(&mut device, a_buffer);
    let technique = Transparency::KBuffer(k_buffer(64, Rest::Merged, Selection::Registers));
    let (actual, _) = scene.render(&mut device, technique);
    let [colour, alpha] = errors(&actual, &expected);
    // Bit for bit, except in a few pixels in which more than 64 thin fragments are seen.
    assert!(colour.p99 == 0.0 && colour.max < 1e-3, "{colour:?}");
    assert!(alpha.p99 == 0.0 && alpha.max < 1e-3, "{alpha:?}");
}

#[test]
fn of_equal_depths_the_first_points_are_kept() {
    let Some(mut device) = device() else { return };
    let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let hair = pile(&mut device, 100, &colours, 0.3);
    let exact = Transparency::ABuffer(ABuffer::default());
    let (exact, _) = render_pile(&mut device, &hair, exact);
    for (k, storage, allowed) in [(64, Storage::Counted, 1e-5), (16, Storage::Lists, 4e-3)] {
        let technique = KBuffer {
            k,
            storage,
            ..KBuffer::default()
        };
        let technique = Transparency::KBuffer(technique);
        let (actual, _) = render_pile(&mut device, &hair, technique);
        let [colour, alpha] = errors(&actual, &exact);
        assert!(colour.max < allowed, "{k}: {colour:?}");
        assert!(alpha.max < 4e-4, "{k}: {alpha:?}");
        let (again, _) = render_pile(&mut device, &hair, technique);
        assert_identical("pile again", &again, &actual);
    }
}

#[test]
fn a_pool_that_is_too_small_hides_nothing() {
    let Some(mut device) = device() else { return };
    assert_overflows_gracefully(
        &mut device,
        |bytes| {
            Transparency::KBuffer(KBuffer {
                pool_bytes: Some(bytes),
                ..k_buffer(16, Rest::Merged, Selection::Registers)
            })
        },
        pelage::transparency::a_buffer::FRAGMENT_BYTES,
        |_, scene| scene.lists.fragments.len() as u64,
        OVERFLOW,
        true,
    );
}

#[test]
fn settings_out_of_range_are_named() {
    for k in [0, 65, u32::MAX] {
        let settings = KBuffer {
            k,
            ..KBuffer::default()
        };
        let error = Transparency::KBuffer(settings).validate().unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("k_buffer: k {k} is not from 1 to 64")
        );
    }
}
