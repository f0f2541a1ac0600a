//! Deep opacity map (Yuksel and Keyser 2008, Hunz §4.2): a front depth a texel, and behind it layers that follow the
//! hair's shape, each with the sum of -ln(1 - opacity) of its fragments; transmittance is exp(-Ω).

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::plan::{Plan, PlannedMap};
use crate::raster::{self, Emission, Raster};
use crate::resources::Bound;
use crate::shader::Module;

/// The files of the look-up.
pub(crate) const LOOK_UP: &[&str] = &["shadow/deep_opacity_map_common", "shadow/deep_opacity_map"];

/// Half-width in texels from which on fibres are so wide that a block of 2×2 texels may share one front, at a third of
/// the time. Measured at opacity 1, with 2,000 strands on the head: RMSE 0.123 for 0.117 at K = 2, 0.115 for 0.112 at K = 8,
/// 0.111 for 0.111 at K = 16; with strands four times as wide 0.167 for 0.166 at K = 8.
const WIDE_HALF_WIDTH: f64 = 1.0;

/// The shift from texels to fronts for fibres of at most this half-width in texels.
pub(crate) fn front_shift(half_width: f64) -> u32 {
    u32::from(half_width >= WIDE_HALF_WIDTH)
}

const FRONT: Emission = Emission {
    label: "pelage.shadow.deep_opacity_map.front",
    stage: 0,
    files: &[
        "shadow/deep_opacity_map_common",
        "shadow/deep_opacity_map_emit",
    ],
    group: Group::MapsWritten,
    touch_only: true,
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
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for DeepOpacityMap {
    fn default() -> Self {
        Self {
            resolution: 512,
            layers: 8,
            pcf: 3,
            depth: 0.5,
            raster: Raster::Auto,
        }
    }
}

impl DeepOpacityMap {
    pub(crate) fn validate(&self) -> Result<()> {
        if !(16..=8192).contains(&self.resolution) {
            return invalid!(
                "deep_opacity_map: resolution {} is not between 16 and 8192",
                self.resolution
            );
        }
        if !(1..=64).contains(&self.layers) {
            return invalid!(
                "deep_opacity_map: layers {} is not between 1 and 64",
                self.layers
            );
        }
        if !matches!(self.pcf, 1 | 3 | 5) {
            return invalid!("deep_opacity_map: pcf {} is not 1, 3 or 5", self.pcf);
        }
        if !(self.depth > 0.0 && self.depth <= 1.0) {
            return invalid!(
                "deep_opacity_map: depth {} is not above 0 and up to 1",
                self.depth
            );
        }
        Ok(())
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
    let size = [map.settings.resolution; 2];
    let rows = [0, size[1]];
    let raster = raster::Draw {
        rasteriser: map.rasteriser,
        splits: map.splits,
        size,
        rows,
        drawings: &map.drawings,
        on_overflow: false,
    };
    let front = [&FRONT, &FRONT_OF_BLOCKS][map.front_shift as usize];
    raster::record(gpu, passes, bound, front, &raster, plan)?;
    raster::record(gpu, passes, bound, &LAYERS, &raster, plan)?;
    let label = "pelage.shadow.deep_opacity_map.prefix";
    let groups = [Group::Frame, Group::MapsWritten];
    let pipeline = gpu.compute(
        PipelineKey::new(label),
        "deep_opacity_map_prefix",
        &groups,
        || {
            Module::new(&[
                "shadow/deep_opacity_map_common",
                "shadow/deep_opacity_map_prefix",
            ])
        },
    )?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, bound.frame, &[0, map.drawings[0], plan.runs[0].material]);
        pass.set_bind_group(2, bound.maps_written, &[]);
        let (x, y) = workgroups(size[0] * size[1]);
        pass.dispatch_workgroups(x, y, 1);
    });
    Ok(())
}
