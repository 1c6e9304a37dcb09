//! The first four moments of a sample, in one pass, with merge.

use super::HEAVY_TAIL;
use crate::faults::{Fault, planted};

/// Count, mean and central sums up to the fourth power.
///
/// Pushing and merging lose no digits to cancellation: all updates work on differences from the mean.
///
/// # Limits
/// The fourth power keeps its range for deviations of 1e-75 to 1e75; outside, variance and mean still hold and the
/// variance of variance does not. A non-finite value makes the mean non-finite: it is not dropped.
///
/// # Source
/// Chan, Golub and LeVeque 1979; Pebay 2008.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    n: u64,
    mean: f64,
    m2: f64,
    m3: f64,
    m4: f64,
}

impl Moments {
    /// No values yet.
    pub fn new() -> Self {
        Moments::default()
    }

    /// Adds one value.
    pub fn push(&mut self, x: f64) {
        if planted(Fault::NonFiniteDropped) && !x.is_finite() {
            return;
        }
        let before = self.n as f64;
        self.n += 1;
        let n = self.n as f64;
        let delta = x - self.mean;
        let step = delta / n;
        let step2 = step * step;
        let spread = if planted(Fault::AbsoluteDeviation) { delta.signum() / n } else { step };
        let term = delta * spread * before;
        self.m4 += term * step2 * (n * n - 3.0 * n + 3.0) + 6.0 * step2 * self.m2 - 4.0 * step * self.m3;
        self.m3 += term * step * (n - 2.0) - 3.0 * step * self.m2;
        self.m2 += term;
        self.mean += step;
        if planted(Fault::SinglePrecisionMean) {
            self.mean = f64::from(self.mean as f32);
        }
    }

    /// Adds all values of another sample.
    pub fn merge(&mut self, other: &Moments) {
        if other.n == 0 {
            return;
        }
        if self.n == 0 {
            *self = *other;
            return;
        }
        let (a, b) = (self.n as f64, other.n as f64);
        let n = a + b;
        let delta = other.mean - self.mean;
        let d = delta / n;
        let d2 = d * d;
        self.m4 += other.m4
            + delta * d * d2 * a * b * (a * a - a * b + b * b)
            + 6.0 * d2 * (a * a * other.m2 + b * b * self.m2)
            + 4.0 * d * (a * other.m3 - b * self.m3);
        self.m3 += other.m3 + delta * d2 * a * b * (a - b) + 3.0 * d * (a * other.m2 - b * self.m2);
        self.m2 += other.m2 + delta * d * a * b;
        self.mean += d * b;
        self.n += other.n;
    }

    /// So many values of 0.
    pub fn zeros(n: u64) -> Self {
        Moments { n, ..Moments::default() }
    }

    /// Number of values.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// Mean; 0 without values.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased variance of one value, sum of squares over n - 1; infinite (unknown) below two values.
    pub fn variance(&self) -> f64 {
        if self.n < 2 { f64::INFINITY } else { self.m2 / (self.n - 1) as f64 }
    }

    /// Standard deviation of one value.
    pub fn std_dev(&self) -> f64 {
        self.variance().sqrt()
    }

    /// Standard error **of the mean**; infinite (unknown) below two values.
    pub fn std_error(&self) -> f64 {
        if planted(Fault::RootForgotten) {
            return self.std_dev();
        }
        if self.n < 2 { f64::INFINITY } else { (self.m2 / ((self.n - 1) as f64 * self.n as f64)).sqrt() }
    }

    /// Skewness, sqrt(n) m3 / m2^(3/2); 0 for equal values.
    pub fn skew(&self) -> f64 {
        if self.m2 == 0.0 { 0.0 } else { (self.n as f64).sqrt() * self.m3 / (self.m2 * self.m2.sqrt()) }
    }

    /// Relative variance of the estimated variance of the mean: sum d^4 / (sum d^2)^2 - 1/n, about 2/n for a
    /// normal sample; 0 for equal values.
    ///
    /// # Source
    /// Estes and Cashwell 1978, as in MCNP and OpenMC.
    pub fn vov(&self) -> f64 {
        if self.m2 == 0.0 { 0.0 } else { self.m4 / (self.m2 * self.m2) - 1.0 / self.n as f64 }
    }

    /// Whether the variance is too uncertain for an interval: [`Moments::vov`] above [`HEAVY_TAIL`].
    pub fn is_heavy_tailed(&self) -> bool {
        // A non-number counts as heavy: nothing is known about its tail.
        self.vov().is_nan() || self.vov() > HEAVY_TAIL
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Moments::new();
        for x in values {
            moments.push(x);
        }
        moments
    }
}

