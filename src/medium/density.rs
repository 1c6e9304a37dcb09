//! How much of a medium is where: the densities at hand.

use super::period::{Period, Pieces, repeat_blocks, repeat_grid};
use super::{Along, Blocks, Bound, Cloud, CloudShape, Grid, HeightFog, Layers, Through};
use crate::error::{Error, Result};
use crate::math::{Interval, Positive, Ray};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A density, 0 or more at every point \[1\]; extinction is this times that at density 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Density {
    /// Samples on a grid.
    Grid(Arc<Grid>),
    /// A body broken up by noise.
    Cloud(Arc<Cloud>),
    /// Exponential in height.
    HeightFog(HeightFog),
    /// Constant in blocks.
    Blocks(Arc<Blocks>),
    /// Another one, again and again.
    Repeated(Arc<Repeated>),
}

/// Stretches of a ray with the bounds of a density, nearest first.
#[derive(Debug, Clone)]
pub enum Bounds<'a> {
    /// By cell.
    Cells(Along<'a>),
    /// By height.
    Layers(Layers),
    /// By block.
    Blocks(Through<'a>),
    /// By period.
    Repeated(Box<AlongPeriods<'a>>),
}

impl Iterator for Bounds<'_> {
    type Item = Bound;

    #[inline]
    fn next(&mut self) -> Option<Bound> {
        match self {
            Bounds::Cells(cells) => cells.next(),
            Bounds::Layers(layers) => layers.next(),
            Bounds::Blocks(blocks) => blocks.next(),
            Bounds::Repeated(periods) => periods.next(),
        }
    }
}

impl Density {
    /// A grid of one channel.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a grid of more
    pub fn grid(grid: Grid) -> Result<Self> {
        match grid.channels() {
            1 => Ok(Density::Grid(Arc::new(grid))),
            more => Err(Error::out_of_range("channels of a density", more as f64, "1")),
        }
    }

    /// Blocks of one channel.
    ///
    /// # Errors
    /// `Error::OutOfRange` for blocks of more
    pub fn blocks(blocks: Blocks) -> Result<Self> {
        match blocks.channels() {
            1 => Ok(Density::Blocks(Arc::new(blocks))),
            more => Err(Error::out_of_range("channels of a density", more as f64, "1")),
        }
    }

    /// The same density, bounded as suits light that collides `sigma_t` times a length where it is 1.
    pub(super) fn bounded_for(self, sigma_t: f64) -> Self {
        match self {
            Density::Grid(grid) => Density::Grid(Arc::new(Arc::unwrap_or_clone(grid).bounded_for(sigma_t))),
            Density::Cloud(_) | Density::HeightFog(_) | Density::Blocks(_) | Density::Repeated(_) => self,
        }
    }

    /// The density at a point \[1\].
    #[inline]
    pub fn at(&self, p: DVec3) -> f64 {
        match self {
            Density::Grid(grid) => grid.at(p),
            Density::Cloud(cloud) => cloud.at(p),
            Density::HeightFog(fog) => fog.at(p),
            Density::Blocks(blocks) => blocks.at(p),
            Density::Repeated(repeated) => repeated.at(p),
        }
    }

    /// Bounds along a part of a ray that hold for every point of it.
    #[inline]
    pub fn along(&self, ray: &Ray, part: Interval) -> Bounds<'_> {
        match self {
            Density::Grid(grid) => Bounds::Cells(grid.along(ray, part)),
            Density::Cloud(cloud) => Bounds::Cells(cloud.along(ray, part)),
            Density::HeightFog(fog) => Bounds::Layers(fog.along(ray, part)),
            Density::Blocks(blocks) => Bounds::Blocks(blocks.along(ray, part)),
            Density::Repeated(repeated) => Bounds::Repeated(Box::new(repeated.along(ray, part))),
        }
    }

    /// The integral along a part of a ray \[L\], where it has a closed form.
    #[inline]
    pub fn closed_integral(&self, ray: &Ray, part: Interval) -> Option<f64> {
        match self {
            Density::HeightFog(fog) => Some(fog.integral(ray, part)),
            Density::Grid(_) | Density::Cloud(_) | Density::Blocks(_) | Density::Repeated(_) => None,
        }
    }

    /// The integral along a part of a ray \[L\]: exact for height fog and blocks and, sample by sample, for grids; of a cloud by
    /// quadrature, to some 1e-4 of its extent.
    pub fn integral(&self, ray: &Ray, part: Interval) -> f64 {
        let kinks = match self {
            Density::HeightFog(fog) => return fog.integral(ray, part),
            Density::Repeated(repeated) => return repeated.integral(ray, part),
            Density::Grid(grid) => grid.kinks(ray, part),
            Density::Cloud(_) | Density::Blocks(_) => Vec::new(),
        };
        let mut sum = 0.0;
        for bound in self.along(ray, part) {
            let Interval { start, end } = bound.interval;
            if bound.high == bound.low {
                sum += if bound.low == 0.0 { 0.0 } else { bound.low * (end - start) };
                continue;
            }
            let inside = kinks.iter().copied().filter(|t| start < *t && *t < end);
            let steps = 16;
            let even = (1..steps).map(|i| start + (end - start) * f64::from(i) / f64::from(steps));
            let mut ends: Vec<f64> = match self {
                Density::Grid(_) => inside.collect(),
                _ => even.collect(),
            };
            ends.push(end);
            let mut low = start;
            for high in ends {
                // Two nodes of Gauss: exact for the cubic that a trilinear function is on a line.
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                let node = half / 3.0f64.sqrt();
                sum += half * (self.at(ray.at(middle - node)) + self.at(ray.at(middle + node)));
                low = high;
            }
        }
        sum
    }

    /// About the integral along a part of a ray \[L\]: in closed form where there is one, else by the middle between the
    /// bounds of each stretch, which asks for no density.
    pub fn integral_by_bounds(&self, ray: &Ray, part: Interval) -> f64 {
        self.closed_integral(ray, part).unwrap_or_else(|| {
            let middle = |b: Bound| 0.5 * (b.low + b.high);
            let stretches = self.along(ray, part).filter(|b| b.high > 0.0);
            stretches.map(|b| middle(b) * b.interval.length()).sum()
        })
    }

    /// No point has more than this.
    pub fn high(&self) -> f64 {
        match self {
            Density::Grid(grid) => grid.high(),
            Density::Cloud(_) | Density::HeightFog(_) => 1.0,
            Density::Blocks(blocks) => blocks.high(),
            Density::Repeated(repeated) => repeated.density().high(),
        }
    }

    /// No point of a box has more than this.
    pub fn high_in(&self, min: DVec3, max: DVec3) -> f64 {
        match self {
            Density::Grid(grid) => grid.cells().high_in(min, max),
            Density::Cloud(cloud) => cloud.bounds(min, max).1,
            Density::HeightFog(fog) => fog.high_in(min, max),
            Density::Blocks(blocks) => blocks.high_in(min, max),
            Density::Repeated(repeated) => repeated.high_in(min, max),
        }
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        match self {
            Density::Grid(grid) => grid.is_layered(),
            Density::HeightFog(fog) => fog.is_layered(),
            Density::Blocks(blocks) => blocks.is_layered(),
            Density::Cloud(_) | Density::Repeated(_) => false,
        }
    }

    /// What it is, in a line.
    pub fn describe(&self) -> String {
        match self {
            Density::Grid(grid) => {
                let [x, y, z] = grid.count();
                format!("grid of {x} x {y} x {z} samples, majorants in {} cells", grid.cells().len())
            }
            Density::Cloud(cloud) => {
                let octaves = cloud.shape().octaves;
                format!("cloud of {octaves} octaves, majorants in {} cells", cloud.cells().len())
            }
            Density::HeightFog(_) => "height fog: transmittance in closed form, majorants by height".into(),
            Density::Blocks(blocks) => {
                let [x, y, z] = blocks.count();
                match blocks.is_columns() {
                    true => format!("{x} x {y} columns, constant in each"),
                    false => format!("{x} x {y} x {z} blocks, constant in each"),
                }
            }
            Density::Repeated(repeated) => format!("{}; periodic", repeated.density().describe()),
        }
    }

    /// Some of each kind, about the origin. A new kind does not compile until it is named here.
    pub fn specimens() -> Vec<Density> {
        let cube = |half: f64| (DVec3::splat(-half), DVec3::splat(half));
        let grid = |count: [usize; 3], f: &dyn Fn(DVec3) -> f64| {
            Grid::sampled(cube(1.5), count, f).and_then(Density::grid).ok()
        };
        let cloud = |radii: [f64; 3], roughness: f64, body: super::Body, octaves: u32| {
            let plain = CloudShape::plain(DVec3::new(0.1, -0.2, 0.0), radii.into());
            let look = CloudShape { body, octaves, roughness, seed: 3, ..plain };
            Cloud::new(look).ok().map(|c| Density::Cloud(Arc::new(c)))
        };
        let fog = |up: DVec3, base: f64, scale: f64| {
            HeightFog::new(up, base, Positive::new("scale height", scale).ok()?).ok().map(Density::HeightFog)
        };
        let blocks = |count: [usize; 3], f: &dyn Fn(usize) -> f64| {
            let values = (0..count.iter().product()).map(f).collect();
            Blocks::uniform(cube(1.5), count, 1, values).and_then(Density::blocks).ok()
        };
        let columns = || {
            let edges = |n: u32| (0..=n).map(|i| -1.5 + 3.0 * f64::from(i * i) / f64::from(n * n)).collect();
            let spans = (0..12).map(|i| (-0.1 * f64::from(i), 0.2 * f64::from(i % 5))).collect();
            let values = (0..12).map(|i| f64::from(i % 4)).collect();
            Blocks::columns(edges(4), edges(3), values, spans).and_then(Density::blocks).ok()
        };
        let again = |density: Option<Density>, x: f64, y: f64| density?.repeated(DVec2::new(x, y), 2.0).ok();
        let named = |density: Density| match density {
            Density::Grid(_) => vec![
                grid([1, 1, 1], &|_| 0.7),
                grid([8, 8, 8], &|_| 1.25),
                grid([2, 9, 33], &|p| (p.x * 3.0 + p.y * p.z).abs()),
                grid([24, 24, 24], &|p| if p.length() < 1.0 { 1.0 - p.length() } else { 0.0 }),
            ],
            Density::Cloud(_) => vec![
                cloud([1.0, 1.2, 0.8], 1.0, super::Body::Ellipsoid, 5),
                cloud([1.0, 1.0, 1.0], 0.0, super::Body::Cuboid, 1),
                cloud([0.7, 1.4, 1.0], 2.5, super::Body::Cuboid, 12),
            ],
            Density::HeightFog(_) => {
                vec![
                    fog(DVec3::Y, -1.0, 0.5),
                    fog(DVec3::new(1.0, -2.0, 0.5), 0.3, 0.05),
                    fog(DVec3::Z, -9.0, 40.0),
                ]
            }
            Density::Blocks(_) => vec![blocks([3, 1, 5], &|i| (i % 4) as f64), columns()],
            Density::Repeated(_) => vec![
                again(grid([5, 4, 3], &|p| (p.x + p.y * p.z).abs()), 3.0, 6.0),
                again(columns(), 3.0, 3.0),
                again(cloud([0.7, 0.5, 0.9], 0.5, super::Body::Cuboid, 3), 1.8, 1.3),
            ],
        };
        let first = [
            grid([1, 1, 1], &|_| 1.0),
            cloud([1.0; 3], 1.0, super::Body::Ellipsoid, 1),
            fog(DVec3::Z, 0.0, 1.0),
            blocks([1, 1, 1], &|_| 1.0),
            again(blocks([2, 1, 1], &|i| i as f64), 3.0, 3.0),
        ];
        first.into_iter().flatten().flat_map(named).flatten().collect()
    }
}

