//! A host with a wgpu device of its own: hair between its own passes, in its own images and its own command encoder.
//!
//! ```sh
//! cargo run --release --example wgpu_host -- [picture.png [strands]]
//! ```
//!
//! The host's types must be those of the wgpu that pelage is built with: version **30**, which the crate re-exports as
//! [`pelage::wgpu`]. A host that names `wgpu = "30"` itself has the same types; another major version does not compile.
//!
//! One encoder, one submission: the host's depth pre-pass, its opaque pass, `Renderer::record`, and its tone curve. wgpu
//! itself orders what they do to the images.

use std::error::Error;

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin, head_mesh};
use pelage::wgpu::util::DeviceExt;
use pelage::{Frame, Hair, Light, Renderer, Target, View, wgpu};

/// The host's picture in pixels.
pub const SIZE: [u32; 2] = [480, 640];
/// Linear and scene-referred: what hair is blended into.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Sampled by pelage, so that the head hides hair.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// What the tone curve writes.
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

const SHADERS: &str = r"
struct Scene {
    clip_from_world: mat4x4f,
    to_light: vec4f,
}

@group(0) @binding(0) var<uniform> scene: Scene;

struct Vertex {
    @invariant @builtin(position) place: vec4f,
    @location(0) normal: vec3f,
}

@vertex
fn head_vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Vertex {
    return Vertex(scene.clip_from_world * vec4f(position, 1.0), normal);
}

@fragment
fn head(vertex: Vertex) -> @location(0) vec4f {
    let light = max(dot(normalize(vertex.normal), scene.to_light.xyz), 0.0);
    return vec4f(vec3f(0.55, 0.42, 0.35) * (0.9 * light + 0.05), 1.0);
}

@group(0) @binding(0) var hdr: texture_2d<f32>;

@vertex
fn tone_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn tone(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let radiance = textureLoad(hdr, vec2u(pixel.xy), 0).rgb;
    return vec4f(1.0 - exp(-1.5 * radiance), 1.0);
}
";

/// The host: its device, its images, its pipelines, and the renderer that it has made on its device.
pub struct Host {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// The opaque scene, and then the hair on it.
    pub colour: wgpu::Texture,
    /// The opaque scene's depth, and then the nearest hair's.
    pub depth: wgpu::Texture,
    /// The finished picture.
    pub shown: wgpu::Texture,
    pre_pass: wgpu::RenderPipeline,
    opaque_pass: wgpu::RenderPipeline,
    tone_pass: wgpu::RenderPipeline,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    scene: wgpu::Buffer,
    renderer: Renderer,
}

/// From where the picture is seen.
pub fn view() -> pelage::Result<View> {
    View::perspective(
        DVec3::new(0.6, 0.15, 0.75),
        DVec3::new(0.0, -0.06, 0.0),
        DVec3::Y,
        0.5,
        f64::from(SIZE[0]) / f64::from(SIZE[1]),
        [0.1, 10.0],
    )
}

/// The light of the hair and of the head.
pub fn light() -> Light {
    Light::directional(DVec3::new(-0.9, -0.8, -0.4), Vec3::splat(3.0))
}

/// Radiance from all around.
pub const AMBIENT: Vec3 = Vec3::splat(0.05);

