//! Marschner: a smooth dielectric cylinder's R, TT and TRT, blurred along the fibre.
//!
//! `S = Σ_p M_p(θ_h) N_p(θ_d, φ) / cos² θ_d`, `M_p = ½ g(β_p, θ_h - α_p)`
//!
//! `N_p = Σ_r A(p, h_r) |2 dφ/dh|⁻¹` over all roots of `φ(p, h) = 2p γ_t - 2 γ_i + pπ = φ (mod 2π)`, `sin γ_i = h`,
//! `sin γ_t = h / η'`.
//!
//! Marschner et al., *Light Scattering from Human Hair Fibers*, SIGGRAPH 2003; Hunz (2016), §3.3, with these corrections:
//! - M_p has the factor ½: at fixed θ_i, dθ_o = 2 dθ_h, so without it the albedo is near 2 (Hunz eq. 40).
//! - Absorption is along the inclined path, and Fresnel's reflectance is that in space (see [`crate::fresnel`]).
//! - The caustic's h_c fits the kind of roots; its Gaussians take (w_c, φ ∓ φ_c), wrapped (Hunz algorithm 1).
//! - η₂* = 2 (η - 1) a⁻² - η + 2, so that a = 1 gives η (Hunz eq. 59).
//! - In η*, a is the axis along φ = 0 over the other one. The sources have the major axis there and a below 1; but light
//!   along the major axis is focused on the back, which is what a *higher* index does: traced rays agree.
//! - 1 / cos² θ_d stops growing at [`crate::fibre::MIN_COS_THETA_D`].

use crate::fibre::{
    Direction, FibreModel, LOBES, Lobe, OutOfRange, Pair, TRT, all_within, gaussian, unit_gaussian,
    within, wrap_to_pi,
};
use crate::fresnel::Cylinder;
use crate::quadrature::{SIXTEEN, panels};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The least |dφ/dγ_i| that is divided by: at a caustic the true N_p is infinite, here it ends at some 10⁷.
const MIN_SLOPE: f64 = 1e-8;

/// How the roots of φ(p, h) = φ are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Roots {
    /// Of the exact function, to the last bits.
    #[default]
    Exact,
    /// Of its fit by a cubic polynomial in γ_i (Hunz eq. 46), with the fit's own slope (eq. 50).
    Cubic,
}

/// The caustic of TRT is taken out and Gaussians are put in its place (Hunz algorithm 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CausticRemoval {
    /// Azimuthal width of the Gaussians, radians, above 0. Published: 10° to 25°.
    pub w_c: f64,
    /// Scale of the glints, not negative. ½ puts back the energy that was taken out; published: 0.5 to 5.
    pub k_g: f64,
    /// Range of η' above 2 in which the merged glint fades, above 0. Published: 0.2 to 0.4.
    pub delta_eta: f64,
    /// Limit of a caustic's width in h, not negative. Published: 0.5.
    pub delta_h_max: f64,
}

impl Default for CausticRemoval {
    fn default() -> Self {
        Self {
            w_c: 15f64.to_radians(),
            k_g: 0.5,
            delta_eta: 0.3,
            delta_h_max: 0.5,
        }
    }
}

/// Parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Params {
    /// Index of refraction, 1.01 to 3.
    pub eta: f64,
    /// Absorption per fibre radius, not negative.
    pub sigma_a: DVec3,
    /// Longitudinal shifts α_R, α_TT, α_TRT: a lobe lies at θ_h = α_p. Radians, -π/2 to π/2; negative is towards the root.
    pub alpha: [f64; 3],
    /// Longitudinal widths β_R, β_TT, β_TRT in terms of θ_h, radians, 1e-5 to 10.
    pub beta: [f64; 3],
    /// a, the cross-section's axis along φ = 0 over that along φ = π/2, 0.75 to 1.33; TRT takes η*(φ_h) for it.
    pub eccentricity: f64,
    /// How roots are found.
    pub roots: Roots,
    /// With `None`, N_TRT has its caustic, which ends at some 10⁷.
    pub caustic: Option<CausticRemoval>,
}

impl Default for Params {
    /// Brown hair with the widths and shifts of Hunz's table 1.
    fn default() -> Self {
        let degrees = |a: [f64; 3]| a.map(f64::to_radians);
        Self {
            eta: 1.55,
            sigma_a: DVec3::new(0.2, 0.35, 0.8),
            alpha: degrees([-7.5, 3.75, 11.25]),
            beta: degrees([7.5, 3.75, 15.0]),
            eccentricity: 1.0,
            roots: Roots::Exact,
            caustic: Some(CausticRemoval::default()),
        }
    }
}

