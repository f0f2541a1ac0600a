//! A frame: what is drawn, into what, and the way of the data in one function.

use glam::Vec3;

use crate::error::{Error, Result, invalid};
use crate::geometry::Hair;
use crate::light::Light;
use crate::plan::Plan;
use crate::resources::Resources;
use crate::transparency::Transparency;
use crate::view::View;
use crate::{composite, geometry, gpu, shading, shadow, transparency};

/// What one frame draws. Plain data, borrowed for the length of the call.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The hairs; they sort and shadow against each other.
    pub hairs: &'a [&'a Hair],
    /// The lights, at most [`crate::MAX_LIGHTS`].
    pub lights: &'a [Light],
    /// Radiance of a uniform environment, linear RGB; it reaches every fibre unshadowed.
    pub ambient: Vec3,
    /// From where, and through which lens.
    pub view: View,
    /// The transparency technique. `None`: what all hairs wish for; a conflict is an error.
    pub transparency: Option<Transparency>,
}

/// What a frame is drawn into: the host's colour, and its depth if there is an opaque scene.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Single-sampled, 2D, usable as a render attachment. Hair is blended over what it holds, premultiplied.
    pub colour: &'a wgpu::Texture,
    /// The opaque scene's depth, of the colour's size, single-sampled, usable as a texture: it hides hair.
    pub depth: Option<&'a wgpu::Texture>,
    /// Clear the colour to transparent black first.
    pub clear: bool,
    /// Write the nearest hair's depth into `depth`, which must then be usable as a render attachment too.
    pub write_depth: bool,
    /// Darken the opaque scene behind `depth` by the hair's shadow.
    pub receive_shadow: bool,
}

impl<'a> Target<'a> {
    /// A target without an opaque scene, cleared first.
    pub fn cleared(colour: &'a wgpu::Texture) -> Self {
        Self {
            colour,
            depth: None,
            clear: true,
            write_depth: false,
            receive_shadow: false,
        }
    }

    pub(crate) fn validate(&self, device: &wgpu::Device) -> Result<()> {
        let colour = self.colour;
        texture_fits("colour", colour, wgpu::TextureUsages::RENDER_ATTACHMENT)?;
        if colour
            .format()
            .sample_type(None, Some(device.features()))
            .is_none_or(|sample| !matches!(sample, wgpu::TextureSampleType::Float { .. }))
            || colour.format().has_depth_aspect()
        {
            return invalid!(
                "the target's colour has the format {:?}, which holds no colour as floats",
                colour.format()
            );
        }
        let blendable = colour
            .format()
            .guaranteed_format_features(device.features())
            .flags;
        if !blendable.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
            return Err(Error::Unsupported(format!(
                "this device cannot blend into {:?}",
                colour.format()
            )));
        }
        let Some(depth) = self.depth else {
            if self.write_depth || self.receive_shadow {
                return invalid!("write_depth and receive_shadow need a depth in the target");
            }
            return Ok(());
        };
        let mut usage = wgpu::TextureUsages::TEXTURE_BINDING;
        if self.write_depth {
            usage |= wgpu::TextureUsages::RENDER_ATTACHMENT;
        }
        texture_fits("depth", depth, usage)?;
        if !depth.format().has_depth_aspect() {
            return invalid!(
                "the target's depth has the format {:?}, which holds no depth",
                depth.format()
            );
        }
        if (depth.width(), depth.height()) != (colour.width(), colour.height()) {
            return invalid!(
                "the target's depth is {}×{}, its colour {}×{}",
                depth.width(),
                depth.height(),
                colour.width(),
                colour.height()
            );
        }
        Ok(())
    }
}

/// Checks what colour and depth have in common.
fn texture_fits(name: &str, texture: &wgpu::Texture, usage: wgpu::TextureUsages) -> Result<()> {
    if texture.sample_count() != 1 {
        return Err(Error::Unsupported(format!(
            "the target's {name} has {} samples a pixel; resolve it first",
            texture.sample_count()
        )));
    }
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.depth_or_array_layers() != 1 {
        return invalid!("the target's {name} is not one 2D image");
    }
    if !texture.usage().contains(usage) {
        return invalid!(
            "the target's {name} lacks the usage {:?}",
            usage - texture.usage()
        );
    }
    Ok(())
}

/// The way of the data: every step one line, in this order; no step reaches back.
pub(crate) fn record(
    gpu: &mut gpu::Gpu,
    passes: &mut gpu::Passes,
    resources: &Resources,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    composite::clear(passes, target);
    let Some(bound) = resources.bound(plan) else {
        return Ok(());
    };
    resources.clear_maps(passes, plan);
    for map in &plan.maps {
        geometry::project(
            gpu,
            passes,
            &bound,
            "pelage.shadow.project",
            &map.drawings,
            plan,
        )?;
        shadow::record(gpu, passes, &bound, map, plan)?;
    }
    geometry::host_tiles(gpu, passes, &bound, plan)?;
    geometry::project(
        gpu,
        passes,
        &bound,
        "pelage.geometry.project",
        &plan.bands[0].drawings,
        plan,
    )?;
    shading::record(gpu, passes, &bound, plan)?;
    for band in &plan.bands {
        transparency::record(gpu, passes, &bound, band, plan)?;
        if band.first == 0 {
            composite::receive(gpu, passes, &bound, plan, target)?;
        }
        composite::record(gpu, passes, &bound, band, plan, target)?;
    }
    resources.read_counters(passes);
    Ok(())
}
