//! Estimates from the k nearest of independent points: mean and variance in any field.
//!
//! The rule: r_k is the distance of the k-th nearest point; the kernel of radius r_k is summed over the k - 1 nearer
//! ones, and nothing else. With fewer than k points within the cap, the estimate has the cap's radius and all points.
//!
//! Points are a Poisson process with lambda(r) points expected within r. Given r_k, the nearer points are independent
//! with the field's density in the ball, so that each adds kernel_mean(r)/lambda(r) on average. With s = lambda(r),
//! which at r_k is gamma distributed, and p_n(s) = e^(-s) s^n/n!,
//!
//! E = int_0^Lambda p_(k-2)(s) kernel_mean(r(s)) ds + kernel_mean(cap) P(n <= k-2 | Lambda),   Lambda = lambda(cap),
//!
//! and the second moment has kernel_square in place of kernel_mean plus the same with k - 3 and kernel_mean^2.
//! Source: Loftsgaarden and Quesenberry 1965; Mack and Rosenblatt 1979.

mod curved;
mod uniform;

use crate::ball_mean::exponential_mean;
use crate::error::{Error, Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::poisson::{at_most, probability};
use crate::quadrature::Adaptive;
use crate::value::Value;
pub use curved::{NearestCurved, nearest_curved, optimum_neighbors};
use libm::cbrt;
pub(crate) use uniform::gamma_ratio;
pub use uniform::{biased_factor, nearest_square_distance, nearest_variance_uniform};

const METHOD: &str = "gamma mixture over the k-th distance, two Gauss rules";

/// Mean and variance of one estimate over independent maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gather {
    /// Expectation, in the unit of the field.
    pub mean: Value,
    /// Variance, in its square.
    pub variance: Value,
    /// Probability of fewer than k points within the cap.
    pub underfull: Value,
}

/// Expectation of the k-nearest estimate (k - 1 points over the ball of the k-th).
///
/// # Arguments
/// `k` 2 to 1e6; `cap` largest radius; `lambda(r)` expected number of points within r, rising from 0, cut
/// by the medium; `kernel_mean(r)` expectation of the fixed-radius estimate at r, cut alike
/// # Returns
/// \[unit of `kernel_mean`\]; the bound covers the integration, not errors of the two functions
/// # Errors
/// `Error::OutOfRange` naming `k` or `cap`; `Error::NotFinite` naming the function
/// # Limits
/// a uniform field without faces gives itself, for every k and cap
pub fn nearest_expectation(
    k: u32,
    cap: f64,
    lambda: impl Fn(f64) -> f64,
    kernel_mean: impl Fn(f64) -> f64,
) -> Result<Value> {
    let whole = check(k, cap, &lambda)?;
    expectation(k, cap, whole, &lambda, &kernel_mean)
}

/// Expectation of the negative control that counts k points, not k - 1, over the ball of the k-th (uniform kernel).
///
/// Gathers with fewer than k points within the cap are right in it, as they are in the rule.
/// # Arguments
/// as [`nearest_expectation`]
/// # Errors
/// as [`nearest_expectation`]
/// # Limits
/// a uniform field and a large cap: k/(k-1) of it
pub fn nearest_expectation_biased(
    k: u32,
    cap: f64,
    lambda: impl Fn(f64) -> f64,
    kernel_mean: impl Fn(f64) -> f64,
) -> Result<Value> {
    let whole = check(k, cap, &lambda)?;
    let right = expectation(k, cap, whole, &lambda, &kernel_mean)?;
    let at_cap = finite("kernel_mean", kernel_mean(cap), cap)? * at_most(k - 2, whole);
    let gathers = Value::new(right.value - at_cap, right.error, METHOD).scaled(biased_factor(k)?.value);
    Ok(Value::new(gathers.value + at_cap, gathers.error, METHOD))
}

