//! Tests of a mean, and what they can detect.

use super::{ALPHA, Moments, normal_p, student_critical, student_p};

/// The normal quantile of 99 per cent power, 2.33, rounded up: a bias of (t_alpha + 2.4) standard errors is detected 99
/// times in 100 with many maps, 98.5 times with 64 (the estimated error adds to the spread; measured in the tests).
pub const POWER_QUANTILE: f64 = 2.4;

/// A mean against a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanTest {
    /// Estimate minus reference.
    pub difference: f64,
    /// Standard error of the difference, the reference's own error included.
    pub std_error: f64,
    /// Difference over its error.
    pub z: f64,
    /// Two-sided p-value.
    pub p: f64,
    /// The smallest bias that this test at [`ALPHA`] hardly ever misses; see [`POWER_QUANTILE`].
    pub smallest_bias: f64,
}

/// Student's t test of a mean against `reference`, whose own standard error (or error bound) is `reference_error`.
///
/// Degrees of freedom are n - 1, as if all of the error were estimated: with an exactly known part that is
/// cautious. Below two values nothing is tested and p is 1 with an infinite smallest bias. Without any spread p is
/// 1 if the difference is 0, else 0.
pub fn t_test(moments: &Moments, reference: f64, reference_error: f64) -> MeanTest {
    let difference = moments.mean() - reference;
    let std_error = libm::hypot(moments.std_error(), reference_error);
    if moments.n() < 2 {
        return MeanTest { difference, std_error, z: 0.0, p: 1.0, smallest_bias: f64::INFINITY };
    }
    let freedom = moments.n() - 1;
    let z = if difference == 0.0 { 0.0 } else { difference / std_error };
    let smallest_bias = smallest_detectable_bias(std_error, freedom);
    MeanTest { difference, std_error, z, p: student_p(z, freedom), smallest_bias }
}

/// The test of a mean whose standard error is known, not estimated.
pub fn z_test(mean: f64, std_error: f64, reference: f64) -> MeanTest {
    let difference = mean - reference;
    let z = if difference == 0.0 { 0.0 } else { difference / std_error };
    let p = if z.is_nan() { 0.0 } else { normal_p(z) };
    let smallest_bias = (super::normal_critical(ALPHA) + POWER_QUANTILE) * std_error;
    MeanTest { difference, std_error, z, p, smallest_bias }
}

