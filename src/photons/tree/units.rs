//! The tree's own unit of length: a power of two, about half the map's box.

use crate::error::{Error, Result};
use crate::photons::Photons;
use glam::DVec3;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Distances beyond this many units see the whole map as one point, and distances below its inverse are not
/// told apart from zero: squares of both stay far inside the range of f32 (2^-126 to 2^127).
pub(super) const LIMIT: f64 = (1u64 << 60) as f64;

/// Where the map's box is and how large: positions relative to its centre lie in [-1, 1].
///
/// The unit is a power of two, so a map scaled by a power of two has the same relative positions, bit for
/// bit.
#[derive(Debug, Clone, Copy)]
pub(in crate::photons) struct Units {
    origin: DVec3,
    extent: f64,
    exponent: i32,
    scale: f64,
}

impl Units {
    /// The units of the box of all photons, which must be finite in every part.
    pub(super) fn of(parts: &[Photons], is_parallel: bool) -> Result<Self> {
        let of_part = |part: &Photons| {
            let nowhere = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let widened = |(lower, upper): (DVec3, DVec3), p: &DVec3| (lower.min(*p), upper.max(*p));
            let (lower, upper) = part.positions.iter().fold(nowhere, widened);
            (lower, upper, part.non_finite())
        };
        let joined = |(lower, upper, count): (DVec3, DVec3, u64), other: (DVec3, DVec3, u64)| {
            (lower.min(other.0), upper.max(other.1), count + other.2)
        };
        let filled: Vec<&Photons> = parts.iter().filter(|part| !part.is_empty()).collect();
        let of_all = match is_parallel {
            true => filled.into_par_iter().map(of_part).reduce_with(joined),
            false => filled.into_iter().map(of_part).reduce(joined),
        };
        match of_all {
            None => Ok(Units::new(DVec3::ZERO, DVec3::ZERO)),
            Some((lower, upper, 0)) => Ok(Units::new(lower, upper)),
            Some((_, _, count)) => Err(Error::NonFinite { count, place: "stored photons" }),
        }
    }

    /// The units of the box from `lower` to `upper`.
    pub(in crate::photons) fn new(lower: DVec3, upper: DVec3) -> Self {
        // Halved before they are added or subtracted: the largest finite box does not overflow.
        let origin = lower * 0.5 + upper * 0.5;
        let half = (upper * 0.5 - lower * 0.5).max_element();
        // A box without extent has no length of its own; its distance from zero serves.
        let size = if half > 0.0 { half } else { lower.abs().max_element() };
        let exponent = libm::frexp(size).1.max(-1022);
        Units { origin, extent: half, exponent, scale: libm::ldexp(1.0, -exponent) }
    }

    /// Half the longest edge of the box \[L\]; 0 of a single place.
    pub(super) fn extent(&self) -> f64 {
        self.extent
    }

    /// A point relative to the centre of the box, in units.
    pub(in crate::photons) fn relative(&self, point: DVec3) -> DVec3 {
        (point - self.origin) * self.scale
    }

    /// The place of a stored position.
    pub(super) fn absolute(&self, [x, y, z]: [f32; 3]) -> DVec3 {
        let length = |c: f32| libm::ldexp(f64::from(c), self.exponent);
        self.origin + DVec3::new(length(x), length(y), length(z))
    }

    /// A length in units.
    pub(in crate::photons) fn shrink(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// A length given in units.
    pub(super) fn stretch(&self, units: f64) -> f64 {
        libm::ldexp(units, self.exponent)
    }
}
