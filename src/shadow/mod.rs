//! Shadow techniques: how much of a light reaches a point through the hair.
//!
//! A technique with maps says what each is made of (`Shape`), fills it (`record`), and is looked up by its files'
//! `shadow_texel`. One technique serves all lights of a frame; their settings may differ.

pub mod approximated_deep_shadow_map;
pub mod deep_opacity_map;
pub(crate) mod held;
pub mod k_buffer_volume;
pub mod moment_opacity_map;
pub mod none;
pub mod opacity_shadow_maps;
pub mod shadow_map;

pub use approximated_deep_shadow_map::ApproximatedDeepShadowMap;
pub use deep_opacity_map::DeepOpacityMap;
pub use k_buffer_volume::{Attenuation, KBufferVolume};
pub use moment_opacity_map::MomentOpacityMap;
pub use opacity_shadow_maps::OpacityShadowMaps;
pub use shadow_map::ShadowMap;

use glam::Vec3;

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Passes};
use crate::light::LightCameras;
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
    /// Nearest depths with percentage-closer filtering (Hunz §6.2).
    ShadowMap(ShadowMap),
    /// Nearest depths, and a guess of the fibres behind them (Hunz §4.3).
    ApproximatedDeepShadowMap(ApproximatedDeepShadowMap),
    /// Kim and Neumann 2001 (Kim §4).
    OpacityShadowMaps(OpacityShadowMaps),
    /// Moments of each texel's optical depths, after Peters and Klein 2015 and Münstermann et al. 2018.
    MomentOpacityMap(MomentOpacityMap),
    /// Yu et al. 2012, §3.1.
    KBufferVolume(KBufferVolume),
}

/// What finds a point's own fibre, beside the look-up.
pub(crate) const OWN: &[&str] = &["common/coverage", "shadow/own"];

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
            Self::ShadowMap(_) => "shadow_map",
            Self::ApproximatedDeepShadowMap(_) => "approximated_deep_shadow_map",
            Self::OpacityShadowMaps(_) => "opacity_shadow_maps",
            Self::MomentOpacityMap(_) => "moment_opacity_map",
            Self::KBufferVolume(_) => "k_buffer_volume",
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
            Self::ShadowMap(settings) => settings.validate(),
            Self::ApproximatedDeepShadowMap(settings) => settings.validate(),
            Self::OpacityShadowMaps(settings) => settings.validate(),
            Self::MomentOpacityMap(settings) => settings.validate(),
            Self::KBufferVolume(settings) => settings.validate(),
        }
    }

    /// What each of a light's maps is made of; `None` where there are none.
    pub(crate) fn shape(&self, sight: &Sight) -> Option<Shape> {
        match self {
            Self::None => None,
            Self::DeepOpacityMap(settings) => Some(settings.shape(sight)),
            Self::ShadowMap(settings) => Some(settings.shape(sight)),
            Self::ApproximatedDeepShadowMap(settings) => Some(settings.shape(sight)),
            Self::OpacityShadowMaps(settings) => Some(settings.shape(sight)),
            Self::MomentOpacityMap(settings) => Some(settings.shape(sight)),
            Self::KBufferVolume(settings) => Some(settings.shape(sight)),
        }
    }

    /// The files of the look-up, `shadow(position, light)`; lights without a map cost a comparison.
    pub(crate) fn look_up(&self) -> &'static [&'static str] {
        match self {
            Self::None => none::LOOK_UP,
            Self::DeepOpacityMap(_) if self.colours() => deep_opacity_map::LOOK_UP_COLOURED,
            Self::DeepOpacityMap(_) => deep_opacity_map::LOOK_UP,
            Self::ShadowMap(_) => shadow_map::LOOK_UP,
            Self::ApproximatedDeepShadowMap(_) => approximated_deep_shadow_map::LOOK_UP,
            Self::OpacityShadowMaps(_) => opacity_shadow_maps::LOOK_UP,
            Self::MomentOpacityMap(_) if self.colours() => moment_opacity_map::LOOK_UP_COLOURED,
            Self::MomentOpacityMap(_) => moment_opacity_map::LOOK_UP,
            Self::KBufferVolume(_) => k_buffer_volume::LOOK_UP,
        }
    }

    /// Whether sums of optical depths colour the light: the look-up of a map that does so serves grey ones too.
    pub(crate) fn colours(&self) -> bool {
        match self {
            Self::DeepOpacityMap(settings) => settings.transmitted != Vec3::ZERO,
            Self::MomentOpacityMap(settings) => settings.transmitted != Vec3::ZERO,
            _ => false,
        }
    }

    /// The look-up with what finds a point's own fibre, which it is not to be shadowed by.
    pub(crate) fn module(&self) -> Module {
        Module::new(self.look_up()).and(OWN)
    }

    /// What tells a pipeline with one technique's look-up from another's.
    pub(crate) fn variant(&self) -> u32 {
        let technique = match self {
            Self::None => 0,
            Self::DeepOpacityMap(_) => 1,
            Self::ShadowMap(_) => 2,
            Self::ApproximatedDeepShadowMap(_) => 3,
            Self::OpacityShadowMaps(_) => 4,
            Self::MomentOpacityMap(_) => 5,
            Self::KBufferVolume(_) => 6,
        };
        technique << 1 | u32::from(self.colours())
    }

    /// Whether the maps' shape depends on how densely the hair fills space, which takes a look at every strand once.
    pub(crate) fn needs_density(&self) -> bool {
        match self {
            Self::None
            | Self::DeepOpacityMap(_)
            | Self::ShadowMap(_)
            | Self::OpacityShadowMaps(_)
            | Self::MomentOpacityMap(_)
            | Self::KBufferVolume(_) => false,
            Self::ApproximatedDeepShadowMap(settings) => {
                settings.opacity.is_none() || settings.spacing.is_none()
            }
        }
    }
}

