//! Random subsets of the strands, each drawn as if it were opaque, and composited in order (Hunz §5.4).
//!
//! Hunz's figures (his §6.3.3), k = 8 at 656×861: RGBA16 tangents take 34.47 MiB; with his 16-bit depth buffers it is 43.09. Here
//! a subset of a pixel is a fragment's word of 8 bytes, with its depth: 34.47 MiB, and 2.15 for `exact_alpha`.

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::transparency::{Fragments, Needs};

const NEAREST: Emission = Emission {
    label: "pelage.transparency.random_subsets.nearest",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/shaded",
        "transparency/fragment_word",
        "transparency/random_subsets_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const WINNER: Emission = Emission {
    label: "pelage.transparency.random_subsets.winner",
    stage: 1,
    ..NEAREST
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 2] = [NEAREST, WINNER];

/// The most subsets.
pub const MAX_SUBSETS: u32 = 32;

/// Settings of random subsets. 8 bytes a pixel and subset, and 4 a pixel for the exact opacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RandomSubsets {
    /// Subsets, from 1 to [`MAX_SUBSETS`].
    pub subsets: u32,
    /// What strands are parted by: another seed, another picture.
    pub seed: u32,
    /// Whether a pixel has the opacity of all its fragments, its colour scaled to it; otherwise, as published, only the
    /// opacity of the fragments that were kept.
    pub exact_alpha: bool,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for RandomSubsets {
    fn default() -> Self {
        Self {
            subsets: 8,
            seed: 0,
            exact_alpha: true,
            raster: Raster::Auto,
        }
    }
}

impl RandomSubsets {
    pub(crate) fn validate(&self) -> Result<()> {
        if !(1..=MAX_SUBSETS).contains(&self.subsets) {
            return invalid!(
                "random_subsets: subsets {} is not within 1 and {MAX_SUBSETS}",
                self.subsets
            );
        }
        Ok(())
    }

    /// As the shaders read them.
    pub(crate) fn values(&self) -> [f32; 4] {
        [
            self.subsets as f32,
            f32::from(u8::from(self.exact_alpha)),
            0.0,
            0.0,
        ]
    }

    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        Needs {
            fill: if self.exact_alpha { pixels * 4 } else { 0 },
            links: 0,
            overflow: 0,
            fragments: Fragments::Halves(pixels * 4 * u64::from(self.subsets)),
        }
    }
}

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &RandomSubsets,
) -> Result<()> {
    let needs = settings.needs(u64::from(plan.width) * u64::from(band.rows));
    let Fragments::Halves(halves) = needs.fragments else {
        return Ok(());
    };
    passes.encode("pelage.transparency.random_subsets.clear", |encoder| {
        let pixels = bound.pixels;
        if settings.exact_alpha {
            encoder.clear_buffer(&pixels.fill.buffer, 0, Some(needs.fill));
        }
        for half in &pixels.fragments {
            encoder.clear_buffer(&half.buffer, 0, Some(halves));
        }
        bound.clear_counters(encoder);
    });
    raster::record(gpu, passes, bound, &NEAREST, draw, plan)?;
    raster::record(gpu, passes, bound, &WINNER, draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module, settings: &RandomSubsets) -> Module {
    common
        .and(&["transparency/fragment_word", "transparency/random_subsets"])
        .with("SUBSETS", Constant::U32(settings.subsets))
}
