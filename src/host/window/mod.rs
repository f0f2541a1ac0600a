//! Windows: the library's own device, chosen so that it can show what it draws in a window of the host's.
//!
//! The host keeps its window and the events of it. It hands over raw handles, draws into targets as it would offscreen,
//! and presents one of them: the target over a clear colour, in the window's upper left, pixel upon pixel.
//!
//! What is presented is linear and premultiplied. A surface of [`Encoding::Srgb8`] is encoded by the GPU as it is written,
//! one of [`Encoding::Unorm8`] or [`Encoding::Unorm10`] by the pass that presents; both clip to 0…1, there is no tone curve.
//! A surface of [`Encoding::Float16`] takes linear values as they are, those above 1 too; the screen makes of them what it can.

mod encoding;
mod pass;

use glam::Vec3;
use wgpu::rwh::{RawDisplayHandle, RawWindowHandle};

pub use self::encoding::{ENCODINGS, Encoding, PRESENT_MODES, PresentMode};

use self::encoding::{check_mode, choose, encodings, modes, no_format};
use self::pass::Pass;
use super::offscreen::{Image, Offscreen, OffscreenOptions};
use crate::error::{Error, Result, invalid};

/// Frames that may wait to be shown.
const LATENCY: u32 = 2;
/// How often one call makes a surface anew that is lost or outdated before it leaves the frame to the next call: a window
/// that is being dragged changes again meanwhile.
const ATTEMPTS: usize = 3;

/// How a window's context is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WindowOptions {
    /// How the device is chosen.
    pub device: OffscreenOptions,
    /// Width and height of the window in pixels, where the window system leaves them to the host (Wayland); otherwise 0.
    pub size: [u32; 2],
    /// How frames come to the screen.
    pub present_mode: PresentMode,
    /// `None`: the first of [`ENCODINGS`] that the surface has.
    pub encoding: Option<Encoding>,
}

/// What became of a frame that was to be presented. Only [`Presented::Shown`] has reached the window; the others are no
/// errors, and the next call tries again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presented {
    /// It is on its way to the screen.
    Shown,
    /// Skipped: the window has no pixels, as one that is minimised.
    Minimised,
    /// Skipped: nothing of the window can be seen.
    Occluded,
    /// Skipped: the screen had no room for another frame within a second.
    TimedOut,
    /// Skipped: the window kept changing while its surface was made anew.
    Changing,
}

/// Raw handles of the host's.
#[derive(Clone, Copy)]
struct Handles {
    display: RawDisplayHandle,
    window: RawWindowHandle,
}

// SAFETY: the host promises, to `Window::new`, that its handles may be used on every thread that it uses the context on.
unsafe impl Send for Handles {}

/// A device of the library's own with a surface of the host's window.
pub struct Window {
    /// `None` where a lost one could not be made anew yet. Dropped before the device.
    surface: Option<wgpu::Surface<'static>>,
    handles: Handles,
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
    pass: Pass,
    encoding: Encoding,
    present_mode: PresentMode,
    /// As the host says; taken where the window system does not know.
    size: [u32; 2],
    /// As the host says.
    minimised: bool,
    /// What the surface is configured for; `None` makes the next frame configure it.
    configured: Option<[u32; 2]>,
    /// The device, with its renderer and targets.
    pub offscreen: Offscreen,
}

impl Window {
    /// A context for a window.
    ///
    /// # Errors
    /// No Vulkan driver, or none that can show this window; a present mode or an encoding that the surface does not have.
    ///
    /// # Safety
    /// Both handles are valid, and stay so until the context is dropped. They may be used on every thread that the context
    /// is used on: with Xlib after `XInitThreads`, on macOS on the main thread alone.
    pub unsafe fn new(
        display: RawDisplayHandle,
        window: RawWindowHandle,
        options: &WindowOptions,
    ) -> Result<Self> {
        let handles = Handles { display, window };
        check(&handles)?;
        let instance = super::offscreen::instance(&options.device);
        // SAFETY: the host's promise is passed on.
        let surface = unsafe { make_surface(&instance, &handles) }?;
        let adapter = pollster::block_on(super::offscreen::adapter(
            &instance,
            &options.device,
            Some(&surface),
        ))
        .map_err(|error| {
            Error::Unsupported(format!("no Vulkan driver can show this window ({error})"))
        })?;
        let offered = surface.get_capabilities(&adapter);
        let encoding = choose(options.encoding, &offered)?;
        check_mode(options.present_mode, &offered)?;
        let offscreen = pollster::block_on(Offscreen::on_adapter(&adapter))?;
        let device = offscreen.renderer.device();
        let format = encoding.find(&offered).ok_or_else(no_format)?;
        Ok(Self {
            pass: Pass::new(device, format, encoding),
            surface: Some(surface),
            handles,
            instance,
            adapter,
            encoding,
            present_mode: options.present_mode,
            size: options.size,
            minimised: false,
            configured: None,
            offscreen,
        })
    }

