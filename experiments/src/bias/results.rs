//! What the maps say of each case, and how results are picked.

use super::cases::Case;
use super::fields::Field;
use super::measure::is_fano_case;
use crate::harness::Cells;
use crate::prediction::{Compared, Term};
use crate::setups::Size;
use crate::theory::clustering;
use turbid::stats::Moments;

/// One case with everything that is known of it; errors as fractions of the exact fluence.
pub type CaseResult = Compared<Case>;

impl CaseResult {
    /// Whether the measurement is fine enough to see the predicted error at all.
    pub fn sees_prediction(&self) -> bool {
        self.predicted().abs() >= 2.0 * self.error.std_error()
    }

    /// Whether the medium fills every ball, as far as the prediction can tell.
    pub fn is_whole(&self) -> bool {
        self.expected.of(Term::Edge).abs() < 1e-6
    }
}

/// A number that somebody else would report from the same photons.
pub struct Mistake {
    /// What was done wrong.
    pub name: &'static str,
    /// The case whose photons it uses.
    pub case: Case,
    /// Error predicted for the right estimate.
    pub predicted: f64,
    /// Error predicted for the wrong one.
    pub wrong: f64,
    /// Signed error over maps.
    pub error: Moments,
}

impl Mistake {
    /// What can be done wrong.
    pub const NAMES: [&'static str; 2] = ["divided by sigma_s", "divided by stored photons"];
}

/// The largest number of photons a map of a field.
pub fn largest(results: &[CaseResult], field: &Field) -> u64 {
    results.iter().filter(|r| r.case.field == field).map(|r| r.case.photons).max().unwrap_or(0)
}

/// The exact fluence at a probe and its bound.
pub fn exact_at(results: &[CaseResult], field: &Field, depth: f64) -> (f64, f64) {
    let found = results.iter().find(|r| r.case.field == field && r.case.depth == depth);
    found.map_or((f64::NAN, f64::NAN), |r| r.expected.exact)
}

/// Variance over mean of the photon counts, where they are compared.
pub fn fano(cells: &Cells, case: &Case) -> anyhow::Result<Option<Moments>> {
    if !is_fano_case(case) {
        return Ok(None);
    }
    let factors: Vec<f64> = excess(cells, case)?.iter().map(|e| 1.0 + e).collect();
    Ok(Some(factors.iter().collect()))
}

/// What clusters add to a Fano factor of 1.
pub fn predicted_fano(case: &Case) -> f64 {
    match case.size {
        Size::Radius(r) if case.field.has_clusters() => {
            clustering(case.field.setup.albedo, case.field.setup.g, r)
        }
        _ => 0.0,
    }
}

/// The results of right estimators that a test picks.
pub fn pick(results: &[CaseResult], test: impl Fn(&CaseResult) -> bool) -> Vec<&CaseResult> {
    results.iter().filter(|r| !r.case.is_biased && test(r)).collect()
}

/// Variance over mean of the photon counts, less 1, a map each; the mean over all maps divides, since the ratio of
/// two numbers of one map would be biased.
pub fn excess(cells: &Cells, case: &Case) -> anyhow::Result<Vec<f64>> {
    let counts = cells.values(&case.name(), "count")?;
    let variances = cells.values(&case.name(), "count variance")?;
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    Ok(variances.iter().map(|v| v / mean - 1.0).collect())
}
