//! Input that is wrong: each an error whose sentence names the value, and nothing changed.

use std::ptr::{null, null_mut};

use super::support::*;
use pelage::capi::*;

/// What an output holds before a call that fails, and after it.
const UNTOUCHED: u64 = 0x5555;

fn create(context: &Context, strands: &PelageStrands) -> PelageResult {
    let mut hair = PelageHair { id: UNTOUCHED };
    // SAFETY: the pointers are to values of their types, or wrong on purpose in a way that the call must notice.
    let result = unsafe { pelage_hair_create_from_strands(context.0, strands, &mut hair) };
    assert_eq!(result == PELAGE_OK, hair.id != UNTOUCHED, "an output is written by success alone");
    result
}

fn create_file(context: &Context, bytes: &[u8], change: impl FnOnce(&mut PelageFile)) -> PelageResult {
    let mut hair = PelageHair { id: UNTOUCHED };
    let mut file = PelageFile { bytes: bytes.as_ptr().cast(), size: bytes.len() as u64, ..Default::default() };
    change(&mut file);
    // SAFETY: as above.
    let result = unsafe { pelage_hair_create_from_file(context.0, &file, &mut hair) };
    assert_eq!(result == PELAGE_OK, hair.id != UNTOUCHED);
    result
}

#[test]
fn null_pointers_are_named() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, true));
    let (mut id, mut arrays) = (PelageHair::default(), Arrays::crossing().strands());
    arrays.positions = null();
    let counted = |entries| {
        let mut count = 0;
        // SAFETY: `entries` is NULL.
        unsafe { pelage_bytes_by_label(context.0, 4, entries, &mut count) }
    };
    let size = u64::from(SIDE * SIDE);
    // SAFETY: every NULL is what the call must notice; the rest are values of their types.
    unsafe {
        fails(pelage_context_create(null(), &mut PelageContext::default()), PELAGE_INVALID_VALUE, &["descriptor is NULL"]);
        fails(pelage_context_create(&Default::default(), null_mut()), PELAGE_INVALID_VALUE, &["context is NULL"]);
        fails(pelage_context_adapter(context.0, null_mut()), PELAGE_INVALID_VALUE, &["adapter is NULL"]);
        fails(pelage_hair_create_from_strands(context.0, null(), &mut id), PELAGE_INVALID_VALUE, &["strands is NULL"]);
        fails(pelage_hair_create_from_strands(context.0, &arrays, &mut id), PELAGE_INVALID_VALUE, &["positions is NULL"]);
        fails(pelage_hair_create_builtin(context.0, 0, 1, null_mut()), PELAGE_INVALID_VALUE, &["hair is NULL"]);
        fails(pelage_hair_create_from_file(context.0, null(), &mut id), PELAGE_INVALID_VALUE, &["file is NULL"]);
        fails(pelage_hair_set_transform(hair, null()), PELAGE_INVALID_VALUE, &["world_from_object is NULL"]);
        fails(pelage_hair_set_shading(hair, null()), PELAGE_INVALID_VALUE, &["shading is NULL"]);
        fails(pelage_hair_update_points(hair, null(), 5), PELAGE_INVALID_VALUE, &["positions is NULL"]);
        fails(pelage_hair_points(hair, null_mut(), 60), PELAGE_INVALID_VALUE, &["positions is NULL"]);
        fails(pelage_hair_info(hair, null_mut()), PELAGE_INVALID_VALUE, &["info is NULL"]);
        fails(pelage_target_create(context.0, null(), &mut Default::default()), PELAGE_INVALID_VALUE, &["descriptor is NULL"]);
        fails(pelage_target_write_colour(target, null(), size * 16), PELAGE_INVALID_VALUE, &["pixels is NULL"]);
        fails(pelage_target_write_depth(target, null(), size * 4), PELAGE_INVALID_VALUE, &["depths is NULL"]);
        fails(pelage_target_read_colour(target, null_mut(), size * 16), PELAGE_INVALID_VALUE, &["pixels is NULL"]);
        fails(pelage_target_read_depth(target, null_mut(), size * 4), PELAGE_INVALID_VALUE, &["depths is NULL"]);
        fails(pelage_readback_begin_colour(target, null_mut()), PELAGE_INVALID_VALUE, &["readback is NULL"]);
        fails(pelage_render(context.0, null(), target, 0), PELAGE_INVALID_VALUE, &["frame is NULL"]);
        fails(pelage_statistics(context.0, null_mut()), PELAGE_INVALID_VALUE, &["statistics is NULL"]);
        fails(counted(null_mut()), PELAGE_INVALID_VALUE, &["entries is NULL", "4"]);
        fails(pelage_bytes_by_label(context.0, 0, null_mut(), null_mut()), PELAGE_INVALID_VALUE, &["count is NULL"]);
        let eye = [0.0; 3];
        let view = pelage_view_perspective(eye.as_ptr(), null(), eye.as_ptr(), 1.0, 1.0, 0.1, 1.0, &mut view());
        fails(view, PELAGE_INVALID_VALUE, &["target is NULL"]);
    }
}

