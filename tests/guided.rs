//! Hair that follows its guides on the GPU: as if the CPU had interpolated it anew.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{
    ClumpSettings, Curve, GuidedStrands, Guides, InterpolationSettings, Strands, Stray,
    interpolate_clumps, interpolate_on_mesh,
};
use pelage::shadow::Shadow;
use pelage::{Error, Hair, PointSource, Renderer, testing, wgpu};

use crate::common::device;
use crate::moving::{
    assert_alike, draw, interleaved, largest_distance, points, renderer_of_small_bindings,
};

/// Both sides are single precision throughout, of lengths below 1; the frames of clumps are carried along the guide, and
/// rounding with them.
const POSITION: f64 = 1e-6;

/// Guides on a grid of `side` × `side` over a bowed sheet, of 5 to 12 points each.
fn guides(side: u32, curve: Curve) -> Guides {
    let (mut points, mut counts) = (Vec::new(), Vec::new());
    for guide in 0..side * side {
        let (u, v) = (guide % side, guide / side);
        let [x, y] = [u, v].map(|at| 0.24 * at as f32 / (side - 1) as f32 - 0.12);
        let count = 5 + (guide * 5) % 8;
        for point in 0..count {
            let t = point as f32 / (count - 1) as f32;
            points.push([
                x + 0.05 * (7.0 * t + x * 9.0).sin() * t,
                0.1 - 0.22 * t + 0.1 * y,
                y + 0.1 * t * t - x * x,
            ]);
        }
        counts.push(count);
    }
    let colours = (0..counts.len()).map(|guide| [0.5, guide as f32 / counts.len() as f32, 1.0]);
    let strands = Strands::new(points, &counts, 0.0)
        .unwrap()
        .with_root_tip_radii(0.0008, 0.0003)
        .unwrap()
        .with_colours(colours.collect())
        .unwrap()
        .with_curve(curve);
    let corner = |u: u32, v: u32| v * side + u;
    let mut triangles = Vec::new();
    for (u, v) in (0..side - 1).flat_map(|v| (0..side - 1).map(move |u| (u, v))) {
        triangles.push([corner(u, v), corner(u + 1, v), corner(u, v + 1)]);
        triangles.push([corner(u + 1, v), corner(u + 1, v + 1), corner(u, v + 1)]);
    }
    Guides::on_mesh(strands, triangles).unwrap()
}

fn on_mesh(guides: &Guides, strands: f32) -> GuidedStrands {
    let settings = InterpolationSettings {
        density: strands / 0.06,
        stray: Stray {
            fraction: 0.2,
            strength: 0.3,
        },
        ..Default::default()
    };
    let guided = GuidedStrands::on_mesh(guides, &settings).unwrap();
    assert_eq!(
        *guided.strands(),
        interpolate_on_mesh(guides, &settings).unwrap()
    );
    guided
}

fn clumps(guides: &Guides, followers: u32) -> GuidedStrands {
    let settings = ClumpSettings {
        followers,
        root_radius: 0.012,
        tip_factor: 1.5,
        stray: Stray {
            fraction: 0.2,
            strength: 0.3,
        },
        seed: 3,
    };
    let guided = GuidedStrands::clumps(guides.strands(), &settings).unwrap();
    let strands = interpolate_clumps(guides.strands(), &settings).unwrap();
    assert_eq!(*guided.strands(), strands);
    guided
}

/// The guides blown aside, and carried away.
fn blown(guides: &Strands, amount: f32) -> Vec<[f32; 3]> {
    let mut points = guides.points().to_vec();
    for (point, along) in points.iter_mut().zip(guides.coordinates()) {
        point[0] += amount * along * along + 0.3;
        point[2] += 0.4 * amount * along * (point[1] * 20.0).sin();
    }
    points
}

fn box_of(points: &[[f32; 3]]) -> [DVec3; 2] {
    let corner = |pick: fn(Vec3, Vec3) -> Vec3| {
        let all = points.iter().map(|p| Vec3::from(*p));
        all.reduce(pick).unwrap().as_dvec3()
    };
    [corner(Vec3::min), corner(Vec3::max)]
}

/// From the CPU, or from a buffer of the given offset and stride.
fn update(
    renderer: &mut Renderer,
    hair: &mut Hair,
    points: &[[f32; 3]],
    layout: Option<[usize; 2]>,
    bounds: [DVec3; 2],
) {
    let mut encoder = renderer
        .device()
        .create_command_encoder(&Default::default());
    match layout {
        None => renderer.update_guides(&mut encoder, hair, points).unwrap(),
        Some([offset, stride]) => {
            let usage = wgpu::BufferUsages::STORAGE;
            let buffer = interleaved(renderer.device(), points, offset, stride, usage);
            let source = PointSource {
                buffer: &buffer,
                offset: offset as u64,
                stride: stride as u64,
                bounds,
            };
            renderer
                .update_guides_from(&mut encoder, hair, &source)
                .unwrap();
        }
    }
    renderer.queue().submit([encoder.finish()]);
}

