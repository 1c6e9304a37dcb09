//! Photons: the record, shooting, the folded cell, the tree over their positions, maps.

pub mod fold;
mod record;
mod shoot;

pub use record::{Flags, Photon};
pub use shoot::{Histories, Ledger, Pass, is_in, is_indirect, shoot};