/// The fibres of all hairs of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Fibres {
    /// Mean of their own opacities, by area.
    pub opacity: f64,
    /// Length × diameter over the volume that they fill, in 1 / host units: 0 where no technique asks for it.
    pub area_density: f64,
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
    pub fibres: Fibres,
}

impl Sight {
    pub fn new(cameras: &LightCameras, radius: f64, fibres: Fibres) -> Self {
        Self {
            extent: cameras.extent,
            width: cameras.width,
            nearest_width: cameras.nearest_width,
            radius,
            fibres,
        }
    }

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
    /// Whether each texel has a front, the nearest depth.
    pub fronts: bool,
    /// Words a texel behind the fronts.
    pub layers: u32,
    /// What the technique's files read as `drawing.map_values` and `shadow_views[…].values`.
    pub values: [f32; 4],
    /// What they read as `drawing.map_colour` and `shadow_views[…].colour`. In techniques that sum optical depths: by how
    /// much these count in each channel.
    pub colour: [f32; 4],
    pub bias: f64,
    pub raster: Raster,
}

impl Shape {
    /// How many fronts there are.
    pub fn fronts(&self) -> u64 {
        u64::from(self.fronts) * u64::from(self.resolution).pow(2)
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

/// Checks what a fibre passes on of the light that meets it.
fn validate_transmitted(stem: &str, transmitted: Vec3) -> Result<()> {
    let within = transmitted.cmpge(Vec3::ZERO).all() && transmitted.cmplt(Vec3::ONE).all();
    if !within {
        let Vec3 { x, y, z } = transmitted;
        return invalid!(
            "{stem}: transmitted ({x}, {y}, {z}) has a component that is not from 0 to below 1"
        );
    }
    Ok(())
}

/// The colour of a map that sums optical depths. A crossing by a fibre of opacity × coverage o leaves 1 - o (1 - t) of a
/// channel of which t is passed on; for small o that is (1 - o) to the power of 1 - t, which sums of logarithms can carry.
fn summed_colour(transmitted: Vec3) -> [f32; 4] {
    (Vec3::ONE - transmitted).extend(1.0).into()
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
        Shadow::ShadowMap(_) => shadow_map::record(gpu, passes, bound, map, plan),
        Shadow::ApproximatedDeepShadowMap(_) => {
            approximated_deep_shadow_map::record(gpu, passes, bound, map, plan)
        }
        Shadow::OpacityShadowMaps(_) => opacity_shadow_maps::record(gpu, passes, bound, map, plan),
        Shadow::MomentOpacityMap(_) => moment_opacity_map::record(gpu, passes, bound, map, plan),
        Shadow::KBufferVolume(_) => k_buffer_volume::record(gpu, passes, bound, map, plan),
    }
}
