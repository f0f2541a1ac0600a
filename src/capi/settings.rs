//! Techniques with their settings: a shading model, a shadow technique, a transparency technique.

use std::ptr::null;

use super::descriptor::{self, descriptor};
use super::input::reserved;
use crate::error::{Result, invalid};
use crate::raster::Raster;
use crate::shading::{KajiyaKay, Shading};
use crate::shadow::{DeepOpacityMap, Shadow};
use crate::transparency::{ABuffer, Opaque, Storage, Transparency};

/// Kajiya and Kay 1989.
pub const PELAGE_SHADING_KAJIYA_KAY: u32 = 0;

/// Every light reaches every fibre.
pub const PELAGE_SHADOW_NONE: u32 = 0;
/// Yuksel and Keyser 2008.
pub const PELAGE_SHADOW_DEEP_OPACITY_MAP: u32 = 1;

/// The nearest fragment's colour at the pixel's whole opacity.
pub const PELAGE_TRANSPARENCY_OPAQUE: u32 = 0;
/// Every fragment stored, sorted and composited.
pub const PELAGE_TRANSPARENCY_A_BUFFER: u32 = 1;

/// The library chooses.
pub const PELAGE_RASTER_AUTO: u32 = 0;
/// Camera-facing triangle strips.
pub const PELAGE_RASTER_RIBBONS: u32 = 1;
/// A compute pass that walks the pixels of each segment.
pub const PELAGE_RASTER_WALK: u32 = 2;

/// Fragments counted first, then stored side by side.
pub const PELAGE_STORAGE_COUNTED: u32 = 0;
/// Per-pixel linked lists.
pub const PELAGE_STORAGE_LISTS: u32 = 1;

/// Kajiya and Kay's diffuse and specular lobes.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKajiyaKay {
    /// `sizeof(PelageKajiyaKay)`.
    pub struct_size: u32,
    /// Diffuse coefficient, linear RGB, at least 0; multiplies each strand's own colour. About 1/pi for a light fibre.
    pub diffuse: [f32; 3],
    /// Specular coefficient, linear RGB, at least 0.
    pub specular: [f32; 3],
    /// The specular lobe's exponent, from 1 to 100000.
    pub exponent: f32,
}

impl Default for PelageKajiyaKay {
    fn default() -> Self {
        let KajiyaKay {
            diffuse,
            specular,
            exponent,
        } = KajiyaKay::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            diffuse: diffuse.into(),
            specular: specular.into(),
            exponent,
        }
    }
}

descriptor!(PelageKajiyaKay, "PELAGE_KAJIYA_KAY_INIT", exponent: f32);

/// A shading model with its parameters.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShading {
    /// `sizeof(PelageShading)`.
    pub struct_size: u32,
    /// `PELAGE_SHADING_…`.
    pub model: u32,
    /// For `PELAGE_SHADING_KAJIYA_KAY`; NULL: as `PELAGE_KAJIYA_KAY_INIT`.
    pub kajiya_kay: *const PelageKajiyaKay,
}

impl Default for PelageShading {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            model: PELAGE_SHADING_KAJIYA_KAY,
            kajiya_kay: null(),
        }
    }
}

descriptor!(PelageShading, "PELAGE_SHADING_INIT", kajiya_kay: *const PelageKajiyaKay);

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
}

impl Default for PelageDeepOpacityMap {
    fn default() -> Self {
        let DeepOpacityMap {
            resolution,
            layers,
            pcf,
            depth,
            ..
        } = DeepOpacityMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            layers,
            pcf,
            depth,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageDeepOpacityMap, "PELAGE_DEEP_OPACITY_MAP_INIT", raster: u32);

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
}

impl Default for PelageShadow {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_SHADOW_DEEP_OPACITY_MAP,
            deep_opacity_map: null(),
        }
    }
}

descriptor!(PelageShadow, "PELAGE_SHADOW_INIT", deep_opacity_map: *const PelageDeepOpacityMap);

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
    /// Bytes of the fragment pool, at least 16; 0: the library estimates, and grows it within the byte budget.
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
}

impl Default for PelageTransparency {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_TRANSPARENCY_A_BUFFER,
            opaque: null(),
            a_buffer: null(),
        }
    }
}

descriptor!(PelageTransparency, "PELAGE_TRANSPARENCY_INIT", a_buffer: *const PelageABuffer);

/// What stands behind a pointer to settings, or their defaults behind NULL.
unsafe fn settings<T: descriptor::Descriptor>(name: &str, pointer: *const T) -> Result<T> {
    // SAFETY: the rule of the module `capi`.
    Ok(unsafe { descriptor::read_optional(name, pointer) }?.unwrap_or_default())
}

fn raster(value: u32) -> Result<Raster> {
    match value {
        PELAGE_RASTER_AUTO => Ok(Raster::Auto),
        PELAGE_RASTER_RIBBONS => Ok(Raster::Ribbons),
        PELAGE_RASTER_WALK => Ok(Raster::Walk),
        _ => invalid!("raster {value} is not one of PELAGE_RASTER_…"),
    }
}

/// A validated shading model.
pub(super) unsafe fn shading(name: &str, pointer: *const PelageShading) -> Result<Shading> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read(name, pointer) }?;
    let shading = match given.model {
        PELAGE_SHADING_KAJIYA_KAY => {
            // SAFETY: the rule of the module `capi`.
            let model = unsafe { settings("kajiya_kay", given.kajiya_kay) }?;
            let (diffuse, specular) = (model.diffuse.into(), model.specular.into());
            Shading::KajiyaKay(KajiyaKay {
                diffuse,
                specular,
                exponent: model.exponent,
            })
        }
        unknown => return invalid!("{name}: model {unknown} is not one of PELAGE_SHADING_…"),
    };
    shading.validate().map(|()| shading)
}

/// A validated shadow technique; `None` for NULL.
pub(super) unsafe fn shadow(name: &str, pointer: *const PelageShadow) -> Result<Option<Shadow>> {
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
                raster: raster(map.raster)?,
            })
        }
        unknown => return invalid!("{name}: technique {unknown} is not one of PELAGE_SHADOW_…"),
    };
    shadow.validate().map(|()| Some(shadow))
}

/// A validated transparency technique; `None` for NULL.
pub(super) unsafe fn transparency(
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
        unknown => {
            return invalid!("{name}: technique {unknown} is not one of PELAGE_TRANSPARENCY_…");
        }
    };
    transparency.validate().map(|()| Some(transparency))
}

fn a_buffer(given: &PelageABuffer) -> Result<ABuffer> {
    reserved("PelageABuffer", given.reserved)?;
    let storage = match given.storage {
        PELAGE_STORAGE_COUNTED => Storage::Counted,
        PELAGE_STORAGE_LISTS => Storage::Lists,
        unknown => return invalid!("storage {unknown} is not one of PELAGE_STORAGE_…"),
    };
    let pool_bytes = (given.pool_bytes > 0).then_some(given.pool_bytes);
    Ok(ABuffer {
        storage,
        raster: raster(given.raster)?,
        pool_bytes,
    })
}
