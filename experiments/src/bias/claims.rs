//! The claims. Each is judged on one number a map. A margin is what the quick preset can decide: at least five of
//! the standard errors that trial runs of it had shown for the noisiest claim of its kind, so that quieter ones of the
//! same kind have more room than they need. Margins are those of the quick preset, and a full run, which detects more, is
//! judged by the same.

use super::fields::{FIELDS, Field, UNCOLLIDED};
use super::measure::{is_fano_case, path_case};
use super::results::{CaseResult, Mistake, exact_at, excess, largest, pick, predicted_fano};
use crate::harness::{Cells, Claim, Estimate, Settings, Unit};
use crate::prediction::{Term, amplitude};
use crate::setups::Body;
use crate::setups::Size;
use turbid::estimators::Kernel;
use turbid::stats::{Moments, amplitude_per_map};

/// All claims of the experiment.
pub fn all(
    settings: &Settings,
    cells: &Cells,
    results: &[CaseResult],
    mistakes: &[Mistake],
) -> anyhow::Result<Vec<Claim>> {
    let mut claims = radius_claims(results);
    claims.extend(nearest_claims(settings, results));
    claims.extend(number_claim(settings, results));
    for field in FIELDS {
        claims.extend(face_claim(results, field));
    }
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        claims.extend(blur_claim(results, field));
    }
    for field in FIELDS {
        claims.push(left_over_claim(results, field));
    }
    for field in FIELDS {
        claims.extend(fano_claim(cells, results, field)?);
    }
    claims.extend(cluster_claim(results));
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        for &depth in field.depths {
            claims.push(path_claim(cells, results, field, depth)?);
        }
    }
    claims.extend(mistake_claims(results, mistakes));
    Ok(claims)
}

/// A claim that measured over predicted error is 1 within a margin.
fn amplitude_claim(id: &str, text: &str, chosen: &[&CaseResult], margin: f64) -> Option<Claim> {
    let text = format!("{text}: measured over predicted error");
    amplitude(chosen, CaseResult::predicted)
        .map(|statistic| Claim::within(id, &text, Unit::ONE, statistic, 1.0 - margin, 1.0 + margin))
}

/// Moments of a list.
fn moments(values: impl Iterator<Item = f64>) -> Moments {
    values.collect::<Vec<f64>>().iter().collect()
}

fn is_fixed(result: &CaseResult) -> bool {
    matches!(result.case.size, Size::Radius(_))
}

/// The order in the radius: one claim a radius, since a sum over radii would hear the largest alone.
fn radius_claims(results: &[CaseResult]) -> Vec<Claim> {
    let free = &UNCOLLIDED;
    let most = largest(results, free);
    let is_free = |r: &CaseResult| r.case.field == free && r.is_whole() && r.case.photons == most;
    let mut claims = Vec::new();
    for (radius, margin) in [(0.2, 0.35), (0.4, 0.1), (0.8, 0.02)] {
        let chosen = pick(results, |r| {
            is_free(r) && r.case.size == Size::Radius(radius) && r.case.kernel == Kernel::Uniform
        });
        let text = format!("uncollided photons, whole balls of radius {radius}");
        claims.extend(amplitude_claim(&format!("uncollided-radius-{radius}"), &text, &chosen, margin));
    }
    let others = pick(results, |r| is_free(r) && is_fixed(r) && r.case.kernel != Kernel::Uniform);
    claims.extend(amplitude_claim(
        "uncollided-kernels",
        "the same, the other four kernels at radius 0.8",
        &others,
        0.05,
    ));
    claims
}

/// The orders in k and in the number of photons, where the predicted error is large enough to be detected.
fn nearest_claims(settings: &Settings, results: &[CaseResult]) -> Vec<Claim> {
    let counts = UNCOLLIDED.photons(settings);
    let mut claims = Vec::new();
    for (index, k, margin) in [(0, 50, 0.8), (0, 100, 0.5), (1, 100, 0.9), (1, 500, 0.25)] {
        let Some(&photons) = counts.get(index) else { continue };
        let chosen = pick(results, |r| {
            let c = &r.case;
            c.field == &UNCOLLIDED
                && c.photons == photons
                && c.depth >= 1.0
                && c.size == Size::Nearest(k)
                && c.kernel == Kernel::Uniform
        });
        let text = format!("uncollided photons, {k} nearest of {photons} emitted");
        claims.extend(amplitude_claim(&format!("uncollided-n{photons}-k{k}"), &text, &chosen, margin));
    }
    claims
}

/// At a fixed radius the error does not depend on the number of photons.
fn number_claim(settings: &Settings, results: &[CaseResult]) -> Option<Claim> {
    let counts = UNCOLLIDED.photons(settings);
    let find = |photons: Option<&u64>| {
        results.iter().find(|r| {
            let c = &r.case;
            c.field == &UNCOLLIDED
                && Some(&c.photons) == photons
                && c.depth == 1.0
                && c.kernel == Kernel::Uniform
                && c.size == Size::Radius(0.8)
        })
    };
    let (few, many) = (find(counts.first())?, find(counts.last())?);
    let difference = moments(few.errors.iter().zip(&many.errors).map(|(a, b)| a - b));
    let text =
        "uncollided photons, radius 0.8, depth 1: error with the fewest photons less error with the most";
    Some(Claim::within("uncollided-number", text, Unit::FRACTION, Estimate::mean(&difference), -0.016, 0.016))
}

