//! Draws the opaque scene into colour and depth, as a host does before its hair.

use bytemuck::{Pod, Zeroable};
use pelage::glam::{DMat4, DVec3, Mat4, Vec3, Vec4};
use pelage::groom::Mesh;
use pelage::host::offscreen::Image;
use pelage::wgpu::util::DeviceExt;
use pelage::{Light, LightKind, MAX_LIGHTS, View, wgpu};

/// Reflectance of the meshes, near that of skin.
const ALBEDO: Vec3 = Vec3::new(0.55, 0.42, 0.35);
/// Light from all around that keeps the shadowed side from black, as a part of what the lights would give a white wall.
const FILL: f32 = 0.04;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct LightUniform {
    place: Vec4,
    power: Vec4,
    axis: Vec4,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SceneUniform {
    clip_from_relative: Mat4,
    albedo: Vec4,
    ambient: Vec4,
    lights: [LightUniform; MAX_LIGHTS],
}

/// The opaque scene on the GPU.
pub struct MeshPass {
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
}

/// By what, and from where, the scene is seen.
#[derive(Clone, Copy)]
pub struct Scenery<'a> {
    /// The view, the hair's own.
    pub view: View,
    /// The eye in world space.
    pub eye: DVec3,
    /// The lights, the hair's own.
    pub lights: &'a [Light],
    /// Radiance of a uniform environment.
    pub ambient: Vec3,
}

impl MeshPass {
    /// Uploads a mesh, and what lights it.
    pub fn new(device: &wgpu::Device, image: &Image, mesh: &Mesh, scenery: &Scenery) -> Self {
        let buffer = |label, contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        // Relative to the eye, so that large world coordinates keep their precision.
        let relative = |p: &[f32; 3]| {
            (Vec3::from(*p).as_dvec3() - scenery.eye)
                .as_vec3()
                .to_array()
        };
        let vertices: Vec<[[f32; 3]; 2]> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(p, normal)| [relative(p), *normal])
            .collect();
        let uniform = buffer(
            "host.meshes.scene",
            bytemuck::bytes_of(&scene_uniform(scenery)),
            wgpu::BufferUsages::UNIFORM,
        );
        let pipeline = pipeline(device, image.colour.format());
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host.meshes"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: uniform.as_entire_binding(),
            }],
        });
        Self {
            pipeline,
            bindings,
            vertices: buffer(
                "host.meshes.vertices",
                bytemuck::cast_slice(&vertices),
                wgpu::BufferUsages::VERTEX,
            ),
            indices: buffer(
                "host.meshes.indices",
                bytemuck::cast_slice(&mesh.indices),
                wgpu::BufferUsages::INDEX,
            ),
            index_count: mesh.indices.len() as u32,
        }
    }

    /// Clears colour and depth, and draws the meshes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, image: &Image) {
        let colour = image.colour.create_view(&Default::default());
        let depth = image
            .depth
            .as_ref()
            .map(|depth| depth.create_view(&Default::default()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host.meshes"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &colour,
                resolve_target: None,
                depth_slice: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: depth.as_ref().map(|view| {
                wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }
}

/// Cosine of a cone that holds every direction, and how fast it ends.
const EVERYWHERE: [f32; 2] = [-2.0, 1.0];

/// What the shader reads; lights and places relative to the eye.
fn scene_uniform(scenery: &Scenery) -> SceneUniform {
    let view = scenery.view.view_from_world * DMat4::from_translation(scenery.eye);
    let mut lights = [LightUniform::zeroed(); MAX_LIGHTS];
    let mut fill = Vec3::ZERO;
    for (slot, light) in lights.iter_mut().zip(scenery.lights) {
        *slot = match light.kind {
            LightKind::Directional {
                direction,
                irradiance,
            } => {
                fill += FILL * irradiance / std::f32::consts::PI;
                LightUniform {
                    place: (-direction).as_vec3().extend(0.0),
                    power: irradiance.extend(EVERYWHERE[0]),
                    axis: Vec3::ZERO.extend(EVERYWHERE[1]),
                }
            }
            LightKind::Point {
                position,
                intensity,
            } => LightUniform {
                place: (position - scenery.eye).as_vec3().extend(1.0),
                power: intensity.extend(EVERYWHERE[0]),
                axis: Vec3::ZERO.extend(EVERYWHERE[1]),
            },
            LightKind::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => {
                let edge = (inner_angle.cos() - outer_angle.cos()).max(1e-6).recip();
                LightUniform {
                    place: (position - scenery.eye).as_vec3().extend(1.0),
                    power: intensity.extend(outer_angle.cos()),
                    axis: direction.normalize().as_vec3().extend(edge),
                }
            }
        };
    }
    let count = scenery.lights.len().min(MAX_LIGHTS);
    SceneUniform {
        clip_from_relative: (scenery.view.clip_from_view * view).as_mat4(),
        albedo: ALBEDO.extend(1.0),
        ambient: (scenery.ambient + fill).extend(count as f32),
        lights,
    }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("lambert.wgsl"));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host.meshes"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("lambert_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 24,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("lambert"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
