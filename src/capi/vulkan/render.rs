//! Frames into the host's images.

use std::mem::size_of;
use std::ptr::null;

use ash::vk;
use ash::vk::Handle;
use glam::DMat4;

use super::super::descriptor::{self, descriptor};
use super::super::error::{PelageResult, guard};
use super::super::frame::{GivenFrame, PELAGE_VIEW_FLIP_Y, PELAGE_VIEW_REVERSE_Z, PelageFrame};
use super::super::input::{flags, reserved};
use super::super::registry::{PelageContext, State};
use super::super::render::{
    ALL_FLAGS, PELAGE_RENDER_CLEAR, PELAGE_RENDER_RECEIVE_SHADOW, PELAGE_RENDER_SHADOWS_ONLY,
    PELAGE_RENDER_WRITE_DEPTH,
};
use super::{PELAGE_VULKAN_QUEUE_FAMILY_IGNORED, PelageVkImage, PelageVkSemaphore, owner};
use crate::error::{Result, invalid};
use crate::geometry::Hair;
use crate::host::vulkan::{Image, MAX_VIEWS, Semaphore, View, ViewOccluder, ViewOutputs};
use crate::surface::Subresource;

/// An image of the host's: one layer and one mip level of a 2D image. The other ones are not touched, and neither are their
/// layouts.
///
/// An image of `VK_SHARING_MODE_EXCLUSIVE` that another family of queues has used, or will use next, changes hands. Then the
/// submission acquires it in `layout_in` before all else, or releases it in `layout_out` in the end: one half of the transfer,
/// by a barrier of that layer and mip level, of all aspects of the format, whose old and new layout are the same. The host
/// records the other half with the same layouts, families and subresource on the other queue, and orders the two by a
/// semaphore.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanImage {
    /// `sizeof(PelageVulkanImage)`.
    pub struct_size: u32,
    /// `VkFormat`, as the image was made.
    pub format: u32,
    /// `VkImage`.
    pub image: PelageVkImage,
    /// Width in pixels of mip level 0.
    pub width: u32,
    /// Height in pixels of mip level 0.
    pub height: u32,
    /// `VkImageUsageFlags`, as the image was made. A colour needs `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`, a depth
    /// `VK_IMAGE_USAGE_SAMPLED_BIT`, and `VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT` where it is written.
    pub usage: u32,
    /// `VkSampleCountFlagBits`, as the image was made: 1. An image of several samples is refused.
    pub samples: u32,
    /// `VkImageLayout` in which the image is when the submission begins. `VK_IMAGE_LAYOUT_UNDEFINED`: what it holds is lost,
    /// which only a colour that is cleared takes.
    pub layout_in: u32,
    /// `VkImageLayout` in which the submission leaves it.
    pub layout_out: u32,
    /// `arrayLayers`, as the image was made.
    pub array_layers: u32,
    /// `mipLevels`, as the image was made.
    pub mip_levels: u32,
    /// The layer that is meant, below `array_layers`.
    pub layer: u32,
    /// The mip level that is meant, below `mip_levels`.
    pub mip_level: u32,
    /// The family of queues from which the submission acquires the image, as the host has released it there; the number of
    /// one of the device's families, `VK_QUEUE_FAMILY_EXTERNAL`, or `VK_QUEUE_FAMILY_FOREIGN_EXT` on a device that was made with
    /// `VK_EXT_queue_family_foreign`. The queue's own family and `PELAGE_VULKAN_QUEUE_FAMILY_IGNORED`: it is there already.
    pub owner_before: u32,
    /// The family to which the submission releases the image, likewise.
    pub owner_after: u32,
}

impl Default for PelageVulkanImage {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            format: 0,
            image: 0,
            width: 0,
            height: 0,
            usage: 0,
            samples: 1,
            layout_in: 0,
            layout_out: 0,
            array_layers: 1,
            mip_levels: 1,
            layer: 0,
            mip_level: 0,
            owner_before: PELAGE_VULKAN_QUEUE_FAMILY_IGNORED,
            owner_after: PELAGE_VULKAN_QUEUE_FAMILY_IGNORED,
        }
    }
}

