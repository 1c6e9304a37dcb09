//! Rows of the result table. A row without an error and a unit cannot be built.

use super::{Estimate, Parameters, Unit};
use crate::prediction::Prediction;
use anyhow::ensure;
use serde::Serialize;
use turbid::estimators::Kernel;
use turbid::stats::{ALPHA, Moments, poisson_interval};

/// One row: a case and a quantity, measured, beside what was predicted and what is exact.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    case: String,
    quantity: String,
    parameters: Parameters,
    unit: Unit,
    n: u64,
    value: f64,
    std_error: f64,
    vov: Option<f64>,
    is_exact: bool,
    predicted: Option<f64>,
    reference: Option<(f64, f64)>,
    cost: Option<(u64, &'static str)>,
}

impl Row {
    /// A mean over maps.
    ///
    /// # Errors
    /// Fewer than two maps, a value that is not finite, or no spread at all: a mean with an error of zero is a count
    /// in disguise ([`Row::count`]) or computed ([`Row::exact`]).
    pub fn measured(case: &str, quantity: &str, unit: Unit, moments: &Moments) -> anyhow::Result<Self> {
        let mut row = Row::estimated(case, quantity, unit, &Estimate::mean(moments))?;
        row.vov = Some(moments.vov());
        Ok(row)
    }

    /// A statistic with its error, such as a fit refitted per map.
    ///
    /// # Errors
    /// As [`Row::measured`].
    pub fn estimated(case: &str, quantity: &str, unit: Unit, estimate: &Estimate) -> anyhow::Result<Self> {
        let Some(n) = estimate.maps() else {
            return Ok(Row::exact(case, quantity, unit, estimate.value(), estimate.std_error()));
        };
        let error = estimate.std_error();
        ensure!(estimate.value().is_finite(), "{quantity} of {case} is not finite");
        ensure!(n >= 2 && error.is_finite(), "{quantity} of {case} has no error bar: {n} maps");
        ensure!(
            error > 0.0,
            "{quantity} of {case} is the same in all {n} maps: state it as a count or as exact"
        );
        Ok(Row::plain(case, quantity, unit, n, estimate.value(), error))
    }

    /// A rate of rare events: `count` in `n` independent trials. No event at all has the error of its 95 per cent
    /// bound, 3.0 / n, never 0.
    pub fn count(case: &str, quantity: &str, unit: Unit, n: u64, count: u64) -> Self {
        let error = if count == 0 { poisson_interval(0, 0.95).high } else { (count as f64).sqrt() };
        let trials = n.max(1) as f64;
        Row::plain(case, quantity, unit, n, count as f64 / trials, error / trials)
    }

    /// A computed value, with the bound on its error.
    pub fn exact(case: &str, quantity: &str, unit: Unit, value: f64, bound: f64) -> Self {
        Row { is_exact: true, ..Row::plain(case, quantity, unit, 0, value, bound) }
    }

    fn plain(case: &str, quantity: &str, unit: Unit, n: u64, value: f64, std_error: f64) -> Self {
        Row {
            case: case.to_string(),
            quantity: quantity.to_string(),
            parameters: Parameters::default(),
            unit,
            n,
            value,
            std_error,
            vov: None,
            is_exact: false,
            predicted: None,
            reference: None,
            cost: None,
        }
    }

    /// What was predicted for it, where [`Row::predicted_from`] cannot know.
    #[must_use]
    pub fn predicted(self, value: f64) -> Self {
        Row { predicted: Some(value), ..self }
    }

    /// The exact value and its error.
    #[must_use]
    pub fn reference(self, value: f64, error: f64) -> Self {
        Row { reference: Some((value, error)), ..self }
    }

    /// What the case asks.
    #[must_use]
    pub fn with(self, parameters: Parameters) -> Self {
        Row { parameters, ..self }
    }

    /// The work behind it: a count and what was counted.
    #[must_use]
    pub fn cost(self, count: u64, of: &'static str) -> Self {
        Row { cost: Some((count, of)), ..self }
    }

    /// Takes the prediction of the same case and quantity, unless it has one. The study does this for every row of
    /// a section; an experiment does it for rows that it prints in a table.
    #[must_use]
    pub fn predicted_from(self, predictions: &[Prediction]) -> Self {
        let own = predictions.iter().find(|p| p.case == self.case && p.quantity == self.quantity);
        Row { predicted: self.predicted.or(own.map(|p| p.value)), ..self }
    }

    /// Case and quantity.
    pub fn key(&self) -> (&str, &str) {
        (&self.case, &self.quantity)
    }

    /// The unit.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Value and standard error (or bound).
    pub fn value(&self) -> (f64, f64) {
        (self.value, self.std_error)
    }

