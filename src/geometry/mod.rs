//! Shapes with exact hits in f64: one file each.
//!
//! A ray that starts on a shape says so, and the hit it starts from is excluded, by algebra or by the primitive that it
//! starts on, so that no shape needs an epsilon.

mod bins;
mod cuboid;
mod height_field;
mod hit;
mod mesh;
mod normals;
mod rectangle;
mod rectangles;
mod revolution;
mod slab;
mod sphere;
mod spherical_rectangle;
mod sums;
mod tree;

pub use bins::{FaceBins, MAX_BINS, Voxels};
pub use cuboid::Cuboid;
pub use height_field::{Ground, Up, Waves, height_field, listed};
pub(crate) use hit::ASLANT;
pub use hit::{Front, Hit};
pub use mesh::Mesh;
pub use normals::Normals;
pub use rectangle::Rectangle;
pub use rectangles::Rectangles;
pub use revolution::{Revolution, smooth};
pub use slab::{Face, Slab};
pub use sphere::Sphere;
pub use spherical_rectangle::SphericalRectangle;
pub(crate) use sums::remainder;
pub(crate) use tree::Tree;

use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The shapes at hand. Heavy ones share their data: a clone costs little.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A ball and its surface.
    Sphere(Sphere),
    /// A flat rectangle, without inside.
    Rectangle(Rectangle),
    /// The layer between two planes of constant z.
    Slab(Slab),
    /// A box along the axes.
    Cuboid(Cuboid),
    /// A surface of triangles.
    Mesh(Arc<Mesh>),
    /// A surface of revolution.
    Revolution(Arc<Revolution>),
}

macro_rules! each {
    ($self:ident, $inner:ident => $body:expr) => {
        match $self {
            Shape::Sphere($inner) => $body,
            Shape::Rectangle($inner) => $body,
            Shape::Slab($inner) => $body,
            Shape::Cuboid($inner) => $body,
            Shape::Mesh($inner) => $body,
            Shape::Revolution($inner) => $body,
        }
    };
}