descriptor!(PelageVulkanImage, "PELAGE_VULKAN_IMAGE_INIT", owner_after: u32);

/// The most shadow maps of the host's in one view.
pub const PELAGE_MAX_OCCLUDERS: u32 = 8;

const _: () = assert!(PELAGE_MAX_OCCLUDERS as usize == crate::MAX_OCCLUDERS);

/// A shadow map of the host's, by which its opaque scene shadows the hair from one light. Of several maps for one light the
/// first decides in whose clip space a point lies; what lies in none is lit.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanOccluder {
    /// `sizeof(PelageVulkanOccluder)`.
    pub struct_size: u32,
    /// The light's place in the frame.
    pub light: u32,
    /// The depth of the opaque scene as the light sees it, with `VK_IMAGE_USAGE_SAMPLED_BIT`. Not NULL.
    pub depth: *const PelageVulkanImage,
    /// The clip space of that depth from world space, column-major. Can be inverted.
    pub clip_from_world: [f64; 16],
    /// `PELAGE_VIEW_REVERSE_Z` or `PELAGE_VIEW_FLIP_Y`, both, or 0.
    pub flags: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// How far a point is moved towards the light before it is compared, in host units, at least 0.
    pub bias: f32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageVulkanOccluder {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            light: 0,
            depth: null(),
            clip_from_world: DMat4::IDENTITY.to_cols_array(),
            flags: 0,
            pcf: 3,
            bias: 0.0,
            reserved: 0,
        }
    }
}

descriptor!(PelageVulkanOccluder, "PELAGE_VULKAN_OCCLUDER_INIT", reserved: u32);

/// An image of the hair's shadow from one light on the host's opaque scene, for the host's own lighting: each pixel of the
/// view's rectangle holds the part of the light, 0 to 1, that the hair lets through to the point that the view's depth stands
/// for; 1 at the far plane.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanShadowImage {
    /// `sizeof(PelageVulkanShadowImage)`.
    pub struct_size: u32,
    /// The light's place in the frame.
    pub light: u32,
    /// Of the colour's size, with `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`: `VK_FORMAT_R32_SFLOAT`, `VK_FORMAT_R16_SFLOAT`,
    /// `VK_FORMAT_R8_UNORM`, `VK_FORMAT_R16G16B16A16_SFLOAT` or `VK_FORMAT_R8G8B8A8_UNORM`. Not NULL.
    pub image: *const PelageVulkanImage,
}

impl Default for PelageVulkanShadowImage {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            light: 0,
            image: null(),
        }
    }
}

descriptor!(
    PelageVulkanShadowImage,
    "PELAGE_VULKAN_SHADOW_IMAGE_INIT",
    image: *const PelageVulkanImage
);

/// One view of a submission: a frame, and the images that it goes into.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanView {
    /// `sizeof(PelageVulkanView)`.
    pub struct_size: u32,
    /// Any of `PELAGE_RENDER_...`, or 0.
    pub flags: u32,
    /// What is drawn. Not NULL.
    pub frame: *const PelageFrame,
    /// Hair is blended over what it holds, premultiplied. Not NULL.
    pub colour: *const PelageVulkanImage,
    /// The opaque scene's depth, of the colour's size: it hides hair. NULL for none.
    pub depth: *const PelageVulkanImage,
    /// What else is written, as `PELAGE_OUTPUT_...` of a target; each NULL for none. All are of the colour's size, with
    /// `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`, and keep what they hold outside the view's rectangle: only a view that fills
    /// them takes `VK_IMAGE_LAYOUT_UNDEFINED`.
    ///
    /// The nearest fibre's depth: `VK_FORMAT_R32_SFLOAT`.
    pub nearest_depth: *const PelageVulkanImage,
    /// The part of the pixel that hair covers: `VK_FORMAT_R32_SFLOAT`, `VK_FORMAT_R16_SFLOAT` or `VK_FORMAT_R8_UNORM`.
    pub coverage: *const PelageVulkanImage,
    /// Motion on the screen: `VK_FORMAT_R32G32_SFLOAT` or `VK_FORMAT_R16G16_SFLOAT`.
    pub motion: *const PelageVulkanImage,
    /// Hair, instance and strand: `VK_FORMAT_R32G32_UINT`.
    pub ids: *const PelageVulkanImage,
    /// The host's shadow maps.
    pub occluders: *const PelageVulkanOccluder,
    /// Images of the hair's shadow on the opaque scene; they need a depth.
    pub shadow_images: *const PelageVulkanShadowImage,
    /// The number of shadow maps, at most `PELAGE_MAX_OCCLUDERS`.
    pub occluder_count: u32,
    /// The number of images, at most `PELAGE_MAX_LIGHTS`.
    pub shadow_image_count: u32,
}

