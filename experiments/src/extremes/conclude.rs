//! What all cells together say.

use super::measure::large_cases;
use super::predict::class_of;
use super::results::{
    CheckedResult, LargeResult, Results, STANDARD_ERRORS, SampledResult, StorageResult, StretchedResult,
};
use super::storage::{self, Rule};
use super::stretched::{self, Case};
use super::{claims, figures, sampled, tables};
use crate::harness::{Cells, Estimate, Row, Section, Settings, Unit, number, percent, with_error};
use crate::prediction::{Entry, Prediction, Predictions, Term};
use anyhow::Context;
use turbid::stats::{Moments, jackknife};

fn moments(values: &[f64]) -> Moments {
    values.iter().collect()
}

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let results = gather(settings, predictions, cells)?;
    let mut section = Section { rows: rows(&results)?, ..Section::default() };
    section.budget = budget(&results, predictions)?;
    section.claims = claims::all(&results);
    section.figures = figures::all(&results)?;
    section.tables = vec![tables::sampled(&results), tables::checked(&results), tables::storage(&results)];
    summarise(&mut section, settings, &results);
    Ok(section)
}

fn gather(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Results> {
    let known = Predictions::new(predictions);
    let find = |case: &str, quantity: &str| known.get(case, quantity);
    let mut non_finite = Vec::new();
    for (case, quantity) in cells.keys().filter(|(_, quantity)| *quantity == "non-finite") {
        let count: f64 = cells.values(case, quantity)?.iter().sum();
        if count > 0.0 {
            non_finite.push((case.to_string(), count));
        }
    }
    let mut sampled_results = Vec::new();
    for row in sampled::all() {
        let values = cells.values(&row.name, "value")?;
        let (exact, moments) = (find(&row.name, "value")?, moments(&values));
        let (class, unit) = (row.class, row.unit());
        sampled_results.push(SampledResult { class, name: row.name, unit, exact, values, moments });
    }
    let mut checked = Vec::new();
    for (case, _) in cells.keys().filter(|(_, quantity)| *quantity == "bound") {
        let class = class_of(case).with_context(|| format!("{case} is of no class"))?;
        let name = case.split_once(": ").map_or(case, |(_, name)| name).to_string();
        let one = |quantity: &str| anyhow::Ok(cells.values(case, quantity)?[0]);
        let value = if cells.keys().any(|key| key == (case, "value")) { one("value")? } else { f64::MAX };
        checked.push(CheckedResult { class, name, value, exact: one("exact")?, bound: one("bound")? });
    }
    checked.sort_by_key(|row| row.class);
    let mut large = Vec::new();
    for (name, ..) in large_cases(settings)? {
        let count = (cells.values(&name, "count")?[0], cells.values(&name, "emitted")?[0]);
        let exact = find(&name, "rate")?;
        large.push(LargeResult { name, count, exact });
    }
    let mut storage_results = Vec::new();
    let mut rounding = 0.0f64;
    for rule in Rule::ALL {
        let name = storage::case_double(rule);
        let (mean, square) = (cells.values(&name, "error")?, cells.values(&name, "squared error")?);
        for power in storage::POWERS {
            let name = storage::case(rule, power);
            if rule == Rule::Fixed {
                let worst = cells.values(&name, "rounding over resolution")?;
                rounding = worst.into_iter().fold(rounding, f64::max);
            }
            let squared = cells.values(&name, "squared difference")?;
            let maps: Vec<[f64; 3]> = (0..squared.len()).map(|m| [squared[m], mean[m], square[m]]).collect();
            storage_results.push(StorageResult {
                rule,
                power,
                predicted: find(&name, "difference")?,
                predicted_rms: find(&name, "rms difference")?.0,
                difference: cells.moments(&name, "difference")?,
                rms: Estimate::jackknife(&jackknife(&maps, ratio)),
                moved: cells.values(&name, "photons moved")?.iter().sum(),
                errors: cells.values(&name, "error")?,
            });
        }
    }
    let mut stretched_results = Vec::new();
    for case in stretched::POWERS.into_iter().flat_map(Case::all) {
        let (predicted, errors) = (find(&case.name(), "error")?, cells.values(&case.name(), "error")?);
        stretched_results.push(StretchedResult { case, predicted, errors });
    }
    Ok(Results {
        sampled: sampled_results,
        checked,
        large,
        storage: storage_results,
        stretched: stretched_results,
        non_finite,
        rounding,
    })
}

/// Root mean square difference over the standard deviation of an estimate, from [squared difference, error, squared
/// error] of each map.
fn ratio(maps: &[[f64; 3]]) -> f64 {
    let mean = |i: usize| maps.iter().map(|m| m[i]).sum::<f64>() / maps.len() as f64;
    (mean(0) / (mean(2) - mean(1) * mean(1))).sqrt()
}

fn rows(results: &Results) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for r in &results.sampled {
        let n = r.values.len() as u64;
        let row = if r.moments.std_error() > 0.0 {
            Row::measured(&r.name, "value", r.unit, &r.moments)?
        } else {
            Row::count(&r.name, "value", r.unit, n, r.moments.mean() as u64 * n)
        };
        rows.push(row.reference(r.exact.0, r.exact.1));
    }
    for r in &results.checked {
        let name = format!("{}: {}", r.class.name(), r.name);
        rows.push(Row::exact(&name, "value", Unit::ONE, r.value, r.bound).reference(r.exact, r.bound));
    }
    for r in &results.large {
        let row = Row::count(&r.name, "rate", Unit::ONE, r.count.1 as u64, r.count.0 as u64);
        rows.push(row.reference(r.exact.0, r.exact.1));
    }
    for r in &results.storage {
        let name = storage::case(r.rule, r.power);
        if r.difference.std_error() > 0.0 && r.rms.std_error() > 0.0 {
            rows.push(Row::measured(&name, "difference", Unit::FRACTION, &r.difference)?);
            rows.push(Row::estimated(&name, "rms difference", STANDARD_ERRORS, &r.rms)?);
        }
    }
    for r in &results.stretched {
        rows.push(Row::measured(&r.case.name(), "error", Unit::FRACTION, &moments(&r.errors))?);
    }
    Ok(rows)
}

