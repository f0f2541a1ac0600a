//! The scene file: JSON that says what is seen, from where, and by which techniques. Any group or key may be left out;
//! an unknown one is an error that names the known ones.

use std::path::{Path, PathBuf};

use pelage::groom::BuiltinGroom;
use pelage::shading::{Shading, ShadingRate};
use pelage::shadow::Shadow;
use pelage::transparency::Transparency;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::techniques::{self, GROUPS};

/// A value, or one sentence that names the file, key or value at fault.
pub type Result<T> = std::result::Result<T, String>;

/// A scene as its file and the overrides say it, paths made relative to the working folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What makes up the groom.
    pub hair: Vec<HairSource>,
    /// From where it is seen.
    pub camera: Camera,
    /// The lights; `None`: one key light.
    pub lights: Option<Vec<Light>>,
    /// Radiance of a uniform environment.
    pub ambient: [f32; 3],
    /// The fibres' measures and optics.
    pub fibre: Fibre,
    /// The shading model.
    pub shading: Shading,
    /// Where it is evaluated.
    pub shading_rate: ShadingRate,
    /// The shadow technique of every light.
    pub shadow: Shadow,
    /// The transparency technique.
    pub transparency: Transparency,
    /// The opaque scene's OBJ files; `None`: what comes with the groom.
    pub meshes: Option<Vec<PathBuf>>,
}

/// Where strands come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HairSource {
    /// A `.hair` or `.tfx` file.
    File(PathBuf),
    /// A groom of the library.
    Builtin(BuiltinGroom),
}

/// The `camera` group; what is left out is framed by the groom's bounds.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Camera {
    /// Position of the eye.
    pub eye: Option<[f64; 3]>,
    /// What is looked at.
    pub target: Option<[f64; 3]>,
    /// Which way is up.
    pub up: [f64; 3],
    /// Full vertical field of view in degrees.
    pub vfov_deg: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: None,
            target: None,
            up: [0.0, 1.0, 0.0],
            vfov_deg: 30.0,
            width: 656,
            height: 861,
        }
    }
}

/// One light; `position` and `intensity` make it a point light, `cone_deg` too a spot.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Light {
    /// The way the light travels; a spot's axis.
    pub direction: Option<[f64; 3]>,
    /// Irradiance on a plane that faces the light.
    pub irradiance: Option<[f32; 3]>,
    /// The position of a point light or a spot.
    pub position: Option<[f64; 3]>,
    /// The radiant intensity of a point light or a spot.
    pub intensity: Option<[f32; 3]>,
    /// The angles from a spot's axis up to which it has all of its intensity, and from which on it has none.
    pub cone_deg: Option<[f32; 2]>,
    /// Radiance of a uniform environment, added to the scene's own.
    pub ambient: Option<[f32; 3]>,
}

/// The `fibre` group.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fibre {
    /// Radius everywhere; `None`: the file's own, or else one that suits the groom's size.
    pub radius: Option<f32>,
    /// The fibres' own opacity, 0…1.
    pub opacity: f32,
    /// Index of refraction.
    pub eta: f32,
    /// Absorption per radius.
    pub sigma_a: [f32; 3],
    /// Longitudinal roughness.
    pub beta_m: f32,
    /// Azimuthal roughness.
    pub beta_n: f32,
    /// Tilt of the cuticle's scales in degrees.
    pub alpha_deg: f32,
}

impl Default for Fibre {
    /// Dark blond hair, as the library's own default.
    fn default() -> Self {
        Self {
            radius: None,
            opacity: 1.0,
            eta: 1.55,
            sigma_a: [0.2, 0.35, 0.8],
            beta_m: 0.3,
            beta_n: 0.3,
            alpha_deg: 2.0,
        }
    }
}

/// The file's groups before those that select techniques are looked into.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Groups {
    hair: Value,
    #[serde(default)]
    camera: Camera,
    light: Option<Value>,
    #[serde(default)]
    ambient: [f32; 3],
    #[serde(default)]
    fibre: Fibre,
    #[serde(default)]
    shading: Map<String, Value>,
    #[serde(default)]
    shadow: Map<String, Value>,
    #[serde(default)]
    transparency: Map<String, Value>,
    meshes: Option<Vec<PathBuf>>,
}

impl Scene {
    /// Reads a scene file. `overrides` are `GROUP.KEY=JSON` or `GROUP=JSON`, the last word on their keys.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self> {
        let name = path.display();
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("{name} cannot be read: {error}"))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&text, folder, overrides).map_err(|error| format!("{name}: {error}"))
    }

    /// Reads a scene from text; paths are relative to `folder`.
    pub fn parse(text: &str, folder: &Path, overrides: &[String]) -> Result<Self> {
        let document: Value = serde_json::from_str(text)
            .map_err(|error| format!("the scene is not JSON: {error}"))?;
        let Value::Object(mut document) = document else {
            return Err("the scene is not a JSON object".into());
        };
        override_keys(&mut document, overrides)?;
        let groups: Groups = typed("", Value::Object(document))?;
        Ok(Self {
            hair: hair_sources(groups.hair, folder)?,
            camera: groups.camera,
            lights: groups.light.map(lights).transpose()?,
            ambient: groups.ambient,
            shading: techniques::shading(&groups.shading, &groups.fibre)?,
            shading_rate: techniques::shading_rate(&groups.shading)?,
            fibre: groups.fibre,
            shadow: techniques::shadow(&groups.shadow)?,
            transparency: techniques::transparency(&groups.transparency)?,
            meshes: groups
                .meshes
                .map(|paths| paths.iter().map(|path| folder.join(path)).collect()),
        })
    }
}

