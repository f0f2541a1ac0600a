//! What a fibre returns of uniform light, and where light from one direction goes: integrals over the sphere.
//!
//! `furnace(ω_o) = ∫ scatter(ω_i, ω_o) dω_i`, `albedo(ω_i) = ∫ scatter(ω_i, ω_o) cos θ_o / cos θ_i dω_o`
//!
//! In white surroundings the first is the radiance seen; the second is the part of the light that is scattered, at most 1
//! in nature. A reciprocal model has both equal. Inclinations are integrated by Gauss-Legendre panels around each lobe,
//! azimuths by midpoints, which converge fast for smooth periodic functions; a caustic needs many.

use crate::fibre::{Direction, FibreModel, LOBES, MIN_COS_THETA_D};
use crate::quadrature::{EIGHT, on};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes and weights for inclinations in [-π/2, π/2] against one at `theta`: panels shrink towards each lobe's centre.
pub(crate) fn inclinations(model: &impl FibreModel, theta: f64) -> Vec<(f64, f64)> {
    let lobes = || model.lobes().into_iter().flatten();
    let mut ends: Vec<f64> = (-3..=3).map(|i| FRAC_PI_2 * f64::from(i) / 4.0).collect();
    for lobe in lobes() {
        // A lobe tilted past the tangent lies at the supplementary angle (Chiang).
        let centre = lobe.shift - theta;
        for centre in [centre, PI.copysign(centre) - centre] {
            let steps = [0.0, 2.0, 4.0, 8.0, 16.0].map(|k| k * lobe.deviation);
            ends.extend(steps.iter().flat_map(|step| [centre + step, centre - step]));
        }
    }
    let corner = 2.0 * MIN_COS_THETA_D.acos();
    ends.extend([theta - corner, theta + corner]);
    ends.retain(|&e| e > -FRAC_PI_2 && e < FRAC_PI_2);
    ends.sort_by(f64::total_cmp);
    let finest = lobes().map(|lobe| lobe.deviation).fold(0.1, f64::min);
    ends.dedup_by(|b, a| *b - *a < 0.25 * finest);
    ends.insert(0, -FRAC_PI_2);
    ends.push(FRAC_PI_2);
    ends.windows(2)
        .flat_map(|ends| on(&EIGHT, ends[0], ends[1]))
        .collect()
}

/// Midpoints of `azimuths` equal parts of [-π, π].
pub(crate) fn azimuths_of_ring(azimuths: usize) -> impl Iterator<Item = f64> {
    (0..azimuths).map(move |i| TAU * ((i as f64 + 0.5) / azimuths as f64 - 0.5))
}

/// Σ over the sphere of the lobes of the pairs of `pair(direction)`, weighted by the solid angle and by `factor(θ)`.
fn over_sphere(
    model: &impl FibreModel,
    inclinations: &[(f64, f64)],
    azimuths: usize,
    pair: impl Fn(Direction) -> (Direction, Direction) + Sync,
    factor: impl Fn(Direction) -> f64 + Sync,
) -> [DVec3; LOBES] {
    let ring = |&(theta, weight): &(f64, f64)| {
        let pairs: Vec<_> = azimuths_of_ring(azimuths)
            .map(|phi| pair(Direction::new(theta, phi)))
            .collect();
        let mut sum = [DVec3::ZERO; LOBES];
        for lobes in model.scatter_ring(&pairs) {
            for (sum, lobe) in sum.iter_mut().zip(lobes) {
                *sum += lobe;
            }
        }
        let direction = Direction::new(theta, 0.0);
        let step = TAU / azimuths as f64;
        sum.map(|lobe| lobe * (weight * step * direction.cos_theta() * factor(direction)))
    };
    // Rings are added in their order, so that the sum does not depend on the threads.
    let rings: Vec<[DVec3; LOBES]> = inclinations.par_iter().map(ring).collect();
    std::array::from_fn(|p| rings.iter().map(|ring| ring[p]).sum())
}

/// `∫ scatter(ω_i, ω_o) dω_i` of every lobe, with this many azimuths.
pub fn furnace_lobes(model: &impl FibreModel, wo: Direction, azimuths: usize) -> [DVec3; LOBES] {
    let inclinations = inclinations(model, wo.theta);
    over_sphere(model, &inclinations, azimuths, |wi| (wi, wo), |_| 1.0)
}

/// `∫ scatter(ω_i, ω_o) dω_i`: the radiance seen in white surroundings.
pub fn furnace(model: &impl FibreModel, wo: Direction, azimuths: usize) -> DVec3 {
    furnace_lobes(model, wo, azimuths).into_iter().sum()
}

/// `∫ scatter(ω_i, ω_o) cos θ_o / cos θ_i dω_o`: the part of the light that is scattered, for |θ_i| < π/2.
pub fn albedo(model: &impl FibreModel, wi: Direction, azimuths: usize) -> DVec3 {
    let inclinations = inclinations(model, wi.theta);
    let ratio = |wo: Direction| wo.cos_theta() / wi.cos_theta();
    let lobes = over_sphere(model, &inclinations, azimuths, |wo| (wi, wo), ratio);
    lobes.into_iter().sum()
}
