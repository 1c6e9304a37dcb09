//! Convolutions of two and three exponentials over a length, as sums of positive terms.
//!
//! int_0^x e^(-a s) e^(-b (x-s)) ds and its like with three factors are divided differences of e^(-r x) in the rates r:
//! the light that one exponential feeds into another. Equal rates are rates like any other.

use super::solution::decayed;
use libm::exp;

/// Terms of the series in rate times length, below 1: the n-th is less than 1/n!, n = 2 and more.
const TERMS: usize = 19;

/// int_0^x e^(-a s) e^(-b (x-s)) ds.
pub(crate) fn two(a: f64, b: f64, x: f64) -> f64 {
    let falling = falling(a.min(b), x);
    if x == 0.0 || falling == 0.0 { 0.0 } else { falling * decayed((a - b).abs(), x) }
}

/// e^(-rate x), x infinite too.
pub(crate) fn falling(rate: f64, x: f64) -> f64 {
    if rate == 0.0 { 1.0 } else { exp(-rate * x) }
}

/// int over r + s + u = x of e^(-a r) e^(-b s) e^(-c u).
pub(crate) fn three(a: f64, b: f64, c: f64, x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let middle = a.min(b).max(a.max(b).min(c));
    let (near, far) = (middle - low, high - low);
    let falling = falling(low, x);
    if falling == 0.0 {
        return 0.0;
    }
    if far * x >= 1.0 {
        // From the two rates farthest apart: the difference keeps a third of the first term at least.
        return falling * (decayed(near, x) - two(near, far, x)) / far;
    }
    // x^2 sum_n (-1)^n h_n / (n+2)!, h_n the complete symmetric polynomial of 0, near x and far x.
    let (near, far) = (near * x, far * x);
    let (mut sum, mut h, mut power, mut factorial) = (0.5, 1.0, 1.0, 0.5);
    for n in 1..TERMS {
        power *= near;
        h = far * h + power;
        factorial /= -(n as f64 + 2.0);
        sum += h * factorial;
    }
    falling * x * x * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;

    #[test]
    fn they_are_the_integrals() {
        let rule = GaussLegendre::rule(60);
        let rates = [0.0, 1e-9, 0.3, 0.999, 1.0, 1.0 + 1e-12, 2.5, 17.0];
        for x in [1e-9, 0.01, 0.9, 1.0, 1.1, 3.0] {
            for a in rates {
                for b in rates {
                    let brute = rule.integrate(0.0, x, |s| exp(-a * s - b * (x - s)));
                    assert!((two(a, b, x) / brute - 1.0).abs() < 1e-13, "{a} {b} {x}");
                    for c in rates {
                        let brute = rule.integrate(0.0, x, |s| exp(-a * (x - s)) * two(b, c, s));
                        let got = three(a, b, c, x);
                        assert!((got / brute - 1.0).abs() < 1e-13, "{a} {b} {c} {x} {got:e} {brute:e}");
                    }
                }
            }
        }
        // A half-space: int_0^inf.
        assert_eq!(two(0.0, 4.0, f64::INFINITY), 0.25);
        assert_eq!(three(0.0, 2.0, 4.0, f64::INFINITY), 0.125);
        assert_eq!(three(1.0, 2.0, 4.0, f64::INFINITY), 0.0);
        assert_eq!(two(1.0, 1.0, f64::INFINITY), 0.0);
        assert_eq!(three(0.0, 2.0, 2.0, f64::INFINITY), 0.25);
    }
}
