//! A shape whose surface emits outwards.

use super::bundle::{by_number, cone};
use super::emission::emissive;
use super::{Bundle, EmissionCell, LightSample, Needs, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::geometry::{Face, Hit, Rectangle, Shape, Sphere, SphericalRectangle};
use crate::math::{Frame, Ray, warp};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A rectangle whose middle is farther than so many diagonals is aimed at by area. Near it samples by area have no bounded
/// variance, and solid angle is worth its trigonometry; from a diagonal on, what a sample brings varies little over the
/// rectangle. In a box of fog (`cargo bench --bench fogbox`) variances are 1 % greater with 1 than with 32, and pictures
/// take a quarter less time.
const FAR: f64 = 1.0;

/// A black shape whose surface emits the same radiance everywhere, in all outward directions: the front of a rectangle,
/// the outside of a sphere, a cuboid, a mesh or a lathe.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    shape: Shape,
    radiance: Spectrum,
    area: f64,
}

impl Area {
    /// A light of the given shape and radiance [W/(L^2 sr)].
    ///
    /// # Errors
    /// `Error::Scene` for a slab, whose faces have no end; `Error::OutOfRange` for the radiance.
    pub fn new(shape: Shape, radiance: Spectrum) -> Result<Self> {
        let area = shape.area();
        if !area.is_finite() {
            return Err(Error::Scene(
                "an area light needs a bounded shape: a rectangle, a sphere, a cuboid, a mesh or a lathe"
                    .into(),
            ));
        }
        Ok(Area { shape, radiance: emissive("radiance", radiance)?, area })
    }

    /// The shape that emits.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Radiance [W/(L^2 sr)].
    pub fn radiance(&self) -> Spectrum {
        self.radiance
    }

    pub(super) fn power(&self) -> Spectrum {
        self.radiance * (PI * self.area)
    }

    pub(super) fn needs(&self) -> Needs {
        let position = match self.shape {
            Shape::Rectangle(_) | Shape::Sphere(_) | Shape::Mesh(_) | Shape::Revolution(_) => 2,
            Shape::Cuboid(_) | Shape::Slab(_) => 3,
        };
        Needs { position, direction: 2 }
    }

    pub(super) fn ray(&self, numbers: &PrimarySample) -> Ray {
        let (origin, normal, _) = self.shape.sample_boundary(Face::Top, DVec2::ZERO, numbers.position);
        let local = if planted(Fault::EmissionUniform) {
            let dir = warp::square_to_sphere(numbers.direction);
            dir.with_z(dir.z.abs())
        } else {
            warp::square_to_cosine_hemisphere(numbers.direction)
        };
        Ray::new(origin, Frame::new(normal).to_world(local))
    }

    /// The part of the shape that the ray of these numbers starts on.
    pub(super) fn primitive(&self, numbers: &PrimarySample) -> u32 {
        self.shape.sample_surface(numbers.position).2
    }

    /// Whether it is a sphere, whose photons are aimed by choosing the direction first.
    pub(super) fn is_sphere(&self) -> bool {
        matches!(self.shape, Shape::Sphere(_))
    }

    /// Where the first number of the position goes from one face to the next, if the shape has faces.
    pub(super) fn faces(&self) -> Option<Vec<f64>> {
        if let Shape::Cuboid(c) = &self.shape { Some(c.face_ends().to_vec()) } else { None }
    }

    /// The photon of a sphere, direction first; none of other shapes.
    pub(super) fn aimed_ray(&self, numbers: &PrimarySample) -> Option<Ray> {
        let Shape::Sphere(sphere) = &self.shape else { return None };
        let dir = warp::square_to_sphere(numbers.direction).normalize();
        let [a, b, _] = numbers.position;
        let p = warp::square_to_disc([a, b]);
        let normal = Frame::new(dir).to_world(DVec3::new(p.x, p.y, (1.0 - a).sqrt()));
        Some(Ray::new(sphere.center() + normal * sphere.radius(), dir))
    }

    pub(super) fn bundle(&self, cell: &EmissionCell) -> Option<Bundle> {
        let u = cell.position_middle()[0];
        let on_face = |low: [f64; 3], high: [f64; 3]| {
            let (a, normal, _) = self.shape.sample_boundary(Face::Top, DVec2::ZERO, low);
            let (b, _, _) = self.shape.sample_boundary(Face::Top, DVec2::ZERO, high);
            let (axis, angle) = cone(cell, &Frame::new(normal), by_number::cosine_hemisphere);
            Bundle { center: 0.5 * (a + b), radius: 0.5 * a.distance(b), axis, angle }
        };
        match &self.shape {
            Shape::Sphere(s) => {
                let (axis, angle) = cone(cell, &Frame::new(DVec3::Z), by_number::sphere);
                Some(Bundle { center: s.center(), radius: s.radius(), axis, angle })
            }
            Shape::Rectangle(_) => Some(on_face(cell.low.position, cell.high.position)),
            Shape::Cuboid(c) => {
                let ends = c.face_ends();
                let face = |x: f64| ends[1..6].iter().take_while(|end| **end <= x).count();
                let is_one =
                    face(cell.low.position[0]) == face(u) && ends[face(u) + 1] >= cell.high.position[0];
                let [low, high] = [cell.low.position, cell.high.position].map(|[_, v, w]| [u, v, w]);
                is_one.then(|| on_face(low, high))
            }
            _ => None,
        }
    }

