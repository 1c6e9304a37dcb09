//! Kernels: how the photons of a ball, of a disc, or the beams along a line, are weighted by their distance from its centre.

use crate::math::{exp, exp_m1, ln_1p, sin};
use glam::DVec3;
use libm::{asin, cbrt, erf};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use wide::f32x8;

/// Volume of the ball of radius 1.
pub const UNIT_BALL: f64 = 4.0 / 3.0 * PI;

/// A radial weight K(u), u the distance over the radius; zero beyond u = 1.
///
/// K integrates to one over the unit ball of three dimensions, so the kernel of radius r is K(u)/r^3; the same profile,
/// normalised over the disc of two, is that of estimates on surfaces, K(u)/r^2, and over the line of one that of beams across a ray, K(u)/r. The moments are m_j = int u^j K dV and the
/// roughness is int K^2 dV. Kernels are compared at equal standard deviation a coordinate, r sqrt(m2/3).
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

/// What is known of a kernel in closed form; profiles apart, a kernel is a row of these.
struct Closed {
    name: &'static str,
    /// K at the centre, second and fourth moment, and roughness times the volume of the ball.
    ball: [f64; 4],
    /// K at the centre, second moment, and roughness times the area of the disc.
    disc: [f64; 3],
    /// int_0^u 4 pi s^2 K ds.
    within: fn(f64) -> f64,
    /// int_u^1 4 pi s K ds.
    across: fn(f64) -> f64,
    /// int_0^sqrt(w) s profile(s^2) ds over w.
    wedge: fn(f64) -> f64,
    /// int_0^u 2 pi s K ds on the disc.
    within_disc: fn(f64) -> f64,
    /// Its inverse.
    sample_disc: fn(f64) -> f64,
    /// K at the centre of the line.
    line_peak: f64,
    /// int_-u^u K ds on the line.
    within_line: fn(f64) -> f64,
}

/// (1 - u) (1 + u).
fn rest(u: f64) -> f64 {
    (1.0 - u) * (1.0 + u)
}

const UNIFORM: Closed = Closed {
    name: "uniform",
    ball: [3.0 / (4.0 * PI), 3.0 / 5.0, 3.0 / 7.0, 1.0],
    disc: [1.0 / PI, 1.0 / 2.0, 1.0],
    within: |u| u * (u * u),
    across: |u| 1.5 * rest(u),
    wedge: |_| 0.5,
    within_disc: |u| u * u,
    sample_disc: f64::sqrt,
    line_peak: 0.5,
    within_line: |u| u,
};

const EPANECHNIKOV: Closed = Closed {
    name: "epanechnikov",
    ball: [15.0 / (8.0 * PI), 3.0 / 7.0, 5.0 / 21.0, 10.0 / 7.0],
    disc: [2.0 / PI, 1.0 / 3.0, 4.0 / 3.0],
    within: |u| 0.5 * (u * (u * u)) * (5.0 - 3.0 * (u * u)),
    across: |u| 1.875 * rest(u) * rest(u),
    wedge: |w| 0.5 - 0.25 * w,
    within_disc: |u| u * u * (2.0 - u * u),
    sample_disc: |part| (1.0 - (1.0 - part).sqrt()).sqrt(),
    line_peak: 0.75,
    within_line: |u| 0.5 * u * (3.0 - u * u),
};

const CONE: Closed = Closed {
    name: "cone",
    ball: [3.0 / PI, 2.0 / 5.0, 3.0 / 14.0, 8.0 / 5.0],
    disc: [3.0 / PI, 3.0 / 10.0, 3.0 / 2.0],
    within: |u| u * (u * u) * (4.0 - 3.0 * u),
    across: |u| 2.0 * (1.0 - u) * (1.0 - u) * (1.0 + 2.0 * u),
    wedge: |w| 0.5 - w.sqrt() / 3.0,
    within_disc: |u| u * u * (3.0 - 2.0 * u),
    sample_disc: |part| 0.5 - sin(asin(1.0 - 2.0 * part) / 3.0),
    line_peak: 1.0,
    within_line: |u| u * (2.0 - u),
};

const BIWEIGHT: Closed = Closed {
    name: "biweight",
    ball: [105.0 / (32.0 * PI), 1.0 / 3.0, 5.0 / 33.0, 70.0 / 33.0],
    disc: [3.0 / PI, 1.0 / 4.0, 9.0 / 5.0],
    within: |u| 0.125 * (u * (u * u)) * (35.0 - 42.0 * (u * u) + 15.0 * (u * u) * (u * u)),
    across: |u| 2.1875 * rest(u) * rest(u) * rest(u),
    wedge: |w| 0.5 - w * (0.5 - w / 6.0),
    within_disc: |u| 1.0 - rest(u) * rest(u) * rest(u),
    sample_disc: |part| (1.0 - cbrt(1.0 - part)).sqrt(),
    line_peak: 15.0 / 16.0,
    within_line: |u| 0.125 * u * (15.0 - u * u * (10.0 - 3.0 * u * u)),
};

/// The Gaussian's exponent at the edge: exp(-a u^2) with a = 1/(2 s^2), s = 1/3.
const A: f64 = 4.5;

