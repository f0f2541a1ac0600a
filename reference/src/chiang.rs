//! Chiang: lobes of d'Eon's longitudinal function, trimmed logistics around the fibre, and all energy kept.
//!
//! `S = Σ_p M_p(θ_o, θ_i) A_p(θ_o, h) N_p(φ; h)`, p = R, TT, TRT and the residual of all longer paths,
//!
//! `M_p = i0e(a) exp(-2 sin² θ_h / v_p) / (v_p (1 - e^(-2/v_p)))`, `a = cos θ_i cos θ_o / v_p`, θ_o tilted,
//!
//! `N_p = l(φ - Φ(p, h); s)`, the logistic of scale s trimmed to [-π, π], `Φ = 2p γ_t - 2γ_i + pπ`; residual 1/2π.
//!
//! i0e(a) = e^(-a) I_0(a): the powers of e that make the plain form overflow have been joined. Near field: h is the
//! offset at which the *view* ray meets the fibre, in [-1, 1], and A_p takes the view's θ; so the model is not
//! reciprocal, but with σ_a = 0 its ∫ dω_i is 1. Far field: the mean over h.
//!
//! d'Eon et al., *An Energy-Conserving Hair Reflectance Model*, EGSR 2011; Chiang et al., *A Practical and Controllable
//! Hair and Fur Model for Production Path Tracing*, EGSR 2016. The scale of a unit logistic is √(π/8).
//! `scatter` is S itself: the cosine is inside, since ∫ M_p cos θ_i dθ_i is 1.

use crate::fibre::{
    Direction, FibreModel, LOBES, Lobe, OutOfRange, Pair, RESIDUAL, all_within, within, wrap_to_pi,
};
use crate::fresnel::Cylinder;
use crate::quadrature::{EIGHT, on};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Beyond this many scales from its centre the logistic is below e⁻⁴⁵ of its peak, and left out.
const LOGISTIC_REACH: f64 = 45.0;

/// Parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Longitudinal roughness β_m, 1e-3 to 1.
    pub beta_m: f64,
    /// Azimuthal roughness β_n, 1e-3 to 1.
    pub beta_n: f64,
    /// Tilt of the cuticle's scales, radians, -π/2 to π/2. Positive moves R towards the root: its θ_h is -alpha, that
    /// of TT alpha/2, that of TRT 2 alpha.
    pub alpha: f64,
    /// Index of refraction, 1.01 to 3.
    pub eta: f64,
    /// Absorption per fibre radius, not negative.
    pub sigma_a: DVec3,
}

impl Default for Params {
    /// Brown hair.
    fn default() -> Self {
        Self {
            beta_m: 0.3,
            beta_n: 0.3,
            alpha: 2f64.to_radians(),
            eta: 1.55,
            sigma_a: sigma_a_from_melanin(1.3, 0.0),
        }
    }
}

/// σ_a per fibre radius from the concentrations of eumelanin and pheomelanin (brown hair: 1.3 and 0), not negative.
/// Coefficients by d'Eon et al. 2011.
pub fn sigma_a_from_melanin(eumelanin: f64, pheomelanin: f64) -> DVec3 {
    eumelanin * DVec3::new(0.419, 0.697, 1.37) + pheomelanin * DVec3::new(0.187, 0.4, 1.05)
}

/// σ_a per fibre radius with which a volume of hair has about this colour (each channel above 0, at most 1) after all
/// scattering, at azimuthal roughness β_n: `(ln c / (5.969 - 0.215 β + 2.532 β² - 10.73 β³ + 5.574 β⁴ + 0.245 β⁵))²`
/// (Chiang et al. 2016).
pub fn sigma_a_from_reflectance(colour: DVec3, beta_n: f64) -> DVec3 {
    const FIT: [f64; 6] = [0.245, 5.574, -10.73, 2.532, -0.215, 5.969];
    let divisor = FIT.into_iter().fold(0.0, |sum, c| sum * beta_n + c);
    colour.map(|c| (c.ln() / divisor).powi(2))
}

/// v(β_m) = (0.726 β + 0.812 β² + 3.7 β²⁰)², R's longitudinal variance.
pub fn longitudinal_variance(beta_m: f64) -> f64 {
    (0.726 * beta_m + 0.812 * beta_m * beta_m + 3.7 * beta_m.powi(20)).powi(2)
}

/// s(β_n) = √(π/8) (0.265 β + 1.194 β² + 5.372 β²²), the logistic's scale.
pub fn azimuthal_scale(beta_n: f64) -> f64 {
    (PI / 8.0).sqrt() * (0.265 * beta_n + 1.194 * beta_n * beta_n + 5.372 * beta_n.powi(22))
}

