//! Shading models: how a fibre turns light into radiance towards the eye.
//!
//! [`Marschner`], [`Sadeghi`] and [`Chiang`] take each strand's own colour as the further transmittance of one crossing of the
//! fibre. What such a colour does to light that other fibres have scattered is left out.

mod angles;
pub mod chiang;
pub mod evaluator;
pub mod fibre;
pub mod kajiya_kay;
pub mod marschner;
pub mod sadeghi;
pub mod scheuermann;
pub(crate) mod tables;
pub(crate) mod transmission;

pub use chiang::Chiang;
pub use evaluator::{Evaluator, Sample};
pub use fibre::{
    DualScattering, HairColour, Precision, RoughnessVariation, Tables, sigma_a_from_melanin,
    sigma_a_from_reflectance,
};
pub use kajiya_kay::KajiyaKay;
pub use marschner::{CausticRemoval, Marschner, Roots};
pub use sadeghi::{LobeControls, Sadeghi};
pub use scheuermann::{Highlight, Scheuermann};

use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, spread_workgroups};
use crate::layout::Material;
use crate::occluder;
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shadow;

/// Where fibres are shaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum ShadingRate {
    /// At strand points, once a view; a fragment's colour is interpolated along its segment (Kim §5). 8 bytes a point.
    #[default]
    Point,
    /// At each fragment that the transparency technique keeps, at its own position: its own tangent, shadow and model. For
    /// strands of few points, narrow lobes and fine shadows. 32 bytes a point. What has overflowed the fragment pool takes the mean
    /// colour of three of its fragments. Techniques that need colours before they know what they keep refuse it:
    /// [`weighted_blended`](crate::transparency::weighted_blended), [`depth_peeling`](crate::transparency::depth_peeling),
    /// [`random_subsets`](crate::transparency::random_subsets), [`sorted_blending`](crate::transparency::sorted_blending),
    /// [`k_buffer_single_pass`](crate::transparency::k_buffer_single_pass), [`moment`](crate::transparency::moment), and
    /// [`k_plus_buffer`](crate::transparency::k_plus_buffer) where it merges the rest.
    Fragment,
}

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

    /// The bits of [`SETTINGS`] that are set.
    pub(crate) fn settings(&self, rate: ShadingRate) -> u32 {
        let tables = self.tables();
        let marschner = match self {
            Self::Marschner(model) => Some(model),
            _ => None,
        };
        let is_set = [
            tables.is_some(),
            tables.is_some_and(|t| t.precision == Precision::F16),
            self.dual_scattering().is_some(),
            marschner.is_some_and(|m| m.eccentricity != 1.0),
            marschner.is_some_and(|m| m.roots == Roots::Cubic),
            rate == ShadingRate::Fragment
                && matches!(self, Self::Chiang(model) if model.near_field),
        ];
        let bits = is_set.into_iter().enumerate();
        bits.map(|(bit, is_set)| u32::from(is_set) << bit).sum()
    }

    /// Tables of azimuthal functions, where the model is to be read from them.
    pub(crate) fn tables(&self) -> Option<Tables> {
        match self {
            Self::Marschner(model) => model.tables,
            Self::Chiang(model) => model.tables.filter(|_| !model.roughness.varies()),
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

    /// Whether roughness varies between or along strands.
    fn varies(&self) -> bool {
        match self {
            Self::Marschner(model) => model.roughness.varies(),
            Self::Sadeghi(model) => model.roughness.varies(),
            Self::Chiang(model) => model.roughness.varies(),
            Self::KajiyaKay(_) | Self::Scheuermann(_) => false,
        }
    }

    /// The TT lobe and the radiance by which leaving it out may change a fibre, where it may be left out at all.
    pub(crate) fn transmission(&self) -> Option<(transmission::Lobe, f32)> {
        let (lobe, tolerance) = match self {
            Self::Marschner(model) => (model.transmission(), model.lobe_tolerance),
            Self::Sadeghi(model) => (model.transmission(), model.lobe_tolerance),
            Self::Chiang(model) => (model.transmission(), model.lobe_tolerance),
            Self::KajiyaKay(_) | Self::Scheuermann(_) => return None,
        };
        let single = self.dual_scattering().is_none() && !self.varies();
        let lobe = lobe.filter(|_| single && tolerance > 0.0)?;
        Some((lobe, tolerance))
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

/// The settings for which a model's shaders are compiled, bit by bit: drivers that run on a CPU take both sides of every
/// branch, so what no setting uses is left out. `shading/settings` reads the bits where hairs shaded by one module differ.
const SETTINGS: [&str; 6] = [
    "FIBRE_TABLES",
    "FIBRE_TABLE_F16",
    "FIBRE_DUAL",
    "MARSCHNER_ELLIPTIC",
    "MARSCHNER_CUBIC",
    "NEAR",
];

/// The shaders of a hair, or of all hairs of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Shader {
    /// The label of the pass that shades points.
    pub label: &'static str,
    /// The model's files.
    pub files: &'static [&'static str],
    pub rate: ShadingRate,
    /// The files of the shadow technique's look-up.
    pub shadow: &'static [&'static str],
    /// Whether the host has shadow maps that shadow the hair; at points only.
    pub occluded: bool,
    /// Whether all hairs have the same parameters.
    pub one_material: bool,
    /// Whether any hair's roughness varies.
    pub varies: bool,
    /// Whether light goes through fibres: the TT lobe.
    pub transmits: bool,
    /// The bits of [`SETTINGS`] that all hairs have; `None`: each has its own.
    pub settings: Option<u32>,
}

