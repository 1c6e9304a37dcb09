//! Coloured glass without thickness.

use super::Texture;
use crate::Spectrum;
use crate::error::Result;
use glam::{DVec2, DVec3};

/// Lets a fraction of the light pass straight on, by channel, and absorbs the rest: stained glass. It bends nothing and
/// is no event of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    transmittance: Texture,
}

impl Filter {
    /// A filter of the given transmittance \[1\], each channel in [0, 1].
    pub fn new(transmittance: Spectrum) -> Result<Self> {
        Ok(Filter { transmittance: Texture::constant("transmittance", transmittance)? })
    }

    /// A filter whose transmittance varies from place to place.
    pub fn textured(transmittance: Texture) -> Self {
        Filter { transmittance }
    }

    /// The transmittance over the whole surface.
    pub fn texture(&self) -> &Texture {
        &self.transmittance
    }

    /// Fraction of the arriving light that passes, at a point \[L\] with these surface parameters.
    pub fn transmittance(&self, position: DVec3, uv: DVec2) -> Spectrum {
        self.transmittance.at(position, uv)
    }

    /// An upper bound of the transmittance, over the whole surface.
    pub fn largest_transmittance(&self) -> Spectrum {
        self.transmittance.brightest()
    }
}
