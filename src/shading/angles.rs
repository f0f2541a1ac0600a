//! Functions of one inclination that a model needs beside its lobes, in double precision, on the host, when its parameters
//! change: what it gives back of uniform light, the part of the light that it scatters, and the averages of dual scattering
//! (Zinke et al. 2008; Sadeghi and Tamstorf 2010).
//!
//! A model is here a sum over its lobes of a function along the fibre times one around it, so that
//! `∫ scatter dω = Σ_p ∫ along_p(θ_i, θ_o) [∫ around_p dφ] cos θ dθ`. Light and exit lie anywhere in their halves: an exit at φ
//! from the light counts by |φ|/π as forward and by the rest as backward.
//!
//! Two things are left out, and measured in the tests: that removing TRT's caustic moves a little of its light around the
//! fibre, and that an elliptic section does.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::fibre::DualScattering;

/// Rows of the table, the words of each; the same in WGSL.
pub(crate) const ANGLES: usize = 128;
/// Words a row.
pub(crate) const ANGLE_WORDS: usize = 24;

/// Rows of the azimuthal integrals over |θ| from 0 to π/2.
const ROWS: usize = 64;
/// Rays across the fibre.
const RAYS: usize = 96;
/// Equal parts of a logistic.
const QUANTILES: usize = 16;
/// Azimuths of Sadeghi's functions.
const AZIMUTHS: usize = 512;
/// The least cos θ_d that 1 / cos² θ_d is taken of; the same in WGSL.
const MIN_COS_THETA_D: f64 = 0.01;
/// The least 1 - ā_f² that is divided by.
const MIN_LOSS: f64 = 1e-9;

/// ∫ θ² cos θ dθ / ∫ cos θ dθ: the variance of inclination of light that comes from everywhere.
const ISOTROPIC_VARIANCE: f64 = PI * PI / 4.0 - 2.0;
/// How much of its decay a fibre light keeps where fibres lie in all directions: it goes round, by shorter ways than the light's
/// own, along which fibres are counted. Fitted to traced hair: `tests/shading/truth.rs`.
const DISORDERED_DECAY: f64 = 0.3;

/// Nodes and weights of eight-point Gauss-Legendre on [-1, 1], the positive half.
const EIGHT: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Mean and standard deviation of θ_i + θ_o.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lobe {
    pub shift: f64,
    pub deviation: f64,
}

/// A model's functions along the fibre.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Along {
    /// d'Eon's, of variance v, the view tilted.
    Chiang { v: [f64; 4], tilt: [f64; 4] },
    /// Gaussians in terms of θ_h over cos² θ_d: of half an area's unit, or of unit height.
    Gaussian {
        alpha: [f64; 3],
        beta: [f64; 3],
        unit_height: bool,
    },
}

/// ∫ around dφ of each lobe, forward and backward, by |θ|: the view's for Chiang, θ_d for Marschner.
#[derive(Debug, Clone)]
pub(crate) struct Around {
    rows: Vec<[[DVec3; 2]; 4]>,
    /// The θ of a row is the view's.
    of_view: bool,
}

/// A model as averages see it.
#[derive(Debug, Clone)]
pub(crate) struct Averaged {
    pub lobes: Vec<Lobe>,
    pub along: Along,
    pub around: Around,
    /// Factor of each lobe.
    pub scale: [DVec3; 4],
    /// Divided by the part that is scattered, where that is above 1.
    pub normalised: bool,
}

/// e^-x I_0(x), x ≥ 0 (Abramowitz and Stegun 9.8.1, 9.8.2): 2e-7.
pub(super) fn i0e(x: f64) -> f64 {
    let series = |t: f64, c: &[f64]| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if x < 3.75 {
        let small = [
            1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813,
        ];
        return series((x / 3.75).powi(2), &small) * (-x).exp();
    }
    let large = [
        0.39894228,
        0.01328592,
        0.00225319,
        -0.00157565,
        0.00916281,
        -0.02057706,
        0.02635537,
        -0.01647633,
        0.00392377,
    ];
    series(3.75 / x, &large) / x.sqrt()
}

