//! Chiang et al. 2016, d'Eon et al. 2011: energy-conserving lobes R, TT, TRT and the residual of all longer paths, in the far
//! field. See `shaders/shading/chiang.wgsl`.

use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

use super::angles::{Along, Around, Averaged, Lobe};
use super::fibre::{
    DualScattering, MAX_SIGMA_A, MAX_TOLERANCE, RoughnessVariation, Tables, all_within, densities,
    longitudinal_variance, within,
};
use super::transmission;
use crate::error::{Result, invalid};
use crate::layout::Material;

/// The label of the pass that shades points, and the model's shaders.
pub(crate) const POINTS: (&str, &[&str]) = (
    "pelage.shading.chiang.points",
    &["shading/fibre", "shading/chiang"],
);
/// The label of the pass that makes tables.
pub(crate) const TABLES: &str = "pelage.shading.chiang.tables";

/// Chiang's model. With `sigma_a` 0 it gives back all light that it gets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chiang {
    /// Longitudinal roughness β_m, 0.001 to 1.
    pub beta_m: f32,
    /// Azimuthal roughness β_n, 0.001 to 1.
    pub beta_n: f32,
    /// Tilt of the cuticle's scales, radians, -π/2 to π/2. Positive moves R towards the root.
    pub alpha: f32,
    /// Index of refraction, 1.01 to 3.
    pub eta: f32,
    /// Absorption per fibre radius, linear RGB, 0 to 10⁶. See [`super::sigma_a_from_melanin`] and
    /// [`super::sigma_a_from_reflectance`].
    pub sigma_a: Vec3,
    /// What a crossing of the fibre transmits further at the tip, linear RGB, 0 to 1; 1 at the root, linear between. Each
    /// strand's own colour is such a transmittance too, all along.
    pub tip_colour: Vec3,
    /// Intervals of the integral across the fibre where there are no tables, 8 to 256.
    pub intervals: u32,
    /// Tables in place of that integral.
    pub tables: Option<Tables>,
    /// Light that other fibres have scattered.
    pub dual_scattering: Option<DualScattering>,
    /// How `beta_m` and `beta_n` vary, each kept within 0.001 to 1. A table has one roughness: where there is any variation the model
    /// is evaluated directly, and no tables are made. Uniform light and dual scattering take the model's own.
    pub roughness: RoughnessVariation,
    /// Radiance by which no fibre may change where the TT lobe is left out: with no light behind the hair, as the eye sees it, its upper
    /// bound may be that small, and the frame is then shaded without it. In the units of the lights; 0: never. Kept in any case
    /// with dual scattering, with varying roughness and with the near field.
    pub lobe_tolerance: f32,
    /// Fibres wider than a pixel are shaded by the light that leaves them where the pixel lies across them, directly; others by the
    /// mean over all of them. At [`super::ShadingRate::Fragment`] alone: a point has no place across.
    pub near_field: bool,
}

impl Default for Chiang {
    /// Brown hair, through tables, single scattering.
    fn default() -> Self {
        Self {
            beta_m: 0.3,
            beta_n: 0.3,
            alpha: 2f32.to_radians(),
            eta: 1.55,
            sigma_a: super::HairColour::Brown.sigma_a(),
            tip_colour: Vec3::ONE,
            intervals: 32,
            tables: Some(Tables::default()),
            dual_scattering: None,
            roughness: RoughnessVariation::default(),
            lobe_tolerance: 0.0,
            near_field: false,
        }
    }
}

impl Chiang {
    pub(crate) fn validate(&self) -> Result<()> {
        within("chiang", "beta_m", self.beta_m, [1e-3, 1.0])?;
        within("chiang", "beta_n", self.beta_n, [1e-3, 1.0])?;
        let right = FRAC_PI_2 as f32;
        within("chiang", "alpha", self.alpha, [-right, right])?;
        within("chiang", "eta", self.eta, [1.01, 3.0])?;
        all_within("chiang", "sigma_a", self.sigma_a, [0.0, MAX_SIGMA_A])?;
        all_within("chiang", "tip_colour", self.tip_colour, [0.0, 1.0])?;
        if !(8..=256).contains(&self.intervals) {
            return invalid!(
                "chiang: intervals {} is not between 8 and 256",
                self.intervals
            );
        }
        self.tables.map_or(Ok(()), |t| t.validate("chiang"))?;
        self.roughness.validate("chiang")?;
        within(
            "chiang",
            "lobe_tolerance",
            self.lobe_tolerance,
            MAX_TOLERANCE,
        )?;
        self.dual_scattering
            .map_or(Ok(()), |d| d.validate("chiang"))
    }

    /// A guess of the largest value: TT's peak, the narrowest.
    pub(crate) fn brightest(&self) -> f32 {
        let v = longitudinal_variance(f64::from(self.beta_m));
        let around = (0.25 / self.scale()).clamp(0.2, 3.0);
        (around / (0.5 * v * PI).sqrt()).clamp(0.3, 1e3) as f32
    }

    /// s(β_n) = √(π/8) (0.265 β + 1.194 β² + 5.372 β²²), the logistic's scale.
    fn scale(&self) -> f64 {
        let b = f64::from(self.beta_n);
        (PI / 8.0).sqrt() * (0.265 * b + 1.194 * b * b + 5.372 * b.powi(22))
    }

    fn variances(&self) -> [f64; 4] {
        let v = longitudinal_variance(f64::from(self.beta_m));
        [v, 0.25 * v, 4.0 * v, 4.0 * v]
    }

    fn tilts(&self) -> [f64; 4] {
        [2.0, -1.0, -4.0, 0.0].map(|k| k * f64::from(self.alpha))
    }

    pub(crate) fn material(&self) -> Material {
        let mut material = Material::default();
        material.values[0] = self.sigma_a.extend(self.eta).into();
        material.values[1] = self.variances().map(|v| v as f32);
        material.values[2] = self.tilts().map(|t| t as f32);
        material.values[3] = [self.scale() as f32, self.intervals as f32, 0.0, 0.0];
        material.values[4] = self.tip_colour.extend(0.0).into();
        let RoughnessVariation { strand, tip } = self.roughness;
        material.values[13] = [strand, tip, self.beta_m, self.beta_n];
        material.values[14] = densities(self.dual_scattering);
        material
    }

    /// TT, but not of the near field.
    pub(crate) fn transmission(&self) -> Option<transmission::Lobe> {
        if self.near_field {
            return None;
        }
        let intervals = if self.tables.is_some() {
            128
        } else {
            self.intervals
        };
        Some(transmission::Lobe {
            along: transmission::Along::Chiang {
                v: self.variances()[1],
                tilt: self.tilts()[1],
            },
            around: transmission::Around::Cylinder {
                eta: f64::from(self.eta),
                sigma_a: f64::from(self.sigma_a.min_element()),
                s: Some(self.scale()),
                of_view: true,
                ray_step: PI / f64::from(intervals),
            },
            table_step: self.tables.map_or(0.0, |tables| tables.step()),
        })
    }

    pub(crate) fn averaged(&self) -> Averaged {
        let (v, tilt) = (self.variances(), self.tilts());
        Averaged {
            lobes: (0..4)
                .map(|p| Lobe {
                    shift: -tilt[p],
                    deviation: v[p].sqrt(),
                })
                .collect(),
            along: Along::Chiang { v, tilt },
            around: Around::of_cylinder(
                f64::from(self.eta),
                self.sigma_a.as_dvec3(),
                self.scale(),
                true,
            ),
            scale: [DVec3::ONE; 4],
            normalised: false,
        }
    }
}
