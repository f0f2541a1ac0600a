//! Ribbons: instanced camera-facing strips, one a segment. The fragment shader writes through `emit`; a render pass
//! needs an attachment, so that one of one byte a pixel is kept, which nothing reads or writes.

use super::{Draw, Emission, Rasteriser};
use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, RenderSpec};
use crate::plan::Plan;
use crate::resources::Bound;

/// The format of the attachment that is not written.
pub(crate) const ATTACHMENT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

pub(super) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    emission: &Emission,
    draw: &Draw,
    plan: &Plan,
) -> Result<()> {
    let key = PipelineKey {
        rasteriser: Some(Rasteriser::Ribbons),
        variant: emission.variant(plan),
        ..PipelineKey::new(emission.label)
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: emission.module("raster/ribbons", plan.shader.rate),
        vertex: "ribbon_vertex",
        fragment: "ribbon_fragment",
        groups: match emission.group {
            Group::MapsWritten => &[Group::Frame, Group::Segments, Group::MapsWritten],
            _ => &[Group::Frame, Group::Segments, Group::PixelsWritten],
        },
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        targets: vec![Some(wgpu::ColorTargetState {
            format: ATTACHMENT,
            blend: None,
            write_mask: wgpu::ColorWrites::empty(),
        })],
        depth_stencil: None,
    })?;
    let Some(view) = &bound.attachment else {
        return Err(crate::Error::Internal(
            "ribbons without an attachment".into(),
        ));
    };
    passes.encode(emission.label, |encoder| {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(emission.label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let [width, height] = draw.size;
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, draw.rows[0], width, draw.rows[1]);
        pass.set_pipeline(&pipeline);
        let (index, group) = bound.emission(emission.group);
        pass.set_bind_group(index, group, &[]);
        for ((run, drawing), groups) in plan.runs.iter().zip(draw.drawings).zip(bound.runs) {
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, &groups.segments, &[]);
            if draw.on_overflow {
                pass.draw_indirect(bound.arguments, super::RIBBON_ARGUMENTS);
            } else {
                pass.draw(0..4, 0..run.run.count);
            }
        }
    });
    Ok(())
}