#[test]
fn frames_with_null_parts_are_refused() {
    let context = Context::new();
    let (hair, target, view) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false), view());
    let render = |change: &dyn Fn(&mut PelageFrame)| {
        let hairs = [hair];
        let lights = [PelageLight::default()];
        let mut frame = frame(&hairs, &lights, &view);
        change(&mut frame);
        // SAFETY: NULL parts are what the call must notice.
        unsafe { pelage_render(context.0, &frame, target, 0) }
    };
    fails(render(&|frame| frame.view = null()), PELAGE_INVALID_VALUE, &["view is NULL"]);
    fails(render(&|frame| frame.hairs = null()), PELAGE_INVALID_VALUE, &["hairs is NULL"]);
    fails(render(&|frame| frame.lights = null()), PELAGE_INVALID_VALUE, &["lights is NULL", "1"]);
    ok(render(&|_| ()));
}

#[test]
fn wrong_struct_sizes_are_named_with_the_initialiser() {
    let context = Context::new();
    let mut arrays = Arrays::crossing().strands();
    for size in [0, 1, 4, arrays.struct_size - 1, arrays.struct_size + 8, u32::MAX] {
        arrays.struct_size = size;
        let words = [&format!("struct_size {size} "), "PelageStrands", "PELAGE_STRANDS_INIT"];
        fails(create(&context, &arrays), PELAGE_INVALID_VALUE, &words);
    }
    let lights = [PelageLight::default(), PelageLight { struct_size: 3, ..Default::default() }];
    let (view, target) = (view(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let frame = frame(&[], &lights, &view);
    // SAFETY: the frame points to values that live.
    let result = unsafe { pelage_render(context.0, &frame, target, 0) };
    fails(result, PELAGE_INVALID_VALUE, &["lights[1]", "struct_size 3"]);
    let mut statistics = PelageStatistics { struct_size: 7, strands: UNTOUCHED, ..Default::default() };
    // SAFETY: the pointer is to a value of its type.
    fails(unsafe { pelage_statistics(context.0, &mut statistics) }, PELAGE_INVALID_VALUE, &["struct_size 7"]);
    assert_eq!(statistics.strands, UNTOUCHED);
}

#[test]
fn unknown_enumerators_and_flags_are_named() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let arrays = Arrays::crossing();
    let strands = PelageStrands { curve: 9, ..arrays.strands() };
    fails(create(&context, &strands), PELAGE_INVALID_VALUE, &["curve 9", "PELAGE_CURVE_"]);
    fails(render(&context, &[hair], target, 8), PELAGE_INVALID_VALUE, &["flags", "0x8"]);
    let mut id = PelageHair::default();
    // SAFETY: every pointer is to a value of its type.
    unsafe {
        fails(pelage_hair_create_builtin(context.0, 3, 1, &mut id), PELAGE_INVALID_VALUE, &["groom 3", "PELAGE_BUILTIN_"]);
        let shading = PelageShading { model: 44, ..Default::default() };
        fails(pelage_hair_set_shading(hair, &shading), PELAGE_INVALID_VALUE, &["model 44", "PELAGE_SHADING_"]);
        let shadow = PelageShadow { technique: 45, ..Default::default() };
        fails(pelage_hair_set_shadow(hair, &shadow), PELAGE_INVALID_VALUE, &["technique 45", "PELAGE_SHADOW_"]);
        let transparency = PelageTransparency { technique: 46, ..Default::default() };
        let result = pelage_hair_set_transparency(hair, &transparency);
        fails(result, PELAGE_INVALID_VALUE, &["technique 46", "PELAGE_TRANSPARENCY_"]);
        let a_buffer = PelageABuffer { storage: 5, ..Default::default() };
        let transparency = PelageTransparency { a_buffer: &a_buffer, ..Default::default() };
        fails(pelage_hair_set_transparency(hair, &transparency), PELAGE_INVALID_VALUE, &["storage 5", "PELAGE_STORAGE_"]);
        let map = PelageDeepOpacityMap { raster: 6, ..Default::default() };
        let shadow = PelageShadow { deep_opacity_map: &map, ..Default::default() };
        fails(pelage_hair_set_shadow(hair, &shadow), PELAGE_INVALID_VALUE, &["raster 6", "PELAGE_RASTER_"]);
        let image = PelageTargetDescriptor { width: 4, height: 4, format: 2, ..Default::default() };
        let result = pelage_target_create(context.0, &image, &mut PelageTarget::default());
        fails(result, PELAGE_INVALID_VALUE, &["format 2", "PELAGE_FORMAT_"]);
        let (lights, mut view) = ([PelageLight { kind: 2, ..Default::default() }], view());
        let result = pelage_render(context.0, &frame(&[hair], &lights, &view), target, 0);
        fails(result, PELAGE_INVALID_VALUE, &["light 0", "kind 2", "PELAGE_LIGHT_"]);
        view.flags = 2;
        fails(pelage_render(context.0, &frame(&[hair], &[], &view), target, 0), PELAGE_INVALID_VALUE, &["flags", "0x2"]);
        let descriptor = PelageContextDescriptor { validation: 2, ..Default::default() };
        let result = pelage_context_create(&descriptor, &mut PelageContext::default());
        fails(result, PELAGE_INVALID_VALUE, &["validation 2"]);
    }
}

#[test]
fn counts_that_are_huge_negative_or_zero_are_refused_before_memory_is_touched() {
    let context = Context::new();
    let arrays = Arrays::crossing();
    for count in [u64::MAX, i64::MAX as u64, -1i64 as u64, -5i64 as u64, 1 << 61, (1 << 28) + 1] {
        let strands = PelageStrands { point_count: count, ..arrays.strands() };
        fails(create(&context, &strands), PELAGE_INVALID_VALUE, &["positions", &count.to_string()]);
        let strands = PelageStrands { strand_count: count, ..arrays.strands() };
        fails(create(&context, &strands), PELAGE_INVALID_VALUE, &["counts", &count.to_string()]);
    }
    let strands = PelageStrands { point_count: 4, ..arrays.strands() };
    fails(create(&context, &strands), PELAGE_INVALID_VALUE, &["5 points", "4 are given"]);
    let zero = Arrays { counts: vec![0, 5], ..Arrays::crossing() };
    fails(create(&context, &zero.strands()), PELAGE_INVALID_VALUE, &["strand 0", "0 points"]);
    let huge = Arrays { counts: vec![u32::MAX, u32::MAX], ..Arrays::crossing() };
    fails(create(&context, &huge.strands()), PELAGE_INVALID_VALUE, &["4294967295"]);
    ok(create(&context, &PelageStrands::default()));
}

#[test]
fn strands_out_of_range_are_named_by_strand_and_point() {
    let context = Context::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut arrays = Arrays::crossing();
        arrays.positions[4][1] = bad;
        fails(create(&context, &arrays.strands()), PELAGE_INVALID_VALUE, &["strand 1, point 1", "not finite"]);
    }
    let arrays = Arrays::crossing();
    let refused = |strands: PelageStrands, words: &[&str]| fails(create(&context, &strands), PELAGE_INVALID_VALUE, words);
    refused(PelageStrands { root_radius: -1.0, ..arrays.strands() }, &["root_radius -1"]);
    refused(PelageStrands { tip_radius: f32::NAN, ..arrays.strands() }, &["tip_radius NaN"]);
    let radii = [0.1, 0.1, -2.0, 0.1, 0.1];
    refused(PelageStrands { radii: radii.as_ptr(), ..arrays.strands() }, &["strand 0, point 2", "-2"]);
    let colours = [1.0, 1.0, 1.0, 1.0, f32::INFINITY, 1.0];
    refused(PelageStrands { colours: colours.as_ptr(), ..arrays.strands() }, &["strand 1", "colour"]);
    let coordinates = [0.0, 0.5, 0.4, 0.0, 1.0];
    refused(PelageStrands { coordinates: coordinates.as_ptr(), ..arrays.strands() }, &["strand 0, point 2", "0.4"]);
    let bytes = [0u8; 64];
    let odd = bytes.as_ptr().wrapping_add(1 + bytes.as_ptr().align_offset(4));
    refused(PelageStrands { positions: odd.cast(), ..arrays.strands() }, &["positions", "no multiple of 4"]);
}

