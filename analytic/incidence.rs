//! How light falls on the lit face: a beam, or from everywhere.

use crate::error::{Result, within};

/// Light on the lit face t = 0, of unit irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Incidence {
    /// A collimated beam whose cosine to the inward normal is `mu0`, 1e-300 to 1.
    Beam {
        /// Cosine of incidence \[1\].
        mu0: f64,
    },
    /// Radiance 1/pi from all directions outside (Lambertian).
    Diffuse,
}

impl Incidence {
    pub(crate) fn check(self) -> Result<Self> {
        if let Incidence::Beam { mu0 } = self {
            check_mu0(mu0)?;
        }
        Ok(self)
    }
}

/// A cosine whose inverse is finite.
pub(crate) fn check_mu0(mu0: f64) -> Result<f64> {
    within("mu0", mu0, 1e-300, 1.0, "1e-300 to 1, or diffuse")
}

pub(crate) fn check_tau(tau: f64) -> Result<f64> {
    within("tau", tau, 1e-12, 400.0, "1e-12 to 400")
}

pub(crate) fn check_albedo(albedo: f64) -> Result<f64> {
    within("albedo", albedo, 0.0, 1.0, "0 to 1")
}

pub(crate) fn check_depth(t: f64, tau: f64) -> Result<f64> {
    within("t", t, 0.0, tau, "0 to tau")
}

pub(crate) fn check_mu(mu: f64) -> Result<f64> {
    within("mu", mu, -1.0, 1.0, "-1 to 1")
}
