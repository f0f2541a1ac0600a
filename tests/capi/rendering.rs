//! What the calls do when they are given what they want.

use super::support::*;
use pelage::capi::*;

#[test]
fn a_frame_shows_hair_where_it_is_and_nothing_elsewhere() {
    let context = Context::new();
    for format in [PELAGE_FORMAT_RGBA16F, PELAGE_FORMAT_RGBA32F] {
        let target = context.target(format, false);
        ok(render(
            &context,
            &[context.hair()],
            target,
            PELAGE_RENDER_CLEAR,
        ));
        let pixels = read(target);
        assert!(
            pixels[MIDDLE][3] > 0.99 && pixels[MIDDLE][0] > 0.01,
            "{:?}",
            pixels[MIDDLE]
        );
        assert_eq!(
            pixels[SIDE as usize / 2],
            [0.0; 4],
            "above the crossing there is none"
        );
    }
}

#[test]
fn shadow_maps_are_kept_unless_the_context_is_told_otherwise() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let (lights, view, hairs) = ([PelageLight::default()], view(), [hair]);
    let frame = frame(&hairs, &lights, &view);
    let maps = || {
        // SAFETY: the frame points to values that live.
        ok(unsafe { pelage_render(context.0, &frame, target, PELAGE_RENDER_CLEAR) });
        ok(pelage_wait(context.0));
        let statistics = context.statistics();
        (statistics.shadow_maps_filled, statistics.shadow_maps_taken)
    };
    assert_eq!([maps(), maps()], [(1, 0), (0, 1)]);
    ok(pelage_context_set_shadow_reuse(context.0, 0));
    assert_eq!([maps(), maps()], [(1, 0), (1, 0)]);
    ok(pelage_context_set_shadow_reuse(context.0, 1));
    assert_eq!([maps(), maps()], [(1, 0), (0, 1)]);
    wrong(
        pelage_context_set_shadow_reuse(context.0, 2),
        "reuse 2 is neither 0 nor 1",
    );
    assert_eq!(maps(), (0, 1), "as it was");
}

#[test]
fn moved_and_turned_hair_is_drawn_where_it_went() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let mut points = [[0.0f32; 3]; 5];
    let away = pelage::glam::DMat4::from_translation(pelage::glam::DVec3::X * 50.0).to_cols_array();
    let back =
        pelage::glam::DMat4::from_translation(pelage::glam::DVec3::X * -50.0).to_cols_array();
    let seen = || {
        ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
        read(target)[MIDDLE][3]
    };
    // SAFETY: arrays are as large as they say.
    unsafe {
        ok(pelage_hair_set_transform(hair, away.as_ptr()));
        assert_eq!(seen(), 0.0);
        ok(pelage_hair_points(
            hair,
            points.as_mut_ptr().cast(),
            size_of_val(&points) as u64,
        ));
        assert_eq!(points[0], [-1.0, -1.0, 0.0]);
        points.iter_mut().for_each(|point| point[0] += 50.0);
        ok(pelage_hair_update_points(hair, points.as_ptr().cast(), 5));
        ok(pelage_hair_set_transform(hair, back.as_ptr()));
    }
    assert!(seen() > 0.99);
    ok(pelage_hair_set_opacity(hair, 0.0));
    assert_eq!(seen(), 0.0);
}

