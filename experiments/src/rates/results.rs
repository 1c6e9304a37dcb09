//! What the maps say.

use super::predict::Case;
use turbid::stats::Moments;

/// One size, depth and radius with what was measured.
pub struct Point {
    /// Photons of a map.
    pub photons: u64,
    /// Depth [mfp].
    pub depth: f64,
    /// Radius [mfp].
    pub radius: f64,
    /// What was predicted.
    pub theory: Case,
    /// Relative error of each cell.
    pub errors: Vec<f64>,
    /// Mean squared error of each cell.
    pub squares: Vec<f64>,
}

impl Point {
    /// Mean squared error over all cells.
    pub fn squared(&self) -> Moments {
        self.squares.iter().collect()
    }
}

/// The points of one size and depth, in the order of radii.
pub fn ladder(points: &[Point], photons: u64, depth: f64) -> Vec<&Point> {
    points.iter().filter(|p| p.photons == photons && p.depth == depth).collect()
}
