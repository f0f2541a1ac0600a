//! Sadeghi et al. 2010 (Hunz §3.4): R, TT and TRT as an artist would have them. See `shaders/shading/sadeghi.wgsl`.

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

use super::angles::{Along, Around, Averaged, Lobe};
use super::fibre::{
    DualScattering, MAX_TOLERANCE, RoughnessVariation, all_within, densities, within,
};
use super::transmission;
use crate::error::{Result, invalid};
use crate::layout::Material;

/// The label of the pass that shades points, and the model's shaders.
pub(crate) const POINTS: (&str, &[&str]) = (
    "pelage.shading.sadeghi.points",
    &["shading/fibre", "shading/sadeghi"],
);

/// One lobe's controls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeControls {
    /// C_p, linear RGB, 0 to 10⁶.
    pub colour: Vec3,
    /// I_p, 0 to 10⁶.
    pub intensity: f32,
    /// α_p: the lobe lies at half the sum of both inclinations = α_p. Radians, -π/2 to π/2; negative is towards the root.
    pub shift: f32,
    /// β_p in terms of that half sum, radians, 10⁻⁵ to 10.
    pub width: f32,
}

/// Sadeghi's model. A strand's own colour tints TT once and TRT twice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sadeghi {
    /// Primary highlight.
    pub r: LobeControls,
    /// Forward lobe.
    pub tt: LobeControls,
    /// Secondary highlight, with the glints.
    pub trt: LobeControls,
    /// δ_TT, the forward lobe's azimuthal width, radians, 10⁻⁵ to 10.
    pub tt_azimuthal_width: f32,
    /// I_G, relative to the secondary highlight's intensity, 0 to 10⁶.
    pub glint_intensity: f32,
    /// δ_G, radians, 10⁻⁵ to 10.
    pub glint_width: f32,
    /// Range of half the angle between a strand's two glints, radians, 0 to π: each strand has its own within.
    pub glint_angle: [f32; 2],
    /// Divide by `max(1, E(θ_i), E(θ_o))`, E the part of the light that is scattered, so that no light is made.
    pub normalised: bool,
    /// As [`super::Chiang::tip_colour`].
    pub tip_colour: Vec3,
    /// Light that other fibres have scattered.
    pub dual_scattering: Option<DualScattering>,
    /// How the lobes' `width` varies. Uniform light and dual scattering take the model's own.
    /// A wider lobe is lower in turn, so that it sends as much light.
    pub roughness: RoughnessVariation,
    /// Radiance by which no fibre may change where the TT lobe is left out: with no light behind the hair, as the eye sees it, its upper
    /// bound may be that small, and the frame is then shaded without it. In the units of the lights; 0: never. Kept in any case
    /// with dual scattering and with varying roughness.
    pub lobe_tolerance: f32,
}

impl Default for Sadeghi {
    /// Light brown hair, normalised, single scattering.
    fn default() -> Self {
        let lobe = |colour: [f32; 3], intensity, shift: f32, width: f32| LobeControls {
            colour: Vec3::from(colour),
            intensity,
            shift: shift.to_radians(),
            width: width.to_radians(),
        };
        Self {
            r: lobe([1.0, 1.0, 1.0], 0.3, -7.5, 7.5),
            tt: lobe([0.9, 0.7, 0.4], 0.8, 3.75, 3.75),
            trt: lobe([0.8, 0.5, 0.25], 0.2, 11.25, 15.0),
            tt_azimuthal_width: 20f32.to_radians(),
            glint_intensity: 0.5,
            glint_width: 10f32.to_radians(),
            glint_angle: [30f32.to_radians(), 45f32.to_radians()],
            normalised: true,
            tip_colour: Vec3::ONE,
            dual_scattering: None,
            roughness: RoughnessVariation::default(),
            lobe_tolerance: 0.0,
        }
    }
}

impl Sadeghi {
    /// Shifts and widths from the optics of Chiang's model as [`super::Marschner::of_fibre`], and lobes of as much light as
    /// those of a fibre with these optics send: each lobe's part of the light goes into its colour.
    pub fn of_fibre(optics: &super::Chiang) -> Self {
        let (alpha, beta) = super::marschner::lobes_of(optics);
        let mut model = Self {
            tip_colour: optics.tip_colour,
            dual_scattering: optics.dual_scattering,
            roughness: optics.roughness,
            lobe_tolerance: optics.lobe_tolerance,
            ..Self::default()
        };
        let energies =
            Around::of_cylinder(f64::from(optics.eta), optics.sigma_a.as_dvec3(), 0.0, false)
                .energies();
        let around = model.averaged().around.energies();
        for (p, lobe) in [&mut model.r, &mut model.tt, &mut model.trt]
            .into_iter()
            .enumerate()
        {
            lobe.shift = alpha[p];
            lobe.width = beta[p];
            // A Gaussian of unit height has the area 2β √2π of θ_o, and N′ the integral `around`.
            let area = 2.0 * f64::from(beta[p]) * std::f64::consts::TAU.sqrt() * around[p].x;
            lobe.intensity = 1.0;
            lobe.colour = (energies[p] / area).as_vec3().min(Vec3::splat(1e6));
        }
        model
    }