/// e^(-x) I_0(x) for x ≥ 0, to 1e-15: the power series, whose terms are all positive, or the asymptotic one.
pub fn i0e(x: f64) -> f64 {
    if x < 25.0 {
        let quarter = 0.25 * x * x;
        let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
        while term > 1e-17 * sum {
            k += 1.0;
            term *= quarter / (k * k);
            sum += term;
        }
        return sum * (-x).exp();
    }
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 0..40 {
        let odd = f64::from(2 * k + 1);
        let next = term * odd * odd / (8.0 * x * f64::from(k + 1));
        if next > term || next < 1e-17 {
            break;
        }
        term = next;
        sum += term;
    }
    sum / (TAU * x).sqrt()
}

/// d'Eon's longitudinal function of variance v, per steradian without the azimuth: `∫ M cos θ_i dθ_i = 1` at any θ_o.
///
/// θ_o may be tilted past ±π/2, where the function is that of π - θ_o: it depends on sin θ_o and |cos θ_o| alone.
pub fn longitudinal(v: f64, theta_i: f64, theta_o: f64) -> f64 {
    let theta_o = if theta_o.abs() > FRAC_PI_2 {
        PI.copysign(theta_o) - theta_o
    } else {
        theta_o
    };
    let a = (theta_i.cos() * theta_o.cos()).max(0.0) / v;
    let sin_theta_h = (0.5 * (theta_i + theta_o)).sin();
    i0e(a) * (-2.0 * sin_theta_h * sin_theta_h / v).exp() / (v * -(-2.0 / v).exp_m1())
}

/// The logistic of scale s on [-π, π], of unit integral.
pub fn trimmed_logistic(x: f64, s: f64) -> f64 {
    let e = (-x.abs() / s).exp();
    // The untrimmed one's integral over [-π, π] is tanh(π / 2s).
    e / (s * (1.0 + e) * (1.0 + e) * (PI / (2.0 * s)).tanh())
}

/// The model, with parameters in range; as a [`FibreModel`] it is the far field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chiang {
    params: Params,
    /// Variance of each lobe.
    v: [f64; LOBES],
    /// What is added to the view's θ for each lobe.
    tilt: [f64; LOBES],
    /// The logistic's scale.
    s: f64,
}

impl Chiang {
    /// The model, or the first parameter that is out of range.
    pub fn new(params: Params) -> Result<Self, OutOfRange> {
        within("beta_m", params.beta_m, [1e-3, 1.0])?;
        within("beta_n", params.beta_n, [1e-3, 1.0])?;
        within("alpha", params.alpha, [-FRAC_PI_2, FRAC_PI_2])?;
        within("eta", params.eta, [1.01, 3.0])?;
        all_within("sigma_a", &params.sigma_a.to_array(), [0.0, f64::MAX])?;
        let v = longitudinal_variance(params.beta_m);
        Ok(Self {
            params,
            v: [v, 0.25 * v, 4.0 * v, 4.0 * v],
            tilt: [2.0, -1.0, -4.0, 0.0].map(|k| k * params.alpha),
            s: azimuthal_scale(params.beta_n),
        })
    }

    /// The parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// M_p, with lobe p's variance and tilt.
    pub fn m_p(&self, p: usize, theta_i: f64, theta_o: f64) -> f64 {
        longitudinal(self.v[p], theta_i, theta_o + self.tilt[p])
    }

    /// A_p at offset h in [-1, 1] and the view's inclination; the sum over p is 1 where σ_a is 0.
    pub fn a_p(&self, theta_o: f64, h: f64) -> [DVec3; LOBES] {
        Cylinder::new(self.params.eta, theta_o)
            .attenuations(self.params.sigma_a, h.clamp(-1.0, 1.0).asin())
    }

    /// Φ(p, h), the azimuth (from the view to the light) around which lobe p lies, not wrapped.
    fn centre(p: usize, gamma_i: f64, eta_prime: f64) -> f64 {
        let p = p as f64;
        2.0 * p * (gamma_i.sin() / eta_prime).asin() - 2.0 * gamma_i + p * PI
    }

    /// N_p, per radian of φ = φ_i - φ_o, at offset h: `∫ N_p dφ = 1`.
    pub fn n_p(&self, p: usize, theta_o: f64, h: f64, phi: f64) -> f64 {
        if p == RESIDUAL {
            return 1.0 / TAU;
        }
        let eta_prime = Cylinder::new(self.params.eta, theta_o).eta_prime;
        let centre = Self::centre(p, h.clamp(-1.0, 1.0).asin(), eta_prime);
        trimmed_logistic(wrap_to_pi(phi - centre), self.s)
    }

    /// The near field at the view ray's offset h in [-1, 1].
    pub fn at(self, h: f64) -> NearField {
        NearField { model: self, h }
    }

