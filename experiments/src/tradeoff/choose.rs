//! Choosing settings on half of the maps, reporting them on the other half, and what the choice costs.

use super::cases::PROBES;
use super::data::{Measured, Paths};
use super::split::{Split, halves, positive, rms};
use crate::harness::Estimate;
use crate::setups::Size;

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
pub fn cheapest<'a>(
    cases: &[&'a Measured],
    target: f64,
    cost: impl Fn(&Measured) -> f64,
) -> Option<Choice<'a>> {
    let reaches = |m: &&&Measured| Split::of(&halves(&m.maps).0).total <= target * target;
    let found = cases.iter().filter(reaches).min_by(|a, b| cost(a).total_cmp(&cost(b)));
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

/// Errors above this are no answer, whatever they cost: a map of a few photons is cheap.
const USEFUL: f64 = 1.0 / 3.0;

/// The case of the best figure of merit, the smallest squared error times cost of 4096 queries, among those of a
/// useful error (if there is none, among all). The figure does not change when error is bought by samples, as the path
/// tracer buys it. Theory chooses, so that all maps may report.
pub fn most_efficient<'a>(cases: &[&'a Measured]) -> Option<Choice<'a>> {
    let error = |m: &Measured| m.predicted().total();
    let key = |m: &Measured| (error(m) > USEFUL, error(m) * error(m) * m.cost(PROBES as f64));
    let order = |a: &&&Measured, b: &&&Measured| {
        let ((a_useless, a), (b_useless, b)) = (key(a), key(b));
        a_useless.cmp(&b_useless).then(a.total_cmp(&b))
    };
    cases.iter().min_by(order).map(|case| Choice { case, rms: rms(&case.maps) })
}

/// The squared error of every map with the best setting by the half that it is not in.
fn crossed(cases: &[&Measured]) -> Vec<f64> {
    let (Some(by_even), Some(by_odd)) = (best_by(cases, false), best_by(cases, true)) else {
        return Vec::new();
    };
    let one = |index: usize| (if index.is_multiple_of(2) { by_odd } else { by_even }).maps[index].square;
    (0..by_even.maps.len().min(by_odd.maps.len())).map(one).collect()
}

/// Root mean square error over that of the best setting for the same maps, every map with the setting that the other
/// half of the maps chose.
pub fn regret(case: &Measured, cases: &[&Measured]) -> Estimate {
    gain(case.maps.iter().map(|m| m.square), crossed(cases).into_iter())
}

/// Root mean square error of the best of some settings over that of the best of others.
pub fn best_over_best(cases: &[&Measured], others: &[&Measured]) -> Estimate {
    gain(crossed(cases).into_iter(), crossed(others).into_iter())
}

/// The root of a ratio of mean squares.
fn gain(above: impl Iterator<Item = f64>, below: impl Iterator<Item = f64>) -> Estimate {
    let pairs: Vec<(f64, f64)> = above.zip(below).collect();
    let ratio = |pairs: &[(f64, f64)]| {
        let (above, below) = pairs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        (above / below).sqrt()
    };
    positive(&pairs, ratio)
}

/// What costs are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Currency {
    /// Rays, records and gathered photons, each as one.
    Operations,
    /// The same with records and gathered photons as parts of a ray, as in [`cost_model`](crate::cost_model).
    Rays,
    /// CPU seconds of this machine.
    Seconds,
}

/// What a map costs against a path tracer.
pub struct BreakEven {
    /// A query by the path tracer, over one from the map.
    pub ratio: Estimate,
    /// So many queries from the map, the map included, over as many by the path tracer: 4096 of them.
    pub share: Estimate,
    /// Queries from which the map is the cheaper of the two; none where a query costs more from the map than by
    /// paths, so that nothing ever pays for it.
    pub queries: Option<Estimate>,
}

/// A setting against a path tracer of the same error.
pub fn break_even(case: &Measured, paths: &Paths, currency: Currency) -> BreakEven {
    break_even_at(case, paths, currency, None)
}

