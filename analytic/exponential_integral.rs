//! Exponential integrals: E_n, the kernel of every plane problem, and the entire functions behind it.
//!
//! E_n(x) = int_1^inf e^(-x u) u^(-n) du. E_1(x) = -gamma - ln x + Ein(x), where Ein(x) = int_0^x (1 - e^(-v))/v dv
//! is entire: up to x = 1 its series, beyond it the continued fraction of E_n.

use crate::error::{Error, Result, within};
use crate::value::Value;
use libm::{exp, log};

/// Euler's constant.
pub(crate) const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Roundings that E_n may carry: at x = 1 the series of E_1 loses a factor of four, each recurrence up to another
/// four; the tests compare with multiple-precision values and an independent library.
const ULPS: f64 = 16.0;

/// Exponential integral E_n(x) for n >= 1.
///
/// # Arguments
/// `n` order, 1 to 1000; `x` argument \[1\], 0 or more (above 0 for n = 1)
/// # Returns
/// \[1\], relative error under 16 roundings
/// # Errors
/// `Error::OutOfRange` for another order or argument
/// # Limits
/// E_n(0) = 1/(n-1); E_n(x) -> e^(-x)/x for x -> inf
/// # Source
/// Abramowitz and Stegun 1964, section 5.1
pub fn exponential_integral(n: u32, x: f64) -> Result<Value> {
    within("n", f64::from(n), 1.0, 1000.0, "1 to 1000")?;
    within("x", x, 0.0, f64::INFINITY, "0 or more")?;
    if n == 1 && x == 0.0 {
        return Err(Error::OutOfRange { name: "x", value: x, allowed: "above 0 for n = 1" });
    }
    Ok(Value::rounded(e_n(n, x), ULPS, "series to x = 1, continued fraction beyond"))
}

/// E_n(x) for arguments known to be valid; E_1(0) is infinite.
pub(crate) fn e_n(n: u32, x: f64) -> f64 {
    if x > 1.0 {
        return exp(-x) * continued_fraction(n, x);
    }
    if x == 0.0 {
        return 1.0 / (f64::from(n) - 1.0);
    }
    // Upward recurrence: each step multiplies the error by about x/k, at most 1 here.
    let decay = exp(-x);
    let mut e = -EULER_GAMMA - log(x) + ein_series(x);
    for k in 1..n {
        e = (decay - x * e) / f64::from(k);
    }
    e
}

/// E_1(x), x > 0.
pub(crate) fn e1(x: f64) -> f64 {
    if x > 1.0 {
        if x > 746.0 { 0.0 } else { exp(-x) * continued_fraction(1, x) }
    } else {
        -EULER_GAMMA - log(x) + ein_series(x)
    }
}

/// e^x E_n(x) for x > 1: even part of the continued fraction, from the tail.
fn continued_fraction(n: u32, x: f64) -> f64 {
    // Terms until the relative remainder is under 1e-16: found to be 92 at x = 1 and 14 at x = 10 for n = 1 to 3,
    // fewer for larger n; 8 + 90/x covers all with a margin.
    let n = f64::from(n);
    let terms = 8.0 + (90.0 / x).ceil();
    let mut i = terms;
    let mut f = x + n + 2.0 * terms;
    while i >= 1.0 {
        f = x + n + 2.0 * (i - 1.0) - i * (n + i - 1.0) / f;
        i -= 1.0;
    }
    1.0 / f
}

/// Ein(x) = sum_(k>=1) (-1)^(k+1) x^k / (k k!), for 0 <= x <= 1 (to 2 with a last digit less).
fn ein_series(x: f64) -> f64 {
    let (mut power, mut sum, mut k) = (x, x, 1.0);
    while power.abs() > 1e-18 * sum {
        k += 1.0;
        power *= -x / k;
        sum += power / k;
    }
    sum
}

/// Ein(x) = int_0^x (1 - e^(-v))/v dv, x >= 0.
pub(crate) fn ein(x: f64) -> f64 {
    if x <= 1.0 { ein_series(x) } else { e1(x) + log(x) + EULER_GAMMA }
}

