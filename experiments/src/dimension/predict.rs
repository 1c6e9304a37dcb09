//! What theory says of every case, before anything is measured.

use super::cases::{name, radii, sizes};
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::uncollided::{Case, Query};

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for size in sizes(settings) {
        for query in Query::ALL {
            for radius in radii() {
                let case = Case::new(query, size.photons, radius)?;
                let name = name(query, size.photons, radius);
                let blur = (case.blur, case.error);
                let source = "kernel mean of an exponential field";
                predictions.push(Prediction::new(&name, "error", Unit::ONE, blur, source));
                let squared = (case.squared(), 2.0 * case.blur * case.error + 1e-12 * case.variance);
                let source = "squared blur and variance of independent photons";
                predictions.push(Prediction::new(name, "squared error", Unit::ONE, squared, source));
            }
        }
    }
    Ok(predictions)
}
