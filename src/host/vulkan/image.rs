//! The host's images: what of them can be drawn into, and the barriers by which they are taken and given back.

use ash::vk;
use wgpu::{TextureFormat, TextureUsages, TextureUses};

use super::barrier::Families;
use crate::error::{Error, Result, invalid};
use crate::surface::Subresource;

type Hal = wgpu::hal::api::Vulkan;

/// An image of the host's: one layer and one mip level of a 2D image. The other ones are not touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Image {
    /// The host's.
    pub image: vk::Image,
    /// As the image was made.
    pub format: vk::Format,
    /// Width and height in pixels of mip level 0.
    pub extent: vk::Extent2D,
    /// As the image was made: a colour needs `COLOR_ATTACHMENT`; a depth `SAMPLED`, and `DEPTH_STENCIL_ATTACHMENT` where
    /// it is written.
    pub usage: vk::ImageUsageFlags,
    /// As the image was made: one sample.
    pub samples: vk::SampleCountFlags,
    /// The layout that the image is in when the submission begins. `UNDEFINED`: what it holds is lost.
    pub layout_in: vk::ImageLayout,
    /// The layout that the submission leaves it in.
    pub layout_out: vk::ImageLayout,
    /// As the image was made.
    pub array_layers: u32,
    /// As the image was made.
    pub mip_levels: u32,
    /// Which layer and mip level is meant.
    pub subresource: Subresource,
    /// The family of queues from which the submission acquires the image, in `layout_in`, as the host has released it there:
    /// one of the device's, `QUEUE_FAMILY_EXTERNAL`, or `QUEUE_FAMILY_FOREIGN_EXT` where its extension is enabled. `None`, and
    /// the queue's own family: it is there already.
    pub owner_before: Option<u32>,
    /// The family to which the submission releases the image, in `layout_out`, likewise.
    pub owner_after: Option<u32>,
}

/// What an image is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aspect {
    /// The colour that hair is blended over.
    Colour,
    /// The depth that hides hair.
    Depth,
    /// [`crate::Outputs::nearest_depth`].
    NearestDepth,
    /// [`crate::Outputs::coverage`].
    Coverage,
    /// [`crate::Outputs::motion`].
    Motion,
    /// [`crate::Outputs::ids`].
    Ids,
    /// [`crate::Occluder::depth`].
    Occluder,
    /// [`crate::ShadowImage::image`].
    ShadowImage,
}

const COLOURS: [(vk::Format, TextureFormat); 8] = [
    (vk::Format::R16G16B16A16_SFLOAT, TextureFormat::Rgba16Float),
    (vk::Format::R32G32B32A32_SFLOAT, TextureFormat::Rgba32Float),
    (
        vk::Format::B10G11R11_UFLOAT_PACK32,
        TextureFormat::Rg11b10Ufloat,
    ),
    (
        vk::Format::A2B10G10R10_UNORM_PACK32,
        TextureFormat::Rgb10a2Unorm,
    ),
    (vk::Format::R8G8B8A8_UNORM, TextureFormat::Rgba8Unorm),
    (vk::Format::R8G8B8A8_SRGB, TextureFormat::Rgba8UnormSrgb),
    (vk::Format::B8G8R8A8_UNORM, TextureFormat::Bgra8Unorm),
    (vk::Format::B8G8R8A8_SRGB, TextureFormat::Bgra8UnormSrgb),
];

const DEPTHS: [(vk::Format, TextureFormat); 5] = [
    (vk::Format::D16_UNORM, TextureFormat::Depth16Unorm),
    (vk::Format::X8_D24_UNORM_PACK32, TextureFormat::Depth24Plus),
    (vk::Format::D32_SFLOAT, TextureFormat::Depth32Float),
    (
        vk::Format::D24_UNORM_S8_UINT,
        TextureFormat::Depth24PlusStencil8,
    ),
    (
        vk::Format::D32_SFLOAT_S8_UINT,
        TextureFormat::Depth32FloatStencil8,
    ),
];

const NEAREST_DEPTHS: [(vk::Format, TextureFormat); 1] =
    [(vk::Format::R32_SFLOAT, TextureFormat::R32Float)];

const COVERAGES: [(vk::Format, TextureFormat); 3] = [
    (vk::Format::R32_SFLOAT, TextureFormat::R32Float),
    (vk::Format::R16_SFLOAT, TextureFormat::R16Float),
    (vk::Format::R8_UNORM, TextureFormat::R8Unorm),
];

