//! Intervals for means, counts and fractions.

use super::distribution::{poisson_lower_tail, root_of_falling};
use super::{Moments, normal_critical, poisson_upper_tail, student_critical};
use crate::math::ln;

/// An interval of values, ends included.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The interval from `low` to `high`.
    pub fn new(low: f64, high: f64) -> Self {
        Interval { low, high }
    }

    /// The interval of `half_width` about `centre`.
    pub fn about(centre: f64, half_width: f64) -> Self {
        Interval { low: centre - half_width, high: centre + half_width }
    }

    /// Whether `x` lies inside.
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// Whether the whole interval lies within `margin`: the condition of equivalence.
    pub fn is_within(&self, margin: &Interval) -> bool {
        margin.low <= self.low && self.high <= margin.high
    }
}

/// Two-sided interval of a mean by Student's t at `level`, such as 0.95; unbounded below two values.
///
/// # Limits
/// Trustworthy while [`Moments::is_heavy_tailed`] is false.
pub fn mean_interval(moments: &Moments, level: f64) -> Interval {
    if moments.n() < 2 {
        return Interval::new(f64::NEG_INFINITY, f64::INFINITY);
    }
    let t = student_critical(1.0 - level, moments.n() - 1);
    Interval::about(moments.mean(), t * moments.std_error())
}

/// Interval of the mean of a Poisson count at `level`.
///
/// Central for positive counts: each end leaves half of 1 - `level` outside. Zero has only an upper end, where
/// exp(-mean) = 1 - level: [0, 3.0] at 95 per cent, the rule of three.
///
/// # Limits
/// Positive counts alone cover at least their level. Spending all of it on one end at zero costs something for
/// means that zero no longer contains and one does, 3.0 to 3.7 at 95 per cent: coverage falls to 93.8 there.
///
/// # Source
/// Garwood 1936.
pub fn poisson_interval(count: u64, level: f64) -> Interval {
    let outside = 1.0 - level;
    if count == 0 {
        return Interval::new(0.0, -ln(outside));
    }
    let half = 0.5 * outside;
    let high = root_of_falling(half, |mean| poisson_lower_tail(count, mean));
    // The upper tail grows with the mean: its complement falls.
    let low = root_of_falling(1.0 - half, |mean| 1.0 - poisson_upper_tail(count, mean));
    Interval::new(low, high)
}

/// Interval of a fraction, from `successes` out of `trials` (at least 1), at `level`.
///
/// # Source
/// Wilson 1927: the score test turned round; it stays inside [0, 1] and has a width at 0 and at 1.
pub fn wilson_interval(successes: u64, trials: u64, level: f64) -> Interval {
    let n = trials as f64;
    let fraction = successes as f64 / n;
    let z = normal_critical(1.0 - level);
    let z2 = z * z;
    let centre = (fraction + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = z / (1.0 + z2 / n) * (fraction * (1.0 - fraction) / n + z2 / (4.0 * n * n)).sqrt();
    // At the ends of the range the two terms are equal but for rounding.
    let low = if successes == 0 { 0.0 } else { (centre - half).max(0.0) };
    let high = if successes == trials { 1.0 } else { (centre + half).min(1.0) };
    Interval::new(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};

    #[test]
    fn mean_interval_by_hand() {
        // 1..=5: mean 3, error sqrt(1/2), t(0.975; 4) = 2.776.
        let interval = mean_interval(&[1.0, 2.0, 3.0, 4.0, 5.0].iter().collect(), 0.95);
        assert!((interval.high - (3.0 + 2.776_445_105_197_793_4 * 0.5f64.sqrt())).abs() < 1e-9);
        assert!((interval.low + interval.high - 6.0).abs() < 1e-12);
        assert_eq!(mean_interval(&[1.0].iter().collect(), 0.95).high, f64::INFINITY);
    }

    /// Garwood's table: 1 -> [0.0253, 5.572], 10 -> [4.795, 18.391].
    #[test]
    fn poisson_intervals_stand_in_the_table() {
        let zero = poisson_interval(0, 0.95);
        assert!(zero.low == 0.0 && (zero.high - 2.995_732_273_553_991).abs() < 1e-12);
        let one = poisson_interval(1, 0.95);
        assert!((one.low - 0.025_317_8).abs() < 1e-6 && (one.high - 5.571_643_4).abs() < 1e-6);
        let ten = poisson_interval(10, 0.95);
        assert!((ten.low - 4.795_389).abs() < 1e-5 && (ten.high - 18.390_356).abs() < 1e-5);
    }

    /// Coverage summed over all counts, without simulation: the level, but for the stated gap of the rule of three.
    #[test]
    fn poisson_intervals_cover_at_least_their_level() {
        for (mean, least) in [
            (0.01, 0.95),
            (0.5, 0.95),
            (1.0, 0.95),
            (2.99, 0.95),
            (2.996, 0.938),
            (3.1, 0.938),
            (3.69, 0.95),
            (7.0, 0.95),
            (20.0, 0.95),
        ] {
            let mut term = crate::math::exp(-mean);
            let mut covered = 0.0;
            for count in 0..80u64 {
                if poisson_interval(count, 0.95).contains(mean) {
                    covered += term;
                }
                term *= mean / (count + 1) as f64;
            }
            assert!(covered >= least, "mean {mean}: {covered}");
        }
    }

    #[test]
    fn wilson_by_hand_and_at_the_ends() {
        // 5 of 10 at 95 %: 0.2366 to 0.7634 (Brown, Cai and DasGupta 2001).
        let half = wilson_interval(5, 10, 0.95);
        assert!((half.low - 0.236_593).abs() < 1e-5 && (half.high - 0.763_407).abs() < 1e-5);
        let none = wilson_interval(0, 10, 0.95);
        assert!(none.low == 0.0 && (none.high - 0.277_533).abs() < 1e-5);
        assert!(wilson_interval(10, 10, 0.95).high == 1.0);
    }

    #[test]
    fn equivalence_needs_the_whole_interval() {
        let margin = Interval::about(1.0, 0.05);
        assert!(Interval::new(0.96, 1.04).is_within(&margin));
        assert!(!Interval::new(0.94, 1.0).is_within(&margin));
        assert!(!Interval::new(f64::NAN, 1.0).is_within(&margin));
    }

    /// 4000 sets of 8 normal values: coverage of the 95 % interval within 5 binomial standard deviations (0.017).
    #[test]
    fn mean_intervals_of_few_maps_cover_their_level() {
        let mut inside = 0;
        for set in 0..4000 {
            let mut stream = Stream::new(3, Purpose::Synthetic, set, 0);
            let moments: Moments = (0..8).map(|_| crate::stats::mean::tests::normal(&mut stream)).collect();
            inside += u64::from(mean_interval(&moments, 0.95).contains(0.0));
        }
        assert!((inside as f64 / 4000.0 - 0.95).abs() < 5.0 * (0.95f64 * 0.05 / 4000.0).sqrt());
    }
}
