//! A row of `report.json`.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ladder::Case;
use super::scenes::Scene;
use super::{Group, flip};
use crate::Result;

/// One technique with one set of settings on one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The group's name: `shading`, `samples`, `frames`, `shadow`, `transparency`.
    pub group: String,
    /// The technique's stem.
    pub technique: String,
    /// Its settings; `pool_part` is the pool as a part of what all fragments need.
    pub settings: Value,
    /// The scene's name.
    pub scene: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Against the reference: of linear radiance over hair-covered pixels, or for shadows of transmittance.
    pub error: Error,
    /// For shadows, the error of the picture where points were shaded.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub image_error: Option<Error>,
    /// For shadows, the squares that the picture's ꟻLIP is of.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub squares: Option<String>,
    /// For transparency, how many pixels are not compared, since single precision cannot tell whether the opaque scene hides a
    /// fragment there.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub undecided: Option<usize>,
    /// For transparency, the error of the opacity.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub alpha_error: Option<Error>,
    /// Time of the frame, for shadows of the light's passes, for samples of the evaluation of all, in milliseconds.
    pub ms: Times,
    /// How many samples were evaluated in that time.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub samples: Option<u64>,
    /// For frames, the time over that of the same round's first model.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub ratio: Option<Times>,
    /// For frames shaded at points, time of the shading passes submitted alone, in milliseconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub shading_ms: Option<Times>,
    /// GPU memory of the frame: the geometry's and the techniques'; for samples the tables' alone.
    pub bytes: u64,
    /// What became of the fragments.
    pub fragments: Option<Fragments>,
    /// The fewest fragments that the technique's tolerance allows, by the reference.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fewest: Option<u64>,
    /// Time of the frame's passes, each submitted alone, in milliseconds.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub passes: BTreeMap<String, f64>,
    /// How long it took to measure all this, in seconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub seconds: Option<f64>,
    /// The device.
    pub adapter: String,
    /// Its driver.
    pub driver: String,
    /// When, UTC.
    pub date: String,
}

/// How far from the reference.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Error {
    /// Root of the mean square.
    pub rmse: f64,
    /// 99th percentile.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
    /// Mean ꟻLIP of the pictures over mid-grey; none for transmittances, or where it is not built in.
    pub flip: Option<f64>,
    /// Of transmittance, the mean: above zero where too much light comes through.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bias: Option<f64>,
}

/// Wall clock.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// The least.
    pub min: f64,
    /// The median.
    pub median: f64,
}

/// Counts of fragments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fragments {
    /// Found by the rasteriser.
    pub produced: u64,
    /// Dropped before they were stored.
    pub culled: u64,
    /// Stored one by one.
    pub stored: u64,
    /// Merged into a tail.
    pub merged: u64,
}

impl Row {
    /// Whether all that would be measured today is there: rows of shadows may be older than their ꟻLIP.
    pub fn is_whole(&self) -> bool {
        self.group != Group::Shadow.name() || self.squares.is_some() || !flip::IS_BUILT_IN
    }

    /// Nanoseconds a sample, the least, where samples were evaluated.
    pub fn ns(&self) -> Option<f64> {
        self.samples.map(|count| self.ms.min * 1e6 / count as f64)
    }

    /// Whether this is a case's row on a scene.
    pub fn is_of(&self, case: &Case, scene: &Scene) -> bool {
        self.group == case.group.name()
            && self.technique == case.technique()
            && self.scene == scene.name
            && [self.width, self.height] == scene.size
            && without_bytes(&self.settings) == without_bytes(&case.settings())
    }
}

/// Settings as read from text, so that numbers compare as they are written; without the pool's size in bytes and the depth
/// shift where they follow from a part.
pub fn without_bytes(settings: &Value) -> Value {
    let mut settings: Value = serde_json::from_str(&settings.to_string()).unwrap_or_default();
    if let Value::Object(map) = &mut settings
        && map.contains_key("pool_part")
    {
        map.shift_remove("pool_bytes");
    }
    if let Value::Object(map) = &mut settings
        && map.contains_key("shift_part")
    {
        map.shift_remove("depth_shift");
    }
    settings
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} {} on {}: RMSE {:.2e}, p99 {:.2e}, max {:.2e}, {:.1} ms, {:.1} MB",
            self.technique,
            self.settings,
            self.scene,
            self.error.rmse,
            self.error.p99,
            self.error.max,
            self.ms.median,
            self.bytes as f64 / 1e6
        )
    }
}

/// Reads the rows of a former run; none where there is no file.
pub fn load(path: &Path) -> Result<Vec<Row>> {
    let name = path.display();
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(format!("{name} cannot be read: {error}")),
    };
    serde_json::from_str(&text).map_err(|error| format!("{name} is no report: {error}"))
}

/// Writes all rows, the old file staying whole until the new one is.
pub fn save(path: &Path, rows: &[Row]) -> Result<()> {
    let text = serde_json::to_string_pretty(rows).map_err(|error| error.to_string())?;
    let beside = path.with_extension("json.new");
    std::fs::write(&beside, text + "\n")
        .and_then(|()| std::fs::rename(&beside, path))
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}
