//! Tests of a whole distribution: Kolmogorov-Smirnov and chi-squared.

use super::distribution::{chi_squared_p, kolmogorov_later_terms, root_of_falling};
use super::{ALPHA, POWER_QUANTILE};
use crate::math::{exp, ln, ln_1p};
use statrs::function::gamma::ln_gamma;

/// Expected count below which a cell of a chi-squared test is pooled (Cochran 1954).
const SMALLEST_CELL: f64 = 5.0;

/// Result of a Kolmogorov-Smirnov test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KolmogorovSmirnov {
    /// Largest distance between the two distribution functions.
    pub distance: f64,
    /// p-value.
    pub p: f64,
}

/// Result of a chi-squared test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquared {
    /// Sum of (observed - expected)^2 / expected over the cells after pooling.
    pub statistic: f64,
    /// Degrees of freedom: cells after pooling, less one, less the fitted parameters.
    pub freedom: u64,
    /// p-value; 1 where no degree of freedom is left.
    pub p: f64,
}

/// One-sample Kolmogorov-Smirnov test of **independent** values against a continuous distribution function.
///
/// The chance that one of the two one-sided distances is so large is exact (Smirnov's sum), twice that counts
/// crossings on both sides twice; the later terms of Kolmogorov's limit series take them off again. In the tail,
/// where verdicts are, only the exact term is left. A value that is not a number gives p = 0.
///
/// # Source
/// Birnbaum and Tingey 1951; Stephens 1970 for the scaled distance.
pub fn kolmogorov_smirnov_test(values: &[f64], cdf: impl Fn(f64) -> f64) -> KolmogorovSmirnov {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let mut distance: f64 = 0.0;
    for (i, &x) in sorted.iter().enumerate() {
        let f = cdf(x);
        if f.is_nan() {
            return KolmogorovSmirnov { distance: f64::NAN, p: 0.0 };
        }
        distance = distance.max((i + 1) as f64 / n - f).max(f - i as f64 / n);
    }
    KolmogorovSmirnov { distance, p: kolmogorov_smirnov_p(sorted.len(), distance) }
}

/// Probability that the two-sided distance of `n` independent values is at least `distance`.
fn kolmogorov_smirnov_p(n: usize, distance: f64) -> f64 {
    if n == 0 || distance <= 0.0 {
        return 1.0;
    }
    let root = (n as f64).sqrt();
    let scaled = (root + 0.12 + 0.11 / root) * distance;
    (2.0 * one_sided_tail(n, distance) + kolmogorov_later_terms(scaled)).clamp(0.0, 1.0)
}

/// P(D+ >= d) = d sum_j C(n, j) (d + j/n)^(j-1) (1 - d - j/n)^(n-j), over j up to n (1 - d); all terms positive.
fn one_sided_tail(n: usize, d: f64) -> f64 {
    if d >= 1.0 {
        return 0.0;
    }
    let count = n as f64;
    let ln_factorial = ln_gamma(count + 1.0);
    let mut sum = 0.0;
    for j in 0..=n {
        let j = j as f64;
        let rest = d + j / count;
        if rest >= 1.0 {
            break;
        }
        let choose = ln_factorial - ln_gamma(j + 1.0) - ln_gamma(count - j + 1.0);
        sum += exp(choose + (j - 1.0) * ln(rest) + (count - j) * ln_1p(-rest));
    }
    (d * sum).min(1.0)
}

/// Chi-squared test of counts against expected counts, with `fitted` parameters taken from the same data.
///
/// Cells expected below five are pooled, smallest first, until each pool reaches five; a last pool that does not
/// joins the smallest whole cell. Something observed where nothing is expected gives p = 0.
///
/// # Arguments
/// `observed` and `expected` of equal length and total, up to rounding.
pub fn chi_squared_test(observed: &[f64], expected: &[f64], fitted: u64) -> ChiSquared {
    let mut cells: Vec<(f64, f64)> = observed.iter().copied().zip(expected.iter().copied()).collect();
    if cells.iter().any(|&(o, e)| (e <= 0.0 && o > 0.0) || !o.is_finite() || !e.is_finite()) {
        return ChiSquared { statistic: f64::INFINITY, freedom: 0, p: 0.0 };
    }
    cells.retain(|&(_, e)| e > 0.0);
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut pooled: Vec<(f64, f64)> = Vec::new();
    let mut pool = (0.0, 0.0);
    for (o, e) in cells {
        pool = (pool.0 + o, pool.1 + e);
        if pool.1 >= SMALLEST_CELL {
            pooled.push(pool);
            pool = (0.0, 0.0);
        }
    }
    if pool.1 > 0.0 {
        match pooled.first_mut() {
            Some(first) => *first = (first.0 + pool.0, first.1 + pool.1),
            None => pooled.push(pool),
        }
    }
    let statistic = pooled.iter().map(|&(o, e)| (o - e) * (o - e) / e).sum();
    let freedom = (pooled.len() as u64).saturating_sub(1 + fitted);
    ChiSquared { statistic, freedom, p: chi_squared_p(statistic, freedom) }
}

