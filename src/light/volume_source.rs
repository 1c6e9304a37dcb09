//! A uniform isotropic source filling a shape.

use super::emission::emissive;
use super::{LightSample, PeriodicCell, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Shape, Sphere};
use crate::math::{FOUR_PI, Ray, warp};
use glam::DVec3;

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

    /// The ball about the shape, which is what directions are aimed at; nothing bounds a slab.
    pub(super) fn ball(&self) -> Option<Sphere> {
        let (center, radius) = self.shape.bounds()?;
        Sphere::new(center, radius).ok()
    }

    /// Density with which [`super::Light::sample`] aims from `p` at any point of the shape [1/sr]: uniform in the cone about
    /// its ball, and 0 from inside of the ball, where every direction may meet the shape.
    pub fn pdf_solid_angle(&self, p: DVec3) -> f64 {
        self.ball().map_or(0.0, |ball| ball.pdf_cone(p))
    }

    /// A direction from `p`, and what comes along it where nothing stands or absorbs on the way.
    pub(super) fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let (dir, pdf) = self.ball()?.sample_cone(p, u)?;
        let inside = self.shape.interval(&Ray::new(p, dir))?;
        let value = self.emission() * inside.length() / pdf;
        Some(LightSample { dir, distance: inside.start, value, pdf_solid_angle: Some(pdf) })
    }

    pub(super) fn power(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        self.density * self.shape.sample_inside(PeriodicCell::side(periodic_cell), [0.0; 3]).1
    }

    pub(super) fn ray(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Ray {
        let (origin, _) = self.shape.sample_inside(PeriodicCell::side(periodic_cell), numbers.position);
        Ray::new(origin, warp::square_to_sphere(numbers.direction).normalize())
    }
}
