//! Positions in the host's buffers.

use ash::vk;
use glam::DVec3;

use super::barrier::Families;
use crate::error::{Error, Result, invalid};

type Hal = wgpu::hal::api::Vulkan;

/// Positions in a buffer of the host's, as [`crate::PointSource`] has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Points {
    /// The host's.
    pub buffer: vk::Buffer,
    /// Its size in bytes, as it was made.
    pub size: u64,
    /// As it was made: `STORAGE_BUFFER` at least.
    pub usage: vk::BufferUsageFlags,
    /// Bytes before the first position, a multiple of 4.
    pub offset: u64,
    /// Bytes from one position to the next: a multiple of 4, at least 12.
    pub stride: u64,
    /// As of [`crate::PointSource::bounds`].
    pub bounds: [DVec3; 2],
    /// The family of queues from which the whole buffer is acquired before it is read, as of [`super::Image::owner_before`].
    pub owner_before: Option<u32>,
    /// The family to which it is released afterwards.
    pub owner_after: Option<u32>,
}

impl Points {
    pub(super) fn validate(&self, families: &Families) -> Result<()> {
        if self.buffer == vk::Buffer::null() {
            return invalid!("the buffer is NULL");
        }
        if self.size == 0 {
            return invalid!("size 0: a buffer has at least one byte");
        }
        if !self.usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) {
            return invalid!("the buffer's usage lacks VK_BUFFER_USAGE_STORAGE_BUFFER_BIT");
        }
        families.validate("the buffer", "owner_before", self.owner_before)?;
        families.validate("the buffer", "owner_after", self.owner_after)
    }

    /// Our half of the transfer by which the buffer changes hands; `None` where it stays where it is.
    pub(super) fn owner_barrier(
        &self,
        families: &Families,
        towards_us: bool,
    ) -> Option<vk::BufferMemoryBarrier<'static>> {
        let owner = if towards_us {
            self.owner_before
        } else {
            self.owner_after
        };
        let transfer = families.transfer(owner, towards_us)?;
        Some(
            vk::BufferMemoryBarrier::default()
                .buffer(self.buffer)
                .size(vk::WHOLE_SIZE)
                .src_queue_family_index(transfer.from)
                .dst_queue_family_index(transfer.to)
                .src_access_mask(transfer.src_access)
                .dst_access_mask(transfer.dst_access),
        )
    }

    /// The buffer as wgpu sees it, which never destroys it.
    ///
    /// # Safety
    /// The buffer is what it is said to be, and outlives its use on the GPU.
    pub(super) unsafe fn wrap(&self, device: &wgpu::Device) -> Result<wgpu::Buffer> {
        // A drop callback: wgpu leaves buffer and memory alone.
        // SAFETY: the buffer lives for as long as it is used, by the host's promise.
        let raw = unsafe {
            wgpu::hal::vulkan::Buffer::from_raw_externally_owned(self.buffer, Box::new(|| ()))
        };
        let descriptor = wgpu::BufferDescriptor {
            label: None,
            size: self.size / 4 * 4,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        };
        if descriptor.size == 0 {
            return Err(Error::InvalidValue(format!(
                "size {}: a position takes 12 bytes",
                self.size
            )));
        }
        // SAFETY: a buffer of this device with that usage and at least that size, which is not 0; the host has filled what
        // will be read.
        Ok(unsafe { device.create_buffer_from_hal::<Hal>(raw, &descriptor) })
    }
}
