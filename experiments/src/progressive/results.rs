//! What the sequences say.

use super::cases::Schedule;
use super::predict::Expected;
use crate::harness::Estimate;
use crate::setups::uncollided::Query;
use turbid::stats::{Moments, poisson_interval};

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

    /// The part of the intervals that hold the exact value, over cells. Where all cells say the same, as after many maps whose blur stays,
    /// its error is that of a bound, never 0.
    pub fn held(&self) -> Estimate {
        let held: Moments = self.coverage.iter().collect();
        if held.std_error() > 0.0 {
            return Estimate::mean(&held);
        }
        let error = poisson_interval(0, 0.95).high / held.n().max(1) as f64;
        Estimate::resampled(held.mean(), error, held.n())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Intervals of which none holds in any of 256 cells, and of which a few do.
    #[test]
    fn a_part_of_none_has_an_error() {
        let radii = [0.1, 0.1];
        let theory = Expected::after(Query::Places, 1000, &radii).unwrap();
        let of = |coverage: Vec<f64>| {
            let (query, schedule) = (Query::Places, Schedule::Constant);
            let (errors, squares) = (Vec::new(), Vec::new());
            Point { query, schedule, maps: 2, radius: radii[0], theory, errors, squares, coverage }.held()
        };
        let none = of(vec![0.0; 256]);
        assert!(none.value() == 0.0 && (0.01..0.015).contains(&none.std_error()));
        let few = of((0..256).map(|n| f64::from(u8::from(n < 4))).collect());
        assert!((few.value() - 4.0 / 256.0).abs() < 1e-15 && (0.007..0.009).contains(&few.std_error()));
    }
}
