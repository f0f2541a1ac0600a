//! NULL pointers, wrong sizes, unknown enumerators: each an error whose sentence names it.

use std::ptr::{null, null_mut};

use super::support::*;
use pelage::capi::*;

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
        wrong(
            pelage_context_create(null(), &mut PelageContext::default()),
            "descriptor is NULL",
        );
        wrong(
            pelage_context_create(&Default::default(), null_mut()),
            "context is NULL",
        );
        wrong(
            pelage_context_adapter(context.0, null_mut()),
            "adapter is NULL",
        );
        wrong(
            pelage_hair_create_from_strands(context.0, null(), &mut id),
            "strands is NULL",
        );
        wrong(
            pelage_hair_create_from_strands(context.0, &arrays, &mut id),
            "positions is NULL",
        );
        wrong(
            pelage_hair_create_builtin(context.0, 0, 1, null_mut()),
            "hair is NULL",
        );
        wrong(
            pelage_hair_create_from_file(context.0, null(), &mut id),
            "file is NULL",
        );
        wrong(
            pelage_hair_set_transform(hair, null()),
            "world_from_object is NULL",
        );
        wrong(pelage_hair_set_shading(hair, null()), "shading is NULL");
        wrong(
            pelage_hair_update_points(hair, null(), 5),
            "positions is NULL",
        );
        wrong(
            pelage_hair_points(hair, null_mut(), 60),
            "positions is NULL",
        );
        wrong(pelage_hair_info(hair, null_mut()), "info is NULL");
        wrong(
            pelage_target_create(context.0, null(), &mut Default::default()),
            "descriptor is NULL",
        );
        wrong(
            pelage_target_write_colour(target, null(), size * 16),
            "pixels is NULL",
        );
        wrong(
            pelage_target_write_depth(target, null(), size * 4),
            "depths is NULL",
        );
        wrong(
            pelage_target_read_colour(target, null_mut(), size * 16),
            "pixels is NULL",
        );
        wrong(
            pelage_target_read_depth(target, null_mut(), size * 4),
            "depths is NULL",
        );
        wrong(
            pelage_readback_begin_colour(target, null_mut()),
            "readback is NULL",
        );
        wrong(pelage_render(context.0, null(), target, 0), "frame is NULL");
        wrong(
            pelage_statistics(context.0, null_mut()),
            "statistics is NULL",
        );
        wrong(counted(null_mut()), "entries is NULL…4");
        wrong(
            pelage_bytes_by_label(context.0, 0, null_mut(), null_mut()),
            "count is NULL",
        );
        let eye = [0.0; 3];
        let view = pelage_view_perspective(
            eye.as_ptr(),
            null(),
            eye.as_ptr(),
            1.0,
            1.0,
            0.1,
            1.0,
            &mut view(),
        );
        wrong(view, "target is NULL");
    }
}

#[test]
fn frames_with_null_parts_are_refused() {
    let context = Context::new();
    let (hair, target, view) = (
        context.hair(),
        context.target(PELAGE_FORMAT_RGBA16F, false),
        view(),
    );
    let render = |change: &dyn Fn(&mut PelageFrame)| {
        let hairs = [hair];
        let lights = [PelageLight::default()];
        let mut frame = frame(&hairs, &lights, &view);
        change(&mut frame);
        // SAFETY: NULL parts are what the call must notice.
        unsafe { pelage_render(context.0, &frame, target, 0) }
    };
    wrong(render(&|frame| frame.view = null()), "view is NULL");
    wrong(render(&|frame| frame.hairs = null()), "hairs is NULL");
    wrong(render(&|frame| frame.lights = null()), "lights is NULL…1");
    ok(render(&|_| ()));
}