#[test]
fn every_technique_draws_alike_where_a_single_strand_is_seen() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA32F, false));
    let opaque = PelageOpaque::default();
    let mut pictures = Vec::new();
    for raster in [
        PELAGE_RASTER_AUTO,
        PELAGE_RASTER_RIBBONS,
        PELAGE_RASTER_WALK,
    ] {
        for storage in [PELAGE_STORAGE_COUNTED, PELAGE_STORAGE_LISTS] {
            let a_buffer = PelageABuffer {
                storage,
                raster,
                ..Default::default()
            };
            let technique = PELAGE_TRANSPARENCY_A_BUFFER;
            let transparency = PelageTransparency {
                technique,
                a_buffer: &a_buffer,
                ..Default::default()
            };
            // SAFETY: the pointers are to values that live.
            ok(unsafe { pelage_hair_set_transparency(hair, &transparency) });
            ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
            pictures.push(read(target));
        }
    }
    let transparency = PelageTransparency {
        technique: PELAGE_TRANSPARENCY_OPAQUE,
        opaque: &opaque,
        ..Default::default()
    };
    // SAFETY: the pointers are to values that live.
    ok(unsafe { pelage_hair_set_transparency(hair, &transparency) });
    ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR));
    pictures.push(read(target));
    /// Rounding of coverages to 16 bits, and of colours to half floats.
    const TOLERANCE: f32 = 4e-3;
    for (number, picture) in pictures.iter().enumerate() {
        let furthest = picture
            .iter()
            .zip(&pictures[0])
            .map(|(a, b)| (a[3] - b[3]).abs())
            .fold(0.0, f32::max);
        assert!(
            furthest <= TOLERANCE,
            "picture {number} is off by {furthest}"
        );
    }
}

#[test]
fn wishes_that_differ_are_a_conflict_that_the_frame_settles() {
    let context = Context::new();
    let (one, other, target) = (
        context.hair(),
        context.hair(),
        context.target(PELAGE_FORMAT_RGBA16F, false),
    );
    let wish = |technique| PelageTransparency {
        technique,
        ..Default::default()
    };
    // SAFETY: the pointers are to values that live.
    unsafe {
        ok(pelage_hair_set_transparency(
            one,
            &wish(PELAGE_TRANSPARENCY_OPAQUE),
        ));
        ok(pelage_hair_set_transparency(
            other,
            &wish(PELAGE_TRANSPARENCY_A_BUFFER),
        ));
        fails(
            render(&context, &[one, other], target, 0),
            PELAGE_CONFLICT,
            "opaque…a_buffer",
        );
        let (view, settled) = (view(), wish(PELAGE_TRANSPARENCY_A_BUFFER));
        let hairs = [one, other];
        let frame = PelageFrame {
            transparency: &settled,
            ..frame(&hairs, &[], &view)
        };
        ok(pelage_render(context.0, &frame, target, 0));
        ok(pelage_hair_set_transparency(one, std::ptr::null()));
        ok(render(&context, &[one, other], target, 0));

        let none = PelageShadow {
            technique: PELAGE_SHADOW_NONE,
            ..Default::default()
        };
        ok(pelage_hair_set_shadow(one, &none));
        ok(pelage_hair_set_shadow(other, &PelageShadow::default()));
        fails(
            render(&context, &[one, other], target, 0),
            PELAGE_CONFLICT,
            "none…deep_opacity_map",
        );
        ok(pelage_hair_set_shadow(other, std::ptr::null()));
        ok(render(&context, &[one, other], target, 0));
    }
}

#[test]
fn the_opaque_scene_is_kept_and_hides_hair() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA32F, true));
    let count = (SIDE * SIDE) as usize;
    let scene = vec![[0.25f32, 0.5, 0.75, 1.0]; count];
    // The left half of the scene stands right before the eye, the right half far away, each row at a depth of its own.
    let depths: Vec<f32> = (0..count)
        .map(|at| {
            if at as u32 % SIDE < SIDE / 2 {
                0.0
            } else {
                1.0 - (at / SIDE as usize) as f32 * 1e-4
            }
        })
        .collect();
    let mut back = vec![0.0f32; count];
    // SAFETY: arrays are as large as they say.
    unsafe {
        ok(pelage_target_write_colour(
            target,
            scene.as_ptr().cast(),
            size_of_val(&scene[..]) as u64,
        ));
        ok(pelage_target_write_depth(
            target,
            depths.as_ptr(),
            size_of_val(&depths[..]) as u64,
        ));
        ok(pelage_target_read_depth(
            target,
            back.as_mut_ptr(),
            size_of_val(&back[..]) as u64,
        ));
        assert!(back == depths, "a depth comes back as it was written");
        ok(render(&context, &[hair], target, PELAGE_RENDER_WRITE_DEPTH));
        ok(pelage_target_read_depth(
            target,
            back.as_mut_ptr(),
            size_of_val(&back[..]) as u64,
        ));
    }
    let pixels = read(target);
    let left = MIDDLE - 1;
    assert_eq!(
        pixels[left],
        [0.25, 0.5, 0.75, 1.0],
        "the near half hides the hair"
    );
    assert_eq!(back[left], 0.0);
    assert!(
        pixels[MIDDLE] != [0.25, 0.5, 0.75, 1.0],
        "before the far half there is hair"
    );
    assert!(
        back[MIDDLE] < 0.99,
        "whose depth is written: {}",
        back[MIDDLE]
    );
    assert_eq!(
        pixels[SIDE as usize / 2 + 2],
        [0.25, 0.5, 0.75, 1.0],
        "the scene beside the hair is kept"
    );
}