#[test]
fn guides_and_their_settings_are_checked() {
    let context = Context::new();
    let arrays = Arrays {
        positions: vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0]],
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
        unsafe { pelage_hair_create_interpolated_on_mesh(context.0, &arrays.strands(), &settings, &mut hair) }
    };
    ok(mesh(given));
    let wrong = [3u32, 1, 2];
    fails(mesh(PelageInterpolationSettings { triangles: wrong.as_ptr(), ..given }), PELAGE_INVALID_VALUE, &["guide 3"]);
    fails(mesh(PelageInterpolationSettings { triangles: null(), ..given }), PELAGE_INVALID_VALUE, &["triangles is NULL"]);
    fails(mesh(PelageInterpolationSettings { triangle_count: 0, ..given }), PELAGE_INVALID_VALUE, &["no mesh"]);
    fails(mesh(PelageInterpolationSettings { triangle_count: u64::MAX, ..given }), PELAGE_INVALID_VALUE, &["triangles"]);
    for density in [-1.0, f32::NAN, f32::INFINITY, 1e30] {
        let sentence = mesh(PelageInterpolationSettings { density, ..given });
        fails(sentence, PELAGE_INVALID_VALUE, &["density"]);
    }
    fails(mesh(PelageInterpolationSettings { clump: 2.0, ..given }), PELAGE_INVALID_VALUE, &["clump", "2"]);
    fails(mesh(PelageInterpolationSettings { stray_fraction: -0.5, ..given }), PELAGE_INVALID_VALUE, &["-0.5"]);

    let mut clumps = |settings: PelageClumpSettings| {
        // SAFETY: wrong values are what the call must notice.
        unsafe { pelage_hair_create_interpolated_clumps(context.0, &arrays.strands(), &settings, &mut hair) }
    };
    let given = PelageClumpSettings { root_radius: 0.1, ..Default::default() };
    ok(clumps(given));
    fails(clumps(PelageClumpSettings { followers: u32::MAX, ..given }), PELAGE_INVALID_VALUE, &["4294967295"]);
    fails(clumps(PelageClumpSettings { root_radius: f32::NAN, ..given }), PELAGE_INVALID_VALUE, &["root_radius"]);
    fails(clumps(PelageClumpSettings { tip_factor: -1.0, ..given }), PELAGE_INVALID_VALUE, &["tip_factor"]);
    fails(clumps(PelageClumpSettings { reserved: 1, ..given }), PELAGE_INVALID_VALUE, &["reserved is 1"]);
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
        fails(create_file(&context, &file[..size], |_| ()), PELAGE_INVALID_FILE, &["file"]);
    }
    // Strand and point counts that the bytes do not hold; the first positions not a number.
    for (at, value) in [(4, u32::MAX), (8, u32::MAX), (4, 0x7fff_ffff), (8, 0), (128 + 4, f32::NAN.to_bits())] {
        let mut corrupt = file.clone();
        corrupt[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let result = create_file(&context, &corrupt, |_| ());
        assert!(result == PELAGE_INVALID_FILE, "byte {at}: {result}: {}", last_error());
    }
    fails(create_file(&context, b"P6 640 480 255", |_| ()), PELAGE_INVALID_FILE, &["neither HAIR"]);
    fails(create_file(&context, &file, |f| f.bytes = null()), PELAGE_INVALID_VALUE, &["bytes is NULL"]);
    fails(create_file(&context, &file, |f| f.size = u64::MAX), PELAGE_INVALID_VALUE, &["18446744073709551615"]);
    fails(create_file(&context, &file, |f| f.curve = 2), PELAGE_INVALID_VALUE, &["curve 2"]);
    fails(create_file(&context, &file, |f| f.tip_radius = -1.0), PELAGE_INVALID_VALUE, &["tip_radius -1"]);
}

