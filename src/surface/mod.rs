//! Surfaces, without thickness: one file each.

mod black;
mod dielectric;
mod filter;
mod fraction;
mod lambertian;
mod mirror;
mod texture;

pub use black::Black;
pub use dielectric::{Dielectric, Refraction, fresnel, refract};
pub use filter::Filter;
pub use lambertian::Lambertian;
pub use mirror::Mirror;
pub use texture::{Checker, Image, Texture, Wood};

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
    /// Reflects and refracts.
    Dielectric(Dielectric),
    /// Lets a fraction pass straight on.
    Filter(Filter),
}

impl Surface {
    /// Fraction of the arriving power that leaves again, on either side, by channel, at a point \[L\] with these surface parameters.
    pub fn reflectance(&self, position: DVec3, uv: DVec2) -> Spectrum {
        match self {
            Surface::Lambertian(s) => s.reflectance(position, uv),
            Surface::Mirror(s) => s.reflectance(),
            Surface::Black(_) => Spectrum::ZERO,
            Surface::Dielectric(_) => Spectrum::ONE,
            Surface::Filter(s) => s.transmittance(position, uv),
        }
    }

    /// An upper bound of that fraction, over the whole surface.
    pub fn largest_reflectance(&self) -> Spectrum {
        match self {
            Surface::Lambertian(s) => s.largest_reflectance(),
            Surface::Mirror(s) => s.reflectance(),
            Surface::Black(_) => Spectrum::ZERO,
            Surface::Dielectric(_) => Spectrum::ONE,
            Surface::Filter(s) => s.largest_transmittance(),
        }
    }

    /// Whether all channels are equal everywhere.
    pub fn is_grey(&self) -> bool {
        match self {
            Surface::Lambertian(s) => s.texture().is_grey(),
            Surface::Mirror(s) => s.reflectance().is_grey(),
            Surface::Filter(s) => s.texture().is_grey(),
            Surface::Dielectric(_) | Surface::Black(_) => true,
        }
    }

    /// Whether it ends or turns back every ray that meets it.
    pub fn is_opaque(&self) -> bool {
        matches!(self, Surface::Lambertian(_) | Surface::Mirror(_) | Surface::Black(_))
    }

    /// Whether light leaves in one or two directions only, so that no other estimator can connect to it. A filter and an
    /// index-matched boundary are not: light that they let pass has met nothing.
    pub fn is_specular(&self) -> bool {
        matches!(self, Surface::Mirror(_) | Surface::Dielectric(_)) && self.is_event()
    }

    /// Whether light that meets it has met something: everything but a filter and an index-matched boundary.
    pub fn is_event(&self) -> bool {
        match self {
            Surface::Filter(_) => false,
            Surface::Dielectric(boundary) => !boundary.is_matched(),
            Surface::Lambertian(_) | Surface::Mirror(_) | Surface::Black(_) => true,
        }
    }

    /// The direction of travel after reflection, from the one before, the normal on the side of arrival and two
    /// numbers in [0, 1), with its density [1/sr], or none for a specular direction. What a dielectric or a filter does
    /// depends on more than that: none of theirs.
    pub fn scatter(&self, dir: DVec3, normal: DVec3, u: [f64; 2]) -> Option<(DVec3, Option<f64>)> {
        match self {
            Surface::Lambertian(_) => {
                let (out, pdf) = Lambertian::scatter(normal, u);
                Some((out, Some(pdf)))
            }
            Surface::Mirror(_) => Some((Mirror::scatter(dir, normal), None)),
            Surface::Black(_) | Surface::Dielectric(_) | Surface::Filter(_) => None,
        }
    }
}
