//! Handles that are NULL, stale, of another kind, of another context, or made up.

use super::support::*;
use pelage::capi::*;

/// Every call that takes a hair alone.
fn hair_calls(hair: PelageHair) -> Vec<PelageResult> {
    let (mut info, mut points) = (PelageHairInfo::default(), [[0.0f32; 3]; 5]);
    let identity = pelage::glam::DMat4::IDENTITY.to_cols_array();
    // SAFETY: every pointer is to a value of its type, arrays are as large as they say.
    unsafe {
        vec![
            pelage_hair_info(hair, &mut info),
            pelage_hair_points(hair, points.as_mut_ptr().cast(), 60),
            pelage_hair_update_points(hair, points.as_ptr().cast(), 5),
            pelage_hair_set_transform(hair, identity.as_ptr()),
            pelage_hair_set_previous_transform(hair, identity.as_ptr()),
            pelage_hair_set_instances(hair, identity.as_ptr(), std::ptr::null(), 1),
            pelage_hair_rest(hair),
            pelage_hair_set_opacity(hair, 0.5),
            pelage_hair_set_shading(hair, &PelageShading::default()),
            pelage_hair_set_shadow(hair, std::ptr::null()),
            pelage_hair_set_transparency(hair, std::ptr::null()),
            pelage_hair_destroy(hair),
        ]
    }
}

/// Every call that takes a target alone.
fn target_calls(target: PelageTarget) -> Vec<PelageResult> {
    let mut colours = vec![0.0f32; (SIDE * SIDE * 4) as usize];
    let mut depths = vec![0.0f32; (SIDE * SIDE) as usize];
    let (colour_size, depth_size) = (
        size_of_val(&colours[..]) as u64,
        size_of_val(&depths[..]) as u64,
    );
    let mut readback = PelageReadback::default();
    // SAFETY: every pointer is to a value of its type, arrays are as large as they say.
    unsafe {
        vec![
            pelage_target_write_colour(target, colours.as_ptr(), colour_size),
            pelage_target_write_depth(target, depths.as_ptr(), depth_size),
            pelage_target_read_colour(target, colours.as_mut_ptr(), colour_size),
            pelage_target_read_depth(target, depths.as_mut_ptr(), depth_size),
            pelage_target_read_output(
                target,
                PELAGE_OUTPUT_COVERAGE,
                depths.as_mut_ptr().cast(),
                depth_size,
            ),
            pelage_readback_begin_colour(target, &mut readback),
            pelage_readback_begin_depth(target, &mut readback),
            pelage_target_destroy(target),
        ]
    }
}

/// Every call that takes a readback alone.
fn readback_calls(readback: PelageReadback) -> Vec<PelageResult> {
    let (mut arrived, mut values) = (0, vec![0.0f32; (SIDE * SIDE * 4) as usize]);
    // SAFETY: every pointer is to a value of its type, arrays are as large as they say.
    unsafe {
        vec![
            pelage_readback_poll(readback, &mut arrived),
            pelage_readback_copy(
                readback,
                values.as_mut_ptr(),
                size_of_val(&values[..]) as u64,
            ),
            pelage_readback_destroy(readback),
        ]
    }
}

/// Every call that takes a context.
fn context_calls(context: PelageContext) -> Vec<PelageResult> {
    let (mut adapter, mut statistics, mut count) =
        (PelageAdapter::default(), PelageStatistics::default(), 0);
    let (mut hair, mut target) = (PelageHair::default(), PelageTarget::default());
    let (arrays, view) = (Arrays::crossing(), view());
    let image = PelageTargetDescriptor {
        width: 8,
        height: 8,
        ..Default::default()
    };
    let file = PelageFile::default();
    // SAFETY: every pointer is to a value of its type, arrays are as large as they say.
    unsafe {
        vec![
            pelage_context_adapter(context, &mut adapter),
            pelage_context_set_byte_budget(context, 0),
            pelage_context_set_shadow_reuse(context, 1),
            pelage_wait(context),
            pelage_statistics(context, &mut statistics),
            pelage_bytes_by_label(context, 0, std::ptr::null_mut(), &mut count),
            pelage_pass_times(context, 0, std::ptr::null_mut(), &mut count),
            pelage_hair_create_from_strands(context, &arrays.strands(), &mut hair),
            pelage_hair_memory_estimate(context, &arrays.strands(), &mut count),
            pelage_hair_create_interpolated_on_mesh(
                context,
                &arrays.strands(),
                &Default::default(),
                &mut hair,
            ),
            pelage_hair_create_interpolated_clumps(
                context,
                &arrays.strands(),
                &Default::default(),
                &mut hair,
            ),
            pelage_hair_create_from_file(context, &file, &mut hair),
            pelage_hair_create_builtin(context, PELAGE_BUILTIN_STRAIGHT, 10, &mut hair),
            pelage_target_create(context, &image, &mut target),
            pelage_render(context, &frame(&[], &[], &view), target, 0),
            pelage_render_timed(context, &frame(&[], &[], &view), target, 0),
            pelage_frame_memory_estimate(
                context,
                &frame(&[], &[], &view),
                &image,
                0,
                &mut PelageMemoryEstimate::default(),
            ),
            pelage_context_destroy(context),
        ]
    }
}

