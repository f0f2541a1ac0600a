//! Marschner et al. 2003 (Hunz §3.3): R, TT and TRT of a smooth dielectric fibre, blurred along it. See
//! `shaders/shading/marschner.wgsl`.

use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::f64::consts::TAU;

use super::angles::{Along, Around, Averaged, Lobe};
use super::fibre::{
    DualScattering, MAX_SIGMA_A, MAX_TOLERANCE, RoughnessVariation, Tables, all_within, densities,
    longitudinal_variance, within,
};
use super::{Chiang, HairColour, transmission};
use crate::error::Result;
use crate::layout::Material;

/// The label of the pass that shades points, and the model's shaders.
pub(crate) const POINTS: (&str, &[&str]) = (
    "pelage.shading.marschner.points",
    &["shading/fibre", "shading/marschner"],
);
/// The label of the pass that makes tables.
pub(crate) const TABLES: &str = "pelage.shading.marschner.tables";

/// How the paths that leave at an azimuth are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Roots {
    /// Of the exact exit angle.
    #[default]
    Exact,
    /// Of its fit by a cubic polynomial (Hunz eq. 46).
    Cubic,
}

/// TRT's caustic is taken out, and Gaussians are put in its place: glints (Hunz algorithm 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CausticRemoval {
    /// Azimuthal width of the glints, radians, 10⁻⁵ to 10. Published: 10° to 25°.
    pub w_c: f32,
    /// Their scale, 0 to 100. ½ puts back the energy that was taken out; published: 0.5 to 5.
    pub k_g: f32,
    /// Range of η' above 2 in which they fade, 10⁻⁵ to 10. Published: 0.2 to 0.4.
    pub delta_eta: f32,
    /// Limit of the caustic's width across the fibre, 0 to 1. Published: 0.5.
    pub delta_h_max: f32,
}

impl Default for CausticRemoval {
    fn default() -> Self {
        Self {
            w_c: 15f32.to_radians(),
            k_g: 0.5,
            delta_eta: 0.3,
            delta_h_max: 0.5,
        }
    }
}

/// Marschner's model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marschner {
    /// Index of refraction, 1.01 to 3.
    pub eta: f32,
    /// Absorption per fibre radius, linear RGB, 0 to 10⁶.
    pub sigma_a: Vec3,
    /// α_R, α_TT, α_TRT: a lobe lies at half the sum of both inclinations = α. Radians, -π/2 to π/2; negative is towards the
    /// root.
    pub alpha: [f32; 3],
    /// β_R, β_TT, β_TRT, widths in terms of that half sum, radians, 10⁻⁵ to 10.
    pub beta: [f32; 3],
    /// One axis of the section over the other, 0.75 to 1.33. TRT then takes η*(φ_h), with the axis at a random azimuth of each
    /// strand, and is evaluated directly even where there are tables.
    pub eccentricity: f32,
    /// How roots are found.
    pub roots: Roots,
    /// `None`: N_TRT keeps its caustic, which ends at some 10⁵.
    pub caustic: Option<CausticRemoval>,
    /// As [`Chiang::tip_colour`].
    pub tip_colour: Vec3,
    /// Tables in place of roots found at every point.
    pub tables: Option<Tables>,
    /// Light that other fibres have scattered.
    pub dual_scattering: Option<DualScattering>,
    /// How `beta` varies. Uniform light and dual scattering take the model's own.
    pub roughness: RoughnessVariation,
    /// Radiance by which no fibre may change where the TT lobe is left out: with no light behind the hair, as the eye sees it, its upper
    /// bound may be that small, and the frame is then shaded without it. In the units of the lights; 0: never. Kept in any case
    /// with dual scattering, with varying roughness and with cubic roots.
    pub lobe_tolerance: f32,
}

impl Default for Marschner {
    /// Brown hair with the widths and shifts of Hunz's table 1, through tables, single scattering.
    fn default() -> Self {
        Self {
            eta: 1.55,
            sigma_a: HairColour::Brown.sigma_a(),
            alpha: [-7.5, 3.75, 11.25].map(f32::to_radians),
            beta: [7.5, 3.75, 15.0].map(f32::to_radians),
            eccentricity: 1.0,
            roots: Roots::Exact,
            caustic: Some(CausticRemoval::default()),
            tip_colour: Vec3::ONE,
            tables: Some(Tables::default()),
            dual_scattering: None,
            roughness: RoughnessVariation::default(),
            lobe_tolerance: 0.0,
        }
    }
}

/// Shifts and widths of R, TT and TRT from the optics of Chiang's model: β_R = √v(β_m) / 2, β_TT = β_R / 2, β_TRT = 2 β_R,
/// α_R = -alpha, α_TT = alpha / 2, α_TRT = 3 alpha / 2.
pub(crate) fn lobes_of(optics: &Chiang) -> ([f32; 3], [f32; 3]) {
    let beta = 0.5 * longitudinal_variance(f64::from(optics.beta_m)).sqrt() as f32;
    (
        [-1.0, 0.5, 1.5].map(|k| k * optics.alpha),
        [1.0, 0.5, 2.0].map(|k| k * beta),
    )
}

