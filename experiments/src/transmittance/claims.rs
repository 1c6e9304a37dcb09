//! The claims.

use super::cases::{Case, LEVELS, Method, PLACES, RAMP, UNBIASED, level_name};
use super::rays::{Profile, Way};
use super::results::{CaseResult, NORMAL, THICK, find, gain, light};
use crate::harness::{Cells, Claim, Estimate, PREDICTED, Unit};
use crate::prediction::{Compared, Predictions, amplitude};
use crate::theory::{exponent, exponent_of_means};

/// How far a ratio of two methods' work may lie from the predicted one, relative: a ratio of four means, whose standard error
/// in the quick preset is some 3 per cent.
const GAIN: f64 = 0.2;

/// How far the mean of an unbiased method may lie from T, relative.
const MEAN: f64 = 0.02;

/// The noise through which methods are compared.
pub const NOISE: Way = Way { profile: Profile::Noise, depth: 2.0 };
/// The cloud.
pub const CLOUD: Way = Way { profile: Profile::Cloud, depth: 2.0 };

/// All claims.
pub fn claims(results: &[CaseResult], known: &Predictions, cells: &Cells) -> anyhow::Result<Vec<Claim>> {
    let mut claims = variances(results);
    claims.extend(means(results));
    claims.extend(marches(results));
    claims.extend(gains(results));
    claims.push(levels(known, cells)?);
    Ok(claims)
}

/// Cases of a method that a rule admits.
fn of_method(results: &[CaseResult], method: Method, is_in: fn(&CaseResult) -> bool) -> Vec<&CaseResult> {
    results.iter().filter(|r| r.case().method == method && is_in(r)).collect()
}

/// Mean over rays of a statistic of each; rays share no cells.
fn over_rays(chosen: &[&CaseResult], of: impl Fn(&CaseResult) -> Estimate) -> Option<Estimate> {
    Estimate::average(&chosen.iter().map(|r| of(r)).collect::<Vec<_>>())
}

fn variances(results: &[CaseResult]) -> Vec<Claim> {
    let of = |method: Method| {
        let chosen = of_method(results, method, CaseResult::is_light);
        let statistic = over_rays(&chosen, CaseResult::over_predicted)?;
        let (title, most) = (method.title(), light(method));
        let text = format!(
            "{title}, rays of relative variance up to {most} and depth up to {THICK}: measured over predicted variance"
        );
        let id = format!("variance-{}", method.name());
        Some(Claim::about(&id, &text, Unit::ONE, statistic, 1.0, PREDICTED))
    };
    UNBIASED.into_iter().filter(|m| m.has_known_spread()).filter_map(of).collect()
}

fn means(results: &[CaseResult]) -> Vec<Claim> {
    let of = |method: Method| {
        let chosen = of_method(results, method, CaseResult::is_normal);
        let statistic = over_rays(&chosen, |r| Estimate::mean(&r.mean.error))?;
        let title = method.title();
        let text = format!("{title}, rays of relative variance up to {NORMAL}: error of the mean");
        let id = format!("mean-{}", method.name());
        Some(Claim::about(&id, &text, Unit::FRACTION, statistic, 0.0, MEAN))
    };
    UNBIASED.into_iter().filter_map(of).collect()
}

fn marches(results: &[CaseResult]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let (march, left) = (Method::March(PLACES), Method::Jackknife(PLACES));
    let chosen = of_method(results, march, CaseResult::is_light);
    let of_marches: Vec<&Compared<Case>> = chosen.iter().map(|r| &r.mean).collect();
    if let Some(amplitude) = amplitude(&of_marches, Compared::predicted) {
        let most = light(march);
        let text = format!(
            "marches of {PLACES} places at random, rays of squared error up to {most} and depth up to {THICK}: measured over predicted bias"
        );
        claims.push(Claim::about("march", &text, Unit::ONE, amplitude, 1.0, PREDICTED));
    }
    let thick = chosen.into_iter().filter(|r| r.case().way.depth == THICK);
    if let Some(faintest) = thick.min_by(|a, b| a.expected.bias.total_cmp(&b.expected.bias)) {
        let text =
            format!("marches are bright: bias on the ray of depth {THICK} where it is predicted to be least");
        let statistic = Estimate::mean(&faintest.mean.error);
        claims.push(Claim::at_least("march-bright", &text, Unit::FRACTION, statistic, 0.0));
    }
    if let (Some(march), Some(jackknife)) = (find(results, RAMP, march), find(results, RAMP, left)) {
        let statistic = Estimate::mean(&jackknife.mean.error).times(1.0 / march.expected.bias);
        let text =
            format!("mu = 4x, {PLACES} places: bias that the jackknife leaves, over that of the march");
        claims.push(Claim::within("jackknife", &text, Unit::ONE, statistic, -0.2, 0.2));
        let text = "wrong on purpose, a march taken for unbiased: error on mu = 4x";
        let statistic = Estimate::mean(&march.mean.error);
        claims.push(Claim::detected("march-is-biased", text, Unit::FRACTION, statistic, 0.0, 0.05));
    }
    claims
}

fn gains(results: &[CaseResult]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (way, of, over) in [
        (NOISE, Method::Ratio, Method::Combs),
        (CLOUD, Method::Ratio, Method::Combs),
        (NOISE, Method::Local, Method::LocalCombs),
        (CLOUD, Method::Local, Method::LocalCombs),
    ] {
        let Some((gain, predicted)) = gain(results, way, of, over) else { continue };
        let text = format!(
            "{}: variance times look-ups, {} over {}, over what is predicted",
            way.title(),
            of.title(),
            over.title()
        );
        let id = format!("{}-over-{}-{}", of.name(), over.name(), way.profile.name());
        claims.push(Claim::about(&id, &text, Unit::ONE, gain.times(1.0 / predicted), 1.0, GAIN));
    }
    claims
}

/// Squared differences fall by 4 a level while look-ups double: with chances that fall by 2^(3/2), both sums are finite.
fn levels(known: &Predictions, cells: &Cells) -> anyhow::Result<Claim> {
    let names: Vec<String> = (0..LEVELS).map(level_name).collect();
    let places: Vec<f64> = (0..LEVELS).map(|level| f64::from(2u32 << level)).collect();
    let measured =
        exponent_of_means(&places, &cells.per_map(&names, "squared difference")?, &vec![0.0; names.len()]);
    let predicted = names.iter().map(|n| Ok(known.get(n, "squared difference")?.0));
    let theory = exponent(&places, &predicted.collect::<anyhow::Result<Vec<f64>>>()?);
    let text = "telescoped marches on mu = 4x: exponent of squared differences in the number of places (below -1: finite \
                variance in finite work)";
    Ok(Claim::about("telescoped", text, Unit::ONE, measured, theory, 0.05))
}
