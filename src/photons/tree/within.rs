//! Every photon within a fixed radius: boxes that touch the ball, then one masked pass a block; no list is
//! kept.

use super::PhotonTree;
use super::block::{ROW, Row};
use super::boxes::{Boxes, Probe};
use super::scratch::{Scratch, with_scratch};
use super::units::LIMIT;
use glam::DVec3;
use wide::f32x8;

/// Photons of one row that a search found.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a> {
    pub(super) tree: &'a PhotonTree,
    pub(super) row: usize,
    pub(super) u2: f32x8,
    pub(super) inside: f32x8,
    pub(super) share: f32,
}

impl<'a> Neighbors<'a> {
    /// Squared distances over the squared radius, at most 1. Lanes that were not found mean nothing.
    #[inline(always)]
    pub fn u2(&self) -> f32x8 {
        self.u2
    }

    /// Which lanes were found: all bits set, or none.
    #[inline(always)]
    pub fn inside(&self) -> f32x8 {
        self.inside
    }

    /// The part of each photon that counts: 1, but for photons that tie with the k-th
    /// ([`PhotonTree::nearest`]).
    #[inline(always)]
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Powers \[W\], an array a channel.
    #[inline(always)]
    pub fn power(&self) -> &'a Row {
        &self.tree.powers[self.row]
    }

    /// Directions of travel, an array a coordinate.
    #[inline(always)]
    pub fn dir(&self) -> &'a Row {
        &self.tree.dirs[self.row]
    }

    /// Positions relative to the middle of the map, in its unit, an array a coordinate.
    #[inline(always)]
    pub(crate) fn positions(&self) -> &'a Row {
        &self.tree.positions[self.row / 2][self.row % 2]
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

/// The set bits of each number of four bits, lowest first, and how many they are.
const SET_BITS: [([u32; 4], usize); 16] = set_bits();

const fn set_bits() -> [([u32; 4], usize); 16] {
    let mut table = [([0; 4], 0); 16];
    let mut number = 0;
    while number < 16 {
        let mut bit = 0;
        while bit < 4 {
            if number >> bit & 1 == 1 {
                table[number].0[table[number].1] = bit;
                table[number].1 += 1;
            }
            bit += 1;
        }
        number += 1;
    }
    table
}

impl PhotonTree {
    /// The photons of a row that are `inside`, of squared distances and the inverse of the squared radius, over which rounding leaves none
    /// above 1.
    #[inline(always)]
    pub(super) fn neighbors(
        &self,
        row: usize,
        (squared, inverse_r2): (f32x8, f32),
        inside: f32x8,
        share: f32,
    ) -> Neighbors<'_> {
        let u2 = (squared * f32x8::splat(inverse_r2)).fast_min(f32x8::ONE);
        Neighbors { tree: self, row, u2, inside, share }
    }

    /// Visits every photon at most `radius` \[L\] from `centre`, by blocks, in the tree's order; a photon
    /// exactly at `radius` is inside. `radius` is above zero.
    ///
    /// Distances below 2^-60 of the map's box count as zero, and a radius above 2^60 of it sees the map as
    /// one point.
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
                scratch.measure(self, |positions| probe.squared_distances(positions), r2);
                for (&row, &squared) in scratch.rows[..scratch.end].iter().zip(&scratch.squared) {
                    let inside = squared.simd_le(f32x8::splat(r2));
                    visitor.visit(self.neighbors(row as usize, (squared, inverse_r2), inside, 1.0));
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
                visitor.visit(self.neighbors(row, (squared, 1.0), inside, 1.0));
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
        self.descend(|boxes| probe.touched(boxes, r2), scratch);
    }

    /// Lists the blocks whose boxes are accepted, a bit each, in the tree's order.
    #[inline(always)]
    pub(super) fn descend(&self, accepted: impl Fn(&Boxes) -> u32, scratch: &mut Scratch) {
        let Scratch { touched, parents, .. } = scratch;
        touched.clear();
        touched.extend((!self.levels.is_empty()).then_some(0));
        for level in self.levels.iter().rev() {
            std::mem::swap(touched, parents);
            // Four places beyond what can count, since children are written four by four, whether they count
            // or not: no branch to mispredict.
            touched.clear();
            touched.resize(parents.len() * 16 + 4, 0);
            let mut end = 0;
            for &node in parents.iter() {
                let mask = accepted(&level[node as usize]) as usize;
                for first in [0, 4, 8, 12] {
                    let (set, count) = SET_BITS[mask >> first & 15];
                    for (child, bit) in touched[end..end + 4].iter_mut().zip(set) {
                        *child = node * 16 + first as u32 + bit;
                    }
                    end += count;
                }
            }
            touched.truncate(end);
        }
    }
}

impl Scratch {
    /// Lists the rows of the touched blocks that have photons whose squared distance is at most `r2`, with these distances.
    ///
    /// Every row is written and only those that count are kept: no branch to mispredict.
    #[inline(always)]
    pub(super) fn measure(&mut self, tree: &PhotonTree, distances: impl Fn(&Row) -> f32x8, r2: f32) {
        let most = self.touched.len() * 2 + 1;
        if self.rows.len() < most {
            self.rows.resize(most, 0);
            self.squared.resize(most, f32x8::ZERO);
        }
        let (rows, squared) = (&mut self.rows[..most], &mut self.squared[..most]);
        let mut end = 0;
        for &block in &self.touched {
            for (half, positions) in tree.positions[block as usize].iter().enumerate() {
                let distances = distances(positions);
                rows[end] = 2 * block + half as u32;
                squared[end] = distances;
                end += usize::from(distances.simd_le(f32x8::splat(r2)).to_bitmask() != 0);
            }
        }
        self.end = end;
    }
}
