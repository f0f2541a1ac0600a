//! Maps that a frame takes as an earlier one has filled them: the picture is that of a frame that fills its own, bit for bit.

use pelage::glam::{DMat4, DVec3, Vec3};
use pelage::groom::{BuiltinGroom, ClumpSettings, GuidedStrands, Strands, builtin};
use pelage::raster::Raster;
use pelage::shading::{KajiyaKay, Shading};
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::transparency::{ABuffer, Transparency};
use pelage::wgpu::util::DeviceExt;
use pelage::{
    Frame, Hair, Instance, Light, LightKind, PointSource, Renderer, ShadowImage, Target, View, wgpu,
};
use pelage_reference::composite::Image;

use crate::common::images::{FORMAT, assert_identical, read, write_depth};
use crate::common::scenes::portrait;
use crate::common::{Device, device};

use super::every::techniques;
use super::support::{directional, light};

const SIZE: [u32; 2] = [41, 54];

/// What a frame draws beside its hair.
#[derive(Clone)]
struct Scene {
    lights: Vec<Light>,
    ambient: Vec3,
    view: View,
    transparency: Transparency,
}

impl Scene {
    fn new(lights: Vec<Light>) -> Self {
        Self {
            lights,
            ambient: Vec3::splat(0.1),
            view: portrait(SIZE),
            transparency: Transparency::default(),
        }
    }

    fn frame<'a>(&'a self, hairs: &'a [&'a Hair]) -> Frame<'a> {
        Frame {
            hairs,
            lights: &self.lights,
            ambient: self.ambient,
            view: self.view,
            transparency: Some(self.transparency),
        }
    }
}

/// A renderer and its hair.
struct Side {
    renderer: Renderer,
    hairs: Vec<Hair>,
}

impl Side {
    fn new(device: &Device, grooms: &[&Strands]) -> Self {
        let mut side = Self {
            renderer: Renderer::new(device.renderer.device(), device.renderer.queue()).unwrap(),
            hairs: Vec::new(),
        };
        for strands in grooms {
            side.add(strands);
        }
        side
    }

    fn add(&mut self, strands: &Strands) {
        let mut hair = self.renderer.create_hair(strands).unwrap();
        hair.opacity = 0.7;
        self.hairs.push(hair);
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.renderer
            .device()
            .create_command_encoder(&Default::default())
    }

    fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.renderer.queue().submit([encoder.finish()]);
    }

    fn record(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &Scene, target: &Target) {
        let hairs: Vec<&Hair> = self.hairs.iter().collect();
        self.renderer
            .record(encoder, &scene.frame(&hairs), target)
            .unwrap();
    }

    /// Maps that the latest frame fills and takes.
    fn maps(&mut self) -> [u64; 2] {
        let statistics = self.renderer.statistics();
        [statistics.shadow_maps_filled, statistics.shadow_maps_taken]
    }

    /// A frame that is waited for: its picture, and the maps that it fills and takes.
    fn draw(&mut self, device: &mut Device, scene: &Scene) -> (Image, [u64; 2]) {
        let image = device
            .create_image(SIZE[0], SIZE[1], FORMAT, false)
            .unwrap();
        let mut encoder = self.encoder();
        self.record(&mut encoder, scene, &Target::cleared(&image.colour));
        self.submit(encoder);
        let picture = read(device, &image.colour);
        (picture, self.maps())
    }
}

/// A side that takes maps, and one that fills its own in every frame.
fn sides(device: &Device, grooms: &[&Strands]) -> [Side; 2] {
    let [kept, mut fresh] = [(); 2].map(|()| Side::new(device, grooms));
    fresh.renderer.set_shadow_reuse(false);
    [kept, fresh]
}

fn groom(strands: usize) -> Strands {
    builtin(BuiltinGroom::Wavy, strands).unwrap()
}

fn spot() -> LightKind {
    LightKind::Spot {
        position: DVec3::new(0.4, 0.6, 0.7),
        direction: DVec3::new(-0.4, -0.6, -0.7),
        intensity: Vec3::ONE,
        inner_angle: 0.3,
        outer_angle: 0.5,
    }
}