impl<'a> FromIterator<&'a f64> for Moments {
    fn from_iter<I: IntoIterator<Item = &'a f64>>(values: I) -> Self {
        values.into_iter().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};
    use proptest::prelude::*;

    /// Two passes over the values: the definition.
    fn two_pass(values: &[f64]) -> (f64, f64, f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let power = |k: i32| values.iter().map(|x| (x - mean).powi(k)).sum::<f64>();
        (mean, power(2), power(3), power(4))
    }

    fn sample(n: u64, offset: f64) -> Vec<f64> {
        let mut stream = Stream::new(7, Purpose::Synthetic, 0, 0);
        (0..n).map(|_| offset + stream.unit() * stream.unit()).collect()
    }

    // Each of n updates rounds a few times: relative error below a few n eps of the sum of absolute terms.
    fn close(a: f64, b: f64, scale: f64, n: f64) -> bool {
        (a - b).abs() <= 20.0 * n * f64::EPSILON * scale
    }

    #[test]
    fn one_to_five_by_hand() {
        let m: Moments = [1.0, 2.0, 3.0, 4.0, 5.0].iter().collect();
        assert_eq!((m.n(), m.mean(), m.variance()), (5, 3.0, 2.5));
        assert!((m.std_error() - 0.5f64.sqrt()).abs() < 1e-15);
        assert_eq!(m.skew(), 0.0);
        // sum d^4 = 34, sum d^2 = 10.
        assert!((m.vov() - (0.34 - 0.2)).abs() < 1e-15);
    }

    #[test]
    fn push_and_merge_agree_with_two_passes() {
        for offset in [0.0, 1.0] {
            let values = sample(1000, offset);
            let (mean, m2, m3, m4) = two_pass(&values);
            let pushed: Moments = values.iter().collect();
            let mut merged = Moments::new();
            for part in values.chunks(37) {
                merged.merge(&part.iter().collect());
            }
            for m in [pushed, merged] {
                assert_eq!(m.n, 1000);
                assert!(close(m.mean, mean, 2.0, 10.0));
                assert!(
                    close(m.m2, m2, m2, 1000.0) && close(m.m3, m3, m2, 1000.0) && close(m.m4, m4, m2, 1000.0)
                );
            }
        }
    }

    #[test]
    fn a_large_offset_costs_only_its_own_rounding() {
        // Values of spread 1 at 1e8 are themselves rounded to 1.5e-8: the variance keeps 7 digits, not none.
        let near: Moments = sample(1000, 0.0).iter().collect();
        let far: Moments = sample(1000, 1e8).iter().collect();
        assert!((far.variance() / near.variance() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn unknown_errors_are_infinite_not_zero() {
        let one: Moments = [2.0].iter().collect();
        assert_eq!(one.std_error(), f64::INFINITY);
        assert_eq!(Moments::new().variance(), f64::INFINITY);
    }

    #[test]
    fn one_large_value_is_a_heavy_tail() {
        let mut values = vec![0.0; 999];
        values.push(1.0);
        let heavy: Moments = values.iter().collect();
        // One value carries everything: sum d^4 / (sum d^2)^2 is nearly 1.
        assert!(heavy.vov() > 0.99 && heavy.is_heavy_tailed());
        assert!(!sample(1000, 0.0).iter().collect::<Moments>().is_heavy_tailed());
        assert!(![3.0; 10].iter().collect::<Moments>().is_heavy_tailed());
        assert!([1.0, f64::NAN, 2.0].iter().collect::<Moments>().is_heavy_tailed());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]
        #[test]
        fn merging_is_pushing(a in proptest::collection::vec(-1e3f64..1e3, 0..40),
                              b in proptest::collection::vec(-1e3f64..1e3, 0..40)) {
            let mut merged: Moments = a.iter().collect();
            merged.merge(&b.iter().collect());
            let all: Moments = a.iter().chain(&b).collect();
            let scale = |k: i32| 80.0 * 2e3f64.powi(k);
            prop_assert_eq!(merged.n, all.n);
            prop_assert!(close(merged.mean, all.mean, scale(1), 1.0));
            prop_assert!(close(merged.m2, all.m2, scale(2), 1.0));
            prop_assert!(close(merged.m3, all.m3, scale(3), 1.0));
            prop_assert!(close(merged.m4, all.m4, scale(4), 1.0));
        }
    }
}
