//! A straight edge of a wide shaft of light, as kernels in three dimensions show it; the k nearest points in `nearest`.
//!
//! The field is e^(-decay z) H(x): dark for x < 0, falling along the shaft, which every edge of uncollided light in a
//! homogeneous medium does. With lengths in radii, s = decay times radius, the estimate at distance x inside the edge
//! is, over the field at its depth inside,
//!
//! M(x) = int_-inf^x L(t) dt,   L(t) = int_0^inf K(sqrt(t^2 + p^2)) I_0(s p) 2 pi p dp.
//!
//! For K = c (1-u^2)^n, v = 1 - t^2: L = pi c sum_j (s/2)^(2j) n!/(j! (n+j+1)!) v^(n+j+1), a sum of positive terms. Any
//! other kernel is a mixture of uniform balls of radius u with weight -K'(u) 4 pi u^3/3, and K(1) 4 pi/3 at u = 1.
//! All is shown over the plateau M(inf), which the decay lifts above 1.

mod nearest;

use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel, normal_cdf};
use crate::quadrature::GAUSS_24;
use crate::value::Value;
pub use nearest::NearestEdge;
use std::f64::consts::PI;

const METHOD: &str = "series in the decay, Gauss rule exact for its terms";

/// Terms of the series: at s = 5 the next is 1e-20 of the first. The highest in v = 1 - t^2 has degree 46, which the rule
/// of 24 nodes integrates exactly.
const TERMS: usize = 20;

/// Largest decay times radius.
pub(crate) const LARGEST_DECAY: f64 = 5.0;

/// Roundings of a sum of positive terms by the rules below, with room.
const ULPS: f64 = 64.0;

/// A member of (1-u^2)^n in a decaying field: L as a polynomial in v.
struct Family {
    /// Lowest power, n + 1.
    first: i32,
    coefficients: [f64; TERMS],
    terms: usize,
}

impl Family {
    fn new(n: u8, s: f64) -> Self {
        let n = f64::from(n);
        // pi c n!/(n+1)! with c = 3/(4 pi), 15/(8 pi), 105/(32 pi).
        let mut term = [0.75, 0.9375, 1.093_75][n as usize];
        let (mut coefficients, mut terms, mut j) = ([0.0; TERMS], 0, 0.0);
        while terms < TERMS && term > 1e-18 * coefficients[0] {
            coefficients[terms] = term;
            terms += 1;
            j += 1.0;
            term *= 0.25 * s * s / (j * (n + j + 1.0));
        }
        Family { first: n as i32 + 1, coefficients, terms }
    }

    fn line(&self, t: f64) -> f64 {
        let v = (1.0 - t) * (1.0 + t);
        if v <= 0.0 {
            return 0.0;
        }
        let sum = self.coefficients[..self.terms].iter().rev().fold(0.0, |sum, a| sum * v + a);
        (0..self.first).fold(sum, |product, _| product * v)
    }

    /// M(x) for x <= 0.
    fn below(&self, x: f64) -> f64 {
        if x <= -1.0 { 0.0 } else { GAUSS_24.integrate(-1.0, x, |t| self.line(t)) }
    }
}

/// The edge in a fixed radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    kernel: Kernel,
    s: f64,
}

impl Edge {
    /// # Arguments
    /// `decay` of the field along the shaft times the radius \[1\], 0 to 5
    /// # Errors
    /// `Error::OutOfRange` naming `kappa` or `decay`
    pub fn new(kernel: Kernel, decay: f64) -> Result<Self> {
        kernel.check()?;
        within("decay", decay, 0.0, LARGEST_DECAY, "0 to 5 radii")?;
        Ok(Edge { kernel, s: decay })
    }

    /// Estimate far inside over the field at its depth: the mean of e^(-sz) over the kernel.
    ///
    /// # Limits
    /// s -> 0: 1 + m2 s^2/6
    pub fn plateau(&self) -> Value {
        Value::rounded(2.0 * self.below(0.0), ULPS, METHOD)
    }

    /// Edge spread function: the estimate at `x` radii inside the edge, over the plateau.
    ///
    /// # Returns
    /// \[1\], 0 to 1; the uniform kernel without decay: (1+x)^2 (2-x)/4
    /// # Errors
    /// `Error::OutOfRange` naming `x`
    pub fn spread(&self, x: f64) -> Result<Value> {
        within("x", x, f64::MIN, f64::MAX, "finite numbers")?;
        let share = self.below(-x.abs()) / (2.0 * self.below(0.0));
        // A rounding of the plane's place moves the value by at most half of one.
        let error = (2.0 * ULPS * share + 1.0) * f64::EPSILON;
        Ok(Value::new(if x > 0.0 { 1.0 - share } else { share }, error, METHOD))
    }

    /// Line spread function, the slope of [`Edge::spread`] \[1/radius\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `x`
    pub fn line(&self, x: f64) -> Result<Value> {
        within("x", x, f64::MIN, f64::MAX, "finite numbers")?;
        let value = self.slope(x) / (2.0 * self.below(0.0));
        // Near the rim the slope of the slope, below 2 for all kernels, brings the rounding of x.
        Ok(Value::new(value, (2.0 * ULPS * value + 8.0) * f64::EPSILON, METHOD))
    }

