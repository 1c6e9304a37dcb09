//! How light that was scattered on the face of a half-space decays inward: the resolvent Phi(t).
//!
//! H(mu) = 1 + int_0^inf Phi(t) e^(-t/mu) dt, and inverting that Laplace transform at the pole and the cut of H,
//!
//! Phi(t) = C e^(-kt) + (w/2) int_0^1 e^(-t/nu) / (H(nu) [(1 - w nu atanh nu)^2 + (pi w nu/2)^2]) dnu/nu,
//! C = k (1-k^2) / ((k^2+w-1) H(1/k)), C = sqrt 3 for w = 1.
//!
//! All terms are positive. With nu = tanh(e^y) the integrand is analytic about the real axis of y and falls at both
//! ends, so that the trapezoidal rule converges exponentially.

use super::decay::Decay;
use super::h_function::HFunction;
use libm::{cosh, exp, expm1, tanh};
use std::f64::consts::FRAC_PI_2;

/// Step in y of the finer rule; the coarser takes every other point. The nearest poles are those at
/// e^y = atanh(k) + i pi/2, of strength e^(-2 atanh k): the error is below e^(-2 pi arg/step - 2 atanh k), 1e-24 for
/// the worst k, and 1e-17 at twice the step; relative to what is left of the light far away, less.
pub(crate) const STEP: f64 = 0.025;
/// Range of y: nu from 4e-18 ...
const FIRST: i32 = -1600;
/// ... to 1 - nu = 1e-18, for integrands that are finite at nu = 1,
pub(crate) const TO_ONE: i32 = 121;
/// or to atanh nu = 2e17, for integrands like 1/((1-nu) ln(1-nu)^2).
pub(crate) const TO_INFINITY: i32 = 1600;

/// A point of the rule.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    /// atanh(nu).
    pub a: f64,
    /// Decay length.
    pub nu: f64,
    /// (d nu/d y) times the step.
    pub weight: f64,
    /// (d a/d y) times the step.
    pub step: f64,
}

/// The rule in y, up to `last`.
pub(crate) fn points(last: i32) -> impl Iterator<Item = Point> {
    (FIRST..=last).map(|i| {
        let a = exp(STEP * f64::from(i));
        let c = cosh(a.min(300.0));
        Point { a, nu: tanh(a), weight: STEP * a / (c * c), step: STEP * a }
    })
}

/// 1/((1 - w nu atanh nu)^2 + (pi w nu/2)^2).
pub(crate) fn spectrum(albedo: f64, point: Point) -> f64 {
    let real = 1.0 - albedo * point.nu * point.a;
    let imaginary = FRAC_PI_2 * albedo * point.nu;
    1.0 / (real * real + imaginary * imaginary)
}

/// A sum of the finer rule, its difference from the coarser, and what its roundings may amount to.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sum {
    fine: f64,
    alternating: f64,
    rounding: f64,
}

impl Sum {
    /// Adds a term whose exponential had the argument `exponent`.
    pub fn add(&mut self, index: usize, term: f64, exponent: f64) {
        self.fine += term;
        self.alternating += if index.is_multiple_of(2) { term } else { -term };
        self.rounding += term * (16.0 + 4.0 * exponent.min(750.0));
    }

    /// Value and bound.
    pub fn value(&self) -> (f64, f64) {
        (self.fine, self.alternating.abs() + f64::EPSILON * self.rounding)
    }
}

/// The resolvent of one albedo.
pub(crate) struct Resolvent {
    /// Strength and decay of the slowest mode.
    pub mode: (f64, f64),
    /// Decays 1/nu and strengths, without the factor w/2.
    pub continuum: Vec<(f64, f64)>,
}

impl Resolvent {
    pub fn new(albedo: f64, h: &HFunction, decay: &Decay) -> Self {
        let mode = if albedo == 1.0 {
            3f64.sqrt()
        } else if decay.gap == 0.0 {
            0.0
        } else {
            decay.k * decay.gap / (decay.excess * exp(h.log(1.0 / decay.k).0))
        };
        let continuum = points(TO_ONE)
            .map(|p| (1.0 / p.nu, p.weight / p.nu * spectrum(albedo, p) * exp(-h.log(p.nu).0)))
            .collect();
        Resolvent { mode: (mode, decay.k), continuum }
    }
}

/// int_0^t e^(-x t') e^(-b (t-t')) dt'.
pub(crate) fn convolved(x: f64, b: f64, t: f64) -> f64 {
    let rate = (x - b).abs();
    exp(-x.min(b) * t) * if rate * t == 0.0 { t } else { -expm1(-rate * t) / rate }
}