    /// A direction from `p`: uniform in the solid angle that a rectangle or a sphere fills, or to a uniform point of the
    /// surface, of the sides of a cuboid that face `p`.
    ///
    /// None where the surface is seen so edge-on, or from so near, that density or direction have no number: within 10^-150 of it
    /// or of its plane.
    pub(super) fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let sample = match &self.shape {
            Shape::Sphere(sphere) => self.sample_cone(sphere, p, u),
            Shape::Rectangle(r) if is_near(r, p) => self.sample_seen(&SphericalRectangle::new(r, p)?, u),
            Shape::Rectangle(r) => self.towards(p, r.sample(u), r.normal()),
            Shape::Cuboid(c) => {
                let (point, normal) = c.sample_facing(p, u)?;
                self.towards(p, point, normal)
            }
            Shape::Mesh(_) | Shape::Revolution(_) => {
                let (point, normal, _) = self.shape.sample_surface([u[0], u[1], 0.0]);
                self.towards(p, point, normal)
            }
            Shape::Slab(_) => None,
        };
        sample.filter(|s| s.dir.is_finite() && s.pdf_solid_angle.is_none_or(f64::is_finite))
    }

    /// The sample that aims at a point of the surface.
    fn towards(&self, p: DVec3, point: DVec3, normal: DVec3) -> Option<LightSample> {
        let to_light = point - p;
        let distance = to_light.length();
        let dir = to_light / distance;
        let cosine = -dir.dot(normal);
        // Written so that a NaN, from the point itself, is refused too.
        if cosine > 0.0 {
            let area = if planted(Fault::AreaForgotten) { 1.0 } else { self.facing_area(p) };
            let pdf = distance * distance / (cosine * area);
            Some(LightSample { dir, distance, value: self.radiance / pdf, pdf_solid_angle: Some(pdf) })
        } else {
            None
        }
    }

    /// Area that [`Self::sample`] chooses from [L^2].
    fn facing_area(&self, p: DVec3) -> f64 {
        if let Shape::Cuboid(c) = &self.shape { c.facing_area(p) } else { self.area }
    }

    fn sample_seen(&self, seen: &SphericalRectangle, u: [f64; 2]) -> Option<LightSample> {
        let (way, pdf) = (seen.sample(u), 1.0 / seen.solid_angle());
        let distance = way.length();
        let value = self.radiance * seen.solid_angle();
        Some(LightSample { dir: way / distance, distance, value, pdf_solid_angle: Some(pdf) })
    }

    fn sample_cone(&self, sphere: &Sphere, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let (dir, pdf) = sphere.sample_cone(p, u)?;
        // A direction on the very rim may miss by rounding: then it is as far as the rim is.
        let distance = self.hit(&Ray::new(p, dir), None).map_or_else(
            || (p.distance_squared(sphere.center()) - sphere.radius() * sphere.radius()).sqrt(),
            |hit| hit.t,
        );
        Some(LightSample { dir, distance, value: self.radiance / pdf, pdf_solid_angle: Some(pdf) })
    }

    pub(super) fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        // Light leaves a body outwards, so that a ray that starts on a convex one never meets it again.
        let is_convex = !matches!(self.shape, Shape::Mesh(_) | Shape::Revolution(_));
        if from.is_some() && is_convex { None } else { self.shape.hit(ray, from) }
    }

    /// Of a convex body what faces a point hides nothing of itself. Of others what is nearer by more than a millionth
    /// stands in the way, which rounding is far below.
    pub(super) fn hides_itself(&self, ray: &Ray, end: f64) -> bool {
        let is_convex = !matches!(self.shape, Shape::Mesh(_) | Shape::Revolution(_));
        !is_convex && self.shape.blocks(ray, None, end * (1.0 - 1e-6))
    }

    pub(super) fn emitted(&self, ray: &Ray, hit: &Hit) -> (Spectrum, f64) {
        let cosine = -ray.dir.dot(hit.normal);
        if cosine <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let pdf = match &self.shape {
            Shape::Sphere(sphere) => sphere.pdf_cone(ray.origin),
            Shape::Rectangle(r) if is_near(r, ray.origin) => {
                SphericalRectangle::new(r, ray.origin).map_or(0.0, |seen| 1.0 / seen.solid_angle())
            }
            _ => hit.t * hit.t / (cosine * self.facing_area(ray.origin)),
        };
        (self.radiance, pdf)
    }
}

/// Whether a rectangle is aimed at by solid angle.
fn is_near(rectangle: &Rectangle, p: DVec3) -> bool {
    let far = FAR * rectangle.diagonal();
    rectangle.sample([0.5; 2]).distance_squared(p) < far * far && !planted(Fault::AreaForgotten)
}
