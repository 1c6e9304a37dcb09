//! Importance: photons go where the picture needs them.
//!
//! Importance is to the eye what power is to the lights. Three steps make a map of it:
//! 1. particles leave the camera and are counted, in the boxes of a grid, where a picture reads photons (`readout`): at
//!    the first event on their way, and, where rays of a final gathering read the maps, at the second;
//! 2. photons of a pilot score where they would be stored, as much as is read there, and every cube of a coarser grid
//!    learns, by direction and for the cone towards most of what is read, what a photon that leaves it scores on average
//!    from there on, over its weight: its *value* J. So does every cell of the lights' numbers. Each round of the pilot is
//!    directed by what the rounds before it learned (`learn`);
//! 3. emission takes each cell in proportion to its power times its value; half of the photons that an event scatters go
//!    where value times scattering is large, with the weight of both ways to choose a direction together; and the weight
//!    that a photon should have where the value is J is R/J, R the score of all emission: one that leaves an event with a
//!    weight r times as large goes on as r of them, each with its share, one with a weight r times as small goes on with
//!    probability r, its weight over r (`branching`). These are the weight windows of neutron transport (Wagner and Haghighat
//!    1998), learned, and guided directions (Vorba et al. 2014), by histogram.
//!
//! Every estimate keeps its expectation, whatever was learned: a photon's chance times its weight is unchanged. What is
//! lost is the equality of the photons' powers: where the picture reads, they are nearly equal still, and smaller by the
//! factor by which more of them come; far from there they are few and large. The ledger of powers holds on average, not
//! photon by photon.

mod branching;
mod grid;
mod learn;
mod readout;
mod settings;
mod values;

pub use branching::Branching;
pub use settings::ImportanceSettings;
pub use values::Importance;

use super::check_end;
use super::maps::Indirect;
use crate::error::{Error, Result};
use crate::scene::{Camera, Scene};
use crate::transport::Progress;
use grid::Grid;

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
        let (low, high) = readout::extent(scene, camera, settings, progress)?;
        let fine = Grid::new(low, high, 2 * settings.boxes);
        let readout = readout::read(scene, camera, indirect, fine, settings, progress)?;
        learn::learn(scene, indirect, Grid::new(low, high, settings.boxes), &readout, settings, progress)
    }
}
