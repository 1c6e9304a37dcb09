//! A uniform isotropic source filling a shape.

use super::{EmissionNumbers, Stage, emissive};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::math::{FOUR_PI, Ray, warp};

/// Every volume element of a shape emits the same power, alike in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeSource {
    shape: Shape,
    density: Spectrum,
}

impl VolumeSource {
    /// A source in a sphere, a cuboid or a slab, of the given power per volume [W/L^3].
    pub fn new(shape: Shape, density: Spectrum) -> Result<Self> {
        if !shape.is_solid() {
            return Err(Error::Scene(
                "a volume source needs a convex shape with an inside: a sphere, a cuboid or a slab".into(),
            ));
        }
        Ok(VolumeSource { shape, density: emissive("density", density)? })
    }

    /// The shape that it fills.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Emission coefficient [W/(L^3 sr)].
    pub fn emission(&self) -> Spectrum {
        self.density / FOUR_PI
    }

    pub(super) fn power(&self, stage: Option<&Stage>) -> Spectrum {
        self.density * self.shape.sample_inside(Stage::side(stage), [0.0; 3]).1
    }

    pub(super) fn ray(&self, stage: Option<&Stage>, numbers: &EmissionNumbers) -> Ray {
        let (origin, _) = self.shape.sample_inside(Stage::side(stage), numbers.position);
        Ray::new(origin, warp::square_to_sphere(numbers.direction).normalize())
    }
}
