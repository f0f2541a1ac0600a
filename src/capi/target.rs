//! Targets: images to draw into, written from and read into the host's memory.

use glam::Vec4;
use wgpu::TextureFormat;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{check_bytes, fill, flag, output, outputs, reserved, slice};
use super::registry::{Kind, PelageContext, PelageTarget};
use crate::error::{Result, invalid};
use crate::host::offscreen::Image;

/// Four 16-bit floats a pixel.
pub const PELAGE_FORMAT_RGBA16F: u32 = 0;
/// Four 32-bit floats a pixel; needs a device that can blend them.
pub const PELAGE_FORMAT_RGBA32F: u32 = 1;

/// How a target is made.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageTargetDescriptor {
    /// `sizeof(PelageTargetDescriptor)`.
    pub struct_size: u32,
    /// Width in pixels, at least 1 and at most what the device takes (8192 or more).
    pub width: u32,
    /// Height in pixels, likewise.
    pub height: u32,
    /// `PELAGE_FORMAT_…` of the colour: linear, premultiplied.
    pub format: u32,
    /// 1: with a depth, of 32-bit floats, for an opaque scene that hides hair.
    pub with_depth: u32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageTargetDescriptor {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            width: 0,
            height: 0,
            format: PELAGE_FORMAT_RGBA16F,
            with_depth: 0,
            reserved: 0,
        }
    }
}

descriptor!(PelageTargetDescriptor, "PELAGE_TARGET_DESCRIPTOR_INIT", reserved: u32);

/// Makes a target: its colour transparent black, its depth, if it has one, 1.
///
/// Errors: a size of zero or beyond the device's largest; an unknown format; no memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_create(
    context: PelageContext,
    descriptor: *const PelageTargetDescriptor,
    target: *mut PelageTarget,
) -> PelageResult {
    guard(|| {
        context.check()?;
        // SAFETY: the rule of the module `capi`.
        let (given, target) = unsafe {
            (
                descriptor::read("descriptor", descriptor)?,
                output("target", target)?,
            )
        };
        let format = match given.format {
            PELAGE_FORMAT_RGBA16F => TextureFormat::Rgba16Float,
            PELAGE_FORMAT_RGBA32F => TextureFormat::Rgba32Float,
            unknown => return invalid!("format {unknown} is not one of PELAGE_FORMAT_…"),
        };
        let with_depth = flag("with_depth", given.with_depth)?;
        reserved("PelageTargetDescriptor", given.reserved)?;
        let id = context.make(
            Kind::Target,
            |state| &mut state.targets,
            |state| {
                state
                    .host
                    .offscreen()?
                    .create_image(given.width, given.height, format, with_depth)
            },
        )?;
        target.write(PelageTarget { id });
        Ok(())
    })
}

/// Destroys a target. Readbacks of it are not touched.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_target_destroy(target: PelageTarget) -> PelageResult {
    guard(|| target.destroy())
}

/// Writes a target's colour: the opaque scene under the hair. Four floats a pixel whatever the format, row 0 at the top,
/// `size` bytes in all: 16 times width times height. 16-bit floats hold 65504 at most; what is beyond is held at that.
///
/// Errors: another size; a value that is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_write_colour(
    target: PelageTarget,
    pixels: *const f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        target.with(|image, host| {
            let count = pixel_count(image);
            check_bytes::<[f32; 4]>("pixels", size, count, "the image takes")?;
            // SAFETY: the rule of the module `capi`.
            let values =
                unsafe { slice("pixels", pixels.cast::<[f32; 4]>(), count as u64, count) }?;
            if let Some(at) = values
                .iter()
                .position(|pixel| !pixel.iter().all(|value| value.is_finite()))
            {
                let (x, y) = (
                    at % image.colour.width() as usize,
                    at / image.colour.width() as usize,
                );
                return invalid!("pixel ({x}, {y}): colour {:?} is not finite", values[at]);
            }
            let colours: Vec<Vec4> = values
                .iter()
                .map(|pixel| Vec4::from_array(*pixel))
                .collect();
            host.offscreen()?.write_colour(&image.colour, &colours)
        })
    })
}

/// Writes a target's depth: what of the opaque scene hides hair. One float a pixel, 0 to 1, row 0 at the top, `size`
/// bytes in all: 4 times width times height.
///
/// Errors: a target without a depth; another size; a value outside 0 to 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_write_depth(
    target: PelageTarget,
    depths: *const f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        target.with(|image, host| {
            let (depth, count) = (depth_of(image)?, pixel_count(image));
            check_bytes::<f32>("depths", size, count, "the image takes")?;
            // SAFETY: the rule of the module `capi`.
            let values = unsafe { slice("depths", depths, count as u64, count) }?;
            host.offscreen()?.write_depth(depth, values)
        })
    })
}

/// Reads a target's colour as it is after all rendering so far, into `pixels`: four floats a pixel whatever the format,
/// row 0 at the top, `size` bytes in all: 16 times width times height. Waits for the GPU; see `pelage_readback_begin_colour`.
///
/// Errors: another size; `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_read_colour(
    target: PelageTarget,
    pixels: *mut f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        target.with(|image, host| {
            let count = pixel_count(image);
            check_bytes::<[f32; 4]>("pixels", size, count, "the image has")?;
            // SAFETY: the rule of the module `capi`.
            let out = unsafe { outputs("pixels", pixels.cast::<[f32; 4]>(), count) }?;
            let colours = host.offscreen()?.read_colour(&image.colour)?;
            fill(out, colours.into_iter().map(Into::into));
            Ok(())
        })
    })
}

/// Reads a target's depth as it is after all rendering so far, into `depths`: one float a pixel, row 0 at the top, `size`
/// bytes in all: 4 times width times height. Waits for the GPU; see `pelage_readback_begin_depth`.
///
/// Errors: a target without a depth; another size; `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_read_depth(
    target: PelageTarget,
    depths: *mut f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        target.with(|image, host| {
            let (depth, count) = (depth_of(image)?, pixel_count(image));
            check_bytes::<f32>("depths", size, count, "the image has")?;
            // SAFETY: the rule of the module `capi`.
            let out = unsafe { outputs("depths", depths, count) }?;
            fill(out, host.offscreen()?.read_depth(depth)?);
            Ok(())
        })
    })
}

fn pixel_count(image: &Image) -> usize {
    image.colour.width() as usize * image.colour.height() as usize
}

/// The depth of a target that has one.
pub(super) fn depth_of(image: &Image) -> Result<&wgpu::Texture> {
    match &image.depth {
        Some(depth) => Ok(depth),
        None => invalid!("the target was made without a depth"),
    }
}
