//! The host's own Vulkan device: what it must be made with, contexts on it, and frames into the host's images.

use std::ffi::{CStr, c_char, c_void};
use std::mem::size_of;
use std::ptr::{null, null_mut};
use std::sync::Arc;

use ash::vk;
use ash::vk::Handle;
use glam::DMat4;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::frame::{GivenFrame, PELAGE_VIEW_FLIP_Y, PELAGE_VIEW_REVERSE_Z, PelageFrame};
use super::input::{flag, flags, output, reserved};
use super::registry::{Host, PelageContext, PelageHair, State};
use super::render::{
    ALL_FLAGS, PELAGE_RENDER_CLEAR, PELAGE_RENDER_RECEIVE_SHADOW, PELAGE_RENDER_SHADOWS_ONLY,
    PELAGE_RENDER_WRITE_DEPTH,
};
use crate::error::{Result, invalid};
use crate::geometry::Hair;
use crate::host::vulkan::{
    DeviceDescriptor, FEATURE_STORAGE, HostInstance, Image, MAX_VIEWS, Points, QueueLock,
    Semaphore, View, ViewOccluder, ViewOutputs, Vulkan, requirements,
};

// The header defines these by itself, typed where it is told to include <vulkan/vulkan.h>: see cbindgen.toml.
/// `VkInstance`.
pub type PelageVkInstance = *mut c_void;
/// `VkPhysicalDevice`.
pub type PelageVkPhysicalDevice = *mut c_void;
/// `VkDevice`.
pub type PelageVkDevice = *mut c_void;
/// `VkImage`.
pub type PelageVkImage = u64;
/// `VkBuffer`.
pub type PelageVkBuffer = u64;
/// `VkSemaphore`.
pub type PelageVkSemaphore = u64;
/// `VkPhysicalDeviceFeatures2`.
pub type PelageVkFeatures = c_void;
/// `PFN_vkGetInstanceProcAddr`.
pub type PelageVkGetInstanceProcAddr = Option<
    unsafe extern "system" fn(
        instance: *mut c_void,
        name: *const c_char,
    ) -> Option<unsafe extern "system" fn()>,
>;

/// The host's instance of Vulkan.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanInstance {
    /// `sizeof(PelageVulkanInstance)`.
    pub struct_size: u32,
    /// The `apiVersion` of the `VkApplicationInfo` that it was made with: `VK_API_VERSION_1_3` or newer. No extension of
    /// the instance is needed.
    pub api_version: u32,
    /// `VkInstance`.
    pub instance: PelageVkInstance,
    /// `vkGetInstanceProcAddr`: every function of Vulkan is asked of it.
    pub get_instance_proc_addr: PelageVkGetInstanceProcAddr,
    /// 1: the instance was made with `VK_EXT_debug_utils`, and passes shall bear their labels in GPU debuggers.
    pub debug_utils: u32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageVulkanInstance {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            api_version: 0,
            instance: null_mut(),
            get_instance_proc_addr: None,
            debug_utils: 0,
            reserved: 0,
        }
    }
}

descriptor!(PelageVulkanInstance, "PELAGE_VULKAN_INSTANCE_INIT", reserved: u32);

/// The most extensions that are required of a device.
pub const PELAGE_VULKAN_MAX_EXTENSIONS: usize = 8;
/// Words in which appended structs of features live.
pub const PELAGE_VULKAN_FEATURE_STORAGE: usize = 128;

const _: () = assert!(PELAGE_VULKAN_FEATURE_STORAGE == FEATURE_STORAGE);

/// What a device must be made with. It holds structs that `features` points to: do not copy or move it before the device
/// has been made.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanRequirements {
    /// `sizeof(PelageVulkanRequirements)`.
    pub struct_size: u32,
    /// `VkQueueFlags` that the family of the queue must have: graphics and compute.
    pub queue_flags: u32,
    /// Given: the host's own features, a `VkPhysicalDeviceFeatures2` with its chain, or NULL for none. Set: the same, to be
    /// put into `VkDeviceCreateInfo.pNext` (with `pEnabledFeatures` NULL); what pelage requires has been set in the host's
    /// structs, and what they have no place for appended to their chain. What the host has set is kept.
    pub features: *mut PelageVkFeatures,
    /// Extensions that the device must be made with beside the host's own: `device_extension_count` names, valid for ever.
    pub device_extensions: [*const c_char; PELAGE_VULKAN_MAX_EXTENSIONS],
    /// How many there are.
    pub device_extension_count: u32,
    /// 0.
    pub reserved: u32,
    /// Where what is appended lives.
    pub storage: [u64; PELAGE_VULKAN_FEATURE_STORAGE],
}

