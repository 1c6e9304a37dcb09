//! Cells of a tree that hold about as many photons each, and what each learned.

use super::arrival::Arrival;
use super::choice::{Own, lobe, plain};
use crate::medium::Medium;
use crate::transport::Lobe;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Photons that a cell holds at least, if there are as many in all, and less than twice as many.
const LEAST: usize = 512;

/// A binary tree whose leaves are all as deep; none where nothing was learned that is of use.
#[derive(Debug, Default)]
pub(super) struct Cells {
    depth: u32,
    /// Axis and place of each cut, level by level.
    cuts: Vec<(usize, f64)>,
    /// By leaf.
    lobes: Vec<Option<Lobe>>,
    /// Leaves, and those with a lobe.
    counts: [usize; 2],
}

impl Cells {
    /// Sorts photons into cells, and learns in each.
    ///
    /// # Arguments
    /// `share` of what is learned, in place of the best one
    /// `medium_at` the medium at a place, if there is one
    pub fn new<'a>(
        mut arrivals: Vec<Arrival>,
        share: Option<f64>,
        medium_at: &(dyn Fn(DVec3) -> Option<&'a Medium> + Sync),
    ) -> Self {
        if arrivals.is_empty() {
            return Cells::default();
        }
        let depth = (arrivals.len() / LEAST).max(1).ilog2();
        let (mut cuts, mut parts) = (Vec::new(), vec![&mut arrivals[..]]);
        for _ in 0..depth {
            let halves: Vec<_> = parts.into_par_iter().map(halved).collect();
            parts = Vec::with_capacity(2 * halves.len());
            for (cut, [near, far]) in halves {
                cuts.push(cut);
                parts.extend([near, far]);
            }
        }
        let learned = |part: &mut [Arrival]| {
            let first = part.first()?;
            let own = if first.normal == Vec3::ZERO {
                // That of the first photon stands for all.
                let medium = medium_at(first.position)?;
                if medium.matter().albedo().is_black() {
                    return None;
                }
                Own::Medium(medium.phase())
            } else {
                Own::Surface(part.iter().map(|arrival| arrival.normal).sum::<Vec3>().as_dvec3().normalize())
            };
            match share {
                Some(share) => plain(part, share),
                None => lobe(part, &own),
            }
        };
        let lobes: Vec<Option<Lobe>> = parts.into_par_iter().map(learned).collect();
        let counts = [lobes.len(), lobes.iter().flatten().count()];
        if counts[1] == 0 {
            return Cells { counts, ..Cells::default() };
        }
        Cells { depth, cuts, lobes, counts }
    }

    /// What the cell of a place learned.
    #[inline]
    pub fn at(&self, p: DVec3) -> Option<&Lobe> {
        if self.lobes.is_empty() {
            return None;
        }
        let mut node = 0;
        for _ in 0..self.depth {
            let (axis, place) = self.cuts[node];
            node = 2 * node + 1 + usize::from(p[axis] >= place);
        }
        self.lobes[node - self.cuts.len()].as_ref()
    }

    /// Cells, and those with a lobe.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }
}

/// The halves of a cell along its longest axis, and where they meet.
fn halved(part: &mut [Arrival]) -> ((usize, f64), [&mut [Arrival]; 2]) {
    let corners = part.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), arrival| {
        (low.min(arrival.position), high.max(arrival.position))
    });
    let axis = (corners.1 - corners.0).max_position();
    let middle = part.len() / 2;
    part.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    let place = part[middle].position[axis];
    ((axis, place), part.split_at_mut(middle).into())
}
