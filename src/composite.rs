//! The composite: each pixel's resolved hair blended over the target, premultiplied; the hair's shadow on the opaque
//! scene before it.

use crate::error::Result;
use crate::frame::Target;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, RenderSpec};
use crate::plan::{Band, Plan};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::Shader;
use crate::shadow::Shadow;
use crate::transparency::{self, Transparency};

/// What writes a light's shadow image, beside the look-up.
pub(crate) const SHADOW_IMAGE: &[&str] =
    &["common/host_position", "common/fullscreen", "shadow_image"];
/// The same where no hair shadows anything.
pub(crate) const SHADOW_IMAGE_NONE: &[&str] = &["common/fullscreen", "shadow_image_none"];

/// Pixels a side of the tiles in which the composite and the received shadow are drawn, `TILE` in WGSL: smaller ones fit what they
/// cover more closely, but the pixels at their diagonals are shaded twice.
const TILE: u32 = 32;

/// Clears the target where the host asked for it.
pub(crate) fn clear(passes: &mut Passes, target: &Target) {
    if !target.clear {
        return;
    }
    let view = target.colour_surface().view(wgpu::TextureAspect::All);
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
    if !target.receive_shadow || plan.shadow == Shadow::None {
        return Ok(());
    }
    let label = "pelage.composite.receive";
    let format = target.colour.format();
    let key = PipelineKey {
        colour: Some(format),
        variant: plan.shadow.variant(),
        ..PipelineKey::new(label)
    };
    // Colour × shadow; the alpha stays.
    let multiply = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::Src,
        operation: wgpu::BlendOperation::Add,
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: receive_module(&plan.shadow),
        vertex: "receive_vertex",
        fragment: "receive",
        groups: &[Group::Frame, Group::HostTilesRead, Group::MapsRead],
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        targets: vec![Some(wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState {
                color: multiply,
                alpha: multiply,
            }),
            write_mask: wgpu::ColorWrites::COLOR,
        })],
        depth_stencil: None,
    })?;
    let view = target.colour_surface().view(wgpu::TextureAspect::All);
    passes.encode(label, |encoder| {
        let mut pass = begin(encoder, label, &view, wgpu::LoadOp::Load, None);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, plan.bands[0].drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(1, bound.host_tiles_read, &[]);
        pass.set_bind_group(2, bound.maps_read, &[]);
        set_area(&mut pass, plan, 0, plan.height);
        draw_tiles(&mut pass, plan.width, plan.height);
    });
    Ok(())
}

/// The module of the received shadow.
pub(crate) fn receive_module(shadow: &Shadow) -> Module {
    shadow
        .module()
        .and(&[
            "common/pixels",
            "common/light",
            "common/host_position",
            "common/tiles",
            "receive",
        ])
        .with("TILE", Constant::U32(TILE))
}

/// The module of the composite.
pub(crate) fn module(transparency: &Transparency, shader: Option<&Shader>) -> Module {
    let resolve = transparency::resolve_module(transparency, shader);
    let resolve = if transparency.counted() {
        resolve
            .and(&["common/tiles", "transparency/a_buffer_tiles"])
            .with("TILE", Constant::U32(TILE))
    } else {
        resolve.and(&["common/fullscreen"])
    };
    resolve.and(&["composite"])
}

/// Draws an image of this size in tiles.
fn draw_tiles(pass: &mut wgpu::RenderPass, width: u32, height: u32) {
    pass.draw(0..4, 0..width.div_ceil(TILE) * height.div_ceil(TILE));
}

