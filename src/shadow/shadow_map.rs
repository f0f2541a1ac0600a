//! Shadow map (Williams 1978; Hunz §6.2): the nearest fibre's depth a texel. What lies behind it is in shadow, whatever
//! the fibre's opacity; percentage-closer filtering (Reeves et al. 1987) averages these decisions over a box of texels.
//!
//! A texel takes the fibre that covers its centre, as the hardware samples triangles, and not all that touch it: thin
//! fibres then shadow as much as they cover, with noise, instead of whole texels.

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{Emission, Footprint, Raster};
use crate::resources::Bound;

use super::{Shape, Sight};

/// The files of the look-up.
pub(crate) const LOOK_UP: &[&str] = &[
    "shadow/map",
    "shadow/front",
    "shadow/nearest",
    "shadow/shadow_map",
];

/// The files that fill maps of nearest depths.
pub(super) const NEAREST: &[&str] = &["shadow/front", "shadow/map_emit", "shadow/nearest_emit"];

/// The only stage.
pub(crate) const DEPTH: Emission = Emission {
    label: "pelage.shadow.shadow_map.depth",
    stage: 0,
    files: NEAREST,
    group: Group::MapsWritten,
    touch_only: true,
    footprint: Footprint::Centre,
};

/// What exp(-Ω) of a full shadow is taken to be: Ω as an opaque fibre's.
const OPAQUE: f64 = 16.0;

/// Settings of the shadow map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowMap {
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The part of the light that a shadow takes, from 0 to 1.
    pub strength: f32,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for ShadowMap {
    fn default() -> Self {
        Self {
            resolution: 512,
            pcf: 5,
            strength: 1.0,
            raster: Raster::Auto,
        }
    }
}

impl ShadowMap {
    pub(super) fn validate(&self) -> Result<()> {
        super::validate_map("shadow_map", self.resolution, self.pcf)?;
        if !(0.0..=1.0).contains(&self.strength) {
            return invalid!(
                "shadow_map: strength {} is not between 0 and 1",
                self.strength
            );
        }
        Ok(())
    }

    pub(super) fn shape(&self, sight: &Sight) -> Shape {
        let passes = 1.0 - self.strength;
        let optical_depth = (-f64::from(passes).ln()).min(OPAQUE);
        Shape {
            resolution: self.resolution,
            pcf: self.pcf,
            fronts: true,
            layers: 0,
            values: [
                passes,
                optical_depth as f32,
                sight.bias(self.resolution, 1) as f32,
                0.0,
            ],
            colour: [0.0; 4],
            bias: 0.0,
            raster: self.raster,
        }
    }
}

/// Fills one map.
pub(super) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    super::fill(gpu, passes, bound, &DEPTH, map, plan)
}
