//! What a sample's largest values say of those that it has not drawn.

use super::Moments;

/// The most values that are kept.
const KEPT: usize = 200;
/// Shape of a tail from which on a mean has no standard error: the variance is infinite. (Vehtari et al. 2024 take means
/// for useful up to 0.7, which says nothing of their errors.)
const HEAVY_SHAPE: f64 = 0.5;
/// Fewest values of a tail that its shape is fitted to: its standard deviation is about (1 + shape)/sqrt(values).
const FEWEST: usize = 20;
/// Share of the variance that the values of a heavy tail carry at least. The m largest of n values u^-k have about
/// (1 - m^(1-2k))/(1 - n^(1-2k)) of all squares: measured 0.75 or more for k of 0.55 to 1.2 and n of 2,000 to 20,000. Of 46 sums
/// that are bounded (Kobayashi's problems 1 ii by paths in weight windows and 2 i by plain ones, 200,000 and a million
/// values) 13 have a shape above 1/2, since their largest values are of another kind than the next ones, and all of these but
/// one 0.01 to 0.41; of that one the quarter tells.
const HEAVY_SHARE: f64 = 0.5;
/// Where the quarter of the largest values is so many standard deviations of its fitted shape below 1/2, the tail ends.
const ENDS: f64 = 2.0;

/// How many values of a sample are above 0, and the largest of them.
///
/// A variance of variance knows only what was drawn. Where rare values carry the mean and none of them was drawn, it is
/// as small as that of a good sample; the spread of the largest values is not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tail {
    contributing: u64,
    /// The largest values and some others, in no order.
    largest: Vec<f64>,
    /// Values at or below this are not among the largest.
    least: f64,
}

impl Tail {
    /// Adds one value.
    pub fn push(&mut self, x: f64) {
        self.contributing += u64::from(x > 0.0);
        self.keep(x);
    }

    fn keep(&mut self, x: f64) {
        if x > self.least {
            self.largest.push(x);
            if self.largest.len() == 2 * KEPT {
                self.largest.sort_unstable_by(|a, b| b.total_cmp(a));
                self.largest.truncate(KEPT);
                self.least = self.largest[KEPT - 1];
            }
        }
    }

    /// Adds all values of another sample: the same in any order.
    pub fn merge(&mut self, other: &Tail) {
        self.contributing += other.contributing;
        other.largest.iter().for_each(|x| self.keep(*x));
    }

    /// The largest value; 0 of none.
    pub fn largest(&self) -> f64 {
        self.largest.iter().copied().fold(0.0, f64::max)
    }

    /// How many values are above 0.
    pub fn contributing(&self) -> u64 {
        self.contributing
    }

    /// Shape of the generalised Pareto distribution of what the m largest values exceed the next one by, with m the least of
    /// 3 sqrt(n), n/5 and 199, n values being above 0; none where m is below 20, or a quarter of them exceed nothing.
    ///
    /// Moments of an order above the inverse of the shape are infinite. Fitted by the profile likelihood, averaged over a
    /// grid of scales.
    ///
    /// # Source
    /// Zhang and Stephens 2009; m as in Vehtari et al. 2024
    pub fn shape(&self) -> Option<f64> {
        let values = self.sorted();
        Self::shape_of(&values, self.fitted(&values)?)
    }

    /// Whether the tail is too heavy for the standard error of the sample, whose moments are given: [`Tail::shape`] above 1/2
    /// in values that carry most of the variance, and not significantly below it in the largest quarter of them. A
    /// generalised Pareto tail has one shape from any value on; where the largest values are of another kind than the next
    /// ones, and bounded, it has not.
    ///
    /// # Limits
    /// What was not drawn at all, and is not the continuation of what was, nothing in a sample tells.
    /// # Source
    /// Davison and Smith 1990 for the shape over thresholds
    pub fn is_heavy(&self, moments: &Moments) -> bool {
        let values = self.sorted();
        let Some(m) = self.fitted(&values) else { return false };
        let quarter = (m / 4).max(FEWEST);
        let ends = HEAVY_SHAPE - ENDS * (1.0 + HEAVY_SHAPE) / (quarter as f64).sqrt();
        let is_above = |m: usize, least: f64| Self::shape_of(&values, m).is_some_and(|shape| shape > least);
        // The values are sizes, so that this is the least that they can differ by from a mean of either sign.
        let squares =
            values[..m].iter().map(|x| (x - moments.mean().abs()) * (x - moments.mean().abs())).sum::<f64>();
        let all = moments.variance() * (moments.n() as f64 - 1.0);
        is_above(m, HEAVY_SHAPE) && is_above(quarter, ends) && squares > HEAVY_SHARE * all
    }

