//! A map of beams: those that one pass stored, and how many photons that pass emitted.

use super::{Beam, BeamTree, Chord, Crossing};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray, wrap};
use crate::photons::periodic;
use glam::{DVec2, DVec3};

/// Stored beams and the number of photons **emitted** by the pass that stored them, which estimates divide by.
///
/// That of a periodic cell stands for an unbounded slab: whoever asks may ask along any ray of it.
#[derive(Debug)]
pub struct BeamMap {
    tree: BeamTree,
    emitted: u64,
    /// Sides of the periodic cell that the beams are in, if there is one \[L\].
    side: Option<DVec2>,
}

impl BeamMap {
    /// The map of one pass, of beams in parts; `side` of the periodic cell [0, side.x) x [0, side.y) that each of them is in.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `emitted` is zero, and those of [`BeamTree::new`].
    pub fn new(parts: Vec<Vec<Beam>>, emitted: u64, side: Option<DVec2>) -> Result<Self> {
        if emitted == 0 {
            return Err(Error::out_of_range("the number of emitted photons", 0.0, "at least 1"));
        }
        Ok(BeamMap { tree: BeamTree::new(parts)?, emitted, side })
    }

    /// Bits of one of its beams, which are other ones in other maps; 0 of none.
    pub fn salt(&self) -> u64 {
        self.tree
            .beams()
            .first()
            .map_or(0, |beam| beam.start.x.to_bits() ^ beam.dir.y.to_bits().rotate_left(17))
    }

    /// Visits every beam that comes near to a ray, as [`BeamTree::near`] has it; in a periodic cell, those of the world that it
    /// stands for. False where such a map cannot tell: the radius is larger than the cell, or the stretch has no end.
    pub fn near(
        &self,
        ray: &Ray,
        span: Interval,
        radius: f64,
        mut visit: impl FnMut(&Beam, &Crossing),
    ) -> bool {
        self.each_ray((ray, span), radius, |ray, span| self.tree.near(ray, span, radius, &mut visit))
    }

    /// Visits every part of a beam that is near to a ray, as [`BeamTree::chords_near`] has it, with the ray as it is where the beam is;
    /// for the rest as [`BeamMap::near`].
    pub fn chords_near(
        &self,
        ray: &Ray,
        span: Interval,
        radius: f64,
        mut visit: impl FnMut(&Beam, &Chord, &Ray),
    ) -> bool {
        self.each_ray((ray, span), radius, |ray, span| {
            self.tree.chords_near(ray, span, radius, |beam, chord| visit(beam, chord, ray));
        })
    }

    /// Asks the tree along a ray, or along what it is in each cell that it and its surroundings come to.
    fn each_ray(
        &self,
        (ray, span): (&Ray, Interval),
        radius: f64,
        mut ask: impl FnMut(&Ray, Interval),
    ) -> bool {
        let Some(side) = self.side else {
            ask(ray, span);
            return true;
        };
        if !(radius <= side.min_element() && span.end < f64::INFINITY) {
            return false;
        }
        for (ray, span) in periodic::in_cells(ray, span, side) {
            let ends = [ray.at(span.start), ray.at(span.end)];
            // The cells that points within the radius are in.
            let cells = |axis: usize| {
                let (low, high) = (ends[0][axis].min(ends[1][axis]), ends[0][axis].max(ends[1][axis]));
                ((low - radius) / side[axis]).floor() as i64..=((high + radius) / side[axis]).floor() as i64
            };
            for (i, j) in cells(0).flat_map(|i| cells(1).map(move |j| (i, j))) {
                let shift = DVec3::new(i as f64 * side.x, j as f64 * side.y, 0.0);
                ask(&Ray::new(ray.origin - shift, ray.dir), span);
            }
        }
        true
    }

    /// Visits every beam that passes a place, as [`BeamTree::about`] has it; in a periodic cell, those of the world that it stands for.
    /// False where such a map cannot tell: the radius is larger than the cell.
    pub fn about(&self, place: DVec3, radius: f64, mut visit: impl FnMut(&Beam, f64, f64)) -> bool {
        self.each_place(place, radius, |place| self.tree.about(place, radius, &mut visit))
    }

    /// Visits every part of a beam that is near to a place, as [`BeamTree::chords_about`] has it, with the place as it is where the beam
    /// is; for the rest as [`BeamMap::about`].
    pub fn chords_about(
        &self,
        place: DVec3,
        radius: f64,
        mut visit: impl FnMut(&Beam, &Chord, DVec3),
    ) -> bool {
        self.each_place(place, radius, |place| {
            self.tree.chords_about(place, radius, |beam, chord| visit(beam, chord, place));
        })
    }

    /// Asks the tree about a place, or about what it is in each cell that its surroundings come to.
    fn each_place(&self, place: DVec3, radius: f64, mut ask: impl FnMut(DVec3)) -> bool {
        let Some(side) = self.side else {
            ask(place);
            return true;
        };
        if radius.is_nan() || radius > side.min_element() {
            return false;
        }
        let place = wrap(place, side);
        // The cells that points within the radius are in.
        let cells = |axis: usize| {
            let (low, high) = (place[axis] - radius, place[axis] + radius);
            (low / side[axis]).floor() as i64..=(high / side[axis]).floor() as i64
        };
        for (i, j) in cells(0).flat_map(|i| cells(1).map(move |j| (i, j))) {
            let shift = DVec3::new(i as f64 * side.x, j as f64 * side.y, 0.0);
            ask(place - shift);
        }
        true
    }

    /// The beams.
    pub fn tree(&self) -> &BeamTree {
        &self.tree
    }

    /// Number of photons that the pass sent out.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// Number of beams that the pass stored.
    pub fn stored(&self) -> usize {
        self.tree.len()
    }
}
