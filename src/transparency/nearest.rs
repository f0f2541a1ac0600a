//! Each pixel's nearest fragment, for techniques that keep no order: sought only where an output or the host's depth asks.

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes};
use crate::memory::Viewport;
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint};
use crate::resources::Bound;

const NEAREST: Emission = Emission {
    label: "pelage.transparency.nearest",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/nearest_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const WINNER: Emission = Emission {
    label: "pelage.transparency.nearest.winner",
    stage: 1,
    ..NEAREST
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 2] = [NEAREST, WINNER];

/// What a frame asks of each pixel's nearest fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sought {
    pub depth: bool,
    /// Its segment, and the place on it; with the depth only.
    pub segment: bool,
}

impl Sought {
    pub fn by(viewport: &Viewport) -> Self {
        let segment = viewport.tracked();
        Self {
            depth: segment || viewport.write_depth || viewport.outputs.nearest_depth,
            segment,
        }
    }
}

/// Finds what the frame asks for, into `fill` and `links`.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
) -> Result<()> {
    if !plan.sought.depth {
        return Ok(());
    }
    let bytes = u64::from(plan.width) * u64::from(band.rows) * 4;
    passes.encode("pelage.transparency.nearest.clear", |encoder| {
        encoder.clear_buffer(&bound.pixels.fill.buffer, 0, Some(bytes));
        if plan.sought.segment {
            encoder.clear_buffer(&bound.pixels.links.buffer, 0, Some(bytes));
        }
    });
    raster::record(gpu, passes, bound, &NEAREST, draw, plan)?;
    if plan.sought.segment {
        raster::record(gpu, passes, bound, &WINNER, draw, plan)?;
    }
    Ok(())
}
