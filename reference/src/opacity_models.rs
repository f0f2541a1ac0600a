//! What a few numbers a texel know of the light that passes there: layers, moments and Fourier coefficients of the same
//! optical depths, so that one can choose among them by figures.
//!
//! What crosses a texel is a measure on [-1, 1], the map's depths: Ω_i = -ln(1 - opacity) at x_i. The transmittance at x
//! is exp(-Ω(x)), Ω(x) being the measure of what lies before x.
//!
//! - [`layers`]: the sums between K + 1 even boundaries, linear between these.
//! - [`moments`]: Σ Ω T_k(x) up to an even m, with Chebyshev's polynomials. They are Peters' and Münstermann's power
//!   moments (2015, 2018) in another basis, in which rounding does far less harm. Ω(x) lies between two sharp bounds,
//!   those of the measure of m/2 + 1 points, x among them, with these moments. The bounds differ by the mass at x, of which
//!   a fixed part is taken. Either bound rises with x, so the transmittance never does.
//! - [`fourier`]: a truncated series of the density, integrated (Jansen and Bavoil 2010). It rings: its Ω falls at places,
//!   unless it is damped (Fejér's means).

use std::f64::consts::TAU;

/// A measure's points in ascending order: place in [-1, 1], and mass.
pub type Steps = [(f64, f64)];

/// Sums of `count` even layers.
pub fn layers(steps: &Steps, count: usize) -> Vec<f64> {
    let mut sums = vec![0.0; count];
    for (x, mass) in steps {
        let layer = (0.5 * (x + 1.0) * count as f64) as usize;
        sums[layer.min(count - 1)] += mass;
    }
    sums
}

/// Ω(x) from layers.
pub fn layers_optical_depth(sums: &[f64], x: f64) -> f64 {
    let count = sums.len() as f64;
    let place = (0.5 * (x + 1.0) * count).clamp(0.0, count);
    let layer = (place as usize).min(sums.len() - 1);
    sums[..layer].iter().sum::<f64>() + sums[layer] * (place - layer as f64)
}

/// T_0(x), …, T_{n-1}(x).
pub fn chebyshev(n: usize, x: f64) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for k in 2..n {
        values.push(2.0 * x * values[k - 1] - values[k - 2]);
    }
    values.truncate(n);
    values
}

/// Σ Ω T_k(x) for k from 0 to m.
pub fn moments(steps: &Steps, m: usize) -> Vec<f64> {
    let mut sums = vec![0.0; m + 1];
    for (x, mass) in steps {
        for (sum, value) in sums.iter_mut().zip(chebyshev(m + 1, *x)) {
            *sum += mass * value;
        }
    }
    sums
}

/// L with `L Lᵀ` the matrix, or `None` where that is not positive definite.
fn cholesky(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut lower = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = matrix[i][j] - known;
            if i > j {
                lower[i][j] = rest / lower[j][j];
            } else if rest > 0.0 {
                lower[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(lower)
}

/// L⁻¹ v.
fn forward(lower: &[Vec<f64>], v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; v.len()];
    for i in 0..v.len() {
        let known: f64 = (0..i).map(|k| lower[i][k] * out[k]).sum();
        out[i] = (v[i] - known) / lower[i][i];
    }
    out
}

/// L⁻ᵀ v.
fn backward(lower: &[Vec<f64>], v: &[f64]) -> Vec<f64> {
    let n = v.len();
    let mut out = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| lower[k][i] * out[k]).sum();
        out[i] = (v[i] - known) / lower[i][i];
    }
    out
}

/// A polynomial in powers from its coefficients in Chebyshev's.
fn in_powers(c: &[f64]) -> Vec<f64> {
    let n = c.len();
    let mut sum = vec![0.0; n];
    let mut basis = vec![vec![0.0; n]; n.max(2)];
    basis[0][0] = 1.0;
    if n > 1 {
        basis[1][1] = 1.0;
    }
    for k in 2..n {
        for i in 0..n {
            let raised = if i > 0 {
                2.0 * basis[k - 1][i - 1]
            } else {
                0.0
            };
            basis[k][i] = raised - basis[k - 2][i];
        }
    }
    for (c, row) in c.iter().zip(&basis) {
        for (sum, value) in sum.iter_mut().zip(row) {
            *sum += c * value;
        }
    }
    sum
}

