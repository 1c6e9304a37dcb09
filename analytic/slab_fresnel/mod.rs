//! The homogeneous slab between two smooth faces that refract: index n inside over 1 outside, the same on both sides.
//!
//! Within the slab light obeys the equation of [`crate::AnisotropicSlab`]; at each face a share r(mu) of it returns,
//!
//! I(0, -mu) = r(mu) I(0, mu) + entering light,  I(tau, mu) = r(mu) I(tau, -mu),  mu > 0
//!
//! with Fresnel's reflectance for unpolarised light. For n > 1 all light below the critical cosine
//! mu_c = root(1 - 1/n^2) returns; for n < 1 it is light from outside below root(1 - n^2) that never enters. A beam is
//! refracted to the cosine root(1 - (1 - mu0^2)/n^2) and goes to and fro as (1-r)/(1 - r^2 e^(-2 tau/mu)) of itself;
//! Lambertian light from outside has the radiance (1-r) n^2/pi inside, where it enters. What leaves is
//! (1-r) times what arrives at a face, per solid angle outside 1/n^2 times that.
//!
//! The directions are chosen so that the critical cosine is the edge of a rule in the root of mu - mu_c. Every answer
//! is computed on two sets of nodes, whose difference is the bound: by the modes of discrete ordinates, or by the
//! reflection and transmission that adding and doubling make, closed by the faces. The second is the first for thin
//! slabs, where modes give small differences of large numbers.
//!
//! Limits: n = 1 is [`crate::AnisotropicSlab`]; albedo 0 a plate of glass; albedo 1: R + T = 1; tau -> infinity:
//! reflection of a half-space behind a face.
//!
//! Source: Giovanelli 1955; van de Hulst 1980, chapter 4 (adding with a surface); Prahl, van Gemert and Welch 1993.

mod direct;
mod doubling;
pub(crate) mod face;
mod fluxes;
mod ordinates;
#[cfg(test)]
mod tests;

use crate::adding_doubling::degrees;
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo, check_depth};
use crate::phase::Phase;
use crate::slab_anisotropic::scattering::Scattering;
use crate::value::Value;
use direct::Direct;
use doubling::Closed;
use face::{Face, Rule};
use fluxes::{Fluxes, Light};
use ordinates::Matched;
use std::sync::{Arc, OnceLock};

const ORDINATES: &str = "discrete ordinates between refracting faces, two node counts";
const DOUBLING: &str = "adding and doubling between refracting faces, two node counts";

/// Below this thickness doubling is the first method too; with more moments than that, below this one.
const THIN: f64 = 1e-3;
const PEAKED: usize = 300;
const THIN_PEAKED: f64 = 1e-5;

/// Nodes towards the horizon, and the fewest of each panel above it.
const LOWER: [usize; 2] = [56, 46];
const UPPER: [usize; 2] = [36, 29];

enum Solution {
    Ordinates(Box<Matched>),
    Doubling(Box<Closed>),
}

impl Solution {
    fn fluxes(&self) -> Fluxes {
        match self {
            Solution::Ordinates(solution) => solution.fluxes(),
            Solution::Doubling(solution) => solution.fluxes(),
        }
    }

    fn fluence(&self, t: f64, direct: &Direct) -> Light {
        match self {
            Solution::Ordinates(solution) => solution.fluence(t, direct),
            Solution::Doubling(solution) => solution.fluence(t, direct),
        }
    }
}

/// A solved slab between refracting faces.
pub struct FresnelSlab {
    direct: Direct,
    index: f64,
    albedo: f64,
    phase: Phase,
    method: &'static str,
    solutions: [Solution; 2],
    specular: Value,
    reflectance_direct: Value,
    reflectance_diffuse: Value,
    transmittance_direct: Value,
    transmittance_diffuse: Value,
    absorptance: Value,
    /// Depths in rising order, and the relative difference of the two fluences of scattered light there.
    ladder: OnceLock<Vec<(f64, f64)>>,
}

