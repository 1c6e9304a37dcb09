//! One case measured beside what was predicted of it.

use super::error::PredictedError;
use super::term::Entry;
use crate::harness::{Cells, Estimate, Parameters, Row, Unit};
use turbid::stats::{Moments, amplitude_per_map};

/// One case with everything that is known of it; errors as fractions of the exact value.
pub struct Compared<C> {
    /// The case.
    pub case: C,
    /// What was predicted.
    pub expected: PredictedError,
    /// Signed error of each map.
    pub errors: Vec<f64>,
    /// The same over maps.
    pub error: Moments,
}

impl<C> Compared<C> {
    /// The case of this name, as the maps measured a quantity of it.
    ///
    /// # Errors
    /// If no map has the quantity.
    pub fn new(
        case: C,
        name: &str,
        quantity: &str,
        expected: PredictedError,
        cells: &Cells,
    ) -> anyhow::Result<Self> {
        let exact = expected.exact.0;
        let values = cells.values(name, quantity)?;
        let errors: Vec<f64> = values.iter().map(|v| v / exact - 1.0).collect();
        let error = errors.iter().collect();
        Ok(Compared { case, expected, errors, error })
    }

    /// Predicted error.
    pub fn predicted(&self) -> f64 {
        self.expected.total()
    }

    /// What is left of the measured error, in standard errors.
    pub fn z(&self) -> f64 {
        let error = libm::hypot(self.error.std_error(), self.expected.error);
        (self.error.mean() - self.predicted()) / error
    }

    /// The rows of the case in the results: the quantity beside the exact value, its error beside the predicted one, and
    /// what is left over.
    ///
    /// # Errors
    /// If no map has the quantity.
    pub fn rows(
        &self,
        name: &str,
        (quantity, unit): (&str, Unit),
        parameters: Parameters,
        cells: &Cells,
    ) -> anyhow::Result<[Row; 3]> {
        let (exact, bound) = self.expected.exact;
        let values = cells.moments(name, quantity)?;
        let left: Moments = self.errors.iter().map(|e| e - self.predicted()).collect();
        let rows = [
            Row::measured(name, quantity, unit, &values)?.reference(exact, bound),
            Row::measured(name, "error", Unit::FRACTION, &self.error)?.predicted(self.predicted()),
            Row::measured(name, "error left over", Unit::FRACTION, &left)?
                .reference(0.0, self.expected.error),
        ];
        Ok(rows.map(|row| row.with(parameters)))
    }

    /// The case in the error budget of the study.
    pub fn entry(&self, group: impl Into<String>, name: &str) -> Entry {
        Entry::new(group, name, &self.expected.terms, self.expected.error, self.errors.clone())
    }
}

/// Measured over predicted part of the error of some cases: one amplitude a map, weighted by what all maps say of the
/// noise. `part` says which part of the prediction is tested; the others are taken away first. None without a case,
/// or where nothing was predicted.
pub fn amplitude<C>(results: &[&Compared<C>], part: impl Fn(&Compared<C>) -> f64) -> Option<Estimate> {
    // Cases of different numbers of photons come from different maps; joining them by number is a free choice.
    let maps = results.iter().map(|r| r.errors.len()).min()?;
    let predicted: Vec<f64> = results.iter().map(|r| part(r)).collect();
    let weights: Vec<f64> = results.iter().map(|r| 1.0 / r.error.variance()).collect();
    let left = |r: &Compared<C>, m: usize| r.errors[m] - (r.predicted() - part(r));
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| results.iter().map(|r| left(r, m)).collect()).collect();
    amplitude_per_map(&predicted, &per_map, &weights).map(|a| Estimate::mean(&a.moments))
}
