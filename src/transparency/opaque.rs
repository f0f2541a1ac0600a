//! Opaque: the colour of a pixel's nearest fragment, at the exact opacity of all its fragments.

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::transparency::{Fragments, Needs};

const NEAREST: Emission = Emission {
    label: "pelage.transparency.opaque.nearest",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/opaque_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const WINNER: Emission = Emission {
    label: "pelage.transparency.opaque.winner",
    stage: 1,
    ..NEAREST
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 2] = [NEAREST, WINNER];

/// Settings of the opaque technique.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Opaque {
    /// The rasteriser.
    pub raster: Raster,
}

pub(crate) fn needs(pixels: u64) -> Needs {
    Needs {
        fill: pixels * 4,
        links: pixels * 4,
        overflow: 0,
        fragments: Fragments::Fixed(pixels * 4),
    }
}

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
) -> Result<()> {
    let words = u64::from(plan.width) * u64::from(band.rows) * 4;
    passes.encode("pelage.transparency.opaque.clear", |encoder| {
        for buffer in [
            &bound.pixels.fill,
            &bound.pixels.links,
            &bound.pixels.fragments[0],
        ] {
            encoder.clear_buffer(&buffer.buffer, 0, Some(words));
        }
        bound.clear_counters(encoder);
    });
    raster::record(gpu, passes, bound, &NEAREST, draw, plan)?;
    raster::record(gpu, passes, bound, &WINNER, draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}
