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
pub use shoot::{Histories, Ledger, Pass, is_in, is_indirect, shoot, shoot_from};
pub use tree::PhotonTree;
