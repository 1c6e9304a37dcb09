//! Surfaces in one place: which of them light meets there would be a matter of rounding.

use super::{Binned, Object, Quantity, SceneParts};
use crate::error::{Error, Result};
use crate::geometry::{Face, Rectangle, Shape, Sphere};
use crate::light::{Faces, Light, Section};
use crate::math::{Frame, sin_cos};
use glam::DVec3;
use std::collections::BTreeMap;

/// Surfaces nearer than this part of their size, and of their distance from the origin, count as in one place: rounding is
/// far below, and a gap that anybody means far above.
const SAME: f64 = 1e-9;

/// What helps where rounding decides.
pub(super) const REMEDY: &str =
    "move one of them, if only by a millionth of its size or of its distance from the origin";

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

/// A flat face: a rectangle, a plane of constant z, or a disc with a hole.
#[derive(Clone, Copy)]
enum Flat {
    Rectangle(Rectangle),
    Level(f64),
    Disc { center: DVec3, normal: DVec3, inner: f64, outer: f64 },
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
/// and spheres are compared, meshes with other meshes and flat faces where one of the two is clear; otherwise meshes and
/// lathes only with their equals.
///
/// # Errors
/// `Error::Scene`, naming both bodies.
pub(super) fn check(parts: &SceneParts) -> Result<()> {
    let objects = parts.objects.iter().enumerate().map(|(i, object)| of_object(i, object));
    let lights = parts.lights.iter().enumerate().filter_map(|(i, light)| of_light(i, light));
    let bodies: Vec<Body> = objects.chain(lights).collect();
    for (index, a) in bodies.iter().enumerate() {
        if let Some(b) = bodies[index + 1..].iter().find(|b| matters(a, b)) {
            return refuse(a, b);
        }
    }
    match clear_facets(&bodies) {
        Some((a, b)) => refuse(a, b),
        None => Ok(()),
    }
}

fn refuse(a: &Body, b: &Body) -> Result<()> {
    Err(Error::Scene(format!(
        "{} and {} have surfaces in one place, where rounding decides which of them light meets; {REMEDY}",
        a.name, b.name
    )))
}

/// A triangle of a mesh, or a flat face.
struct Facet {
    body: usize,
    corners: Vec<DVec3>,
    /// Unit.
    normal: DVec3,
    /// Along the axis by which facets of one plane are sorted \[L\].
    span: (f64, f64),
}

/// Two bodies, one of them a mesh and one of them clear, that share an area.
fn clear_facets<'a>(bodies: &'a [Body<'a>]) -> Option<(&'a Body<'a>, &'a Body<'a>)> {
    let is_mesh = |body: &Body| matches!(body.shape, Shape::Mesh(_));
    let is_clear = |body: &Body| body.kind == Kind::Clear;
    if !bodies.iter().any(is_mesh) || !bodies.iter().any(is_clear) {
        return None;
    }
    let facets: Vec<(usize, Vec<DVec3>)> = bodies
        .iter()
        .enumerate()
        .flat_map(|(i, body)| body.facets().into_iter().map(move |f| (i, f)))
        .collect();
    let points = facets.iter().flat_map(|(_, corners)| corners);
    let far = points.map(|p| p.abs().max_element()).fold(0.0, f64::max);
    // Planes by their normal, either way round, and their distance from the origin.
    let mut planes: BTreeMap<[i64; 4], Vec<Facet>> = BTreeMap::new();
    for (number, corners) in facets {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(normal) = normal.try_normalize() else { continue };
        let upward = [normal.z, normal.y, normal.x].into_iter().find(|x| x.abs() > 1e-6).unwrap_or(1.0);
        let normal = normal * upward.signum();
        let key = (normal.extend(normal.dot(corners[0]) / far) * 1e6).round().to_array().map(|x| x as i64);
        // The same for all in the plane, whatever rounding says of its normal.
        let [x, y, z, _] = key.map(|x| x as f64);
        let axis = DVec3::new(x, y, z).normalize().any_orthonormal_vector();
        let along = corners.iter().map(|p| p.dot(axis));
        let span = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        planes.entry(key).or_default().push(Facet { body: number, corners, normal, span });
    }
    for mut facets in planes.into_values() {
        facets.sort_by(|a, b| a.span.0.total_cmp(&b.span.0));
        for (index, f) in facets.iter().enumerate() {
            let beside = facets[index + 1..].iter().take_while(|g| g.span.0 < f.span.1);
            for g in beside.filter(|g| g.body != f.body) {
                let (a, b) = (&bodies[f.body], &bodies[g.body]);
                if (is_mesh(a) || is_mesh(b)) && (is_clear(a) || is_clear(b)) && f.overlaps(g) {
                    return Some(if f.body < g.body { (a, b) } else { (b, a) });
                }
            }
        }
    }
    None
}

impl Facet {
    /// Whether two convex facets lie in one plane and share an area: no line along an edge of either parts them.
    fn overlaps(&self, other: &Facet) -> bool {
        let all = || self.corners.iter().chain(&other.corners);
        let far = all().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let least = SAME * far;
        if other.corners.iter().any(|p| (*p - self.corners[0]).dot(self.normal).abs() > least) {
            return false;
        }
        let along = |facet: &Facet, axis: DVec3| {
            let at = facet.corners.iter().map(|p| p.dot(axis));
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        [self, other].into_iter().all(|facet| {
            (0..facet.corners.len()).all(|i| {
                let edge = facet.corners[(i + 1) % facet.corners.len()] - facet.corners[i];
                let axis = edge.cross(self.normal).normalize_or_zero();
                let ((low, high), (other_low, other_high)) = (along(self, axis), along(other, axis));
                high.min(other_high) - low.max(other_low) > least
            })
        })
    }
}

impl Body<'_> {
    /// Triangles and flat faces with corners, one after the other around each.
    fn facets(&self) -> Vec<Vec<DVec3>> {
        if let Shape::Mesh(mesh) = self.shape {
            return (0..mesh.len() as u32).map(|index| mesh.triangle(index).to_vec()).collect();
        }
        let flat = |face: &Flat| match face {
            Flat::Rectangle(r) => Some(r.corners().to_vec()),
            // As a polygon of nearly its area; a hole is left out.
            Flat::Disc { center, normal, inner: 0.0, outer } => {
                let frame = Frame::new(*normal);
                let corner = |i: u32| {
                    let (sin, cos) = sin_cos(f64::from(i) * std::f64::consts::TAU / 32.0);
                    center + (frame.x * cos + frame.y * sin) * *outer
                };
                Some((0..32).map(corner).collect())
            }
            Flat::Disc { .. } | Flat::Level(_) => None,
        };
        self.faces.iter().filter_map(flat).collect()
    }
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
        Shape::Revolution(revolution) => {
            let disc = |(center, normal, [inner, outer]): (DVec3, DVec3, [f64; 2])| Flat::Disc {
                center,
                normal,
                inner,
                outer,
            };
            revolution.discs().map(disc).collect()
        }
        Shape::Sphere(_) | Shape::Mesh(_) => Vec::new(),
    }
}

