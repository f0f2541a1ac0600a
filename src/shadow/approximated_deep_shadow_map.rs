//! Approximated deep shadow map (Hunz §4.3, from TressFX): a map of nearest depths, and behind each a guess of how many
//! fibres there are, n, from the depth behind it and the mean spacing of fibres along a ray; transmittance is (1 - α_s)ⁿ.
//!
//! A texel's nearest fibre is the first at its centre, as in a shadow map, so that n counts what a ray meets: fibres spread as
//! Poisson's points would then be crossed by n of mean transmittance exactly (1 - α_s)ⁿ.

use std::f64::consts::FRAC_PI_4;

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{Emission, Footprint, Raster};
use crate::resources::Bound;

use super::shadow_map::NEAREST;
use super::{Shape, Sight};

/// The files of the look-up.
pub(crate) const LOOK_UP: &[&str] = &[
    "shadow/map",
    "shadow/passed",
    "shadow/front",
    "shadow/nearest",
    "shadow/approximated_deep_shadow_map",
];

/// The only stage.
pub(crate) const DEPTH: Emission = Emission {
    label: "pelage.shadow.approximated_deep_shadow_map.depth",
    stage: 0,
    files: NEAREST,
    group: Group::MapsWritten,
    touch_only: true,
    footprint: Footprint::Centre,
};

/// The optical depth of an opaque fibre.
const OPAQUE: f64 = 16.0;

/// Settings of the approximated deep shadow map.
///
/// Of `opacity` and `spacing`, what is not given follows from the groom: from the volume that its strands fill, measured
/// once on the CPU as they were loaded, and from their length, width and own opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproximatedDeepShadowMap {
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// α_s, the opacity of each fibre that is guessed to lie in the way, above 0 and up to 1. `None`: the fibres' own.
    pub opacity: Option<f32>,
    /// w, the mean distance between fibres along a ray, in host units, above 0. `None`: such that mean transmittance is
    /// that of fibres spread evenly in the volume that they fill.
    pub spacing: Option<f32>,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for ApproximatedDeepShadowMap {
    fn default() -> Self {
        Self {
            resolution: 512,
            pcf: 3,
            opacity: None,
            spacing: None,
            raster: Raster::Auto,
        }
    }
}

impl ApproximatedDeepShadowMap {
    pub(super) fn validate(&self) -> Result<()> {
        super::validate_map("approximated_deep_shadow_map", self.resolution, self.pcf)?;
        if let Some(opacity) = self.opacity
            && !(opacity > 0.0 && opacity <= 1.0)
        {
            return invalid!(
                "approximated_deep_shadow_map: opacity {opacity} is not above 0 and up to 1"
            );
        }
        if let Some(spacing) = self.spacing
            && !(spacing > 0.0 && spacing.is_finite())
        {
            return invalid!("approximated_deep_shadow_map: spacing {spacing} is not positive");
        }
        Ok(())
    }

    pub(super) fn shape(&self, sight: &Sight) -> Shape {
        let fibres = sight.fibres;
        let opacity = self.opacity.map_or(fibres.opacity, f64::from);
        let optical_depth = (-(1.0 - opacity).ln()).min(OPAQUE);
        // π/4 is the mean sine between fibre and ray.
        let extinction = FRAC_PI_4 * fibres.opacity * fibres.area_density;
        let per_unit = match self.spacing {
            Some(spacing) => 1.0 / f64::from(spacing),
            None if optical_depth > 0.0 => extinction / optical_depth,
            None => 0.0,
        };
        Shape {
            resolution: self.resolution,
            pcf: self.pcf,
            fronts: true,
            layers: 0,
            values: [
                per_unit as f32,
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