impl Along {
    /// Lobe p's value times cos θ_i.
    fn value(&self, p: usize, theta_i: f64, theta_o: f64) -> f64 {
        match *self {
            Self::Chiang { v, tilt } => {
                let view = theta_o + tilt[p];
                let view = if view.abs() > FRAC_PI_2 {
                    PI.copysign(view) - view
                } else {
                    view
                };
                let a = (theta_i.cos() * view.cos()).max(0.0) / v[p];
                let sin_h = (0.5 * (theta_i + view)).sin();
                i0e(a) * (-2.0 * sin_h * sin_h / v[p]).exp() / (v[p] * -(-2.0 / v[p]).exp_m1())
            }
            Self::Gaussian {
                alpha,
                beta,
                unit_height,
            } => {
                let t = (0.5 * (theta_i + theta_o) - alpha[p]) / beta[p];
                let height = if unit_height {
                    1.0
                } else {
                    0.5 / (beta[p] * TAU.sqrt())
                };
                let cos_d = (0.5 * (theta_o - theta_i)).cos().max(MIN_COS_THETA_D);
                height * (-0.5 * t * t).exp() * theta_i.cos().max(0.0) / (cos_d * cos_d)
            }
        }
    }
}

/// The part by which an exit at this azimuth from the light counts as forward.
fn forwardness(phi: f64) -> f64 {
    (phi - TAU * (phi / TAU).round()).abs() / PI
}

impl Around {
    /// A round dielectric cylinder of unit radius, its exits blurred by a logistic of scale `s`, 0 for none; the residual of
    /// longer paths spread evenly.
    pub fn of_cylinder(eta: f64, sigma_a: DVec3, s: f64, of_view: bool) -> Self {
        let blur: Vec<f64> = if s > 0.0 {
            // x = 2 s atanh(u tanh(π / 2s)) has the trimmed logistic's distribution for u even on [-1, 1].
            (0..QUANTILES)
                .map(|q| {
                    let u = (2.0 * q as f64 + 1.0) / QUANTILES as f64 - 1.0;
                    2.0 * s * (u * (PI / (2.0 * s)).tanh()).atanh()
                })
                .collect()
        } else {
            vec![0.0]
        };
        let step = PI / RAYS as f64;
        let row = |number: usize| {
            let theta = FRAC_PI_2 * number as f64 / (ROWS - 1) as f64;
            let (sin_theta, cos_theta) = (theta.sin(), theta.cos().max(0.0));
            let root = (eta * eta - sin_theta * sin_theta).sqrt();
            let cos_theta_t = root / eta;
            let mut sums = [[DVec3::ZERO; 2]; 4];
            for ray in 0..RAYS {
                let gamma = step * (ray as f64 + 0.5) - FRAC_PI_2;
                // Midpoints of ½ cos γ sum to (step / 2) / sin(step / 2).
                let weight = gamma.cos() * (0.5 * step).sin();
                let sin_t = gamma.sin() * cos_theta / root;
                let gamma_t = sin_t.asin();
                let c = cos_theta * gamma.cos();
                let c_t = (eta * eta - 1.0 + c * c).sqrt() / eta;
                let f = 0.5
                    * (((c - eta * c_t) / (c + eta * c_t)).powi(2)
                        + ((eta * c - c_t) / (eta * c + c_t)).powi(2));
                let crossing = (sigma_a * (-2.0 * gamma_t.cos() / cos_theta_t)).map(f64::exp);
                let tt = (1.0 - f) * (1.0 - f) * crossing;
                let again = f * crossing;
                let rest = tt * again * again / (DVec3::ONE - again).max(DVec3::splat(1e-12));
                let parts = [DVec3::splat(f), tt, tt * again, rest];
                for (p, part) in parts.into_iter().enumerate() {
                    let exit = 2.0 * p as f64 * gamma_t - 2.0 * gamma + p as f64 * PI;
                    let forward = if p == 3 {
                        0.5
                    } else {
                        blur.iter().map(|x| forwardness(exit + x)).sum::<f64>() / blur.len() as f64
                    };
                    sums[p][0] += weight * forward * part;
                    sums[p][1] += weight * (1.0 - forward) * part;
                }
            }
            sums
        };
        Self {
            rows: (0..ROWS).map(row).collect(),
            of_view,
        }
    }

