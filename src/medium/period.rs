//! Periods of a world that repeats itself in x and y.
//!
//! The world has the periods of the cell that photons are wrapped into; a density may have a whole part of them as its own.
//! Positions are folded, and a ray goes from period to period, moved back in each: the bounds of one period hold in all.

use super::{Blocks, Cloud, Grid};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A box may differ from a whole part of the cell by this part of itself, single precision in its file; it is made to fit.
const FIT: f64 = 1e-6;

/// Where a period begins, and its length, along x and y; none where nothing varies \[L\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Period([Option<(f64, f64)>; 2]);

fn refuse<T>(text: String) -> Result<T> {
    Err(Error::Scene(text))
}

impl Period {
    /// That of what varies along some of x and y within a box: the cell must hold a whole number of boxes.
    fn of(what: &str, (min, max): (DVec3, DVec3), varies: [bool; 2], cell: DVec2) -> Result<Self> {
        let mut period = [None; 2];
        for axis in (0..2).filter(|axis| varies[*axis]) {
            let width = max[axis] - min[axis];
            let boxes = (cell[axis] / width).round().max(1.0);
            let side = cell[axis] / boxes;
            if (width - side).abs() > FIT * side {
                return refuse(format!(
                    "{what} is {width} wide along {}; allowed: the side of the cell there, {}, or a whole part of it",
                    ["x", "y"][axis],
                    cell[axis]
                ));
            }
            period[axis] = Some((min[axis], side));
        }
        Ok(Period(period))
    }

    /// The point in the first period that a point stands for.
    pub fn fold(&self, mut p: DVec3) -> DVec3 {
        for (axis, period) in self.0.iter().enumerate() {
            if let Some((low, side)) = period {
                p[axis] -= side * ((p[axis] - low) / side).floor();
            }
        }
        p
    }

    /// That of a cloud: the whole cell about it.
    pub(super) fn about_cloud(cloud: &Cloud, cell: DVec2) -> Result<Self> {
        let (center, reach) = (cloud.shape().center, cloud.reach());
        if let Some(axis) = (0..2).find(|axis| 2.0 * reach[*axis] > cell[*axis]) {
            return refuse(format!(
                "a cloud is {} wide along {}, with its shreds; allowed: up to the side of the cell there, {}",
                2.0 * reach[axis],
                ["x", "y"][axis],
                cell[axis]
            ));
        }
        let along = |axis: usize| Some((center[axis] - 0.5 * cell[axis], cell[axis]));
        Ok(Period([along(0), along(1)]))
    }

    /// A box of the first period that a box stands for: all of the period where it goes across the seam.
    pub(super) fn fold_box(&self, mut min: DVec3, mut max: DVec3) -> (DVec3, DVec3) {
        for (axis, period) in self.0.iter().enumerate() {
            let Some((low, side)) = *period else { continue };
            let shift = side * ((min[axis] - low) / side).floor();
            let (a, b) = (min[axis] - shift, max[axis] - shift);
            (min[axis], max[axis]) = if b <= low + side { (a, b) } else { (low, low + side) };
        }
        (min, max)
    }

    /// All of the first period between two z, either one the lower.
    pub(super) fn whole(&self, a: f64, b: f64) -> (DVec3, DVec3) {
        let [x, y] = self.0.map(|period| period.map_or((0.0, 0.0), |(low, side)| (low, low + side)));
        (DVec3::new(x.0, y.0, a.min(b)), DVec3::new(x.1, y.1, a.max(b)))
    }

    /// Whether a cell holds a whole number of these periods.
    pub(super) fn fits(&self, cell: DVec2) -> bool {
        self.0.iter().enumerate().all(|(axis, period)| {
            period.is_none_or(|(_, side)| {
                let many = cell[axis] / side;
                (many - many.round()).abs() <= FIT * many && many > 0.5
            })
        })
    }

    /// The parts of a part of a ray, period by period: the ray as it would pass the first one.
    pub(super) fn pieces(&self, ray: &Ray, part: Interval) -> Pieces {
        let start = ray.at(part.start);
        let number =
            |axis: usize| self.0[axis].map_or(0.0, |(low, side)| ((start[axis] - low) / side).floor());
        let mut pieces = Pieces {
            period: *self,
            ray: *ray,
            number: [number(0), number(1)],
            next: [f64::INFINITY; 2],
            at: part.start,
            end: part.end,
        };
        (0..2).for_each(|axis| pieces.look_ahead(axis));
        pieces
    }
}

/// A ray, period by period.
#[derive(Debug, Clone)]
pub(super) struct Pieces {
    period: Period,
    ray: Ray,
    /// Whole numbers: that of the period.
    number: [f64; 2],
    /// Distance to the next plane between periods \[L\].
    next: [f64; 2],
    at: f64,
    end: f64,
}

impl Pieces {
    /// The ray as it is.
    pub(super) fn ray(&self) -> &Ray {
        &self.ray
    }

    /// What is left of its part.
    pub(super) fn rest(&self) -> Interval {
        Interval { start: self.at, end: self.end }
    }

