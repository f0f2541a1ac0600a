//! Transparency techniques: how a pixel's fragments become one colour.

pub mod a_buffer;
pub mod opaque;

pub use a_buffer::{ABuffer, Storage};
pub use opaque::Opaque;

use crate::error::Result;
use crate::gpu::{Gpu, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{Draw, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::Shader;

/// A transparency technique with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Transparency {
    /// The nearest fragment's colour at the pixel's whole opacity.
    Opaque(Opaque),
    /// Every fragment stored, sorted and composited.
    ABuffer(ABuffer),
}

impl Default for Transparency {
    fn default() -> Self {
        Self::ABuffer(ABuffer::default())
    }
}

impl Transparency {
    /// The stem of the technique's files.
    pub fn stem(&self) -> &'static str {
        match self {
            Self::Opaque(_) => "opaque",
            Self::ABuffer(_) => "a_buffer",
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// A setting out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::Opaque(_) => Ok(()),
            Self::ABuffer(settings) => settings.validate(),
        }
    }

    /// The rasteriser that the settings ask for.
    pub fn raster(&self) -> Raster {
        match self {
            Self::Opaque(settings) => settings.raster,
            Self::ABuffer(settings) => settings.raster,
        }
    }
}

/// Fragments of a band of rows into the technique's buffers.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
) -> Result<()> {
    let draw = Draw {
        rasteriser: plan.rasteriser,
        splits: plan.splits,
        size: [plan.width, plan.height],
        rows: [band.first, band.rows],
        drawings: &band.drawings,
        on_overflow: false,
    };
    match &plan.transparency {
        Transparency::Opaque(_) => opaque::record(gpu, passes, bound, band, &draw, plan),
        Transparency::ABuffer(settings) => {
            a_buffer::record(gpu, passes, bound, band, &draw, plan, settings.storage)
        }
    }
}

/// The files that supply `resolve(pixel)`; with a shader, fragments are shaded there.
pub(crate) fn resolve_module(
    transparency: &Transparency,
    parts: u32,
    shader: Option<&Shader>,
) -> Module {
    let shaded = match shader {
        None => Module::new(&["transparency/shaded"]),
        Some(shader) => shader.fragments_module(),
    };
    let common = shaded
        .and(&["common/pixels"])
        .with("PARTS", Constant::U32(parts));
    match transparency {
        Transparency::Opaque(_) => common.and(&["transparency/opaque"]),
        Transparency::ABuffer(settings) => {
            a_buffer::resolve_module(common, settings.storage, shader)
        }
    }
}

/// What tells one technique's composite pipeline from another's.
pub(crate) fn resolve_variant(transparency: &Transparency) -> u32 {
    match transparency {
        Transparency::Opaque(_) => 0,
        Transparency::ABuffer(ABuffer {
            storage: Storage::Counted,
            ..
        }) => 1,
        Transparency::ABuffer(ABuffer {
            storage: Storage::Lists,
            ..
        }) => 2,
    }
}
