//! Opaque surfaces, alike on both sides: one file each.

mod black;
mod lambertian;
mod mirror;

pub use black::Black;
pub use lambertian::Lambertian;
pub use mirror::Mirror;

use crate::Spectrum;
use glam::{DVec2, DVec3};

/// The surfaces at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// Reflects the same radiance in all directions.
    Lambertian(Lambertian),
    /// Reflects along the mirrored direction.
    Mirror(Mirror),
    /// Absorbs everything.
    Black(Black),
}

impl Surface {
    /// Fraction of the arriving power that leaves again, by channel, at a point \[L\] with these surface parameters.
    pub fn reflectance(&self, position: DVec3, uv: DVec2) -> Spectrum {
        match self {
            Surface::Lambertian(s) => s.reflectance(position, uv),
            Surface::Mirror(s) => s.reflectance(),
            Surface::Black(_) => Spectrum::ZERO,
        }
    }

    /// An upper bound of the reflectance, over the whole surface.
    pub fn largest_reflectance(&self) -> Spectrum {
        match self {
            Surface::Lambertian(s) => s.largest_reflectance(),
            Surface::Mirror(s) => s.reflectance(),
            Surface::Black(_) => Spectrum::ZERO,
        }
    }

    /// Whether all channels are equal everywhere.
    pub fn is_grey(&self) -> bool {
        self.largest_reflectance().is_grey()
    }

    /// Whether light leaves in one direction only, so that no other estimator can connect to it.
    pub fn is_specular(&self) -> bool {
        matches!(self, Surface::Mirror(_))
    }

    /// The direction of travel after reflection, from the one before, the normal on the side of arrival and two
    /// numbers in [0, 1), with its density [1/sr], or none for a specular direction.
    pub fn scatter(&self, dir: DVec3, normal: DVec3, u: [f64; 2]) -> Option<(DVec3, Option<f64>)> {
        match self {
            Surface::Lambertian(_) => {
                let (out, pdf) = Lambertian::scatter(normal, u);
                Some((out, Some(pdf)))
            }
            Surface::Mirror(_) => Some((Mirror::scatter(dir, normal), None)),
            Surface::Black(_) => None,
        }
    }
}
