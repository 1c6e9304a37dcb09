//! The pictures that made photon mapping in fog famous, each beside a control that knows no photons.
//!
//! `gallery` renders them with the originals' numbers of photons, gives the path tracer the same CPU time, compares both
//! with a converged control, and writes a page. Makings are kept in files, so that an interrupted run goes on.

pub mod assets;
mod beside;
mod blocks;
pub mod compare;
pub mod develop;
mod dots;
pub mod keep;
pub mod light;
pub mod look;
mod makings;
mod page;
pub mod pictures;
mod plates;
pub mod predict;
pub mod recipe;
mod run;
mod settings;
mod shown;
pub mod speed;
pub mod studio;

pub use blocks::{BLOCK, Grid};
pub use run::main;
