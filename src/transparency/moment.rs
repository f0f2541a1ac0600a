//! Moment-based transparency: each pixel's transmittance over depth as four power moments of its optical depth, by which its
//! fragments' colours are weighted (Münstermann et al. 2018, Sharpe 2018).
//!
//! Alpha is exact. The colour's RMSE against the exact sorted composite, of 3,000 straight strands with a white point of about
//! 0.5: 0.0004 at an opacity of 0.1, 0.0012 at 0.3, 0.0028 at 0.9, 0.0031 at 1; the 99th percentile is four times that. What
//! single precision and fixed-point sums leave against the double-precision reference of the same algorithm is below 3e-5.
//! Where a pixel's optical depth is above some hundred no fragment has more than the least weight, which for one of opacity α is
//! 1024 α steps: of very many very faint fibres the colour is rounded.

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::Module;
use crate::transparency::{Fragments, Needs};

const RANGE: Emission = Emission {
    label: "pelage.transparency.moment.range",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/moment_transmittance",
        "transparency/moment_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const MOMENTS: Emission = Emission {
    label: "pelage.transparency.moment.moments",
    stage: 1,
    ..RANGE
};
const COLOUR: Emission = Emission {
    label: "pelage.transparency.moment.colour",
    stage: 2,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/shaded",
        "transparency/moment_transmittance",
        "transparency/moment_emit_colour",
    ],
    ..RANGE
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 3] = [RANGE, MOMENTS, COLOUR];

/// Words a pixel of the sums of moments and of colours; `MOMENT_WORDS` and `MOMENT_COLOUR_WORDS` in WGSL.
const MOMENT_WORDS: u64 = 6;
const COLOUR_WORDS: u64 = 6;

/// Settings of moment-based transparency. It takes 56 bytes a pixel whatever the hair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Moment {
    /// The rasteriser.
    pub raster: Raster,
}

pub(crate) fn needs(pixels: u64) -> Needs {
    Needs {
        fill: pixels * 4,
        links: pixels * 4,
        overflow: pixels * 4 * COLOUR_WORDS,
        fragments: Fragments::Fixed(pixels * 4 * MOMENT_WORDS),
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
    let pixels = u64::from(plan.width) * u64::from(band.rows);
    passes.encode("pelage.transparency.moment.clear", |encoder| {
        for (buffer, words) in [
            (&bound.pixels.fill, 1),
            (&bound.pixels.links, 1),
            (&bound.pixels.overflow, COLOUR_WORDS),
            (&bound.pixels.fragments[0], MOMENT_WORDS),
        ] {
            encoder.clear_buffer(&buffer.buffer, 0, Some(pixels * 4 * words));
        }
        bound.clear_counters(encoder);
    });
    for emission in &EMISSIONS {
        raster::record(gpu, passes, bound, emission, draw, plan)?;
    }
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(pixels: Module) -> Module {
    pixels.and(&["transparency/moment_transmittance", "transparency/moment"])
}
