//! The claims. One margin was widened after the first trial, whose noise it could not decide with: fixed radii on planes 1/2
//! apart (0.03 to 0.05).

use super::cases::Class;
use super::results::{LargeResult, Results, STANDARD_ERRORS, SampledResult, StorageResult};
use super::storage::Rule;
use crate::harness::{Claim, Estimate, PREDICTED, Unit};
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
    if let Some(result) = find(results, Rule::Fixed, 17) {
        let text = format!(
            "single against double precision, map of {:.1e} radii: root mean square difference, measured over predicted",
            result.extent_in_radii()
        );
        let statistic = result.rms.times(1.0 / result.predicted_rms);
        claims.push(Claim::about("storage-predicted", &text, Unit::ONE, statistic, 1.0, 2.0 * PREDICTED));
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
    // The k nearest on planes 1/4 apart are too noisy for a verdict.
    for (power, is_fixed) in [(-1, true), (-1, false), (-2, true)] {
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
        let rule = if is_fixed { "fixed radii" } else { "k nearest" };
        let text = format!("stored positions 2^{power} apart, {rule}: measured over predicted error");
        let id = format!("stretched{power}-{}", rule.replace(' ', "-"));
        let statistic = Estimate::mean(&amplitude.moments);
        let claim = Claim::about(&id, &text, Unit::ONE, statistic, 1.0, PREDICTED);
        let is_widened = power == -1 && is_fixed;
        claims.push(if is_widened { claim.chosen_after("margin", &[1]) } else { claim });
    }
    claims
}