    /// Leaves out what is left.
    pub(super) fn skip_rest(&mut self) {
        self.at = self.end;
    }

    /// Finds the next plane along an axis: each by its number, so that roundings do not add up.
    fn look_ahead(&mut self, axis: usize) {
        let slope = self.ray.dir[axis];
        if let Some((low, side)) = self.period.0[axis]
            && slope != 0.0
        {
            let ahead = self.number[axis] + if slope > 0.0 { 1.0 } else { 0.0 };
            self.next[axis] = (low + side * ahead - self.ray.origin[axis]) / slope;
        }
    }
}

impl Iterator for Pieces {
    type Item = (Ray, Interval);

    fn next(&mut self) -> Option<(Ray, Interval)> {
        while self.at < self.end {
            let start = self.at;
            let axis = usize::from(self.next[1] < self.next[0]);
            let end = self.next[axis].min(self.end);
            let mut ray = self.ray;
            for (axis, period) in self.period.0.iter().enumerate() {
                if let Some((_, side)) = period {
                    ray.origin[axis] -= side * self.number[axis];
                }
            }
            if self.next[axis] < self.end {
                self.number[axis] += self.ray.dir[axis].signum();
                self.at = self.at.max(end);
                self.look_ahead(axis);
            } else {
                self.at = self.end;
            }
            if end > start {
                return Some((ray, Interval { start, end }));
            }
        }
        None
    }
}

/// What a box of samples repeats: with one more of them on either side, taken from the other, so that it is smooth across the
/// seam.
pub(super) fn repeat_grid(grid: &Arc<Grid>, cell: DVec2) -> Result<(Grid, Period)> {
    let [x, y, _] = grid.count();
    let varies = [x > 1, y > 1];
    let period = Period::of("a grid", grid.corners(), varies, cell)?;
    let (min, mut max) = grid.corners();
    for (axis, side) in period.0.iter().enumerate() {
        max[axis] = side.map_or(max[axis], |(low, side)| low + side);
    }
    let bytes = 4.0 * grid.values().len() as f64;
    crate::memory::check(|| format!("a grid of {bytes} bytes, once more"), 1.2 * bytes)?;
    Ok((grid.wrapped((min, max), varies)?, period))
}

pub(super) fn repeat_blocks(blocks: &Arc<Blocks>, cell: DVec2) -> Result<(Arc<Blocks>, Period)> {
    let [x, y, _] = blocks.count();
    let what = if blocks.is_columns() { "a lattice of columns" } else { "a box of blocks" };
    let period = Period::of(what, blocks.corners(), [x > 1, y > 1], cell)?;
    let mut repeated = blocks.clone();
    for (axis, side) in period.0.iter().enumerate() {
        if let Some((low, side)) = side
            && blocks.corners().1[axis] != low + side
        {
            Arc::make_mut(&mut repeated).end_at(axis, low + side);
        }
    }
    Ok((repeated, period))
}

/// An albedo from place to place.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Albedo {
    /// Linear between samples.
    Grid(Arc<Grid>, Option<Period>),
    /// Constant in blocks.
    Blocks(Arc<Blocks>, Option<Period>),
}

impl Albedo {
    /// The value at a point \[1\].
    pub(super) fn at(&self, p: DVec3) -> Spectrum {
        let folded = |period: &Option<Period>| period.as_ref().map_or(p, |period| period.fold(p));
        match self {
            Albedo::Grid(grid, period) => grid.color_at(folded(period)),
            Albedo::Blocks(blocks, period) => blocks.color_at(folded(period)),
        }
    }

    /// Whether it depends on z alone.
    pub(super) fn is_layered(&self) -> bool {
        match self {
            Albedo::Grid(grid, _) => grid.is_layered(),
            Albedo::Blocks(blocks, _) => blocks.is_layered(),
        }
    }

    /// Whether it is the same in all channels.
    pub(super) fn is_grey(&self) -> bool {
        match self {
            Albedo::Grid(grid, _) => grid.channels() == 1,
            Albedo::Blocks(blocks, _) => blocks.channels() == 1,
        }
    }

    /// The same in every period of a cell.
    pub(super) fn repeated(&self, cell: DVec2) -> Result<Albedo> {
        match self {
            Albedo::Grid(grid, None) if !grid.is_layered() => {
                let (grid, period) = repeat_grid(grid, cell)?;
                Ok(Albedo::Grid(Arc::new(grid), Some(period)))
            }
            Albedo::Blocks(blocks, None) if !blocks.is_layered() => {
                let (blocks, period) = repeat_blocks(blocks, cell)?;
                Ok(Albedo::Blocks(blocks, Some(period)))
            }
            Albedo::Grid(_, Some(period)) | Albedo::Blocks(_, Some(period)) if !period.fits(cell) => {
                refuse("an albedo that repeats itself with periods that are no part of the cell".into())
            }
            Albedo::Grid(..) | Albedo::Blocks(..) => Ok(self.clone()),
        }
    }
}
