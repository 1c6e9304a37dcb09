//! Phase functions as an estimate uses them: eight photons at a time.

use crate::math::FOUR_PI;
use crate::photons::tree::bits;
use wide::f32x8;

/// The value of a phase function [1/sr] for the pair (1-mu, 1+mu), mu the cosine between the directions of
/// travel before and after; it integrates to one over the sphere.
///
/// Any `Fn(f64, f64) -> f64` is one, evaluated photon by photon. One that can do eight at a time overrides
/// [`Directional::values`].
pub trait Directional {
    /// The value for one photon [1/sr].
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64;

    /// The values for eight photons [1/sr]; lanes outside `pairs.inside` are free.
    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let (minus, plus) = (pairs.one_minus_mu().to_array(), pairs.one_plus_mu().to_array());
        let mut values = [0.0; 8];
        for lane in bits(pairs.inside.to_bitmask()) {
            values[lane] = self.value(f64::from(minus[lane]), f64::from(plus[lane])) as f32;
        }
        f32x8::new(values)
    }
}

/// Directions of eight photons before a scattering, and the one after it.
#[derive(Debug, Clone, Copy)]
pub struct CosinePairs<'a> {
    /// Directions of travel of the photons.
    pub dir: &'a [f32x8; 3],
    /// Direction of travel after the scattering.
    pub wo: [f32; 3],
    /// The photons asked for: all bits of their lanes are set.
    pub inside: f32x8,
}

impl CosinePairs<'_> {
    /// 1-mu = |dir - wo|^2/2.
    #[inline(always)]
    pub fn one_minus_mu(&self) -> f32x8 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.dir[axis] - f32x8::splat(self.wo[axis]));
        f32x8::HALF * (x * x + y * y + z * z)
    }

    /// 1+mu = |dir + wo|^2/2.
    #[inline(always)]
    pub fn one_plus_mu(&self) -> f32x8 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.dir[axis] + f32x8::splat(self.wo[axis]));
        f32x8::HALF * (x * x + y * y + z * z)
    }
}

impl<F: Fn(f64, f64) -> f64> Directional for F {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self(one_minus_mu, one_plus_mu)
    }
}

/// The isotropic phase function, eight photons at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsotropicLanes;

impl Directional for IsotropicLanes {
    fn value(&self, _: f64, _: f64) -> f64 {
        1.0 / FOUR_PI
    }

    #[inline(always)]
    fn values(&self, _: CosinePairs<'_>) -> f32x8 {
        f32x8::splat((1.0 / FOUR_PI) as f32)
    }
}

/// The phase function of Henyey and Greenstein, eight photons at a time.
///
/// p = (1-g^2)/(4 pi d^(3/2)), d = (1-g)^2 + 2 g (1-mu) for g >= 0 and (1+g)^2 - 2 g (1+mu) for g < 0: sums
/// of non-negatives. The lanes are within a few roundings of f32 of [`Directional::value`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreensteinLanes {
    forward: bool,
    front: f64,
    square: f64,
    slope: f64,
}

impl HenyeyGreensteinLanes {
    /// The phase function of mean cosine `g`, in (-1, 1).
    pub fn new(g: crate::math::Asymmetry) -> Self {
        let g = g.get();
        let size = g.abs();
        let front = (1.0 - size) * (1.0 + size) / FOUR_PI;
        HenyeyGreensteinLanes {
            forward: g >= 0.0,
            front,
            square: (1.0 - size) * (1.0 - size),
            slope: 2.0 * size,
        }
    }
}

impl Directional for HenyeyGreensteinLanes {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let away = if self.forward { one_minus_mu } else { one_plus_mu };
        let d = self.square + self.slope * away;
        self.front / (d * d.sqrt())
    }

    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let away = if self.forward { pairs.one_minus_mu() } else { pairs.one_plus_mu() };
        let d = f32x8::splat(self.square as f32) + f32x8::splat(self.slope as f32) * away;
        f32x8::splat(self.front as f32) / (d * d.sqrt())
    }
}
