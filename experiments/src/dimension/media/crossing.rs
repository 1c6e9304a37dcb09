//! Two methods against time: which of them is ahead at which, and where one overtakes the other.

use super::results::{Curve, at, interval};
use crate::harness::Estimate;
use turbid::stats::{Interval, Moments};

/// One method beside another in one medium.
pub struct Pair<'a> {
    /// The one that a sentence is about.
    pub new: &'a Curve,
    /// The one that it is compared to.
    pub old: &'a Curve,
    /// The times that both have errors of \[s\]; none if one has given its best before the other begins.
    pub common: Option<(f64, f64)>,
    /// Where the new one comes to be ahead, or falls behind, last; with its 95 % interval over samples that cross \[s\].
    pub crossing: Option<(f64, Interval)>,
    /// Part of the samples that cross.
    pub crossed: f64,
    /// Logarithm of the new one's typical error over the old one's at the longest common time; with none in common, that of the last of one
    /// over the first of the other, where the sooner one has the smaller error.
    pub ratio: Option<Estimate>,
}

impl<'a> Pair<'a> {
    /// Compares typical errors.
    pub fn new(new: &'a Curve, old: &'a Curve) -> Self {
        let ((x, found, samples), (x_old, found_old, samples_old)) = (new.lines(), old.lines());
        let both = |y: &[f64], y_old: &[f64]| difference((&x, y), (&x_old, y_old));
        let apart = |y: &[f64], y_old: &[f64]| across((&x, y), (&x_old, y_old));
        let gap = apart(&found, &found_old);
        let found = both(&found, &found_old);
        let sampled: Vec<_> =
            samples.zip(samples_old).map(|(y, y_old)| (both(&y, &y_old), apart(&y, &y_old))).collect();
        let crossings: Vec<f64> = sampled.iter().filter_map(|(line, _)| last_zero(line)).collect();
        let crossed = crossings.len() as f64 / sampled.len().max(1) as f64;
        let cells = new.cells().min(old.cells());
        Pair {
            new,
            old,
            common: found.first().zip(found.last()).map(|(a, b)| (libm::exp(a.0), libm::exp(b.0))),
            crossing: last_zero(&found).map(|at| {
                let Interval { low, high, .. } = interval(crossings.into_iter());
                (libm::exp(at), Interval::new(libm::exp(low), libm::exp(high)))
            }),
            crossed,
            ratio: match found.last() {
                Some(last) => {
                    let spread: Moments =
                        sampled.iter().filter_map(|(line, _)| Some(line.last()?.1)).collect();
                    Some(Estimate::resampled(last.1, spread.std_dev(), cells))
                }
                // The sooner one would only gain with more time.
                None => gap.filter(|(is_sooner, ratio)| *is_sooner == (*ratio < 0.0)).map(|(_, ratio)| {
                    let spread: Moments =
                        sampled.iter().filter_map(|(_, gap)| Some(gap.as_ref()?.1)).collect();
                    Estimate::resampled(ratio, spread.std_dev(), cells)
                }),
            },
        }
    }
}

/// The first line less the second, at the corners of both where both are: empty if they are nowhere.
fn difference(first: (&[f64], &[f64]), second: (&[f64], &[f64])) -> Vec<(f64, f64)> {
    let ends = |x: &[f64]| (x[0], x[x.len() - 1]);
    let (a, b) = (ends(first.0), ends(second.0));
    let (low, high) = (a.0.max(b.0), a.1.min(b.1));
    let mut corners: Vec<f64> = first.0.iter().chain(second.0).copied().collect();
    corners.retain(|&x| low <= x && x <= high);
    corners.sort_by(f64::total_cmp);
    corners.into_iter().map(|x| (x, at(first, x) - at(second, x))).collect()
}

/// Of lines that are nowhere both: whether the first one is the sooner, and its value less that of the second where they are nearest.
fn across(first: (&[f64], &[f64]), second: (&[f64], &[f64])) -> Option<(bool, f64)> {
    let ends = |x: &[f64]| (x[0], x[x.len() - 1]);
    let (a, b) = (ends(first.0), ends(second.0));
    let (start, last) = (|y: &[f64]| y[0], |y: &[f64]| y[y.len() - 1]);
    if a.1 < b.0 {
        return Some((true, last(first.1) - start(second.1)));
    }
    (b.1 < a.0).then(|| (false, start(first.1) - last(second.1)))
}

/// Where a line changes its sign last.
fn last_zero(line: &[(f64, f64)]) -> Option<f64> {
    let step = line.windows(2).rev().find(|step| (step[0].1 < 0.0) != (step[1].1 < 0.0))?;
    let [(x, y), (next, other)] = [step[0], step[1]];
    Some(x + (next - x) * y / (y - other))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 4 - x and y = 2 cross at 2; between 0 and 1 they do not.
    #[test]
    fn lines_cross_where_they_do() {
        let (x, falling) = ([0.0, 1.0, 4.0], [4.0, 3.0, 0.0]);
        let found = difference((&x, &falling), (&[0.5, 3.0], &[2.0, 2.0]));
        assert_eq!(found, vec![(0.5, 1.5), (1.0, 1.0), (3.0, -1.0)]);
        assert_eq!(last_zero(&found), Some(2.0));
        assert_eq!(last_zero(&found[..2]), None);
        assert!(difference((&x, &falling), (&[5.0, 6.0], &[2.0, 2.0])).is_empty());
    }

    /// Lines that follow each other are compared where they are nearest.
    #[test]
    fn lines_apart_are_compared_at_their_ends() {
        let (early, late) = ((&[0.0, 1.0][..], &[4.0, 3.0][..]), (&[2.0, 3.0][..], &[3.5, 2.0][..]));
        assert_eq!(across(early, late), Some((true, -0.5)));
        assert_eq!(across(late, early), Some((false, 0.5)));
        assert_eq!(across(early, early), None);
    }
}
