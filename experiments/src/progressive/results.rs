//! What the sequences say.

use super::cases::Schedule;
use super::predict::Expected;
use crate::harness::Estimate;
use crate::setups::uncollided::Query;
use turbid::stats::Moments;

/// One question by one schedule after so many maps.
pub struct Point {
    /// Who asks.
    pub query: Query,
    /// How radii go.
    pub schedule: Schedule,
    /// Maps so far.
    pub maps: u64,
    /// Radius in the last of them [mfp].
    pub radius: f64,
    /// What was predicted.
    pub theory: Expected,
    /// Relative error of each cell.
    pub errors: Vec<f64>,
    /// Mean squared error of each cell.
    pub squares: Vec<f64>,
    /// Part of the intervals that hold the exact value, by cell; none of one map.
    pub coverage: Vec<f64>,
}

impl Point {
    /// Mean squared error over all cells.
    pub fn squared(&self) -> Moments {
        self.squares.iter().collect()
    }
}

/// One kind of question.
pub struct Answer {
    /// Who asks.
    pub query: Query,
    /// Exponent of the mean squared error in the number of maps, from four maps on.
    pub exponent: Estimate,
    /// The same of the predicted one.
    pub theory: f64,
    /// Mean squared error after all maps over that of another schedule, from the same maps.
    pub over: Vec<(Schedule, Estimate, f64)>,
    /// Part of the intervals from the spread between all maps that hold the exact value, and what is predicted.
    pub coverage: (Estimate, f64),
}

/// The points of a question and schedule, in the order of the number of maps.
pub fn sequence(points: &[Point], query: Query, schedule: Schedule) -> Vec<&Point> {
    points.iter().filter(|p| p.query == query && p.schedule == schedule).collect()
}
