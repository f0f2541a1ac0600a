//! Contexts on a device of the library's own, without a window; what all contexts have in common.

use std::ffi::c_char;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{flag, output, reserved};
use super::registry::{Host, PelageContext};
use super::statistics::copy_text;
use crate::host::offscreen::{Offscreen, OffscreenOptions};

/// How a context is made.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageContextDescriptor {
    /// `sizeof(PelageContextDescriptor)`.
    pub struct_size: u32,
    /// 1: take a software driver even where a GPU is present. 0 takes one only where there is nothing else.
    pub force_software: u32,
    /// 1: load Vulkan's validation layer where it is installed; it writes what it finds to the standard output.
    pub validation: u32,
    /// 0.
    pub reserved: u32,
    /// Bytes of GPU memory that the context may take beside its targets; 0 for no limit.
    pub byte_budget: u64,
}

impl Default for PelageContextDescriptor {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            force_software: 0,
            validation: 0,
            reserved: 0,
            byte_budget: 0,
        }
    }
}

descriptor!(PelageContextDescriptor, "PELAGE_CONTEXT_DESCRIPTOR_INIT", byte_budget: u64);

/// Bytes of a name in `PelageAdapter`, its NUL included.
pub const PELAGE_NAME_SIZE: usize = 256;

/// What a context runs on.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageAdapter {
    /// `sizeof(PelageAdapter)`.
    pub struct_size: u32,
    /// 1 for a software driver.
    pub software: u32,
    /// The device's name, UTF-8, ended by a NUL, cut off where it is too long.
    pub name: [c_char; PELAGE_NAME_SIZE],
    /// The driver's name and version, likewise.
    pub driver: [c_char; PELAGE_NAME_SIZE],
}

impl Default for PelageAdapter {
    fn default() -> Self {
        let empty = [0; PELAGE_NAME_SIZE];
        Self {
            struct_size: size_of::<Self>() as u32,
            software: 0,
            name: empty,
            driver: empty,
        }
    }
}

descriptor!(PelageAdapter, "PELAGE_ADAPTER_INIT", driver: [c_char; PELAGE_NAME_SIZE]);

/// Opens a device and makes a context on it, which `*context` receives.
///
/// Calls on one context, and on what was made on it, may come from any thread and wait for each other; contexts run beside
/// each other.
///
/// Errors: `PELAGE_UNSUPPORTED` where there is no Vulkan driver, or one that falls short.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_context_create(
    descriptor: *const PelageContextDescriptor,
    context: *mut PelageContext,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let (given, context) = unsafe {
            (
                descriptor::read("descriptor", descriptor)?,
                output("context", context)?,
            )
        };
        let options = OffscreenOptions {
            force_software: flag("force_software", given.force_software)?,
            validation: flag("validation", given.validation)?,
        };
        reserved("PelageContextDescriptor", given.reserved)?;
        let mut offscreen = Offscreen::new(&options)?;
        offscreen
            .renderer
            .set_byte_budget((given.byte_budget > 0).then_some(given.byte_budget));
        context.write(PelageContext::register(Host::Offscreen(Box::new(
            offscreen,
        ))));
        Ok(())
    })
}

/// Destroys a context with all its hairs, targets and readbacks, whose handles are stale from then on. Waits for calls on
/// it that run on other threads.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_context_destroy(context: PelageContext) -> PelageResult {
    guard(|| context.destroy())
}

/// Says what a context runs on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_context_adapter(
    context: PelageContext,
    adapter: *mut PelageAdapter,
) -> PelageResult {
    guard(|| {
        let mut value = PelageAdapter::default();
        context.with(|state| {
            let info = state.host.adapter_info();
            value.software = u32::from(info.device_type == wgpu::DeviceType::Cpu);
            copy_text(&info.name, &mut value.name);
            copy_text(
                &format!("{} {}", info.driver, info.driver_info),
                &mut value.driver,
            );
            Ok(())
        })?;
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("adapter", adapter, &value) }
    })
}

/// Limits the GPU memory that a context takes beside its targets to `bytes`; 0 lifts the limit. What it holds is kept.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_context_set_byte_budget(
    context: PelageContext,
    bytes: u64,
) -> PelageResult {
    guard(|| {
        context.with(|state| {
            state.host.with_renderer(|renderer| {
                renderer.set_byte_budget((bytes > 0).then_some(bytes));
                Ok(())
            })
        })
    })
}

/// Whether frames take the shadow maps that an earlier frame has filled, where all is as it was then: the hairs' points, places
/// and opacities, the light and its technique, whatever the view. 1, which is the default, does not change the picture; 0 is for
/// measurements of frames with everything new.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_context_set_shadow_reuse(
    context: PelageContext,
    reuse: u32,
) -> PelageResult {
    guard(|| {
        let reuse = flag("reuse", reuse)?;
        context.with(|state| {
            state.host.with_renderer(|renderer| {
                renderer.set_shadow_reuse(reuse);
                Ok(())
            })
        })
    })
}

/// Waits until the GPU has done all that was asked of it on a context. Other calls on the context wait too.
///
/// Errors: `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_wait(context: PelageContext) -> PelageResult {
    guard(|| context.with(|state| state.host.with_renderer(|renderer| renderer.wait())))
}