#[test]
fn an_image_read_asynchronously_is_the_one_read_at_once() {
    let context = Context::new();
    let target = context.target(PELAGE_FORMAT_RGBA16F, true);
    ok(render(
        &context,
        &[context.hair()],
        target,
        PELAGE_RENDER_CLEAR | PELAGE_RENDER_WRITE_DEPTH,
    ));
    let (mut colour, mut depth) = (PelageReadback::default(), PelageReadback::default());
    // SAFETY: arrays are as large as they say, pointers are to values of their types.
    unsafe {
        ok(pelage_readback_begin_colour(target, &mut colour));
        ok(pelage_readback_begin_depth(target, &mut depth));
        // What happens to the target afterwards does not change the images.
        let before = read(target);
        ok(render(&context, &[], target, PELAGE_RENDER_CLEAR));
        ok(pelage_target_destroy(target));
        let mut arrived = 0;
        let start = std::time::Instant::now();
        while arrived == 0 {
            ok(pelage_readback_poll(colour, &mut arrived));
            assert!(start.elapsed().as_secs() < 60, "the image never arrives");
        }
        let mut pixels = vec![[0.0f32; 4]; before.len()];
        let size = size_of_val(&pixels[..]) as u64;
        fails(
            pelage_readback_copy(colour, pixels.as_mut_ptr().cast(), size / 4),
            PELAGE_INVALID_VALUE,
            "values",
        );
        for _ in 0..2 {
            ok(pelage_readback_copy(
                colour,
                pixels.as_mut_ptr().cast(),
                size,
            ));
            assert!(pixels == before);
        }
        // Without a poll before it, the copy waits.
        let mut depths = vec![0.0f32; before.len()];
        fails(
            pelage_readback_copy(depth, depths.as_mut_ptr(), size),
            PELAGE_INVALID_VALUE,
            "values",
        );
        ok(pelage_readback_copy(depth, depths.as_mut_ptr(), size / 4));
        assert!(depths[MIDDLE] < 1.0 && depths[0] == 1.0 || depths[0] < 1.0);
        ok(pelage_readback_destroy(colour));
        fails(
            pelage_readback_destroy(colour),
            PELAGE_INVALID_HANDLE,
            "stale",
        );
    }
}

#[test]
fn a_frame_states_its_memory_before_it_is_rendered() {
    let context = Context::new();
    let (lights, view, hairs) = ([PelageLight::default()], view(), [context.hair()]);
    let frame = frame(&hairs, &lights, &view);
    let image = |width| PelageTargetDescriptor {
        width,
        height: SIDE,
        ..Default::default()
    };
    let mut estimate = PelageMemoryEstimate::default();
    // SAFETY: the frame points to values that live; the other pointers are to values of their types.
    unsafe {
        let flags = PELAGE_RENDER_CLEAR;
        let estimate_of = |image: &PelageTargetDescriptor, estimate: &mut PelageMemoryEstimate| {
            pelage_frame_memory_estimate(context.0, &frame, image, flags, estimate)
        };
        wrong(estimate_of(&image(0), &mut estimate), "0×32 pixels");
        assert_eq!(estimate.bytes_total, 0);
        ok(estimate_of(&image(SIDE), &mut estimate));
        assert!(estimate.bytes_added > 0, "{estimate:?}");
        let target = context.target(PELAGE_FORMAT_RGBA16F, false);
        ok(pelage_render(context.0, &frame, target, flags));
        ok(pelage_wait(context.0));
        assert_eq!(estimate.bytes_total, context.statistics().bytes_total);
        let parts = [
            estimate.bytes_geometry,
            estimate.bytes_shading,
            estimate.bytes_shadow,
            estimate.bytes_transparency,
            estimate.bytes_raster,
        ];
        assert!(parts[..4].iter().all(|bytes| *bytes > 0), "{estimate:?}");
        assert!(parts.iter().sum::<u64>() <= estimate.bytes_total);
        wrong(
            pelage_frame_memory_estimate(context.0, &frame, std::ptr::null(), 0, &mut estimate),
            "target is NULL",
        );
    }
}

