//! Counts, strands, guides and files that are wrong: each an error whose sentence names the value, and no hair.

use std::ptr::null;

use super::support::*;
use pelage::capi::*;

fn create_file(
    context: &Context,
    bytes: &[u8],
    change: impl FnOnce(&mut PelageFile),
) -> PelageResult {
    let mut hair = PelageHair { id: UNTOUCHED };
    let mut file = PelageFile {
        bytes: bytes.as_ptr().cast(),
        size: bytes.len() as u64,
        ..Default::default()
    };
    change(&mut file);
    // SAFETY: as above.
    let result = unsafe { pelage_hair_create_from_file(context.0, &file, &mut hair) };
    assert_eq!(result == PELAGE_OK, hair.id != UNTOUCHED);
    result
}

#[test]
fn counts_that_are_huge_negative_or_zero_are_refused_before_memory_is_touched() {
    let context = Context::new();
    let arrays = Arrays::crossing();
    for count in [
        u64::MAX,
        i64::MAX as u64,
        -1i64 as u64,
        -5i64 as u64,
        1 << 61,
        (1 << 28) + 1,
    ] {
        let strands = PelageStrands {
            point_count: count,
            ..arrays.strands()
        };
        wrong(create(&context, &strands), &format!("positions…{}", count));
        let strands = PelageStrands {
            strand_count: count,
            ..arrays.strands()
        };
        wrong(create(&context, &strands), &format!("counts…{}", count));
    }
    let strands = PelageStrands {
        point_count: 4,
        ..arrays.strands()
    };
    wrong(create(&context, &strands), "5 points…4 are given");
    let zero = Arrays {
        counts: vec![0, 5],
        ..Arrays::crossing()
    };
    wrong(create(&context, &zero.strands()), "strand 0…0 points");
    let huge = Arrays {
        counts: vec![u32::MAX, u32::MAX],
        ..Arrays::crossing()
    };
    wrong(create(&context, &huge.strands()), "4294967295");
    ok(create(&context, &PelageStrands::default()));
}

#[test]
fn strands_out_of_range_are_named_by_strand_and_point() {
    let context = Context::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut arrays = Arrays::crossing();
        arrays.positions[4][1] = bad;
        wrong(
            create(&context, &arrays.strands()),
            "strand 1, point 1…not finite",
        );
    }
    let arrays = Arrays::crossing();
    let refused = |strands: PelageStrands, words: &str| wrong(create(&context, &strands), words);
    refused(
        PelageStrands {
            root_radius: -1.0,
            ..arrays.strands()
        },
        "root_radius -1",
    );
    refused(
        PelageStrands {
            tip_radius: f32::NAN,
            ..arrays.strands()
        },
        "tip_radius NaN",
    );
    let radii = [0.1, 0.1, -2.0, 0.1, 0.1];
    refused(
        PelageStrands {
            radii: radii.as_ptr(),
            ..arrays.strands()
        },
        "strand 0, point 2…-2",
    );
    let colours = [1.0, 1.0, 1.0, 1.0, f32::INFINITY, 1.0];
    refused(
        PelageStrands {
            colours: colours.as_ptr(),
            ..arrays.strands()
        },
        "strand 1…colour",
    );
    let coordinates = [0.0, 0.5, 0.4, 0.0, 1.0];
    refused(
        PelageStrands {
            coordinates: coordinates.as_ptr(),
            ..arrays.strands()
        },
        "strand 0, point 2…0.4",
    );
    let bytes = [0u8; 64];
    let odd = bytes
        .as_ptr()
        .wrapping_add(1 + bytes.as_ptr().align_offset(4));
    refused(
        PelageStrands {
            positions: odd.cast(),
            ..arrays.strands()
        },
        "positions…no multiple of 4",
    );
}