#[test]
fn every_single_bit_flip_of_a_files_header_is_survived() {
    let context = Context::new();
    let file = hair_file();
    for bit in 0..8 * 40 {
        let mut flipped = file.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let result = create_file(&context, &flipped, |_| ());
        assert!(matches!(result, PELAGE_OK | PELAGE_INVALID_FILE), "bit {bit}: {result}: {}", last_error());
    }
}

#[test]
fn targets_of_wrong_sizes_are_refused_and_nothing_is_written() {
    let context = Context::new();
    let make = |width, height, with_depth| {
        let descriptor = PelageTargetDescriptor { width, height, with_depth, ..Default::default() };
        let mut target = PelageTarget { id: UNTOUCHED };
        // SAFETY: the pointers are to values of their types.
        let result = unsafe { pelage_target_create(context.0, &descriptor, &mut target) };
        assert_eq!(target.id, UNTOUCHED);
        result
    };
    for (width, height) in [(0, 4), (4, 0), (u32::MAX, 4), (4, 1 << 20)] {
        fails(make(width, height, 0), PELAGE_INVALID_VALUE, &[&format!("{width}×{height}")]);
    }
    fails(make(4, 4, 2), PELAGE_INVALID_VALUE, &["with_depth 2"]);

    let target = context.target(PELAGE_FORMAT_RGBA16F, false);
    let mut pixels = vec![7.0f32; (SIDE * SIDE * 4) as usize];
    let right = size_of_val(&pixels[..]) as u64;
    // SAFETY: sizes are wrong on purpose; the array is larger than all that are below the right one.
    unsafe {
        for size in [0, 1, right - 1, right + 1, right / 2, u64::MAX] {
            let words = [&size.to_string(), &right.to_string()[..]].map(|word| word.to_string());
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            fails(pelage_target_read_colour(target, pixels.as_mut_ptr(), size), PELAGE_INVALID_VALUE, &words);
            fails(pelage_target_write_colour(target, pixels.as_ptr(), size), PELAGE_INVALID_VALUE, &words);
        }
        fails(pelage_target_read_depth(target, pixels.as_mut_ptr(), right / 4), PELAGE_INVALID_VALUE, &["without a depth"]);
        fails(pelage_target_write_depth(target, pixels.as_ptr(), right / 4), PELAGE_INVALID_VALUE, &["without a depth"]);
        let mut readback = PelageReadback { id: UNTOUCHED };
        fails(pelage_readback_begin_depth(target, &mut readback), PELAGE_INVALID_VALUE, &["without a depth"]);
        assert_eq!(readback.id, UNTOUCHED);
        assert!(pixels.iter().all(|value| *value == 7.0));
        pixels[(4 * SIDE + 8) as usize] = f32::NAN;
        let result = pelage_target_write_colour(target, pixels.as_ptr(), right);
        fails(result, PELAGE_INVALID_VALUE, &["pixel (2, 1)", "not finite"]);
        let with_depth = context.target(PELAGE_FORMAT_RGBA16F, true);
        let result = pelage_target_write_depth(with_depth, pixels.as_ptr(), right / 4);
        fails(result, PELAGE_INVALID_VALUE, &["pixel (0, 0)", "7"]);
    }
    for flags in [PELAGE_RENDER_WRITE_DEPTH, PELAGE_RENDER_RECEIVE_SHADOW] {
        fails(render(&context, &[context.hair()], target, flags), PELAGE_INVALID_VALUE, &["depth"]);
    }
    assert!(read(target).iter().all(|pixel| *pixel == [0.0; 4]));
}

