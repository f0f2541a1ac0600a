//! A frame: what is drawn, into what, and the way of the data in one function.

use glam::Vec3;

use crate::error::{Error, Result, invalid};
use crate::geometry::{Hair, Projection};
use crate::light::Light;
use crate::occluder::Occluder;
use crate::plan::Plan;
use crate::raster::Rasteriser;
use crate::resources::Resources;
use crate::surface::{Subresource, Subresources, Surface};
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
    /// The part of the images that the view fills: left, top, width, height in pixels. `None`: all of them. Nothing outside
    /// it is touched, but that `clear` clears the whole image.
    pub rectangle: Option<[u32; 4]>,
    /// What else is written.
    pub outputs: Outputs<'a>,
    /// The host's own shadow maps, which shadow the hair; at most [`crate::MAX_OCCLUDERS`].
    pub occluders: &'a [Occluder<'a>],
    /// The hair's shadow on the opaque scene, an image a light, for the host's own lighting.
    pub shadow_images: &'a [ShadowImage<'a>],
    /// Write `shadow_images` alone: no hair is drawn, and nothing else of the target is touched.
    pub shadows_only: bool,
    /// Which layer and mip level of each image is meant.
    pub subresources: Subresources,
}

/// An image of the hair's shadow from one light on the opaque scene.
///
/// Each pixel of the view's rectangle holds the part of the light, from 0 to 1, that the hair lets through to the point
/// that the target's depth stands for; 1 at the far plane. Red, green and blue are those of the light; alpha is 1.
#[derive(Debug, Clone, Copy)]
pub struct ShadowImage<'a> {
    /// The light's place in [`Frame::lights`].
    pub light: usize,
    /// `R32Float`, `R16Float`, `R8Unorm`, `Rgba16Float` or `Rgba8Unorm`, of the colour's size, usable as a render attachment.
    pub image: &'a wgpu::Texture,
    /// Which layer and mip level of it is meant.
    pub subresource: Subresource,
}

impl<'a> ShadowImage<'a> {
    pub(crate) fn surface(&self) -> Surface<'a> {
        Surface {
            texture: self.image,
            at: self.subresource,
        }
    }
}

/// The formats of shadow images.
const SHADOW_IMAGES: &[wgpu::TextureFormat] = &[
    wgpu::TextureFormat::R32Float,
    wgpu::TextureFormat::R16Float,
    wgpu::TextureFormat::R8Unorm,
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba8Unorm,
];

/// Images beside the colour, all of its size, each written in the whole rectangle and usable as a render attachment.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outputs<'a> {
    /// `R32Float`: clip depth of the nearest fibre; the far plane's where there is none.
    pub nearest_depth: Option<&'a wgpu::Texture>,
    /// `R32Float`, `R16Float` or `R8Unorm`: the part of the pixel that hair covers, from 0 to 1: the alpha of the hair alone.
    pub coverage: Option<&'a wgpu::Texture>,
    /// `Rg32Float` or `Rg16Float`: how far the nearest fibre has moved on the screen since the frame before, in pixels, +x
    /// right, +y down, the views' jitter left out; 0 where there is none.
    pub motion: Option<&'a wgpu::Texture>,
    /// `Rg32Uint`: of the nearest fibre, the hair's place in [`Frame::hairs`] in the lower 16 bits and its instance in the
    /// upper 16; and the strand's number. [`NO_STRAND`] in both where there is none.
    pub ids: Option<&'a wgpu::Texture>,
}

/// What both words of [`Outputs::ids`] hold where there is no hair.
pub const NO_STRAND: u32 = u32::MAX;

