//! Levels of boxes, sixteen wide, above the blocks.

use super::{BLOCK, Positions};
use wide::f32x16;

/// Sixteen boxes as arrays. Places without a box hold one that is infinitely far away.
#[derive(Debug, Clone)]
pub(super) struct Boxes {
    lower: [f32x16; 3],
    upper: [f32x16; 3],
}

/// A query point, once a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    at: [f32x16; 3],
}

impl Probe {
    pub(super) fn new(point: [f32; 3]) -> Self {
        Probe { at: point.map(f32x16::splat) }
    }

    /// Squared distances to the sixteen positions of a block.
    #[inline(always)]
    pub(super) fn squared_distances(&self, positions: &Positions) -> f32x16 {
        let x = positions[0] - self.at[0];
        let y = positions[1] - self.at[1];
        let z = positions[2] - self.at[2];
        x * x + y * y + z * z
    }

    /// Squared distances to sixteen boxes.
    ///
    /// Rounding is monotone and the operations are those of [`Probe::squared_distances`] in the same order, so
    /// this is never above the squared distance of a photon inside the box, not even by rounding.
    #[inline(always)]
    pub(super) fn squared_distances_to_boxes(&self, boxes: &Boxes) -> f32x16 {
        let along = |axis: usize| {
            let outside = (boxes.lower[axis] - self.at[axis]).fast_max(self.at[axis] - boxes.upper[axis]);
            outside.fast_max(f32x16::ZERO)
        };
        let (x, y, z) = (along(0), along(1), along(2));
        x * x + y * y + z * z
    }

    /// The boxes that touch the ball of squared radius `r2`, a bit each.
    #[inline(always)]
    pub(super) fn touched(&self, boxes: &Boxes, r2: f32x16) -> u32 {
        self.squared_distances_to_boxes(boxes).simd_le(r2).to_bitmask()
    }
}

/// A box while it is being filled.
#[derive(Clone, Copy)]
struct Extent {
    lower: [f32; 3],
    upper: [f32; 3],
}

impl Extent {
    const NONE: Extent = Extent { lower: [f32::INFINITY; 3], upper: [f32::INFINITY; 3] };

    fn of_block(positions: &Positions, stored: usize) -> Extent {
        let bound = |axis: usize, better: fn(f32, f32) -> f32| {
            positions[axis].as_array()[..stored].iter().copied().reduce(better).unwrap_or(f32::INFINITY)
        };
        Extent { lower: [0, 1, 2].map(|a| bound(a, f32::min)), upper: [0, 1, 2].map(|a| bound(a, f32::max)) }
    }

    fn union(self, other: Extent) -> Extent {
        Extent {
            lower: [0, 1, 2].map(|a| self.lower[a].min(other.lower[a])),
            upper: [0, 1, 2].map(|a| self.upper[a].max(other.upper[a])),
        }
    }
}

/// The levels over the blocks, finest first: level 0 holds the boxes of blocks, the last level is one node.
pub(super) fn levels(positions: &[Positions], stored: usize) -> Vec<Vec<Boxes>> {
    let mut extents: Vec<Extent> = positions
        .iter()
        .enumerate()
        .map(|(block, positions)| Extent::of_block(positions, (stored - block * BLOCK).min(BLOCK)))
        .collect();
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
    Boxes {
        lower: [0, 1, 2].map(|axis| f32x16::new(sixteen.map(|e| e.lower[axis]))),
        upper: [0, 1, 2].map(|axis| f32x16::new(sixteen.map(|e| e.upper[axis]))),
    }
}