fn deep(resolution: u32) -> Shadow {
    Shadow::DeepOpacityMap(DeepOpacityMap {
        resolution,
        ..Default::default()
    })
}

fn sun_and_spot() -> Scene {
    Scene::new(vec![
        light(directional(DVec3::new(-0.4, -0.8, -0.5)), deep(64)),
        light(spot(), deep(48)),
    ])
}

/// Cameras of every kind of place: near, among the hair, far, and at infinity.
fn views() -> [View; 4] {
    let from = |eye| View::perspective(eye, DVec3::ZERO, DVec3::Y, 0.6, 0.76, [0.01, 1e4]).unwrap();
    let mut flat = portrait(SIZE);
    flat.clip_from_view = DMat4::from_scale(DVec3::new(4.0, 3.0, -0.1));
    [
        from(DVec3::new(-0.5, 0.3, -0.6)),
        from(DVec3::new(0.03, 0.05, 0.02)),
        from(DVec3::new(700.0, 300.0, -123.4)),
        flat,
    ]
}

#[test]
fn a_moving_camera_takes_the_maps_and_changes_no_pixel() {
    let Some(mut device) = device() else { return };
    let strands = groom(200);
    let [mut kept, mut fresh] = sides(&device, &[&strands]);
    let among = LightKind::Point {
        position: DVec3::new(0.02, 0.06, 0.01),
        intensity: Vec3::splat(0.1),
    };
    let mut all = techniques(64, Raster::Walk);
    all.extend(techniques(64, Raster::Ribbons).drain(..1));
    let views = views();
    for (number, shadow) in all.into_iter().enumerate() {
        let stem = shadow.stem();
        let kinds = [directional(DVec3::new(-0.4, -0.8, -0.5)), spot(), among];
        let mut scene = Scene::new(kinds.map(|kind| light(kind, shadow)).to_vec());
        // A cube of six beside one each.
        let (first, maps) = kept.draw(&mut device, &scene);
        assert_eq!(maps, [8, 0], "{stem}");
        let (again, maps) = kept.draw(&mut device, &scene);
        assert_eq!(maps, [0, 8], "{stem}");
        assert_identical(&format!("{stem} again"), &again, &first);
        for view in [number, number + 1].map(|at| at % views.len()) {
            scene.view = views[view];
            let (actual, maps) = kept.draw(&mut device, &scene);
            assert_eq!(maps, [0, 8], "{stem}, view {view}");
            let (expected, maps) = fresh.draw(&mut device, &scene);
            assert_eq!(maps, [8, 0]);
            assert!(expected.pixels.iter().any(|p| p[0] > 0.0));
            assert_identical(&format!("{stem}, view {view}"), &actual, &expected);
        }
    }
}

