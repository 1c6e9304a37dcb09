//! Gathering accepted photons only: rejected ones set no radius and count for nothing.

use crate::estimators::{Ball, Gather};
use crate::faults::{Fault, planted};
use crate::photons::tree::{Counted, Nearest, Neighbors};
use crate::photons::{Photon, PhotonTree};
use glam::DVec3;

/// The accepted photons of a gather.
pub(super) struct Accepted {
    /// Each with the part of it that counts: 1, but for photons that tie with the k-th.
    pub photons: Vec<(Photon, f64)>,
    /// The ball, set by accepted photons; `found` counts them alone.
    pub ball: Ball,
    /// Rejected photons in the ball.
    pub rejected: usize,
}

/// All photons near a point, by squared distance.
struct Near {
    accepted: Vec<(f64, Photon)>,
    rejected: Vec<f64>,
}

impl Near {
    fn look(
        tree: &PhotonTree,
        point: DVec3,
        cap: f64,
        keeps: &dyn Fn(&Photon) -> bool,
        first: Option<usize>,
    ) -> Option<Self> {
        let mut near = Near { accepted: Vec::new(), rejected: Vec::new() };
        let mut take = |neighbors: Neighbors<'_>| {
            for (_, place) in neighbors.places() {
                let photon = tree.photon(place);
                let squared = photon.position.distance_squared(point);
                if keeps(&photon) {
                    near.accepted.push((squared, photon));
                } else {
                    near.rejected.push(squared);
                }
            }
        };
        match first {
            None => tree.within(point, cap, &mut take),
            Some(n) => {
                if tree.nearest(point, n, cap, Counted::UpToKth, &mut take) == Nearest::Underfull {
                    return None;
                }
            }
        }
        near.accepted.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(near)
    }

    /// The squared distance of the k-th accepted photon, or, if k of them are at the point itself, of the next one
    /// out; and how many are at the point then.
    fn shell(&self, k: usize) -> Option<(f64, usize)> {
        if planted(Fault::RejectedSetRadius) {
            let mut all: Vec<f64> =
                self.accepted.iter().map(|a| a.0).chain(self.rejected.iter().copied()).collect();
            all.sort_by(f64::total_cmp);
            return all.get(k - 1).map(|kth| (*kth, 0));
        }
        let kth = self.accepted.get(k - 1)?.0;
        if kth > 0.0 {
            return Some((kth, 0));
        }
        let here = self.accepted.partition_point(|(squared, _)| *squared == 0.0);
        Some((self.accepted.get(here)?.0, here))
    }

    /// The gather through the k-th accepted photon.
    fn through(self, k: usize, counted: Counted) -> Option<Accepted> {
        let (squared, coincident) = self.shell(k)?;
        let closer = self.accepted.partition_point(|(s, _)| *s < squared);
        let found = self.accepted.partition_point(|(s, _)| *s <= squared);
        let nearer = if coincident > 0 { closer } else { k - 1 };
        let counts = nearer + usize::from(counted == Counted::UpToKth);
        let share = (counts - closer) as f64 / (found - closer) as f64;
        let rejected = self.rejected.iter().filter(|s| **s <= squared).count();
        let of =
            |(index, (_, photon)): (usize, (f64, Photon))| (photon, if index < closer { 1.0 } else { share });
        let photons = self.accepted.into_iter().take(found).enumerate().map(of).collect();
        let ball = Ball { radius: squared.sqrt(), found, underfull: false, coincident };
        Some(Accepted { photons, ball, rejected })
    }
}

/// The accepted photons of a gather: all within a radius, or the k nearest of them.
///
/// The k nearest are looked for among the 5k/2 nearest photons of any kind, since a wall rejects half, then 5k, and so
/// on, until k accepted ones are among them: all that are nearer than the farthest one looked at have then been seen.
pub(super) fn accepted(
    tree: &PhotonTree,
    point: DVec3,
    gather: Gather,
    keeps: &dyn Fn(&Photon) -> bool,
) -> Accepted {
    let cap = gather.cap();
    let (k, counted) = match gather {
        Gather::Radius(_) => (None, Counted::BelowKth),
        Gather::Nearest { k, .. } => (Some(k.get()), Counted::BelowKth),
        Gather::NearestBiased { k, .. } => (Some(k.get()), Counted::UpToKth),
    };
    if let Some(k) = k {
        let mut first = k + k / 4;
        loop {
            first *= 2;
            let near = Near::look(tree, point, cap, keeps, Some(first));
            let is_all = near.is_none();
            let near = near.or_else(|| Near::look(tree, point, cap, keeps, None));
            if let Some(found) = near.and_then(|near| near.through(k, counted)) {
                return found;
            }
            if is_all {
                break;
            }
        }
    }
    let near = Near::look(tree, point, cap, keeps, None);
    let (photons, rejected) = near.map_or((Vec::new(), 0), |near| {
        (near.accepted.into_iter().map(|(_, photon)| (photon, 1.0)).collect(), near.rejected.len())
    });
    let ball = Ball { radius: cap, found: photons.len(), underfull: k.is_some(), coincident: 0 };
    Accepted { photons, ball, rejected }
}
