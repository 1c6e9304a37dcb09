//! What is said before anything is measured.

use super::Unit;

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
