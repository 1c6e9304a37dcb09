//! Values on a regular grid, trilinear in between.

use super::{Along, Cells};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray};
use glam::DVec3;

/// The most cells of bounds along an axis.
const MOST_CELLS: usize = 32;
/// Samples along the edge of a cell of bounds, where there are few: one step to the next cell costs as much as some
/// samples that a closer bound saves.
const SAMPLES_A_CELL: usize = 4;

/// Samples in the middles of equal cells of a box along the axes, one or three channels each; between the middles
/// trilinear, outside them that of the nearest point between.
///
/// So a constant grid is constant to its faces and beyond; this is how Mitsuba reads its `.vol` files.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    min: DVec3,
    max: DVec3,
    count: [usize; 3],
    channels: usize,
    /// Channel fastest, then x, y, z.
    values: Vec<f32>,
    /// Samples a length, by axis [1/L].
    scale: DVec3,
    cells: Cells,
}

impl Grid {
    /// A grid over the box from `min` to `max`.
    ///
    /// # Arguments
    /// `count` samples an axis; `channels` 1 or 3; `values` with the channel fastest, then x, y and z, each 0 or more
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange` for no samples, another number of channels, values that are too few, too
    /// many, negative or not finite, and boxes without inside
    pub fn new(
        (min, max): (DVec3, DVec3),
        count: [usize; 3],
        channels: usize,
        values: Vec<f32>,
    ) -> Result<Self> {
        // Farther out squares of lengths are no numbers.
        let is_near = min.abs().max(max.abs()).cmple(DVec3::splat(1e100)).all();
        if !(is_near && (max - min).cmpge(DVec3::splat(1e-100)).all()) {
            return Err(Error::Scene(format!(
                "a grid's box goes from {min} to {max}; allowed: up to 1e100 in size, and at least 1e-100 long along each axis"
            )));
        }
        if let Some(bad) = count.iter().find(|n| **n == 0) {
            return Err(Error::out_of_range("samples of a grid along an axis", *bad as f64, "1 or more"));
        }
        if channels != 1 && channels != 3 {
            return Err(Error::out_of_range("channels of a grid", channels as f64, "1 or 3"));
        }
        let expected = count.iter().try_fold(channels, |product, n| product.checked_mul(*n));
        if expected != Some(values.len()) {
            return Err(Error::Scene(format!(
                "a grid of {} x {} x {} samples with {channels} channels has {} values",
                count[0],
                count[1],
                count[2],
                values.len()
            )));
        }
        if let Some(at) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            let sample = at / channels;
            let (x, y, z) = (sample % count[0], sample / count[0] % count[1], sample / (count[0] * count[1]));
            let value = f64::from(values[at]);
            let name = format!("value of a grid at sample {x} {y} {z}");
            return Err(Error::out_of_range(name, value, "finite and at least 0"));
        }
        let scale = DVec3::from_array(count.map(|n| n as f64)) / (max - min);
        let finest = count.map(|n| (n / SAMPLES_A_CELL).clamp(1, MOST_CELLS));
        let cells = bounds((min, max), count, channels, &values, finest);
        Ok(Grid { min, max, count, channels, values, scale, cells })
    }

    /// A grid of one channel whose samples are a function of their position.
    ///
    /// # Errors
    /// As [`Grid::new`]
    pub fn sampled(corners: (DVec3, DVec3), count: [usize; 3], f: impl Fn(DVec3) -> f64) -> Result<Self> {
        let step = (corners.1 - corners.0) / DVec3::from_array(count.map(|n| n as f64));
        let mut values = Vec::with_capacity(count.iter().product());
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let middle = DVec3::new(x as f64, y as f64, z as f64) + 0.5;
                    values.push(f(corners.0 + middle * step) as f32);
                }
            }
        }
        Grid::new(corners, count, 1, values)
    }

    /// The same grid with its bounds in cells that suit light which collides `sigma_t` times a length where the value is 1:
    /// in thick matter close bounds save look-ups, in thin matter wide cells save steps.
    pub fn bounded_for(mut self, sigma_t: f64) -> Self {
        loop {
            let coarser = self.cells.count().map(|n| n.div_ceil(2));
            if coarser == self.cells.count() {
                return self;
            }
            let cells = bounds((self.min, self.max), self.count, self.channels, &self.values, coarser);
            if cells.work(sigma_t) >= self.cells.work(sigma_t) {
                return self;
            }
            self.cells = cells;
        }
    }

    /// The corners of its box.
    pub fn corners(&self) -> (DVec3, DVec3) {
        (self.min, self.max)
    }

    /// The same samples over another box, times `factor`.
    ///
    /// # Errors
    /// As [`Grid::new`]
    pub fn placed(&self, corners: (DVec3, DVec3), factor: f64) -> Result<Self> {
        let values = self.values.iter().map(|v| (f64::from(*v) * factor) as f32).collect();
        Grid::new(corners, self.count, self.channels, values)
    }

    /// The same samples over another box, with one more on either side along some of x and y, taken from the other side.
    ///
    /// # Errors
    /// As [`Grid::new`]
    pub(super) fn wrapped(&self, (mut min, mut max): (DVec3, DVec3), around: [bool; 2]) -> Result<Self> {
        let [nx, ny, nz] = self.count;
        let more = [0, 1].map(|axis: usize| usize::from(around[axis]));
        for (axis, more) in more.iter().enumerate() {
            let step = (max[axis] - min[axis]) / self.count[axis] as f64;
            min[axis] -= step * *more as f64;
            max[axis] += step * *more as f64;
        }
        let count = [nx + 2 * more[0], ny + 2 * more[1], nz];
        let mut values = Vec::with_capacity(count.iter().product::<usize>() * self.channels);
        for z in 0..nz {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let (x, y) = ((x + nx - more[0]) % nx, (y + ny - more[1]) % ny);
                    let first = self.channels * ((z * ny + y) * nx + x);
                    values.extend(&self.values[first..first + self.channels]);
                }
            }
        }
        Grid::new((min, max), count, self.channels, values)
    }

    /// Samples an axis.
    pub fn count(&self) -> [usize; 3] {
        self.count
    }

    /// Numbers a sample.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The samples: channel fastest, then x, y, z.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        self.count[0] == 1 && self.count[1] == 1
    }

    /// The largest value.
    pub fn high(&self) -> f64 {
        self.cells.high()
    }

    /// The eight samples about a point: index of the first, how far to step along each axis, and the point's place
    /// between them.
    #[inline]
    fn about(&self, p: DVec3) -> (usize, [usize; 3], [f64; 3]) {
        let middle = if planted(Fault::GridHalfCellOff) { 0.0 } else { 0.5 };
        let (mut first, mut step, mut part) = ([0usize; 3], [0usize; 3], [0.0; 3]);
        let strides =
            [self.channels, self.channels * self.count[0], self.channels * self.count[0] * self.count[1]];
        for axis in 0..3 {
            let last = self.count[axis] - 1;
            let place = ((p[axis] - self.min[axis]) * self.scale[axis] - middle).clamp(0.0, last as f64);
            let below = (place as usize).min(last.saturating_sub(1));
            first[axis] = below * strides[axis];
            step[axis] = if last > 0 { strides[axis] } else { 0 };
            part[axis] = place - below as f64;
        }
        (first[0] + first[1] + first[2], step, part)
    }

    #[inline]
    fn mix(&self, channel: usize, (first, step, part): (usize, [usize; 3], [f64; 3])) -> f64 {
        let at = |offset: usize| f64::from(self.values[first + channel + offset]);
        // Differences times parts keep a constant constant, to the last bit.
        let line = |from: usize| {
            let (a, b) = (at(from), at(from + step[0]));
            a + (b - a) * part[0]
        };
        let face = |from: usize| {
            let (a, b) = (line(from), line(from + step[1]));
            a + (b - a) * part[1]
        };
        let (a, b) = (face(0), face(step[2]));
        a + (b - a) * part[2]
    }

    /// The value at a point; the first channel of several.
    #[inline]
    pub fn at(&self, p: DVec3) -> f64 {
        self.mix(0, self.about(p))
    }

    /// The value at a point by channel; equal where the grid has only one.
    pub fn color_at(&self, p: DVec3) -> Spectrum {
        let about = self.about(p);
        if self.channels == 1 {
            Spectrum::grey(self.mix(0, about))
        } else {
            Spectrum::rgb(self.mix(0, about), self.mix(1, about), self.mix(2, about))
        }
    }

    /// Bounds of the value along a part of a ray.
    #[inline]
    pub fn along(&self, ray: &Ray, part: Interval) -> Along<'_> {
        self.cells.along(ray, part)
    }

    /// Where a part of a ray passes from between some samples to between others, nearest first \[L\].
    pub fn kinks(&self, ray: &Ray, part: Interval) -> Vec<f64> {
        let mut all = Vec::new();
        for axis in 0..3 {
            for i in 0..self.count[axis] {
                let plane = self.min[axis] + (i as f64 + 0.5) / self.scale[axis];
                let t = (plane - ray.origin[axis]) / ray.dir[axis];
                if part.start < t && t < part.end {
                    all.push(t);
                }
            }
        }
        all.sort_by(f64::total_cmp);
        all
    }

    /// The cells of its bounds.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }
}

/// Bounds by cell: a trilinear value lies between those of the samples about it. All channels share them.
fn bounds(
    (min, max): (DVec3, DVec3),
    count: [usize; 3],
    channels: usize,
    values: &[f32],
    cells: [usize; 3],
) -> Cells {
    Cells::new(min, max, cells, |index| {
        // Samples whose middles lie in the cell, and one more on either side: a cell's face may pass between the
        // two.
        let range = |axis: usize| {
            let (n, parts) = (count[axis], cells[axis]);
            let first = (index[axis] * n / parts).saturating_sub(1);
            let last = ((index[axis] + 1) * n).div_ceil(parts).min(n - 1);
            first..=last
        };
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let first = channels * ((z * count[1] + y) * count[0] + x);
                    for value in &values[first..first + channels] {
                        (low, high) = (low.min(f64::from(*value)), high.max(f64::from(*value)));
                    }
                }
            }
        }
        (low, high)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thin matter has one cell, thick matter the finest, and the bounds hold in any.
    #[test]
    fn cells_suit_the_extinction() {
        let corners = (DVec3::ZERO, DVec3::ONE);
        let grid =
            |sigma_t: f64| Grid::sampled(corners, [32; 3], |p| p.x * p.y).unwrap().bounded_for(sigma_t);
        assert_eq!([0.0, 1e-3, 10.0, 1e6].map(|s| grid(s).cells().count()), [[1; 3], [1; 3], [4; 3], [8; 3]]);
        let ray = Ray::new(DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.6, 0.64, 0.48));
        for sigma_t in [1e-3, 10.0, 1e6] {
            let grid = grid(sigma_t);
            for bound in grid.along(&ray, Interval { start: 0.0, end: 1.0 }) {
                for part in [0.01, 0.3, 0.7, 0.99] {
                    let value = grid.at(ray.at(bound.interval.start + part * bound.interval.length()));
                    assert!((bound.low..=bound.high).contains(&value), "{sigma_t} {bound:?} {value}");
                }
            }
        }
    }
}
