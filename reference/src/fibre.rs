//! What all models of a single fibre share: directions in the fibre's frame, lobes, ranges of parameters.
//!
//! The frame is (x, y, z) = (tangent from root to tip, first axis of the cross-section, second axis). A direction leaves
//! the fibre; θ in [-π/2, π/2] is its inclination from the normal plane, positive towards the tip; φ its azimuth from
//! the first axis. ω_i goes to the light, ω_o to the eye, and with φ = φ_o - φ_i
//!
//! `θ_h = (θ_i + θ_o) / 2`, `θ_d = (θ_o - θ_i) / 2`, `L_o = ∫ scatter(ω_i, ω_o) L_i dω_i`
//!
//! so `scatter` is the model's function times cos θ_i. Marschner et al., *Light Scattering from Human Hair Fibers*,
//! SIGGRAPH 2003.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

/// Reflection.
pub const R: usize = 0;
/// Transmission through both sides.
pub const TT: usize = 1;
/// Transmission with one reflection inside.
pub const TRT: usize = 2;
/// All longer paths together.
pub const RESIDUAL: usize = 3;
/// The number of lobes that a model may have.
pub const LOBES: usize = 4;

/// The least cos θ_d that `1 / cos² θ_d` is taken of, in the models that have that factor (Marschner, Sadeghi).
///
/// With one direction along the tangent and the other ε away from it on the other end, cos θ_i / cos² θ_d grows like
/// 4/ε. With this floor it is at most 2 / [`MIN_COS_THETA_D`]; nothing changes further than 0.58° from the tangent.
pub const MIN_COS_THETA_D: f64 = 0.01;

/// A parameter out of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// The parameter's name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The least and the greatest value allowed.
    pub range: [f64; 2],
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.range;
        write!(
            f,
            "{} {} is not within {low} to {high}",
            self.name, self.value
        )
    }
}

impl std::error::Error for OutOfRange {}

/// `Ok` if `value` lies in `range`; what is not a number does not.
pub(crate) fn within(name: &'static str, value: f64, range: [f64; 2]) -> Result<(), OutOfRange> {
    if value >= range[0] && value <= range[1] {
        Ok(())
    } else {
        Err(OutOfRange { name, value, range })
    }
}

/// The same for every channel.
pub(crate) fn all_within(
    name: &'static str,
    values: &[f64],
    range: [f64; 2],
) -> Result<(), OutOfRange> {
    values.iter().try_for_each(|&v| within(name, v, range))
}

/// An angle brought to [-π, π].
pub fn wrap_to_pi(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The Gaussian of unit integral, `exp(-x² / 2β²) / (β √2π)`, β > 0.
pub(crate) fn gaussian(beta: f64, x: f64) -> f64 {
    unit_gaussian(beta, x) / (beta * TAU.sqrt())
}

/// The Gaussian of unit height, `exp(-x² / 2β²)`, β > 0.
pub(crate) fn unit_gaussian(beta: f64, x: f64) -> f64 {
    let t = x / beta;
    (-0.5 * t * t).exp()
}

/// A direction that leaves the fibre, in the fibre's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// Inclination from the normal plane, in [-π/2, π/2], positive towards the tip.
    pub theta: f64,
    /// Azimuth from the section's first axis, radians; any multiple of 2π may be added.
    pub phi: f64,
}

impl Direction {
    /// From inclination and azimuth, in radians.
    pub fn new(theta: f64, phi: f64) -> Self {
        Self {
            theta: theta.clamp(-FRAC_PI_2, FRAC_PI_2),
            phi,
        }
    }

    /// From a vector of any length in the fibre's frame. Along the tangent the azimuth is 0; the null vector gives
    /// θ = φ = 0. θ is an arc tangent of two lengths, exact to the last bits up to ±π/2.
    pub fn from_vector(v: DVec3) -> Self {
        let across = v.y.hypot(v.z);
        Self {
            theta: v.x.atan2(across),
            phi: if across > 0.0 { v.z.atan2(v.y) } else { 0.0 },
        }
    }

    /// From a vector in the world, with the fibre's unit tangent and any vector that has a part along the section's first
    /// axis.
    pub fn in_frame(v: DVec3, tangent: DVec3, first_axis: DVec3) -> Self {
        let second = tangent.cross(first_axis).normalize_or_zero();
        let first = second.cross(tangent);
        Self::from_vector(DVec3::new(v.dot(tangent), v.dot(first), v.dot(second)))
    }

    /// The unit vector.
    pub fn to_vector(self) -> DVec3 {
        let (sin_theta, cos_theta) = self.theta.sin_cos();
        DVec3::new(
            sin_theta,
            cos_theta * self.phi.cos(),
            cos_theta * self.phi.sin(),
        )
    }

    /// cos θ, never negative.
    pub fn cos_theta(self) -> f64 {
        self.theta.cos().max(0.0)
    }
}

/// Half the sum and half the difference of a pair's inclinations, and the difference of its azimuths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    /// θ_h = (θ_i + θ_o) / 2.
    pub theta_h: f64,
    /// θ_d = (θ_o - θ_i) / 2.
    pub theta_d: f64,
    /// φ = φ_o - φ_i, in [-π, π].
    pub phi: f64,
    /// φ_h = (φ_i + φ_o) / 2, up to multiples of π.
    pub phi_h: f64,
}

impl Pair {
    pub fn new(wi: Direction, wo: Direction) -> Self {
        Self {
            theta_h: 0.5 * (wi.theta + wo.theta),
            theta_d: 0.5 * (wo.theta - wi.theta),
            phi: wrap_to_pi(wo.phi - wi.phi),
            phi_h: 0.5 * (wi.phi + wo.phi),
        }
    }

    /// cos θ_i / cos² θ_d: turns M_p N_p into `scatter`. See [`MIN_COS_THETA_D`].
    pub fn cosine_factor(&self, wi: Direction) -> f64 {
        let cos_theta_d = self.theta_d.cos().max(MIN_COS_THETA_D);
        wi.cos_theta() / (cos_theta_d * cos_theta_d)
    }
}

/// Where a lobe lies and how wide it is, in terms of θ_i + θ_o (twice θ_h): Marschner's 2 α_p and 2 β_p.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lobe {
    /// Mean of θ_i + θ_o, radians.
    pub shift: f64,
    /// Standard deviation of θ_i + θ_o, radians.
    pub deviation: f64,
}

/// A model of one fibre: three colour channels, lobes R, TT, TRT and residual (zero where a model lacks one).
pub trait FibreModel: Sync {
    /// Position and width of every lobe; `None` where the model lacks it.
    fn lobes(&self) -> [Option<Lobe>; LOBES];

    /// Every lobe's value, per steradian, times cos θ_i. Finite and not negative.
    fn scatter_lobes(&self, wi: Direction, wo: Direction) -> [DVec3; LOBES];

    /// [`FibreModel::scatter_lobes`] of pairs (ω_i, ω_o) that all have the first one's θ_i and θ_o: what does not depend
    /// on azimuths need be found once only.
    fn scatter_ring(&self, pairs: &[(Direction, Direction)]) -> Vec<[DVec3; LOBES]> {
        pairs
            .iter()
            .map(|&(wi, wo)| self.scatter_lobes(wi, wo))
            .collect()
    }

    /// The sum of the lobes: L_o = ∫ scatter · L_i dω_i.
    fn scatter(&self, wi: Direction, wo: Direction) -> DVec3 {
        self.scatter_lobes(wi, wo).into_iter().sum()
    }
}
