//! Smoothing kernels in one, two and three dimensions: profile, moments, roughness, marginal.
//!
//! A kernel K has unit integral over R^d at radius 1; at radius r it is K(u/r)/r^d. For N independent samples of
//! density f the estimate has bias (m2/2d) r^2 lap f + m4/(8d(d+2)) r^4 lap^2 f + ... and variance
//! (1/N)(f R/r^d - f^2 + ...), with m_j = int |u|^j K and R = int K^2 (Silverman 1986, chapter 4).

mod dimension;
mod optimum;

use crate::error::{Result, within};
use crate::value::Value;
pub use dimension::Dimension;
use libm::{erf, exp};
pub use optimum::optimum;
use std::f64::consts::{PI, SQRT_2};

const METHOD: &str = "closed form";

/// Roundings of the closed forms, all of few operations on positive terms.
const ULPS: f64 = 16.0;

/// Exponent of the truncated Gaussian exp(-u^2/(2 s^2)) with s = 1/3, at u = 1.
const CUT: f64 = 4.5;

/// A radial kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// Constant on the unit ball.
    Uniform,
    /// Proportional to 1 - u^2 on the unit ball.
    Epanechnikov,
    /// Proportional to (1 - u^2)^2 on the unit ball.
    Biweight,
    /// Proportional to 1 - u/kappa on the unit ball (Jensen 1996).
    Cone {
        /// Slope parameter \[1\], 1 to 1e6.
        kappa: f64,
    },
    /// Gaussian of standard deviation 1 along each axis, on all of space.
    Gaussian,
    /// Gaussian of standard deviation 1/3, cut at the unit ball and normalised over it.
    TruncatedGaussian,
}

impl Kernel {
    /// One of each kind, and a sharper cone.
    #[cfg(test)]
    pub(crate) const SAMPLES: [Kernel; 7] = [
        Kernel::Uniform,
        Kernel::Epanechnikov,
        Kernel::Biweight,
        Kernel::Cone { kappa: 1.0 },
        Kernel::Cone { kappa: 2.0 },
        Kernel::TruncatedGaussian,
        Kernel::Gaussian,
    ];

    pub(crate) fn check(self) -> Result<Self> {
        if let Kernel::Cone { kappa } = self {
            within("kappa", kappa, 1.0, 1e6, "1 to 1e6")?;
        }
        Ok(self)
    }

    /// Where the kernel ends: 1, or where a Gaussian has fallen by e^(-42).
    pub(crate) fn reach(self) -> f64 {
        if self == Kernel::Gaussian { 9.2 } else { 1.0 }
    }

    /// Profile without its normalisation, and zero beyond the ball.
    fn shape(self, u: f64) -> f64 {
        if u > 1.0 && self != Kernel::Gaussian {
            return 0.0;
        }
        let v = (1.0 - u) * (1.0 + u);
        match self {
            Kernel::Uniform => 1.0,
            Kernel::Epanechnikov => v,
            Kernel::Biweight => v * v,
            Kernel::Cone { kappa } => 1.0 - u / kappa,
            Kernel::Gaussian => exp(-0.5 * u * u),
            Kernel::TruncatedGaussian => exp(-CUT * u * u),
        }
    }

    /// Moment int_0^inf u^n shape(u)^power du for power 1 or 2.
    fn radial(self, n: u32, power: u32) -> f64 {
        let k = f64::from(n + 1);
        let p = f64::from(power);
        match self {
            Kernel::Uniform => 1.0 / k,
            // int u^n (1-u^2)^m = (1/2) B((n+1)/2, m+1) = prod_(i=1)^m (2i) / prod_(i=0)^m (n+1+2i).
            Kernel::Epanechnikov | Kernel::Biweight => {
                let m = power * if self == Kernel::Epanechnikov { 1 } else { 2 };
                (1..=m).map(f64::from).fold(1.0 / k, |product, i| product * 2.0 * i / (k + 2.0 * i))
            }
            Kernel::Cone { kappa } if power == 1 => 1.0 / k - 1.0 / ((k + 1.0) * kappa),
            Kernel::Cone { kappa } => 1.0 / k - 2.0 / ((k + 1.0) * kappa) + 1.0 / ((k + 2.0) * kappa * kappa),
            Kernel::Gaussian => gaussian_radial(n, 0.5 * p, None),
            Kernel::TruncatedGaussian => gaussian_radial(n, CUT * p, Some(1.0)),
        }
    }

