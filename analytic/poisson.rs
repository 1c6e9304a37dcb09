//! Poisson probabilities, which are gamma densities too, without cancellation (Loader 2000).

use libm::{exp, lgamma, log};
use std::f64::consts::PI;

/// e^(-lambda) lambda^n / n! for n >= 0, lambda >= 0.
pub(crate) fn probability(n: u32, lambda: f64) -> f64 {
    let x = f64::from(n);
    if lambda <= 0.0 {
        return if n == 0 { 1.0 } else { 0.0 };
    }
    if n == 0 {
        return exp(-lambda);
    }
    exp(-stirling_error(x) - deviance(x, lambda)) / (2.0 * PI * x).sqrt()
}

/// Probability of at most n events.
pub(crate) fn at_most(n: u32, lambda: f64) -> f64 {
    if lambda <= 0.0 {
        return 1.0;
    }
    // From the largest term among 0..=n, down and up.
    let start = if lambda < f64::from(n) { lambda as u32 } else { n };
    let first = probability(start, lambda);
    let mut sum = first;
    let (mut term, mut i) = (first, start);
    while i > 0 && term > 1e-18 * sum {
        term *= f64::from(i) / lambda;
        sum += term;
        i -= 1;
    }
    (term, i) = (first, start);
    while i < n && term > 1e-18 * sum {
        i += 1;
        term *= lambda / f64::from(i);
        sum += term;
    }
    sum.min(1.0)
}

/// ln n! - (n + 1/2) ln n + n - (1/2) ln 2 pi.
fn stirling_error(x: f64) -> f64 {
    if x < 16.0 {
        return lgamma(x + 1.0) - (x + 0.5) * log(x) + x - 0.5 * log(2.0 * PI);
    }
    let y = 1.0 / (x * x);
    // The next term, 691/(360360 x^11), is 1e-16 at x = 16.
    (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)))) / x
}

/// x ln(x/lambda) + lambda - x, accurate where x is close to lambda.
fn deviance(x: f64, lambda: f64) -> f64 {
    let d = (x - lambda) / (x + lambda);
    if d.abs() < 0.1 {
        // x ln(x/lambda) = 2 x artanh(d).
        let (mut sum, mut power, mut k) = ((x - lambda) * d, 2.0 * x * d, 1.0);
        loop {
            power *= d * d;
            k += 2.0;
            let next = sum + power / k;
            if next == sum {
                return sum;
            }
            sum = next;
        }
    }
    x * log(x / lambda) + lambda - x
}
