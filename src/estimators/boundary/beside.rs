//! What comes near a stretch of a ray: looked for once, and asked at every place of it.

use super::Boundary;
use super::visible::Surroundings;
use crate::geometry::{Cuboid, Shape};
use crate::math::{Interval, Ray};
use glam::DVec3;

/// Bodies are looked for a little beyond a radius, so that rounding leaves none out.
const BEYOND: f64 = 1.001;

/// The bodies and regions that come within a distance of a stretch of a ray, each with the part of the line where it may.
pub(in crate::estimators) struct Beside<'a> {
    boundary: &'a Boundary<'a>,
    ray: &'a Ray,
    bodies: Vec<(Interval, &'a Shape)>,
    later: Vec<(Interval, &'a Shape)>,
}

impl<'a> Beside<'a> {
    /// What is nearer to the stretch than a radius \[L\].
    pub fn new(boundary: &'a Boundary<'_>, ray: &'a Ray, span: Interval, radius: f64) -> Self {
        let reach = BEYOND * radius;
        let near = |shape: &'a Shape| Some((about(shape, ray, reach)?.intersection(span)?, shape));
        let bodies = boundary.bodies.iter().filter_map(near).collect();
        let later = boundary.later.iter().filter_map(near).collect();
        Beside { boundary, ray, bodies, later }
    }

    /// What a photon or beam is divided by that is found within a radius of the place at a distance along the ray, `seen` \[L\] away from it:
    /// 1 where everything about it counts or nothing is clipped, else what `share` says of what stands there. None where it is not
    /// kept. `is_owned` where it is sure to be of the medium.
    pub fn divisor(
        &self,
        (along, radius, seen): (f64, f64, f64),
        (is_clipped, is_owned): (bool, bool),
        keeps: impl FnOnce(&Surroundings<'_>) -> bool,
        share: impl FnOnce(&Surroundings<'_>) -> f64,
    ) -> Option<f64> {
        if self.boundary.is_clear() && !is_clipped || is_owned && self.is_clear(along, radius) {
            return Some(1.0);
        }
        let about = self.at(along, BEYOND * if is_clipped { radius } else { seen });
        if !keeps(&about) {
            return None;
        }
        let is_whole = !is_clipped || (about.is_clear(radius) && self.is_whole(along, radius));
        Some(if is_whole { 1.0 } else { share(&about) })
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
        let Some(mut rest) = inner.and_then(|inner| inner.intersection(span)) else { return Vec::new() };
        let mut near: Vec<Interval> = self.bodies.iter().chain(&self.later).map(|(part, _)| *part).collect();
        near.sort_unstable_by(|a, b| a.start.total_cmp(&b.start));
        let mut parts = Vec::new();
        for part in near {
            if part.start > rest.start {
                parts.push(Interval { start: rest.start, end: part.start.min(rest.end) });
            }
            rest.start = rest.start.max(part.end);
            if rest.start >= rest.end {
                return parts;
            }
        }
        parts.push(rest);
        parts
    }

    /// Whether everything within a radius of the place at a distance along the ray is of the medium and seen, as far as boxes tell.
    fn is_clear(&self, along: f64, radius: f64) -> bool {
        let is_far = |near: &[(Interval, &Shape)]| near.iter().all(|(part, _)| !holds(part, along));
        self.is_whole(along, radius) && is_far(&self.bodies) && is_far(&self.later)
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

/// Both ends included.
fn holds(part: &Interval, along: f64) -> bool {
    part.start <= along && along <= part.end
}

/// The part of a ray's line in which it may be nearer to a shape than `reach` \[L\]: that in a box about it, with room for rounding.
fn about(shape: &Shape, ray: &Ray, reach: f64) -> Option<Interval> {
    const ALL: Interval = Interval { start: 0.0, end: f64::INFINITY };
    let Some((min, max)) = shape.corners() else { return Some(ALL) };
    let room = DVec3::splat(reach) + 1e-9 * (min.abs().max(max.abs()) + ray.origin.abs());
    // Boxes that are not finite hold everything.
    let Ok(cuboid) = Cuboid::new(min - room, max + room) else { return Some(ALL) };
    let inside = Shape::Cuboid(cuboid).interval(ray)?;
    let margin = 1e-9 * (inside.end - inside.start);
    Some(Interval { start: inside.start - margin, end: inside.end + margin })
}