const MOTIONS: [(vk::Format, TextureFormat); 2] = [
    (vk::Format::R32G32_SFLOAT, TextureFormat::Rg32Float),
    (vk::Format::R16G16_SFLOAT, TextureFormat::Rg16Float),
];

const IDS: [(vk::Format, TextureFormat); 1] = [(vk::Format::R32G32_UINT, TextureFormat::Rg32Uint)];

const SHADOW_IMAGES: [(vk::Format, TextureFormat); 5] = [
    (vk::Format::R32_SFLOAT, TextureFormat::R32Float),
    (vk::Format::R16_SFLOAT, TextureFormat::R16Float),
    (vk::Format::R8_UNORM, TextureFormat::R8Unorm),
    (vk::Format::R16G16B16A16_SFLOAT, TextureFormat::Rgba16Float),
    (vk::Format::R8G8B8A8_UNORM, TextureFormat::Rgba8Unorm),
];

/// The colour formats that there are, whether or not a device can blend them.
pub fn colour_formats() -> impl Iterator<Item = vk::Format> {
    COLOURS.into_iter().map(|(format, _)| format)
}

/// The depth formats that there are, whether or not a device has them.
pub fn depth_formats() -> impl Iterator<Item = vk::Format> {
    DEPTHS.into_iter().map(|(format, _)| format)
}

/// The formats that a device's images may have.
#[derive(Debug)]
pub(super) struct Formats(Vec<(vk::Format, TextureFormat)>);

impl Formats {
    /// Of all formats those that wgpu maps to the very same one of Vulkan, and that the device has.
    pub fn of(
        adapter: &<Hal as wgpu::hal::Api>::Adapter,
        features: wgpu::Features,
        raw: &ash::Instance,
        physical: vk::PhysicalDevice,
    ) -> Self {
        let has = |(format, ours): &(vk::Format, TextureFormat)| {
            let needed = if ours.has_depth_aspect() {
                vk::FormatFeatureFlags::SAMPLED_IMAGE
            } else if COLOURS.iter().any(|(colour, _)| colour == format) {
                vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND
            } else {
                vk::FormatFeatureFlags::COLOR_ATTACHMENT
            };
            // SAFETY: the physical device belongs to the instance.
            let properties =
                unsafe { raw.get_physical_device_format_properties(physical, *format) };
            adapter.texture_format_as_raw(*ours) == *format
                && features.contains(ours.required_features())
                && properties.optimal_tiling_features.contains(needed)
        };
        let outputs = [&NEAREST_DEPTHS[..], &COVERAGES, &MOTIONS, &IDS].concat();
        let all = COLOURS.into_iter().chain(DEPTHS).chain(outputs);
        Self(all.filter(has).collect())
    }

    fn find(&self, format: vk::Format) -> Option<TextureFormat> {
        let mut known = self.0.iter();
        known
            .find(|(theirs, _)| *theirs == format)
            .map(|(_, ours)| *ours)
    }
}

impl Image {
    /// Checks all of an image that can be checked without a device's help.
    pub(super) fn validate(
        &self,
        aspect: Aspect,
        formats: &Formats,
        families: &Families,
    ) -> Result<()> {
        let name = aspect.name();
        if self.image == vk::Image::null() {
            return invalid!("{name}: the image is NULL");
        }
        self.format(aspect, formats)?;
        if self.samples != vk::SampleCountFlags::TYPE_1 {
            return Err(Error::Unsupported(format!(
                "{name}: the image has {} samples a pixel; resolve it into one of a single sample first",
                self.samples.as_raw()
            )));
        }
        let vk::Extent2D { width, height } = self.extent;
        if width == 0 || height == 0 {
            return invalid!("{name}: an image of {width}×{height} pixels");
        }
        let most = width.max(height).ilog2() + 1;
        if self.array_layers == 0 || !(1..=most).contains(&self.mip_levels) {
            return invalid!(
                "{name}: an image of {} layers and {} mip levels; one of {width}×{height} pixels has at least one layer and from 1 to {most} levels",
                self.array_layers,
                self.mip_levels
            );
        }
        self.subresource
            .validate(name, self.array_layers, self.mip_levels)?;
        let (needed, word) = match aspect {
            Aspect::Depth | Aspect::Occluder => {
                (vk::ImageUsageFlags::SAMPLED, "VK_IMAGE_USAGE_SAMPLED_BIT")
            }
            _ => (
                vk::ImageUsageFlags::COLOR_ATTACHMENT,
                "VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT",
            ),
        };
        if !self.usage.contains(needed) {
            return invalid!("{name}: the image's usage lacks {word}");
        }
        layout_fits(name, "layout_in", self.layout_in)?;
        layout_fits(name, "layout_out", self.layout_out)?;
        if leads_nowhere(self.layout_out) {
            return invalid!(
                "{name}: layout_out is VK_IMAGE_LAYOUT_{:?}, in which no image can be left",
                self.layout_out
            );
        }
        families.validate(name, "owner_before", self.owner_before)?;
        families.validate(name, "owner_after", self.owner_after)?;
        if families.other(self.owner_before).is_some() && leads_nowhere(self.layout_in) {
            return invalid!(
                "{name}: layout_in is VK_IMAGE_LAYOUT_{:?}, in which no image can change hands; owner_before must be ignored",
                self.layout_in
            );
        }
        Ok(())
    }

