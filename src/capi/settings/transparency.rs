//! A transparency technique with its settings.

use std::ptr::null;

use super::{PELAGE_RASTER_AUTO, raster, settings, switch};
use crate::capi::descriptor::{self, descriptor};
use crate::capi::input::reserved;
use crate::error::{Result, invalid};
use crate::transparency::{
    ABuffer, Atomics, BlendOrder, Culling, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass,
    KPlusBuffer, Moment, Opaque, RandomSubsets, Rest, Selection, SortedBlending, Storage,
    Transparency, Weight, WeightedBlended,
};

/// The nearest fragment's colour at the pixel's whole opacity.
pub const PELAGE_TRANSPARENCY_OPAQUE: u32 = 0;
/// Every fragment stored, sorted and composited.
pub const PELAGE_TRANSPARENCY_A_BUFFER: u32 = 1;
/// As the A-buffer, but that nothing is stored behind the depth from which on it changes a pixel by less than a tolerance.
pub const PELAGE_TRANSPARENCY_DBK_BUFFER: u32 = 10;
/// McGuire and Bavoil 2013: the mean of all fragments weighed by depth, at their exact opacity.
pub const PELAGE_TRANSPARENCY_WEIGHTED_BLENDED: u32 = 4;
/// Everitt 2001: the nearest fragments found one after the other, the rest merged.
pub const PELAGE_TRANSPARENCY_DEPTH_PEELING: u32 = 5;
/// Hunz 2016: the nearest fragment of each of some random subsets of the strands.
pub const PELAGE_TRANSPARENCY_RANDOM_SUBSETS: u32 = 3;
/// Kim 2003: segments sorted into bins of depth, and blended in that order.
pub const PELAGE_TRANSPARENCY_SORTED_BLENDING: u32 = 2;
/// Every fragment stored, the K nearest of each pixel sorted and composited (Yu et al. 2012).
pub const PELAGE_TRANSPARENCY_K_BUFFER: u32 = 6;
/// The K nearest fragments of each pixel stored and composited (Vasilakis and Fudos 2014, Hunz 2016).
pub const PELAGE_TRANSPARENCY_K_PLUS_BUFFER: u32 = 7;
/// Fragments linked in order as they come, unless K nearer ones are there (Yu et al. 2012).
pub const PELAGE_TRANSPARENCY_K_BUFFER_SINGLE_PASS: u32 = 8;
/// Colours weighted by a transmittance that moments of optical depth give (Muenstermann et al. 2018, Sharpe 2018).
pub const PELAGE_TRANSPARENCY_MOMENT: u32 = 9;

/// Fragments counted first, then stored side by side.
pub const PELAGE_STORAGE_COUNTED: u32 = 0;
/// Per-pixel linked lists.
pub const PELAGE_STORAGE_LISTS: u32 = 1;

/// Cut-offs are looked for where that saves time, or where `pool_bytes` or the device do not hold all fragments.
pub const PELAGE_CULLING_AUTO: u32 = 0;
/// They are looked for in every frame: the fewest fragments are stored.
pub const PELAGE_CULLING_ALWAYS: u32 = 1;

/// Every fragment weighs the same.
pub const PELAGE_WEIGHT_UNIFORM: u32 = 0;
/// Opacity times the third power of the distance from the hair's far end.
pub const PELAGE_WEIGHT_CUBIC: u32 = 1;
/// exp(-falloff d), d from 0 at the hair's near end to 1 at its far one.
pub const PELAGE_WEIGHT_EXPONENTIAL: u32 = 2;

/// Farthest segments first, each over what is there.
pub const PELAGE_BLEND_ORDER_BACK_TO_FRONT: u32 = 0;
/// Nearest segments first, each under what is there.
pub const PELAGE_BLEND_ORDER_FRONT_TO_BACK: u32 = 1;
/// What lies behind the K nearest is one layer of exact opacity, in the mean of its own colours.
pub const PELAGE_REST_MERGED: u32 = 0;
/// It is one layer of exact opacity, in the mean colour of the K.
pub const PELAGE_REST_ALPHA: u32 = 1;
/// It is left out, as published.
pub const PELAGE_REST_DROPPED: u32 = 2;