fn kinds() -> Vec<(String, GuidedStrands)> {
    let mut kinds = Vec::new();
    for curve in [Curve::Polyline, Curve::CatmullRom] {
        let guides = guides(5, curve);
        kinds.push((format!("mesh {curve:?}"), on_mesh(&guides, 500.0)));
        kinds.push((format!("clumps {curve:?}"), clumps(&guides, 15)));
        kinds.push((format!("guides {curve:?}"), clumps(&guides, 0)));
    }
    kinds
}

#[test]
fn strands_follow_their_guides_as_the_cpu_would_interpolate_them() {
    let Some(mut device) = device() else { return };
    for (name, guided) in kinds() {
        let rest = guided.strands();
        assert_eq!(
            guided.follow(guided.guides().points()).unwrap(),
            rest.points()
        );
        let renderer = &mut device.renderer;
        let mut ours = renderer.create_guided_hair(&guided).unwrap();
        let mut theirs = renderer.create_hair(rest).unwrap();
        // Where guides alone are drawn there is little to see.
        let few = guided.strands().strand_count() < 100;
        for hair in [&mut ours, &mut theirs] {
            hair.shadow = Some(Shadow::None);
        }
        for (step, layout) in [(0.05, None), (-0.03, Some([12, 32])), (0.08, Some([0, 12]))] {
            let moved = blown(guided.guides(), step);
            let renderer = &mut device.renderer;
            update(renderer, &mut ours, &moved, layout, box_of(&moved));
            let expected = guided.follow(&moved).unwrap();
            renderer.update_points(&mut theirs, &expected).unwrap();
            let actual = points(renderer, &ours);
            let differ = largest_distance(&actual, &points(renderer, &theirs));
            eprintln!("{name}, {step}: points differ by {differ:e}");
            assert!(differ < POSITION, "{name}: {differ}");
            let (origin, half) = (testing::points_buffer(&ours).1, testing::half_extent(&ours));
            let outside = actual
                .iter()
                .filter(|p| (**p - origin).abs().cmpgt(half + 1e-6).any());
            assert_eq!(outside.count(), 0, "{name}: points outside their box");
            assert!(half.max_element() < 0.4, "{name}: a box of {half}");
            if !few {
                assert!(assert_alike(&mut device, &name, &ours, &theirs) > 1.0);
            }
        }
        ours.rest();
        theirs.rest();
        if !few {
            assert_eq!(assert_alike(&mut device, &name, &ours, &theirs), 0.0);
        }
        // Strands and guides can be moved in turn.
        let swung = guided.follow(&blown(guided.guides(), 0.02)).unwrap();
        let renderer = &mut device.renderer;
        for hair in [&mut ours, &mut theirs] {
            renderer.update_points(hair, &swung).unwrap();
        }
        let moved = blown(guided.guides(), -0.04);
        update(renderer, &mut ours, &moved, None, box_of(&moved));
        renderer
            .update_points(&mut theirs, &guided.follow(&moved).unwrap())
            .unwrap();
        let differ = largest_distance(&points(renderer, &ours), &points(renderer, &theirs));
        assert!(differ < POSITION, "{name}: {differ}");
        if !few {
            assert!(assert_alike(&mut device, &name, &ours, &theirs) > 1.0);
        }
    }
}

#[test]
fn a_device_of_small_bindings_follows_in_parts() {
    let Some(device) = device() else { return };
    drop(device);
    let mut renderer = renderer_of_small_bindings();
    let sheet = guides(5, Curve::CatmullRom);
    for guided in [on_mesh(&sheet, 2000.0), clumps(&sheet, 60)] {
        let moved = blown(guided.guides(), 0.05);
        let mut ours = renderer.create_guided_hair(&guided).unwrap();
        let mut theirs = renderer.create_hair(guided.strands()).unwrap();
        assert!(guided.strands().points().len() * 12 > 3 << 15);
        update(
            &mut renderer,
            &mut ours,
            &moved,
            Some([20, 24]),
            box_of(&moved),
        );
        renderer
            .update_points(&mut theirs, &guided.follow(&moved).unwrap())
            .unwrap();
        let [a, b] = [&ours, &theirs].map(|hair| points(&renderer, hair));
        let differ = largest_distance(&a, &b);
        assert!(differ < POSITION, "{differ}");
    }
}

