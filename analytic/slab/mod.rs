//! The homogeneous slab by whichever method knows it best: the Peierls equation, discrete ordinates, or both.
//!
//! Isotropic scattering up to a thickness of 400: the Peierls equation, whose bound is absolute. Where light may be faint,
//! above a thickness of 2, the slab is solved by discrete ordinates too, and every value is the one with the smaller bound.
//! All other slabs: discrete ordinates. Net fluxes at a depth are known by discrete ordinates alone.

mod orders;

use crate::adding_doubling::AddingDoubling;
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo};
use crate::phase::Phase;
use crate::slab_anisotropic::{AnisotropicMedium, AnisotropicSlab};
use crate::slab_isotropic::IsotropicSlab;
use crate::value::Value;
pub use orders::SlabOrders;
use std::sync::{Arc, OnceLock};

/// Thickness up to which the Peierls equation is solved.
const PEIERLS_UP_TO: f64 = 400.0;

/// Thickness above which the Peierls equation, whose bound is absolute, loses to discrete ordinates in faint light.
const THICK: f64 = 2.0;

/// An albedo and a phase function, whose modes are solved when a slab first needs them. Cloning shares them.
#[derive(Clone)]
pub struct SlabMedium(Arc<Medium>);

struct Medium {
    albedo: f64,
    phase: Phase,
    modes: OnceLock<Result<AnisotropicMedium>>,
}

