//! Blocks and rows of photons.

use wide::f32x8;

/// Photons in a block: two rows of eight, what the registers of every processor hold without spilling.
pub(super) const BLOCK: usize = 16;

/// Photons in a row, and lanes of its arrays.
pub const ROW: usize = 8;

/// Eight vectors, an array a coordinate.
pub(in crate::photons) type Row = [f32x8; 3];

#[inline(always)]
pub(in crate::photons) fn cross(a: &Row, b: &Row) -> Row {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(in crate::photons) fn dot(a: &Row, b: &Row) -> f32x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
