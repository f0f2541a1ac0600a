//! Deep opacity map (Yuksel and Keyser 2008, Hunz §4.2): a front depth a texel, and behind it layers that follow the
//! hair's shape, each with the sum of -ln(1 - opacity) of its fragments; transmittance is exp(-Ω).

use glam::Vec3;

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::Module;

use super::{Shape, Sight};

/// The files of the look-up, and those where fibres colour light.
pub(crate) const LOOK_UP: &[&str] = &[
    "shadow/map",
    "shadow/passed",
    "shadow/front",
    "shadow/deep_opacity_map_common",
    "shadow/deep_opacity_map",
];
pub(crate) const LOOK_UP_COLOURED: &[&str] = &[
    "shadow/map",
    "shadow/passed_coloured",
    "shadow/front",
    "shadow/deep_opacity_map_common",
    "shadow/deep_opacity_map",
];
/// The files of the pass that sums the layers.
pub(crate) const PREFIX: &[&str] = &["shadow/front", "shadow/deep_opacity_map_prefix"];

const FRONT: Emission = Emission {
    label: "pelage.shadow.deep_opacity_map.front",
    stage: 0,
    files: &[
        "shadow/front",
        "shadow/map_emit",
        "shadow/deep_opacity_map_common",
        "shadow/deep_opacity_map_emit",
    ],
    group: Group::MapsWritten,
    touch_only: true,
    footprint: Footprint::Slice,
};
const LAYERS: Emission = Emission {
    label: "pelage.shadow.deep_opacity_map.layers",
    stage: 1,
    touch_only: false,
    ..FRONT
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 2] = [FRONT, LAYERS];

/// Settings of the deep opacity map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeepOpacityMap {
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Layers, from 1 to 64.
    pub layers: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Depth behind the front at which the last layer ends, as a part of the hair's extent along the light, above 0 and
    /// up to 1. What lies deeper counts in the last layer.
    pub depth: f32,
    /// The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    pub transmitted: Vec3,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for DeepOpacityMap {
    fn default() -> Self {
        Self {
            resolution: 512,
            layers: 16,
            pcf: 1,
            depth: 1.0,
            transmitted: Vec3::ZERO,
            raster: Raster::Auto,
        }
    }
}

impl DeepOpacityMap {
    pub(crate) fn validate(&self) -> Result<()> {
        super::validate_map("deep_opacity_map", self.resolution, self.pcf)?;
        if !(1..=64).contains(&self.layers) {
            return invalid!(
                "deep_opacity_map: layers {} is not between 1 and 64",
                self.layers
            );
        }
        if !(self.depth > 0.0 && self.depth <= 1.0) {
            return invalid!(
                "deep_opacity_map: depth {} is not above 0 and up to 1",
                self.depth
            );
        }
        super::validate_transmitted("deep_opacity_map", self.transmitted)
    }

    pub(super) fn shape(&self, sight: &Sight) -> Shape {
        let extent = sight.extent * f64::from(self.depth);
        Shape {
            resolution: self.resolution,
            pcf: self.pcf,
            // A front for blocks of texels would be faster, at half as much error again.
            fronts: true,
            layers: self.layers,
            values: [extent as f32, 0.0, 0.0, 0.0],
            colour: super::summed_colour(self.transmitted),
            bias: 0.0,
            raster: self.raster,
        }
    }
}

/// Fills one map: fronts, layers, and the layers' sums.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    super::fill(gpu, passes, bound, &FRONT, map, plan)?;
    super::fill(gpu, passes, bound, &LAYERS, map, plan)?;
    let label = "pelage.shadow.deep_opacity_map.prefix";
    let groups = [Group::Frame, Group::MapsWritten];
    let pipeline = gpu.compute(
        PipelineKey::new(label),
        "deep_opacity_map_prefix",
        &groups,
        || Module::new(PREFIX),
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