#[test]
fn wrong_settings_leave_a_hair_as_it_was() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA32F, false));
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
    let before = read(target);
    for opacity in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        fails(pelage_hair_set_opacity(hair, opacity), PELAGE_INVALID_VALUE, &["opacity", &opacity.to_string()]);
    }
    let transform = |change: fn(&mut [f64; 16])| {
        let mut matrix = pelage::glam::DMat4::IDENTITY.to_cols_array();
        change(&mut matrix);
        // SAFETY: sixteen doubles.
        unsafe { pelage_hair_set_transform(hair, matrix.as_ptr()) }
    };
    fails(transform(|m| m[3] = 1.0), PELAGE_INVALID_VALUE, &["affine"]);
    fails(transform(|m| m[0] = f64::NAN), PELAGE_INVALID_VALUE, &["inverted", "NaN"]);
    fails(transform(|m| m[12] = f64::INFINITY), PELAGE_INVALID_VALUE, &["inverted", "inf"]);
    fails(transform(|m| m.fill(0.0)), PELAGE_INVALID_VALUE, &["inverted"]);
    let shading = |kajiya_kay: PelageKajiyaKay| {
        // SAFETY: the pointers are to values of their types.
        unsafe { pelage_hair_set_shading(hair, &PelageShading { kajiya_kay: &kajiya_kay, ..Default::default() }) }
    };
    let default = PelageKajiyaKay::default();
    fails(shading(PelageKajiyaKay { exponent: 0.5, ..default }), PELAGE_INVALID_VALUE, &["exponent 0.5"]);
    fails(shading(PelageKajiyaKay { exponent: f32::NAN, ..default }), PELAGE_INVALID_VALUE, &["exponent NaN"]);
    fails(shading(PelageKajiyaKay { diffuse: [-1.0; 3], ..default }), PELAGE_INVALID_VALUE, &["diffuse", "-1"]);
    fails(shading(PelageKajiyaKay { struct_size: 2, ..default }), PELAGE_INVALID_VALUE, &["kajiya_kay: struct_size 2"]);
    let shadow = |map: PelageDeepOpacityMap| {
        // SAFETY: the pointers are to values of their types.
        unsafe { pelage_hair_set_shadow(hair, &PelageShadow { deep_opacity_map: &map, ..Default::default() }) }
    };
    let default = PelageDeepOpacityMap::default();
    fails(shadow(PelageDeepOpacityMap { resolution: 0, ..default }), PELAGE_INVALID_VALUE, &["resolution 0"]);
    fails(shadow(PelageDeepOpacityMap { resolution: u32::MAX, ..default }), PELAGE_INVALID_VALUE, &["4294967295"]);
    fails(shadow(PelageDeepOpacityMap { layers: 0, ..default }), PELAGE_INVALID_VALUE, &["layers 0"]);
    fails(shadow(PelageDeepOpacityMap { pcf: 2, ..default }), PELAGE_INVALID_VALUE, &["pcf 2"]);
    fails(shadow(PelageDeepOpacityMap { depth: f32::NAN, ..default }), PELAGE_INVALID_VALUE, &["depth NaN"]);
    let a_buffer = PelageABuffer { pool_bytes: 1, ..Default::default() };
    let transparency = PelageTransparency { a_buffer: &a_buffer, ..Default::default() };
    // SAFETY: the pointers are to values of their types.
    fails(unsafe { pelage_hair_set_transparency(hair, &transparency) }, PELAGE_INVALID_VALUE, &["pool_bytes 1"]);
    let points = [[f32::NAN; 3]; 5];
    // SAFETY: the array is at least as large as it says.
    unsafe {
        let result = pelage_hair_update_points(hair, points.as_ptr().cast(), 5);
        fails(result, PELAGE_INVALID_VALUE, &["strand 0, point 0", "not finite"]);
        fails(pelage_hair_update_points(hair, points.as_ptr().cast(), 4), PELAGE_INVALID_VALUE, &["4", "5"]);
        fails(pelage_hair_update_points(hair, points.as_ptr().cast(), u64::MAX), PELAGE_INVALID_VALUE, &["positions"]);
    }
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
    assert!(read(target) == before);
}