/// Whether a gather stands in the study's budget. Extents share their photons, so that more of them below the noise
/// would say the same again; and what a lattice makes of the clusters of one history at k nearest is not predicted.
fn is_budgeted(result: &StorageResult) -> bool {
    match result.rule {
        Rule::Fixed => [3, 18, 19, 20, 21].contains(&result.power),
        Rule::Nearest => result.power == 3,
    }
}

fn budget(results: &Results, predictions: &[Prediction]) -> anyhow::Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for r in results.storage.iter().filter(|r| is_budgeted(r)) {
        let name = storage::case(r.rule, r.power);
        let whole = predictions.iter().find(|p| p.case == name && p.quantity == "error");
        let whole = whole.with_context(|| format!("no prediction of the error of {name}"))?;
        let (storage, clusters) = (r.predicted.0, whole.value - r.predicted.0);
        let terms = [(Term::Storage, storage), (Term::Clusters, clusters)];
        entries.push(Entry::new("extremes-storage", name, &terms, whole.error, r.errors.clone()));
    }
    for r in &results.stretched {
        let group = format!("extremes-{}", stretched::group(r.case.power));
        let terms = [(Term::Storage, r.predicted.0)];
        entries.push(Entry::new(group, r.case.name(), &terms, r.predicted.1, r.errors.clone()));
    }
    Ok(entries)
}

