//! Hair whose points come from a buffer of the GPU's: as if the CPU had given them.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Curve, Strands, builtin, tessellate};
use pelage::host::offscreen::{Image, WantedOutputs};
use pelage::wgpu::util::DeviceExt;
use pelage::{Error, Frame, Hair, Light, PointSource, Renderer, Target, testing, wgpu};

use crate::common::images::{FORMAT, Tolerance, assert_close, read};
use crate::common::scenes::portrait;
use crate::common::{Device, device};

const SIZE: [u32; 2] = [82, 108];

/// Both ways are single precision, of positions below 1 and with differing origins: a step at 0.25 is 3e-8.
const POSITION: f64 = 1.2e-7;
/// What a sliver more or less of a fibre makes of a pixel.
const CLOSE: Tolerance = Tolerance {
    rmse: 1e-4,
    p99: 1e-4,
};

fn swung(points: &[[f32; 3]], amount: f32) -> Vec<[f32; 3]> {
    let swing = |p: &[f32; 3]| {
        [
            p[0] + amount * (0.1 - p[1]) + 0.3,
            p[1],
            p[2] + amount * p[1] * p[0],
        ]
    };
    points.iter().map(swing).collect()
}

/// The box around the points and their curves, as the CPU has it.
fn bounds(strands: &Strands, points: &[[f32; 3]]) -> [DVec3; 2] {
    let mut moved = strands.clone();
    moved.set_points(points).unwrap();
    let cut = tessellate(&moved, testing::curve_pieces(strands)).unwrap();
    let (low, high) = cut.bounds().unwrap();
    [Vec3::from(low).as_dvec3(), Vec3::from(high).as_dvec3()]
}

/// Positions among other words, as an engine's vertices have them.
pub fn interleaved(
    device: &wgpu::Device,
    points: &[[f32; 3]],
    offset: usize,
    stride: usize,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let mut words = vec![f32::NAN; offset / 4];
    for (at, point) in points.iter().enumerate() {
        words.resize(offset / 4 + at * stride / 4, f32::NAN);
        words.extend_from_slice(point);
    }
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("the host's vertices"),
        contents: bytemuck::cast_slice(&words),
        usage,
    })
}

fn update(
    renderer: &mut Renderer,
    hair: &mut Hair,
    points: &[[f32; 3]],
    [offset, stride]: [usize; 2],
    bounds: [DVec3; 2],
) {
    let usage = wgpu::BufferUsages::STORAGE;
    let buffer = interleaved(renderer.device(), points, offset, stride, usage);
    let mut encoder = renderer
        .device()
        .create_command_encoder(&Default::default());
    let source = PointSource {
        buffer: &buffer,
        offset: offset as u64,
        stride: stride as u64,
        bounds,
    };
    renderer
        .update_points_from(&mut encoder, hair, &source)
        .unwrap();
    renderer.queue().submit([encoder.finish()]);
}

/// A hair's points in the groom's space, in the renderer's own order.
pub fn points(renderer: &Renderer, hair: &Hair) -> Vec<DVec3> {
    let (buffer, origin) = testing::points_buffer(hair);
    let copy = renderer.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = renderer
        .device()
        .create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, None);
    renderer.queue().submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    let wait = wgpu::PollType::wait_indefinitely();
    renderer.device().poll(wait).unwrap();
    let bytes = copy.get_mapped_range(..).unwrap().to_vec();
    bytemuck::cast_slice::<u8, [f32; 4]>(&bytes)
        .iter()
        // What fills up a run has no size.
        .filter(|p| p[3] > 0.0)
        .map(|p| Vec3::new(p[0], p[1], p[2]).as_dvec3() + origin)
        .collect()
}

pub fn largest_distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| a.distance(*b));
    distances.fold(0.0, |most, way| {
        if way > most || way.is_nan() {
            way
        } else {
            most
        }
    })
}