#[track_caller]
fn all_refused(results: Vec<PelageResult>, words: &str) {
    for (at, result) in results.iter().enumerate() {
        assert_eq!(
            *result,
            PELAGE_INVALID_HANDLE,
            "call {at}: {}",
            last_error()
        );
    }
    fails(PELAGE_INVALID_HANDLE, PELAGE_INVALID_HANDLE, words);
}

#[test]
fn null_handles_are_refused_by_every_call() {
    all_refused(hair_calls(PelageHair::default()), "hair…NULL");
    all_refused(target_calls(PelageTarget::default()), "target…NULL");
    all_refused(readback_calls(PelageReadback::default()), "readback…NULL");
    all_refused(context_calls(PelageContext::default()), "context…NULL");
}

#[test]
fn made_up_handles_are_refused_by_every_call() {
    for id in [
        1,
        2,
        3,
        4,
        5,
        7,
        8,
        u64::MAX,
        u64::MAX - 6,
        1 << 63,
        0xdead_beef << 8 | 2,
    ] {
        all_refused(hair_calls(PelageHair { id }), "hair handle");
        all_refused(target_calls(PelageTarget { id }), "target handle");
        all_refused(readback_calls(PelageReadback { id }), "readback handle");
        all_refused(context_calls(PelageContext { id }), "context handle");
    }
}

#[test]
fn handles_of_another_kind_are_refused_by_name() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, true));
    all_refused(
        hair_calls(PelageHair { id: target.id }),
        "hair handle…is that of a target",
    );
    all_refused(
        target_calls(PelageTarget { id: hair.id }),
        "target handle…is that of a hair",
    );
    all_refused(
        context_calls(PelageContext { id: hair.id }),
        "context handle…is that of a hair",
    );
    all_refused(
        readback_calls(PelageReadback { id: context.0.id }),
        "readback handle…is that of a context",
    );
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
}

#[test]
fn destroyed_handles_are_stale_for_every_call_and_for_ever() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, true));
    let mut readback = PelageReadback::default();
    // SAFETY: the pointer is to a value of its type.
    ok(unsafe { pelage_readback_begin_colour(target, &mut readback) });
    ok(pelage_hair_destroy(hair));
    ok(pelage_target_destroy(target));
    ok(pelage_readback_destroy(readback));
    // Newer objects do not take the place of the old ones.
    let (new_hair, new_target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, true));
    assert!(new_hair.id != hair.id && new_target.id != target.id);
    all_refused(hair_calls(hair), "hair handle…stale");
    all_refused(target_calls(target), "target handle…stale");
    all_refused(readback_calls(readback), "readback handle…stale");
    fails(
        render(&context, &[new_hair, hair], new_target, 0),
        PELAGE_INVALID_HANDLE,
        "hairs[1]…stale",
    );
    fails(
        render(&context, &[new_hair], target, 0),
        PELAGE_INVALID_HANDLE,
        "target handle…stale",
    );
}

#[test]
fn what_was_made_on_a_context_is_stale_after_it() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, true));
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
    ok(pelage_context_destroy(context.0));
    all_refused(hair_calls(hair), "hair handle…stale");
    all_refused(target_calls(target), "target handle…stale");
    all_refused(context_calls(context.0), "context handle…stale");
}

#[test]
fn hairs_and_targets_of_another_context_are_refused() {
    let (one, other) = (Context::new(), Context::new());
    let (hair, target) = (one.hair(), one.target(PELAGE_FORMAT_RGBA16F, false));
    let (foreign_hair, foreign_target) = (other.hair(), other.target(PELAGE_FORMAT_RGBA16F, false));
    fails(
        render(&one, &[hair, foreign_hair], target, 0),
        PELAGE_INVALID_HANDLE,
        "hairs[1]…belongs to another context",
    );
    fails(
        render(&one, &[hair], foreign_target, 0),
        PELAGE_INVALID_HANDLE,
        "belongs to another context",
    );
    ok(render(&one, &[hair], target, 0));
}
