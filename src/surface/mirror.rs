//! A perfect mirror.

use super::fraction::checked;
use crate::Spectrum;
use crate::error::Result;
use glam::DVec3;

/// Reflects a fraction of the light along the mirrored direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    reflectance: Spectrum,
}

impl Mirror {
    /// A mirror of the given reflectance \[1\], each channel in [0, 1].
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        Ok(Mirror { reflectance: checked("reflectance", reflectance)? })
    }

    /// Fraction of the arriving power that is reflected.
    pub fn reflectance(&self) -> Spectrum {
        self.reflectance
    }

    /// The mirrored direction of travel.
    pub fn scatter(dir: DVec3, normal: DVec3) -> DVec3 {
        (dir - normal * (2.0 * dir.dot(normal))).normalize()
    }
}
