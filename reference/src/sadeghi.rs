//! Sadeghi: Marschner's three lobes as an artist would have them, each with its own colour, place and widths.
//!
//! `f′ = (1 / cos² θ_d) Σ_p C_p I_p g′(β_p, θ_h - α_p) N′_p(φ)` with g′ the Gaussian of unit height,
//!
//! `N′_R = cos(φ/2)`, `N′_TT = g′(δ_TT, π - |φ|)`, `N′_TRT = cos(φ/2) + I_G g′(δ_G, G - |φ|)`, |φ| in [0, π].
//!
//! Sadeghi et al., *An Artist Friendly Hair Shading System*, SIGGRAPH 2010; Hunz (2016), §3.4. Hunz prints widths squared
//! (eq. 61, 63, 64); here β and δ are standard deviations.
//!
//! The normalised form divides by `max(1, E(θ_i), E(θ_o))`, `E(θ_i) = ∫ f′ cos θ_o dω_o` (each channel for itself): as
//! the model is symmetric in its two directions, dividing by the E of one of them alone would keep ∫ cos θ_o dω_o or
//! ∫ cos θ_i dω_i at most 1, but not both, and would lose reciprocity.

use crate::fibre::{
    Direction, FibreModel, LOBES, Lobe, MIN_COS_THETA_D, OutOfRange, Pair, R, TRT, TT, all_within,
    unit_gaussian, within,
};
use crate::quadrature::{SIXTEEN, panels};
use crate::random::unit;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

/// One lobe's controls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeControls {
    /// C_p, not negative.
    pub colour: DVec3,
    /// I_p, not negative.
    pub intensity: f64,
    /// α_p: the lobe lies at θ_h = α_p. Radians, -π/2 to π/2; negative is towards the root.
    pub shift: f64,
    /// β_p in terms of θ_h, radians, 1e-5 to 10.
    pub width: f64,
}

/// Parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Primary highlight.
    pub r: LobeControls,
    /// Forward lobe.
    pub tt: LobeControls,
    /// Secondary highlight; glints share its colour, intensity, shift and width.
    pub trt: LobeControls,
    /// δ_TT, the forward lobe's azimuthal width, radians, 1e-5 to 10.
    pub tt_azimuthal_width: f64,
    /// I_G, relative to the secondary highlight's intensity, not negative.
    pub glint_intensity: f64,
    /// δ_G, radians, 1e-5 to 10.
    pub glint_width: f64,
    /// G, half the angle between a strand's two glints, radians, 0 to π. See [`glint_angle`].
    pub glint_angle: f64,
}

impl Default for Params {
    fn default() -> Self {
        let lobe = |colour: [f64; 3], intensity: f64, shift: f64, width: f64| LobeControls {
            colour: DVec3::from_array(colour),
            intensity,
            shift: shift.to_radians(),
            width: width.to_radians(),
        };
        Self {
            r: lobe([1.0, 1.0, 1.0], 0.3, -7.5, 7.5),
            tt: lobe([0.9, 0.7, 0.4], 0.8, 3.75, 3.75),
            trt: lobe([0.8, 0.5, 0.25], 0.2, 11.25, 15.0),
            tt_azimuthal_width: 20f64.to_radians(),
            glint_intensity: 0.5,
            glint_width: 10f64.to_radians(),
            glint_angle: 37.5f64.to_radians(),
        }
    }
}

/// A strand's own G, evenly distributed in [30°, 45°): depends on strand and seed alone.
pub fn glint_angle(strand: u64, seed: u64) -> f64 {
    FRAC_PI_6 + (FRAC_PI_4 - FRAC_PI_6) * unit(seed, strand)
}

/// The model, with parameters in range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sadeghi {
    params: Params,
}

impl Sadeghi {
    /// The model, or the first parameter that is out of range.
    pub fn new(params: Params) -> Result<Self, OutOfRange> {
        for lobe in [params.r, params.tt, params.trt] {
            all_within("colour", &lobe.colour.to_array(), [0.0, 1e6])?;
            within("intensity", lobe.intensity, [0.0, 1e6])?;
            within("shift", lobe.shift, [-FRAC_PI_2, FRAC_PI_2])?;
            within("width", lobe.width, [1e-5, 10.0])?;
        }
        within(
            "tt_azimuthal_width",
            params.tt_azimuthal_width,
            [1e-5, 10.0],
        )?;
        within("glint_intensity", params.glint_intensity, [0.0, 1e6])?;
        within("glint_width", params.glint_width, [1e-5, 10.0])?;
        within("glint_angle", params.glint_angle, [0.0, PI])?;
        Ok(Self { params })
    }

