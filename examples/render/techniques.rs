//! The scene file's `shading`, `shadow` and `transparency` groups: a stem that selects, and the settings of what it
//! selects by the names of the Rust fields.
//!
//! Adding a technique: its stem in the list, its settings as a struct with the library's defaults, its line in `parse`
//! and in `resolved`.

use glam::Vec3;
use pelage::shading::{
    Chiang, DualScattering, Highlight, KajiyaKay, Marschner, Precision, Roots, RoughnessVariation,
    Sadeghi, Scheuermann, Shading, ShadingRate, Tables,
};
use pelage::shadow::{
    ApproximatedDeepShadowMap, Attenuation, DeepOpacityMap, KBufferVolume, MomentOpacityMap,
    OpacityShadowMaps, Shadow, ShadowMap,
};
use pelage::transparency::{
    ABuffer, Atomics, BlendOrder, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass, KPlusBuffer,
    Moment, Opaque, RandomSubsets, Rest, Selection, SortedBlending, Storage, Transparency, Weight,
    WeightedBlended,
};
use pelage::{Raster, glam};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::scene::{Fibre, Result, typed};

/// A group of the scene file in which one key selects what the others set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Group {
    /// The group's name.
    pub name: &'static str,
    /// The key that holds the stem.
    pub selector: &'static str,
    /// The stems of this build; the first that is listed need not be the default.
    pub stems: &'static [&'static str],
    /// The stem of a group that names none.
    pub default: &'static str,
    /// Keys that every stem has.
    pub common: &'static [&'static str],
}

/// The shading model.
pub const SHADING: Group = Group {
    name: "shading",
    selector: "model",
    stems: &[
        "kajiya_kay",
        "scheuermann",
        "marschner",
        "sadeghi",
        "chiang",
    ],
    default: "kajiya_kay",
    common: &["rate"],
};
/// The shadow technique.
pub const SHADOW: Group = Group {
    name: "shadow",
    selector: "technique",
    stems: &[
        "none",
        "shadow_map",
        "approximated_deep_shadow_map",
        "opacity_shadow_maps",
        "deep_opacity_map",
        "moment_opacity_map",
        "k_buffer_volume",
    ],
    default: "deep_opacity_map",
    common: &[],
};
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
/// All groups that select.
pub const GROUPS: [Group; 3] = [SHADING, SHADOW, TRANSPARENCY];

/// `raster`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RasterKey {
    Auto,
    Ribbons,
    Walk,
}

impl RasterKey {
    fn of(raster: Raster) -> Self {
        match raster {
            Raster::Ribbons => Self::Ribbons,
            Raster::Walk => Self::Walk,
            _ => Self::Auto,
        }
    }

    fn raster(self) -> Raster {
        match self {
            Self::Auto => Raster::Auto,
            Self::Ribbons => Raster::Ribbons,
            Self::Walk => Raster::Walk,
        }
    }
}

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

/// Settings of a technique that has none.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NoKeys {}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct KajiyaKayKeys {
    /// `None`: from the fibre's absorption.
    diffuse: Option<[f32; 3]>,
    specular: [f32; 3],
    exponent: f32,
}

impl Default for KajiyaKayKeys {
    fn default() -> Self {
        let model = KajiyaKay::default();
        Self {
            diffuse: None,
            specular: model.specular.into(),
            exponent: model.exponent,
        }
    }
}

/// Replaces a default by what the scene says, if it does.
fn set<T>(value: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *value = given;
    }
}

