//! What a kernel makes of an exponential field, exactly: the closed blur of every diffusion mode.
//!
//! M(x) = int K_r(y) e^(b.y) dy with x = |b| r, the factor by which an estimate with the kernel K_r is too high in the
//! field e^(b.y) wherever no face cuts the kernel. It is radial: int K(u) S_d(x u) dV, S_d the mean of e^(v n.e) over
//! all directions.
//!
//! Limits: x -> 0, 1 + m2 x^2/(2d), the curvature's bias; large x, e^x over a power of x, for the Gaussian e^(x^2/2).
//!
//! Source: Silverman 1986, chapter 4, for the bias; the closed forms are the Bessel functions of Watson 1944.

use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{cosh, exp, expm1, sinh};
use std::sync::LazyLock;

/// Mean of e^(b.x) over the kernel K_r about the origin, over the value at the centre, as a function of x = |b| r.
///
/// Uniform kernel: sinh x/x (d = 1), 2 I_1(x)/x (d = 2), 3 (x cosh x - sinh x)/x^3 (d = 3); Gaussian e^(x^2/2); the
/// others by the radial integral int K(u) S_d(x u) dV with S_d = cosh, I_0, sinh(v)/v.
/// # Arguments
/// `x` gradient times radius \[1\], |x| up to 500 (Gaussian: 35)
/// # Returns
/// \[1\], at least 1
/// # Errors
/// `Error::OutOfRange` naming `x` or `kappa`
/// # Limits
/// x -> 0: 1 + m2 x^2/(2d)
pub fn exponential_mean(kernel: Kernel, d: Dimension, x: f64) -> Result<Value> {
    kernel.check()?;
    if kernel == Kernel::Gaussian {
        within("x", x, -35.0, 35.0, "-35 to 35")?;
        // The exponent is rounded: relative error exponent times epsilon.
        return Ok(Value::rounded(exp(0.5 * x * x), 4.0 + 0.5 * x * x, "closed form"));
    }
    within("x", x, -500.0, 500.0, "-500 to 500")?;
    Ok(radial_mean(kernel, d, x.abs()))
}

/// A rule, and a coarser one whose difference from it bounds its error.
static RULES: LazyLock<[GaussLegendre; 2]> = LazyLock::new(|| [32, 24].map(GaussLegendre::rule));

/// The radial integral by two Gauss rules on panels over which the shell's mean grows by at most e^4.
fn radial_mean(kernel: Kernel, d: Dimension, x: f64) -> Value {
    let panels = (x / 4.0).ceil().max(1.0);
    let step = 1.0 / panels;
    let integrand = |u: f64| {
        kernel.density(d, u) * d.sphere_area() * d.power(u) / u.max(f64::MIN_POSITIVE) * shell_mean(d, x * u)
    };
    let [fine, coarse] = &*RULES;
    let (mut value, mut difference, mut i) = (0.0, 0.0, 0.0);
    while i < panels {
        let best = fine.integrate(i * step, (i + 1.0) * step, integrand);
        difference += (best - coarse.integrate(i * step, (i + 1.0) * step, integrand)).abs();
        value += best;
        i += 1.0;
    }
    // A shell's mean has the rounding of its argument in an exponent, and a series of positive terms.
    let error = difference + (64.0 + 2.0 * x) * f64::EPSILON * value;
    Value::new(value, error, "radial integral, two Gauss rules")
}

/// Mean of e^(v n.e) over directions n: cosh v, I_0(v), sinh(v)/v.
fn shell_mean(d: Dimension, v: f64) -> f64 {
    match d {
        Dimension::One => cosh(v),
        Dimension::Two => bessel_i0(v),
        Dimension::Three => {
            if v == 0.0 {
                1.0
            } else if v < 1.0 {
                // sinh v = (e^v - 1)(1 + e^(-v))/2, without cancellation.
                0.5 * expm1(v) * (1.0 + exp(-v)) / v
            } else {
                sinh(v) / v
            }
        }
    }
}

/// I_0(v) = sum (v/2)^(2k)/(k!)^2: positive terms.
fn bessel_i0(v: f64) -> f64 {
    let q = 0.25 * v * v;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > 1e-18 * sum {
        k += 1.0;
        term *= q / (k * k);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Closed forms for the uniform kernel, with the size of their roundings.
    fn uniform(d: Dimension, x: f64) -> (f64, f64) {
        match d {
            Dimension::One => (sinh(x) / x, 1.0),
            Dimension::Two => {
                // 2 I_1(x)/x = sum (x/2)^(2k)/(k! (k+1)!).
                let q = 0.25 * x * x;
                let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
                while term > 1e-18 * sum {
                    k += 1.0;
                    term *= q / (k * (k + 1.0));
                    sum += term;
                }
                (sum, 4.0)
            }
            Dimension::Three => {
                let cubed = x * x * x;
                (3.0 * (x * cosh(x) - sinh(x)) / cubed, 8.0 * (1.0 + 3.0 / (x * x)))
            }
        }
    }

    proptest! {
        #![proptest_config(crate::fixed_cases(256))]

        #[test]
        fn uniform_kernel_has_its_closed_form(x in 0.01..300.0_f64, which in 0_usize..3) {
            let d = Dimension::ALL[which];
            let got = exponential_mean(Kernel::Uniform, d, x).unwrap();
            let (want, ulps) = uniform(d, x);
            let rounding = (ulps + x) * 4.0 * f64::EPSILON * want;
            prop_assert!((got.value - want).abs() <= got.error + rounding, "{got:?} {want}");
        }

        #[test]
        fn small_gradients_read_the_bias_coefficient(lx in -6.0..-2.0_f64, which in 0_usize..3) {
            let d = Dimension::ALL[which];
            let x = libm::pow(10.0, lx);
            for kernel in [Kernel::Epanechnikov, Kernel::Cone { kappa: 1.5 }, Kernel::TruncatedGaussian] {
                let got = exponential_mean(kernel, d, -x).unwrap();
                let second = kernel.bias_coefficient(d).unwrap().value * x * x;
                let fourth = kernel.second_bias_coefficient(d).unwrap().value * x * x * x * x;
                // The next term is below x^6/5000.
                let off = (got.value - 1.0 - second - fourth).abs();
                prop_assert!(off <= got.error + libm::pow(x, 6.0) / 5000.0, "{kernel:?} {d:?} {got:?}");
            }
        }
    }

    #[test]
    fn the_plane_marginal_gives_the_same_mean() {
        let rule = GaussLegendre::rule(40);
        for kernel in
            [Kernel::Uniform, Kernel::Biweight, Kernel::Cone { kappa: 1.0 }, Kernel::TruncatedGaussian]
        {
            let x = 3.0;
            let f = |z: f64| kernel.plane_density(z) * exp(x * z);
            let want = rule.integrate(-1.0, 0.0, f) + rule.integrate(0.0, 1.0, f);
            let got = exponential_mean(kernel, Dimension::Three, x).unwrap();
            assert!((got.value - want).abs() < got.error + 1e-13 * want, "{kernel:?} {got:?} {want}");
        }
        assert!(exponential_mean(Kernel::Uniform, Dimension::One, 501.0).is_err());
    }
}
