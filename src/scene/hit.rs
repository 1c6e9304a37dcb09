//! What a ray meets: the nearest body, and what lets light through on the way.

use super::Scene;
use crate::Spectrum;
use crate::geometry::Hit;
use crate::math::Ray;

/// A body that a ray can meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The object of this index.
    Object(usize),
    /// The light of this index.
    Light(usize),
}

/// Where a ray starts, if it starts on a body: what it must not meet again at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Start {
    /// Which body.
    pub target: Target,
    /// Which part of its shape; 0 of a shape without parts.
    pub primitive: u32,
}

impl Start {
    /// The part that a ray starts on, if it starts on this body.
    fn on(start: Option<Start>, target: Target) -> Option<u32> {
        start.filter(|s| s.target == target).map(|s| s.primitive)
    }
}

/// The nearest body on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneHit {
    /// Which body.
    pub target: Target,
    /// Where, and its normal.
    pub hit: Hit,
}

impl SceneHit {
    /// Rays from here start on this body.
    pub fn start(&self) -> Start {
        Start { target: self.target, primitive: self.hit.primitive }
    }
}

impl Scene {
    /// The nearest body ahead; `from` is the body that the ray starts on.
    pub fn hit(&self, ray: &Ray, from: Option<Start>) -> Option<SceneHit> {
        let mut nearest: Option<SceneHit> = None;
        let mut consider = |target, hit: Option<Hit>| {
            if let Some(hit) = hit
                && nearest.is_none_or(|n| hit.t < n.hit.t)
            {
                nearest = Some(SceneHit { target, hit });
            }
        };
        for (i, object) in self.objects().iter().enumerate() {
            let target = Target::Object(i);
            consider(target, object.shape.hit(ray, Start::on(from, target)));
        }
        for (i, light) in self.lights().iter().enumerate() {
            let target = Target::Light(i);
            consider(target, light.hit(ray, Start::on(from, target)));
        }
        nearest
    }

    /// What bodies let pass between the ray's origin and distance `end` \[1\], not counting the body at the far end;
    /// none if one of them stands in the way. Media are not asked.
    pub fn passes(&self, ray: &Ray, from: Option<Start>, end: f64, towards: Target) -> Option<Spectrum> {
        match self.hit(ray, from) {
            None => Some(Spectrum::ONE),
            Some(found) => (found.target == towards || found.hit.t >= end).then_some(Spectrum::ONE),
        }
    }
}