    /// The values that are kept, largest first.
    fn sorted(&self) -> Vec<f64> {
        let mut values = self.largest.clone();
        values.sort_unstable_by(|a, b| b.total_cmp(a));
        values
    }

    /// How many of them a shape is fitted to, if to any.
    fn fitted(&self, values: &[f64]) -> Option<usize> {
        let n = self.contributing as f64;
        let m = (3.0 * n.sqrt()).min(n / 5.0).min((KEPT - 1) as f64) as usize;
        (m >= FEWEST && values.len() > m).then_some(m)
    }

    /// Shape of what the m largest exceed the next one by.
    fn shape_of(values: &[f64], m: usize) -> Option<f64> {
        let excess: Vec<f64> = values[..m].iter().rev().map(|x| x - values[m]).collect();
        pareto_shape(&excess)
    }
}

/// Shape of a generalised Pareto distribution, from values above 0 in rising order; none if a quarter of them are 0.
fn pareto_shape(values: &[f64]) -> Option<f64> {
    use crate::math::{exp, ln, ln_1p};
    let n = values.len() as f64;
    let quarter = values[((0.25 * n + 0.5) as usize).max(1) - 1];
    let largest = values[values.len() - 1];
    if !(quarter > 0.0 && largest.is_finite()) {
        return None;
    }
    let count = 30 + n.sqrt() as usize;
    // With b = -shape/scale the likelihood has its largest value for the shape mean(ln(1 - b x)).
    let shape = |b: f64| values.iter().map(|x| ln_1p(-b * x)).sum::<f64>() / n;
    let grid: Vec<f64> = (0..count)
        .map(|j| 1.0 / largest + (1.0 - (count as f64 / (j as f64 + 0.5)).sqrt()) / (3.0 * quarter))
        .collect();
    let likelihood = |b: f64| {
        let k = shape(b);
        n * (ln(-b / k) - k - 1.0)
    };
    let likelihoods: Vec<f64> = grid.iter().map(|b| likelihood(*b)).collect();
    let best = likelihoods.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = likelihoods.iter().map(|l| exp(l - best)).collect();
    let b = grid.iter().zip(&weights).map(|(b, w)| b * w).sum::<f64>() / weights.iter().sum::<f64>();
    let shape = shape(b);
    shape.is_finite().then_some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{exp, ln};
    use crate::rng::{Purpose, Stream};

    fn tail(set: u64, n: u64, f: impl Fn(f64) -> f64) -> Tail {
        let mut stream = Stream::new(5, Purpose::Synthetic, set, 0);
        let mut tail = Tail::default();
        (0..n).for_each(|_| tail.push(f(stream.open_unit())));
        tail
    }

    /// u^-k has the shape k, -ln u the shape 0, and what ends at 1 a negative one. The shape's standard deviation at m
    /// values is (1 + k)/sqrt(m), 0.12 for k = 0.7 at 199: its mean over 64 sets is known to 0.015.
    #[test]
    fn known_tails_have_their_shapes() {
        let mean =
            |f: fn(f64) -> f64| (0..64).map(|set| tail(set, 20_000, f).shape().unwrap()).sum::<f64>() / 64.0;
        assert!((mean(|u| exp(-0.7 * ln(u))) - 0.7).abs() < 0.08);
        assert!((mean(|u| exp(-1.5 * ln(u))) - 1.5).abs() < 0.1);
        assert!(mean(|u| -ln(u)).abs() < 0.08);
        assert!((mean(|u| 1.0 - u) + 1.0).abs() < 0.15);
    }

    fn sample(set: u64, n: u64, f: impl Fn(f64, f64) -> f64) -> (Tail, Moments) {
        let mut stream = Stream::new(5, Purpose::Synthetic, set, 0);
        let (mut tail, mut moments) = (Tail::default(), Moments::new());
        for _ in 0..n {
            let [u, v] = stream.pair();
            let x = f(1.0 - u, v);
            tail.push(x);
            moments.push(x);
        }
        (tail, moments)
    }

    /// False alarms: of 1,000 exponential samples none is heavy; of 1,000 without a mean nearly all are.
    #[test]
    fn heavy_tails_are_told_from_light_ones() {
        let heavy = |f: fn(f64) -> f64| {
            let is_heavy = |set: &u64| {
                let (tail, moments) = sample(*set, 2000, |u, _| f(u));
                tail.is_heavy(&moments)
            };
            (0..1000).filter(is_heavy).count()
        };
        assert_eq!(heavy(|u| -ln(u)), 0);
        assert!(heavy(|u| exp(-1.2 * ln(u))) > 980);
    }

    /// Runs of which an error is stated, and those of them that are more than 4 of it wrong, by the variance of variance
    /// alone and with the tail.
    fn stated(n: u64, mean: f64, f: impl Fn(f64, f64) -> f64) -> [(u32, u32); 2] {
        let mut counts = [(0, 0); 2];
        for set in 0..200 {
            let (tail, moments) = sample(set, n, &f);
            let is_wrong = (moments.mean() - mean).abs() > 4.0 * moments.std_error();
            let alone = !moments.is_heavy_tailed();
            for (count, is_stated) in counts.iter_mut().zip([alone, alone && !tail.is_heavy(&moments)]) {
                count.0 += u32::from(is_stated);
                count.1 += u32::from(is_stated && is_wrong);
            }
        }
        counts
    }

    /// u^-0.9 has the mean 10 and no variance: where the variance of variance lets it pass, its largest values are missing,
    /// and the error is wrong. The tail tells nearly all of these.
    #[test]
    fn a_tail_without_variance_has_no_error() {
        let [alone, with_tail] = stated(2000, 10.0, |u, _| exp(-0.9 * ln(u)));
        assert!(alone.1 >= 8 && alone.1 == alone.0, "{alone:?}");
        assert!(with_tail.0 <= 3, "{with_tail:?}");
    }

    /// Uniform values, of which few are of another kind, and larger: the shape is above 1/2, and the sum is bounded. In the first
    /// case these carry little of the variance, in the second most of it. Errors are stated and right; the chance of more
    /// than 4 of them in 200 runs is 1 in 80.
    #[test]
    fn bounded_sums_have_an_error() {
        let two = |share: f64, low: f64, high: f64| {
            move |u: f64, v: f64| if v < share { low + (high - low) * u } else { u }
        };
        for (share, low, high) in [(0.002, 1.0, 3.0), (0.005, 5.0, 10.0)] {
            let f = two(share, low, high);
            let is_fooled =
                |set: &u64| sample(*set, 20_000, f).0.shape().is_some_and(|shape| shape > HEAVY_SHAPE);
            assert!((0..200).filter(is_fooled).count() > 190, "{share}");
            let mean = 0.5 * (1.0 - share) + share * 0.5 * (low + high);
            let [alone, with_tail] = stated(20_000, mean, f);
            assert_eq!((alone, with_tail), ((200, 0), (200, 0)), "{share}");
        }
    }

    /// What no rule tells: one value in 20,000 is 5,000 times as large as the others and brings a fifth of the mean. Where none was
    /// drawn, in a share 1/e of the runs, the sample is one of exponential values, and its mean is 35 of its errors wrong.
    #[test]
    fn what_was_not_drawn_is_not_told() {
        let rare = |u: f64, v: f64| if v < 5e-5 { 5000.0 } else { -ln(u) };
        let [_, with_tail] = stated(20_000, 1.25, rare);
        assert!(with_tail.0 == with_tail.1 && (50..100).contains(&with_tail.0), "{with_tail:?}");
    }

    /// One after the other or in parts: the same, and as sorting all of them finds it.
    #[test]
    fn merging_is_pushing() {
        let whole = tail(1, 10_000, |u| 1.0 / u);
        let mut stream = Stream::new(5, Purpose::Synthetic, 1, 0);
        let values: Vec<f64> = (0..10_000).map(|_| 1.0 / stream.open_unit()).collect();
        let mut merged = Tail::default();
        for part in values.chunks(777).rev() {
            let mut tail = Tail::default();
            part.iter().for_each(|x| tail.push(*x));
            merged.merge(&tail);
        }
        let mut sorted = values;
        sorted.sort_by(|a, b| b.total_cmp(a));
        let excess: Vec<f64> = sorted[..199].iter().rev().map(|x| x - sorted[199]).collect();
        assert_eq!(whole.shape(), pareto_shape(&excess));
        assert_eq!((merged.shape(), merged.contributing()), (whole.shape(), 10_000));
    }

    #[test]
    fn equal_values_and_few_have_no_shape() {
        assert_eq!(tail(1, 10_000, |_| 1.0).shape(), None);
        assert_eq!((tail(1, 10_000, |_| 0.0).contributing(), tail(1, 99, |u| u).shape()), (0, None));
        assert!(tail(1, 100, |u| u).shape().is_some());
    }
}