/// The fibre's optics as Chiang's model takes them.
fn optics(fibre: &Fibre) -> Chiang {
    Chiang {
        beta_m: fibre.beta_m,
        beta_n: fibre.beta_n,
        alpha: fibre.alpha_deg.to_radians(),
        eta: fibre.eta,
        sigma_a: Vec3::from(fibre.sigma_a),
        ..Chiang::default()
    }
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct HighlightKeys {
    colour: Option<[f32; 3]>,
    exponent: Option<f32>,
    shift: Option<f32>,
}

impl HighlightKeys {
    fn apply(self, highlight: &mut Highlight) {
        set(&mut highlight.colour, self.colour.map(Vec3::from));
        set(&mut highlight.exponent, self.exponent);
        set(&mut highlight.shift, self.shift);
    }
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ScheuermannKeys {
    diffuse: Option<[f32; 3]>,
    primary: HighlightKeys,
    secondary: HighlightKeys,
}

/// `true`, `false`, or the densities, and how disordered the hair is.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(untagged)]
enum DualScatteringKey {
    Switch(bool),
    Densities {
        forward: f32,
        backward: f32,
        disorder: Option<f32>,
    },
}

impl Default for DualScatteringKey {
    fn default() -> Self {
        Self::Switch(false)
    }
}

impl DualScatteringKey {
    fn dual_scattering(self) -> Option<DualScattering> {
        match self {
            Self::Switch(on) => on.then(DualScattering::default),
            Self::Densities {
                forward,
                backward,
                disorder,
            } => Some(DualScattering {
                forward,
                backward,
                disorder: disorder.unwrap_or(DualScattering::default().disorder),
            }),
        }
    }
}

/// `"precision"` of tables, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum PrecisionKey {
    F16,
    F32,
}

/// `false`: direct evaluation; or the tables' size and precision.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(untagged)]
enum TablesKey {
    Switch(bool),
    Tables { size: u32, precision: PrecisionKey },
}

impl Default for TablesKey {
    fn default() -> Self {
        Self::Switch(true)
    }
}

impl TablesKey {
    fn tables(self) -> Option<Tables> {
        match self {
            Self::Switch(on) => on.then(Tables::default),
            Self::Tables { size, precision } => Some(Tables {
                size,
                precision: match precision {
                    PrecisionKey::F16 => Precision::F16,
                    PrecisionKey::F32 => Precision::F32,
                },
            }),
        }
    }
}

/// `"roughness"`: how it varies.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RoughnessKeys {
    strand: f32,
    tip: f32,
}

impl Default for RoughnessKeys {
    fn default() -> Self {
        let RoughnessVariation { strand, tip } = RoughnessVariation::default();
        Self { strand, tip }
    }
}

