//! Depths of the opaque scene from the host's memory: WebGPU copies no data into a 32-bit float depth, so that a small
//! pass draws them.

use super::offscreen::Offscreen;
use crate::error::{Error, Result, invalid};

/// The pass's shader.
const SOURCE: &str = include_str!("../../shaders/host/write_depth.wgsl");
const LABEL: &str = "pelage.image.write_depth";

impl Offscreen {
    /// Writes a depth image, row 0 at the top: what of the opaque scene hides hair. Values from 0 to 1.
    ///
    /// # Errors
    /// An image of another format than `Depth32Float`; another number of values than it has pixels; a value outside
    /// 0…1; no memory. Nothing has then been written.
    pub fn write_depth(&mut self, depth: &wgpu::Texture, values: &[f32]) -> Result<()> {
        if depth.format() != wgpu::TextureFormat::Depth32Float {
            return invalid!(
                "a depth of format {:?}; Depth32Float can be written",
                depth.format()
            );
        }
        let (width, height) = (depth.width(), depth.height());
        if values.len() as u64 != u64::from(width) * u64::from(height) {
            return invalid!("{} depths for an image of {width}×{height}", values.len());
        }
        if let Some(at) = values.iter().position(|value| !(0.0..=1.0).contains(value)) {
            let (x, y) = (at as u32 % width, at as u32 / width);
            return invalid!(
                "pixel ({x}, {y}): depth {} is not between 0 and 1",
                values[at]
            );
        }
        let device = self.renderer.device();
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let source = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(LABEL),
            size: depth.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!(
                "a depth of {width}×{height} pixels: {error}"
            )));
        }
        self.write_texture(&source, bytemuck::cast_slice(values), values.len())?;
        let pipeline = self.write_depth_pipeline();
        self.draw_depth(&pipeline, &source, depth);
        Ok(())
    }

    /// The pass's pipeline, made at its first use.
    fn write_depth_pipeline(&mut self) -> wgpu::RenderPipeline {
        let device = self.renderer.device();
        let make = || {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(LABEL),
                source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
            });
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(LABEL),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("write_depth_vertex"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: wgpu::TextureFormat::Depth32Float,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Always),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("write_depth"),
                    compilation_options: Default::default(),
                    targets: &[],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        self.write_depth.get_or_insert_with(make).clone()
    }

    fn draw_depth(
        &self,
        pipeline: &wgpu::RenderPipeline,
        source: &wgpu::Texture,
        depth: &wgpu::Texture,
    ) {
        let device = self.renderer.device();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(
                    &source.create_view(&Default::default()),
                ),
            }],
        });
        let view = depth.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(LABEL),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.renderer.queue().submit([encoder.finish()]);
    }
}
