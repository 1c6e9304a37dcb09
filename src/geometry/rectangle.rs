//! A flat rectangle.

use super::{Front, Hit};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// Planes nearer than this part of the size and place of what lies in them are one: rounding is far below, and a gap that
/// anybody means far above.
const SAME: f64 = 1e-9;

/// The points `corner + a u + b v` for a, b in [0, 1]; the edges u and v are perpendicular, the front is u x v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
    normal: DVec3,
}

impl Rectangle {
    /// A rectangle from a corner and two perpendicular edges \[L\].
    pub fn new(corner: DVec3, u: DVec3, v: DVec3) -> Result<Self> {
        let (lu, lv) = (u.length(), v.length());
        if !(lu > 0.0 && lv > 0.0 && (lu * lv).is_finite() && corner.is_finite()) {
            return Err(Error::Scene("a rectangle needs a finite corner and two edges longer than 0".into()));
        }
        // Rounding of the given numbers may tilt the edges by a few units in the last place, no more.
        if u.dot(v).abs() > 1e-12 * lu * lv {
            return Err(Error::Scene(format!(
                "the edges of a rectangle are perpendicular; these have cosine {:.3e}",
                u.dot(v) / (lu * lv)
            )));
        }
        Ok(Rectangle { corner, u, v, normal: u.cross(v).normalize() })
    }

