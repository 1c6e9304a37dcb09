//! Pieces of beams, sixteen a group, in single precision.

use crate::photons::tree::{Cylinder, Row, cross, dot};
use glam::Vec3;
use wide::f32x8;

/// A piece of a beam in the tree's units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub middle: Vec3,
    pub dir: Vec3,
    /// Half its length.
    pub half: f32,
}

/// Sixteen pieces in two rows of eight; lanes without one are met by nothing.
#[derive(Debug)]
pub(super) struct Group {
    rows: [(Row, Row, f32x8); 2],
}

/// Pieces of a group.
pub(super) const GROUP: usize = 16;

impl Group {
    /// The group of at most sixteen pieces.
    pub fn new(stretches: &[Stretch]) -> Self {
        let row = |first: usize| {
            let lane = |lane: usize| stretches.get(first + lane);
            let vectors = |of: fn(&Stretch) -> Vec3| {
                [0, 1, 2]
                    .map(|axis| f32x8::new(std::array::from_fn(|i| lane(i).map_or(0.0, |s| of(s)[axis]))))
            };
            let half = |i: usize| lane(i).map_or(f32::NEG_INFINITY, |stretch| stretch.half);
            (vectors(|s| s.middle), vectors(|s| s.dir), f32x8::new(std::array::from_fn(half)))
        };
        Group { rows: [row(0), row(8)] }
    }

    /// Those that a ray may come nearest to within its cylinder, a bit each ([`Cylinder::near_lines`]).
    #[inline(always)]
    pub fn near(&self, cylinder: &Cylinder) -> u32 {
        let [low, high] = &self.rows;
        cylinder.near_lines(&low.0, &low.1, low.2) | cylinder.near_lines(&high.0, &high.1, high.2) << 8
    }

    /// Those that may come within a ray's cylinder, a bit each ([`Cylinder::touched_lines`]).
    #[inline(always)]
    pub fn touched(&self, cylinder: &Cylinder) -> u32 {
        let [low, high] = &self.rows;
        cylinder.touched_lines(&low.0, &low.1, low.2) | cylinder.touched_lines(&high.0, &high.1, high.2) << 8
    }

    /// Those that may come within a radius of a place in the tree's units, both with room for rounding, a bit each.
    #[inline(always)]
    pub fn about(&self, place: Vec3, radius: f32) -> u32 {
        let at = [f32x8::splat(place.x), f32x8::splat(place.y), f32x8::splat(place.z)];
        let radius = f32x8::splat(radius);
        let near = |(middles, dirs, halves): &(Row, Row, f32x8)| {
            let way = [middles[0] - at[0], middles[1] - at[1], middles[2] - at[2]];
            let away = cross(&way, dirs);
            let is_beside = dot(&away, &away).simd_le(radius * radius);
            (is_beside & dot(&way, dirs).abs().simd_le(*halves + radius)).to_bitmask()
        };
        near(&self.rows[0]) | near(&self.rows[1]) << 8
    }
}
