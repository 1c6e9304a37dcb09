//! The sum of two Henyey-Greenstein phase functions.

use super::{HenyeyGreenstein, PhaseFunction};
use crate::math::{Albedo, Asymmetry, exp, ln};
use std::f64::consts::PI;

/// A `share` of one Henyey-Greenstein function, the rest of another: a forward peak with a backward one beside it.
///
/// # Source
/// Kattawar 1975
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoTerm {
    first: HenyeyGreenstein,
    second: HenyeyGreenstein,
    share: f64,
}

/// Below this number the cumulated density is a straight line, to all digits: a peak of width 1-|g| bends it at
/// (1-|g|)^2, which is 1e-32 at the narrowest.
const STRAIGHT: f64 = 1e-200;

impl TwoTerm {
    /// `share` \[1\] of mean cosine `g1`, 1 - `share` of mean cosine `g2`.
    pub fn new(g1: Asymmetry, g2: Asymmetry, share: Albedo) -> Self {
        TwoTerm { first: HenyeyGreenstein::new(g1), second: HenyeyGreenstein::new(g2), share: share.get() }
    }

    /// The two terms, each with its share.
    pub fn terms(&self) -> [(f64, HenyeyGreenstein); 2] {
        [(self.share, self.first), (1.0 - self.share, self.second)]
    }

    fn mixed(&self, f: impl Fn(&HenyeyGreenstein) -> f64) -> f64 {
        self.share * f(&self.first) + (1.0 - self.share) * f(&self.second)
    }

    /// Fraction scattered below the cosine of the pair, or above it, whichever is asked for.
    fn cumulated(&self, (one_minus_mu, one_plus_mu): (f64, f64), is_below: bool) -> f64 {
        self.mixed(|term| {
            let (below, above) = term.cumulated(one_minus_mu, one_plus_mu);
            if is_below { below } else { above }
        })
    }
}

/// The pair (1-mu, 1+mu) of a ratio r = (1-mu)/(1+mu).
fn pair(r: f64) -> (f64, f64) {
    (2.0 * (r / (1.0 + r)), 2.0 / (1.0 + r))
}

impl PhaseFunction for TwoTerm {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.mixed(|term| term.eval(one_minus_mu, one_plus_mu))
    }

    /// Newton's method on the logarithm of the cumulated density over that of r = (1-mu)/(1+mu), between the samples
    /// of both terms; below the median from one end and above it from the other, so that both keep every digit.
    fn sample(&self, u: f64) -> (f64, f64) {
        let is_below = u < 0.5;
        let target = if is_below { u } else { 1.0 - u };
        if target < STRAIGHT {
            // Only u itself can be so small: 1-u is 2^-53 or more.
            let one_plus_mu = u / (2.0 * PI * self.eval(2.0, 0.0));
            return (2.0 - one_plus_mu, one_plus_mu);
        }
        let ratio = |(m, p): (f64, f64)| m / p;
        let (a, b) = (ratio(self.first.sample(u)), ratio(self.second.sample(u)));
        let (mut low, mut high) = (a.min(b), a.max(b));
        let mut r = low.sqrt() * high.sqrt();
        // Each step that Newton's method does not take halves a bracket of at most 160 in ln r.
        for _ in 0..100 {
            let (m, p) = pair(r);
            let part = self.cumulated((m, p), is_below);
            // What lies below the cosine falls as r grows, what lies above it grows.
            if (part > target) == is_below {
                low = low.max(r)
            } else {
                high = high.min(r)
            }
            // dF/d ln r = 2 pi p(mu) (1-mu)(1+mu)/2, with the sign of the side.
            let slope = PI * self.eval(m, p) * m * p / part;
            let step = ln(part / target) / slope;
            let newton = r * exp(if is_below { step } else { -step });
            let next = if (low..=high).contains(&newton) { newton } else { low.sqrt() * high.sqrt() };
            let is_done = (next / r - 1.0).abs() < 1e-15 || step.abs() < 1e-8;
            r = next;
            if is_done {
                break;
            }
        }
        pair(r)
    }

    fn moment(&self, l: u32) -> f64 {
        self.mixed(|term| term.moment(l))
    }
}
