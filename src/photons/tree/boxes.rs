//! Levels of boxes, sixteen wide, above the blocks.

use super::block::{BLOCK, ROW, Row};
use wide::f32x8;

/// Sixteen boxes as arrays, in two rows of eight. Places without a box hold one that is infinitely far away.
#[derive(Debug, Clone)]
pub(in crate::photons) struct Boxes {
    pub(super) rows: [[Row; 2]; 2],
}

/// A query point in the tree's units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    at: [f32; 3],
}

impl Probe {
    pub(super) fn new(point: [f32; 3]) -> Self {
        Probe { at: point }
    }

    /// Squared distances to eight positions.
    #[inline(always)]
    pub(super) fn squared_distances(&self, positions: &Row) -> f32x8 {
        let x = positions[0] - f32x8::splat(self.at[0]);
        let y = positions[1] - f32x8::splat(self.at[1]);
        let z = positions[2] - f32x8::splat(self.at[2]);
        x * x + y * y + z * z
    }

    /// Ways from the point to eight positions.
    #[inline(always)]
    pub(super) fn offsets(&self, positions: &Row) -> Row {
        [0, 1, 2].map(|axis| positions[axis] - f32x8::splat(self.at[axis]))
    }

    /// Squared distances to eight boxes.
    ///
    /// Rounding is monotone and the operations are those of [`Probe::squared_distances`] in the same order,
    /// so this is never above the squared distance of a photon inside the box, not even by rounding.
    #[inline(always)]
    fn squared_distances_to_row(&self, [lower, upper]: &[Row; 2]) -> f32x8 {
        let along = |axis: usize| {
            let at = f32x8::splat(self.at[axis]);
            (lower[axis] - at).fast_max(at - upper[axis]).fast_max(f32x8::ZERO)
        };
        let (x, y, z) = (along(0), along(1), along(2));
        x * x + y * y + z * z
    }

    /// Squared distances to sixteen boxes.
    pub(super) fn squared_distances_to_boxes(&self, boxes: &Boxes) -> [f32; 16] {
        let mut squared = [0.0; 16];
        squared[..8].copy_from_slice(&self.squared_distances_to_row(&boxes.rows[0]).to_array());
        squared[8..].copy_from_slice(&self.squared_distances_to_row(&boxes.rows[1]).to_array());
        squared
    }

    /// The boxes that touch the ball of squared radius `r2`, a bit each.
    #[inline(always)]
    pub(super) fn touched(&self, boxes: &Boxes, r2: f32) -> u32 {
        let row = |row: &[Row; 2]| self.squared_distances_to_row(row).simd_le(f32x8::splat(r2)).to_bitmask();
        row(&boxes.rows[0]) | row(&boxes.rows[1]) << 8
    }
}

/// A box while it is being filled.
#[derive(Clone, Copy)]
pub(in crate::photons) struct Extent {
    pub(in crate::photons) lower: [f32; 3],
    pub(in crate::photons) upper: [f32; 3],
}

impl Extent {
    /// No box, infinitely far away.
    const NONE: Extent = Extent { lower: [f32::INFINITY; 3], upper: [f32::INFINITY; 3] };

    /// The box of the first `stored` positions of a block.
    fn of_block(rows: &[Row; 2], stored: usize) -> Extent {
        let at = |lane: usize| [0, 1, 2].map(|axis| rows[lane / ROW][axis].as_array()[lane % ROW]);
        let mut extent = Extent { lower: at(0), upper: at(0) };
        for lane in 1..stored {
            extent = extent.union(Extent { lower: at(lane), upper: at(lane) });
        }
        extent
    }

    pub(in crate::photons) fn union(self, other: Extent) -> Extent {
        let mut union = self;
        for axis in 0..3 {
            if other.lower[axis] < union.lower[axis] {
                union.lower[axis] = other.lower[axis];
            }
            if other.upper[axis] > union.upper[axis] {
                union.upper[axis] = other.upper[axis];
            }
        }
        union
    }
}

/// The levels over the blocks, finest first: level 0 holds the boxes of blocks, the last level is one node.
pub(super) fn levels(blocks: &[[Row; 2]], stored: usize) -> Vec<Vec<Boxes>> {
    let extent =
        |(block, rows): (usize, &[Row; 2])| Extent::of_block(rows, (stored - block * BLOCK).min(BLOCK));
    levels_of(blocks.iter().enumerate().map(extent).collect())
}

/// The levels over boxes, finest first: level 0 holds those boxes, the last level is one node.
pub(in crate::photons) fn levels_of(mut extents: Vec<Extent>) -> Vec<Vec<Boxes>> {
    let mut levels = Vec::new();
    while !extents.is_empty() {
        levels.push(extents.chunks(16).map(pack).collect::<Vec<_>>());
        if extents.len() <= 16 {
            break;
        }
        extents =
            extents.chunks(16).filter_map(|group| group.iter().copied().reduce(Extent::union)).collect();
    }
    levels
}

fn pack(extents: &[Extent]) -> Boxes {
    let mut sixteen = [Extent::NONE; 16];
    sixteen[..extents.len()].copy_from_slice(extents);
    let row = |first: usize, bound: fn(&Extent) -> [f32; 3]| {
        [0, 1, 2].map(|axis| f32x8::new(std::array::from_fn(|lane| bound(&sixteen[first + lane])[axis])))
    };
    Boxes { rows: [0, 8].map(|first| [row(first, |e| e.lower), row(first, |e| e.upper)]) }
}