impl Params {
    /// From the optics that the physical models share: `β_R = √v(β_m) / 2`, β_TT = β_R / 2, β_TRT = 2 β_R, α_R = -alpha,
    /// α_TT = alpha / 2, α_TRT = 3 alpha / 2; a round section, exact roots, caustic removed.
    pub fn of_fibre(optics: &crate::chiang::Params) -> Self {
        let beta_r = 0.5 * crate::chiang::longitudinal_variance(optics.beta_m).sqrt();
        Self {
            eta: optics.eta,
            sigma_a: optics.sigma_a,
            alpha: [-1.0, 0.5, 1.5].map(|k| k * optics.alpha),
            beta: [1.0, 0.5, 2.0].map(|k| k * beta_r),
            ..Self::default()
        }
    }
}

/// The model, with parameters in range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marschner {
    params: Params,
}

/// φ(p, γ_i) in the normal plane, exact or fitted.
#[derive(Debug, Clone, Copy)]
struct ExitAngle {
    p: f64,
    eta_prime: f64,
    /// asin(1 / η') of the fit; `None` for the exact function.
    c: Option<f64>,
}

impl ExitAngle {
    fn new(p: usize, eta_prime: f64, roots: Roots) -> Self {
        Self {
            p: p as f64,
            eta_prime,
            c: (roots == Roots::Cubic).then(|| (1.0 / eta_prime).asin()),
        }
    }

    /// φ, radians, not wrapped.
    fn value(&self, gamma_i: f64) -> f64 {
        let gamma_t = match self.c {
            None => (gamma_i.sin() / self.eta_prime).asin(),
            // Hunz eq. 45.
            Some(c) => c / PI * gamma_i * (3.0 - 4.0 * (gamma_i / PI).powi(2)),
        };
        2.0 * self.p * gamma_t - 2.0 * gamma_i + self.p * PI
    }

    /// dφ/dγ_i.
    fn slope(&self, gamma_i: f64) -> f64 {
        let gamma_t_slope = match self.c {
            None => {
                let (h, cos_gamma_i) = gamma_i.sin_cos();
                // At η' = 1 both roots vanish together at grazing incidence; η' is above 1 here.
                cos_gamma_i.max(0.0) / (self.eta_prime * self.eta_prime - h * h).sqrt()
            }
            Some(c) => c / PI * (3.0 - 12.0 * (gamma_i / PI).powi(2)),
        };
        2.0 * self.p * gamma_t_slope - 2.0
    }

    /// γ_c ≥ 0, where φ turns back: dφ/dγ_i = 0. `None` if it is monotonic.
    fn turning_point(&self) -> Option<f64> {
        let p2 = self.p * self.p;
        match self.c {
            // h_c² = (p² - η'²) / (p² - 1); for TRT (4 - η'²) / 3.
            None if self.p > 1.0 && self.eta_prime < self.p => {
                Some((((p2 - self.eta_prime.powi(2)) / (p2 - 1.0)).sqrt().min(1.0)).asin())
            }
            // Hunz eq. 57.
            Some(c) if 3.0 * self.p * c > PI => {
                let gamma_c = PI * ((3.0 * self.p * c - PI) / (12.0 * self.p * c)).sqrt();
                (gamma_c < FRAC_PI_2).then_some(gamma_c)
            }
            _ => None,
        }
    }

    /// |d²φ/dh²| at a turning point.
    fn curvature(&self, gamma_c: f64) -> f64 {
        let (h, cos) = gamma_c.sin_cos();
        match self.c {
            None => {
                let inside = (self.eta_prime * self.eta_prime - h * h).powf(1.5);
                (2.0 * self.p * h / inside - 2.0 * h / cos.powi(3)).abs()
            }
            // dφ/dγ is 0, so d²φ/dh² = d²φ/dγ² (dγ/dh)².
            Some(c) => 48.0 * self.p * c / PI.powi(3) * gamma_c / (cos * cos),
        }
    }

