//! The k nearest points in a field that curves: mean and variance to second order in the radius, closed.
//!
//! With the Poisson points of density n f(x), f = 1 and lap f = L at the probe, the expected number of points s within r
//! is n V r^d (1 + c r^2), c = L/(2(d+2)), a gamma variable of shape k at r_k. To first order in L, with
//! a = m2 L/(2d), q = m2' L/(2d) (m2' the moment of the squared kernel), v = R V and r^2 -> (s/(n V))^(2/d),
//!
//! E = 1 + a E\[r_(k-1)^2\],   E\[r_(k-1)^2\] = rho Gamma(k-1+2/d)/Gamma(k-1),   rho = (n V)^(-2/d),
//!
//! Var = v/(k-2) + \[v (c + q) - 4a/d\] rho Gamma(k-2+2/d)/Gamma(k-1).
//!
//! It is r_(k-1), not r_k, that the bias of the uniform kernel contains: k + 2/d - 1 over k - 1 of it would be too much,
//! 17 per cent at k = 5 in three dimensions. For the uniform kernel v = 1, c = q = a: the variance is
//! 1/(k-2) + 2a(1 - 2/d) rho Gamma(k-2+2/d)/Gamma(k-1), in two dimensions without any correction.
//!
//! Source: Loftsgaarden and Quesenberry 1965; Mack and Rosenblatt 1979 for the leading orders.

use super::uniform::gamma_ratio;
use crate::error::{Error, Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::value::Value;
use libm::pow;

const METHOD: &str = "second order in the radius, closed form";

/// Mean and variance of an estimate in units of the field and of its square, to second order in the radius.
///
/// The bounds are those of the closed forms; what they leave out is of fourth order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestCurved {
    /// Mean less one: the bias over the field.
    pub bias: Value,
    /// Variance over the square of the field.
    pub variance: Value,
    /// (bias)^2 + variance.
    pub mean_squared_error: Value,
}

/// Bias and variance of the k-nearest estimate in a field with curvature, without a cap.
///
/// # Arguments
/// `k` 3 to 1e6; `density` of points at the probe \[1/length^d\], 1e-60 to 1e60; `curvature` Laplacian of the field over
/// the field \[1/length^2\], -1e60 to 1e60, of which r_k^2 times should be small
/// # Returns
/// see the page of the module: bias, variance and mean squared error, relative
/// # Errors
/// `Error::OutOfRange` naming the parameter; `Error::Infinite` for k = 2, and where the numbers leave f64
/// # Limits
/// curvature 0: 0 and R V/(k-2)
pub fn nearest_curved(
    kernel: Kernel,
    d: Dimension,
    k: u32,
    density: f64,
    curvature: f64,
) -> Result<NearestCurved> {
    kernel.check()?;
    let kf = within("k", f64::from(k), 2.0, 1e6, "3 to 1e6")?;
    if k < 3 {
        return Err(Error::Infinite(
            "the variance of the 2-nearest estimate is infinite; allowed: k of 3 or more",
        ));
    }
    within("density", density, 1e-60, 1e60, "1e-60 to 1e60")?;
    within("curvature", curvature, -1e60, 1e60, "-1e60 to 1e60")?;
    let n = f64::from(d.number());
    let power = 2.0 / n;
    let rho = pow(density * d.ball_volume(), -power);
    // Gamma(k-2+2/d)/Gamma(k-1), by Gamma(k-1) = (k-2) Gamma(k-2).
    let spread = rho * gamma_ratio(kf - 2.0, power) / (kf - 2.0);
    let square = rho * gamma_ratio(kf - 1.0, power);
    let a = kernel.bias_coefficient(d)?.value * curvature;
    let q = kernel.square_moment(d)?.value * curvature / (2.0 * n);
    let c = curvature / (2.0 * (n + 2.0));
    let v = kernel.variance_coefficient(d)?.value;
    let (bias, flat) = (a * square, v / (kf - 2.0));
    let variance = flat + (v * (c + q) - 4.0 * a / n) * spread;
    let size = flat + (v * (c.abs() + q.abs()) + 4.0 * a.abs() / n) * spread;
    let error = bias * bias + variance;
    if !(error.is_finite() && size.is_finite()) {
        return Err(Error::Infinite(
            "the second order of so large a radius leaves f64; allowed: smaller curvature",
        ));
    }
    // Kernel moments are good to some thousand roundings at worst, gamma ratios to 256.
    let ulps = 2048.0 * f64::EPSILON;
    Ok(NearestCurved {
        bias: Value::new(bias, ulps * bias.abs() + f64::MIN_POSITIVE, METHOD),
        variance: Value::new(variance, ulps * size + f64::MIN_POSITIVE, METHOD),
        mean_squared_error: Value::new(error, ulps * (2.0 * bias * bias + size) + f64::MIN_POSITIVE, METHOD),
    })
}

