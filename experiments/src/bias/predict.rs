//! What theory predicts of every case, in parts, before anything is measured.

use super::cases::Case;
use super::fields::{FIELDS, Field};
use crate::harness::{Settings, Unit};
use crate::prediction::{PredictedError, Prediction, Term};
use crate::setups::{CELL, Size};
use crate::theory::{Gathers, NearestGather};
use turbid::transport::in_parallel;

/// What is predicted of each field whose photons are all stored: collisions of a history, on average.
pub const COLLISIONS: &str = "collisions per photon";

/// Panels of the quadrature over the fluence, which bends like t ln t at the faces: 10^-5 of it is left.
const PANELS: u32 = 16;

/// A field with all that predictions ask of it.
pub struct Theory(Gathers);

impl Theory {
    /// The theory of a field.
    pub fn new(field: &'static Field) -> anyhow::Result<Self> {
        Ok(Theory(Gathers::new(field.setup, field.depths, 0.5 * CELL)?))
    }

    /// The predicted error of one case. Fixed radii may be asked at any depth, nearest gathers at the field's own.
    pub fn error(&self, case: &Case) -> anyhow::Result<PredictedError> {
        match case.size {
            Size::Radius(r) => self.0.within(case.kernel, r, case.depth),
            Size::Nearest(k) => {
                let (density, is_biased) = (case.field.setup.density(case.photons), case.is_biased);
                let gather = NearestGather { kernel: case.kernel, k, cap: case.cap(), density, is_biased };
                self.0.nearest(&gather, case.depth)
            }
        }
    }
}

/// Collisions of a history, on average.
fn collisions(field: &'static Field) -> anyhow::Result<f64> {
    field.setup.collisions(&field.setup.exact()?, PANELS)
}

/// All cases of a study with their predicted errors, computed in parallel.
pub fn budget(settings: &Settings) -> anyhow::Result<Vec<(Case, PredictedError)>> {
    let mut all = Vec::new();
    for field in FIELDS {
        let theory = Theory::new(field)?;
        let cases: Vec<Case> =
            field.photons(settings).into_iter().flat_map(|n| Case::all(field, n)).collect();
        let predicted = in_parallel(cases.len(), |i| theory.error(&cases[i]));
        for (case, error) in cases.into_iter().zip(predicted) {
            all.push((case, error?));
        }
    }
    Ok(all)
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    let source = |term| match term {
        Term::Edge => "kernel mean of a uniform field in the medium, less 1",
        Term::Blur => "kernel mean of the exact field, less the edge",
        Term::Nearest => "expectation with the k-th photon summed, less without",
        Term::Clusters => "photons of one history, far from faces",
        Term::Step | Term::Storage => "none",
    };
    for (case, error) in budget(settings)? {
        let sources = [case.field.setup.source(), "exact field, kernel mean, k-nearest law"];
        predictions.extend(error.predictions(&case.name(), ("fluence", Unit::FLUENCE), sources, source));
    }
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        let (value, source) = ((collisions(field)?, 1e-5), "integral of the exact fluence");
        predictions.push(Prediction::new(field.name, COLLISIONS, Unit::ONE, value, source));
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::super::fields::{HIGH_ALBEDO, UNCOLLIDED};
    use super::*;
    use turbid::estimators::Kernel;

    fn total(field: &'static Field, depth: f64, radius: f64) -> f64 {
        let (size, kernel) = (Size::Radius(radius), Kernel::Uniform);
        let case = Case { field, photons: 1, depth, size, is_biased: false, kernel };
        Theory::new(field).unwrap().error(&case).unwrap().total()
    }

    /// Errors, in per cent, of the plain estimate in the slab of albedo 0.9, computed elsewhere by another program and
    /// printed to 0.01.
    #[test]
    fn known_errors_at_and_near_the_lit_face() {
        let field = &HIGH_ALBEDO;
        for (radius, depth, error) in [(0.2, 0.0, -47.12), (0.2, 0.1, -15.89), (0.4, 0.4, -1.43)] {
            let found = 100.0 * total(field, depth, radius);
            assert!((found - error).abs() < 0.0051, "radius {radius} depth {depth}: {found}, not {error}");
        }
    }

    /// The ball mean of e^-t in closed form, 3 (x cosh x - sinh x) / x^3.
    #[test]
    fn whole_balls_of_uncollided_photons() {
        let field = &UNCOLLIDED;
        for x in [0.1, 0.4, 0.8] {
            let mean = 3.0 * (x * libm::cosh(x) - libm::sinh(x)) / (x * x * x);
            // Cancellation of the closed form at small x: a few 1e-16 over x^2.
            assert!((total(field, 1.0, x) - (mean - 1.0)).abs() < 1e-11, "radius {x}");
        }
    }

    /// In a field of small slope the biased rule is high by k/(k-1), and the right one does not.
    #[test]
    fn the_biased_rule_reads_high() {
        let field = &UNCOLLIDED;
        let theory = Theory::new(field).unwrap();
        let case = |is_biased| {
            let (photons, size, kernel) = (1_000_000, Size::Nearest(10), Kernel::Uniform);
            Case { field, photons, depth: 1.0, size, is_biased, kernel }
        };
        let right = theory.error(&case(false)).unwrap();
        let wrong = theory.error(&case(true)).unwrap();
        assert!(right.total().abs() < 1e-3);
        // One part in 9 of the right value; the few under-full gathers, which are right, take 1e-3 of it.
        assert!(
            (wrong.of(Term::Nearest) / (1.0 + right.total()) - 1.0 / 9.0).abs() < 2e-4,
            "{}",
            wrong.of(Term::Nearest)
        );
    }
}
