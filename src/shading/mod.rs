//! Shading models: how a fibre turns light into radiance towards the eye.
//!
//! [`Marschner`], [`Sadeghi`] and [`Chiang`] take each strand's own colour as the further transmittance of one crossing of the
//! fibre. What such a colour does to light that other fibres have scattered is left out.

mod angles;
pub mod chiang;
pub mod fibre;
pub mod kajiya_kay;
pub mod marschner;
pub mod sadeghi;
pub mod scheuermann;
pub(crate) mod tables;

pub use chiang::Chiang;
pub use fibre::{
    DualScattering, HairColour, Precision, Tables, sigma_a_from_melanin, sigma_a_from_reflectance,
};
pub use kajiya_kay::KajiyaKay;
pub use marschner::{CausticRemoval, Marschner, Roots};
pub use sadeghi::{LobeControls, Sadeghi};
pub use scheuermann::{Highlight, Scheuermann};

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::layout::Material;
use crate::occluder;
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::Module;
use crate::shadow::Shadow;

/// A shading model with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shading {
    /// Kajiya and Kay 1989.
    KajiyaKay(KajiyaKay),
    /// Scheuermann 2004: Kajiya-Kay with two highlights.
    Scheuermann(Scheuermann),
    /// Marschner et al. 2003.
    Marschner(Marschner),
    /// Sadeghi et al. 2010.
    Sadeghi(Sadeghi),
    /// Chiang et al. 2016, d'Eon et al. 2011.
    Chiang(Chiang),
}

impl Default for Shading {
    fn default() -> Self {
        Self::KajiyaKay(KajiyaKay::default())
    }
}

impl Shading {
    /// The stem of the model's files.
    pub fn stem(&self) -> &'static str {
        match self {
            Self::KajiyaKay(_) => "kajiya_kay",
            Self::Scheuermann(_) => "scheuermann",
            Self::Marschner(_) => "marschner",
            Self::Sadeghi(_) => "sadeghi",
            Self::Chiang(_) => "chiang",
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// A parameter out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::KajiyaKay(model) => model.validate(),
            Self::Scheuermann(model) => model.validate(),
            Self::Marschner(model) => model.validate(),
            Self::Sadeghi(model) => model.validate(),
            Self::Chiang(model) => model.validate(),
        }
    }

    /// The largest value of the model per unit of irradiance.
    pub(crate) fn brightest(&self) -> f32 {
        match self {
            Self::KajiyaKay(model) => model.diffuse.max_element() + model.specular.max_element(),
            Self::Scheuermann(model) => model.brightest(),
            Self::Marschner(model) => model.brightest(),
            Self::Sadeghi(model) => model.brightest(),
            Self::Chiang(model) => model.brightest(),
        }
    }

    pub(crate) fn material(&self) -> Material {
        match self {
            Self::KajiyaKay(model) => model.material(),
            Self::Scheuermann(model) => model.material(),
            Self::Marschner(model) => model.material(),
            Self::Sadeghi(model) => model.material(),
            Self::Chiang(model) => model.material(),
        }
    }

    /// The label of the pass that shades points, and the model's shaders.
    pub(crate) fn points(&self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::KajiyaKay(_) => kajiya_kay::POINTS,
            Self::Scheuermann(_) => scheuermann::POINTS,
            Self::Marschner(_) => marschner::POINTS,
            Self::Sadeghi(_) => sadeghi::POINTS,
            Self::Chiang(_) => chiang::POINTS,
        }
    }

    /// Tables of azimuthal functions, where the model is to be read from them.
    pub(crate) fn tables(&self) -> Option<Tables> {
        match self {
            Self::Marschner(model) => model.tables,
            Self::Chiang(model) => model.tables,
            Self::KajiyaKay(_) | Self::Scheuermann(_) | Self::Sadeghi(_) => None,
        }
    }

    /// The label of the pass that makes them.
    pub(crate) fn tables_label(&self) -> Option<&'static str> {
        match self {
            Self::Marschner(_) => Some(marschner::TABLES),
            Self::Chiang(_) => Some(chiang::TABLES),
            Self::KajiyaKay(_) | Self::Scheuermann(_) | Self::Sadeghi(_) => None,
        }
    }

    pub(crate) fn dual_scattering(&self) -> Option<DualScattering> {
        match self {
            Self::Marschner(model) => model.dual_scattering,
            Self::Sadeghi(model) => model.dual_scattering,
            Self::Chiang(model) => model.dual_scattering,
            Self::KajiyaKay(_) | Self::Scheuermann(_) => None,
        }
    }

    /// Whether the model reads functions of one inclination.
    pub(crate) fn needs_angles(&self, ambient: bool) -> bool {
        match self {
            Self::KajiyaKay(_) | Self::Scheuermann(_) => false,
            Self::Sadeghi(model) if model.normalised => true,
            _ => ambient || self.dual_scattering().is_some(),
        }
    }

    /// The functions of one inclination, as WGSL reads them; empty for models without.
    pub(crate) fn angles(&self) -> Vec<f32> {
        let averaged = match self {
            Self::KajiyaKay(_) | Self::Scheuermann(_) => return Vec::new(),
            Self::Marschner(model) => model.averaged(),
            Self::Sadeghi(model) => model.averaged(),
            Self::Chiang(model) => model.averaged(),
        };
        averaged.table(self.dual_scattering())
    }
}

/// The module that shades points.
pub(crate) fn points_module(shadow: &Shadow, occluded: bool, files: &[&'static str]) -> Module {
    shadow
        .module()
        .and(occluder::files(occluded))
        .and(&["common/light", "shading/fibre_type", "shading/points"])
        .and(files)
}

/// Shades every strand point for the view.
pub(crate) fn record(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    tables::record(gpu, passes, bound, plan)?;
    let (label, files) = plan.shading;
    let key = PipelineKey {
        variant: plan.shadow.variant() * 2 + u32::from(plan.occluded),
        ..PipelineKey::new(label)
    };
    let groups = [
        Group::Frame,
        Group::Shade,
        Group::MapsRead,
        Group::Occluders,
    ];
    let groups = &groups[..if plan.occluded { 4 } else { 3 }];
    let pipeline = gpu.compute(key, "shade_points", groups, || {
        points_module(&plan.shadow, plan.occluded, files)
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(2, bound.maps_read, &[]);
        if let Some(occluders) = bound.occluders {
            pass.set_bind_group(3, occluders, &[]);
        }
        for ((run, drawing), groups) in plan
            .runs
            .iter()
            .zip(&plan.bands[0].drawings)
            .zip(bound.runs)
        {
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, &groups.shade, &[]);
            let (x, y) = workgroups(run.run.count);
            pass.dispatch_workgroups(x, y, 1);
        }
    });
    Ok(())
}
