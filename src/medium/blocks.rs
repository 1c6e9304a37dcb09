//! Values that are constant in blocks: voxels, layers along an axis, columns.

use super::{Bound, Grid};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::DVec3;

/// The most blocks: a gigabyte of them.
const MOST: usize = 1 << 27;

/// Blocks between planes across each axis, one or three values each; outside, the value of the nearest block.
///
/// The bounds of a density of blocks are its values: tracking meets no tentative collision that is none, and transmittance is
/// the exponential of a sum.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks {
    /// Rising, one more than there are blocks along the axis \[L\].
    planes: [Vec<f64>; 3],
    channels: usize,
    /// Channel fastest, then x, y, z.
    values: Vec<f64>,
    /// Of columns, which fill only a part of z: from where to where \[L\], x fastest; of others empty.
    spans: Vec<(f64, f64)>,
    high: f64,
}

/// Planes between `count` equal blocks.
fn even(min: f64, max: f64, count: usize) -> Vec<f64> {
    let plane = |i: usize| min + (max - min) * (i as f64 / count as f64);
    (0..count).map(plane).chain([max]).collect()
}

impl Blocks {
    /// Blocks between planes.
    ///
    /// # Arguments
    /// `planes` across x, y and z \[L\], one more than blocks; `channels` 1 or 3; `values` with the channel fastest, then x, y
    /// and z
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange` for planes that do not rise, or are beyond 1e100; values that are too few, too many,
    /// negative or not finite; another number of channels
    pub fn new(planes: [Vec<f64>; 3], channels: usize, values: Vec<f64>) -> Result<Self> {
        for (axis, planes) in planes.iter().enumerate() {
            let name = ["x", "y", "z"][axis];
            if planes.len() < 2 {
                let what = format!("planes of blocks across {name}");
                return Err(Error::out_of_range(what, planes.len() as f64, "2 or more"));
            }
            if let Some(bad) = planes.iter().find(|p| p.abs().total_cmp(&1e100).is_gt()) {
                let what = format!("a plane of blocks across {name}");
                return Err(Error::out_of_range(what, *bad, "up to 1e100 in size"));
            }
            if let Some(at) = planes.windows(2).position(|two| two[0] >= two[1]) {
                return Err(Error::Scene(format!(
                    "planes of blocks across {name} do not rise: {} comes after {}; allowed: each above the one before",
                    planes[at + 1],
                    planes[at]
                )));
            }
        }
        if channels != 1 && channels != 3 {
            return Err(Error::out_of_range("channels of blocks", channels as f64, "1 or 3"));
        }
        let [x, y, z] = [0, 1, 2].map(|axis: usize| planes[axis].len() - 1);
        let expected = [y, z].iter().try_fold(channels * x, |product, n| product.checked_mul(*n));
        if expected != Some(values.len()) {
            return Err(Error::Scene(format!(
                "{x} x {y} x {z} blocks with {channels} channels have {} values; allowed: {}",
                values.len(),
                expected.map_or("fewer blocks".into(), |n| n.to_string())
            )));
        }
        if let Some(at) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            let block = at / channels;
            let name = format!("value of block {} {} {}", block % x, block / x % y, block / (x * y));
            return Err(Error::out_of_range(name, values[at], "finite and at least 0"));
        }
        let high = values.iter().fold(0.0, |high: f64, value| high.max(*value));
        Ok(Blocks { planes, channels, values, spans: Vec::new(), high })
    }

    /// Equal blocks of a box.
    ///
    /// # Errors
    /// As [`Blocks::new`]; for none along an axis, and for more than 2^27
    pub fn uniform(
        (min, max): (DVec3, DVec3),
        count: [usize; 3],
        channels: usize,
        values: Vec<f64>,
    ) -> Result<Self> {
        let all = count.iter().try_fold(1usize, |product, n| product.checked_mul(*n));
        if all.is_none_or(|n| !(1..=MOST).contains(&n)) {
            let [x, y, z] = count;
            return Err(Error::Scene(format!("{x} x {y} x {z} blocks; allowed: 1 to {MOST} in all")));
        }
        let planes = [0, 1, 2].map(|axis: usize| even(min[axis], max[axis], count[axis]));
        Blocks::new(planes, channels, values)
    }

    /// The samples of a grid, each the value of its whole cell.
    ///
    /// # Errors
    /// As [`Blocks::uniform`], and for more memory than is free
    pub fn of_grid(grid: &Grid) -> Result<Self> {
        let values = grid.values();
        crate::memory::check(|| format!("{} blocks", values.len()), 8.0 * values.len() as f64)?;
        let values = values.iter().map(|v| f64::from(*v)).collect();
        Blocks::uniform(grid.corners(), grid.count(), grid.channels(), values)
    }

    /// Layers between planes across one axis, 0 to 2.
    ///
    /// # Errors
    /// As [`Blocks::new`]
    pub fn layers(axis: usize, edges: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        let mut planes = [0, 1, 2].map(|_| vec![0.0, 1.0]);
        planes[axis] = edges;
        Blocks::new(planes, 1, values)
    }

    /// Columns along z: each has its value between two z of its own, and 0 elsewhere.
    ///
    /// # Arguments
    /// `x` and `y` planes between columns \[L\]; `values` and `spans`, from and to \[L\], with x fastest
    /// # Errors
    /// As [`Blocks::new`], and for spans that are too few, too many, not finite, or end before they begin
    pub fn columns(x: Vec<f64>, y: Vec<f64>, values: Vec<f64>, spans: Vec<(f64, f64)>) -> Result<Self> {
        if spans.len() != values.len() {
            return Err(Error::Scene(format!("{} columns with {} heights", values.len(), spans.len())));
        }
        if let Some(at) = spans.iter().position(|(a, b)| !(a <= b && a.abs().max(b.abs()) <= 1e100)) {
            let (from, to) = spans[at];
            return Err(Error::Scene(format!(
                "column {at} goes from z = {from} to {to}; allowed: rising, up to 1e100 in size"
            )));
        }
        Ok(Blocks { spans, ..Blocks::new([x, y, vec![0.0, 1.0]], 1, values)? })
    }

    /// Planes between blocks across an axis, 0 to 2 \[L\].
    pub fn planes(&self, axis: usize) -> &[f64] {
        &self.planes[axis]
    }

    /// Blocks along each axis.
    pub fn count(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis: usize| self.planes[axis].len() - 1)
    }

    /// Values a block.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The largest value.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        self.planes[0].len() == 2 && self.planes[1].len() == 2
    }

    /// Whether blocks are columns of their own heights.
    pub fn is_columns(&self) -> bool {
        !self.spans.is_empty()
    }

    /// The corners of the box of all blocks.
    pub fn corners(&self) -> (DVec3, DVec3) {
        let end = |axis: usize| self.planes[axis][self.planes[axis].len() - 1];
        (
            DVec3::new(self.planes[0][0], self.planes[1][0], self.planes[2][0]),
            DVec3::new(end(0), end(1), end(2)),
        )
    }

    /// Moves its last plane across an axis by a rounding.
    pub(super) fn end_at(&mut self, axis: usize, end: f64) {
        if let Some(last) = self.planes[axis].last_mut() {
            *last = end;
        }
    }

    /// The block along one axis; beyond the outer planes the outermost.
    fn index(&self, axis: usize, x: f64) -> usize {
        let planes = &self.planes[axis];
        planes[1..planes.len() - 1].partition_point(|plane| *plane <= x)
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.count();
        (z * ny + y) * nx + x
    }

    /// The block of a point; none outside of a column's span.
    fn block(&self, p: DVec3) -> Option<usize> {
        let number = self.number([0, 1, 2].map(|axis: usize| self.index(axis, p[axis])));
        match self.spans.get(number) {
            Some((from, to)) if !(*from..=*to).contains(&p.z) => None,
            _ => Some(number),
        }
    }

    /// The value at a point; the first channel of several.
    pub fn at(&self, p: DVec3) -> f64 {
        self.block(p).map_or(0.0, |block| self.values[self.channels * block])
    }

    /// The value at a point by channel; equal where there is only one.
    pub fn color_at(&self, p: DVec3) -> Spectrum {
        let Some(first) = self.block(p).map(|block| self.channels * block) else { return Spectrum::ZERO };
        let value = |channel: usize| self.values[first + if self.channels == 1 { 0 } else { channel }];
        Spectrum::rgb(value(0), value(1), value(2))
    }

    /// The largest value in a box.
    pub fn high_in(&self, min: DVec3, max: DVec3) -> f64 {
        // Rounding may put a point of the box beside its block.
        let margin = |axis: usize| 1e-6 * (self.corners().1[axis] - self.corners().0[axis]);
        let range = |axis: usize| {
            let margin = margin(axis) / self.count()[axis] as f64;
            self.index(axis, min[axis] - margin)..=self.index(axis, max[axis] + margin)
        };
        let mut high = 0.0f64;
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let number = self.number([x, y, z]);
                    let is_met = self.spans.get(number).is_none_or(|(from, to)| {
                        let margin = 1e-6 * (to - from);
                        from - margin <= max.z && min.z <= to + margin
                    });
                    if is_met {
                        let first = self.channels * number;
                        high = self.values[first..first + self.channels].iter().fold(high, |a, b| a.max(*b));
                    }
                }
            }
        }
        high
    }

    /// The blocks on a part of a ray, nearest first; all channels share their bounds.
    pub fn along(&self, ray: &Ray, part: Interval) -> Through<'_> {
        let start = ray.at(part.start);
        let index = [0, 1, 2].map(|axis: usize| self.index(axis, start[axis]));
        let mut through = Through {
            blocks: self,
            ray: *ray,
            index,
            next: [f64::INFINITY; 3],
            at: part.start,
            end: part.end,
        };
        (0..3).for_each(|axis| through.look_ahead(axis));
        through
    }
}

/// The blocks that a ray passes.
#[derive(Debug, Clone)]
pub struct Through<'a> {
    blocks: &'a Blocks,
    ray: Ray,
    index: [usize; 3],
    /// Distance to the next plane between blocks, by axis \[L\]; infinite where there is none.
    next: [f64; 3],
    at: f64,
    end: f64,
}

impl Through<'_> {
    /// Finds the next plane across an axis: each by itself, so that roundings do not add up.
    fn look_ahead(&mut self, axis: usize) {
        let (planes, slope) = (&self.blocks.planes[axis], self.ray.dir[axis]);
        let ahead = self.index[axis] + usize::from(slope > 0.0);
        let is_between = slope != 0.0 && 0 < ahead && ahead + 1 < planes.len();
        self.next[axis] =
            if is_between { (planes[ahead] - self.ray.origin[axis]) / slope } else { f64::INFINITY };
    }

    /// Where the ray next enters or leaves a span of z, and whether it is inside until then.
    fn span(&self, (from, to): (f64, f64)) -> (f64, bool) {
        let (z, slope) = (self.ray.origin.z, self.ray.dir.z);
        if slope == 0.0 {
            return (f64::INFINITY, (from..=to).contains(&z));
        }
        let (a, b) = ((from - z) / slope, (to - z) / slope);
        let (enters, leaves) = (a.min(b), a.max(b));
        if self.at < enters {
            (enters, false)
        } else if self.at < leaves {
            (leaves, true)
        } else {
            (f64::INFINITY, false)
        }
    }
}

impl Iterator for Through<'_> {
    type Item = Bound;

    fn next(&mut self) -> Option<Bound> {
        loop {
            if self.at >= self.end {
                return None;
            }
            let number = self.blocks.number(self.index);
            let axis = match self.next {
                [x, y, z] if x <= y && x <= z => 0,
                [_, y, z] if y <= z => 1,
                _ => 2,
            };
            let (turn, is_inside) =
                self.blocks.spans.get(number).map_or((f64::INFINITY, true), |span| self.span(*span));
            let start = self.at;
            let end = self.next[axis].min(turn).min(self.end);
            if turn < self.next[axis] && turn < self.end {
                self.at = self.at.max(turn);
            } else if self.next[axis] < self.end {
                if self.ray.dir[axis] > 0.0 {
                    self.index[axis] += 1;
                } else {
                    self.index[axis] -= 1;
                }
                self.at = self.at.max(end);
                self.look_ahead(axis);
            } else {
                self.at = self.end;
            }
            if end > start {
                let first = self.blocks.channels * number;
                let values = &self.blocks.values[first..first + self.blocks.channels];
                let (low, high) = match values {
                    _ if !is_inside => (0.0, 0.0),
                    [one] => (*one, *one),
                    more => more
                        .iter()
                        .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(*v), high.max(*v))),
                };
                return Some(Bound { interval: Interval { start, end }, low, high });
            }
        }
    }
}
