//! When the TT lobe may be left out: an upper bound of what it adds where no light stands behind the hair.
//!
//! With the angle between the ways to the light and to the eye at most `a`, a lobe's value is at most
//!
//! `B(a) = max over θ_i, θ_o of M_max(θ_i, θ_o) N_max(θ, φ_max)`, `cos φ_max = (cos a - sin θ_i sin θ_o) / (cos θ_i cos θ_o)`,
//!
//! and its radiance at most the light's irradiance times that. θ_i and θ_o are taken by cells, and each factor as its greatest value in
//! the cell; N_max is a sum over intervals of γ_i of the greatest attenuation times the greatest density that exits of that interval
//! have at any azimuth up to φ_max. All of them are bounds, not samples: what is left out is never more than they say.

use glam::{DVec3, DVec4};
use std::f64::consts::{FRAC_PI_2, PI};

use super::angles::i0e;

/// Angles of the table, from 0 to π.
const ANGLES: usize = 48;
/// Cells of each inclination from -π/2 to π/2.
const CELLS: usize = 64;
/// Rows of |θ| for what happens around the fibre.
const ROWS: usize = 32;
/// Azimuths up to which it is bounded.
const AZIMUTHS: usize = 48;
/// Intervals of γ_i from 0 to π/2.
const RAYS: usize = 32;
/// Values are found in single precision, and integrals by intervals: 4e-4 of the peak.
const SLACK: f64 = 1.01;

/// A lobe along the fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Along {
    /// d'Eon's, of variance v, the view tilted.
    Chiang { v: f64, tilt: f64 },
    /// A Gaussian of this height in θ_i + θ_o, over cos² θ_d.
    Gaussian {
        shift: f64,
        deviation: f64,
        height: f64,
    },
}

/// A lobe around the fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Around {
    /// What a cylinder transmits, blurred by a logistic of scale `s` or not at all; the θ of the view or θ_d.
    Cylinder {
        eta: f64,
        sigma_a: f64,
        s: Option<f64>,
        of_view: bool,
        /// Distance in γ_i at which the integral across the fibre is taken.
        ray_step: f64,
    },
    /// A Gaussian of unit height around π.
    Gaussian { width: f64 },
}

/// The TT lobe as a model has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lobe {
    pub along: Along,
    pub around: Around,
    /// Azimuth and inclination between which tables are interpolated; 0 without.
    pub table_step: f64,
}

/// B at ANGLES angles.
pub(crate) type Bound = [f32; ANGLES];

/// The bounds of the last lobes that were asked for.
#[derive(Default)]
pub(crate) struct Bounds(Vec<(Lobe, Bound)>);

/// Lobes whose bounds are kept.
const KEPT: usize = 32;

impl Bounds {
    /// The bound of a lobe, found once.
    pub fn of(&mut self, lobe: &Lobe) -> &Bound {
        let at = match self.0.iter().position(|(held, _)| held == lobe) {
            Some(at) => at,
            None => {
                if self.0.len() == KEPT {
                    self.0.remove(0);
                }
                self.0.push((*lobe, lobe.bound()));
                self.0.len() - 1
            }
        };
        &self.0[at].1
    }
}

/// B(a), rounded up to the next angle of the table.
pub(crate) fn look_up(bound: &Bound, angle: f64) -> f32 {
    let at = (angle / PI * (ANGLES - 1) as f64).ceil();
    bound[(at.max(0.0) as usize).min(ANGLES - 1)]
}

/// The least and the greatest cosine of a range within ±π/2.
fn cosines(range: [f64; 2]) -> [f64; 2] {
    let (a, b) = (range[0].cos().max(0.0), range[1].cos().max(0.0));
    let most = if range[0] <= 0.0 && range[1] >= 0.0 {
        1.0
    } else {
        a.max(b)
    };
    [a.min(b), most]
}

/// The range of |x|.
fn sizes(range: [f64; 2]) -> [f64; 2] {
    let (a, b) = (range[0].abs(), range[1].abs());
    if range[0] <= 0.0 && range[1] >= 0.0 {
        [0.0, a.max(b)]
    } else {
        [a.min(b), a.max(b)]
    }
}