impl SlabMedium {
    /// A medium; nothing is solved yet.
    ///
    /// # Arguments
    /// `albedo` 0 to 1; `phase` as for [`AnisotropicMedium::new`], isotropic scattering apart
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`
    pub fn new(albedo: f64, phase: &Phase) -> Result<Self> {
        check_albedo(albedo)?;
        Ok(SlabMedium(Arc::new(Medium { albedo, phase: phase.clone(), modes: OnceLock::new() })))
    }

    /// The medium of discrete ordinates.
    fn modes(&self) -> Result<&AnisotropicMedium> {
        let solved = self.0.modes.get_or_init(|| AnisotropicMedium::new(self.0.albedo, &self.0.phase));
        solved.as_ref().map_err(Clone::clone)
    }

    fn serves_peierls(&self, tau: f64) -> bool {
        self.0.phase.is_isotropic() && tau <= PEIERLS_UP_TO
    }
}

/// A solved slab: fluxes, fluence and radiance, each by the method that knows it best.
pub struct Slab {
    medium: SlabMedium,
    tau: f64,
    incidence: Incidence,
    solution: Solution,
    /// Discrete ordinates for the net flux, where the solution has none.
    flux: OnceLock<Result<AnisotropicSlab>>,
}

enum Solution {
    Peierls(Box<IsotropicSlab>),
    Ordinates(Box<AnisotropicSlab>),
    Both(Box<IsotropicSlab>, Box<AnisotropicSlab>),
    Doubling(Box<AddingDoubling>),
}

/// The value with the smaller bound.
fn better(a: Value, b: Value) -> Value {
    if a.error <= b.error { a } else { b }
}

/// Asks the solution, and where there are two the better of both.
macro_rules! best {
    ($slab:expr, |$one:ident| $ask:expr) => {
        match &$slab.solution {
            Solution::Peierls($one) => $ask,
            Solution::Ordinates($one) => $ask,
            Solution::Doubling($one) => $ask,
            Solution::Both(first, second) => {
                let ($one, second) = (first, second);
                let first = $ask;
                let $one = second;
                better(first, $ask)
            }
        }
    };
}

impl Slab {
    /// Solves a slab by the method, or the two methods, that know it best.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e9; `incidence` of unit irradiance, with a beam's cosine of 1e-5 to 1, or
    /// of any above 0 where the Peierls equation is solved
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `mu0` or a Legendre moment
    pub fn solve(tau: f64, medium: &SlabMedium, incidence: Incidence) -> Result<Self> {
        Self::solve_beside(tau, medium, incidence, None)
    }

    /// The slab of the same thickness with another medium or incidence: saves building the operator of the Peierls equation.
    ///
    /// # Errors
    /// as [`Self::solve`]
    pub fn with(&self, medium: &SlabMedium, incidence: Incidence) -> Result<Self> {
        let beside = match &self.solution {
            Solution::Peierls(slab) | Solution::Both(slab, _) => Some(slab.as_ref()),
            Solution::Ordinates(_) | Solution::Doubling(_) => None,
        };
        Self::solve_beside(self.tau, medium, incidence, beside)
    }

    fn solve_beside(
        tau: f64,
        medium: &SlabMedium,
        incidence: Incidence,
        beside: Option<&IsotropicSlab>,
    ) -> Result<Self> {
        within("tau", tau, 1e-12, 1e9, "1e-12 to 1e9")?;
        if !medium.serves_peierls(tau) {
            return Self::by_ordinates(tau, medium, incidence);
        }
        let slab = Box::new(match beside {
            Some(other) => other.with(medium.0.albedo, incidence)?,
            None => IsotropicSlab::new(tau, medium.0.albedo, incidence)?,
        });
        let ordinates = || medium.modes()?.slab(tau, incidence);
        // Discrete ordinates leave out grazing beams.
        let second = if tau > THICK { ordinates().ok() } else { None };
        let solution = match second {
            Some(other) => Solution::Both(slab, Box::new(other)),
            None => Solution::Peierls(slab),
        };
        Ok(Self::of(tau, medium, incidence, solution))
    }

    /// Solves a slab of isotropic scattering by the Peierls equation alone.
    ///
    /// # Errors
    /// as [`IsotropicSlab::new`]
    pub fn by_peierls(tau: f64, albedo: f64, incidence: Incidence) -> Result<Self> {
        let slab = Box::new(IsotropicSlab::new(tau, albedo, incidence)?);
        let medium = SlabMedium::new(albedo, &Phase::isotropic())?;
        Ok(Self::of(tau, &medium, incidence, Solution::Peierls(slab)))
    }

    /// Solves a slab by discrete ordinates alone.
    ///
    /// # Errors
    /// as [`AnisotropicMedium::new`] and [`AnisotropicMedium::slab`]
    pub fn by_ordinates(tau: f64, medium: &SlabMedium, incidence: Incidence) -> Result<Self> {
        let slab = medium.modes()?.slab(tau, incidence)?;
        Ok(Self::of(tau, medium, incidence, Solution::Ordinates(Box::new(slab))))
    }

    /// Solves a slab by adding and doubling.
    ///
    /// # Errors
    /// as [`AddingDoubling::with_phase`]
    pub fn by_doubling(tau: f64, medium: &SlabMedium, incidence: Incidence) -> Result<Self> {
        let slab = AddingDoubling::with_phase(tau, medium.0.albedo, &medium.0.phase, incidence)?;
        Ok(Self::of(tau, medium, incidence, Solution::Doubling(Box::new(slab))))
    }

    fn of(tau: f64, medium: &SlabMedium, incidence: Incidence, solution: Solution) -> Self {
        Slab { medium: medium.clone(), tau, incidence, solution, flux: OnceLock::new() }
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Fraction of the incident power that leaves through the lit face \[1\].
    pub fn reflectance(&self) -> Value {
        best!(self, |slab| slab.reflectance())
    }

    /// Fraction of the incident power that leaves through the far face, direct light included \[1\].
    pub fn transmittance(&self) -> Value {
        best!(self, |slab| slab.transmittance())
    }

    /// Fraction of the incident power that crosses the slab without a collision \[1\].
    pub fn transmittance_direct(&self) -> Value {
        best!(self, |slab| slab.transmittance_direct())
    }

    /// Fraction of the incident power that leaves through the far face after scattering \[1\].
    pub fn transmittance_diffuse(&self) -> Value {
        best!(self, |slab| slab.transmittance_diffuse())
    }

    /// Fraction of the incident power that is absorbed \[1\].
    pub fn absorptance(&self) -> Value {
        best!(self, |slab| slab.absorptance())
    }

    /// Fluence at depth t, direct light included, per unit irradiance on the lit face \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        Ok(best!(self, |slab| slab.fluence(t)?))
    }

    /// Net flux downwards at depth t, direct light included, per unit irradiance \[1\]; by discrete ordinates.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`, or what discrete ordinates leave out: `mu0` below 1e-5
    pub fn flux(&self, t: f64) -> Result<Value> {
        match &self.solution {
            Solution::Ordinates(slab) | Solution::Both(_, slab) => slab.flux(t),
            Solution::Peierls(_) | Solution::Doubling(_) => {
                let solve = || self.medium.modes()?.slab(self.tau, self.incidence);
                self.flux.get_or_init(solve).as_ref().map_err(Clone::clone)?.flux(t)
            }
        }
    }

    /// Radiance of scattered light, per unit irradiance \[1/sr\].
    ///
    /// # Arguments
    /// `t` depth, 0 to tau; `mu` signed cosine, above 0 towards the lit face; `dphi` azimuth of propagation minus that of
    /// the beam, which isotropic scattering does not tell apart
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu` or `dphi`
    pub fn radiance(&self, t: f64, mu: f64, dphi: f64) -> Result<Value> {
        match &self.solution {
            Solution::Peierls(slab) => slab.radiance(t, mu),
            Solution::Ordinates(slab) => slab.radiance(t, mu, dphi),
            Solution::Doubling(slab) => slab.radiance(t, mu, dphi),
            Solution::Both(a, b) => Ok(better(a.radiance(t, mu)?, b.radiance(t, mu, dphi)?)),
        }
    }
}