    /// Sadeghi's N′.
    pub fn of_sadeghi(tt_width: f64, glint: f64, glint_width: f64, angle: [f64; 2]) -> Self {
        let mut sums = [[DVec3::ZERO; 2]; 4];
        let bump = |x: f64, width: f64| (-0.5 * (x / width).powi(2)).exp();
        let mut add = |p: usize, phi: f64, value: f64| {
            // Both signs of φ.
            sums[p][0] += DVec3::splat(2.0 * value * phi / PI);
            sums[p][1] += DVec3::splat(2.0 * value * (1.0 - phi / PI));
        };
        let middle = 0.5 * (angle[0] + angle[1]);
        let step = PI / AZIMUTHS as f64;
        for i in 0..AZIMUTHS {
            let phi = step * (i as f64 + 0.5);
            add(0, phi, step * (0.5 * phi).cos());
            add(2, phi, step * (0.5 * phi).cos());
        }
        // Gaussians over the part of their reach that lies in [0, π].
        for (p, centre, width, height) in [(1, PI, tt_width, 1.0), (2, middle, glint_width, glint)]
        {
            let (low, high) = (
                (centre - 9.0 * width).max(0.0),
                (centre + 9.0 * width).min(PI),
            );
            let step = (high - low) / AZIMUTHS as f64;
            for i in 0..AZIMUTHS {
                let phi = low + step * (i as f64 + 0.5);
                add(p, phi, step * height * bump(phi - centre, width));
            }
        }
        Self {
            rows: vec![sums; 2],
            of_view: false,
        }
    }

    /// ∫ around dφ of each lobe at θ = 0.
    pub fn energies(&self) -> [DVec3; 4] {
        self.rows[0].map(|[forward, backward]| forward + backward)
    }

    fn at(&self, p: usize, theta_i: f64, theta_o: f64) -> [DVec3; 2] {
        let theta = if self.of_view {
            theta_o
        } else {
            0.5 * (theta_o - theta_i)
        };
        let last = self.rows.len() - 1;
        let y = (theta.abs() / FRAC_PI_2).min(1.0) * last as f64;
        let row = (y as usize).min(last - 1);
        let (low, high) = (self.rows[row][p], self.rows[row + 1][p]);
        [0, 1].map(|half| low[half].lerp(high[half], y - row as f64))
    }
}