/// e^(-y) int_0^y (e^v - 1)/v dv = e^(-y) (Ei(y) - gamma - ln y), y >= 0: all terms positive.
pub(crate) fn eim_scaled(y: f64) -> f64 {
    if y > 40.0 {
        // Asymptotic series of Ei: the smallest term is e^(-40); gamma + ln y times e^(-40) is below rounding too.
        let (mut term, mut sum, mut k) = (1.0 / y, 1.0 / y, 0.0);
        while term > 1e-18 * sum && k < 39.0 {
            k += 1.0;
            term *= k / y;
            sum += term;
        }
        return sum;
    }
    let (mut power, mut sum, mut k) = (y, y, 1.0);
    while power > 1e-18 * sum {
        k += 1.0;
        power *= y / k;
        sum += power / k;
    }
    exp(-y) * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// E_n(x) from a multiple-precision library, rounded to f64.
    const KNOWN: &[(u32, f64, f64)] = &[
        (1, 1e-300, 690.1983122333122),
        (1, 1e-12, 27.053805451028015),
        (1, 0.001, 6.331539364136149),
        (1, 0.3, 0.9056766516758468),
        (1, 0.999, 0.21975218202294455),
        (1, 1.0, 0.21938393439552029),
        (1, 1.0000001, 0.21938389760757981),
        (1, 1.5, 0.10001958240663265),
        (1, 3.7, 0.005447824656770462),
        (1, 10.0, 4.156968929685325e-06),
        (1, 55.5, 1.3955306227669237e-26),
        (1, 700.0, 1.406518766234033e-307),
        (2, 1e-300, 1.0),
        (2, 1e-12, 0.9999999999719462),
        (2, 0.001, 0.9926689604692388),
        (2, 0.3, 0.46911522517896387),
        (2, 0.999, 0.14871507477274132),
        (2, 1.0, 0.14849550677592205),
        (2, 1.0000001, 0.14849548483753044),
        (2, 1.5, 0.07310078653848084),
        (2, 3.7, 0.004566575240288675),
        (2, 10.0, 3.830240465631609e-06),
        (2, 55.5, 1.3716483424442408e-26),
        (2, 700.0, 1.4045180121540397e-307),
        (3, 1e-300, 0.5),
        (3, 1e-12, 0.499999999999),
        (3, 0.001, 0.4990039154364529),
        (3, 0.3, 0.30004182656401435),
        (3, 0.999, 0.10984057245784717),
        (3, 1.0, 0.10969196719776014),
        (3, 1.0000001, 0.10969195234821055),
        (3, 1.5, 0.056739490170354276),
        (3, 3.7, 0.003913599040635644),
        (3, 10.0, 3.548762553084382e-06),
        (3, 55.5, 1.3485574501765684e-26),
        (3, 700.0, 1.4025229340746378e-307),
        (4, 1e-300, 0.3333333333333333),
        (4, 1e-12, 0.3333333333328333),
        (4, 0.001, 0.33283383197264615),
        (4, 0.3, 0.21693522423750453),
        (4, 0.999, 0.0861722575760912),
        (4, 1.0, 0.08606249132456073),
        (4, 1.0000001, 0.08606248035536475),
        (4, 1.5, 0.04600697496429947),
        (4, 3.7, 0.0034144033399958343),
        (4, 10.0, 3.3041014105470106e-06),
        (4, 55.5, 1.3262198070696513e-26),
        (4, 700.0, 1.4005335079101904e-307),
        (7, 1e-300, 0.16666666666666666),
        (7, 1e-12, 0.16666666666646668),
        (7, 0.001, 0.16646679161113193),
        (7, 0.3, 0.11656832448019365),
        (7, 0.999, 0.05145858702045865),
        (7, 1.0, 0.051399066738249656),
        (7, 1.0000001, 0.05139906078974593),
        (7, 1.5, 0.02892159634922895),
        (7, 3.7, 0.0024506470220325167),
        (7, 10.0, 2.7324414204314788e-06),
        (7, 55.5, 1.2633796054976987e-26),
        (7, 700.0, 1.3945989020828561e-307),
        (12, 1e-300, 0.09090909090909091),
        (12, 1e-12, 0.09090909090899091),
        (12, 0.001, 0.09080914644381909),
        (12, 0.3, 0.06539162236334539),
        (12, 0.999, 0.030463248244566036),
        (12, 1.0, 0.030430081496130884),
        (12, 1.0000001, 0.030430078181276594),
        (12, 1.5, 0.017670319792289745),
        (12, 3.7, 0.001652672283006235),
        (12, 10.0, 2.1139115063892826e-06),
        (12, 55.5, 1.1707676559797149e-26),
        (12, 700.0, 1.384818721662997e-307),
        (13, 1e-300, 0.08333333333333333),
        (13, 1e-12, 0.08333333333324243),
        (13, 0.001, 0.08324247422391093),
        (13, 0.3, 0.06010006116439286),
        (13, 0.999, 0.028151226634778453),
        (13, 1.0, 0.02812077997294262),
        (13, 1.0000001, 0.028120776929934633),
        (13, 1.5, 0.016385390038332934),
        (13, 3.7, 0.0015507199186013598),
        (13, 10.0, 2.021734558216002e-06),
        (13, 55.5, 1.1538327499278609e-26),
        (13, 700.0, 1.382879100989928e-307),
        (50, 1e-300, 0.02040816326530612),
        (50, 1e-12, 0.02040816326528529),
        (50, 0.001, 0.0203873405666484),
        (50, 0.3, 0.015024846311309022),
        (50, 0.999, 0.007362097884723892),
        (50, 1.0, 0.0073545894972313),
        (50, 1.0000001, 0.007354588746775758),
        (50, 1.5, 0.0044157725848881875),
        (50, 3.7, 0.00046850268018935615),
        (50, 10.0, 7.672615506215421e-07),
        (50, 55.5, 7.504810475316477e-27),
        (50, 700.0, 1.3147401151194962e-307),
        (1000, 1e-300, 0.001001001001001001),
        (1000, 1e-12, 0.001001001000999999),
        (1000, 0.001, 0.0009999994983302045),
        (1000, 0.3, 0.0007413369337556753),
        (1000, 0.999, 0.0003682475046140323),
        (1000, 1.0, 0.0003678790729248608),
        (1000, 1.0000001, 0.00036787903610013064),
        (1000, 1.5, 0.00022301831629646584),
        (1000, 3.7, 2.465686186840656e-05),
        (1000, 10.0, 4.499453260351645e-08),
        (1000, 55.5, 7.474600338142139e-28),
        (1000, 700.0, 5.801816308038085e-308),
    ];

    #[test]
    fn multiple_precision_values_are_met() {
        for &(n, x, reference) in KNOWN {
            let ours = exponential_integral(n, x).unwrap();
            assert!(
                ours.covers(reference),
                "E_{n}({x}) = {} +- {:e}, not {reference}",
                ours.value,
                ours.error
            );
        }
    }

    #[test]
    fn the_argument_that_statrs_refuses_is_answered() {
        let x = 1.048_769_939_709_662_6;
        assert!(statrs::function::exponential::integral(x, 2).is_none());
        let e2 = exponential_integral(2, x).unwrap().value;
        // E_2 = e^(-x) - x E_1.
        let by_recurrence = exp(-x) - x * e_n(1, x);
        assert!((e2 - by_recurrence).abs() < 4.0 * f64::EPSILON * exp(-x));
    }

    #[test]
    fn ei_minus_its_logarithm() {
        // Ei(1) - gamma and Ei(50) scaled, from a multiple-precision library.
        assert!((eim_scaled(1.0) * exp(1.0) - 1.317_902_151_454_403_9).abs() < 1e-15);
        assert!((eim_scaled(50.0) - 0.020417045555943987).abs() < 1e-17);
        assert!((eim_scaled(40.0) / 0.025658862785975126 - 1.0).abs() < 2e-15);
    }

    #[test]
    fn refusals_name_the_parameter() {
        for (n, x) in [(0, 1.0), (1, 0.0), (2, -1.0), (2, f64::NAN), (1001, 1.0)] {
            assert!(exponential_integral(n, x).is_err());
        }
        assert_eq!(exponential_integral(3, f64::INFINITY).unwrap().value, 0.0);
    }

    proptest! {
        #![proptest_config(crate::fixed_cases(256))]

        #[test]
        fn agrees_with_statrs_where_it_answers(n in 1_u64..30, lx in -30.0..6.0_f64) {
            let x = exp(lx);
            let ours = exponential_integral(n as u32, x).unwrap();
            // statrs is accurate to 6e-15 relative.
            if let Some(theirs) = statrs::function::exponential::integral(x, n) {
                prop_assert!((ours.value - theirs).abs() <= ours.error + 1e-14 * theirs.abs());
            }
        }

        #[test]
        fn recurrence_holds(n in 1_u32..900, lx in -30.0..6.0_f64) {
            // n E_(n+1) = e^(-x) - x E_n: the terms' own bounds are the tolerance.
            let x = exp(lx);
            let (a, b) = (exponential_integral(n, x).unwrap(), exponential_integral(n + 1, x).unwrap());
            let defect = f64::from(n) * b.value - (exp(-x) - x * a.value);
            prop_assert!(defect.abs() <= f64::from(n) * b.error + x * a.error + 4.0 * f64::EPSILON * exp(-x));
        }
    }
}
