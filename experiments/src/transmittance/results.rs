//! What the cells say of each case.

use super::cases::{Case, Method};
use super::expected::Expected;
use super::predict::TERMS;
use super::rays::Way;
use crate::harness::{Cells, Estimate};
use crate::prediction::{Compared, PredictedError, Predictions};
use turbid::stats::{Interval, Moments, jackknife, positive_interval};

/// Predicted relative variance above which a case takes no part in claims on variances; none does beyond an optical depth of
/// [`THICK`]. Values far above T carry the variance there, and sooner where the factors of a residual pass more than all.
pub fn light(method: Method) -> f64 {
    if method == Method::ResidualMean { NORMAL } else { 10.0 }
}

/// See [`light`].
pub const THICK: f64 = 2.0;
/// The same for claims on means and for the budget: batches of some hundred estimates are nearly normal below.
pub const NORMAL: f64 = 1.0;
/// Below this nothing varies but roundings.
const NOTHING: f64 = 1e-9;

/// Squared error and look-ups of a cell.
type Pair = (f64, f64);

/// One case with everything that is known of it.
pub struct CaseResult {
    /// Its mean, measured and predicted.
    pub mean: Compared<Case>,
    /// What was predicted.
    pub expected: Expected,
    /// Mean squared error of each cell, over T^2.
    pub squared: Vec<f64>,
    /// Mean look-ups of each cell.
    pub look_ups: Vec<f64>,
}

impl CaseResult {
    /// Reads a case.
    ///
    /// # Errors
    /// If something was not predicted, or not measured
    pub fn new(case: Case, known: &Predictions, cells: &Cells) -> anyhow::Result<Self> {
        let name = case.name();
        let error = PredictedError::read(known, &name, "transmittance", &TERMS)?;
        let expected = Expected {
            bias: error.total(),
            squared: known.get(&name, "squared error")?.0,
            look_ups: known.get(&name, "look-ups")?.0,
        };
        Ok(CaseResult {
            mean: Compared::new(case, &name, "transmittance", error, cells)?,
            expected,
            squared: cells.values(&name, "squared error")?,
            look_ups: cells.values(&name, "look-ups")?,
        })
    }

    /// The case.
    pub fn case(&self) -> Case {
        self.mean.case
    }

    /// Whether cells tell its variance.
    pub fn is_light(&self) -> bool {
        let Case { way, method } = self.case();
        let squared = self.expected.squared;
        NOTHING < squared && squared <= light(method) && way.depth <= THICK && method.has_known_spread()
    }

    /// Whether batches of its estimates are nearly normal.
    pub fn is_normal(&self) -> bool {
        NOTHING < self.expected.squared && self.expected.squared <= NORMAL
    }

    /// Whether its measured variance is worth a point in a figure.
    pub fn is_shown(&self) -> bool {
        self.is_light() || (self.is_normal() && self.case().method.has_known_spread())
    }

    /// Mean squared error over T^2, over the predicted one.
    pub fn over_predicted(&self) -> Estimate {
        let ratios: Moments = self.squared.iter().map(|s| s / self.expected.squared).collect();
        Estimate::mean(&ratios)
    }

    /// Squared error and look-ups of each cell.
    fn pairs(&self) -> Vec<Pair> {
        self.squared.iter().copied().zip(self.look_ups.iter().copied()).collect()
    }

    /// Squared error times look-ups: what a relative variance of 1 costs.
    pub fn work(&self) -> Estimate {
        Estimate::jackknife(&jackknife(&self.pairs(), work))
    }

    /// Its 95 per cent interval.
    pub fn work_interval(&self) -> Interval {
        positive_interval(&self.pairs(), work, 0.95)
    }
}

/// Squared error times look-ups of some cells.
fn work(pairs: &[Pair]) -> f64 {
    let n = pairs.len() as f64;
    let sum = |f: fn(&Pair) -> f64| pairs.iter().map(f).sum::<f64>() / n;
    sum(|p| p.0) * sum(|p| p.1)
}

/// The case of a ray and method.
pub fn find(results: &[CaseResult], way: Way, method: Method) -> Option<&CaseResult> {
    results.iter().find(|r| r.case() == Case { way, method })
}

/// Work of one method over that of another on the same ray, refitted without each cell in turn; and as predicted.
pub fn gain(results: &[CaseResult], way: Way, of: Method, over: Method) -> Option<(Estimate, f64)> {
    let (a, b) = (find(results, way, of)?, find(results, way, over)?);
    let pairs: Vec<_> = a.pairs().into_iter().zip(b.pairs()).collect();
    let ratio = |pairs: &[(Pair, Pair)]| {
        let (first, second): (Vec<Pair>, Vec<Pair>) = pairs.iter().copied().unzip();
        work(&first) / work(&second)
    };
    let predicted = a.expected.work() / b.expected.work();
    Some((Estimate::jackknife(&jackknife(&pairs, ratio)), predicted))
}
