//! What the maps say.

use crate::setups::uncollided::{Case, Query};
use crate::theory::Curve;
use turbid::stats::Moments;

/// One question, size and radius with what was measured.
pub struct Point {
    /// Who asks.
    pub query: Query,
    /// Photons of a map.
    pub photons: u64,
    /// Radius [mfp].
    pub radius: f64,
    /// What was predicted.
    pub theory: Case,
    /// Relative error of each cell.
    pub errors: Vec<f64>,
    /// Mean squared error of each cell.
    pub squares: Vec<f64>,
    /// CPU seconds of one question, by cell.
    pub seconds: Moments,
}

impl Point {
    /// Mean squared error over all cells.
    pub fn squared(&self) -> Moments {
        self.squares.iter().collect()
    }

    /// Mean squared deviation from the predicted mean, by cell.
    pub fn deviations(&self) -> Vec<f64> {
        let blur = self.theory.blur;
        self.errors
            .iter()
            .zip(&self.squares)
            .map(|(e, square)| square - 2.0 * blur * e + blur * blur)
            .collect()
    }
}

/// One kind of question at the best radius for each size.
pub struct Answer {
    /// Who asks.
    pub query: Query,
    /// Its errors.
    pub curve: Curve,
    /// CPU seconds of one question at the best radius of each size.
    pub seconds: Vec<Moments>,
    /// CPU seconds of a map of each size.
    pub filling: Vec<f64>,
}

/// Rays of a small picture, over which a map's own time is shared.
pub const PICTURE: f64 = 10_000.0;

impl Answer {
    /// CPU seconds of a map and the rays of a small picture, for each size.
    pub fn picture(&self) -> Vec<f64> {
        self.seconds.iter().zip(&self.filling).map(|(ray, map)| map + PICTURE * ray.mean()).collect()
    }
}

/// The points of one kind of question and size, in the order of radii.
pub fn ladder(points: &[Point], query: Query, photons: u64) -> Vec<&Point> {
    points.iter().filter(|p| p.query == query && p.photons == photons).collect()
}
