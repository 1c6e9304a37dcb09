//! Photons: the record, the pass that stores them, the periodic cell, the tree over their positions, maps, and files of them.

pub mod beams;
mod emit;
mod ends;
pub mod file;
pub mod importance;
mod map;
pub mod maps;
mod pass;
pub mod periodic;
pub mod planes;
mod record;
pub mod synthetic;
mod tallies;
pub mod tree;

pub use crate::transport::Flags;
pub use emit::Emitter;
pub(crate) use emit::from_light;
pub use ends::{MOST_EVENTS, check_end};
pub use map::PhotonMap;
pub use pass::{Ends, Histories, Ledger, Part, Pass, PassReport, Run, Storage, is_in, is_indirect, shoot};
pub use record::{Photon, Photons};
pub use tallies::Scores;
pub(crate) use tallies::score_bytes;
pub use tree::PhotonTree;

/// Most memory that a stored photon takes on its way into a map \[bytes\]: 64 as a record until the tree is complete, beside
/// its place in the tree, 42 in a medium and 54 on a surface, and its number, 4; before, its entry of the order and what sorts it take 40. The allocator
/// loses up to a tenth between the blocks of a pass. Measured: see `tests/cli/memory.rs`.
pub const PEAK_BYTES: f64 = 134.0;

/// Time that a stored photon takes on its way into the tree, of one processor \[s\]: measured with 2.8 x 10^6 of them. It is for
/// what users are told of a run beforehand, and no more.
pub(crate) const BUILD_SECONDS: f64 = 0.6e-6;
