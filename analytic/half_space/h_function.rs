//! Chandrasekhar's H by a trapezoidal rule in the logarithm of its variable.

use crate::value::Value;
use libm::{atan, exp, log, log1p};

const METHOD: &str = "H by the trapezoidal rule, step halved";

/// Step in s = ln x of the finer rule; the coarser takes every other point.
const STEP: f64 = 0.125;
/// Range of s. What lies below weighs less than 90 mu e^-62, above less than e^-45.
const FIRST: i32 = -496;
const LAST: i32 = 360;

/// ln H(mu) = -(1/pi) int ln(1 - w atan(x)/x) v/(1 + v^2) ds with x = e^s, v = mu x.
///
/// In s the integrand is analytic for |Im s| < pi/2, where its poles v = i and its branch points x = i and x = i k
/// lie, and falls at both ends, so that the trapezoidal rule errs by a few e^(-pi^2/step): 1e-34, and 1e-17 at twice
/// the step.
pub(crate) struct HFunction {
    albedo: f64,
    /// x and the step times ln(1 - w atan(x)/x) / pi.
    points: Vec<(f64, f64)>,
}

impl HFunction {
    /// For an albedo between 0 and 1.
    pub fn new(albedo: f64) -> Self {
        let scale = STEP / std::f64::consts::PI;
        let points = (FIRST..=LAST)
            .map(|i| {
                let x = exp(STEP * f64::from(i));
                (x, scale * log_dispersion(albedo, x))
            })
            .collect();
        HFunction { albedo, points }
    }

    /// ln H(mu), 0 <= mu <= 1e8, and a bound on its error.
    pub fn log(&self, mu: f64) -> (f64, f64) {
        // The points alternate between the two rules.
        let (mut even, mut odd) = (0.0, 0.0);
        for pair in self.points.chunks(2) {
            even += term(mu, pair[0]);
            if let Some(&point) = pair.get(1) {
                odd += term(mu, point);
            }
        }
        let value = even + odd;
        // Each term is good to about eight roundings, or to one of the dispersion function, 4 eps at most.
        (value, (even - odd).abs() + 16.0 * f64::EPSILON * value.abs() + 1e-17 * self.albedo * mu.min(1.0))
    }

    /// H(mu).
    pub fn h(&self, mu: f64) -> Value {
        let (log, error) = self.log(mu);
        let value = exp(log);
        Value::new(value, value * (error * (1.0 + error) + 2.0 * f64::EPSILON), METHOD)
    }
}

fn term(mu: f64, (x, log): (f64, f64)) -> f64 {
    let v = mu * x;
    -log * v / (1.0 + v * v)
}

/// ln(1 - w atan(x)/x) with all its digits.
fn log_dispersion(albedo: f64, x: f64) -> f64 {
    let scattered = albedo * (if x < 1e-9 { 1.0 } else { atan(x) / x });
    if scattered < 0.5 { log1p(-scattered) } else { log((1.0 - albedo) + albedo * bend(x)) }
}

/// 1 - atan(x)/x.
fn bend(x: f64) -> f64 {
    if x > 0.3 {
        return 1.0 - atan(x) / x;
    }
    // x^2 below 0.09: sixteen terms leave 0.09^16.
    let y = x * x;
    (1..=16).rev().fold(0.0, |sum, n| y * (1.0 / f64::from(2 * n + 1) - sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_meets_the_closed_form() {
        for x in [0.2999, 0.3001, 0.25] {
            assert!((bend(x) - (1.0 - atan(x) / x)).abs() < 2e-16, "{x}");
        }
        assert!((bend(1e-4) / (1e-8 / 3.0) - 1.0 + 0.6e-8).abs() < 1e-15);
    }
}
