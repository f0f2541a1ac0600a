//! Rendering.

use super::error::{PelageResult, guard};
use super::frame::{GivenFrame, PelageFrame};
use super::input::flags;
use super::registry::{PelageContext, PelageTarget, State};
use crate::error::Result;
use crate::frame::{Frame, Target};
use crate::host::offscreen::{Image, Offscreen};

/// Clear the colour to transparent black first. Without it, hair is blended over what the colour holds.
pub const PELAGE_RENDER_CLEAR: u32 = 1;
/// Write the nearest hair's depth into the target's depth.
pub const PELAGE_RENDER_WRITE_DEPTH: u32 = 2;
/// Darken the opaque scene of the target by the hair's shadow.
pub const PELAGE_RENDER_RECEIVE_SHADOW: u32 = 4;

/// Of `pelage_vulkan_render`: write a view's shadow images alone. No hair is drawn, and its colour and outputs stay.
pub const PELAGE_RENDER_SHADOWS_ONLY: u32 = 8;

pub(super) const ALL_FLAGS: u32 =
    PELAGE_RENDER_CLEAR | PELAGE_RENDER_WRITE_DEPTH | PELAGE_RENDER_RECEIVE_SHADOW;

/// Renders a frame into a target of the same context: the target's depth, if it has one, hides hair. `flags`: any of
/// `PELAGE_RENDER_…`, or 0. Gives the work to the GPU and does not wait for it; what reads the target afterwards does.
///
/// Errors: a value out of its range; hairs that wish for different techniques (`PELAGE_CONFLICT`);
/// `PELAGE_RENDER_WRITE_DEPTH` or `PELAGE_RENDER_RECEIVE_SHADOW` without a depth; no memory. Nothing is then drawn.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_render(
    context: PelageContext,
    frame: *const PelageFrame,
    target: PelageTarget,
    flags: u32,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe {
        render(context, frame, target, flags, |offscreen, frame, target| {
            offscreen.submit(frame, target).map(|()| None)
        })
    })
}

/// As `pelage_render`, but gives pass after pass to the GPU, waits for each, and keeps their times for
/// `pelage_pass_times`. Slower by the waits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_render_timed(
    context: PelageContext,
    frame: *const PelageFrame,
    target: PelageTarget,
    flags: u32,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    guard(|| unsafe {
        render(context, frame, target, flags, |offscreen, frame, target| {
            let timed = offscreen.renderer.render_timed(frame, target);
            offscreen
                .settle(timed)
                .map(|statistics| Some(statistics.passes))
        })
    })
}

unsafe fn render(
    context: PelageContext,
    frame: *const PelageFrame,
    target: PelageTarget,
    flags: u32,
    call: impl FnOnce(&mut Offscreen, &Frame, &Target) -> Result<Option<Vec<crate::PassTime>>>,
) -> Result<()> {
    context.check()?;
    let flags = self::flags("flags", flags, ALL_FLAGS)?;
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { GivenFrame::read(frame) }?;
    context.with(
        |State {
             host,
             hairs,
             targets,
             passes,
             ..
         }| {
            let offscreen = host.offscreen()?;
            let target = target_of(target.among(targets)?, given.rectangle, flags);
            let hairs = given.hairs(hairs)?;
            if let Some(times) = call(offscreen, &given.frame(&hairs), &target)? {
                *passes = times;
            }
            Ok(())
        },
    )
}

fn target_of(image: &Image, rectangle: Option<[u32; 4]>, flags: u32) -> Target<'_> {
    Target {
        colour: &image.colour,
        depth: image.depth.as_ref(),
        clear: flags & PELAGE_RENDER_CLEAR != 0,
        write_depth: flags & PELAGE_RENDER_WRITE_DEPTH != 0,
        receive_shadow: flags & PELAGE_RENDER_RECEIVE_SHADOW != 0,
        rectangle,
        outputs: image.outputs(),
        subresources: Default::default(),
        ..Target::cleared(&image.colour)
    }
}
