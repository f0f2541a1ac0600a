//! Opacity shadow maps (Kim §4; Kim and Neumann 2001): planes across the light's way, for each of which and each texel
//! the sum of -ln(1 - opacity) of all fragments before it is known; linear in between, and transmittance is exp(-Ω).
//!
//! The sums are whole multiples of 1/65536, up to 32,768 at least: a million opaque fragments in one texel are as dark as
//! 2,048, and each fragment's optical depth is rounded by no more than 7.7e-6.

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::Module;

use super::{Shape, Sight};

/// The files of the look-up.
pub(crate) const LOOK_UP: &[&str] = &[
    "shadow/map",
    "shadow/passed",
    "shadow/opacity_shadow_maps_common",
    "shadow/opacity_shadow_maps",
];
/// The file of the pass that sums the slabs.
pub(crate) const SUM: &[&str] = &["shadow/opacity_shadow_maps_sum"];

/// The only stage that takes fragments.
pub(crate) const SLABS: Emission = Emission {
    label: "pelage.shadow.opacity_shadow_maps.slabs",
    stage: 0,
    files: &[
        "shadow/front",
        "shadow/map_emit",
        "shadow/opacity_shadow_maps_common",
        "shadow/opacity_shadow_maps_emit",
    ],
    group: Group::MapsWritten,
    touch_only: false,
    footprint: Footprint::Slice,
};

/// Settings of opacity shadow maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpacityShadowMaps {
    /// Texels a side, from 16 to 8192. A light's maps take 4 `resolution`² `layers` bytes each, which one binding of the
    /// device must hold.
    pub resolution: u32,
    /// Planes, N, from 1 to 256.
    pub layers: u32,
    /// How much farther apart the planes lie with depth, from 0, evenly, to 1, as the square of their number.
    pub unevenness: f32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for OpacityShadowMaps {
    fn default() -> Self {
        Self {
            resolution: 256,
            layers: 256,
            unevenness: 0.0,
            pcf: 3,
            raster: Raster::Auto,
        }
    }
}

impl OpacityShadowMaps {
    pub(super) fn validate(&self) -> Result<()> {
        super::validate_map("opacity_shadow_maps", self.resolution, self.pcf)?;
        if !(1..=256).contains(&self.layers) {
            return invalid!(
                "opacity_shadow_maps: layers {} is not between 1 and 256",
                self.layers
            );
        }
        if !(0.0..=1.0).contains(&self.unevenness) {
            return invalid!(
                "opacity_shadow_maps: unevenness {} is not between 0 and 1",
                self.unevenness
            );
        }
        Ok(())
    }

    pub(super) fn shape(&self, sight: &Sight) -> Shape {
        Shape {
            resolution: self.resolution,
            pcf: self.pcf,
            fronts: false,
            layers: self.layers,
            values: [sight.extent as f32, self.unevenness, 0.0, 0.0],
            colour: [0.0; 4],
            bias: 0.0,
            raster: self.raster,
        }
    }
}

/// Fills one map: the slabs, and their sums.
pub(super) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    super::fill(gpu, passes, bound, &SLABS, map, plan)?;
    let label = "pelage.shadow.opacity_shadow_maps.sum";
    let groups = [Group::Frame, Group::MapsWritten];
    let pipeline = gpu.compute(
        PipelineKey::new(label),
        "opacity_shadow_maps_sum",
        &groups,
        || Module::new(SUM),
    )?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, bound.frame, &[0, map.drawings[0], plan.runs[0].material]);
        pass.set_bind_group(2, bound.maps_written, &[]);
        let (x, y) = workgroups(map.shape.resolution.pow(2));
        pass.dispatch_workgroups(x, y, 1);
    });
    Ok(())
}
