//! How much of a kernel's disc the surfaces fill whose photons count: what estimates on diffuse surfaces are divided by.
//!
//! Photons count by their place and by the normal of the surface that they arrived on ([`Tangent`]), and so do surfaces: an
//! estimate is the sum over the photons, over the integral of the kernel over the accepted surface,
//!
//! E = (sum p K_r(d) / N) / (int K_r(d) dA).
//!
//! Of rectangles, of the faces of cuboids and of spheres with nothing near the integral is known in closed form. Otherwise
//! lines along the normal look for it: places of density K_r on the disc, each with the first surface that a line meets there,
//! the secant of its slope for weight. Where the closed form is known too, it is corrected by what the lines say of both, so
//! that it stands where nothing is covered.
//!
//! What another body hides is no part of it: a surface is *hidden* if the way to it, lifted off both ends by the height up to
//! which surfaces are accepted, is blocked. There photons are asked as well, one by one, so that light from beyond a wall does
//! not count where its floor does not.

use crate::estimators::{Kernel, cap_share, disc_share};
use crate::geometry::{Rectangle, Shape};
use crate::math::{Frame, Ray, sin_cos};
use crate::photons::tree::Tangent;
use crate::rng::Stream;
use crate::scene::{Scene, SceneHit, Target};
use crate::surface::Surface;
use glam::DVec3;
use std::f64::consts::TAU;

/// Photons of a flat surface lie on it, so that few of another one that meets it need be let in.
const FLAT: f64 = 0.1;

/// How far surfaces may face away from the place that asks, as |n - n'|, on curved bodies: 29 degrees, so that the facets of
/// a coarse mesh count as one surface and those of a box do not.
const TURN: f64 = 0.5;

/// Planes count as one if their normals differ by less than this, and their places by less than this part of a diagonal:
/// what rounding of a scene's numbers leaves.
const SAME: f64 = 1e-6;

/// Lines of a first look, which says how to look and is then forgotten, so that chance does not choose what is believed.
const PILOT: u32 = 8;

/// Lines where half of the first ones found surface, on a spiral: the error of an area with a straight edge is about
/// m^(-3/4)/3, 2 per cent of the disc.
const LINES: u32 = 32;

/// Elsewhere independent lines are tried until so many have found surface: with n found in T the mean of T/n is the inverse
/// of the part that finds any, exactly.
const ENOUGH: u32 = 32;

/// But no more than so many lines.
const MOST: u32 = 4096;

/// Part of a full turn between the points of a spiral that fills a disc evenly: the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A body that light does not pass.
#[derive(Debug)]
struct Body {
    shape: Shape,
    is_diffuse: bool,
    is_closed: bool,
    /// Its flat faces, of a cuboid in the order of [`side`]; none where rounding leaves no rectangle.
    faces: Vec<Option<Rectangle>>,
    /// For each face the diffuse ones in its plane, itself among them.
    planes: Vec<Plane>,
}

/// Diffuse faces in one plane.
#[derive(Debug)]
struct Plane {
    faces: Vec<Face>,
    /// Whether some of them cover the same place.
    has_overlap: bool,
}

/// One flat face of a body.
#[derive(Debug, Clone, Copy)]
struct Face {
    body: usize,
    rectangle: Rectangle,
}

/// The bodies of a scene that photons can be stored on, or hidden by.
#[derive(Debug)]
pub(super) struct Bodies {
    list: Vec<Body>,
    /// Where in the list an object is.
    of_object: Vec<Option<usize>>,
}

impl Bodies {
    pub fn new(scene: &Scene) -> Self {
        let (mut list, mut of_object) = (Vec::new(), Vec::new());
        for object in scene.objects() {
            let is_opaque = object.surface.is_opaque();
            of_object.push(is_opaque.then_some(list.len()));
            if is_opaque {
                let is_diffuse = matches!(object.surface, Surface::Lambertian(_));
                list.push(Body::new(&object.shape, is_diffuse));
            }
        }
        list.extend(
            scene.lights().iter().filter_map(|light| light.body()).map(|shape| Body::new(shape, false)),
        );
        let all: Vec<Face> = list
            .iter()
            .enumerate()
            .filter(|(_, body)| body.is_diffuse)
            .flat_map(|(index, body)| {
                body.faces.iter().flatten().map(move |rectangle| Face { body: index, rectangle: *rectangle })
            })
            .collect();
        for body in list.iter_mut().filter(|body| body.is_diffuse) {
            let plane = |face: &Option<Rectangle>| {
                let is_in = |other: &&Face| face.is_some_and(|face| is_same_plane(&face, &other.rectangle));
                let faces: Vec<Face> = all.iter().filter(is_in).copied().collect();
                let has_overlap = faces.iter().enumerate().any(|(i, face)| {
                    faces[..i].iter().any(|other| is_overlapping(&face.rectangle, &other.rectangle))
                });
                Plane { faces, has_overlap }
            };
            body.planes = body.faces.iter().map(plane).collect();
        }
        Bodies { list, of_object }
    }

