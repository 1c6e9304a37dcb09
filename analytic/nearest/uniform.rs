//! The k nearest points in a uniform field: closed forms, finite numbers of points included.

use crate::error::{Error, Result, within};
use crate::kernel::Dimension;
use crate::value::Value;
use libm::{exp, log, log1p, pow};

const METHOD: &str = "closed form";

fn check_k(k: u32) -> Result<f64> {
    within("k", f64::from(k), 2.0, 1e6, "2 to 1e6")
}

/// What counting k points over the ball of the k-th reads in a uniform field: k/(k-1).
///
/// # Errors
/// `Error::OutOfRange` naming `k` (2 to 1e6)
pub fn biased_factor(k: u32) -> Result<Value> {
    let k = check_k(k)?;
    Ok(Value::rounded(k / (k - 1.0), 2.0, METHOD))
}

/// Relative variance of (k-1)/(N V(r_k)) in a uniform field, uniform kernel: (N-1)(k-1)/(N(k-2)) - 1.
///
/// # Arguments
/// `k` 3 to 1e6; `points` their number N, at least k, or `None` for the limit 1/(k-2)
/// # Errors
/// `Error::OutOfRange` naming `k` or `points`; `Error::Infinite` for k = 2
pub fn nearest_variance_uniform(k: u32, points: Option<u64>) -> Result<Value> {
    let kf = check_k(k)?;
    if k < 3 {
        return Err(Error::Infinite(
            "the variance of the 2-nearest estimate is infinite; allowed: k of 3 or more",
        ));
    }
    let value = match points {
        None => 1.0 / (kf - 2.0),
        Some(n) => {
            let n = within("points", n as f64, kf, 1e18, "k to 1e18")?;
            // ((N-1)(k-1) - N(k-2))/(N(k-2)) = (N - k + 1)/(N(k-2)).
            (n - kf + 1.0) / (n * (kf - 2.0))
        }
    };
    Ok(Value::rounded(value, 4.0, METHOD))
}

/// Expected squared distance of the j-th nearest point in a uniform field.
///
/// (n V_d)^(-2/d) Gamma(j + 2/d)/Gamma(j), n points per volume; for a fixed number N of points also
/// N^(2/d) Gamma(N+1)/Gamma(N+1+2/d).
/// # Arguments
/// `j` 1 to 1e6; `density` n \[1/length^d\]; `points` N, at least j, or `None` for a Poisson number
/// # Returns
/// \[length^2\]
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn nearest_square_distance(d: Dimension, j: u32, density: f64, points: Option<u64>) -> Result<Value> {
    let jf = within("j", f64::from(j), 1.0, 1e6, "1 to 1e6")?;
    within("density", density, 1e-100, 1e100, "1e-100 to 1e100")?;
    let a = 2.0 / f64::from(d.number());
    let mut value = gamma_ratio(jf, a) / pow(density * d.ball_volume(), a);
    if let Some(n) = points {
        let n = within("points", n as f64, jf, 1e15, "j to 1e15")?;
        value *= pow(n, a) / gamma_ratio(n + 1.0, a);
    }
    Ok(Value::rounded(value, 256.0, "Stirling's series"))
}

/// Gamma(z + a)/Gamma(z) for z > 0, 0 <= a <= 2.
pub(crate) fn gamma_ratio(z: f64, a: f64) -> f64 {
    let (mut z, mut factor) = (z, 1.0);
    while z < 16.0 {
        factor *= z / (z + a);
        z += 1.0;
    }
    let tail = |z: f64| {
        let y = 1.0 / (z * z);
        (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)))) / z
    };
    // Stirling's series for both, the large logarithms taken out.
    factor * exp((z + a - 0.5) * log1p(a / z) - a + a * log(z) + tail(z + a) - tail(z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use libm::lgamma;

    #[test]
    fn gamma_ratios_agree_with_the_library_and_with_products() {
        for z in [1.0, 2.5, 15.0, 16.0, 80.0] {
            for a in [2.0 / 3.0, 1.0, 2.0] {
                let want = exp(lgamma(z + a) - lgamma(z));
                assert!((gamma_ratio(z, a) / want - 1.0).abs() < 1e-12, "{z} {a}");
            }
            assert!((gamma_ratio(z, 1.0) / z - 1.0).abs() < 1e-14);
            assert!((gamma_ratio(z, 2.0) / (z * (z + 1.0)) - 1.0).abs() < 2e-14);
        }
    }

    #[test]
    fn distances_and_variances() {
        // One dimension, N points on a segment of length N/n about the probe: r_j = (N/2n) Beta(j, N-j+1).
        let got = nearest_square_distance(Dimension::One, 3, 2.0, Some(10)).unwrap();
        let want = 2.5 * 2.5 * (3.0 * 4.0) / (11.0 * 12.0);
        assert!(got.covers(want), "{got:?} {want}");
        let many = nearest_square_distance(Dimension::Three, 20, 5.0, Some(1_000_000_000)).unwrap();
        let poisson = nearest_square_distance(Dimension::Three, 20, 5.0, None).unwrap();
        assert!((many.value / poisson.value - 1.0).abs() < 2e-9);
        assert!(nearest_variance_uniform(12, None).unwrap().covers(0.1));
        let finite = nearest_variance_uniform(12, Some(20)).unwrap().value;
        assert!((finite - (19.0 * 11.0 / (20.0 * 10.0) - 1.0)).abs() < 4.0 * f64::EPSILON);
        assert!(nearest_variance_uniform(2, None).is_err() && biased_factor(1).is_err());
        assert!(biased_factor(20).unwrap().covers(20.0 / 19.0));
    }
}
