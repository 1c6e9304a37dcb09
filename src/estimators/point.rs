//! Sums over the photons about a point.

use super::{CosinePairs, Directional, Gather, Kernel};
use crate::faults::{Fault, planted, size};
use crate::photons::tree::{Nearest, Neighbors, Visit};
use crate::photons::{Photon, PhotonMap, PhotonTree};
use crate::spectrum::Spectrum;
use glam::DVec3;
use wide::f32x8;

/// An estimate, and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The estimate by channel.
    pub value: Spectrum,
    /// Radius of the ball \[L\].
    pub radius: f64,
    /// Photons in the ball that count, those on its surface included.
    pub found: usize,
    /// Whether fewer than k photons were within the cap, so that the ball is the cap.
    pub underfull: bool,
    /// Photons at the point itself if they were k or more, so that the ball reaches to the next one out; else
    /// 0.
    pub coincident: usize,
    /// Photons in the ball that do not count, since they are of another medium, hidden by a body, or rejected behind a wall.
    pub rejected: usize,
}

impl Estimate {
    pub(super) fn new(map: &PhotonMap, BallSum { sum, ball }: BallSum, rejected: usize) -> Self {
        let Ball { radius, found, underfull, coincident } = ball;
        let value = sum / map.emitted() as f64;
        Estimate { value, radius, found, underfull, coincident, rejected }
    }
}

/// The ball that a gather chose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Radius \[L\].
    pub radius: f64,
    /// Photons in the ball, those on its surface included.
    pub found: usize,
    /// Whether fewer than k photons were within the cap, so that the ball is the cap.
    pub underfull: bool,
    /// Photons at the point itself if they were k or more, so that the ball reaches to the next one out; else
    /// 0.
    pub coincident: usize,
}

/// A raw sum over a ball: divided by nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallSum {
    /// Sum of power x K_r [W/L^3], as though every history were the only one emitted.
    pub sum: Spectrum,
    /// The ball.
    pub ball: Ball,
}

/// Sum of power x phase x K_r over the gathered photons [W/(L^3 sr)], divided by nothing.
pub(super) fn in_scattered_sum(
    map: &PhotonMap,
    point: DVec3,
    wo: DVec3,
    phase: &impl Directional,
    kernel: Kernel,
    gather: Gather,
) -> BallSum {
    let wo = wo.as_vec3().to_array();
    weighted_sum(map, point, kernel, gather, |neighbors| {
        phase.values(CosinePairs { dir: neighbors.dir(), wo, inside: neighbors.inside() })
    })
}

/// Sum of power x K_r over the gathered photons [W/L^3], divided by nothing.
pub fn ball_sum(map: &PhotonMap, point: DVec3, kernel: Kernel, gather: Gather) -> BallSum {
    weighted_sum(map, point, kernel, gather, |_| f32x8::ONE)
}

/// Number of photons at most `radius` \[L\] from a point; 0 where a periodic cell has no copies that far ([`PhotonMap::place`]).
pub fn count_within(map: &PhotonMap, point: DVec3, radius: f64) -> usize {
    let mut count = 0;
    map.tree().within(map.place(point, radius), radius, &mut |neighbors: Neighbors<'_>| {
        count += number(&neighbors)
    });
    count
}

/// Visits each photon of the gather with its weight K(u) in units of 1/radius^3, for sums that none of the
/// other functions makes: sum weight x ... / radius^3 is an estimate of the same kind. Slower than they are.
pub fn for_each_photon(
    map: &PhotonMap,
    point: DVec3,
    kernel: Kernel,
    gather: Gather,
    mut visit: impl FnMut(Photon, f64),
) -> Ball {
    let (tree, point) = (map.tree(), map.place(point, gather.cap()));
    gathered(tree, point, gather, &mut |neighbors: Neighbors<'_>| {
        let u2 = neighbors.u2().to_array();
        let scale = kernel.peak() * f64::from(neighbors.share());
        for (lane, place) in neighbors.places() {
            visit(tree.photon(place), scale * kernel.profile(f64::from(u2[lane])));
        }
    })
}

/// How many of a row were found.
#[inline(always)]
pub(super) fn number(neighbors: &Neighbors<'_>) -> usize {
    neighbors.inside().to_bitmask().count_ones() as usize
}

