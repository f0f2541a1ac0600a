//! Windows: a context with a device that can show its targets in a window of the host's.

use std::ffi::c_void;
use std::num::{NonZeroIsize, NonZeroU32};
use std::ptr::{NonNull, null_mut};

use glam::Vec3;
use wgpu::rwh;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{flag, output, reserved};
use super::registry::{Host, PelageContext, PelageTarget, State};
use crate::error::{Result, invalid};
use crate::host::offscreen::OffscreenOptions;
use crate::host::window::{
    ENCODINGS, Encoding, PRESENT_MODES, PresentMode, Presented, Window, WindowOptions,
};

/// `display` is a `Display *`, `window` a `Window`.
pub const PELAGE_WINDOW_XLIB: u32 = 1;
/// `display` is an `xcb_connection_t *`, `window` an `xcb_window_t`.
pub const PELAGE_WINDOW_XCB: u32 = 2;
/// `display` is a `struct wl_display *`, `window` a `struct wl_surface *`.
pub const PELAGE_WINDOW_WAYLAND: u32 = 3;
/// `display` is the `HINSTANCE` that the window was made with, `window` an `HWND`.
pub const PELAGE_WINDOW_WIN32: u32 = 4;
/// `display` is NULL, `window` an `NSView *`. Needs a Vulkan driver, such as MoltenVK.
pub const PELAGE_WINDOW_APPKIT: u32 = 5;

/// Each frame in its turn, at the screen's rate. Every window has it.
pub const PELAGE_PRESENT_FIFO: u32 = 0;
/// The newest frame at the screen's next refresh; older ones are dropped.
pub const PELAGE_PRESENT_MAILBOX: u32 = 1;
/// At once, even while the screen is being refreshed.
pub const PELAGE_PRESENT_IMMEDIATE: u32 = 2;

/// The first of the following that the window has.
pub const PELAGE_SURFACE_AUTO: u32 = 0;
/// 8 bits a channel of the sRGB curve, which the GPU applies.
pub const PELAGE_SURFACE_SRGB8: u32 = 1;
/// The same 8 bits in a format that does not know of the curve: the library applies it.
pub const PELAGE_SURFACE_UNORM8: u32 = 2;
/// 10 bits a channel of the sRGB curve, which the library applies.
pub const PELAGE_SURFACE_UNORM10: u32 = 3;
/// 16-bit floats, linear, beyond 1 too: extended linear sRGB, which the screen makes the best of.
pub const PELAGE_SURFACE_FLOAT16: u32 = 4;

/// The frame is on its way to the screen.
pub const PELAGE_PRESENTED: u32 = 0;
/// Skipped: the window has no pixels, as one that is minimised.
pub const PELAGE_SKIPPED_MINIMISED: u32 = 1;
/// Skipped: nothing of the window can be seen.
pub const PELAGE_SKIPPED_OCCLUDED: u32 = 2;
/// Skipped: the screen had no room for another frame within a second.
pub const PELAGE_SKIPPED_TIMEOUT: u32 = 3;
/// Skipped: the window kept changing while its surface was made anew.
pub const PELAGE_SKIPPED_CHANGING: u32 = 4;

/// A window of the host's, by its raw handles.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageWindow {
    /// `sizeof(PelageWindow)`.
    pub struct_size: u32,
    /// `PELAGE_WINDOW_...`: whose handles they are.
    pub kind: u32,
    /// As the kind says.
    pub display: *mut c_void,
    /// As the kind says: a number, or a pointer cast to `uintptr_t`.
    pub window: u64,
    /// The number of the X11 screen; otherwise 0.
    pub screen: u32,
    /// Width in pixels. Taken where the window system leaves it to the program (Wayland); may be 0 elsewhere.
    pub width: u32,
    /// Height in pixels, likewise.
    pub height: u32,
    /// `PELAGE_SURFACE_...`.
    pub format: u32,
    /// `PELAGE_PRESENT_...`.
    pub present_mode: u32,
    /// 1: take a software driver even where a GPU is present.
    pub force_software: u32,
    /// 1: load Vulkan's validation layer where it is installed; it writes what it finds to the standard output.
    pub validation: u32,
    /// 0.
    pub reserved: u32,
    /// Bytes of GPU memory that the context may take beside its targets and the window; 0 for no limit.
    pub byte_budget: u64,
}

impl Default for PelageWindow {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            kind: 0,
            display: null_mut(),
            window: 0,
            screen: 0,
            width: 0,
            height: 0,
            format: PELAGE_SURFACE_AUTO,
            present_mode: PELAGE_PRESENT_FIFO,
            force_software: 0,
            validation: 0,
            reserved: 0,
            byte_budget: 0,
        }
    }
}

descriptor!(PelageWindow, "PELAGE_WINDOW_INIT", byte_budget: u64);

