//! What comes near a stretch of a ray: looked for once, and asked at every place of it.

use super::Boundary;
use super::sheets::{ALONG, FaceLine, Sheets, rectangles_of};
use super::visible::{DiscShare, Surroundings};
use crate::estimators::Kernel;
use crate::estimators::disc_share::share_before;
use crate::geometry::{Cuboid, Front, Rectangle, Shape};
use crate::math::{Frame, Interval, Ray};
use glam::{DVec2, DVec3};

/// Bodies are looked for a little beyond a radius, so that rounding leaves none out.
const BEYOND: f64 = 1.001;

/// Bodies that reach no farther out of a face of the medium than this part of the radius, and of the medium's thickness, neither hide nor
/// cut off what the face does not.
const IN_FACE: f64 = 1e-6;

/// Faces that a medium bounded by planes has at most.
const FACES: usize = 6;

/// The bodies and regions that come within a distance of a stretch of a ray, each with the part of the line where it may.
pub(in crate::estimators) struct Beside<'a> {
    boundary: &'a Boundary<'a>,
    ray: &'a Ray,
    bodies: Vec<(Interval, &'a Shape)>,
    later: Vec<(Interval, &'a Shape)>,
    /// The medium's faces as the ray's origin has them, where they are planes; the same on discs.
    faces: Option<Vec<Front>>,
    lines: Vec<FaceLine>,
    axes: Frame,
}

impl<'a> Beside<'a> {
    /// What is nearer to the stretch than a radius \[L\].
    pub fn new(boundary: &'a Boundary<'_>, ray: &'a Ray, span: Interval, radius: f64) -> Self {
        let reach = BEYOND * radius;
        let near = |shape: &'a Shape| Some((about(shape, ray, reach)?.intersection(span)?, shape));
        let faces = boundary.medium.and_then(|medium| medium.faces_about(ray.origin));
        // Faces come in pairs.
        let thickness = |pair: &[Front]| pair.iter().map(|face| face.distance).sum::<f64>();
        let thinnest = faces.iter().flat_map(|faces| faces.chunks(2)).map(thickness).fold(radius, f64::min);
        let is_in_face = |shape: &Shape| {
            let is_behind = |face: &Front| shape.is_behind(ray.origin, face, IN_FACE * thinnest);
            faces.as_ref().is_some_and(|faces| faces.iter().any(is_behind))
        };
        let bodies = boundary.bodies.iter().filter_map(near).filter(|(_, body)| !is_in_face(body)).collect();
        let later = boundary.later.iter().filter_map(near).collect();
        let axes = Frame::new(ray.dir);
        let lines = faces.iter().flatten().filter_map(|face| FaceLine::new(face, &axes)).collect();
        Beside { boundary, ray, bodies, later, faces, lines, axes }
    }

    /// The part of the disc of a radius across the ray on which photons are kept, of one found `seen` \[L\] from its middle at a distance along
    /// it, as [`Beside::share`]. `salt` of what is chosen at random.
    pub fn disc_share(
        &self,
        kernel: Kernel,
        (along, radius, seen): (f64, f64, f64),
        (is_clipped, is_owned): (bool, bool),
        salt: u64,
        keeps: impl FnOnce(&Surroundings<'_>) -> bool,
    ) -> Option<DiscShare> {
        let of_disc = |about: &Surroundings<'_>| about.disc_share(kernel, self.ray.dir, radius, salt);
        match &self.faces {
            Some(_) if is_clipped && is_owned && self.is_far(along) => {
                if self.is_whole(along, radius) {
                    return Some(DiscShare::WHOLE);
                }
                let (mut lines, mut count) = ([(DVec2::ZERO, 0.0); FACES], 0);
                for line in self.lines.iter().filter_map(|face| face.on_disc(along, radius)) {
                    lines[count] = line;
                    count += 1;
                }
                Some(DiscShare::exact(share_before(kernel, &lines[..count])))
            }
            _ => self.share((along, radius, seen), (is_clipped, is_owned), keeps, DiscShare::WHOLE, of_disc),
        }
    }

    /// What a beam is divided by that passes `seen` \[L\] from the place at a distance along the ray, both ways along `across`, a unit vector.
    pub fn line_divisor(
        &self,
        kernel: Kernel,
        (along, radius, seen): (f64, f64, f64),
        is_clipped: bool,
        across: DVec3,
        keeps: impl FnOnce(&Surroundings<'_>) -> bool,
    ) -> Option<f64> {
        let of_line = |about: &Surroundings<'_>| about.line_share(kernel, across, radius, seen);
        match &self.faces {
            Some(faces) if is_clipped && self.is_far(along) => {
                if self.is_whole(along, radius) {
                    return Some(1.0);
                }
                let up_to = |towards: DVec3| {
                    let reach = |face: &Front| {
                        let sine = -face.normal.dot(towards);
                        if sine > ALONG { face.height(self.ray.dir * along).max(0.0) / sine } else { radius }
                    };
                    0.5 * kernel.within_line(faces.iter().map(reach).fold(radius, f64::min) / radius)
                };
                let least = 0.5 * kernel.within_line(seen / radius);
                Some((up_to(across) + up_to(-across)).max(least).max(f64::MIN_POSITIVE))
            }
            _ => self.share((along, radius, seen), (is_clipped, true), keeps, 1.0, of_line),
        }
    }

    /// The share of a photon or beam that is found within a radius of the place at a distance along the ray, `seen` \[L\] away from it:
    /// `whole` where everything about it counts or nothing is clipped, else what `share` says of what stands there. None where it is not
    /// kept. `is_owned` where it is sure to be of the medium.
    fn share<T>(
        &self,
        (along, radius, seen): (f64, f64, f64),
        (is_clipped, is_owned): (bool, bool),
        keeps: impl FnOnce(&Surroundings<'_>) -> bool,
        whole: T,
        share: impl FnOnce(&Surroundings<'_>) -> T,
    ) -> Option<T> {
        if self.boundary.is_clear() && !is_clipped || is_owned && self.is_clear(along, radius) {
            return Some(whole);
        }
        let about = self.at(along, BEYOND * if is_clipped { radius } else { seen });
        if !keeps(&about) {
            return None;
        }
        let is_whole = !is_clipped || (about.is_clear(radius) && self.is_whole(along, radius));
        Some(if is_whole { whole } else { share(&about) })
    }

    /// Parts of the stretch, in order and apart, of which everything within a radius is of the medium and seen, or nothing is asked.
    pub fn clear_parts(&self, span: Interval, radius: f64, is_clipped: bool) -> Vec<Interval> {
        if self.boundary.is_clear() && !is_clipped {
            return vec![span];
        }
        let inner = match self.boundary.medium {
            Some(medium) => medium.interval_with_room(self.ray, BEYOND * radius),
            None => Some(span),
        };
        let rest = inner.and_then(|inner| inner.intersection(span));
        rest.map_or(Vec::new(), |rest| without(rest, self.bodies.iter().chain(&self.later)))
    }

    /// Parts of the stretch, in order and apart, near which there are no other bodies than flat ones; none where photons may be of another
    /// medium.
    pub fn flat_parts(&self, span: Interval) -> Option<Vec<Interval>> {
        let others = self.bodies.iter().filter(|(_, body)| rectangles_of(body).is_none()).chain(&self.later);
        self.boundary.is_only.then(|| without(span, others))
    }

    /// What parts discs in [`Beside::flat_parts`], as the ray has it; none where the medium's faces are not planes.
    pub(super) fn sheets(&self) -> Option<Sheets> {
        let is_bounded_by_planes = self.boundary.medium.is_none() || self.faces.is_some();
        let rectangles = self.flat_bodies().flat_map(|(_, rectangles)| rectangles);
        is_bounded_by_planes.then(|| Sheets::new((self.ray, &self.axes), rectangles, self.lines.clone()))
    }

    /// The rectangles of flat bodies, with the part of the line where each body may be near.
    pub fn flat_bodies(&self) -> impl Iterator<Item = (Interval, Vec<Rectangle>)> {
        self.bodies.iter().filter_map(|(part, body)| Some((*part, rectangles_of(body)?)))
    }

    /// Whether everything within a radius of the place at a distance along the ray is of the medium and seen, as far as boxes tell.
    fn is_clear(&self, along: f64, radius: f64) -> bool {
        self.is_whole(along, radius) && self.is_far(along)
    }

    /// Whether neither bodies nor other regions are near the place at a distance along the ray, as far as boxes tell.
    fn is_far(&self, along: f64) -> bool {
        let is_far = |near: &[(Interval, &Shape)]| near.iter().all(|(part, _)| !holds(part, along));
        is_far(&self.bodies) && is_far(&self.later)
    }

    /// Whether the medium's own faces are no nearer than a radius to the place at a distance along the ray.
    fn is_whole(&self, along: f64, radius: f64) -> bool {
        self.boundary.medium.is_none_or(|medium| medium.room(self.ray.at(along)) >= radius)
    }

    /// What is nearer than `reach` \[L\], at most that which all was looked for, to the place at a distance along the ray.
    fn at(&self, along: f64, reach: f64) -> Surroundings<'a> {
        let at_hand = move |near: &(Interval, &'a Shape)| holds(&near.0, along).then_some(near.1);
        let place = self.ray.at(along);
        let shapes = (self.bodies.iter().filter_map(at_hand), self.later.iter().filter_map(at_hand));
        Surroundings::among(self.boundary, shapes, (place, place), reach)
    }
}

/// What is left of a stretch without some parts, in order and apart.
fn without<'a>(mut rest: Interval, parts: impl Iterator<Item = &'a (Interval, &'a Shape)>) -> Vec<Interval> {
    let mut parts: Vec<Interval> = parts.map(|(part, _)| *part).collect();
    parts.sort_unstable_by(|a, b| a.start.total_cmp(&b.start));
    let mut left = Vec::new();
    for part in parts {
        if part.start > rest.start {
            left.push(Interval { start: rest.start, end: part.start.min(rest.end) });
        }
        rest.start = rest.start.max(part.end);
        if rest.start >= rest.end {
            return left;
        }
    }
    left.push(rest);
    left
}

/// Both ends included.
fn holds(part: &Interval, along: f64) -> bool {
    part.start <= along && along <= part.end
}

/// The part of a ray's line in which it may be nearer to a shape than `reach` \[L\]: that in a box about it, a rectangle's along its edges, with
/// room for rounding.
fn about(shape: &Shape, ray: &Ray, reach: f64) -> Option<Interval> {
    const ALL: Interval = Interval { start: 0.0, end: f64::INFINITY };
    let Some((min, max)) = shape.corners() else { return Some(ALL) };
    let room = DVec3::splat(reach) + 1e-9 * (min.abs().max(max.abs()) + ray.origin.abs());
    let inside = match shape {
        Shape::Rectangle(rectangle) => rectangle.beside(ray, room.max_element())?,
        _ => {
            // Boxes that are not finite hold everything.
            let Ok(cuboid) = Cuboid::new(min - room, max + room) else { return Some(ALL) };
            Shape::Cuboid(cuboid).interval(ray)?
        }
    };
    let margin = 1e-9 * (inside.end - inside.start);
    Some(Interval { start: inside.start - margin, end: inside.end + margin })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rectangle, Slab};
    use crate::math::warp;
    use crate::rng::{Purpose, Stream};

    /// The six faces of a cuboid as rectangles, and a sheet that stands in it.
    fn walls(min: DVec3, size: DVec3) -> Vec<Shape> {
        let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
        let face = |corner, u, v| Shape::Rectangle(Rectangle::new(corner, u, v).unwrap());
        let low = [(y, z), (z, x), (x, y)].map(|(u, v)| face(min, u, v));
        let high = [(y, z), (z, x), (x, y)].map(|(u, v)| face(min + size, -u, -v));
        [&low[..], &high, &[face(min + 0.4 * size, 0.3 * x, 0.2 * y + 0.1 * z)]].concat()
    }

    /// Between planes, with walls in them or none, and about a sheet: what is told of each place by itself.
    #[test]
    fn shares_are_those_of_each_place() {
        let mut stream = Stream::new(7, Purpose::Synthetic, 0, 0);
        let mut counts = [0; 3];
        for trial in 0..4000 {
            let (min, size) = (DVec3::from(stream.triple()) - 3.0, DVec3::from(stream.triple()) + 0.2);
            let all = walls(min, size);
            let (bodies, medium) = match trial % 4 {
                0 => (&all[..6], Shape::Cuboid(Cuboid::new(min, min + size).unwrap())),
                1 => (&all[..7], Shape::Cuboid(Cuboid::new(min, min + size).unwrap())),
                2 => (&[][..], Shape::Cuboid(Cuboid::new(min, min + size).unwrap())),
                _ => (&[][..], Shape::Slab(Slab::new(min.z, size.z).unwrap())),
            };
            let boundary = Boundary::of(&medium).unwrap().about(bodies);
            let place = min + size * DVec3::from(stream.triple());
            let dir = if trial % 3 == 0 { DVec3::Y } else { warp::square_to_sphere(stream.pair()) };
            let along = 2.0 * stream.unit();
            let ray = Ray::new(place - dir * along, dir);
            let place = ray.at(along);
            // A disc may be larger than all there is.
            let radius = if trial % 11 == 0 { 1e6 } else { 0.6 * stream.unit() + 0.01 };
            let (kernel, seen, salt) = (Kernel::ALL[trial % 5], 0.3 * radius.min(1e-3), trial as u64);
            let span = Interval { start: 0.0, end: 2.0 };
            let beside = Beside::new(&boundary, &ray, span, radius);
            let about = Surroundings::new(&boundary, place, place, BEYOND * radius);
            let is_whole = about.is_clear(radius) && medium.room(place) >= radius;
            let across = Frame::new(dir).x;
            let disc = if is_whole { DiscShare::WHOLE } else { about.disc_share(kernel, dir, radius, salt) };
            let line = if is_whole { 1.0 } else { about.line_share(kernel, across, radius, seen) };
            let at = (along, radius, seen);
            let told_of_disc = beside.disc_share(kernel, at, (true, true), salt, |_| true).unwrap();
            let told = [told_of_disc.part, beside.line_divisor(kernel, at, true, across, |_| true).unwrap()];
            counts[if beside.is_far(along) { usize::from(is_whole) } else { 2 }] += 1;
            for (told, expected) in told.into_iter().zip([disc.part, line]) {
                // What is left of 1 where lines are all but through the middle of the disc has rounding of that.
                assert!(
                    (told - expected).abs() < 1e-5 * expected + 1e-15,
                    "{trial}: {told} {expected} {boundary:?} {place} {dir}"
                );
            }
        }
        assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
    }
}
