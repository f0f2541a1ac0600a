//! What is written beside the colour, and where: motion, picking, coverage and depth against the reference, rectangles,
//! instances, and hosts whose clip space is another.

use pelage::glam::{DMat4, DQuat, DVec2, DVec3, DVec4, Vec3};
use pelage::groom::{BuiltinGroom, Curve, builtin};
use pelage::host::offscreen::{Image, WantedOutputs};
use pelage::raster::Raster;
use pelage::transparency::{
    DepthPeeling, KBuffer, KBufferSinglePass, KPlusBuffer, Moment, Opaque, RandomSubsets,
    SortedBlending, Storage, Transparency, WeightedBlended,
};
use pelage::{Error, Frame, Hair, Instance, NO_STRAND, Outputs, PreviousView, Target, View, wgpu};
use pelage_reference::fragments::FragmentLists;

use crate::common::images::{FORMAT, assert_identical, read, render};
use crate::common::scenes::{WHITE, World, a_buffer, lists, portrait, unshadowed, world};
use crate::common::{Device, device};

const SIZE: [u32; 2] = [82, 108];

const ALL: WantedOutputs = WantedOutputs {
    nearest_depth: true,
    coverage: true,
    motion: true,
    ids: true,
};

/// Stored depths are single precision: half a step at 1, with the error of the projection.
const DEPTH: f32 = 1e-6;
/// As the A-buffer's alpha: opacities of 16 bits, and slivers that round to nothing in single precision.
const COVERAGE: f32 = 4e-3;
/// In pixels: positions on the screen in single precision, and motion taken as linear along a segment of a few pixels.
const MOTION: f64 = 4e-3;
/// The part of the pixels in which fibres lie at the same depth to single precision, or only a sliver of the nearest one
/// does: 1 of 2,163 was measured.
const TIES: f64 = 0.002;

fn techniques() -> [(&'static str, Transparency); 11] {
    [
        ("counted", a_buffer(Storage::Counted, Raster::Walk)),
        ("lists", a_buffer(Storage::Lists, Raster::Ribbons)),
        ("k_buffer", Transparency::KBuffer(KBuffer::default())),
        (
            "k_plus_buffer",
            Transparency::KPlusBuffer(KPlusBuffer::default()),
        ),
        (
            "k_buffer_single_pass",
            Transparency::KBufferSinglePass(KBufferSinglePass::default()),
        ),
        ("moment", Transparency::Moment(Moment::default())),
        (
            "opaque",
            Transparency::Opaque(Opaque {
                raster: Raster::Walk,
            }),
        ),
        (
            "weighted_blended",
            Transparency::WeightedBlended(WeightedBlended {
                raster: Raster::Ribbons,
                ..Default::default()
            }),
        ),
        (
            "depth_peeling",
            Transparency::DepthPeeling(DepthPeeling {
                peels: 3,
                raster: Raster::Walk,
            }),
        ),
        (
            "random_subsets",
            Transparency::RandomSubsets(RandomSubsets::default()),
        ),
        (
            "sorted_blending",
            Transparency::SortedBlending(SortedBlending {
                full_precision: true,
                ..Default::default()
            }),
        ),
    ]
}

fn image(device: &Device, size: [u32; 2], wanted: WantedOutputs) -> Image {
    let mut image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    device.add_outputs(&mut image, wanted).unwrap();
    image
}

fn target(image: &Image) -> Target<'_> {
    Target {
        outputs: image.outputs(),
        ..Target::cleared(&image.colour)
    }
}

fn words(device: &mut Device, texture: &Option<wgpu::Texture>) -> Vec<u32> {
    device.read_words(texture.as_ref().unwrap()).unwrap()
}

fn floats(device: &mut Device, texture: &Option<wgpu::Texture>) -> Vec<f32> {
    words(device, texture)
        .into_iter()
        .map(f32::from_bits)
        .collect()
}