/// The smallest distance between two distribution functions that a Kolmogorov-Smirnov test of `n` values at [`ALPHA`]
/// hardly ever misses.
///
/// Where the functions are farthest apart the empirical one is binomial, with a standard error of at most
/// 1/(2 sqrt n): the critical distance, sqrt(ln(2/ALPHA)/(2n)), and [`POWER_QUANTILE`] of those.
pub fn smallest_detectable_distance(n: usize) -> f64 {
    let critical = (0.5 * ln(2.0 / ALPHA)).sqrt();
    (critical + 0.5 * POWER_QUANTILE) / (n as f64).sqrt()
}

/// The smallest deviation of probabilities, the root mean square of (p - q)/q over cells weighted with q, that a
/// chi-squared test of `total` counts with `freedom` degrees of freedom at [`ALPHA`] hardly ever misses.
///
/// The statistic is then noncentral, with L = `total` times the squared deviation.
pub fn smallest_detectable_deviation(total: f64, freedom: u64) -> f64 {
    (smallest_detectable_noncentrality(freedom, ALPHA) / total).sqrt()
}

/// The smallest noncentrality L, the sum of squared deviations over their errors, that a chi-squared test with `freedom` degrees of
/// freedom at the level `alpha` hardly ever misses.
///
/// The statistic has the mean k + L and the variance 2(k + 2L): solved for the L whose mean is [`POWER_QUANTILE`] standard
/// deviations above the critical value. Its lower tail is lighter than the normal one, so that this is cautious.
pub fn smallest_detectable_noncentrality(freedom: u64, alpha: f64) -> f64 {
    let k = freedom as f64;
    let critical = root_of_falling(alpha, |x| chi_squared_p(x, freedom));
    // L + k - critical = q sqrt(2k + 4L), squared; the larger root.
    let (above, q2) = (critical - k, POWER_QUANTILE * POWER_QUANTILE);
    let half = above + 2.0 * q2;
    half + (half * half - above * above + 2.0 * q2 * k).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};
    use crate::stats::{ALPHA, wilson_interval};

    fn uniform(set: u64, n: u64) -> Vec<f64> {
        let mut stream = Stream::new(13, Purpose::Synthetic, set, 0);
        (0..n).map(|_| stream.unit()).collect()
    }

    /// One value: D = max(u, 1-u), so P(D >= d) = 2 (1 - d). Two values, d >= 1/2: P = 2 (1 - d)^2.
    #[test]
    fn smallest_samples_in_closed_form() {
        for d in [0.5, 0.7, 0.99] {
            assert!((2.0 * one_sided_tail(1, d) - 2.0 * (1.0 - d)).abs() < 1e-14);
            assert!((2.0 * one_sided_tail(2, d) - 2.0 * (1.0 - d) * (1.0 - d)).abs() < 1e-13);
        }
    }

    /// Tables of critical distances (Miller 1956): 5 % at n = 10 0.40925, n = 20 0.29408; 1 % at n = 10 0.48893.
    #[test]
    fn critical_distances_stand_in_the_table() {
        for (n, d, p) in [(10, 0.409_25, 0.05), (20, 0.294_08, 0.05), (10, 0.488_93, 0.01)] {
            // Five digits of d fix p to about 1e-4 of itself; the later terms are below 1e-5 here.
            assert!((kolmogorov_smirnov_p(n, d) / p - 1.0).abs() < 1e-3, "{n}");
        }
    }

    #[test]
    fn the_limit_of_many_values() {
        // 1.3581 and 1.6276 are the 5 % and 1 % points of Kolmogorov's distribution; corrections fall as 1/sqrt n.
        for (x, p) in [(1.358_10, 0.05), (1.627_62, 0.01)] {
            let n = 1_000_000;
            let root = (n as f64).sqrt();
            assert!((kolmogorov_smirnov_p(n, x / (root + 0.12)) / p - 1.0).abs() < 2e-3);
        }
    }

    /// Right data: the rate at 5 % within its interval. Wrong data (u^1.02, wrong by at most 0.7 %): 1e5 values detect it.
    #[test]
    fn kolmogorov_smirnov_false_alarms_and_power() {
        let alarms = (0..4000).filter(|&s| kolmogorov_smirnov_test(&uniform(s, 50), |x| x).p < 0.05).count();
        assert!(wilson_interval(alarms as u64, 4000, 1.0 - ALPHA).contains(0.05), "{alarms} of 4000");
        let wrong: Vec<f64> = uniform(0, 200_000).iter().map(|&u| libm::pow(u, 1.03)).collect();
        assert!(kolmogorov_smirnov_test(&wrong, |x| x).p < ALPHA);
        assert!(kolmogorov_smirnov_test(&uniform(0, 200_000), |x| x).p > ALPHA);
        assert_eq!(kolmogorov_smirnov_test(&[0.5, f64::NAN], |x| x).p, 0.0);
    }

    /// Two degrees of freedom: p = exp(-statistic/2).
    #[test]
    fn chi_squared_by_hand() {
        let test = chi_squared_test(&[10.0, 20.0, 30.0], &[20.0, 20.0, 20.0], 0);
        assert_eq!((test.statistic, test.freedom), (10.0, 2));
        assert!((test.p - exp(-5.0)).abs() < 1e-15);
        // The far tail keeps its digits.
        let far = chi_squared_test(&[0.0, 500.0, 1000.0], &[500.0, 500.0, 500.0], 0);
        assert!((far.p / exp(-500.0) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn small_cells_are_pooled() {
        let observed = [2.0, 1.0, 3.0, 40.0, 54.0];
        let expected = [2.0, 2.0, 2.0, 44.0, 50.0];
        // The three small ones make one cell of 6 against 6.
        let test = chi_squared_test(&observed, &expected, 0);
        assert_eq!(test.freedom, 2);
        assert!((test.statistic - (16.0 / 44.0 + 16.0 / 50.0)).abs() < 1e-14);
        assert_eq!(chi_squared_test(&[1.0, 9.0], &[0.0, 10.0], 0).p, 0.0);
        assert_eq!(chi_squared_test(&[1.0, 1.0], &[1.0, 1.0], 0).p, 1.0);
    }

    /// Data as far off as stated are detected at least 98 times in 100. Negative control: a third of it is hardly ever detected.
    #[test]
    fn the_smallest_deviations_are_seen() {
        let (n, sets) = (2000u64, 400u64);
        // u + shift at both ends of the unit interval: distribution functions that differ by the shift.
        let by_distance = |shift: f64| {
            let moved = |set| uniform(set, n).iter().map(|u| u.max(shift)).collect::<Vec<_>>();
            (0..sets).filter(|&set| kolmogorov_smirnov_test(&moved(set), |x| x).p < ALPHA).count()
        };
        let distance = smallest_detectable_distance(n as usize);
        assert!(by_distance(distance) >= 392, "{}", by_distance(distance));
        assert!(by_distance(distance / 3.0) < 40);
        // Ten cells, five of them heavier by the deviation.
        let by_counts = |deviation: f64| {
            let seen = |set: &u64| {
                let mut counts = [0.0; 10];
                for u in uniform(*set, n) {
                    let split = 0.5 * (1.0 + deviation);
                    let v = if u < split { 0.5 * u / split } else { 1.0 - 0.5 * (1.0 - u) / (1.0 - split) };
                    counts[((v * 10.0) as usize).min(9)] += 1.0;
                }
                chi_squared_test(&counts, &[n as f64 / 10.0; 10], 0).p < ALPHA
            };
            (0..sets).filter(seen).count()
        };
        let deviation = smallest_detectable_deviation(n as f64, 9);
        assert!(by_counts(deviation) >= 392, "{} at {deviation}", by_counts(deviation));
        assert!(by_counts(deviation / 3.0) < 40);
    }

    #[test]
    fn chi_squared_false_alarms_and_power() {
        let histogram = |set: u64, n: u64, shift: f64| {
            let mut counts = [0.0; 10];
            for u in uniform(set, n) {
                counts[((u * (1.0 + shift) * 10.0) as usize).min(9)] += 1.0;
            }
            counts
        };
        let p = |set, n: u64, shift| chi_squared_test(&histogram(set, n, shift), &[n as f64 / 10.0; 10], 0).p;
        let alarms = (0..4000).filter(|&s| p(s, 1000, 0.0) < 0.05).count();
        // Counts are whole numbers: the limit's 5 % holds to about a tenth of itself at 100 a cell.
        let interval = wilson_interval(alarms as u64, 4000, 1.0 - ALPHA);
        assert!(interval.low < 0.055 && interval.high > 0.045, "{alarms} of 4000");
        assert!(p(0, 100_000, 0.01) < ALPHA && p(0, 100_000, 0.0) > ALPHA);
    }
}