/// Whether two bodies share an area where it matters which of them is met.
fn matters(a: &Body, b: &Body) -> bool {
    match (a.shape, b.shape) {
        (Shape::Sphere(a), Shape::Sphere(b)) => are_one(a, b),
        (Shape::Revolution(a), Shape::Revolution(b)) if a.nearly(b, SAME) => true,
        (Shape::Mesh(_), _) => a.shape == b.shape,
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

/// A surface that light starts from or that is measured on, and that is no body.
struct Mark<'a> {
    name: String,
    shape: Option<&'a Shape>,
    faces: Vec<Flat>,
}

/// Refuses what starts or is measured on the very surface of a body: rounding would decide on which side.
///
/// # Errors
/// `Error::Scene`, naming both.
pub(super) fn check_marks(parts: &SceneParts) -> Result<()> {
    let objects = parts.objects.iter().enumerate().map(|(i, object)| of_object(i, object));
    let lamps = parts.lights.iter().enumerate().filter_map(|(i, light)| of_light(i, light));
    let bodies: Vec<Body> = objects.chain(lamps).collect();
    let of_face = |shape: &Shape, face: Option<Face>| match (shape, face) {
        (Shape::Slab(slab), Some(face)) => vec![Flat::Level(slab.face(face))],
        _ => faces(shape),
    };
    let mut marks = Vec::new();
    for (index, light) in parts.lights.iter().enumerate() {
        let name = format!("lights[{index}]");
        match light {
            Light::Isotropic(light) => {
                let face = (light.faces() == Faces::Top).then_some(Face::Top);
                let (shape, faces) = (Some(light.shape()), of_face(light.shape(), face));
                marks.push(Mark { name, shape, faces });
            }
            Light::Beam(beam) => match beam.section() {
                Section::Rectangle(section) => {
                    marks.push(Mark { name, shape: None, faces: vec![Flat::Rectangle(section)] });
                }
                Section::Disc { center, radius } => {
                    let disc = Flat::Disc { center, normal: beam.dir(), inner: 0.0, outer: radius };
                    marks.push(Mark { name, shape: None, faces: vec![disc] });
                }
                Section::Unbounded => {}
            },
            _ => {}
        }
    }
    for sensor in &parts.sensors {
        if let Quantity::Outflow { shape, face } = &sensor.quantity {
            let (name, faces) = (format!("sensor {}", sensor.name), of_face(shape, Some(*face)));
            marks.push(Mark { name, shape: Some(shape), faces });
        }
        if let Some(Binned::Flux { bins, .. } | Binned::Radiance { bins, .. }) = sensor.binned() {
            let (name, faces) = (format!("sensor {}", sensor.name), vec![Flat::Rectangle(*bins.rectangle())]);
            marks.push(Mark { name, shape: None, faces });
        }
    }
    for mark in &marks {
        let is_on = |body: &&Body| match (mark.shape, body.shape) {
            (Some(Shape::Sphere(a)), Shape::Sphere(b)) => are_one(a, b),
            (Some(Shape::Revolution(a)), Shape::Revolution(b)) if a.nearly(b, SAME) => true,
            (Some(a @ Shape::Mesh(_)), b) => a == b,
            _ => mark.faces.iter().any(|f| body.faces.iter().any(|g| share(f, g))),
        };
        if let Some(body) = bodies.iter().find(is_on) {
            return refuse_mark(&mark.name, body);
        }
    }
    Ok(())
}

fn refuse_mark(name: &str, body: &Body) -> Result<()> {
    Err(Error::Scene(format!(
        "{name} lies on the surface of {}, where rounding decides on which side it is; {REMEDY}",
        body.name
    )))
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
        (&Flat::Disc { center, normal, inner, outer }, other)
        | (other, &Flat::Disc { center, normal, inner, outer }) => {
            let least = SAME * (outer + center.abs().max_element());
            let is_one_plane =
                |n: DVec3, p: DVec3| normal.cross(n).length() <= SAME && (center - p).dot(n).abs() <= least;
            match other {
                Flat::Level(z) => is_one_plane(DVec3::Z, DVec3::new(0.0, 0.0, *z)),
                Flat::Rectangle(r) => {
                    is_one_plane(r.normal(), r.corners()[0])
                        && Shape::Rectangle(*r).distance(center, f64::INFINITY) < outer
                        && r.corners().iter().any(|p| p.distance(center) > inner)
                }
                Flat::Disc { center: c, normal: n, inner: hole, outer: edge } => {
                    let apart = center.distance(*c);
                    is_one_plane(*n, *c)
                        && apart < outer + edge
                        && apart + edge > inner
                        && apart + outer > *hole
                }
            }
        }
    }
}