    /// Says that the window has another size, in pixels; 0 × 0 for one that is minimised. Where the window system itself
    /// knows the size of a surface, as X11 and Windows do, that one is taken, and this says nothing but whether it is 0.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.size = [width, height];
        self.minimised = width == 0 || height == 0;
        self.configured = None;
    }

    /// Changes how frames come to the screen.
    ///
    /// # Errors
    /// A mode that the surface does not have; the old one stays.
    pub fn set_present_mode(&mut self, mode: PresentMode) -> Result<()> {
        check_mode(mode, &self.offered()?)?;
        self.present_mode = mode;
        self.configured = None;
        Ok(())
    }

    /// How frames come to the screen.
    pub fn present_mode(&self) -> PresentMode {
        self.present_mode
    }

    /// What the surface's pixels are.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The present modes that the surface has.
    ///
    /// # Errors
    /// A surface that is lost.
    pub fn present_modes(&self) -> Result<Vec<PresentMode>> {
        let offered = self.offered()?;
        Ok(modes(&offered).collect())
    }

    /// The encodings that the surface has.
    ///
    /// # Errors
    /// A surface that is lost.
    pub fn encodings(&self) -> Result<Vec<Encoding>> {
        let offered = self.offered()?;
        Ok(encodings(&offered).collect())
    }

    /// Width and height of the surface in pixels; `None` where the window has no pixels.
    ///
    /// # Errors
    /// A surface that is lost.
    pub fn extent(&self) -> Result<Option<[u32; 2]>> {
        if self.minimised {
            return Ok(None);
        }
        let surface = self.surface.as_ref().ok_or_else(gone)?;
        // SAFETY: nothing of either is kept or destroyed.
        let offered = unsafe {
            let (surface, adapter) = (
                surface.as_hal::<wgpu::hal::api::Vulkan>(),
                self.adapter.as_hal::<wgpu::hal::api::Vulkan>(),
            );
            surface
                .zip(adapter)
                .and_then(|(surface, adapter)| {
                    wgpu::hal::Adapter::surface_capabilities(&*adapter, &surface)
                })
                .ok_or_else(gone)?
        };
        let extent = match offered.current_extent {
            Some(known) => [known.width, known.height],
            None => self.size,
        };
        Ok((!extent.contains(&0)).then_some(extent))
    }

    /// Shows a target over a linear colour in the window. The target's upper left is the window's; what it does not reach
    /// is the clear colour, what does not fit is cut off. May wait for the screen, as [`PresentMode`] says.
    ///
    /// # Errors
    /// A clear colour that is not finite; a surface that is lost and cannot be made anew, as that of a window that is no
    /// more; a lost device; no memory.
    pub fn present(&mut self, image: &Image, clear: Vec3) -> Result<Presented> {
        self.offscreen.alive()?;
        if !clear.is_finite() {
            return invalid!("clear {clear} is not finite");
        }
        for _ in 0..ATTEMPTS {
            let Some(extent) = self.present_extent()? else {
                return Ok(Presented::Minimised);
            };
            if self.configured != Some(extent) && !self.configure(extent)? {
                self.remake()?;
                continue;
            }
            use wgpu::CurrentSurfaceTexture as Current;
            let (texture, fits) = match self.acquire()? {
                Current::Success(texture) => (texture, true),
                Current::Suboptimal(texture) => (texture, false),
                Current::Timeout => return Ok(Presented::TimedOut),
                Current::Occluded => return Ok(Presented::Occluded),
                Current::Outdated => {
                    self.configured = None;
                    continue;
                }
                Current::Lost => {
                    self.remake()?;
                    continue;
                }
                Current::Validation => {
                    return Err(Error::Internal("the surface gave no image".into()));
                }
            };
            self.show(texture, image, clear)?;
            if !fits {
                self.configured = None;
            }
            return Ok(Presented::Shown);
        }
        Ok(Presented::Changing)
    }

    /// The extent to present to, of a surface that is made anew if it is lost.
    fn present_extent(&mut self) -> Result<Option<[u32; 2]>> {
        match self.extent() {
            Ok(extent) => Ok(extent),
            Err(_) => {
                self.remake()?;
                self.extent()
            }
        }
    }

    /// Configures the surface; `false` if it is lost.
    fn configure(&mut self, [width, height]: [u32; 2]) -> Result<bool> {
        let Some(surface) = &self.surface else {
            return Ok(false);
        };
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: self.pass.format,
            color_space: self.encoding.colour_space(),
            width,
            height,
            present_mode: self.present_mode.wgpu(),
            desired_maximum_frame_latency: LATENCY,
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: Vec::new(),
        };
        let device = self.offscreen.renderer.device();
        let outcome = self.watched(|| surface.configure(device, &configuration));
        match outcome {
            Ok(()) => {
                self.configured = Some([width, height]);
                Ok(true)
            }
            // What wgpu says of a surface that is lost is no more than that it is invalid.
            Err(Error::Internal(what)) => {
                log::debug!("configuring a surface: {what}");
                Ok(false)
            }
            Err(error) => Err(error),
        }
    }

    fn acquire(&self) -> Result<wgpu::CurrentSurfaceTexture> {
        let surface = self.surface.as_ref().ok_or_else(gone)?;
        self.watched(|| surface.get_current_texture())
    }

    /// Draws the target into the surface's image and presents it.
    fn show(&self, texture: wgpu::SurfaceTexture, image: &Image, clear: Vec3) -> Result<()> {
        let renderer = &self.offscreen.renderer;
        self.watched(|| {
            let [r, g, b] = clear.to_array();
            let bytes: [f32; 4] = [r, g, b, 1.0];
            renderer
                .queue()
                .write_buffer(&self.pass.clear, 0, bytemuck::cast_slice(&bytes));
            let mut encoder = renderer
                .device()
                .create_command_encoder(&Default::default());
            self.pass
                .record(renderer.device(), &mut encoder, &texture.texture, image);
            renderer.queue().submit([encoder.finish()]);
            renderer.queue().present(texture);
        })
    }

    /// Makes a lost surface anew.
    fn remake(&mut self) -> Result<()> {
        self.configured = None;
        // A window takes one surface at a time.
        self.surface = None;
        // SAFETY: the handles are valid until the context is dropped, as the host has promised.
        let surface = unsafe { make_surface(&self.instance, &self.handles) }.map_err(|_| gone())?;
        let offered = surface.get_capabilities(&self.adapter);
        if offered.formats.is_empty() {
            return Err(gone());
        }
        let format = self.encoding.find(&offered).ok_or_else(no_format)?;
        check_mode(self.present_mode, &offered)?;
        if format != self.pass.format {
            self.pass = Pass::new(self.offscreen.renderer.device(), format, self.encoding);
        }
        self.surface = Some(surface);
        log::info!("a window's surface was lost, and has been made anew");
        Ok(())
    }

    fn offered(&self) -> Result<wgpu::SurfaceCapabilities> {
        let surface = self.surface.as_ref().ok_or_else(gone)?;
        let offered = surface.get_capabilities(&self.adapter);
        if offered.formats.is_empty() {
            return Err(gone());
        }
        Ok(offered)
    }

    /// Runs `call`; what wgpu says meanwhile becomes an error.
    fn watched<T>(&self, call: impl FnOnce() -> T) -> Result<T> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let device = self.offscreen.renderer.device();
        let scopes =
            [Validation, OutOfMemory, Internal].map(|filter| device.push_error_scope(filter));
        let value = call();
        let mut found = None;
        for scope in scopes.into_iter().rev() {
            found = pollster::block_on(scope.pop()).or(found);
        }
        self.offscreen.settle(match found {
            None => Ok(value),
            Some(error @ wgpu::Error::OutOfMemory { .. }) => {
                Err(Error::OutOfMemory(error.to_string()))
            }
            Some(error) => Err(Error::Internal(error.to_string())),
        })
    }
}

