//! Half-spaces of any phase function: constants and faster light by discrete ordinates.

use super::entrance::{Entrance, METHOD};
use crate::error::{Error, Result};
use crate::incidence::Incidence;
use crate::slab_anisotropic::AnisotropicMedium;
use crate::slab_anisotropic::matching::columns;
use crate::slab_anisotropic::modes::Modes;
use crate::slab_anisotropic::solution::Solution;
use crate::value::Value;
use libm::{exp, log1p};
use nalgebra::DVector;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Roundings of an amplitude, as in a slab by discrete ordinates.
const ULPS: f64 = 256.0;

/// A medium on two sets of nodes, and its answer to a wave from infinity.
pub(super) struct Ordinates {
    medium: AnisotropicMedium,
    milne: [Milne; 2],
    /// The first incidence that was asked for: slabs of every thickness share its half-space.
    first: OnceLock<(Incidence, Arc<Entered>)>,
}

/// A half-space under one incidence.
pub(super) struct Entered {
    pub entrance: Entrance,
    pub solutions: [Solution; 2],
}

/// What comes back from the face for sinh(kt)/k (of unit fluence per slope) coming up: amplitudes of all modes.
struct Milne {
    modes: Arc<Modes>,
    slowest: usize,
    back: DVector<f64>,
    /// Milne's length, in mean free paths of the medium.
    length: f64,
}

impl Milne {
    fn new(modes: Arc<Modes>) -> Result<Self> {
        const SINGULAR: Error = Error::Infinite("the face of the half-space cannot be matched in f64");
        let n = modes.nodes.len();
        let slowest = (0..n).fold(0, |best, j| if modes.k[j] < modes.k[best] { j } else { best });
        // Downwards 2 I- = p f - q f': the decaying modes take away what the growing one brings, -q.
        let leaving = columns(&modes, |_| 1.0, |k| k);
        let unit = 2.0 * PI * modes.fluence[slowest];
        let back = leaving.lu().solve(&(modes.odd.column(slowest) / unit)).ok_or(SINGULAR)?;
        let (k, own) = (modes.k[slowest], back[slowest] * unit);
        // sinh(kt)/k + own e^(-kt) is a multiple of sinh(k (t+z)).
        let length = if k == 0.0 { own } else { -log1p(-2.0 * k * own) / (2.0 * k) };
        let length = length / modes.scattering.stretch;
        Ok(Milne { modes, slowest, back, length })
    }
}

impl Ordinates {
    pub fn new(medium: AnisotropicMedium) -> Result<Self> {
        let milne = [Milne::new(medium.modes(0, 0)?)?, Milne::new(medium.modes(1, 0)?)?];
        Ok(Ordinates { medium, milne, first: OnceLock::new() })
    }

    pub fn length(&self) -> Value {
        let [a, b] = self.milne.each_ref().map(|milne| milne.length);
        Value::new(a, 2.0 * (a - b).abs() + ULPS * f64::EPSILON * (a.abs() + 1.0), METHOD)
    }

    /// n, which takes the solutions alone.
    pub fn diffuse(&self) -> Result<Value> {
        let solve = |milne: &Milne| Solution::new(f64::INFINITY, Incidence::Diffuse, milne.modes.clone());
        Ok(self.escape(&[solve(&self.milne[0])?, solve(&self.milne[1])?]))
    }

    fn escape(&self, solutions: &[Solution; 2]) -> Value {
        let [a, b] = std::array::from_fn(|set| deep(&solutions[set], self.milne[set].slowest));
        Value::new(0.25 * a, 0.5 * (a - b).abs() + ULPS * f64::EPSILON * a.abs(), METHOD)
    }

    pub fn entrance(&self, incidence: Incidence) -> Result<Arc<Entered>> {
        if let Some((_, entered)) = self.first.get().filter(|(first, _)| *first == incidence) {
            return Ok(entered.clone());
        }
        let space = self.medium.half_space(incidence)?;
        let (reflected, absorbed) = (space.reflectance(), space.absorptance());
        let solutions = space.into_solutions();
        let entrance = Entrance { escape: self.escape(&solutions), reflected, absorbed };
        let entered = Arc::new(Entered { entrance, solutions });
        // Another incidence may have been the first.
        let _kept = self.first.set((incidence, entered.clone()));
        Ok(entered)
    }

    /// Bound on the flux of all but the slowest mode at depth `tau` of a half-space.
    pub fn faster(&self, solutions: &[Solution; 2], tau: f64) -> f64 {
        (0..2).map(|set| faster(&solutions[set], self.milne[set].slowest, tau)).fold(0.0, f64::max)
    }

    /// Flux at a face of the faster light that a wave of unit slope leaves `tau` away.
    pub fn echo(&self, tau: f64) -> f64 {
        let bound = |milne: &Milne| {
            let depth = tau * milne.modes.scattering.stretch;
            faster_modes(&milne.modes, milne.slowest, depth, |j| milne.back[j].abs())
        };
        bound(&self.milne[0]).max(bound(&self.milne[1]))
    }
}

/// Fluence of the slowest mode at the face: its amplitude, and what its particular solution turns into deep inside.
fn deep(solution: &Solution, slowest: usize) -> f64 {
    let modes = &solution.modes;
    let k = modes.k[slowest];
    let mut amplitude = solution.first[slowest];
    if let Some(beam) = solution.beam.as_ref().filter(|_| k >= 0.5) {
        amplitude -= (k * beam.kappa[slowest] - beam.pi[slowest]) / ((beam.beta - k) * 2.0 * k);
    }
    2.0 * PI * modes.fluence[slowest] * amplitude
}

fn faster(solution: &Solution, slowest: usize, tau: f64) -> f64 {
    let depth = tau * solution.modes.scattering.stretch;
    let mut sum = faster_modes(&solution.modes, slowest, depth, |j| solution.first[j].abs());
    match (&solution.beam, solution.incidence) {
        (Some(beam), Incidence::Beam { mu0 }) => {
            // Direct light, and the sources that follow it: each mode's is a convolution of e^(-beta t) and
            // e^(-k t) of at most t times the slower.
            sum += exp(-beam.beta * depth) / mu0;
            for (j, &k) in solution.modes.k.iter().enumerate() {
                let gap = (k - beam.beta).abs();
                let slower = if j == slowest { beam.beta } else { k.min(beam.beta) };
                let source = (k * beam.kappa[j]).abs() + beam.pi[j].abs();
                let width = if gap * depth > 1.0 { 1.0 / gap } else { depth };
                sum += norm(&solution.modes, j) * source * width * exp(-slower * depth) / k.max(0.5);
            }
        }
        _ => sum += 2.0 * exp(-depth),
    }
    sum
}

fn faster_modes(modes: &Modes, slowest: usize, depth: f64, amplitude: impl Fn(usize) -> f64) -> f64 {
    let terms = modes.k.iter().enumerate().filter(|&(j, _)| j != slowest);
    terms.map(|(j, &k)| amplitude(j) * norm(modes, j) * exp(-k * depth)).sum()
}

/// Half the integral of the absolute radiance of a mode over both hemispheres, times mu: a bound on its fluxes.
fn norm(modes: &Modes, j: usize) -> f64 {
    let (p, q, k) = (modes.even.column(j), modes.odd.column(j), modes.k[j]);
    let terms = modes.nodes.mu.iter().zip(&modes.root).enumerate();
    2.0 * PI * terms.map(|(i, (mu, root))| root * mu * (p[i].abs() + k * q[i].abs())).sum::<f64>()
}
