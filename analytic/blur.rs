//! How the uniform kernel blurs an edge, a line and a sinusoid, and any other kernel a sinusoid; lengths in units of the
//! radius. Edges of other kernels are in `edge`.
//!
//! A step seen through the kernel is its edge spread function, the integral of the kernel's marginal; a line its marginal,
//! the line spread function; a sinusoid keeps the marginal's cosine transform, the modulation transfer.
//!
//! Limits: frequency 0, transfer 1; beyond the radius an edge is 0 or 1.
//!
//! Source: Goodman 2005, chapter 6, for transfer functions.

use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::quadrature::{GAUSS_16, GAUSS_24};
use crate::value::Value;
use libm::{acos, cos, exp, j1, sin};
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

/// Modulation transfer of any kernel in three dimensions: int K cos(q z) dV, the cosine transform of its marginal.
///
/// # Arguments
/// `q` 2 pi frequency times radius \[1\], 0 to 1e4
/// # Errors
/// `Error::OutOfRange` naming `q` or `kappa`
/// # Limits
/// q -> 0: 1 - m2 q^2/6; uniform 3 (sin q - q cos q)/q^3
pub fn kernel_transfer(kernel: Kernel, q: f64) -> Result<Value> {
    kernel.check()?;
    within("q", q, 0.0, 1e4, "0 to 1e4")?;
    if kernel == Kernel::Gaussian {
        return Ok(Value::rounded(exp(-0.5 * q * q), 4.0 + 0.5 * q * q, METHOD));
    }
    // Panels of at most four radians; the marginals are smooth for z > 0.
    let panels = libm::ceil(0.25 * q).max(1.0);
    let (fine, coarse) = (&GAUSS_24, &GAUSS_16);
    let f = |z: f64| 2.0 * kernel.plane_density(z) * cos(q * z);
    let (mut value, mut difference, mut i) = (0.0, 0.0, 0.0);
    while i < panels {
        let (a, b) = (i / panels, (i + 1.0) / panels);
        let best = fine.integrate(a, b, f);
        difference += (best - coarse.integrate(a, b, f)).abs();
        value += best;
        i += 1.0;
    }
    // The phase q z carries a rounding of q.
    let error = difference + (32.0 + q) * f64::EPSILON;
    Ok(Value::new(value, error, "cosine transform of the marginal, two Gauss rules"))
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

        /// Shells: int K sin(qu)/(qu) dV, and the closed forms.
        #[test]
        fn transfers_of_kernels_are_mixtures_of_shells(q in 0.5..60.0_f64) {
            let (s, c) = (sin(q), cos(q));
            let (q2, q4) = (q * q, q * q * q * q);
            let closed = [
                (Kernel::Uniform, 3.0 * (s - q * c) / (q * q2), 3.0),
                (Kernel::Epanechnikov, 15.0 * ((3.0 - q2) * s - 3.0 * q * c) / (q * q4), 45.0),
                (Kernel::Biweight, 105.0 * ((15.0 - 6.0 * q2) * s - q * (15.0 - q2) * c) / (q * q2 * q4), 1575.0),
                (Kernel::Cone { kappa: 1.0 }, 12.0 * (2.0 - 2.0 * c - q * s) / q4, 24.0),
            ];
            for (kernel, want, size) in closed {
                let got = kernel_transfer(kernel, q).unwrap();
                // The closed forms cancel: their terms over the power of q.
                let rounding = 8.0 * f64::EPSILON * size * (1.0 + q2) * (1.0 + 1.0 / (q2 * q4 * q));
                prop_assert!((got.value - want).abs() <= got.error + rounding, "{kernel:?} {q} {got:?} {want}");
            }
            let rule = GaussLegendre::rule(90);
            let shells = rule.integrate(0.0, 1.0, |u| {
                4.0 * PI * u * Kernel::TruncatedGaussian.density(Dimension::Three, u) * sin(q * u) / q
            });
            let got = kernel_transfer(Kernel::TruncatedGaussian, q).unwrap();
            prop_assert!((got.value - shells).abs() <= got.error + 1e-14, "{q} {got:?} {shells}");
        }
    }

    #[test]
    fn slow_sinusoids_lose_by_the_second_moment() {
        for kernel in
            [Kernel::Uniform, Kernel::Cone { kappa: 1.0 }, Kernel::TruncatedGaussian, Kernel::Gaussian]
        {
            let q = 0.01;
            let got = kernel_transfer(kernel, q).unwrap();
            let second = kernel.bias_coefficient(Dimension::Three).unwrap().value * q * q;
            let fourth = kernel.second_bias_coefficient(Dimension::Three).unwrap().value * q * q * q * q;
            // The next term is below q^6/48.
            assert!(
                (got.value - 1.0 + second - fourth).abs() <= got.error + 1e-12 / 48.0,
                "{kernel:?} {got:?}"
            );
        }
        assert!(kernel_transfer(Kernel::Uniform, -1.0).is_err());
    }
}