impl Default for PelageVulkanRequirements {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            queue_flags: 0,
            features: null_mut(),
            device_extensions: [null(); PELAGE_VULKAN_MAX_EXTENSIONS],
            device_extension_count: 0,
            reserved: 0,
            storage: [0; PELAGE_VULKAN_FEATURE_STORAGE],
        }
    }
}

descriptor!(
    PelageVulkanRequirements,
    "PELAGE_VULKAN_REQUIREMENTS_INIT",
    storage: [u64; PELAGE_VULKAN_FEATURE_STORAGE]
);

/// Says whether pelage runs on a physical device, and what a `VkDevice` of it must be made with. Call it before the device
/// is made, with `*requirements` begun with `PELAGE_VULKAN_REQUIREMENTS_INIT` and its `features` set to the host's own.
///
/// `PELAGE_OK` is the yes. `PELAGE_UNSUPPORTED` is the no, and `pelage_last_error` the reason.
///
/// Errors: a handle that is NULL or does not belong to the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_vulkan_requirements(
    instance: *const PelageVulkanInstance,
    physical_device: PelageVkPhysicalDevice,
    requirements: *mut PelageVulkanRequirements,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let host = unsafe { read_instance("instance", instance) }?;
        // SAFETY: as above.
        let given = unsafe { descriptor::read("requirements", requirements) }?;
        // SAFETY: as above. The struct that has been read is written as a whole.
        let out = unsafe { output("requirements", requirements) }?;
        let chain = given.features.cast::<vk::PhysicalDeviceFeatures2>();
        // SAFETY: the host's chain, if it has one, begins with a struct of Vulkan.
        if let Some(first) = unsafe { chain.as_ref() }
            && first.s_type != vk::StructureType::PHYSICAL_DEVICE_FEATURES_2
        {
            return invalid!(
                "features points to a struct of sType {}, not to a VkPhysicalDeviceFeatures2",
                first.s_type.as_raw()
            );
        }
        let physical_device = vk::PhysicalDevice::from_raw(physical_device as u64);
        // SAFETY: as above.
        let required = unsafe { self::requirements(&host, physical_device) }?;
        let out = out.as_mut_ptr();
        // SAFETY: the chain is valid, and the storage is the host's, which stays where it is.
        let features = unsafe { required.merge(chain, &raw mut (*out).storage) }?;
        let mut names = [null(); PELAGE_VULKAN_MAX_EXTENSIONS];
        names
            .iter_mut()
            .zip(&required.extensions)
            .for_each(|(to, from)| *to = from.as_ptr());
        // SAFETY: the host has room for the struct.
        unsafe {
            (*out).queue_flags = required.queue_flags.as_raw();
            (*out).features = features.cast();
            (*out).device_extensions = names;
            (*out).device_extension_count = required.extensions.len() as u32;
        }
        Ok(())
    })
}

unsafe fn read_instance(name: &str, pointer: *const PelageVulkanInstance) -> Result<HostInstance> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read(name, pointer) }?;
    reserved("PelageVulkanInstance", given.reserved)?;
    let Some(function) = given.get_instance_proc_addr else {
        return invalid!("{name}: get_instance_proc_addr is NULL");
    };
    // SAFETY: both are Vulkan's type of that function; `VkInstance` is a pointer.
    let get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr =
        unsafe { std::mem::transmute(function) };
    Ok(HostInstance {
        get_instance_proc_addr,
        instance: vk::Instance::from_raw(given.instance as u64),
        api_version: given.api_version,
        debug_utils: flag("debug_utils", given.debug_utils)?,
    })
}

/// Locks the host's queue, or unlocks it; `user` is what was given with the callback. It must return: no exception, no
/// longjmp. It must not call the library.
pub type PelageVulkanLockCallback = Option<unsafe extern "C" fn(user: *mut c_void)>;

