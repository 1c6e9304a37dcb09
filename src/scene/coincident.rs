//! Surfaces in one place: which of them light meets there would be a matter of rounding.

use super::{Object, Parts};
use crate::error::{Error, Result};
use crate::geometry::{Face, Rectangle, Shape, Sphere};
use crate::light::Light;

/// Surfaces nearer than this part of their size, and of their distance from the origin, count as in one place: rounding is
/// far below, and a gap that anybody means far above.
const SAME: f64 = 1e-9;

/// What light meets on a surface.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A lamp.
    Light,
    /// A diffuse, mirroring or black surface.
    Opaque,
    /// A dielectric or a filter.
    Clear,
}

/// A flat face: a rectangle, or a plane of constant z.
#[derive(Clone, Copy)]
enum Flat {
    Rectangle(Rectangle),
    Level(f64),
}

/// A body: its name in the scene file, its shape, its flat faces.
struct Body<'a> {
    name: String,
    shape: &'a Shape,
    kind: Kind,
    faces: Vec<Flat>,
}

/// Refuses surfaces that share an area, where rounding would decide which of the two light meets.
///
/// Those of a dielectric or a filter with any other, and of lamps. Of opaque rectangles in one plane, and of one with a lamp
/// that is a rectangle, the first counts ([`Rectangles`](crate::geometry::Rectangles)). Opaque solids may touch and stand
/// on rectangles, and lamps that are cuboids may touch each other: nobody sees where they do. Rectangles, cuboids, slabs
/// and spheres are compared, other shapes only with their equals.
///
/// # Errors
/// `Error::Scene`, naming both bodies.
pub(super) fn check(parts: &Parts) -> Result<()> {
    let objects = parts.objects.iter().enumerate().map(|(i, object)| of_object(i, object));
    let lights = parts.lights.iter().enumerate().filter_map(|(i, light)| of_light(i, light));
    let bodies: Vec<Body> = objects.chain(lights).collect();
    for (index, a) in bodies.iter().enumerate() {
        if let Some(b) = bodies[index + 1..].iter().find(|b| matters(a, b)) {
            return Err(Error::Scene(format!(
                "{} and {} have surfaces in one place, where rounding decides which of them light meets; move one of them, if only by a millionth of its size",
                a.name, b.name
            )));
        }
    }
    Ok(())
}

fn of_object(index: usize, object: &Object) -> Body<'_> {
    let is_clear = !object.surface.is_opaque();
    let kind = if is_clear { Kind::Clear } else { Kind::Opaque };
    Body { name: format!("objects[{index}]"), shape: &object.shape, kind, faces: faces(&object.shape) }
}

fn of_light(index: usize, light: &Light) -> Option<Body<'_>> {
    let shape = light.body()?;
    Some(Body { name: format!("lights[{index}]"), shape, kind: Kind::Light, faces: faces(shape) })
}

fn faces(shape: &Shape) -> Vec<Flat> {
    match shape {
        Shape::Rectangle(rectangle) => vec![Flat::Rectangle(*rectangle)],
        Shape::Cuboid(cuboid) => cuboid.faces().into_iter().map(Flat::Rectangle).collect(),
        Shape::Slab(slab) => [Face::Top, Face::Bottom].map(|face| Flat::Level(slab.face(face))).to_vec(),
        Shape::Sphere(_) | Shape::Mesh(_) | Shape::Lathe(_) => Vec::new(),
    }
}

/// Whether two bodies share an area where it matters which of them is met.
fn matters(a: &Body, b: &Body) -> bool {
    match (a.shape, b.shape) {
        (Shape::Sphere(a), Shape::Sphere(b)) => are_one(a, b),
        (Shape::Mesh(_) | Shape::Lathe(_), _) => a.shape == b.shape,
        _ => a.faces.iter().any(|f| b.faces.iter().any(|g| is_seen((a, f), (b, g)) && share(f, g))),
    }
}

fn are_one(a: &Sphere, b: &Sphere) -> bool {
    let apart = a.center().distance(b.center()) + (a.radius() - b.radius()).abs();
    apart <= SAME * (a.radius() + a.center().abs().max_element())
}

/// Whether light can come to where two faces of these bodies lie in one place.
fn is_seen((a, f): (&Body, &Flat), (b, g): (&Body, &Flat)) -> bool {
    let is_cuboid = |body: &Body| matches!(body.shape, Shape::Cuboid(_));
    let is_rectangle = |body: &Body| matches!(body.shape, Shape::Rectangle(_));
    match (a.kind, b.kind, f, g) {
        (Kind::Light, Kind::Light, Flat::Rectangle(f), Flat::Rectangle(g)) => {
            !(is_cuboid(a) && is_cuboid(b) && f.normal().dot(g.normal()) < 0.0)
        }
        (Kind::Clear, ..) | (_, Kind::Clear, ..) => true,
        (Kind::Light, ..) | (_, Kind::Light, ..) => !(is_rectangle(a) && is_rectangle(b)),
        (Kind::Opaque, Kind::Opaque, Flat::Rectangle(f), Flat::Rectangle(g)) => {
            match (is_cuboid(a), is_cuboid(b)) {
                (false, false) => false,
                // A picture on the side of a block is seen, what a block stands on is not.
                (true, false) => g.corners().iter().all(|p| f.covers(*p)),
                (false, true) => f.corners().iter().all(|p| g.covers(*p)),
                (true, true) => false,
            }
        }
        (Kind::Opaque, Kind::Opaque, ..) => false,
    }
}

/// Whether two faces lie in one plane and share an area.
fn share(f: &Flat, g: &Flat) -> bool {
    match (f, g) {
        (Flat::Level(a), Flat::Level(b)) => (a - b).abs() <= SAME * a.abs().max(b.abs()),
        (Flat::Level(z), Flat::Rectangle(r)) | (Flat::Rectangle(r), Flat::Level(z)) => {
            let least = SAME * (r.diagonal() + z.abs());
            r.corners().iter().all(|p| (p.z - z).abs() <= least)
        }
        (Flat::Rectangle(a), Flat::Rectangle(b)) => a.overlaps(b),
    }
}
