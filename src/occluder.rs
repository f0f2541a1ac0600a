//! The host's opaque scene as a light sees it: its own shadow maps, which shadow the hair.

use glam::DMat4;

use crate::error::{Error, Result, invalid};
use crate::layout::{self, MAX_OCCLUDERS};
use crate::surface::{Subresource, Surface};

/// A shadow map of the host's, that shadows the hair from one light.
///
/// Of several maps for one light (cascades, the faces of a cube) the first decides in whose clip space a point lies. What
/// lies in none is lit.
#[derive(Debug, Clone, Copy)]
pub struct Occluder<'a> {
    /// The light's place in [`crate::Frame::lights`].
    pub light: usize,
    /// The depth of the opaque scene as the light sees it: single-sampled, 2D, usable as a texture.
    pub depth: &'a wgpu::Texture,
    /// Which layer and mip level of it is meant.
    pub subresource: Subresource,
    /// The clip space of that depth, 0 to 1, from world space. Can be inverted.
    pub clip_from_world: DMat4,
    /// Clip depth 1 is near and 0 far.
    pub reverse_z: bool,
    /// Clip space's y points down the image, as Vulkan's own convention has it, not up.
    pub flip_y: bool,
    /// How far a point is moved towards the light before it is compared, in host units, at least 0. Hair needs none for
    /// itself; what roots on a surface takes about a texel's size.
    pub bias: f32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
}

impl Occluder<'_> {
    /// Checks everything; `number` is the place among the target's occluders.
    fn validate(&self, number: usize, lights: usize) -> Result<()> {
        if self.light >= lights {
            return invalid!(
                "occluder {number}: light {} of a frame of {lights} lights",
                self.light
            );
        }
        let determinant = self.clip_from_world.determinant();
        if !self.clip_from_world.is_finite() || determinant == 0.0 || !determinant.is_finite() {
            return invalid!("occluder {number}: clip_from_world cannot be inverted");
        }
        if !(self.bias >= 0.0 && self.bias.is_finite()) {
            return invalid!(
                "occluder {number}: bias {} is negative or not finite",
                self.bias
            );
        }
        if !matches!(self.pcf, 1 | 3 | 5) {
            return invalid!("occluder {number}: pcf {} is not 1, 3 or 5", self.pcf);
        }
        self.surface().validate(
            &format!("occluder {number}"),
            wgpu::TextureUsages::TEXTURE_BINDING,
        )?;
        if !self.depth.format().has_depth_aspect() {
            return invalid!(
                "occluder {number} has the format {:?}, which holds no depth",
                self.depth.format()
            );
        }
        Ok(())
    }

    pub(crate) fn surface(&self) -> Surface<'_> {
        Surface {
            texture: self.depth,
            at: self.subresource,
        }
    }

    /// As the shaders have it, with positions relative to an origin.
    pub(crate) fn uniform(&self, relative_origin: glam::DVec3) -> layout::Occluder {
        let flip = glam::DVec3::new(1.0, if self.flip_y { -1.0 } else { 1.0 }, 1.0);
        let clip = DMat4::from_scale(flip)
            * self.clip_from_world
            * DMat4::from_translation(relative_origin);
        layout::Occluder {
            clip_from_relative: clip.as_mat4().to_cols_array_2d(),
            light: self.light as u32,
            pcf: self.pcf,
            bias: self.bias,
            flags: u32::from(self.reverse_z),
        }
    }
}

/// Checks a target's occluders.
pub(crate) fn validate(occluders: &[Occluder], lights: usize) -> Result<()> {
    if occluders.len() > MAX_OCCLUDERS {
        return Err(Error::Unsupported(format!(
            "{} occluders: a frame takes at most {MAX_OCCLUDERS}",
            occluders.len()
        )));
    }
    occluders
        .iter()
        .enumerate()
        .try_for_each(|(number, occluder)| occluder.validate(number, lights))
}

/// The files that say what of a light the host's opaque scene lets through.
pub(crate) fn files(occluded: bool) -> &'static [&'static str] {
    if occluded {
        &["occluder"]
    } else {
        &["occluder_none"]
    }
}