/// Where every point of the reference's strands was in the frame before, in world space.
fn points_before(hairs: &[&Hair], before: &[Vec<[f32; 3]>]) -> Vec<DVec3> {
    let mut points = Vec::new();
    for (hair, before) in hairs.iter().zip(before) {
        let place = hair
            .previous_world_from_object
            .unwrap_or(hair.world_from_object);
        points.extend(
            before
                .iter()
                .map(|p| place.transform_point3(Vec3::from(*p).as_dvec3())),
        );
    }
    points
}

fn pixel(clip_from_world: DMat4, point: DVec3, size: [u32; 2]) -> DVec2 {
    let clip = clip_from_world * point.extend(1.0);
    let ndc = clip.truncate().truncate() / clip.w;
    DVec2::new(
        (0.5 + 0.5 * ndc.x) * f64::from(size[0]),
        (0.5 - 0.5 * ndc.y) * f64::from(size[1]),
    )
}

/// The nearest fragment's depth, hair, strand and motion in a pixel, and the pixel's coverage.
fn expected(
    lists: &FragmentLists,
    at: usize,
    world: &World,
    before: &[DVec3],
    view: &View,
    opacity: f64,
) -> Option<(f64, [u32; 2], DVec2, f64)> {
    let fragments = lists.pixel(at);
    let seen = |f: &&pelage_reference::fragments::Fragment| f.coverage > 1e-6;
    let nearest = fragments
        .iter()
        .filter(seen)
        .min_by(|a, b| a.depth.total_cmp(&b.depth))?;
    let coverage = 1.0
        - fragments
            .iter()
            .map(|f| 1.0 - opacity * f.coverage)
            .product::<f64>();
    let first = nearest.segment as usize;
    let between = |points: &[DVec3]| points[first].lerp(points[first + 1], nearest.t);
    let previous = view.previous.unwrap();
    let now = pixel(
        view.clip_from_view * view.view_from_world,
        between(&world.strands.points),
        SIZE,
    );
    let then = pixel(
        previous.clip_from_view * previous.view_from_world,
        between(before),
        SIZE,
    );
    let jitter = DVec2::new(
        f64::from(view.jitter[0] - previous.jitter[0]),
        f64::from(view.jitter[1] - previous.jitter[1]),
    );
    let (hair, strand) = world.sources[nearest.strand as usize];
    Some((
        nearest.depth,
        [hair as u32, strand as u32],
        now - then - jitter,
        coverage,
    ))
}

/// A projection shifted by pixels, +x right and +y down.
fn jittered(view: &View, jitter: [f32; 2]) -> DMat4 {
    let shift = DVec3::new(
        2.0 * f64::from(jitter[0]) / f64::from(SIZE[0]),
        -2.0 * f64::from(jitter[1]) / f64::from(SIZE[1]),
        0.0,
    );
    DMat4::from_translation(shift) * view.clip_from_view
}

