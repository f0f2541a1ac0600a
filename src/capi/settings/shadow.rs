//! A shadow technique with its settings.

use std::ptr::null;

use super::{PELAGE_RASTER_AUTO, raster, settings};
use crate::capi::descriptor::{self, descriptor};
use crate::error::{Result, invalid};
use crate::shadow::{
    ApproximatedDeepShadowMap, Attenuation, DeepOpacityMap, KBufferVolume, MomentOpacityMap,
    OpacityShadowMaps, Shadow, ShadowMap,
};

/// Every light reaches every fibre.
pub const PELAGE_SHADOW_NONE: u32 = 0;
/// Yuksel and Keyser 2008.
pub const PELAGE_SHADOW_DEEP_OPACITY_MAP: u32 = 1;
/// Nearest depths with percentage-closer filtering.
pub const PELAGE_SHADOW_SHADOW_MAP: u32 = 2;
/// Nearest depths, and a guess of the fibres behind them.
pub const PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP: u32 = 3;
/// Kim and Neumann 2001.
pub const PELAGE_SHADOW_OPACITY_SHADOW_MAPS: u32 = 4;
/// Peters and Klein 2015, Münstermann et al. 2018.
pub const PELAGE_SHADOW_MOMENT_OPACITY_MAP: u32 = 5;
/// Yu et al. 2012.
pub const PELAGE_SHADOW_K_BUFFER_VOLUME: u32 = 6;

/// A fibre takes as much of the light as its opacity says.
pub const PELAGE_ATTENUATION_OPACITY: u32 = 0;
/// A fibre takes what its surface reflects and its inside absorbs.
pub const PELAGE_ATTENUATION_FRESNEL: u32 = 1;

/// Settings of the deep opacity map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageDeepOpacityMap {
    /// `sizeof(PelageDeepOpacityMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Layers, from 1 to 64.
    pub layers: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Depth behind the front at which the last layer ends, as a part of the hair's extent along the light, above 0 and
    /// up to 1. What lies deeper counts in the last layer.
    pub depth: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    pub transmitted: [f32; 3],
}

impl Default for PelageDeepOpacityMap {
    fn default() -> Self {
        let DeepOpacityMap {
            resolution,
            layers,
            pcf,
            depth,
            transmitted,
            ..
        } = DeepOpacityMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            layers,
            pcf,
            depth,
            raster: PELAGE_RASTER_AUTO,
            transmitted: transmitted.into(),
        }
    }
}

descriptor!(PelageDeepOpacityMap, "PELAGE_DEEP_OPACITY_MAP_INIT", transmitted: [f32; 3]);

