//! Kernels: how the photons of a ball are weighted by their distance from its centre.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use wide::f32x8;

/// Volume of the ball of radius 1.
pub const UNIT_BALL: f64 = 4.0 / 3.0 * PI;

/// A radial weight K(u) on the unit ball of three dimensions, u the distance over the radius; zero beyond u =
/// 1.
///
/// K integrates to one over the ball, so the kernel of radius r is K(u)/r^3. The moments are m_j = int u^j K
/// dV and the roughness is int K^2 dV. Kernels are compared at equal standard deviation a coordinate, r
/// sqrt(m2/3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// The same weight everywhere in the ball.
    Uniform,
    /// 1 - u^2.
    Epanechnikov,
    /// 1 - u.
    Cone,
    /// (1 - u^2)^2.
    Biweight,
    /// exp(-u^2/(2 s^2)) with s = 1/3, cut at u = 1.
    Gaussian,
}

impl Kernel {
    /// Every kernel.
    pub const ALL: [Kernel; 5] =
        [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Cone, Kernel::Biweight, Kernel::Gaussian];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Uniform => "uniform",
            Kernel::Epanechnikov => "epanechnikov",
            Kernel::Cone => "cone",
            Kernel::Biweight => "biweight",
            Kernel::Gaussian => "gaussian",
        }
    }

    /// K at the centre, where every profile is 1: what makes the integral over the ball one.
    ///
    /// The Gaussian's is 1/(4 pi I2), I2 = int_0^1 u^2 exp(-9 u^2/2) du = sqrt(pi) erf(a)/(4 a^3) -
    /// exp(-a^2)/(2 a^2) with a^2 = 9/2; its moments follow by parts from the same integral.
    pub fn peak(self) -> f64 {
        match self {
            Kernel::Uniform => 3.0 / (4.0 * PI),
            Kernel::Epanechnikov => 15.0 / (8.0 * PI),
            Kernel::Cone => 3.0 / PI,
            Kernel::Biweight => 105.0 / (32.0 * PI),
            Kernel::Gaussian => 1.766_057_561_883_723_7,
        }
    }

    /// K over its peak, from u^2 in [0, 1].
    pub fn profile(self, u2: f64) -> f64 {
        match self {
            Kernel::Uniform => 1.0,
            Kernel::Epanechnikov => 1.0 - u2,
            Kernel::Cone => 1.0 - u2.sqrt(),
            Kernel::Biweight => (1.0 - u2) * (1.0 - u2),
            Kernel::Gaussian => crate::math::exp(-4.5 * u2),
        }
    }

    /// [`Kernel::profile`] for eight photons, within 1e-6 of it (tested), that is a few roundings of f32.
    #[inline(always)]
    pub fn profiles(self, u2: f32x8) -> f32x8 {
        match self {
            Kernel::Uniform => f32x8::ONE,
            Kernel::Epanechnikov => f32x8::ONE - u2,
            Kernel::Cone => f32x8::ONE - u2.sqrt(),
            Kernel::Biweight => (f32x8::ONE - u2) * (f32x8::ONE - u2),
            Kernel::Gaussian => gaussian_profiles(u2),
        }
    }

    /// Part of the kernel within u, in [0, 1], of its centre: int_0^u 4 pi s^2 K ds.
    pub fn within(self, u: f64) -> f64 {
        let u2 = u * u;
        let cubed = u * u2;
        match self {
            Kernel::Uniform => cubed,
            Kernel::Epanechnikov => 0.5 * cubed * (5.0 - 3.0 * u2),
            Kernel::Cone => cubed * (4.0 - 3.0 * u),
            Kernel::Biweight => 0.125 * cubed * (35.0 - 42.0 * u2 + 15.0 * u2 * u2),
            Kernel::Gaussian => {
                let a = 4.5f64.sqrt();
                let whole = PI.sqrt() * libm::erf(a * u) / (4.0 * 4.5 * a);
                4.0 * PI * self.peak() * (whole - u * crate::math::exp(-4.5 * u2) / 9.0)
            }
        }
    }

    /// Part of the kernel beyond a plane at distance u of its centre, above 0: half of int_u^1 4 pi s^2 K (1 - u/s) ds, the
    /// caps that the plane cuts from spheres about the centre.
    pub fn beyond_plane(self, u: f64) -> f64 {
        if u >= 1.0 {
            return 0.0;
        }
        let rest = (1.0 - u) * (1.0 + u);
        // int_u^1 4 pi s K ds
        let across = match self {
            Kernel::Uniform => 1.5 * rest,
            Kernel::Epanechnikov => 1.875 * rest * rest,
            Kernel::Cone => 2.0 * (1.0 - u) * (1.0 - u) * (1.0 + 2.0 * u),
            Kernel::Biweight => 2.1875 * rest * rest * rest,
            Kernel::Gaussian => {
                -4.0 / 9.0
                    * PI
                    * self.peak()
                    * crate::math::exp(-4.5 * u * u)
                    * crate::math::exp_m1(-4.5 * rest)
            }
        };
        (0.5 * (1.0 - self.within(u) - u * across)).max(0.0)
    }

    /// Second moment.
    pub fn m2(self) -> f64 {
        match self {
            Kernel::Uniform => 3.0 / 5.0,
            Kernel::Epanechnikov => 3.0 / 7.0,
            Kernel::Cone => 2.0 / 5.0,
            Kernel::Biweight => 1.0 / 3.0,
            Kernel::Gaussian => 0.305_939_863_855_431_13,
        }
    }

    /// Fourth moment.
    pub fn m4(self) -> f64 {
        match self {
            Kernel::Uniform => 3.0 / 7.0,
            Kernel::Epanechnikov => 5.0 / 21.0,
            Kernel::Cone => 3.0 / 14.0,
            Kernel::Biweight => 5.0 / 33.0,
            Kernel::Gaussian => 0.142_573_121_552_892_87,
        }
    }

    /// Roughness, int K^2 dV; times the ball's volume it is the variance in units of the uniform kernel's.
    pub fn roughness(self) -> f64 {
        let relative = match self {
            Kernel::Uniform => 1.0,
            Kernel::Epanechnikov => 10.0 / 7.0,
            Kernel::Cone => 8.0 / 5.0,
            Kernel::Biweight => 70.0 / 33.0,
            Kernel::Gaussian => 2.693_198_085_847_398_3,
        };
        relative / UNIT_BALL
    }
}

/// exp(-9 u^2/2) as the eighth power of exp(-y), y = (9/16) u^2 in [0, 9/16].
///
/// Taylor's series about the middle c = 9/32 to the seventh power: the remainder is below c^8/8! = 9.7e-10,
/// eight times that after the powers, so rounding dominates. Made of products and sums only: the same bits
/// everywhere.
#[inline(always)]
fn gaussian_profiles(u2: f32x8) -> f32x8 {
    const AT_MIDDLE: f32 = 0.754_839_6; // exp(-9/32)
    let x = f32x8::splat(9.0 / 32.0) - u2 * f32x8::splat(9.0 / 16.0);
    let mut sum = f32x8::splat(AT_MIDDLE / 5040.0);
    for coefficient in [720.0, 120.0, 24.0, 6.0, 2.0, 1.0, 1.0] {
        sum = sum * x + f32x8::splat(AT_MIDDLE / coefficient);
    }
    let squared = sum * sum;
    let fourth = squared * squared;
    fourth * fourth
}