/// The k of least mean squared error, to leading order, and that error.
///
/// Bias a rho Gamma(k-1+2/d)/Gamma(k-1) and variance R V/(k-2): k ~ N^(4/(d+4)), error ~ N^(-4/(d+4)).
/// # Arguments
/// `density` and `curvature` as in [`nearest_curved`], the curvature not 0
/// # Returns
/// k, 3 to 1e6, and the relative mean squared error there; the least over all integers
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn optimum_neighbors(kernel: Kernel, d: Dimension, density: f64, curvature: f64) -> Result<(u32, Value)> {
    within("density", density, 1e-60, 1e60, "1e-60 to 1e60")?;
    let size = within("curvature", curvature.abs(), 1e-60, 1e60, "1e-60 to 1e60, or negative")?;
    let power = 2.0 / f64::from(d.number());
    let a = kernel.bias_coefficient(d)?.value * size * pow(density * d.ball_volume(), -power);
    let v = kernel.variance_coefficient(d)?.value;
    let at = |k: u32| {
        let bias = a * gamma_ratio(f64::from(k) - 1.0, power);
        bias * bias + v / (f64::from(k) - 2.0)
    };
    // A rising and a falling function of k, both convex: their sum has one least value.
    let (mut low, mut high) = (3, 1_000_000);
    while low < high {
        let middle = low + (high - low) / 2;
        if at(middle + 1) < at(middle) { low = middle + 1 } else { high = middle }
    }
    let least = at(low);
    if !least.is_finite() {
        return Err(Error::Infinite(
            "the bias leaves f64 at every k; allowed: smaller curvature, larger density",
        ));
    }
    Ok((low, Value::rounded(least, 4096.0, METHOD)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ball_mean::exponential_mean;
    use crate::nearest::{nearest_moments, nearest_square_distance};

    /// The exact integrals in the field e^(b.x), whose Laplacian is b^2 of it.
    fn exact(kernel: Kernel, d: Dimension, k: u32, density: f64, b: f64, cap: f64) -> (f64, f64) {
        let mean = |kernel, r: f64| exponential_mean(kernel, d, b * r).unwrap().value;
        let roughness = kernel.roughness(d).unwrap().value;
        // int K^2 e^(b.x), to second order of the field: what is tested is of first order in b^2.
        let q = kernel.square_moment(d).unwrap().value / (2.0 * f64::from(d.number()));
        let square = |r: f64| {
            let whole = if kernel == Kernel::Uniform { mean(kernel, r) } else { 1.0 + q * b * b * r * r };
            roughness / (density * d.power(r)) * whole
        };
        let lambda = |r: f64| density * d.ball_volume() * d.power(r) * mean(Kernel::Uniform, r);
        let got = nearest_moments(k, cap, lambda, |r| mean(kernel, r), square).unwrap();
        (got.mean.value - 1.0, got.variance.value)
    }

    #[test]
    fn the_exact_integrals_tend_to_it() {
        for d in Dimension::ALL {
            for (kernel, orders) in [(Kernel::Uniform, [3, 20]), (Kernel::Epanechnikov, [5, 5])] {
                // One case is enough for another kernel.
                let all = orders.len() - usize::from(orders[0] == orders[1]);
                for k in orders.into_iter().take(all) {
                    let density = 10.0;
                    // k points within about (k/(n V))^(1/d); twenty times that many within the cap.
                    let reach = d.root(f64::from(k) / (density * d.ball_volume()));
                    let cap = reach * d.root(30.0);
                    // The fourth order is (b r)^2 = 4e-4 of the second, times a few.
                    let b = 0.02 / reach;
                    let (bias, variance) = exact(kernel, d, k, density, b, cap);
                    let flat = exact(kernel, d, k, density, 0.0, cap).1;
                    let got = nearest_curved(kernel, d, k, density, b * b).unwrap();
                    assert!(
                        (bias / got.bias.value - 1.0).abs() < 2e-3,
                        "{d:?} {kernel:?} {k} {bias:e} {got:?}"
                    );
                    let straight = nearest_curved(kernel, d, k, density, 0.0).unwrap().variance.value;
                    assert!((flat / straight - 1.0).abs() < 1e-9, "{d:?} {kernel:?} {k} {flat} {straight}");
                    let (change, want) = (variance - flat, got.variance.value - straight);
                    let scale = b * b * reach * reach / f64::from(k);
                    assert!((change - want).abs() < 4e-3 * scale, "{d:?} {kernel:?} {k} {change:e} {want:e}");
                }
            }
            let got = nearest_curved(Kernel::Uniform, d, 5, 2.0, 1.0).unwrap().bias;
            let square = nearest_square_distance(d, 4, 2.0, None).unwrap().value;
            let n = f64::from(d.number());
            assert!((got.value / (square / (2.0 * (n + 2.0))) - 1.0).abs() < 1e-12);
        }
        assert!(nearest_curved(Kernel::Uniform, Dimension::One, 2, 1.0, 1.0).is_err());
        assert!(nearest_curved(Kernel::Uniform, Dimension::One, 1_000_000, 1e-60, 1e60).is_err());
    }

    #[test]
    fn the_best_k_beats_its_neighbours_and_grows_like_the_rate() {
        for d in Dimension::ALL {
            let rate = 4.0 / f64::from(d.number() + 4);
            let best = |density| optimum_neighbors(Kernel::Uniform, d, density, 0.5).unwrap();
            let (k, error) = best(1e4);
            let at = |k: u32| {
                let bias = nearest_curved(Kernel::Uniform, d, k, 1e4, 0.5).unwrap().bias.value;
                bias * bias + 1.0 / (f64::from(k) - 2.0)
            };
            assert!((at(k) / error.value - 1.0).abs() < 1e-12 && at(k - 1) >= at(k) && at(k + 1) >= at(k));
            let (more, less) = best(1e6);
            let slope = libm::log(f64::from(more) / f64::from(k)) / libm::log(100.0);
            // (k - 2) and the gamma ratio tend to k and its power like 1/k.
            assert!((slope - rate).abs() < 2.0 / f64::from(k), "{d:?} {slope} {rate} {k}");
            let fall = libm::log(error.value / less.value) / libm::log(100.0);
            assert!((fall - rate).abs() < 2.0 / f64::from(k), "{d:?} {fall}");
        }
    }
}
