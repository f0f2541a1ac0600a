//! Outputs beside the colour, rectangles, instances and motion through the C ABI.

use std::ptr::{null, null_mut};

use pelage::capi::*;
use pelage::glam::{DMat4, DVec3};

use super::support::*;

const EVERY: u32 =
    PELAGE_OUTPUT_NEAREST_DEPTH | PELAGE_OUTPUT_COVERAGE | PELAGE_OUTPUT_MOTION | PELAGE_OUTPUT_IDS;

fn target(context: &Context, outputs: u32) -> PelageTarget {
    let descriptor = PelageTargetDescriptor {
        width: SIDE,
        height: SIDE,
        format: PELAGE_FORMAT_RGBA32F,
        outputs,
        ..Default::default()
    };
    let mut target = PelageTarget::default();
    // SAFETY: both pointers are to values of their types.
    ok(unsafe { pelage_target_create(context.0, &descriptor, &mut target) });
    target
}

fn words(target: PelageTarget, which: u32, each: usize) -> Vec<u32> {
    let mut values = vec![7u32; (SIDE * SIDE) as usize * each];
    let size = size_of_val(&values[..]) as u64;
    // SAFETY: the array is as large as it says.
    ok(unsafe { pelage_target_read_output(target, which, values.as_mut_ptr().cast(), size) });
    values
}

fn render(context: &Context, hairs: &[PelageHair], view: &PelageView, target: PelageTarget) {
    let frame = PelageFrame {
        hairs: hairs.as_ptr(),
        hair_count: hairs.len() as u32,
        view,
        ambient: [1.0; 3],
        ..Default::default()
    };
    // SAFETY: the frame and what it points to live through the call.
    ok(unsafe { pelage_render(context.0, &frame, target, PELAGE_RENDER_CLEAR) });
}

#[test]
fn outputs_tell_of_the_nearest_fibre() {
    let context = Context::new();
    let hair = context.hair();
    let target = target(&context, EVERY);
    render(&context, &[hair], &view(), target);
    let ids = words(target, PELAGE_OUTPUT_IDS, 2);
    let coverage = words(target, PELAGE_OUTPUT_COVERAGE, 1);
    let depth = words(target, PELAGE_OUTPUT_NEAREST_DEPTH, 1);
    let motion = words(target, PELAGE_OUTPUT_MOTION, 2);
    let mut strands = [0; 2];
    for at in 0..coverage.len() {
        let (hair, strand) = (ids[2 * at], ids[2 * at + 1]);
        let (coverage, depth) = (f32::from_bits(coverage[at]), f32::from_bits(depth[at]));
        if hair == PELAGE_NO_STRAND {
            assert_eq!((strand, coverage, depth), (PELAGE_NO_STRAND, 0.0, 1.0));
        } else {
            assert!(hair == 0 && coverage > 0.0 && depth > 0.0 && depth < 1.0);
            strands[strand as usize] += 1;
        }
        assert_eq!(motion[2 * at..][..2], [0, 0]);
    }
    assert!(strands[0] > 10 && strands[1] > 10, "{strands:?}");
}

#[test]
fn hair_camera_and_points_that_move_are_told_from_the_frame_before() {
    let context = Context::new();
    let hair = context.hair();
    let target = target(&context, EVERY);
    // The longest motion to the right, in pixels.
    let right = |view: &PelageView| {
        render(&context, &[hair], view, target);
        let motion = words(target, PELAGE_OUTPUT_MOTION, 2);
        motion
            .chunks(2)
            .map(|way| f32::from_bits(way[0]))
            .fold(
                0.0f32,
                |most, way| if way.abs() > most.abs() { way } else { most },
            )
    };
    let still = view();
    assert_eq!(right(&still), 0.0);
    let before = DMat4::from_translation(DVec3::new(-0.5, 0.0, 0.0)).to_cols_array();
    // SAFETY: sixteen doubles.
    ok(unsafe { pelage_hair_set_previous_transform(hair, before.as_ptr()) });
    assert!(right(&still) > 1.0, "the hair came from the left");
    // SAFETY: NULL is allowed.
    ok(unsafe { pelage_hair_set_previous_transform(hair, null()) });
    assert_eq!(right(&still), 0.0);

    let mut panned = view();
    panned.flags |= PELAGE_VIEW_PREVIOUS;
    panned.previous_clip_from_view = panned.clip_from_view;
    panned.previous_view_from_world = (DMat4::from_translation(DVec3::new(0.5, 0.0, 0.0))
        * DMat4::from_cols_array(&panned.view_from_world))
    .to_cols_array();
    assert!(right(&panned) < -1.0, "the camera panned to the right");
    panned.previous_view_from_world = panned.view_from_world;
    panned.jitter = [1.5, 0.0];
    let shift = right(&panned) + 1.5;
    assert!(
        shift.abs() < 1e-5,
        "jitter that the projection does not have: {shift}"
    );

    let moved: Vec<[f32; 3]> = Arrays::crossing()
        .positions
        .iter()
        .map(|p| [p[0] + 0.5, p[1], p[2]])
        .collect();
    // SAFETY: the array is as long as it says.
    ok(unsafe { pelage_hair_update_points(hair, moved.as_ptr().cast(), moved.len() as u64) });
    assert!(right(&still) > 1.0, "the points moved to the right");
    ok(pelage_hair_rest(hair));
    assert_eq!(right(&still), 0.0);
}

