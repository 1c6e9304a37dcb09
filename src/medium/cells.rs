//! Bounds of a density by cell, and the cells that a ray passes.

use crate::math::{Interval, Ray};
use glam::DVec3;

/// Time of a tentative collision (a logarithm and a look-up between eight samples) in that of a step from cell to cell:
/// measured in the uneven fog of `cargo bench --bench fogbox`.
const LOOK_UP: f64 = 3.0;

/// A stretch of a ray on which a density is bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Where it is on the ray \[L\].
    pub interval: Interval,
    /// The density is nowhere below this \[1\].
    pub low: f64,
    /// The density is nowhere above this \[1\].
    pub high: f64,
}

/// A box of equal cells along the axes, with the bounds of a density in each.
///
/// Cells at the faces of the box reach on beyond it without end, so that a density that is clamped outside its box is
/// bounded everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    min: DVec3,
    /// Edges of a cell \[L\].
    edge: DVec3,
    count: [usize; 3],
    /// Low and high, x fastest.
    bounds: Vec<(f64, f64)>,
}

impl Cells {
    /// `count` cells an axis, at least one each, over the box from `min` to `max`; `bounds` is asked for each by its
    /// index.
    pub fn new(
        min: DVec3,
        max: DVec3,
        count: [usize; 3],
        mut bounds: impl FnMut([usize; 3]) -> (f64, f64),
    ) -> Self {
        let edge = (max - min) / DVec3::from_array(count.map(|n| n as f64));
        let mut all = Vec::with_capacity(count.iter().product());
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    all.push(bounds([x, y, z]));
                }
            }
        }
        Cells { min, edge, count, bounds: all }
    }

    /// Cells an axis.
    pub fn count(&self) -> [usize; 3] {
        self.count
    }

    /// What tracking costs, in steps from cell to cell a length [1/L], where light meets tentative collisions `sigma_t`
    /// times the upper bound: mean over cells and over directions, which have a mean cosine of 1/2 to every axis.
    pub fn work(&self, sigma_t: f64) -> f64 {
        let planes =
            |axis: usize| (self.count[axis] - 1) as f64 / (self.edge[axis] * self.count[axis] as f64);
        let steps = 0.5 * (planes(0) + planes(1) + planes(2));
        let bound = self.bounds.iter().map(|bound| bound.1).sum::<f64>() / self.bounds.len() as f64;
        steps + LOOK_UP * sigma_t * bound
    }

    /// The largest bound of all.
    pub fn high(&self) -> f64 {
        self.bounds.iter().fold(0.0, |high, bound| high.max(bound.1))
    }

    /// The largest bound in a box.
    pub fn high_in(&self, min: DVec3, max: DVec3) -> f64 {
        let index = |p: DVec3, axis: usize| {
            let place = (p[axis] - self.min[axis]) / self.edge[axis];
            (place.max(0.0) as usize).min(self.count[axis] - 1)
        };
        // Rounding may put a point of the box beside its cell.
        let margin = 1e-6 * self.edge;
        let range = |axis: usize| index(min - margin, axis)..=index(max + margin, axis);
        let [nx, ny, _] = self.count;
        let mut high = 0.0f64;
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    high = high.max(self.bounds[(z * ny + y) * nx + x].1);
                }
            }
        }
        high
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// The cells on a part of a ray, nearest first.
    pub fn along(&self, ray: &Ray, part: Interval) -> Along<'_> {
        let start = ray.at(part.start);
        let (mut index, mut next, mut step) = ([0usize; 3], [f64::INFINITY; 3], [0.0f64; 3]);
        for axis in 0..3 {
            if self.count[axis] == 1 {
                continue;
            }
            let place = (start[axis] - self.min[axis]) / self.edge[axis];
            index[axis] = (place.max(0.0) as usize).min(self.count[axis] - 1);
            let slope = ray.dir[axis];
            if slope != 0.0 {
                step[axis] = self.edge[axis] / slope.abs();
                // The plane ahead, one of those between cells.
                let ahead = index[axis] + usize::from(slope > 0.0);
                if 0 < ahead && ahead < self.count[axis] {
                    let plane = self.min[axis] + self.edge[axis] * ahead as f64;
                    next[axis] = (plane - ray.origin[axis]) / slope;
                }
            }
        }
        Along { cells: self, dir: ray.dir, index, next, step, at: part.start, end: part.end }
    }
}

