//! Every photon within a fixed radius: boxes that touch the ball, then one masked pass a block; no list is kept.

use super::boxes::Probe;
use super::units::LIMIT;
use super::{BLOCK, PhotonTree};
use glam::DVec3;
use wide::f32x16;

/// Photons of one block that a search found.
#[derive(Debug)]
pub struct Neighbors<'a> {
    tree: &'a PhotonTree,
    block: usize,
    squared: f32x16,
    inverse_r2: f32x16,
    inside: f32x16,
    share: f32,
}

impl<'a> Neighbors<'a> {
    #[inline(always)]
    pub(super) fn new(
        tree: &'a PhotonTree,
        block: usize,
        squared: f32x16,
        inverse_r2: f32x16,
        inside: f32x16,
        share: f32,
    ) -> Self {
        Neighbors { tree, block, squared, inverse_r2, inside, share }
    }

    /// Squared distances over the squared radius, at most 1. Lanes that were not found mean nothing.
    #[inline(always)]
    pub fn u2(&self) -> f32x16 {
        (self.squared * self.inverse_r2).fast_min(f32x16::ONE)
    }

    /// Which lanes were found: all bits set, or none.
    #[inline(always)]
    pub fn inside(&self) -> f32x16 {
        self.inside
    }

    /// The part of each photon that counts: 1, but for photons that tie with the k-th ([`PhotonTree::nearest`]).
    #[inline(always)]
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Powers [W], an array a channel.
    #[inline(always)]
    pub fn power(&self) -> &'a [f32x16; 3] {
        &self.tree.powers[self.block]
    }

    /// Directions of travel, an array a coordinate.
    #[inline(always)]
    pub fn dir(&self) -> &'a [f32x16; 3] {
        &self.tree.dirs[self.block]
    }

    /// Lanes found, each with its photon's place in the tree's order ([`PhotonTree::photon`]).
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (first, mask) = (self.block * BLOCK, self.inside.to_bitmask());
        bits(mask).map(move |lane| (lane, first + lane))
    }
}

/// The set bits of a mask, lowest first.
#[inline(always)]
pub(crate) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            bit
        })
    })
}

impl PhotonTree {
    /// Visits every photon at most `radius` [L] from `centre`, by blocks, in the tree's order; a photon exactly
    /// at `radius` is inside. `radius` is above zero.
    ///
    /// Distances below 2^-60 of the map's box count as zero, and a radius above 2^60 of it sees the map as one
    /// point.
    pub fn within(&self, centre: DVec3, radius: f64, mut visit: impl FnMut(Neighbors<'_>)) {
        let point = self.units.relative(centre);
        let r = self.units.shrink(radius);
        if r > LIMIT {
            self.within_point(centre, radius, visit);
        } else if point.abs().max_element() <= 4.0 * LIMIT {
            let r2 = ((r * r) as f32).max((1.0 / (LIMIT * LIMIT)) as f32);
            let (r2, inverse_r2) = (f32x16::splat(r2), f32x16::splat(1.0 / r2));
            let probe = Probe::new(point.as_vec3().to_array());
            self.touched_blocks(&probe, r2, &mut |block| {
                let squared = probe.squared_distances(&self.positions[block]);
                let inside = squared.simd_le(r2);
                if inside.any() {
                    visit(Neighbors::new(self, block, squared, inverse_r2, inside, 1.0));
                }
            });
        }
    }

    /// The whole map at one distance from `centre`, which a radius of 2^60 times the map cannot tell from it.
    fn within_point(&self, centre: DVec3, radius: f64, mut visit: impl FnMut(Neighbors<'_>)) {
        let u2 = ((centre - self.units.absolute([0.0; 3])) / radius).length_squared();
        if u2 <= 1.0 {
            for (block, squared) in self.all_at(u2 as f32) {
                let inside = squared.simd_le(f32x16::ONE);
                visit(Neighbors::new(self, block, squared, f32x16::ONE, inside, 1.0));
            }
        }
    }

    /// Every block, as though all photons were at the same squared distance, padding still beyond it.
    pub(super) fn all_at(&self, squared: f32) -> impl Iterator<Item = (usize, f32x16)> + '_ {
        (0..self.positions.len()).map(move |block| {
            let stored = (self.stored - block * BLOCK).min(BLOCK);
            let mut lanes = [f32::INFINITY; BLOCK];
            lanes[..stored].fill(squared);
            (block, f32x16::new(lanes))
        })
    }

    /// Visits the blocks whose boxes touch the ball of squared radius `r2`, in the tree's order.
    #[inline(always)]
    pub(super) fn touched_blocks(&self, probe: &Probe, r2: f32x16, visit: &mut impl FnMut(usize)) {
        if let Some(top) = self.levels.len().checked_sub(1) {
            self.descend(top, 0, probe, r2, visit);
        }
    }

    fn descend(&self, level: usize, node: usize, probe: &Probe, r2: f32x16, visit: &mut impl FnMut(usize)) {
        for child in bits(probe.touched(&self.levels[level][node], r2)) {
            let child = node * 16 + child;
            if level == 0 {
                visit(child);
            } else {
                self.descend(level - 1, child, probe, r2, visit);
            }
        }
    }
}