/// Writes the images of the hair's shadow on the opaque scene. Without `bound` there is no hair.
pub(crate) fn shadow_images(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: Option<&Bound>,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    let bound = bound.filter(|_| plan.shadow != Shadow::None);
    let label = "pelage.composite.shadow_image";
    for wanted in target.shadow_images {
        let format = wanted.image.format();
        let key = PipelineKey {
            colour: Some(format),
            variant: bound.map_or(0, |_| plan.shadow.variant()),
            ..PipelineKey::new(label)
        };
        let pipeline = gpu.render(key, || {
            let targets = vec![Some(wgpu::ColorTargetState::from(format))];
            let common = |module, vertex, fragment, groups| RenderSpec {
                module,
                vertex,
                fragment,
                groups,
                topology: wgpu::PrimitiveTopology::TriangleList,
                targets,
                depth_stencil: None,
            };
            if bound.is_some() {
                let module = plan.shadow.module().and(SHADOW_IMAGE);
                let groups = &[Group::Frame, Group::MapsRead];
                common(module, "shadow_image_vertex", "shadow_image", groups)
            } else {
                let module = Module::new(SHADOW_IMAGE_NONE);
                common(module, "fullscreen_vertex", "shadow_image_none", &[])
            }
        })?;
        let view = wanted.surface().view(wgpu::TextureAspect::All);
        passes.encode(label, |encoder| {
            let mut pass = begin(encoder, label, &view, wgpu::LoadOp::Load, None);
            pass.set_pipeline(&pipeline);
            if let Some(bound) = bound {
                let offsets = [0, plan.bands[0].drawings[0], plan.runs[0].material];
                pass.set_bind_group(0, bound.frame, &offsets);
                pass.set_bind_group(2, bound.maps_read, &[]);
            }
            set_area(&mut pass, plan, 0, plan.height);
            let light = wanted.light as u32;
            pass.draw(0..3, light..light + 1);
        });
    }
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
    let depth = target.depth_surface().filter(|_| target.write_depth);
    let shader = plan.shader.of_fragments();
    let tiled = plan.transparency.counted();
    let key = PipelineKey {
        shading: shader,
        colour: Some(format),
        depth: depth.map(|depth| depth.format()),
        variant: transparency::resolve_variant(&plan.transparency) * 2 + u32::from(plan.reverse_z),
        ..PipelineKey::new(label)
    };
    let nearer = if plan.reverse_z {
        wgpu::CompareFunction::GreaterEqual
    } else {
        wgpu::CompareFunction::LessEqual
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: module(&plan.transparency, shader.as_ref()),
        vertex: if tiled {
            "tiles_vertex"
        } else {
            "fullscreen_vertex"
        },
        fragment: if depth.is_some() {
            "composite_with_depth"
        } else {
            "composite"
        },
        groups: match (transparency::read_group(&plan.transparency), shader) {
            (Group::BlendedRead, _) => &[Group::Frame, Group::BlendedRead],
            (_, None) => &[Group::Frame, Group::PixelsRead],
            (_, Some(_)) => &[
                Group::Frame,
                Group::TablesRead,
                Group::MapsRead,
                Group::PixelsRead,
            ],
        },
        topology: if tiled {
            wgpu::PrimitiveTopology::TriangleStrip
        } else {
            wgpu::PrimitiveTopology::TriangleList
        },
        targets: vec![Some(wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        })],
        depth_stencil: depth.map(|depth| wgpu::DepthStencilState {
            format: depth.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(nearer),
            stencil: Default::default(),
            bias: Default::default(),
        }),
    })?;
    let view = target.colour_surface().view(wgpu::TextureAspect::All);
    let depth_view = depth.map(|depth| depth.view(wgpu::TextureAspect::All));
    passes.encode(label, |encoder| {
        let mut pass = begin(
            encoder,
            label,
            &view,
            wgpu::LoadOp::Load,
            depth_view.as_ref(),
        );
        set_area(&mut pass, plan, band.first, band.rows);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame_without_depth,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        if let Some(tables) = bound.tables_read {
            pass.set_bind_group(1, tables, &[]);
            pass.set_bind_group(2, bound.maps_read, &[]);
        }
        pass.set_bind_group(3, bound.read(plan), &[]);
        if tiled {
            draw_tiles(&mut pass, plan.width, band.rows);
        } else {
            pass.draw(0..3, 0..1);
        }
    });
    Ok(())
}

/// Draws into rows of the view's own rectangle only.
fn set_area(pass: &mut wgpu::RenderPass, plan: &Plan, first: u32, rows: u32) {
    let [left, top] = plan.origin;
    pass.set_viewport(
        left as f32,
        top as f32,
        plan.width as f32,
        plan.height as f32,
        0.0,
        1.0,
    );
    pass.set_scissor_rect(left, top + first, plan.width, rows);
}