/// The host's device, and the queue that pelage submits to.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanDevice {
    /// `sizeof(PelageVulkanDevice)`.
    pub struct_size: u32,
    /// The family of the queue; the images' own family too.
    pub queue_family: u32,
    /// The queue's number within its family, as `vkGetDeviceQueue` takes it.
    pub queue_index: u32,
    /// The number of extensions.
    pub extension_count: u32,
    /// The extensions that the device was made with: those that were required, at least.
    pub extensions: *const *const c_char,
    /// The instance. Not NULL.
    pub instance: *const PelageVulkanInstance,
    /// `VkPhysicalDevice`, one of the instance's.
    pub physical_device: PelageVkPhysicalDevice,
    /// `VkDevice`, made with what `pelage_vulkan_requirements` has said.
    pub device: PelageVkDevice,
    /// Called before the queue is used, on the thread that called the library, by `pelage_vulkan_render` and
    /// `pelage_context_destroy` alone. NULL where no other thread uses the queue at the same time.
    pub lock: PelageVulkanLockCallback,
    /// Called after it. NULL if `lock` is.
    pub unlock: PelageVulkanLockCallback,
    /// Given to both.
    pub lock_user: *mut c_void,
    /// Bytes of GPU memory that the context may take; 0 for no limit.
    pub byte_budget: u64,
}

impl Default for PelageVulkanDevice {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            queue_family: 0,
            queue_index: 0,
            extension_count: 0,
            extensions: null(),
            instance: null(),
            physical_device: null_mut(),
            device: null_mut(),
            lock: None,
            unlock: None,
            lock_user: null_mut(),
            byte_budget: 0,
        }
    }
}

descriptor!(PelageVulkanDevice, "PELAGE_VULKAN_DEVICE_INIT", byte_budget: u64);

/// The host's callbacks around its queue.
struct Lock {
    lock: unsafe extern "C" fn(*mut c_void),
    unlock: unsafe extern "C" fn(*mut c_void),
    user: *mut c_void,
}

// SAFETY: the host promises that its callbacks may be called, with its pointer, on any thread.
unsafe impl Send for Lock {}
// SAFETY: as above.
unsafe impl Sync for Lock {}

impl QueueLock for Lock {
    fn lock(&self) {
        // SAFETY: the host keeps its callbacks callable until the context is destroyed.
        unsafe { (self.lock)(self.user) };
    }

    fn unlock(&self) {
        // SAFETY: as above.
        unsafe { (self.unlock)(self.user) };
    }
}

/// Makes a context on the host's device, which `*context` receives. All functions but those of targets, readbacks and
/// `pelage_render` serve it; `pelage_vulkan_render` draws. Several contexts may share a device and a queue.
///
/// The host keeps the instance and the device until the context has been destroyed. Nothing of the host's is destroyed.
///
/// Errors: a handle that is NULL or does not belong to the others; a queue that is not there; an extension that is required
/// and missing; a device that falls short (`PELAGE_UNSUPPORTED`); no memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_vulkan_context_create(
    device: *const PelageVulkanDevice,
    context: *mut PelageContext,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let (given, context) = unsafe {
            (
                descriptor::read("device", device)?,
                output("context", context)?,
            )
        };
        let lock: Option<Arc<dyn QueueLock>> = match (given.lock, given.unlock) {
            (Some(lock), Some(unlock)) => Some(Arc::new(Lock {
                lock,
                unlock,
                user: given.lock_user,
            })),
            (None, None) => None,
            _ => return invalid!("lock and unlock are given both or neither"),
        };
        // SAFETY: the rule of the module `capi`.
        let (instance, extensions) = unsafe {
            (
                read_instance("instance", given.instance)?,
                read_names(given.extensions, given.extension_count)?,
            )
        };
        let descriptor = DeviceDescriptor {
            instance,
            physical_device: vk::PhysicalDevice::from_raw(given.physical_device as u64),
            device: vk::Device::from_raw(given.device as u64),
            queue_family: given.queue_family,
            queue_index: given.queue_index,
            extensions: &extensions,
            lock,
        };
        // SAFETY: the handles are what the host says they are; it keeps them until the context has been destroyed.
        let mut vulkan = unsafe { Vulkan::new(&descriptor) }?;
        vulkan.with_renderer(|renderer| {
            renderer.set_byte_budget((given.byte_budget > 0).then_some(given.byte_budget));
            Ok(())
        })?;
        context.write(PelageContext::register(Host::Vulkan(Box::new(vulkan))));
        Ok(())
    })
}

