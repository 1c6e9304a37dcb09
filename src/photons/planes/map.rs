//! A map of planes: those that one pass stored, and how many photons that pass emitted.

use super::{Plane, PlaneCrossing, PlaneTree};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// Copies of a periodic cell that planes may reach across, at most: each is asked by itself.
const MOST_COPIES: f64 = 10_000.0;

/// Stored planes and the number of photons **emitted** by the pass that stored them, which estimates divide by.
///
/// Planes of a periodic cell start in it, reach beyond it, and stand for those of an unbounded slab: whoever asks may ask along any ray
/// of it.
#[derive(Debug)]
pub struct PlaneMap {
    tree: PlaneTree,
    emitted: u64,
    /// Sides of the periodic cell that the planes start in, if there is one \[L\].
    side: Option<DVec2>,
}

impl PlaneMap {
    /// The map of one pass, of planes in parts; `side` of the periodic cell that each of them starts in.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `emitted` is zero; [`Error::Scene`] where planes reach across more than 10,000 copies of the cell; those
    /// of [`PlaneTree::new`].
    pub fn new(parts: Vec<Vec<Plane>>, emitted: u64, side: Option<DVec2>) -> Result<Self> {
        if emitted == 0 {
            return Err(Error::out_of_range("the number of emitted photons", 0.0, "at least 1"));
        }
        let tree = PlaneTree::new(parts)?;
        if let (Some(side), Some([lower, upper])) = (side, tree.bounds()) {
            let copies = ((upper - lower).truncate() / side).ceil().element_product();
            if copies > MOST_COPIES {
                return Err(Error::Scene(format!(
                    "photons' planes reach across {copies:.0} copies of the periodic cell; allowed: at most {MOST_COPIES}, with a \
                     larger cell, or beams (a beam radius)"
                )));
            }
        }
        Ok(PlaneMap { tree, emitted, side })
    }

    /// Visits every plane that a stretch of a ray meets, as [`PlaneTree::met`] has it; in a periodic cell, those of the world that it
    /// stands for, which are told as they are stored. False where such a map cannot tell: the stretch has no end.
    pub fn met(&self, ray: &Ray, span: Interval, mut visit: impl FnMut(&Plane, &PlaneCrossing)) -> bool {
        let (Some(side), Some([lower, upper])) = (self.side, self.tree.bounds()) else {
            self.tree.met(ray, span, visit);
            return true;
        };
        if !span.end.is_finite() {
            return false;
        }
        let ends = [ray.at(span.start), ray.at(span.end)];
        let cells = |axis: usize| {
            let (low, high) = (ends[0][axis].min(ends[1][axis]), ends[0][axis].max(ends[1][axis]));
            let first = ((low - upper[axis]) / side[axis]).floor() as i64;
            first..=((high - lower[axis]) / side[axis]).ceil() as i64
        };
        for (i, j) in cells(0).flat_map(|i| cells(1).map(move |j| (i, j))) {
            let shift = DVec3::new(i as f64 * side.x, j as f64 * side.y, 0.0);
            self.tree.met(&Ray::new(ray.origin - shift, ray.dir), span, &mut visit);
        }
        true
    }

    /// The planes.
    pub fn tree(&self) -> &PlaneTree {
        &self.tree
    }

    /// Number of photons that the pass sent out.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// Number of planes that the pass stored.
    pub fn stored(&self) -> usize {
        self.tree.len()
    }
}
