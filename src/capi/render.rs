//! Rendering.

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::frame::{GivenFrame, PelageFrame};
use super::input::flags;
use super::registry::{PelageContext, PelageTarget, State};
use super::target::{PelageTargetDescriptor, wanted_outputs};
use crate::error::Result;
use crate::frame::{Frame, Target};
use crate::host::offscreen::{Image, Offscreen};
use crate::memory::Viewport;

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

/// GPU memory that a context will hold once a frame has been rendered, in bytes, the targets left out.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageMemoryEstimate {
    /// `sizeof(PelageMemoryEstimate)`.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// All of it: what is held now, with all hairs, and what the frame adds.
    pub bytes_total: u64,
    /// Of these, what is not held yet.
    pub bytes_added: u64,
    /// Hairs, and their points and segments as they are projected.
    pub bytes_geometry: u64,
    /// Shaded points, and the shading models' tables.
    pub bytes_shading: u64,
    /// The lights' maps.
    pub bytes_shadow: u64,
    /// The transparency technique's: pixels, and the pool of fragments.
    pub bytes_transparency: u64,
    /// The rasteriser's.
    pub bytes_raster: u64,
}

impl Default for PelageMemoryEstimate {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            reserved: 0,
            bytes_total: 0,
            bytes_added: 0,
            bytes_geometry: 0,
            bytes_shading: 0,
            bytes_shadow: 0,
            bytes_transparency: 0,
            bytes_raster: 0,
        }
    }
}

descriptor!(PelageMemoryEstimate, "PELAGE_MEMORY_ESTIMATE_INIT", bytes_raster: u64);

/// States in `*estimate`, begun with `PELAGE_MEMORY_ESTIMATE_INIT`, the GPU memory that the context will hold once `frame` has
/// been rendered with `flags` into a target like `*target`, which need not exist. It follows from the techniques, the hairs,
/// the size, `pool_bytes` and the byte budget, and from what the last frames left. Renders and allocates nothing. A view's
/// occluders and shadow images take nothing more; of a view that writes these alone `PELAGE_RENDER_SHADOWS_ONLY` says so.
///
/// Errors: as `pelage_render`, but for memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_frame_memory_estimate(
    context: PelageContext,
    frame: *const PelageFrame,
    target: *const PelageTargetDescriptor,
    flags: u32,
    estimate: *mut PelageMemoryEstimate,
) -> PelageResult {
    guard(|| {
        context.check()?;
        let flags = self::flags("flags", flags, ALL_FLAGS | PELAGE_RENDER_SHADOWS_ONLY)?;
        // SAFETY: the rule of the module `capi`.
        let (given, target) = unsafe {
            (
                GivenFrame::read(frame)?,
                descriptor::read("target", target)?,
            )
        };
        let [_, _, width, height] = given
            .rectangle
            .unwrap_or([0, 0, target.width, target.height]);
        let viewport = Viewport {
            width,
            height,
            depth: target.with_depth != 0,
            write_depth: flags & PELAGE_RENDER_WRITE_DEPTH != 0,
            outputs: wanted_outputs(target.outputs)?,
            shadows_only: flags & PELAGE_RENDER_SHADOWS_ONLY != 0,
        };
        let found = context.with(|State { host, hairs, .. }| {
            let hairs = given.hairs(hairs)?;
            let frame = given.frame(&hairs);
            host.with_renderer(|renderer| renderer.memory_estimate(&frame, &viewport))
        })?;
        let value = PelageMemoryEstimate {
            bytes_total: found.total,
            bytes_added: found.added,
            bytes_geometry: found.of("pelage.geometry."),
            bytes_shading: found.of("pelage.shading."),
            bytes_shadow: found.of("pelage.shadow."),
            bytes_transparency: found.of("pelage.transparency."),
            bytes_raster: found.of("pelage.raster."),
            ..Default::default()
        };
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("estimate", estimate, &value) }
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