pub fn draw(
    device: &mut Device,
    hair: &Hair,
) -> (pelage_reference::composite::Image, Vec<f32>, Vec<u32>) {
    let lights = [Light::directional(DVec3::new(-0.4, -0.7, -0.6), Vec3::ONE)];
    let hairs = [hair];
    let mut view = portrait(SIZE);
    view.view_from_world *= pelage::glam::DMat4::from_translation(DVec3::new(-0.3, 0.0, 0.0));
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::splat(0.1),
        view,
        transparency: None,
    };
    let mut held: Image = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    let wanted = WantedOutputs {
        motion: true,
        ids: true,
        ..Default::default()
    };
    device.add_outputs(&mut held, wanted).unwrap();
    let target = Target {
        outputs: held.outputs(),
        ..Target::cleared(&held.colour)
    };
    device.render(&frame, &target).unwrap();
    let motion = device
        .read_words(held.outputs.motion.as_ref().unwrap())
        .unwrap();
    let ids = device
        .read_words(held.outputs.ids.as_ref().unwrap())
        .unwrap();
    let colour = read(device, &held.colour);
    (
        colour,
        motion.into_iter().map(f32::from_bits).collect(),
        ids,
    )
}

/// Asserts that two hairs are drawn alike and have moved alike.
pub fn assert_alike(device: &mut Device, name: &str, actual: &Hair, expected: &Hair) -> f32 {
    let [a, b] = [actual, expected].map(|hair| draw(device, hair));
    assert_close(name, &a.0, &b.0, CLOSE);
    let (mut others, mut pixels, mut fastest) = (0, 0, 0.0f32);
    for at in 0..a.2.len() / 2 {
        if a.2[2 * at..][..2] != b.2[2 * at..][..2] {
            others += 1;
            continue;
        }
        pixels += usize::from(a.2[2 * at] != pelage::NO_STRAND);
        for axis in 0..2 {
            let (a, b) = (a.1[2 * at + axis], b.1[2 * at + axis]);
            assert!((a - b).abs() < 4e-3, "{name}: motion {a} for {b}");
            fastest = fastest.max(b.abs());
        }
    }
    assert!(pixels > 500, "{name}: {pixels} pixels show hair");
    assert!(
        others * 200 < pixels,
        "{name}: {others} pixels show another strand"
    );
    fastest
}

#[test]
fn points_from_a_buffer_are_those_that_the_cpu_would_have_given() {
    let Some(mut device) = device() else { return };
    for (groom, curve, layout) in [
        (BuiltinGroom::Curly, Curve::CatmullRom, [20, 28]),
        (BuiltinGroom::Straight, Curve::Polyline, [0, 12]),
    ] {
        let name = &format!("{groom:?}");
        let strands = builtin(groom, 300).unwrap().with_curve(curve);
        let pieces = testing::curve_pieces(&strands);
        assert_eq!(pieces > 1, curve == Curve::CatmullRom, "{pieces} pieces");
        let renderer = &mut device.renderer;
        let [mut ours, mut theirs] = [(); 2].map(|()| renderer.create_hair(&strands).unwrap());
        let steps = [-0.2, 0.17, 0.3].map(|amount| swung(strands.points(), amount));
        let boxes = [0, 1, 2].map(|step| bounds(&strands, &steps[step]));
        for step in 0..2 {
            update(renderer, &mut ours, &steps[step], layout, boxes[step]);
            renderer.update_points(&mut theirs, &steps[step]).unwrap();
        }
        let differ = largest_distance(&points(renderer, &ours), &points(renderer, &theirs));
        eprintln!("{name}: {pieces} pieces, points differ by {differ:e}");
        assert!(differ < POSITION, "{name}: {differ}");
        assert!(assert_alike(&mut device, name, &ours, &theirs) > 3.0);
        ours.rest();
        theirs.rest();
        assert_eq!(assert_alike(&mut device, name, &ours, &theirs), 0.0);

        // The CPU goes on where the GPU has left off, and the other way round.
        for hair in [&mut ours, &mut theirs] {
            device.renderer.update_points(hair, &steps[2]).unwrap();
        }
        assert!(assert_alike(&mut device, name, &ours, &theirs) > 1.0);
        assert_eq!(ours.strands().points(), steps[2]);
        update(&mut device.renderer, &mut ours, &steps[0], layout, boxes[0]);
        device
            .renderer
            .update_points(&mut theirs, &steps[0])
            .unwrap();
        assert!(assert_alike(&mut device, name, &ours, &theirs) > 3.0);
        assert_eq!(ours.strands().points(), steps[2], "the CPU is not told");
    }
}

