//! What is said before anything is measured, and asked again after.

use crate::harness::Unit;
use anyhow::Context;
use std::collections::HashMap;

/// A value computed before the measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Which case, as in the cells' rows.
    pub case: String,
    /// Which quantity, as in the cells' rows.
    pub quantity: String,
    /// Its unit.
    pub unit: Unit,
    /// The predicted value.
    pub value: f64,
    /// Bound on its numerical error.
    pub error: f64,
    /// Where it comes from: the equation or the literature, in a few words.
    pub source: String,
}

impl Prediction {
    /// A value and the bound on its error.
    pub fn new(
        case: impl Into<String>,
        quantity: impl Into<String>,
        unit: Unit,
        (value, error): (f64, f64),
        source: impl Into<String>,
    ) -> Self {
        Prediction { case: case.into(), quantity: quantity.into(), unit, value, error, source: source.into() }
    }
}

/// The predictions of an experiment by case and quantity.
pub struct Predictions<'a>(HashMap<(&'a str, &'a str), (f64, f64)>);

impl<'a> Predictions<'a> {
    /// From the list.
    pub fn new(predictions: &'a [Prediction]) -> Self {
        let entry = |p: &'a Prediction| ((p.case.as_str(), p.quantity.as_str()), (p.value, p.error));
        Predictions(predictions.iter().map(entry).collect())
    }

    /// One value and its bound.
    ///
    /// # Errors
    /// If it was not predicted.
    pub fn get(&self, case: &str, quantity: &str) -> anyhow::Result<(f64, f64)> {
        let found = self.0.get(&(case, quantity)).copied();
        found.with_context(|| format!("no prediction of {quantity} of {case}"))
    }
}