    /// The place of a hit; none on a body that light passes.
    ///
    /// # Arguments
    /// `normal` unit, on the side where light arrives; `slope` as set for curved surfaces
    pub fn place(&self, found: &SceneHit, point: DVec3, normal: DVec3, slope: f64) -> Option<Place<'_>> {
        let Target::Object(object) = found.target else { return None };
        let own = self.of_object[object]?;
        let body = &self.list[own];
        let plane = match body.planes.len() {
            0 => None,
            1 => Some(&body.planes[0]),
            _ => Some(&body.planes[side(found.hit.normal)]),
        };
        let is_flat = matches!(body.shape, Shape::Rectangle(_) | Shape::Cuboid(_) | Shape::Slab(_));
        let tangent = match is_flat {
            // What one slope turns.
            true => Tangent { normal, slope: FLAT * slope, turn: 2.0 * FLAT * slope },
            false => Tangent { normal, slope, turn: TURN },
        };
        let exact = match (&body.shape, plane) {
            (Shape::Slab(_), _) => Exact::Plane,
            (Shape::Sphere(_), _) => Exact::Sphere,
            (_, Some(plane)) if !plane.faces.is_empty() => Exact::Faces(plane),
            _ => Exact::Unknown,
        };
        Some(Place { bodies: self, own, is_outer: found.hit.normal.dot(normal) > 0.0, point, tangent, exact })
    }
}

impl Body {
    fn new(shape: &Shape, is_diffuse: bool) -> Self {
        Body {
            shape: shape.clone(),
            is_diffuse,
            is_closed: shape.is_closed(),
            faces: faces(shape),
            planes: Vec::new(),
        }
    }
}

/// What is known in closed form about a place.
#[derive(Debug)]
enum Exact<'a> {
    /// It lies in a plane without end.
    Plane,
    /// It lies on a flat face, of several in its plane.
    Faces(&'a Plane),
    /// It lies on a sphere.
    Sphere,
    /// Nothing.
    Unknown,
}

/// A place on a diffuse surface where light arrives.
#[derive(Debug)]
pub(super) struct Place<'a> {
    bodies: &'a Bodies,
    /// The body that it lies on.
    own: usize,
    /// Whether light arrives on the outer side of that body.
    is_outer: bool,
    point: DVec3,
    /// Which photons count here, and which surfaces.
    pub tangent: Tangent,
    exact: Exact<'a>,
}

/// How much surface there is about a place.
#[derive(Debug)]
pub(super) struct Part {
    /// The kernel's integral over the accepted surface \[1\]: 1 if the disc is whole.
    pub share: f64,
    /// Whether lines enough found it.
    pub is_known: bool,
    /// Bodies that hide some of the disc; none if nothing is hidden.
    pub hiding: Option<Vec<usize>>,
}

/// What lines found.
#[derive(Debug, Clone, Copy, Default)]
struct Lines {
    /// Kernel on the accepted surface.
    seen: f64,
    /// Kernel on the surface that is known in closed form, as though nothing were near.
    exact: f64,
    /// How many, and how many of them found an accepted surface.
    count: u32,
    found: u32,
    is_hidden: bool,
}