    /// The image's format, if it serves.
    fn format(&self, aspect: Aspect, formats: &Formats) -> Result<TextureFormat> {
        let name = aspect.name();
        let own = |(format, _): &(vk::Format, TextureFormat)| *format == self.format;
        let listed: &[_] = match aspect {
            Aspect::Colour => &COLOURS,
            Aspect::Depth | Aspect::Occluder => &DEPTHS,
            Aspect::NearestDepth => &NEAREST_DEPTHS,
            Aspect::Coverage => &COVERAGES,
            Aspect::Motion => &MOTIONS,
            Aspect::Ids => &IDS,
            Aspect::ShadowImage => &SHADOW_IMAGES,
        };
        if !listed.iter().any(own) {
            let possible: Vec<_> = listed
                .iter()
                .map(|(format, _)| format!("{format:?}"))
                .collect();
            return invalid!(
                "{name}: format {:?} ({}) is not one of {}",
                self.format,
                self.format.as_raw(),
                possible.join(", ")
            );
        }
        formats.find(self.format).ok_or_else(|| {
            Error::Unsupported(format!(
                "{name}: this device cannot use the format {:?}",
                self.format
            ))
        })
    }
}

/// Layouts to which no barrier leads.
fn leads_nowhere(layout: vk::ImageLayout) -> bool {
    [vk::ImageLayout::UNDEFINED, vk::ImageLayout::PREINITIALIZED].contains(&layout)
}

/// Layouts in which any image may be, of Vulkan 1.3 and of presentation.
fn layout_fits(name: &str, which: &str, layout: vk::ImageLayout) -> Result<()> {
    let known = match layout.as_raw() {
        0..=8 => true,
        raw => [
            vk::ImageLayout::DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL,
            vk::ImageLayout::DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL,
            vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
            vk::ImageLayout::DEPTH_READ_ONLY_OPTIMAL,
            vk::ImageLayout::READ_ONLY_OPTIMAL,
            vk::ImageLayout::ATTACHMENT_OPTIMAL,
            vk::ImageLayout::PRESENT_SRC_KHR,
        ]
        .iter()
        .any(|known| known.as_raw() == raw),
    };
    if !known {
        return invalid!(
            "{name}: {which} {} is not a VkImageLayout that an image can be taken or left in",
            layout.as_raw()
        );
    }
    Ok(())
}

impl Aspect {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Colour => "colour",
            Self::Depth => "depth",
            Self::NearestDepth => "nearest_depth",
            Self::Coverage => "coverage",
            Self::Motion => "motion",
            Self::Ids => "ids",
            Self::Occluder => "occluder",
            Self::ShadowImage => "shadow_image",
        }
    }
}

/// An image of the host's as a texture, for one submission.
pub(super) struct Wrapped {
    pub texture: wgpu::Texture,
    /// In which the image is before and after the frame.
    layout: vk::ImageLayout,
    aspects: vk::ImageAspectFlags,
    image: Image,
}