impl Marschner {
    /// The same fibre as Chiang's: β_R = √v(β_m) / 2, β_TT = β_R / 2, β_TRT = 2 β_R, α_R = -alpha, α_TT = alpha / 2,
    /// α_TRT = 3 alpha / 2; a round section.
    pub fn of_fibre(optics: &Chiang) -> Self {
        let (alpha, beta) = lobes_of(optics);
        Self {
            eta: optics.eta,
            sigma_a: optics.sigma_a,
            alpha,
            beta,
            tip_colour: optics.tip_colour,
            tables: optics.tables,
            dual_scattering: optics.dual_scattering,
            roughness: optics.roughness,
            lobe_tolerance: optics.lobe_tolerance,
            ..Self::default()
        }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        within("marschner", "eta", self.eta, [1.01, 3.0])?;
        all_within("marschner", "sigma_a", self.sigma_a, [0.0, MAX_SIGMA_A])?;
        for value in self.alpha {
            within("marschner", "alpha", value, [-FRAC_PI_2, FRAC_PI_2])?;
        }
        for value in self.beta {
            within("marschner", "beta", value, [1e-5, 10.0])?;
        }
        within("marschner", "eccentricity", self.eccentricity, [0.75, 1.33])?;
        if let Some(caustic) = self.caustic {
            within("marschner", "caustic.w_c", caustic.w_c, [1e-5, 10.0])?;
            within("marschner", "caustic.k_g", caustic.k_g, [0.0, 100.0])?;
            within(
                "marschner",
                "caustic.delta_eta",
                caustic.delta_eta,
                [1e-5, 10.0],
            )?;
            within(
                "marschner",
                "caustic.delta_h_max",
                caustic.delta_h_max,
                [0.0, 1.0],
            )?;
        }
        all_within("marschner", "tip_colour", self.tip_colour, [0.0, 1.0])?;
        self.tables.map_or(Ok(()), |t| t.validate("marschner"))?;
        self.roughness.validate("marschner")?;
        within(
            "marschner",
            "lobe_tolerance",
            self.lobe_tolerance,
            MAX_TOLERANCE,
        )?;
        self.dual_scattering
            .map_or(Ok(()), |d| d.validate("marschner"))
    }

    /// A guess of the largest value: TT's peak, the narrowest.
    pub(crate) fn brightest(&self) -> f32 {
        (0.5 / self.beta[1]).clamp(0.3, 1e3)
    }

    pub(crate) fn material(&self) -> Material {
        let mut material = Material::default();
        let [r, tt, trt] = self.alpha;
        material.values[0] = self.sigma_a.extend(self.eta).into();
        material.values[1] = [r, tt, trt, self.eccentricity];
        let [r, tt, trt] = self.beta;
        material.values[2] = [r, tt, trt, 0.0];
        let caustic = self.caustic.unwrap_or_default();
        material.values[3] = [
            caustic.w_c,
            caustic.k_g,
            caustic.delta_eta,
            caustic.delta_h_max,
        ];
        material.values[4] = self
            .tip_colour
            .extend(f32::from(self.caustic.is_some()))
            .into();
        material.values[13] = [self.roughness.strand, self.roughness.tip, 0.0, 0.0];
        material.values[14] = densities(self.dual_scattering);
        material
    }

    /// TT, where there is a bound of it.
    pub(crate) fn transmission(&self) -> Option<transmission::Lobe> {
        if self.roots == Roots::Cubic {
            return None;
        }
        let deviation = 2.0 * f64::from(self.beta[1]);
        Some(transmission::Lobe {
            along: transmission::Along::Gaussian {
                shift: 2.0 * f64::from(self.alpha[1]),
                deviation,
                height: 1.0 / (deviation * TAU.sqrt()),
            },
            around: transmission::Around::Cylinder {
                eta: f64::from(self.eta),
                sigma_a: f64::from(self.sigma_a.min_element()),
                s: None,
                of_view: false,
                ray_step: 0.0,
            },
            table_step: self.tables.map_or(0.0, |tables| tables.step()),
        })
    }

    pub(crate) fn averaged(&self) -> Averaged {
        let (alpha, beta) = (self.alpha.map(f64::from), self.beta.map(f64::from));
        Averaged {
            lobes: (0..3)
                .map(|p| Lobe {
                    shift: 2.0 * alpha[p],
                    deviation: 2.0 * beta[p],
                })
                .collect(),
            along: Along::Gaussian {
                alpha,
                beta,
                unit_height: false,
            },
            around: Around::of_cylinder(f64::from(self.eta), self.sigma_a.as_dvec3(), 0.0, false),
            scale: [DVec3::ONE; 4],
            normalised: false,
        }
    }
}
