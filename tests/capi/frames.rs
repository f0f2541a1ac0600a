//! Targets, settings, frames and views that are wrong: each an error whose sentence names the value, and nothing changed.

use super::support::*;
use pelage::capi::*;

#[test]
fn targets_of_wrong_sizes_are_refused_and_nothing_is_written() {
    let context = Context::new();
    let make = |width, height, with_depth| {
        let descriptor = PelageTargetDescriptor {
            width,
            height,
            with_depth,
            ..Default::default()
        };
        let mut target = PelageTarget { id: UNTOUCHED };
        // SAFETY: the pointers are to values of their types.
        let result = unsafe { pelage_target_create(context.0, &descriptor, &mut target) };
        assert_eq!(target.id, UNTOUCHED);
        result
    };
    for (width, height) in [(0, 4), (4, 0), (u32::MAX, 4), (4, 1 << 20)] {
        wrong(make(width, height, 0), &format!("{width}×{height}"));
    }
    wrong(make(4, 4, 2), "with_depth 2");

    let target = context.target(PELAGE_FORMAT_RGBA16F, false);
    let mut pixels = vec![7.0f32; (SIDE * SIDE * 4) as usize];
    let right = size_of_val(&pixels[..]) as u64;
    // SAFETY: sizes are wrong on purpose; the array is larger than all that are below the right one.
    unsafe {
        for size in [0, 1, right - 1, right + 1, right / 2, u64::MAX] {
            let words = format!("{size} bytes…{right}");
            wrong(
                pelage_target_read_colour(target, pixels.as_mut_ptr(), size),
                &words,
            );
            wrong(
                pelage_target_write_colour(target, pixels.as_ptr(), size),
                &words,
            );
        }
        wrong(
            pelage_target_read_depth(target, pixels.as_mut_ptr(), right / 4),
            "without a depth",
        );
        wrong(
            pelage_target_write_depth(target, pixels.as_ptr(), right / 4),
            "without a depth",
        );
        let mut readback = PelageReadback { id: UNTOUCHED };
        wrong(
            pelage_readback_begin_depth(target, &mut readback),
            "without a depth",
        );
        assert_eq!(readback.id, UNTOUCHED);
        assert!(pixels.iter().all(|value| *value == 7.0));
        pixels[(4 * SIDE + 8) as usize] = f32::NAN;
        let result = pelage_target_write_colour(target, pixels.as_ptr(), right);
        wrong(result, "pixel (2, 1)…not finite");
        let with_depth = context.target(PELAGE_FORMAT_RGBA16F, true);
        let result = pelage_target_write_depth(with_depth, pixels.as_ptr(), right / 4);
        wrong(result, "pixel (0, 0)…7");
    }
    for flags in [PELAGE_RENDER_WRITE_DEPTH, PELAGE_RENDER_RECEIVE_SHADOW] {
        wrong(render(&context, &[context.hair()], target, flags), "depth");
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
        wrong(
            pelage_hair_set_opacity(hair, opacity),
            &format!("opacity…{}", opacity),
        );
    }
    let transform = |change: fn(&mut [f64; 16])| {
        let mut matrix = pelage::glam::DMat4::IDENTITY.to_cols_array();
        change(&mut matrix);
        // SAFETY: sixteen doubles.
        unsafe { pelage_hair_set_transform(hair, matrix.as_ptr()) }
    };
    wrong(transform(|m| m[3] = 1.0), "affine");
    wrong(transform(|m| m[0] = f64::NAN), "NaN…inverted");
    wrong(transform(|m| m[12] = f64::INFINITY), "inf…inverted");
    wrong(transform(|m| m.fill(0.0)), "inverted");
    let shading = |kajiya_kay: PelageKajiyaKay| {
        // SAFETY: the pointers are to values of their types.
        unsafe {
            pelage_hair_set_shading(
                hair,
                &PelageShading {
                    kajiya_kay: &kajiya_kay,
                    ..Default::default()
                },
            )
        }
    };
    let default = PelageKajiyaKay::default();
    wrong(
        shading(PelageKajiyaKay {
            exponent: 0.5,
            ..default
        }),
        "exponent 0.5",
    );
    wrong(
        shading(PelageKajiyaKay {
            exponent: f32::NAN,
            ..default
        }),
        "exponent NaN",
    );
    wrong(
        shading(PelageKajiyaKay {
            diffuse: [-1.0; 3],
            ..default
        }),
        "diffuse…-1",
    );
    wrong(
        shading(PelageKajiyaKay {
            struct_size: 2,
            ..default
        }),
        "kajiya_kay: struct_size 2",
    );
    let marschner = PelageMarschner {
        eccentricity: 2.0,
        ..Default::default()
    };
    let sadeghi = PelageSadeghi {
        normalised: 2,
        ..Default::default()
    };
    let chiang = PelageChiang {
        table_size: 31,
        ..Default::default()
    };
    let scheuermann = PelageScheuermann {
        struct_size: 1,
        ..Default::default()
    };
    let given = PelageShading {
        scheuermann: &scheuermann,
        marschner: &marschner,
        sadeghi: &sadeghi,
        chiang: &chiang,
        ..Default::default()
    };
    for (model, sentence) in [
        (PELAGE_SHADING_SCHEUERMANN, "scheuermann: struct_size 1"),
        (PELAGE_SHADING_MARSCHNER, "marschner: eccentricity 2"),
        (PELAGE_SHADING_SADEGHI, "normalised 2"),
        (PELAGE_SHADING_CHIANG, "tables.size 31"),
        (5, "model 5"),
    ] {
        // SAFETY: the pointers are to values of their types.
        let result = unsafe { pelage_hair_set_shading(hair, &PelageShading { model, ..given }) };
        wrong(result, sentence);
    }
    let mut sigma_a = [0.0f32; 3];
    // SAFETY: all arrays have three floats.
    unsafe {
        wrong(pelage_sigma_a_of(7, sigma_a.as_mut_ptr()), "colour 7");
        wrong(
            pelage_sigma_a_from_melanin(-1.0, 0.0, sigma_a.as_mut_ptr()),
            "eumelanin -1",
        );
        wrong(
            pelage_sigma_a_from_reflectance([0.0f32; 3].as_ptr(), 0.3, sigma_a.as_mut_ptr()),
            "colour 0",
        );
        assert_eq!(sigma_a, [0.0; 3]);
        assert_eq!(
            pelage_sigma_a_from_melanin(1.0, 0.0, sigma_a.as_mut_ptr()),
            PELAGE_OK
        );
    }
    assert_eq!(sigma_a, [0.419, 0.697, 1.37]);
    let shadow = |map: PelageDeepOpacityMap| {
        // SAFETY: the pointers are to values of their types.
        unsafe {
            pelage_hair_set_shadow(
                hair,
                &PelageShadow {
                    deep_opacity_map: &map,
                    ..Default::default()
                },
            )
        }
    };
    let default = PelageDeepOpacityMap::default();
    wrong(
        shadow(PelageDeepOpacityMap {
            resolution: 0,
            ..default
        }),
        "resolution 0",
    );
    wrong(
        shadow(PelageDeepOpacityMap {
            resolution: u32::MAX,
            ..default
        }),
        "4294967295",
    );
    wrong(
        shadow(PelageDeepOpacityMap {
            layers: 0,
            ..default
        }),
        "layers 0",
    );
    wrong(shadow(PelageDeepOpacityMap { pcf: 2, ..default }), "pcf 2");
    wrong(
        shadow(PelageDeepOpacityMap {
            depth: f32::NAN,
            ..default
        }),
        "depth NaN",
    );
    wrong(
        shadow(PelageDeepOpacityMap {
            transmitted: [0.0, 1.0, 0.0],
            ..default
        }),
        "transmitted (0, 1, 0)",
    );
    let shadow = |map: PelageMomentOpacityMap| {
        // SAFETY: the pointers are to values of their types.
        unsafe {
            pelage_hair_set_shadow(
                hair,
                &PelageShadow {
                    technique: PELAGE_SHADOW_MOMENT_OPACITY_MAP,
                    moment_opacity_map: &map,
                    ..Default::default()
                },
            )
        }
    };
    let default = PelageMomentOpacityMap::default();
    assert_eq!(shadow(default), PELAGE_OK);
    for (settings, says) in [
        (
            PelageMomentOpacityMap {
                moments: 5,
                ..default
            },
            "moments 5",
        ),
        (
            PelageMomentOpacityMap {
                resolution: 15,
                ..default
            },
            "resolution 15",
        ),
        (
            PelageMomentOpacityMap {
                transmitted: [f32::NAN; 3],
                ..default
            },
            "transmitted (NaN",
        ),
    ] {
        wrong(shadow(settings), says);
    }
    let shadow = |map: PelageKBufferVolume| {
        // SAFETY: the pointers are to values of their types.
        unsafe {
            pelage_hair_set_shadow(
                hair,
                &PelageShadow {
                    technique: PELAGE_SHADOW_K_BUFFER_VOLUME,
                    k_buffer_volume: &map,
                    ..Default::default()
                },
            )
        }
    };
    let default = PelageKBufferVolume::default();
    assert_eq!(shadow(default), PELAGE_OK);
    let fresnel = PelageKBufferVolume {
        attenuation: PELAGE_ATTENUATION_FRESNEL,
        ..default
    };
    assert_eq!(shadow(fresnel), PELAGE_OK);
    for (settings, says) in [
        (PelageKBufferVolume { k: 65, ..default }, "k 65"),
        (PelageKBufferVolume { k: 0, ..default }, "k 0"),
        (PelageKBufferVolume { tail: 2, ..default }, "tail 2"),
        (
            PelageKBufferVolume {
                attenuation: 2,
                ..default
            },
            "attenuation 2",
        ),
        (
            PelageKBufferVolume {
                eta: 1.0,
                ..fresnel
            },
            "eta 1",
        ),
        (
            PelageKBufferVolume {
                sigma_a: [0.0, -1.0, 0.0],
                ..fresnel
            },
            "sigma_a (0, -1, 0)",
        ),
    ] {
        wrong(shadow(settings), says);
    }
    // SAFETY: the pointer is to a value of its type.
    let result = unsafe { pelage_hair_set_shadow(hair, &PelageShadow::default()) };
    assert_eq!(result, PELAGE_OK);
    let a_buffer = PelageABuffer {
        pool_bytes: 1,
        ..Default::default()
    };
    let transparency = PelageTransparency {
        technique: PELAGE_TRANSPARENCY_A_BUFFER,
        a_buffer: &a_buffer,
        ..Default::default()
    };
    // SAFETY: the pointers are to values of their types.
    wrong(
        unsafe { pelage_hair_set_transparency(hair, &transparency) },
        "pool_bytes 1",
    );
    let points = [[f32::NAN; 3]; 5];
    // SAFETY: the array is at least as large as it says.
    unsafe {
        let result = pelage_hair_update_points(hair, points.as_ptr().cast(), 5);
        wrong(result, "strand 0, point 0…not finite");
        wrong(
            pelage_hair_update_points(hair, points.as_ptr().cast(), 4),
            "4…5",
        );
        wrong(
            pelage_hair_update_points(hair, points.as_ptr().cast(), u64::MAX),
            "positions",
        );
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
    let attempt = |change: &dyn Fn(&mut PelageFrame, &mut PelageView, &mut [PelageLight; 17]),
                   words: &str| {
        let (mut lights, mut own, hairs) = ([PelageLight::default(); 17], view(), [hair, hair]);
        let mut frame = PelageFrame {
            hairs: hairs.as_ptr(),
            hair_count: 1,
            ambient: [0.1; 3],
            ..Default::default()
        };
        (frame.lights, frame.light_count) = (lights.as_ptr(), 1);
        change(&mut frame, &mut own, &mut lights);
        frame.view = &own;
        // SAFETY: the frame points to values that live.
        wrong(
            unsafe { pelage_render(context.0, &frame, target, PELAGE_RENDER_CLEAR) },
            words,
        );
    };
    attempt(&|frame, _, _| frame.light_count = 17, "17 lights");
    attempt(
        &|frame, _, _| frame.light_count = u32::MAX,
        "4294967295 lights",
    );
    attempt(&|frame, _, _| frame.hair_count = 2, "hairs[1]…already");
    attempt(
        &|frame, _, _| frame.hair_count = u32::MAX,
        "hairs…4294967295",
    );
    attempt(&|frame, _, _| frame.ambient[1] = f32::NAN, "ambient…NaN");
    attempt(&|frame, _, _| frame.ambient[1] = -1.0, "ambient…-1");
    attempt(
        &|_, view, _| view.view_from_world[5] = f64::NAN,
        "view_from_world…not finite",
    );
    attempt(
        &|_, view, _| view.clip_from_view = [0.0; 16],
        "clip_from_view…inverted",
    );
    attempt(
        &|_, _, lights| lights[0].direction = [0.0; 3],
        "light 0…direction (0, 0, 0)",
    );
    attempt(
        &|_, _, lights| lights[0].direction[2] = f64::INFINITY,
        "light 0…inf",
    );
    attempt(&|_, _, lights| lights[0].power[0] = -3.0, "light 0…-3");
    attempt(
        &|_, _, lights| lights[0].reserved = 1,
        "PelageLight…reserved is 1",
    );
    attempt(
        &|_, _, lights| (lights[0].kind, lights[0].position) = (PELAGE_LIGHT_POINT, [f64::NAN; 3]),
        "light 0…position…NaN",
    );
    assert!(read(target) == before);
}

#[test]
fn views_that_are_none_are_refused_and_not_written() {
    let make = |eye: [f64; 3], up: [f64; 3], fov: f64, aspect: f64, near: f64, far: f64| {
        let mut out = PelageView {
            flags: 77,
            ..Default::default()
        };
        let target = [0.0; 3];
        // SAFETY: three doubles each, and a value of its type.
        let result = unsafe {
            pelage_view_perspective(
                eye.as_ptr(),
                target.as_ptr(),
                up.as_ptr(),
                fov,
                aspect,
                near,
                far,
                &mut out,
            )
        };
        assert_eq!(
            (result == PELAGE_OK, out.flags == 77),
            (result == PELAGE_OK, result != PELAGE_OK)
        );
        result
    };
    let (eye, up) = ([0.0, 0.0, 3.0], [0.0, 1.0, 0.0]);
    ok(make(eye, up, 1.0, 1.0, 0.1, 1.0));
    wrong(make([0.0; 3], up, 1.0, 1.0, 0.1, 1.0), "eye");
    wrong(make(eye, [0.0, 0.0, 1.0], 1.0, 1.0, 0.1, 1.0), "up");
    wrong(make([f64::NAN; 3], up, 1.0, 1.0, 0.1, 1.0), "NaN");
    wrong(make(eye, up, 0.0, 1.0, 0.1, 1.0), "field of view 0");
    wrong(make(eye, up, 4.0, 1.0, 0.1, 1.0), "field of view 4");
    wrong(make(eye, up, 1.0, f64::NAN, 0.1, 1.0), "aspect ratio NaN");
    wrong(make(eye, up, 1.0, 1.0, 1.0, 0.5), "1…0.5");
}

#[test]
fn a_budget_too_small_is_out_of_memory_and_hair_draws_once_it_is_lifted() {
    let context = Context::new();
    let target = context.target(PELAGE_FORMAT_RGBA16F, false);
    let hair = context.hair();
    ok(pelage_context_set_byte_budget(context.0, 1));
    let mut id = PelageHair { id: UNTOUCHED };
    // SAFETY: the pointer is to a value of its type.
    let result =
        unsafe { pelage_hair_create_builtin(context.0, PELAGE_BUILTIN_STRAIGHT, 1000, &mut id) };
    fails(result, PELAGE_OUT_OF_MEMORY, "budget");
    assert_eq!(id.id, UNTOUCHED);
    fails(
        render(&context, &[hair], target, 0),
        PELAGE_OUT_OF_MEMORY,
        "budget",
    );
    ok(pelage_context_set_byte_budget(context.0, 0));
    ok(render(&context, &[hair], target, 0));
    assert!(read(target)[MIDDLE][3] > 0.5);
}