    /// The parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    fn controls(&self, p: usize) -> LobeControls {
        [self.params.r, self.params.tt, self.params.trt][p]
    }

    /// M′_p: unit height, in [0, 1].
    pub fn m_p(&self, p: usize, theta_i: f64, theta_o: f64) -> f64 {
        let lobe = self.controls(p);
        unit_gaussian(lobe.width, 0.5 * (theta_i + theta_o) - lobe.shift)
    }

    /// N′_p, not normalised.
    pub fn n_p(&self, p: usize, phi: f64) -> f64 {
        let phi = crate::fibre::wrap_to_pi(phi).abs();
        let base = (0.5 * phi).cos().max(0.0);
        match p {
            R => base,
            TT => unit_gaussian(self.params.tt_azimuthal_width, PI - phi),
            _ => {
                let off = self.params.glint_angle - phi;
                base + self.params.glint_intensity * unit_gaussian(self.params.glint_width, off)
            }
        }
    }

    /// ∫ N′_p dφ around the fibre.
    fn azimuthal_integral(&self, p: usize) -> f64 {
        // A half circle, in panels that resolve the Gaussian around its centre.
        let half = |low: f64, high: f64, peak: f64, width: f64| -> f64 {
            let mut ends = vec![low, high];
            ends.extend([-8.0, -4.0, 0.0, 4.0, 8.0].map(|k| peak + k * width));
            ends.retain(|&e| e >= low && e <= high);
            ends.sort_by(f64::total_cmp);
            let of_panel = |ends: &[f64]| -> f64 {
                panels(&SIXTEEN, ends[0], ends[1], 4)
                    .map(|(phi, weight)| weight * self.n_p(p, phi))
                    .sum()
            };
            ends.windows(2).map(of_panel).sum()
        };
        let Params {
            tt_azimuthal_width,
            glint_width,
            glint_angle,
            ..
        } = self.params;
        2.0 * match p {
            TT => half(0.0, PI, PI, tt_azimuthal_width),
            _ => half(0.0, PI, glint_angle, glint_width),
        }
    }

    /// ∫ M′_p cos² θ / cos² θ_d dθ at the other direction's inclination.
    fn longitudinal_integral(&self, p: usize, theta: f64) -> f64 {
        let lobe = self.controls(p);
        let centre = 2.0 * lobe.shift - theta;
        let reach = 2.0 * 8.6 * lobe.width;
        let (low, high) = (
            (centre - reach).max(-FRAC_PI_2),
            (centre + reach).min(FRAC_PI_2),
        );
        if low >= high {
            return 0.0;
        }
        let value = |other: f64| {
            let cos = other.cos();
            let cos_theta_d = (0.5 * (other - theta)).cos().max(MIN_COS_THETA_D);
            self.m_p(p, theta, other) * (cos / cos_theta_d).powi(2)
        };
        // The floor of cos θ_d makes a corner, where the other direction is near the tangent's far end.
        let corner = 2.0 * MIN_COS_THETA_D.acos();
        let mut ends = vec![low, high];
        ends.extend(
            [theta - corner, theta + corner]
                .into_iter()
                .filter(|&e| e > low && e < high),
        );
        ends.sort_by(f64::total_cmp);
        let of_panel = |ends: &[f64]| -> f64 {
            panels(&SIXTEEN, ends[0], ends[1], 12)
                .map(|(other, weight)| weight * value(other))
                .sum()
        };
        ends.windows(2).map(of_panel).sum()
    }

    /// E(θ) = ∫ f′ cos θ_o dω_o, the part of the light from inclination θ that is scattered; may exceed 1.
    pub fn albedo(&self, theta: f64) -> DVec3 {
        let around = std::array::from_fn(|p| self.azimuthal_integral(p));
        self.albedo_with(theta, &around)
    }

    fn albedo_with(&self, theta: f64, around: &[f64; 3]) -> DVec3 {
        (0..3)
            .map(|p| {
                let lobe = self.controls(p);
                lobe.colour * (lobe.intensity * around[p] * self.longitudinal_integral(p, theta))
            })
            .sum()
    }

    /// The energy-conserving form of the same parameters.
    pub fn normalised(self) -> Normalised {
        Normalised {
            around: std::array::from_fn(|p| self.azimuthal_integral(p)),
            model: self,
        }
    }
}

impl FibreModel for Sadeghi {
    fn lobes(&self) -> [Option<Lobe>; LOBES] {
        let lobe = |p: usize| {
            Some(Lobe {
                shift: 2.0 * self.controls(p).shift,
                deviation: 2.0 * self.controls(p).width,
            })
        };
        [lobe(R), lobe(TT), lobe(TRT), None]
    }

    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES] {
        let pair = Pair::new(wi, wo);
        let factor = pair.cosine_factor(wi);
        std::array::from_fn(|p| {
            if p > TRT {
                return DVec3::ZERO;
            }
            let lobe = self.controls(p);
            let value = self.m_p(p, wi.theta, wo.theta) * self.n_p(p, pair.phi);
            lobe.colour * (lobe.intensity * value * factor)
        })
    }
}

/// The energy-conserving form: symmetric in its directions but for cos θ_i, and its furnace and albedo are at most 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalised {
    model: Sadeghi,
    around: [f64; 3],
}

impl Normalised {
    /// What this form divides by at a pair of inclinations, at least 1: `max(1, E(θ_i), E(θ_o))`.
    pub fn divisor(&self, theta_i: f64, theta_o: f64) -> DVec3 {
        let albedo = |theta| self.model.albedo_with(theta, &self.around);
        DVec3::ONE.max(albedo(theta_i)).max(albedo(theta_o))
    }
}

impl FibreModel for Normalised {
    fn lobes(&self) -> [Option<Lobe>; LOBES] {
        self.model.lobes()
    }

    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES] {
        let divisor = self.divisor(wi.theta, wo.theta);
        self.model.scatter_lobes(wi, wo).map(|lobe| lobe / divisor)
    }

    fn scatter_ring(&self, pairs: &[(Direction, Direction)]) -> Vec<[DVec3; LOBES]> {
        let Some((wi, wo)) = pairs.first() else {
            return Vec::new();
        };
        let divisor = self.divisor(wi.theta, wo.theta);
        let lobes = self.model.scatter_ring(pairs).into_iter();
        lobes.map(|ring| ring.map(|lobe| lobe / divisor)).collect()
    }
}
