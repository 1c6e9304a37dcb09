//! Lights: one file each; emission of photons, next-event estimation, and what a ray meets by itself.

mod area;
mod beam;
mod emitting_sphere;
mod isotropic;
mod point;
mod volume_source;

pub use area::Area;
pub use beam::{Beam, Section};
pub use emitting_sphere::EmittingSphere;
pub use isotropic::{Faces, Isotropic};
pub use point::Point;
pub use volume_source::VolumeSource;

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Hit, Shape, Slab};
use crate::math::Ray;
use crate::rng::Stream;
use glam::DVec3;

/// The lights at hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Collimated light, unbounded or of a given section.
    Beam(Beam),
    /// A one-sided black rectangle that emits the same radiance everywhere.
    Area(Area),
    /// A black sphere that emits the same radiance everywhere.
    EmittingSphere(EmittingSphere),
    /// A point that emits the same intensity in all directions.
    Point(Point),
    /// The same radiance from all directions into a closed shape, or through the faces of a slab.
    Isotropic(Isotropic),
    /// Power emitted uniformly inside a shape, alike in all directions.
    VolumeSource(VolumeSource),
}

/// What unbounded lights need to start photons: the one slab of the scene and the side of its cell \[L\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// The layer.
    pub slab: Slab,
    /// Side of the square cell [0, side) x [0, side) that stands for the whole layer \[L\].
    pub side: f64,
}

impl Stage {
    /// Side of the cell \[L\]; 0 where there is none.
    pub fn side(stage: Option<&Stage>) -> f64 {
        stage.map_or(0.0, |s| s.side)
    }
}

/// A photon on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emission {
    /// Where it starts and where to.
    pub ray: Ray,
    /// Power \[W\], as though it were the only one.
    pub power: Spectrum,
}

/// A direction towards a light, with its contribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit direction from the point towards the light.
    pub dir: DVec3,
    /// How far the light is \[L\]; infinite for an unbounded beam.
    pub distance: f64,
    /// Radiance over density, or irradiance for a delta light [W/L^2].
    pub value: Spectrum,
    /// Density of the direction [1/sr], or none for a delta light.
    pub pdf_solid_angle: Option<f64>,
}

/// A radiance, irradiance or power whose channels are finite, not negative and not all 0.
fn emissive(name: &'static str, value: Spectrum) -> Result<Spectrum> {
    match (0..3).map(|c| value[c]).find(|v| !(*v >= 0.0 && v.is_finite())) {
        Some(bad) => Err(Error::out_of_range(name, bad, "finite and at least 0")),
        None if value.is_black() => Err(Error::out_of_range(name, 0.0, "above 0 in at least one channel")),
        None => Ok(value),
    }
}

impl Light {
    /// Whether its radiance is a delta function, so that no ray meets it by itself.
    pub fn is_delta(&self) -> bool {
        matches!(self, Light::Beam(_) | Light::Point(_))
    }

    /// The body that rays can meet, black but for its light; none for lights without.
    pub fn body(&self) -> Option<Shape> {
        match self {
            Light::Area(l) => Some(l.shape()),
            Light::EmittingSphere(l) => Some(l.shape()),
            Light::Beam(_) | Light::Point(_) | Light::Isotropic(_) | Light::VolumeSource(_) => None,
        }
    }

    /// Whether next-event estimation can aim at it.
    pub fn has_direction(&self) -> bool {
        !matches!(self, Light::Isotropic(_) | Light::VolumeSource(_))
    }

    /// Whether all channels are equal.
    pub fn is_grey(&self) -> bool {
        match self {
            Light::Beam(l) => l.irradiance().is_grey(),
            Light::Area(l) => l.power().is_grey(),
            Light::EmittingSphere(l) => l.power().is_grey(),
            Light::Point(l) => l.power().is_grey(),
            Light::Isotropic(l) => l.radiance().is_grey(),
            Light::VolumeSource(l) => l.emission().is_grey(),
        }
    }

    /// Whether photons start from the cell of an unbounded slab.
    pub fn needs_stage(&self) -> bool {
        match self {
            Light::Beam(l) => l.section() == Section::Unbounded,
            Light::Isotropic(l) => matches!(l.shape(), Shape::Slab(_)),
            Light::VolumeSource(l) => matches!(l.shape(), Shape::Slab(_)),
            Light::Area(_) | Light::EmittingSphere(_) | Light::Point(_) => false,
        }
    }

    /// Emitted power \[W\]; of an unbounded light the part that enters the cell.
    pub fn power(&self, stage: Option<&Stage>) -> Spectrum {
        match self {
            Light::Beam(l) => l.power(stage),
            Light::Area(l) => l.power(),
            Light::EmittingSphere(l) => l.power(),
            Light::Point(l) => l.power(),
            Light::Isotropic(l) => l.power(stage),
            Light::VolumeSource(l) => l.power(stage),
        }
    }

    /// One photon that carries the light's whole power.
    pub fn emit(&self, stage: Option<&Stage>, stream: &mut Stream) -> Emission {
        let ray = match self {
            Light::Beam(l) => l.emit(stage, stream),
            Light::Area(l) => l.emit(stream),
            Light::EmittingSphere(l) => l.emit(stream),
            Light::Point(l) => l.emit(stream),
            Light::Isotropic(l) => l.emit(stage, stream),
            Light::VolumeSource(l) => l.emit(stage, stream),
        };
        Emission { ray, power: self.power(stage) }
    }

    /// A direction from `p` towards the light; none if the light cannot be aimed at or sends nothing to `p`.
    pub fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        match self {
            Light::Beam(l) => l.sample(p),
            Light::Area(l) => l.sample(p, u),
            Light::EmittingSphere(l) => l.sample(p, u),
            Light::Point(l) => l.sample(p),
            Light::Isotropic(_) | Light::VolumeSource(_) => None,
        }
    }

    /// Where a ray meets the light's own body; `from` is the part of it that the ray starts on, if it does.
    pub fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        match self {
            // Light leaves a body outwards, so that a ray that starts on a convex one never meets it again.
            _ if from.is_some() => None,
            Light::Area(l) => l.hit(ray),
            Light::EmittingSphere(l) => l.hit(ray),
            Light::Beam(_) | Light::Point(_) | Light::Isotropic(_) | Light::VolumeSource(_) => None,
        }
    }

    /// Radiance sent back along a ray that meets the light's body [W/(L^2 sr)], and the density with which
    /// [`Self::sample`] aims from the ray's origin at that point [1/sr].
    pub fn emitted(&self, ray: &Ray, hit: &Hit) -> (Spectrum, f64) {
        match self {
            Light::Area(l) => l.emitted(ray, hit),
            Light::EmittingSphere(l) => l.emitted(ray, hit),
            Light::Beam(_) | Light::Point(_) | Light::Isotropic(_) | Light::VolumeSource(_) => {
                (Spectrum::ZERO, 0.0)
            }
        }
    }
}