    /// The prediction, if there is one.
    pub fn prediction(&self) -> Option<f64> {
        self.predicted
    }

    /// The exact value and its error, if there is one.
    pub fn exact_value(&self) -> Option<(f64, f64)> {
        self.reference
    }

    /// Difference from the reference in standard errors, and its two-sided p-value; nothing for heavy tails.
    pub fn z_and_p(&self) -> Option<(f64, f64)> {
        let (reference, error) = self.reference?;
        if self.is_exact || self.is_heavy_tailed() {
            return None;
        }
        let std_error = libm::hypot(self.std_error, error);
        let z = (self.value - reference) / std_error;
        Some((z, turbid::stats::student_p(z, self.n.saturating_sub(1))))
    }

    fn is_heavy_tailed(&self) -> bool {
        self.vov.is_some_and(|vov| vov.is_nan() || vov > turbid::stats::HEAVY_TAIL)
    }

    /// One word on the row by itself; claims have verdicts of their own.
    pub fn verdict(&self) -> &'static str {
        match self.z_and_p() {
            _ if self.is_heavy_tailed() => "heavy-tailed",
            _ if self.is_exact => "computed",
            Some((_, p)) if p < ALPHA => "differs",
            Some(_) => "consistent",
            None => "",
        }
    }
}

/// A row of results.csv.
#[derive(Debug, Default, Serialize)]
pub(super) struct Record<'a> {
    experiment: &'a str,
    case: &'a str,
    quantity: &'a str,
    field: Option<&'a str>,
    photons: Option<u64>,
    depth: Option<f64>,
    radius: Option<f64>,
    k: Option<usize>,
    kernel: Option<&'a str>,
    unit: &'a str,
    n: u64,
    mean: f64,
    std_error: f64,
    vov: Option<f64>,
    predicted: Option<f64>,
    reference: Option<f64>,
    reference_error: Option<f64>,
    z: Option<f64>,
    p: Option<f64>,
    verdict: &'a str,
    cost: Option<u64>,
    cost_unit: &'a str,
}

impl<'a> Record<'a> {
    pub(super) fn new(experiment: &'a str, row: &'a Row) -> Self {
        let test = row.z_and_p();
        let Parameters { field, photons, depth, radius, k, kernel } = row.parameters;
        Record {
            experiment,
            case: &row.case,
            quantity: &row.quantity,
            field,
            photons,
            depth,
            radius,
            k,
            kernel: kernel.map(Kernel::name),
            unit: row.unit.name(),
            n: row.n,
            mean: row.value,
            std_error: row.std_error,
            vov: row.vov,
            predicted: row.predicted,
            reference: row.reference.map(|r| r.0),
            reference_error: row.reference.map(|r| r.1),
            z: test.map(|t| t.0),
            p: test.map(|t| t.1),
            verdict: row.verdict(),
            cost: row.cost.map(|c| c.0),
            cost_unit: row.cost.map_or("", |c| c.1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::stats::t_test;

    fn moments(values: &[f64]) -> Moments {
        values.iter().collect()
    }

    #[test]
    fn no_row_without_an_error() {
        let make = |values: &[f64]| Row::measured("a", "q", Unit::ONE, &moments(values));
        assert!(make(&[1.0]).is_err() && make(&[]).is_err());
        assert!(make(&[2.0, 2.0]).is_err());
        assert!(make(&[1.0, f64::NAN]).is_err());
        assert!(make(&[1.0, 2.0]).is_ok());
    }

    #[test]
    fn a_count_of_zero_has_an_error_of_three() {
        let (value, error) = Row::count("a", "q", Unit::ONE, 100, 0).value();
        assert!(value == 0.0 && (error - 0.029_957).abs() < 1e-5);
    }

    #[test]
    fn z_and_p_are_those_of_the_t_test() {
        let values: Moments = (0..64).map(|i| f64::from(i * 37 % 64) / 16.0).collect();
        let row = Row::measured("a", "q", Unit::ONE, &values).unwrap().reference(2.0, 0.1);
        let (z, p) = row.z_and_p().unwrap();
        let test = t_test(&values, 2.0, 0.1);
        assert!((z - test.z).abs() < 1e-14 && (p - test.p).abs() < 1e-14);
        assert_eq!(row.verdict(), "consistent");
        assert_eq!(row.reference(50.0, 0.1).verdict(), "differs");
    }

    #[test]
    fn heavy_tails_have_no_p() {
        let mut values = vec![0.0; 100];
        values.push(1.0);
        let row = Row::measured("a", "q", Unit::ONE, &moments(&values)).unwrap().reference(0.5, 0.0);
        assert!(row.z_and_p().is_none());
        assert_eq!(row.verdict(), "heavy-tailed");
    }
}
