//! The radius that balances bias against variance.

use super::Dimension;
use crate::error::{Result, within};
use crate::value::Value;
use libm::pow;

const METHOD: &str = "closed form";

/// Radius of least mean squared error of an estimate whose bias is `bias` r^2 and whose variance `variance`/r^d, and
/// that error.
///
/// r^(d+4) = d B/(4 A^2), A the bias and B the variance at r = 1; there the variance is 4/d of the squared bias. For N
/// samples of density f: A = m2 lap f/(2d), B = f R/N, so that r ~ N^(-1/(d+4)) and the error ~ N^(-4/(d+4)).
/// # Arguments
/// `bias` A, not 0; `variance` B, 1e-120 to 1e120 both in size
/// # Returns
/// radius and mean squared error, in the units of the arguments
/// # Errors
/// `Error::OutOfRange` naming `bias` or `variance`
/// # Source
/// Silverman 1986, section 4.3
pub fn optimum(d: Dimension, bias: f64, variance: f64) -> Result<(Value, Value)> {
    let a = within("bias", bias.abs(), 1e-120, 1e120, "1e-120 to 1e120, or negative")?;
    let b = within("variance", variance, 1e-120, 1e120, "1e-120 to 1e120")?;
    let n = f64::from(d.number());
    // A and B may be too far apart for their quotient: each is raised apart.
    let power = 1.0 / (n + 4.0);
    let radius = pow(0.25 * n * b, power) / pow(a, 2.0 * power);
    // A^2 r^4 (1 + 4/d), in powers of A and B.
    let square = pow(a, 2.0 * n * power) * pow(0.25 * n * b, 4.0 * power);
    // The powers carry the rounding of the exponent, times the logarithm of the base, up to 280.
    Ok((Value::rounded(radius, 1024.0, METHOD), Value::rounded(square * (1.0 + 4.0 / n), 4096.0, METHOD)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_the_optimum_are_worse() {
        for d in Dimension::ALL {
            for (a, b) in [(1.0, 1.0), (-3e5, 1e-7), (1e-100, 1e110), (1e100, 1e-110)] {
                let (radius, error) = optimum(d, a, b).unwrap();
                let r = radius.value;
                let mse = |r: f64| (a * r * r) * (a * r * r) + b / d.power(r);
                assert!((mse(r) / error.value - 1.0).abs() < 1e-11, "{d:?} {a} {b}");
                assert!(mse(r * 1.001) > mse(r) && mse(r * 0.999) > mse(r));
            }
            // Thirty-two times the samples: N^(-4/(d+4)).
            let gain = optimum(d, 1.0, 1.0).unwrap().1.value / optimum(d, 1.0, 1.0 / 32.0).unwrap().1.value;
            assert!((gain - pow(32.0, 4.0 / f64::from(d.number() + 4))).abs() < 1e-11);
        }
        assert!(
            optimum(Dimension::One, 0.0, 1.0).is_err() && optimum(Dimension::One, 1.0, f64::NAN).is_err()
        );
    }
}
