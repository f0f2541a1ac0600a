//! Shadow techniques: how much of a light reaches a point through the hair.
//!
//! A technique with maps says what each is made of ([`Shape`]), fills it (`record`), and is looked up by its files'
//! `shadow_texel`. One technique serves all lights of a frame; their settings may differ.

pub mod deep_opacity_map;
pub mod none;

pub use deep_opacity_map::DeepOpacityMap;

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Passes};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{self, Emission, Raster};
use crate::resources::Bound;
use crate::shader::Module;

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

    /// What each of a light's maps is made of; `None` where there are none.
    pub(crate) fn shape(&self, sight: &Sight) -> Option<Shape> {
        match self {
            Self::None => None,
            Self::DeepOpacityMap(settings) => Some(settings.shape(sight)),
        }
    }

    /// The files of the look-up, `shadow(position, light)`; lights without a map cost a comparison.
    pub(crate) fn look_up(&self) -> &'static [&'static str] {
        match self {
            Self::None => none::LOOK_UP,
            Self::DeepOpacityMap(_) => deep_opacity_map::LOOK_UP,
        }
    }

    /// The look-up with what finds a point's own fibre, which it is not to be shadowed by.
    pub(crate) fn module(&self) -> Module {
        Module::new(self.look_up()).and(&["common/coverage", "shadow/own"])
    }

    /// What tells a pipeline with one technique's look-up from another's.
    pub(crate) fn variant(&self) -> u32 {
        match self {
            Self::None => 0,
            Self::DeepOpacityMap(_) => 1,
        }
    }
}

/// How a light's maps see the hair, in host units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sight {
    /// Depth range of the hair.
    pub extent: f64,
    /// Width of a map at the hair's middle, and at the nearest hair.
    pub width: f64,
    pub nearest_width: f64,
    /// The widest fibre's radius.
    pub radius: f64,
}

impl Sight {
    /// The widest fibre's half-width in texels.
    pub fn half_width(&self, resolution: u32) -> f64 {
        self.radius * f64::from(resolution) / self.nearest_width
    }

    /// How much nearer to the light than it is a point is taken to be, so that its own fibre, as coarse as texels are,
    /// does not shadow it: the fibre itself, and half of the box that the filter averages over.
    pub fn bias(&self, resolution: u32, pcf: u32) -> f64 {
        let texel = self.width / f64::from(resolution);
        2.0 * self.radius + 0.25 * f64::from(pcf + 1) * texel
    }
}

/// What a map is made of: square, of fronts and layers, either of which may be missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    /// Texels a side.
    pub resolution: u32,
    /// Width of the filter in texels.
    pub pcf: u32,
    /// Blocks of 1 << front_shift texels a side share one word, the front; `None`: no fronts.
    pub front_shift: Option<u32>,
    /// Words a texel behind the fronts.
    pub layers: u32,
    /// What the technique's files read as `drawing.map_values` and `shadow_views[…].values`.
    pub values: [f32; 4],
    pub bias: f64,
    pub raster: Raster,
}

impl Shape {
    /// How many fronts there are.
    pub fn fronts(&self) -> u64 {
        self.front_shift.map_or(0, |shift| {
            u64::from(self.resolution.div_ceil(1 << shift)).pow(2)
        })
    }
}

/// Checks what all maps have in common.
fn validate_map(stem: &str, resolution: u32, pcf: u32) -> Result<()> {
    if !(16..=8192).contains(&resolution) {
        return invalid!("{stem}: resolution {resolution} is not between 16 and 8192");
    }
    if !matches!(pcf, 1 | 3 | 5) {
        return invalid!("{stem}: pcf {pcf} is not 1, 3 or 5");
    }
    Ok(())
}

/// Hands every fragment of a map to an emission.
fn fill(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    emission: &Emission,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    let size = [map.shape.resolution; 2];
    let draw = raster::Draw {
        rasteriser: map.rasteriser,
        splits: map.splits,
        size,
        rows: [0, size[1]],
        drawings: &map.drawings,
        on_overflow: false,
    };
    raster::record(gpu, passes, bound, emission, &draw, plan)
}

/// Fills one map of one light.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    match map.technique {
        Shadow::None => Ok(()),
        Shadow::DeepOpacityMap(_) => deep_opacity_map::record(gpu, passes, bound, map, plan),
    }
}
