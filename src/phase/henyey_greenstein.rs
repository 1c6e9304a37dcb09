//! The phase function of Henyey and Greenstein (1941), for every asymmetry below 1 in size.

use super::PhaseFunction;
use crate::faults::{Fault, planted, size};
use crate::math::{Asymmetry, FOUR_PI};

/// `p = (1-g^2) / (4 pi (1 + g^2 - 2 g mu)^(3/2))`, written as sums of terms of one sign: no cancellation, no
/// threshold on small g, no clamp on large ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreenstein {
    g: f64,
}

impl HenyeyGreenstein {
    /// The phase function of mean cosine `g`.
    pub fn new(g: Asymmetry) -> Self {
        HenyeyGreenstein { g: g.get() }
    }

    /// The mean cosine.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Fractions of what is scattered below and above the cosine of the pair \[1\]; they sum to 1, and each keeps every
    /// digit: (1-g)(1+mu)/(s (1+g+s)) and (1+g)(1-mu)/(s (1-g+s)), s^2 = 1 + g^2 - 2 g mu.
    pub(super) fn cumulated(&self, one_minus_mu: f64, one_plus_mu: f64) -> (f64, f64) {
        let g = self.g;
        let s = if g >= 0.0 {
            ((1.0 - g) * (1.0 - g) + 2.0 * g * one_minus_mu).sqrt()
        } else {
            ((1.0 + g) * (1.0 + g) - 2.0 * g * one_plus_mu).sqrt()
        };
        ((1.0 - g) / s * one_plus_mu / ((1.0 + g) + s), (1.0 + g) / s * one_minus_mu / ((1.0 - g) + s))
    }

    /// The mean cosine as density and sampler use it: the same, unless a fault is planted.
    fn used(&self) -> f64 {
        if planted(Fault::AsymmetryClamped) {
            return self.g.clamp(-0.99, 0.99);
        }
        if planted(Fault::SmallAsymmetryIgnored) && self.g.abs() < 1e-3 {
            return 0.0;
        }
        self.g
    }
}

impl PhaseFunction for HenyeyGreenstein {
    /// The denominator 1 + g^2 - 2 g mu is (1-g)^2 + 2 g (1-mu) for g >= 0, and its mirror image otherwise.
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let g = if planted(Fault::EvaluationMirrored) { -self.used() } else { self.used() };
        let d = if g >= 0.0 {
            (1.0 - g) * (1.0 - g) + 2.0 * g * one_minus_mu
        } else {
            (1.0 + g) * (1.0 + g) - 2.0 * g * one_plus_mu
        };
        // Divided in two steps: d * sqrt(d) underflows nowhere, but (1-g)^3 is small against (1-g).
        (1.0 - g) * (1.0 + g) / d / (FOUR_PI * d.sqrt())
    }

    /// Exact inversion; relative error of both members of the pair below 1e-15 for |g| up to 1 - 1e-9.
    fn sample(&self, u: f64) -> (f64, f64) {
        let turned = if planted(Fault::PhaseTurned) { size() } else { 0.0 };
        let g = (self.used() + turned).min(1.0);
        let e = 1.0 - u;
        if planted(Fault::BackwardIsotropic) && g < 0.0 {
            return (2.0 * e, 2.0 * u);
        }
        if g >= 0.0 {
            let d = (1.0 - g) + 2.0 * g * u;
            (
                2.0 * e * ((1.0 - g) / d) * ((1.0 - g) / d) * (1.0 + g * u),
                2.0 * u * ((1.0 + g) / d) * ((1.0 + g) / d) * ((1.0 - g) + g * u),
            )
        } else {
            let d = (1.0 + g) - 2.0 * g * e;
            (
                2.0 * e * ((1.0 - g) / d) * ((1.0 - g) / d) * ((1.0 + g) - g * e),
                2.0 * u * ((1.0 + g) / d) * ((1.0 + g) / d) * (1.0 - g * e),
            )
        }
    }

    fn moment(&self, l: u32) -> f64 {
        (0..l).fold(1.0, |product, _| product * self.g)
    }
}