/// The cells that a ray passes.
#[derive(Debug, Clone)]
pub struct Along<'a> {
    cells: &'a Cells,
    dir: DVec3,
    index: [usize; 3],
    /// Distance to the next plane between cells, by axis \[L\]; infinite where there is none.
    next: [f64; 3],
    /// Distance between planes \[L\].
    step: [f64; 3],
    at: f64,
    end: f64,
}

impl Iterator for Along<'_> {
    type Item = Bound;

    #[inline]
    fn next(&mut self) -> Option<Bound> {
        loop {
            if self.at >= self.end {
                return None;
            }
            let [nx, ny, _] = self.cells.count;
            let [x, y, z] = self.index;
            let (low, high) = self.cells.bounds[(z * ny + y) * nx + x];
            let axis = match self.next {
                [x, y, z] if x <= y && x <= z => 0,
                [_, y, z] if y <= z => 1,
                _ => 2,
            };
            let interval = Interval { start: self.at, end: self.next[axis].min(self.end) };
            if self.next[axis] < self.end {
                let is_up = self.dir[axis] > 0.0;
                if is_up {
                    self.index[axis] += 1;
                } else {
                    self.index[axis] -= 1;
                }
                let ahead = self.index[axis] + usize::from(is_up);
                let is_between = 0 < ahead && ahead < self.cells.count[axis];
                self.next[axis] = if is_between { self.next[axis] + self.step[axis] } else { f64::INFINITY };
                self.at = self.at.max(interval.end);
            } else {
                self.at = self.end;
            }
            if interval.end > interval.start {
                return Some(Bound { interval, low, high });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every stretch lies in the cell whose bounds it carries, and together they are the whole part.
    #[test]
    fn stretches_lie_in_their_cells() {
        let count = [3, 1, 4];
        let number = |[x, y, z]: [usize; 3]| ((z * count[1] + y) * count[0] + x) as f64;
        let (min, max) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(2.0, 0.5, 4.0));
        let cells = Cells::new(min, max, count, |index| (0.0, number(index)));
        let mut stream = crate::rng::Stream::new(1, crate::rng::Purpose::Synthetic, 0, 0);
        for case in 0..2000 {
            let mut point = || DVec3::from_array(stream.triple()) * 6.0 - DVec3::new(2.5, 2.5, 0.0);
            let (origin, target) = (point(), point());
            // Every third ray runs along an axis, some of those on a plane between cells.
            let (origin, dir) = match case % 3 {
                0 => (origin.with_x(0.0), DVec3::AXES[case % 9 / 3] * if case % 2 == 0 { 1.0 } else { -1.0 }),
                _ => (origin, (target - origin).normalize()),
            };
            let ray = Ray::new(origin, dir);
            let part = Interval { start: 0.25, end: if case % 5 == 0 { f64::INFINITY } else { 3.0 } };
            let mut at = part.start;
            for bound in cells.along(&ray, part) {
                assert_eq!(bound.interval.start, at);
                at = bound.interval.end;
                let middle = 0.5 * (bound.interval.start + at.min(bound.interval.start + 1e3));
                let place = (ray.at(middle) - min) / (max - min);
                let index = |axis: usize| {
                    let place = place[axis] * count[axis] as f64;
                    (place.max(0.0) as usize).min(count[axis] - 1)
                };
                let near = (place * DVec3::from_array(count.map(|n| n as f64)) + 1e-9).fract().abs();
                if near.min_element() > 1e-8 || bound.interval.length() > 1e-8 && case % 3 != 0 {
                    assert_eq!(bound.high, number([index(0), index(1), index(2)]), "{ray:?} {bound:?}");
                }
            }
            assert_eq!(at, part.end);
        }
    }
}
