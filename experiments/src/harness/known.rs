//! What was written down before the measurement, to be asked again.

use super::Prediction;
use anyhow::Context;
use std::collections::HashMap;

/// The predictions of an experiment by case and quantity.
pub struct Known<'a>(HashMap<(&'a str, &'a str), (f64, f64)>);

impl<'a> Known<'a> {
    /// From the list.
    pub fn new(predictions: &'a [Prediction]) -> Self {
        let entry = |p: &'a Prediction| ((p.case.as_str(), p.quantity.as_str()), (p.value, p.error));
        Known(predictions.iter().map(entry).collect())
    }

    /// One value and its bound.
    ///
    /// # Errors
    /// If it was not predicted.
    pub fn get(&self, case: &str, quantity: &str) -> anyhow::Result<(f64, f64)> {
        let found = self.0.get(&(case, quantity)).copied();
        found.with_context(|| format!("no prediction of {quantity} of {case}"))
    }

    /// A part of the predicted error of a case, written down in per cent, as a fraction.
    ///
    /// # Errors
    /// If it was not predicted.
    pub fn part(&self, case: &str, part: &str) -> anyhow::Result<f64> {
        Ok(self.get(case, &format!("error from {part}"))?.0 / 100.0)
    }
}
