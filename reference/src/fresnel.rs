//! Light at the surface of a dielectric and on its way through a cylinder.
//!
//! Snell: `sin γ_t = sin γ_i / η`. Fresnel, with c = cos γ_i and c_t = cos γ_t:
//!
//! `F_⊥ = ((c - η c_t) / (c + η c_t))²`, `F_∥ = ((η c - c_t) / (η c + c_t))²`, unpolarised their mean.
//!
//! Bravais: a ray at inclination θ to a cylinder, projected to the normal plane, obeys Snell's law with
//! `η' = √(η² - sin² θ) / cos θ`; F_⊥ there takes η', F_∥ takes `η'' = η² / η'`, and both take γ_t from η'. Their mean
//! equals the unpolarised F of η at `cos θ · cos γ_i`, the cosine in space, which stays finite at θ = ±π/2; the models use
//! that form. Hunz (2016) has Snell with η'' for one polarisation, which does not agree with it.

use glam::DVec3;

/// Reflectance of both polarisations, each in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance {
    /// The field is perpendicular to the plane of incidence.
    pub perpendicular: f64,
    /// The field lies in the plane of incidence.
    pub parallel: f64,
}

impl Reflectance {
    /// The mean of both, for unpolarised light.
    pub fn unpolarised(self) -> f64 {
        0.5 * (self.perpendicular + self.parallel)
    }
}

/// Reflectance from outside, at an index above 0 relative to the outside and a cosine of incidence (clamped to [0, 1]).
/// An index below 1 reflects everything beyond its critical angle.
pub fn fresnel(eta: f64, cos_gamma_i: f64) -> Reflectance {
    let c = cos_gamma_i.clamp(0.0, 1.0);
    let cos2_gamma_t = 1.0 - (1.0 - c * c) / (eta * eta);
    if cos2_gamma_t <= 0.0 || c == 0.0 {
        return Reflectance {
            perpendicular: 1.0,
            parallel: 1.0,
        };
    }
    let c_t = cos2_gamma_t.sqrt();
    let square = |x: f64| x * x;
    Reflectance {
        perpendicular: square((c - eta * c_t) / (c + eta * c_t)),
        parallel: square((eta * c - c_t) / (eta * c + c_t)),
    }
}

/// Bravais' indices at inclination θ, |θ| < π/2: η' for the perpendicular polarisation and for Snell's law, η'' = η²/η'
/// for the parallel one. η' is at least η and infinite where cos θ is 0.
pub fn bravais(eta: f64, theta: f64) -> (f64, f64) {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let root = (eta * eta - sin_theta * sin_theta).sqrt();
    let cos_theta = cos_theta.max(0.0);
    (root / cos_theta, eta * eta * cos_theta / root)
}

/// Reflectance in the normal plane by Bravais' indices, at inclination θ, |θ| < π/2, and cos γ_i in [0, 1].
pub fn bravais_fresnel(eta: f64, theta: f64, cos_gamma_i: f64) -> Reflectance {
    let (eta_perp, eta_par) = bravais(eta, theta);
    let c = cos_gamma_i.clamp(0.0, 1.0);
    let h = (1.0 - c * c).sqrt();
    let c_t = (1.0 - (h / eta_perp).powi(2)).sqrt();
    let square = |x: f64| x * x;
    Reflectance {
        perpendicular: square((c - eta_perp * c_t) / (c + eta_perp * c_t)),
        parallel: square((eta_par * c - c_t) / (eta_par * c + c_t)),
    }
}

/// What a circular cylinder of unit radius does to rays of one inclination.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cylinder {
    eta: f64,
    cos_theta: f64,
    /// Bravais' index η'; infinite at θ = ±π/2.
    pub eta_prime: f64,
    /// Cosine of the inclination inside, at least √(1 - 1/η²).
    cos_theta_t: f64,
}

impl Cylinder {
    /// η above 1, any θ.
    pub fn new(eta: f64, theta: f64) -> Self {
        let sin_theta_t = theta.sin() / eta;
        Self {
            eta,
            cos_theta: theta.cos().max(0.0),
            eta_prime: bravais(eta, theta).0,
            cos_theta_t: (1.0 - sin_theta_t * sin_theta_t).sqrt(),
        }
    }

    /// Reflectance and one crossing's transmittance at offset h in [-1, 1], given as γ_i = asin h.
    ///
    /// A crossing is 2 cos γ_t long in the normal plane and 2 cos γ_t / cos θ_t in space, with sin θ_t = sin θ / η.
    /// Hunz eq. 52 leaves the inclination out.
    pub fn reflectance_and_crossing(&self, sigma_a: DVec3, gamma_i: f64) -> (f64, DVec3) {
        let (h, cos_gamma_i) = gamma_i.sin_cos();
        let f = fresnel(self.eta, self.cos_theta * cos_gamma_i.max(0.0)).unpolarised();
        let sin_gamma_t = h / self.eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).max(0.0).sqrt();
        let length = 2.0 * cos_gamma_t / self.cos_theta_t;
        let crossing = (sigma_a * -length).map(f64::exp);
        (f, crossing)
    }

    /// A(p, h): the part of the light at offset sin γ_i that leaves after p crossings.
    pub fn attenuation(&self, sigma_a: DVec3, p: usize, gamma_i: f64) -> DVec3 {
        let (f, crossing) = self.reflectance_and_crossing(sigma_a, gamma_i);
        match p {
            0 => DVec3::splat(f),
            _ => {
                let reflected = f.powi(p as i32 - 1);
                (1.0 - f) * (1.0 - f) * reflected * crossing.map(|t| t.powi(p as i32))
            }
        }
    }

    /// A(0..=2, h), and all longer paths together: a geometric series.
    pub fn attenuations(&self, sigma_a: DVec3, gamma_i: f64) -> [DVec3; 4] {
        let (f, t) = self.reflectance_and_crossing(sigma_a, gamma_i);
        if f >= 1.0 {
            return [DVec3::ONE, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
        }
        let tt = (1.0 - f) * (1.0 - f) * t;
        let again = f * t;
        let trt = tt * again;
        [DVec3::splat(f), tt, trt, trt * again / (1.0 - again)]
    }
}