/// What a window's surface is, and what it could be.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageWindowInfo {
    /// `sizeof(PelageWindowInfo)`.
    pub struct_size: u32,
    /// Width in pixels: that of the target to render; 0 for a window that is minimised.
    pub width: u32,
    /// Height in pixels, likewise.
    pub height: u32,
    /// `PELAGE_SURFACE_...`, never `PELAGE_SURFACE_AUTO`.
    pub format: u32,
    /// `PELAGE_PRESENT_...`.
    pub present_mode: u32,
    /// The formats that the surface has: bit `1 << PELAGE_SURFACE_...` of each.
    pub formats: u32,
    /// The present modes that it has: bit `1 << PELAGE_PRESENT_...` of each.
    pub present_modes: u32,
}

impl Default for PelageWindowInfo {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            width: 0,
            height: 0,
            format: 0,
            present_mode: 0,
            formats: 0,
            present_modes: 0,
        }
    }
}

descriptor!(PelageWindowInfo, "PELAGE_WINDOW_INFO_INIT", present_modes: u32);

/// Opens a device that can show its pictures in a window of the host's, and makes a context on it, which `*context`
/// receives. All functions that serve a context of `pelage_context_create` serve it too: render into a target, then
/// `pelage_window_present` it. One context a window.
///
/// The window stays the host's, with its events; it is destroyed after the context. Its handles may be used on every thread
/// that uses the context: with Xlib call `XInitThreads` first, on macOS use the main thread alone.
///
/// Errors: handles that are NULL or of no kind; `PELAGE_UNSUPPORTED` where no Vulkan driver can show the window, or its
/// surface lacks the format or the present mode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_window_context_create(
    window: *const PelageWindow,
    context: *mut PelageContext,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let (given, context) = unsafe {
            (
                descriptor::read("window", window)?,
                output("context", context)?,
            )
        };
        reserved("PelageWindow", given.reserved)?;
        let options = WindowOptions {
            device: OffscreenOptions {
                force_software: flag("force_software", given.force_software)?,
                validation: flag("validation", given.validation)?,
            },
            size: [given.width, given.height],
            present_mode: mode(given.present_mode)?,
            encoding: encoding(given.format)?,
        };
        let (display, window) = handles(&given)?;
        // SAFETY: the handles are what the host says they are; it keeps them until the context has been destroyed.
        let mut window = unsafe { Window::new(display, window, &options) }?;
        window
            .offscreen
            .renderer
            .set_byte_budget((given.byte_budget > 0).then_some(given.byte_budget));
        context.write(PelageContext::register(Host::Window(Box::new(window))));
        Ok(())
    })
}

/// Says that a context's window has another size, in pixels; 0 and 0 where it is minimised. Targets are the host's to make
/// anew, in the size that `pelage_window_info` says.
///
/// Errors: `PELAGE_UNSUPPORTED` for a context without a window.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_window_resize(
    context: PelageContext,
    width: u32,
    height: u32,
) -> PelageResult {
    guard(|| {
        context.with(|state| {
            state.host.window()?.resize(width, height);
            Ok(())
        })
    })
}

/// Changes how frames come to the screen: `PELAGE_PRESENT_...`.
///
/// Errors: `PELAGE_UNSUPPORTED` for a mode that the window does not have, which leaves the old one; for a context without
/// a window.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_window_set_present_mode(
    context: PelageContext,
    present_mode: u32,
) -> PelageResult {
    guard(|| {
        let mode = mode(present_mode)?;
        context.with(|state| state.host.window()?.set_present_mode(mode))
    })
}

/// Says what a context's window is now, in `*info`, begun with `PELAGE_WINDOW_INFO_INIT`.
///
/// Errors: `PELAGE_UNSUPPORTED` for a window that is no more, and for a context without one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_window_info(
    context: PelageContext,
    info: *mut PelageWindowInfo,
) -> PelageResult {
    guard(|| {
        let value = context.with(|state| {
            let window = state.host.window()?;
            let [width, height] = window.extent()?.unwrap_or_default();
            Ok(PelageWindowInfo {
                width,
                height,
                format: encoding_number(window.encoding()),
                present_mode: mode_number(window.present_mode()),
                formats: bits(window.encodings()?.into_iter().map(encoding_number)),
                present_modes: bits(window.present_modes()?.into_iter().map(mode_number)),
                ..Default::default()
            })
        })?;
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("info", info, &value) }
    })
}

/// Shows a target in the context's window, over `clear`, three floats, linear RGB; NULL for black. The target's upper left
/// is the window's; what it does not reach shows `clear`, what does not fit is cut off. Sets `*outcome` to
/// `PELAGE_PRESENTED`, or to the `PELAGE_SKIPPED_...` that says why the window still shows what it did; `outcome` may be NULL.
///
/// A surface that is lost or outdated is made anew. With `PELAGE_PRESENT_FIFO` the call may wait for the screen, and other
/// calls on the context with it.
///
/// Errors: a colour that is not finite; a target of another context; `PELAGE_UNSUPPORTED` for a window that is no more, and
/// for a context without one; `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_window_present(
    context: PelageContext,
    target: PelageTarget,
    clear: *const f32,
    outcome: *mut u32,
) -> PelageResult {
    guard(|| {
        context.check()?;
        let clear = if clear.is_null() {
            [0.0; 3]
        } else {
            // SAFETY: the rule of the module `capi`.
            unsafe { super::input::array("clear", clear) }?
        };
        let outcome = if outcome.is_null() {
            None
        } else {
            // SAFETY: as above.
            Some(unsafe { output("outcome", outcome) }?)
        };
        let presented = context.with(|State { host, targets, .. }| {
            let window = host.window()?;
            window.present(target.among(targets)?, Vec3::from_array(clear))
        })?;
        if let Some(outcome) = outcome {
            outcome.write(match presented {
                Presented::Shown => PELAGE_PRESENTED,
                Presented::Minimised => PELAGE_SKIPPED_MINIMISED,
                Presented::Occluded => PELAGE_SKIPPED_OCCLUDED,
                Presented::TimedOut => PELAGE_SKIPPED_TIMEOUT,
                Presented::Changing => PELAGE_SKIPPED_CHANGING,
            });
        }
        Ok(())
    })
}