/// Mean, variance and underfull probability of the k-nearest estimate.
///
/// # Arguments
/// as [`nearest_expectation`], and `kernel_square(r)`, the variance of the fixed-radius estimate at r for
/// Poisson points: the sum over points of weight^2 K_r^2, expected
/// # Returns
/// the variance needs k >= 3
/// # Errors
/// as [`nearest_expectation`]; `Error::Infinite` for k = 2
/// # Limits
/// uniform kernel and field f, large cap: f^2/(k-2)
pub fn nearest_moments(
    k: u32,
    cap: f64,
    lambda: impl Fn(f64) -> f64,
    kernel_mean: impl Fn(f64) -> f64,
    kernel_square: impl Fn(f64) -> f64,
) -> Result<Gather> {
    let whole = check(k, cap, &lambda)?;
    if k < 3 {
        return Err(Error::Infinite(
            "the variance of the 2-nearest estimate is infinite; allowed: k of 3 or more",
        ));
    }
    let mean = expectation(k, cap, whole, &lambda, &kernel_mean)?;
    let squares = mixture(k - 2, cap, whole, &lambda, "kernel_square", &kernel_square)?;
    let pairs = |r: f64| {
        let m = kernel_mean(r);
        m * m
    };
    let products = mixture(k - 3, cap, whole, &lambda, "kernel_mean", &pairs)?;
    let value = squares.value + products.value - mean.value * mean.value;
    let error = squares.error
        + products.error
        + 2.0 * mean.value.abs() * mean.error
        + 4.0 * f64::EPSILON * products.value.abs();
    let underfull = at_most(k - 1, whole);
    Ok(Gather {
        mean,
        variance: Value::new(value, error, METHOD),
        underfull: Value::new(underfull, 1e-13 * underfull + 1e-17, "Poisson sum"),
    })
}

/// Variance of the fixed-radius estimate of independent points.
///
/// # Arguments
/// `kernel_mean`, `kernel_square` at the radius; `points` their fixed number, `None` for a Poisson number
/// # Returns
/// kernel_square, less kernel_mean^2/points for a fixed number
/// # Errors
/// `Error::OutOfRange` naming the argument
pub fn fixed_radius_variance(kernel_mean: f64, kernel_square: f64, points: Option<u64>) -> Result<Value> {
    within("kernel_mean", kernel_mean, 0.0, 1e150, "0 to 1e150")?;
    within("kernel_square", kernel_square, 0.0, 1e300, "0 to 1e300")?;
    let less = match points {
        Some(n) => {
            within("points", n as f64, 1.0, 1e18, "1 to 1e18")?;
            kernel_mean * kernel_mean / n as f64
        }
        None => 0.0,
    };
    Ok(Value::new(kernel_square - less, 4.0 * f64::EPSILON * (kernel_square + less), "closed form"))
}

/// Expectation of the k-nearest estimate in the unbounded field e^(b.x), over the field at the probe.
///
/// # Arguments
/// `density` expected points per unit volume at the probe; `gradient` |b| \[1/length\]; `cap` \[length\],
/// with |gradient| times cap up to 500 (Gaussian: 35)
/// # Returns
/// \[1\]
/// # Errors
/// `Error::OutOfRange` naming the parameter
/// # Limits
/// gradient -> 0: 1; small: 1 + m2 b^2 E\[r^2\]/(2d), r^2 over gamma-distributed k - 1
pub fn nearest_expectation_exponential(
    kernel: Kernel,
    d: Dimension,
    k: u32,
    density: f64,
    gradient: f64,
    cap: f64,
) -> Result<Value> {
    within("density", density, 1e-100, 1e100, "1e-100 to 1e100")?;
    check_cap(cap)?;
    // The largest argument is asked once, so that afterwards the means exist.
    exponential_mean(kernel, d, gradient * cap)?;
    exponential_mean(Kernel::Uniform, d, gradient * cap)?;
    let mean = |kernel, r: f64| exponential_mean(kernel, d, gradient * r).map_or(f64::NAN, |v| v.value);
    let lambda = |r: f64| density * d.ball_volume() * d.power(r) * mean(Kernel::Uniform, r);
    nearest_expectation(k, cap, lambda, |r| mean(kernel, r))
}

