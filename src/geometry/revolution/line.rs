//! A ray in the coordinates of a body of revolution.

use glam::DVec3;

/// The line of a ray in the axis' own coordinates, its origin moved to where it passes the body's middle.
pub(super) struct Line {
    pub(super) origin: DVec3,
    pub(super) dir: DVec3,
    /// How far along the ray the origin was moved \[L\].
    pub(super) shift: f64,
    /// Squared speed across the axis.
    pub(super) a: f64,
}