/// Checks what a driver would not forgive: handles that are NULL, or of two window systems.
fn check(handles: &Handles) -> Result<()> {
    use {RawDisplayHandle as Display, RawWindowHandle as Raw};
    match (handles.display, handles.window) {
        (Display::Xlib(display), Raw::Xlib(window)) => {
            if display.display.is_none() {
                return invalid!("the Xlib display is NULL");
            }
            if window.window == 0 {
                return invalid!("the Xlib window is 0");
            }
        }
        (Display::Xcb(display), Raw::Xcb(_)) => {
            if display.connection.is_none() {
                return invalid!("the Xcb connection is NULL");
            }
        }
        (Display::Windows(_), Raw::Win32(window)) => {
            if window.hinstance.is_none() {
                return invalid!("the Win32 window comes without its HINSTANCE");
            }
        }
        (Display::Wayland(_), Raw::Wayland(_)) | (Display::AppKit(_), Raw::AppKit(_)) => {}
        (display, window) => {
            return invalid!(
                "display {display:?} and window {window:?} are not of one kind among Xlib, Xcb, Wayland, Win32 and AppKit"
            );
        }
    }
    Ok(())
}

unsafe fn make_surface(
    instance: &wgpu::Instance,
    handles: &Handles,
) -> Result<wgpu::Surface<'static>> {
    let target = wgpu::SurfaceTargetUnsafe::RawHandle {
        raw_display_handle: Some(handles.display),
        raw_window_handle: handles.window,
    };
    // SAFETY: the handles are valid until the context is dropped, and the surface with it.
    let make = || unsafe { instance.create_surface_unsafe(target) };
    let refused =
        |why: &str| Error::Unsupported(format!("this window takes no Vulkan surface: {why}"));
    // wgpu panics where a driver refuses the window itself, as lavapipe 25 does with one that is no more. It holds nothing by
    // then that another call could find half done.
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(make)) {
        Ok(made) => made.map_err(|error| refused(&error.to_string())),
        Err(_) => Err(refused("the driver refuses it")),
    }
}

fn gone() -> Error {
    Error::Unsupported(
        "the window's surface is lost and cannot be made anew: the window may be no more".into(),
    )
}