fn check_cap(cap: f64) -> Result<f64> {
    within("cap", cap, 1e-100, 1e100, "1e-100 to 1e100")
}

/// Checks and returns Lambda = lambda(cap).
fn check(k: u32, cap: f64, lambda: &impl Fn(f64) -> f64) -> Result<f64> {
    within("k", f64::from(k), 2.0, 1e6, "2 to 1e6")?;
    check_cap(cap)?;
    finite("lambda", lambda(cap), cap)
}

fn finite(name: &'static str, value: f64, at: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::NotFinite { name, value, at }) }
}

fn expectation(
    k: u32,
    cap: f64,
    whole: f64,
    lambda: &impl Fn(f64) -> f64,
    kernel_mean: &impl Fn(f64) -> f64,
) -> Result<Value> {
    mixture(k - 2, cap, whole, lambda, "kernel_mean", kernel_mean)
}

/// int_0^Lambda p_n(s) f(r(s)) ds + f(cap) P(at most n | Lambda).
fn mixture(
    n: u32,
    cap: f64,
    whole: f64,
    lambda: &impl Fn(f64) -> f64,
    name: &'static str,
    f: &impl Fn(f64) -> f64,
) -> Result<Value> {
    let mean = f64::from(n) + 1.0;
    let width = mean.sqrt();
    // Ten deviations below the gamma's mean and ten plus 50 above it leave e^(-45).
    let (low, high) = ((mean - 10.0 * width).max(0.0), (mean + 10.0 * width + 50.0).min(whole));
    // s = v^3: r is smooth in v where lambda grows like r^3.
    let mut breaks: Vec<f64> = [-1e9, -3.0, 0.0, 3.0, 8.0, 1e9]
        .iter()
        .map(|w| cbrt((mean + w * width).clamp(low.min(high), high.max(0.0))))
        .collect();
    breaks.dedup();
    let inside = Adaptive::new(1e-13).integrate(&breaks, name, METHOD, |v| {
        let s = v * v * v;
        let r = radius_of(s, cap, whole, lambda)?;
        Ok(3.0 * v * v * probability(n, s) * finite(name, f(r), r)?)
    })?;
    let at_cap = finite(name, f(cap), cap)? * at_most(n, whole);
    let value = inside.value + at_cap;
    // Radii and probabilities are good to some ten roundings of the exponents.
    let error = inside.error + 1e-13 * (inside.value.abs() + at_cap.abs()) + f64::MIN_POSITIVE;
    Ok(Value::new(value, error, METHOD))
}

/// The radius that holds s points: false position on lambda^(1/3), which is nearly straight.
fn radius_of(s: f64, cap: f64, whole: f64, lambda: &impl Fn(f64) -> f64) -> Result<f64> {
    let target = cbrt(s);
    let (mut low, mut high) = (0.0, cap);
    let (mut below, mut above) = (-target, cbrt(whole) - target);
    if above <= 0.0 {
        return Ok(cap);
    }
    let mut last = 0;
    for step in 0..200 {
        if high - low <= 4.0 * f64::EPSILON * high {
            break;
        }
        let mut r = low + (high - low) * (below / (below - above));
        if step % 8 == 7 || !(r > low && r < high) {
            r = 0.5 * (low + high);
        }
        let value = cbrt(finite("lambda", lambda(r), r)?) - target;
        if value.abs() <= 2.0 * f64::EPSILON * target {
            return Ok(r);
        }
        // The Illinois rule: an end that stays counts half the next time.
        if value < 0.0 {
            (low, below) = (r, value);
            if last == -1 {
                above *= 0.5;
            }
            last = -1;
        } else {
            (high, above) = (r, value);
            if last == 1 {
                below *= 0.5;
            }
            last = 1;
        }
    }
    Ok(0.5 * (low + high))
}

#[cfg(test)]
mod tests;