/// 64-bit atomics where the device was opened with them, else 32-bit ones.
pub const PELAGE_ATOMICS_AUTO: u32 = 0;
/// 64-bit atomics, in one pass; on a device without them rendering fails with PELAGE_UNSUPPORTED.
pub const PELAGE_ATOMICS_64: u32 = 1;
/// 32-bit atomics, in two passes.
pub const PELAGE_ATOMICS_32: u32 = 2;

/// One way through a pixel's list selects all K (Yu et al. 2012).
pub const PELAGE_SELECTION_REGISTERS: u32 = 0;
/// It selects eight.
pub const PELAGE_SELECTION_ROUNDS: u32 = 1;
/// It selects one: a selection sort (Yang et al. 2010), for comparison.
pub const PELAGE_SELECTION_SORT: u32 = 2;

/// Settings of the opaque technique.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageOpaque {
    /// `sizeof(PelageOpaque)`.
    pub struct_size: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageOpaque {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageOpaque, "PELAGE_OPAQUE_INIT", raster: u32);

/// Settings of the A-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageABuffer {
    /// `sizeof(PelageABuffer)`.
    pub struct_size: u32,
    /// `PELAGE_STORAGE_…`.
    pub storage: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// 0.
    pub reserved: u32,
    /// Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
}

impl Default for PelageABuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            storage: PELAGE_STORAGE_COUNTED,
            raster: PELAGE_RASTER_AUTO,
            reserved: 0,
            pool_bytes: 0,
        }
    }
}

descriptor!(PelageABuffer, "PELAGE_A_BUFFER_INIT", pool_bytes: u64);

/// Settings of the DBK-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageDbkBuffer {
    /// `sizeof(PelageDbkBuffer)`.
    pub struct_size: u32,
    /// How much of a pixel's alpha, and of its culled hair's radiance, may be left out: from 1e-6 to 0.5.
    pub epsilon: f32,
    /// Above 0: what lies farther than this behind the nearest fragment, in host units along the ray, is drawn as one opaque
    /// layer, and `epsilon` is not asked. 0: `epsilon` decides.
    pub depth_shift: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
    /// `PELAGE_CULLING_…`; by a depth shift cut-offs are always looked for.
    pub culling: u32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageDbkBuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            epsilon: DbkBuffer::default().epsilon,
            depth_shift: 0.0,
            raster: PELAGE_RASTER_AUTO,
            pool_bytes: 0,
            culling: PELAGE_CULLING_AUTO,
            reserved: 0,
        }
    }
}

descriptor!(PelageDbkBuffer, "PELAGE_DBK_BUFFER_INIT", reserved: u32);

