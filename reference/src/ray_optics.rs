//! Monte Carlo ray optics of a smooth dielectric cylinder of elliptic cross-section, in three dimensions.
//!
//! Parallel rays of one direction, evenly spread over the width that the cylinder shows them, are traced by Snell's law
//! in space; at every hit the weight is split by the unpolarised Fresnel reflectance, and on every way through it is
//! absorbed by `exp(-σ_a · length)`. A path leaves as R (p = 0) or after p crossings; all its light keeps |θ|, so what
//! is left to find is its azimuth. No approximation beyond ray optics, depolarised at every hit, is made.

use crate::fresnel::fresnel;
use crate::random::unit;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Paths that are told apart: R, TT, TRT, TRRT.
pub const PATHS: usize = 4;

/// Rays are traced in this many groups, whose sums are added in order: the result does not depend on the threads.
const GROUPS: usize = 256;

/// The cylinder, its light and the histogram that is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayOptics {
    /// Index of refraction, above 1.
    pub eta: f64,
    /// Absorption per unit of length.
    pub sigma_a: f64,
    /// Half axes of the cross-section, along φ = 0 and φ = π/2, in units of length, above 0.
    pub semi_axes: DVec2,
    /// Inclination of the direction to the light, |θ_i| < π/2.
    pub theta_i: f64,
    /// Azimuth of the direction to the light.
    pub phi_i: f64,
    /// How many rays.
    pub rays: usize,
    /// Bins of the histogram, over φ_o - φ_i in [-π, π].
    pub bins: usize,
    /// Same seed, same rays.
    pub seed: u64,
}

/// Where the light went.
#[derive(Debug, Clone, PartialEq)]
pub struct Scattered {
    /// N_p of every bin and path, per radian: the integral over φ and sum over p is 1 without absorption.
    pub n_p: Vec<[f64; PATHS]>,
    /// The part of the light of each path.
    pub energy: [f64; PATHS],
    /// The greatest |sin θ_o + sin θ_i| of any path: rounding alone.
    pub cone_error: f64,
}

/// The sums of one group of rays.
struct Sums {
    weights: Vec<[f64; PATHS]>,
    energy: [f64; PATHS],
    cone_error: f64,
}

impl RayOptics {
    /// The outward unit normal at a point of the surface.
    fn normal(&self, point: DVec3) -> DVec3 {
        let squares = self.semi_axes * self.semi_axes;
        DVec3::new(0.0, point.y / squares.x, point.z / squares.y).normalize()
    }

    /// Where rays of one direction, `offset` in [-1, 1] of the half width seen off the axis, meet the cylinder first.
    fn entry(&self, direction: DVec3, offset: f64) -> DVec3 {
        // Scaled by the half axes the section is a unit circle, and the offset is that of the circle.
        let across = DVec2::new(direction.y, direction.z) / self.semi_axes;
        let along = across.normalize();
        let back = (1.0 - offset * offset).max(0.0).sqrt();
        let hit = (along.perp() * offset - along * back) * self.semi_axes;
        DVec3::new(0.0, hit.x, hit.y)
    }

    /// The length of the way from a point of the surface through the inside, along a unit direction.
    fn way_through(&self, point: DVec3, direction: DVec3) -> f64 {
        let p = DVec2::new(point.y, point.z) / self.semi_axes;
        let d = DVec2::new(direction.y, direction.z) / self.semi_axes;
        (-2.0 * p.dot(d) / d.length_squared()).max(0.0)
    }

    /// Calls `leave(p, direction, weight)` for every path of one ray.
    fn trace(&self, offset: f64, mut leave: impl FnMut(usize, DVec3, f64)) {
        let (sin_theta, cos_theta) = self.theta_i.sin_cos();
        let to_light = DVec3::new(
            sin_theta,
            cos_theta * self.phi_i.cos(),
            cos_theta * self.phi_i.sin(),
        );
        let mut direction = -to_light;
        let mut point = self.entry(direction, offset);

        let normal = self.normal(point);
        let cos = -direction.dot(normal);
        let f = fresnel(self.eta, cos).unpolarised();
        leave(0, direction + normal * (2.0 * cos), f);
        let cos_t = (1.0 - (1.0 - cos * cos) / (self.eta * self.eta)).sqrt();
        direction = direction / self.eta + normal * (cos / self.eta - cos_t);
        let mut weight = 1.0 - f;

        for p in 1..PATHS {
            let length = self.way_through(point, direction);
            point += direction * length;
            point.x = 0.0;
            weight *= (-self.sigma_a * length).exp();
            let normal = self.normal(point);
            let cos = direction.dot(normal);
            let f = fresnel(1.0 / self.eta, cos).unpolarised();
            let sin2_t = self.eta * self.eta * (1.0 - cos * cos);
            if sin2_t < 1.0 {
                let out = direction * self.eta + normal * ((1.0 - sin2_t).sqrt() - self.eta * cos);
                leave(p, out, weight * (1.0 - f));
            }
            direction -= normal * (2.0 * cos);
            weight *= f;
        }
    }

    fn group(&self, rays: std::ops::Range<usize>) -> Sums {
        let mut sums = Sums {
            weights: vec![[0.0; PATHS]; self.bins],
            energy: [0.0; PATHS],
            cone_error: 0.0,
        };
        let sin_theta_i = self.theta_i.sin();
        for ray in rays {
            // One ray at a random place of each of as many equal strips.
            let strip = ray as f64 + unit(self.seed, ray as u64);
            let offset = 2.0 * strip / self.rays as f64 - 1.0;
            self.trace(offset, |p, out, weight| {
                let phi = crate::fibre::wrap_to_pi(out.z.atan2(out.y) - self.phi_i);
                let bin = ((phi + PI) / TAU * self.bins as f64) as usize;
                sums.weights[bin.min(self.bins - 1)][p] += weight;
                sums.energy[p] += weight;
                sums.cone_error = sums.cone_error.max((out.x + sin_theta_i).abs());
            });
        }
        sums
    }

    /// Traces all rays.
    pub fn run(&self) -> Scattered {
        let edge = |group: usize| group * self.rays / GROUPS;
        let groups: Vec<Sums> = (0..GROUPS)
            .into_par_iter()
            .map(|group| self.group(edge(group)..edge(group + 1)))
            .collect();
        let per_bin = self.bins as f64 / (TAU * self.rays as f64);
        let mut scattered = Scattered {
            n_p: vec![[0.0; PATHS]; self.bins],
            energy: [0.0; PATHS],
            cone_error: 0.0,
        };
        for sums in groups {
            for p in 0..PATHS {
                for (n, weight) in scattered.n_p.iter_mut().zip(&sums.weights) {
                    n[p] += weight[p] * per_bin;
                }
                scattered.energy[p] += sums.energy[p] / self.rays as f64;
            }
            scattered.cone_error = scattered.cone_error.max(sums.cone_error);
        }
        scattered
    }
}