#[test]
fn wrong_frames_leave_the_target_as_it_was() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA32F, false));
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
    let before = read(target);
    let attempt = |change: &dyn Fn(&mut PelageFrame, &mut PelageView, &mut [PelageLight; 17]), words: &[&str]| {
        let (mut lights, mut own, hairs) = ([PelageLight::default(); 17], view(), [hair, hair]);
        let mut frame = PelageFrame { hairs: hairs.as_ptr(), hair_count: 1, ambient: [0.1; 3], ..Default::default() };
        (frame.lights, frame.light_count) = (lights.as_ptr(), 1);
        change(&mut frame, &mut own, &mut lights);
        frame.view = &own;
        // SAFETY: the frame points to values that live.
        fails(unsafe { pelage_render(context.0, &frame, target, PELAGE_RENDER_CLEAR) }, PELAGE_INVALID_VALUE, words);
    };
    attempt(&|frame, _, _| frame.light_count = 17, &["17 lights"]);
    attempt(&|frame, _, _| frame.light_count = u32::MAX, &["4294967295 lights"]);
    attempt(&|frame, _, _| frame.hair_count = 2, &["hairs[1]", "already"]);
    attempt(&|frame, _, _| frame.hair_count = u32::MAX, &["hairs", "4294967295"]);
    attempt(&|frame, _, _| frame.ambient[1] = f32::NAN, &["ambient", "NaN"]);
    attempt(&|frame, _, _| frame.ambient[1] = -1.0, &["ambient", "-1"]);
    attempt(&|_, view, _| view.view_from_world[5] = f64::NAN, &["view_from_world", "not finite"]);
    attempt(&|_, view, _| view.clip_from_view = [0.0; 16], &["clip_from_view", "inverted"]);
    attempt(&|_, _, lights| lights[0].direction = [0.0; 3], &["light 0", "direction (0, 0, 0)"]);
    attempt(&|_, _, lights| lights[0].direction[2] = f64::INFINITY, &["light 0", "inf"]);
    attempt(&|_, _, lights| lights[0].power[0] = -3.0, &["light 0", "-3"]);
    attempt(&|_, _, lights| lights[0].reserved = 1, &["PelageLight", "reserved is 1"]);
    attempt(
        &|_, _, lights| (lights[0].kind, lights[0].position) = (PELAGE_LIGHT_POINT, [f64::NAN; 3]),
        &["light 0", "position", "NaN"],
    );
    assert!(read(target) == before);
}

