//! The claims. Margins are what the quick preset can decide: at least five of the standard errors that trial runs of it
//! had shown. One was widened after the first trial for that reason: fixed radii on planes 1/2 apart (0.03 to 0.05).

use super::cases::Class;
use super::results::{LargeResult, Results, STANDARD_ERRORS, SampledResult, StorageResult};
use super::storage::Rule;
use crate::harness::{Claim, Estimate, Unit};
use crate::setups::Size;
use turbid::stats::{Moments, amplitude_per_map};

/// All claims of the experiment.
pub fn all(results: &Results) -> Vec<Claim> {
    let mut claims = counts(results);
    claims.extend(Class::SAMPLED.map(|class| class_claim(results, class)));
    claims.extend(storage_claims(results));
    claims.extend(stretched_claims(results));
    claims
}

/// Counts that must be 0.
fn counts(results: &Results) -> Vec<Claim> {
    let none = |id: &str, text: &str, count: f64| {
        Claim::within(id, text, Unit::ONE, Estimate::exact(count, 0.0), 0.0, 0.0)
    };
    let wrong = |class: Option<Class>| {
        let of_class = results.checked.iter().filter(|r| class.is_none_or(|c| r.class == c));
        of_class.filter(|r| !r.is_right()).count() as f64
    };
    let lost = results.lost();
    let mut claims = vec![
        none("non-finite", "numbers that are not finite, over all rows", lost),
        none("checked", "computed checks beyond their roundings", wrong(None)),
        none(
            "scale",
            "units of length, 2^-40 to 2^40, in which any bit of any result changes",
            wrong(Some(Class::Scale)),
        ),
        none(
            "refusals",
            "questions without answer that are not refused by name",
            wrong(Some(Class::Refusal)),
        ),
    ];
    let rounding = Estimate::exact(results.rounding, 1e-6);
    let text = "largest error of a stored coordinate over the tree's stated resolution";
    claims.push(Claim::at_most("resolution", text, Unit::ONE, rounding, 1.0 + 2e-6));
    claims
}

/// The worst row of a class, as one test: the smallest p-value times their number (Bonferroni). Every row counts alike,
/// however precise its neighbours are; what bias each can show is a column of its table.
fn class_claim(results: &Results, class: Class) -> Claim {
    let mut p_values: Vec<f64> =
        results.sampled.iter().filter(|r| r.class == class).map(SampledResult::p).collect();
    if class == Class::Number {
        p_values.extend(results.large.iter().map(LargeResult::p));
    }
    let text = format!(
        "{} rows about {}: the farthest from its exact value is no farther than chance takes it",
        p_values.len(),
        about(class)
    );
    let worst = p_values.iter().fold(1.0f64, |least, p| least.min(*p));
    Claim::fits(&format!("rows-{}", class.name()), &text, (p_values.len() as f64 * worst).min(1.0))
}

fn about(class: Class) -> &'static str {
    match class {
        Class::Thickness => "optical thickness, 1e-12 to 1e6",
        Class::Albedo => "albedo, 0 to 1",
        Class::Asymmetry => "asymmetry, to 1-1e-9 both ways",
        Class::Position => "distance from the origin, to 1e9 mean free paths",
        Class::Number => "passes of few photons",
        Class::Faces => "light along and across faces",
        Class::Ordinary => "ordinary media, with thirty times the histories",
        Class::Scale | Class::Nearest | Class::Coincident | Class::Refusal => class.name(),
    }
}

fn find(results: &Results, rule: Rule, power: i32) -> Option<&StorageResult> {
    results.storage.iter().find(|r| r.rule == rule && r.power == power)
}

fn storage_claims(results: &Results) -> Vec<Claim> {
    let mut claims = Vec::new();
    for rule in Rule::ALL {
        let Some(result) = find(results, rule, 7) else { continue };
        let text = format!(
            "single against double precision, {}, map of {} radii: root mean square difference",
            rule.name(),
            result.extent_in_radii()
        );
        let id = format!("storage-{}", rule.name().replace('=', ""));
        claims.push(Claim::at_most(&id, &text, STANDARD_ERRORS, result.rms, 0.01));
    }
    for (power, margin) in [(13, 0.15), (17, 0.1), (19, 0.1)] {
        let Some(result) = find(results, Rule::Fixed, power) else { continue };
        let text = format!(
            "single against double precision, map of {:.1e} radii: root mean square difference, measured over predicted",
            result.extent_in_radii()
        );
        let statistic = result.rms.times(1.0 / result.predicted_rms);
        let id = format!("storage-predicted-{power}");
        claims.push(Claim::within(&id, &text, Unit::ONE, statistic, 1.0 - margin, 1.0 + margin));
    }
    if let Some(result) = find(results, Rule::Fixed, 21) {
        let text = "a map of 1.3e7 radii in single precision, wrong on purpose: mean difference from double precision";
        let statistic = Estimate::mean(&result.difference);
        claims.push(Claim::detected("storage-too-long", text, Unit::FRACTION, statistic, 0.0, 0.03));
    }
    claims
}

/// Measured over predicted error of the stretched maps, one amplitude a map.
fn stretched_claims(results: &Results) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (power, margin) in [(-1, 0.05), (-2, 0.05)] {
        for is_fixed in [true, false] {
            let chosen: Vec<_> = results
                .stretched
                .iter()
                .filter(|r| r.case.power == power && matches!(r.case.size, Size::Radius(_)) == is_fixed)
                .collect();
            let Some(maps) = chosen.iter().map(|r| r.errors.len()).min() else { continue };
            let predicted: Vec<f64> = chosen.iter().map(|r| r.predicted.0).collect();
            let variance = |errors: &[f64]| errors.iter().collect::<Moments>().variance();
            let weights: Vec<f64> = chosen.iter().map(|r| 1.0 / variance(&r.errors)).collect();
            let per_map: Vec<Vec<f64>> =
                (0..maps).map(|m| chosen.iter().map(|r| r.errors[m]).collect()).collect();
            let Some(amplitude) = amplitude_per_map(&predicted, &per_map, &weights) else { continue };
            let (rule, margin) = if is_fixed { ("fixed radii", margin) } else { ("k nearest", 4.0 * margin) };
            let text = format!("stored positions 2^{power} apart, {rule}: measured over predicted error");
            let id = format!("stretched{power}-{}", rule.replace(' ', "-"));
            let statistic = Estimate::mean(&amplitude.moments);
            claims.push(Claim::within(&id, &text, Unit::ONE, statistic, 1.0 - margin, 1.0 + margin));
        }
    }
    claims
}
