//! A rectangle that emits from its front.

use super::{LightSample, emissive};
use crate::Spectrum;
use crate::error::Result;
use crate::faults::{Fault, planted};
use crate::geometry::{Hit, Rectangle, Shape};
use crate::math::{Frame, Ray, warp};
use crate::rng::Stream;
use glam::DVec3;
use std::f64::consts::PI;

/// A black rectangle whose front emits the same radiance in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    rectangle: Rectangle,
    radiance: Spectrum,
}

impl Area {
    /// A light of the given shape and radiance [W/(L^2 sr)].
    pub fn new(rectangle: Rectangle, radiance: Spectrum) -> Result<Self> {
        Ok(Area { rectangle, radiance: emissive("radiance", radiance)? })
    }

    pub(super) fn shape(&self) -> Shape {
        Shape::Rectangle(self.rectangle)
    }

    pub(super) fn power(&self) -> Spectrum {
        self.radiance * (PI * self.rectangle.area())
    }

    pub(super) fn emit(&self, stream: &mut Stream) -> Ray {
        let origin = self.rectangle.sample(stream.pair());
        let local = if planted(Fault::EmissionUniform) {
            let dir = warp::square_to_sphere(stream.pair());
            dir.with_z(dir.z.abs())
        } else {
            warp::square_to_cosine_hemisphere(stream.pair())
        };
        Ray::new(origin, Frame::new(self.rectangle.normal()).to_world(local))
    }

    pub(super) fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let to_light = self.rectangle.sample(u) - p;
        let distance = to_light.length();
        let dir = to_light / distance;
        let cosine = -dir.dot(self.rectangle.normal());
        if cosine <= 0.0 {
            return None;
        }
        let area = if planted(Fault::AreaForgotten) { 1.0 } else { self.rectangle.area() };
        let pdf = distance * distance / (cosine * area);
        Some(LightSample { dir, distance, value: self.radiance / pdf, pdf_solid_angle: Some(pdf) })
    }

    pub(super) fn hit(&self, ray: &Ray) -> Option<Hit> {
        self.shape().hit(ray, None)
    }

    pub(super) fn emitted(&self, ray: &Ray, hit: &Hit) -> (Spectrum, f64) {
        let cosine = -ray.dir.dot(hit.normal);
        if cosine <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        (self.radiance, hit.t * hit.t / (cosine * self.rectangle.area()))
    }
}
