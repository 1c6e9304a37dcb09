//! A slab by whichever method serves the question.

use crate::phase::Named;
use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use turbid_analytic::{AddingDoubling, AnisotropicMedium, AnisotropicSlab, Incidence, IsotropicSlab, Value};

/// How a slab is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Isotropic: Peierls, above a thickness of 2 the better known of both, above 400 ordinates; others: ordinates.
    Auto,
    /// The Peierls equation (isotropic scattering).
    Peierls,
    /// Discrete ordinates.
    Ordinates,
    /// Adding and doubling, the second method of all slabs (thickness up to 100).
    Doubling,
}

/// Thickness up to which the Peierls equation is solved.
pub const PEIERLS_UP_TO: f64 = 400.0;

/// Thickness above which the Peierls equation, whose bound is absolute, loses to discrete ordinates in faint light.
pub const THICK: f64 = 2.0;

/// A solved slab.
pub enum Solved {
    /// By the Peierls equation.
    Peierls(IsotropicSlab),
    /// By discrete ordinates.
    Ordinates(AnisotropicSlab),
    /// By both, of which each value takes the one with the smaller bound.
    Both(Box<IsotropicSlab>, Box<AnisotropicSlab>),
    /// By adding and doubling.
    Doubling(AddingDoubling),
}

impl Solved {
    /// Solves a slab.
    pub fn new(tau: f64, albedo: f64, named: &Named, incidence: Incidence, method: Method) -> Result<Self> {
        let isotropic = named.is_isotropic();
        ensure!(
            method != Method::Auto || (1e-12..=1e9).contains(&tau),
            "tau is {tau}; allowed: 1e-12 to 1e9"
        );
        if method == Method::Peierls && !isotropic {
            bail!("phase function is {}; allowed with --method peierls: isotropic", named.name);
        }
        if method == Method::Peierls || method == Method::Auto && isotropic && tau <= PEIERLS_UP_TO {
            let slab = IsotropicSlab::new(tau, albedo, incidence)?;
            return Ok(match method {
                Method::Auto => Self::isotropic(slab, tau, || {
                    AnisotropicMedium::new(albedo, &named.phase)?.slab(tau, incidence)
                }),
                _ => Solved::Peierls(slab),
            });
        }
        if method == Method::Doubling {
            return Ok(Solved::Doubling(AddingDoubling::with_phase(tau, albedo, &named.phase, incidence)?));
        }
        Ok(Solved::Ordinates(AnisotropicMedium::new(albedo, &named.phase)?.slab(tau, incidence)?))
    }

    /// An isotropic slab with a second solution where that may know more; discrete ordinates leave out grazing beams.
    pub fn isotropic(
        slab: IsotropicSlab,
        tau: f64,
        ordinates: impl FnOnce() -> turbid_analytic::Result<AnisotropicSlab>,
    ) -> Self {
        if tau <= THICK {
            return Solved::Peierls(slab);
        }
        match ordinates() {
            Ok(other) => Solved::Both(Box::new(slab), Box::new(other)),
            Err(_) => Solved::Peierls(slab),
        }
    }

    /// Fraction sent back.
    pub fn reflectance(&self) -> Value {
        match self {
            Solved::Peierls(slab) => slab.reflectance(),
            Solved::Ordinates(slab) => slab.reflectance(),
            Solved::Doubling(slab) => slab.reflectance(),
            Solved::Both(a, b) => better(a.reflectance(), b.reflectance()),
        }
    }

    /// Fraction let through, direct light included.
    pub fn transmittance(&self) -> Value {
        match self {
            Solved::Peierls(slab) => slab.transmittance(),
            Solved::Ordinates(slab) => slab.transmittance(),
            Solved::Doubling(slab) => slab.transmittance(),
            Solved::Both(a, b) => better(a.transmittance(), b.transmittance()),
        }
    }

    /// Fraction let through without a collision.
    pub fn transmittance_direct(&self) -> Value {
        match self {
            Solved::Peierls(slab) => slab.transmittance_direct(),
            Solved::Ordinates(slab) => slab.transmittance_direct(),
            Solved::Doubling(slab) => slab.transmittance_direct(),
            Solved::Both(a, b) => better(a.transmittance_direct(), b.transmittance_direct()),
        }
    }

    /// Fraction let through after scattering.
    pub fn transmittance_diffuse(&self) -> Value {
        match self {
            Solved::Peierls(slab) => slab.transmittance_diffuse(),
            Solved::Ordinates(slab) => slab.transmittance_diffuse(),
            Solved::Doubling(slab) => slab.transmittance_diffuse(),
            Solved::Both(a, b) => better(a.transmittance_diffuse(), b.transmittance_diffuse()),
        }
    }

    /// Fraction absorbed.
    pub fn absorptance(&self) -> Value {
        match self {
            Solved::Peierls(slab) => slab.absorptance(),
            Solved::Ordinates(slab) => slab.absorptance(),
            Solved::Doubling(slab) => slab.absorptance(),
            Solved::Both(a, b) => better(a.absorptance(), b.absorptance()),
        }
    }

    /// Fluence at a depth, direct light included.
    pub fn fluence(&self, t: f64) -> Result<Value> {
        Ok(match self {
            Solved::Peierls(slab) => slab.fluence(t)?,
            Solved::Ordinates(slab) => slab.fluence(t)?,
            Solved::Doubling(slab) => slab.fluence(t)?,
            Solved::Both(a, b) => better(a.fluence(t)?, b.fluence(t)?),
        })
    }

    /// Net flux downwards at a depth, direct light included.
    pub fn flux(&self, t: f64) -> Result<Value> {
        match self {
            Solved::Ordinates(slab) => Ok(slab.flux(t)?),
            Solved::Both(_, slab) => Ok(slab.flux(t)?),
            Solved::Peierls(_) | Solved::Doubling(_) => bail!("net flux is answered by --method ordinates"),
        }
    }

    /// Radiance of scattered light.
    pub fn radiance(&self, t: f64, mu: f64, dphi: f64) -> Result<Value> {
        Ok(match self {
            Solved::Peierls(slab) => slab.radiance(t, mu)?,
            Solved::Doubling(slab) => slab.radiance(t, mu, dphi)?,
            Solved::Ordinates(slab) => slab.radiance(t, mu, dphi)?,
            Solved::Both(a, b) => better(a.radiance(t, mu)?, b.radiance(t, mu, dphi)?),
        })
    }
}

/// The value with the smaller bound.
pub fn better(a: Value, b: Value) -> Value {
    if a.error <= b.error { a } else { b }
}