impl Place<'_> {
    /// The farthest that accepted photons of its own body lie \[L\].
    pub fn reach(&self) -> f64 {
        match &self.bodies.list[self.own].shape {
            // Beyond the chord that turns too far; rounding may let a photon in there.
            Shape::Sphere(sphere) => {
                let Tangent { slope, turn, .. } = self.tangent;
                sphere.radius() * (2.0 * slope).min(turn) * (1.0 + SAME)
            }
            shape @ (Shape::Mesh(_) | Shape::Revolution(_)) => {
                shape.bounds().map_or(f64::INFINITY, |(_, radius)| 2.0 * radius)
            }
            _ => f64::INFINITY,
        }
    }

    /// Whether [`Place::reach`], or where flat faces end, is known. Elsewhere photons tell how far the accepted surface reaches:
    /// where all of them are fewer than k, the farthest.
    pub fn has_reach(&self) -> bool {
        !matches!(self.exact, Exact::Unknown)
    }

    /// The part of a kernel's disc about the place that accepted surface fills.
    pub fn part(&self, kernel: Kernel, radius: f64, stream: &mut Stream) -> Part {
        let (exact, has_overlap) = self.known(kernel, radius);
        let near: Vec<usize> =
            (0..self.bodies.list.len()).filter(|&index| self.matters(index, radius)).collect();
        if let Some(share) = exact.filter(|_| near.is_empty() && !has_overlap) {
            return Part { share, is_known: true, hiding: None };
        }
        let pilot = self.lines(kernel, radius, &near, [PILOT, PILOT], spiral(PILOT, stream));
        let is_full = 2 * pilot.found >= PILOT;
        let lines = match is_full {
            true => self.lines(kernel, radius, &near, [LINES, LINES], spiral(LINES, stream)),
            false => self.lines(kernel, radius, &near, [MOST, ENOUGH], |_| stream.pair()),
        };
        let count = f64::from(lines.count);
        let share = match exact {
            Some(exact) if lines.seen <= lines.exact => {
                exact * (lines.seen / lines.exact.max(f64::MIN_POSITIVE))
            }
            Some(exact) => exact + (lines.seen - lines.exact) / count,
            None => lines.seen / count,
        };
        let is_known = share > 0.0 && (is_full || lines.found == ENOUGH);
        Part { share, is_known, hiding: lines.is_hidden.then_some(near) }
    }

    /// Whether no body of a list stands in the way to a point, lifted off the surface.
    pub fn sees(&self, point: DVec3, near: &[usize]) -> bool {
        let way = point - self.point;
        let distance = way.length();
        if distance == 0.0 {
            return true;
        }
        let lifted = self.point + self.tangent.normal * (self.tangent.slope * distance);
        let ray = Ray::new(lifted, way / distance);
        !near.iter().any(|&index| self.bodies.list[index].shape.blocks(&ray, None, distance))
    }

    /// The share in closed form as though nothing else were near, and whether faces overlap, so that it may be too much.
    fn known(&self, kernel: Kernel, radius: f64) -> (Option<f64>, bool) {
        match &self.exact {
            Exact::Plane => (Some(1.0), false),
            Exact::Sphere => (Some(cap_share(kernel, self.reach() / radius)), false),
            Exact::Faces(plane) => {
                let mut lit = self.lit(plane);
                let share = |face: &Face| disc_share(kernel, &face.rectangle, self.point, radius);
                if plane.has_overlap {
                    return (Some(lit.map(share).sum()), true);
                }
                // A whole disc on its own face needs no other.
                let mut sum = 0.0;
                while sum < 1.0
                    && let Some(face) = lit.next()
                {
                    sum += share(face);
                }
                (Some(sum.min(1.0)), false)
            }
            Exact::Unknown => (None, false),
        }
    }

    /// The faces of a plane that light falls on, on the side of the place: of a solid the outer ones, and from within the
    /// inner ones.
    fn lit<'p>(&self, plane: &'p Plane) -> impl Iterator<Item = &'p Face> {
        plane.faces.iter().filter(|face| {
            let shape = &self.bodies.list[face.body].shape;
            !shape.is_solid()
                || match face.body == self.own {
                    true => (face.rectangle.normal().dot(self.tangent.normal) > 0.0) == self.is_outer,
                    false => {
                        face.rectangle.normal().dot(self.tangent.normal) > 0.0 || shape.contains(self.point)
                    }
                }
        })
    }

    /// Whether a body may cover, hide or add surface within a radius, beyond what is known in closed form.
    fn matters(&self, index: usize, radius: f64) -> bool {
        let reach = radius * (1.0 + SAME);
        let is_known = match &self.exact {
            Exact::Plane | Exact::Sphere => index == self.own,
            Exact::Faces(plane) => index == self.own || self.lit(plane).any(|face| face.body == index),
            Exact::Unknown => false,
        };
        !is_known && self.bodies.list[index].shape.distance(self.point, reach) < reach
    }

    /// Lines along the normal through places of density K on the disc, each made from two numbers in [0, 1): at most `most`,
    /// until `enough` have found surface.
    fn lines(
        &self,
        kernel: Kernel,
        radius: f64,
        near: &[usize],
        [most, enough]: [u32; 2],
        mut numbers: impl FnMut(u32) -> [f64; 2],
    ) -> Lines {
        let Tangent { normal, slope, .. } = self.tangent;
        let frame = Frame::new(normal);
        // Height over distance across, of what is accepted.
        let steep = slope / (1.0 - slope * slope).max(SAME).sqrt();
        let mut lines = Lines::default();
        while lines.count < most && lines.found < enough {
            let [part, turn] = numbers(lines.count);
            lines.count += 1;
            let across = radius * kernel.sample_disc(part);
            let (sin, cos) = sin_cos(TAU * turn);
            let foot = self.point + frame.to_world(DVec3::new(cos * across, sin * across, 0.0));
            // Surfaces in the plane of the place lie ahead, whatever rounding does.
            let height = across * steep + SAME * radius;
            let ray = Ray::new(foot + normal * height, -normal);
            // Kernel by area of the surface over kernel of the disc, of a surface with this normal.
            let weight = |point: DVec3, outward: DVec3| {
                let (way, facing) = (point - self.point, outward.dot(normal));
                let u2 = way.length_squared() / (radius * radius);
                let is_accepted = u2 < 1.0 && self.tangent.accepts(way, outward * facing.signum());
                let over = kernel.profile(u2.min(1.0)) / kernel.profile(across * across / (radius * radius));
                if is_accepted { over / facing.abs() } else { 0.0 }
            };
            let (mut first, exact) = self.line(&ray, foot, height, weight);
            lines.exact += exact;
            for &index in near {
                let body = &self.bodies.list[index];
                let Some(hit) = body.shape.hit(&ray, None).filter(|hit| hit.t <= 2.0 * height) else {
                    continue;
                };
                // What lies in the plane of a known face counts there.
                if first.is_some_and(|(t, ..)| hit.t >= t - SAME * radius) {
                    continue;
                }
                let is_outer = hit.normal.dot(ray.dir) < 0.0;
                let is_wrong_side = index == self.own && body.is_closed && is_outer != self.is_outer;
                let counts = body.is_diffuse && !is_wrong_side;
                let point = ray.at(hit.t);
                first = Some((hit.t, point, if counts { weight(point, hit.normal) } else { 0.0 }));
            }
            if let Some((_, point, weight)) = first.filter(|(_, _, weight)| *weight > 0.0) {
                if self.sees(point, near) {
                    lines.seen += weight;
                    lines.found += 1;
                } else {
                    lines.is_hidden = true;
                }
            }
        }
        lines
    }

    /// The meeting of a line with the surface that is known in closed form, if there is one: distance, point and weight. And
    /// the weight that the closed form counts there.
    fn line(
        &self,
        ray: &Ray,
        foot: DVec3,
        height: f64,
        weight: impl Fn(DVec3, DVec3) -> f64,
    ) -> (Option<(f64, DVec3, f64)>, f64) {
        match &self.exact {
            Exact::Plane => (Some((height, foot, 1.0)), 1.0),
            Exact::Faces(plane) => {
                let count = self.lit(plane).filter(|face| face.rectangle.covers(foot)).count();
                ((count > 0).then_some((height, foot, 1.0)), count as f64)
            }
            Exact::Sphere => {
                let hit = self.bodies.list[self.own].shape.hit(ray, None);
                let hit = hit.filter(|hit| (hit.normal.dot(ray.dir) < 0.0) == self.is_outer);
                let met = hit.map(|hit| {
                    let point = ray.at(hit.t);
                    (hit.t, point, weight(point, hit.normal))
                });
                (met, met.map_or(0.0, |(_, _, weight)| weight))
            }
            Exact::Unknown => (None, 0.0),
        }
    }
}