impl Default for PelageVulkanView {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            flags: 0,
            frame: null(),
            colour: null(),
            depth: null(),
            nearest_depth: null(),
            coverage: null(),
            motion: null(),
            ids: null(),
            occluders: null(),
            shadow_images: null(),
            occluder_count: 0,
            shadow_image_count: 0,
        }
    }
}

descriptor!(
    PelageVulkanView,
    "PELAGE_VULKAN_VIEW_INIT",
    shadow_image_count: u32,
    since ids: *const PelageVulkanImage
);

/// A binary semaphore.
pub const PELAGE_VULKAN_SEMAPHORE_BINARY: u32 = 0;
/// A timeline semaphore.
pub const PELAGE_VULKAN_SEMAPHORE_TIMELINE: u32 = 1;

/// A semaphore to wait on, or to signal.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanSemaphore {
    /// `sizeof(PelageVulkanSemaphore)`.
    pub struct_size: u32,
    /// `PELAGE_VULKAN_SEMAPHORE_...`, as it was made.
    pub kind: u32,
    /// `VkSemaphore`.
    pub semaphore: PelageVkSemaphore,
    /// The value of a timeline semaphore; 0 for a binary one.
    pub value: u64,
}

impl Default for PelageVulkanSemaphore {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            kind: PELAGE_VULKAN_SEMAPHORE_BINARY,
            semaphore: 0,
            value: 0,
        }
    }
}

descriptor!(PelageVulkanSemaphore, "PELAGE_VULKAN_SEMAPHORE_INIT", value: u64);

/// The most views of one submission.
pub const PELAGE_VULKAN_MAX_VIEWS: u32 = 8;
/// The most semaphores to wait on, and the most to signal.
pub const PELAGE_VULKAN_MAX_SEMAPHORES: u32 = 64;

const _: () = assert!(PELAGE_VULKAN_MAX_VIEWS as usize == MAX_VIEWS);

/// One submission to the host's queue. Read during the call only.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanSubmit {
    /// `sizeof(PelageVulkanSubmit)`.
    pub struct_size: u32,
    /// The number of views, at most `PELAGE_VULKAN_MAX_VIEWS`; 0 for a submission of semaphores alone.
    pub view_count: u32,
    /// The views, drawn one after another. Where one layer and level of an image is in several, a view finds it in the layout
    /// in which the one before has left it, and with that owner.
    pub views: *const PelageVulkanView,
    /// The semaphores that the submission waits on, before any of its commands.
    pub waits: *const PelageVulkanSemaphore,
    /// The semaphores that it signals, after all of its commands.
    pub signals: *const PelageVulkanSemaphore,
    /// The number of semaphores to wait on, at most `PELAGE_VULKAN_MAX_SEMAPHORES`.
    pub wait_count: u32,
    /// The number of semaphores to signal, likewise.
    pub signal_count: u32,
}

impl Default for PelageVulkanSubmit {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            view_count: 0,
            views: null(),
            waits: null(),
            signals: null(),
            wait_count: 0,
            signal_count: 0,
        }
    }
}

descriptor!(PelageVulkanSubmit, "PELAGE_VULKAN_SUBMIT_INIT", signal_count: u32);

