//! What the tests of all shadow techniques share: white diffuse fibres, whose brightness is the light that reaches them.

use pelage::glam::{DVec3, Vec3};
use pelage::raster::Raster;
use pelage::shadow::Shadow;
use pelage::testing::{LightMap, light_map};
use pelage::transparency::{Opaque, Transparency};
use pelage::{Frame, Hair, Light, LightKind, View, wgpu};
use pelage_reference::composite::{self, Image};
use pelage_reference::fragments::fragment_lists;
use pelage_reference::scene::Camera;
use pelage_reference::shadow_maps::{self, Occluder};
use pelage_reference::transmittance::{Light as Towards, Occluders, Query};

use crate::common::Device;
use crate::common::images::render;
use crate::common::scenes::{World, lists, point_radiance, world};

/// The nearest fragment alone: the picture is of points' colours.
pub const OPAQUE: Option<Transparency> = Some(Transparency::Opaque(Opaque {
    raster: Raster::Auto,
}));
/// Two 16-bit floats and their interpolation.
pub const HALF_FLOATS: f64 = 2e-3;

/// A directional light of irradiance 1.
pub fn directional(direction: DVec3) -> LightKind {
    LightKind::Directional {
        direction,
        irradiance: Vec3::ONE,
    }
}

/// A light with a technique of its own.
pub fn light(kind: LightKind, shadow: Shadow) -> Light {
    Light {
        kind,
        shadow: Some(shadow),
    }
}

/// A frame of hairs under lights.
pub fn draw(
    device: &mut Device,
    hairs: &[&Hair],
    lights: &[Light],
    size: [u32; 2],
    view: View,
) -> Image {
    let frame = Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view,
        transparency: OPAQUE,
    };
    render(device, &frame, size).0
}

/// Shadowed over unshadowed red where hair is opaque enough to tell.
pub fn ratios(shadowed: &Image, lit: &Image) -> Vec<f64> {
    let seen = |(_, lit): &(&[f64; 4], &[f64; 4])| lit[0] > 0.02;
    shadowed
        .pixels
        .iter()
        .zip(&lit.pixels)
        .filter(seen)
        .map(|(shadowed, lit)| shadowed[0] / lit[0])
        .collect()
}

/// The frame as it would be if the part `passed[i]` of the first light reached point i.
pub fn image_of(frame: &Frame, size: [u32; 2], passed: &[f64]) -> Image {
    let colours: Vec<[f64; 3]> = point_radiance(frame)
        .iter()
        .zip(passed)
        .map(|(colour, passed)| colour.map(|c| c * passed))
        .collect();
    let alpha = f64::from(frame.hairs[0].opacity);
    composite::opaque(
        &lists(frame, size, None),
        alpha,
        composite::point_colours(&colours),
    )
}

/// The frame with exact transmittance at every strand point, averaged over a disc.
pub fn exact(frame: &Frame, size: [u32; 2], light: Towards, footprint: f64) -> Image {
    let world = world(frame.hairs);
    let occluders = Occluders::new(&world.strands);
    let query = Query {
        light,
        alpha: f64::from(frame.hairs[0].opacity),
        footprint,
        samples: 32,
    };
    let mut points = Vec::new();
    for strand in 0..world.strands.len() {
        let range = world.strands.range(strand);
        points.extend(
            range
                .clone()
                .map(|at| (world.strands.points[at], Some(at.min(range.end - 2)))),
        );
    }
    image_of(frame, size, &occluders.transmittances(&points, &query))
}

/// A texel as a point sees it: all fragments, the one that the point's own fibre has left there, and the point's depth.
pub struct Seen<'a> {
    pub occluders: &'a [Occluder],
    pub own: Option<usize>,
    pub depth: f64,
}

/// The own fibre's fragment is one of these many segments around the point.
const OWN_SEGMENTS: usize = 3;

/// The part of its only light, a directional one, that a technique's model lets through to each point of a frame.
pub fn modelled(
    frame: &Frame,
    resolution: u32,
    pcf: u32,
    texel: impl Fn(&LightMap, Seen) -> f64,
) -> Vec<f64> {
    let map = light_map(frame, 0).unwrap();
    let LightKind::Directional { direction, .. } = frame.lights[0].kind else {
        panic!("no directional light")
    };
    assert_eq!(map.bias, 0.0);
    let World { strands, .. } = world(frame.hairs);
    let size = resolution as usize;
    let camera = Camera {
        clip_from_world: map.clip_from_world,
        eye: -direction.normalize().extend(0.0),
        width: size,
        height: size,
    };
    let fragments = fragment_lists(&strands, &camera, None);
    let model = shadow_maps::LightMap {
        camera: &camera,
        lists: &fragments,
        depth_row: map.depth_row,
        strands: &strands,
    };
    let occluders: Vec<Vec<Occluder>> = (0..size * size)
        .map(|at| model.occluders(at % size, at / size))
        .collect();
    let mut passed = Vec::new();
    for strand in 0..strands.len() {
        for at in strands.range(strand) {
            let point = strands.points[at];
            let distance = |o: &Occluder| (2 * o.segment + 1).abs_diff(2 * at);
            passed.push(model.filtered(point, pcf as usize, |x, y| {
                let occluders = &occluders[y * size + x];
                let own = (0..occluders.len())
                    .filter(|i| strands.range(strand).contains(&occluders[*i].segment))
                    .filter(|i| distance(&occluders[*i]) < 2 * OWN_SEGMENTS)
                    .min_by_key(|i| distance(&occluders[*i]));
                let depth = model.depth(point);
                texel(
                    &map,
                    Seen {
                        occluders,
                        own,
                        depth,
                    },
                )
            }));
        }
    }
    passed
}

/// Runs a module's entry `evaluate`, which has `array<f32>` at bindings 0 (read) and 1 (written) of group 1, over 64
/// invocations a workgroup.
pub fn evaluate(device: &Device, source: &str, input: &[f32], outputs: usize) -> Vec<f64> {
    let gpu = device.renderer.device();
    let module = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test.evaluate"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = gpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("test.evaluate"),
        layout: None,
        module: &module,
        entry_point: Some("evaluate"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |size: usize, usage| {
        gpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    use wgpu::BufferUsages as Usage;
    let inputs = buffer(input.len(), Usage::STORAGE | Usage::COPY_DST);
    let values = buffer(outputs, Usage::STORAGE | Usage::COPY_SRC);
    let returned = buffer(outputs, Usage::MAP_READ | Usage::COPY_DST);
    let queue = device.renderer.queue();
    queue.write_buffer(&inputs, 0, bytemuck::cast_slice(input));
    let group = gpu.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(1),
        entries: &[(0, &inputs), (1, &values)].map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        }),
    });
    let mut encoder = gpu.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups((outputs as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&values, 0, &returned, 0, None);
    queue.submit([encoder.finish()]);
    returned.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    gpu.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(&returned.get_mapped_range(..).unwrap());
    values.into_iter().map(f64::from).collect()
}