fn polynomial(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Roots within ±`reach` of a polynomial whose roots are all real and simple: those of its derivative part them.
fn real_roots(c: &[f64], reach: f64) -> Vec<f64> {
    if c.len() < 2 {
        return Vec::new();
    }
    let slope: Vec<f64> = c[1..]
        .iter()
        .zip(1..)
        .map(|(c, k)| f64::from(k) * c)
        .collect();
    let mut ends = vec![-reach];
    ends.extend(real_roots(&slope, reach));
    ends.push(reach);
    let mut roots = Vec::new();
    for pair in ends.windows(2) {
        let [mut low, mut high] = [pair[0], pair[1]];
        let rises = polynomial(c, high) > 0.0;
        if (polynomial(c, low) > 0.0) == rises {
            continue;
        }
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (polynomial(c, middle) > 0.0) == rises {
                high = middle;
            } else {
                low = middle;
            }
        }
        roots.push(0.5 * (low + high));
    }
    roots
}

/// Ω(x) from moments. `bias`, from 0 to 1, moves them towards those of the density 1/√(1 - x²), all of which but the first
/// are 0, so that they are those of some measure in spite of rounding; `part` of the mass at x counts as before it, but for
/// `own`, a mass known to be there that does not count. `None` where the moments are those of no measure of more than m/2
/// points.
pub fn moments_optical_depth(sums: &[f64], x: f64, own: f64, bias: f64, part: f64) -> Option<f64> {
    let total = sums[0];
    if total <= 0.0 {
        return Some(0.0);
    }
    let n = sums.len() / 2 + 1;
    let b = |k: usize| sums[k] / total * if k == 0 { 1.0 } else { 1.0 - bias };
    // T_i T_j = (T_{i+j} + T_{|i-j|}) / 2.
    let gram: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| 0.5 * (b(i + j) + b(i.abs_diff(j))))
                .collect()
        })
        .collect();
    let lower = cholesky(&gram)?;
    // K(x, y) = t(x)ᵀ G⁻¹ t(y): its zeros in y are the other points, and 1 / K(y, y) is the mass at each.
    let kernel = backward(&lower, &forward(&lower, &chebyshev(n, x)));
    let mass = |y: f64| {
        let solved = forward(&lower, &chebyshev(n, y));
        1.0 / solved.iter().map(|a| a * a).sum::<f64>()
    };
    let others = real_roots(&in_powers(&kernel), 1e4);
    let before: f64 = others.into_iter().filter(|y| *y < x).map(mass).sum();
    Some(total * before + part * (total * mass(x) - own).max(0.0))
}

/// Σ Ω, then Σ Ω cos(2πk d) and Σ Ω sin(2πk d) for k from 1 to `pairs`, with d from 0 to 1 as x goes from -1 to 1.
pub fn fourier(steps: &Steps, pairs: usize) -> Vec<f64> {
    let mut sums = vec![0.0; 1 + 2 * pairs];
    for (x, mass) in steps {
        sums[0] += mass;
        for k in 1..=pairs {
            let (sin, cos) = (TAU * k as f64 * 0.5 * (x + 1.0)).sin_cos();
            sums[2 * k - 1] += mass * cos;
            sums[2 * k] += mass * sin;
        }
    }
    sums
}

/// Ω(x) from Fourier coefficients, damped or not; never below 0.
pub fn fourier_optical_depth(sums: &[f64], x: f64, damped: bool) -> f64 {
    let d = 0.5 * (x + 1.0);
    let pairs = sums.len() / 2;
    let mut depth = sums[0] * d;
    for k in 1..=pairs {
        let fejer = 1.0 - k as f64 / (pairs + 1) as f64;
        let weight = if damped { fejer } else { 1.0 };
        let turn = TAU * k as f64;
        let (sin, cos) = (turn * d).sin_cos();
        let rise = sums[2 * k - 1] * sin + sums[2 * k] * (1.0 - cos);
        depth += weight * 2.0 / turn * rise;
    }
    depth.max(0.0)
}