#[test]
fn guides_and_their_settings_are_checked() {
    let context = Context::new();
    let arrays = Arrays {
        positions: vec![
            [0.0; 3],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
        ],
        counts: vec![2; 3],
    };
    let (triangle, mut hair) = ([0u32, 1, 2], PelageHair { id: UNTOUCHED });
    let given = PelageInterpolationSettings {
        triangles: triangle.as_ptr(),
        triangle_count: 1,
        density: 100.0,
        ..Default::default()
    };
    let mut mesh = |settings: PelageInterpolationSettings| {
        // SAFETY: wrong values are what the call must notice.
        unsafe {
            pelage_hair_create_interpolated_on_mesh(
                context.0,
                &arrays.strands(),
                &settings,
                &mut hair,
            )
        }
    };
    ok(mesh(given));
    let missing = [3u32, 1, 2];
    wrong(
        mesh(PelageInterpolationSettings {
            triangles: missing.as_ptr(),
            ..given
        }),
        "guide 3",
    );
    wrong(
        mesh(PelageInterpolationSettings {
            triangles: null(),
            ..given
        }),
        "triangles is NULL",
    );
    wrong(
        mesh(PelageInterpolationSettings {
            triangle_count: 0,
            ..given
        }),
        "no mesh",
    );
    wrong(
        mesh(PelageInterpolationSettings {
            triangle_count: u64::MAX,
            ..given
        }),
        "triangles",
    );
    for density in [-1.0, f32::NAN, f32::INFINITY, 1e30] {
        let sentence = mesh(PelageInterpolationSettings { density, ..given });
        wrong(sentence, "density");
    }
    wrong(
        mesh(PelageInterpolationSettings {
            clump: 2.0,
            ..given
        }),
        "clump…2",
    );
    wrong(
        mesh(PelageInterpolationSettings {
            stray_fraction: -0.5,
            ..given
        }),
        "-0.5",
    );

    let mut clumps = |settings: PelageClumpSettings| {
        // SAFETY: wrong values are what the call must notice.
        unsafe {
            pelage_hair_create_interpolated_clumps(
                context.0,
                &arrays.strands(),
                &settings,
                &mut hair,
            )
        }
    };
    let given = PelageClumpSettings {
        root_radius: 0.1,
        ..Default::default()
    };
    ok(clumps(given));
    wrong(
        clumps(PelageClumpSettings {
            followers: u32::MAX,
            ..given
        }),
        "4294967295",
    );
    wrong(
        clumps(PelageClumpSettings {
            root_radius: f32::NAN,
            ..given
        }),
        "root_radius",
    );
    wrong(
        clumps(PelageClumpSettings {
            tip_factor: -1.0,
            ..given
        }),
        "tip_factor",
    );
    wrong(
        clumps(PelageClumpSettings {
            reserved: 1,
            ..given
        }),
        "reserved is 1",
    );
}

/// A `.hair` file of two strands.
fn hair_file() -> Vec<u8> {
    let arrays = Arrays::crossing();
    let strands = pelage::groom::Strands::new(arrays.positions, &arrays.counts, 0.1).unwrap();
    pelage::groom::formats::write_hair(&strands).unwrap()
}

#[test]
fn truncated_and_corrupt_files_are_refused() {
    let context = Context::new();
    let file = hair_file();
    ok(create_file(&context, &file, |_| ()));
    for size in 0..file.len() {
        fails(
            create_file(&context, &file[..size], |_| ()),
            PELAGE_INVALID_FILE,
            "file",
        );
    }
    // Strand and point counts that the bytes do not hold; the first positions not a number.
    for (at, value) in [
        (4, u32::MAX),
        (8, u32::MAX),
        (4, 0x7fff_ffff),
        (8, 0),
        (128 + 4, f32::NAN.to_bits()),
    ] {
        let mut corrupt = file.clone();
        corrupt[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let result = create_file(&context, &corrupt, |_| ());
        assert!(
            result == PELAGE_INVALID_FILE,
            "byte {at}: {result}: {}",
            last_error()
        );
    }
    fails(
        create_file(&context, b"P6 640 480 255", |_| ()),
        PELAGE_INVALID_FILE,
        "neither HAIR",
    );
    wrong(
        create_file(&context, &file, |f| f.bytes = null()),
        "bytes is NULL",
    );
    wrong(
        create_file(&context, &file, |f| f.size = u64::MAX),
        "18446744073709551615",
    );
    wrong(create_file(&context, &file, |f| f.curve = 2), "curve 2");
    wrong(
        create_file(&context, &file, |f| f.tip_radius = -1.0),
        "tip_radius -1",
    );
}

#[test]
fn every_single_bit_flip_of_a_files_header_is_survived() {
    let context = Context::new();
    let file = hair_file();
    for bit in 0..8 * 40 {
        let mut flipped = file.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let result = create_file(&context, &flipped, |_| ());
        assert!(
            matches!(result, PELAGE_OK | PELAGE_INVALID_FILE),
            "bit {bit}: {result}: {}",
            last_error()
        );
    }
}
