//! The pictures that made photon mapping in fog famous, each beside a twin that knows no photons.

mod blocks;
pub mod compare;

pub use blocks::{BLOCK, Grid};