#[test]
fn outputs_match_the_reference_for_a_moving_groom() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 400)
        .unwrap()
        .with_curve(Curve::Polyline);
    let mut moving = device.renderer.create_hair(&strands).unwrap();
    let mut turning = device.renderer.create_hair(&strands).unwrap();
    let rest = strands.points().to_vec();
    let swung = |amount: f32| -> Vec<[f32; 3]> {
        rest.iter()
            .map(|p| {
                [
                    p[0] + amount * (0.1 - p[1]),
                    p[1],
                    p[2] + 0.5 * amount * p[1],
                ]
            })
            .collect()
    };
    let before = swung(0.11);
    device
        .renderer
        .update_points(&mut moving, &swung(-0.3))
        .unwrap();
    device.renderer.update_points(&mut moving, &before).unwrap();
    device
        .renderer
        .update_points(&mut moving, &swung(0.17))
        .unwrap();
    turning.world_from_object = DMat4::from_rotation_translation(
        DQuat::from_rotation_y(0.4),
        DVec3::new(0.05, -0.02, -0.1),
    );
    turning.previous_world_from_object = Some(DMat4::from_rotation_translation(
        DQuat::from_rotation_y(0.3),
        DVec3::new(0.03, -0.02, -0.1),
    ));
    for hair in [&mut moving, &mut turning] {
        hair.shading = WHITE;
        hair.opacity = 0.6;
    }
    let mut view = portrait(SIZE);
    view.jitter = [0.25, -0.4];
    let mut previous = portrait(SIZE);
    previous.view_from_world =
        DMat4::from_translation(DVec3::new(0.002, 0.001, 0.01)) * previous.view_from_world;
    view.previous = Some(PreviousView {
        view_from_world: previous.view_from_world,
        clip_from_view: jittered(&previous, [-0.125, 0.3]),
        jitter: [-0.125, 0.3],
    });
    view.clip_from_view = jittered(&view, view.jitter);
    let hairs = [&moving, &turning];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    for (name, transparency) in techniques() {
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view,
            transparency: Some(transparency),
        };
        let lists = lists(&frame, SIZE, None);
        let world = world(&hairs);
        let then = points_before(&hairs, &[before.clone(), rest.clone()]);
        let held = image(&device, SIZE, ALL);
        device.render(&frame, &target(&held)).unwrap();
        let depth = floats(&mut device, &held.outputs.nearest_depth);
        let coverage = floats(&mut device, &held.outputs.coverage);
        let motion = floats(&mut device, &held.outputs.motion);
        let ids = words(&mut device, &held.outputs.ids);
        let (mut covered, mut ties, mut fastest) = (0, 0, 0.0f64);
        for at in 0..depth.len() {
            let got = [ids[2 * at], ids[2 * at + 1]];
            let way = DVec2::new(f64::from(motion[2 * at]), f64::from(motion[2 * at + 1]));
            let Some((exact_depth, exact_ids, exact_motion, exact_coverage)) =
                expected(&lists, at, &world, &then, &view, 0.6)
            else {
                if lists.pixel(at).is_empty() {
                    assert_eq!(
                        (depth[at], got, way),
                        (1.0, [NO_STRAND; 2], DVec2::ZERO),
                        "{name}"
                    );
                    assert_eq!(coverage[at], 0.0, "{name}");
                }
                continue;
            };
            covered += 1;
            assert!(
                (coverage[at] - exact_coverage as f32).abs() < COVERAGE,
                "{name}: coverage {} for {exact_coverage}",
                coverage[at]
            );
            fastest = fastest.max(exact_motion.length());
            if (depth[at] - exact_depth as f32).abs() > DEPTH
                || got != exact_ids
                || way.distance(exact_motion) > MOTION
            {
                ties += 1;
            }
        }
        let part = f64::from(ties) / f64::from(covered);
        eprintln!(
            "outputs, {name}: {covered} pixels, {part:.5} differ, up to {fastest:.2} px of motion"
        );
        assert!(
            covered > 1000 && fastest > 3.0,
            "{name}: the scene shows little"
        );
        assert!(part < TIES, "{name}: {part} of the pixels differ");
    }
}

#[test]
fn what_rests_has_no_motion() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Curly, 200).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let moved: Vec<[f32; 3]> = strands
        .points()
        .iter()
        .map(|p| [p[0] + 0.02, p[1], p[2]])
        .collect();
    let longest = |device: &mut Device, hair: &Hair| {
        let hairs = [hair];
        let frame = Frame {
            hairs: &hairs,
            lights: &[],
            ambient: Vec3::ONE,
            view: portrait(SIZE),
            transparency: None,
        };
        let held = image(device, SIZE, ALL);
        device.render(&frame, &target(&held)).unwrap();
        let motion = floats(device, &held.outputs.motion);
        motion.iter().fold(0.0f32, |most, way| most.max(way.abs()))
    };
    assert_eq!(longest(&mut device, &hair), 0.0, "never moved");
    device.renderer.update_points(&mut hair, &moved).unwrap();
    assert!(longest(&mut device, &hair) > 1.0, "moved");
    hair.rest();
    assert_eq!(longest(&mut device, &hair), 0.0, "at rest");
    device
        .renderer
        .update_points(&mut hair, strands.points())
        .unwrap();
    assert!(longest(&mut device, &hair) > 1.0, "moved back");
}

