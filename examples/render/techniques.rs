//! The scene file's `shading`, `shadow` and `transparency` groups: a stem that selects, and the settings of what it
//! selects by the names of the Rust fields.
//!
//! Adding a technique: its stem in the list, its settings as a struct with the library's defaults, its line in `parse`
//! and in `resolved`.

use glam::Vec3;
use pelage::shading::{KajiyaKay, Shading};
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::transparency::{ABuffer, Opaque, Storage, Transparency};
use pelage::{Raster, glam};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::scene::{Result, typed};

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
}

/// The shading model.
pub const SHADING: Group = Group {
    name: "shading",
    selector: "model",
    stems: &["kajiya_kay"],
    default: "kajiya_kay",
};
/// The shadow technique.
pub const SHADOW: Group = Group {
    name: "shadow",
    selector: "technique",
    stems: &["none", "deep_opacity_map"],
    default: "deep_opacity_map",
};
/// The transparency technique.
pub const TRANSPARENCY: Group = Group {
    name: "transparency",
    selector: "technique",
    stems: &["opaque", "a_buffer"],
    default: "a_buffer",
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

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DeepOpacityMapKeys {
    resolution: u32,
    layers: u32,
    pcf: u32,
    depth: f32,
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
        let storage = match settings.storage {
            Storage::Counted => StorageKey::Counted,
            Storage::Lists => StorageKey::Lists,
        };
        Self {
            storage,
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
        typed(name, Value::Object(settings))
    }

    /// The names of a stem's settings.
    pub fn keys(&self, stem: &str) -> Vec<String> {
        let settings = match stem {
            "kajiya_kay" => json!(KajiyaKayKeys::default()),
            "deep_opacity_map" => json!(DeepOpacityMapKeys::default()),
            "opaque" => json!(OpaqueKeys::default()),
            "a_buffer" => json!(ABufferKeys::default()),
            _ => json!(NoKeys::default()),
        };
        settings
            .as_object()
            .map(|keys| keys.keys().cloned().collect())
            .unwrap_or_default()
    }
}

/// The shading model that a group selects. `sigma_a` is the fibre's absorption, from which colours follow that the group
/// does not give.
pub fn shading(map: &Map<String, Value>, sigma_a: [f32; 3]) -> Result<Shading> {
    let stem = SHADING.stem(map)?;
    match stem {
        "kajiya_kay" => {
            let keys: KajiyaKayKeys = SHADING.settings(stem, map)?;
            let of_fibre = || KajiyaKay::diffuse_of(Vec3::from(sigma_a));
            Ok(Shading::KajiyaKay(KajiyaKay {
                diffuse: keys.diffuse.map_or_else(of_fibre, Vec3::from),
                specular: keys.specular.into(),
                exponent: keys.exponent,
            }))
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
            let storage = match keys.storage {
                StorageKey::Counted => Storage::Counted,
                StorageKey::Lists => Storage::Lists,
            };
            Ok(Transparency::ABuffer(ABuffer {
                storage,
                raster: keys.raster.raster(),
                pool_bytes: keys.pool_bytes,
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
        _ => json!({ "model": shading.stem() }),
    }
}

/// A shadow technique as its group of a scene file.
pub fn shadow_settings(shadow: &Shadow) -> Value {
    match shadow {
        Shadow::DeepOpacityMap(settings) => {
            with_stem(shadow.stem(), json!(DeepOpacityMapKeys::of(settings)))
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