#[test]
fn several_updates_of_one_submission_happen_in_turn() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 200).unwrap();
    let renderer = &mut device.renderer;
    let [mut ours, mut theirs] = [(); 2].map(|()| renderer.create_hair(&strands).unwrap());
    let steps = [0.2, -0.1].map(|amount| swung(strands.points(), amount));
    let buffers = [0, 1].map(|step| {
        let usage = wgpu::BufferUsages::STORAGE;
        interleaved(renderer.device(), &steps[step], 0, 16, usage)
    });
    let mut encoder = renderer
        .device()
        .create_command_encoder(&Default::default());
    for step in 0..2 {
        let source = PointSource {
            buffer: &buffers[step],
            offset: 0,
            stride: 16,
            bounds: bounds(&strands, &steps[step]),
        };
        renderer
            .update_points_from(&mut encoder, &mut ours, &source)
            .unwrap();
        renderer.update_points(&mut theirs, &steps[step]).unwrap();
    }
    renderer.queue().submit([encoder.finish()]);
    assert!(assert_alike(&mut device, "two updates", &ours, &theirs) > 3.0);
}

/// A renderer on a device that binds 32 KiB at once.
pub fn renderer_of_small_bindings() -> Renderer {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    descriptor.flags = wgpu::InstanceFlags::empty();
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).unwrap();
    let (small, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits {
            max_storage_buffer_binding_size: 1 << 15,
            ..adapter.limits()
        },
        ..Default::default()
    }))
    .unwrap();
    Renderer::new(&small, &queue).unwrap()
}

#[test]
fn a_device_of_small_bindings_gathers_in_parts() {
    let Some(device) = device() else { return };
    let strands = builtin(BuiltinGroom::Curly, 300).unwrap();
    let moved = swung(strands.points(), 0.2);
    let corners = bounds(&strands, &moved);
    let mut whole = device;
    let mut theirs = whole.renderer.create_hair(&strands).unwrap();
    update(&mut whole.renderer, &mut theirs, &moved, [8, 44], corners);
    let expected = points(&whole.renderer, &theirs);

    let mut renderer = renderer_of_small_bindings();
    let mut ours = renderer.create_hair(&strands).unwrap();
    assert!(moved.len() * 44 > 4 << 15, "{} points", moved.len());
    update(&mut renderer, &mut ours, &moved, [8, 44], corners);
    let actual = points(&renderer, &ours);
    assert_eq!(largest_distance(&actual, &expected), 0.0);
    assert!(actual.len() > 2 * (1 << 15) / 24, "several runs");
}

#[test]
fn positions_that_are_no_numbers_leave_their_points_where_they_were() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 200)
        .unwrap()
        .with_curve(Curve::Polyline);
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let mut expected = device.renderer.create_hair(&strands).unwrap();
    let moved = swung(strands.points(), 0.2);
    let (mut broken, mut mended) = (moved.clone(), moved.clone());
    for (at, value) in [f32::NAN, f32::INFINITY, -f32::INFINITY, -f32::NAN]
        .into_iter()
        .enumerate()
    {
        for point in (11 + at..moved.len()).step_by(97) {
            broken[point][at % 3] = value;
            mended[point] = strands.points()[point];
        }
    }
    let corners = bounds(&strands, &mended);
    update(&mut device.renderer, &mut hair, &broken, [0, 12], corners);
    device
        .renderer
        .update_points(&mut expected, &mended)
        .unwrap();
    let [a, b] = [&hair, &expected].map(|hair| points(&device.renderer, hair));
    assert!(largest_distance(&a, &b) < POSITION);
    assert_alike(&mut device, "mended", &hair, &expected);

    // Nothing but rubbish, and numbers whose curves overflow: no harm is done, and the next good points are drawn.
    for value in [f32::NAN, f32::MAX, 1e30] {
        let rubbish: Vec<[f32; 3]> = (0..moved.len())
            .map(|at| if at % 2 == 0 { [value; 3] } else { [-value; 3] })
            .collect();
        for curve in [Curve::Polyline, Curve::CatmullRom] {
            let curved = strands.clone().with_curve(curve);
            let mut wild = device.renderer.create_hair(&curved).unwrap();
            update(&mut device.renderer, &mut wild, &rubbish, [0, 12], corners);
            draw(&mut device, &wild);
        }
        update(&mut device.renderer, &mut hair, &rubbish, [0, 12], corners);
        draw(&mut device, &hair);
    }
    let corners = bounds(&strands, &moved);
    update(&mut device.renderer, &mut hair, &moved, [0, 12], corners);
    let mut expected = device.renderer.create_hair(&strands).unwrap();
    device
        .renderer
        .update_points(&mut expected, &moved)
        .unwrap();
    hair.rest();
    expected.rest();
    assert_alike(&mut device, "recovered", &hair, &expected);
}