    /// Factor that makes the integral of the shape 1.
    pub(crate) fn constant(self, d: Dimension) -> f64 {
        1.0 / (d.sphere_area() * self.radial(d.number() - 1, 1))
    }

    /// Profile K(u), u = |x|, of unit integral over R^d.
    pub(crate) fn density(self, d: Dimension, u: f64) -> f64 {
        self.constant(d) * self.shape(u)
    }

    /// Profile K(u) at radius 1, of unit integral over R^d.
    ///
    /// # Arguments
    /// `u` distance in radii \[1\], 0 or more
    /// # Errors
    /// `Error::OutOfRange` naming `u` or `kappa`
    pub fn profile(self, d: Dimension, u: f64) -> Result<Value> {
        self.check()?;
        within("u", u, 0.0, f64::MAX, "0 or more")?;
        // The Gaussian's exponent u^2/2 is rounded, and its square root of the largest, 745, is 38.
        let exponent = u.min(39.0);
        Ok(Value::rounded(self.density(d, u), ULPS + exponent * exponent, METHOD))
    }

    /// Factor in front of the shape: K(0).
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    pub fn normalization(self, d: Dimension) -> Result<Value> {
        self.check()?;
        Ok(Value::rounded(self.constant(d), ULPS, METHOD))
    }

    /// Moment m_j = int |u|^j K over R^d.
    ///
    /// # Arguments
    /// `j` 0 to 20
    /// # Errors
    /// `Error::OutOfRange` naming `j` or `kappa`
    /// # Limits
    /// uniform d/(d+j); (1-u^2)^n family, j = 2: d/(d+2+2n); Gaussian, j = 2: d
    pub fn moment(self, d: Dimension, j: u32) -> Result<Value> {
        self.check()?;
        within("j", f64::from(j), 0.0, 20.0, "0 to 20")?;
        let n = d.number() - 1;
        Ok(Value::rounded(self.radial(n + j, 1) / self.radial(n, 1), self.moment_ulps(n + j), METHOD))
    }

    /// Roundings of a moment: the upward recurrence of the truncated Gaussian cancels, up to (n+1)!!/9^(n/2).
    fn moment_ulps(self, n: u32) -> f64 {
        if self == Kernel::TruncatedGaussian { ULPS * (10.0 + f64::from(n * n * n)) } else { ULPS }
    }

    /// Roughness R = int K^2 over R^d, so that the variance of a density f is f R/(N r^d).
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    /// # Limits
    /// uniform 1/V_d; Gaussian (4 pi)^(-d/2)
    pub fn roughness(self, d: Dimension) -> Result<Value> {
        self.check()?;
        let c = self.constant(d);
        let value = c * c * d.sphere_area() * self.radial(d.number() - 1, 2);
        // At kappa = 1 the terms of the cone's square, up to four times their sum, cancel.
        Ok(Value::rounded(value, 8.0 * ULPS, METHOD))
    }

    /// Mean of |u|^2 over the square of the kernel: int |u|^2 K^2 / int K^2, so that the variance in a curved field has
    /// f + r^2 lap f/(2d) of this in place of f.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    /// # Limits
    /// uniform d/(d+2); Gaussian d/2
    pub fn square_moment(self, d: Dimension) -> Result<Value> {
        self.check()?;
        let n = d.number() - 1;
        let value = self.radial(n + 2, 2) / self.radial(n, 2);
        Ok(Value::rounded(value, 16.0 * self.moment_ulps(n + 2), METHOD))
    }

