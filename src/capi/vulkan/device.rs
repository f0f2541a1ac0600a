//! What the host's device must be made with, and contexts on it.

use std::ffi::{CStr, c_char, c_void};
use std::mem::size_of;
use std::ptr::{null, null_mut};
use std::sync::Arc;

use ash::vk;
use ash::vk::Handle;

use super::super::descriptor::{self, descriptor};
use super::super::error::{PelageResult, guard};
use super::super::input::{flag, output, reserved};
use super::super::registry::{Host, PelageContext};
use super::{
    PelageVkDevice, PelageVkFeatures, PelageVkGetInstanceProcAddr, PelageVkInstance,
    PelageVkPhysicalDevice,
};
use crate::error::{Result, invalid};
use crate::host::vulkan::{
    DeviceDescriptor, FEATURE_STORAGE, HostInstance, QueueLock, Vulkan, requirements,
};

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
    /// The family of the queue.
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
