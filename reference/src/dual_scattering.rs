//! Dual scattering: light that reaches a fibre through n others, and light that the fibres around it send back.
//!
//! Hemispherical averages of a single fibre's model, lit at inclination θ from all azimuths of the near half:
//!
//! `ā_f(θ) = 1/π ∫_{-π/2}^{π/2} ∫_{Ω_f} scatter((θ, φ), ω) dω dφ`, ā_b over the other half Ω_b
//!
//! ᾱ and β̄² are the means of the lobes' shifts and variances, weighted by the lobes' parts in that half. Then
//!
//! `T_f = d_f Π_k ā_f(θ_k)`, `σ̄_f² = Σ_k β̄_f²(θ_k)`; with all fibres alike, as Sadeghi and Tamstorf: `d_f ā_fⁿ`, `n β̄_f²`
//!
//! `Ā_b = ā_b ā_f² / (1 - ā_f²) + ā_b³ ā_f² / (1 - ā_f²)³`
//!
//! `Δ̄_b = ᾱ_b (1 - 2ā_b² / (1-ā_f²)²) + ᾱ_f (2(1-ā_f²)² + 4ā_f²ā_b²) / (1-ā_f²)³`
//!
//! `σ̄_b = (1 + d_b ā_f²) (ā_b √(2β̄_f²+β̄_b²) + ā_b³ √(2β̄_f²+3β̄_b²)) / (ā_b + ā_b³)`
//!
//! Zinke et al., *Dual Scattering Approximation for Fast Multiple Scattering in Hair*, SIGGRAPH 2008; Sadeghi and
//! Tamstorf, *Efficient Implementation of the Dual Scattering Model in RenderMan*, 2010. The denominator of σ̄_b is as
//! printed `ā_b + ā_b³ (2β̄_f + 3β̄_b)`, which adds a number to an angle; here it is the sum of the numerator's weights.
//! Shifts and deviations are of θ_i + θ_o (twice those of θ_h), in which a path through i fibres, back from one and through
//! i again has shift ᾱ_b + 2i ᾱ_f and variance β̄_b² + 2i β̄_f².

use crate::fibre::{Direction, FibreModel, LOBES, Pair};
use crate::furnace::{azimuths_of_ring, inclinations};
use crate::quadrature::{SIXTEEN, panels};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The least 1 - ā_f² that is divided by.
const MIN_LOSS: f64 = 1e-9;

/// How dense the hair is around the shaded fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Density {
    /// d_f, 0 to 1; the paper's 0.7 fits 0.6 to 0.8.
    pub forward: f64,
    /// d_b, 0 to 1; likewise.
    pub backward: f64,
}

impl Default for Density {
    fn default() -> Self {
        Self {
            forward: 0.7,
            backward: 0.7,
        }
    }
}

/// What a single fibre does on average, lit at one inclination; one value a channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Averages {
    /// ā_f, the part that goes on; ā_f + ā_b ≤ 1.
    pub a_f: DVec3,
    /// ā_b, the part that is sent back.
    pub a_b: DVec3,
    /// ᾱ_f, mean shift of θ_i + θ_o of what goes on, radians.
    pub alpha_f: DVec3,
    /// ᾱ_b, of what is sent back.
    pub alpha_b: DVec3,
    /// β̄_f, root of the mean variance of θ_i + θ_o of what goes on, radians.
    pub beta_f: DVec3,
    /// β̄_b, of what is sent back.
    pub beta_b: DVec3,
}

/// Light after fibres between the light's source and the shaded one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forward {
    /// T_f, the part that arrives.
    pub transmittance: DVec3,
    /// σ̄_f², the variance of its inclination, radians².
    pub variance: DVec3,
    /// Whether there was a fibre at all; if not, the light comes from its own direction alone.
    pub scattered: bool,
}

/// Light that the fibres around the shaded one send back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// Ā_b, the part of the light.
    pub a_b: DVec3,
    /// Δ̄_b, mean of θ_i + θ_o, radians.
    pub delta_b: DVec3,
    /// σ̄_b, standard deviation of θ_i + θ_o, radians.
    pub sigma_b: DVec3,
}