    /// Bias per r^2 and Laplacian: m2/(2d).
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    pub fn bias_coefficient(self, d: Dimension) -> Result<Value> {
        Ok(self.moment(d, 2)?.scaled(0.5 / f64::from(d.number())))
    }

    /// Bias per r^4 and squared Laplacian: m4/(8 d (d+2)).
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    pub fn second_bias_coefficient(self, d: Dimension) -> Result<Value> {
        let n = f64::from(d.number());
        Ok(self.moment(d, 4)?.scaled(0.125 / (n * (n + 2.0))))
    }

    /// Relative variance times the expected number of samples in the ball: R V_d, 1 for the uniform kernel.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `kappa`
    pub fn variance_coefficient(self, d: Dimension) -> Result<Value> {
        Ok(self.roughness(d)?.scaled(d.ball_volume()))
    }

    /// Marginal of the three-dimensional kernel along an axis: its integral over the plane at distance z.
    ///
    /// # Arguments
    /// `z` \[radii\], any finite number
    /// # Returns
    /// \[1/radius\], of unit integral
    /// # Errors
    /// `Error::OutOfRange` naming `z` or `kappa`
    pub fn marginal(self, z: f64) -> Result<Value> {
        self.check()?;
        within("z", z, f64::MIN, f64::MAX, "finite numbers")?;
        let exponent = z.abs().min(39.0);
        // The cone and the truncated Gaussian cancel near the rim: absolute roundings of the value at the centre.
        let value = self.plane_density(z);
        let error = f64::EPSILON * ULPS * (self.plane_density(0.0) + exponent * exponent * value);
        Ok(Value::new(value, error, METHOD))
    }

    /// Marginal for arguments known to be valid.
    pub(crate) fn plane_density(self, z: f64) -> f64 {
        let a = z.abs();
        if a >= 1.0 && self != Kernel::Gaussian {
            return 0.0;
        }
        let v = (1.0 - a) * (1.0 + a);
        match self {
            Kernel::Uniform => 0.75 * v,
            Kernel::Epanechnikov => 0.9375 * v * v,
            Kernel::Biweight => 1.093_75 * v * v * v,
            Kernel::Cone { kappa } => {
                let cubes = (1.0 - a) * (1.0 + a + a * a);
                2.0 * PI * self.constant(Dimension::Three) * (0.5 * v - cubes / (3.0 * kappa))
            }
            Kernel::Gaussian => exp(-0.5 * a * a) / (2.0 * PI).sqrt(),
            Kernel::TruncatedGaussian => {
                PI * self.constant(Dimension::Three) / CUT * -exp(-CUT * a * a) * libm::expm1(-CUT * v)
            }
        }
    }
}

/// int_0^end u^n e^(-a u^2) du, to infinity without an end.
fn gaussian_radial(n: u32, a: f64, end: Option<f64>) -> f64 {
    let tail = if end.is_some() { exp(-a) } else { 0.0 };
    let root = a.sqrt();
    let (mut value, first) = if n.is_multiple_of(2) {
        (0.5 * (PI.sqrt() / root) * if end.is_some() { erf(root) } else { 1.0 }, 0)
    } else {
        (0.5 * (1.0 - tail) / a, 1)
    };
    let mut k = first;
    while k < n {
        value = (f64::from(k + 1) * value - tail) / (2.0 * a);
        k += 2;
    }
    value
}

/// Mean weight over the disc of the kernel of Jensen's 1996 photon maps,
/// alpha \[1 - (1 - e^(-beta u^2/2))/(1 - e^(-beta))\] with alpha = 0.918, beta = 1.953.
///
/// Not 1: an estimate that divides by the disc's area is low by this factor unless it divides by it too.
pub fn jensen_disc_mean_weight() -> Value {
    let (alpha, beta) = (0.918, 1.953);
    let inside = 1.0 + libm::expm1(-0.5 * beta) * 2.0 / beta;
    Value::rounded(alpha * (1.0 + inside / libm::expm1(-beta)), ULPS, METHOD)
}

