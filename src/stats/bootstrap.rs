//! Intervals of any statistic of independent maps, by resampling them.

use super::Interval;
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
        return Jackknife { value: all, std_error: f64::INFINITY, n: n as u64 };
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
    }
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

    #[test]
    fn nothing_known_is_unbounded() {
        assert_eq!(bootstrap_interval(&[], mean, 0.95, 100, 1).high, f64::INFINITY);
        assert_eq!(jackknife(&[1.0], mean).std_error, f64::INFINITY);
    }
}
