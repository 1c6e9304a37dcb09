//! Choosing settings on half of the maps, reporting them on the other half, and what the choice costs.

use super::data::{Measured, Paths, mean};
use super::split::{MapError, Split, halves, rms};
use crate::harness::Estimate;
use turbid::stats::jackknife;

/// A setting chosen on one half of its maps.
#[derive(Clone, Copy)]
pub struct Choice<'a> {
    /// The case.
    pub case: &'a Measured,
    /// Its root mean square error on the other half.
    pub rms: Estimate,
}

fn choice(case: &Measured) -> Choice<'_> {
    Choice { case, rms: rms(&halves(&case.maps).1) }
}

/// The cheapest case that reaches a root mean square error, judged by the choosing half.
pub fn cheapest<'a>(cases: &[&'a Measured], target: f64, queries: f64) -> Option<Choice<'a>> {
    let reaches = |m: &&&Measured| Split::of(&halves(&m.maps).0).total <= target * target;
    let found = cases.iter().filter(reaches).min_by(|a, b| a.cost(queries).total_cmp(&b.cost(queries)));
    found.map(|case| choice(case))
}

/// The case of the smallest error, judged by some maps: those of even number, or those of odd.
fn best_by<'a>(cases: &[&'a Measured], by_odd: bool) -> Option<&'a Measured> {
    let judged = |m: &Measured| {
        let (even, odd) = halves(&m.maps);
        Split::of(if by_odd { &odd } else { &even }).total
    };
    cases.iter().min_by(|a, b| judged(a).total_cmp(&judged(b))).copied()
}

/// The case of the smallest error, judged by the choosing half.
pub fn best<'a>(cases: &[&'a Measured]) -> Option<Choice<'a>> {
    best_by(cases, false).map(choice)
}

/// One map with the setting that the other half of the maps chose for it.
#[derive(Debug, Clone, PartialEq)]
struct Crossed {
    /// Mean squared error of the chosen setting.
    square: f64,
    /// The same of the setting that is compared with it.
    compared: f64,
    prepare: f64,
    found: f64,
}

/// Every map with the best setting by the half that it is not in, beside a case of the same maps.
fn crossed(cases: &[&Measured], compared: &[MapError]) -> Vec<Crossed> {
    let (Some(by_even), Some(by_odd)) = (best_by(cases, false), best_by(cases, true)) else {
        return Vec::new();
    };
    let one = |(index, compared): (usize, &MapError)| {
        let chosen = if index % 2 == 0 { by_odd } else { by_even };
        Crossed {
            square: chosen.maps[index].square,
            compared: compared.square,
            prepare: chosen.prepare[index],
            found: chosen.found[index],
        }
    };
    compared.iter().enumerate().map(one).collect()
}

/// Root mean square error over that of the best setting for the same maps, every map with the setting that the other
/// half of the maps chose.
pub fn regret(case: &Measured, cases: &[&Measured]) -> Estimate {
    let ratio = |maps: &[Crossed]| {
        let sum = |f: &dyn Fn(&Crossed) -> f64| maps.iter().map(f).sum::<f64>();
        (sum(&|m| m.compared) / sum(&|m| m.square)).sqrt()
    };
    Estimate::jackknife(&jackknife(&crossed(cases, &case.maps), ratio))
}

/// Number of queries from which the best setting is cheaper than a path tracer of the same error, in operations. A
/// map is prepared once and asked often; the path tracer pays for each query alike.
pub fn break_even(cases: &[&Measured], paths: &Paths) -> Option<Estimate> {
    let maps = crossed(cases, &cases.first()?.maps);
    let joined: Vec<(Crossed, f64, f64)> = maps
        .into_iter()
        .zip(paths.variance.iter().zip(&paths.rays))
        .map(|(map, (&variance, &rays))| (map, variance, rays))
        .collect();
    // Joining maps and batches by number is a free choice: they share nothing.
    let queries = |maps: &[(Crossed, f64, f64)]| {
        let average =
            |f: &dyn Fn(&(Crossed, f64, f64)) -> f64| mean(&maps.iter().map(f).collect::<Vec<f64>>());
        let samples = (average(&|m| m.1) / average(&|m| m.0.square)).max(1.0);
        let saved = average(&|m| m.2) * samples - average(&|m| m.0.found);
        average(&|m| m.0.prepare) / saved
    };
    let found = Estimate::jackknife(&jackknife(&joined, queries));
    // Where a query costs more from the map than by paths, there is no break-even.
    (found.value() > 0.0).then_some(found)
}