/// Numbers that put points on a spiral which fills a disc evenly, shifted and turned at random.
fn spiral(count: u32, stream: &mut Stream) -> impl FnMut(u32) -> [f64; 2] + use<> {
    let [shift, turn] = stream.pair();
    move |i| [(f64::from(i) + shift) / f64::from(count), f64::from(i) * GOLDEN + turn]
}

/// The flat faces of a shape, of a cuboid in the order of [`side`].
fn faces(shape: &Shape) -> Vec<Option<Rectangle>> {
    match shape {
        Shape::Rectangle(rectangle) => vec![Some(*rectangle)],
        Shape::Cuboid(cuboid) => {
            let (min, max) = (cuboid.min(), cuboid.max());
            let edge = |axis: usize| DVec3::AXES[axis] * (max - min)[axis];
            let face = |side: usize| {
                let (axis, is_high) = (side / 2, side % 2 == 1);
                let [a, b] = [edge((axis + 1) % 3), edge((axis + 2) % 3)];
                let rectangle = match is_high {
                    true => Rectangle::new(min + edge(axis), a, b),
                    false => Rectangle::new(min, b, a),
                };
                // Edges below the root of the smallest number have no product.
                rectangle.ok().filter(|rectangle| rectangle.normal().is_normalized())
            };
            (0..6).map(face).collect()
        }
        Shape::Sphere(_) | Shape::Slab(_) | Shape::Mesh(_) | Shape::Revolution(_) => Vec::new(),
    }
}