impl Shape {
    /// The first crossing of the surface ahead of the ray; `from` is the primitive that the ray starts on, if it starts
    /// on this very surface.
    pub fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        match self {
            Shape::Sphere(s) => s.hit(ray, from.is_some()),
            Shape::Rectangle(s) => s.hit(ray, from.is_some()),
            Shape::Slab(s) => s.hit(ray, from.is_some()),
            Shape::Cuboid(s) => s.hit(ray, from.is_some()),
            Shape::Mesh(s) => s.hit(ray, from),
            Shape::Revolution(s) => s.hit(ray, from),
        }
    }

    /// Whether the surface stands before distance `end` \[L\]: as a hit, and sooner known for many parts.
    pub fn blocks(&self, ray: &Ray, from: Option<u32>, end: f64) -> bool {
        match self {
            Shape::Mesh(s) => s.blocks(ray, from, end),
            _ => self.hit(ray, from).is_some_and(|hit| hit.t < end),
        }
    }

    /// The distance at which a ray first meets the surface, or `end` where that is nearer \[L\].
    pub fn until(&self, ray: &Ray, end: f64) -> f64 {
        match self {
            Shape::Rectangle(rectangle) => rectangle.until(ray, end),
            _ => self.hit(ray, None).map_or(end, |hit| hit.t.min(end)),
        }
    }

    /// A plane that the whole surface lies in or behind; none for a point that may be inside, or in the plane.
    pub fn front(&self, p: DVec3) -> Option<Front> {
        match self {
            Shape::Rectangle(rectangle) => rectangle.front(p),
            Shape::Cuboid(cuboid) => cuboid.front(p),
            _ => {
                let (center, radius) = self.bounds()?;
                let distance = p.distance(center) - radius;
                (distance > 0.0).then(|| Front { normal: (p - center).normalize(), distance })
            }
        }
    }

    /// The planes of all faces, seen from a point inside, in pairs that face each other; none for a shape that is not bounded by planes alone.
    pub fn faces_about(&self, p: DVec3) -> Option<Vec<Front>> {
        let face = |normal: DVec3, distance: f64| Front { normal, distance };
        match self {
            Shape::Slab(s) => {
                let bottom = face(DVec3::NEG_Z, s.face(Face::Bottom) - p.z);
                Some(vec![face(DVec3::Z, p.z - s.top()), bottom])
            }
            Shape::Cuboid(c) => {
                let (low, high) = (p - c.min(), c.max() - p);
                let pair = |i: usize| [face(DVec3::AXES[i], low[i]), face(-DVec3::AXES[i], high[i])];
                Some((0..3).flat_map(pair).collect())
            }
            Shape::Sphere(_) | Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => None,
        }
    }

    /// Whether the surface parts a ball about a point as the whole plane of its front does.
    pub fn parts_ball(&self, p: DVec3, radius: f64) -> bool {
        match self {
            Shape::Rectangle(rectangle) => rectangle.parts_ball(p, radius),
            Shape::Cuboid(cuboid) => cuboid.parts_ball(p, radius),
            Shape::Sphere(_) | Shape::Slab(_) | Shape::Mesh(_) | Shape::Revolution(_) => false,
        }
    }

    /// Whether the surface reaches no farther than `margin` \[L\] out of the front of a point, as far as a box about it tells.
    pub fn is_behind(&self, p: DVec3, front: &Front, margin: f64) -> bool {
        let is_behind = |corner: DVec3| front.height(corner - p) <= margin;
        match self {
            Shape::Rectangle(rectangle) => rectangle.corners().into_iter().all(is_behind),
            _ => self.corners().is_some_and(|(min, max)| {
                is_behind(DVec3::select(front.normal.cmpgt(DVec3::ZERO), max, min))
            }),
        }
    }

    /// Whether the surface stands between two points.
    pub fn is_between(&self, from: DVec3, to: DVec3) -> bool {
        if let Shape::Rectangle(rectangle) = self {
            return rectangle.is_between(from, to);
        }
        let way = to - from;
        let dir = way.try_normalize();
        dir.is_some_and(|dir| self.blocks(&Ray::new(from, dir), None, way.length()))
    }

    /// Whether it is convex and has an inside: only such shapes bound media and fill with light.
    pub fn is_solid(&self) -> bool {
        match self {
            Shape::Sphere(_) | Shape::Slab(_) | Shape::Cuboid(_) => true,
            Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => false,
        }
    }

    /// Whether the surface parts space into an inside and an outside.
    pub fn is_closed(&self) -> bool {
        match self {
            Shape::Sphere(_) | Shape::Slab(_) | Shape::Cuboid(_) => true,
            Shape::Rectangle(_) => false,
            Shape::Mesh(s) => s.is_closed(),
            Shape::Revolution(s) => s.is_closed(),
        }
    }

    /// A sphere about the shape, centre and radius \[L\]; none for one without end.
    pub fn bounds(&self) -> Option<(DVec3, f64)> {
        match self {
            Shape::Sphere(s) => Some((s.center(), s.radius())),
            Shape::Rectangle(r) => Some((r.sample([0.5; 2]), 0.5 * r.diagonal())),
            Shape::Slab(_) => None,
            Shape::Cuboid(c) => Some(about((c.min(), c.max()))),
            Shape::Mesh(m) => Some(about(m.bounds())),
            Shape::Revolution(l) => Some(l.bounds()),
        }
    }

    /// Lower and upper corner of a box about the shape along the axes \[L\]; none for one without end.
    pub fn corners(&self) -> Option<(DVec3, DVec3)> {
        match self {
            Shape::Cuboid(c) => Some((c.min(), c.max())),
            Shape::Mesh(m) => Some(m.bounds()),
            Shape::Rectangle(r) => {
                let [a, b, c, d] = r.corners();
                Some((a.min(b).min(c.min(d)), a.max(b).max(c.max(d))))
            }
            _ => self.bounds().map(|(center, radius)| {
                let reach = DVec3::splat(radius);
                (center - reach, center + reach)
            }),
        }
    }

    /// The part of the ray inside, from 0 on; none for a shape that is not solid.
    pub fn interval(&self, ray: &Ray) -> Option<Interval> {
        match self {
            Shape::Sphere(s) => s.interval(ray),
            Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => None,
            Shape::Slab(s) => s.interval(ray),
            Shape::Cuboid(s) => s.interval(ray),
        }
    }

    /// Density of a ray's direction if it is that from its origin to a uniform point inside [1/sr]: int t^2 dt over the part
    /// inside, over the volume. 0 for a shape that is not solid, or has no end.
    pub fn pdf_towards_inside(&self, ray: &Ray) -> f64 {
        let volume = self.volume();
        match self.interval(ray) {
            Some(inside) if volume.is_finite() => inside.squared_distances() / volume,
            _ => 0.0,
        }
    }

    /// Whether the point is inside; on the surface too, of a solid.
    pub fn contains(&self, p: DVec3) -> bool {
        match self {
            Shape::Sphere(s) => s.contains(p),
            Shape::Rectangle(_) => false,
            Shape::Slab(s) => s.contains(p),
            Shape::Cuboid(s) => s.contains(p),
            Shape::Mesh(s) => s.contains(p),
            Shape::Revolution(s) => s.contains(p),
        }
    }

    /// Distance from a point inside to the nearest point of the surface \[L\]; negative outside, 0 for a shape that
    /// is not solid.
    pub fn room(&self, p: DVec3) -> f64 {
        match self {
            Shape::Sphere(s) => s.radius() - p.distance(s.center()),
            Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => 0.0,
            Shape::Slab(s) => (p.z - s.top()).min(s.face(Face::Bottom) - p.z),
            Shape::Cuboid(c) => (p - c.min()).min_element().min((c.max() - p).min_element()),
        }
    }

    /// The part of a ray in which [`Shape::room`] is at least `least`, which is above 0 \[L\]; none where that is nowhere, or the shape is
    /// not solid.
    pub fn interval_with_room(&self, ray: &Ray, least: f64) -> Option<Interval> {
        let inner = match self {
            Shape::Sphere(s) => Shape::Sphere(Sphere::new(s.center(), s.radius() - least).ok()?),
            Shape::Slab(s) => Shape::Slab(Slab::new(s.top() + least, s.thickness() - 2.0 * least).ok()?),
            Shape::Cuboid(c) => Shape::Cuboid(Cuboid::new(c.min() + least, c.max() - least).ok()?),
            Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => return None,
        };
        inner.interval(ray)
    }

    /// Distance from a point, on either side, to the nearest point of the surface, or `limit` where that is farther \[L\].
    pub fn distance(&self, p: DVec3, limit: f64) -> f64 {
        let distance = match self {
            Shape::Sphere(_) | Shape::Slab(_) => self.room(p).abs(),
            Shape::Rectangle(r) => r.distance(p, limit),
            Shape::Cuboid(c) if c.contains(p) => self.room(p),
            Shape::Cuboid(c) => p.distance(p.clamp(c.min(), c.max())),
            Shape::Mesh(m) => m.distance(p, limit),
            Shape::Revolution(l) => l.distance(p, limit),
        };
        distance.min(limit)
    }

    /// Surface area [L^2]; infinite for a slab.
    pub fn area(&self) -> f64 {
        each!(self, s => s.area())
    }

    /// Volume [L^3]; infinite for a slab, 0 for a rectangle, without meaning for other surfaces that are not closed.
    pub fn volume(&self) -> f64 {
        match self {
            Shape::Sphere(s) => s.volume(),
            Shape::Rectangle(_) => 0.0,
            Shape::Slab(_) => f64::INFINITY,
            Shape::Cuboid(s) => s.volume(),
            Shape::Mesh(s) => s.volume(),
            Shape::Revolution(s) => s.volume(),
        }
    }

    /// A uniform point on the boundary from three numbers in [0, 1), the outward normal there, and the boundary's
    /// area [L^2]. Of a slab: one face, over the cell [0, side.x) x [0, side.y).
    pub fn sample_boundary(&self, face: Face, side: DVec2, u: [f64; 3]) -> (DVec3, DVec3, f64) {
        match self {
            Shape::Sphere(s) => {
                let (p, normal) = s.sample_surface([u[0], u[1]]);
                (p, normal, s.area())
            }
            Shape::Rectangle(r) => (r.sample([u[0], u[1]]), r.normal(), r.area()),
            Shape::Slab(s) => {
                (DVec3::new(u[0] * side.x, u[1] * side.y, s.face(face)), face.normal(), side.x * side.y)
            }
            Shape::Cuboid(c) => {
                let (p, normal) = c.sample_surface(u);
                (p, normal, c.area())
            }
            Shape::Mesh(_) | Shape::Revolution(_) => {
                let (p, normal, _) = self.sample_surface(u);
                (p, normal, self.area())
            }
        }
    }

    /// A uniform point on the surface from three numbers in [0, 1), the outward normal there, and the part of the shape
    /// that it lies on ([`Hit::primitive`]). Of a slab, which has no uniform points: one above the origin.
    pub fn sample_surface(&self, u: [f64; 3]) -> (DVec3, DVec3, u32) {
        match self {
            Shape::Mesh(s) => s.sample_surface([u[0], u[1]]),
            Shape::Revolution(s) => s.sample_surface([u[0], u[1]]),
            Shape::Sphere(_) | Shape::Rectangle(_) | Shape::Slab(_) | Shape::Cuboid(_) => {
                let (p, normal, _) = self.sample_boundary(Face::Top, DVec2::ZERO, u);
                (p, normal, 0)
            }
        }
    }

    /// A uniform point inside from three numbers in [0, 1), and the volume [L^3]; of a slab, the part under the
    /// cell [0, side.x) x [0, side.y); of a shape that is not solid, a point of its surface and 0.
    pub fn sample_inside(&self, side: DVec2, u: [f64; 3]) -> (DVec3, f64) {
        match self {
            Shape::Sphere(s) => (s.sample_inside(u), s.volume()),
            Shape::Rectangle(r) => (r.sample([u[0], u[1]]), 0.0),
            Shape::Slab(s) => {
                let p = DVec3::new(u[0] * side.x, u[1] * side.y, s.top() + u[2] * s.thickness());
                (p, side.x * side.y * s.thickness())
            }
            Shape::Cuboid(c) => (c.sample_inside(u), c.volume()),
            Shape::Mesh(_) | Shape::Revolution(_) => (self.sample_surface(u).0, 0.0),
        }
    }

    /// Shortest extent \[L\]: what the mean free path is compared with.
    pub fn shortest_extent(&self) -> f64 {
        match self {
            Shape::Sphere(s) => 2.0 * s.radius(),
            Shape::Rectangle(_) => 0.0,
            Shape::Slab(s) => s.thickness(),
            Shape::Cuboid(s) => (s.max() - s.min()).min_element(),
            Shape::Mesh(s) => s.shortest_extent(),
            Shape::Revolution(s) => s.shortest_extent(),
        }
    }
}

/// The sphere about a box.
fn about((min, max): (DVec3, DVec3)) -> (DVec3, f64) {
    (0.5 * (min + max), 0.5 * min.distance(max))
}