#[test]
fn guides_that_are_no_numbers_stay_where_they_were() {
    let Some(mut device) = device() else { return };
    for (name, guided) in kinds() {
        let renderer = &mut device.renderer;
        let mut hair = renderer.create_guided_hair(&guided).unwrap();
        let (moved, rest) = (blown(guided.guides(), 0.05), guided.guides().points());
        let mut broken = moved.clone();
        let all = box_of(&[moved.as_slice(), rest].concat());
        for value in [f32::NAN, f32::MAX] {
            // Every point of the guides, and then some of them.
            for step in [1, 7] {
                broken.copy_from_slice(&moved);
                broken
                    .iter_mut()
                    .step_by(step)
                    .for_each(|point| point[1] = value);
                update(&mut device.renderer, &mut hair, &broken, Some([0, 12]), all);
                draw(&mut device, &hair);
            }
        }
        update(&mut device.renderer, &mut hair, &moved, Some([0, 12]), all);
        let mut other = device.renderer.create_hair(guided.strands()).unwrap();
        let expected = guided.follow(&moved).unwrap();
        device
            .renderer
            .update_points(&mut other, &expected)
            .unwrap();
        let [a, b] = [&hair, &other].map(|hair| points(&device.renderer, hair));
        let differ = largest_distance(&a, &b);
        assert!(differ < POSITION, "{name} recovers: {differ}");
    }
    // Of guides with one number of points each point stands for itself.
    let sheet = guides(5, Curve::Polyline);
    let guided = clumps(&sheet, 15);
    let mut hair = device.renderer.create_guided_hair(&guided).unwrap();
    let mut broken = blown(guided.guides(), 0.05);
    let mut mended = broken.clone();
    for at in (3..broken.len()).step_by(11) {
        broken[at][at % 3] = f32::NAN;
        mended[at] = guided.guides().points()[at];
    }
    update(
        &mut device.renderer,
        &mut hair,
        &broken,
        Some([0, 12]),
        box_of(&mended),
    );
    let mut other = device.renderer.create_hair(guided.strands()).unwrap();
    let expected = guided.follow(&mended).unwrap();
    device
        .renderer
        .update_points(&mut other, &expected)
        .unwrap();
    let [a, b] = [&hair, &other].map(|hair| points(&device.renderer, hair));
    assert!(largest_distance(&a, &b) < POSITION);
}

#[test]
fn what_is_wrong_with_guides_is_named_and_changes_nothing() {
    let Some(mut device) = device() else { return };
    let guided = on_mesh(&guides(3, Curve::Polyline), 50.0);
    let renderer = &mut device.renderer;
    let mut plain = renderer.create_hair(guided.strands()).unwrap();
    let mut hair = renderer.create_guided_hair(&guided).unwrap();
    let before = points(renderer, &hair);
    let rest = guided.guides().points().to_vec();
    let mut encoder = renderer
        .device()
        .create_command_encoder(&Default::default());
    let error = renderer
        .update_guides(&mut encoder, &mut plain, &rest)
        .unwrap_err();
    assert!(
        error.to_string().contains("the hair has no guides"),
        "{error}"
    );
    let error = renderer
        .update_guides(&mut encoder, &mut hair, &rest[1..])
        .unwrap_err();
    let sentence = format!("{} positions for {} points", rest.len() - 1, rest.len());
    assert!(error.to_string().contains(&sentence), "{error}");
    let mut broken = rest.clone();
    broken[6][1] = f32::NAN;
    let error = renderer
        .update_guides(&mut encoder, &mut hair, &broken)
        .unwrap_err();
    assert!(
        error.to_string().contains("strand 1, point 1: position"),
        "{error}"
    );
    let buffer = interleaved(renderer.device(), &rest, 0, 12, wgpu::BufferUsages::STORAGE);
    let source = PointSource {
        buffer: &buffer,
        offset: 4,
        stride: 12,
        bounds: box_of(&rest),
    };
    let error = renderer
        .update_guides_from(&mut encoder, &mut hair, &source)
        .unwrap_err();
    assert!(
        error.to_string().contains("points from offset 4"),
        "{error}"
    );
    renderer.set_byte_budget(Some(0));
    let error = renderer
        .update_guides(&mut encoder, &mut hair, &rest)
        .unwrap_err();
    assert!(matches!(error, Error::OutOfMemory(_)), "{error}");
    let error = renderer.create_guided_hair(&guided).unwrap_err();
    assert!(matches!(error, Error::OutOfMemory(_)), "{error}");
    renderer.set_byte_budget(None);
    renderer.queue().submit([encoder.finish()]);
    assert_eq!(points(renderer, &hair), before);

    // Guides that make no strand, and none at all.
    for none in [on_mesh(&guides(3, Curve::Polyline), 0.0), {
        let empty = Strands::new(Vec::new(), &[], 0.0).unwrap();
        GuidedStrands::clumps(&empty, &ClumpSettings::default()).unwrap()
    }] {
        let mut hair = renderer.create_guided_hair(&none).unwrap();
        let at_rest = none.guides().points().to_vec();
        let mut encoder = renderer
            .device()
            .create_command_encoder(&Default::default());
        renderer
            .update_guides(&mut encoder, &mut hair, &at_rest)
            .unwrap();
        renderer.queue().submit([encoder.finish()]);
    }
    let bytes = renderer.statistics().bytes;
    assert!(
        bytes
            .iter()
            .any(|(label, _)| label == "pelage.guided.placements")
    );
}
