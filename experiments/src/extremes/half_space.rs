//! Slabs too thick for a solution in depth: half-spaces, and thick slabs without absorption, isotropic scattering.

use turbid_analytic::{Asymptotics, HalfSpace, Incidence};

/// Reflectance of a half-space under a beam, with its bound.
pub fn half_space_reflectance(mu0: f64, albedo: f64) -> anyhow::Result<(f64, f64)> {
    let r = HalfSpace::new(albedo)?.reflectance(Incidence::Beam { mu0 })?;
    Ok((r.value, r.error))
}

/// Transmittance of a thick slab without absorption under a beam, with its bound.
pub fn thick_white_transmittance(mu0: f64, tau: f64) -> anyhow::Result<(f64, f64)> {
    let t = Asymptotics::isotropic(1.0)?.slab(tau, Incidence::Beam { mu0 })?.transmittance;
    Ok((t.value, t.error))
}