#[test]
fn a_view_fills_its_rectangle_with_every_instance() {
    let context = Context::new();
    let hair = context.hair();
    let target = target(&context, PELAGE_OUTPUT_IDS);
    let places = [-0.4, 0.4].map(|x| {
        DMat4::from_scale_rotation_translation(
            DVec3::splat(0.4),
            pelage::glam::DQuat::IDENTITY,
            DVec3::new(x, 0.0, 0.0),
        )
        .to_cols_array()
    });
    // SAFETY: two transforms, as it says; NULL is allowed.
    ok(unsafe { pelage_hair_set_instances(hair, places.as_ptr().cast(), null(), 2) });
    let mut part = view();
    part.rectangle = [4, 6, 20, 22];
    render(&context, &[hair], &part, target);
    let ids = words(target, PELAGE_OUTPUT_IDS, 2);
    let mut seen = [0; 2];
    for y in 0..SIDE {
        for x in 0..SIDE {
            let hair = ids[2 * (y * SIDE + x) as usize];
            if !(4..24).contains(&x) || !(6..28).contains(&y) {
                // Outputs are not cleared; outside the rectangle nothing was ever written.
                assert_eq!(hair, 0, "{x}, {y}");
            } else if hair != PELAGE_NO_STRAND {
                seen[(hair >> 16) as usize] += 1;
            }
        }
    }
    assert!(seen[0] > 5 && seen[1] > 5, "{seen:?}");
}

#[test]
fn what_outputs_and_instances_cannot_be_is_named() {
    let context = Context::new();
    let hair = context.hair();
    let without = target(&context, PELAGE_OUTPUT_COVERAGE);
    let mut values = vec![0u32; (SIDE * SIDE * 2) as usize];
    let pointer = values.as_mut_ptr().cast();
    let size = u64::from(SIDE * SIDE) * 4;
    // SAFETY: the arrays are as large as they say, or the call must refuse before it uses them.
    unsafe {
        let read = pelage_target_read_output;
        wrong(
            read(without, PELAGE_OUTPUT_IDS, pointer, 2 * size),
            "without the output ids",
        );
        wrong(read(without, 3, pointer, size), "which 3");
        wrong(
            read(without, PELAGE_OUTPUT_COVERAGE, pointer, size + 4),
            "size",
        );
        wrong(
            read(without, PELAGE_OUTPUT_COVERAGE, null_mut(), size),
            "values is NULL",
        );

        let zero = [0.0f64; 32];
        let instances = pelage_hair_set_instances;
        wrong(
            instances(hair, zero.as_ptr(), null(), 2),
            "object_from_instance[0]…inverted",
        );
        wrong(instances(hair, null(), null(), 1), "NULL…1 instances");
        wrong(instances(hair, null(), null(), 65536), "65536 instances");
        wrong(
            pelage_hair_set_previous_transform(hair, zero.as_ptr()),
            "inverted",
        );

        let descriptor = PelageTargetDescriptor {
            width: 4,
            height: 4,
            outputs: 16,
            ..Default::default()
        };
        let mut target = PelageTarget { id: 99 };
        wrong(
            pelage_target_create(context.0, &descriptor, &mut target),
            "outputs…16",
        );
        assert_eq!(target.id, 99);
    }
    let refused = |change: &dyn Fn(&mut PelageView), words: &str| {
        let mut changed = view();
        change(&mut changed);
        let frame = PelageFrame {
            hairs: &hair,
            hair_count: 1,
            view: &changed,
            ..Default::default()
        };
        // SAFETY: the frame and what it points to live through the call.
        wrong(
            unsafe { pelage_render(context.0, &frame, without, 0) },
            words,
        );
    };
    refused(
        &|view| view.rectangle = [20, 0, 20, 10],
        "rectangle of 20×10 pixels at (20, 0)",
    );
    refused(&|view| view.jitter = [f32::INFINITY, 0.0], "jitter");
    refused(&|view| view.flags = 8, "flags…0x8");
}