/// In the ball K is 1/(4 pi I2) at the centre, I2 = int_0^1 u^2 exp(-a u^2) du = sqrt(pi) erf(sqrt a)/(4 a^(3/2)) -
/// exp(-a)/(2 a); its moments follow by parts from the same integral. On the disc it is a/(pi (1 - e^-a)), the second moment
/// 1/a - e^-a/(1 - e^-a) and the roughness (a/2) (1 + e^-a)/(1 - e^-a); on the line K is
/// sqrt(a/pi)/erf(sqrt a) at the centre.
const GAUSSIAN: Closed = Closed {
    name: "gaussian",
    ball: [
        1.766_057_561_883_723_7,
        0.305_939_863_855_431_13,
        0.142_573_121_552_892_87,
        2.693_198_085_847_398_3,
    ],
    disc: [1.448_485_710_571_490_1, 0.210_988_429_519_736_65, 2.300_552_067_161_184_8],
    within: |u| {
        // The closed form is a difference, of which nothing is left where u is small.
        if u < 0.01 {
            let x = A * (u * u);
            let sum = 1.0 / 3.0 - x * (1.0 / 5.0 - x * (1.0 / 14.0 - x / 54.0));
            return 4.0 * PI * GAUSSIAN.ball[0] * (u * (u * u)) * sum;
        }
        let whole = PI.sqrt() * erf(A.sqrt() * u) / (4.0 * A * A.sqrt());
        4.0 * PI * GAUSSIAN.ball[0] * (whole - u * exp(-A * (u * u)) / 9.0)
    },
    across: |u| -4.0 / 9.0 * PI * GAUSSIAN.ball[0] * exp(-A * u * u) * exp_m1(-A * rest(u)),
    wedge: |w| if w == 0.0 { 0.5 } else { -exp_m1(-A * w) / (9.0 * w) },
    within_disc: |u| exp_m1(-A * u * u) / exp_m1(-A),
    sample_disc: |part| (-ln_1p(part * exp_m1(-A)) / A).sqrt(),
    line_peak: 1.200_066_776_763_854_4,
    within_line: |u| erf(A.sqrt() * u) / erf(A.sqrt()),
};

impl Kernel {
    /// Every kernel.
    pub const ALL: [Kernel; 5] =
        [Kernel::Uniform, Kernel::Epanechnikov, Kernel::Cone, Kernel::Biweight, Kernel::Gaussian];

    #[inline(always)]
    fn closed(self) -> &'static Closed {
        match self {
            Kernel::Uniform => &UNIFORM,
            Kernel::Epanechnikov => &EPANECHNIKOV,
            Kernel::Cone => &CONE,
            Kernel::Biweight => &BIWEIGHT,
            Kernel::Gaussian => &GAUSSIAN,
        }
    }

    /// K over its peak, from u^2 in [0, 1].
    pub fn profile(self, u2: f64) -> f64 {
        match self {
            Kernel::Uniform => 1.0,
            Kernel::Epanechnikov => 1.0 - u2,
            Kernel::Cone => 1.0 - u2.sqrt(),
            Kernel::Biweight => (1.0 - u2) * (1.0 - u2),
            Kernel::Gaussian => exp(-A * u2),
        }
    }

    /// K at a vector over the radius, 0 beyond its ball.
    pub fn at(self, away: DVec3) -> f64 {
        let u2 = away.length_squared();
        if u2 <= 1.0 { self.peak() * self.profile(u2) } else { 0.0 }
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

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        self.closed().name
    }

    /// The kernel of this name.
    pub fn named(name: &str) -> Option<Kernel> {
        Kernel::ALL.into_iter().find(|kernel| kernel.name() == name)
    }

    /// K at the centre of the ball, where every profile is 1: what makes its integral one.
    pub fn peak(self) -> f64 {
        self.closed().ball[0]
    }

    /// Second moment.
    pub fn m2(self) -> f64 {
        self.closed().ball[1]
    }

    /// Fourth moment.
    pub fn m4(self) -> f64 {
        self.closed().ball[2]
    }

    /// Roughness, int K^2 dV; times the ball's volume it is the variance in units of the uniform kernel's.
    pub fn roughness(self) -> f64 {
        self.closed().ball[3] / UNIT_BALL
    }

    /// K at the centre of the disc.
    pub fn disc_peak(self) -> f64 {
        self.closed().disc[0]
    }

    /// Second moment on the disc, int u^2 K dA.
    pub fn disc_m2(self) -> f64 {
        self.closed().disc[1]
    }

    /// Roughness on the disc, int K^2 dA, times its area: the variance in units of the uniform kernel's.
    pub fn disc_roughness(self) -> f64 {
        self.closed().disc[2]
    }

    /// Part of the kernel within u, in [0, 1], of its centre: int_0^u 4 pi s^2 K ds.
    pub fn within(self, u: f64) -> f64 {
        (self.closed().within)(u)
    }

    /// Part of the kernel beyond a plane at distance u of its centre, above 0: half of int_u^1 4 pi s^2 K (1 - u/s) ds, the
    /// caps that the plane cuts from spheres about the centre.
    pub fn beyond_plane(self, u: f64) -> f64 {
        if u >= 1.0 {
            return 0.0;
        }
        (0.5 * (1.0 - self.within(u) - u * (self.closed().across)(u))).max(0.0)
    }

    /// The integral of the disc's K over a wedge of one radian out to sqrt(w), over w.
    pub(super) fn wedge(self, w: f64) -> f64 {
        self.disc_peak() * (self.closed().wedge)(w)
    }

    /// Part of the disc's kernel within u, in [0, 1], of its centre: int_0^u 2 pi s K ds.
    pub fn within_disc(self, u: f64) -> f64 {
        (self.closed().within_disc)(u)
    }

    /// K at the centre of the line, on which it integrates to one from -1 to 1.
    pub fn line_peak(self) -> f64 {
        self.closed().line_peak
    }

    /// Part of the line's kernel within u, in [0, 1], of its centre: int_-u^u K ds.
    pub fn within_line(self, u: f64) -> f64 {
        (self.closed().within_line)(u)
    }

    /// Distance from the middle, over the radius, of a point of the disc of density K, from a number in [0, 1).
    pub fn sample_disc(self, part: f64) -> f64 {
        (self.closed().sample_disc)(part)
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
