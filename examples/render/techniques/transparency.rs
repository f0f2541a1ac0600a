//! The transparency technique of a scene file.

use pelage::transparency::{
    ABuffer, Atomics, BlendOrder, Culling, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass,
    KPlusBuffer, Moment, Opaque, RandomSubsets, Rest, Selection, SortedBlending, Storage,
    Transparency, Weight, WeightedBlended,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::super::scene::Result;
use super::{Group, NoKeys, RasterKey, with_stem};

/// The transparency technique.
pub const TRANSPARENCY: Group = Group {
    name: "transparency",
    selector: "technique",
    stems: &[
        "opaque",
        "sorted_blending",
        "random_subsets",
        "weighted_blended",
        "depth_peeling",
        "a_buffer",
        "k_buffer",
        "k_plus_buffer",
        "k_buffer_single_pass",
        "dbk_buffer",
        "moment",
    ],
    default: "dbk_buffer",
    common: &[],
};

/// The A-buffer's `storage`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum StorageKey {
    Counted,
    Lists,
}

impl StorageKey {
    fn of(storage: Storage) -> Self {
        match storage {
            Storage::Counted => Self::Counted,
            Storage::Lists => Self::Lists,
        }
    }

    fn storage(self) -> Storage {
        match self {
            Self::Counted => Storage::Counted,
            Self::Lists => Storage::Lists,
        }
    }
}

/// The k-buffers' `rest`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RestKey {
    Merged,
    Alpha,
    Dropped,
}

impl RestKey {
    fn of(rest: Rest) -> Self {
        match rest {
            Rest::Merged => Self::Merged,
            Rest::Alpha => Self::Alpha,
            Rest::Dropped => Self::Dropped,
        }
    }

    fn rest(self) -> Rest {
        match self {
            Self::Merged => Rest::Merged,
            Self::Alpha => Rest::Alpha,
            Self::Dropped => Rest::Dropped,
        }
    }
}

/// The k-buffer's `selection`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SelectionKey {
    Registers,
    Rounds,
    Sort,
}

/// The k⁺-buffer's `atomics`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AtomicsKey {
    Auto,
    Bits64,
    Bits32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct OpaqueKeys {
    raster: RasterKey,
}