impl Shader {
    pub fn of(shading: &Shading, rate: ShadingRate) -> Self {
        let (label, files) = shading.points();
        Self {
            label,
            files,
            rate,
            shadow: shadow::none::LOOK_UP,
            occluded: false,
            one_material: true,
            varies: shading.varies(),
            transmits: true,
            settings: Some(shading.settings(rate)),
        }
    }

    /// The shader, as far as pipelines for points depend on it.
    fn of_points(self) -> Self {
        Self {
            one_material: true,
            ..self
        }
    }

    /// The module's constants.
    fn constants(&self) -> Module {
        let module = Module::default()
            .with("VARIES", Constant::Bool(self.varies))
            .with("TRANSMITS", Constant::Bool(self.transmits));
        let Some(bits) = self.settings else {
            return module;
        };
        let names = SETTINGS.into_iter().enumerate();
        names.fold(module, |module, (bit, name)| {
            module.with(name, Constant::Bool(bits >> bit & 1 == 1))
        })
    }

    /// The shader, where fragments are what it shades.
    pub fn of_fragments(self) -> Option<Self> {
        (self.rate == ShadingRate::Fragment).then_some(self)
    }

    /// The files of the model and of what it is called by.
    fn model(&self) -> Module {
        self.constants()
            .and(self.shadow)
            .and(shadow::OWN)
            .and(occluder::files(self.occluded))
            .and(&["common/light", "shading/fibre_type", "shading/radiance"])
            .and(self.files)
    }

    /// The model's functions alone, of the material that is bound and without shadows.
    pub fn functions(&self) -> Module {
        self.constants()
            .and(&["shadow/none", "shading/fibre_type", "shading/material"])
            .and(self.files)
    }

    /// The module that shades points.
    pub fn points_module(&self) -> Module {
        self.model().and(&[
            "common/spread",
            "shading/material",
            "shading/points_common",
            "shading/points",
        ])
    }

    /// The files that supply `shaded_colour(point, along)` to a resolve.
    pub fn fragments_module(&self) -> Module {
        let settings = match self.settings {
            Some(_) => "shading/settings_alike",
            None => "shading/settings",
        };
        self.model()
            .and(&[settings, "shading/fragments"])
            .with("ONE_MATERIAL", Constant::Bool(self.one_material))
    }
}

/// The module that gathers what shading at fragments asks of the points.
pub(crate) fn gather_module() -> Module {
    Module::new(&["shading/points_common", "shading/fibre_points"])
}

/// Shades every strand point for the view, or gathers what shading at fragments asks of them.
pub(crate) fn record(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    tables::record(gpu, passes, bound, plan)?;
    let groups = [
        Group::Frame,
        Group::Shade,
        Group::MapsRead,
        Group::Occluders,
    ];
    let groups = &groups[..if plan.shader.occluded { 4 } else { 3 }];
    let rate = plan.shader.rate;
    let label = match rate {
        ShadingRate::Point => plan.shader.label,
        ShadingRate::Fragment => "pelage.shading.fibre_points",
    };
    let mut pipelines = Vec::with_capacity(plan.runs.len());
    for run in &plan.runs {
        let pipeline = match rate {
            ShadingRate::Point => {
                let shader = plan.shader_of(run.hair);
                let key = PipelineKey {
                    shading: Some(shader.of_points()),
                    ..PipelineKey::new(label)
                };
                gpu.compute(key, "shade_points", groups, || shader.points_module())?
            }
            ShadingRate::Fragment => {
                let key = PipelineKey::new(label);
                gpu.compute(key, "gather_fibre_points", groups, gather_module)?
            }
        };
        pipelines.push(pipeline);
    }
    passes.compute(label, |pass| {
        pass.set_bind_group(2, bound.maps_read, &[]);
        if let Some(occluders) = bound.occluders {
            pass.set_bind_group(3, occluders, &[]);
        }
        for (((run, pipeline), drawing), groups) in plan
            .runs
            .iter()
            .zip(&pipelines)
            .zip(&plan.bands[0].drawings)
            .zip(bound.runs)
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, &groups.shade, &[]);
            let (x, y) = spread_workgroups(run.run.count);
            pass.dispatch_workgroups(x, y, 1);
        }
    });
    Ok(())
}
