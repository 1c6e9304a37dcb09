//! What the cells say.

use super::cases::{Estimator, beyond, difference, thresholds};
use super::predict::{Difference, Expected};
use crate::harness::{Cells, Estimate, Settings};
use crate::setups::uncollided::Query;
use turbid::stats::{Moments, jackknife};

/// One estimator that one kind of question was put to.
pub struct Answer {
    /// Who asks.
    pub query: Query,
    /// What answers.
    pub estimator: Estimator,
    /// What was predicted.
    pub expected: Expected,
    /// Mean error of each cell.
    pub errors: Vec<f64>,
    /// Mean squared error of each cell.
    pub squares: Vec<f64>,
}

impl Answer {
    /// From the cells.
    pub fn new(
        settings: &Settings,
        cells: &Cells,
        query: Query,
        estimator: Estimator,
    ) -> anyhow::Result<Self> {
        let name = estimator.name(query);
        let expected = Expected::new(settings, query, estimator)?;
        let (errors, squares) = (cells.values(&name, "error")?, cells.values(&name, "squared error")?);
        Ok(Answer { query, estimator, expected, errors, squares })
    }

    /// Mean error over all cells.
    pub fn error(&self) -> Moments {
        self.errors.iter().collect()
    }

    /// Mean squared error over all cells.
    pub fn squared(&self) -> Moments {
        self.squares.iter().collect()
    }

    /// Mean squared deviation from the predicted mean, by cell.
    pub fn deviations(&self) -> Vec<f64> {
        let blur = self.expected.blur;
        self.errors
            .iter()
            .zip(&self.squares)
            .map(|(e, square)| square - 2.0 * blur * e + blur * blur)
            .collect()
    }

    /// The predicted variance.
    pub fn variance(&self) -> f64 {
        self.expected.squared - self.expected.blur * self.expected.blur
    }
}

/// The answer of an estimator.
pub fn find(answers: &[Answer], query: Query, estimator: Estimator) -> Option<&Answer> {
    answers.iter().find(|a| a.query == query && a.estimator == estimator)
}

/// The ratio of two means over the same cells.
pub fn ratio(over: &[f64], under: &[f64]) -> Estimate {
    let pairs: Vec<(f64, f64)> = over.iter().copied().zip(under.iter().copied()).collect();
    let of = |pairs: &[(f64, f64)]| {
        pairs.iter().map(|pair| pair.0).sum::<f64>() / pairs.iter().map(|pair| pair.1).sum::<f64>()
    };
    Estimate::jackknife(&jackknife(&pairs, of))
}

/// Differences of one number of photons.
pub struct Level {
    /// Who asks.
    pub query: Query,
    /// The level.
    pub level: u32,
    /// Predicted mean magnitude.
    pub predicted: f64,
    /// Mean magnitude of each cell.
    pub magnitudes: Vec<f64>,
}

impl Level {
    /// From the cells.
    pub fn new(cells: &Cells, query: Query, level: u32, photons: u64) -> anyhow::Result<Self> {
        let predicted = Difference::of_level(query, level)?.magnitude(photons);
        let magnitudes = cells.values(&difference(query, level), "magnitude")?;
        Ok(Level { query, level, predicted, magnitudes })
    }

    /// Mean over all cells.
    pub fn moments(&self) -> Moments {
        self.magnitudes.iter().collect()
    }
}

/// How far off the answers of one estimator are.
pub struct Tail {
    /// Who asks.
    pub query: Query,
    /// What answers.
    pub estimator: Estimator,
    /// For each cell, the parts of its answers beyond the thresholds.
    parts: Vec<Vec<f64>>,
}

impl Tail {
    /// From the cells.
    pub fn new(cells: &Cells, query: Query, estimator: Estimator) -> anyhow::Result<Self> {
        let name = estimator.name(query);
        let columns: Vec<Vec<f64>> =
            thresholds().iter().map(|&t| cells.values(&name, &beyond(t))).collect::<Result<_, _>>()?;
        let cells = columns[0].len();
        let parts = (0..cells).map(|cell| columns.iter().map(|column| column[cell]).collect()).collect();
        Ok(Tail { query, estimator, parts })
    }

    /// The part of all answers beyond a threshold.
    pub fn beyond(&self, threshold: usize) -> Moments {
        self.parts.iter().map(|parts| parts[threshold]).collect()
    }

    /// The median distance from the exact value, in units of the plain root mean square error: between thresholds, in
    /// proportion on the logarithm.
    pub fn median(&self) -> Estimate {
        let ladder = thresholds();
        let median = |cells: &[Vec<f64>]| {
            let part = |i: usize| cells.iter().map(|parts| parts[i]).sum::<f64>() / cells.len() as f64;
            let above = (0..ladder.len()).find(|&i| part(i) <= 0.5).unwrap_or(ladder.len() - 1);
            if above == 0 {
                return ladder[0];
            }
            let (more, less) = (part(above - 1), part(above));
            let share = if more > less { ((more - 0.5) / (more - less)).clamp(0.0, 1.0) } else { 1.0 };
            ladder[above - 1] * libm::pow(ladder[above] / ladder[above - 1], share)
        };
        Estimate::jackknife(&jackknife(&self.parts, median))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::debiasing::cases::ONE;

    #[test]
    fn medians_lie_between_thresholds() {
        // All answers are beyond thresholds below 1, a quarter beyond 1 and none farther out.
        let last = thresholds().len();
        let parts: Vec<f64> =
            (0..last).map(|i| [1.0, 0.25, 0.0][usize::from(i >= ONE) + usize::from(i > ONE)]).collect();
        let tail = Tail { query: Query::Places, estimator: Estimator::Drawn, parts: vec![parts; 4] };
        let expected = libm::exp2(-0.5 / 3.0);
        assert!((tail.median().value() - expected).abs() < 1e-12, "{}", tail.median().value());
    }

    #[test]
    fn ratios_are_those_of_means() {
        let found = ratio(&[2.0, 4.0, 6.0], &[1.0, 1.0, 1.0]);
        assert!((found.value() - 4.0).abs() < 1e-15 && found.maps() == Some(3));
    }
}