impl Default for OpaqueKeys {
    fn default() -> Self {
        Self {
            raster: RasterKey::of(Opaque::default().raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ABufferKeys {
    storage: StorageKey,
    raster: RasterKey,
    pool_bytes: Option<u64>,
}

impl Default for ABufferKeys {
    fn default() -> Self {
        Self::of(&ABuffer::default())
    }
}

impl ABufferKeys {
    fn of(settings: &ABuffer) -> Self {
        Self {
            storage: StorageKey::of(settings.storage),
            raster: RasterKey::of(settings.raster),
            pool_bytes: settings.pool_bytes,
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct KBufferKeys {
    k: u32,
    rest: RestKey,
    selection: SelectionKey,
    storage: StorageKey,
    raster: RasterKey,
    pool_bytes: Option<u64>,
}

impl Default for KBufferKeys {
    fn default() -> Self {
        Self::of(&KBuffer::default())
    }
}

impl KBufferKeys {
    fn of(settings: &KBuffer) -> Self {
        Self {
            k: settings.k,
            rest: RestKey::of(settings.rest),
            selection: match settings.selection {
                Selection::Registers => SelectionKey::Registers,
                Selection::Rounds => SelectionKey::Rounds,
                Selection::Sort => SelectionKey::Sort,
            },
            storage: StorageKey::of(settings.storage),
            raster: RasterKey::of(settings.raster),
            pool_bytes: settings.pool_bytes,
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MomentKeys {
    raster: RasterKey,
}

impl Default for MomentKeys {
    fn default() -> Self {
        Self {
            raster: RasterKey::of(Moment::default().raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct KPlusBufferKeys {
    k: u32,
    rest: RestKey,
    atomics: AtomicsKey,
    raster: RasterKey,
}

impl Default for KPlusBufferKeys {
    fn default() -> Self {
        Self::of(&KPlusBuffer::default())
    }
}

impl KPlusBufferKeys {
    fn of(settings: &KPlusBuffer) -> Self {
        Self {
            k: settings.k,
            rest: RestKey::of(settings.rest),
            atomics: match settings.atomics {
                Atomics::Auto => AtomicsKey::Auto,
                Atomics::Bits64 => AtomicsKey::Bits64,
                Atomics::Bits32 => AtomicsKey::Bits32,
            },
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct KBufferSinglePassKeys {
    k: u32,
    rest: RestKey,
    retries: u32,
    raster: RasterKey,
    pool_bytes: Option<u64>,
}

impl Default for KBufferSinglePassKeys {
    fn default() -> Self {
        Self::of(&KBufferSinglePass::default())
    }
}

impl KBufferSinglePassKeys {
    fn of(settings: &KBufferSinglePass) -> Self {
        Self {
            k: settings.k,
            rest: RestKey::of(settings.rest),
            retries: settings.retries,
            raster: RasterKey::of(settings.raster),
            pool_bytes: settings.pool_bytes,
        }
    }
}

/// The weight of weighted blended transparency, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum WeightKey {
    Uniform,
    Cubic,
    Exponential,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct WeightedBlendedKeys {
    weight: WeightKey,
    /// Of the exponential weight.
    falloff: f32,
    raster: RasterKey,
}

impl Default for WeightedBlendedKeys {
    fn default() -> Self {
        Self::of(&WeightedBlended::default())
    }
}

impl WeightedBlendedKeys {
    fn of(settings: &WeightedBlended) -> Self {
        let (weight, falloff) = match settings.weight {
            Weight::Uniform => (WeightKey::Uniform, 0.0),
            Weight::Cubic => (WeightKey::Cubic, 0.0),
            Weight::Exponential { falloff } => (WeightKey::Exponential, falloff),
        };
        Self {
            weight,
            falloff,
            raster: RasterKey::of(settings.raster),
        }
    }

    fn settings(&self) -> WeightedBlended {
        let weight = match self.weight {
            WeightKey::Uniform => Weight::Uniform,
            WeightKey::Cubic => Weight::Cubic,
            WeightKey::Exponential => Weight::Exponential {
                falloff: self.falloff,
            },
        };
        WeightedBlended {
            weight,
            raster: self.raster.raster(),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DepthPeelingKeys {
    peels: u32,
    raster: RasterKey,
}

impl Default for DepthPeelingKeys {
    fn default() -> Self {
        Self::of(&DepthPeeling::default())
    }
}

impl DepthPeelingKeys {
    fn of(settings: &DepthPeeling) -> Self {
        Self {
            peels: settings.peels,
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RandomSubsetsKeys {
    subsets: u32,
    seed: u32,
    exact_alpha: bool,
    raster: RasterKey,
}

impl Default for RandomSubsetsKeys {
    fn default() -> Self {
        Self::of(&RandomSubsets::default())
    }
}

impl RandomSubsetsKeys {
    fn of(settings: &RandomSubsets) -> Self {
        Self {
            subsets: settings.subsets,
            seed: settings.seed,
            exact_alpha: settings.exact_alpha,
            raster: RasterKey::of(settings.raster),
        }
    }
}

/// The order of sorted blending, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum BlendOrderKey {
    BackToFront,
    FrontToBack,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SortedBlendingKeys {
    bins: u32,
    order: BlendOrderKey,
    reuse: u32,
    full_precision: bool,
}

impl Default for SortedBlendingKeys {
    fn default() -> Self {
        Self::of(&SortedBlending::default())
    }
}

impl SortedBlendingKeys {
    fn of(settings: &SortedBlending) -> Self {
        let order = match settings.order {
            BlendOrder::BackToFront => BlendOrderKey::BackToFront,
            BlendOrder::FrontToBack => BlendOrderKey::FrontToBack,
        };
        Self {
            bins: settings.bins,
            order,
            reuse: settings.reuse,
            full_precision: settings.full_precision,
        }
    }

    fn settings(&self) -> SortedBlending {
        let order = match self.order {
            BlendOrderKey::BackToFront => BlendOrder::BackToFront,
            BlendOrderKey::FrontToBack => BlendOrder::FrontToBack,
        };
        SortedBlending {
            bins: self.bins,
            order,
            reuse: self.reuse,
            full_precision: self.full_precision,
        }
    }
}

/// The DBK-buffer's `culling`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum CullingKey {
    Auto,
    Always,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DbkBufferKeys {
    culling: CullingKey,
    epsilon: f32,
    depth_shift: Option<f32>,
    raster: RasterKey,
    pool_bytes: Option<u64>,
}

impl Default for DbkBufferKeys {
    fn default() -> Self {
        Self::of(&DbkBuffer::default())
    }
}

impl DbkBufferKeys {
    fn of(settings: &DbkBuffer) -> Self {
        let culling = match settings.culling {
            Culling::Always => CullingKey::Always,
            _ => CullingKey::Auto,
        };
        Self {
            culling,
            epsilon: settings.epsilon,
            depth_shift: settings.depth_shift,
            raster: RasterKey::of(settings.raster),
            pool_bytes: settings.pool_bytes,
        }
    }
}

/// The settings of a stem, with their defaults.
pub(super) fn keys(stem: &str) -> Value {
    match stem {
        "opaque" => json!(OpaqueKeys::default()),
        "a_buffer" => json!(ABufferKeys::default()),
        "weighted_blended" => json!(WeightedBlendedKeys::default()),
        "depth_peeling" => json!(DepthPeelingKeys::default()),
        "random_subsets" => json!(RandomSubsetsKeys::default()),
        "sorted_blending" => json!(SortedBlendingKeys::default()),
        "k_buffer" => json!(KBufferKeys::default()),
        "k_plus_buffer" => json!(KPlusBufferKeys::default()),
        "k_buffer_single_pass" => json!(KBufferSinglePassKeys::default()),
        "moment" => json!(MomentKeys::default()),
        "dbk_buffer" => json!(DbkBufferKeys::default()),
        _ => json!(NoKeys::default()),
    }
}

/// The transparency technique that a group selects.
pub fn transparency(map: &Map<String, Value>) -> Result<Transparency> {
    let stem = TRANSPARENCY.stem(map)?;
    match stem {
        "opaque" => {
            let keys: OpaqueKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::Opaque(Opaque {
                raster: keys.raster.raster(),
            }))
        }
        "a_buffer" => {
            let keys: ABufferKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::ABuffer(ABuffer {
                storage: keys.storage.storage(),
                raster: keys.raster.raster(),
                pool_bytes: keys.pool_bytes,
            }))
        }
        "k_buffer" => {
            let keys: KBufferKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::KBuffer(KBuffer {
                k: keys.k,
                rest: keys.rest.rest(),
                selection: match keys.selection {
                    SelectionKey::Registers => Selection::Registers,
                    SelectionKey::Rounds => Selection::Rounds,
                    SelectionKey::Sort => Selection::Sort,
                },
                storage: keys.storage.storage(),
                raster: keys.raster.raster(),
                pool_bytes: keys.pool_bytes,
            }))
        }
        "weighted_blended" => {
            let keys: WeightedBlendedKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::WeightedBlended(keys.settings()))
        }
        "depth_peeling" => {
            let keys: DepthPeelingKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::DepthPeeling(DepthPeeling {
                peels: keys.peels,
                raster: keys.raster.raster(),
            }))
        }
        "random_subsets" => {
            let keys: RandomSubsetsKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::RandomSubsets(RandomSubsets {
                subsets: keys.subsets,
                seed: keys.seed,
                exact_alpha: keys.exact_alpha,
                raster: keys.raster.raster(),
            }))
        }
        "sorted_blending" => {
            let keys: SortedBlendingKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::SortedBlending(keys.settings()))
        }
        "dbk_buffer" => {
            let keys: DbkBufferKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::DbkBuffer(DbkBuffer {
                culling: match keys.culling {
                    CullingKey::Auto => Culling::Auto,
                    CullingKey::Always => Culling::Always,
                },
                epsilon: keys.epsilon,
                depth_shift: keys.depth_shift,
                raster: keys.raster.raster(),
                pool_bytes: keys.pool_bytes,
            }))
        }
        "k_plus_buffer" => {
            let keys: KPlusBufferKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::KPlusBuffer(KPlusBuffer {
                k: keys.k,
                rest: keys.rest.rest(),
                atomics: match keys.atomics {
                    AtomicsKey::Auto => Atomics::Auto,
                    AtomicsKey::Bits64 => Atomics::Bits64,
                    AtomicsKey::Bits32 => Atomics::Bits32,
                },
                raster: keys.raster.raster(),
            }))
        }
        "k_buffer_single_pass" => {
            let keys: KBufferSinglePassKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::KBufferSinglePass(KBufferSinglePass {
                k: keys.k,
                rest: keys.rest.rest(),
                retries: keys.retries,
                raster: keys.raster.raster(),
                pool_bytes: keys.pool_bytes,
            }))
        }
        "moment" => {
            let keys: MomentKeys = TRANSPARENCY.settings(stem, map)?;
            Ok(Transparency::Moment(Moment {
                raster: keys.raster.raster(),
            }))
        }
        _ => unreachable!("{stem} is listed and not handled"),
    }
}

/// A transparency technique as its group of a scene file.
pub fn transparency_settings(transparency: &Transparency) -> Value {
    let settings = match transparency {
        Transparency::Opaque(settings) => json!(OpaqueKeys {
            raster: RasterKey::of(settings.raster)
        }),
        Transparency::ABuffer(settings) => json!(ABufferKeys::of(settings)),
        Transparency::WeightedBlended(settings) => json!(WeightedBlendedKeys::of(settings)),
        Transparency::DepthPeeling(settings) => json!(DepthPeelingKeys::of(settings)),
        Transparency::RandomSubsets(settings) => json!(RandomSubsetsKeys::of(settings)),
        Transparency::SortedBlending(settings) => json!(SortedBlendingKeys::of(settings)),
        Transparency::KBuffer(settings) => json!(KBufferKeys::of(settings)),
        Transparency::KPlusBuffer(settings) => json!(KPlusBufferKeys::of(settings)),
        Transparency::KBufferSinglePass(settings) => json!(KBufferSinglePassKeys::of(settings)),
        Transparency::Moment(settings) => json!(MomentKeys {
            raster: RasterKey::of(settings.raster)
        }),
        Transparency::DbkBuffer(settings) => json!(DbkBufferKeys::of(settings)),
        _ => json!({}),
    };
    with_stem(transparency.stem(), settings)
}
