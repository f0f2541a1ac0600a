//! K-buffer volumetric shadow (Yu et al. 2012, §3.1): a texel keeps the K scattering events nearest to the light, and a
//! point receives their product, `Π (A C + 1 - C)`. A is the *transmitted* part of an event, C its opacity × coverage.
//!
//! The K nearest are kept by a chain of 32-bit atomic maxima over K sorted slots: bounded memory whatever the hair, no pool
//! to guess, no sort afterwards, and the same result in any order. An event that is farther than the last slot costs one
//! load. Counted arrays of all fragments (count, scan, scatter, select) would take 4 bytes a fragment of a number
//! that is known only afterwards; rounds of peeling would take K walks.
//!
//! Against transmittance along rays, 2,000 strands of opacity 0.5 in 512² texels: RMSE of the image and the part of the whole
//! light 0.178 and 1.46 with K = 1, 0.055 and 1.13 with 4, 0.030 and 1.04 with 16 and 64; 0.033 and 1.02 with 4 and the
//! tail.
//!
//! Beyond the paper: `tail` also keeps the sum of all optical depths and the farthest one's depth, so that light does not
//! leak behind the K-th event.

use glam::Vec3;

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
    "shadow/k_buffer_volume_common",
    "shadow/k_buffer_volume",
];
/// The files of the pass that multiplies the events.
pub(crate) const PREFIX: &[&str] = &[
    "shadow/k_buffer_volume_common",
    "shadow/k_buffer_volume_prefix",
];
/// Words of a texel behind its slots; `VOLUME_TAIL_WORDS` in WGSL.
const TAIL_WORDS: u32 = 3;

const EVENTS: Emission = Emission {
    label: "pelage.shadow.k_buffer_volume.events",
    stage: 0,
    files: &[
        "shadow/front",
        "shadow/map_emit",
        "shadow/k_buffer_volume_common",
        "shadow/k_buffer_volume_emit",
    ],
    group: Group::MapsWritten,
    touch_only: false,
    footprint: Footprint::Slice,
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 1] = [EVENTS];

/// What a fibre takes of the light that meets it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Attenuation {
    /// As much as its opacity says.
    #[default]
    Opacity,
    /// What its surface reflects and its inside absorbs of the part that its opacity says: coloured, at twice the memory.
    Fresnel {
        /// Index of refraction, from 1.01 to 3.
        eta: f32,
        /// Absorption per fibre radius, from 0.
        sigma_a: Vec3,
    },
}

/// Settings of the k-buffer volumetric shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KBufferVolume {
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Events a texel, from 1 to 64.
    pub k: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Whether what lies behind the K-th event counts, spread evenly to the farthest one.
    pub tail: bool,
    /// What a fibre takes of the light.
    pub attenuation: Attenuation,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for KBufferVolume {
    fn default() -> Self {
        Self {
            resolution: 512,
            k: 16,
            pcf: 3,
            tail: true,
            attenuation: Attenuation::Opacity,
            raster: Raster::Auto,
        }
    }
}

impl KBufferVolume {
    pub(crate) fn validate(&self) -> Result<()> {
        super::validate_map("k_buffer_volume", self.resolution, self.pcf)?;
        if !(1..=64).contains(&self.k) {
            return invalid!("k_buffer_volume: k {} is not between 1 and 64", self.k);
        }
        let Attenuation::Fresnel { eta, sigma_a } = self.attenuation else {
            return Ok(());
        };
        if !(1.01..=3.0).contains(&eta) {
            return invalid!("k_buffer_volume: eta {eta} is not between 1.01 and 3");
        }
        if !sigma_a.is_finite() || sigma_a.min_element() < 0.0 {
            let Vec3 { x, y, z } = sigma_a;
            return invalid!(
                "k_buffer_volume: sigma_a ({x}, {y}, {z}) has a component that is negative or not finite"
            );
        }
        Ok(())
    }

    pub(super) fn shape(&self, sight: &Sight) -> Shape {
        let (colour, colours) = match self.attenuation {
            Attenuation::Opacity => ([0.0; 4], 0),
            Attenuation::Fresnel { eta, sigma_a } => (sigma_a.extend(eta).into(), self.k),
        };
        let texel = sight.width / f64::from(self.resolution);
        let tail = if self.tail { 1.0 } else { 0.0 };
        Shape {
            resolution: self.resolution,
            pcf: self.pcf,
            fronts: false,
            layers: self.k + TAIL_WORDS + colours,
            values: [sight.extent as f32, self.k as f32, tail, texel as f32],
            colour,
            bias: 0.0,
            raster: self.raster,
        }
    }
}

/// Fills one map: its events, then what each leaves of the light.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    map: &PlannedMap,
    plan: &Plan,
) -> Result<()> {
    super::fill(gpu, passes, bound, &EVENTS, map, plan)?;
    let label = "pelage.shadow.k_buffer_volume.prefix";
    let groups = [Group::Frame, Group::MapsWritten];
    let pipeline = gpu.compute(
        PipelineKey::new(label),
        "k_buffer_volume_prefix",
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