/// A JSON value as a type; errors name the key, beginning with `place`.
pub fn typed<T: DeserializeOwned>(place: &str, value: Value) -> Result<T> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        let key = match (place, path.as_str()) {
            ("", "." | "") => String::new(),
            (place, "." | "") => format!("{place}: "),
            ("", path) => format!("{path}: "),
            (place, path) => format!("{place}.{path}: "),
        };
        format!("{key}{}", error.into_inner())
    })
}

/// One `--set`: which key of which group, and its value.
struct Override {
    group: String,
    key: Option<String>,
    value: Value,
}

fn parse_override(text: &str) -> Result<Override> {
    let Some((key, value)) = text.split_once('=') else {
        return Err(format!(
            "--set {text}: GROUP.KEY=JSON is wanted, and there is no \"=\""
        ));
    };
    let value = serde_json::from_str(value).map_err(|error| {
        format!("--set {key}: {value:?} is not JSON ({error}); a string is written with its quotes")
    })?;
    let (group, key) = match key.split_once('.') {
        Some((group, key)) => (group, Some(key.to_owned())),
        None => (key, None),
    };
    Ok(Override {
        group: group.to_owned(),
        key,
        value,
    })
}

/// Lays overrides over the file's keys. Where they select another technique, the file's settings that it does not know
/// are dropped: they were the former technique's.
fn override_keys(document: &mut Map<String, Value>, overrides: &[String]) -> Result<()> {
    let overrides: Vec<Override> = overrides
        .iter()
        .map(|text| parse_override(text))
        .collect::<Result<_>>()?;
    for group in GROUPS {
        let selecting =
            |o: &&Override| o.group == group.name && o.key.as_deref() == Some(group.selector);
        let Some(selected) = overrides.iter().rev().find(selecting) else {
            continue;
        };
        let Some(Value::Object(file)) = document.get_mut(group.name) else {
            continue;
        };
        let Some(stem) = selected.value.as_str() else {
            continue;
        };
        if file
            .get(group.selector)
            .and_then(Value::as_str)
            .unwrap_or(group.default)
            != stem
        {
            let known = group.keys(stem);
            file.retain(|key, _| known.contains(key));
        }
    }
    for Override { group, key, value } in overrides {
        let Some(key) = key else {
            document.insert(group, value);
            continue;
        };
        match document
            .entry(&group)
            .or_insert_with(|| Value::Object(Map::new()))
        {
            Value::Object(map) => map.insert(key, value),
            other => {
                let kind = if other.is_array() {
                    "a list"
                } else {
                    "no group"
                };
                return Err(format!(
                    "--set {group}.{key}: {group} is {kind} in this scene; set it as a whole"
                ));
            }
        };
    }
    Ok(())
}

/// The `hair` key: a path, a built-in groom's name, or a list of them.
fn hair_sources(value: Value, folder: &Path) -> Result<Vec<HairSource>> {
    let names: Vec<String> = match value {
        Value::String(name) => vec![name],
        Value::Array(_) => typed("hair", value)?,
        other => {
            return Err(format!(
                "hair is {other}; a path, \"builtin:…\" or a list of them is wanted"
            ));
        }
    };
    if names.is_empty() {
        return Err("hair is an empty list".into());
    }
    names
        .into_iter()
        .map(|name| match name.strip_prefix("builtin:") {
            None => Ok(HairSource::File(folder.join(name))),
            Some("straight") => Ok(HairSource::Builtin(BuiltinGroom::Straight)),
            Some("wavy") => Ok(HairSource::Builtin(BuiltinGroom::Wavy)),
            Some("curly") => Ok(HairSource::Builtin(BuiltinGroom::Curly)),
            Some(_) => Err(format!("hair \"{name}\" is unknown; there are builtin:straight, builtin:wavy, builtin:curly")),
        })
        .collect()
}

/// The `light` key: a light or a list of them.
fn lights(value: Value) -> Result<Vec<Light>> {
    let values = match value {
        Value::Array(values) => values
            .into_iter()
            .enumerate()
            .map(|(at, value)| (format!("light[{at}]"), value))
            .collect(),
        value => vec![("light".to_owned(), value)],
    };
    values
        .into_iter()
        .map(|(place, value)| light(&place, value))
        .collect()
}

fn light(place: &str, value: Value) -> Result<Light> {
    let light: Light = typed(place, value)?;
    let is_spot = light.cone_deg.is_some();
    let is_point = is_spot || light.position.is_some() || light.intensity.is_some();
    if is_spot && light.direction.is_none() {
        return Err(format!("{place}.direction is missing"));
    }
    let directed = light.direction.is_some() && !is_spot;
    if is_point && (directed || light.irradiance.is_some()) {
        return Err(format!(
            "{place} has keys of a point light (position, intensity) and of a directional one (direction, irradiance)"
        ));
    }
    if is_point && light.position.is_none() {
        return Err(format!("{place}.position is missing"));
    }
    if is_point && light.intensity.is_none() {
        return Err(format!("{place}.intensity is missing"));
    }
    Ok(light)
}