#[test]
fn a_rectangle_holds_what_a_target_of_its_size_would_and_nothing_else_is_touched() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.5;
    let hairs = [&hair];
    let lights = [pelage::Light::directional(
        DVec3::new(-0.4, -0.7, -0.6),
        Vec3::ONE,
    )];
    let size = [40, 52];
    let rectangle = [13, 29, size[0], size[1]];
    for (name, transparency) in techniques() {
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::splat(0.1),
            view: portrait(size),
            transparency: Some(transparency),
        };
        // A slanted wall through the hair.
        let wall = |x: i32, y: i32| 0.885 + 0.0007 * (x + y) as f32;
        let draw = |device: &mut Device, all: [u32; 2], rectangle: Option<[u32; 4]>| {
            let mut held = device.create_image(all[0], all[1], FORMAT, true).unwrap();
            device.add_outputs(&mut held, ALL).unwrap();
            let [left, top, ..] = rectangle.unwrap_or_default();
            let depths: Vec<f32> = (0..all[0] * all[1])
                .map(|at| {
                    wall(
                        (at % all[0]) as i32 - left as i32,
                        (at / all[0]) as i32 - top as i32,
                    )
                })
                .collect();
            device
                .write_depth(held.depth.as_ref().unwrap(), &depths)
                .unwrap();
            let under =
                vec![pelage::glam::Vec4::new(0.2, 0.3, 0.4, 1.0); (all[0] * all[1]) as usize];
            device.write_colour(&held.colour, &under).unwrap();
            let target = Target {
                depth: held.depth.as_ref(),
                clear: false,
                write_depth: true,
                receive_shadow: true,
                rectangle,
                ..target(&held)
            };
            device.render(&frame, &target).unwrap();
            let colour = read(device, &held.colour).pixels;
            let depth = device.read_depth(held.depth.as_ref().unwrap()).unwrap();
            let ids = words(device, &held.outputs.ids);
            let coverage = floats(device, &held.outputs.coverage);
            (colour, depth, ids, coverage, depths)
        };
        let small = draw(&mut device, size, None);
        let all = [71, 97];
        let large = draw(&mut device, all, Some(rectangle));
        assert!(
            small.3.iter().any(|part| *part > 0.5),
            "{name}: hair is seen"
        );
        for y in 0..all[1] {
            for x in 0..all[0] {
                let at = (y * all[0] + x) as usize;
                let (u, v) = (x.wrapping_sub(rectangle[0]), y.wrapping_sub(rectangle[1]));
                if u < size[0] && v < size[1] {
                    let own = (v * size[0] + u) as usize;
                    assert_eq!(large.0[at], small.0[own], "{name}: colour at {u}, {v}");
                    assert_eq!(large.1[at], small.1[own], "{name}: depth at {u}, {v}");
                    assert_eq!(large.2[2 * at..][..2], small.2[2 * own..][..2], "{name}");
                    assert_eq!(large.3[at], small.3[own], "{name}");
                } else {
                    let under = [0.2f32, 0.3, 0.4, 1.0].map(f64::from);
                    assert_eq!(large.0[at], under, "{name}: colour at {x}, {y}");
                    assert_eq!(large.1[at], large.4[at], "{name}: depth at {x}, {y}");
                    assert_eq!(large.3[at], 0.0, "{name}: coverage at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn instances_are_drawn_as_hairs_of_their_own_would_be() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 200).unwrap();
    let places = [
        DMat4::from_translation(DVec3::new(-0.12, 0.0, 0.0)),
        DMat4::from_scale_rotation_translation(
            DVec3::splat(0.7),
            DQuat::from_rotation_y(1.0),
            DVec3::new(0.12, 0.02, -0.05),
        ),
    ];
    let whole = DMat4::from_rotation_z(0.2);
    let mut single = device.renderer.create_hair(&strands).unwrap();
    single.world_from_object = whole;
    single.instances = places
        .map(|object_from_instance| Instance {
            object_from_instance,
            previous_object_from_instance: None,
        })
        .to_vec();
    let mut copies: Vec<Hair> = places
        .iter()
        .map(|place| {
            let mut hair = device.renderer.create_hair(&strands).unwrap();
            hair.world_from_object = whole * *place;
            hair
        })
        .collect();
    let lights = [pelage::Light::directional(
        DVec3::new(-0.4, -0.7, -0.6),
        Vec3::ONE,
    )];
    for hair in copies.iter_mut().chain([&mut single]) {
        hair.opacity = 0.5;
    }
    let draw = |device: &mut Device, hairs: &[&Hair]| {
        let frame = Frame {
            hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(SIZE),
            transparency: None,
        };
        let held = image(device, SIZE, ALL);
        let statistics = device.render(&frame, &target(&held)).unwrap();
        let ids = words(device, &held.outputs.ids);
        (read(device, &held.colour), ids, statistics)
    };
    let instanced = draw(&mut device, &[&single]);
    let separate = draw(&mut device, &[&copies[0], &copies[1]]);
    assert_identical("instances against hairs", &instanced.0, &separate.0);
    assert_eq!(instanced.2.strands, 400);
    let mut seen = [0; 2];
    for (a, b) in instanced.1.chunks(2).zip(separate.1.chunks(2)) {
        if a[0] == NO_STRAND {
            assert_eq!(b, [NO_STRAND; 2]);
            continue;
        }
        // The hair's number in the lower half, the instance's in the upper.
        assert_eq!([a[0] & 0xffff, a[0] >> 16, a[1]], [0, b[0], b[1]]);
        seen[b[0] as usize] += 1;
    }
    assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");

    single.instances[1].object_from_instance = DMat4::ZERO;
    let frame = Frame {
        hairs: &[&single],
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    };
    let held = image(&device, SIZE, WantedOutputs::default());
    let error = device.render(&frame, &target(&held)).unwrap_err();
    assert!(error.to_string().contains("instance 1"), "{error}");
}

#[test]
fn a_clip_space_that_points_down_gives_the_same_image() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let hairs = [&hair];
    let lights = [pelage::Light::directional(
        DVec3::new(-0.4, -0.7, -0.6),
        Vec3::ONE,
    )];
    let up = portrait(SIZE);
    let down = View {
        clip_from_view: DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)) * up.clip_from_view,
        flip_y: true,
        ..up
    };
    let [a, b] = [up, down].map(|view| {
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view,
            transparency: None,
        };
        render(&mut device, &frame, SIZE).0
    });
    assert_identical("y up against y down", &a, &b);
}

