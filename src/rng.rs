//! Random streams: the only place where random bits become numbers.
//!
//! Histories own streams, not threads: a stream is a function of seed, purpose, replicate and history, and of
//! nothing else, so that results do not depend on the number of threads, the block size, or what is measured.

use crate::faults::{Fault, planted};
use rand::Rng;
use rand_pcg::Pcg64;
use std::ops::AddAssign;

/// What a stream is used for. Streams of different purposes are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Photon histories.
    Photons,
    /// Camera and sensor paths.
    Paths,
    /// Photon histories connected to a sensor.
    LightTracing,
    /// Points drawn from a known density.
    Synthetic,
    /// Bootstrap and other resampling.
    Resampling,
    /// Photon histories that only say how many the true ones must be.
    Pilot,
    /// Photon histories of the caustic map.
    Caustics,
    /// Particles from the camera, and the photons that learn what the picture needs.
    Importance,
    /// Histories that find out whether light comes to an end.
    Ends,
    /// Points that find out how much a medium emits.
    Emission,
    /// What photon histories score in bins, beside their walk.
    Scores,
    /// Realisations of random media.
    Mixture,
    /// Second legs of photons' planes, beside their walk.
    Planes,
    /// What photons' beams carry through media that vary, beside their walk.
    Beams,
    /// Photon histories that say where light comes from.
    Guide,
}

/// Work that a scene may or may not require, counted where it is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Stretches of a ray whose bounds were looked up.
    pub majorants: u64,
    /// Densities looked up.
    pub densities: u64,
    /// Transmittances estimated by tracking.
    pub transmittances: u64,
    /// Flights whose weights are kept channel by channel.
    pub channel_flights: u64,
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Work) {
        self.majorants += other.majorants;
        self.densities += other.densities;
        self.transmittances += other.transmittances;
        self.channel_flights += other.channel_flights;
    }
}

/// The random numbers of one history, and the work that they were drawn for.
#[derive(Debug, Clone)]
pub struct Stream {
    generator: Pcg64,
    /// Counted since the stream was made.
    pub work: Work,
}

/// Output function of SplitMix64 (Steele, Lea and Flood 2014): a bijection of 64 bits without structure.
fn mix(word: u64) -> u64 {
    let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform in [0, 1): the upper 53 bits of a word.
pub fn half_open(bits: u64) -> f64 {
    if planted(Fault::UnitReachesOne) {
        return bits as f64 / u64::MAX as f64;
    }
    (bits >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

fn open(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
}

impl Stream {
    /// The stream of one history.
    ///
    /// The four words are mixed into both state and stream of the generator: streams that differ in high bits
    /// only would be identical or correlated (`Pcg64` drops the top bit of its stream).
    pub fn new(seed: u64, purpose: Purpose, replicate: u64, history: u64) -> Self {
        let a = mix(mix(mix(mix(seed) ^ (purpose as u64)) ^ replicate) ^ history);
        let b = mix(a);
        let c = mix(b);
        let d = mix(c);
        let state = (u128::from(a) << 64) | u128::from(b);
        let stream = (u128::from(c) << 64) | u128::from(d);
        Stream { generator: Pcg64::new(state, stream), work: Work::default() }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in [0, 1): multiples of 2^-53.
    pub fn unit(&mut self) -> f64 {
        half_open(self.bits())
    }

    /// Uniform in (0, 1): odd multiples of 2^-53, so that the largest is below 1 by as much as the smallest is above 0.
    pub fn open_unit(&mut self) -> f64 {
        open(self.bits())
    }

    /// Two numbers uniform in [0, 1).
    pub fn pair(&mut self) -> [f64; 2] {
        [self.unit(), self.unit()]
    }

    /// Three numbers uniform in [0, 1).
    pub fn triple(&mut self) -> [f64; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    /// Uniform index below `count`, which is at least 1. The bias of the multiplication is below `count`/2^53.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn words_of_the_generator_stay() {
        let mut words = Pcg64::seed_from_u64(42);
        assert_eq!(words.next_u64(), 0x39fc_b970_a300_1809);
        assert_eq!(words.next_u64(), 0x3d36_1897_2c55_d911);
    }

    #[test]
    fn open_unit_excludes_both_ends() {
        assert_eq!(open(0), 0.5f64.powi(53));
        assert_eq!(open(u64::MAX), 1.0 - 0.5f64.powi(53));
    }
}
