//! Phase functions as an estimate uses them: eight photons at a time.

use crate::math::FOUR_PI;
use crate::phase::{
    HenyeyGreenstein, Isotropic, Legendre, Phase, PhaseFunction, Rayleigh, Schlick, Tabulated, TwoTerm,
};
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

impl Directional for Isotropic {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    #[inline(always)]
    fn values(&self, _: CosinePairs<'_>) -> f32x8 {
        f32x8::splat((1.0 / FOUR_PI) as f32)
    }
}

impl Directional for HenyeyGreenstein {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    /// p = (1-g^2)/(4 pi d^(3/2)), d = (1-|g|)^2 + 2 |g| (1-mu), mu towards the peak: sums of non-negatives, within a
    /// few roundings of f32 of [`Directional::value`].
    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let g = self.g();
        let size = g.abs();
        let front = (1.0 - size) * (1.0 + size) / FOUR_PI;
        let away = if g >= 0.0 { pairs.one_minus_mu() } else { pairs.one_plus_mu() };
        let square = (1.0 - size) * (1.0 - size);
        let d = f32x8::splat(square as f32) + f32x8::splat((2.0 * size) as f32) * away;
        f32x8::splat(front as f32) / (d * d.sqrt())
    }
}

impl Directional for TwoTerm {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let [(a, first), (b, second)] = self.terms();
        f32x8::splat(a as f32) * first.values(pairs) + f32x8::splat(b as f32) * second.values(pairs)
    }
}

impl Directional for Schlick {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    /// p = (1-k^2)/(4 pi d^2), d = (1-|k|) + |k| (1-mu), mu towards the peak.
    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let size = self.k().abs();
        let away = if self.k() >= 0.0 { pairs.one_minus_mu() } else { pairs.one_plus_mu() };
        let d = f32x8::splat((1.0 - size) as f32) + f32x8::splat(size as f32) * away;
        f32x8::splat(((1.0 - size) * (1.0 + size) / FOUR_PI) as f32) / (d * d)
    }
}

impl Directional for Rayleigh {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        let mu = f32x8::HALF * (pairs.one_plus_mu() - pairs.one_minus_mu());
        f32x8::splat((0.75 / FOUR_PI) as f32) * (f32x8::ONE + mu * mu)
    }
}

impl Directional for Tabulated {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }
}

impl Directional for Legendre {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }
}

impl Directional for Phase {
    fn value(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        self.eval(one_minus_mu, one_plus_mu)
    }

    #[inline(always)]
    fn values(&self, pairs: CosinePairs<'_>) -> f32x8 {
        match self {
            Phase::Isotropic(phase) => phase.values(pairs),
            Phase::HenyeyGreenstein(phase) => phase.values(pairs),
            Phase::TwoTerm(phase) => phase.values(pairs),
            Phase::Schlick(phase) => phase.values(pairs),
            Phase::Rayleigh(phase) => phase.values(pairs),
            Phase::Tabulated(phase) => phase.values(pairs),
            Phase::Legendre(phase) => phase.values(pairs),
        }
    }
}
