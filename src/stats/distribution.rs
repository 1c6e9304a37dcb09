//! Tail probabilities and critical values, exact far into the tails.

use crate::math::exp;
use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::gamma::{gamma_lr, gamma_ur};

/// Two-sided p-value of a standard normal `z`, by libm's complementary error function: that of statrs 0.19 is 4.5e-11
/// off at 2.
pub fn normal_p(z: f64) -> f64 {
    libm::erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2)
}

/// Two-sided p-value of Student's t with `freedom` degrees of freedom (at least 1).
///
/// A non-number has p = 0: an undefined distance is not a pass.
pub fn student_p(t: f64, freedom: u64) -> f64 {
    if t.is_nan() || t.is_infinite() {
        return 0.0;
    }
    match StudentsT::new(0.0, 1.0, freedom.max(1) as f64) {
        Ok(distribution) => 2.0 * distribution.sf(t.abs()),
        Err(_) => f64::NAN,
    }
}

/// P(sum of the squares of `freedom` standard normals >= `sum`).
pub fn chi_squared_p(sum: f64, freedom: u64) -> f64 {
    if freedom == 0 || sum <= 0.0 { 1.0 } else { gamma_ur(0.5 * freedom as f64, 0.5 * sum) }
}

/// The z that a standard normal exceeds in size with probability `alpha`, in (0, 1).
pub fn normal_critical(alpha: f64) -> f64 {
    root_of_falling(alpha, normal_p)
}

/// The t that Student's t with `freedom` degrees of freedom exceeds in size with probability `alpha`, in (0, 1).
pub fn student_critical(alpha: f64, freedom: u64) -> f64 {
    root_of_falling(alpha, |t| student_p(t, freedom))
}

/// P(count >= `count`) for a Poisson count of mean `mean`.
pub fn poisson_upper_tail(count: u64, mean: f64) -> f64 {
    match count {
        0 => 1.0,
        _ if mean <= 0.0 => 0.0,
        _ => gamma_lr(count as f64, mean),
    }
}

/// P(count <= `count`) for a Poisson count of mean `mean`.
pub(super) fn poisson_lower_tail(count: u64, mean: f64) -> f64 {
    if mean <= 0.0 { 1.0 } else { gamma_ur(count as f64 + 1.0, mean) }
}

/// The x >= 0 with `falling(x) = level`, for a function that falls from at least `level` towards 0.
///
/// Bisection to the last bit; a hundred evaluations are nothing beside a map, and there is no tail in which a
/// series or a starting value could fail.
pub(super) fn root_of_falling(level: f64, falling: impl Fn(f64) -> f64) -> f64 {
    let mut high = 1.0;
    while falling(high) > level && high < 1e300 {
        high *= 2.0;
    }
    let mut low = 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if falling(middle) > level {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Kolmogorov's distribution: probability that the scaled distance of a large sample exceeds `x`, without the
/// first term of its series.
pub(super) fn kolmogorov_later_terms(x: f64) -> f64 {
    let mut sum = 0.0;
    for k in 2..=100 {
        let k2 = f64::from(k * k);
        let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
        let term = exp(-2.0 * k2 * x * x);
        sum += 2.0 * sign * term;
        if term < 1e-18 {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::atan2;
    use std::f64::consts::PI;

    fn relative(a: f64, b: f64) -> f64 {
        (a / b - 1.0).abs()
    }

    /// Closed forms of the two-sided p for 1, 2 and 4 degrees of freedom, written without cancellation.
    #[test]
    fn student_p_follows_the_closed_forms_into_the_tail() {
        for t in [1e-3, 0.5, 1.0, 3.0, 30.0, 1e3, 1e5] {
            let one = 2.0 / PI * atan2(1.0, t);
            let root = (t * t + 2.0f64).sqrt();
            let two = (2.0 / (t * t + 2.0)) / (1.0 + t / root);
            // 1 - s (3 - s^2)/2 with s = t/sqrt(t^2+4) is (1-s)^2 (2+s)/2.
            let s = t / (t * t + 4.0f64).sqrt();
            let one_minus_s = (4.0 / (t * t + 4.0)) / (1.0 + s);
            let four = one_minus_s * one_minus_s * (2.0 + s) / 2.0;
            for (freedom, exact) in [(1, one), (2, two), (4, four)] {
                // statrs documents about 1e-12 for its continued fraction.
                assert!(relative(student_p(t, freedom), exact) < 1e-11, "t = {t}, {freedom} degrees");
            }
        }
    }

    /// Tables: 2.228 (10, 5 %), 4.032 (5, 1 %), 1.960, 4.8916 (normal, 1e-6).
    #[test]
    fn critical_values_stand_in_the_tables() {
        assert!((student_critical(0.05, 10) - 2.228_138_851_964_938_5).abs() < 1e-9);
        assert!((student_critical(0.01, 5) - 4.032_142_983_557_536).abs() < 1e-9);
        assert!((normal_critical(0.05) - 1.959_963_984_540_054).abs() < 1e-9);
        assert!((normal_critical(1e-6) - 4.891_638_475_699_41).abs() < 1e-8);
        assert!((student_critical(1e-6, 7) - 15.76).abs() < 0.05);
        assert!((student_critical(1e-6, 63) - 5.42).abs() < 0.01);
    }

    /// Two-sided tails of the normal distribution; the argument's own rounding moves the last by 2e-15.
    #[test]
    fn normal_p_stands_in_the_table() {
        let table = [
            (1.0, 0.317_310_507_862_914_1),
            (2.0, 0.045_500_263_896_358_42),
            (5.0, 5.733_031_437_583_877e-7),
        ];
        for (z, p) in table {
            assert!(relative(normal_p(z), p) < 1e-14, "{z}: {:e}", normal_p(z));
            assert_eq!(normal_p(-z), normal_p(z));
        }
    }

    #[test]
    fn critical_values_invert_p() {
        for freedom in [1, 3, 7, 63, 1000] {
            for alpha in [0.9, 0.05, 1e-6, 1e-12] {
                assert!(relative(student_p(student_critical(alpha, freedom), freedom), alpha) < 1e-12);
            }
        }
    }

    #[test]
    fn poisson_tails_are_sums() {
        let mean = 2.5;
        let mut below = 0.0;
        let mut term = exp(-mean);
        for count in 0..12u64 {
            assert!(relative(poisson_upper_tail(count, mean), 1.0 - below) < 1e-9);
            below += term;
            assert!(relative(poisson_lower_tail(count, mean), below) < 1e-12);
            term *= mean / (count + 1) as f64;
        }
    }

    #[test]
    fn what_is_not_a_number_never_passes() {
        assert_eq!(student_p(f64::NAN, 10), 0.0);
        assert_eq!(student_p(f64::INFINITY, 10), 0.0);
    }
}
