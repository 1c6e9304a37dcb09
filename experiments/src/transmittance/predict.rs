//! What theory says of every case, before anything is measured.

use super::cases::{Case, LEVELS, RAMP, level_name};
use super::expected::{difference, expected};
use super::rays::{Profile, Way};
use crate::harness::{Settings, Unit};
use crate::prediction::{PredictedError, Prediction, Term};
use turbid::transport::in_parallel;

/// The terms of a case: what a march in steps has too much.
pub const TERMS: [Term; 1] = [Term::Step];

/// Bound on the relative error of a mean: quadrature on pieces, which only the shreds of a cloud are not smooth on.
fn bound(way: Way) -> f64 {
    if way.profile == Profile::Cloud { 1e-5 } else { 1e-10 }
}

/// The predictions of one case.
fn of_case(case: &Case) -> anyhow::Result<Vec<Prediction>> {
    let line = case.way.line()?;
    let expected = expected(&line, &case.method.on(&line));
    let (name, exact) = (case.name(), libm::exp(-line.depth()));
    let bound = bound(case.way);
    let error = PredictedError {
        exact: (exact, bound * exact),
        terms: vec![(Term::Step, expected.bias)],
        error: bound * (1.0 + expected.bias.abs()),
    };
    let sources = ["exponential of the optical depth by quadrature", "mean of the estimator"];
    let mut all = error.predictions(
        &name,
        ("transmittance", Unit::ONE),
        sources,
        |_| "generating function of a place's optical depth",
    );
    let mut add = |quantity: &str, value: f64, bound: f64, source: &str| {
        all.push(Prediction::new(&name, quantity, Unit::ONE, (value, bound), source));
    };
    let source = "second moment in closed form, integrals by quadrature";
    add("squared error", expected.squared, 1e-3 * expected.squared, source);
    add("look-ups", expected.look_ups, 1e-3 * expected.look_ups, "rate times length, or mean order");
    add("work", expected.work(), 2e-3 * expected.work(), "squared error times look-ups");
    Ok(all)
}

/// The predictions, as they are written down before the measurement.
pub fn predict(_settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let cases = Case::all();
    let all = in_parallel(cases.len(), |i| of_case(&cases[i]));
    let mut all: Vec<Prediction> = all.into_iter().collect::<anyhow::Result<Vec<_>>>()?.concat();
    let line = RAMP.line()?;
    for level in 0..LEVELS {
        let value = difference(&line, 1 << level);
        let source = "generating function of a place's optical depth";
        let error = 1e-9 * value;
        let quantity = "squared difference";
        all.push(Prediction::new(level_name(level), quantity, Unit::ONE, (value, error), source));
    }
    Ok(all)
}