impl FresnelSlab {
    /// Solves the slab with Henyey-Greenstein scattering.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e5; `albedo` 0 to 1; `g` mean cosine of scattering, -0.95 to 0.95;
    /// `index` refractive index inside over outside \[1\], 0.25 to 4; `incidence` from outside, of unit irradiance, a
    /// beam with a cosine of 1e-5 to 1, refracted to one of 1e-5 to 1 or reflected whole
    /// # Returns
    /// a solution with errors below 1e-10 of themselves for most slabs; the bounds say how much. It takes some tens of
    /// milliseconds, two seconds at |g| = 0.95. Scattered light of a slab thicker than 100 of albedo below 1e-4 in
    /// diffuse light is known to 1e-14 of the incident power only
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `g`, `index` or `mu0`
    pub fn new(tau: f64, albedo: f64, g: f64, index: f64, incidence: Incidence) -> Result<Self> {
        within("g", g, -0.95, 0.95, "-0.95 to 0.95 between refracting faces")?;
        Self::with_phase(tau, albedo, &Phase::henyey_greenstein(g)?, index, incidence)
    }

    /// Solves the slab with any phase function.
    ///
    /// # Arguments
    /// as for [`Self::new`]; `phase` any whose Legendre moments beyond l = 450 are below 1e-9
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `phase function`, `index` or `mu0`
    pub fn with_phase(
        tau: f64,
        albedo: f64,
        phase: &Phase,
        index: f64,
        incidence: Incidence,
    ) -> Result<Self> {
        within("tau", tau, 1e-12, 1e5, "1e-12 to 1e5 between refracting faces")?;
        let peaked = degrees(phase)?[0] > PEAKED;
        let (thin, digits) = if peaked { (THIN_PEAKED, 1e-9) } else { (THIN, 1e-11) };
        let slab = Self::solve(tau, albedo, phase, index, incidence, tau < thin)?;
        // Little light scattered out of much light on its way: a difference in discrete ordinates.
        if slab.method == ORDINATES && tau <= 100.0 && slab.solutions[0].fluxes().loses(digits) {
            return Self::solve(tau, albedo, phase, index, incidence, true);
        }
        Ok(slab)
    }

    /// Solves the slab by adding and doubling, whatever its thickness: the second method.
    ///
    /// # Arguments
    /// as for [`Self::with_phase`], `tau` 1e-12 to 100
    /// # Errors
    /// as for [`Self::with_phase`]
    pub fn by_doubling(
        tau: f64,
        albedo: f64,
        phase: &Phase,
        index: f64,
        incidence: Incidence,
    ) -> Result<Self> {
        within("tau", tau, 1e-12, 100.0, "1e-12 to 100 with adding and doubling")?;
        Self::solve(tau, albedo, phase, index, incidence, true)
    }

    fn solve(
        tau: f64,
        albedo: f64,
        phase: &Phase,
        index: f64,
        incidence: Incidence,
        doubling: bool,
    ) -> Result<Self> {
        check_albedo(albedo)?;
        check_index(index)?;
        let face = Face::new(index);
        if let Incidence::Beam { mu0 } = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 on a refracting face, or diffuse")?;
            if face.inside(mu0).is_some_and(|inside| inside < 1e-5) {
                within("mu0", mu0, 1.0, 1.0, "refracted to a cosine of 1e-5 or more, or reflected whole")?;
            }
        }
        let direct = Direct { face, tau, incidence };
        let degrees = degrees(phase)?;
        let solve = |i: usize| -> Result<Solution> {
            let power = if doubling { 5 } else { 4 };
            let rule = Rule { upper: UPPER[i], lower: LOWER[i], power, degree: degrees[i], tau };
            if doubling {
                let moments: Vec<f64> = (0..=degrees[i]).map(|l| phase.moment(l)).collect();
                return Ok(Solution::Doubling(Box::new(Closed::new(&direct, albedo, &moments, rule)?)));
            }
            let scattering = Arc::new(Scattering::new(albedo, phase, degrees[i], false));
            Ok(Solution::Ordinates(Box::new(Matched::new(&direct, scattering, face.nodes(rule))?)))
        };
        let solutions = [solve(0)?, solve(1)?];
        let method = if doubling { DOUBLING } else { ORDINATES };
        let pair = solutions.each_ref().map(Solution::fluxes);
        let fluxes = [pair.map(|f| f.reflected), pair.map(|f| f.transmitted), pair.map(|f| f.absorbed)];
        let [reflectance_diffuse, transmittance_diffuse, absorptance] = bounded(fluxes, method);
        Ok(FresnelSlab {
            specular: direct.specular()?,
            reflectance_direct: direct.returned()?,
            transmittance_direct: direct.transmitted()?,
            direct,
            index,
            albedo,
            phase: phase.clone(),
            method,
            solutions,
            reflectance_diffuse,
            transmittance_diffuse,
            absorptance,
            ladder: OnceLock::new(),
        })
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.direct.tau
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// How the medium scatters.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// Refractive index inside over outside \[1\].
    pub fn index(&self) -> f64 {
        self.index
    }