/// A setting against a path tracer of an error, that of the setting itself if none is given. A map is prepared once and asked
/// often; the path tracer pays for each query alike.
pub fn break_even_at(case: &Measured, paths: &Paths, currency: Currency, error: Option<f64>) -> BreakEven {
    let (prepare, found, sample) = match currency {
        Currency::Operations => (&case.prepare, &case.found, &paths.rays),
        Currency::Rays => (&case.prepare_rays, &case.query_rays, &paths.rays),
        Currency::Seconds => (&case.prepare_seconds, &case.query_seconds, &paths.seconds),
    };
    // Joining maps and batches of paths by number is a free choice: they share nothing.
    let maps = case.maps.iter().zip(prepare).zip(found);
    let joined: Vec<[f64; 5]> = maps
        .zip(paths.variance.iter().zip(sample))
        .map(|(((map, &prepare), &found), (&variance, &sample))| {
            [error.map_or(map.square, |error| error * error), prepare, found, variance, sample]
        })
        .collect();
    let means = |maps: &[[f64; 5]]| {
        let mut sums = [0.0; 5];
        for map in maps {
            for (sum, value) in sums.iter_mut().zip(map) {
                *sum += value / maps.len() as f64;
            }
        }
        let [square, prepare, found, variance, sample] = sums;
        (sample * (variance / square).max(1.0), found, prepare)
    };
    let ratio = |maps: &[[f64; 5]]| {
        let (by_paths, found, _) = means(maps);
        by_paths / found
    };
    let share = |maps: &[[f64; 5]]| {
        let (by_paths, found, prepare) = means(maps);
        (prepare / PROBES as f64 + found) / by_paths
    };
    let queries = |maps: &[[f64; 5]]| {
        let (by_paths, found, prepare) = means(maps);
        prepare / (by_paths - found)
    };
    let ratio = positive(&joined, ratio);
    // The number of queries has a pole where nothing is saved: it has an error only well away from there.
    let is_clear = ratio.value() - 1.0 > 5.0 * ratio.std_error();
    BreakEven {
        ratio,
        share: positive(&joined, share),
        queries: is_clear.then(|| positive(&joined, queries)),
    }
}

/// Rays of guided paths over those of paths that nothing leads, to the same error.
pub fn guided_rays(guided: &Paths, paths: &Paths) -> Estimate {
    // Joining batches by number is a free choice: they share nothing.
    let work = |paths: &Paths| paths.variance.iter().copied().zip(paths.rays.clone()).collect::<Vec<_>>();
    let joined: Vec<[f64; 4]> =
        work(guided).into_iter().zip(work(paths)).map(|(a, b)| [a.0, a.1, b.0, b.1]).collect();
    positive(&joined, |batches| {
        let sum = |part: usize| batches.iter().map(|batch| batch[part]).sum::<f64>();
        sum(0) * sum(1) / (sum(2) * sum(3))
    })
}

/// Whether a case has the largest radius, or the largest k, of those tried with its maps: if it is the best, a still
/// larger one may be better.
pub fn is_last(case: &Measured, cases: &[&Measured]) -> bool {
    let larger = |other: &&Measured| match (case.setting.size, other.setting.size) {
        (Size::Radius(own), Size::Radius(other)) => other > own,
        (Size::Nearest(own), Size::Nearest(other)) => other > own,
        _ => false,
    };
    !cases.iter().filter(|m| m.setting.photons == case.setting.photons).any(larger)
}

/// The cases that no other beats in both cost and error, judged by the choosing half, the cheapest first.
pub fn frontier<'a>(cases: &[&'a Measured], cost: impl Fn(&Measured) -> f64) -> Vec<Choice<'a>> {
    let mut sorted: Vec<(f64, f64, &Measured)> =
        cases.iter().map(|&m| (cost(m), Split::of(&halves(&m.maps).0).total, m)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    let mut front = Vec::new();
    for (_, square, case) in sorted {
        if square < least {
            least = square;
            front.push(choice(case));
        }
    }
    front
}