impl Along {
    /// The greatest value times cos θ_i in a cell.
    fn most(&self, theta_i: [f64; 2], theta_o: [f64; 2]) -> f64 {
        match *self {
            Self::Chiang { v, tilt } => {
                let view = [theta_o[0] + tilt, theta_o[1] + tilt];
                // Tilted past ±π/2 the function is that of the supplementary angle: both branches.
                let branches = [
                    view,
                    [PI - view[1], PI - view[0]],
                    [-PI - view[1], -PI - view[0]],
                ];
                let one = |view: [f64; 2]| {
                    let view = [view[0].max(-FRAC_PI_2), view[1].min(FRAC_PI_2)];
                    if view[0] > view[1] {
                        return 0.0;
                    }
                    let a = cosines(theta_i)[0] * cosines(view)[0] / v;
                    let sum = sizes([theta_i[0] + view[0], theta_i[1] + view[1]])[0];
                    let sin_h = (0.5 * sum.min(PI)).sin();
                    i0e(a) * (-2.0 * sin_h * sin_h / v).exp() / (v * -(-2.0 / v).exp_m1())
                };
                branches.into_iter().map(one).fold(0.0, f64::max)
            }
            Self::Gaussian {
                shift,
                deviation,
                height,
            } => {
                let off = sizes([
                    theta_i[0] + theta_o[0] - shift,
                    theta_i[1] + theta_o[1] - shift,
                ])[0];
                let half = [
                    0.5 * (theta_o[0] - theta_i[1]),
                    0.5 * (theta_o[1] - theta_i[0]),
                ];
                let cos_d = cosines(half)[0].max(0.01);
                let t = off / deviation;
                height * (-0.5 * t * t).exp() * cosines(theta_i)[1] / (cos_d * cos_d)
            }
        }
    }
}

fn fresnel(eta: f64, cosine: f64) -> f64 {
    let c = cosine.clamp(0.0, 1.0);
    let c_t = (eta * eta - 1.0 + c * c).sqrt() / eta;
    0.5 * (((c - eta * c_t) / (c + eta * c_t)).powi(2)
        + ((eta * c - c_t) / (eta * c + c_t)).powi(2))
}

impl Around {
    /// The greatest value at |θ| within a range and azimuths from the light up to `phi`.
    fn most(&self, theta: [f64; 2], phi: f64) -> f64 {
        let (eta, sigma_a, s, ray_step) = match *self {
            Self::Gaussian { width } => return (-0.5 * ((PI - phi) / width).powi(2)).exp(),
            Self::Cylinder {
                eta,
                sigma_a,
                s,
                ray_step,
                ..
            } => (eta, sigma_a, s, ray_step),
        };
        let bravais = |theta: f64| {
            let cosine = theta.cos().max(1e-9);
            (eta * eta - 1.0 + cosine * cosine).sqrt() / cosine
        };
        let [least_index, greatest_index] = theta.map(bravais);
        let cos_theta = theta[0].cos();
        let cos_theta_t = (eta * eta - theta[0].sin().powi(2)).sqrt() / eta;
        // How far rays are turned from straight on: more for greater γ_i, and for greater indices.
        let turn = |gamma: f64, index: f64| 2.0 * (gamma - (gamma.sin() / index).asin());
        let density = |x: f64, s: f64| {
            let e = (-x.abs() / s).exp();
            e / (s * (1.0 + e) * (1.0 + e) * (PI / (2.0 * s)).tanh())
        };
        let mut sum = 0.0;
        let mut most = 0.0f64;
        for ray in 0..RAYS {
            let [from, to] = [ray, ray + 1].map(|i| FRAC_PI_2 * i as f64 / RAYS as f64);
            // What lies within one of the shader's steps too, between which it interpolates.
            let beyond = (to + ray_step).min(FRAC_PI_2);
            let before = (from - ray_step).max(0.0);
            let f = fresnel(eta, cos_theta * before.cos());
            let cos_gamma_t = (1.0 - (beyond.sin() / least_index).powi(2)).max(0.0).sqrt();
            let passed = (1.0 - f).powi(2) * (-2.0 * sigma_a * cos_gamma_t / cos_theta_t).exp();
            let turned = [turn(before, least_index), turn(beyond, greatest_index)];
            match s {
                Some(s) => {
                    // Exits at π ∓ turn, and the nearest that azimuths up to φ come to them, over the wraps.
                    let ahead = (PI - turned[1] - phi).max(0.0);
                    let behind = (PI - turned[1]).min(PI + turned[0] - phi).max(0.0);
                    let weight = 0.5 * (to.sin() - from.sin());
                    sum += weight * passed * (density(ahead, s) + density(behind, s));
                }
                None if turned[1] >= PI - phi => {
                    // ½ A cos γ / |dφ/dγ|.
                    let ratio = before.cos()
                        / (least_index * (1.0 - (before.sin() / least_index).powi(2)).sqrt());
                    let slope = (2.0 * (1.0 - ratio)).max(1e-6);
                    most = most.max(0.5 * passed * before.cos() / slope);
                }
                None => {}
            }
        }
        if s.is_some() { sum } else { most }
    }