/// A quotient, or 0 where there is nothing to divide.
fn quotient(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if b[c] > 0.0 { a[c] / b[c] } else { 0.0 }
    }))
}

impl Averages {
    /// The averages of `model` lit at inclination θ, with this many azimuths, for sections of any orientation: the model is
    /// taken at φ_i = 0.
    ///
    /// The azimuths of light and exit are each anywhere in their halves, so an exit at φ from the light counts by |φ| / π
    /// as forward and by the rest as backward. A model that gives back more than it gets is scaled down to ā_f + ā_b = 1.
    pub fn of(model: &impl FibreModel, theta: f64, azimuths: usize) -> Self {
        let wi = Direction::new(theta, 0.0);
        let step = TAU / azimuths as f64;
        let ring = |&(theta_o, weight): &(f64, f64)| {
            let pairs: Vec<_> = azimuths_of_ring(azimuths)
                .map(|phi| (wi, Direction::new(theta_o, phi)))
                .collect();
            let mut halves = [[DVec3::ZERO; LOBES]; 2];
            for (value, (_, wo)) in model.scatter_ring(&pairs).into_iter().zip(&pairs) {
                let forward = wo.phi.abs() / PI;
                for p in 0..LOBES {
                    let value = value[p] * (weight * step * theta_o.cos());
                    halves[0][p] += value * forward;
                    halves[1][p] += value * (1.0 - forward);
                }
            }
            halves
        };
        let rings: Vec<_> = inclinations(model, theta).par_iter().map(ring).collect();
        let lobes = model.lobes().map(Option::unwrap_or_default);
        let [f, b] = std::array::from_fn(|half| {
            let parts: [DVec3; LOBES] =
                std::array::from_fn(|p| rings.iter().map(|ring| ring[half][p]).sum());
            let mean = |of: &dyn Fn(usize) -> f64| {
                let weighted = (0..LOBES).map(|p| parts[p] * of(p)).sum();
                quotient(weighted, parts.iter().sum())
            };
            let alpha = mean(&|p| lobes[p].shift);
            let beta = mean(&|p| lobes[p].deviation.powi(2)).map(f64::sqrt);
            (parts.iter().sum::<DVec3>(), alpha, beta)
        });
        let excess = (f.0 + b.0).max(DVec3::ONE);
        Self {
            a_f: f.0 / excess,
            a_b: b.0 / excess,
            alpha_f: f.1,
            alpha_b: b.1,
            beta_f: f.2,
            beta_b: b.2,
        }
    }

    /// T_f and σ̄_f² of light that came through `fibres` fibres like this one, a number not negative and not always whole.
    pub fn forward(&self, fibres: f64, density: Density) -> Forward {
        if fibres <= 0.0 {
            return Forward {
                transmittance: DVec3::ONE,
                variance: DVec3::ZERO,
                scattered: false,
            };
        }
        Forward {
            transmittance: density.forward * self.a_f.map(|a| a.powf(fibres)),
            variance: self.beta_f * self.beta_f * fibres,
            scattered: true,
        }
    }

    /// Ā_b, Δ̄_b and σ̄_b of fibres like this one around the shaded one.
    pub fn local(&self, density: Density) -> Local {
        let channel = |c: usize| {
            let (a_f2, a_b) = (self.a_f[c] * self.a_f[c], self.a_b[c]);
            let loss = (1.0 - a_f2).max(MIN_LOSS);
            let (a_b2, a_b3) = (a_b * a_b, a_b * a_b * a_b);
            let back = a_b * a_f2 / loss + a_b3 * a_f2 / loss.powi(3);

            let of_b = 1.0 - 2.0 * a_b2 / (loss * loss);
            let of_f = (2.0 * loss * loss + 4.0 * a_f2 * a_b2) / loss.powi(3);
            let delta = self.alpha_b[c] * of_b + self.alpha_f[c] * of_f;

            let [f2, b2] = [self.beta_f[c], self.beta_b[c]].map(|beta| beta * beta);
            let once = (2.0 * f2 + b2).sqrt();
            let thrice = (2.0 * f2 + 3.0 * b2).sqrt();
            let spread = (once + a_b2 * thrice) / (1.0 + a_b2);
            [back, delta, (1.0 + density.backward * a_f2) * spread]
        };
        let channels = [channel(0), channel(1), channel(2)];
        let value = |k: usize| DVec3::from_array(channels.map(|channel| channel[k]));
        Local {
            a_b: value(0),
            delta_b: value(1),
            sigma_b: value(2),
        }
    }
}

