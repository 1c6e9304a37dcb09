//! Importance: photons go where the picture needs them.
//!
//! Importance is to the eye what power is to the lights. Three steps make a map of it:
//! 1. particles leave the camera and are counted, in the boxes of a grid, where a picture reads photons (`reading`): at
//!    the first event on their way, and, where rays of a final gathering read the maps, at the second;
//! 2. photons of a pilot score where they would be stored, as much as is read there, and every cube of a coarser grid
//!    learns, by direction and for the cone towards most of what is read, what a photon that leaves it scores on average
//!    from there on, over its weight: its *value* J. So does every cell of the lights' numbers. Each round of the pilot is
//!    steered by what the rounds before it learned (`learn`);
//! 3. emission takes each cell in proportion to its power times its value; half of the photons that an event scatters go
//!    where value times scattering is large, with the weight of both ways to choose a direction together; and the weight
//!    that a photon should have where the value is J is R/J, R the score of all emission: one that leaves an event with a
//!    weight r times as large goes on as r of them, each with its share, one with a weight r times as small goes on with
//!    probability r, its weight over r (`steer`). These are the weight windows of neutron transport (Wagner and Haghighat
//!    1998), learned, and steered directions (Vorba et al. 2014), by histogram.
//!
//! Every estimate keeps its expectation, whatever was learned: a photon's chance times its weight is unchanged. What is
//! lost is the equality of the photons' powers: where the picture reads, they are nearly equal still, and smaller by the
//! factor by which more of them come; far from there they are few and large. The ledger of powers holds on average, not
//! photon by photon.

mod grid;
mod learn;
mod reading;
mod steer;

pub use steer::{Branching, window};

use super::maps::Indirect;
use super::{Emitter, check_end};
use crate::error::{Error, Result};
use crate::rng::{Purpose, Stream};
use crate::scene::{Camera, Scene};
use crate::transport::Progress;
use grid::{Aim, DIRECTIONS, Grid};

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
    fn stream(&self, stage: Stage, history: u64) -> Stream {
        let stage = match stage {
            Stage::Reading => 0,
            Stage::Round(number) => 1 + number,
            Stage::Extent => u64::MAX,
        };
        Stream::new(self.seed, Purpose::Importance, self.replicate << 16 ^ stage, history)
    }
}

/// What is learned by histories of its own.
#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Where the camera looks.
    Extent,
    /// Where the picture reads photons.
    Reading,
    /// A round of the pilot.
    Round(u64),
}

impl Default for ImportanceSettings {
    /// Enough to find a corner that one photon in a thousand comes to.
    fn default() -> Self {
        ImportanceSettings { particles: 1 << 16, pilot: 1 << 15, rounds: 4, boxes: 12, seed: 1, replicate: 0 }
    }
}

/// The importance map of a scene and its camera: how photons leave the lights, and what they are worth where.
#[derive(Debug, Clone)]
pub struct Importance {
    grid: Grid,
    aim: Aim,
    /// By box and direction: what a photon that leaves it scores, over its weight; never 0.
    values: Vec<f64>,
    /// What a whole emission scores \[W\].
    response: f64,
    emitter: Emitter,
}

impl Importance {
    /// Learns the importance of a scene to a camera.
    ///
    /// # Errors
    /// [`Error::Scene`] for a scene without bounds, or a camera that sees no place where photons are
    /// read or come to; [`Error::Cancelled`].
    pub fn of(
        scene: &Scene,
        camera: &Camera,
        indirect: Indirect,
        settings: &ImportanceSettings,
        progress: &dyn Progress,
    ) -> Result<Self> {
        if scene.bounds().is_none() {
            return Err(Error::Scene("importance needs a scene with bounds, without unbounded slab".into()));
        }
        check_end(scene)?;
        let (low, high) = reading::extent(scene, camera, settings, progress)?;
        let fine = Grid::new(low, high, 2 * settings.boxes);
        let reading = reading::read(scene, camera, indirect, fine, settings, progress)?;
        learn::learn(scene, indirect, Grid::new(low, high, settings.boxes), &reading, settings, progress)
    }

    /// How photons leave the lights.
    pub fn emitter(&self) -> &Emitter {
        &self.emitter
    }

    /// Values of the directions in which a photon may leave `p`.
    fn values_at(&self, p: glam::DVec3) -> &[f64] {
        let start = self.grid.index(p) * DIRECTIONS;
        &self.values[start..start + DIRECTIONS]
    }
}
