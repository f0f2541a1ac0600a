//! Hair files: what is read is what was written, and nothing in a file makes the readers panic.

use super::shared_data;
use pelage::Error;
use pelage::groom::Strands;
use pelage::groom::formats::{read, read_hair, read_tfx, write_hair};
use proptest::prelude::*;

/// Every shared strand file: path, strands, points.
const FILES: [(&str, usize, usize); 9] = [
    ("ponytail/front_top.tfx", 876, 14_016),
    ("ponytail/side.tfx", 3_066, 49_056),
    ("ponytail/back.tfx", 517, 8_272),
    ("ponytail/tail.tfx", 474, 7_584),
    ("bear/bear.tfx", 48_113, 192_452),
    ("testhair1/TestHair1.tfx", 10_027, 40_108),
    ("ratboy/Ratboy_mohawk.tfx", 2_228, 71_296),
    (
        "sintel/SintelHairOriginal-sintel_hair.16points.tfx",
        11_400,
        182_400,
    ),
    ("furball/furBall_A_every5th.hair", 6_074, 97_184),
];

#[test]
fn every_shared_groom_is_read_whole() {
    for (path, strand_count, point_count) in FILES {
        let Some(bytes) = shared_data("every_shared_groom_is_read_whole", path) else {
            continue;
        };
        let strands = read(&bytes).unwrap();
        assert_eq!(
            (strands.strand_count(), strands.points().len()),
            (strand_count, point_count),
            "{path}"
        );
        let (low, high) = strands.bounds().unwrap();
        let size = (0..3)
            .map(|axis| (high[axis] - low[axis]).powi(2))
            .sum::<f32>()
            .sqrt();
        let widest = strands.radii().iter().copied().fold(0.0, f32::max);
        assert!(
            widest > 0.0 && widest <= 0.01 * size,
            "{path}: radius {widest} in a groom of size {size}"
        );
    }
}

#[test]
fn test_hairs_are_eleven_units_long() {
    let Some(bytes) = shared_data(
        "test_hairs_are_eleven_units_long",
        "testhair1/TestHair1.tfx",
    ) else {
        return;
    };
    let strands = read_tfx(&bytes).unwrap();
    for points in super::strands_of(&strands) {
        let [root, tip] = [points[0], points[3]];
        let length = (0..3)
            .map(|axis| (tip[axis] - root[axis]).powi(2))
            .sum::<f32>()
            .sqrt();
        // The data's own description; its coordinates are rounded.
        assert!((length - 11.0).abs() < 0.1, "{length}");
    }
}

#[test]
fn a_tfx_file_of_each_version_holds_its_positions() {
    let positions = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 2.0],
        [1.0, 1.0, 3.0],
    ];
    for bytes in [tfx(3.0, 2, 2, &positions), tfx(4.0, 2, 2, &positions)] {
        let strands = read(&bytes).unwrap();
        assert_eq!(strands.points(), positions);
        assert_eq!(strands.offsets(), [0, 2, 4]);
        assert_eq!(strands.radii()[0], strands.fitting_radius());
    }
}

#[test]
fn thickness_is_a_diameter_and_colours_are_averaged() {
    let bytes = hair(
        0b10111,
        [1, 2],
        &[1],
        &[
            0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.25, 1.0, 0.0, 0.5, 0.0, 0.5, 1.0,
        ],
    );
    let strands = read_hair(&bytes).unwrap();
    assert_eq!(strands.radii(), [0.25, 0.125]);
    assert_eq!(strands.colours(), [[0.5, 0.25, 0.75]]);
}

#[test]
fn defaults_of_the_header_stand_in_for_arrays() {
    let bytes = hair(0b10, [2, 4], &[], &[0.0; 12]);
    let strands = read_hair(&bytes).unwrap();
    assert_eq!(strands.offsets(), [0, 2, 4]);
    assert_eq!(strands.radii(), [0.5; 4]);
    assert_eq!(strands.colours(), [[0.1, 0.2, 0.3]; 2]);
}

#[test]
fn errors_name_the_value_and_the_place() {
    let said = |bytes: &[u8]| match read(bytes) {
        Err(Error::InvalidFile(what)) => what,
        other => panic!("{other:?}"),
    };
    assert!(said(b"").contains("neither HAIR"));
    assert!(said(b"HAIR").contains("header"));
    assert!(said(&hair(0b10, [u32::MAX, u32::MAX], &[], &[0.0; 3])).contains("4294967295 points"));
    assert!(said(&hair(0b01, [1, 2], &[1], &[])).contains("no points"));
    assert!(
        said(&hair(0b10, [3, 4], &[], &[0.0; 12]))
            .contains("3 strands with their segments make 6 points")
    );
    assert!(
        said(&hair(
            0b10,
            [1, 2],
            &[],
            &[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]
        ))
        .contains("strand 0, point 1")
    );
    assert!(said(&tfx(3.0, 1, 0, &[])).contains("0 vertices"));
    assert!(said(&tfx(4.0, 70_000, 70_000, &[])).contains("positions"));
    assert!(said(&tfx(4.0, 1, 1, &[[0.0, f32::INFINITY, 0.0]])).contains("strand 0, point 0"));
    assert!(
        read_tfx(&tfx(5.0, 1, 1, &[[0.0; 3]]))
            .unwrap_err()
            .to_string()
            .contains("version 5")
    );
}

