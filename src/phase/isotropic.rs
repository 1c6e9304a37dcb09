//! Isotropic scattering.

use super::PhaseFunction;
use crate::math::FOUR_PI;

/// Scattering that forgets the direction it came from: 1/(4 pi) per steradian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isotropic;

impl PhaseFunction for Isotropic {
    fn eval(&self, _one_minus_mu: f64, _one_plus_mu: f64) -> f64 {
        1.0 / FOUR_PI
    }

    fn sample(&self, u: f64) -> (f64, f64) {
        (2.0 * (1.0 - u), 2.0 * u)
    }

    fn moment(&self, l: u32) -> f64 {
        if l == 0 { 1.0 } else { 0.0 }
    }
}
