//! Isotropic beams that cross a ray: the law of 1/sin theta, closed.

use crate::error::{Error, Result, within};
use crate::value::Value;
use libm::{asin, log, sin};
use std::f64::consts::PI;

const METHOD: &str = "closed form";

/// Probability that a beam that crosses contributes more than x times what a perpendicular one does.
///
/// The angle of those that cross has density (2/pi) sin^2 theta: P = (2/pi)(a - sin a cos a), sin a = 1/x.
/// # Arguments
/// `x` 1/sin theta \[1\], 1 to 1e100
/// # Errors
/// `Error::OutOfRange` naming `x`
/// # Limits
/// x -> infinity: (4/(3 pi)) x^-3
pub fn crossing_tail(x: f64) -> Result<Value> {
    within("x", x, 1.0, 1e100, "1 to 1e100")?;
    let a = asin(1.0 / x);
    let value = if a < 0.25 {
        // 2a - sin 2a = sum of (2a)^(2k+1)/(2k+1)!, alternating.
        let y = 2.0 * a;
        let (mut term, mut sum, mut k) = (y * y * y / 6.0, 0.0, 3.0);
        while term.abs() > 1e-18 * sum {
            sum += term;
            term *= -y * y / ((k + 1.0) * (k + 2.0));
            k += 2.0;
        }
        sum / PI
    } else {
        (2.0 * a - sin(2.0 * a)) / PI
    };
    Ok(Value::rounded(value, 64.0, METHOD))
}

/// Moment E\[X^j; X <= cap\] of X = 1/sin theta over isotropic beams that cross.
///
/// With sin a = 1/cap: 1 - P(X > cap), (4/pi) cos a, 2 - 4a/pi, (4/pi) ln cot(a/2), (4/pi) cot a for j = 0 to 4.
/// # Arguments
/// `j` 0 to 4; `cap` 1 to 1e100
/// # Errors
/// `Error::OutOfRange` naming `j` or `cap`
/// # Limits
/// cap -> infinity: 1, 4/pi, 2, and for j = 3, 4 without bound: (4/pi) ln(2 cap), (4/pi) cap
pub fn crossing_moment(j: u32, cap: f64) -> Result<Value> {
    within("cap", cap, 1.0, 1e100, "1 to 1e100")?;
    let a = asin(1.0 / cap);
    // cos a of a quotient near 1 cancels: (cap - 1)(cap + 1) does not.
    let cosine = ((cap - 1.0) * (cap + 1.0)).sqrt() / cap;
    let value = match j {
        0 => 1.0 - crossing_tail(cap)?.value,
        1 => 4.0 / PI * cosine,
        2 => 2.0 - 4.0 * a / PI,
        // cot(a/2) = (1 + cos a)/sin a.
        3 => 4.0 / PI * log(cap * (1.0 + cosine)),
        4 => 4.0 / PI * cap * cosine,
        _ => return Err(Error::OutOfRange { name: "j", value: f64::from(j), allowed: "0 to 4" }),
    };
    // At cap = 1 all of them vanish, as differences of numbers of order 1.
    Ok(Value::new(value, 32.0 * f64::EPSILON * (1.0 + value), METHOD))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;

    #[test]
    fn closed_forms_are_the_integrals() {
        let rule = GaussLegendre::rule(60);
        for cap in [1.0, 1.01, 2.0, 7.0, 40.0] {
            let a = asin(1.0 / cap);
            for j in 0..=4 {
                // int (2/pi) sin^(2-j) from a to pi - a, by halving panels towards a.
                let f = |theta: f64| 4.0 / PI * libm::pow(sin(theta), 2.0 - f64::from(j));
                let (mut low, mut want) = (a, 0.0);
                while low < 0.5 * PI {
                    let high = (2.0 * low).min(0.5 * PI);
                    want += rule.integrate(low, high, f);
                    low = high;
                }
                let got = crossing_moment(j, cap).unwrap();
                assert!((got.value - want).abs() <= got.error + 1e-13 * want, "{j} {cap}: {got:?} {want}");
            }
        }
    }

    #[test]
    fn the_tail_falls_like_the_cube() {
        for x in [1.0, 1.5, 4.0, 4.1, 100.0] {
            // Below a the density integrated by a rule: (4/pi) int_0^a sin^2.
            let rule = GaussLegendre::rule(30);
            let want = rule.integrate(0.0, asin(1.0 / x), |t| 4.0 / PI * sin(t) * sin(t));
            let got = crossing_tail(x).unwrap();
            assert!((got.value - want).abs() <= got.error + 1e-14 * want, "{x} {got:?} {want}");
        }
        let x = 1e30;
        assert!((crossing_tail(x).unwrap().value * x * x * x * 0.75 * PI - 1.0).abs() < 1e-14);
        let ratio = crossing_tail(200.0).unwrap().value / crossing_tail(100.0).unwrap().value;
        assert!((ratio - 0.125).abs() < 1e-4, "{ratio}");
        assert!(crossing_tail(0.5).is_err() && crossing_moment(5, 2.0).is_err());
        assert!((libm::cos(asin(0.5)) - crossing_moment(1, 2.0).unwrap().value * PI / 4.0).abs() < 1e-15);
    }
}
