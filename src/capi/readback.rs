//! Images on their way back from the GPU: begun at once, asked after, taken when they have arrived.

use super::error::{PelageResult, guard};
use super::input::{check_bytes, fill, output, outputs};
use super::registry::{PelageReadback, PelageTarget};
use super::target::depth_of;
use crate::error::Result;
use crate::host::offscreen::Image;

/// Sends a copy of a target's colour, as it is after all rendering so far, on its way to the host. Does not wait.
///
/// Errors: an image larger than the device's largest buffer; no memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_readback_begin_colour(
    target: PelageTarget,
    readback: *mut PelageReadback,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe { begin(target, readback, |image| Ok(&image.colour)) })
}

/// Sends a copy of a target's depth on its way to the host; see `pelage_readback_begin_colour`.
///
/// Errors: a target without a depth; likewise.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_readback_begin_depth(
    target: PelageTarget,
    readback: *mut PelageReadback,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe { begin(target, readback, depth_of) })
}

unsafe fn begin(
    target: PelageTarget,
    readback: *mut PelageReadback,
    texture: fn(&Image) -> Result<&wgpu::Texture>,
) -> Result<()> {
    // SAFETY: the rule of the module `capi`.
    let readback = unsafe { output("readback", readback) }?;
    let id = target.make_readback(|image, offscreen| offscreen.begin_read(texture(image)?))?;
    readback.write(PelageReadback { id });
    Ok(())
}

/// Sets `*arrived` to 1 if the image has arrived, else to 0. Does not wait for the GPU.
///
/// Errors: `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_readback_poll(
    readback: PelageReadback,
    arrived: *mut u32,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let arrived = unsafe { output("arrived", arrived) }?;
        let has = readback.with(|readback, host| host.offscreen()?.poll_read(readback))?;
        arrived.write(u32::from(has));
        Ok(())
    })
}

/// Copies the image into `values`: of a colour four floats a pixel, of a depth one, row 0 at the top, `size` bytes in all.
/// Waits for it if it has not arrived. May be called again.
///
/// Errors: another size; `PELAGE_DEVICE_LOST`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_readback_copy(
    readback: PelageReadback,
    values: *mut f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        readback.with(|readback, host| {
            let offscreen = host.offscreen()?;
            let (width, height) = readback.size();
            let depth = readback.format().has_depth_aspect();
            let count = width as usize * height as usize * if depth { 1 } else { 4 };
            check_bytes::<f32>("values", size, count, "the image has")?;
            // SAFETY: the rule of the module `capi`.
            let out = unsafe { outputs("values", values, count) }?;
            if depth {
                fill(out, offscreen.finish_depth(readback)?);
            } else {
                let colours = offscreen.finish_colour(readback)?;
                fill(out, colours.iter().flat_map(|colour| colour.to_array()));
            }
            Ok(())
        })
    })
}

/// Destroys a readback, whether the image has arrived or not.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_readback_destroy(readback: PelageReadback) -> PelageResult {
    guard(|| readback.destroy())
}
