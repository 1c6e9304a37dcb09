//! Gauss-Legendre quadrature.

use super::cos;
use std::f64::consts::PI;

/// P_n and P_(n-1) at x, n at least 1.
fn legendre_pair(n: u32, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 1..n {
        let k = f64::from(k);
        (before, p) = (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0));
    }
    (p, before)
}

/// Legendre polynomials at x, of degree 0 and on.
pub fn legendre_series(x: f64) -> impl Iterator<Item = f64> {
    let (mut before, mut p, mut degree) = (0.0, 1.0, 0.0);
    std::iter::from_fn(move || {
        let own = p;
        (before, p) = (p, ((2.0 * degree + 1.0) * x * p - degree * before) / (degree + 1.0));
        degree += 1.0;
        Some(own)
    })
}

/// Nodes and weights on [-1, 1] of the rule of `n` nodes, exact for polynomials of degree 2n - 1.
///
/// Newton's method on P_n from Chebyshev's angles: eight steps double the digits beyond those of an f64.
pub fn gauss_legendre(n: u32) -> Vec<(f64, f64)> {
    let count = f64::from(n);
    let node = |i: u32| {
        let mut x = cos(PI * (f64::from(i) + 0.75) / (count + 0.5));
        let mut slope = 0.0;
        for _ in 0..8 {
            let (p, before) = legendre_pair(n, x);
            slope = count * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_the_degree_are_exact() {
        for n in 1..30 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(i32::try_from(degree).unwrap_or(0))).sum();
                let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{n} {degree}: {sum}");
            }
        }
        let series: Vec<f64> = legendre_series(0.5).take(5).collect();
        assert_eq!(series, [1.0, 0.5, -0.125, -0.4375, -0.2890625]);
    }
}