    /// Calls `found` with every γ_i in [-π/2, π/2] at which φ(γ_i) = φ modulo 2π.
    fn for_each_root(&self, phi: f64, mut found: impl FnMut(f64)) {
        let turn = self.turning_point();
        let mut ends = [-FRAC_PI_2, FRAC_PI_2, FRAC_PI_2, FRAC_PI_2];
        let pieces = if let Some(gamma_c) = turn {
            ends = [-FRAC_PI_2, -gamma_c, gamma_c, FRAC_PI_2];
            3
        } else {
            1
        };
        for piece in ends.windows(2).take(pieces) {
            // Between turning points φ is monotonic: one root for each multiple of 2π in its range.
            let [a, b] = [self.value(piece[0]), self.value(piece[1])];
            let first = ((a.min(b) - phi) / TAU).ceil() as i64;
            let last = ((a.max(b) - phi) / TAU).floor() as i64;
            for k in first..=last {
                found(self.root_between(piece[0], piece[1], phi + TAU * k as f64));
            }
        }
    }

    /// The root of φ(γ) = target in an interval where φ is monotonic: Newton's steps, or halves where they leave it.
    fn root_between(&self, mut low: f64, mut high: f64, target: f64) -> f64 {
        let rising = self.value(high) > self.value(low);
        let mut gamma = 0.5 * (low + high);
        for _ in 0..100 {
            let excess = self.value(gamma) - target;
            if excess == 0.0 {
                break;
            }
            if (excess > 0.0) == rising {
                high = gamma;
            } else {
                low = gamma;
            }
            let newton = gamma - excess / self.slope(gamma);
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - gamma).abs() <= 1e-16 {
                break;
            }
            gamma = next;
        }
        gamma
    }
}

/// η*(φ_h) for a cross-section whose axis along φ = 0 is `eccentricity` times the other (Hunz eq. 58 and 59, corrected).
/// At least 1 + (η - 1)/8 for ratios from 0.75 to 1.33.
pub fn elliptic_eta(eta: f64, eccentricity: f64, phi_h: f64) -> f64 {
    let a2 = eccentricity * eccentricity;
    let eta_1 = 2.0 * (eta - 1.0) * a2 - eta + 2.0;
    let eta_2 = 2.0 * (eta - 1.0) / a2 - eta + 2.0;
    0.5 * ((eta_1 + eta_2) + (2.0 * phi_h).cos() * (eta_1 - eta_2))
}

impl Marschner {
    /// The model, or the first parameter that is out of range.
    pub fn new(params: Params) -> Result<Self, OutOfRange> {
        within("eta", params.eta, [1.01, 3.0])?;
        all_within("sigma_a", &params.sigma_a.to_array(), [0.0, f64::MAX])?;
        all_within("alpha", &params.alpha, [-FRAC_PI_2, FRAC_PI_2])?;
        all_within("beta", &params.beta, [1e-5, 10.0])?;
        within("eccentricity", params.eccentricity, [0.75, 1.33])?;
        if let Some(caustic) = params.caustic {
            within("w_c", caustic.w_c, [1e-5, 10.0])?;
            within("k_g", caustic.k_g, [0.0, 100.0])?;
            within("delta_eta", caustic.delta_eta, [1e-5, 10.0])?;
            within("delta_h_max", caustic.delta_h_max, [0.0, 1.0])?;
        }
        Ok(Self { params })
    }

    /// The parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// M_p, per radian of θ_o (or θ_i): `½ g(β_p, θ_h - α_p)`.
    pub fn m_p(&self, p: usize, theta_i: f64, theta_o: f64) -> f64 {
        let theta_h = 0.5 * (theta_i + theta_o);
        0.5 * gaussian(self.params.beta[p], theta_h - self.params.alpha[p])
    }

    /// The cylinder that lobe p sees: with η*, if the section is elliptic and p is TRT.
    fn cylinder(&self, p: usize, theta_d: f64, phi_h: f64) -> Cylinder {
        let Params {
            eta, eccentricity, ..
        } = self.params;
        let eta = if p == TRT && eccentricity != 1.0 {
            elliptic_eta(eta, eccentricity, phi_h)
        } else {
            eta
        };
        Cylinder::new(eta, theta_d)
    }

    /// Σ_r A(p, h_r) |2 dφ/dh|⁻¹ (Hunz eq. 55), caustic included.
    fn sum_over_roots(&self, cylinder: &Cylinder, exit: &ExitAngle, p: usize, phi: f64) -> DVec3 {
        let mut sum = DVec3::ZERO;
        exit.for_each_root(phi, |gamma_i| {
            let dh_dphi = gamma_i.cos().max(0.0) / exit.slope(gamma_i).abs().max(MIN_SLOPE);
            sum += 0.5 * dh_dphi * cylinder.attenuation(self.params.sigma_a, p, gamma_i);
        });
        sum
    }

