//! Shadow techniques: how much of a light reaches a point through the hair.

pub mod deep_opacity_map;
pub mod none;

pub use deep_opacity_map::DeepOpacityMap;

use crate::error::Result;
use crate::gpu::{Gpu, Passes};
use crate::plan::{Plan, PlannedMap};
use crate::resources::Bound;

/// A shadow technique with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shadow {
    /// Every light reaches every fibre.
    None,
    /// Yuksel and Keyser 2008 (Hunz §4.2).
    DeepOpacityMap(DeepOpacityMap),
}

impl Default for Shadow {
    fn default() -> Self {
        Self::DeepOpacityMap(DeepOpacityMap::default())
    }
}

impl Shadow {
    /// The stem of the technique's files.
    pub fn stem(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::DeepOpacityMap(_) => "deep_opacity_map",
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// A setting out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::None => Ok(()),
            Self::DeepOpacityMap(settings) => settings.validate(),
        }
    }
}

/// The files of the look-up, `shadow(position, light)`; lights without a map cost a comparison.
pub(crate) fn look_up(shadowed: bool) -> &'static [&'static str] {
    if shadowed {
        deep_opacity_map::LOOK_UP
    } else {
        none::LOOK_UP
    }
}

/// Fills one map of one light.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    deep_opacity_map::record(gpu, passes, bound, map, plan)
}