    /// How the light falls on the lit face, outside.
    pub fn incidence(&self) -> Incidence {
        self.direct.incidence
    }

    /// What the lit face reflects before any light enters \[1\]; of Lambertian light, the hemispherical reflectance.
    pub fn specular(&self) -> Value {
        self.specular
    }

    /// Fraction of the incident power that leaves on the lit side \[1\]: specular, unscattered from the far face, and
    /// scattered light.
    pub fn reflectance(&self) -> Value {
        self.sum(&[self.specular, self.reflectance_direct, self.reflectance_diffuse])
    }

    /// Fraction of the incident power that leaves through the lit face after at least one scattering \[1\].
    pub fn reflectance_diffuse(&self) -> Value {
        self.reflectance_diffuse
    }

    /// Fraction of the incident power that leaves through the far face \[1\].
    pub fn transmittance(&self) -> Value {
        self.sum(&[self.transmittance_direct, self.transmittance_diffuse])
    }

    /// Fraction of the incident power that leaves through the far face without scattering, echoes included \[1\].
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

    /// Fluence in the medium at depth t, per unit irradiance on the lit face from outside \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        check_depth(t, self.direct.tau)?;
        let [fine, coarse] = self.pair(t);
        let ladder = self.ladder.get_or_init(|| {
            let depths = crate::adding_doubling::depths(self.direct.tau);
            depths.into_iter().map(|t| (t, self.difference(t))).collect()
        });
        let at = ladder.partition_point(|&(depth, _)| depth < t);
        let near = &ladder[at.saturating_sub(2)..(at + 2).min(ladder.len())];
        let shared = near.iter().fold(0.0, |a: f64, &(_, d)| a.max(d)) * fine.value.abs();
        let error = (fine.value - coarse.value).abs() + shared + fine.rounding();
        let scattered = Value::new(fine.value, error + f64::MIN_POSITIVE, self.method);
        Ok(self.sum(&[self.direct.fluence(t)?, scattered]))
    }

    fn pair(&self, t: f64) -> [Light; 2] {
        self.solutions.each_ref().map(|solution| solution.fluence(t, &self.direct))
    }

    fn difference(&self, t: f64) -> f64 {
        let [fine, coarse] = self.pair(t).map(|light| light.value);
        if fine == 0.0 { 0.0 } else { ((fine - coarse) / fine).abs() }
    }

    fn sum(&self, parts: &[Value]) -> Value {
        let value: f64 = parts.iter().map(|p| p.value).sum();
        let error: f64 = parts.iter().map(|p| p.error).sum();
        Value::new(value, error + 2.0 * f64::EPSILON * value.abs(), self.method)
    }
}

/// R, T and A of scattered light with their bounds: each the difference of the two solutions, plus the largest
/// difference of the three, absolute or relative to each, whichever is less.
fn bounded(fluxes: [[Light; 2]; 3], method: &'static str) -> [Value; 3] {
    let differences = fluxes.map(|[fine, coarse]| (fine.value - coarse.value).abs());
    let largest = differences.iter().fold(0.0, |a: f64, &b| a.max(b));
    let relative = fluxes
        .iter()
        .zip(&differences)
        .filter(|(flux, _)| flux[0].value != 0.0)
        .fold(0.0, |a: f64, (flux, d)| a.max(d / flux[0].value.abs()));
    std::array::from_fn(|i| {
        let fine = fluxes[i][0];
        let shared = largest.min(relative * fine.value.abs());
        let error = differences[i] + shared + fine.rounding() + f64::MIN_POSITIVE;
        Value::new(fine.value, error, method)
    })
}

pub(crate) fn check_index(index: f64) -> Result<f64> {
    within("index", index, 0.25, 4.0, "0.25 to 4, inside over outside")
}

/// Reflectance of a smooth face for Lambertian light \[1\]: from outside, or from inside.
///
/// The mean of Fresnel's reflectance, int 2 mu r dmu; from the denser side light beyond the critical angle returns
/// whole. Light that passes, seen from both sides, gives n^2 (1 - r_inside) = 1 - r_outside.
/// # Arguments
/// `index` refractive index inside over outside \[1\], 0.25 to 4
/// # Errors
/// `Error::OutOfRange` naming `index`
/// # Source
/// Walsh 1926; Duntley 1942
pub fn hemispherical_reflectance(index: f64, from_outside: bool) -> Result<Value> {
    check_index(index)?;
    Face::new(index).diffuse(from_outside)
}
