//! What theory predicts of every case, in parts, before anything is measured.

use super::cases::{CAP, Case};
use super::exact::referee;
use super::fields::{FIELDS, Field};
use super::{sheet, spread};
use crate::harness::{Settings, Unit};
use crate::prediction::{PredictedError, Prediction, Term};
use crate::setups::Size;
use crate::theory::{Exact, nearest_clustering, referee_kernel};
use anyhow::Context;
use std::collections::HashMap;
use turbid::estimators::boundary::Treatment;
use turbid::transport::in_parallel;
use turbid_analytic::boundary::{
    self as referee, Body, nearest_treated_mean_symmetric, nearest_treated_mean_uniform,
    treated_mean_symmetric, treated_mean_uniform,
};

/// The predicted error of one case; `untreated` is that of the same without a treatment, if it is known.
fn expected(
    case: &Case,
    exact: &Exact,
    untreated: Option<&PredictedError>,
) -> anyhow::Result<PredictedError> {
    let Case { field, place, .. } = *case;
    let (treatment, kernel) = (referee(case.treatment), referee_kernel(case.kernel));
    let (here, here_error) = exact(place.depth())?;
    let (body, at) = (field.setup.body.referee(), case.point());
    let density = field.setup.density(case.photons);
    let of_place = |x: f64| {
        // The referee's coordinate is the depth in a slab, the distance from the centre in a sphere.
        let depth = if let Body::Sphere { radius } = body { radius - x } else { x };
        exact(depth).map_or(f64::NAN, |(value, _)| value)
    };
    let (uniform, bent, clusters) = match case.size {
        Size::Radius(r) => {
            let uniform = treated_mean_uniform(treatment, kernel, body, at, r)?;
            let bent = match field.setup.is_furnace() {
                true => None,
                false => Some(treated_mean_symmetric(treatment, kernel, body, at, r, of_place)?),
            };
            (uniform, bent, 0.0)
        }
        Size::Nearest(k) => {
            let neighbors = u32::try_from(k)?;
            let uniform =
                nearest_treated_mean_uniform(treatment, kernel, neighbors, CAP, body, at, density * here)?;
            let bent = match field.setup.is_furnace() {
                true => None,
                false => Some(nearest_treated_mean_symmetric(
                    treatment, kernel, neighbors, CAP, body, at, density, of_place,
                )?),
            };
            // Where the medium ends inside the ball, neighbours are missing like the ball's own part.
            let plain = referee::Treatment::None;
            let inside = match untreated {
                Some(expected) => 1.0 + expected.of(Term::Edge),
                None if treatment == plain => uniform.value,
                None => {
                    let here = density * here;
                    nearest_treated_mean_uniform(plain, kernel, neighbors, CAP, body, at, here)?.value
                }
            };
            let raised = nearest_clustering(field.setup.albedo, field.setup.g, density * here * inside, k);
            (uniform, bent, raised * inside * uniform.value)
        }
    };
    let blur = bent.map_or(0.0, |bent| bent.value / here - uniform.value);
    let bent_error = bent.map_or(0.0, |bent| bent.error / here);
    let error = uniform.error + bent_error + here_error / here;
    let terms = TERMS.into_iter().zip([uniform.value - 1.0, blur, clusters]).collect();
    Ok(PredictedError { exact: (here, here_error), terms, error })
}

/// All cases of a study with their predicted errors, computed in parallel.
fn budget(settings: &Settings) -> anyhow::Result<Vec<(Case, PredictedError)>> {
    let mut all = Vec::new();
    for field in FIELDS {
        let exact = field.setup.exact()?;
        let cases: Vec<Case> =
            field.sizes(settings).into_iter().flat_map(|(n, _)| Case::all(settings, field, n)).collect();
        let ask = |case: &Case, untreated| expected(case, &exact, untreated).with_context(|| case.name());
        let plain: Vec<&Case> = cases.iter().filter(|case| case.treatment == Treatment::None).collect();
        let untreated = in_parallel(plain.len(), |i| Ok((plain[i].name(), ask(plain[i], None)?)))
            .into_iter()
            .collect::<anyhow::Result<HashMap<String, PredictedError>>>()?;
        let predicted = in_parallel(cases.len(), |i| -> anyhow::Result<(Case, PredictedError)> {
            let case = cases[i];
            let same = untreated.get(&Case { treatment: Treatment::None, ..case }.name());
            match same {
                Some(error) if case.treatment == Treatment::None => Ok((case, error.clone())),
                _ => Ok((case, ask(&case, same)?)),
            }
        });
        for item in predicted {
            all.push(item?);
        }
    }
    Ok(all)
}

/// The terms of a case.
pub const TERMS: [Term; 3] = [Term::Edge, Term::Blur, Term::Clusters];

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    let source = |term| match term {
        Term::Edge => "mean of the treated kernel over a uniform field, less 1",
        Term::Blur => "mean over the exact field, less the edge",
        Term::Clusters => "photons of one history, far from faces",
        Term::Nearest | Term::Step | Term::Storage => "none",
    };
    for (case, error) in budget(settings)? {
        let sources = [case.field.setup.source(), "exact mean of the treated kernel"];
        predictions.extend(error.predictions(&case.name(), ("fluence", Unit::FLUENCE), sources, source));
    }
    predictions.extend(sheet::predict(settings)?);
    predictions.extend(spread::predict()?);
    Ok(predictions)
}

/// The error of a fixed radius at one depth of a field, for lines in figures.
pub fn line(
    field: &'static Field,
    treatment: Treatment,
    radius: f64,
    depth: f64,
    exact: &Exact,
) -> anyhow::Result<f64> {
    let case = Case {
        field,
        photons: 1,
        place: super::cases::Place::Face(depth),
        size: Size::Radius(radius),
        kernel: turbid::estimators::Kernel::Uniform,
        treatment,
    };
    expected(&case, exact, None).map(|error| error.total())
}