#[test]
fn shadow_images_alone_need_no_pixels_buffers() {
    let context = Context::new();
    let (lights, view, hairs) = ([PelageLight::default()], view(), [context.hair()]);
    let frame = frame(&hairs, &lights, &view);
    let image = PelageTargetDescriptor {
        width: SIDE,
        height: SIDE,
        with_depth: 1,
        ..Default::default()
    };
    let [all, few] = [0, PELAGE_RENDER_SHADOWS_ONLY].map(|flags| {
        let mut estimate = PelageMemoryEstimate::default();
        // SAFETY: the frame points to values that live; the other pointers are to values of their types.
        ok(unsafe {
            pelage_frame_memory_estimate(context.0, &frame, &image, flags, &mut estimate)
        });
        estimate
    });
    assert_eq!(few.bytes_shadow, all.bytes_shadow);
    assert!(few.bytes_transparency < all.bytes_transparency);
}

#[test]
fn a_hair_states_its_memory_before_it_is_made() {
    let context = Context::new();
    let arrays = Arrays::crossing();
    let estimate = |strands: &PelageStrands, bytes: *mut u64| {
        // SAFETY: the arrays are as large as they say; the result is NULL or a value of its type.
        unsafe { pelage_hair_memory_estimate(context.0, strands, bytes) }
    };
    let mut bytes = 7;
    let short = PelageStrands {
        point_count: 4,
        ..arrays.strands()
    };
    wrong(estimate(&short, &mut bytes), "5 points…4 are given");
    assert_eq!(bytes, 7);
    let null = std::ptr::null_mut();
    wrong(estimate(&arrays.strands(), null), "bytes is NULL");
    ok(estimate(&arrays.strands(), &mut bytes));
    let before = context.statistics().bytes_total;
    let mut hair = PelageHair::default();
    // SAFETY: as above.
    ok(unsafe { pelage_hair_create_from_strands(context.0, &arrays.strands(), &mut hair) });
    assert_eq!(context.statistics().bytes_total - before, bytes);
    assert!(bytes > 0);
}

