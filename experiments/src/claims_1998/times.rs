//! Ratios of times, pair by pair: measurements of this machine, for words and tables alone.

use turbid::math::{exp, ln};
use turbid::stats::{Moments, mean_interval};

/// The second time of each pair over its first: geometric mean over pairs and its 95 % interval.
pub struct Times {
    /// The mean.
    pub ratio: f64,
    low: f64,
    high: f64,
}

impl Times {
    /// Of pairs of seconds; none of fewer than two.
    pub fn of(pairs: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let logs: Moments = pairs.filter(|[a, b]| *a > 0.0 && *b > 0.0).map(|[a, b]| ln(b / a)).collect();
        let interval = mean_interval(&logs, 0.95);
        (logs.n() > 1).then(|| Times {
            ratio: exp(logs.mean()),
            low: exp(interval.low),
            high: exp(interval.high),
        })
    }

    /// The ratio with its interval.
    pub fn words(&self) -> String {
        format!("{:.3} ({:.3} to {:.3})", self.ratio, self.low, self.high)
    }

    /// What the interval says of a range.
    pub fn against(&self, low: f64, high: f64) -> String {
        if low <= self.low && self.high <= high {
            format!("the whole interval is within {low} to {high}")
        } else if self.high < low || self.low > high {
            format!("the whole interval is outside {low} to {high}")
        } else {
            format!("undecided against {low} to {high} on this machine, in this run")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_take_twice_as_long() {
        let times = Times::of([[1.0, 2.0], [2.0, 4.2], [3.0, 5.7], [0.0, 1.0]].into_iter()).unwrap();
        assert!((times.ratio - libm::cbrt(2.0 * 2.1 * 1.9)).abs() < 1e-12);
        assert!(times.against(1.5, 2.5).contains("within") && times.against(0.9, 1.1).contains("outside"));
        assert!(times.against(2.0, 2.5).contains("undecided"));
        assert!(Times::of([[1.0, 2.0]].into_iter()).is_none());
    }
}