impl Wrapped {
    /// Wraps an image that has been validated.
    ///
    /// # Safety
    /// The image is what it is said to be, and lives until the GPU is done with it.
    pub unsafe fn new(
        device: &wgpu::Device,
        image: &Image,
        aspect: Aspect,
        formats: &Formats,
    ) -> Result<Self> {
        let format = image.format(aspect, formats)?;
        let limits = device.limits();
        let largest = limits.max_texture_dimension_2d;
        let vk::Extent2D { width, height } = image.extent;
        if width > largest || height > largest {
            return invalid!(
                "{}: an image of {width}×{height} pixels; sides up to {largest} are possible",
                aspect.name()
            );
        }
        let most = limits.max_texture_array_layers;
        if image.array_layers > most {
            return invalid!(
                "{}: an image of {} layers; up to {most} are possible",
                aspect.name(),
                image.array_layers
            );
        }
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: image.array_layers,
        };
        // As little as the library uses: a texture needs no more of the image's usage.
        let (state, layout, aspects, usage) = match aspect {
            Aspect::Depth | Aspect::Occluder => {
                let stencil = if format.has_stencil_aspect() {
                    vk::ImageAspectFlags::STENCIL
                } else {
                    vk::ImageAspectFlags::empty()
                };
                let written = aspect == Aspect::Depth
                    && image
                        .usage
                        .contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
                let attachment = if written {
                    TextureUsages::RENDER_ATTACHMENT
                } else {
                    TextureUsages::empty()
                };
                (
                    TextureUses::RESOURCE,
                    vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
                    vk::ImageAspectFlags::DEPTH | stencil,
                    TextureUsages::TEXTURE_BINDING | attachment,
                )
            }
            _ => (
                TextureUses::COLOR_TARGET,
                vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
                vk::ImageAspectFlags::COLOR,
                TextureUsages::RENDER_ATTACHMENT,
            ),
        };
        // SAFETY: nothing of the raw device is kept or destroyed.
        let Some(raw) = (unsafe { device.as_hal::<Hal>() }) else {
            return Err(Error::Internal("the device is not Vulkan's".into()));
        };
        let uses = if usage.contains(TextureUsages::RENDER_ATTACHMENT) {
            match aspect {
                Aspect::Depth => TextureUses::RESOURCE | TextureUses::DEPTH_STENCIL_WRITE,
                _ => TextureUses::COLOR_TARGET,
            }
        } else {
            TextureUses::RESOURCE
        };
        // No label: the image's name is the host's. A drop callback: wgpu does not destroy it.
        let described = wgpu::hal::TextureDescriptor {
            label: None,
            size,
            mip_level_count: image.mip_levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: uses,
            memory_flags: wgpu::hal::MemoryFlags::empty(),
            view_formats: Vec::new(),
        };
        // SAFETY: the image is as described, by the host's promise.
        let texture = unsafe {
            raw.texture_from_raw(
                image.image,
                &described,
                Some(Box::new(|| ())),
                wgpu::hal::vulkan::TextureMemory::External,
            )
        };
        drop(raw);
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: image.mip_levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        };
        // SAFETY: made on this device as described; the barrier before the frame brings it into `state`.
        let texture = unsafe { device.create_texture_from_hal::<Hal>(texture, &descriptor, state) };
        Ok(Self {
            texture,
            layout,
            aspects,
            image: *image,
        })
    }

    /// The barrier that brings the image into the layout of the frame's own, or out of it.
    pub fn layout_barrier(&self, towards_us: bool) -> vk::ImageMemoryBarrier<'static> {
        let (from, to) = if towards_us {
            (self.image.layout_in, self.layout)
        } else {
            (self.layout, self.image.layout_out)
        };
        self.barrier()
            .old_layout(from)
            .new_layout(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE)
    }

    /// Our half of the transfer by which the image changes hands, in the layout that it keeps meanwhile; `None` where it
    /// stays where it is.
    pub fn owner_barrier(
        &self,
        families: &Families,
        towards_us: bool,
    ) -> Option<vk::ImageMemoryBarrier<'static>> {
        let (owner, layout) = if towards_us {
            (self.image.owner_before, self.image.layout_in)
        } else {
            (self.image.owner_after, self.image.layout_out)
        };
        let transfer = families.transfer(owner, towards_us)?;
        Some(
            self.barrier()
                .old_layout(layout)
                .new_layout(layout)
                .src_queue_family_index(transfer.from)
                .dst_queue_family_index(transfer.to)
                .src_access_mask(transfer.src_access)
                .dst_access_mask(transfer.dst_access),
        )
    }

    fn barrier(&self) -> vk::ImageMemoryBarrier<'static> {
        let Subresource { layer, mip_level } = self.image.subresource;
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(self.aspects)
            .base_mip_level(mip_level)
            .level_count(1)
            .base_array_layer(layer)
            .layer_count(1);
        vk::ImageMemoryBarrier::default()
            .image(self.image.image)
            .subresource_range(range)
    }
}