    /// The front's unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    pub(super) fn hit(&self, ray: &Ray, from_here: bool) -> Option<Hit> {
        let denominator = ray.dir.dot(self.normal);
        if from_here || denominator == 0.0 {
            return None;
        }
        let t = (self.corner - ray.origin).dot(self.normal) / denominator;
        if t.is_nan() || t <= 0.0 {
            return None;
        }
        self.covers(ray.at(t)).then(|| self.hit_at(ray, t))
    }

    /// Whether the rectangle stands between two points; in its plane neither of them is behind it.
    pub(super) fn is_between(&self, from: DVec3, to: DVec3) -> bool {
        let (start, end) = (self.height(from), self.height(to));
        let crosses = (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0);
        crosses && self.covers(from + (to - from) * (start / (start - end)))
    }

    /// The hit of a ray that meets the rectangle at this distance \[L\].
    pub(super) fn hit_at(&self, ray: &Ray, t: f64) -> Hit {
        Hit { t, normal: self.normal, shading: self.normal, uv: self.coordinates(ray.at(t)), primitive: 0 }
    }

    /// The distance at which a ray meets the rectangle, or `end` where that is nearer \[L\].
    pub(super) fn until(&self, ray: &Ray, end: f64) -> f64 {
        let t = -self.height(ray.origin) / ray.dir.dot(self.normal);
        if t > 0.0 && t < end && self.covers(ray.at(t)) { t } else { end }
    }

    /// Distance from a point, or `limit` where that is farther \[L\].
    pub(super) fn distance(&self, p: DVec3, limit: f64) -> f64 {
        let height = self.height(p).abs();
        let beyond = |edge: DVec3| {
            let (x, squared) = ((p - self.corner).dot(edge), edge.length_squared());
            let beyond = (-x).max(x - squared);
            beyond > 0.0 && beyond * beyond > limit * limit * squared
        };
        if height >= limit || beyond(self.u) || beyond(self.v) {
            return limit;
        }
        libm::hypot(height, self.inside(p).min(0.0)).min(limit)
    }

    pub(super) fn front(&self, p: DVec3) -> Option<Front> {
        let height = self.height(p);
        (height != 0.0).then(|| Front { normal: self.normal * height.signum(), distance: height.abs() })
    }

    /// Whether the rectangle covers all that its plane cuts of a ball.
    pub(super) fn parts_ball(&self, p: DVec3, radius: f64) -> bool {
        let height = self.height(p).abs();
        // Roots first: squares of small lengths vanish. Not a number where the ball does not reach the plane.
        let across = (radius - height).sqrt() * (radius + height).sqrt();
        self.inside(p) >= across
    }

    pub(crate) fn corner(&self) -> DVec3 {
        self.corner
    }

    pub(crate) fn u(&self) -> DVec3 {
        self.u
    }

    pub(crate) fn v(&self) -> DVec3 {
        self.v
    }

    /// Whether a point lies above or below the rectangle, seen along its normal; the edges count.
    pub fn covers(&self, p: DVec3) -> bool {
        let p = p - self.corner;
        let (a, b) = (p.dot(self.u), p.dot(self.v));
        (0.0..=self.u.length_squared()).contains(&a) && (0.0..=self.v.length_squared()).contains(&b)
    }

    /// The part of a ray in front of the rectangle, straight above it.
    pub(crate) fn above(&self, ray: &Ray) -> Option<Interval> {
        let from = ray.origin - self.corner;
        let between = |edge: DVec3| {
            Interval::of_between(from.dot(edge), ray.dir.dot(edge), [0.0, edge.length_squared()])
        };
        let in_front = Interval::of_positive(from.dot(self.normal), ray.dir.dot(self.normal));
        let ahead = Interval { start: 0.0, end: f64::INFINITY };
        between(self.u)?.intersection(between(self.v)?)?.intersection(in_front)?.intersection(ahead)
    }

    /// The part of a ray, and what is behind its origin, in the box that reaches so far \[L\] beyond the rectangle to all sides.
    pub(crate) fn beside(&self, ray: &Ray, reach: f64) -> Option<Interval> {
        let from = ray.origin - self.corner;
        let between = |axis: DVec3, length: f64| {
            Interval::of_between(from.dot(axis), ray.dir.dot(axis), [-reach, length + reach])
        };
        let along = |edge: DVec3| between(edge.normalize(), edge.length());
        along(self.u)?.intersection(along(self.v)?)?.intersection(between(self.normal, 0.0)?)
    }

    /// Where a point lies along the edges, each of length 1, seen along the normal.
    fn coordinates(&self, p: DVec3) -> DVec2 {
        let p = p - self.corner;
        DVec2::new(p.dot(self.u) / self.u.length_squared(), p.dot(self.v) / self.v.length_squared())
    }

    /// Where the edges lie seen from a point, along u and v \[L\]: those through the corner, and those opposite.
    pub fn bounds_about(&self, p: DVec3) -> (DVec2, DVec2) {
        let (lu, lv) = (self.u.length(), self.v.length());
        let low = DVec2::new((self.corner - p).dot(self.u) / lu, (self.corner - p).dot(self.v) / lv);
        (low, low + DVec2::new(lu, lv))
    }

    /// Its corners, in turn.
    pub fn corners(&self) -> [DVec3; 4] {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|u| self.sample(u))
    }

    /// Whether it lies in one plane with another, up to a billionth of their sizes and places, and shares an area with it.
    pub fn overlaps(&self, other: &Rectangle) -> bool {
        // The larger one's normal is known best.
        let (large, small) = if self.area() >= other.area() { (self, other) } else { (other, self) };
        let far = large.corner.abs().max_element() + large.diagonal();
        let least = SAME * far;
        // Most are in other planes.
        if large.height(small.corner).abs() > least {
            return false;
        }
        let (mine, others) = (self.corners(), other.corners());
        if small.corners().iter().any(|p| large.height(*p).abs() > least) {
            return false;
        }
        let along = |corners: &[DVec3; 4], axis: DVec3| {
            let at = corners.map(|p| p.dot(axis));
            at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
        };
        // Apart if a line along a side of either parts them.
        [self.u, self.v, other.u, other.v].iter().all(|edge| {
            let axis = edge.normalize();
            let ((low, high), (other_low, other_high)) = (along(&mine, axis), along(&others, axis));
            high.min(other_high) - low.max(other_low) > least
        })
    }

    /// Length of the diagonal \[L\].
    pub fn diagonal(&self) -> f64 {
        (self.u + self.v).length()
    }

    /// How far a point lies inside the rectangle's edges, seen along its normal; outside, minus the distance \[L\].
    pub fn inside(&self, p: DVec3) -> f64 {
        let p = p - self.corner;
        let within = |edge: DVec3| {
            let (length, x) = (edge.length(), p.dot(edge) / edge.length());
            x.min(length - x)
        };
        let (a, b) = (within(self.u), within(self.v));
        if a >= 0.0 && b >= 0.0 { a.min(b) } else { -libm::hypot(a.min(0.0), b.min(0.0)) }
    }

    /// Signed distance of a point from the plane, positive in front \[L\].
    pub fn height(&self, p: DVec3) -> f64 {
        (p - self.corner).dot(self.normal)
    }

    /// Area [L^2] of one side.
    pub fn area(&self) -> f64 {
        self.u.length() * self.v.length()
    }

    /// A uniform point.
    pub fn sample(&self, [a, b]: [f64; 2]) -> DVec3 {
        self.corner + self.u * a + self.v * b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Rectangle {
        Rectangle::new(corner.into(), u.into(), v.into()).unwrap()
    }

    #[test]
    fn rectangles_share_an_area_or_do_not() {
        let one = rectangle([0.0, 0.0, 0.3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let share = |corner, u, v| {
            let other = rectangle(corner, u, v);
            assert_eq!(one.overlaps(&other), other.overlaps(&one));
            one.overlaps(&other)
        };
        let (x, y, diagonal) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]);
        assert!(share([0.0, 0.0, 0.3], x, y) && share([0.5, -0.9, 0.3], y, x));
        // Along an edge, at a corner, beside it, above it, across it.
        assert!(!share([1.0, 0.0, 0.3], x, y) && !share([1.0, 1.0, 0.3], x, y));
        assert!(!share([3.0, 0.0, 0.3], x, y) && !share([0.0, 0.0, 0.3 + 1e-7], x, y));
        assert!(!share([0.5, 0.2, 0.0], [0.0, 0.0, 1.0], y));
        // Turned, with its corner inside, and with boxes that overlap though the rectangles do not.
        assert!(share([0.9, 0.9, 0.3], diagonal, [-0.5, 0.5, 0.0]));
        assert!(!share([1.1, 0.85, 0.3], diagonal, [-0.1, 0.1, 0.0]));
    }
}