    fn of_view(&self) -> bool {
        matches!(self, Self::Cylinder { of_view: true, .. })
    }
}

impl Lobe {
    /// B at every angle.
    pub fn bound(&self) -> Bound {
        let step = PI / CELLS as f64;
        // A row reaches over the tables' neighbours, and cells that straddle two rows take the greater.
        let row_step = FRAC_PI_2 / ROWS as f64;
        let reach = row_step.max(self.table_step);
        let around: Vec<[f64; AZIMUTHS + 1]> = (0..ROWS)
            .map(|row| {
                let low = (row as f64 * row_step - reach).max(0.0);
                let high = ((row + 1) as f64 * row_step + reach).min(FRAC_PI_2);
                std::array::from_fn(|i| {
                    let phi = PI * i as f64 / AZIMUTHS as f64 + self.table_step;
                    self.around.most([low, high], phi.min(PI))
                })
            })
            .collect();
        let cell = |i: usize| [0, 1].map(|end| step * (i + end) as f64 - FRAC_PI_2);
        let mut bound = [0.0f64; ANGLES];
        for i in 0..CELLS {
            let theta_i = cell(i);
            for o in 0..CELLS {
                let theta_o = cell(o);
                let along = self.along.most(theta_i, theta_o);
                let theta = if self.around.of_view() {
                    sizes(theta_o)
                } else {
                    sizes([
                        0.5 * (theta_o[0] - theta_i[1]),
                        0.5 * (theta_o[1] - theta_i[0]),
                    ])
                };
                let [first, last] =
                    theta.map(|t| ((t / row_step - 1e-9).max(0.0) as usize).min(ROWS - 1));
                let (cos_i, cos_o) = (cosines(theta_i), cosines(theta_o));
                let corners = [0, 1, 2, 3].map(|c| theta_i[c & 1].sin() * theta_o[c >> 1].sin());
                let product = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
                for (angle, bound) in bound.iter_mut().enumerate() {
                    let cosine = (PI * angle as f64 / (ANGLES - 1) as f64).cos();
                    let rest = cosine - product;
                    let across = if rest > 0.0 {
                        cos_i[1] * cos_o[1]
                    } else {
                        cos_i[0] * cos_o[0]
                    };
                    if rest > across && rest > 0.0 {
                        continue;
                    }
                    let phi = (rest / across.max(1e-12)).clamp(-1.0, 1.0).acos();
                    let at = ((phi / PI * AZIMUTHS as f64).ceil() as usize).min(AZIMUTHS);
                    for row in &around[first..=last] {
                        *bound = bound.max(along * row[at]);
                    }
                }
            }
        }
        // Never rounded to 0, which single precision would make of the smallest.
        let [least, most] = [f32::MIN_POSITIVE, f32::MAX].map(f64::from);
        bound.map(|value| (value * SLACK).clamp(least, most) as f32)
    }
}

/// The greatest angle between the ways to a light and to the eye from anywhere in a sphere; both are points (w = 1) or directions.
/// π where one of them lies inside.
pub(crate) fn greatest_angle(centre: DVec3, radius: f64, light: DVec4, eye: DVec4) -> f64 {
    let way = |place: DVec4| place.truncate() - centre * place.w;
    let mut angle = way(light).angle_between(way(eye));
    for place in [light, eye] {
        if place.w > 0.0 {
            let distance = way(place).length();
            if distance <= radius {
                return PI;
            }
            angle += (radius / distance).asin();
        }
    }
    angle.min(PI)
}