/// T_f and σ̄_f² of light that came through these fibres, each with the averages of its own inclination.
pub fn forward_through(fibres: &[Averages], density: Density) -> Forward {
    if fibres.is_empty() {
        return Averages::default().forward(0.0, density);
    }
    Forward {
        transmittance: density.forward * fibres.iter().map(|fibre| fibre.a_f).product::<DVec3>(),
        variance: fibres.iter().map(|fibre| fibre.beta_f * fibre.beta_f).sum(),
        scattered: true,
    }
}

/// A Gaussian of unit integral a channel; `variance` above 0.
fn gaussian_of(variance: DVec3, x: DVec3) -> DVec3 {
    let exponent = -(x * x) / (2.0 * variance);
    exponent.map(f64::exp) / (TAU * variance).map(f64::sqrt)
}

impl Local {
    /// What the fibres around send back of light from ω_i, times cos θ_i: `2 Ā_b g(θ_i + θ_o - Δ̄_b, σ̄_b²) s̃_b / cos² θ_d`,
    /// with s̃_b = 1/π for exits on the light's side and 0 on the other. Its albedo is 2 Ā_b, as published: a fibre seen
    /// from the light's side stands for those behind it too.
    pub fn scatter(&self, wi: Direction, wo: Direction) -> DVec3 {
        let pair = Pair::new(wi, wo);
        if pair.phi.abs() > FRAC_PI_2 {
            return DVec3::ZERO;
        }
        let variance = (self.sigma_b * self.sigma_b).max(DVec3::splat(1e-12));
        let off = DVec3::splat(wi.theta + wo.theta) - self.delta_b;
        2.0 / PI * self.a_b * gaussian_of(variance, off) * pair.cosine_factor(wi)
    }
}

/// All the light that leaves towards ω_o of light from ω_d that came through other fibres (or none), times cos θ_d:
///
/// `T_f ∫ S_f(ω_d, ω_i) [scatter(ω_i, ω_o) + d_b back(ω_i, ω_o)] dω_i`
///
/// S_f is a Gaussian of variance σ̄_f² around θ_d, evenly spread over the half of the azimuths around φ_d, of unit
/// integral. The integral takes `nodes`² directions a channel; the model is evaluated at every one.
pub fn scatter(
    model: &impl FibreModel,
    wd: Direction,
    wo: Direction,
    forward: &Forward,
    local: &Local,
    density: Density,
    nodes: usize,
) -> DVec3 {
    let whole = |wi: Direction| model.scatter(wi, wo) + density.backward * local.scatter(wi, wo);
    if !forward.scattered {
        return forward.transmittance * whole(wd);
    }
    let rings = nodes.div_ceil(SIXTEEN.len());
    let channel = |c: usize| {
        let deviation = forward.variance[c].sqrt().max(1e-6);
        let [low, high] =
            [-6.0, 6.0].map(|k| (wd.theta + k * deviation).clamp(-FRAC_PI_2, FRAC_PI_2));
        let (mut sum, mut norm) = (0.0, 0.0);
        for (theta, weight) in panels(&SIXTEEN, low, high, rings) {
            let off = (theta - wd.theta) / deviation;
            let weight = weight * theta.cos() * (-0.5 * off * off).exp();
            for i in 0..nodes {
                let phi = wd.phi + PI * ((i as f64 + 0.5) / nodes as f64 - 0.5);
                sum += weight * whole(Direction::new(theta, phi))[c];
            }
            norm += weight * nodes as f64;
        }
        if norm > 0.0 { sum / norm } else { 0.0 }
    };
    forward.transmittance * DVec3::new(channel(0), channel(1), channel(2))
}
