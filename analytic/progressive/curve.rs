//! The same schedule in closed form: Gamma functions, exponents, the best alpha, and the error of n passes.

use super::progressive;
use crate::error::{Error, Result, within};
use crate::kernel::Dimension;
use crate::nearest::gamma_ratio;
use crate::value::Value;
use libm::{pow, tgamma};

const METHOD: &str = "Gamma functions";

fn check_alpha(alpha: f64) -> Result<f64> {
    if alpha > 0.0 && alpha <= 1.0 {
        Ok(alpha)
    } else {
        Err(Error::OutOfRange { name: "alpha", value: alpha, allowed: "above 0, up to 1" })
    }
}

/// r_n/r_1 of the schedule: (Gamma(n+alpha)/(Gamma(1+alpha) Gamma(n+1)))^(1/d).
///
/// # Arguments
/// `alpha` above 0, up to 1; `n` pass, 1 to 1e15
/// # Errors
/// `Error::OutOfRange` naming `alpha` or `n`
/// # Limits
/// n -> infinity: (n^(alpha-1)/Gamma(1+alpha))^(1/d)
/// # Source
/// Hachisuka, Ogaki and Jensen 2008; Knaus and Zwicker 2011
pub fn progressive_radius(d: Dimension, alpha: f64, n: f64) -> Result<Value> {
    check_alpha(alpha)?;
    within("n", n, 1.0, 1e15, "1 to 1e15")?;
    // Gamma(n+1)/Gamma(n+alpha).
    let shrink = gamma_ratio(n + alpha, 1.0 - alpha) * tgamma(1.0 + alpha);
    Ok(Value::rounded(d.root(1.0 / shrink), 256.0, METHOD))
}

/// Variance of the mean of n passes over that of the first:
/// Gamma(1+alpha) n^-2 \[Gamma(n+2)/Gamma(n+alpha) - 1/Gamma(alpha)\]/(2-alpha).
///
/// # Arguments
/// `alpha` above 0, up to 1; `n` passes, 1 to 1e15 (a whole number)
/// # Errors
/// `Error::OutOfRange` naming `alpha` or `n`
/// # Limits
/// n -> infinity: Gamma(1+alpha)/(2-alpha) n^(-alpha)
pub fn progressive_variance(alpha: f64, n: f64) -> Result<Value> {
    check_alpha(alpha)?;
    within("n", n, 1.0, 1e15, "1 to 1e15")?;
    // Gamma(1+alpha)/Gamma(alpha) = alpha; at n = 1 the two terms are 2 and alpha over 2 - alpha.
    let first = tgamma(1.0 + alpha) * gamma_ratio(n + alpha, 2.0 - alpha) / n / n;
    let value = (first - alpha / n / n) / (2.0 - alpha);
    Ok(Value::rounded(value, 1024.0, METHOD))
}

/// How the mean of many passes behaves: variance ~ `variance` n^(-alpha), bias ~ `bias` n^(-beta), both over those of
/// the first pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asymptote {
    /// Gamma(1+alpha)/(2-alpha).
    pub variance: Value,
    /// alpha.
    pub variance_exponent: f64,
    /// Gamma(1+alpha)^(-2/d)/(1-beta), where beta < 1.
    pub bias: Value,
    /// beta = 2(1-alpha)/d.
    pub bias_exponent: f64,
}

/// Constants and exponents of the schedule after many passes.
///
/// # Arguments
/// `alpha` above 0, up to 1
/// # Errors
/// `Error::OutOfRange` naming `alpha`; `Error::Infinite` in one dimension for alpha of 1/2 or less, where the bias
/// falls like ln n/n or is a matter of the first passes
pub fn progressive_asymptote(d: Dimension, alpha: f64) -> Result<Asymptote> {
    check_alpha(alpha)?;
    let power = 2.0 / f64::from(d.number());
    let beta = power * (1.0 - alpha);
    if beta >= 1.0 {
        return Err(Error::Infinite(
            "the bias of this schedule is that of its first passes; allowed: 2(1-alpha)/d below 1",
        ));
    }
    let gamma = tgamma(1.0 + alpha);
    Ok(Asymptote {
        variance: Value::rounded(gamma / (2.0 - alpha), 16.0, METHOD),
        variance_exponent: alpha,
        // 1 - beta may cancel.
        bias: Value::rounded(pow(gamma, -power) / (1.0 - beta), 32.0 + 8.0 / (1.0 - beta), METHOD),
        bias_exponent: beta,
    })
}