/// Settings of weighted blended transparency. 28 bytes a pixel.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageWeightedBlended {
    /// `sizeof(PelageWeightedBlended)`.
    pub struct_size: u32,
    /// `PELAGE_WEIGHT_…`.
    pub weight: u32,
    /// For `PELAGE_WEIGHT_EXPONENTIAL`, from 0 to 100: the hair's optical depth.
    pub falloff: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageWeightedBlended {
    fn default() -> Self {
        let falloff = match WeightedBlended::default().weight {
            Weight::Exponential { falloff } => falloff,
            _ => 0.0,
        };
        Self {
            struct_size: size_of::<Self>() as u32,
            weight: PELAGE_WEIGHT_EXPONENTIAL,
            falloff,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageWeightedBlended, "PELAGE_WEIGHTED_BLENDED_INIT", raster: u32);

/// Settings of depth peeling. 52 bytes a pixel.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageDepthPeeling {
    /// `sizeof(PelageDepthPeeling)`.
    pub struct_size: u32,
    /// Fragments of a pixel that are composited in their order, from 1 to 1024; what lies behind them is merged.
    pub peels: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageDepthPeeling {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            peels: DepthPeeling::default().peels,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageDepthPeeling, "PELAGE_DEPTH_PEELING_INIT", raster: u32);

/// Settings of random subsets. 8 bytes a pixel and subset, and 4 a pixel for the exact opacity.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageRandomSubsets {
    /// `sizeof(PelageRandomSubsets)`.
    pub struct_size: u32,
    /// Subsets, from 1 to 32.
    pub subsets: u32,
    /// What strands are parted by: another seed, another picture.
    pub seed: u32,
    /// 1: a pixel has the opacity of all its fragments; 0: as published, only that of those that are kept.
    pub exact_alpha: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageRandomSubsets {
    fn default() -> Self {
        let settings = RandomSubsets::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            subsets: settings.subsets,
            seed: settings.seed,
            exact_alpha: u32::from(settings.exact_alpha),
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageRandomSubsets, "PELAGE_RANDOM_SUBSETS_INIT", raster: u32);

/// Settings of sorted blending. It draws ribbons, whatever their width.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageSortedBlending {
    /// `sizeof(PelageSortedBlending)`.
    pub struct_size: u32,
    /// Bins of depth, from 1 to 4096.
    pub bins: u32,
    /// `PELAGE_BLEND_ORDER_…`.
    pub order: u32,
    /// Frames after a sorted one that take its order, as long as they draw the same hair; 0: every frame is sorted.
    pub reuse: u32,
    /// 0: blended as 16-bit floats, 8 bytes a pixel; 1: as 32-bit floats where the device blends these, 16 bytes a pixel.
    pub full_precision: u32,
}

impl Default for PelageSortedBlending {
    fn default() -> Self {
        let settings = SortedBlending::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            bins: settings.bins,
            order: PELAGE_BLEND_ORDER_BACK_TO_FRONT,
            reuse: settings.reuse,
            full_precision: u32::from(settings.full_precision),
        }
    }
}

descriptor!(PelageSortedBlending, "PELAGE_SORTED_BLENDING_INIT", full_precision: u32);

/// Settings of the k-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKBuffer {
    /// `sizeof(PelageKBuffer)`.
    pub struct_size: u32,
    /// Fragments of a pixel that keep their order, from 1 to 64.
    pub k: u32,
    /// `PELAGE_REST_…`.
    pub rest: u32,
    /// `PELAGE_SELECTION_…`; the picture does not depend on it.
    pub selection: u32,
    /// `PELAGE_STORAGE_…`.
    pub storage: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
}

impl Default for PelageKBuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            k: KBuffer::default().k,
            rest: PELAGE_REST_MERGED,
            selection: PELAGE_SELECTION_REGISTERS,
            storage: PELAGE_STORAGE_COUNTED,
            raster: PELAGE_RASTER_AUTO,
            pool_bytes: 0,
        }
    }
}

descriptor!(PelageKBuffer, "PELAGE_K_BUFFER_INIT", pool_bytes: u64);

/// Settings of the k+-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKPlusBuffer {
    /// `sizeof(PelageKPlusBuffer)`.
    pub struct_size: u32,
    /// Fragments of a pixel that are kept, from 1 to 64, in 8 bytes each.
    pub k: u32,
    /// `PELAGE_REST_…`.
    pub rest: u32,
    /// `PELAGE_ATOMICS_…`; the picture does not depend on it.
    pub atomics: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageKPlusBuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            k: KPlusBuffer::default().k,
            rest: PELAGE_REST_ALPHA,
            atomics: PELAGE_ATOMICS_AUTO,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageKPlusBuffer, "PELAGE_K_PLUS_BUFFER_INIT", raster: u32);

/// Settings of the single-pass k-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKBufferSinglePass {
    /// `sizeof(PelageKBufferSinglePass)`.
    pub struct_size: u32,
    /// Fragments of a pixel that keep their order, from 1 to 64.
    pub k: u32,
    /// `PELAGE_REST_…`.
    pub rest: u32,
    /// How often a fragment tries again, where others were faster, before it is merged: up to 255.
    pub retries: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// 0.
    pub reserved: u32,
    /// Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
}

