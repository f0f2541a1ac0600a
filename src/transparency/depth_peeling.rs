//! Depth peeling: the nearest fragments of every pixel, found one after the other (Everitt 2001). Slow, in memory that does
//! not grow with the hair; exact where no pixel has more fragments than there are peels, and so an oracle too.

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::layout::{Counters, OVERFLOW_WORDS};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::Module;
use crate::transparency::{Fragments, Needs, nearest};

const FIRST_UPPER: Emission = Emission {
    label: "pelage.transparency.depth_peeling.first_upper",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/tail_sums_emit",
        "transparency/tail_emit",
        "transparency/fragment_word",
        "transparency/depth_peeling_state",
        "transparency/depth_peeling_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const UPPER: Emission = Emission {
    label: "pelage.transparency.depth_peeling.upper",
    stage: 1,
    ..FIRST_UPPER
};
const LOWER: Emission = Emission {
    label: "pelage.transparency.depth_peeling.lower",
    stage: 2,
    ..FIRST_UPPER
};
const TAIL: Emission = Emission {
    label: "pelage.transparency.depth_peeling.tail",
    stage: 3,
    ..FIRST_UPPER
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 4] = [FIRST_UPPER, UPPER, LOWER, TAIL];

/// Words of what is kept of a pixel; `PEEL_WORDS` in WGSL.
const WORDS: u64 = 6;

/// The most peels: each is two passes over the hair.
pub const MAX_PEELS: u32 = 1024;

/// Settings of depth peeling. 52 bytes a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DepthPeeling {
    /// Fragments of a pixel that are composited in their order, from 1 to [`MAX_PEELS`]; what lies behind them is merged,
    /// with its exact opacity and its mean colour. Peels end early where no pixel has anything more to show.
    pub peels: u32,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for DepthPeeling {
    fn default() -> Self {
        Self {
            peels: 16,
            raster: Raster::Auto,
        }
    }
}

impl DepthPeeling {
    pub(crate) fn validate(&self) -> Result<()> {
        if !(1..=MAX_PEELS).contains(&self.peels) {
            return invalid!(
                "depth_peeling: peels {} is not within 1 and {MAX_PEELS}",
                self.peels
            );
        }
        Ok(())
    }
}

pub(crate) fn needs(pixels: u64) -> Needs {
    Needs {
        fill: 0,
        links: 0,
        overflow: pixels * 4 * OVERFLOW_WORDS,
        fragments: Fragments::Fixed(pixels * 4 * WORDS),
    }
}

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    peels: u32,
) -> Result<()> {
    let words = u64::from(plan.width) * u64::from(band.rows) * 4;
    passes.encode("pelage.transparency.depth_peeling.clear", |encoder| {
        let pixels = bound.pixels;
        encoder.clear_buffer(&pixels.overflow.buffer, 0, Some(words * OVERFLOW_WORDS));
        encoder.clear_buffer(&pixels.fragments[0].buffer, 0, Some(words * WORDS));
        bound.clear_counters(encoder);
    });
    for peel in 0..peels {
        let upper = if peel == 0 { &FIRST_UPPER } else { &UPPER };
        raster::record(gpu, passes, bound, upper, draw, plan)?;
        raster::record(gpu, passes, bound, &LOWER, draw, plan)?;
        advance(gpu, passes, bound, band, plan)?;
    }
    raster::record(gpu, passes, bound, &TAIL, draw, plan)?;
    nearest::record(gpu, passes, bound, band, draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// Composites what each pixel's peel has found.
fn advance(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
) -> Result<()> {
    let label = "pelage.transparency.depth_peeling.advance";
    let groups = [Group::Frame, Group::PixelsWritten];
    let pipeline = gpu.compute(
        PipelineKey::new(label),
        "depth_peeling_advance",
        &groups,
        advance_module,
    )?;
    passes.encode(label, |encoder| {
        // Whether any pixel goes on is found anew.
        let flag = std::mem::offset_of!(Counters, overflow) as u64;
        encoder.clear_buffer(&bound.pixels.counters.buffer, flag, Some(4));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(3, bound.pixels_written, &[]);
        let (x, y) = workgroups(plan.width * band.rows);
        pass.dispatch_workgroups(x, y, 1);
    });
    Ok(())
}

/// The pass over the pixels after a peel.
pub(crate) fn advance_module() -> Module {
    Module::new(&[
        "transparency/overflow",
        "transparency/shaded",
        "transparency/fragment_word",
        "transparency/depth_peeling_state",
        "transparency/depth_peeling_advance",
    ])
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module) -> Module {
    common.and(&[
        "transparency/nearest",
        "transparency/overflow",
        "transparency/tail_sums",
        "transparency/tail",
        "transparency/depth_peeling_state",
        "transparency/depth_peeling",
    ])
}