/// Which face of a box has this outward normal.
fn side(normal: DVec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] > 0.0)
}

fn is_same_plane(a: &Rectangle, b: &Rectangle) -> bool {
    let is_parallel = a.normal().cross(b.normal()).length() < SAME;
    is_parallel && a.height(b.sample([0.5; 2])).abs() < SAME * a.diagonal().max(b.diagonal())
}

/// Whether two rectangles of one plane share more than an edge: along no edge of either do their shadows part.
fn is_overlapping(a: &Rectangle, b: &Rectangle) -> bool {
    let corners = |r: &Rectangle| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|at| r.sample(at));
    let shadow = |r: &Rectangle, along: DVec3| {
        let places = corners(r).map(|corner| (corner - a.sample([0.5; 2])).dot(along));
        (
            places.iter().copied().fold(f64::INFINITY, f64::min),
            places.iter().copied().fold(-f64::INFINITY, f64::max),
        )
    };
    let margin = SAME * a.diagonal().min(b.diagonal());
    [a, b]
        .into_iter()
        .flat_map(|r| {
            [r.sample([1.0, 0.0]) - r.sample([0.0, 0.0]), r.sample([0.0, 1.0]) - r.sample([0.0, 0.0])]
        })
        .all(|edge| {
            let along = edge.normalize();
            let ((low_a, high_a), (low_b, high_b)) = (shadow(a, along), shadow(b, along));
            high_a.min(high_b) - low_a.max(low_b) > margin
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cuboid;

    #[test]
    fn sides_of_a_box() {
        let shape = Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).unwrap());
        let faces = faces(&shape);
        assert_eq!(faces.len(), 6);
        for (index, face) in faces.iter().enumerate() {
            let face = face.unwrap();
            let normal = face.normal();
            assert_eq!(side(normal), index);
            // Outwards: the box's middle lies behind.
            assert!(face.height(DVec3::new(0.5, 1.0, 1.5)) < 0.0);
            assert!(face.inside(DVec3::new(0.5, 1.0, 1.5)) >= 0.5 - 1e-12);
        }
    }

    /// Of a box thinner than any rectangle the two large faces are left, each in its place.
    #[test]
    fn faces_without_a_rectangle_keep_their_places() {
        for thin in [1e-310, 1e-200, 1e200] {
            let shape = Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 1e160, thin)).unwrap());
            let faces = faces(&shape);
            assert_eq!(faces.len(), 6);
            for (index, face) in faces.iter().enumerate() {
                assert!(face.is_none_or(|face| side(face.normal()) == index));
            }
        }
    }

    #[test]
    fn rectangles_of_a_plane_overlap_or_touch() {
        let at = |x: f64, y: f64, u: DVec3, v: DVec3| Rectangle::new(DVec3::new(x, y, 0.0), u, v).unwrap();
        let unit = at(0.0, 0.0, DVec3::X, DVec3::Y);
        let diagonal = (DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 1.0, 0.0));
        for (other, overlaps) in [
            (unit, true),
            (at(1.0, 0.0, DVec3::X, DVec3::Y), false),
            (at(0.9, 0.9, DVec3::X, DVec3::Y), true),
            (at(0.2, 0.2, DVec3::X * 0.1, DVec3::Y * 0.1), true),
            (at(1.6, 0.5, diagonal.0, diagonal.1), false),
            (at(1.4, -0.6, diagonal.0, diagonal.1), true),
        ] {
            assert_eq!(is_overlapping(&unit, &other), overlaps, "{other:?}");
            assert_eq!(is_overlapping(&other, &unit), overlaps, "{other:?}");
        }
    }
}