impl Default for PelageKBufferSinglePass {
    fn default() -> Self {
        let KBufferSinglePass { k, retries, .. } = KBufferSinglePass::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            k,
            rest: PELAGE_REST_MERGED,
            retries,
            raster: PELAGE_RASTER_AUTO,
            reserved: 0,
            pool_bytes: 0,
        }
    }
}

descriptor!(PelageKBufferSinglePass, "PELAGE_K_BUFFER_SINGLE_PASS_INIT", pool_bytes: u64);

/// Settings of moment-based transparency.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageMoment {
    /// `sizeof(PelageMoment)`.
    pub struct_size: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageMoment {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageMoment, "PELAGE_MOMENT_INIT", raster: u32);

/// A transparency technique with its settings.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageTransparency {
    /// `sizeof(PelageTransparency)`.
    pub struct_size: u32,
    /// `PELAGE_TRANSPARENCY_…`.
    pub technique: u32,
    /// For `PELAGE_TRANSPARENCY_OPAQUE`; NULL: as `PELAGE_OPAQUE_INIT`.
    pub opaque: *const PelageOpaque,
    /// For `PELAGE_TRANSPARENCY_A_BUFFER`; NULL: as `PELAGE_A_BUFFER_INIT`.
    pub a_buffer: *const PelageABuffer,
    /// For `PELAGE_TRANSPARENCY_DBK_BUFFER`; NULL: as `PELAGE_DBK_BUFFER_INIT`.
    pub dbk_buffer: *const PelageDbkBuffer,
    /// For `PELAGE_TRANSPARENCY_WEIGHTED_BLENDED`; NULL: as `PELAGE_WEIGHTED_BLENDED_INIT`.
    pub weighted_blended: *const PelageWeightedBlended,
    /// For `PELAGE_TRANSPARENCY_DEPTH_PEELING`; NULL: as `PELAGE_DEPTH_PEELING_INIT`.
    pub depth_peeling: *const PelageDepthPeeling,
    /// For `PELAGE_TRANSPARENCY_RANDOM_SUBSETS`; NULL: as `PELAGE_RANDOM_SUBSETS_INIT`.
    pub random_subsets: *const PelageRandomSubsets,
    /// For `PELAGE_TRANSPARENCY_SORTED_BLENDING`; NULL: as `PELAGE_SORTED_BLENDING_INIT`.
    pub sorted_blending: *const PelageSortedBlending,
    /// For `PELAGE_TRANSPARENCY_K_BUFFER`; NULL: as `PELAGE_K_BUFFER_INIT`.
    pub k_buffer: *const PelageKBuffer,
    /// For `PELAGE_TRANSPARENCY_K_PLUS_BUFFER`; NULL: as `PELAGE_K_PLUS_BUFFER_INIT`.
    pub k_plus_buffer: *const PelageKPlusBuffer,
    /// For `PELAGE_TRANSPARENCY_K_BUFFER_SINGLE_PASS`; NULL: as `PELAGE_K_BUFFER_SINGLE_PASS_INIT`.
    pub k_buffer_single_pass: *const PelageKBufferSinglePass,
    /// For `PELAGE_TRANSPARENCY_MOMENT`; NULL: as `PELAGE_MOMENT_INIT`.
    pub moment: *const PelageMoment,
}

impl Default for PelageTransparency {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_TRANSPARENCY_DBK_BUFFER,
            opaque: null(),
            a_buffer: null(),
            dbk_buffer: null(),
            weighted_blended: null(),
            depth_peeling: null(),
            random_subsets: null(),
            sorted_blending: null(),
            k_buffer: null(),
            k_plus_buffer: null(),
            k_buffer_single_pass: null(),
            moment: null(),
        }
    }
}

descriptor!(PelageTransparency, "PELAGE_TRANSPARENCY_INIT", moment: *const PelageMoment);

