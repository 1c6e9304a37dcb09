//! Phase functions: one file each; the contract, the closed set, and its specimens for the laws.
//!
//! Every method takes or returns the pair (1-mu, 1+mu) of the cosine between the directions of travel before and
//! after: that keeps every digit at both peaks.

mod function;
mod henyey_greenstein;
mod isotropic;
mod legendre;
mod rayleigh;
mod schlick;
mod tabulated;
mod two_term;

pub use function::PhaseFunction;
pub use henyey_greenstein::HenyeyGreenstein;
pub use isotropic::Isotropic;
pub use legendre::Legendre;
pub use rayleigh::Rayleigh;
pub use schlick::Schlick;
pub use tabulated::Tabulated;
pub use two_term::TwoTerm;

use crate::math::{Albedo, Asymmetry, Frame, warp};
use glam::DVec3;
use std::sync::Arc;

/// The phase functions at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// The same in every direction.
    Isotropic(Isotropic),
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein(HenyeyGreenstein),
    /// The sum of two Henyey-Greenstein functions.
    TwoTerm(TwoTerm),
    /// Blasi, Le Saec and Schlick 1993.
    Schlick(Schlick),
    /// Small particles.
    Rayleigh(Rayleigh),
    /// Given by a table.
    Tabulated(Arc<Tabulated>),
    /// Given by its Legendre moments.
    Legendre(Arc<Legendre>),
}

macro_rules! each {
    ($self:ident, $inner:ident => $body:expr) => {
        match $self {
            Phase::Isotropic($inner) => $body,
            Phase::HenyeyGreenstein($inner) => $body,
            Phase::TwoTerm($inner) => $body,
            Phase::Schlick($inner) => $body,
            Phase::Rayleigh($inner) => $body,
            Phase::Tabulated($inner) => $body,
            Phase::Legendre($inner) => $body,
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

    /// The pairs (1-mu, 1+mu) where the density has a kink, from backward to forward: quadrature breaks there.
    pub fn kinks(&self) -> Vec<(f64, f64)> {
        match self {
            Phase::Tabulated(table) => table.kinks().collect(),
            Phase::Isotropic(_)
            | Phase::HenyeyGreenstein(_)
            | Phase::TwoTerm(_)
            | Phase::Schlick(_)
            | Phase::Rayleigh(_)
            | Phase::Legendre(_) => Vec::new(),
        }
    }

    /// Each kind over its whole domain. A new kind does not compile until it is named here.
    pub fn specimens() -> Vec<Phase> {
        let each = |values: &[f64], make: &dyn Fn(Asymmetry) -> Phase| -> Vec<Phase> {
            values.iter().filter_map(|&g| Asymmetry::try_from(g).ok()).map(make).collect()
        };
        let named = |phase: Phase| match phase {
            Phase::Isotropic(_) | Phase::Rayleigh(_) => vec![phase],
            Phase::HenyeyGreenstein(_) => each(
                &[
                    -1.0 + 1e-9,
                    -0.9999,
                    -0.75,
                    -1e-6,
                    -1e-12,
                    1e-12,
                    1e-6,
                    0.3,
                    0.75,
                    0.95,
                    0.9999,
                    1.0 - 1e-9,
                ],
                &Phase::with_asymmetry,
            ),
            Phase::TwoTerm(_) => {
                let pairs = [
                    (0.8, -0.4, 0.7),
                    (0.0, 0.95, 0.25),
                    (1.0 - 1e-9, -1.0 + 1e-9, 0.5),
                    (0.9999, -1e-12, 0.99),
                ];
                let term = |(a, b, share): (f64, f64, f64)| {
                    let (a, b) = (Asymmetry::try_from(a).ok()?, Asymmetry::try_from(b).ok()?);
                    Some(Phase::TwoTerm(TwoTerm::new(a, b, Albedo::try_from(share).ok()?)))
                };
                pairs.into_iter().filter_map(term).collect()
            }
            Phase::Schlick(_) => {
                each(&[-1.0 + 1e-9, -0.9, -1e-6, 1e-12, 0.3, 0.75, 0.99, 1.0 - 1e-9], &|k| {
                    Phase::Schlick(Schlick::new(k))
                })
            }
            Phase::Legendre(_) => {
                // Even; a line backwards; brighter to both ends; and a dozen moments of Henyey and Greenstein, g = 0.4.
                let peak: Vec<f64> =
                    (0..12).scan(1.0, |power, _| Some(std::mem::replace(power, *power * 0.4))).collect();
                let all: [&[f64]; 4] = [&[1.0], &[1.0, -0.3], &[1.0, 0.1, 0.25], &peak];
                let all = all.into_iter().filter_map(|moments| Legendre::new(moments).ok());
                all.map(|p| Phase::Legendre(Arc::new(p))).collect()
            }
            Phase::Tabulated(_) => {
                // Even; with a step; and a droplet's: a narrow forward peak, a flat side and a glory.
                let droplet = [
                    (0.0, 3e4),
                    (0.01, 2.9e4),
                    (0.03, 2e4),
                    (0.1, 3e3),
                    (0.5, 100.0),
                    (2.0, 20.0),
                    (10.0, 5.0),
                    (45.0, 0.8),
                    (90.0, 0.05),
                    (120.0, 0.02),
                    (139.0, 0.3),
                    (150.0, 0.1),
                    (179.0, 0.2),
                    (180.0, 0.6),
                ];
                let step = [(0.0, 1.0), (60.0, 4.0), (60.000_001, 0.0), (100.0, 0.0), (180.0, 2.0)];
                let tables: [&[(f64, f64)]; 3] = [&[(0.0, 7.0), (180.0, 7.0)], &step, &droplet];
                let tables = tables.into_iter().filter_map(|table| Tabulated::new(table).ok());
                tables.map(|table| Phase::Tabulated(Arc::new(table))).collect()
            }
        };
        let half = Asymmetry::try_from(0.5);
        let even = Legendre::new(&[1.0]).ok().map(|p| Phase::Legendre(Arc::new(p)));
        let first = [
            Some(Phase::Isotropic(Isotropic)),
            half.clone().ok().map(Phase::with_asymmetry),
            half.clone()
                .ok()
                .zip(Albedo::try_from(0.5).ok())
                .map(|(g, share)| Phase::TwoTerm(TwoTerm::new(g, g, share))),
            half.ok().map(|k| Phase::Schlick(Schlick::new(k))),
            Some(Phase::Rayleigh(Rayleigh)),
            Tabulated::new(&[(0.0, 1.0), (180.0, 1.0)]).ok().map(|table| Phase::Tabulated(Arc::new(table))),
            even,
        ];
        first.into_iter().flatten().flat_map(named).collect()
    }
}