/// At the lit face half of each ball is empty.
fn face_claim(results: &[CaseResult], field: &'static Field) -> Option<Claim> {
    let chosen = pick(results, |r| r.case.field == field && r.case.depth == 0.0);
    let text = format!("{}, at the {}, every gather", field.title, field.setup.surface());
    amplitude_claim(&format!("{}-face", field.name), &text, &chosen, 0.004 * field.slack)
}

/// Fixed radii inside the medium.
fn blur_claim(results: &[CaseResult], field: &'static Field) -> Option<Claim> {
    let chosen = pick(results, |r| r.case.field == field && is_fixed(r) && r.is_whole());
    let text = format!("{}, whole balls of fixed radius, all kernels", field.title);
    // Light that turns back at its first collision bends little: there the claim is that the blur is there.
    let margin = if field.setup.g < 0.0 { 0.7 } else { 0.2 };
    amplitude_claim(&format!("{}-blur", field.name), &text, &chosen, margin)
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
    Claim::within(
        &format!("{}-left-over", field.name),
        &format!("{}, below the {}: error left over by the prediction", field.title, below),
        Unit::FRACTION,
        Estimate::mean(&moments((0..maps).map(mean))),
        -0.0015 * field.slack,
        0.0015 * field.slack,
    )
}

/// Photons of one history cluster as predicted; independent ones do not.
fn fano_claim(cells: &Cells, results: &[CaseResult], field: &'static Field) -> anyhow::Result<Option<Claim>> {
    let most = largest(results, field);
    let mut per_case = Vec::new();
    for result in pick(results, |r| r.case.field == field && r.case.photons == most) {
        if is_fano_case(&result.case) {
            per_case.push((predicted_fano(&result.case), excess(cells, &result.case)?));
        }
    }
    let Some(maps) = per_case.first().map(|(_, excess)| excess.len()) else { return Ok(None) };
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| per_case.iter().map(|(_, e)| e[m]).collect()).collect();
    let weights: Vec<f64> =
        per_case.iter().map(|(_, excess)| 1.0 / moments(excess.iter().copied()).variance()).collect();
    let id = format!("{}-fano", field.name);
    if !field.has_clusters() {
        let ones = vec![1.0; weights.len()];
        let text = "uncollided photons: variance over mean of their counts, less 1";
        let fitted = amplitude_per_map(&ones, &per_map, &weights);
        return Ok(
            fitted.map(|a| Claim::within(&id, text, Unit::ONE, Estimate::mean(&a.moments), -0.04, 0.04))
        );
    }
    let predicted: Vec<f64> = per_case.iter().map(|(p, _)| *p).collect();
    let text = format!(
        "{}: excess of the variance of photon counts over their mean, measured over predicted",
        field.title
    );
    let fitted = amplitude_per_map(&predicted, &per_map, &weights);
    // Where little is scattered there are few clusters to see.
    let margin = if field.setup.albedo < 0.9 { 0.25 } else { 0.2 } * field.slack.min(2.0);
    Ok(fitted.map(|a| {
        Claim::within(&id, &text, Unit::ONE, Estimate::mean(&a.moments), 1.0 - margin, 1.0 + margin)
    }))
}

/// Clusters draw the k-th photon nearer: a part in a few hundred at small k, seen when all fields are taken together.
fn cluster_claim(results: &[CaseResult]) -> Option<Claim> {
    let chosen = pick(results, |r| {
        r.case.field.has_clusters() && r.is_whole() && matches!(r.case.size, Size::Nearest(4 | 10))
    });
    let text = "k = 4 and 10 in whole balls, all fogs: error from clusters of photons of one history, measured over predicted";
    amplitude(&chosen, |r| r.expected.of(Term::Clusters))
        .map(|statistic| Claim::within("clusters", text, Unit::ONE, statistic, 0.3, 1.7))
}

/// The path tracer agrees with the exact slab.
fn path_claim(
    cells: &Cells,
    results: &[CaseResult],
    field: &'static Field,
    depth: f64,
) -> anyhow::Result<Claim> {
    let (exact, _) = exact_at(results, field, depth);
    let values = cells.values(&path_case(field, depth), "fluence")?;
    let errors = moments(values.iter().map(|value| value / exact - 1.0));
    // Behind a forward peak few paths turn towards the beam, and each connection counts for more.
    let margin = if field.setup.g > 0.0 { 0.01 } else { 0.005 } * field.slack;
    let text = format!("{}, depth {depth}: error of the path tracer", field.title);
    let id = format!("{}-paths-{depth}", field.name);
    Ok(Claim::within(&id, &text, Unit::FRACTION, Estimate::mean(&errors), -margin, margin))
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
    for mistake in mistakes.iter().filter(|m| m.case.size == Size::Radius(0.4)) {
        let id = format!("{}-{}", mistake.case.field.name, mistake.name.replace(' ', "-"));
        let text = format!("wrong on purpose, {}, {}: error", mistake.case.field.title, mistake.name);
        let statistic = Estimate::mean(&mistake.error);
        claims.push(Claim::within(
            &id,
            &text,
            Unit::FRACTION,
            statistic,
            mistake.wrong - 0.01 * mistake.case.field.slack,
            mistake.wrong + 0.01 * mistake.case.field.slack,
        ));
    }
    claims
}