/// After so many periods without anything in them, what is left of a ray is asked at once.
const EMPTY: u64 = 1 << 10;

/// A ray along the faces of its slab has no end: it is followed over so many periods, and what lies behind counts as empty. A
/// direction at random is never one.
const FOREVER: u64 = 1 << 20;

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
    pub fn high_in(&self, min: DVec3, max: DVec3) -> f64 {
        let (min, max) = self.period.fold_box(min, max);
        self.density.high_in(min, max)
    }

    /// Whether nothing is left on the rest of a ray.
    fn is_empty_beyond(&self, ray: &Ray, part: Interval) -> bool {
        let height = |t: f64| if ray.dir.z == 0.0 { ray.origin.z } else { ray.at(t).z };
        let (min, max) = self.period.whole(height(part.start), height(part.end));
        self.density.high_in(min, max) == 0.0
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
            let rest = self.pieces.rest();
            let is_endless = self.crossed >= FOREVER && rest.end == f64::INFINITY;
            let is_asked = self.empty > 0 && self.empty.is_multiple_of(EMPTY);
            if is_endless || (is_asked && self.repeated.is_empty_beyond(self.pieces.ray(), rest)) {
                self.pieces.skip_rest();
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
            Density::Cloud(cloud) => (self.clone(), Period::about_cloud(cloud, cell)?),
            Density::HeightFog(_) => {
                return Err(Error::Scene(
                    "height fog does not repeat itself; allowed with `cell`: `up` along z".into(),
                ));
            }
            Density::Repeated(repeated) if repeated.period.fits(cell) => return Ok(self.clone()),
            Density::Repeated(_) => {
                return Err(Error::Scene(
                    "a density that repeats itself with periods that are no part of the cell".into(),
                ));
            }
        };
        Ok(Density::Repeated(Arc::new(Repeated { density, period })))
    }
}