#[test]
fn a_strand_of_too_many_segments_is_not_written() {
    let points = vec![[0.0; 3]; 65_537];
    assert!(write_hair(&Strands::new(points.clone(), &[65_536, 1], 1.0).unwrap()).is_ok());
    let error = write_hair(&Strands::new(points, &[65_537], 1.0).unwrap()).unwrap_err();
    assert!(
        error.to_string().contains("strand 0: 65536 segments"),
        "{error}"
    );
}

/// A `.hair` file with one default segment, thickness 1 and colour (0.1, 0.2, 0.3).
fn hair(flags: u32, [strands, points]: [u32; 2], segments: &[u16], floats: &[f32]) -> Vec<u8> {
    let mut bytes = b"HAIR".to_vec();
    bytes.extend(
        [strands, points, flags, 1]
            .iter()
            .flat_map(|n| n.to_le_bytes()),
    );
    bytes.extend(
        [1.0f32, 0.0, 0.1, 0.2, 0.3]
            .iter()
            .flat_map(|v| v.to_le_bytes()),
    );
    bytes.resize(128, 0);
    bytes.extend(segments.iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend(floats.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// A `.tfx` file with nothing but positions.
fn tfx(version: f32, strands: u32, each: u32, positions: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = version.to_le_bytes().to_vec();
    bytes.extend([strands, each].iter().flat_map(|n| n.to_le_bytes()));
    let (offset_at, first) = if version < 4.0 {
        (144, 296u32)
    } else {
        (12, 160)
    };
    bytes.resize(first as usize, 0);
    bytes[offset_at..offset_at + 4].copy_from_slice(&first.to_le_bytes());
    for position in positions {
        bytes.extend(position.iter().flat_map(|v| v.to_le_bytes()));
        if version >= 4.0 {
            bytes.extend(1.0f32.to_le_bytes());
        }
    }
    bytes
}

prop_compose! {
    fn any_strands()(counts in prop::collection::vec(1u32..5, 0..6))(
        points in prop::collection::vec(prop::array::uniform3(-1e6f32..1e6), counts.iter().sum::<u32>() as usize),
        radii in prop::collection::vec(0.0f32..10.0, counts.iter().sum::<u32>() as usize),
        colours in prop::collection::vec(prop::array::uniform3(0.0f32..2.0), counts.len()),
        counts in Just(counts),
    ) -> Strands {
        Strands::new(points, &counts, 1.0).unwrap().with_point_radii(radii).unwrap().with_colours(colours).unwrap()
    }
}

/// Changes bytes, some in the header where the counts are, and cuts the end off.
fn damage(mut bytes: Vec<u8>, changes: &[(usize, u8)], keep: f64) -> Vec<u8> {
    for (at, value) in changes {
        let at = at % bytes.len();
        bytes[at] = *value;
    }
    bytes.truncate((bytes.len() as f64 * keep) as usize);
    bytes
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(strands in any_strands()) {
        prop_assert_eq!(read(&write_hair(&strands).unwrap()).unwrap(), strands);
    }

    #[test]
    fn damaged_files_never_panic(
        strands in any_strands(),
        version in prop::sample::select(vec![3.0f32, 4.0]),
        changes in prop::collection::vec((prop_oneof![0usize..160, any::<usize>()], any::<u8>()), 0..12),
        keep in prop_oneof![Just(1.0), 0.0..1.0f64],
    ) {
        let files = [write_hair(&strands).unwrap(), tfx(version, strands.points().len() as u32, 1, strands.points())];
        for file in files {
            let file = damage(file, &changes, keep);
            for result in [read(&file), read_hair(&file), read_tfx(&file)] {
                match result {
                    Ok(read) => prop_assert!(read.points().len() <= file.len()),
                    Err(error) => prop_assert!(matches!(error, Error::InvalidFile(_)), "{error:?}"),
                }
            }
        }
    }

    #[test]
    fn noise_is_never_a_panic(noise in prop::collection::vec(any::<u8>(), 0..600)) {
        let _ = read(&noise);
        let _ = read_hair(&[b"HAIR".as_slice(), &noise].concat());
        let _ = read_tfx(&[3.0f32.to_le_bytes().as_slice(), &noise].concat());
    }
}
