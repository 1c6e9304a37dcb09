//! The homogeneous slab by adding and doubling: the second method of the referee.
//!
//! A layer is known by what it does to light from outside: a reflection R and a transmission e + T, operators on the
//! radiance over one hemisphere, in each azimuthal mode. Two like layers on top of each other make
//!
//! R' = R + (e+T) R S (e+T),  e + T' = (e+T) S (e+T),  S = 1 + R R + R R R R + ... = (1 - R R)^-1
//!
//! with e = e^(-tau/mu) the direct light. A layer so thin that light is scattered in it once, or hardly ever twice,
//! is known in closed form, and some thirty doublings make it a slab. Between two layers runs the light S (e+T) down
//! and R S (e+T) up, so that the field at any depth follows on the way back, halving the slab that holds it.
//!
//! Nothing here is shared with the discrete ordinates of [`crate::AnisotropicSlab`]: no decay lengths, no boundary
//! systems, other directions. All sums in the azimuthal mean are of positive terms, so that thin slabs and small
//! transmittances keep their digits; what grows is the rounding of some ten operations a doubling, and where photons
//! are conserved each such rounding absorbs or makes light along all of its way.
//!
//! Every answer is computed on two sets of nodes; its error is a small part of the difference, which is the bound,
//! together with the relative differences of its neighbours (the other fluxes; other depths).
//!
//! Source: van de Hulst 1963; Hansen and Travis 1974, section 3; van de Hulst 1980, chapter 4; de Haan, Bosma and
//! Hovenier 1987.

mod nodes;
mod radiance;
mod stack;
#[cfg(test)]
mod tests;

pub(crate) use nodes::{Nodes, Panels};
pub(crate) use radiance::{LAST, deflection, single_mode};
pub(crate) use stack::{Layer, Stack, bounces};

use crate::beer_lambert::{direct_fluence, direct_transmittance};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo, check_depth};
use crate::phase::Phase;
use crate::value::Value;
use libm::sqrt;
use nalgebra::DVector;
use std::f64::consts::PI;
use std::sync::OnceLock;

const METHOD: &str = "adding and doubling, two node counts";

/// Roundings of one doubling: a chain of three products of matrices, all of whose terms are positive.
pub(crate) const ULPS: f64 = 8.0;

/// What the Legendre moments left out may be on the finer and on the coarser nodes; and where that takes too many.
const CUT: [f64; 2] = [1e-13, 1e-10];
const CUT_PEAKED: [f64; 2] = [1e-9, 1e-7];

/// The last moment of all.
pub(crate) const MOST: usize = 450;

/// The cut for light scattered twice or more, where the moments enter as products.
pub(crate) const CUT_TWICE: [f64; 2] = [1e-11, 1e-9];

/// Nodes towards the horizon, and the fewest above it.
pub(crate) const LOWER: [usize; 2] = [56, 44];
const UPPER: [usize; 2] = [28, 22];

/// A slab solved by adding and doubling.
pub struct AddingDoubling {
    tau: f64,
    albedo: f64,
    phase: Phase,
    incidence: Incidence,
    solutions: [Solution; 2],
    reflectance: Value,
    transmittance_direct: Value,
    transmittance_diffuse: Value,
    absorptance: Value,
    rounding: f64,
    /// Depths in rising order, and the relative difference of the two fluences there.
    ladder: OnceLock<Vec<(f64, f64)>>,
}

/// The azimuthal mean on one set of nodes.
struct Solution {
    stack: Stack,
    /// The light that enters.
    entering: DVector<f64>,
}