impl Host {
    /// A device as any host makes one, with the adapter's own limits: of wgpu's defaults 8 storage buffers a stage are too
    /// few, pelage needs 10, and larger bindings let it hold more hair.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        descriptor.flags = if cfg!(debug_assertions) {
            wgpu::InstanceFlags::VALIDATION
        } else {
            wgpu::InstanceFlags::empty()
        };
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
                label: Some("host"),
                required_limits: adapter.limits(),
                ..Default::default()
            }))?;
        // From here on the host is the host, and pelage a guest on its device.
        let renderer = Renderer::new(&device, &queue)?;
        let shaders = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("host"),
            source: wgpu::ShaderSource::Wgsl(SHADERS.into()),
        });
        let head = head_mesh();
        let vertices: Vec<[[f32; 3]; 2]> = head
            .positions
            .iter()
            .zip(&head.normals)
            .map(|(position, normal)| [*position, *normal])
            .collect();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("host"),
                contents,
                usage,
            })
        };
        let image = |format, more| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("host"),
                size: wgpu::Extent3d {
                    width: SIZE[0],
                    height: SIZE[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::COPY_SRC
                    | more,
                view_formats: &[],
            })
        };
        let sampled = wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(Self {
            colour: image(COLOUR, sampled),
            depth: image(DEPTH, sampled),
            shown: image(SHOWN, wgpu::TextureUsages::empty()),
            pre_pass: head_pipeline(&device, &shaders, false),
            opaque_pass: head_pipeline(&device, &shaders, true),
            tone_pass: tone_pipeline(&device, &shaders),
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(
                bytemuck::cast_slice(&head.indices),
                wgpu::BufferUsages::INDEX,
            ),
            scene: buffer(
                bytemuck::cast_slice(&scene_uniform()?),
                wgpu::BufferUsages::UNIFORM,
            ),
            renderer,
            device,
            queue,
        })
    }

    /// Hair on the host's device.
    pub fn hair(&mut self, strands: usize) -> pelage::Result<Hair> {
        self.renderer
            .create_hair(&builtin(BuiltinGroom::Wavy, strands)?)
    }

    /// One frame: the host's passes, with the hair between them.
    pub fn frame(&mut self, hairs: &[&Hair]) -> pelage::Result<()> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.head(&mut encoder, false);
        self.head(&mut encoder, true);
        let frame = Frame {
            hairs,
            lights: &[light()],
            ambient: AMBIENT,
            view: view()?,
            transparency: None,
        };
        let target = Target {
            depth: Some(&self.depth),
            clear: false,
            write_depth: true,
            receive_shadow: true,
            ..Target::cleared(&self.colour)
        };
        self.renderer.record(&mut encoder, &frame, &target)?;
        self.tone(&mut encoder);
        self.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The depth pre-pass, or the opaque pass after it.
    fn head(&self, encoder: &mut wgpu::CommandEncoder, opaque: bool) {
        let group = self.bind(&self.pre_pass, self.scene.as_entire_binding());
        let colour = self.colour.create_view(&Default::default());
        let depth = self.depth.create_view(&Default::default());
        let grey = wgpu::Color {
            r: 0.18,
            g: 0.18,
            b: 0.18,
            a: 1.0,
        };
        let attachment = Some(wgpu::RenderPassColorAttachment {
            view: &colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(grey),
                store: wgpu::StoreOp::Store,
            },
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(if opaque { "host.opaque" } else { "host.depth" }),
            color_attachments: if opaque {
                std::slice::from_ref(&attachment)
            } else {
                &[]
            },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: if opaque {
                        wgpu::LoadOp::Load
                    } else {
                        wgpu::LoadOp::Clear(1.0)
                    },
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(if opaque {
            &self.opaque_pass
        } else {
            &self.pre_pass
        });
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..(self.indices.size() / 4) as u32, 0, 0..1);
    }

    /// The tone curve, from the picture with its hair.
    fn tone(&self, encoder: &mut wgpu::CommandEncoder) {
        let colour = self.colour.create_view(&Default::default());
        let group = self.bind(&self.tone_pass, wgpu::BindingResource::TextureView(&colour));
        let shown = self.shown.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host.tone"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &shown,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.tone_pass);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn bind(
        &self,
        pipeline: &wgpu::RenderPipeline,
        resource: wgpu::BindingResource,
    ) -> wgpu::BindGroup {
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource,
            }],
        })
    }

    /// An image's bytes, rows packed.
    pub fn read(
        &self,
        texture: &wgpu::Texture,
        texel_bytes: u32,
    ) -> Result<Vec<u8>, Box<dyn Error>> {
        let row = texture.width() * texel_bytes;
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host.read"),
            size: u64::from(stride) * u64::from(texture.height()),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        let mapped = buffer.get_mapped_range(..)?;
        Ok(mapped
            .chunks_exact(stride as usize)
            .flat_map(|line| line[..row as usize].iter().copied())
            .collect())
    }
}

/// The head's pipeline: its depth alone, or its colour where that depth is its own.
fn head_pipeline(
    device: &wgpu::Device,
    shaders: &wgpu::ShaderModule,
    opaque: bool,
) -> wgpu::RenderPipeline {
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let targets = [Some(COLOUR.into())];
    // Both pipelines take one bind group.
    let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("host.scene"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("host.scene"),
        bind_group_layouts: &[Some(&group)],
        ..Default::default()
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host.head"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: shaders,
            entry_point: Some("head_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<[[f32; 3]; 2]>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: Some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(!opaque),
            depth_compare: Some(if opaque {
                wgpu::CompareFunction::Equal
            } else {
                wgpu::CompareFunction::Less
            }),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: opaque.then(|| wgpu::FragmentState {
            module: shaders,
            entry_point: Some("head"),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn tone_pipeline(device: &wgpu::Device, shaders: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host.tone"),
        layout: None,
        vertex: wgpu::VertexState {
            module: shaders,
            entry_point: Some("tone_vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shaders,
            entry_point: Some("tone"),
            compilation_options: Default::default(),
            targets: &[Some(SHOWN.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// The view's matrix and the way to the light, as the shaders have them.
fn scene_uniform() -> pelage::Result<[f32; 20]> {
    let view = view()?;
    let clip_from_world = (view.clip_from_view * view.view_from_world).as_mat4();
    let to_light = -DVec3::new(-0.9, -0.8, -0.4).normalize().as_vec3();
    let mut words = [0.0; 20];
    words[..16].copy_from_slice(&clip_from_world.to_cols_array());
    words[16..19].copy_from_slice(&to_light.to_array());
    Ok(words)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or("wgpu_host.png".into());
    let strands = match arguments.next() {
        Some(count) => count.parse()?,
        None => BuiltinGroom::DEFAULT_STRAND_COUNT,
    };
    let mut host = Host::new()?;
    let hair = host.hair(strands)?;
    host.frame(&[&hair])?;
    let pixels = host.read(&host.shown, 4)?;
    let mut encoder = png::Encoder::new(std::fs::File::create(&path)?, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&pixels)?;
    println!("{strands} strands; wrote {path}");
    Ok(())
}
