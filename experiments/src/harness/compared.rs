//! One case measured beside what was predicted of it.

use super::Cells;
use turbid::stats::Moments;

/// The predicted error of a case, a sum of parts, each as a fraction of the exact value.
pub trait Predicted {
    /// The exact value.
    fn exact(&self) -> f64;
    /// The sum of the parts.
    fn total(&self) -> f64;
    /// Bound on its numerical error.
    fn bound(&self) -> f64;
}

/// One case with everything that is known of it; errors in per cent of the exact value.
pub struct Compared<C, P> {
    /// The case.
    pub case: C,
    /// What was predicted.
    pub parts: P,
    /// Signed error of each map.
    pub errors: Vec<f64>,
    /// The same over maps.
    pub error: Moments,
}

impl<C, P: Predicted> Compared<C, P> {
    /// The case of this name, as the maps measured a quantity of it.
    ///
    /// # Errors
    /// If no map has the quantity.
    pub fn new(case: C, name: &str, quantity: &str, parts: P, cells: &Cells) -> anyhow::Result<Self> {
        let exact = parts.exact();
        let values = cells.values(name, quantity)?;
        let errors: Vec<f64> = values.iter().map(|v| 100.0 * (v / exact - 1.0)).collect();
        let error = errors.iter().collect();
        Ok(Compared { case, parts, errors, error })
    }

    /// Predicted error.
    pub fn predicted(&self) -> f64 {
        100.0 * self.parts.total()
    }

    /// What is left of the measured error, in standard errors.
    pub fn z(&self) -> f64 {
        let error = libm::hypot(self.error.std_error(), 100.0 * self.parts.bound());
        (self.error.mean() - self.predicted()) / error
    }
}
