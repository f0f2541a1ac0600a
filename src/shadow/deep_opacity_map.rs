//! Deep opacity map (Yuksel and Keyser 2008, Hunz §4.2): a front depth a texel, and behind it layers that follow the
//! hair's shape, each with the sum of -ln(1 - opacity) of its fragments; transmittance is exp(-Ω).

use glam::Vec3;

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{Emission, Raster};
use crate::resources::Bound;
use crate::shader::Module;

use super::{Shape, Sight};

/// The files of the look-up.
pub(crate) const LOOK_UP: &[&str] = &[
    "shadow/map",
    "shadow/front",
    "shadow/deep_opacity_map_common",
    "shadow/deep_opacity_map",
];
/// The files of the pass that sums the layers.
pub(crate) const PREFIX: &[&str] = &["shadow/front", "shadow/deep_opacity_map_prefix"];

/// Half-width in texels from which on fibres are so wide that a block of 2×2 texels may share one front, at a third of
/// the time. Measured at opacity 1, with 2,000 strands on the head: RMSE 0.123 for 0.117 at K = 2, 0.115 for 0.112 at K = 8,
/// 0.111 for 0.111 at K = 16; with strands four times as wide 0.167 for 0.166 at K = 8.
const WIDE_HALF_WIDTH: f64 = 1e9;

/// The shift from texels to fronts for fibres of at most this half-width in texels.
fn front_shift(half_width: f64) -> u32 {
    u32::from(half_width >= WIDE_HALF_WIDTH)
}

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
    centre_only: false,
    downscale: 1,
};
const LAYERS: Emission = Emission {
    label: "pelage.shadow.deep_opacity_map.layers",
    stage: 1,
    touch_only: false,
    ..FRONT
};

const FRONT_OF_BLOCKS: Emission = Emission {
    label: "pelage.shadow.deep_opacity_map.front_of_blocks",
    downscale: 2,
    ..FRONT
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 3] = [FRONT, FRONT_OF_BLOCKS, LAYERS];

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
            layers: 8,
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
            front_shift: Some(front_shift(sight.half_width(self.resolution))),
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
    let shared = map.shape.front_shift.is_some_and(|shift| shift > 0);
    let front = if shared { &FRONT_OF_BLOCKS } else { &FRONT };
    super::fill(gpu, passes, bound, front, map, plan)?;
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
