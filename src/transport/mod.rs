//! Free flight, roulette, weight windows, learned directions and distances, the one random walk that paths and photons share, and blocks of histories.

mod blocks;
mod bounce;
mod brightness;
mod emission;
mod equal_angles;
mod flags;
mod flight;
mod lobe;
mod roulette;
mod track;
mod transmittance;
mod visitor;
mod walk;
mod windows;

pub use blocks::{BLOCK, NoProgress, Progress, blocks_at_once, in_parallel, run_blocks, run_blocks_of};
pub use brightness::{Brightness, BrightnessGrid, CELLS, Ends};
pub use emission::{collected, emission};
pub use equal_angles::{Distances, EqualAngles, span};
pub use flags::Flags;
pub(crate) use flight::flight_by_stretch;
pub use flight::{Flight, free_flight};
pub use lobe::Lobe;
pub use roulette::Roulette;
pub(crate) use track::steps;
pub use transmittance::{Passage, connection, segment_transmittance, transmittance};
pub use visitor::{Arrival, Step, Visitor, Walker};
pub use walk::{LONG, walk};
pub use windows::{WeightWindows, Windowed, window};