fn summarise(section: &mut Section, settings: &Settings, results: &Results) {
    let z: Vec<f64> = results
        .sampled
        .iter()
        .map(SampledResult::z)
        .chain(results.large.iter().map(LargeResult::z))
        .collect();
    let right = results.checked.iter().filter(|r| r.is_right()).count();
    let largest = z.iter().fold(0.0f64, |most, z| most.max(z.abs()));
    let mut visible: Vec<f64> = results
        .sampled
        .iter()
        .filter_map(SampledResult::smallest_bias)
        .chain(results.large.iter().map(LargeResult::smallest_bias))
        .map(percent)
        .collect();
    visible.sort_by(f64::total_cmp);
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / z.len().max(1) as f64).sqrt();
    let at = |power: i32| results.storage.iter().find(|r| r.rule == Rule::Fixed && r.power == power);
    let (near, far) = (at(7), at(21));
    if let (Some(near), Some(far)) = (near, far) {
        section.summary.push(format!(
            "At the extremes of thickness, albedo, peak, length and number, {} finite and {right} of {} computed \
             checks are within their roundings; single precision in the tree moves an estimate by {} of its standard \
             errors where the map is {} gather radii long; at {} radii it has an error of {:.1} %.",
            if results.lost() == 0.0 { "every number is".to_string() } else { format!("all but {} numbers are", number(results.lost())) },
            results.checked.len(),
            number(near.rms.value()),
            number(near.extent_in_radii()),
            number(far.extent_in_radii()),
            percent(far.difference.mean())
        ).replace('-', "−"));
    }
    section.summary.push(format!(
        "{} sampled rows stand against exact values: their distances have a root mean square of {rms:.2} standard \
         errors and are at most {largest:.1}. The smallest bias that a row would hardly ever miss is {} % of its value in \
         the middle of these rows and {} % in the least precise of them.",
        z.len(),
        number(visible.get(visible.len() / 2).copied().unwrap_or(f64::NAN)),
        number(visible.last().copied().unwrap_or(f64::NAN)),
    ));
    section.summary.push(
        "The storage question is settled by asking one set of photons twice, in single precision in the tree and in \
         double precision by a plain search. At a fixed radius the difference is what theory says of points on a \
         lattice: photons near the rim of the ball change sides, a random error that grows as the root of the extent, and the lattice sum \
         differs from the volume, a systematic one that grows as its square. Both are far below the noise at any \
         extent that a scene of fog has; a map whose one distant photon lies ten million gather radii away shows them."
            .to_string(),
    );
    section.notes.extend(surprises(results));
    section.notes.push(
        "Without absorption a slab of optical thickness 1e6 takes 1e12 collisions a history: it is followed to order \
         32, whose exact reflectance a slab of 60 mean free paths gives. White slabs are followed to the end up to a \
         thickness of 300."
            .to_string(),
    );
    section.notes.push(format!(
        "The largest pass emits {} photons and keeps those of the middle of its cell, a twenty-fifth of its area: a \
         map of all of 1e8 photons would fit in memory, at 42 bytes each, but not beside its records while it is \
         built.",
        number(super::measure::large(settings) as f64)
    ));
    section.notes.push(
        "No analog photon is scattered at albedo 1e−12, and none is absorbed at 1 − 1e−12: the first is measured by \
         paths, which carry the albedo as a weight, the second against a slab that differs from the white one by 1e−12 \
         of itself. At |g| = 1 − 1e−9 no exact slab is known; the furnace is exact at any g."
            .to_string(),
    );
    section.notes.push(
        "A scattering angle of negative g comes from a number of 53 bits near 1: at g = −(1 − 1e−9) its steps are a \
         ten-millionth of the peak's width, which the bound of that row allows and no simulation could see."
            .to_string(),
    );
    section.notes.push(
        "Rows have no margin: of each class the farthest is tested, and its table says what bias each row could show. \
         Of a white slab of thickness 1000 too few histories come through for an error bar; 300 stands for it."
            .to_string(),
    );
    section.notes.push(
        "What a lattice makes of the clusters of one history at k nearest is not predicted: such gathers stand in the \
         study's budget only where storage is far below the noise."
            .to_string(),
    );
}

/// Where the difference of the k nearest is not what was predicted, if it is anywhere.
fn surprises(results: &Results) -> Option<String> {
    let off: Vec<String> = results
        .storage
        .iter()
        .filter(|r| r.rule == Rule::Nearest)
        .filter(|r| (r.rms.value() - r.predicted_rms).abs() > 5.0 * r.rms.std_error())
        .map(|r| {
            let measured = with_error(r.rms.value(), r.rms.std_error());
            format!("2^{}: {measured} for {}", r.power, number(r.predicted_rms))
        })
        .collect();
    let sizes = Rule::Nearest.name();
    (!off.is_empty()).then(|| {
        format!(
            "Surprise: at {sizes} the root mean square difference is more than five standard errors from its prediction \
             at these extents, measured for predicted: {}. The prediction joins two limits by taking the smaller: a radius \
             that is rounded while no photon changes sides, and photons that change sides as at a fixed radius of the mean \
             size. Between the two neither holds. To both it adds the roundings of the arithmetic by their number, not by \
             their spread, which is too much at short extents. No claim rests on it.",
            off.join("; ")
        )
    })
}
