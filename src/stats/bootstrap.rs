//! Intervals of any statistic of independent maps, by resampling them.

use super::{Interval, Moments, student_critical};
use crate::rng::{Purpose, Stream};

/// Percentile interval at `level` of a statistic of independent maps, from `resamples` samples with replacement.
///
/// # Arguments
/// `maps` one value (or one record of paired values) a map; `resamples` at least 1000 for a level of 0.95: the
/// ends are the order statistics next to the wanted quantiles. `seed` fixes the resampling.
///
/// # Limits
/// For figures. With few maps the interval is too narrow by about sqrt(1 - 1/M), and a tail beyond the data is
/// never seen.
///
/// # Source
/// Efron and Tibshirani 1993, ch. 13.
pub fn bootstrap_interval<T: Clone>(
    maps: &[T],
    statistic: impl Fn(&[T]) -> f64,
    level: f64,
    resamples: usize,
    seed: u64,
) -> Interval {
    if maps.is_empty() || resamples == 0 {
        return Interval::new(f64::NEG_INFINITY, f64::INFINITY);
    }
    let mut sample = maps.to_vec();
    let mut values: Vec<f64> = (0..resamples as u64)
        .map(|resample| {
            let mut stream = Stream::new(seed, Purpose::Resampling, resample, 0);
            for slot in &mut sample {
                slot.clone_from(&maps[stream.index(maps.len())]);
            }
            statistic(&sample)
        })
        .collect();
    values.sort_by(f64::total_cmp);
    let outside = 0.5 * (1.0 - level);
    let last = values.len() - 1;
    let low = (outside * resamples as f64) as usize;
    Interval::new(values[low.min(last)], values[last - low.min(last)])
}

/// A statistic and its error by leaving out one map at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jackknife {
    /// The statistic of all maps, less its estimated bias.
    pub value: f64,
    /// Standard error.
    pub std_error: f64,
    /// Number of maps; the statistic has n - 1 degrees of freedom.
    pub n: u64,
    /// Of the pseudo-values, n all - (n-1) without: what each map says. Their mean and its error are `value` and
    /// `std_error`, but for rounding; their fourth moment tells whether that error can be relied on.
    pub moments: Moments,
}

impl Jackknife {
    /// Whether the error is too uncertain for an interval, as of a plain mean ([`Moments::is_heavy_tailed`]).
    pub fn is_heavy_tailed(&self) -> bool {
        self.moments.is_heavy_tailed()
    }
}

/// Estimate and error of a smooth statistic, such as a ratio of means, by refitting without each map in turn.
///
/// # Limits
/// Below two maps the error is infinite. Not for quantiles, which are not smooth.
///
/// # Source
/// Tukey 1958.
pub fn jackknife<T: Clone>(maps: &[T], statistic: impl Fn(&[T]) -> f64) -> Jackknife {
    let all = statistic(maps);
    let n = maps.len();
    if n < 2 {
        let moments = std::iter::repeat_n(all, n).collect();
        return Jackknife { value: all, std_error: f64::INFINITY, n: n as u64, moments };
    }
    // `rest` is all maps but the i-th: stepping i puts the previous one back in its place.
    let mut rest: Vec<T> = maps[1..].to_vec();
    let mut without = Vec::with_capacity(n);
    for i in 0..n {
        without.push(statistic(&rest));
        if i + 1 < n {
            rest[i].clone_from(&maps[i]);
        }
    }
    let count = n as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|x| (x - mean) * (x - mean)).sum();
    Jackknife {
        value: count * all - (count - 1.0) * mean,
        std_error: (squares * (count - 1.0) / count).sqrt(),
        n: n as u64,
        moments: without.iter().map(|x| count * all - (count - 1.0) * x).collect(),
    }
}

/// The logarithm of a positive statistic and its error, such as a variance, a root mean square, a price or a ratio.
///
/// Statistics of squares are skewed, and their error grows with their value: an interval about the statistic itself
/// misses the truth on one side, and of 16 maps with 5 places each covers 93.9 per cent for 95. The logarithm of such a
/// statistic has nearly the same error whatever its value, and is nearly normal; carried back by the exponential, the
/// ends of its interval are those of the statistic ([`positive_interval`]).
///
/// # Limits
/// As [`jackknife`]. A statistic that is not positive gives a non-number.
///
/// # Source
/// Efron and Tibshirani 1993, ch. 12, on intervals that respect transformations.
pub fn jackknife_log<T: Clone>(maps: &[T], statistic: impl Fn(&[T]) -> f64) -> Jackknife {
    jackknife(maps, |rest| crate::math::ln(statistic(rest)))
}

