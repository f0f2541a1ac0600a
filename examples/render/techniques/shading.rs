//! The shading model of a scene file.

use pelage::glam::Vec3;
use pelage::shading::{
    Chiang, DualScattering, Highlight, KajiyaKay, Marschner, Precision, Roots, RoughnessVariation,
    Sadeghi, Scheuermann, Shading, ShadingRate, Tables,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::super::scene::{Fibre, Result, typed};
use super::{Group, NoKeys, number, numbers};

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

/// The settings of a stem, with their defaults.
pub(super) fn keys(stem: &str) -> Value {
    match stem {
        "kajiya_kay" => json!(KajiyaKayKeys::default()),
        "scheuermann" => json!(ScheuermannKeys::default()),
        "marschner" => json!(MarschnerKeys::default()),
        "sadeghi" => json!(SadeghiKeys::default()),
        "chiang" => json!(ChiangKeys::default()),
        _ => json!(NoKeys::default()),
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