#[test]
fn views_that_are_none_are_refused_and_not_written() {
    let make = |eye: [f64; 3], up: [f64; 3], fov: f64, aspect: f64, near: f64, far: f64| {
        let mut out = PelageView { flags: 77, ..Default::default() };
        let target = [0.0; 3];
        // SAFETY: three doubles each, and a value of its type.
        let result = unsafe {
            pelage_view_perspective(eye.as_ptr(), target.as_ptr(), up.as_ptr(), fov, aspect, near, far, &mut out)
        };
        assert_eq!((result == PELAGE_OK, out.flags == 77), (result == PELAGE_OK, result != PELAGE_OK));
        result
    };
    let (eye, up) = ([0.0, 0.0, 3.0], [0.0, 1.0, 0.0]);
    ok(make(eye, up, 1.0, 1.0, 0.1, 1.0));
    fails(make([0.0; 3], up, 1.0, 1.0, 0.1, 1.0), PELAGE_INVALID_VALUE, &["eye"]);
    fails(make(eye, [0.0, 0.0, 1.0], 1.0, 1.0, 0.1, 1.0), PELAGE_INVALID_VALUE, &["up"]);
    fails(make([f64::NAN; 3], up, 1.0, 1.0, 0.1, 1.0), PELAGE_INVALID_VALUE, &["NaN"]);
    fails(make(eye, up, 0.0, 1.0, 0.1, 1.0), PELAGE_INVALID_VALUE, &["field of view 0"]);
    fails(make(eye, up, 4.0, 1.0, 0.1, 1.0), PELAGE_INVALID_VALUE, &["field of view 4"]);
    fails(make(eye, up, 1.0, f64::NAN, 0.1, 1.0), PELAGE_INVALID_VALUE, &["aspect ratio NaN"]);
    fails(make(eye, up, 1.0, 1.0, 1.0, 0.5), PELAGE_INVALID_VALUE, &["1…0.5"]);
}

#[test]
fn a_budget_too_small_is_out_of_memory_and_hair_draws_once_it_is_lifted() {
    let context = Context::new();
    let target = context.target(PELAGE_FORMAT_RGBA16F, false);
    let hair = context.hair();
    ok(pelage_context_set_byte_budget(context.0, 1));
    let mut id = PelageHair { id: UNTOUCHED };
    // SAFETY: the pointer is to a value of its type.
    let result = unsafe { pelage_hair_create_builtin(context.0, PELAGE_BUILTIN_STRAIGHT, 1000, &mut id) };
    fails(result, PELAGE_OUT_OF_MEMORY, &["budget"]);
    assert_eq!(id.id, UNTOUCHED);
    fails(render(&context, &[hair], target, 0), PELAGE_OUT_OF_MEMORY, &["budget"]);
    ok(pelage_context_set_byte_budget(context.0, 0));
    ok(render(&context, &[hair], target, 0));
    assert!(read(target)[MIDDLE][3] > 0.5);
}