#[test]
fn statistics_count_and_lists_are_filled_up_to_their_capacity() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let (lights, view, hairs) = ([PelageLight::default()], view(), [hair]);
    let frame = frame(&hairs, &lights, &view);
    let mut count = u64::MAX;
    // SAFETY: the frame points to values that live; entries are as many as they say.
    unsafe {
        ok(pelage_pass_times(
            context.0,
            0,
            std::ptr::null_mut(),
            &mut count,
        ));
        assert_eq!(count, 0, "no frame has been timed");
        ok(pelage_render_timed(
            context.0,
            &frame,
            target,
            PELAGE_RENDER_CLEAR,
        ));
        ok(pelage_pass_times(
            context.0,
            0,
            std::ptr::null_mut(),
            &mut count,
        ));
        assert!(count > 3);
        let mut passes = vec![
            PelagePassTime {
                label: [1; PELAGE_LABEL_SIZE],
                ms: -1.0
            };
            count as usize
        ];
        ok(pelage_pass_times(
            context.0,
            2,
            passes.as_mut_ptr(),
            &mut count,
        ));
        assert!(
            passes[1].ms >= 0.0 && passes[2].ms == -1.0,
            "two were asked for"
        );
        ok(pelage_pass_times(
            context.0,
            u64::MAX,
            passes.as_mut_ptr(),
            &mut count,
        ));
        for pass in &passes {
            let label = std::ffi::CStr::from_ptr(pass.label.as_ptr())
                .to_str()
                .unwrap();
            assert!(
                label.starts_with("pelage.") && pass.ms >= 0.0,
                "{label} {}",
                pass.ms
            );
        }
        ok(pelage_wait(context.0));
        let statistics = context.statistics();
        assert_eq!((statistics.strands, statistics.segments), (2, 3));
        assert!(
            statistics.fragments_produced > 30 && statistics.fragments_merged == 0,
            "{statistics:?}"
        );
        ok(pelage_bytes_by_label(
            context.0,
            0,
            std::ptr::null_mut(),
            &mut count,
        ));
        let mut bytes = vec![
            PelageLabelBytes {
                label: [0; PELAGE_LABEL_SIZE],
                bytes: 0
            };
            count as usize
        ];
        ok(pelage_bytes_by_label(
            context.0,
            count,
            bytes.as_mut_ptr(),
            &mut count,
        ));
        assert_eq!(
            bytes.iter().map(|entry| entry.bytes).sum::<u64>(),
            context.statistics().bytes_total
        );
    }
}

#[test]
fn grooms_come_from_guides_files_and_nothing() {
    let context = Context::new();
    let info = |hair| {
        let mut info = PelageHairInfo::default();
        // SAFETY: the pointer is to a value of its type.
        ok(unsafe { pelage_hair_info(hair, &mut info) });
        info
    };
    let mut hair = PelageHair::default();
    let arrays = Arrays::crossing();
    // SAFETY: the pointers are to values that live.
    unsafe {
        let clumps = PelageClumpSettings {
            followers: 3,
            root_radius: 0.1,
            ..Default::default()
        };
        ok(pelage_hair_create_interpolated_clumps(
            context.0,
            &arrays.strands(),
            &clumps,
            &mut hair,
        ));
        assert_eq!((info(hair).strand_count, info(hair).point_count), (8, 20));
        ok(pelage_hair_create_builtin(
            context.0,
            PELAGE_BUILTIN_CURLY,
            50,
            &mut hair,
        ));
        assert_eq!(
            (info(hair).strand_count, info(hair).curve),
            (50, PELAGE_CURVE_CATMULL_ROM)
        );
        assert!(info(hair).low[1] < info(hair).high[1]);
        let strands =
            pelage::groom::Strands::new(arrays.positions.clone(), &arrays.counts, 0.1).unwrap();
        let bytes = pelage::groom::formats::write_hair(&strands).unwrap();
        let file = PelageFile {
            bytes: bytes.as_ptr().cast(),
            size: bytes.len() as u64,
            curve: PELAGE_CURVE_CATMULL_ROM,
            root_radius: 0.2,
            ..Default::default()
        };
        ok(pelage_hair_create_from_file(context.0, &file, &mut hair));
        assert_eq!(
            (
                info(hair).strand_count,
                info(hair).point_count,
                info(hair).curve
            ),
            (2, 5, PELAGE_CURVE_CATMULL_ROM)
        );
    }
}

#[test]
fn the_adapter_and_the_version_have_names() {
    let (context, mut adapter) = (Context::new(), PelageAdapter::default());
    // SAFETY: the pointer is to a value of its type; the texts end with a NUL.
    unsafe {
        ok(pelage_context_adapter(context.0, &mut adapter));
        assert!(!std::ffi::CStr::from_ptr(adapter.name.as_ptr()).is_empty());
        assert_eq!(adapter.software, 1);
        let version = std::ffi::CStr::from_ptr(pelage_version()).to_str().unwrap();
        assert_eq!(
            version,
            format!("{PELAGE_VERSION_MAJOR}.{PELAGE_VERSION_MINOR}.{PELAGE_VERSION_PATCH}")
        );
    }
}
