//! A medium that is the same everywhere.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::phase::Phase;

/// Extinction, albedo and phase function, the same at every point.
#[derive(Debug, Clone, PartialEq)]
pub struct Homogeneous {
    sigma_t: Spectrum,
    albedo: Spectrum,
    phase: Phase,
}

impl Homogeneous {
    /// A medium of extinction `sigma_t` [1/L] and single-scattering albedo \[1\], by channel.
    ///
    /// # Errors
    /// `Error::OutOfRange` if an extinction is negative or not finite, or an albedo outside 0 to 1.
    pub fn new(sigma_t: Spectrum, albedo: Spectrum, phase: Phase) -> Result<Self> {
        for channel in 0..3 {
            let (s, a) = (sigma_t[channel], albedo[channel]);
            if !(s >= 0.0 && s.is_finite()) {
                return Err(Error::out_of_range("sigma_t", s, "finite and at least 0"));
            }
            if !(0.0..=1.0).contains(&a) {
                return Err(Error::out_of_range("albedo", a, "0 to 1"));
            }
        }
        Ok(Homogeneous { sigma_t, albedo, phase })
    }

    /// Extinction coefficient [1/L].
    pub fn sigma_t(&self) -> Spectrum {
        self.sigma_t
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> Spectrum {
        self.albedo
    }

    /// Absorption coefficient [1/L].
    pub fn sigma_a(&self) -> Spectrum {
        self.sigma_t * (Spectrum::ONE - self.albedo)
    }

    /// Phase function.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }
}
