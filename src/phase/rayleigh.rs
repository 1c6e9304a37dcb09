//! Rayleigh scattering: particles much smaller than the wavelength.

use super::PhaseFunction;
use crate::math::FOUR_PI;

/// `p = 3 (1 + mu^2) / (16 pi)`: unpolarised light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rayleigh;

/// The root x in [0, 1] of x (x^2 - 3x + 6) = 8u, u up to 1/2: with mu = x - 1 that is mu^3 + 3 mu = 8u - 4.
///
/// mu = c - 1/c with c^3 = q + sqrt(q^2 + 1), q = 4u - 2 (Cardano), has digits enough for two steps of Newton's method
/// in x to give all.
fn root(u: f64) -> f64 {
    let q = 4.0 * u - 2.0;
    // q is negative here: the mirror image has the sum without cancellation.
    let c = libm::cbrt((q * q + 1.0).sqrt() - q);
    let mut x = (1.0 + (1.0 / c - c)).max(0.0);
    for _ in 0..2 {
        x -= (x * ((x - 3.0) * x + 6.0) - 8.0 * u) / (3.0 * ((x - 1.0) * (x - 1.0) + 1.0));
    }
    x
}

impl PhaseFunction for Rayleigh {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let mu = 0.5 * (one_plus_mu - one_minus_mu);
        0.75 * (1.0 + mu * mu) / FOUR_PI
    }

    fn sample(&self, u: f64) -> (f64, f64) {
        if u < 0.5 {
            let x = root(u);
            (2.0 - x, x)
        } else {
            let x = root(1.0 - u);
            (x, 2.0 - x)
        }
    }

    fn moment(&self, l: u32) -> f64 {
        match l {
            0 => 1.0,
            2 => 0.1,
            _ => 0.0,
        }
    }
}
