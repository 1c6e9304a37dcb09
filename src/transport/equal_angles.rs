//! Equal angles: distances on a ray chosen for a point beside it, a light or an eye.

use crate::math::{Interval, Ray, atan2};
use crate::scene::Scene;
use glam::DVec3;

/// The stretch of a ray from the first medium to the last.
pub fn span(scene: &Scene, ray: &Ray, end: f64, within: usize) -> Option<Interval> {
    let segments = scene.segments(ray, end, within);
    let first = segments.iter().next()?;
    let last = segments.iter().last()?;
    Some(Interval { start: first.interval.start, end: last.interval.end })
}

/// Distances along a ray such that the angle seen from a point is uniform (Kulla and Fajardo 2012).
pub struct EqualAngles {
    nearest: f64,
    distance: f64,
    angle: (f64, f64),
    span: Interval,
}

impl EqualAngles {
    /// Those seen from `point` on a stretch of the ray.
    pub fn new(ray: &Ray, point: DVec3, span: Interval) -> Self {
        let nearest = (point - ray.origin).dot(ray.dir);
        let distance = point.distance(ray.at(nearest));
        let angle = |t: f64| atan2(t - nearest, distance);
        EqualAngles { nearest, distance, angle: (angle(span.start), angle(span.end)), span }
    }

    /// The angle that the span fills, or none where the angle is no coordinate: on a ray through the point itself, and
    /// so far away that the span shrinks to nothing.
    fn range(&self) -> Option<f64> {
        let range = self.angle.1 - self.angle.0;
        (self.distance > 0.0 && range > 0.0).then_some(range)
    }

    /// A distance \[L\], from a number in [0, 1).
    pub fn sample(&self, u: f64) -> Option<f64> {
        let range = self.range()?;
        let t = self.nearest + self.distance * libm::tan(self.angle.0 + u * range);
        t.is_finite().then(|| t.clamp(self.span.start, self.span.end))
    }

    /// Density of [`Self::sample`] [1/L].
    pub fn pdf(&self, t: f64) -> f64 {
        let Some(range) = self.range() else { return 0.0 };
        let along = t - self.nearest;
        self.distance / (range * (self.distance * self.distance + along * along))
    }
}
