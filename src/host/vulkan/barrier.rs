//! Barriers between the host's commands and the library's, and the families of queues between which its images and buffers
//! change hands.

use ash::vk;

use crate::error::{Error, Result, invalid};

type Hal = wgpu::hal::api::Vulkan;

/// The families of queues of a device, as far as things can change hands between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Families {
    /// That of the context's queue.
    pub own: u32,
    /// How many the device has.
    pub count: u32,
    /// Whether it was made with `VK_EXT_queue_family_foreign`.
    pub foreign: bool,
}

/// Our half of a transfer: the families and accesses of its barrier.
pub(super) struct Transfer {
    pub from: u32,
    pub to: u32,
    pub src_access: vk::AccessFlags,
    pub dst_access: vk::AccessFlags,
}

impl Families {
    /// Checks the family that owns a thing before or after, as `which` says.
    pub fn validate(&self, name: &str, which: &str, owner: Option<u32>) -> Result<()> {
        match owner {
            None | Some(vk::QUEUE_FAMILY_EXTERNAL) => Ok(()),
            Some(vk::QUEUE_FAMILY_FOREIGN_EXT) if self.foreign => Ok(()),
            Some(vk::QUEUE_FAMILY_FOREIGN_EXT) => invalid!(
                "{name}: {which} is VK_QUEUE_FAMILY_FOREIGN_EXT, but VK_EXT_queue_family_foreign is not among the device's extensions"
            ),
            Some(family) if family < self.count => Ok(()),
            Some(family) => invalid!(
                "{name}: {which} {family} is not below {}, the number of the device's queue families",
                self.count
            ),
        }
    }

    /// An owner other than the queue's own family.
    pub fn other(&self, owner: Option<u32>) -> Option<u32> {
        owner.filter(|family| *family != self.own)
    }

    /// The half that acquires from an owner, or that releases to it; `None` where nothing changes hands.
    pub fn transfer(&self, owner: Option<u32>, towards_us: bool) -> Option<Transfer> {
        let owner = self.other(owner)?;
        let (reads_and_writes, none) = (
            vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE,
            vk::AccessFlags::empty(),
        );
        Some(if towards_us {
            Transfer {
                from: owner,
                to: self.own,
                src_access: none,
                dst_access: reads_and_writes,
            }
        } else {
            Transfer {
                from: self.own,
                to: owner,
                src_access: vk::AccessFlags::MEMORY_WRITE,
                dst_access: none,
            }
        })
    }
}

/// A full barrier, with these among it.
#[derive(Clone, Copy, Default)]
pub(super) struct Step<'a> {
    pub buffers: &'a [vk::BufferMemoryBarrier<'static>],
    pub images: &'a [vk::ImageMemoryBarrier<'static>],
}

/// A command buffer of full barriers, one after another.
///
/// # Safety
/// Images and buffers live, and are in the old layouts, and with the families that the barriers say, when the commands run.
pub(super) unsafe fn record(
    device: &wgpu::Device,
    raw: &ash::Device,
    steps: &[Step],
) -> Result<wgpu::CommandBuffer> {
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
        label: Some("pelage.vulkan.barrier"),
    });
    let memory = vk::MemoryBarrier::default()
        .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
        .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
    let record = |encoder: Option<&mut <Hal as wgpu::hal::Api>::CommandEncoder>| {
        let Some(encoder) = encoder else {
            return false;
        };
        let all = vk::PipelineStageFlags::ALL_COMMANDS;
        for step in steps {
            // SAFETY: the command buffer is being recorded, outside a pass; the rest is the caller's promise.
            unsafe {
                raw.cmd_pipeline_barrier(
                    encoder.raw_handle(),
                    all,
                    all,
                    vk::DependencyFlags::empty(),
                    &[memory],
                    step.buffers,
                    step.images,
                );
            }
        }
        true
    };
    // SAFETY: the encoder is used for nothing else, and its command buffer neither ended nor destroyed.
    if !unsafe { encoder.as_hal_mut::<Hal, _, _>(record) } {
        return Err(Error::DeviceLost(
            "no command buffer could be recorded".into(),
        ));
    }
    Ok(encoder.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAMILIES: Families = Families {
        own: 1,
        count: 3,
        foreign: false,
    };

    #[test]
    fn only_families_that_there_are_can_own_a_thing() {
        let check = |families: Families, owner| families.validate("colour", "owner_before", owner);
        for owner in [
            None,
            Some(0),
            Some(1),
            Some(2),
            Some(vk::QUEUE_FAMILY_EXTERNAL),
        ] {
            assert_eq!(check(FAMILIES, owner), Ok(()));
        }
        let error = check(FAMILIES, Some(3)).unwrap_err().to_string();
        assert!(
            error.contains("colour: owner_before 3 is not below 3"),
            "{error}"
        );
        let foreign = Some(vk::QUEUE_FAMILY_FOREIGN_EXT);
        let error = check(FAMILIES, foreign).unwrap_err().to_string();
        assert!(error.contains("VK_EXT_queue_family_foreign"), "{error}");
        let extended = Families {
            foreign: true,
            ..FAMILIES
        };
        assert_eq!(check(extended, foreign), Ok(()));
    }

    #[test]
    fn what_is_ours_already_changes_no_hands_and_the_rest_comes_and_goes() {
        for towards_us in [false, true] {
            assert!(FAMILIES.transfer(None, towards_us).is_none());
            assert!(FAMILIES.transfer(Some(1), towards_us).is_none());
        }
        let families = |transfer: Transfer| (transfer.from, transfer.to);
        assert_eq!(FAMILIES.transfer(Some(2), true).map(families), Some((2, 1)));
        assert_eq!(
            FAMILIES.transfer(Some(2), false).map(families),
            Some((1, 2))
        );
    }
}
