//! A uniform isotropic source filling a shape.

use super::emission::emissive;
use super::{LightSample, PeriodicCell, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::math::{FOUR_PI, Ray, warp};
use glam::{DVec2, DVec3};

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

    /// Whether directions are chosen towards it from `p`: not from inside, where every direction meets it, and a second ray costs more than it brings;
    /// and not towards a slab, which has no uniform points.
    pub(super) fn has_direction_from(&self, p: DVec3) -> bool {
        self.shape.bounds().is_some() && !self.shape.contains(p)
    }

    /// Density with which [`VolumeSource::sample`] chooses the direction of a ray [1/sr].
    pub fn pdf_solid_angle(&self, ray: &Ray) -> f64 {
        if self.has_direction_from(ray.origin) { self.shape.pdf_towards_inside(ray) } else { 0.0 }
    }

    /// The direction from `p` to a uniform point of the shape, and what comes along it, from all of the source, where nothing stands
    /// or absorbs on the way.
    ///
    /// From far away the density is in proportion to the length inside, and so is the light of a source that absorbs little: all
    /// samples are alike.
    pub fn sample(&self, p: DVec3, u: [f64; 3]) -> Option<LightSample> {
        if !self.has_direction_from(p) {
            return None;
        }
        let (inside, _) = self.shape.sample_inside(DVec2::ZERO, u);
        let ray = Ray::new(p, (inside - p).try_normalize()?);
        let part = self.shape.interval(&ray)?;
        let pdf = self.pdf_solid_angle(&ray);
        let value = self.emission() * part.length() / pdf;
        let (dir, distance) = (ray.dir, part.start);
        (pdf > 0.0).then_some(LightSample { dir, distance, value, pdf_solid_angle: Some(pdf) })
    }

    pub(super) fn power(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        self.density * self.shape.sample_inside(PeriodicCell::side(periodic_cell), [0.0; 3]).1
    }

    pub(super) fn ray(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Ray {
        let (origin, _) = self.shape.sample_inside(PeriodicCell::side(periodic_cell), numbers.position);
        Ray::new(origin, warp::square_to_sphere(numbers.direction).normalize())
    }
}
