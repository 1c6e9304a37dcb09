//! Photons and rays as points or as beams: how an estimate blurs, and how it spreads.
//!
//! A map of n photons a volume estimates a field f in three ways (Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011):
//!
//! * **points at a point**: sum of K_3(|x_p - x|/r)/r^3. Blur in three dimensions, variance ~ 1/r^3.
//! * **points along a ray** (the beam radiance estimate, Jarosz, Zwicker and Jensen 2008): int T f ds along a ray from
//!   all points beside it, each with K_2(distance/r)/r^2 and the transmittance T to the foot of its perpendicular. Blur
//!   across the ray, variance ~ 1/r^2.
//! * **beams along a ray**: a photon is its whole path between two collisions. A path that passes the ray at distance
//!   u, under the angle theta, adds K_1(u/r)/(r sin theta). Blur along n, the common normal of ray and path, variance
//!   ~ 1/r.
//!
//! The mean is that of f blurred by the kernel, in so many dimensions, exactly (the ray's ends included, whose planes
//! cut the kernel's cylinder square): bias m2 r^2/(2d) times the Laplacian in the d directions of blur; r^2/10, r^2/8
//! and r^2/6 for the uniform kernel. Beams of an isotropic field have their normals n in all azimuths about the ray, so
//! that they blur like a radial kernel in the plane with half the coefficient, r^2/12 times the Laplacian across.
//!
//! Beams cross a ray the less often the more parallel they are to it, in proportion to sin theta, which 1/sin theta
//! repairs: the mean is right, and the second moment is E\[1/sin theta\] times that of perpendicular beams, pi/2 for
//! isotropic ones. Of those that do cross, the contribution X = 1/sin theta has
//! P(X > x) = (2/pi)(a - sin a cos a), sin a = 1/x, which falls like (4/(3 pi)) x^-3: the variance is finite, the third
//! moment diverges like ln x, and the variance of an estimated variance is infinite. Error bars of beam estimates
//! are one-sided and come slowly.
//!
//! Points are Poisson. Source: the papers above; Santalo 1976, chapter 12 (lines in space).

mod crossing;
mod field;

use crate::ball_mean::exponential_mean;
use crate::error::{Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::value::Value;
pub use crossing::{crossing_moment, crossing_tail};
pub use field::blurred_field;
use libm::{cos, expm1};
use std::f64::consts::{FRAC_PI_2, PI};

/// What asks, and what is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pairing {
    /// A point asks photons stored as points.
    PointPoints,
    /// A ray asks photons stored as points: the beam radiance estimate.
    RayPoints,
    /// A point asks photons stored as beams, all of one direction.
    PointBeams,
    /// A ray asks photons stored as beams, all of which have the same common normal with it and cross it under the
    /// angle of this sine.
    RayBeams {
        /// Sine of the angle between ray and beams \[1\], above 0 to 1.
        sine: f64,
    },
    /// A ray asks photons stored as beams, whose directions are isotropic.
    RayIsotropicBeams,
}

impl Pairing {
    /// Dimensions in which the kernel lives: 3, 2, 2, 1, 1.
    pub fn dimension(self) -> Dimension {
        match self {
            Pairing::PointPoints => Dimension::Three,
            Pairing::RayPoints | Pairing::PointBeams => Dimension::Two,
            Pairing::RayBeams { .. } | Pairing::RayIsotropicBeams => Dimension::One,
        }
    }

    fn check(self) -> Result<Self> {
        if let Pairing::RayBeams { sine } = self {
            within("sine", sine, 1e-100, 1.0, "1e-100 to 1")?;
        }
        Ok(self)
    }

    /// Bias over r^2 and the field's Laplacian: in space (points at a point), across the ray (points along a ray, isotropic
    /// beams) or the beams (beams at a point), or the second derivative along the common normal.
    ///
    /// m2/(2d); half the one-dimensional one for isotropic beams. Uniform kernel: 1/10, 1/8, 1/8, 1/6, 1/12.
    /// # Errors
    /// `Error::OutOfRange` naming `kappa` or `sine`
    pub fn bias_coefficient(self, kernel: Kernel) -> Result<Value> {
        let coefficient = kernel.bias_coefficient(self.check()?.dimension())?;
        Ok(if self == Pairing::RayIsotropicBeams { coefficient.scaled(0.5) } else { coefficient })
    }

    /// E\[1/sin theta\] over the beams: pi/2 if isotropic; 1 without beams.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `sine`
    pub fn inverse_sine(self) -> Result<Value> {
        let value = match self.check()? {
            Pairing::PointPoints | Pairing::RayPoints | Pairing::PointBeams => 1.0,
            Pairing::RayBeams { sine } => 1.0 / sine,
            Pairing::RayIsotropicBeams => FRAC_PI_2,
        };
        Ok(Value::rounded(value, 2.0, "closed form"))
    }