#[test]
fn wrong_struct_sizes_are_named_with_the_initialiser() {
    let context = Context::new();
    let mut arrays = Arrays::crossing().strands();
    for size in [
        0,
        1,
        4,
        arrays.struct_size - 1,
        arrays.struct_size + 8,
        u32::MAX,
    ] {
        arrays.struct_size = size;
        let words = format!("struct_size {size} …PelageStrands…PELAGE_STRANDS_INIT");
        wrong(create(&context, &arrays), &words);
    }
    let lights = [
        PelageLight::default(),
        PelageLight {
            struct_size: 3,
            ..Default::default()
        },
    ];
    let (view, target) = (view(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let frame = frame(&[], &lights, &view);
    // SAFETY: the frame points to values that live.
    let result = unsafe { pelage_render(context.0, &frame, target, 0) };
    wrong(result, "lights[1]…struct_size 3");
    let mut statistics = PelageStatistics {
        struct_size: 7,
        strands: UNTOUCHED,
        ..Default::default()
    };
    // SAFETY: the pointer is to a value of its type.
    wrong(
        unsafe { pelage_statistics(context.0, &mut statistics) },
        "struct_size 7",
    );
    assert_eq!(statistics.strands, UNTOUCHED);
}

#[test]
fn unknown_enumerators_and_flags_are_named() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let arrays = Arrays::crossing();
    let strands = PelageStrands {
        curve: 9,
        ..arrays.strands()
    };
    wrong(create(&context, &strands), "curve 9…PELAGE_CURVE_");
    wrong(render(&context, &[hair], target, 8), "flags…0x8");
    let mut id = PelageHair::default();
    // SAFETY: every pointer is to a value of its type.
    unsafe {
        wrong(
            pelage_hair_create_builtin(context.0, 3, 1, &mut id),
            "groom 3…PELAGE_BUILTIN_",
        );
        let shading = PelageShading {
            model: 44,
            ..Default::default()
        };
        wrong(
            pelage_hair_set_shading(hair, &shading),
            "model 44…PELAGE_SHADING_",
        );
        let shadow = PelageShadow {
            technique: 45,
            ..Default::default()
        };
        wrong(
            pelage_hair_set_shadow(hair, &shadow),
            "technique 45…PELAGE_SHADOW_",
        );
        let transparency = PelageTransparency {
            technique: 46,
            ..Default::default()
        };
        let result = pelage_hair_set_transparency(hair, &transparency);
        wrong(result, "technique 46…PELAGE_TRANSPARENCY_");
        let a_buffer = PelageABuffer {
            storage: 5,
            ..Default::default()
        };
        let transparency = PelageTransparency {
            technique: PELAGE_TRANSPARENCY_A_BUFFER,
            a_buffer: &a_buffer,
            ..Default::default()
        };
        wrong(
            pelage_hair_set_transparency(hair, &transparency),
            "storage 5…PELAGE_STORAGE_",
        );
        let map = PelageDeepOpacityMap {
            raster: 6,
            ..Default::default()
        };
        let shadow = PelageShadow {
            deep_opacity_map: &map,
            ..Default::default()
        };
        wrong(
            pelage_hair_set_shadow(hair, &shadow),
            "raster 6…PELAGE_RASTER_",
        );
        let image = PelageTargetDescriptor {
            width: 4,
            height: 4,
            format: 99,
            ..Default::default()
        };
        let result = pelage_target_create(context.0, &image, &mut PelageTarget::default());
        wrong(result, "format 99…PELAGE_FORMAT_");
        let (lights, mut view) = (
            [PelageLight {
                kind: 99,
                ..Default::default()
            }],
            view(),
        );
        let result = pelage_render(context.0, &frame(&[hair], &lights, &view), target, 0);
        wrong(result, "light 0…kind 99…PELAGE_LIGHT_");
        view.flags = 8;
        wrong(
            pelage_render(context.0, &frame(&[hair], &[], &view), target, 0),
            "flags…0x8",
        );
        let descriptor = PelageContextDescriptor {
            validation: 2,
            ..Default::default()
        };
        let result = pelage_context_create(&descriptor, &mut PelageContext::default());
        wrong(result, "validation 2");
    }
}