#[test]
fn a_far_plane_at_infinity_changes_nothing() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.5;
    let hairs = [&hair];
    let lights = [pelage::Light::directional(
        DVec3::new(-0.4, -0.7, -0.6),
        Vec3::ONE,
    )];
    let finite = portrait(SIZE);
    let infinite = |reverse: bool| {
        let near = 0.1;
        let mut clip = finite.clip_from_view;
        // Depth = 1 - near/distance; reversed, near/distance.
        let (scale, shift) = if reverse { (0.0, near) } else { (-1.0, -near) };
        clip.z_axis = DVec4::new(0.0, 0.0, scale, -1.0);
        clip.w_axis = DVec4::new(0.0, 0.0, shift, 0.0);
        View {
            clip_from_view: clip,
            reverse_z: reverse,
            ..finite
        }
    };
    let [expected, plain, reversed] = [finite, infinite(false), infinite(true)].map(|view| {
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view,
            transparency: None,
        };
        render(&mut device, &frame, SIZE).0
    });
    // Depths round otherwise, so that fibres at all but the same depth may change places.
    for (name, actual) in [("infinite", plain), ("infinite, reversed", reversed)] {
        crate::common::images::assert_close(
            name,
            &actual,
            &expected,
            crate::common::images::Tolerance {
                rmse: 1e-3,
                p99: 4e-3,
            },
        );
    }
}

