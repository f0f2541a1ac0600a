//! Techniques with their settings: a shading model, a shadow technique, a transparency technique.

mod shading;
mod shadow;
mod transparency;

pub use shading::*;
pub use shadow::*;
pub use transparency::*;

use super::descriptor;
use crate::error::{Result, invalid};
use crate::raster::Raster;

/// The library chooses.
pub const PELAGE_RASTER_AUTO: u32 = 0;
/// Camera-facing triangle strips.
pub const PELAGE_RASTER_RIBBONS: u32 = 1;
/// A compute pass that walks the pixels of each segment.
pub const PELAGE_RASTER_WALK: u32 = 2;

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

fn switch(name: &str, value: u32) -> Result<bool> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => invalid!("{name} {value} is neither 0 nor 1"),
    }
}