/// Records views of hair into the host's images and submits them to the host's queue, all at once. Does not wait for the
/// GPU, unless more than `PELAGE_VULKAN_MAX_VIEWS` views of the context are on their way.
///
/// In the queue's order a full barrier stands before the commands of each view and after them: what the host submits to the
/// same queue before or after needs no semaphore. Images stay valid until the GPU is done with the submission.
///
/// Do not hold what `lock` locks. Wait for what has been submitted already, or is signalled by another thread: drivers may
/// block within `vkQueueSubmit` as long as an earlier submission cannot begin.
///
/// Errors: an image that cannot be drawn into; all of `pelage_render`'s; a context with a device of its own
/// (`PELAGE_UNSUPPORTED`). Nothing is then submitted, and no semaphore waited on or signalled. `PELAGE_DEVICE_LOST`, or
/// `PELAGE_OUT_OF_MEMORY` from the driver at the submission: the context is dead; destroy it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_vulkan_render(
    context: PelageContext,
    submit: *const PelageVulkanSubmit,
) -> PelageResult {
    guard(|| {
        context.check()?;
        // SAFETY: the rule of the module `capi`.
        let (views, waits, signals) = unsafe {
            let given = descriptor::read("submit", submit)?;
            (
                read_views(given.views, given.view_count)?,
                read_semaphores("waits", given.waits, given.wait_count)?,
                read_semaphores("signals", given.signals, given.signal_count)?,
            )
        };
        context.with(|State { host, hairs, .. }| {
            let vulkan = host.vulkan()?;
            let drawn: Vec<Vec<&Hair>> = views
                .iter()
                .map(|view| view.frame.hairs(hairs))
                .collect::<Result<_>>()?;
            let frames: Vec<_> = views
                .iter()
                .zip(&drawn)
                .map(|(view, hairs)| view.frame.frame(hairs))
                .collect();
            let views: Vec<_> = views
                .iter()
                .zip(&frames)
                .map(|(view, frame)| View {
                    frame,
                    colour: &view.colour,
                    depth: view.depth.as_ref(),
                    clear: view.flags & PELAGE_RENDER_CLEAR != 0,
                    write_depth: view.flags & PELAGE_RENDER_WRITE_DEPTH != 0,
                    receive_shadow: view.flags & PELAGE_RENDER_RECEIVE_SHADOW != 0,
                    rectangle: view.frame.rectangle,
                    outputs: view.outputs(),
                    occluders: &view.occluders,
                    shadow_images: &view.shadow_images,
                    shadows_only: view.flags & PELAGE_RENDER_SHADOWS_ONLY != 0,
                })
                .collect();
            // SAFETY: images and semaphores are what the host says they are, and it keeps them until the GPU is done.
            unsafe { vulkan.render(&views, &waits, &signals) }
        })
    })
}

/// A view in the crate's own types.
struct GivenView<'a> {
    frame: GivenFrame<'a>,
    colour: Image,
    depth: Option<Image>,
    /// Nearest depth, coverage, motion and ids.
    outputs: [Option<Image>; 4],
    occluders: Vec<ViewOccluder>,
    shadow_images: Vec<(usize, Image)>,
    flags: u32,
}

impl GivenView<'_> {
    fn outputs(&self) -> ViewOutputs<'_> {
        let [nearest_depth, coverage, motion, ids] = self.outputs.each_ref().map(Option::as_ref);
        ViewOutputs {
            nearest_depth,
            coverage,
            motion,
            ids,
        }
    }
}

unsafe fn read_views<'a>(
    pointer: *const PelageVulkanView,
    count: u32,
) -> Result<Vec<GivenView<'a>>> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read_array("views", pointer, count, MAX_VIEWS) }?;
    let read = |(at, given): (usize, &PelageVulkanView)| {
        let name = |what: &str| format!("views[{at}]: {what}");
        let all = ALL_FLAGS | PELAGE_RENDER_SHADOWS_ONLY;
        let flags = flags(&name("flags"), given.flags, all)?;
        let optional = |what: &str, pointer| -> Result<Option<Image>> {
            // SAFETY: as above.
            let read = unsafe { descriptor::read_optional(&name(what), pointer) }?;
            Ok(read.as_ref().map(image))
        };
        // SAFETY: as above.
        unsafe {
            Ok(GivenView {
                frame: GivenFrame::read(given.frame)?,
                colour: image(&descriptor::read(&name("colour"), given.colour)?),
                depth: optional("depth", given.depth)?,
                outputs: [
                    optional("nearest_depth", given.nearest_depth)?,
                    optional("coverage", given.coverage)?,
                    optional("motion", given.motion)?,
                    optional("ids", given.ids)?,
                ],
                occluders: read_occluders(&name("occluders"), given)?,
                shadow_images: read_shadow_images(&name("shadow_images"), given)?,
                flags,
            })
        }
    };
    given.iter().enumerate().map(read).collect()
}

