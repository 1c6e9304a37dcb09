//! How the uniform kernel blurs an edge, a line and a sinusoid; lengths in units of the radius.

use crate::error::{Result, within};
use crate::kernel::Dimension;
use crate::value::Value;
use libm::{acos, cos, j1, sin};
use std::f64::consts::PI;

const METHOD: &str = "closed form";

/// Edge spread function: the estimate of a unit step, at depth x behind the edge.
///
/// (1+x)/2 | 1 - \[acos x - x sqrt(1-x^2)\]/pi | (1+x)^2 (2-x)/4 for d = 1 | 2 | 3: also the part of a ball inside a
/// half-space whose face lies at distance x from its centre.
/// # Arguments
/// `x` depth over radius \[1\], any finite number
/// # Errors
/// `Error::OutOfRange` naming `x`
pub fn edge_spread(d: Dimension, x: f64) -> Result<Value> {
    within("x", x, f64::MIN, f64::MAX, "finite numbers")?;
    Ok(Value::new(edge(d, x.clamp(-1.0, 1.0)), 8.0 * f64::EPSILON, METHOD))
}

fn edge(d: Dimension, x: f64) -> f64 {
    match d {
        Dimension::One => 0.5 * (1.0 + x),
        Dimension::Two => (acos(-x) + x * ((1.0 - x) * (1.0 + x)).sqrt()) / PI,
        Dimension::Three => 0.25 * (1.0 + x) * (1.0 + x) * (2.0 - x),
    }
}

/// Line spread function, the slope of the edge: 1/2 | 2 sqrt(1-x^2)/pi | (3/4)(1-x^2) for d = 1 | 2 | 3.
///
/// # Arguments
/// `x` distance over radius \[1\], any finite number
/// # Returns
/// \[1/radius\], of unit integral
/// # Errors
/// `Error::OutOfRange` naming `x`
pub fn line_spread(d: Dimension, x: f64) -> Result<Value> {
    within("x", x, f64::MIN, f64::MAX, "finite numbers")?;
    Ok(Value::rounded(line(d, x), 8.0, METHOD))
}

fn line(d: Dimension, x: f64) -> f64 {
    if x.abs() > 1.0 {
        return 0.0;
    }
    let v = (1.0 - x) * (1.0 + x);
    match d {
        Dimension::One => 0.5,
        Dimension::Two => 2.0 / PI * v.sqrt(),
        Dimension::Three => 0.75 * v,
    }
}

/// Modulation transfer: the factor on a sinusoid of q = 2 pi frequency times radius.
///
/// sin q/q | 2 J_1(q)/q | 3 (sin q - q cos q)/q^3 for d = 1 | 2 | 3.
/// # Arguments
/// `q` \[1\], 0 to 1e6
/// # Errors
/// `Error::OutOfRange` naming `q`
/// # Limits
/// q -> 0: 1 - q^2/(2(d+2))
pub fn modulation_transfer(d: Dimension, q: f64) -> Result<Value> {
    within("q", q, 0.0, 1e6, "0 to 1e6")?;
    if q < 1.0 {
        // sum (-1)^k (q/2)^(2k) Gamma(d/2+1)/(k! Gamma(k+d/2+1)).
        let (mut term, mut sum, mut k) = (1.0_f64, 1.0_f64, 0.0);
        while term.abs() > 1e-18 {
            k += 1.0;
            term *= -0.25 * q * q / (k * (k + 0.5 * f64::from(d.number())));
            sum += term;
        }
        return Ok(Value::new(sum, 8.0 * f64::EPSILON, "series"));
    }
    let value = match d {
        Dimension::One => sin(q) / q,
        Dimension::Two => 2.0 * j1(q) / q,
        Dimension::Three => 3.0 * (sin(q) - q * cos(q)) / (q * q * q),
    };
    // Each of the functions is good to an absolute rounding or two, over 1, q/2 or q^2/3.
    Ok(Value::new(value, 16.0 * f64::EPSILON / q.min(1e3).sqrt(), METHOD))
}

/// Width of the box that has the line's peak and integral, over the radius: 2 | pi/2 | 4/3.
pub fn equivalent_width(d: Dimension) -> Value {
    Value::rounded(1.0 / line(d, 0.0), 4.0, METHOD)
}

/// Standard deviation of the line spread over the radius: 1/sqrt(d+2).
pub fn line_deviation(d: Dimension) -> Value {
    Value::rounded(1.0 / f64::from(d.number() + 2).sqrt(), 4.0, METHOD)
}

/// Distance over which the image of an edge rises from 10 to 90 per cent, over the radius.
pub fn rise_width(d: Dimension) -> Value {
    let (mut low, mut high) = (0.0, 1.0);
    // Bisection of a rising function down to neighbouring numbers.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if edge(d, middle) < 0.9 { low = middle } else { high = middle }
    }
    let error = 2.0 * (8.0 * f64::EPSILON / line(d, high) + 2.0 * f64::EPSILON);
    Value::new(low + high, error, "bisection of the closed form")
}

/// What a uniform field loses at a face, integrated over depth, over the radius: int_0^1 (1 - edge) dx.
///
/// r/4 | 2r/(3 pi) | 3r/16 for d = 1 | 2 | 3.
pub fn missing_length(d: Dimension) -> Value {
    let value = match d {
        Dimension::One => 0.25,
        Dimension::Two => 2.0 / (3.0 * PI),
        Dimension::Three => 0.1875,
    };
    Value::rounded(value, 4.0, METHOD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;
    use proptest::prelude::*;

    #[test]
    fn edge_line_and_missing_length_are_one_family() {
        // x = sin(theta) makes the disc's square root smooth.
        let rule = GaussLegendre::rule(60);
        let over = |from: f64, f: &dyn Fn(f64) -> f64| {
            rule.integrate(libm::asin(from), 0.5 * PI, |theta| cos(theta) * f(sin(theta)))
        };
        for d in Dimension::ALL {
            for x in [-1.0, -0.5, 0.0, 0.8] {
                let want = 1.0 - over(x, &|s| line(d, s));
                assert!((edge_spread(d, x).unwrap().value - want).abs() < 1e-14, "{d:?} {x}");
            }
            let lost = over(0.0, &|s| 1.0 - edge(d, s));
            assert!((missing_length(d).value - lost).abs() < 1e-14, "{d:?}");
            let second = 2.0 * over(0.0, &|s| s * s * line(d, s));
            assert!((line_deviation(d).value - second.sqrt()).abs() < 1e-14, "{d:?}");
        }
        assert!((rise_width(Dimension::One).value - 1.6).abs() < 1e-15);
        assert!((rise_width(Dimension::Three).value - 1.216_799_577_4).abs() < 1e-10);
        assert_eq!(edge_spread(Dimension::Two, 3.0).unwrap().value, 1.0);
        assert!(edge_spread(Dimension::Two, f64::NAN).is_err());
    }

    proptest! {
        #![proptest_config(crate::fixed_cases(256))]

        #[test]
        fn transfer_is_the_cosine_transform_of_the_line(q in 0.0..40.0_f64, which in 0_usize..3) {
            let d = Dimension::ALL[which];
            let rule = GaussLegendre::rule(90);
            let want = 2.0 * rule.integrate(0.0, 0.5 * PI, |theta| cos(theta) * line(d, sin(theta)) * cos(q * sin(theta)));
            let got = modulation_transfer(d, q).unwrap();
            prop_assert!((got.value - want).abs() <= got.error + 2e-15, "{got:?} {want}");
        }
    }
}