impl AddingDoubling {
    /// Solves the slab with Henyey-Greenstein scattering.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 100; `albedo` 0 to 1; `g` mean cosine of scattering, -0.95 to 0.95;
    /// `incidence` of unit irradiance, a beam with a cosine of 1e-5 to 1
    /// # Returns
    /// a solution with errors below 1e-10 of themselves for most slabs; the bounds say how much. It takes a tenth of
    /// a second, some seconds at |g| = 0.95
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `g` or `mu0`
    /// # Limits
    /// g = 0: [`crate::IsotropicSlab`]; albedo = 1: R + T = 1; albedo = 0: the direct light alone
    pub fn new(tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Result<Self> {
        within("g", g, -0.95, 0.95, "-0.95 to 0.95")?;
        Self::with_phase(tau, albedo, &Phase::henyey_greenstein(g)?, incidence)
    }

    /// Solves the slab with any phase function.
    ///
    /// # Arguments
    /// as for [`Self::new`]; `phase` any whose Legendre moments beyond l = 450 are below 1e-9
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `phase function` (its first moment left out) or `mu0`
    pub fn with_phase(tau: f64, albedo: f64, phase: &Phase, incidence: Incidence) -> Result<Self> {
        within("tau", tau, 1e-12, 100.0, "1e-12 to 100 with adding and doubling")?;
        check_albedo(albedo)?;
        let beam = match incidence {
            Incidence::Beam { mu0 } => {
                vec![within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 with adding and doubling, or diffuse")?]
            }
            Incidence::Diffuse => Vec::new(),
        };
        let degrees = degrees(phase)?;
        let moments: Vec<f64> = (0..=degrees[0]).map(|l| phase.moment(l)).collect();
        let solve = |i: usize| {
            let nodes = Nodes::open(upper(i, degrees[i]), LOWER[i]).with(&beam);
            let stack = Stack::new(tau, albedo, &moments[..=degrees[i]], 0, nodes)?;
            let entering = entering(&stack.nodes, incidence);
            Ok(Solution { stack, entering })
        };
        let solutions: [Solution; 2] = [solve(0)?, solve(1)?];
        let pair = |f: fn(&Solution) -> f64| [f(&solutions[0]), f(&solutions[1])];
        let fluxes =
            [pair(Solution::reflectance), pair(Solution::transmittance_diffuse), pair(Solution::absorptance)];
        let rounding = ULPS * f64::EPSILON * (solutions[0].stack.doublings() as f64 + 4.0) * (1.0 + tau);
        let transmittance_direct = direct_transmittance(incidence, tau)?;
        let [reflectance, transmittance_diffuse, absorptance] = bounded(fluxes, rounding);
        Ok(AddingDoubling {
            tau,
            albedo,
            phase: phase.clone(),
            incidence,
            solutions,
            reflectance,
            transmittance_direct,
            transmittance_diffuse,
            absorptance,
            rounding,
            ladder: OnceLock::new(),
        })
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// How the medium scatters.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// How the light falls on the lit face.
    pub fn incidence(&self) -> Incidence {
        self.incidence
    }

    /// Fraction of the incident power that leaves through the lit face \[1\].
    pub fn reflectance(&self) -> Value {
        self.reflectance
    }

    /// Fraction of the incident power that leaves through the far face, direct light included \[1\].
    pub fn transmittance(&self) -> Value {
        self.transmittance_direct.plus(self.transmittance_diffuse, METHOD)
    }

    /// Fraction of the incident power that crosses the slab without a collision \[1\].
    pub fn transmittance_direct(&self) -> Value {
        self.transmittance_direct
    }

    /// Fraction of the incident power that leaves through the far face after at least one scattering \[1\].
    pub fn transmittance_diffuse(&self) -> Value {
        self.transmittance_diffuse
    }

    /// Fraction of the incident power that is absorbed \[1\].
    pub fn absorptance(&self) -> Value {
        self.absorptance
    }

    /// Fluence at depth t, direct light included, per unit irradiance on the lit face \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        check_depth(t, self.tau)?;
        let [fine, coarse] = self.pair(t);
        let ladder = self.ladder.get_or_init(|| {
            let depths = depths(self.tau);
            depths.into_iter().map(|t| (t, self.difference(t))).collect()
        });
        // The difference swings about zero with ln t, with a period of about a step of the ladder, and so it does with ln(tau - t):
        // near one face it says nothing of the light from afar, which the middle depths do.
        let at = ladder.partition_point(|&(depth, _)| depth < t);
        let middle = ladder.len() / 2;
        let near = ladder[at.saturating_sub(2)..(at + 2).min(ladder.len())]
            .iter()
            .chain(&ladder[middle - 1..=middle + 1]);
        let shared = near.fold(0.0, |a: f64, &(_, d)| a.max(d)) + self.rounding;
        let error = (fine - coarse).abs() + shared * fine.abs();
        Ok(Value::new(fine, error + f64::MIN_POSITIVE, METHOD))
    }

    fn pair(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|i| self.solutions[i].fluence(t, self.incidence))
    }

    fn difference(&self, t: f64) -> f64 {
        let [fine, coarse] = self.pair(t);
        if fine == 0.0 { 0.0 } else { ((fine - coarse) / fine).abs() }
    }
}

/// Depths that rise from the lit face and fall towards the far one by a factor of eight each.
pub(crate) fn depths(tau: f64) -> Vec<f64> {
    let smallest = 1e-9 * tau.min(1.0);
    let mut near: Vec<f64> =
        std::iter::successors(Some(0.25 * tau), |&t| (t > smallest).then_some(0.125 * t)).collect();
    near.push(0.0);
    let far: Vec<f64> = near.iter().map(|t| tau - t).collect();
    near.reverse();
    near.push(0.5 * tau);
    near.extend(far);
    near
}

/// The last Legendre moment that the finer and the coarser nodes see.
pub(crate) fn degrees(phase: &Phase) -> Result<[usize; 2]> {
    let cut = if phase.degree(CUT[0], MOST) < MOST { CUT } else { CUT_PEAKED };
    let left = phase.moment(MOST + 1).abs();
    const ALLOWED: &str = "at most 1e-9 with adding and doubling or refracting faces (|g| = 0.95)";
    within("Legendre moment 451 of the phase function", left, 0.0, CUT_PEAKED[0], ALLOWED)?;
    Ok(cut.map(|cut| phase.degree(cut, MOST)))
}

/// Nodes above the horizon that follow moments up to `degree`.
pub(crate) fn upper(set: usize, degree: usize) -> usize {
    UPPER[set].max(5 + degree / 2)
}

/// The vector of the light that enters: a beam in the first user's direction, or radiance 1/pi.
pub(crate) fn entering(nodes: &Nodes, incidence: Incidence) -> DVector<f64> {
    let root = |i: usize| sqrt(nodes.mu[i] * nodes.weight[i]);
    DVector::from_fn(nodes.len(), |i, _| match incidence {
        Incidence::Beam { .. } if i == nodes.count => 1.0 / (2.0 * PI * root(i)),
        Incidence::Diffuse if i < nodes.count => root(i) / PI,
        _ => 0.0,
    })
}

impl Solution {
    /// Power per area that a vector of light carries through a plane.
    fn power(&self, u: &DVector<f64>) -> f64 {
        let nodes = &self.stack.nodes;
        let sum: f64 = (0..nodes.count).map(|i| sqrt(nodes.mu[i] * nodes.weight[i]) * u[i]).sum();
        2.0 * PI * sum
    }

