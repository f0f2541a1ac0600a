//! The shadow technique of a scene file.

use pelage::shadow::{
    ApproximatedDeepShadowMap, Attenuation, DeepOpacityMap, KBufferVolume, MomentOpacityMap,
    OpacityShadowMaps, Shadow, ShadowMap,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::super::scene::Result;
use super::{Group, NoKeys, RasterKey, with_stem};

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

/// The settings of a stem, with their defaults.
pub(super) fn keys(stem: &str) -> Value {
    match stem {
        "deep_opacity_map" => json!(DeepOpacityMapKeys::default()),
        "shadow_map" => json!(ShadowMapKeys::default()),
        "approximated_deep_shadow_map" => json!(ApproximatedDeepShadowMapKeys::default()),
        "opacity_shadow_maps" => json!(OpacityShadowMapsKeys::default()),
        "moment_opacity_map" => json!(MomentOpacityMapKeys::default()),
        "k_buffer_volume" => json!(KBufferVolumeKeys::default()),
        _ => json!(NoKeys::default()),
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