/// The handles in the types of `raw-window-handle`.
fn handles(given: &PelageWindow) -> Result<(rwh::RawDisplayHandle, rwh::RawWindowHandle)> {
    let display = NonNull::new(given.display);
    let number = |most: u64| {
        if given.window == 0 || given.window > most {
            return invalid!("window {:#x} is no window of its kind", given.window);
        }
        Ok(given.window)
    };
    let pointer = || match NonNull::new(given.window as usize as *mut c_void) {
        Some(pointer) => Ok(pointer),
        None => invalid!("window is NULL"),
    };
    let required = || match display {
        Some(display) => Ok(display),
        None => invalid!("display is NULL"),
    };
    let screen = i32::try_from(given.screen).unwrap_or(i32::MAX);
    Ok(match given.kind {
        PELAGE_WINDOW_XLIB => {
            let window = number(u64::from(u32::MAX))? as std::ffi::c_ulong;
            (
                rwh::XlibDisplayHandle::new(Some(required()?), screen).into(),
                rwh::XlibWindowHandle::new(window).into(),
            )
        }
        PELAGE_WINDOW_XCB => {
            let window = number(u64::from(u32::MAX))? as u32;
            let Some(window) = NonZeroU32::new(window) else {
                return invalid!("window is 0");
            };
            (
                rwh::XcbDisplayHandle::new(Some(required()?), screen).into(),
                rwh::XcbWindowHandle::new(window).into(),
            )
        }
        PELAGE_WINDOW_WAYLAND => (
            rwh::WaylandDisplayHandle::new(required()?).into(),
            rwh::WaylandWindowHandle::new(pointer()?).into(),
        ),
        PELAGE_WINDOW_WIN32 => {
            let Some(hwnd) = NonZeroIsize::new(given.window as isize) else {
                return invalid!("window is NULL");
            };
            let mut window = rwh::Win32WindowHandle::new(hwnd);
            window.hinstance = NonZeroIsize::new(required()?.as_ptr() as isize);
            (rwh::WindowsDisplayHandle::new().into(), window.into())
        }
        PELAGE_WINDOW_APPKIT => (
            rwh::AppKitDisplayHandle::new().into(),
            rwh::AppKitWindowHandle::new(pointer()?).into(),
        ),
        unknown => return invalid!("kind {unknown} is not one of PELAGE_WINDOW_…"),
    })
}

fn mode(number: u32) -> Result<PresentMode> {
    match PRESENT_MODES.get(number as usize) {
        Some(mode) => Ok(*mode),
        None => invalid!("present_mode {number} is not one of PELAGE_PRESENT_…"),
    }
}

fn mode_number(mode: PresentMode) -> u32 {
    match mode {
        PresentMode::Fifo => PELAGE_PRESENT_FIFO,
        PresentMode::Mailbox => PELAGE_PRESENT_MAILBOX,
        PresentMode::Immediate => PELAGE_PRESENT_IMMEDIATE,
    }
}

fn encoding(number: u32) -> Result<Option<Encoding>> {
    if number == PELAGE_SURFACE_AUTO {
        return Ok(None);
    }
    match ENCODINGS.get(number as usize - 1) {
        Some(encoding) => Ok(Some(*encoding)),
        None => invalid!("format {number} is not one of PELAGE_SURFACE_…"),
    }
}

fn encoding_number(encoding: Encoding) -> u32 {
    match encoding {
        Encoding::Srgb8 => PELAGE_SURFACE_SRGB8,
        Encoding::Unorm8 => PELAGE_SURFACE_UNORM8,
        Encoding::Unorm10 => PELAGE_SURFACE_UNORM10,
        Encoding::Float16 => PELAGE_SURFACE_FLOAT16,
    }
}

fn bits(numbers: impl Iterator<Item = u32>) -> u32 {
    numbers.fold(0, |bits, number| bits | 1 << number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_means_what_it_is_called() {
        for (number, value) in PRESENT_MODES.into_iter().enumerate() {
            assert_eq!(mode_number(value), number as u32);
            assert_eq!(mode(number as u32), Ok(value));
        }
        for (number, value) in ENCODINGS.into_iter().enumerate() {
            assert_eq!(encoding_number(value), number as u32 + 1);
            assert_eq!(encoding(number as u32 + 1), Ok(Some(value)));
        }
        assert!(mode(3).is_err() && encoding(5).is_err());
    }
}
