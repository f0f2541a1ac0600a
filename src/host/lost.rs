//! Whether a device has been lost, and what a call then says.

use std::sync::{Arc, OnceLock};

use crate::error::{Error, Result};

/// Of a device: why it has been lost, once it has.
#[derive(Debug, Clone, Default)]
pub(super) struct Lost(Arc<OnceLock<String>>);

impl Lost {
    /// Learns of the loss of a device of which nobody else wants to.
    pub fn watch(device: &wgpu::Device) -> Self {
        let lost = Self::default();
        let reason = lost.0.clone();
        device.set_device_lost_callback(move |_, message| _ = reason.set(message));
        lost
    }

    /// Checks that the device has not been lost in an earlier call.
    pub fn alive(&self) -> Result<()> {
        match self.0.get() {
            None => Ok(()),
            Some(reason) => Err(before(reason)),
        }
    }

    /// What a call says: its own result, unless the device has been lost in it.
    pub fn settle<T>(&self, result: Result<T>) -> Result<T> {
        match self.0.get() {
            None => result,
            Some(reason) => Err(just_now(reason)),
        }
    }
}

/// The error of the call in which the device was lost: wgpu gives devices up where memory fails in the wrong place.
fn just_now(reason: &str) -> Error {
    if reason == wgpu::hal::DeviceError::OutOfMemory.to_string() {
        Error::OutOfMemory("the driver has no memory left; the context is dead".into())
    } else {
        before(reason)
    }
}

/// The error of every later call.
fn before(reason: &str) -> Error {
    Error::DeviceLost(if reason == wgpu::hal::DeviceError::Lost.to_string() {
        "the driver has given it up".into()
    } else {
        reason.to_string()
    })
}
