//! Photons: the record, the tree over their positions, maps.

mod map;
mod record;
pub mod synthetic;
pub mod tree;

pub use map::PhotonMap;
pub use record::{Flags, Photon};
pub use tree::PhotonTree;