    /// `½ ∫ A_p(h) N_p(φ; h) dh`, the far field's azimuthal function of each lobe, by panels in γ_i = asin h that are
    /// halved until they resolve the logistic.
    pub fn far_field_azimuthal(&self, theta_o: f64, phi: f64) -> [DVec3; LOBES] {
        let cylinder = Cylinder::new(self.params.eta, theta_o);
        std::array::from_fn(|p| {
            let mut far = FarFieldIntegral {
                model: self,
                cylinder: &cylinder,
                p,
                phi,
                // |dΦ/dγ_i| is greatest at γ_i = 0 or ±π/2.
                max_slope: (2.0 * p as f64 / cylinder.eta_prime - 2.0).abs().max(2.0),
                sum: DVec3::ZERO,
            };
            let edge = |i: usize| PI * (i as f64 / 8.0 - 0.5);
            for i in 0..8 {
                far.add(edge(i), edge(i + 1));
            }
            far.sum
        })
    }
}

struct FarFieldIntegral<'a> {
    model: &'a Chiang,
    cylinder: &'a Cylinder,
    p: usize,
    phi: f64,
    max_slope: f64,
    sum: DVec3,
}

impl FarFieldIntegral<'_> {
    /// Adds the integral over [low, high].
    fn add(&mut self, low: f64, high: f64) {
        let s = self.model.s;
        let width = high - low;
        if self.p != RESIDUAL {
            let middle = Chiang::centre(self.p, 0.5 * (low + high), self.cylinder.eta_prime);
            let x = wrap_to_pi(self.phi - middle).abs();
            let spread = 0.5 * self.max_slope * width;
            if x - spread > LOGISTIC_REACH * s {
                return;
            }
            // The trimmed logistic has a corner at ±π.
            let corner = x + spread > PI && (-PI / s).exp() > 1e-12 && width > 1e-6;
            if self.max_slope * width > 4.0 * s || corner {
                let middle = 0.5 * (low + high);
                self.add(low, middle);
                self.add(middle, high);
                return;
            }
        }
        for (gamma_i, weight) in on(&EIGHT, low, high) {
            let n = if self.p == RESIDUAL {
                1.0 / TAU
            } else {
                let centre = Chiang::centre(self.p, gamma_i, self.cylinder.eta_prime);
                trimmed_logistic(wrap_to_pi(self.phi - centre), s)
            };
            let a = self
                .cylinder
                .attenuations(self.model.params.sigma_a, gamma_i)[self.p];
            self.sum += 0.5 * weight * gamma_i.cos() * n * a;
        }
    }
}

fn lobes(model: &Chiang) -> [Option<Lobe>; LOBES] {
    std::array::from_fn(|p| {
        Some(Lobe {
            shift: -model.tilt[p],
            deviation: model.v[p].sqrt(),
        })
    })
}

impl FibreModel for Chiang {
    fn lobes(&self) -> [Option<Lobe>; LOBES] {
        lobes(self)
    }

    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES] {
        let phi = -Pair::new(wi, wo).phi;
        let azimuthal = self.far_field_azimuthal(wo.theta, phi);
        std::array::from_fn(|p| self.m_p(p, wi.theta, wo.theta) * azimuthal[p])
    }
}

/// The model at one offset across the fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearField {
    model: Chiang,
    h: f64,
}

impl FibreModel for NearField {
    fn lobes(&self) -> [Option<Lobe>; LOBES] {
        lobes(&self.model)
    }

    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES] {
        self.scatter_ring(&[(wi, wo)])[0]
    }

    fn scatter_ring(&self, pairs: &[(Direction, Direction)]) -> Vec<[DVec3; LOBES]> {
        let Some((wi, wo)) = pairs.first() else {
            return Vec::new();
        };
        let (model, gamma_i) = (&self.model, self.h.clamp(-1.0, 1.0).asin());
        let eta_prime = Cylinder::new(model.params.eta, wo.theta).eta_prime;
        let centre: [f64; LOBES] = std::array::from_fn(|p| Chiang::centre(p, gamma_i, eta_prime));
        let attenuation = model.a_p(wo.theta, self.h);
        let along: [DVec3; LOBES] =
            std::array::from_fn(|p| attenuation[p] * model.m_p(p, wi.theta, wo.theta));
        let value = |&(wi, wo): &(Direction, Direction)| {
            let phi = -Pair::new(wi, wo).phi;
            std::array::from_fn(|p| match p {
                RESIDUAL => along[p] / TAU,
                _ => along[p] * trimmed_logistic(wrap_to_pi(phi - centre[p]), model.s),
            })
        };
        pairs.iter().map(value).collect()
    }
}
