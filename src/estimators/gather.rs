//! Gathers: which photons an estimate uses, and the bias and variance expected of it.

use super::Kernel;
use super::kernel::UNIT_BALL;
use super::schedule::Codimension;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::math::{Positive, exp};
use crate::photons::tree::Counted;
use std::f64::consts::PI;
use std::fmt;

/// The k of a k-nearest gather: at least 2, since k-1 photons are summed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct NeighborCount(usize);

impl NeighborCount {
    /// # Errors
    /// [`Error::OutOfRange`] below 2.
    pub fn new(k: usize) -> Result<Self> {
        if k < 2 { Err(Error::out_of_range("k", k as f64, "at least 2")) } else { Ok(NeighborCount(k)) }
    }

    /// The plain number.
    pub fn get(self) -> usize {
        self.0
    }

    /// k - 2: the volume of the k nearest has E(1/V^2) = 1/((k-1)(k-2)), infinite for k = 2.
    fn freedom(self) -> f64 {
        self.0 as f64 - if planted(Fault::FreedomOfThree) { 1.0 } else { 2.0 }
    }
}

/// Which photons an estimate uses.
///
/// With fewer than k photons within `max_radius` a nearest gather is **under-full**: the estimate is then
/// that of the fixed radius `max_radius`, all its photons counted. In a uniform field of independent photons
/// the mixture of the two rules is still unbiased.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gather {
    /// All photons at most this far away \[L\].
    Radius(Positive),
    /// The k-th photon sets the radius and contributes nothing; the k-1 nearer ones are summed.
    Nearest {
        /// Which photon sets the radius.
        k: NeighborCount,
        /// Photons farther away are not used \[L\].
        max_radius: Positive,
    },
    /// The rule as it is often written: the k-th photon sets the radius and is summed too. A kernel that does
    /// not vanish at its edge is then biased high, the uniform one by 1/(k-1).
    NearestBiased {
        /// Which photon sets the radius.
        k: NeighborCount,
        /// Photons farther away are not used \[L\].
        max_radius: Positive,
    },
}

impl Gather {
    /// All photons within `radius` \[L\].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `radius` is from 1e-30 to 1e30.
    pub fn radius(radius: f64) -> Result<Self> {
        Ok(Gather::Radius(Positive::length("the gather radius", radius)?))
    }

    /// The k nearest photons within `max_radius` \[L\].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if k is below 2, or `max_radius` not from 1e-30 to 1e30.
    pub fn nearest(k: usize, max_radius: f64) -> Result<Self> {
        let max_radius = Positive::length("the largest gather radius", max_radius)?;
        Ok(Gather::Nearest { k: NeighborCount::new(k)?, max_radius })
    }

    /// Which photon sets the radius, if one does; the farthest that photons are taken from \[L\]; which of them count.
    pub(super) fn rule(self) -> (Option<NeighborCount>, f64, Counted) {
        match self {
            Gather::Radius(radius) => (None, radius.get(), Counted::BelowKth),
            Gather::Nearest { k, max_radius } => (Some(k), max_radius.get(), Counted::BelowKth),
            Gather::NearestBiased { k, max_radius } => (Some(k), max_radius.get(), Counted::UpToKth),
        }
    }

    /// Which photon sets the radius; none where it is fixed.
    pub fn k(self) -> Option<usize> {
        self.rule().0.map(NeighborCount::get)
    }

    /// The farthest that a photon may be taken from \[L\].
    pub fn cap(self) -> f64 {
        self.rule().1
    }

    /// The same gather, reaching no farther than `limit`, finite or not and above zero \[L\].
    pub fn within(self, limit: f64) -> Self {
        let limited =
            |radius: Positive| Positive::new("the gather radius", radius.get().min(limit)).unwrap_or(radius);
        match self {
            Gather::Radius(radius) => Gather::Radius(limited(radius)),
            Gather::Nearest { k, max_radius } => Gather::Nearest { k, max_radius: limited(max_radius) },
            Gather::NearestBiased { k, max_radius } => {
                Gather::NearestBiased { k, max_radius: limited(max_radius) }
            }
        }
    }

    /// The same gather in the map of this number, with its radius shrunk as the codimension asks; the k nearest photons as they are.
    pub fn in_map(self, map: u64, codimension: Codimension) -> Self {
        match self {
            Gather::Radius(radius) => Gather::Radius(codimension.radius(radius, map)),
            Gather::Nearest { .. } | Gather::NearestBiased { .. } => self,
        }
    }

    /// The same gather of so many photons, at least 2; of a fixed radius, itself.
    pub fn with_k(self, number: usize) -> Self {
        let k = NeighborCount(number.max(2));
        match self {
            Gather::Radius(_) => self,
            Gather::Nearest { max_radius, .. } => Gather::Nearest { k, max_radius },
            Gather::NearestBiased { max_radius, .. } => Gather::NearestBiased { k, max_radius },
        }
    }

    /// [`Gather::nearest`] with the biased rule.
    ///
    /// # Errors
    /// As [`Gather::nearest`].
    pub fn nearest_biased(k: usize, max_radius: f64) -> Result<Self> {
        let max_radius = Positive::length("the largest gather radius", max_radius)?;
        Ok(Gather::NearestBiased { k: NeighborCount::new(k)?, max_radius })
    }

