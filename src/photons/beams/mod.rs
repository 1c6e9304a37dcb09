//! Beams: the flights of photons through media, the tree over them, and maps of them.

mod beam;
mod chord;
mod crossing;
mod flight;
mod group;
mod length;
mod map;
mod order;
mod tree;

pub use beam::{Beam, BeamKind};
pub use chord::Chord;
pub use crossing::Crossing;
pub(in crate::photons) use flight::{FlightBeams, MOST_CELLS};
pub use length::BeamLength;
pub use map::BeamMap;
pub(in crate::photons) use order::{Entry, kd_order};
pub use tree::BeamTree;

/// Most memory that a beam takes on its way into a map \[bytes\]: 80 as a record, twice while records are brought together, and, of
/// three pieces at most, 8 each, 28 in groups, 16 of what sorts them, 8 in order, and their part of boxes.
pub const PEAK_BYTES: f64 = 360.0;