/// The smallest bias that a two-sided t test at [`ALPHA`] hardly ever misses; see [`POWER_QUANTILE`].
pub fn smallest_detectable_bias(std_error: f64, freedom: u64) -> f64 {
    (student_critical(ALPHA, freedom) + POWER_QUANTILE) * std_error
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::math::{ln, sin_cos};
    use crate::rng::{Purpose, Stream};
    use crate::stats::wilson_interval;

    /// A standard normal value (Box and Muller 1958).
    pub fn normal(stream: &mut Stream) -> f64 {
        let radius = (-2.0 * ln(stream.open_unit())).sqrt();
        radius * sin_cos(2.0 * std::f64::consts::PI * stream.unit()).1
    }

    fn maps(set: u64, count: u64, shift: f64) -> Moments {
        let mut stream = Stream::new(11, Purpose::Synthetic, set, 0);
        (0..count).map(|_| normal(&mut stream) + shift).collect()
    }

    #[test]
    fn by_hand() {
        let test = t_test(&[1.0, 2.0, 3.0, 4.0, 5.0].iter().collect(), 2.0, 0.0);
        assert!((test.z - 2f64.sqrt()).abs() < 1e-14);
        // Two-sided p of t = sqrt 2 at 4 degrees: s = 1/sqrt 3, p = 1 - s (3 - s^2)/2.
        let s = 1.0 / 3f64.sqrt();
        assert!((test.p - (1.0 - s * (3.0 - s * s) / 2.0)).abs() < 1e-12);
    }

    /// Two known standard errors away: p = 0.0455; what is seen is 4.8916 + 2.4 of them.
    #[test]
    fn a_known_error_by_hand() {
        let test = z_test(1.2, 0.1, 1.0);
        assert!((test.difference - 0.2).abs() < 1e-15 && (test.z - 2.0).abs() < 1e-14);
        assert!((test.p - 0.045_500_263_896_358_4).abs() < 1e-12, "{:.17}", test.p);
        assert!((test.smallest_bias - 0.729_163_847_569_944).abs() < 1e-9);
        assert_eq!((z_test(1.0, 0.0, 1.0).p, z_test(1.0, 0.0, 2.0).p), (1.0, 0.0));
        assert_eq!(z_test(f64::NAN, 1.0, 0.0).p, 0.0);
    }

    /// With 63 degrees of freedom the threshold is 5.42: 7.82 standard errors in all.
    #[test]
    fn the_smallest_bias_by_hand() {
        assert!((smallest_detectable_bias(0.01, 63) - 0.0782).abs() < 1e-4);
        assert!((smallest_detectable_bias(0.01, 7) - 0.1816).abs() < 5e-4);
        assert_eq!(smallest_detectable_bias(f64::INFINITY, 63), f64::INFINITY);
    }

    #[test]
    fn a_reference_with_an_error_widens_the_test() {
        let values: Moments = [1.0, 2.0, 3.0, 4.0, 5.0].iter().collect();
        assert!((t_test(&values, 2.0, 0.5f64.sqrt()).z - 1.0).abs() < 1e-14);
    }

    #[test]
    fn degenerate_samples() {
        let equal: Moments = [2.0, 2.0, 2.0].iter().collect();
        assert_eq!(t_test(&equal, 2.0, 0.0).p, 1.0);
        assert_eq!(t_test(&equal, 2.1, 0.0).p, 0.0);
        assert_eq!(t_test(&[2.0].iter().collect(), 0.0, 0.0).p, 1.0);
        let broken: Moments = [2.0, f64::NAN, 1.0].iter().collect();
        assert_eq!(t_test(&broken, 2.0, 0.0).p, 0.0);
    }

    /// False alarms at 1 % over 20,000 right sets of 8 maps: the rate lies in its own interval. The normal
    /// threshold on the same data is the negative control: it must be detected to be wrong.
    #[test]
    fn false_alarm_rate_on_right_data() {
        let (mut by_t, mut by_normal) = (0, 0);
        for set in 0..20_000 {
            let test = t_test(&maps(set, 8, 0.0), 0.0, 0.0);
            by_t += u64::from(test.p < 0.01);
            by_normal += u64::from(normal_p(test.z) < 0.01);
        }
        assert!(wilson_interval(by_t, 20_000, 1.0 - ALPHA).contains(0.01), "{by_t} of 20000");
        assert!(wilson_interval(by_normal, 20_000, 1.0 - ALPHA).low > 0.01, "{by_normal} of 20000");
    }

    /// Power at the stated smallest bias, M = 64, against the noncentral t: with s^2 = chi^2 / 63 the test rejects
    /// with probability Phi(delta - t s), averaged over s. That is 98.5 %, not quite the 99 % of a known error.
    #[test]
    fn power_at_the_smallest_bias() {
        use statrs::distribution::{ChiSquared, Continuous};
        let critical = student_critical(ALPHA, 63);
        let delta = critical + POWER_QUANTILE;
        let chi_squared = ChiSquared::new(63.0).unwrap();
        let step = 0.05;
        let expected: f64 = (1..4000)
            .map(|i| {
                let x = f64::from(i) * step;
                let upper = delta - critical * (x / 63.0).sqrt();
                let phi = 1.0 - 0.5 * normal_p(upper).min(1.0);
                let phi = if upper < 0.0 { 1.0 - phi } else { phi };
                chi_squared.pdf(x) * phi * step
            })
            .sum();
        assert!((expected - 0.985).abs() < 1e-3, "{expected}");
        let seen = (0..4000).filter(|&set| t_test(&maps(set, 64, delta / 8.0), 0.0, 0.0).p < ALPHA).count();
        assert!(
            wilson_interval(seen as u64, 4000, 1.0 - ALPHA).contains(expected),
            "{seen} of 4000, {expected}"
        );
    }
}