impl RoughnessKeys {
    fn variation(self) -> RoughnessVariation {
        RoughnessVariation {
            strand: self.strand,
            tip: self.tip,
        }
    }
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MarschnerKeys {
    alpha_deg: Option<[f32; 3]>,
    beta_deg: Option<[f32; 3]>,
    eccentricity: Option<f32>,
    cubic: Option<bool>,
    tip_colour: Option<[f32; 3]>,
    tables: Option<TablesKey>,
    dual_scattering: Option<DualScatteringKey>,
    roughness: Option<RoughnessKeys>,
    lobe_tolerance: Option<f32>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SadeghiKeys {
    r_intensity: Option<f32>,
    tt_intensity: Option<f32>,
    trt_intensity: Option<f32>,
    glint_intensity: Option<f32>,
    normalised: Option<bool>,
    tip_colour: Option<[f32; 3]>,
    dual_scattering: Option<DualScatteringKey>,
    roughness: Option<RoughnessKeys>,
    lobe_tolerance: Option<f32>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ChiangKeys {
    intervals: Option<u32>,
    tip_colour: Option<[f32; 3]>,
    tables: Option<TablesKey>,
    dual_scattering: Option<DualScatteringKey>,
    roughness: Option<RoughnessKeys>,
    lobe_tolerance: Option<f32>,
    near_field: Option<bool>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DeepOpacityMapKeys {
    resolution: u32,
    layers: u32,
    pcf: u32,
    depth: f32,
    transmitted: [f32; 3],
    raster: RasterKey,
}

impl Default for DeepOpacityMapKeys {
    fn default() -> Self {
        Self::of(&DeepOpacityMap::default())
    }
}

impl DeepOpacityMapKeys {
    fn of(settings: &DeepOpacityMap) -> Self {
        Self {
            resolution: settings.resolution,
            layers: settings.layers,
            pcf: settings.pcf,
            depth: settings.depth,
            transmitted: settings.transmitted.into(),
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MomentOpacityMapKeys {
    resolution: u32,
    moments: u32,
    pcf: u32,
    transmitted: [f32; 3],
    raster: RasterKey,
}

impl Default for MomentOpacityMapKeys {
    fn default() -> Self {
        Self::of(&MomentOpacityMap::default())
    }
}

impl MomentOpacityMapKeys {
    fn of(settings: &MomentOpacityMap) -> Self {
        Self {
            resolution: settings.resolution,
            moments: settings.moments,
            pcf: settings.pcf,
            transmitted: settings.transmitted.into(),
            raster: RasterKey::of(settings.raster),
        }
    }
}

/// `"attenuation"` of the k-buffer volume, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AttenuationKey {
    Opacity,
    Fresnel,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct KBufferVolumeKeys {
    resolution: u32,
    k: u32,
    pcf: u32,
    tail: bool,
    attenuation: AttenuationKey,
    eta: f32,
    sigma_a: [f32; 3],
    raster: RasterKey,
}

impl Default for KBufferVolumeKeys {
    fn default() -> Self {
        Self::of(&KBufferVolume::default())
    }
}

impl KBufferVolumeKeys {
    fn of(settings: &KBufferVolume) -> Self {
        let (attenuation, eta, sigma_a) = match settings.attenuation {
            Attenuation::Fresnel { eta, sigma_a } => (AttenuationKey::Fresnel, eta, sigma_a),
            _ => (AttenuationKey::Opacity, 1.55, Default::default()),
        };
        Self {
            resolution: settings.resolution,
            k: settings.k,
            pcf: settings.pcf,
            tail: settings.tail,
            attenuation,
            eta,
            sigma_a: sigma_a.into(),
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ShadowMapKeys {
    resolution: u32,
    pcf: u32,
    strength: f32,
    raster: RasterKey,
}

impl Default for ShadowMapKeys {
    fn default() -> Self {
        Self::of(&ShadowMap::default())
    }
}

impl ShadowMapKeys {
    fn of(settings: &ShadowMap) -> Self {
        Self {
            resolution: settings.resolution,
            pcf: settings.pcf,
            strength: settings.strength,
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ApproximatedDeepShadowMapKeys {
    resolution: u32,
    pcf: u32,
    opacity: Option<f32>,
    spacing: Option<f32>,
    raster: RasterKey,
}

impl Default for ApproximatedDeepShadowMapKeys {
    fn default() -> Self {
        Self::of(&ApproximatedDeepShadowMap::default())
    }
}

impl ApproximatedDeepShadowMapKeys {
    fn of(settings: &ApproximatedDeepShadowMap) -> Self {
        Self {
            resolution: settings.resolution,
            pcf: settings.pcf,
            opacity: settings.opacity,
            spacing: settings.spacing,
            raster: RasterKey::of(settings.raster),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct OpacityShadowMapsKeys {
    resolution: u32,
    layers: u32,
    unevenness: f32,
    pcf: u32,
    raster: RasterKey,
}

impl Default for OpacityShadowMapsKeys {
    fn default() -> Self {
        Self::of(&OpacityShadowMaps::default())
    }
}

impl OpacityShadowMapsKeys {
    fn of(settings: &OpacityShadowMaps) -> Self {
        Self {
            resolution: settings.resolution,
            layers: settings.layers,
            unevenness: settings.unevenness,
            pcf: settings.pcf,
            raster: RasterKey::of(settings.raster),
        }
    }
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

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DbkBufferKeys {
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
        Self {
            epsilon: settings.epsilon,
            depth_shift: settings.depth_shift,
            raster: RasterKey::of(settings.raster),
            pool_bytes: settings.pool_bytes,
        }
    }
}

impl Group {
    /// The stem that a group's map selects, known to this build.
    pub fn stem(&self, map: &Map<String, Value>) -> Result<&'static str> {
        let (name, selector) = (self.name, self.selector);
        let known = self.stems.join(", ");
        let Some(value) = map.get(selector) else {
            return Ok(self.default);
        };
        let Some(stem) = value.as_str() else {
            return Err(format!(
                "{name}.{selector} is {value}, not a string; this build has {known}"
            ));
        };
        self.stems
            .iter()
            .copied()
            .find(|known| *known == stem)
            .ok_or_else(|| {
                format!("{name}.{selector} \"{stem}\" is not in this build, which has {known}")
            })
    }

    /// The settings of the stem that a group's map selects.
    fn settings<T: DeserializeOwned>(&self, stem: &str, map: &Map<String, Value>) -> Result<T> {
        let (name, selector) = (self.name, self.selector);
        let known = self.keys(stem);
        if let Some(key) = map
            .keys()
            .find(|key| *key != selector && !known.contains(key))
        {
            let known: Vec<&str> = [selector]
                .into_iter()
                .chain(known.iter().map(String::as_str))
                .collect();
            let known = known.join(", ");
            return Err(format!(
                "{name}.{key} is unknown; with {selector} \"{stem}\" the keys are {known}"
            ));
        }
        let mut settings = map.clone();
        settings.shift_remove(selector);
        for key in self.common {
            settings.shift_remove(*key);
        }
        typed(name, Value::Object(settings))
    }

    /// The names of a stem's settings.
    pub fn keys(&self, stem: &str) -> Vec<String> {
        let settings = match stem {
            "kajiya_kay" => json!(KajiyaKayKeys::default()),
            "scheuermann" => json!(ScheuermannKeys::default()),
            "marschner" => json!(MarschnerKeys::default()),
            "sadeghi" => json!(SadeghiKeys::default()),
            "chiang" => json!(ChiangKeys::default()),
            "deep_opacity_map" => json!(DeepOpacityMapKeys::default()),
            "shadow_map" => json!(ShadowMapKeys::default()),
            "approximated_deep_shadow_map" => json!(ApproximatedDeepShadowMapKeys::default()),
            "opacity_shadow_maps" => json!(OpacityShadowMapsKeys::default()),
            "moment_opacity_map" => json!(MomentOpacityMapKeys::default()),
            "k_buffer_volume" => json!(KBufferVolumeKeys::default()),
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
        };
        let own = settings.as_object().into_iter().flat_map(Map::keys);
        let common = self.common.iter().map(|key| key.to_string());
        common.chain(own.cloned()).collect()
    }
}

/// `"rate"`, as the scene file spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RateKey {
    Point,
    Fragment,
}

/// Where the group's model is evaluated.
pub fn shading_rate(map: &Map<String, Value>) -> Result<ShadingRate> {
    let Some(value) = map.get("rate") else {
        return Ok(ShadingRate::default());
    };
    Ok(match typed("shading.rate", value.clone())? {
        RateKey::Point => ShadingRate::Point,
        RateKey::Fragment => ShadingRate::Fragment,
    })
}

/// A rate as the scene file spells it.
pub fn rate_setting(rate: ShadingRate) -> Value {
    json!(match rate {
        ShadingRate::Point => RateKey::Point,
        ShadingRate::Fragment => RateKey::Fragment,
    })
}

/// The shading model that a group selects. Colours, and the optics of the physical models, follow from the fibre's where the
/// group does not give them.
pub fn shading(map: &Map<String, Value>, fibre: &Fibre) -> Result<Shading> {
    let stem = SHADING.stem(map)?;
    match stem {
        "kajiya_kay" => {
            let keys: KajiyaKayKeys = SHADING.settings(stem, map)?;
            let of_fibre = || KajiyaKay::diffuse_of(Vec3::from(fibre.sigma_a));
            Ok(Shading::KajiyaKay(KajiyaKay {
                diffuse: keys.diffuse.map_or_else(of_fibre, Vec3::from),
                specular: keys.specular.into(),
                exponent: keys.exponent,
            }))
        }
        "scheuermann" => {
            let keys: ScheuermannKeys = SHADING.settings(stem, map)?;
            let mut model = Scheuermann::of_fibre(Vec3::from(fibre.sigma_a));
            set(&mut model.diffuse, keys.diffuse.map(Vec3::from));
            keys.primary.apply(&mut model.primary);
            keys.secondary.apply(&mut model.secondary);
            Ok(Shading::Scheuermann(model))
        }
        "marschner" => {
            let keys: MarschnerKeys = SHADING.settings(stem, map)?;
            let mut model = Marschner::of_fibre(&optics(fibre));
            set(
                &mut model.alpha,
                keys.alpha_deg.map(|a| a.map(f32::to_radians)),
            );
            set(
                &mut model.beta,
                keys.beta_deg.map(|b| b.map(f32::to_radians)),
            );
            set(&mut model.eccentricity, keys.eccentricity);
            if keys.cubic == Some(true) {
                model.roots = Roots::Cubic;
            }
            set(&mut model.tip_colour, keys.tip_colour.map(Vec3::from));
            model.tables = keys.tables.unwrap_or_default().tables();
            model.dual_scattering = keys.dual_scattering.unwrap_or_default().dual_scattering();
            set(
                &mut model.roughness,
                keys.roughness.map(RoughnessKeys::variation),
            );
            set(&mut model.lobe_tolerance, keys.lobe_tolerance);
            Ok(Shading::Marschner(model))
        }
        "sadeghi" => {
            let keys: SadeghiKeys = SHADING.settings(stem, map)?;
            let mut model = Sadeghi::of_fibre(&optics(fibre));
            for (lobe, intensity) in [
                (&mut model.r, keys.r_intensity),
                (&mut model.tt, keys.tt_intensity),
                (&mut model.trt, keys.trt_intensity),
            ] {
                set(&mut lobe.intensity, intensity);
            }
            set(&mut model.glint_intensity, keys.glint_intensity);
            set(&mut model.normalised, keys.normalised);
            set(&mut model.tip_colour, keys.tip_colour.map(Vec3::from));
            model.dual_scattering = keys.dual_scattering.unwrap_or_default().dual_scattering();
            set(
                &mut model.roughness,
                keys.roughness.map(RoughnessKeys::variation),
            );
            set(&mut model.lobe_tolerance, keys.lobe_tolerance);
            Ok(Shading::Sadeghi(model))
        }
        "chiang" => {
            let keys: ChiangKeys = SHADING.settings(stem, map)?;
            let mut model = optics(fibre);
            set(&mut model.intervals, keys.intervals);
            set(&mut model.tip_colour, keys.tip_colour.map(Vec3::from));
            model.tables = keys.tables.unwrap_or_default().tables();
            model.dual_scattering = keys.dual_scattering.unwrap_or_default().dual_scattering();
            set(
                &mut model.roughness,
                keys.roughness.map(RoughnessKeys::variation),
            );
            set(&mut model.lobe_tolerance, keys.lobe_tolerance);
            set(&mut model.near_field, keys.near_field);
            Ok(Shading::Chiang(model))
        }
        _ => unreachable!("{stem} is listed and not handled"),
    }
}

/// The shadow technique that a group selects.
pub fn shadow(map: &Map<String, Value>) -> Result<Shadow> {
    let stem = SHADOW.stem(map)?;
    match stem {
        "none" => SHADOW.settings::<NoKeys>(stem, map).map(|_| Shadow::None),
        "deep_opacity_map" => {
            let keys: DeepOpacityMapKeys = SHADOW.settings(stem, map)?;
            Ok(Shadow::DeepOpacityMap(DeepOpacityMap {
                resolution: keys.resolution,
                layers: keys.layers,
                pcf: keys.pcf,
                depth: keys.depth,
                transmitted: keys.transmitted.into(),
                raster: keys.raster.raster(),
            }))
        }
        "moment_opacity_map" => {
            let keys: MomentOpacityMapKeys = SHADOW.settings(stem, map)?;
            Ok(Shadow::MomentOpacityMap(MomentOpacityMap {
                resolution: keys.resolution,
                moments: keys.moments,
                pcf: keys.pcf,
                transmitted: keys.transmitted.into(),
                raster: keys.raster.raster(),
            }))
        }
        "k_buffer_volume" => {
            let keys: KBufferVolumeKeys = SHADOW.settings(stem, map)?;
            let attenuation = match keys.attenuation {
                AttenuationKey::Opacity => Attenuation::Opacity,
                AttenuationKey::Fresnel => Attenuation::Fresnel {
                    eta: keys.eta,
                    sigma_a: keys.sigma_a.into(),
                },
            };
            Ok(Shadow::KBufferVolume(KBufferVolume {
                resolution: keys.resolution,
                k: keys.k,
                pcf: keys.pcf,
                tail: keys.tail,
                attenuation,
                raster: keys.raster.raster(),
            }))
        }
        "shadow_map" => {
            let keys: ShadowMapKeys = SHADOW.settings(stem, map)?;
            Ok(Shadow::ShadowMap(ShadowMap {
                resolution: keys.resolution,
                pcf: keys.pcf,
                strength: keys.strength,
                raster: keys.raster.raster(),
            }))
        }
        "approximated_deep_shadow_map" => {
            let keys: ApproximatedDeepShadowMapKeys = SHADOW.settings(stem, map)?;
            Ok(Shadow::ApproximatedDeepShadowMap(
                ApproximatedDeepShadowMap {
                    resolution: keys.resolution,
                    pcf: keys.pcf,
                    opacity: keys.opacity,
                    spacing: keys.spacing,
                    raster: keys.raster.raster(),
                },
            ))
        }
        "opacity_shadow_maps" => {
            let keys: OpacityShadowMapsKeys = SHADOW.settings(stem, map)?;
            Ok(Shadow::OpacityShadowMaps(OpacityShadowMaps {
                resolution: keys.resolution,
                layers: keys.layers,
                unevenness: keys.unevenness,
                pcf: keys.pcf,
                raster: keys.raster.raster(),
            }))
        }
        _ => unreachable!("{stem} is listed and not handled"),
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

/// A shading model as its group of a scene file.
pub fn shading_settings(shading: &Shading) -> Value {
    match shading {
        Shading::KajiyaKay(model) => json!({
            "model": shading.stem(),
            "diffuse": numbers(model.diffuse),
            "specular": numbers(model.specular),
            "exponent": number(model.exponent),
        }),
        Shading::Scheuermann(model) => json!({
            "model": shading.stem(),
            "diffuse": numbers(model.diffuse),
            "primary": highlight_settings(&model.primary),
            "secondary": highlight_settings(&model.secondary),
        }),
        Shading::Marschner(model) => json!({
            "model": shading.stem(),
            "alpha_deg": model.alpha.map(|a| number(a.to_degrees())),
            "beta_deg": model.beta.map(|b| number(b.to_degrees())),
            "eccentricity": number(model.eccentricity),
            "cubic": model.roots == Roots::Cubic,
            "tip_colour": numbers(model.tip_colour),
            "tables": tables_settings(model.tables),
            "dual_scattering": dual_settings(model.dual_scattering),
            "roughness": roughness_settings(model.roughness),
            "lobe_tolerance": number(model.lobe_tolerance),
        }),
        Shading::Sadeghi(model) => json!({
            "model": shading.stem(),
            "r_intensity": number(model.r.intensity),
            "tt_intensity": number(model.tt.intensity),
            "trt_intensity": number(model.trt.intensity),
            "glint_intensity": number(model.glint_intensity),
            "normalised": model.normalised,
            "tip_colour": numbers(model.tip_colour),
            "dual_scattering": dual_settings(model.dual_scattering),
            "roughness": roughness_settings(model.roughness),
            "lobe_tolerance": number(model.lobe_tolerance),
        }),
        Shading::Chiang(model) => json!({
            "model": shading.stem(),
            "intervals": model.intervals,
            "tip_colour": numbers(model.tip_colour),
            "tables": tables_settings(model.tables),
            "dual_scattering": dual_settings(model.dual_scattering),
            "roughness": roughness_settings(model.roughness),
            "lobe_tolerance": number(model.lobe_tolerance),
            "near_field": model.near_field,
        }),
        _ => json!({ "model": shading.stem() }),
    }
}

fn highlight_settings(highlight: &Highlight) -> Value {
    json!({
        "colour": numbers(highlight.colour),
        "exponent": number(highlight.exponent),
        "shift": number(highlight.shift),
    })
}

fn tables_settings(tables: Option<Tables>) -> Value {
    tables.map_or(false.into(), |tables| {
        let precision = match tables.precision {
            Precision::F32 => PrecisionKey::F32,
            _ => PrecisionKey::F16,
        };
        json!({ "size": tables.size, "precision": precision })
    })
}

fn roughness_settings(roughness: RoughnessVariation) -> Value {
    json!({ "strand": number(roughness.strand), "tip": number(roughness.tip) })
}

fn dual_settings(dual: Option<DualScattering>) -> Value {
    dual.map_or(false.into(), |dual| {
        json!({
            "forward": number(dual.forward),
            "backward": number(dual.backward),
            "disorder": number(dual.disorder),
        })
    })
}

/// A shadow technique as its group of a scene file.
pub fn shadow_settings(shadow: &Shadow) -> Value {
    match shadow {
        Shadow::DeepOpacityMap(settings) => {
            with_stem(shadow.stem(), json!(DeepOpacityMapKeys::of(settings)))
        }
        Shadow::ShadowMap(settings) => with_stem(shadow.stem(), json!(ShadowMapKeys::of(settings))),
        Shadow::ApproximatedDeepShadowMap(settings) => with_stem(
            shadow.stem(),
            json!(ApproximatedDeepShadowMapKeys::of(settings)),
        ),
        Shadow::OpacityShadowMaps(settings) => {
            with_stem(shadow.stem(), json!(OpacityShadowMapsKeys::of(settings)))
        }
        Shadow::MomentOpacityMap(settings) => {
            with_stem(shadow.stem(), json!(MomentOpacityMapKeys::of(settings)))
        }
        Shadow::KBufferVolume(settings) => {
            with_stem(shadow.stem(), json!(KBufferVolumeKeys::of(settings)))
        }
        _ => json!({ "technique": shadow.stem() }),
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

/// Puts the stem before the settings.
fn with_stem(stem: &str, settings: Value) -> Value {
    let mut group = Map::new();
    group.insert("technique".into(), stem.into());
    if let Value::Object(settings) = settings {
        group.extend(settings);
    }
    Value::Object(group)
}

/// A number as it would be written: JSON's are doubles, in which 0.1 as a float is 0.10000000149.
pub fn number(value: f32) -> Value {
    value
        .to_string()
        .parse::<f64>()
        .map_or(Value::Null, Value::from)
}

/// [`number`] of each channel.
pub fn numbers(values: Vec3) -> Value {
    values.to_array().map(number).to_vec().into()
}
