//! A medium that is the same everywhere.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::phase::Phase;

/// Extinction, albedo, phase function and emission, the same at every point.
#[derive(Debug, Clone, PartialEq)]
pub struct Homogeneous {
    sigma_t: Spectrum,
    albedo: Spectrum,
    phase: Phase,
    emission: Spectrum,
}

/// An emission coefficient: finite and not negative in every channel.
pub(super) fn check_emission(emission: Spectrum) -> Result<()> {
    match (0..3).map(|c| emission[c]).find(|e| !(*e >= 0.0 && e.is_finite())) {
        Some(bad) => Err(Error::out_of_range("emission of a medium", bad, "finite and at least 0")),
        None => Ok(()),
    }
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
        Ok(Homogeneous { sigma_t, albedo, phase, emission: Spectrum::ZERO })
    }

    /// The same medium, emitting [W/(L^3 sr)] alike in all directions.
    ///
    /// # Errors
    /// `Error::OutOfRange` if a channel is negative or not finite.
    pub fn with_emission(self, emission: Spectrum) -> Result<Self> {
        check_emission(emission)?;
        Ok(Homogeneous { emission, ..self })
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

    /// Emission coefficient [W/(L^3 sr)].
    pub fn emission(&self) -> Spectrum {
        self.emission
    }

    /// Optical depth of a length \[1\]: 0 where nothing extinguishes, however long it is.
    #[inline]
    pub fn depth(&self, length: f64) -> Spectrum {
        self.sigma_t.map(|s| if s == 0.0 { 0.0 } else { s * length })
    }

    /// Phase function.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }
}
