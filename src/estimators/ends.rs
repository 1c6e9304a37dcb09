//! What estimates along rays do where a medium ends.

use crate::Spectrum;
use crate::geometry::{Shape, Slab};
use crate::math::{Interval, Ray};
use crate::medium::Homogeneous;
use crate::scene::decay;
use glam::DVec3;

/// Where a stretch of a ray ends for the photons and beams about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RayEnds {
    /// Square across the ray where that enters and leaves the medium: faces that it meets aslant cost light, which a treatment of
    /// boundaries makes up for.
    #[default]
    Cut,
    /// For each where the parallel ray through it leaves the medium: what is estimated is the picture itself, blurred across the ray,
    /// of which nothing is lost. Of one homogeneous medium with nothing in it.
    Own,
}

impl RayEnds {
    /// Both.
    pub const ALL: [RayEnds; 2] = [RayEnds::Cut, RayEnds::Own];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            RayEnds::Cut => "cut",
            RayEnds::Own => "own",
        }
    }
}

/// A ray whose parallels end each for itself.
#[derive(Debug, Clone, Copy)]
pub struct OwnEnds<'a> {
    medium: &'a Homogeneous,
    shape: &'a Shape,
    ray: &'a Ray,
    /// Whether the ray begins in the medium: then all that counts is ahead of it.
    is_inside: bool,
    span: Interval,
}

/// A ray that begins no farther inside than this part of the radius begins on the surface.
const ON_SURFACE: f64 = 1e-6;

impl<'a> OwnEnds<'a> {
    /// Of a ray within a radius \[L\] of which photons or beams count; none where all of the medium is behind it.
    pub fn new(medium: &'a Homogeneous, shape: &'a Shape, ray: &'a Ray, radius: f64) -> Option<Self> {
        let is_inside = shape.room(ray.origin) > ON_SURFACE * radius;
        let mut span = match shape {
            Shape::Slab(slab) if ray.dir.z != 0.0 => across(slab, ray, radius),
            _ => Interval { start: f64::NEG_INFINITY, end: f64::INFINITY },
        };
        // A ray that meets the medium ahead comes from outside, from as far as all its parallels do.
        let back = Ray::new(ray.origin, -ray.dir);
        let is_ahead = |ray: &Ray| shape.interval(ray).is_some_and(|met| met.length() > ON_SURFACE * radius);
        if is_inside || !is_ahead(ray) {
            span.start = span.start.max(0.0);
        }
        let is_behind = !is_inside && !is_ahead(ray) && is_ahead(&back);
        (!is_behind && span.start < span.end).then_some(OwnEnds { medium, shape, ray, is_inside, span })
    }

    /// Where feet lie of what counts \[L\].
    pub fn span(&self) -> Interval {
        self.span
    }

    /// What passes from a place of the medium, its foot at a distance along the ray \[L\], to where the parallel ray leaves the medium, or to
    /// beside the ray's origin.
    pub fn passed(&self, place: DVec3, foot: f64) -> Spectrum {
        let back = Ray::new(place, -self.ray.dir);
        let leaves = self.shape.interval(&back).map_or(0.0, |way| way.end);
        let way = if self.is_inside { leaves.min(foot) } else { leaves };
        decay(self.medium.sigma_t() * way)
    }
}

/// Where feet lie of the points of a layer that are as near to a ray as a radius.
fn across(layer: &Slab, ray: &Ray, radius: f64) -> Interval {
    let beside = radius * (ray.dir.x * ray.dir.x + ray.dir.y * ray.dir.y).sqrt();
    let at = |z: f64| (z - ray.origin.z) / ray.dir.z;
    let (low, high) = (layer.top() - beside, layer.top() + layer.thickness() + beside);
    Interval { start: at(low).min(at(high)), end: at(low).max(at(high)) }
}