/// A validated transparency technique; `None` for NULL.
pub(in crate::capi) unsafe fn transparency(
    name: &str,
    pointer: *const PelageTransparency,
) -> Result<Option<Transparency>> {
    // SAFETY: the rule of the module `capi`.
    let Some(given) = unsafe { descriptor::read_optional(name, pointer) }? else {
        return Ok(None);
    };
    let transparency = match given.technique {
        PELAGE_TRANSPARENCY_OPAQUE => {
            // SAFETY: the rule of the module `capi`.
            let opaque = unsafe { settings("opaque", given.opaque) }?;
            Transparency::Opaque(Opaque {
                raster: raster(opaque.raster)?,
            })
        }
        PELAGE_TRANSPARENCY_A_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            Transparency::ABuffer(a_buffer(&unsafe { settings("a_buffer", given.a_buffer) }?)?)
        }
        PELAGE_TRANSPARENCY_DBK_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("dbk_buffer", given.dbk_buffer) }?;
            reserved("PelageDbkBuffer", given.reserved)?;
            Transparency::DbkBuffer(DbkBuffer {
                culling: match given.culling {
                    PELAGE_CULLING_AUTO => Culling::Auto,
                    PELAGE_CULLING_ALWAYS => Culling::Always,
                    unknown => {
                        return invalid!("culling {unknown} is not one of PELAGE_CULLING_…");
                    }
                },
                epsilon: given.epsilon,
                depth_shift: (given.depth_shift != 0.0).then_some(given.depth_shift),
                raster: raster(given.raster)?,
                pool_bytes: pool(given.pool_bytes),
            })
        }
        PELAGE_TRANSPARENCY_WEIGHTED_BLENDED => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("weighted_blended", given.weighted_blended) }?;
            Transparency::WeightedBlended(weighted_blended(&given)?)
        }
        PELAGE_TRANSPARENCY_DEPTH_PEELING => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("depth_peeling", given.depth_peeling) }?;
            Transparency::DepthPeeling(DepthPeeling {
                peels: given.peels,
                raster: raster(given.raster)?,
            })
        }
        PELAGE_TRANSPARENCY_RANDOM_SUBSETS => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("random_subsets", given.random_subsets) }?;
            Transparency::RandomSubsets(RandomSubsets {
                subsets: given.subsets,
                seed: given.seed,
                exact_alpha: switch("exact_alpha", given.exact_alpha)?,
                raster: raster(given.raster)?,
            })
        }
        PELAGE_TRANSPARENCY_SORTED_BLENDING => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("sorted_blending", given.sorted_blending) }?;
            Transparency::SortedBlending(sorted_blending(&given)?)
        }
        PELAGE_TRANSPARENCY_K_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            Transparency::KBuffer(k_buffer(&unsafe { settings("k_buffer", given.k_buffer) }?)?)
        }
        PELAGE_TRANSPARENCY_K_PLUS_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            let plus = unsafe { settings("k_plus_buffer", given.k_plus_buffer) }?;
            Transparency::KPlusBuffer(k_plus_buffer(&plus)?)
        }
        PELAGE_TRANSPARENCY_K_BUFFER_SINGLE_PASS => {
            // SAFETY: the rule of the module `capi`.
            let single = unsafe { settings("k_buffer_single_pass", given.k_buffer_single_pass) }?;
            Transparency::KBufferSinglePass(k_buffer_single_pass(&single)?)
        }
        PELAGE_TRANSPARENCY_MOMENT => {
            // SAFETY: the rule of the module `capi`.
            let moment = unsafe { settings("moment", given.moment) }?;
            Transparency::Moment(Moment {
                raster: raster(moment.raster)?,
            })
        }
        unknown => {
            return invalid!("{name}: technique {unknown} is not one of PELAGE_TRANSPARENCY_…");
        }
    };
    transparency.validate().map(|()| Some(transparency))
}