/// Standard normal distribution function.
pub(crate) fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;

    /// int_0^reach f by 40 nodes on ten panels.
    fn radial(kernel: Kernel, f: impl Fn(f64) -> f64) -> f64 {
        let rule = GaussLegendre::rule(40);
        let step = if kernel == Kernel::Gaussian { 1.5 } else { 0.1 };
        (0..10).map(|i| rule.integrate(step * f64::from(i), step * f64::from(i + 1), &f)).sum()
    }

    #[test]
    fn closed_forms_agree_with_quadrature() {
        for kernel in Kernel::SAMPLES {
            for d in Dimension::ALL {
                let area = |u: f64| d.sphere_area() * libm::pow(u, f64::from(d.number() - 1));
                for j in [0, 1, 2, 4, 7, 20] {
                    let weight = |u: f64| libm::pow(u, f64::from(j)) * area(u) * kernel.density(d, u);
                    let want = radial(kernel, weight);
                    let got = kernel.moment(d, j).unwrap();
                    assert!(
                        (got.value - want).abs() <= got.error + 1e-13 * want,
                        "{kernel:?} {d:?} {j}: {got:?} {want}"
                    );
                }
                let want = radial(kernel, |u| area(u) * kernel.density(d, u) * kernel.density(d, u));
                let got = kernel.roughness(d).unwrap();
                assert!((got.value - want).abs() <= got.error + 1e-13 * want, "{kernel:?} {d:?}");
                let second =
                    radial(kernel, |u| u * u * area(u) * kernel.density(d, u) * kernel.density(d, u));
                let got = kernel.square_moment(d).unwrap();
                assert!((got.value - second / want).abs() <= got.error + 2e-13, "{kernel:?} {d:?}");
            }
        }
    }

    #[test]
    fn marginal_is_the_integral_over_the_plane() {
        let rule = GaussLegendre::rule(60);
        for kernel in Kernel::SAMPLES {
            for z in [0.0, 0.2, -0.7, 0.999] {
                let end = if kernel == Kernel::Gaussian { 12.0 } else { f64::sqrt(1.0 - z * z) };
                let plane = |s: f64| 2.0 * PI * s * kernel.density(Dimension::Three, (s * s + z * z).sqrt());
                // The cone's root is not smooth at s = 0, z = 0: a short panel there.
                let want = rule.integrate(0.0, 0.1 * end, plane) + rule.integrate(0.1 * end, end, plane);
                let got = kernel.marginal(z).unwrap();
                assert!((got.value - want).abs() < got.error + 1e-11, "{kernel:?} {z}: {got:?} {want}");
            }
        }
    }

    #[test]
    fn known_formulas() {
        for d in Dimension::ALL {
            let n = f64::from(d.number());
            let m = |kernel: Kernel, j| kernel.moment(d, j).unwrap();
            assert!(m(Kernel::Epanechnikov, 2).covers(n / (n + 4.0)));
            assert!(m(Kernel::Biweight, 4).covers(n * (n + 2.0) / ((n + 6.0) * (n + 8.0))));
            assert!(m(Kernel::Cone { kappa: 1.0 }, 2).covers(n * (n + 1.0) / ((n + 2.0) * (n + 3.0))));
            assert!(m(Kernel::Gaussian, 4).covers(n * (n + 2.0)));
            let rv = |kernel: Kernel| kernel.variance_coefficient(d).unwrap();
            assert!(rv(Kernel::Uniform).covers(1.0));
            let biweight = 6.0 * (n + 2.0) * (n + 4.0) / ((n + 6.0) * (n + 8.0));
            assert!(rv(Kernel::Biweight).covers(biweight));
            assert!(rv(Kernel::Cone { kappa: 1.0 }).covers(2.0 * (n + 1.0) / (n + 2.0)));
        }
        assert!(jensen_disc_mean_weight().covers(0.531_154_926_952_969));
        assert!(Kernel::Cone { kappa: 0.5 }.moment(Dimension::Two, 2).is_err());
    }
}
