//! A sphere that emits.

use super::{LightSample, emissive};
use crate::Spectrum;
use crate::error::Result;
use crate::geometry::{Hit, Shape, Sphere};
use crate::math::{Frame, Ray, warp};
use crate::rng::Stream;
use glam::DVec3;
use std::f64::consts::PI;

/// A black sphere that emits the same radiance everywhere, in all outward directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmittingSphere {
    sphere: Sphere,
    radiance: Spectrum,
}

impl EmittingSphere {
    /// A light of the given shape and radiance [W/(L^2 sr)].
    pub fn new(sphere: Sphere, radiance: Spectrum) -> Result<Self> {
        Ok(EmittingSphere { sphere, radiance: emissive("radiance", radiance)? })
    }

    pub(super) fn shape(&self) -> Shape {
        Shape::Sphere(self.sphere)
    }

    pub(super) fn power(&self) -> Spectrum {
        self.radiance * (PI * self.sphere.area())
    }

    pub(super) fn emit(&self, stream: &mut Stream) -> Ray {
        let (origin, normal) = self.sphere.sample_surface(stream.pair());
        let local = warp::square_to_cosine_hemisphere(stream.pair());
        Ray::new(origin, Frame::new(normal).to_world(local))
    }

    /// 1 - cos of the half-angle under which the sphere is seen from `p`; none from inside.
    fn one_minus_mu_max(&self, p: DVec3) -> Option<f64> {
        let d2 = p.distance_squared(self.sphere.center());
        let sin2 = self.sphere.radius() * self.sphere.radius() / d2;
        (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }

    pub(super) fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let one_minus_mu_max = self.one_minus_mu_max(p)?;
        let to_center = (self.sphere.center() - p).normalize();
        let dir = Frame::new(to_center).to_world(warp::square_to_cone(u, one_minus_mu_max)).normalize();
        // A direction on the very rim may miss by rounding: then it is as far as the rim is.
        let distance = self.hit(&Ray::new(p, dir)).map_or_else(
            || {
                (p.distance_squared(self.sphere.center()) - self.sphere.radius() * self.sphere.radius())
                    .sqrt()
            },
            |hit| hit.t,
        );
        let pdf = warp::pdf_cone(one_minus_mu_max);
        Some(LightSample { dir, distance, value: self.radiance / pdf, pdf_solid_angle: Some(pdf) })
    }

    pub(super) fn hit(&self, ray: &Ray) -> Option<Hit> {
        self.shape().hit(ray, None)
    }

    pub(super) fn emitted(&self, ray: &Ray, hit: &Hit) -> (Spectrum, f64) {
        if ray.dir.dot(hit.normal) >= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        (self.radiance, self.one_minus_mu_max(ray.origin).map_or(0.0, warp::pdf_cone))
    }
}