/// The alpha whose mean squared error falls fastest: 4/(d+4), when it falls like n^(-4/(d+4)).
///
/// Variance n^(-alpha) and squared bias n^(-4(1-alpha)/d) then fall alike: 4/5, 2/3, 4/7 for d = 1, 2, 3.
/// # Source
/// Knaus and Zwicker 2011 for d = 2; Kaplanyan and Dachsbacher 2013
pub fn optimum_alpha(d: Dimension) -> Value {
    Value::rounded(4.0 / f64::from(d.number() + 4), 1.0, METHOD)
}

/// Mean squared error of the mean of n passes.
///
/// variance(n) V + (bias(n) B)^2, to leading order of the bias in the radius.
/// # Arguments
/// `bias`, `variance` B and V of the first pass, -1e100 to 1e100 and 0 to 1e200; `n` passes, 1 to 1e6
/// # Returns
/// in the unit of V
/// # Errors
/// `Error::OutOfRange` naming the parameter
/// # Limits
/// many passes: [`progressive_asymptote`]
pub fn progressive_error(d: Dimension, alpha: f64, bias: f64, variance: f64, n: u32) -> Result<Value> {
    within("bias", bias, -1e100, 1e100, "-1e100 to 1e100")?;
    within("variance", variance, 0.0, 1e200, "0 to 1e200")?;
    let after = progressive(d, alpha, n)?;
    let square = after.bias.value * bias * after.bias.value * bias;
    let spread = after.variance.scaled(variance);
    let relative = 2.0 * after.bias.error / after.bias.value + 4.0 * f64::EPSILON;
    Ok(Value::new(
        square + spread.value,
        square * relative + spread.error + f64::EPSILON * square,
        "product and sums",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_agree_with_the_sums() {
        for d in Dimension::ALL {
            for (alpha, n) in
                [(0.8, 1_u32), (0.8, 7), (2.0 / 3.0, 1000), (4.0 / 7.0, 200_000), (1.0, 50), (0.01, 300)]
            {
                let sums = progressive(d, alpha, n).unwrap();
                let radius = progressive_radius(d, alpha, f64::from(n)).unwrap();
                let variance = progressive_variance(alpha, f64::from(n)).unwrap();
                assert!(
                    (radius.value - sums.radius.value).abs() <= radius.error + sums.radius.error,
                    "{radius:?} {sums:?}"
                );
                let off = (variance.value - sums.variance.value).abs();
                assert!(
                    off <= variance.error + sums.variance.error,
                    "{d:?} {alpha} {n} {variance:?} {sums:?}"
                );
            }
        }
    }

    #[test]
    fn many_passes_follow_the_asymptote() {
        for d in Dimension::ALL {
            let alpha = optimum_alpha(d).value;
            let far = progressive_asymptote(d, alpha).unwrap();
            // 4(1-alpha)/d = alpha: both parts of the error fall alike.
            assert!((2.0 * far.bias_exponent - far.variance_exponent).abs() < 1e-15, "{d:?}");
            let n = 1e15;
            let variance = progressive_variance(alpha, n).unwrap().value * pow(n, alpha);
            assert!((variance / far.variance.value - 1.0).abs() < 1e-12, "{d:?} {variance} {far:?}");
            // The sum's next term is zeta(beta) n^(beta-1) of it, below 2 n^(beta-1) for these beta.
            let n = 1_000_000;
            let bias = progressive(d, alpha, n).unwrap().bias.value * pow(f64::from(n), far.bias_exponent);
            let rest = 2.0 * pow(f64::from(n), far.bias_exponent - 1.0);
            assert!((bias / far.bias.value - 1.0).abs() < rest, "{d:?} {bias} {far:?} {rest}");
            // Any other alpha is worse after many passes.
            let error = |alpha| progressive_error(d, alpha, 1.0, 1.0, n).unwrap().value;
            assert!(error(alpha) < error(alpha - 0.15) && error(alpha) < error(alpha + 0.15), "{d:?}");
            assert!(progressive_error(d, alpha, 2.0, 3.0, 1).unwrap().covers(7.0));
        }
        assert!(progressive_asymptote(Dimension::One, 0.5).is_err());
        assert!(
            progressive_radius(Dimension::One, 0.0, 5.0).is_err()
                && progressive_variance(0.5, f64::NAN).is_err()
        );
    }
}