/// The names of extensions, in the host's memory.
unsafe fn read_names<'a>(names: *const *const c_char, count: u32) -> Result<Vec<&'a CStr>> {
    const MOST: u32 = 4096;
    if count > MOST {
        return invalid!("{count} extensions: at most {MOST} are taken");
    }
    if count > 0 && (names.is_null() || !names.is_aligned()) {
        return invalid!("extensions is {names:p}, but {count} are announced");
    }
    let read = |at: usize| {
        // SAFETY: the host's array has `count` pointers.
        let name = unsafe { *names.add(at) };
        if name.is_null() {
            return invalid!("extensions[{at}] is NULL");
        }
        // SAFETY: the rule of the module `capi`: a string that ends with a NUL.
        Ok(unsafe { CStr::from_ptr(name) })
    };
    (0..count as usize).map(read).collect()
}

/// An image of the host's: 2D, of which the first layer and the first mip level are used.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanImage {
    /// `sizeof(PelageVulkanImage)`.
    pub struct_size: u32,
    /// `VkFormat`, as the image was made.
    pub format: u32,
    /// `VkImage`.
    pub image: PelageVkImage,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
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
        }
    }
}

descriptor!(PelageVulkanImage, "PELAGE_VULKAN_IMAGE_INIT", layout_out: u32);

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

/// Positions in a buffer of the host's: three 32-bit floats a point, in the groom's own space, strand after strand, root first.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageVulkanPoints {
    /// `sizeof(PelageVulkanPoints)`.
    pub struct_size: u32,
    /// `VkBufferUsageFlags`, as the buffer was made: with `VK_BUFFER_USAGE_STORAGE_BUFFER_BIT`.
    pub usage: u32,
    /// `VkBuffer`, bound to memory.
    pub buffer: PelageVkBuffer,
    /// Its size in bytes, as it was made.
    pub size: u64,
    /// Bytes before the first position, a multiple of 4.
    pub offset: u64,
    /// Bytes from one position to the next: a multiple of 4, at least 12.
    pub stride: u64,
    /// The lowest corner of a box around all points, and the curves through them, in the groom's own space. What lies outside
    /// the box is drawn, but its shadow may be cut off.
    pub low: [f64; 3],
    /// The highest corner.
    pub high: [f64; 3],
}

impl Default for PelageVulkanPoints {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            usage: 0,
            buffer: 0,
            size: 0,
            offset: 0,
            stride: 12,
            low: [0.0; 3],
            high: [0.0; 3],
        }
    }
}

descriptor!(PelageVulkanPoints, "PELAGE_VULKAN_POINTS_INIT", high: [f64; 3]);

/// Moves a hair on the host's Vulkan device by positions in a buffer of the host's, in the host's order of strands. The next
/// `pelage_vulkan_render` of the context that succeeds reads them, before its views and after the semaphores that it waits
/// on; one of no views does too. Several updates of a hair happen in turn.
///
/// In the queue's order a full barrier stands before the buffer is read and after: what the host submits to the same queue to
/// fill it, before or after, needs no semaphore. The buffer belongs to the queue's family (or is `CONCURRENT`), and it and its
/// memory stay valid until the GPU is done with that submission, or the context has been destroyed. It is never destroyed.
///
/// A position that is not finite leaves its point where it was. `pelage_hair_points` is not told of the new positions.
///
/// Errors: a buffer that is NULL, too small or without its usage; an offset, stride or box out of range; no memory; a context
/// with a device of its own (`PELAGE_UNSUPPORTED`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_vulkan_update_points(
    hair: PelageHair,
    points: *const PelageVulkanPoints,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe { update(hair, points, false) })
}

/// As `pelage_vulkan_update_points`, for the guides of a hair that remembers them: all strands follow. The box is that of the
/// guides; what stands out from them is added, as long as guides keep their length.
///
/// Errors: those; a hair that was not made by `pelage_hair_create_guided_...`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_vulkan_update_guides(
    hair: PelageHair,
    points: *const PelageVulkanPoints,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe { update(hair, points, true) })
}

unsafe fn update(hair: PelageHair, points: *const PelageVulkanPoints, guides: bool) -> Result<()> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read("points", points) }?;
    let source = Points {
        buffer: vk::Buffer::from_raw(given.buffer),
        size: given.size,
        usage: vk::BufferUsageFlags::from_raw(given.usage),
        offset: given.offset,
        stride: given.stride,
        bounds: [given.low.into(), given.high.into()],
    };
    hair.with(|hair, host| {
        // SAFETY: the buffer is what the host says it is, and it keeps it until the GPU is done.
        unsafe { host.vulkan()?.update_from(hair, &source, guides) }
    })
}

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
    /// The views, drawn one after another. Where one image is in several, a view finds it in the layout in which the one
    /// before has left it.
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
