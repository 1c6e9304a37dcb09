//! What `turbid advise` prints.

use serde::Serialize;

/// A line of the answer.
#[derive(Serialize)]
pub struct AdviceRow {
    /// What.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// The number.
    pub value: f64,
    /// Lower end of its range, if it has one.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}
