//! What theory predicts of every case, in parts, before anything is measured.

use super::cases::{CAP, Case, Size};
use super::exact::referee;
use super::fields::{FIELDS, Field};
use super::{sheet, spread};
use crate::harness::{Known, Predicted, Prediction, Settings, Unit};
use crate::theory::{Exact, nearest_clustering, referee_kernel};
use anyhow::Context;
use rayon::prelude::*;
use std::collections::HashMap;
use turbid::estimators::boundary::Treatment;
use turbid_analytic::boundary::{
    self as referee, Body, nearest_treated_mean_symmetric, nearest_treated_mean_uniform,
    treated_mean_symmetric, treated_mean_uniform,
};

/// The predicted error of a case in parts, each as a fraction of the exact fluence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Exact fluence per unit irradiance.
    pub exact: f64,
    /// What the estimate makes of a uniform field, less 1.
    pub edge: f64,
    /// The field bends inside the ball: all else that independent photons do.
    pub blur: f64,
    /// Photons of one history cluster, which draws the k-th photon nearer: rough beside a face.
    pub clusters: f64,
    /// Bound on the numerical error of the sum.
    pub error: f64,
}

impl Predicted for Parts {
    fn exact(&self) -> f64 {
        self.exact
    }

    fn total(&self) -> f64 {
        self.edge + self.blur + self.clusters
    }

    fn bound(&self) -> f64 {
        self.error
    }
}

/// The parts of one case; `untreated` are those of the same without a treatment, if they are known.
fn parts(case: &Case, exact: &Exact, untreated: Option<&Parts>) -> anyhow::Result<Parts> {
    let Case { field, spot, .. } = *case;
    let (treatment, kernel) = (referee(case.treatment), referee_kernel(case.kernel));
    let (here, here_error) = exact(spot.depth())?;
    let (body, at) = (field.body, case.place());
    let density = field.density(case.photons);
    let of_place = |x: f64| {
        // The referee's coordinate is the depth in a slab, the distance from the centre in a sphere.
        let depth = if let Body::Sphere { radius } = body { radius - x } else { x };
        exact(depth).map_or(f64::NAN, |(value, _)| value)
    };
    let (uniform, bent, clusters) = match case.size {
        Size::Radius(r) => {
            let uniform = treated_mean_uniform(treatment, kernel, body, at, r)?;
            let bent = match field.is_furnace() {
                true => None,
                false => Some(treated_mean_symmetric(treatment, kernel, body, at, r, of_place)?),
            };
            (uniform, bent, 0.0)
        }
        Size::Nearest(k) => {
            let neighbors = u32::try_from(k)?;
            let uniform =
                nearest_treated_mean_uniform(treatment, kernel, neighbors, CAP, body, at, density * here)?;
            let bent = match field.is_furnace() {
                true => None,
                false => Some(nearest_treated_mean_symmetric(
                    treatment, kernel, neighbors, CAP, body, at, density, of_place,
                )?),
            };
            // Where the medium ends inside the ball, neighbours are missing like the ball's own part.
            let plain = referee::Treatment::None;
            let inside = match untreated {
                Some(parts) => 1.0 + parts.edge,
                None if treatment == plain => uniform.value,
                None => {
                    let here = density * here;
                    nearest_treated_mean_uniform(plain, kernel, neighbors, CAP, body, at, here)?.value
                }
            };
            let raised = nearest_clustering(field.albedo, field.g, density * here * inside, k);
            (uniform, bent, raised * inside * uniform.value)
        }
    };
    let blur = bent.map_or(0.0, |bent| bent.value / here - uniform.value);
    let bent_error = bent.map_or(0.0, |bent| bent.error / here);
    let error = uniform.error + bent_error + here_error / here;
    Ok(Parts { exact: here, edge: uniform.value - 1.0, blur, clusters, error })
}

/// All cases of a study with their parts, computed in parallel.
fn budget(settings: &Settings) -> anyhow::Result<Vec<(Case, Parts)>> {
    let mut all = Vec::new();
    for field in &FIELDS {
        let exact = field.exact()?;
        let cases: Vec<Case> =
            field.sizes(settings).into_iter().flat_map(|(n, _)| Case::all(settings, field, n)).collect();
        let ask = |case: &Case, untreated| parts(case, &exact, untreated).with_context(|| case.name());
        let untreated: HashMap<String, Parts> = cases
            .par_iter()
            .filter(|case| case.treatment == Treatment::None)
            .map(|case| Ok((case.name(), ask(case, None)?)))
            .collect::<anyhow::Result<_>>()?;
        let predicted: Vec<(Case, Parts)> = cases
            .into_par_iter()
            .map(|case| {
                let same = untreated.get(&Case { treatment: Treatment::None, ..case }.name());
                match same {
                    Some(parts) if case.treatment == Treatment::None => Ok((case, *parts)),
                    _ => Ok((case, ask(&case, same)?)),
                }
            })
            .collect::<anyhow::Result<_>>()?;
        all.extend(predicted);
    }
    Ok(all)
}

const PARTS: [&str; 3] = ["edge", "blur", "clusters"];

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for (case, parts) in budget(settings)? {
        let mut add = |quantity: &str, unit, value: f64, error: f64, source: &str| {
            let (case, quantity, source) = (case.name(), quantity.to_string(), source.to_string());
            predictions.push(Prediction { case, quantity, unit, value, error, source });
        };
        add("exact fluence", Unit::FLUENCE, parts.exact, 0.0, case.field.source());
        let fluence = parts.exact * (1.0 + parts.total());
        add("fluence", Unit::FLUENCE, fluence, parts.exact * parts.error, "exact mean of the treated kernel");
        add("error", Unit::PERCENT, 100.0 * parts.total(), 100.0 * parts.error, "sum of the parts");
        let sources = [
            "mean of the treated kernel over a uniform field, less 1",
            "mean over the exact field, less the edge",
            "photons of one history, far from faces",
        ];
        for ((name, value), source) in PARTS.iter().zip([parts.edge, parts.blur, parts.clusters]).zip(sources)
        {
            add(&format!("error from {name}"), Unit::PERCENT, 100.0 * value, 100.0 * parts.error, source);
        }
    }
    predictions.extend(sheet::predict(settings)?);
    predictions.extend(spread::predict()?);
    Ok(predictions)
}

/// The parts of a case, as they were written down.
pub fn recall(known: &Known, case: &Case) -> anyhow::Result<Parts> {
    let name = case.name();
    let [edge, blur, clusters] = PARTS;
    Ok(Parts {
        exact: known.get(&name, "exact fluence")?.0,
        edge: known.part(&name, edge)?,
        blur: known.part(&name, blur)?,
        clusters: known.part(&name, clusters)?,
        error: known.get(&name, "error")?.1 / 100.0,
    })
}

/// The error of a fixed radius at one depth of a field [%], for lines in figures.
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
        spot: super::cases::Spot::Face(depth),
        size: Size::Radius(radius),
        kernel: turbid::estimators::Kernel::Uniform,
        treatment,
    };
    parts(&case, exact, None).map(|p| 100.0 * p.total())
}
