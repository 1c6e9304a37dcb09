//! Russian roulette: who survives an event, and with what weight.

use crate::Spectrum;
use crate::faults::{Fault, planted, size};
use crate::rng::Stream;

/// How survival is decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roulette {
    /// Photons: survive with the probability that the albedo keeps of the summed power, so that powers stay equal.
    Analog,
    /// Paths: carry the albedo as a weight, and play only once the largest channel is below `threshold` times `led`.
    Below {
        /// What weights are compared with where no direction was learned.
        threshold: f64,
        /// What the density of a learned direction made of the weight at the last event: it falls by as much as more light is expected
        /// from there, so that such a path is no less worth following. What was led before is over: the product of all these factors has
        /// no bound, and is no guess of how much light there is.
        led: f64,
    },
}

impl Roulette {
    /// Paths that play once the largest channel is below this value.
    pub fn below(threshold: f64) -> Self {
        Roulette::Below { threshold, led: 1.0 }
    }

    /// The same game for weights of another size: a forced collision makes every weight behind it small.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Roulette::Analog => Roulette::Analog,
            Roulette::Below { threshold, led } => Roulette::Below { threshold: threshold * factor, led },
        }
    }

    /// The weight that is so many times as large as the one that paths begin to play at where no direction was learned; no finite one
    /// for photons.
    pub fn times(self, factor: f64) -> f64 {
        match self {
            Roulette::Analog => f64::INFINITY,
            Roulette::Below { threshold, .. } => threshold * factor,
        }
    }

    /// The same game behind an event whose direction multiplied the weight by this; by 1 where it was not learned.
    pub fn led(self, led: f64) -> Self {
        match self {
            Roulette::Analog => Roulette::Analog,
            Roulette::Below { threshold, .. } => Roulette::Below { threshold, led },
        }
    }

    /// The same game behind a flight whose end multiplied the weight by this, beside what the direction did.
    pub fn flown(self, factor: f64) -> Self {
        match self {
            Roulette::Analog => Roulette::Analog,
            Roulette::Below { threshold, led } => Roulette::Below { threshold, led: led * factor },
        }
    }

    /// The weight after an event that keeps `albedo` of each channel, or none if the history ends there.
    ///
    /// Analog: survival with q = sum(a_c P_c) / sum(P_c), then P_c a_c / q: the summed power is unchanged, exactly
    /// so for a grey albedo; each channel holds in expectation. Where q is above 1, as on smooth meshes, it survives with P_c a_c.
    pub fn survive(self, weight: Spectrum, albedo: Spectrum, stream: &mut Stream) -> Option<Spectrum> {
        let albedo = if planted(Fault::AlbedoTwice) { albedo * albedo } else { albedo };
        let albedo = if planted(Fault::AlbedoNever) { Spectrum::ONE } else { albedo };
        let albedo = if planted(Fault::AlbedoLowered) { albedo * (1.0 - size()) } else { albedo };
        let kept = weight * albedo;
        match self {
            Roulette::Analog if planted(Fault::NoRoulette) => Some(kept),
            Roulette::Analog if albedo.is_grey() && albedo[0] <= 1.0 => {
                (stream.unit() < albedo[0]).then_some(weight)
            }
            Roulette::Analog => {
                let q = kept.sum() / weight.sum();
                (stream.unit() < q).then(|| kept / q.min(1.0))
            }
            Roulette::Below { threshold, led } => {
                let threshold = threshold * led;
                let largest = kept.max();
                if largest == 0.0 {
                    None
                } else if largest >= threshold {
                    Some(kept)
                } else {
                    let q = largest / threshold;
                    (stream.unit() < q).then(|| kept / q)
                }
            }
        }
    }

    /// What is absorbed where a photon of this weight ends at an event that keeps `albedo` of each channel.
    ///
    /// Survivors leave with P_c a_c / q; for each channel to hold in expectation those that end, with probability
    /// 1 - q, leave P_c (1 - a_c) / (1 - q) behind. Its sum is that of the weight; for a grey albedo it is the weight.
    pub fn lost(weight: Spectrum, albedo: Spectrum) -> Spectrum {
        let lost = weight * (Spectrum::ONE - albedo);
        if albedo.is_grey() || lost.is_black() { weight } else { lost * (weight.sum() / lost.sum()) }
    }
}