impl<'a> Outputs<'a> {
    /// Whether anything is asked for, and whether that takes a record of each point.
    pub(crate) fn wanted(&self) -> (bool, bool) {
        let tracked = self.motion.is_some() || self.ids.is_some();
        let others = self.nearest_depth.is_some() || self.coverage.is_some();
        (tracked || others, tracked)
    }
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
            rectangle: None,
            outputs: Outputs::default(),
            occluders: &[],
            shadow_images: &[],
            shadows_only: false,
            subresources: Subresources::default(),
        }
    }

    pub(crate) fn colour_surface(&self) -> Surface<'a> {
        Surface {
            texture: self.colour,
            at: self.subresources.colour,
        }
    }

    pub(crate) fn depth_surface(&self) -> Option<Surface<'a>> {
        let at = self.subresources.depth;
        self.depth.map(|texture| Surface { texture, at })
    }

    /// Name, image and formats of each output, in the order of the attachments.
    pub(crate) fn output_surfaces(
        &self,
    ) -> [(
        &'static str,
        Option<Surface<'a>>,
        &'static [wgpu::TextureFormat],
    ); 4] {
        use wgpu::TextureFormat as Format;
        let (images, at) = (&self.outputs, &self.subresources);
        let surface =
            |texture: Option<&'a wgpu::Texture>, at| texture.map(|texture| Surface { texture, at });
        [
            (
                "nearest_depth",
                surface(images.nearest_depth, at.nearest_depth),
                &[Format::R32Float],
            ),
            (
                "coverage",
                surface(images.coverage, at.coverage),
                &[Format::R32Float, Format::R16Float, Format::R8Unorm],
            ),
            (
                "motion",
                surface(images.motion, at.motion),
                &[Format::Rg32Float, Format::Rg16Float],
            ),
            ("ids", surface(images.ids, at.ids), &[Format::Rg32Uint]),
        ]
    }

    /// Left, top, width and height of what the view fills.
    pub(crate) fn area(&self) -> [u32; 4] {
        let [width, height] = self.colour_surface().size();
        self.rectangle.unwrap_or([0, 0, width, height])
    }

    pub(crate) fn validate(&self, device: &wgpu::Device) -> Result<()> {
        let colour = self.colour_surface();
        colour.validate("colour", wgpu::TextureUsages::RENDER_ATTACHMENT)?;
        let format = colour.format();
        if format
            .sample_type(None, Some(device.features()))
            .is_none_or(|sample| !matches!(sample, wgpu::TextureSampleType::Float { .. }))
            || format.has_depth_aspect()
        {
            return invalid!(
                "the target's colour has the format {format:?}, which holds no colour as floats"
            );
        }
        let blendable = format.guaranteed_format_features(device.features()).flags;
        if !blendable.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
            return Err(Error::Unsupported(format!(
                "this device cannot blend into {format:?}"
            )));
        }
        let [whole_width, whole_height] = colour.size();
        let [left, top, width, height] = self.area();
        let fits = |first: u32, size: u32, all: u32| {
            size > 0 && first.checked_add(size).is_some_and(|end| end <= all)
        };
        if !fits(left, width, whole_width) || !fits(top, height, whole_height) {
            return invalid!(
                "the rectangle of {width}×{height} pixels at ({left}, {top}) is not within the target's {whole_width}×{whole_height}"
            );
        }
        let names: Vec<String> = (0..self.shadow_images.len())
            .map(|number| format!("shadow image {number}"))
            .collect();
        let shadows = self.shadow_images.iter().zip(&names);
        let shadows =
            shadows.map(|(shadow, name)| (&name[..], Some(shadow.surface()), SHADOW_IMAGES));
        let same_size = |name: &str, image: &Surface| {
            let [width, height] = image.size();
            if [width, height] != colour.size() {
                return invalid!(
                    "the target's {name} is {width}×{height}, its colour {whole_width}×{whole_height}"
                );
            }
            Ok(())
        };
        for (name, image, formats) in self.output_surfaces().into_iter().chain(shadows) {
            let Some(image) = image else { continue };
            image.validate(name, wgpu::TextureUsages::RENDER_ATTACHMENT)?;
            if !formats.contains(&image.format()) {
                return invalid!(
                    "the target's {name} has the format {:?}; possible are {formats:?}",
                    image.format()
                );
            }
            same_size(name, &image)?;
        }
        let Some(depth) = self.depth_surface() else {
            if self.write_depth || self.receive_shadow {
                return invalid!("write_depth and receive_shadow need a depth in the target");
            }
            if !self.shadow_images.is_empty() {
                return invalid!("shadow images need a depth in the target");
            }
            return Ok(());
        };
        let mut usage = wgpu::TextureUsages::TEXTURE_BINDING;
        if self.write_depth {
            usage |= wgpu::TextureUsages::RENDER_ATTACHMENT;
        }
        depth.validate("depth", usage)?;
        if !depth.format().has_depth_aspect() {
            return invalid!(
                "the target's depth has the format {:?}, which holds no depth",
                depth.format()
            );
        }
        same_size("depth", &depth)
    }
}

/// The way of the data: every step one line, in this order; no step reaches back.
pub(crate) fn record(
    gpu: &mut gpu::Gpu,
    passes: &mut gpu::Passes,
    resources: &Resources,
    plan: &Plan,
    target: &Target,
) -> Result<()> {
    if !plan.shadows_only {
        composite::clear(passes, target);
    }
    let Some(bound) = resources.bound(plan) else {
        composite::shadow_images(gpu, passes, None, plan, target)?;
        return composite::outputs_none(gpu, passes, plan, target);
    };
    resources.clear_maps(passes, plan);
    for map in plan.maps.iter().filter(|map| map.filled) {
        geometry::project(
            gpu,
            passes,
            &bound,
            Projection {
                crosses: map.crosses,
                view: false,
            },
            &map.drawings,
            plan,
        )?;
        if map.rasteriser == Rasteriser::Walk {
            geometry::order(
                gpu,
                passes,
                &bound,
                "pelage.shadow.order",
                &map.drawings,
                plan,
            )?;
        }
        shadow::record(gpu, passes, &bound, map, plan)?;
    }
    composite::shadow_images(gpu, passes, Some(&bound), plan, target)?;
    if plan.shadows_only {
        resources.keep_nothing(passes, &bound, plan);
        return Ok(());
    }
    geometry::host_tiles(gpu, passes, &bound, plan)?;
    composite::receive(gpu, passes, &bound, plan, target)?;
    geometry::project(
        gpu,
        passes,
        &bound,
        Projection {
            crosses: plan.crosses,
            view: true,
        },
        &plan.bands[0].drawings,
        plan,
    )?;
    if plan.rasteriser == Rasteriser::Walk {
        geometry::order(
            gpu,
            passes,
            &bound,
            "pelage.geometry.order",
            &plan.bands[0].drawings,
            plan,
        )?;
    }
    geometry::track(gpu, passes, &bound, plan)?;
    for band in &plan.bands {
        transparency::count(gpu, passes, &bound, band, plan)?;
        if band.first == 0 {
            shading::record(gpu, passes, &bound, plan)?;
        }
        transparency::record(gpu, passes, &bound, band, plan)?;
        composite::record(gpu, passes, &bound, band, plan, target)?;
        composite::outputs(gpu, passes, &bound, band, plan, target)?;
    }
    resources.read_counters(passes);
    Ok(())
}
