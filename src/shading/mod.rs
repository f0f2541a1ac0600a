//! Shading models: how a fibre turns light into radiance towards the eye.

pub mod kajiya_kay;

pub use kajiya_kay::KajiyaKay;

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::layout::Material;
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::Module;
use crate::shadow;

/// A shading model with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shading {
    /// Kajiya and Kay 1989.
    KajiyaKay(KajiyaKay),
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
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// A parameter out of its range, named.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::KajiyaKay(model) => model.validate(),
        }
    }

    /// The largest value of the model per unit of irradiance.
    pub(crate) fn brightest(&self) -> f32 {
        match self {
            Self::KajiyaKay(model) => model.diffuse.max_element() + model.specular.max_element(),
        }
    }

    pub(crate) fn material(&self) -> Material {
        match self {
            Self::KajiyaKay(model) => model.material(),
        }
    }
}

/// Shades every strand point for the view.
pub(crate) fn record(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    let (label, model) = match plan.shading {
        "kajiya_kay" => kajiya_kay::POINTS,
        other => {
            return Err(crate::Error::Internal(format!(
                "no shading model has the stem {other}"
            )));
        }
    };
    let key = PipelineKey {
        variant: u32::from(plan.shadowed),
        ..PipelineKey::new(label)
    };
    let groups = [Group::Frame, Group::Shade, Group::MapsRead];
    let pipeline = gpu.compute(key, "shade_points", &groups, || {
        Module::new(shadow::look_up(plan.shadowed))
            .and(&["shading/points"])
            .and(&[model])
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(2, bound.maps_read, &[]);
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