/// Two-sided interval of a positive statistic at `level`: that of its logarithm by Student's t, carried back.
///
/// # Limits
/// As [`jackknife_log`]; unbounded, from 0, below two maps.
pub fn positive_interval<T: Clone>(maps: &[T], statistic: impl Fn(&[T]) -> f64, level: f64) -> Interval {
    let Jackknife { value, std_error, n, .. } = jackknife_log(maps, statistic);
    if n < 2 {
        return Interval::new(0.0, f64::INFINITY);
    }
    let half = student_critical(1.0 - level, n - 1) * std_error;
    Interval::new(crate::math::exp(value - half), crate::math::exp(value + half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::mean::tests::normal;
    use crate::stats::{ALPHA, Moments, mean_interval, wilson_interval};

    fn values(set: u64, n: u64) -> Vec<f64> {
        let mut stream = Stream::new(17, Purpose::Synthetic, set, 0);
        (0..n).map(|_| 2.0 + normal(&mut stream)).collect()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn the_jackknife_of_a_mean_is_the_mean_and_its_error() {
        let values = values(0, 20);
        let moments: Moments = values.iter().collect();
        let estimate = jackknife(&values, mean);
        assert!((estimate.value - moments.mean()).abs() < 1e-13);
        assert!((estimate.std_error / moments.std_error() - 1.0).abs() < 1e-12);
    }

    /// The square of a mean is high by variance/n; the jackknife takes exactly that off.
    #[test]
    fn the_jackknife_removes_a_bias_of_one_over_n() {
        let values = values(1, 10);
        let moments: Moments = values.iter().collect();
        let exact = moments.mean() * moments.mean() - moments.variance() / 10.0;
        assert!((jackknife(&values, |v| mean(v) * mean(v)).value - exact).abs() < 1e-12);
    }

    /// The pseudo-values of a mean are the values themselves: one map that carries the variance of 64 is detected, and
    /// seen in a root mean square; a normal sample is not taken for such.
    #[test]
    fn a_map_that_carries_the_variance_is_seen() {
        let root = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
        let mut values = values(4, 64);
        for statistic in [mean as fn(&[f64]) -> f64, root] {
            let of_mean = jackknife(&values, statistic);
            assert!(!of_mean.is_heavy_tailed(), "{}", of_mean.moments.vov());
            assert!((of_mean.moments.mean() - of_mean.value).abs() < 1e-12);
            assert!((of_mean.moments.std_error() / of_mean.std_error - 1.0).abs() < 1e-9);
        }
        let plain: Moments = values.iter().collect();
        assert!((jackknife(&values, mean).moments.vov() / plain.vov() - 1.0).abs() < 1e-9);
        values[0] = 40.0;
        assert!(jackknife(&values, mean).is_heavy_tailed() && jackknife(&values, root).is_heavy_tailed());
        assert!(jackknife_log(&values, root).is_heavy_tailed());
    }

    #[test]
    fn the_bootstrap_of_a_mean_is_near_its_t_interval_and_repeats() {
        let values = values(2, 200);
        let interval = bootstrap_interval(&values, mean, 0.95, 2000, 1);
        assert_eq!(interval, bootstrap_interval(&values, mean, 0.95, 2000, 1));
        let exact = mean_interval(&values.iter().collect(), 0.95);
        // Each end is a 2.5 % quantile of 2000: 0.05 deviations of the statistic; five of these.
        let tolerance = 5.0 * 0.06 * values.iter().collect::<Moments>().std_error();
        assert!(
            (interval.low - exact.low).abs() < tolerance && (interval.high - exact.high).abs() < tolerance
        );
    }

    #[test]
    fn the_bootstrap_covers_its_level() {
        let inside = (0..1000)
            .filter(|&set| bootstrap_interval(&values(set, 40), mean, 0.95, 1000, set).contains(2.0))
            .count();
        let interval = wilson_interval(inside as u64, 1000, 1.0 - ALPHA);
        // sqrt(39/40) and the normal for the t quantile: 94 % is expected of 40 maps.
        assert!(interval.contains(0.94), "{inside} of 1000");
    }

    /// The logarithm of the statistic, carried back: a product of powers, whose jackknife is that of a mean.
    #[test]
    fn the_logarithm_of_a_geometric_mean_is_a_mean() {
        let values: Vec<f64> = values(3, 20).iter().map(|x| x.abs() + 0.1).collect();
        let logs: Moments = values.iter().map(|x| crate::math::ln(*x)).collect();
        let geometric =
            |v: &[f64]| crate::math::exp(v.iter().map(|x| crate::math::ln(*x)).sum::<f64>() / v.len() as f64);
        let estimate = jackknife_log(&values, geometric);
        assert!((estimate.value - logs.mean()).abs() < 1e-13);
        assert!((estimate.std_error / logs.std_error() - 1.0).abs() < 1e-12);
        let (interval, exact) = (positive_interval(&values, geometric, 0.95), mean_interval(&logs, 0.95));
        assert!((interval.low / crate::math::exp(exact.low) - 1.0).abs() < 1e-12);
        assert!((interval.high / crate::math::exp(exact.high) - 1.0).abs() < 1e-12);
    }

    /// A variance of 16 maps of 5 independent places: the interval by the logarithm covers, the one about the variance
    /// itself (the negative control) does not.
    #[test]
    fn intervals_of_variances_cover_by_their_logarithm() {
        let variance = |v: &[[f64; 5]]| {
            let at = |place: usize| v.iter().map(|m| m[place]).collect::<Moments>().variance();
            (0..5).map(at).sum::<f64>() / 5.0
        };
        let (mut by_log, mut plain) = (0, 0);
        for set in 0..4000 {
            let mut stream = Stream::new(21, Purpose::Synthetic, set, 0);
            let maps: Vec<[f64; 5]> = (0..16).map(|_| std::array::from_fn(|_| normal(&mut stream))).collect();
            by_log += u64::from(positive_interval(&maps, variance, 0.95).contains(1.0));
            let estimate = jackknife(&maps, variance);
            plain +=
                u64::from((estimate.value - 1.0).abs() <= student_critical(0.05, 15) * estimate.std_error);
        }
        let (by_log, plain) =
            (wilson_interval(by_log, 4000, 1.0 - ALPHA), wilson_interval(plain, 4000, 0.999));
        assert!(by_log.contains(0.95), "{by_log:?}");
        assert!(plain.high < 0.95, "{plain:?}");
    }

    #[test]
    fn nothing_known_is_unbounded() {
        assert_eq!(bootstrap_interval(&[], mean, 0.95, 100, 1).high, f64::INFINITY);
        assert_eq!(jackknife(&[1.0], mean).std_error, f64::INFINITY);
        assert_eq!(positive_interval(&[1.0], mean, 0.95), Interval::new(0.0, f64::INFINITY));
    }
}
