//! Where a beam is within a distance of a ray, or of a place.

use crate::math::{Interval, Ray};
use glam::DVec3;

/// The part of a beam that is near enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// From where \[L\], along the beam from its start.
    pub start: f64,
    /// To where \[L\].
    pub end: f64,
    /// Where the beam's line is nearest \[L\]; it may lie beyond both.
    pub nearest: f64,
    /// Whether it is the first part of its beam that is told.
    pub is_first: bool,
}

/// Squared sines below this are those of parallel lines, rounded.
const PARALLEL: f64 = 1e-30;

impl Chord {
    /// Of a line, where it is at most `radius` \[L\] from a ray, with its feet on it in `span`.
    pub(super) fn near_ray(
        ray: &Ray,
        span: Interval,
        radius: f64,
        (start, dir): (DVec3, DVec3),
    ) -> Option<Self> {
        let (way, cosine) = (start - ray.origin, ray.dir.dot(dir));
        let foot = way.dot(ray.dir);
        let (away, across) = (way - ray.dir * foot, dir - ray.dir * cosine);
        let sine2 = across.length_squared();
        let mut chord = if sine2 > PARALLEL {
            let nearest = -away.dot(across) / sine2;
            let squared = (away + across * nearest).length_squared();
            Chord::about(nearest, radius * radius - squared, sine2)?
        } else if away.length_squared() <= radius * radius {
            Chord { start: f64::NEG_INFINITY, end: f64::INFINITY, nearest: 0.0, is_first: true }
        } else {
            return None;
        };
        if cosine == 0.0 {
            return (span.start <= foot && foot < span.end).then_some(chord);
        }
        let ends = [span.start, span.end].map(|s| (s - foot) / cosine);
        chord.start = chord.start.max(ends[0].min(ends[1]));
        chord.end = chord.end.min(ends[0].max(ends[1]));
        (chord.start < chord.end).then_some(chord)
    }

    /// Of a line, where it is at most `radius` \[L\] from a place.
    pub(super) fn near_place(place: DVec3, radius: f64, (start, dir): (DVec3, DVec3)) -> Option<Self> {
        let way = place - start;
        let nearest = way.dot(dir);
        Chord::about(nearest, radius * radius - (way - dir * nearest).length_squared(), 1.0)
    }

    /// Of a line whose squared distance from what it is near to grows by `slope` times that along it from where it is nearest, and may
    /// grow by `left` \[L^2\].
    fn about(nearest: f64, left: f64, slope: f64) -> Option<Self> {
        let half = (left / slope).sqrt();
        (half > 0.0).then_some(Chord { start: nearest - half, end: nearest + half, nearest, is_first: true })
    }

    /// What of it lies on a piece of a beam of a length.
    pub(super) fn on(self, (from, to): (f64, f64), length: f64) -> Option<Self> {
        let first = self.start.max(0.0);
        let part = Chord {
            start: first.max(from),
            end: self.end.min(to).min(length),
            is_first: from <= first && first < to,
            ..self
        };
        (part.start < part.end).then_some(part)
    }
}