    /// Mean of an estimate in the field e^(b.x), over the truth.
    ///
    /// # Arguments
    /// `x` = |b| r, b the part of the gradient along which the kernel blurs: all of it (points at a point), across the ray
    /// (points along a ray, isotropic beams) or the beams (beams at a point), along the common normal (other beams); |x| up to 500, Gaussian 35
    /// # Returns
    /// \[1\], at least 1
    /// # Errors
    /// `Error::OutOfRange` naming `x`, `kappa` or `sine`
    /// # Limits
    /// x -> 0: 1 + bias coefficient times x^2
    pub fn exponential_mean(self, kernel: Kernel, x: f64) -> Result<Value> {
        let d = self.check()?.dimension();
        if self != Pairing::RayIsotropicBeams {
            return exponential_mean(kernel, d, x);
        }
        // Mean over the azimuth psi of the normal. The integrand is entire and of period pi: the rule of equal weights
        // converges like e^x (x/2m)^(2m)/(2m)! ... once 2 m exceeds x.
        let whole = exponential_mean(kernel, d, x)?;
        let count = 2 * (24 + libm::ceil(0.75 * x.abs()) as u32);
        let (mut sum, mut half, mut error) = (0.0, 0.0, 0.0);
        for i in 0..count {
            let value = exponential_mean(kernel, d, x * cos(PI * f64::from(i) / f64::from(count)))?;
            sum += value.value;
            error += value.error;
            if i % 2 == 0 {
                half += value.value;
            }
        }
        let m = f64::from(count);
        let (fine, coarse) = (sum / m, 2.0 * half / m);
        // The argument's rounding, and the disagreement of the rules.
        let rounding = (8.0 + 2.0 * x.abs()) * f64::EPSILON * fine;
        Ok(Value::new(fine, error / m + (fine - coarse).abs() + rounding, whole.method))
    }

    /// Variance of an estimate in a uniform field over the square of the truth, for Poisson photons of equal power.
    ///
    /// R_d E\[1/sin theta\]/(density r^d S), R_d the kernel's roughness; S = 1 at a point, (int T ds)^2/int T^2 ds along a
    /// ray.
    /// # Arguments
    /// `radius` \[length\]; `density`: of points \[1/length^3\], of beams their length in a volume \[1/length^2\]; `ray` what
    /// asks (nothing of it matters at a point)
    /// # Returns
    /// \[1\]; photons of unequal power: times E\[p^2\]/E\[p\]^2
    /// # Errors
    /// `Error::OutOfRange` naming `radius`, `density`, `length`, `extinction`, `kappa` or `sine`
    /// # Limits
    /// points, uniform kernel: one over the expected number within r; isotropic beams: pi/(4 density length r)
    pub fn relative_variance(self, kernel: Kernel, radius: f64, density: f64, ray: Ray) -> Result<Value> {
        let d = self.check()?.dimension();
        within("radius", radius, 1e-60, 1e60, "1e-60 to 1e60")?;
        within("density", density, 1e-60, 1e60, "1e-60 to 1e60")?;
        let is_of_point = matches!(self, Pairing::PointPoints | Pairing::PointBeams);
        let sampled = if is_of_point { 1.0 } else { ray.sampled()? };
        let factor = self.inverse_sine()?.value / (density * d.power(radius) * sampled);
        let value = kernel.roughness(d)?.scaled(factor);
        Ok(Value::new(value.value, value.error + 32.0 * f64::EPSILON * value.value, value.method))
    }

    /// The radius of least mean squared error in a field of unit value, and what is left there.
    ///
    /// Bias A r^2 and variance B/r^d: r^(d+4) = d B/(4 A^2), where the variance is 4/d of the squared bias.
    /// # Arguments
    /// `curvature` the Laplacian, or second derivative, that [`Pairing::bias_coefficient`] is of, over the field
    /// \[1/length^2\], not 0; `density` and `ray` as in [`Pairing::relative_variance`]
    /// # Returns
    /// radius \[length\] and relative mean squared error \[1\]
    /// # Errors
    /// `Error::OutOfRange` naming the parameter
    pub fn optimum(self, kernel: Kernel, curvature: f64, density: f64, ray: Ray) -> Result<(Value, Value)> {
        let size = within("curvature", curvature.abs(), 1e-60, 1e60, "1e-60 to 1e60, or negative")?;
        let bias = self.bias_coefficient(kernel)?.scaled(size);
        let variance = self.relative_variance(kernel, 1.0, density, ray)?;
        crate::kernel::optimum(self.dimension(), bias.value, variance.value)
    }
}

/// A ray that asks photons, from its origin on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Length \[length\], 1e-60 to 1e60.
    pub length: f64,
    /// Extinction coefficient of the medium \[1/length\], 0 to 1e60: contributions count e^(-extinction s).
    pub extinction: f64,
}

impl Ray {
    /// (int T ds)^2/int T^2 ds, the length that is seen: length (2/y) tanh(y/2), y = extinction length.
    fn sampled(self) -> Result<f64> {
        within("length", self.length, 1e-60, 1e60, "1e-60 to 1e60")?;
        within("extinction", self.extinction, 0.0, 1e60, "0 to 1e60")?;
        let y = self.extinction * self.length;
        // tanh(y/2) = (1 - e^(-y))/(1 + e^(-y)).
        let less = -expm1(-y);
        Ok(if y < 1e-8 { self.length } else { 2.0 / self.extinction * less / (2.0 - less) })
    }
}

#[cfg(test)]
mod tests;
