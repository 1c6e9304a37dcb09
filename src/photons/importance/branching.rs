//! A walk whose photons are turned, split or ended by what they are worth.

use super::grid::DIRECTIONS;
use super::values::Importance;
use crate::math::{FOUR_PI, cosine_pair, warp};
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::Scene;
use crate::transport::{Roulette, Step, Visitor, Walker, walk, window};
use glam::DVec3;

/// How often a direction is chosen by value: weights grow by 1/(1 - this) at most.
const TURNED: f64 = 0.5;
/// A visitor of a walk that may branch.
pub trait Branching: Visitor {
    /// A photon is about to fly on from an event, whose number is what [`Self::left`] gave for it; none for a photon from
    /// a light. Called before its steps.
    fn enter(&mut self, _event: Option<u32>) {}

    /// A photon leaves an event, before it is split: the event's number.
    fn left(&mut self, _walker: &Walker) -> u32 {
        0
    }
}

/// What a photon left.
#[derive(Clone, Copy)]
enum Left {
    /// A medium of this number, after coming along this direction.
    Medium(usize, DVec3),
    /// A diffuse surface with this normal, on the photon's side.
    Diffuse(DVec3),
}

/// Passes on one flight and keeps the photon that leaves the event at its end.
struct Flight<'a, V> {
    visitor: &'a mut V,
    order: u32,
    event: Option<Left>,
    next: Option<Walker>,
}

impl<V: Visitor> Visitor for Flight<'_, V> {
    const LOOKS_AHEAD: bool = V::LOOKS_AHEAD;

    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        match step {
            Step::Ahead(_) if walker.order > self.order => return,
            Step::Truncated(_) if walker.order > self.order => {
                self.next = Some(*walker);
                return;
            }
            Step::Collision(_, number) => self.event = Some(Left::Medium(number, walker.ray.dir)),
            Step::Surface(_, found) => {
                let outward = found.hit.normal;
                let is_outside = walker.ray.dir.dot(outward) < 0.0;
                self.event = Some(Left::Diffuse(if is_outside { outward } else { -outward }));
            }
            _ => {}
        }
        self.visitor.visit(walker, step, stream);
    }
}

/// Density with which an event sends photons along a direction [1/sr].
fn density(scene: &Scene, event: Left, dir: DVec3) -> f64 {
    match event {
        Left::Medium(number, before) => {
            let (one_minus_mu, one_plus_mu) = cosine_pair(before, dir);
            scene.medium(number).phase().eval(one_minus_mu, one_plus_mu)
        }
        Left::Diffuse(normal) => warp::pdf_cosine_hemisphere(dir.dot(normal)),
    }
}

impl Importance {
    /// Follows one photon history to its end, split and ended by importance; `limit` as for [`walk`].
    pub(in crate::photons) fn walk<V: Branching>(
        &self,
        scene: &Scene,
        start: Walker,
        limit: Option<u32>,
        stream: &mut Stream,
        visitor: &mut V,
    ) {
        let mut waiting = vec![(start, None)];
        while let Some((walker, event)) = waiting.pop() {
            if limit.is_some_and(|limit| walker.order >= limit) {
                visitor.visit(&walker, Step::Truncated(walker.weight), stream);
                continue;
            }
            visitor.enter(event);
            let mut flight = Flight { visitor, order: walker.order, event: None, next: None };
            walk(scene, walker, Roulette::Analog, Some(walker.order + 1), stream, &mut flight);
            let Flight { event, next, .. } = flight;
            let (Some(next), Some(event)) = (next, event) else { continue };
            let Some(next) = self.turned(scene, event, next, stream) else { continue };
            let number = Some(visitor.left(&next));
            let (copies, factor) = self.copies(&next, stream);
            let next = Walker { weight: next.weight * factor, ..next };
            waiting.extend(std::iter::repeat_n((next, number), copies));
        }
    }

    /// The photon with its direction chosen anew by value, now and then; its weight is that of both ways to choose it
    /// together. None where nothing goes the chosen way.
    fn turned(&self, scene: &Scene, event: Left, walker: Walker, stream: &mut Stream) -> Option<Walker> {
        let origin = walker.ray.origin;
        let (values, directions) = (self.values_at(origin), self.aim.directions(origin));
        // What each sends on, about: its value times the density in its middle and a little, so that cells with their
        // middle below a surface's horizon are not lost.
        let mut sums = [0.0; DIRECTIONS];
        let mut sum = 0.0;
        for (index, cumulated) in sums.iter_mut().enumerate() {
            if let Some((middle, size)) = directions.middle(index) {
                sum += values[index] * size * (density(scene, event, middle) + 0.1 / FOUR_PI);
            }
            *cumulated = sum;
        }
        // Nothing that left an event was ever read, as far as the pilot saw: no direction is better than another.
        if sum == 0.0 {
            return Some(walker);
        }
        let probability = |index: usize| (sums[index] - if index > 0 { sums[index - 1] } else { 0.0 }) / sum;
        let mut dir = walker.ray.dir;
        if stream.unit() < TURNED {
            let target = stream.unit() * sum;
            let index = sums.partition_point(|cumulated| *cumulated <= target).min(DIRECTIONS - 1);
            dir = directions.sample(index, stream.pair());
        }
        let natural = density(scene, event, dir);
        let both = (1.0 - TURNED) * natural + TURNED * directions.density(dir, probability);
        let ray = crate::math::Ray::new(origin, dir);
        (natural > 0.0).then(|| Walker { ray, weight: walker.weight * (natural / both), ..walker })
    }

    /// How many photons go on, and the factor on the weight of each.
    fn copies(&self, walker: &Walker, stream: &mut Stream) -> (usize, f64) {
        let Walker { ray, .. } = walker;
        let value = self.values_at(ray.origin)[self.aim.directions(ray.origin).index(ray.dir)];
        window(walker.weight.sum() * value / self.response, || stream.unit())
    }
}