#[test]
fn a_frame_without_hair_says_so_in_every_output() {
    let Some(mut device) = device() else { return };
    for reverse_z in [false, true] {
        let frame = Frame {
            hairs: &[],
            lights: &[],
            ambient: Vec3::ONE,
            view: View {
                reverse_z,
                ..portrait(SIZE)
            },
            transparency: None,
        };
        let held = image(&device, SIZE, ALL);
        device.render(&frame, &target(&held)).unwrap();
        let far = if reverse_z { 0.0 } else { 1.0 };
        let depth = floats(&mut device, &held.outputs.nearest_depth);
        assert!(depth.iter().all(|depth| *depth == far));
        assert!(
            words(&mut device, &held.outputs.ids)
                .iter()
                .all(|id| *id == NO_STRAND)
        );
        assert!(
            floats(&mut device, &held.outputs.motion)
                .iter()
                .all(|way| *way == 0.0)
        );
        assert!(
            floats(&mut device, &held.outputs.coverage)
                .iter()
                .all(|part| *part == 0.0)
        );
    }
}

#[test]
fn outputs_and_rectangles_that_do_not_fit_are_refused_by_name() {
    let Some(mut device) = device() else { return };
    let hair = device
        .renderer
        .create_hair(&builtin(BuiltinGroom::Straight, 10).unwrap())
        .unwrap();
    let hairs = [&hair];
    let frame = Frame {
        hairs: &hairs,
        lights: &[],
        ambient: Vec3::ONE,
        view: portrait(SIZE),
        transparency: None,
    };
    let held = image(&device, SIZE, ALL);
    let small = image(&device, [8, 8], ALL);
    let own = held.outputs();
    let cases: [(&str, Target); 5] = [
        (
            "motion has the format",
            Target {
                outputs: Outputs {
                    motion: own.ids,
                    ..own
                },
                ..target(&held)
            },
        ),
        (
            "ids is 8×8",
            Target {
                outputs: Outputs {
                    ids: small.outputs().ids,
                    ..own
                },
                ..target(&held)
            },
        ),
        (
            "rectangle of 10×200 pixels at (0, 0)",
            Target {
                rectangle: Some([0, 0, 10, 200]),
                ..target(&held)
            },
        ),
        (
            "rectangle of 0×1 pixels at (1, 1)",
            Target {
                rectangle: Some([1, 1, 0, 1]),
                ..target(&held)
            },
        ),
        (
            "at (4294967295, 0)",
            Target {
                rectangle: Some([u32::MAX, 0, 2, 2]),
                ..target(&held)
            },
        ),
    ];
    for (sentence, target) in cases {
        let error = device.render(&frame, &target).unwrap_err();
        assert!(
            matches!(error, Error::InvalidValue(_)) && error.to_string().contains(sentence),
            "{error}, but {sentence} was expected"
        );
    }
    let previous = PreviousView {
        view_from_world: DMat4::NAN,
        clip_from_view: DMat4::IDENTITY,
        jitter: [0.0; 2],
    };
    let views = [
        View {
            jitter: [f32::NAN, 0.0],
            ..frame.view
        },
        View {
            previous: Some(previous),
            ..frame.view
        },
    ];
    for view in views {
        let error = device
            .render(&Frame { view, ..frame }, &target(&held))
            .unwrap_err();
        assert!(matches!(error, Error::InvalidValue(_)), "{error}");
    }
}