    /// The squared radius that the curvature bias is proportional to [L^2], for independent photons.
    ///
    /// For the k-nearest rule that is E(r_{k-1}^2) = (3/(4 pi n))^(2/3) Gamma(k-1/3)/Gamma(k-1), n the
    /// photons per volume, and not E(r_k^2): the estimate carries 1/r_k^3, which favours small radii. The cap
    /// is left out.
    pub fn effective_squared_radius(self, photons_per_volume: f64) -> f64 {
        let (k, cap, _) = self.rule();
        let Some(k) = k else { return cap * cap };
        let below = k.get() as f64 - 1.0;
        let one_photon = libm::cbrt(1.0 / (photons_per_volume * UNIT_BALL));
        let ratio = exp(libm::lgamma(below + 2.0 / 3.0) - libm::lgamma(below));
        one_photon * one_photon * ratio
    }

    /// The same on a plane, for the disc: E(r_{k-1}^2) = (k-1)/(pi n) for the k-nearest rule, n the photons per area.
    pub fn effective_squared_disc(self, photons_per_area: f64) -> f64 {
        let (k, cap, _) = self.rule();
        let Some(k) = k else { return cap * cap };
        (k.get() as f64 - 1.0) / (PI * photons_per_area)
    }

    /// Bias expected of an estimate of a field from independent photons, to second order in the radius.
    ///
    /// Blur, (m2/6) r^2 laplacian with the effective radius, the same law for every gather; and, of the
    /// biased rule only, the k-th photon's own weight, field x K(1) V/(k-1) with V the unit ball's volume.
    ///
    /// # Arguments `field` and its `laplacian` (per L^2) at the point; `photons_per_volume` [1/L^3], stored
    /// # Returns   in the unit of the field
    pub fn expected_bias(self, kernel: Kernel, field: f64, laplacian: f64, photons_per_volume: f64) -> f64 {
        let blur = kernel.m2() / 6.0 * self.effective_squared_radius(photons_per_volume) * laplacian;
        self.with_last(blur, field, ball_edge(kernel))
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
        self.with_last(blur, field, disc_edge(kernel))
    }

    fn with_last(self, blur: f64, field: f64, edge: f64) -> f64 {
        match self {
            Gather::NearestBiased { k, .. } => blur + field * edge / (k.get() as f64 - 1.0),
            Gather::Radius(_) | Gather::Nearest { .. } => blur,
        }
    }

    /// Variance expected of an estimate from independent photons in a uniform field, over the square of the
    /// field.
    ///
    /// With R the roughness times the unit ball's volume, q = E(p^2)/E(p)^2 of the photons' powers: q R/n for
    /// a ball that holds n photons on average, q R/(k-2) for the k-nearest rule (infinite for k = 2). The
    /// latter is E(S^2) E(1/V_k^2) - 1: the sum S over k-1 uniform places has E(S^2) = (k-1) q R +
    /// (k-1)(k-2), and the volume V_k, a gamma variable of order k, has E(1/V_k^2) = 1/((k-1)(k-2)). The
    /// number of photons is taken to be Poisson.
    ///
    /// # Arguments `power_ratio` q, at least 1; `photons_per_volume` [1/L^3], stored
    pub fn expected_relative_variance(
        self,
        kernel: Kernel,
        photons_per_volume: f64,
        power_ratio: f64,
    ) -> f64 {
        let roughness = power_ratio * kernel.roughness() * UNIT_BALL;
        let r = self.cap();
        let held = photons_per_volume * UNIT_BALL * r * r * r;
        self.relative_variance(roughness, held, ball_edge(kernel), power_ratio)
    }

    /// The same of an irradiance on an evenly lit plane; `photons_per_area` [1/L^2], stored.
    pub fn expected_disc_variance(self, kernel: Kernel, photons_per_area: f64, power_ratio: f64) -> f64 {
        let roughness = power_ratio * kernel.disc_roughness();
        let r = self.cap();
        self.relative_variance(roughness, photons_per_area * PI * r * r, disc_edge(kernel), power_ratio)
    }

    /// `held` photons are within a fixed radius on average.
    fn relative_variance(self, roughness: f64, held: f64, edge: f64, power_ratio: f64) -> f64 {
        match self {
            Gather::Radius(_) => roughness / held,
            Gather::Nearest { k, .. } => roughness / k.freedom(),
            Gather::NearestBiased { k, .. } => {
                let k = k.get() as f64;
                let square =
                    (k - 1.0) * (roughness + k - 2.0) + 2.0 * edge * (k - 1.0) + power_ratio * edge * edge;
                let mean = 1.0 + edge / (k - 1.0);
                square / ((k - 1.0) * (k - 2.0)) - mean * mean
            }
        }
    }
}

impl fmt::Display for Gather {
    /// Such as "k=50".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Gather::Radius(radius) => write!(f, "r={}", radius.get()),
            Gather::Nearest { k, .. } => write!(f, "k={}", k.get()),
            Gather::NearestBiased { k, .. } => write!(f, "k={}(biased)", k.get()),
        }
    }
}

/// The kernel at its edge over its mean in the ball.
fn ball_edge(kernel: Kernel) -> f64 {
    kernel.peak() * kernel.profile(1.0) * UNIT_BALL
}

/// The kernel at its edge over its mean on the disc.
fn disc_edge(kernel: Kernel) -> f64 {
    kernel.disc_peak() * kernel.profile(1.0) * PI
}
