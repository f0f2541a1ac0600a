//! The K nearest scattering events along a light's ray (Yu et al. 2012, §3.1).
//!
//! Equation 3: the light that reaches a point is the product, over the events before it, of `A C + (1 - C)`, C being an
//! event's opacity × coverage. A is the *transmitted* part, which the paper's wording leaves open: 0 for a fibre whose
//! opacity says all, or what Fresnel's reflection and absorption leave of light that goes straight through,
//! `½ ∫ (1 - F)² exp(-2 σ_a cos γ_t / cos θ_t) dh` over the offsets h from -1 to 1.

use crate::quadrature;

/// What one fibre leaves in a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Distance along the light's ray, in any unit.
    pub depth: f64,
    /// Opacity × coverage, from 0 to 1.
    pub opacity: f64,
    /// The angle between the light and the fibre's normal plane, from 0 to π/2.
    pub inclination: f64,
}

/// A fibre's surface and inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Index of refraction, above 1.
    pub eta: f64,
    /// Absorption per fibre radius.
    pub sigma_a: f64,
}

/// Reflectance of unpolarised light, by the cosine of its angle to the surface's normal.
fn reflectance(cos_i: f64, eta: f64) -> f64 {
    let sin_t = (1.0 - cos_i * cos_i).max(0.0).sqrt() / eta;
    let cos_t = (1.0 - sin_t * sin_t).max(0.0).sqrt();
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// The part of the light that goes straight through a fibre, averaged over its width.
pub fn transmitted(optics: &Optics, inclination: f64) -> f64 {
    let Optics { eta, sigma_a } = *optics;
    let (sin, cos) = inclination.sin_cos();
    let cos_theta_t = (1.0 - (sin / eta).powi(2)).sqrt();
    let eta_perpendicular = (eta * eta - sin * sin).sqrt() / cos.max(1e-12);
    // h = sin γ, so that the reflectance's rise at the rim is smooth in the variable of integration.
    let half = std::f64::consts::FRAC_PI_2;
    quadrature::on(&quadrature::SIXTEEN, 0.0, half)
        .map(|(gamma, weight)| {
            let passed = 1.0 - reflectance(cos * gamma.cos(), eta);
            let sin_gamma_t = gamma.sin() / eta_perpendicular;
            let path = 2.0 * (1.0 - sin_gamma_t * sin_gamma_t).sqrt() / cos_theta_t;
            weight * gamma.cos() * passed * passed * (-sigma_a * path).exp()
        })
        .sum()
}

/// The part of the light left at a depth. `events` are all of a ray, nearest first, of which the first `k` are kept; with
/// `tail` the optical depth of the others is spread evenly from the last one that is kept to the last of all. `None` for
/// `optics`: opacity says all.
pub fn transmittance(
    events: &[Event],
    k: usize,
    tail: bool,
    optics: Option<&Optics>,
    depth: f64,
) -> f64 {
    let kept = &events[..k.min(events.len())];
    let passes = |event: &Event| {
        let a = optics.map_or(0.0, |optics| transmitted(optics, event.inclination));
        1.0 - event.opacity * (1.0 - a)
    };
    let before = kept.iter().take_while(|event| event.depth < depth);
    let left: f64 = before.map(passes).product();
    let rest = &events[kept.len()..];
    let (Some(first), Some(last)) = (kept.last(), rest.last()) else {
        return left;
    };
    if !tail || depth <= first.depth {
        return left;
    }
    let optical_depth: f64 = rest.iter().map(|event| -passes(event).ln()).sum();
    let part = (depth - first.depth) / (last.depth - first.depth).max(1e-30);
    left * (-optical_depth * part.min(1.0)).exp()
}