impl Averaged {
    /// Inclinations and weights for lobe p against one at `theta`: panels that shrink towards the lobe's centre.
    fn nodes(&self, p: usize, theta: f64, each: &mut dyn FnMut(f64, f64)) {
        let Lobe { shift, deviation } = self.lobes[p];
        let centre = shift - theta;
        let folded = PI.copysign(centre) - centre;
        let mut ends: Vec<f64> = (0..=4).map(|i| PI * (f64::from(i) / 4.0 - 0.5)).collect();
        for middle in [centre, folded] {
            for k in [0.0, 2.0, 4.0, 8.0] {
                ends.extend([middle - k * deviation, middle + k * deviation]);
            }
        }
        ends.retain(|e| e.abs() <= FRAC_PI_2);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|b, a| *b - *a < 1e-12);
        for pair in ends.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (x, weight) in EIGHT {
                each(middle - half * x, half * weight);
                each(middle + half * x, half * weight);
            }
        }
    }

    /// ∫ scatter dω_i at a view's inclination; each lobe divided by `divisor`.
    fn uniform(&self, theta_o: f64, divisor: &dyn Fn(f64, f64) -> DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for p in 0..self.lobes.len() {
            self.nodes(p, theta_o, &mut |theta_i, weight| {
                let value = self.along.value(p, theta_i, theta_o) * theta_i.cos() * weight;
                let [forward, backward] = self.around.at(p, theta_i, theta_o);
                let whole = self.scale[p] * (forward + backward);
                sum += value * whole / divisor(theta_i, theta_o);
            });
        }
        sum
    }

    /// ã_f, β̄_f², Ā_b, Δ̄_b, σ̄_b at a light's inclination; see [`DualScattering`].
    fn dual(
        &self,
        theta_i: f64,
        dual: &DualScattering,
        divisor: &dyn Fn(f64, f64) -> DVec3,
    ) -> [DVec3; 5] {
        // Sums over lobes of the part, and of the part times shift and variance; forward and backward.
        let mut sums = [[DVec3::ZERO; 3]; 2];
        for (p, lobe) in self.lobes.iter().enumerate() {
            let mut parts = [DVec3::ZERO; 2];
            self.nodes(p, theta_i, &mut |theta_o, weight| {
                let value = self.along.value(p, theta_i, theta_o) * theta_o.cos() * weight;
                let halves = self.around.at(p, theta_i, theta_o);
                let scale = self.scale[p] * value / divisor(theta_i, theta_o);
                for half in 0..2 {
                    parts[half] += halves[half] * scale;
                }
            });
            for half in 0..2 {
                sums[half][0] += parts[half];
                sums[half][1] += parts[half] * lobe.shift;
                sums[half][2] += parts[half] * lobe.deviation.powi(2);
            }
        }
        let excess = (sums[0][0] + sums[1][0]).max(DVec3::ONE);
        let mean = |sum: DVec3, parts: DVec3| {
            DVec3::from_array(std::array::from_fn(|c| {
                if parts[c] > 0.0 {
                    sum[c] / parts[c]
                } else {
                    0.0
                }
            }))
        };
        let [a_f, a_b] = [0, 1].map(|half| sums[half][0] / excess);
        let [alpha_f, alpha_b] = [0, 1].map(|half| mean(sums[half][1], sums[half][0]));
        let [f2, b2] = [0, 1].map(|half| mean(sums[half][2], sums[half][0]));

        // Of light that comes through fibres in other directions than the shaded one.
        let disorder = f64::from(dual.disorder);
        let f2 = f2 + disorder * ISOTROPIC_VARIANCE;
        let a_f2 = a_f * a_f;
        let loss = (DVec3::ONE - a_f2).max(DVec3::splat(MIN_LOSS));
        let (loss2, loss3) = (loss * loss, loss * loss * loss);
        let (a_b2, a_b3) = (a_b * a_b, a_b * a_b * a_b);
        // Paths that turn once, and thrice.
        let back = a_b * a_f2 / loss + a_b3 * a_f2 / loss3;
        let delta = alpha_b * (DVec3::ONE - 2.0 * a_b2 / loss2)
            + alpha_f * (2.0 * loss2 + 4.0 * a_f2 * a_b2) / loss3;
        let once = (2.0 * f2 + b2).map(f64::sqrt);
        let thrice = (2.0 * f2 + 3.0 * b2).map(f64::sqrt);
        let spread = (once + a_b2 * thrice) / (DVec3::ONE + a_b2);
        let sigma = (DVec3::ONE + f64::from(dual.backward) * a_f2) * spread;
        // Two streams that feed each other: I' = -(1 - ā_f) I + ā_b J, -J' = -(1 - ā_f) J + ā_b I. Both fall by this a fibre.
        let lost = DVec3::ONE - a_f;
        let decay = (lost * lost - a_b * a_b).max(DVec3::ZERO).map(f64::sqrt)
            * (1.0 - (1.0 - DISORDERED_DECAY) * disorder);
        [DVec3::ONE - decay, f2, back, delta, sigma]
    }

    /// The table: rows of θ from -π/2 to π/2 of seven colours; the averages of dual scattering only where it is given.
    pub fn table(&self, dual: Option<DualScattering>) -> Vec<f32> {
        let theta = |row: usize| PI * (row as f64 / (ANGLES - 1) as f64 - 0.5);
        let albedo: Vec<DVec3> = if self.normalised {
            // f′ is symmetric: what is scattered of light from θ is what is seen of uniform light.
            (0..ANGLES)
                .map(|row| self.uniform(theta(row), &|_, _| DVec3::ONE))
                .collect()
        } else {
            Vec::new()
        };
        let at = |theta: f64| {
            let y = (theta / PI + 0.5).clamp(0.0, 1.0) * (ANGLES - 1) as f64;
            let row = (y as usize).min(ANGLES - 2);
            albedo[row].lerp(albedo[row + 1], y - row as f64)
        };
        let divisor = |a: f64, b: f64| {
            if albedo.is_empty() {
                DVec3::ONE
            } else {
                DVec3::ONE.max(at(a)).max(at(b))
            }
        };
        let mut table = Vec::with_capacity(ANGLES * ANGLE_WORDS);
        for row in 0..ANGLES {
            let theta = theta(row);
            let uniform = self.uniform(theta, &divisor);
            let whole = albedo.get(row).copied().unwrap_or(DVec3::ONE);
            let averages = dual.map_or([DVec3::ZERO; 5], |dual| self.dual(theta, &dual, &divisor));
            for colour in [uniform, whole].into_iter().chain(averages) {
                table.extend(colour.as_vec3().to_array());
            }
            table.extend([0.0; ANGLE_WORDS - 21]);
        }
        table
    }
}
