//! Gathering accepted photons only: rejected ones set no radius and count for nothing.

use super::treatment::Gathered;
use crate::estimators::{Ball, Gather, Kernel, NeighborCount};
use crate::faults::{Fault, planted};
use crate::photons::tree::{Counted, Nearest, Neighbors};
use crate::photons::{Photon, PhotonTree};
use glam::DVec3;

/// The accepted photons of a gather about a point.
pub(in crate::estimators) struct Accepted {
    point: DVec3,
    /// Each with the part of it that counts: 1, but for photons that tie with the k-th.
    pub photons: Vec<(Photon, f64)>,
    /// The ball, set by accepted photons; `found` counts them alone.
    pub ball: Ball,
    /// Rejected photons in the ball.
    pub rejected: usize,
}

impl Gathered for Accepted {
    fn each(&self, kernel: Kernel, visit: &mut dyn FnMut(&Photon, f64)) {
        let r2 = self.ball.radius * self.ball.radius;
        for (photon, share) in &self.photons {
            // All of them are in the ball, whatever rounding says of the last.
            let u2 = (photon.position - self.point).length_squared() / r2;
            visit(photon, share * kernel.peak() * kernel.profile(u2.min(1.0)));
        }
    }
}

/// All photons near a point, the nearest first, as far as they have been asked.
struct Near<'a> {
    tree: &'a PhotonTree,
    point: DVec3,
    keeps: &'a dyn Fn(usize) -> bool,
    /// Squared distances, and places in the tree.
    all: Vec<(f64, usize)>,
    /// The accepted ones.
    accepted: Vec<(f64, usize)>,
    /// Squared distances of the rejected ones.
    rejected: Vec<f64>,
}

impl<'a> Near<'a> {
    /// All within a radius, or the `first` nearest of them; none if there are fewer.
    fn look(
        tree: &'a PhotonTree,
        point: DVec3,
        cap: f64,
        keeps: &'a dyn Fn(usize) -> bool,
        first: Option<usize>,
    ) -> Option<Self> {
        let mut all = Vec::with_capacity(first.unwrap_or(0));
        let mut take = |neighbors: Neighbors<'_>| {
            let squared = |place: usize| tree.position(place).distance_squared(point);
            all.extend(neighbors.places().map(|(_, place)| (squared(place), place)));
        };
        match first {
            None => tree.within(point, cap, &mut take),
            Some(n) => {
                if tree.nearest(point, n, cap, Counted::UpToKth, &mut take) == Nearest::Underfull {
                    return None;
                }
            }
        }
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Some(Near { tree, point, keeps, all, accepted: Vec::new(), rejected: Vec::new() })
    }

    /// Asks the photons one by one, up to the first one beyond the k-th accepted; all of them if there is no k.
    fn ask(&mut self, k: Option<usize>) {
        for &(squared, place) in &self.all {
            let is_beyond = |k: usize| {
                let last = self.accepted.last();
                self.accepted.len() >= k && last.is_some_and(|(last, _)| *last > 0.0 && squared > *last)
            };
            if k.is_some_and(is_beyond) {
                break;
            }
            if (self.keeps)(place) {
                self.accepted.push((squared, place));
            } else {
                self.rejected.push(squared);
            }
        }
    }

    /// The squared distance of the k-th accepted photon, or, if k of them are at the point itself, of the next one
    /// out; and how many are at the point then.
    fn shell(&self, k: usize) -> Option<(f64, usize)> {
        if planted(Fault::RejectedSetRadius) {
            return self.all.get(k - 1).map(|kth| (kth.0, 0));
        }
        let kth = self.accepted.get(k - 1)?.0;
        if kth > 0.0 {
            return Some((kth, 0));
        }
        let here = self.accepted.partition_point(|(squared, _)| *squared == 0.0);
        Some((self.accepted.get(here)?.0, here))
    }

    /// The gather through the k-th accepted photon.
    fn through(mut self, k: usize, counted: Counted) -> Option<Accepted> {
        self.ask(Some(k));
        let (squared, coincident) = self.shell(k)?;
        let closer = self.accepted.partition_point(|(s, _)| *s < squared);
        let found = self.accepted.partition_point(|(s, _)| *s <= squared);
        let nearer = if coincident > 0 { closer } else { k - 1 };
        let counts = nearer + usize::from(counted == Counted::UpToKth);
        let share = (counts - closer) as f64 / (found - closer) as f64;
        let rejected = self.rejected.iter().filter(|s| **s <= squared).count();
        let of = |(index, (_, place)): (usize, &(f64, usize))| {
            (self.tree.photon(*place), if index < closer { 1.0 } else { share })
        };
        let photons = self.accepted[..found].iter().enumerate().map(of).collect();
        let ball = Ball { radius: squared.sqrt(), found, underfull: false, coincident };
        Some(Accepted { point: self.point, photons, ball, rejected })
    }

    /// All of them.
    fn everything(mut self) -> (Vec<(Photon, f64)>, usize) {
        self.ask(None);
        let photons = self.accepted.iter().map(|(_, place)| (self.tree.photon(*place), 1.0));
        (photons.collect(), self.rejected.len())
    }
}

/// The accepted photons of a gather: all within a radius, or the k nearest of them.
///
/// The k nearest are looked for among so many more photons of any kind as the part that was `rejected` of the k nearest
/// leads to expect, and a quarter; of 5k/2 if that is not known, since a wall rejects half. Then among twice as many, and
/// so on, until k accepted ones are among them: all that are nearer than the farthest one looked at have then been seen.
///
/// # Arguments
/// `keeps` whether the photon at a place in the tree's order is accepted
pub(in crate::estimators) fn accepted(
    tree: &PhotonTree,
    point: DVec3,
    gather: Gather,
    keeps: &dyn Fn(usize) -> bool,
    rejected: Option<usize>,
) -> Accepted {
    let (k, cap, counted) = gather.rule();
    let k = k.map(NeighborCount::get);
    if let Some(k) = k {
        let kept = rejected.map_or(k.div_ceil(2), |rejected| k.saturating_sub(rejected).max(k.div_ceil(8)));
        let mut first = (k + k / 4).saturating_mul(k) / kept;
        loop {
            let near = Near::look(tree, point, cap, keeps, Some(first));
            let is_all = near.is_none();
            let near = near.or_else(|| Near::look(tree, point, cap, keeps, None));
            if let Some(found) = near.and_then(|near| near.through(k, counted)) {
                return found;
            }
            if is_all {
                break;
            }
            first *= 2;
        }
    }
    let near = Near::look(tree, point, cap, keeps, None);
    let (photons, rejected) = near.map_or((Vec::new(), 0), Near::everything);
    let ball = Ball { radius: cap, found: photons.len(), underfull: k.is_some(), coincident: 0 };
    Accepted { point, photons, ball, rejected }
}
