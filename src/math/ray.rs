//! Rays and intervals along them.

use glam::DVec3;

/// A half-line: origin \[L\] and unit direction of travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts \[L\].
    pub origin: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
}

impl Ray {
    /// The ray from `origin` along the unit vector `dir`.
    pub fn new(origin: DVec3, dir: DVec3) -> Self {
        Ray { origin, dir }
    }

    /// The point at distance `t` \[L\].
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.dir * t
    }
}

/// A stretch of a ray, from `start` to `end` \[L\]; `end` may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Nearer end \[L\].
    pub start: f64,
    /// Farther end \[L\].
    pub end: f64,
}

impl Interval {
    /// Where `at_0 + slope t` is at least 0; may be empty, with its ends swapped.
    pub fn of_positive(at_0: f64, slope: f64) -> Self {
        let (start, end) = (f64::NEG_INFINITY, f64::INFINITY);
        let root = -at_0 / slope;
        match slope {
            s if s > 0.0 => Interval { start: root, end },
            s if s < 0.0 => Interval { start, end: root },
            _ if at_0 >= 0.0 => Interval { start, end },
            _ => Interval { start: end, end: start },
        }
    }

    /// Where `at_0 + slope t` is between two values, if that has a length.
    pub fn of_between(at_0: f64, slope: f64, [low, high]: [f64; 2]) -> Option<Self> {
        Self::of_positive(at_0 - low, slope).intersection(Self::of_positive(high - at_0, -slope))
    }

    /// Length \[L\]; zero if the ends are swapped.
    pub fn length(&self) -> f64 {
        (self.end - self.start).max(0.0)
    }

    /// The integral of t^2 over it [L^3]: the volume of a cone of directions over their solid angle.
    pub fn squared_distances(&self) -> f64 {
        let (a, b) = (self.start, self.end);
        self.length() * (a * a + a * b + b * b) / 3.0
    }

    /// The common part of two intervals, if it has a length.
    pub fn intersection(self, other: Interval) -> Option<Interval> {
        let start = self.start.max(other.start);
        let end = self.end.min(other.end);
        (end > start).then_some(Interval { start, end })
    }
}
