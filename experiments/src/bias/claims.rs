//! The claims. Each is judged on one number a map, or on the mean of independent fields. What is too noisy for a margin
//! that would interest anybody (single radii below 0.8, the k nearest of uncollided photons, clusters at small k, the blur of
//! a single field) is in the tables and results, and in the error budget, without a verdict.

use super::fields::{FIELDS, Field, UNCOLLIDED};
use super::measure::{is_fano_case, path_case};
use super::results::{CaseResult, Mistake, exact_at, excess, largest, pick, predicted_fano};
use crate::harness::{Cells, Claim, Estimate, LEFT_OVER, PREDICTED, Unit};
use crate::prediction::{Term, amplitude};
use crate::setups::Body;
use crate::setups::Size;
use turbid::estimators::Kernel;
use turbid::stats::{Moments, amplitude_per_map};

/// What the prediction of a field's errors may leave over, of the exact value.
const UNEXPLAINED: f64 = 0.002;

/// All claims of the experiment.
pub fn all(cells: &Cells, results: &[CaseResult], mistakes: &[Mistake]) -> anyhow::Result<Vec<Claim>> {
    let mut claims = radius_claims(results);
    for field in FIELDS {
        claims.extend(face_claim(results, field));
    }
    claims.extend(blur_claim(results));
    for field in FIELDS {
        claims.push(left_over_claim(results, field));
    }
    claims.extend(fano_claims(cells, results)?);
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        claims.push(path_claim(cells, results, field)?);
    }
    claims.extend(mistake_claims(results, mistakes));
    Ok(claims)
}

/// A claim that measured over predicted error is 1 within a margin.
fn amplitude_claim(id: &str, text: &str, chosen: &[&CaseResult], margin: f64) -> Option<Claim> {
    let text = format!("{text}: measured over predicted error");
    amplitude(chosen, CaseResult::predicted)
        .map(|statistic| Claim::about(id, &text, Unit::ONE, statistic, 1.0, margin))
}

/// Moments of a list.
fn moments(values: impl Iterator<Item = f64>) -> Moments {
    values.collect::<Vec<f64>>().iter().collect()
}

fn is_fixed(result: &CaseResult) -> bool {
    matches!(result.case.size, Size::Radius(_))
}

/// Where blur is large beside noise.
fn radius_claims(results: &[CaseResult]) -> Vec<Claim> {
    let free = &UNCOLLIDED;
    let most = largest(results, free);
    let is_free = |r: &CaseResult| r.case.field == free && r.is_whole() && r.case.photons == most;
    let uniform =
        pick(results, |r| is_free(r) && r.case.size == Size::Radius(0.8) && r.case.kernel == Kernel::Uniform);
    let others = pick(results, |r| is_free(r) && is_fixed(r) && r.case.kernel != Kernel::Uniform);
    let text = "uncollided photons, whole balls of radius 0.8";
    let mut claims = Vec::new();
    claims.extend(amplitude_claim("uncollided-blur", text, &uniform, PREDICTED));
    claims.extend(amplitude_claim(
        "uncollided-kernels",
        "the same, the other four kernels",
        &others,
        PREDICTED,
    ));
    claims
}

/// At the lit face half of each ball is empty.
fn face_claim(results: &[CaseResult], field: &'static Field) -> Option<Claim> {
    let chosen = pick(results, |r| r.case.field == field && r.case.depth == 0.0);
    let text = format!("{}, at the {}, every gather", field.title, field.setup.surface());
    amplitude_claim(&format!("{}-face", field.name), &text, &chosen, LEFT_OVER * field.slack)
}

/// Fixed radii inside the medium, all fields together: light that was scattered bends little, and one field is noisy.
fn blur_claim(results: &[CaseResult]) -> Option<Claim> {
    let chosen = pick(results, |r| r.case.field.has_clusters() && is_fixed(r) && r.is_whole());
    amplitude_claim(
        "blur",
        "scattered light, whole balls of fixed radius, all fields and kernels",
        &chosen,
        2.0 * PREDICTED,
    )
}

/// Mean of what is left over in all cases below the face, weighted by what all maps say of the noise.
fn left_over_claim(results: &[CaseResult], field: &'static Field) -> Claim {
    let chosen = pick(results, |r| r.case.field == field && r.case.depth > 0.0);
    let maps = chosen.iter().map(|r| r.errors.len()).min().unwrap_or(0);
    let weights: Vec<f64> = chosen.iter().map(|r| 1.0 / r.error.variance()).collect();
    let sum: f64 = weights.iter().sum();
    let mean = |m: usize| {
        let one = |(r, w): (&&CaseResult, &f64)| w * (r.errors[m] - r.predicted());
        chosen.iter().zip(&weights).map(one).sum::<f64>() / sum
    };
    let below = if let Body::Slab { .. } = field.setup.body { "face" } else { "surface" };
    Claim::about(
        &format!("{}-left-over", field.name),
        &format!("{}, below the {}: error left over by the prediction", field.title, below),
        Unit::FRACTION,
        Estimate::mean(&moments((0..maps).map(mean))),
        0.0,
        UNEXPLAINED * field.slack,
    )
}

