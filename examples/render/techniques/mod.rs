//! The scene file's `shading`, `shadow` and `transparency` groups: a stem that selects, and the settings of what it
//! selects by the names of the Rust fields.
//!
//! Adding a technique: its stem in its group's list, its settings as a struct with the library's defaults, its line in `keys`, in the
//! function that parses the group, and in the one that writes it.

mod shading;
mod shadow;
mod transparency;

pub use shading::{SHADING, rate_setting, shading, shading_rate, shading_settings};
pub use shadow::{SHADOW, shadow, shadow_settings};
pub use transparency::{TRANSPARENCY, transparency, transparency_settings};

use pelage::Raster;
use pelage::glam::Vec3;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

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
    /// Keys that every stem has.
    pub common: &'static [&'static str],
}

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

/// Settings of a technique that has none.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NoKeys {}

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
        let settings = match self.name {
            "shading" => shading::keys(stem),
            "shadow" => shadow::keys(stem),
            _ => transparency::keys(stem),
        };
        let own = settings.as_object().into_iter().flat_map(Map::keys);
        let common = self.common.iter().map(|key| key.to_string());
        common.chain(own.cloned()).collect()
    }
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
