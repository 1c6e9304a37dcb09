//! An axis: what it measures, in which unit, on which scale.

use serde::{Deserialize, Serialize};

/// How numbers become lengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Scale {
    /// Equal differences are equal lengths.
    Linear,
    /// Equal ratios are equal lengths; numbers that are not positive are refused.
    Log,
    /// As `Log`, but numbers that are not positive are marked at the lower border.
    LogClipped,
    /// Logarithmic in both directions beyond `threshold`, linear between: for signed errors over decades.
    SymLog {
        /// Where the linear part ends, above 0.
        threshold: f64,
    },
}

/// One axis of a panel, or the axis of a colour bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// What is measured, such as `Photons emitted`.
    pub label: String,
    /// The unit, shown in square brackets; empty for a pure number.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// How numbers become lengths.
    pub scale: Scale,
    /// The limits, exactly as given; from the data, with a margin, where absent. Data outside are marked at the border.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
    /// Ticks at these values with these names, in place of numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<(f64, String)>,
}

impl Axis {
    /// An axis whose limits come from the data.
    #[must_use]
    pub fn new(label: impl Into<String>, unit: impl Into<String>, scale: Scale) -> Self {
        Self { label: label.into(), unit: unit.into(), scale, range: None, names: Vec::new() }
    }

    /// A linear axis.
    #[must_use]
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(label, unit, Scale::Linear)
    }

    /// A logarithmic axis for positive numbers.
    #[must_use]
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(label, unit, Scale::Log)
    }

    /// The same axis with these limits.
    #[must_use]
    pub fn with_range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }
}
