//! The host's own Vulkan device: what it must be made with, contexts on it, and frames into the host's images.

use std::ffi::{c_char, c_void};

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

/// `VK_QUEUE_FAMILY_IGNORED`: nothing changes hands.
pub const PELAGE_VULKAN_QUEUE_FAMILY_IGNORED: u32 = 0xffff_ffff;

// In the header's order.
mod device;
mod render;

mod points;

pub use device::*;
pub use points::*;
pub use render::*;

/// A family of queues as the crate has it.
fn owner(family: u32) -> Option<u32> {
    (family != PELAGE_VULKAN_QUEUE_FAMILY_IGNORED).then_some(family)
}
