//! Photons: the record, the tree over their positions, maps.

mod record;

pub use record::{Flags, Photon};
