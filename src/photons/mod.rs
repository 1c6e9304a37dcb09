//! Photons: the record, shooting, the folded cell, the tree over their positions, maps.

mod emit;
mod ends;
pub mod fold;
pub mod importance;
mod map;
pub mod maps;
mod record;
mod shoot;
pub mod synthetic;
pub mod tree;

pub use crate::transport::Flags;
pub use emit::Emitter;
pub use ends::{MOST_EVENTS, check_end};
pub use map::PhotonMap;
pub use record::Photon;
pub(crate) use shoot::shoot_blocks;
pub use shoot::{Histories, Ledger, Pass, is_in, is_indirect, shoot, shoot_from};
pub use tree::PhotonTree;

/// Most memory that a stored photon takes on its way into a map \[bytes\]: 56 as a record, and beside it what is larger, the
/// record in the one vector of all ([`joined`]), or its entry of the order and its place in the tree, 16 and 42.
/// Measured: see `tests/cli/memory.rs`.
pub const PEAK_BYTES: f64 = 115.0;
