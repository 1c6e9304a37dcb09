//! Every photon within a fixed radius: boxes that touch the ball, then one masked pass a block; no list is kept.

use super::boxes::Probe;
use super::scratch::{Scratch, with_scratch};
use super::units::LIMIT;
use super::{BLOCK, PhotonTree, ROW, Row};
use glam::DVec3;
use wide::f32x8;

/// Photons of one row that a search found.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a> {
    pub(super) tree: &'a PhotonTree,
    pub(super) row: usize,
    pub(super) squared: f32x8,
    pub(super) inverse_r2: f32,
    pub(super) inside: f32x8,
    pub(super) share: f32,
}

impl<'a> Neighbors<'a> {
    /// Squared distances over the squared radius, at most 1. Lanes that were not found mean nothing.
    #[inline(always)]
    pub fn u2(&self) -> f32x8 {
        (self.squared * f32x8::splat(self.inverse_r2)).fast_min(f32x8::ONE)
    }

    /// Which lanes were found: all bits set, or none.
    #[inline(always)]
    pub fn inside(&self) -> f32x8 {
        self.inside
    }

    /// The part of each photon that counts: 1, but for photons that tie with the k-th ([`PhotonTree::nearest`]).
    #[inline(always)]
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Powers [W], an array a channel.
    #[inline(always)]
    pub fn power(&self) -> &'a Row {
        &self.tree.powers[self.row]
    }

    /// Directions of travel, an array a coordinate.
    #[inline(always)]
    pub fn dir(&self) -> &'a Row {
        &self.tree.dirs[self.row]
    }

    /// Lanes found, each with its photon's place in the tree's order ([`PhotonTree::photon`]).
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (first, mask) = (self.row * ROW, self.inside.to_bitmask());
        bits(mask).map(move |lane| (lane, first + lane))
    }
}

/// What a search does with the photons it finds. Closures are visitors.
pub trait Visit {
    /// Takes the photons of one row.
    fn visit(&mut self, neighbors: Neighbors<'_>);
}

impl<F: FnMut(Neighbors<'_>)> Visit for F {
    #[inline(always)]
    fn visit(&mut self, neighbors: Neighbors<'_>) {
        self(neighbors);
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
    #[inline(always)]
    pub fn within(&self, centre: DVec3, radius: f64, visitor: &mut impl Visit) {
        let point = self.units.relative(centre);
        let r = self.units.shrink(radius);
        if r > LIMIT {
            self.within_point(centre, radius, visitor);
        } else if point.abs().max_element() <= 4.0 * LIMIT {
            let r2 = ((r * r) as f32).max((1.0 / (LIMIT * LIMIT)) as f32);
            let inverse_r2 = 1.0 / r2;
            let probe = Probe::new(point.as_vec3().to_array());
            with_scratch(|scratch| {
                self.touch(&probe, r2, scratch);
                for &block in &scratch.touched {
                    for row in rows(block) {
                        let squared = probe.squared_distances(&self.positions[row]);
                        let inside = squared.simd_le(f32x8::splat(r2));
                        if inside.any() {
                            visitor.visit(Neighbors {
                                tree: self,
                                row,
                                squared,
                                inverse_r2,
                                inside,
                                share: 1.0,
                            });
                        }
                    }
                }
            });
        }
    }

    /// The whole map at one distance from `centre`, which a radius of 2^60 times the map cannot tell from it.
    #[cold]
    fn within_point(&self, centre: DVec3, radius: f64, visitor: &mut dyn Visit) {
        let u2 = ((centre - self.units.absolute([0.0; 3])) / radius).length_squared();
        if u2 <= 1.0 {
            for (row, squared) in self.all_at(u2 as f32) {
                let inside = squared.simd_le(f32x8::ONE);
                visitor.visit(Neighbors { tree: self, row, squared, inverse_r2: 1.0, inside, share: 1.0 });
            }
        }
    }

    /// Every row with photons, as though all were at the same squared distance, padding still beyond it.
    pub(super) fn all_at(&self, squared: f32) -> impl Iterator<Item = (usize, f32x8)> + '_ {
        (0..self.stored.div_ceil(ROW)).map(move |row| {
            let stored = (self.stored - row * ROW).min(ROW);
            let mut lanes = [f32::INFINITY; ROW];
            lanes[..stored].fill(squared);
            (row, f32x8::new(lanes))
        })
    }

    /// Lists the blocks whose boxes touch the ball of squared radius `r2`, in the tree's order.
    pub(super) fn touch(&self, probe: &Probe, r2: f32, scratch: &mut Scratch) {
        let Scratch { touched, parents, .. } = scratch;
        touched.clear();
        touched.extend((!self.levels.is_empty()).then_some(0));
        for level in self.levels.iter().rev() {
            std::mem::swap(touched, parents);
            touched.clear();
            for &node in parents.iter() {
                // Sixteen places are kept ready, so that a child costs no growth check.
                let mut mask = probe.touched(&level[node as usize], r2);
                let mut end = touched.len();
                touched.resize(end + 16, 0);
                while mask != 0 {
                    touched[end] = node * 16 + mask.trailing_zeros();
                    mask &= mask - 1;
                    end += 1;
                }
                touched.truncate(end);
            }
        }
    }
}

/// The rows of a block.
#[inline(always)]
pub(super) fn rows(block: u32) -> std::ops::Range<usize> {
    let first = block as usize * (BLOCK / ROW);
    first..first + BLOCK / ROW
}