    pub(crate) fn validate(&self) -> Result<()> {
        for (name, lobe) in [("r", self.r), ("tt", self.tt), ("trt", self.trt)] {
            all_within(
                "sadeghi",
                &format!("{name}.colour"),
                lobe.colour,
                [0.0, 1e6],
            )?;
            within(
                "sadeghi",
                &format!("{name}.intensity"),
                lobe.intensity,
                [0.0, 1e6],
            )?;
            within(
                "sadeghi",
                &format!("{name}.shift"),
                lobe.shift,
                [-FRAC_PI_2, FRAC_PI_2],
            )?;
            within(
                "sadeghi",
                &format!("{name}.width"),
                lobe.width,
                [1e-5, 10.0],
            )?;
        }
        within(
            "sadeghi",
            "tt_azimuthal_width",
            self.tt_azimuthal_width,
            [1e-5, 10.0],
        )?;
        within(
            "sadeghi",
            "glint_intensity",
            self.glint_intensity,
            [0.0, 1e6],
        )?;
        within("sadeghi", "glint_width", self.glint_width, [1e-5, 10.0])?;
        for angle in self.glint_angle {
            within("sadeghi", "glint_angle", angle, [0.0, PI])?;
        }
        if self.glint_angle[0] > self.glint_angle[1] {
            return invalid!(
                "sadeghi: glint_angle from {} to {} is no range",
                self.glint_angle[0],
                self.glint_angle[1]
            );
        }
        all_within("sadeghi", "tip_colour", self.tip_colour, [0.0, 1.0])?;
        self.roughness.validate("sadeghi")?;
        within(
            "sadeghi",
            "lobe_tolerance",
            self.lobe_tolerance,
            MAX_TOLERANCE,
        )?;
        self.dual_scattering
            .map_or(Ok(()), |d| d.validate("sadeghi"))
    }

    fn lobes(&self) -> [LobeControls; 3] {
        [self.r, self.tt, self.trt]
    }

    /// A guess of the largest value: all lobes at their peaks.
    pub(crate) fn brightest(&self) -> f32 {
        let sum: Vec3 = self.lobes().iter().map(|l| l.colour * l.intensity).sum();
        (sum.max_element() * (1.0 + self.glint_intensity)).clamp(0.01, 1e3)
    }

    pub(crate) fn material(&self) -> Material {
        let mut material = Material::default();
        for (p, lobe) in self.lobes().into_iter().enumerate() {
            material.values[p] = (lobe.colour * lobe.intensity).extend(lobe.shift).into();
        }
        material.values[3] = [
            self.r.width,
            self.tt.width,
            self.trt.width,
            self.tt_azimuthal_width,
        ];
        let [low, high] = self.glint_angle;
        material.values[4] = [self.glint_intensity, self.glint_width, low, high];
        material.values[5] = self.tip_colour.extend(f32::from(self.normalised)).into();
        material.values[13] = [self.roughness.strand, self.roughness.tip, 0.0, 0.0];
        material.values[14] = densities(self.dual_scattering);
        material
    }

    /// TT. The divisor of the normalised form only makes it less.
    pub(crate) fn transmission(&self) -> Option<transmission::Lobe> {
        let tt = &self.tt;
        Some(transmission::Lobe {
            along: transmission::Along::Gaussian {
                shift: 2.0 * f64::from(tt.shift),
                deviation: 2.0 * f64::from(tt.width),
                height: f64::from(tt.colour.max_element() * tt.intensity),
            },
            around: transmission::Around::Gaussian {
                width: f64::from(self.tt_azimuthal_width),
            },
            table_step: 0.0,
        })
    }

    pub(crate) fn averaged(&self) -> Averaged {
        let lobes = self.lobes();
        let mut scale = [glam::DVec3::ZERO; 4];
        for (scale, lobe) in scale.iter_mut().zip(lobes) {
            *scale = (lobe.colour * lobe.intensity).as_dvec3();
        }
        Averaged {
            lobes: lobes
                .iter()
                .map(|lobe| Lobe {
                    shift: 2.0 * f64::from(lobe.shift),
                    deviation: 2.0 * f64::from(lobe.width),
                })
                .collect(),
            along: Along::Gaussian {
                alpha: lobes.map(|lobe| f64::from(lobe.shift)),
                beta: lobes.map(|lobe| f64::from(lobe.width)),
                unit_height: true,
            },
            around: Around::of_sadeghi(
                f64::from(self.tt_azimuthal_width),
                f64::from(self.glint_intensity),
                f64::from(self.glint_width),
                self.glint_angle.map(f64::from),
            ),
            scale,
            normalised: self.normalised,
        }
    }
}
