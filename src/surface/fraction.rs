//! Fractions of light.

use crate::Spectrum;
use crate::error::{Error, Result};

/// A fraction whose channels are all in [0, 1].
pub(super) fn checked(name: &'static str, fraction: Spectrum) -> Result<Spectrum> {
    match (0..3).map(|c| fraction[c]).find(|r| !(0.0..=1.0).contains(r)) {
        Some(bad) => Err(Error::out_of_range(name, bad, "0 to 1")),
        None => Ok(fraction),
    }
}