    /// N_p, per radian of φ; with its caustic, if p is TRT and none is to be removed. φ_h matters to elliptic sections.
    ///
    /// Without removal ∫ N_p dφ is the part of the light that takes path p: [`Marschner::path_energy`].
    pub fn n_p(&self, p: usize, theta_d: f64, phi: f64, phi_h: f64) -> DVec3 {
        let cylinder = self.cylinder(p, theta_d, phi_h);
        let exit = ExitAngle::new(p, cylinder.eta_prime, self.params.roots);
        let n = self.sum_over_roots(&cylinder, &exit, p, wrap_to_pi(phi));
        match self.params.caustic {
            Some(removal) if p == TRT => self.without_caustic(n, phi, &cylinder, &exit, &removal),
            _ => n,
        }
    }

    /// Hunz algorithm 1, corrected.
    fn without_caustic(
        &self,
        n_trt: DVec3,
        phi: f64,
        cylinder: &Cylinder,
        exit: &ExitAngle,
        removal: &CausticRemoval,
    ) -> DVec3 {
        let CausticRemoval { w_c, k_g, .. } = *removal;
        let turn = exit.turning_point().filter(|_| cylinder.eta_prime < 2.0);
        let (gamma_c, delta_h, t, phi_c) = match turn {
            Some(gamma_c) => {
                let width = 2.0 * (2.0 * w_c / exit.curvature(gamma_c)).sqrt();
                let phi_c = wrap_to_pi(exit.value(gamma_c));
                (gamma_c, width.min(removal.delta_h_max), 1.0, phi_c)
            }
            None => {
                let x = ((cylinder.eta_prime - 2.0) / removal.delta_eta).clamp(0.0, 1.0);
                let smoothstep = x * x * (3.0 - 2.0 * x);
                (0.0, removal.delta_h_max, 1.0 - smoothstep, 0.0)
            }
        };
        if t == 0.0 {
            return n_trt;
        }

        let distances = [wrap_to_pi(phi - phi_c), wrap_to_pi(phi + phi_c)];
        let kept: f64 = distances
            .iter()
            .map(|&d| 1.0 - t * unit_gaussian(w_c, d))
            .product();
        let glints: f64 = distances.iter().map(|&d| gaussian(w_c, d)).sum();
        let a_c = cylinder.attenuation(self.params.sigma_a, TRT, gamma_c);
        n_trt * kept + t * k_g * delta_h * glints * a_c
    }

    /// ½ ∫ A(p, h) dh: the part of the light on a fibre of circular section that takes path p, at inclination θ_d.
    pub fn path_energy(&self, p: usize, theta_d: f64) -> DVec3 {
        let cylinder = Cylinder::new(self.params.eta, theta_d);
        panels(&SIXTEEN, -FRAC_PI_2, FRAC_PI_2, 32)
            .map(|(gamma, weight)| {
                0.5 * weight * gamma.cos() * cylinder.attenuation(self.params.sigma_a, p, gamma)
            })
            .sum()
    }

    /// The angle φ_c in [0, π] of TRT's caustic in a circular section; `None` where there is none (η' ≥ 2).
    pub fn caustic_angle(&self, theta_d: f64) -> Option<f64> {
        let eta_prime = Cylinder::new(self.params.eta, theta_d).eta_prime;
        let exit = ExitAngle::new(TRT, eta_prime, self.params.roots);
        let gamma_c = exit.turning_point()?;
        Some(wrap_to_pi(exit.value(gamma_c)).abs())
    }
}

impl FibreModel for Marschner {
    fn lobes(&self) -> [Option<Lobe>; LOBES] {
        let lobe = |p: usize| {
            Some(Lobe {
                shift: 2.0 * self.params.alpha[p],
                deviation: 2.0 * self.params.beta[p],
            })
        };
        [lobe(0), lobe(1), lobe(2), None]
    }

    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES] {
        let pair = Pair::new(wi, wo);
        let factor = pair.cosine_factor(wi);
        std::array::from_fn(|p| {
            let m = if p > TRT {
                0.0
            } else {
                self.m_p(p, wi.theta, wo.theta)
            };
            // Far from a narrow lobe there is nothing to find roots for.
            if m * factor == 0.0 {
                return DVec3::ZERO;
            }
            m * factor * self.n_p(p, pair.theta_d, pair.phi, pair.phi_h)
        })
    }
}
