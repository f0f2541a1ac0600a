//! Weighted blended: one pass without any order, the colour a mean weighed by depth (McGuire and Bavoil 2013).

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::Module;
use crate::transparency::{Fragments, Needs, nearest};

const SUM: Emission = Emission {
    label: "pelage.transparency.weighted_blended.sum",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/shaded",
        "transparency/weighted_blended_sums",
        "transparency/weighted_blended_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 1] = [SUM];

/// Words of a pixel's sums; `WEIGHTED_BLENDED_WORDS` in WGSL.
const WORDS: u64 = 7;

/// What a fragment weighs at the place d in the hair's extent along the view's axis: 0 at its near end, 1 at its far one. No
/// weight is below 1/1024 of the largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// 1: the mean colour of all fragments (Bavoil and Myers 2008).
    Uniform,
    /// α (1 - d)³: McGuire and Bavoil's equation 10, α being the fragment's opacity.
    Cubic,
    /// exp(-falloff d), as light falls off in an even volume of that optical depth. From 0 to 100.
    Exponential {
        /// The optical depth.
        falloff: f32,
    },
}

/// Settings of weighted blended transparency. 28 bytes a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedBlended {
    /// The weight of a fragment by its depth.
    pub weight: Weight,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for WeightedBlended {
    /// The falloff that errs least on the built-in straight groom: RMSE 0.013 at opacity 0.3 and 0.018 at 1, where 12 gives 0.019
    /// and 0.021, and a uniform weight 0.013 and 0.029.
    fn default() -> Self {
        Self {
            weight: Weight::Exponential { falloff: 4.0 },
            raster: Raster::Auto,
        }
    }
}

impl WeightedBlended {
    pub(crate) fn validate(&self) -> Result<()> {
        match self.weight {
            Weight::Exponential { falloff } if !(0.0..=100.0).contains(&falloff) => {
                invalid!("weighted_blended: falloff {falloff} is not within 0 and 100")
            }
            _ => Ok(()),
        }
    }

    /// As the shaders read them.
    pub(crate) fn values(&self) -> [f32; 4] {
        match self.weight {
            Weight::Uniform => [0.0; 4],
            Weight::Cubic => [1.0, 0.0, 0.0, 0.0],
            Weight::Exponential { falloff } => [2.0, falloff, 0.0, 0.0],
        }
    }
}

pub(crate) fn needs(pixels: u64) -> Needs {
    Needs {
        fill: 0,
        links: 0,
        overflow: pixels * 4 * WORDS,
        fragments: Fragments::Fixed(0),
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
    let bytes = u64::from(plan.width) * u64::from(band.rows) * 4 * WORDS;
    passes.encode("pelage.transparency.weighted_blended.clear", |encoder| {
        encoder.clear_buffer(&bound.pixels.overflow.buffer, 0, Some(bytes));
        bound.clear_counters(encoder);
    });
    raster::record(gpu, passes, bound, &SUM, draw, plan)?;
    nearest::record(gpu, passes, bound, band, draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module) -> Module {
    common.and(&[
        "transparency/nearest",
        "transparency/weighted_blended_sums",
        "transparency/weighted_blended",
    ])
}
