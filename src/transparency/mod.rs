//! Transparency techniques: how a pixel's fragments become one colour.

pub mod a_buffer;
pub mod dbk_buffer;
pub mod depth_peeling;
pub mod k_buffer;
pub mod k_buffer_single_pass;
pub mod k_plus_buffer;
pub mod moment;
pub(crate) mod nearest;
pub mod opaque;
pub mod random_subsets;
pub mod sorted_blending;
pub mod weighted_blended;

pub use a_buffer::{ABuffer, Storage};
pub use dbk_buffer::{Culling, DbkBuffer};
pub use depth_peeling::DepthPeeling;
pub use k_buffer::{KBuffer, Rest, Selection};
pub use k_buffer_single_pass::KBufferSinglePass;
pub use k_plus_buffer::{Atomics, KPlusBuffer};
pub use moment::Moment;
pub use opaque::Opaque;
pub use random_subsets::RandomSubsets;
pub use sorted_blending::{BlendOrder, SortedBlending};
pub use weighted_blended::{Weight, WeightedBlended};

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{Draw, Raster};
use crate::resources::Bound;
use crate::shader::Module;
use crate::shading::Shader;

/// A transparency technique with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Transparency {
    /// The nearest fragment's colour at the pixel's whole opacity.
    Opaque(Opaque),
    /// Every fragment stored, sorted and composited.
    ABuffer(ABuffer),
    /// A mean of all fragments, weighed by depth, at their exact opacity.
    WeightedBlended(WeightedBlended),
    /// The nearest fragments found one after the other, the rest merged.
    DepthPeeling(DepthPeeling),
    /// The nearest fragment of each of some random subsets of the strands.
    RandomSubsets(RandomSubsets),
    /// Segments sorted into bins of depth, and blended in that order.
    SortedBlending(SortedBlending),
    /// Every fragment stored, the K nearest of each pixel sorted and composited.
    KBuffer(KBuffer),
    /// The K nearest fragments of each pixel stored and composited.
    KPlusBuffer(KPlusBuffer),
    /// Fragments linked in order as they come, unless K nearer ones are there.
    KBufferSinglePass(KBufferSinglePass),
    /// No fragment stored: colours weighted by a transmittance that moments of optical depth give.
    Moment(Moment),
    /// As the A-buffer, but that nothing is stored behind the depth from which on it changes a pixel by less than a tolerance.
    DbkBuffer(DbkBuffer),
}

impl Default for Transparency {
    fn default() -> Self {
        Self::DbkBuffer(DbkBuffer::default())
    }
}

