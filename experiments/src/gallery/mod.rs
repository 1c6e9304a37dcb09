//! The pictures that made photon mapping in fog famous, each beside a twin that knows no photons.

pub mod assets;
mod blocks;
pub mod compare;
pub mod develop;

pub use blocks::{BLOCK, Grid};