/// Photons of one history cluster as predicted; independent ones do not.
fn fano_claims(cells: &Cells, results: &[CaseResult]) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    let text = "uncollided photons: variance over mean of their counts, less 1";
    let of_free = fano(cells, results, |field| field == &UNCOLLIDED)?;
    claims.extend(of_free.map(|s| Claim::about("uncollided-fano", text, Unit::ONE, s, 0.0, PREDICTED)));
    let text = "photons in fog, all fields: excess of the variance of their counts over the mean, measured over predicted";
    let of_fog = fano(cells, results, Field::has_clusters)?;
    claims.extend(of_fog.map(|s| Claim::about("fano", text, Unit::ONE, s, 1.0, 2.0 * PREDICTED)));
    Ok(claims)
}

/// The excess of some fields, over what is predicted where anything is: one number a map.
fn fano(
    cells: &Cells,
    results: &[CaseResult],
    is_chosen: impl Fn(&Field) -> bool,
) -> anyhow::Result<Option<Estimate>> {
    let mut cases = Vec::new();
    for field in FIELDS.into_iter().filter(|field| is_chosen(field)) {
        let most = largest(results, field);
        for result in pick(results, |r| r.case.field == field && r.case.photons == most) {
            if is_fano_case(&result.case) {
                let predicted = if field.has_clusters() { predicted_fano(&result.case) } else { 1.0 };
                cases.push((predicted, excess(cells, &result.case)?));
            }
        }
    }
    let Some(maps) = cases.iter().map(|(_, excess)| excess.len()).min() else { return Ok(None) };
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| cases.iter().map(|(_, e)| e[m]).collect()).collect();
    let weights: Vec<f64> = cases.iter().map(|(_, e)| 1.0 / moments(e.iter().copied()).variance()).collect();
    let predicted: Vec<f64> = cases.iter().map(|(p, _)| *p).collect();
    Ok(amplitude_per_map(&predicted, &per_map, &weights).map(|a| Estimate::mean(&a.moments)))
}

/// The path tracer agrees with the exact solution, on the mean over depths.
fn path_claim(cells: &Cells, results: &[CaseResult], field: &'static Field) -> anyhow::Result<Claim> {
    let mut lists = Vec::new();
    for &depth in field.depths {
        let (exact, _) = exact_at(results, field, depth);
        let values = cells.values(&path_case(field, depth), "fluence")?;
        lists.push(values.iter().map(|value| value / exact - 1.0).collect::<Vec<f64>>());
    }
    let batches = lists.iter().map(Vec::len).min().unwrap_or(0);
    let mean = |i: usize| lists.iter().map(|errors| errors[i]).sum::<f64>() / lists.len() as f64;
    let text = format!("{}: error of the path tracer, averaged over depth", field.title);
    let statistic = Estimate::mean(&moments((0..batches).map(mean)));
    Ok(Claim::about(&format!("{}-paths", field.name), &text, Unit::FRACTION, statistic, 0.0, LEFT_OVER))
}

/// The wrong estimators are wrong: the rule that sums all k photons is detected to be, and those that divide by a wrong number,
/// which no estimate could hide, are wrong by what was predicted of them.
fn mistake_claims(results: &[CaseResult], mistakes: &[Mistake]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let most = largest(results, &UNCOLLIDED);
    let biased = results.iter().find(|r| {
        let c = &r.case;
        c.field == &UNCOLLIDED
            && c.photons == most
            && c.depth == 1.0
            && c.is_biased
            && c.size == Size::Nearest(10)
    });
    if let Some(result) = biased {
        let right = result.expected.total() - result.expected.of(Term::Nearest);
        let text = "wrong on purpose, all k photons summed, k = 10: error";
        let statistic = Estimate::mean(&result.error);
        claims.push(Claim::detected("biased-k", text, Unit::FRACTION, statistic, right, 0.05));
    }
    for name in Mistake::NAMES {
        let of_name = |m: &&Mistake| m.name == name && m.case.size == Size::Radius(0.4);
        let fields: Vec<Estimate> =
            mistakes.iter().filter(of_name).map(|m| Estimate::mean(&m.error).minus(m.wrong)).collect();
        let text =
            format!("wrong on purpose, {name}, all fields: error less the one predicted of the mistake");
        claims.extend(Estimate::average(&fields).map(|statistic| {
            Claim::about(&name.replace(' ', "-"), &text, Unit::FRACTION, statistic, 0.0, 2.0 * LEFT_OVER)
        }));
    }
    claims
}
