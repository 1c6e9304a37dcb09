//! Coloured glass without thickness.

use super::lambertian::checked;
use crate::Spectrum;
use crate::error::Result;
use glam::{DVec2, DVec3};

/// Lets a fraction of the light pass straight on, by channel, and absorbs the rest: stained glass. It bends nothing and
/// is no event of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    transmittance: Spectrum,
}

impl Filter {
    /// A filter of the given transmittance \[1\], each channel in [0, 1].
    pub fn new(transmittance: Spectrum) -> Result<Self> {
        Ok(Filter { transmittance: checked("transmittance", transmittance)? })
    }

    /// Fraction of the arriving light that passes, at a point \[L\] with these surface parameters.
    pub fn transmittance(&self, _position: DVec3, _uv: DVec2) -> Spectrum {
        self.transmittance
    }

    /// An upper bound of the transmittance, over the whole surface.
    pub fn largest_transmittance(&self) -> Spectrum {
        self.transmittance
    }
}
