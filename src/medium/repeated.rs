//! Media of a world that repeats itself in x and y.
//!
//! The world has the periods of the cell that photons are wrapped into; a density may have a whole part of them as its own.
//! Positions are folded, and a ray goes from period to period, moved back in each: the bounds of one period hold in all.

use super::{Blocks, Bound, Bounds, Density, Grid};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A box may differ from a whole part of the cell by this part of itself, single precision in its file; it is made to fit.
const FIT: f64 = 1e-6;

/// After so many periods without anything in them, what is left of a ray is asked at once.
const EMPTY: u64 = 1 << 10;

/// A ray along the faces of its slab has no end: it is followed over so many periods, and what lies behind counts as empty. A
/// direction at random is never one.
const FOREVER: u64 = 1 << 20;

/// Where a period begins, and its length, along x and y; none where nothing varies \[L\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period([Option<(f64, f64)>; 2]);

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

    /// Whether a cell holds a whole number of these periods.
    fn fits(&self, cell: DVec2) -> bool {
        self.0.iter().enumerate().all(|(axis, period)| {
            period.is_none_or(|(_, side)| {
                let many = cell[axis] / side;
                (many - many.round()).abs() <= FIT * many && many > 0.5
            })
        })
    }

    /// The parts of a part of a ray, period by period: the ray as it would pass the first one.
    fn pieces(&self, ray: &Ray, part: Interval) -> Pieces {
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
struct Pieces {
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

/// A density that repeats itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeated {
    /// One period.
    density: Density,
    period: Period,
}

impl Repeated {
    /// One period.
    pub fn density(&self) -> &Density {
        &self.density
    }

    /// The density at a point \[1\].
    pub fn at(&self, p: DVec3) -> f64 {
        self.density.at(self.period.fold(p))
    }

    /// Bounds along a part of a ray of any length, in no more memory than those of one period.
    pub fn along(&self, ray: &Ray, part: Interval) -> AlongPeriods<'_> {
        let pieces = self.period.pieces(ray, part);
        AlongPeriods { repeated: self, pieces, inner: None, is_empty: false, crossed: 0, empty: 0 }
    }

    /// The integral along a part of a ray \[L\].
    pub fn integral(&self, ray: &Ray, part: Interval) -> f64 {
        self.period.pieces(ray, part).map(|(ray, part)| self.density.integral(&ray, part)).sum()
    }

    /// No point of a box has more than this.
    pub fn high_in(&self, mut min: DVec3, mut max: DVec3) -> f64 {
        for (axis, period) in self.period.0.iter().enumerate() {
            let Some((low, side)) = *period else { continue };
            let shift = side * ((min[axis] - low) / side).floor();
            let (a, b) = (min[axis] - shift, max[axis] - shift);
            // Across the seam, all of it; so where numbers are not.
            (min[axis], max[axis]) = if b <= low + side { (a, b) } else { (low, low + side) };
        }
        self.density.high_in(min, max)
    }

    /// Whether nothing is left on the rest of a ray.
    fn is_empty_beyond(&self, ray: &Ray, part: Interval) -> bool {
        let height = |t: f64| if ray.dir.z == 0.0 { ray.origin.z } else { ray.at(t).z };
        let (a, b) = (height(part.start), height(part.end));
        let all = |axis: usize| self.period.0[axis].map_or((0.0, 0.0), |(low, side)| (low, low + side));
        let ((x0, x1), (y0, y1)) = (all(0), all(1));
        self.density.high_in(DVec3::new(x0, y0, a.min(b)), DVec3::new(x1, y1, a.max(b))) == 0.0
    }
}

/// Bounds of a density along a ray, period by period.
#[derive(Debug, Clone)]
pub struct AlongPeriods<'a> {
    repeated: &'a Repeated,
    pieces: Pieces,
    inner: Option<Bounds<'a>>,
    /// Whether nothing was in this period so far.
    is_empty: bool,
    crossed: u64,
    /// The last periods that had nothing in them.
    empty: u64,
}

impl Iterator for AlongPeriods<'_> {
    type Item = Bound;

    fn next(&mut self) -> Option<Bound> {
        loop {
            if let Some(bound) = self.inner.as_mut().and_then(Iterator::next) {
                self.is_empty &= bound.high == 0.0;
                return Some(bound);
            }
            self.empty = if self.is_empty { self.empty + 1 } else { 0 };
            let rest = Interval { start: self.pieces.at, end: self.pieces.end };
            let is_endless = self.crossed >= FOREVER && rest.end == f64::INFINITY;
            let is_asked = self.empty > 0 && self.empty.is_multiple_of(EMPTY);
            if is_endless || (is_asked && self.repeated.is_empty_beyond(&self.pieces.ray, rest)) {
                self.pieces.at = rest.end;
                self.inner = None;
                return (rest.end > rest.start).then_some(Bound { interval: rest, low: 0.0, high: 0.0 });
            }
            let (ray, part) = self.pieces.next()?;
            self.crossed += 1;
            self.is_empty = true;
            self.inner = Some(self.repeated.density.along(&ray, part));
        }
    }
}

/// What a box of samples repeats: with one more of them on either side, taken from the other, so that it is smooth across the
/// seam.
fn repeat_grid(grid: &Arc<Grid>, cell: DVec2) -> Result<(Grid, Period)> {
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

fn repeat_blocks(blocks: &Arc<Blocks>, cell: DVec2) -> Result<(Arc<Blocks>, Period)> {
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

impl Density {
    /// The same density in every period of a cell; itself where it depends on z alone.
    ///
    /// # Errors
    /// `Error::Scene` for boxes that are no whole part of the cell, clouds that do not fit into it, and fog that thins out
    /// along x or y
    pub(super) fn repeated(&self, cell: DVec2, sigma_t: f64) -> Result<Density> {
        if self.is_layered() {
            return Ok(self.clone());
        }
        let (density, period) = match self {
            Density::Grid(grid) => {
                let (grid, period) = repeat_grid(grid, cell)?;
                (Density::Grid(Arc::new(grid.bounded_for(sigma_t))), period)
            }
            Density::Blocks(blocks) => {
                let (blocks, period) = repeat_blocks(blocks, cell)?;
                (Density::Blocks(blocks), period)
            }
            Density::Cloud(cloud) => {
                let reach = cloud.reach();
                let center = cloud.shape().center;
                if let Some(axis) = (0..2).find(|axis| 2.0 * reach[*axis] > cell[*axis]) {
                    return refuse(format!(
                        "a cloud is {} wide along {}, with its shreds; allowed: up to the side of the cell there, {}",
                        2.0 * reach[axis],
                        ["x", "y"][axis],
                        cell[axis]
                    ));
                }
                let along = |axis: usize| Some((center[axis] - 0.5 * cell[axis], cell[axis]));
                (self.clone(), Period([along(0), along(1)]))
            }
            Density::HeightFog(_) => {
                return refuse("height fog does not repeat itself; allowed with `cell`: `up` along z".into());
            }
            Density::Repeated(repeated) if repeated.period.fits(cell) => return Ok(self.clone()),
            Density::Repeated(_) => {
                return refuse(
                    "a density that repeats itself with periods that are no part of the cell".into(),
                );
            }
        };
        Ok(Density::Repeated(Arc::new(Repeated { density, period })))
    }
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
