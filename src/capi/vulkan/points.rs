//! Hair that moves by the host's buffers.

use std::mem::size_of;

use ash::vk;
use ash::vk::Handle;

use super::super::descriptor::{self, descriptor};
use super::super::error::{PelageResult, guard};
use super::super::registry::PelageHair;
use super::{PELAGE_VULKAN_QUEUE_FAMILY_IGNORED, PelageVkBuffer, owner};
use crate::error::Result;
use crate::host::vulkan::Points;

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
    /// The family of queues from which the whole buffer is acquired before it is read, as `PelageVulkanImage` has it: the
    /// host has released it there, with offset 0 and `VK_WHOLE_SIZE`.
    pub owner_before: u32,
    /// The family to which it is released afterwards.
    pub owner_after: u32,
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
            owner_before: PELAGE_VULKAN_QUEUE_FAMILY_IGNORED,
            owner_after: PELAGE_VULKAN_QUEUE_FAMILY_IGNORED,
        }
    }
}

descriptor!(PelageVulkanPoints, "PELAGE_VULKAN_POINTS_INIT", owner_after: u32);

/// Moves a hair on the host's Vulkan device by positions in a buffer of the host's, in the host's order of strands. The next
/// `pelage_vulkan_render` of the context that succeeds reads them, before its views and after the semaphores that it waits
/// on; one of no views does too. Several updates of a hair happen in turn.
///
/// In the queue's order a full barrier stands before the buffer is read and after: what the host submits to the same queue to
/// fill it, before or after, needs no semaphore. The buffer belongs to the queue's family, is `CONCURRENT`, or changes hands by
/// `owner_before` and `owner_after`; where several updates read one buffer, the first acquires it and the last releases it. It
/// and its memory stay valid until the GPU is done with that submission, or the context has been destroyed. It is never
/// destroyed.
///
/// A position that is not finite leaves its point where it was. `pelage_hair_points` is not told of the new positions.
///
/// Errors: a buffer that is NULL, too small or without its usage; an offset, stride, box or family out of range; no memory; 16
/// updates of this hair that no submission has taken yet (`PELAGE_CONFLICT`); a context with a device of its own
/// (`PELAGE_UNSUPPORTED`).
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
        owner_before: owner(given.owner_before),
        owner_after: owner(given.owner_after),
    };
    hair.with(|hair, host| {
        // SAFETY: the buffer is what the host says it is, and it keeps it until the GPU is done.
        unsafe { host.vulkan()?.update_from(hair, &source, guides) }
    })
}
