//! A sphere.

use super::Hit;
use crate::error::{Error, Result};
use crate::math::{FOUR_PI, Frame, Interval, Ray, warp};
use glam::{DVec2, DVec3};

/// All points within a radius of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// A sphere of centre and radius \[L\].
    pub fn new(center: DVec3, radius: f64) -> Result<Self> {
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(Error::out_of_range("radius", radius, "finite and above 0"));
        }
        if !center.is_finite() {
            return Err(Error::out_of_range("center", center.length(), "finite"));
        }
        Ok(Sphere { center, radius })
    }

    /// Centre \[L\].
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Radius \[L\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// 1 - cos of the half-angle under which it is seen from `p`; none from inside.
    fn one_minus_mu_max(&self, p: DVec3) -> Option<f64> {
        let sin2 = self.radius * self.radius / p.distance_squared(self.center);
        (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }

    /// A uniform direction from `p` within the cone that the sphere fills, and its density [1/sr]; none from inside.
    pub(crate) fn sample_cone(&self, p: DVec3, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let one_minus_mu_max = self.one_minus_mu_max(p)?;
        let to_center = Frame::new((self.center - p).normalize());
        let dir = to_center.to_world(warp::square_to_cone(u, one_minus_mu_max)).normalize();
        Some((dir, warp::pdf_cone(one_minus_mu_max)))
    }

    /// The density of [`Self::sample_cone`] [1/sr]; 0 from inside.
    pub(crate) fn pdf_cone(&self, p: DVec3) -> f64 {
        self.one_minus_mu_max(p).map_or(0.0, warp::pdf_cone)
    }

    /// Both crossings of the line through the ray, nearer first, or none if it misses.
    ///
    /// The discriminant comes from the distance of the line to the centre, and the smaller root from the product
    /// of the two: neither cancels for a far or a small sphere (Hearn and Baker; Haines et al. 2019).
    fn crossings(&self, ray: &Ray) -> Option<(f64, f64)> {
        let f = ray.origin - self.center;
        let b = -f.dot(ray.dir);
        let closest = f + ray.dir * b;
        let discriminant = self.radius * self.radius - closest.length_squared();
        if discriminant <= 0.0 {
            return None;
        }
        let q = b + discriminant.sqrt().copysign(b);
        let c = (f.length() - self.radius) * (f.length() + self.radius);
        let (t0, t1) = (c / q, q);
        Some(if t0 <= t1 { (t0, t1) } else { (t1, t0) })
    }

    fn hit_at(&self, ray: &Ray, t: f64) -> Hit {
        let normal = ((ray.at(t) - self.center) / self.radius).normalize();
        Hit { t, normal, shading: normal, uv: DVec2::ZERO, primitive: 0 }
    }

    pub(super) fn hit(&self, ray: &Ray, from_here: bool) -> Option<Hit> {
        if from_here {
            let t = -2.0 * (ray.origin - self.center).dot(ray.dir);
            return (t > 0.0).then(|| self.hit_at(ray, t));
        }
        let (t0, t1) = self.crossings(ray)?;
        let t = if t0 > 0.0 { t0 } else { t1 };
        (t > 0.0).then(|| self.hit_at(ray, t))
    }

    pub(super) fn interval(&self, ray: &Ray) -> Option<Interval> {
        let (t0, t1) = self.crossings(ray)?;
        (t1 > 0.0).then_some(Interval { start: t0.max(0.0), end: t1 })
    }

    pub(super) fn contains(&self, p: DVec3) -> bool {
        p.distance_squared(self.center) <= self.radius * self.radius
    }

    /// Surface area [L^2].
    pub fn area(&self) -> f64 {
        FOUR_PI * self.radius * self.radius
    }

    /// Volume [L^3].
    pub fn volume(&self) -> f64 {
        FOUR_PI / 3.0 * self.radius * self.radius * self.radius
    }

    /// A uniform point on the surface and the outward normal there.
    pub fn sample_surface(&self, u: [f64; 2]) -> (DVec3, DVec3) {
        let normal = warp::square_to_sphere(u);
        (self.center + normal * self.radius, normal)
    }

    /// A uniform point inside.
    pub fn sample_inside(&self, [u, v, w]: [f64; 3]) -> DVec3 {
        self.center + warp::square_to_sphere([u, v]) * (self.radius * libm::cbrt(w))
    }
}
