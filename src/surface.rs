//! One layer and one mip level of an image: what a frame is drawn into.

use crate::error::{Error, Result, invalid};

/// A layer and a mip level of an image: the first ones, unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Subresource {
    /// The layer of an array image.
    pub layer: u32,
    /// The mip level. An image's size is that of this level.
    pub mip_level: u32,
}

/// The subresource of each image of a [`crate::Target`]. Layers of one image can be the targets of several frames, as of both
/// eyes, and even colour and outputs of one frame; the other layers and levels are not touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Subresources {
    /// Of [`crate::Target::colour`].
    pub colour: Subresource,
    /// Of [`crate::Target::depth`].
    pub depth: Subresource,
    /// Of [`crate::Outputs::nearest_depth`].
    pub nearest_depth: Subresource,
    /// Of [`crate::Outputs::coverage`].
    pub coverage: Subresource,
    /// Of [`crate::Outputs::motion`].
    pub motion: Subresource,
    /// Of [`crate::Outputs::ids`].
    pub ids: Subresource,
}

impl Subresource {
    /// Checks the subresource of an image that has so many layers and mip levels.
    pub(crate) fn validate(self, name: &str, layers: u32, mip_levels: u32) -> Result<()> {
        if self.layer >= layers {
            return invalid!("{name}: layer {} of an image of {layers}", self.layer);
        }
        if self.mip_level >= mip_levels {
            return invalid!(
                "{name}: mip level {} of an image of {mip_levels}",
                self.mip_level
            );
        }
        Ok(())
    }

    /// Width and height of the mip level, of those of the first.
    pub(crate) fn size(self, first: [u32; 2]) -> [u32; 2] {
        first.map(|side| side.checked_shr(self.mip_level).unwrap_or(0).max(1))
    }
}

/// A subresource of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Surface<'a> {
    pub texture: &'a wgpu::Texture,
    pub at: Subresource,
}

impl Surface<'_> {
    pub fn format(&self) -> wgpu::TextureFormat {
        self.texture.format()
    }

    pub fn size(&self) -> [u32; 2] {
        self.at.size([self.texture.width(), self.texture.height()])
    }

    pub fn view(&self, aspect: wgpu::TextureAspect) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            aspect,
            base_mip_level: self.at.mip_level,
            mip_level_count: Some(1),
            base_array_layer: self.at.layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    }

    /// Checks what all images of a target have in common.
    pub fn validate(&self, name: &str, usage: wgpu::TextureUsages) -> Result<()> {
        let texture = self.texture;
        if texture.sample_count() != 1 {
            return Err(Error::Unsupported(format!(
                "the target's {name} has {} samples a pixel; resolve it first",
                texture.sample_count()
            )));
        }
        if texture.dimension() != wgpu::TextureDimension::D2 {
            return invalid!("the target's {name} is not a 2D image");
        }
        self.at.validate(
            &format!("the target's {name}"),
            texture.depth_or_array_layers(),
            texture.mip_level_count(),
        )?;
        if !texture.usage().contains(usage) {
            return invalid!(
                "the target's {name} lacks the usage {:?}",
                usage - texture.usage()
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mip_level_halves_each_side_down_to_one_pixel() {
        let size = |mip_level| {
            Subresource {
                layer: 0,
                mip_level,
            }
            .size([37, 6])
        };
        assert_eq!(
            [0, 1, 2, 3, 5, 31, 32].map(size),
            [[37, 6], [18, 3], [9, 1], [4, 1], [1, 1], [1, 1], [1, 1]]
        );
    }
}
