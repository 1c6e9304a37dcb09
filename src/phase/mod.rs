//! Phase functions: one file each; the contract, the closed set, and its specimens for the laws.
//!
//! Every method takes or returns the pair (1-mu, 1+mu) of the cosine between the directions of travel before and
//! after: that keeps every digit at both peaks.

mod henyey_greenstein;
mod isotropic;

pub use henyey_greenstein::HenyeyGreenstein;
pub use isotropic::Isotropic;

use crate::math::{Asymmetry, Frame, warp};
use glam::DVec3;

/// What every phase function answers.
pub trait PhaseFunction {
    /// Density over directions [1/sr]: integrates to 1 over the sphere, and is the density of [`Self::sample`].
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64;

    /// The pair (1-mu, 1+mu) by exact inversion of `u` in [0, 1): mu grows with `u`.
    fn sample(&self, u: f64) -> (f64, f64);

    /// Legendre moment of degree `l`, the mean of P_l(mu): moment 0 is 1, moment 1 is g.
    fn moment(&self, l: u32) -> f64;
}

/// The phase functions at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// The same in every direction.
    Isotropic(Isotropic),
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein(HenyeyGreenstein),
}

macro_rules! each {
    ($self:ident, $inner:ident => $body:expr) => {
        match $self {
            Phase::Isotropic($inner) => $body,
            Phase::HenyeyGreenstein($inner) => $body,
        }
    };
}

impl PhaseFunction for Phase {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        each!(self, p => p.eval(one_minus_mu, one_plus_mu))
    }

    fn sample(&self, u: f64) -> (f64, f64) {
        each!(self, p => p.sample(u))
    }

    fn moment(&self, l: u32) -> f64 {
        each!(self, p => p.moment(l))
    }
}

impl Phase {
    /// Henyey-Greenstein, or the isotropic phase function where `g` is exactly 0.
    pub fn with_asymmetry(g: Asymmetry) -> Self {
        if g.get() == 0.0 {
            Phase::Isotropic(Isotropic)
        } else {
            Phase::HenyeyGreenstein(HenyeyGreenstein::new(g))
        }
    }

    /// A direction of travel after scattering, from the one before and two numbers in [0, 1).
    pub fn scatter(&self, dir: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        Frame::new(dir).to_world(warp::direction(self.sample(u), v)).normalize()
    }

    /// One of each kind over its whole domain. A new kind does not compile until it is named here.
    pub fn specimens() -> Vec<Phase> {
        let asymmetries =
            [-1.0 + 1e-9, -0.9999, -0.75, -1e-6, -1e-12, 1e-12, 1e-6, 0.3, 0.75, 0.95, 0.9999, 1.0 - 1e-9];
        let named = |phase: Phase| match phase {
            Phase::Isotropic(_) => vec![phase],
            Phase::HenyeyGreenstein(_) => asymmetries
                .iter()
                .filter_map(|&g| Asymmetry::try_from(g).ok())
                .map(Phase::with_asymmetry)
                .collect(),
        };
        let mut all = named(Phase::Isotropic(Isotropic));
        all.extend(Asymmetry::try_from(0.5).map(Phase::with_asymmetry).map(named).unwrap_or_default());
        all
    }
}
