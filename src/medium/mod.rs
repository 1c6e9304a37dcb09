//! Media: one file each. A medium says its coefficients, bounds of them along a ray, and its phase function; it never
//! tracks.
//!
//! A medium that emits is a light: rays that look through it see its emission, and photons start in it.

mod blocks;
mod cells;
mod cloud;
mod density;
mod grid;
mod height_fog;
mod heterogeneous;
mod homogeneous;
mod markov;
mod noise;
mod npy;
mod period;
mod vol;

pub use blocks::{Blocks, Through};
pub use cells::{Along, Bound, Cells};
pub use cloud::{Body, Cloud, CloudShape};
pub use density::{AlongPeriods, Bounds, Density, Repeated};
pub use grid::Grid;
pub use height_fog::{HeightFog, Layers};
pub use heterogeneous::Heterogeneous;
pub use homogeneous::Homogeneous;
pub use markov::markov;
pub use noise::Noise;

use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray};
use crate::phase::Phase;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The media at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Medium {
    /// The same everywhere: flights and transmittance in closed form.
    Homogeneous(Homogeneous),
    /// Extinction in proportion to a density: delta and ratio tracking.
    Heterogeneous(Arc<Heterogeneous>),
}

impl From<Homogeneous> for Medium {
    fn from(medium: Homogeneous) -> Self {
        Medium::Homogeneous(medium)
    }
}

impl From<Heterogeneous> for Medium {
    fn from(medium: Heterogeneous) -> Self {
        Medium::Heterogeneous(Arc::new(medium))
    }
}

impl Medium {
    /// What it is where its density is 1: everywhere, if it is homogeneous.
    #[inline]
    pub fn matter(&self) -> &Homogeneous {
        match self {
            Medium::Homogeneous(medium) => medium,
            Medium::Heterogeneous(medium) => medium.matter(),
        }
    }

    /// How much of it is where; none if it is the same everywhere.
    #[inline]
    pub fn density(&self) -> Option<&Density> {
        match self {
            Medium::Homogeneous(_) => None,
            Medium::Heterogeneous(medium) => Some(medium.density()),
        }
    }

    /// Extinction coefficient at a point [1/L].
    #[inline]
    pub fn sigma_t(&self, p: DVec3) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.sigma_t(),
            Medium::Heterogeneous(medium) => medium.matter().sigma_t() * medium.density().at(p),
        }
    }

    /// Albedo at a point \[1\].
    #[inline]
    pub fn albedo(&self, p: DVec3) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.albedo(),
            Medium::Heterogeneous(medium) => medium.albedo(p),
        }
    }

    /// Absorption coefficient at a point [1/L].
    pub fn sigma_a(&self, p: DVec3) -> Spectrum {
        self.sigma_t(p) * (Spectrum::ONE - self.albedo(p))
    }

    /// Emission at a point [W/(L^3 sr)].
    pub fn emission(&self, p: DVec3) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.emission(),
            Medium::Heterogeneous(medium) => medium.emission_of(medium.density().at(p)),
        }
    }

    /// Phase function.
    #[inline]
    pub fn phase(&self) -> &Phase {
        self.matter().phase()
    }

    /// Extinction is nowhere above this [1/L].
    pub fn highest_sigma_t(&self) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.sigma_t(),
            Medium::Heterogeneous(medium) => medium.matter().sigma_t() * medium.density().high(),
        }
    }

    /// Optical depth of a part of a ray, where it has a closed form \[1\].
    pub fn optical_depth(&self, ray: &Ray, part: Interval) -> Option<Spectrum> {
        match self {
            Medium::Homogeneous(medium) => Some(medium.depth(part.length())),
            Medium::Heterogeneous(medium) => medium.optical_depth(ray, part),
        }
    }

    /// Optical depth of a part of a ray \[1\]: exact but for clouds, of which it is a quadrature. Estimates use
    /// [`Medium::optical_depth`] where there is one, and ratio tracking elsewhere.
    pub fn integrated_depth(&self, ray: &Ray, part: Interval) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.depth(part.length()),
            Medium::Heterogeneous(medium) => medium.matter().depth(medium.density().integral(ray, part)),
        }
    }

    /// About the optical depth of a part of a ray \[1\], for what any number leaves unbiased: exact where it has a closed
    /// form, else made of the bounds of the density.
    pub fn depth_by_bounds(&self, ray: &Ray, part: Interval) -> Spectrum {
        match self {
            Medium::Homogeneous(medium) => medium.depth(part.length()),
            Medium::Heterogeneous(medium) => {
                medium.matter().depth(medium.density().integral_by_bounds(ray, part))
            }
        }
    }

    /// Whether it is the same everywhere.
    pub fn is_homogeneous(&self) -> bool {
        matches!(self, Medium::Homogeneous(_))
    }

    /// The same in every period of a world with these periods along x and y \[L\]; itself where it depends on z alone.
    ///
    /// # Errors
    /// `Error::Scene` for a density or an albedo that does not fit into such a world
    pub fn repeated(&self, cell: DVec2) -> crate::error::Result<Medium> {
        match self {
            Medium::Heterogeneous(medium) if !medium.is_layered() => Ok(medium.repeated(cell)?.into()),
            Medium::Homogeneous(_) | Medium::Heterogeneous(_) => Ok(self.clone()),
        }
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        match self {
            Medium::Homogeneous(_) => true,
            Medium::Heterogeneous(medium) => medium.is_layered(),
        }
    }

    /// Whether light can collide in it.
    pub fn is_colliding(&self) -> bool {
        self.highest_sigma_t().max() > 0.0
    }

    /// Whether it emits anywhere.
    pub fn is_emitting(&self) -> bool {
        match self {
            Medium::Homogeneous(medium) => !medium.emission().is_black(),
            Medium::Heterogeneous(medium) => medium.is_emitting(),
        }
    }

    /// Whether its extinction is the same in all channels.
    pub fn has_grey_extinction(&self) -> bool {
        self.matter().sigma_t().is_grey()
    }

    /// Whether every number of it is the same in all channels.
    pub fn is_grey(&self) -> bool {
        match self {
            Medium::Homogeneous(m) => {
                let has_grey_emission = planted(Fault::EmissionColorIgnored) || m.emission().is_grey();
                m.sigma_t().is_grey() && m.albedo().is_grey() && has_grey_emission
            }
            Medium::Heterogeneous(medium) => medium.is_grey(),
        }
    }
}
