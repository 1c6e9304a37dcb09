//! How importance is learned.

use crate::rng::{Purpose, Stream};

/// How importance is learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImportanceSettings {
    /// Particles from the camera.
    pub particles: u64,
    /// Photon histories of each round of the pilot.
    pub pilot: u64,
    /// Rounds of the pilot.
    pub rounds: u64,
    /// Cubes of the grid of values along the longest edge of the scene; that of what is read has twice as many.
    pub boxes: usize,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
}

impl ImportanceSettings {
    /// The random numbers of one history of a stage; there are fewer than 65,535 rounds.
    pub(super) fn stream(&self, stage: Stage, history: u64) -> Stream {
        let stage = match stage {
            Stage::Readout => 0,
            Stage::Round(number) => 1 + number,
            Stage::Extent => u64::MAX,
        };
        Stream::new(self.seed, Purpose::Importance, self.replicate << 16 ^ stage, history)
    }
}

/// What is learned by histories of its own.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stage {
    /// Where the camera looks.
    Extent,
    /// Where the picture reads photons.
    Readout,
    /// A round of the pilot.
    Round(u64),
}

impl Default for ImportanceSettings {
    /// Enough to find a corner that one photon in a thousand comes to.
    fn default() -> Self {
        ImportanceSettings { particles: 1 << 16, pilot: 1 << 15, rounds: 4, boxes: 12, seed: 1, replicate: 0 }
    }
}
