//! What a ray meets: the nearest body, and what lets light through on the way.

use super::{SURROUNDINGS, Scene, SceneHit, Start, Target};
use crate::Spectrum;
use crate::geometry::Hit;
use crate::math::Ray;
use crate::surface::Surface;

/// Bodies that a ray may pass without getting on. Where more seem to lie, surfaces coincide but for rounding, and each is behind
/// the other without end: there nothing is let through.
const IN_ONE_PLACE: u32 = 64;

impl Scene {
    /// The nearest body ahead; `origin_surface` is the one that the ray starts on.
    pub fn hit(&self, ray: &Ray, origin_surface: Option<Start>) -> Option<SceneHit> {
        let start = origin_surface.and_then(|start| self.bodies.in_list(start.target));
        let mut nearest = self
            .bodies
            .rectangles
            .nearest(ray, start)
            .map(|(index, hit)| SceneHit { target: self.bodies.targets[index], hit });
        for &target in &self.bodies.others {
            if let Some(hit) = self.try_body(ray, origin_surface, target)
                && nearest.is_none_or(|n| hit.t < n.hit.t || hit.t == n.hit.t && target < n.target)
            {
                nearest = Some(SceneHit { target, hit });
            }
        }
        nearest
    }

    /// Where a ray meets one body.
    fn try_body(&self, ray: &Ray, origin_surface: Option<Start>, target: Target) -> Option<Hit> {
        let start = Start::on(origin_surface, target);
        match target {
            Target::Object(i) => self.objects()[i].shape.hit(ray, start),
            Target::Light(i) => self.lights()[i].hit(ray, start),
        }
    }

    /// What filters let pass between the ray's origin and distance `end` \[1\], not counting the body at the far end;
    /// none if another body stands in the way, but for index-matched boundaries, or nothing passes. Media are not asked.
    pub fn passes(
        &self,
        ray: &Ray,
        origin_surface: Option<Start>,
        end: f64,
        towards: Target,
    ) -> Option<Spectrum> {
        let is_hidden = match towards {
            Target::Light(index) => self.lights()[index].hides_itself(ray, end),
            // As of lights: what is nearer by more than a millionth stands in the way, which rounding is far below.
            Target::Object(index) => {
                let start = Start::on(origin_surface, towards);
                self.objects()[index].shape.blocks(ray, start, end * (1.0 - 1e-6))
            }
        };
        if is_hidden {
            return None;
        }
        self.let_through(ray, origin_surface, end, Some(towards))
    }

    /// The same where no body is at the far end, but an eye.
    pub fn sees(&self, ray: &Ray, origin_surface: Option<Start>, end: f64) -> Option<Spectrum> {
        self.let_through(ray, origin_surface, end, None)
    }

    fn let_through(
        &self,
        ray: &Ray,
        origin_surface: Option<Start>,
        end: f64,
        towards: Option<Target>,
    ) -> Option<Spectrum> {
        if self.plan().has_filters || self.plan().has_matched {
            return self.passes_straight(ray, origin_surface, end, towards);
        }
        let bodies = &self.bodies;
        let except = [
            origin_surface.and_then(|start| bodies.in_list(start.target)),
            towards.and_then(|t| bodies.in_list(t)),
        ];
        if bodies.rectangles.block(ray, except, end) {
            return None;
        }
        let mut others = bodies.others.iter().filter(|target| Some(**target) != towards);
        let is_blocked = others.any(|&target| match target {
            Target::Object(i) => self.objects()[i].shape.blocks(ray, Start::on(origin_surface, target), end),
            Target::Light(_) => self.try_body(ray, origin_surface, target).is_some_and(|hit| hit.t < end),
        });
        (!is_blocked).then_some(Spectrum::ONE)
    }

    /// What goes straight on behind a body that a ray meets in the interior `within`, and the interior there: through a
    /// filter, and through an index-matched boundary. None behind any other body.
    pub fn straight_on(&self, ray: &Ray, found: &SceneHit, interior: usize) -> Option<(Spectrum, usize)> {
        let Target::Object(index) = found.target else { return None };
        match &self.objects()[index].surface {
            Surface::Filter(filter) => {
                Some((filter.transmittance(ray.at(found.hit.t), found.hit.uv), interior))
            }
            Surface::Dielectric(boundary) if boundary.is_matched() => {
                Some((Spectrum::ONE, boundary.sides(ray.dir, found.hit.normal).1))
            }
            _ => None,
        }
    }

    /// The same, body after body.
    fn passes_straight(
        &self,
        ray: &Ray,
        origin_surface: Option<Start>,
        end: f64,
        towards: Option<Target>,
    ) -> Option<Spectrum> {
        let (mut ray, mut origin_surface, mut end, mut transmitted) =
            (*ray, origin_surface, end, Spectrum::ONE);
        let mut here = 0;
        while let Some(found) = self.hit(&ray, origin_surface) {
            if Some(found.target) == towards || found.hit.t >= end {
                break;
            }
            // Which interior it is, filters need not know.
            transmitted *= self.straight_on(&ray, &found, SURROUNDINGS)?.0;
            if transmitted.is_black() {
                return None;
            }
            let position = ray.at(found.hit.t);
            here = if position == ray.origin { here + 1 } else { 0 };
            if here > IN_ONE_PLACE {
                return None;
            }
            (ray, origin_surface, end) =
                (Ray::new(position, ray.dir), Some(found.start()), end - found.hit.t);
        }
        Some(transmitted)
    }
}
