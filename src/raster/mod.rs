//! Rasterisers: two ways to find the same fragments, each of which hands them to a technique's `emit`.

mod ribbons;
mod walk;

pub(crate) use ribbons::ATTACHMENT;

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes};
use crate::layout::Counters;
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::ShadingRate;

/// How segments become fragments. Both find the same ones; they differ in speed only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Raster {
    /// The walk, except where fibres are wider than some pixels.
    #[default]
    Auto,
    /// Camera-facing instanced triangle strips.
    Ribbons,
    /// A compute pass in which one invocation walks the pixels of one segment.
    Walk,
}

/// A rasteriser that has been chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Rasteriser {
    Ribbons,
    Walk,
}

/// Half-widths in pixels beyond which the hardware's triangles beat one invocation a segment.
const WIDE_HALF_WIDTH_PX: f64 = 12.0;

impl Raster {
    /// Chooses for fibres of at most this half-width.
    pub(crate) fn choose(self, half_width_px: f64) -> Rasteriser {
        match self {
            Self::Ribbons => Rasteriser::Ribbons,
            Self::Walk => Rasteriser::Walk,
            Self::Auto if half_width_px > WIDE_HALF_WIDTH_PX => Rasteriser::Ribbons,
            Self::Auto => Rasteriser::Walk,
        }
    }
}

/// One stage of a technique that takes fragments.
pub(crate) struct Emission {
    pub label: &'static str,
    /// The value of `STAGE` in the module, which may hold settings beside the stage's own number.
    pub stage: u32,
    /// The files that supply `emit_begin`, `emit` and `emit_end`.
    pub files: &'static [&'static str],
    /// The bind group that they write.
    pub group: Group,
    /// Coverage is not asked for, only whether a fibre touches a pixel.
    pub touch_only: bool,
    /// What of a pixel is looked at.
    pub footprint: Footprint,
}

/// What of a pixel a fibre is held against: `FOOTPRINT_…` in WGSL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Footprint {
    /// The square: what a picture wants.
    Square = 0,
    /// The line through its centre across the fibre's major axis: all that a thin fibre covers of a slice of pixels is in one of
    /// them. Enough for a map, whose texels are averaged, and cheaper.
    Slice = 1,
    /// The centre alone, as the hardware samples a triangle. Only with `touch_only`.
    Centre = 2,
}

/// The file by which colours of what overflows are summed as fragments are found, and the one where no colours are known then.
const TAIL_SUMS: &str = "transparency/tail_sums_emit";
const TAIL_SAMPLES: &str = "transparency/tail_samples_emit";

impl Emission {
    /// Whether its files depend on the rate of shading.
    fn has_tail(&self) -> bool {
        self.files.contains(&TAIL_SUMS)
    }

    /// What tells its pipelines apart.
    fn variant(&self, plan: &Plan) -> u32 {
        let unshaded = plan.shader.rate == ShadingRate::Fragment && self.has_tail();
        self.stage << 1 | u32::from(unshaded)
    }

    pub(crate) fn module(&self, rasteriser: &'static str, rate: ShadingRate) -> Module {
        let unshaded = rate == ShadingRate::Fragment && self.has_tail();
        let file = |file: &&'static str| match *file {
            "transparency/shaded" if unshaded => None,
            TAIL_SUMS if unshaded => Some(TAIL_SAMPLES),
            file => Some(file),
        };
        let files: Vec<&'static str> = self.files.iter().filter_map(file).collect();
        Module::new(&[
            "common/coverage",
            "common/run",
            "common/segment",
            "common/spread",
        ])
        .with("STAGE", Constant::U32(self.stage))
        .with("TOUCH_ONLY", Constant::Bool(self.touch_only))
        .with("FOOTPRINT", Constant::U32(self.footprint as u32))
        .and(&files)
        .and(&[rasteriser])
    }
}

/// What is rasterised: every run of the frame, by its drawings, over an image of `size` pixels.
pub(crate) struct Draw<'a> {
    pub rasteriser: Rasteriser,
    pub splits: u32,
    pub size: [u32; 2],
    /// First row and number of rows that are drawn.
    pub rows: [u32; 2],
    pub drawings: &'a [u32],
    /// Take the counts from the frame's counters: nothing is drawn unless the pool overflowed.
    pub on_overflow: bool,
}

/// Where the counters' copy holds the arguments of walks and of ribbons.
const WALK_ARGUMENTS: u64 = std::mem::offset_of!(Counters, walk_arguments) as u64;
const RIBBON_ARGUMENTS: u64 = std::mem::offset_of!(Counters, ribbon_arguments) as u64;

/// Hands every fragment of a drawing to an emission.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    emission: &Emission,
    draw: &Draw,
    plan: &Plan,
) -> Result<()> {
    match draw.rasteriser {
        Rasteriser::Walk => walk::record(gpu, passes, bound, emission, draw, plan),
        Rasteriser::Ribbons => ribbons::record(gpu, passes, bound, emission, draw, plan),
    }
}