impl Transparency {
    /// The stem of the technique's files.
    pub fn stem(&self) -> &'static str {
        match self {
            Self::Opaque(_) => "opaque",
            Self::ABuffer(_) => "a_buffer",
            Self::WeightedBlended(_) => "weighted_blended",
            Self::DepthPeeling(_) => "depth_peeling",
            Self::RandomSubsets(_) => "random_subsets",
            Self::SortedBlending(_) => "sorted_blending",
            Self::KBuffer(_) => "k_buffer",
            Self::KPlusBuffer(_) => "k_plus_buffer",
            Self::KBufferSinglePass(_) => "k_buffer_single_pass",
            Self::Moment(_) => "moment",
            Self::DbkBuffer(_) => "dbk_buffer",
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// A setting out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::Opaque(_) | Self::Moment(_) => Ok(()),
            Self::ABuffer(settings) => settings.validate(),
            Self::WeightedBlended(settings) => settings.validate(),
            Self::DepthPeeling(settings) => settings.validate(),
            Self::RandomSubsets(settings) => settings.validate(),
            Self::SortedBlending(settings) => settings.validate(),
            Self::KBuffer(settings) => settings.validate(),
            Self::KPlusBuffer(settings) => settings.validate(),
            Self::KBufferSinglePass(settings) => settings.validate(),
            Self::DbkBuffer(settings) => settings.validate(),
        }
    }

    /// Checks that a device can do what the settings ask for.
    pub(crate) fn fits(&self, gpu: &Gpu) -> Result<()> {
        match self {
            Self::KPlusBuffer(settings) => settings.fits(gpu),
            _ => Ok(()),
        }
    }

    /// The rasteriser that the settings ask for.
    pub fn raster(&self) -> Raster {
        match self {
            Self::Opaque(settings) => settings.raster,
            Self::ABuffer(settings) => settings.raster,
            Self::WeightedBlended(settings) => settings.raster,
            Self::DepthPeeling(settings) => settings.raster,
            Self::RandomSubsets(settings) => settings.raster,
            // For what is sought beside the picture.
            Self::SortedBlending(_) => Raster::Auto,
            Self::KBuffer(settings) => settings.raster,
            Self::KPlusBuffer(settings) => settings.raster,
            Self::KBufferSinglePass(settings) => settings.raster,
            Self::Moment(settings) => settings.raster,
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
    /// So many bytes, in the first buffer alone.
    Fixed(u64),
    /// So many bytes in each of the two.
    Halves(u64),
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

    /// Whether there is a pool, which may be too small.
    pub fn pooled(&self) -> bool {
        matches!(self, Self::Pool { .. })
    }
}

impl Transparency {
    /// What the technique asks for `pixels` pixels.
    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        match self {
            Self::Opaque(_) => opaque::needs(pixels),
            Self::ABuffer(settings) => settings.needs(pixels),
            Self::WeightedBlended(_) => weighted_blended::needs(pixels),
            Self::DepthPeeling(_) => depth_peeling::needs(pixels),
            Self::RandomSubsets(settings) => settings.needs(pixels),
            Self::SortedBlending(_) => sorted_blending::NEEDS,
            Self::KBuffer(settings) => settings.stored().needs(pixels),
            Self::KPlusBuffer(settings) => settings.needs(pixels),
            Self::KBufferSinglePass(settings) => settings.needs(pixels),
            Self::Moment(_) => moment::needs(pixels),
            Self::DbkBuffer(settings) => settings.needs(pixels),
        }
    }

    /// Fragments that a pool should hold of those that a frame is expected to produce in `pixels` pixels.
    pub(crate) fn expected(&self, fragments: u64, pixels: u64) -> u64 {
        match self {
            Self::KBufferSinglePass(settings) => settings.expected(fragments, pixels),
            _ => fragments,
        }
    }

    /// Optical depth beyond which the technique stores nothing; 0 where it does not ask.
    pub(crate) fn cut_depth(&self) -> f32 {
        match self {
            Self::DbkBuffer(settings) => settings.cut_depth(),
            _ => 0.0,
        }
    }

    /// The transmittance behind which no fragment is composited: the A-buffer's, or the tolerance that the host gives.
    pub(crate) fn unseen(&self) -> f32 {
        match self {
            Self::DbkBuffer(settings) if settings.depth_shift.is_none() => settings.epsilon,
            _ => a_buffer::UNSEEN,
        }
    }

    /// Host units behind the nearest fragment beyond which the technique stores nothing; 0 where it does not ask.
    pub(crate) fn depth_shift(&self) -> f32 {
        match self {
            Self::DbkBuffer(settings) => settings.depth_shift.unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Whether the technique asks for colours in its resolve alone, where fragments can be shaded at their own places.
    pub(crate) fn shades_fragments(&self) -> bool {
        match self {
            Self::Opaque(_) | Self::ABuffer(_) | Self::KBuffer(_) | Self::DbkBuffer(_) => true,
            Self::KPlusBuffer(settings) => settings.rest != Rest::Merged,
            Self::KBufferSinglePass(_)
            | Self::Moment(_)
            | Self::WeightedBlended(_)
            | Self::DepthPeeling(_)
            | Self::RandomSubsets(_)
            | Self::SortedBlending(_) => false,
        }
    }

    /// Whether fragments lie in counted arrays, by which a tile without hair is known.
    pub(crate) fn counted(&self) -> bool {
        match self {
            Self::ABuffer(settings) => settings.storage == Storage::Counted,
            Self::KBuffer(settings) => settings.storage == Storage::Counted,
            Self::DbkBuffer(_) => true,
            _ => false,
        }
    }

    /// Whether each pixel's nearest fragment must be sought beside the technique, where a frame asks for it.
    pub(crate) fn seeks_nearest(&self) -> bool {
        matches!(
            self,
            Self::WeightedBlended(_) | Self::DepthPeeling(_) | Self::SortedBlending(_)
        )
    }

    /// The settings as the shaders read them: `frame.technique`.
    pub(crate) fn values(&self) -> [f32; 4] {
        match self {
            Self::WeightedBlended(settings) => settings.values(),
            Self::RandomSubsets(settings) => settings.values(),
            // Sorted blending's are the plan's.
            _ => [0.0; 4],
        }
    }

    /// What strands' hashes are made with: `frame.seed`.
    pub(crate) fn seed(&self) -> u32 {
        match self {
            Self::RandomSubsets(settings) => settings.seed,
            _ => 0,
        }
    }
}

impl Needs {
    /// The most pixels of which each buffer fits into `binding` bytes, from what many need: a part of the bytes may be for
    /// each block of pixels.
    pub(crate) fn most_pixels(of: impl Fn(u64) -> Needs, binding: u64) -> u64 {
        const MANY: u64 = 1 << 20;
        let needs = of(MANY);
        let fixed = match needs.fragments {
            Fragments::Fixed(bytes) | Fragments::Halves(bytes) => bytes,
            Fragments::Pool { .. } => 0,
        };
        let largest = needs.fill.max(needs.links).max(needs.overflow).max(fixed);
        // A little is kept for what is rounded up.
        (u128::from(binding.saturating_sub(1024)) * u128::from(MANY) / u128::from(largest.max(1)))
            as u64
    }
}

/// The bind group that the composite reads.
pub(crate) fn read_group(transparency: &Transparency) -> Group {
    match transparency {
        Transparency::SortedBlending(_) => Group::BlendedRead,
        _ => Group::PixelsRead,
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
        Transparency::Opaque(_)
        | Transparency::KPlusBuffer(_)
        | Transparency::KBufferSinglePass(_)
        | Transparency::Moment(_)
        | Transparency::WeightedBlended(_)
        | Transparency::DepthPeeling(_)
        | Transparency::RandomSubsets(_)
        | Transparency::SortedBlending(_) => Ok(()),
        Transparency::ABuffer(settings) => {
            a_buffer::count(gpu, passes, bound, band, &draw, plan, settings.storage)
        }
        Transparency::KBuffer(settings) => {
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
        Transparency::WeightedBlended(_) => {
            weighted_blended::record(gpu, passes, bound, band, &draw, plan)
        }
        Transparency::DepthPeeling(settings) => {
            depth_peeling::record(gpu, passes, bound, band, &draw, plan, settings.peels)
        }
        Transparency::RandomSubsets(settings) => {
            random_subsets::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::SortedBlending(settings) => {
            sorted_blending::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::KBuffer(settings) => {
            a_buffer::record(gpu, passes, bound, band, &draw, plan, settings.storage)
        }
        Transparency::KPlusBuffer(settings) => {
            k_plus_buffer::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::KBufferSinglePass(settings) => {
            k_buffer_single_pass::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::Moment(_) => moment::record(gpu, passes, bound, band, &draw, plan),
        Transparency::DbkBuffer(settings) if plan.cuts => {
            dbk_buffer::record(gpu, passes, bound, band, &draw, plan, settings)
        }
        Transparency::DbkBuffer(_) => {
            a_buffer::record(gpu, passes, bound, band, &draw, plan, Storage::Counted)
        }
    }
}

/// The file that supplies the colour of what has overflowed a pool.
pub(crate) fn tail(shader: Option<&Shader>) -> &'static str {
    match shader {
        None => "transparency/tail_sums",
        Some(_) => "transparency/tail_samples",
    }
}

/// The files that supply `resolve(pixel)`; with a shader, fragments are shaded there.
pub(crate) fn resolve_module(transparency: &Transparency, shader: Option<&Shader>) -> Module {
    let pixels = Module::new(&["common/pixels"]);
    let shaded = match shader {
        None => Module::new(&["transparency/shaded"]),
        Some(shader) => shader.fragments_module(),
    };
    let common = shaded.and(&["common/pixels"]);
    match transparency {
        Transparency::Opaque(_) => common.and(&["transparency/opaque"]),
        Transparency::ABuffer(settings) => {
            a_buffer::resolve_module(common, settings.storage, shader)
        }
        Transparency::KBuffer(settings) => k_buffer::resolve_module(common, settings, shader),
        Transparency::KPlusBuffer(settings) => k_plus_buffer::resolve_module(common, settings),
        Transparency::KBufferSinglePass(settings) => {
            k_buffer_single_pass::resolve_module(common, settings)
        }
        Transparency::Moment(_) => moment::resolve_module(pixels),
        Transparency::WeightedBlended(_) => weighted_blended::resolve_module(pixels),
        Transparency::DepthPeeling(_) => depth_peeling::resolve_module(common),
        Transparency::RandomSubsets(settings) => random_subsets::resolve_module(common, settings),
        Transparency::SortedBlending(_) => sorted_blending::resolve_module(pixels),
        Transparency::DbkBuffer(settings) => dbk_buffer::resolve_module(common, settings, shader),
    }
}

/// What tells one technique's composite pipeline from another's: a number, and twelve bits of settings.
pub(crate) fn resolve_variant(transparency: &Transparency) -> u32 {
    let (technique, settings) = match transparency {
        Transparency::Opaque(_) => (0, 0),
        Transparency::ABuffer(settings) => (1, u32::from(settings.storage == Storage::Lists)),
        Transparency::DbkBuffer(settings) => (2, u32::from(settings.depth_shift.is_some())),
        Transparency::KBuffer(settings) => (3, settings.variant()),
        Transparency::KPlusBuffer(settings) => (4, settings.variant()),
        Transparency::KBufferSinglePass(settings) => (5, settings.variant()),
        Transparency::Moment(_) => (6, 0),
        Transparency::WeightedBlended(_) => (7, 0),
        Transparency::DepthPeeling(_) => (8, 0),
        Transparency::RandomSubsets(settings) => (9, settings.subsets),
        Transparency::SortedBlending(_) => (10, 0),
    };
    technique << 12 | settings
}
