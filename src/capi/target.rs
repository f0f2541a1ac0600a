//! Targets: images to draw into, written from and read into the host's memory.

use std::ffi::c_void;

use glam::Vec4;
use wgpu::TextureFormat;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{check_bytes, fill, flag, flags, output, outputs, slice};
use super::registry::{Kind, PelageContext, PelageTarget};
use crate::error::{Result, invalid};
use crate::host::offscreen::{Image, WantedOutputs};

/// Four 16-bit floats a pixel.
pub const PELAGE_FORMAT_RGBA16F: u32 = 0;
/// Four 32-bit floats a pixel; needs a device that can blend them.
pub const PELAGE_FORMAT_RGBA32F: u32 = 1;

/// The nearest fibre's clip depth: one float a pixel; the far plane's where there is none.
pub const PELAGE_OUTPUT_NEAREST_DEPTH: u32 = 1;
/// The part of the pixel that hair covers, 0 to 1: one float a pixel.
pub const PELAGE_OUTPUT_COVERAGE: u32 = 2;
/// How far the nearest fibre has moved on the screen since the frame before, in pixels, +x right, +y down, jitter left out:
/// two floats a pixel, 0 where there is none.
pub const PELAGE_OUTPUT_MOTION: u32 = 4;
/// The nearest fibre's hair, as its place in the frame, in the lower 16 bits with its instance in the upper 16; and its strand:
/// two 32-bit integers a pixel, both `PELAGE_NO_STRAND` where there is none.
pub const PELAGE_OUTPUT_IDS: u32 = 8;
/// What both integers of `PELAGE_OUTPUT_IDS` hold where there is no hair.
pub const PELAGE_NO_STRAND: u32 = 0xffff_ffff;

const _: () = assert!(PELAGE_NO_STRAND == crate::NO_STRAND);

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
    /// Any of `PELAGE_OUTPUT_…`, or 0: what is written beside the colour.
    pub outputs: u32,
}

impl Default for PelageTargetDescriptor {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            width: 0,
            height: 0,
            format: PELAGE_FORMAT_RGBA16F,
            with_depth: 0,
            outputs: 0,
        }
    }
}

descriptor!(PelageTargetDescriptor, "PELAGE_TARGET_DESCRIPTOR_INIT", outputs: u32);

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
        let wanted = wanted_outputs(given.outputs)?;
        let id = context.make(
            Kind::Target,
            |state| &mut state.targets,
            |state| {
                let offscreen = state.host.offscreen()?;
                let mut image =
                    offscreen.create_image(given.width, given.height, format, with_depth)?;
                offscreen.add_outputs(&mut image, wanted)?;
                Ok(image)
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

/// Reads one of a target's outputs (`PELAGE_OUTPUT_…`) as it is after all rendering so far into `values`, row 0 at the top, `size`
/// bytes in all: 4 times width times height, or 8 times for motion and ids. Waits for the GPU.
///
/// Errors: not exactly one output; one that the target was made without; another size; `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_target_read_output(
    target: PelageTarget,
    which: u32,
    values: *mut c_void,
    size: u64,
) -> PelageResult {
    guard(|| {
        target.with(|image, host| {
            let own = &image.outputs;
            let (name, texture, words) = match which {
                PELAGE_OUTPUT_NEAREST_DEPTH => ("nearest depth", &own.nearest_depth, 1),
                PELAGE_OUTPUT_COVERAGE => ("coverage", &own.coverage, 1),
                PELAGE_OUTPUT_MOTION => ("motion", &own.motion, 2),
                PELAGE_OUTPUT_IDS => ("ids", &own.ids, 2),
                _ => return invalid!("which {which} is not one of PELAGE_OUTPUT_…"),
            };
            let Some(texture) = texture else {
                return invalid!("the target was made without the output {name}");
            };
            let count = pixel_count(image) * words;
            check_bytes::<u32>("values", size, count, "the output has")?;
            // SAFETY: the rule of the module `capi`.
            let out = unsafe { outputs("values", values.cast::<u32>(), count) }?;
            fill(out, host.offscreen()?.read_words(texture)?);
            Ok(())
        })
    })
}

pub(super) fn wanted_outputs(given: u32) -> Result<WantedOutputs> {
    let all = PELAGE_OUTPUT_NEAREST_DEPTH
        | PELAGE_OUTPUT_COVERAGE
        | PELAGE_OUTPUT_MOTION
        | PELAGE_OUTPUT_IDS;
    let given = flags("outputs", given, all)?;
    Ok(WantedOutputs {
        nearest_depth: given & PELAGE_OUTPUT_NEAREST_DEPTH != 0,
        coverage: given & PELAGE_OUTPUT_COVERAGE != 0,
        motion: given & PELAGE_OUTPUT_MOTION != 0,
        ids: given & PELAGE_OUTPUT_IDS != 0,
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