    fn reflectance(&self) -> f64 {
        self.power(&(self.stack.reflected() * &self.entering))
    }

    fn transmittance_diffuse(&self) -> f64 {
        self.power(&(self.stack.scattered() * &self.entering))
    }

    fn absorptance(&self) -> f64 {
        2.0 * PI * self.stack.absorbed().dot(&self.entering)
    }

    /// Fluence, with the direct light as it is and not as the nodes have it.
    fn fluence(&self, t: f64, incidence: Incidence) -> f64 {
        let nodes = &self.stack.nodes;
        let dark = DVector::zeros(nodes.len());
        let (down, up) = self.stack.field(t, self.entering.clone(), dark);
        let light = down + up;
        let sum: f64 = (0..nodes.count).map(|i| sqrt(nodes.weight[i] / nodes.mu[i]) * light[i]).sum();
        let direct = match incidence {
            Incidence::Beam { .. } => 0.0,
            Incidence::Diffuse => 2.0 * nodes.sum(|mu| libm::exp(-t / mu)),
        };
        2.0 * PI * sum - direct + direct_fluence(incidence, t)
    }
}

/// R, diffuse T and A with their bounds: each the difference of the two solutions, plus the largest difference of the
/// three, absolute or relative to each, whichever is less.
fn bounded<const N: usize>(fluxes: [[f64; 2]; N], rounding: f64) -> [Value; N] {
    let differences = fluxes.map(|[fine, coarse]| (fine - coarse).abs());
    let largest = differences.iter().fold(0.0, |a: f64, &b| a.max(b));
    let relative = fluxes
        .iter()
        .zip(&differences)
        .filter(|(flux, _)| flux[0] != 0.0)
        .fold(0.0, |a: f64, (flux, d)| a.max(d / flux[0].abs()));
    std::array::from_fn(|i| {
        let fine = fluxes[i][0];
        let shared = largest.min(relative * fine.abs());
        Value::new(fine, differences[i] + shared + rounding * fine.abs() + f64::MIN_POSITIVE, METHOD)
    })
}
