//! Equal angles: distances on a ray chosen for a point beside it, a light or an eye.

use crate::light::Light;
use crate::math::{Interval, Ray, atan2, sin_cos};
use crate::scene::Scene;
use glam::DVec3;

/// The stretch of a ray from the first medium to the last.
pub fn span(scene: &Scene, ray: &Ray, end: f64, interior: usize) -> Option<Interval> {
    let segments = scene.segments(ray, end, interior);
    let first = segments.iter().next()?;
    let last = segments.iter().last()?;
    Some(Interval { start: first.interval.start, end: last.interval.end })
}

/// Distances along a ray such that the angle seen from a point is uniform (Kulla and Fajardo 2012).
///
/// With a the distance past the point nearest to it, b how far the ray passes from it, and a0, a1 the ends of the span,
/// the angle is that between (b, a0) and (b, a1), and a(phi) = (a0 cos phi + b sin phi) / (cos phi - a0 sin(phi)/b).
/// Divided by b, angle and density keep their digits on rays that pass the point very closely, and on those through it
/// become sampling in proportion to 1/a^2, as long as the point is not in the span.
pub struct EqualAngles {
    nearest: f64,
    distance: f64,
    /// Where the span starts, past the nearest point \[L\].
    start: f64,
    /// Angle that the span fills, over the distance [1/L]; none where there is none: on a ray through the point itself, if
    /// that is in the span, and so far away that the span shrinks to nothing.
    angle: Option<f64>,
    span: Interval,
}

/// Rays that pass a point more closely \[L\] count as through it: below, squares vanish.
const THROUGH: f64 = 1e-150;

impl EqualAngles {
    /// Those seen from `point` on a stretch of the ray.
    pub fn new(ray: &Ray, point: DVec3, span: Interval) -> Self {
        let nearest = (point - ray.origin).dot(ray.dir);
        let passes = point.distance(ray.at(nearest));
        let distance = if passes < THROUGH { 0.0 } else { passes };
        let (start, end) = (span.start - nearest, span.end - nearest);
        let angle = match (distance > 0.0, end.is_infinite()) {
            (true, false) => atan2(distance * (end - start), distance * distance + start * end) / distance,
            (true, true) => atan2(distance, start) / distance,
            (false, _) if start <= 0.0 && end >= 0.0 => f64::NAN,
            (false, false) => (end - start) / (start * end),
            (false, true) => 1.0 / start,
        };
        let angle = (angle > 0.0 && angle.is_finite()).then_some(angle);
        EqualAngles { nearest, distance, start, angle, span }
    }

    /// A distance \[L\], from a number in [0, 1).
    pub fn sample(&self, u: f64) -> Option<f64> {
        let part = u * self.angle?;
        let (sin, cos) = sin_cos(part * self.distance);
        let sin_over_distance = if self.distance > 0.0 { sin / self.distance } else { part };
        let past = (self.start * cos + self.distance * sin) / (cos - self.start * sin_over_distance);
        let t = self.nearest + past;
        t.is_finite().then(|| t.clamp(self.span.start, self.span.end))
    }

    /// Density of [`Self::sample`] [1/L].
    pub fn pdf(&self, t: f64) -> f64 {
        let Some(angle) = self.angle.filter(|_| (self.span.start..=self.span.end).contains(&t)) else {
            return 0.0;
        };
        let past = t - self.nearest;
        1.0 / (angle * (self.distance * self.distance + past * past))
    }
}

/// Distances on a ray chosen for a light: by equal angles about the point that it comes from, on the part that a spot shines on, or
/// evenly where a beam crosses the ray.
pub enum Distances {
    /// About a point.
    EqualAngles(EqualAngles),
    /// Even on this part.
    Even(Interval),
}

impl Distances {
    /// Those for a light on a stretch of the ray; none for other lights, where a spot does not shine on it, and where a beam does
    /// not cross it or never leaves it.
    pub fn of(light: &Light, ray: &Ray, span: Interval) -> Option<Self> {
        let span = match light {
            Light::Spot(spot) => spot.lit(ray)?.intersection(span)?,
            _ => span,
        };
        if let Some(apex) = light.apex() {
            return Some(Distances::EqualAngles(EqualAngles::new(ray, apex, span)));
        }
        let Light::Beam(beam) = light else { return None };
        let part = beam.interval(ray)?.intersection(span)?;
        part.length().is_finite().then_some(Distances::Even(part))
    }