/// A change, and how many maps of two it lets stand.
type Change = (&'static str, u64, fn(&mut Side), fn(&mut Scene));

fn nothing<T>(_: &mut T) {}

fn buffer_of(side: &Side, points: &[[f32; 3]]) -> wgpu::Buffer {
    let descriptor = wgpu::util::BufferInitDescriptor {
        label: Some("test.points"),
        contents: bytemuck::cast_slice(points),
        usage: wgpu::BufferUsages::STORAGE,
    };
    side.renderer.device().create_buffer_init(&descriptor)
}

/// Records the move of a hair's points within the GPU.
fn move_by_gpu(side: &mut Side, encoder: &mut wgpu::CommandEncoder, by: f32) {
    let shift = |p: &[f32; 3]| [p[0] + by * p[1], p[1], p[2] - by];
    let points: Vec<_> = side.hairs[0].strands().points().iter().map(shift).collect();
    let buffer = buffer_of(side, &points);
    let source = PointSource {
        buffer: &buffer,
        offset: 0,
        stride: 12,
        bounds: [DVec3::splat(-0.5), DVec3::splat(0.5)],
    };
    side.renderer
        .update_points_from(encoder, &mut side.hairs[0], &source)
        .unwrap();
}

fn set_deep(scene: &mut Scene, light: usize, change: fn(&mut DeepOpacityMap)) {
    let mut settings = DeepOpacityMap {
        resolution: 48,
        ..Default::default()
    };
    change(&mut settings);
    scene.lights[light].shadow = Some(Shadow::DeepOpacityMap(settings));
}

fn set_spot(scene: &mut Scene, change: fn(&mut DVec3, &mut DVec3, &mut f32)) {
    let LightKind::Spot {
        position,
        direction,
        outer_angle,
        ..
    } = &mut scene.lights[1].kind
    else {
        panic!("no spot")
    };
    change(position, direction, outer_angle);
}

/// Each on top of those before it.
const CHANGES: &[Change] = &[
    // Hair: all maps.
    (
        "a point moved by the CPU",
        0,
        |side| {
            let mut points = side.hairs[0].strands().points().to_vec();
            points[7][0] += 0.01;
            side.renderer
                .update_points(&mut side.hairs[0], &points)
                .unwrap();
        },
        nothing,
    ),
    (
        "points given again, all where they were",
        0,
        |side| {
            let points = side.hairs[0].strands().points().to_vec();
            side.renderer
                .update_points(&mut side.hairs[0], &points)
                .unwrap();
        },
        nothing,
    ),
    (
        "points moved by the GPU",
        0,
        |side| {
            let mut encoder = side.encoder();
            move_by_gpu(side, &mut encoder, 0.05);
            side.submit(encoder);
            side.renderer
                .device()
                .poll(wgpu::PollType::wait_indefinitely())
                .unwrap();
        },
        nothing,
    ),
    (
        "guides moved",
        0,
        |side| {
            let guide = Strands::new(
                vec![[0.0, 0.1, 0.2], [0.0, 0.0, 0.25], [0.0, -0.1, 0.2]],
                &[3],
                0.002,
            )
            .unwrap();
            let settings = ClumpSettings {
                followers: 6,
                root_radius: 0.03,
                ..Default::default()
            };
            let guided = GuidedStrands::clumps(&guide, &settings).unwrap();
            let mut hair = side.renderer.create_guided_hair(&guided).unwrap();
            let mut encoder = side.encoder();
            let bent = [[0.0, 0.1, 0.2], [0.05, 0.0, 0.25], [0.1, -0.1, 0.25]];
            side.renderer
                .update_guides(&mut encoder, &mut hair, &bent)
                .unwrap();
            side.submit(encoder);
            side.renderer
                .device()
                .poll(wgpu::PollType::wait_indefinitely())
                .unwrap();
            side.hairs[1] = hair;
        },
        nothing,
    ),
    (
        "a transform",
        0,
        |side| side.hairs[0].world_from_object = DMat4::from_rotation_y(0.02),
        nothing,
    ),
    (
        "a scale, and with it the radii",
        0,
        |side| {
            side.hairs[1].world_from_object = DMat4::from_scale(DVec3::splat(1.01));
        },
        nothing,
    ),
    ("an opacity", 0, |side| side.hairs[1].opacity = 0.6, nothing),
    (
        "instances",
        0,
        |side| {
            let instance = |z| Instance {
                object_from_instance: DMat4::from_translation(DVec3::new(0.0, 0.0, z)),
                previous_object_from_instance: None,
            };
            side.hairs[1].instances = vec![instance(0.0), instance(0.03)];
        },
        nothing,
    ),
    (
        "an instance moved",
        0,
        |side| {
            side.hairs[1].instances[1].object_from_instance =
                DMat4::from_translation(DVec3::new(0.0, 0.01, 0.03));
        },
        nothing,
    ),
    ("one hair more", 0, |side| side.add(&groom(30)), nothing),
    (
        "another hair in its place",
        0,
        |side| {
            side.hairs.pop();
            let strands = groom(30).with_root_tip_radii(0.002, 0.002).unwrap();
            side.add(&strands);
        },
        nothing,
    ),
    ("one hair less", 0, |side| drop(side.hairs.pop()), nothing),
    // One light: its own map.
    ("a light moved", 1, nothing, |scene| {
        set_spot(scene, |position, _, _| position.x += 0.01)
    }),
    ("a spot turned", 1, nothing, |scene| {
        set_spot(scene, |_, direction, _| direction.x += 0.1)
    }),
    ("a cone of another angle", 1, nothing, |scene| {
        set_spot(scene, |_, _, outer| *outer = 0.31)
    }),
    ("the sun turned", 1, nothing, |scene| {
        scene.lights[0].kind = directional(DVec3::new(-0.4, -0.8, -0.4));
    }),
    ("a light of another kind", 1, nothing, |scene| {
        scene.lights[1].kind = LightKind::Point {
            position: DVec3::new(0.5, 0.8, 0.9),
            intensity: Vec3::ONE,
        };
    }),
    ("layers", 1, nothing, |scene| {
        set_deep(scene, 1, |deep| deep.layers -= 1)
    }),
    ("a filter", 1, nothing, |scene| {
        set_deep(scene, 1, |deep| deep.pcf = 5)
    }),
    ("a resolution", 1, nothing, |scene| {
        set_deep(scene, 1, |deep| deep.resolution = 40)
    }),
    ("a rasteriser", 1, nothing, |scene| {
        set_deep(scene, 1, |deep| deep.raster = Raster::Ribbons)
    }),
    ("coloured light", 1, nothing, |scene| {
        set_deep(scene, 1, |deep| deep.transmitted = Vec3::new(0.5, 0.2, 0.1))
    }),
    (
        "the first map's size, which moves the second",
        0,
        nothing,
        |scene| set_deep(scene, 0, |deep| deep.resolution = 50),
    ),
    // What no map depends on.
    ("a light's power", 2, nothing, |scene| {
        scene.lights[1].kind = LightKind::Point {
            position: DVec3::new(0.5, 0.8, 0.9),
            intensity: Vec3::new(2.0, 1.0, 0.5),
        };
    }),
    ("ambient light", 2, nothing, |scene| {
        scene.ambient = Vec3::ZERO
    }),
    (
        "shading",
        2,
        |side| side.hairs[0].shading = Shading::KajiyaKay(KajiyaKay::default()),
        nothing,
    ),
    ("transparency", 2, nothing, |scene| {
        scene.transparency = Transparency::ABuffer(ABuffer::default())
    }),
    (
        "where the hair was before",
        2,
        |side| {
            side.hairs[0].previous_world_from_object = Some(DMat4::from_rotation_x(0.1));
        },
        nothing,
    ),
    ("the camera", 2, nothing, |scene| scene.view = views()[0]),
    // A light more and less.
    ("a light less", 1, nothing, |scene| scene.lights.truncate(1)),
    (
        "the light again, whose map nobody has touched",
        2,
        nothing,
        |scene| {
            let kind = LightKind::Point {
                position: DVec3::new(0.5, 0.8, 0.9),
                intensity: Vec3::ONE,
            };
            let settings = DeepOpacityMap {
                resolution: 48,
                transmitted: Vec3::new(0.5, 0.2, 0.1),
                ..Default::default()
            };
            scene
                .lights
                .push(light(kind, Shadow::DeepOpacityMap(settings)));
        },
    ),
    ("another technique", 0, nothing, |scene| {
        let shadow = techniques(48, Raster::Auto)[1];
        scene
            .lights
            .iter_mut()
            .for_each(|light| light.shadow = Some(shadow));
    }),
];

#[test]
fn every_change_fills_the_maps_that_it_touches_and_no_other() {
    let Some(mut device) = device() else { return };
    let [long, short] = [groom(150), groom(40)];
    let mut both = sides(&device, &[&long, &short]);
    let mut scene = sun_and_spot();
    let [kept, _] = &mut both;
    assert_eq!(kept.draw(&mut device, &scene).1, [2, 0]);
    assert_eq!(kept.draw(&mut device, &scene).1, [0, 2]);
    for (name, stand, hair, rest) in CHANGES {
        both.iter_mut().for_each(hair);
        rest(&mut scene);
        let [kept, fresh] = &mut both;
        let (expected, _) = fresh.draw(&mut device, &scene);
        let (actual, maps) = kept.draw(&mut device, &scene);
        let count = scene.lights.len() as u64;
        assert_eq!(maps, [count - stand, *stand], "{name}");
        assert_identical(name, &actual, &expected);
        let (actual, maps) = kept.draw(&mut device, &scene);
        assert_eq!(maps, [0, count], "{name}, again");
        assert_identical(name, &actual, &expected);
    }
}

#[test]
fn a_frame_counts_only_when_it_has_run() {
    let Some(mut device) = device() else { return };
    let strands = groom(150);
    let [mut kept, mut fresh] = sides(&device, &[&strands]);
    let scene = sun_and_spot();
    let (expected, _) = fresh.draw(&mut device, &scene);
    let image = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    let target = Target::cleared(&image.colour);
    // Recorded and dropped.
    let mut encoder = kept.encoder();
    kept.record(&mut encoder, &scene, &target);
    drop(encoder);
    // Two of one encoder: the first has not run when the second is recorded.
    let mut encoder = kept.encoder();
    for _ in 0..2 {
        kept.record(&mut encoder, &scene, &target);
        assert_eq!(kept.maps(), [2, 0]);
    }
    kept.submit(encoder);
    assert_identical("two at once", &read(&mut device, &image.colour), &expected);
    // Other maps in their place, recorded and dropped: what is there now nobody knows.
    let mut other = sun_and_spot();
    other.lights[0].kind = directional(DVec3::new(0.4, -0.8, -0.5));
    let mut encoder = kept.encoder();
    kept.record(&mut encoder, &other, &target);
    assert_eq!(kept.maps(), [1, 1]);
    drop(encoder);
    let (actual, maps) = kept.draw(&mut device, &scene);
    assert_eq!(maps, [1, 1]);
    assert_identical("after a lost frame", &actual, &expected);
    // Frames in flight take what is known.
    let mut encoder = kept.encoder();
    for _ in 0..3 {
        kept.record(&mut encoder, &scene, &target);
        assert_eq!(kept.maps(), [0, 2]);
    }
    kept.submit(encoder);
    assert_identical(
        "three at once",
        &read(&mut device, &image.colour),
        &expected,
    );
}

#[test]
fn while_an_update_may_still_run_no_map_counts() {
    let Some(mut device) = device() else { return };
    let strands = groom(150);
    let [mut kept, mut fresh] = sides(&device, &[&strands]);
    let scene = sun_and_spot();
    kept.draw(&mut device, &scene);
    let mut late = kept.encoder();
    move_by_gpu(&mut kept, &mut late, 0.2);
    // Submitted before the update, these see the points as they were, in a box as it will be.
    for _ in 0..2 {
        let (_, maps) = kept.draw(&mut device, &scene);
        assert_eq!(maps, [2, 0]);
    }
    kept.submit(late);
    let mut encoder = fresh.encoder();
    move_by_gpu(&mut fresh, &mut encoder, 0.2);
    fresh.submit(encoder);
    let (expected, _) = fresh.draw(&mut device, &scene);
    for taken in [0, 2] {
        let (actual, maps) = kept.draw(&mut device, &scene);
        assert_eq!(maps, [2 - taken, taken]);
        assert_identical("after the update", &actual, &expected);
    }
    // An update that is dropped leaves the points as they are, and nothing to wait for.
    let mut dropped = kept.encoder();
    move_by_gpu(&mut kept, &mut dropped, 0.1);
    drop(dropped);
    for taken in [0, 2] {
        assert_eq!(kept.draw(&mut device, &scene).1, [2 - taken, taken]);
    }
    // Hair that moves in every frame's own submission never takes any.
    let image = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    for step in 0..3 {
        let moved = |side: &mut Side| {
            let mut encoder = side.encoder();
            move_by_gpu(side, &mut encoder, 0.02 * step as f32);
            side.record(&mut encoder, &scene, &Target::cleared(&image.colour));
            side.submit(encoder);
        };
        moved(&mut fresh);
        let expected = read(&mut device, &image.colour);
        moved(&mut kept);
        assert_eq!(kept.maps(), [2, 0]);
        assert_identical("in motion", &read(&mut device, &image.colour), &expected);
    }
}

#[test]
fn hairs_and_renderers_that_take_turns_keep_their_own() {
    let Some(mut device) = device() else { return };
    let [one, two] = [groom(120), groom(60)];
    let scene = sun_and_spot();
    let [mut a, mut fresh_a] = sides(&device, &[&one]);
    let [mut b, mut fresh_b] = sides(&device, &[&two]);
    let expected = [&mut fresh_a, &mut fresh_b].map(|side| side.draw(&mut device, &scene).0);
    // Two renderers.
    for round in 0..3u64 {
        for (side, expected) in [&mut a, &mut b].into_iter().zip(&expected) {
            let (actual, maps) = side.draw(&mut device, &scene);
            assert_eq!(maps, if round == 0 { [2, 0] } else { [0, 2] });
            assert_identical("two renderers", &actual, expected);
        }
    }
    // Two sets of hair of one renderer.
    a.add(&two);
    let mut others = a.hairs.split_off(1);
    for round in 0..3 {
        for expected in &expected {
            let (actual, maps) = a.draw(&mut device, &scene);
            // Only the first of all comes after a frame of the same hair.
            let first = round == 0 && a.hairs[0].strands().strand_count() == 120;
            assert_eq!(maps, if first { [0, 2] } else { [2, 0] });
            assert_identical("two sets of hair", &actual, expected);
            std::mem::swap(&mut a.hairs, &mut others);
        }
    }
}

#[test]
fn images_of_the_shadow_alone_fill_maps_for_later_frames() {
    let Some(mut device) = device() else { return };
    let strands = groom(150);
    let [mut kept, mut fresh] = sides(&device, &[&strands]);
    let scene = sun_and_spot();
    let held = device.create_image(SIZE[0], SIZE[1], FORMAT, true).unwrap();
    let depth = held.depth.as_ref().unwrap();
    write_depth(&device, depth, &vec![0.98; (SIZE[0] * SIZE[1]) as usize]);
    let shadow = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    let image = device
        .renderer
        .device()
        .create_texture(&wgpu::TextureDescriptor {
            label: Some("test.shadow"),
            size: held.colour.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: shadow.colour.usage(),
            view_formats: &[],
        });
    let images = [ShadowImage {
        light: 0,
        image: &image,
        subresource: Default::default(),
    }];
    let alone = Target {
        depth: Some(depth),
        shadow_images: &images,
        shadows_only: true,
        ..Target::cleared(&held.colour)
    };
    let whole = Target {
        depth: Some(depth),
        receive_shadow: true,
        ..Target::cleared(&held.colour)
    };
    let pictures = [&mut kept, &mut fresh].map(|side| {
        let mut drawn = Vec::new();
        for (target, of) in [(&alone, &image), (&whole, &held.colour), (&alone, &image)] {
            let mut encoder = side.encoder();
            side.record(&mut encoder, &scene, target);
            side.submit(encoder);
            drawn.push((read(&mut device, of), side.maps()));
        }
        drawn
    });
    let counts =
        |drawn: &[(Image, [u64; 2])]| drawn.iter().map(|(_, maps)| *maps).collect::<Vec<_>>();
    assert_eq!(counts(&pictures[0]), [[2, 0], [0, 2], [0, 2]]);
    assert_eq!(counts(&pictures[1]), [[2, 0], [2, 0], [2, 0]]);
    for ((actual, _), (expected, _)) in pictures[0].iter().zip(&pictures[1]) {
        assert_identical("shadow images", actual, expected);
    }
}

#[test]
fn a_buffer_that_grows_takes_its_maps_along() {
    let Some(mut device) = device() else { return };
    let strands = groom(100);
    let [mut kept, mut fresh] = sides(&device, &[&strands]);
    let mut scene = sun_and_spot();
    let spot = scene.lights.pop().unwrap();
    assert_eq!(kept.draw(&mut device, &scene).1, [1, 0]);
    scene.lights.push(spot);
    // The sun's map would stand, were it not for the other's room.
    for maps in [[2, 0], [0, 2]] {
        let (actual, found) = kept.draw(&mut device, &scene);
        assert_eq!(found, maps);
        assert_identical("grown", &actual, &fresh.draw(&mut device, &scene).0);
    }
    // Turned off and on again, a renderer begins anew.
    kept.renderer.set_shadow_reuse(false);
    assert_eq!(kept.draw(&mut device, &scene).1, [2, 0]);
    kept.renderer.set_shadow_reuse(true);
    assert_eq!(kept.draw(&mut device, &scene).1, [2, 0]);
    assert_eq!(kept.draw(&mut device, &scene).1, [0, 2]);
}
