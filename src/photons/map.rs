//! A photon map: the photons that one pass stored, and how many that pass emitted.

use super::tree::{Neighbors, Radii};
use super::{Photon, PhotonTree, Photons, periodic};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray, wrap};
use crate::transport::{NoProgress, Progress};
use glam::{DVec2, DVec3};
use wide::f32x8;

/// Stored photons and the number **emitted** by the pass that stored them: estimates divide by that number,
/// never by the number stored. It holds no estimator.
///
/// That of a periodic cell stands for an unbounded slab: whoever asks may ask at any place of it.
#[derive(Debug)]
pub struct PhotonMap {
    tree: PhotonTree,
    emitted: u64,
    run: u64,
    period: Option<Period>,
}

/// A world that repeats itself in x and y.
#[derive(Debug, Clone, Copy)]
struct Period {
    side: DVec2,
    /// How far beyond the cell's edges the map holds copies.
    reach: f64,
}

/// The extent of a map over a radius of a gather, at most. A stored coordinate is rounded to the 24 bits of single precision, by up
/// to 2^-25 of a unit of at most twice the extent, and so is that of the point that asks: each by 2^-24 of the extent, here by
/// 2^-24 x 10^6 = 6 % of the radius. Such errors differ from photon to photon and blur the ball's edge: 200,000 photons evenly about
/// a place at 0.7 of the extent give an estimate that is 0.3 % wrong here, 7 % at 10^7, and 12 times too large at 10^8.
const MOST_EXTENT: f64 = 1e6;

impl PhotonMap {
    /// The map of one pass, its tree built by the calling thread.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `emitted` is zero, and those of [`PhotonTree::new`].
    pub fn new(photons: impl Into<Photons>, emitted: u64) -> Result<Self> {
        Self::of(PhotonTree::new(photons), emitted)
    }