    /// A distance \[L\], from a number in [0, 1).
    pub fn sample(&self, u: f64) -> Option<f64> {
        match self {
            Distances::EqualAngles(angles) => angles.sample(u),
            Distances::Even(part) => Some((part.start + u * part.length()).min(part.end)),
        }
    }

    /// Density of [`Self::sample`] [1/L].
    pub fn pdf(&self, t: f64) -> f64 {
        match self {
            Distances::EqualAngles(angles) => angles.pdf(t),
            Distances::Even(part) if (part.start..=part.end).contains(&t) => 1.0 / part.length(),
            Distances::Even(_) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passing(distance: f64, span: (f64, f64)) -> EqualAngles {
        let ray = Ray::new(DVec3::new(distance, 0.0, 0.0), DVec3::Z);
        EqualAngles::new(&ray, DVec3::ZERO, Interval { start: span.0, end: span.1 })
    }

    /// The density is the inverse slope of the samples, and the distribution function between them, whatever the distance:
    /// closely past the point, through it, and far from it; the span behind, before and about the point.
    #[test]
    fn samples_have_their_density() {
        for distance in [0.0, 1e-300, 1e-140, 1e-20, 1e-12, 1e-6, 1e-2, 1.0, 1e3, 1e9] {
            for span in [(1e-3, 2.0), (1.0, 3.0), (5.0, 5.1)] {
                let angles = passing(distance, span);
                let cdf = |t: f64| match distance < 1e-8 {
                    true => (1.0 / span.0 - 1.0 / t) / (1.0 / span.0 - 1.0 / span.1),
                    false => {
                        let angle = |t: f64| atan2(distance * (t - span.0), distance * distance + span.0 * t);
                        angle(t) / angle(span.1)
                    }
                };
                assert_eq!([span.0 - 1e-9, span.1 + 1e-9].map(|t| angles.pdf(t)), [0.0; 2]);
                for i in 0..100 {
                    let u = (f64::from(i) + 0.5) / 100.0;
                    let t = angles.sample(u).unwrap();
                    assert!((cdf(t) - u).abs() < 1e-9, "{distance} {span:?} {u}: {t}, {}", cdf(t));
                    let h = 1e-4;
                    let (a, b) = (angles.sample(u - h).unwrap(), angles.sample(u + h).unwrap());
                    // To the second order of h, and rounding of t over the step.
                    let slope = 2.0 * h / (b - a);
                    let promise = 1e-3 + 1e-14 * span.1 / (b - a);
                    assert!((angles.pdf(t) / slope - 1.0).abs() < promise, "{distance} {span:?} {u}");
                }
            }
        }
    }

    /// A span about the nearest point: tangents, as in the paper.
    #[test]
    fn about_the_point_it_is_the_tangent() {
        let ray = Ray::new(DVec3::new(0.3, 0.0, -0.7), DVec3::Z);
        let angles = EqualAngles::new(&ray, DVec3::ZERO, Interval { start: 0.0, end: 2.0 });
        let (low, high) = (atan2(-0.7, 0.3), atan2(1.3, 0.3));
        for i in 0..=100 {
            let u = f64::from(i) / 101.0;
            let expected = 0.7 + 0.3 * libm::tan(low + u * (high - low));
            assert!((angles.sample(u).unwrap() - expected).abs() < 1e-14);
        }
        let endless = EqualAngles::new(&ray, DVec3::ZERO, Interval { start: 0.0, end: f64::INFINITY });
        let (low, high) = (atan2(-0.7, 0.3), std::f64::consts::FRAC_PI_2);
        let expected = 0.7 + 0.3 * libm::tan(low + 0.9 * (high - low));
        assert!((endless.sample(0.9).unwrap() / expected - 1.0).abs() < 1e-13);
    }

    /// A ray through a point in its span: no way to choose in proportion to what has no integral.
    #[test]
    fn through_the_point_itself_there_is_none() {
        for span in [(0.0, 1.0), (-0.0, f64::INFINITY)] {
            let angles = passing(0.0, span);
            assert_eq!((angles.sample(0.5), angles.pdf(0.5)), (None, 0.0));
        }
    }
}
