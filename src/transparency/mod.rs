//! Transparency techniques: how a pixel's fragments become one colour.

pub mod a_buffer;
pub mod dbk_buffer;
pub mod opaque;

pub use a_buffer::{ABuffer, Storage};
pub use dbk_buffer::DbkBuffer;
pub use opaque::Opaque;

use crate::error::Result;
use crate::gpu::{Gpu, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{Draw, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};

/// A transparency technique with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Transparency {
    /// The nearest fragment's colour at the pixel's whole opacity.
    Opaque(Opaque),
    /// Every fragment stored, sorted and composited.
    ABuffer(ABuffer),
    /// As the A-buffer, but that nothing is stored behind the depth from which on it changes a pixel by less than a tolerance.
    DbkBuffer(DbkBuffer),
}

impl Default for Transparency {
    fn default() -> Self {
        Self::ABuffer(ABuffer::default())
    }
}

impl Transparency {
    /// The stem of the technique's files.
    pub fn stem(&self) -> &'static str {
        match self {
            Self::Opaque(_) => "opaque",
            Self::ABuffer(_) => "a_buffer",
            Self::DbkBuffer(_) => "dbk_buffer",
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// A setting out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::Opaque(_) => Ok(()),
            Self::ABuffer(settings) => settings.validate(),
            Self::DbkBuffer(settings) => settings.validate(),
        }
    }

    /// The rasteriser that the settings ask for.
    pub fn raster(&self) -> Raster {
        match self {
            Self::Opaque(settings) => settings.raster,
            Self::ABuffer(settings) => settings.raster,
            Self::DbkBuffer(settings) => settings.raster,
        }
    }
}

/// What a technique asks of the pixels' buffers, in bytes for a band of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Needs {
    pub fill: u64,
    pub links: u64,
    pub overflow: u64,
    pub fragments: Fragments,
}

/// What a technique asks of the fragments' buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fragments {
    /// So many bytes, in the first part alone.
    Fixed(u64),
    /// A pool of fragments of [`a_buffer::FRAGMENT_BYTES`], as large as they are expected to need.
    Pool {
        /// A word of links for each fragment.
        linked: bool,
        /// As large as the host says.
        bytes: Option<u64>,
    },
}

impl Fragments {
    /// Whether fragments that do not fit are merged, and the pool's state is one counter of nodes.
    pub fn linked(&self) -> bool {
        matches!(self, Self::Pool { linked: true, .. })
    }
}

impl Transparency {
    /// What the technique asks for `pixels` pixels.
    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        match self {
            Self::Opaque(_) => opaque::needs(pixels),
            Self::ABuffer(settings) => settings.needs(pixels),
            Self::DbkBuffer(settings) => settings.needs(pixels),
        }
    }

    /// Optical depth beyond which the technique stores nothing; 0 where it does not ask.
    pub(crate) fn cut_depth(&self) -> f32 {
        match self {
            Self::DbkBuffer(settings) => settings.cut_depth(),
            _ => 0.0,
        }
    }

    /// Host units behind the nearest fragment beyond which the technique stores nothing; 0 where it does not ask.
    pub(crate) fn depth_shift(&self) -> f32 {
        match self {
            Self::DbkBuffer(settings) => settings.depth_shift.unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// The most pixels of which each buffer of the technique fits into `binding` bytes.
    pub(crate) fn most_pixels(&self, binding: u64) -> u64 {
        // A part of the bytes may be for each block of pixels, so that the estimate from many is fair.
        const MANY: u64 = 1 << 20;
        let needs = self.needs(MANY);
        let fixed = match needs.fragments {
            Fragments::Fixed(bytes) => bytes,
            Fragments::Pool { .. } => 0,
        };
        let largest = needs.fill.max(needs.links).max(needs.overflow).max(fixed);
        // A little is kept for what is rounded up.
        (u128::from(binding.saturating_sub(1024)) * u128::from(MANY) / u128::from(largest.max(1)))
            as u64
    }
}

/// What a band's fragments are drawn into, and by which rasteriser.
fn draw<'a>(band: &'a Band, plan: &Plan) -> Draw<'a> {
    Draw {
        rasteriser: plan.rasteriser,
        splits: plan.splits,
        size: [plan.width, plan.height],
        rows: [band.first, band.rows],
        drawings: &band.drawings,
        on_overflow: false,
    }
}

/// What must be known of a band's fragments before they are stored: their number, and which can be seen.
pub(crate) fn count(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
) -> Result<()> {
    let draw = draw(band, plan);
    match &plan.transparency {
        Transparency::Opaque(_) => Ok(()),
        Transparency::ABuffer(settings) => {
            a_buffer::count(gpu, passes, bound, band, &draw, plan, settings.storage)
        }
        Transparency::DbkBuffer(settings) if plan.cuts => {
            dbk_buffer::count(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::DbkBuffer(_) => {
            a_buffer::count(gpu, passes, bound, band, &draw, plan, Storage::Counted)
        }
    }
}

/// Fragments of a band of rows into the technique's buffers.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
) -> Result<()> {
    let draw = draw(band, plan);
    match &plan.transparency {
        Transparency::Opaque(_) => opaque::record(gpu, passes, bound, band, &draw, plan),
        Transparency::ABuffer(settings) => {
            a_buffer::record(gpu, passes, bound, band, &draw, plan, settings.storage)
        }
        Transparency::DbkBuffer(settings) if plan.cuts => {
            dbk_buffer::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::DbkBuffer(_) => {
            a_buffer::record(gpu, passes, bound, band, &draw, plan, Storage::Counted)
        }
    }
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(transparency: &Transparency, parts: u32) -> Module {
    let common =
        Module::new(&["common/pixels", "transparency/shaded"]).with("PARTS", Constant::U32(parts));
    match transparency {
        Transparency::Opaque(_) => common.and(&["transparency/opaque"]),
        Transparency::ABuffer(settings) => a_buffer::resolve_module(common, settings.storage),
        Transparency::DbkBuffer(settings) => dbk_buffer::resolve_module(common, settings),
    }
}

/// What tells one technique's composite pipeline from another's: its place in the enum, and eight bits of settings.
pub(crate) fn resolve_variant(transparency: &Transparency) -> u32 {
    let (technique, settings) = match transparency {
        Transparency::Opaque(_) => (0, 0),
        Transparency::ABuffer(settings) => (1, u32::from(settings.storage == Storage::Lists)),
        Transparency::DbkBuffer(settings) => (2, u32::from(settings.depth_shift.is_some())),
    };
    technique << 8 | settings
}