unsafe fn read_occluders(name: &str, view: &PelageVulkanView) -> Result<Vec<ViewOccluder>> {
    let most = crate::MAX_OCCLUDERS;
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read_array(name, view.occluders, view.occluder_count, most) }?;
    let read = |(at, given): (usize, &PelageVulkanOccluder)| {
        reserved("PelageVulkanOccluder", given.reserved)?;
        let all = PELAGE_VIEW_REVERSE_Z | PELAGE_VIEW_FLIP_Y;
        let flags = flags(&format!("{name}[{at}]: flags"), given.flags, all)?;
        // SAFETY: as above.
        let depth = unsafe { descriptor::read(&format!("{name}[{at}]: depth"), given.depth) }?;
        Ok(ViewOccluder {
            light: given.light as usize,
            depth: image(&depth),
            clip_from_world: DMat4::from_cols_array(&given.clip_from_world),
            reverse_z: flags & PELAGE_VIEW_REVERSE_Z != 0,
            flip_y: flags & PELAGE_VIEW_FLIP_Y != 0,
            bias: given.bias,
            pcf: given.pcf,
        })
    };
    given.iter().enumerate().map(read).collect()
}

unsafe fn read_shadow_images(name: &str, view: &PelageVulkanView) -> Result<Vec<(usize, Image)>> {
    let (pointer, count) = (view.shadow_images, view.shadow_image_count);
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read_array(name, pointer, count, crate::MAX_LIGHTS) }?;
    let read = |(at, given): (usize, &PelageVulkanShadowImage)| {
        // SAFETY: as above.
        let read = unsafe { descriptor::read(&format!("{name}[{at}]: image"), given.image) }?;
        Ok((given.light as usize, image(&read)))
    };
    given.iter().enumerate().map(read).collect()
}

fn image(given: &PelageVulkanImage) -> Image {
    Image {
        image: vk::Image::from_raw(given.image),
        format: vk::Format::from_raw(given.format as i32),
        extent: vk::Extent2D {
            width: given.width,
            height: given.height,
        },
        usage: vk::ImageUsageFlags::from_raw(given.usage),
        samples: vk::SampleCountFlags::from_raw(given.samples),
        layout_in: vk::ImageLayout::from_raw(given.layout_in as i32),
        layout_out: vk::ImageLayout::from_raw(given.layout_out as i32),
        array_layers: given.array_layers,
        mip_levels: given.mip_levels,
        subresource: Subresource {
            layer: given.layer,
            mip_level: given.mip_level,
        },
        owner_before: owner(given.owner_before),
        owner_after: owner(given.owner_after),
    }
}

unsafe fn read_semaphores(
    name: &str,
    pointer: *const PelageVulkanSemaphore,
    count: u32,
) -> Result<Vec<Semaphore>> {
    let most = PELAGE_VULKAN_MAX_SEMAPHORES as usize;
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read_array(name, pointer, count, most) }?;
    let read = |(at, given): (usize, &PelageVulkanSemaphore)| {
        let value = match given.kind {
            PELAGE_VULKAN_SEMAPHORE_TIMELINE => Some(given.value),
            PELAGE_VULKAN_SEMAPHORE_BINARY if given.value == 0 => None,
            PELAGE_VULKAN_SEMAPHORE_BINARY => {
                return invalid!(
                    "{name}[{at}]: value {} for a binary semaphore; it has none",
                    given.value
                );
            }
            kind => {
                return invalid!(
                    "{name}[{at}]: kind {kind} is not one of PELAGE_VULKAN_SEMAPHORE_…"
                );
            }
        };
        Ok(Semaphore {
            semaphore: vk::Semaphore::from_raw(given.semaphore),
            value,
        })
    };
    given.iter().enumerate().map(read).collect()
}
