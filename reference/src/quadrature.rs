//! Integrals by Gauss-Legendre panels.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Nodes and weights of n points on [-1, 1]: the roots of the Legendre polynomial P_n, by Newton's method from
/// cos(π (i + 3/4) / (n + 1/2)), with weights 2 / ((1 - x²) P_n'(x)²).
pub(crate) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let polynomial = |x: f64| {
        let (mut before, mut now) = (1.0, x);
        for k in 1..n {
            let k = k as f64;
            (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
        }
        (now, n as f64 * (x * now - before) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (value, slope) = polynomial(x);
            x -= value / slope;
        }
        let slope = polynomial(x).1;
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// Eight points, exact to degree 15.
pub(crate) static EIGHT: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(8));

/// Sixteen points, exact to degree 31.
pub(crate) static SIXTEEN: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(16));

/// The points and weights of `rule` on [low, high].
pub(crate) fn on(
    rule: &[(f64, f64)],
    low: f64,
    high: f64,
) -> impl Iterator<Item = (f64, f64)> + '_ {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    rule.iter()
        .map(move |&(x, weight)| (middle + half * x, half * weight))
}

/// The points and weights of `rule` on each of `panels` equal parts of [low, high].
pub(crate) fn panels(
    rule: &[(f64, f64)],
    low: f64,
    high: f64,
    panels: usize,
) -> impl Iterator<Item = (f64, f64)> + '_ {
    let step = (high - low) / panels as f64;
    (0..panels).flat_map(move |i| {
        on(
            rule,
            low + i as f64 * step,
            if i + 1 == panels {
                high
            } else {
                low + (i + 1) as f64 * step
            },
        )
    })
}