/// Sum of power x K_r x weight.
#[inline(always)]
fn weighted_sum(
    map: &PhotonMap,
    point: DVec3,
    kernel: Kernel,
    gather: Gather,
    weight: impl Fn(&Neighbors<'_>) -> f32x8,
) -> BallSum {
    let mut sum = Weighted { kernel, weight, sum: LaneSum::default() };
    let point = map.place(point, gather.cap());
    let ball = gathered(map.tree(), point, gather, &mut sum);
    // No photon is near a point that is not finite; that is no darkness.
    let nowhere = if point.is_finite() { 0.0 } else { f64::NAN };
    let r = ball.radius;
    let peak = if planted(Fault::KernelRaised) { kernel.peak() * (1.0 + size()) } else { kernel.peak() };
    BallSum { sum: (sum.sum.total() + Spectrum::grey(nowhere)) * peak / (r * r * r), ball }
}

/// Visits the photons of a gather.
#[inline(always)]
fn gathered(tree: &PhotonTree, point: DVec3, gather: Gather, visitor: &mut impl Visit) -> Ball {
    let (k, cap, counted) = gather.rule();
    if let Some(k) = k
        && let Nearest::Found(shell) = tree.nearest(point, k.get(), cap, counted, visitor)
    {
        let found = shell.closer + shell.tied;
        return Ball { radius: shell.radius, found, underfull: false, coincident: shell.coincident };
    }
    let mut counting = Counting { found: 0, visitor };
    tree.within(point, cap, &mut counting);
    Ball { radius: cap, found: counting.found, underfull: k.is_some(), coincident: 0 }
}

/// A visitor that also counts.
pub(super) struct Counting<'v, V> {
    pub(super) found: usize,
    pub(super) visitor: &'v mut V,
}

impl<V: Visit> Visit for Counting<'_, V> {
    #[inline(always)]
    fn visit(&mut self, neighbors: Neighbors<'_>) {
        self.found += number(&neighbors);
        self.visitor.visit(neighbors);
    }
}

/// The sum while photons are found.
pub(super) struct Weighted<W> {
    pub(super) kernel: Kernel,
    pub(super) weight: W,
    pub(super) sum: LaneSum,
}

impl<W: Fn(&Neighbors<'_>) -> f32x8> Visit for Weighted<W> {
    #[inline(always)]
    fn visit(&mut self, neighbors: Neighbors<'_>) {
        let share = f32x8::splat(neighbors.share());
        let profile = match self.kernel {
            Kernel::Uniform => share,
            kernel => kernel.profiles(neighbors.u2()) * share,
        };
        self.sum.add(neighbors.inside() & (profile * (self.weight)(&neighbors)), neighbors.power());
    }
}

/// A sum that does not stall: a few rows in single precision lanes, everything else in f64.
pub(super) struct LaneSum {
    lanes: [f32x8; 3],
    rows: u32,
    total: Spectrum,
}

impl Default for LaneSum {
    fn default() -> Self {
        LaneSum { lanes: [f32x8::ZERO; 3], rows: 0, total: Spectrum::ZERO }
    }
}

impl LaneSum {
    /// Rows a lane adds up before it is emptied: its relative error stays below 32 x 2^-24 = 2e-6 at worst
    /// and a tenth of that as a rule, far below the noise of 8 photons a row.
    const ROWS: u32 = 32;

    #[inline(always)]
    pub(super) fn add(&mut self, weight: f32x8, power: &[f32x8; 3]) {
        self.add_each([weight; 3], power);
    }

    /// The same with a weight for each channel.
    #[inline(always)]
    pub(super) fn add_each(&mut self, weights: [f32x8; 3], power: &[f32x8; 3]) {
        for (lanes, (weight, power)) in self.lanes.iter_mut().zip(weights.into_iter().zip(power)) {
            *lanes += weight * *power;
        }
        self.rows += 1;
        if self.rows == Self::ROWS {
            self.empty();
        }
    }

    fn empty(&mut self) {
        let channel = |lanes: &f32x8| lanes.as_array().iter().fold(0.0, |sum, &lane| sum + f64::from(lane));
        self.total +=
            Spectrum::rgb(channel(&self.lanes[0]), channel(&self.lanes[1]), channel(&self.lanes[2]));
        self.lanes = [f32x8::ZERO; 3];
        self.rows = 0;
    }

    pub(super) fn total(mut self) -> Spectrum {
        self.empty();
        self.total
    }
}
