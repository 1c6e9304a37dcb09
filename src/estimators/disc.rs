//! Kernels on the disc of two dimensions: what estimates on surfaces use, and the bias and variance expected of them.

use super::{Gather, Kernel};
use crate::math::{exp, exp_m1, ln_1p, sin};
use libm::asin;
use std::f64::consts::PI;

/// The Gaussian's exponent at the edge: exp(-a u^2) with a = 1/(2 s^2), s = 1/3.
const A: f64 = 4.5;

/// The same profiles as on the ball, normalised over the disc: K integrates to one over u < 1 in two dimensions, the
/// kernel of radius r is K(u)/r^2.
impl Kernel {
    /// K at the centre, where every profile is 1.
    ///
    /// 1/(2 pi int_0^1 u profile du): for the Gaussian a/(pi (1 - e^-a)).
    pub fn disc_peak(self) -> f64 {
        match self {
            Kernel::Uniform => 1.0 / PI,
            Kernel::Epanechnikov => 2.0 / PI,
            Kernel::Cone | Kernel::Biweight => 3.0 / PI,
            Kernel::Gaussian => A / (PI * (1.0 - exp(-A))),
        }
    }

    /// Second moment, int u^2 K dA.
    pub fn disc_m2(self) -> f64 {
        match self {
            Kernel::Uniform => 1.0 / 2.0,
            Kernel::Epanechnikov => 1.0 / 3.0,
            Kernel::Cone => 3.0 / 10.0,
            Kernel::Biweight => 1.0 / 4.0,
            Kernel::Gaussian => 1.0 / A - exp(-A) / (1.0 - exp(-A)),
        }
    }

    /// Roughness, int K^2 dA, times the disc's area: the variance in units of the uniform kernel's.
    pub fn disc_roughness(self) -> f64 {
        match self {
            Kernel::Uniform => 1.0,
            Kernel::Epanechnikov => 4.0 / 3.0,
            Kernel::Cone => 3.0 / 2.0,
            Kernel::Biweight => 9.0 / 5.0,
            Kernel::Gaussian => 0.5 * A * (1.0 + exp(-A)) / (1.0 - exp(-A)),
        }
    }

    /// Distance from the middle, over the radius, of a point of the disc of density K, from a number in [0, 1).
    ///
    /// The inverse of the part of the kernel within a distance u: u^2; 2 u^2 - u^4; 3 u^2 - 2 u^3; 1 - (1-u^2)^3;
    /// (1 - e^(-a u^2))/(1 - e^-a).
    pub fn sample_disc(self, part: f64) -> f64 {
        match self {
            Kernel::Uniform => part.sqrt(),
            Kernel::Epanechnikov => (1.0 - (1.0 - part).sqrt()).sqrt(),
            Kernel::Cone => 0.5 - sin(asin(1.0 - 2.0 * part) / 3.0),
            Kernel::Biweight => (1.0 - libm::cbrt(1.0 - part)).sqrt(),
            Kernel::Gaussian => (-ln_1p(part * exp_m1(-A)) / A).sqrt(),
        }
    }

    /// The kernel at its edge over its mean on the disc.
    fn disc_edge(self) -> f64 {
        self.disc_peak() * self.profile(1.0) * PI
    }
}

impl Gather {
    /// The squared radius that the curvature bias on a plane is proportional to [L^2], for independent photons:
    /// E(r_{k-1}^2) = (k-1)/(pi n) for the k-nearest rule, n the photons per area. The cap is left out.
    pub fn effective_squared_disc(self, photons_per_area: f64) -> f64 {
        match self {
            Gather::Radius(radius) => radius.get() * radius.get(),
            Gather::Nearest { k, .. } | Gather::NearestBiased { k, .. } => {
                (k.get() as f64 - 1.0) / (PI * photons_per_area)
            }
        }
    }

    /// Bias expected of an irradiance on a plane, to second order in the radius: (m2/4) r^2 laplacian, and of the
    /// biased rule the k-th photon's own weight.
    ///
    /// # Arguments `field` and its `laplacian` (per L^2) along the plane; `photons_per_area` [1/L^2], stored
    pub fn expected_disc_bias(
        self,
        kernel: Kernel,
        field: f64,
        laplacian: f64,
        photons_per_area: f64,
    ) -> f64 {
        let blur = kernel.disc_m2() / 4.0 * self.effective_squared_disc(photons_per_area) * laplacian;
        match self {
            Gather::NearestBiased { k, .. } => blur + field * kernel.disc_edge() / (k.get() as f64 - 1.0),
            _ => blur,
        }
    }

    /// Variance expected of an irradiance from independent photons on an evenly lit plane, over the square of the
    /// irradiance: q R/n for a disc that holds n photons on average, q R/(k-2) for the k-nearest rule, as in the ball
    /// ([`Gather::expected_relative_variance`]).
    pub fn expected_disc_variance(self, kernel: Kernel, photons_per_area: f64, power_ratio: f64) -> f64 {
        let roughness = power_ratio * kernel.disc_roughness();
        match self {
            Gather::Radius(radius) => roughness / (photons_per_area * PI * radius.get() * radius.get()),
            Gather::Nearest { k, .. } => roughness / k.freedom(),
            Gather::NearestBiased { k, .. } => {
                let (k, edge) = (k.get() as f64, kernel.disc_edge());
                let square =
                    (k - 1.0) * (roughness + k - 2.0) + 2.0 * edge * (k - 1.0) + power_ratio * edge * edge;
                let mean = 1.0 + edge / (k - 1.0);
                square / ((k - 1.0) * (k - 2.0)) - mean * mean
            }
        }
    }
}