fn weighted_blended(given: &PelageWeightedBlended) -> Result<WeightedBlended> {
    let weight = match given.weight {
        PELAGE_WEIGHT_UNIFORM => Weight::Uniform,
        PELAGE_WEIGHT_CUBIC => Weight::Cubic,
        PELAGE_WEIGHT_EXPONENTIAL => Weight::Exponential {
            falloff: given.falloff,
        },
        unknown => return invalid!("weight {unknown} is not one of PELAGE_WEIGHT_…"),
    };
    Ok(WeightedBlended {
        weight,
        raster: raster(given.raster)?,
    })
}

fn sorted_blending(given: &PelageSortedBlending) -> Result<SortedBlending> {
    let order = match given.order {
        PELAGE_BLEND_ORDER_BACK_TO_FRONT => BlendOrder::BackToFront,
        PELAGE_BLEND_ORDER_FRONT_TO_BACK => BlendOrder::FrontToBack,
        unknown => return invalid!("order {unknown} is not one of PELAGE_BLEND_ORDER_…"),
    };
    Ok(SortedBlending {
        bins: given.bins,
        order,
        reuse: given.reuse,
        full_precision: switch("full_precision", given.full_precision)?,
    })
}

fn a_buffer(given: &PelageABuffer) -> Result<ABuffer> {
    reserved("PelageABuffer", given.reserved)?;
    Ok(ABuffer {
        storage: storage(given.storage)?,
        raster: raster(given.raster)?,
        pool_bytes: pool(given.pool_bytes),
    })
}

fn k_buffer(given: &PelageKBuffer) -> Result<KBuffer> {
    Ok(KBuffer {
        k: given.k,
        rest: rest(given.rest)?,
        selection: match given.selection {
            PELAGE_SELECTION_REGISTERS => Selection::Registers,
            PELAGE_SELECTION_ROUNDS => Selection::Rounds,
            PELAGE_SELECTION_SORT => Selection::Sort,
            unknown => return invalid!("selection {unknown} is not one of PELAGE_SELECTION_…"),
        },
        storage: storage(given.storage)?,
        raster: raster(given.raster)?,
        pool_bytes: pool(given.pool_bytes),
    })
}

fn k_plus_buffer(given: &PelageKPlusBuffer) -> Result<KPlusBuffer> {
    Ok(KPlusBuffer {
        k: given.k,
        rest: rest(given.rest)?,
        atomics: match given.atomics {
            PELAGE_ATOMICS_AUTO => Atomics::Auto,
            PELAGE_ATOMICS_64 => Atomics::Bits64,
            PELAGE_ATOMICS_32 => Atomics::Bits32,
            unknown => return invalid!("atomics {unknown} is not one of PELAGE_ATOMICS_…"),
        },
        raster: raster(given.raster)?,
    })
}

fn k_buffer_single_pass(given: &PelageKBufferSinglePass) -> Result<KBufferSinglePass> {
    reserved("PelageKBufferSinglePass", given.reserved)?;
    Ok(KBufferSinglePass {
        k: given.k,
        rest: rest(given.rest)?,
        retries: given.retries,
        raster: raster(given.raster)?,
        pool_bytes: pool(given.pool_bytes),
    })
}

fn storage(value: u32) -> Result<Storage> {
    match value {
        PELAGE_STORAGE_COUNTED => Ok(Storage::Counted),
        PELAGE_STORAGE_LISTS => Ok(Storage::Lists),
        _ => invalid!("storage {value} is not one of PELAGE_STORAGE_…"),
    }
}

fn rest(value: u32) -> Result<Rest> {
    match value {
        PELAGE_REST_MERGED => Ok(Rest::Merged),
        PELAGE_REST_ALPHA => Ok(Rest::Alpha),
        PELAGE_REST_DROPPED => Ok(Rest::Dropped),
        _ => invalid!("rest {value} is not one of PELAGE_REST_…"),
    }
}

/// `pool_bytes`, in which 0 leaves it to the library.
fn pool(bytes: u64) -> Option<u64> {
    (bytes > 0).then_some(bytes)
}