/// Settings of the moment opacity map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageMomentOpacityMap {
    /// `sizeof(PelageMomentOpacityMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Moments beside the sum, 4 or 6.
    pub moments: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    pub transmitted: [f32; 3],
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageMomentOpacityMap {
    fn default() -> Self {
        let MomentOpacityMap {
            resolution,
            moments,
            pcf,
            transmitted,
            ..
        } = MomentOpacityMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            moments,
            pcf,
            transmitted: transmitted.into(),
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageMomentOpacityMap, "PELAGE_MOMENT_OPACITY_MAP_INIT", raster: u32);

/// Settings of the k-buffer volumetric shadow.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKBufferVolume {
    /// `sizeof(PelageKBufferVolume)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Events a texel, from 1 to 64.
    pub k: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// 1: what lies behind the K-th event counts, spread evenly to the farthest one. 0: it does not.
    pub tail: u32,
    /// `PELAGE_ATTENUATION_…`: what a fibre takes of the light.
    pub attenuation: u32,
    /// Of `PELAGE_ATTENUATION_FRESNEL`: the index of refraction, from 1.01 to 3.
    pub eta: f32,
    /// Of `PELAGE_ATTENUATION_FRESNEL`: absorption per fibre radius, from 0.
    pub sigma_a: [f32; 3],
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageKBufferVolume {
    fn default() -> Self {
        let KBufferVolume {
            resolution,
            k,
            pcf,
            tail,
            ..
        } = KBufferVolume::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            k,
            pcf,
            tail: u32::from(tail),
            attenuation: PELAGE_ATTENUATION_OPACITY,
            eta: 1.55,
            sigma_a: [0.0; 3],
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageKBufferVolume, "PELAGE_K_BUFFER_VOLUME_INIT", raster: u32);

/// Settings of the shadow map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShadowMap {
    /// `sizeof(PelageShadowMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The part of the light that a shadow takes, from 0 to 1.
    pub strength: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageShadowMap {
    fn default() -> Self {
        let ShadowMap {
            resolution,
            pcf,
            strength,
            ..
        } = ShadowMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            pcf,
            strength,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageShadowMap, "PELAGE_SHADOW_MAP_INIT", raster: u32);

/// Settings of the approximated deep shadow map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageApproximatedDeepShadowMap {
    /// `sizeof(PelageApproximatedDeepShadowMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Opacity of each fibre that is guessed to lie in the way, above 0 and up to 1. 0: the fibres' own.
    pub opacity: f32,
    /// Mean distance between fibres along a ray, in host units. 0: such that mean transmittance is that of fibres spread
    /// evenly in the volume that they fill.
    pub spacing: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageApproximatedDeepShadowMap {
    fn default() -> Self {
        let ApproximatedDeepShadowMap {
            resolution, pcf, ..
        } = ApproximatedDeepShadowMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            pcf,
            opacity: 0.0,
            spacing: 0.0,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(
    PelageApproximatedDeepShadowMap,
    "PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT",
    raster: u32
);

/// Settings of opacity shadow maps.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageOpacityShadowMaps {
    /// `sizeof(PelageOpacityShadowMaps)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Planes, from 1 to 256.
    pub layers: u32,
    /// How much farther apart the planes lie with depth, from 0, evenly, to 1, as the square of their number.
    pub unevenness: f32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageOpacityShadowMaps {
    fn default() -> Self {
        let OpacityShadowMaps {
            resolution,
            layers,
            unevenness,
            pcf,
            ..
        } = OpacityShadowMaps::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            layers,
            unevenness,
            pcf,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageOpacityShadowMaps, "PELAGE_OPACITY_SHADOW_MAPS_INIT", raster: u32);

/// A shadow technique with its settings.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShadow {
    /// `sizeof(PelageShadow)`.
    pub struct_size: u32,
    /// `PELAGE_SHADOW_…`.
    pub technique: u32,
    /// For `PELAGE_SHADOW_DEEP_OPACITY_MAP`; NULL: as `PELAGE_DEEP_OPACITY_MAP_INIT`.
    pub deep_opacity_map: *const PelageDeepOpacityMap,
    /// For `PELAGE_SHADOW_SHADOW_MAP`; NULL: as `PELAGE_SHADOW_MAP_INIT`.
    pub shadow_map: *const PelageShadowMap,
    /// For `PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP`; NULL: as `PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT`.
    pub approximated_deep_shadow_map: *const PelageApproximatedDeepShadowMap,
    /// For `PELAGE_SHADOW_OPACITY_SHADOW_MAPS`; NULL: as `PELAGE_OPACITY_SHADOW_MAPS_INIT`.
    pub opacity_shadow_maps: *const PelageOpacityShadowMaps,
    /// For `PELAGE_SHADOW_MOMENT_OPACITY_MAP`; NULL: as `PELAGE_MOMENT_OPACITY_MAP_INIT`.
    pub moment_opacity_map: *const PelageMomentOpacityMap,
    /// For `PELAGE_SHADOW_K_BUFFER_VOLUME`; NULL: as `PELAGE_K_BUFFER_VOLUME_INIT`.
    pub k_buffer_volume: *const PelageKBufferVolume,
}

impl Default for PelageShadow {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_SHADOW_DEEP_OPACITY_MAP,
            deep_opacity_map: null(),
            shadow_map: null(),
            approximated_deep_shadow_map: null(),
            opacity_shadow_maps: null(),
            moment_opacity_map: null(),
            k_buffer_volume: null(),
        }
    }
}

descriptor!(PelageShadow, "PELAGE_SHADOW_INIT", k_buffer_volume: *const PelageKBufferVolume);

fn k_buffer_volume(map: &PelageKBufferVolume) -> Result<KBufferVolume> {
    let attenuation = match map.attenuation {
        PELAGE_ATTENUATION_OPACITY => Attenuation::Opacity,
        PELAGE_ATTENUATION_FRESNEL => Attenuation::Fresnel {
            eta: map.eta,
            sigma_a: map.sigma_a.into(),
        },
        unknown => {
            return invalid!(
                "k_buffer_volume: attenuation {unknown} is not one of PELAGE_ATTENUATION_…"
            );
        }
    };
    if map.tail > 1 {
        return invalid!("k_buffer_volume: tail {} is not 0 or 1", map.tail);
    }
    Ok(KBufferVolume {
        resolution: map.resolution,
        k: map.k,
        pcf: map.pcf,
        tail: map.tail == 1,
        attenuation,
        raster: raster(map.raster)?,
    })
}

/// A validated shadow technique; `None` for NULL.
pub(in crate::capi) unsafe fn shadow(
    name: &str,
    pointer: *const PelageShadow,
) -> Result<Option<Shadow>> {
    // SAFETY: the rule of the module `capi`.
    let Some(given) = unsafe { descriptor::read_optional(name, pointer) }? else {
        return Ok(None);
    };
    let shadow = match given.technique {
        PELAGE_SHADOW_NONE => Shadow::None,
        PELAGE_SHADOW_DEEP_OPACITY_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("deep_opacity_map", given.deep_opacity_map) }?;
            Shadow::DeepOpacityMap(DeepOpacityMap {
                resolution: map.resolution,
                layers: map.layers,
                pcf: map.pcf,
                depth: map.depth,
                transmitted: map.transmitted.into(),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_SHADOW_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("shadow_map", given.shadow_map) }?;
            Shadow::ShadowMap(ShadowMap {
                resolution: map.resolution,
                pcf: map.pcf,
                strength: map.strength,
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP => {
            let map = given.approximated_deep_shadow_map;
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("approximated_deep_shadow_map", map) }?;
            let chosen = |value: f32| (value != 0.0).then_some(value);
            Shadow::ApproximatedDeepShadowMap(ApproximatedDeepShadowMap {
                resolution: map.resolution,
                pcf: map.pcf,
                opacity: chosen(map.opacity),
                spacing: chosen(map.spacing),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_OPACITY_SHADOW_MAPS => {
            // SAFETY: the rule of the module `capi`.
            let maps = unsafe { settings("opacity_shadow_maps", given.opacity_shadow_maps) }?;
            Shadow::OpacityShadowMaps(OpacityShadowMaps {
                resolution: maps.resolution,
                layers: maps.layers,
                unevenness: maps.unevenness,
                pcf: maps.pcf,
                raster: raster(maps.raster)?,
            })
        }
        PELAGE_SHADOW_MOMENT_OPACITY_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("moment_opacity_map", given.moment_opacity_map) }?;
            Shadow::MomentOpacityMap(MomentOpacityMap {
                resolution: map.resolution,
                moments: map.moments,
                pcf: map.pcf,
                transmitted: map.transmitted.into(),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_K_BUFFER_VOLUME => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("k_buffer_volume", given.k_buffer_volume) }?;
            Shadow::KBufferVolume(k_buffer_volume(&map)?)
        }
        unknown => return invalid!("{name}: technique {unknown} is not one of PELAGE_SHADOW_…"),
    };
    shadow.validate().map(|()| Some(shadow))
}
