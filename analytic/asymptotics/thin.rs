//! Thin slabs: light is scattered once, and the rest is bounded.

use crate::beer_lambert::direct_transmittance;
use crate::error::{Result, within};
use crate::exponential_integral::e_n;
use crate::incidence::{Incidence, check_albedo};
use crate::slab_single::{single_reflectance, single_transmittance};
use crate::value::Value;
use libm::expm1;

const METHOD: &str = "single scattering, further orders bounded";

/// Fluxes of a thin slab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinSlab {
    /// Fraction of the incident power that leaves through the lit face \[1\].
    pub reflectance: Value,
    /// Fraction that leaves through the far face, direct light included \[1\].
    pub transmittance: Value,
    /// Fraction that leaves through the far face after at least one scattering \[1\].
    pub transmittance_diffuse: Value,
}

/// A slab of isotropic scattering as if no photon were scattered twice.
///
/// A photon that was scattered collides again before it leaves with a chance of at most c = 1 - E_2(tau/2), that of a
/// start in the middle; so that light of all further orders is at most w c/(1 - w c) of that which collides once.
/// # Arguments
/// `tau` \[1\], 1e-12 to 1; `albedo` 0 to 1; `incidence` of unit irradiance
/// # Errors
/// `Error::OutOfRange` naming `tau`, `albedo` or `mu0`
/// # Limits
/// tau -> 0: R = (w/2) tau/mu0, diffuse w tau
pub fn thin_slab(tau: f64, albedo: f64, incidence: Incidence) -> Result<ThinSlab> {
    within("tau", tau, 1e-12, 1.0, "1e-12 to 1 for a thin slab")?;
    check_albedo(albedo)?;
    let (up, down) =
        (single_reflectance(tau, albedo, incidence)?, single_transmittance(tau, albedo, incidence)?);
    let direct = direct_transmittance(incidence, tau)?;
    // 1 - E_2(x) = (1 - e^-x) + x E_1(x).
    let again = |x: f64| -expm1(-x) + x * e_n(1, x);
    let c = albedo * again(0.5 * tau) * (1.0 + 1e-14);
    let lit = match incidence {
        Incidence::Beam { mu0 } => -expm1(-tau / mu0),
        // What a diffuse beam loses: no more than 2 tau.
        Incidence::Diffuse => (2.0 * tau).min(1.0),
    };
    let rest = albedo * lit * c / (1.0 - c);
    let with = |v: Value| Value::new(v.value, v.error + rest, METHOD);
    let diffuse = with(down);
    let transmittance = direct.plus(diffuse, METHOD);
    Ok(ThinSlab { reflectance: with(up), transmittance, transmittance_diffuse: diffuse })
}