#[test]
fn what_is_wrong_with_a_source_is_named_and_changes_nothing() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 20).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let count = strands.points().len();
    let before = points(&device.renderer, &hair);
    let storage = wgpu::BufferUsages::STORAGE;
    let good = interleaved(device.renderer.device(), strands.points(), 16, 16, storage);
    let other = interleaved(
        device.renderer.device(),
        strands.points(),
        16,
        16,
        wgpu::BufferUsages::VERTEX,
    );
    let corners = bounds(&strands, strands.points());
    let nan = [DVec3::NAN, DVec3::ONE];
    let size = good.size();
    let needed = 20 + 16 * (count - 1) + 12;
    for (buffer, offset, stride, bounds, sentence) in [
        (
            &other,
            16,
            16,
            corners,
            "the buffer's usage BufferUsages(VERTEX) lacks STORAGE".to_string(),
        ),
        (
            &good,
            18,
            16,
            corners,
            "offset 18 is not a multiple of 4".into(),
        ),
        (
            &good,
            16,
            8,
            corners,
            "stride 8 is not a multiple of 4 of at least 12".into(),
        ),
        (
            &good,
            16,
            14,
            corners,
            "stride 14 is not a multiple of 4 of at least 12".into(),
        ),
        (
            &good,
            20,
            16,
            corners,
            format!(
                "{count} points from offset 20 at stride 16 take {needed} bytes; the buffer has {size}"
            ),
        ),
        (
            &good,
            u64::MAX - 3,
            16,
            corners,
            format!("take {} bytes", u64::MAX),
        ),
        (
            &good,
            16,
            16,
            nan,
            "bounds from [NaN, NaN, NaN] to [1, 1, 1] make no box".into(),
        ),
        (
            &good,
            16,
            16,
            [DVec3::ONE, DVec3::ZERO],
            "make no box".into(),
        ),
        (
            &good,
            16,
            16,
            [DVec3::ZERO, DVec3::splat(1e300)],
            "beyond single precision".into(),
        ),
        (
            &good,
            16,
            1 << 40,
            corners,
            "stride 1099511627776: this device takes up to".into(),
        ),
    ] {
        let mut encoder = device
            .renderer
            .device()
            .create_command_encoder(&Default::default());
        let source = PointSource {
            buffer,
            offset,
            stride,
            bounds,
        };
        let error = device
            .renderer
            .update_points_from(&mut encoder, &mut hair, &source)
            .unwrap_err();
        assert!(error.to_string().contains(&sentence), "{error}\n{sentence}");
        assert!(matches!(
            error,
            Error::InvalidValue(_) | Error::Unsupported(_)
        ));
        device.renderer.queue().submit([encoder.finish()]);
    }
    assert_eq!(points(&device.renderer, &hair), before);
    device.renderer.set_byte_budget(Some(0));
    let mut encoder = device
        .renderer
        .device()
        .create_command_encoder(&Default::default());
    let source = PointSource {
        buffer: &good,
        offset: 16,
        stride: 16,
        bounds: corners,
    };
    let error = device
        .renderer
        .update_points_from(&mut encoder, &mut hair, &source)
        .unwrap_err();
    assert!(matches!(error, Error::OutOfMemory(_)), "{error}");
    device.renderer.set_byte_budget(None);
    device
        .renderer
        .update_points_from(&mut encoder, &mut hair, &source)
        .unwrap();
    device.renderer.queue().submit([encoder.finish()]);
    let ledger = device.renderer.statistics().bytes;
    assert!(
        ledger
            .iter()
            .any(|(label, bytes)| label == "pelage.geometry.places" && *bytes >= 4 * count as u64)
    );

    let empty = Strands::new(Vec::new(), &[], 0.0).unwrap();
    let mut none = device.renderer.create_hair(&empty).unwrap();
    let mut encoder = device
        .renderer
        .device()
        .create_command_encoder(&Default::default());
    device
        .renderer
        .update_points_from(&mut encoder, &mut none, &source)
        .unwrap();
}
