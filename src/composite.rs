//! The composite: each pixel's resolved hair blended over the target, premultiplied; the hair's shadow on the opaque
//! scene before it.

use crate::error::Result;
use crate::frame::Target;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, RenderSpec};
use crate::plan::{Band, Plan};
use crate::resources::Bound;
use crate::shader::Module;
use crate::{shadow, transparency};

/// Clears the target where the host asked for it.
pub(crate) fn clear(passes: &mut Passes, target: &Target) {
    if !target.clear {
        return;
    }
    let view = target.colour.create_view(&Default::default());
    passes.encode("pelage.composite.clear", |encoder| {
        drop(begin(
            encoder,
            "pelage.composite.clear",
            &view,
            wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            None,
        ));
    });
}

/// Darkens the opaque scene by the hair's shadow.
pub(crate) fn receive(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    if !target.receive_shadow || !plan.shadowed {
        return Ok(());
    }
    let label = "pelage.composite.receive";
    let format = target.colour.format();
    let key = PipelineKey {
        colour: Some(format),
        ..PipelineKey::new(label)
    };
    // Colour × shadow; the alpha stays.
    let multiply = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::Src,
        operation: wgpu::BlendOperation::Add,
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: Module::new(shadow::look_up(true)).and(&["receive"]),
        vertex: "receive_vertex",
        fragment: "receive",
        groups: &[Group::Frame, Group::MapsRead],
        topology: wgpu::PrimitiveTopology::TriangleList,
        target: wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState {
                color: multiply,
                alpha: multiply,
            }),
            write_mask: wgpu::ColorWrites::COLOR,
        },
        depth_stencil: None,
    })?;
    let view = target.colour.create_view(&Default::default());
    passes.encode(label, |encoder| {
        let mut pass = begin(encoder, label, &view, wgpu::LoadOp::Load, None);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, plan.bands[0].drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(2, bound.maps_read, &[]);
        pass.draw(0..3, 0..1);
    });
    Ok(())
}

/// Blends a band's hair over the target, and writes its nearest depth where that is asked for.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    let label = "pelage.composite.resolve";
    let format = target.colour.format();
    let depth = target.depth.filter(|_| target.write_depth);
    let key = PipelineKey {
        colour: Some(format),
        depth: depth.map(|texture| texture.format()),
        variant: (transparency::resolve_variant(&plan.transparency) * 2
            + u32::from(plan.reverse_z))
            * 4
            + plan.parts,
        ..PipelineKey::new(label)
    };
    let nearer = if plan.reverse_z {
        wgpu::CompareFunction::GreaterEqual
    } else {
        wgpu::CompareFunction::LessEqual
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: transparency::resolve_module(&plan.transparency, plan.parts).and(&["composite"]),
        vertex: "composite_vertex",
        fragment: if depth.is_some() {
            "composite_with_depth"
        } else {
            "composite"
        },
        groups: &[Group::Frame, Group::PixelsRead],
        topology: wgpu::PrimitiveTopology::TriangleList,
        target: wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        },
        depth_stencil: depth.map(|texture| wgpu::DepthStencilState {
            format: texture.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(nearer),
            stencil: Default::default(),
            bias: Default::default(),
        }),
    })?;
    let view = target.colour.create_view(&Default::default());
    let depth_view = depth.map(|texture| texture.create_view(&Default::default()));
    passes.encode(label, |encoder| {
        let mut pass = begin(
            encoder,
            label,
            &view,
            wgpu::LoadOp::Load,
            depth_view.as_ref(),
        );
        pass.set_scissor_rect(0, band.first, plan.width, band.rows);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame_without_depth,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(3, bound.pixels_read, &[]);
        pass.draw(0..3, 0..1);
    });
    Ok(())
}

/// Begins a pass over the target's colour, and over its depth if given.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    colour: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
    depth: Option<&wgpu::TextureView>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load,
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