    /// Where the edge spread function has a value \[radii\], negative outside.
    ///
    /// # Arguments
    /// `level` 1e-6 to 1 - 1e-6
    /// # Errors
    /// `Error::OutOfRange` naming `level`
    pub fn place(&self, level: f64) -> Result<Value> {
        within("level", level, 1e-6, 1.0 - 1e-6, "1e-6 to 1 - 1e-6")?;
        let (mut low, mut high) = (-self.kernel.reach(), self.kernel.reach());
        // Bisection of a rising function down to neighbouring numbers.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.spread(middle)?.value < level { low = middle } else { high = middle }
        }
        let error = self.spread(low)?.error / self.line(low)?.value + 4.0 * f64::EPSILON;
        Ok(Value::new(0.5 * (low + high), error, "bisection of the edge spread"))
    }

    /// Distance over which the edge rises from 10 to 90 per cent of the plateau \[radii\].
    ///
    /// # Errors
    /// none in practice: those of [`Edge::place`]
    pub fn rise_width(&self) -> Result<Value> {
        // The field is even about the edge: M(-x) = M(inf) - M(x).
        Ok(self.place(0.9)?.scaled(2.0))
    }

    /// Inverse slope at the edge, over the plateau \[radii\]: the width of the box of the same peak and integral.
    pub fn equivalent_width(&self) -> Value {
        Value::rounded(2.0 * self.below(0.0) / self.slope(0.0), 2.0 * ULPS, METHOD)
    }

    /// M(x), not over the plateau.
    fn image(&self, x: f64) -> f64 {
        if x > 0.0 { 2.0 * self.below(0.0) - self.below(-x) } else { self.below(x) }
    }

    /// Derivative of the plateau in s: that of sinh(su)/(su), the mean over a shell, is u (su/3) times the plateau of
    /// the uniform ball of radius u.
    fn plateau_slope(&self) -> f64 {
        if self.kernel == Kernel::Gaussian {
            return self.s * libm::exp(0.5 * self.s * self.s);
        }
        GAUSS_24.integrate(0.0, 1.0, |u| {
            let shell = self.kernel.density(Dimension::Three, u) * 4.0 * PI * u * u;
            shell * u * (self.s * u / 3.0) * 2.0 * Family::new(0, self.s * u).below(0.0)
        })
    }

    /// M(x) for x <= 0.
    fn below(&self, x: f64) -> f64 {
        match self.mixture() {
            Mixture::Family(n) => Family::new(n, self.s).below(x),
            Mixture::Balls { weight, rim } => self.over_balls(-x, rim, weight, |s, u| {
                let inner = Family::new(0, s);
                if u > 0.0 { inner.below(x / u) } else { 0.0 }
            }),
            Mixture::Space => libm::exp(0.5 * self.s * self.s) * normal_cdf(x),
        }
    }

    /// L(x), not over the plateau.
    fn slope(&self, x: f64) -> f64 {
        match self.mixture() {
            Mixture::Family(n) => Family::new(n, self.s).line(x),
            Mixture::Balls { weight, rim } => self.over_balls(x.abs(), rim, weight, |s, u| {
                if u > 0.0 { Family::new(0, s).line(x / u) / u } else { 0.0 }
            }),
            Mixture::Space => libm::exp(0.5 * self.s * self.s) * self.kernel.plane_density(x),
        }
    }

    /// Mixture over the balls that reach the plane at distance `from`. Times u^3 the terms of the series are
    /// polynomials in u.
    fn over_balls(
        &self,
        from: f64,
        rim: f64,
        weight: impl Fn(f64) -> f64,
        ball: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        if from >= 1.0 {
            return 0.0;
        }
        GAUSS_24.integrate(from, 1.0, |u| weight(u) * ball(self.s * u, u)) + rim * ball(self.s, 1.0)
    }

    fn mixture(&self) -> Mixture {
        let ball = Dimension::Three.ball_volume();
        let peak = self.kernel.constant(Dimension::Three);
        match self.kernel {
            Kernel::Uniform => Mixture::Family(0),
            Kernel::Epanechnikov => Mixture::Family(1),
            Kernel::Biweight => Mixture::Family(2),
            Kernel::Cone { kappa } => Mixture::Balls {
                weight: Box::new(move |u| ball * peak / kappa * u * u * u),
                rim: ball * peak * (1.0 - 1.0 / kappa),
            },
            Kernel::TruncatedGaussian => Mixture::Balls {
                weight: Box::new(move |u| ball * peak * 9.0 * u * u * u * u * libm::exp(-4.5 * u * u)),
                rim: ball * peak * libm::exp(-4.5),
            },
            Kernel::Gaussian => Mixture::Space,
        }
    }
}

/// What a kernel is made of.
enum Mixture {
    /// (1-u^2)^n.
    Family(u8),
    /// Uniform balls: their density over the radius, and the weight of the largest.
    Balls { weight: Box<dyn Fn(f64) -> f64>, rim: f64 },
    /// The Gaussian over all of space.
    Space,
}

#[cfg(test)]
mod tests;