    /// The same map, bit for bit, built by the threads of the current pool.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn new_parallel(photons: impl Into<Photons>, emitted: u64) -> Result<Self> {
        Self::new_watched(photons, emitted, &NoProgress)
    }

    /// The same, and `progress` is told of every photon that is in its place.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn new_watched(photons: impl Into<Photons>, emitted: u64, progress: &dyn Progress) -> Result<Self> {
        Self::of(PhotonTree::new_watched(photons, progress), emitted)
    }

    /// The same of photons in parts, as a pass stores them, which are not brought together first.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn of_parts(parts: Vec<Photons>, emitted: u64, progress: &dyn Progress) -> Result<Self> {
        Self::of(PhotonTree::of_parts(parts, progress), emitted)
    }

    /// The map of a cell [0, side.x) x [0, side.y), if sides are given, with copies for balls that reach so far beyond its edges,
    /// at most its shorter side \[L\].
    ///
    /// # Errors
    /// As [`PhotonMap::new`]; [`Error::OutOfRange`] for a reach beyond the shorter side.
    pub fn periodic(
        mut parts: Vec<Photons>,
        emitted: u64,
        cell: Option<(DVec2, f64)>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let period = cell.map(|(side, reach)| Period { side, reach });
        if let Some(Period { side, reach }) = period {
            if !(0.0..=side.min_element()).contains(&reach) {
                return Err(Error::out_of_range(
                    "the reach beyond the cell",
                    reach,
                    "from 0 to the shorter side of the cell",
                ));
            }
            if reach > 0.0 {
                parts.iter_mut().for_each(|part| periodic::surround(part, side, reach));
            }
        }
        Ok(PhotonMap { period, ..Self::of_parts(parts, emitted, progress)? })
    }

    fn of(tree: Result<PhotonTree>, emitted: u64) -> Result<Self> {
        if emitted == 0 {
            return Err(Error::out_of_range("the number of emitted photons", 0.0, "at least 1"));
        }
        let tree = tree?;
        // Other photons, other numbers.
        let first = if tree.is_empty() { DVec3::ZERO } else { tree.position(0) };
        let run = first.to_array().into_iter().fold(emitted, |mix, x| mix.rotate_left(21) ^ x.to_bits());
        Ok(PhotonMap { tree, emitted, run, period: None })
    }

    /// The same map as one of a run, whole or in parts: in all of them estimates choose alike what they choose at random.
    pub fn of_run(self, seed: u64, replicate: u64) -> Self {
        PhotonMap { run: seed.rotate_left(32) ^ replicate, ..self }
    }

    /// Where the tree is asked for the photons within a distance \[L\] of a place: in a periodic cell, the place in it. Not a number
    /// where the ball reaches beyond the copies about the cell, so that what is estimated there is not one either.
    pub fn place(&self, point: DVec3, distance: f64) -> DVec3 {
        let Some(Period { side, reach }) = self.period else { return point };
        let place = wrap(point, side);
        // The reach may have been the difference of such numbers: rounding is no lack of copies.
        let least = place.x.min(place.y).min(side.x - place.x).min(side.y - place.y)
            + reach * (1.0 + 1e-9)
            + 1e-12 * side.min_element();
        if distance <= least { place } else { DVec3::NAN }
    }

    /// Visits every photon at most `radius` \[L\] from a ray whose foot on it lies in `span`, with the distance of the foot along
    /// the ray \[L\] and its squared distance from it [L^2]; in a periodic cell, those of the world that it stands for, moved into
    /// the cell. False where such a map cannot tell: it has no copies as far as that, or the stretch no end.
    pub fn along(
        &self,
        ray: &Ray,
        span: Interval,
        radius: f64,
        mut visit: impl FnMut(Photon, f64, f64),
    ) -> bool {
        let mut each = |place: usize, foot: f64, squared: f64| visit(self.tree.photon(place), foot, squared);
        self.in_cells((ray, span), radius, |ray, span| self.tree.along(ray, span, radius, &mut each))
    }

    /// [`PhotonMap::along`], but in parts of the span told of by rows, as [`PhotonTree::along_by_rows`] has it. False, and
    /// nothing visited, where the map cannot tell so: in a periodic cell, or of a radius below 10^-3 of the map.
    pub fn along_by_rows(
        &self,
        way: (&Ray, Interval, f64),
        parts: &[Interval],
        mut visit: impl FnMut(Photon, f64, f64),
        visit_row: impl FnMut(Neighbors<'_>, f32x8),
    ) -> bool {
        let each = |place: usize, foot: f64, squared: f64| visit(self.tree.photon(place), foot, squared);
        self.period.is_none() && self.tree.along_by_rows(way, parts, each, visit_row)
    }

    /// [`PhotonMap::along`] of every photon whose own radius reaches the ray, with that radius \[L\] before the other numbers.
    pub fn along_by_radii(
        &self,
        ray: &Ray,
        span: Interval,
        radii: &Radii,
        mut visit: impl FnMut(Photon, f64, f64, f64),
    ) -> bool {
        let mut each = |place: usize, foot: f64, squared: f64| {
            visit(self.tree.photon(place), radii.of(place), foot, squared)
        };
        let largest = radii.largest();
        self.in_cells((ray, span), largest, |ray, span| self.tree.along_by_radii(ray, span, radii, &mut each))
    }

    /// Asks the tree along a ray, or along each part of it in a cell; false where there are no copies as far as the radius.
    fn in_cells(
        &self,
        (ray, span): (&Ray, Interval),
        radius: f64,
        mut ask: impl FnMut(&Ray, Interval),
    ) -> bool {
        let Some(Period { side, reach }) = self.period else {
            ask(ray, span);
            return true;
        };
        if !(radius <= reach * (1.0 + 1e-9) && span.end < f64::INFINITY) {
            return false;
        }
        periodic::in_cells(ray, span, side).for_each(|(ray, span)| ask(&ray, span));
        true
    }

    /// The distance of each photon to its k-th nearest other one, but at most `most`, which is no farther than a cell's copies reach
    /// \[L\], and at least what [`PhotonMap::check_radius`] allows: the k nearest of a copy are those of the photon that it stands for.
    /// By the threads of the current pool.
    pub fn radii(&self, k: usize, most: f64) -> Radii {
        let least = self.tree.extent() / MOST_EXTENT;
        self.tree.radii(k, (least, most), |position| self.place(position, most))
    }

    /// Checks that positions are told apart finely enough for balls of a radius \[L\]: at least 10^-6 of
    /// [`PhotonTree::extent`].
    ///
    /// # Errors
    /// `Error::Scene` that says how far the photons reach, and which radius is allowed
    pub fn check_radius(&self, radius: f64) -> Result<()> {
        let extent = self.tree.extent();
        if extent <= MOST_EXTENT * radius {
            return Ok(());
        }
        Err(Error::Scene(format!(
            "a gather radius of {radius:e} L in a map whose photons reach {extent:.3e} L from its middle, at positions in single \
             precision; allowed: at least {:.3e} L, 10^-6 of that",
            extent / MOST_EXTENT
        )))
    }

    /// The photons, with the copies of a periodic cell.
    pub fn tree(&self) -> &PhotonTree {
        &self.tree
    }

    /// Number of photons that the pass sent out.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// What random choices of estimates depend on beside their place: another number for other photons, the same for all parts
    /// of a run.
    pub fn run(&self) -> u64 {
        self.run
    }

    /// Number of photons that the pass stored.
    pub fn stored(&self) -> usize {
        self.tree.len()
    }
}