/// Writes the outputs beside the colour for a band of rows.
pub(crate) fn outputs(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    let (wanted, tracked) = target.outputs.wanted();
    if !wanted {
        return Ok(());
    }
    let label = "pelage.composite.outputs";
    let formats = output_formats(target);
    let key = PipelineKey {
        variant: transparency::resolve_variant(&plan.transparency) * 256 + output_variant(&formats),
        ..PipelineKey::new(label)
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: transparency::resolve_module(&plan.transparency, None)
            .and(&["common/fullscreen", "outputs"])
            .with("TRACKED", Constant::Bool(tracked)),
        vertex: "fullscreen_vertex",
        fragment: "outputs",
        groups: match transparency::read_group(&plan.transparency) {
            Group::BlendedRead => &[Group::Frame, Group::PointOutputs, Group::BlendedRead],
            _ => &[Group::Frame, Group::PointOutputs, Group::PixelsRead],
        },
        topology: wgpu::PrimitiveTopology::TriangleList,
        targets: output_targets(&formats),
        depth_stencil: None,
    })?;
    passes.encode(label, |encoder| {
        begin_outputs(encoder, label, target, |pass| {
            set_area(pass, plan, band.first, band.rows);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(
                0,
                bound.frame_without_depth,
                &[0, band.drawings[0], plan.runs[0].material],
            );
            pass.set_bind_group(1, bound.point_outputs, &[]);
            pass.set_bind_group(3, bound.read(plan), &[]);
            pass.draw(0..3, 0..1);
        });
    });
    Ok(())
}

/// Writes the outputs beside the colour of a frame without hair.
pub(crate) fn outputs_none(
    gpu: &mut Gpu,
    passes: &mut Passes,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    if !target.outputs.wanted().0 || plan.shadows_only {
        return Ok(());
    }
    let label = "pelage.composite.outputs_none";
    let formats = output_formats(target);
    let key = PipelineKey {
        variant: output_variant(&formats) * 2 + u32::from(plan.reverse_z),
        ..PipelineKey::new(label)
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: Module::new(&["common/fullscreen", "outputs_none"])
            .with("REVERSE_Z", Constant::Bool(plan.reverse_z)),
        vertex: "fullscreen_vertex",
        fragment: "outputs",
        groups: &[],
        topology: wgpu::PrimitiveTopology::TriangleList,
        targets: output_targets(&formats),
        depth_stencil: None,
    })?;
    passes.encode(label, |encoder| {
        begin_outputs(encoder, label, target, |pass| {
            set_area(pass, plan, 0, plan.height);
            pass.set_pipeline(&pipeline);
            pass.draw(0..3, 0..1);
        });
    });
    Ok(())
}

fn output_formats(target: &Target) -> [Option<wgpu::TextureFormat>; 4] {
    target
        .output_surfaces()
        .map(|(_, image, _)| image.map(|image| image.format()))
}

/// Two bits an output: 0 where it is not written, else the place of its format and one.
fn output_variant(formats: &[Option<wgpu::TextureFormat>; 4]) -> u32 {
    use wgpu::TextureFormat as Format;
    formats.iter().fold(0, |variant, format| {
        variant * 4
            + match format {
                None => 0,
                Some(Format::R16Float | Format::Rg16Float) => 2,
                Some(Format::R8Unorm) => 3,
                Some(_) => 1,
            }
    })
}

fn output_targets(
    formats: &[Option<wgpu::TextureFormat>; 4],
) -> Vec<Option<wgpu::ColorTargetState>> {
    let target = |format: &Option<wgpu::TextureFormat>| format.map(wgpu::ColorTargetState::from);
    formats.iter().map(target).collect()
}

/// A pass over the outputs that are asked for; what they hold elsewhere is kept.
fn begin_outputs(
    encoder: &mut wgpu::CommandEncoder,
    label: &str,
    target: &Target,
    draw: impl FnOnce(&mut wgpu::RenderPass),
) {
    let views = target
        .output_surfaces()
        .map(|(_, image, _)| image.map(|image| image.view(wgpu::TextureAspect::All)));
    let attachments = views.each_ref().map(|view| {
        view.as_ref().map(|view| wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            },
        })
    });
    draw(&mut encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &attachments,
        depth_stencil_attachment: None,
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    }));
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
