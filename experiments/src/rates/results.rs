//! What the maps say: points, and curves through them.

use super::predict::Case;
use crate::harness::Estimate;
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

/// Squared error against the number of photons along one rule for the radius.
pub struct Curve {
    /// Name in cases and claims.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: String,
    /// Place of the radius of each size in the ladder.
    pub chosen: Vec<usize>,
    /// Mean squared error of each size, over the cells that report it.
    pub measured: Vec<Moments>,
    /// What was predicted for these radii; for the best, at the radius that is best in theory.
    pub predicted: Vec<f64>,
    /// What no number of photons takes away; subtracted before the fit.
    pub floors: Vec<f64>,
    /// The exponent.
    pub exponent: Estimate,
    /// The one that the same fit finds in the predictions.
    pub theory: f64,
    /// What it tends to.
    pub limit: (f64, &'static str),
}

/// The points of one size and depth, in the order of radii.
pub fn ladder(points: &[Point], photons: u64, depth: f64) -> Vec<&Point> {
    points.iter().filter(|p| p.photons == photons && p.depth == depth).collect()
}
