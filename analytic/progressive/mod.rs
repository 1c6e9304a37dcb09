//! Progressive photon maps with a shrinking radius (Hachisuka 2008; Knaus and Zwicker 2011), one map a pass.
//!
//! With r_(i+1)^d = r_i^d (i + alpha)/(i + 1) the variance of pass i grows like 1/r_i^d and its bias falls like r_i^2.
//! The mean of n passes has a variance ~ n^(-alpha) and a bias ~ n^(-2(1-alpha)/d) of the first pass's; the mean squared error
//! falls fastest, like n^(-4/(d+4)), at alpha = 4/(d+4), as fast as with the best radius for all photons at once.

mod curve;

use crate::error::{Error, Result, within};
use crate::kernel::Dimension;
use crate::value::Value;
pub use curve::{
    Asymptote, optimum_alpha, progressive_asymptote, progressive_error, progressive_radius,
    progressive_variance,
};

/// The schedule r_(i+1)^d = r_i^d (i + alpha)/(i + 1) after n passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progressive {
    /// r_n/r_1 \[1\].
    pub radius: Value,
    /// Variance of the mean of n passes over that of the first pass \[1\].
    pub variance: Value,
    /// Bias of the mean of n passes over that of the first, to leading order in r: the mean of r_i^2/r_1^2 \[1\].
    pub bias: Value,
}

/// Radius, variance and bias of the schedule after n passes.
///
/// # Arguments
/// `alpha` part of the new photons kept, 0 to 1; `n` passes, 1 to 1e6
/// # Errors
/// `Error::OutOfRange` naming `alpha` or `n`
/// # Limits
/// r_n ~ n^((alpha-1)/d)/Gamma(1+alpha)^(1/d); variance ~ n^(-alpha); bias ~ n^(-2(1-alpha)/d)
pub fn progressive(d: Dimension, alpha: f64, n: u32) -> Result<Progressive> {
    const METHOD: &str = "product and sums";
    if !(alpha > 0.0 && alpha <= 1.0) {
        return Err(Error::OutOfRange { name: "alpha", value: alpha, allowed: "above 0, up to 1" });
    }
    within("n", f64::from(n), 1.0, 1e6, "1 to 1e6")?;
    let (mut volume, mut variance, mut bias) = (1.0, 0.0, 0.0);
    let mut radius = 1.0;
    for i in 1..=n {
        radius = d.root(volume);
        variance += 1.0 / volume;
        bias += radius * radius;
        volume *= (f64::from(i) + alpha) / (f64::from(i) + 1.0);
    }
    let passes = f64::from(n);
    // Two roundings a factor, one a summand.
    let ulps = 4.0 + 3.0 * passes;
    Ok(Progressive {
        radius: Value::rounded(radius, ulps, METHOD),
        variance: Value::rounded(variance / passes / passes, ulps, METHOD),
        bias: Value::rounded(bias / passes, ulps, METHOD),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use libm::{exp, lgamma, pow};

    #[test]
    fn gamma_functions_give_the_same() {
        for d in Dimension::ALL {
            for (alpha, n) in [(0.8, 10_u32), (2.0 / 3.0, 1000), (4.0 / 7.0, 100_000)] {
                let got = progressive(d, alpha, n).unwrap();
                let m = f64::from(n);
                let log_volume = lgamma(m + alpha) - lgamma(1.0 + alpha) - lgamma(m + 1.0);
                let radius = exp(log_volume / f64::from(d.number()));
                // lgamma near m ln m carries that many roundings.
                let rounding = 1e-15 * m.max(10.0) * 12.0;
                assert!((got.radius.value / radius - 1.0).abs() < rounding, "{d:?} {alpha} {n}");
                let ratio = exp(lgamma(m + 2.0) - lgamma(m + alpha)) - 1.0 / exp(lgamma(alpha));
                let variance = exp(lgamma(1.0 + alpha)) / (m * m) * ratio / (2.0 - alpha);
                assert!((got.variance.value / variance - 1.0).abs() < rounding, "{d:?} {alpha} {n}");
            }
        }
        // Asymptotically the bias falls like n^(-2(1-alpha)/d).
        let bias = |n| progressive(Dimension::Three, 4.0 / 7.0, n).unwrap().bias.value;
        let slope = libm::log(bias(400_000) / bias(200_000)) / libm::log(2.0);
        assert!((slope + 2.0 / 7.0).abs() < 1e-3, "{slope}");
        assert!((pow(2.0, slope) - bias(400_000) / bias(200_000)).abs() < 1e-12);
        assert!(progressive(Dimension::One, 0.0, 3).is_err() && progressive(Dimension::One, 0.5, 0).is_err());
    }
}
