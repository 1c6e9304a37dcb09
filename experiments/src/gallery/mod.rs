//! The pictures that made photon mapping in fog famous, each beside a reference that knows no photons.
//!
//! `gallery` renders them with the originals' numbers of photons, gives the path tracer the same CPU time, compares both
//! with a converged reference, and writes a page. Renders are cached in files, so that an interrupted run goes on.

pub mod assets;
mod beside;
mod blocks;
mod cache;
pub mod compare;
pub mod develop;
mod dots;
pub mod keep;
pub mod light;
pub mod lines;
pub mod look;
mod page;
pub mod pictures;
mod plates;
pub mod predict;
mod print;
pub mod recipe;
mod run;
mod settings;
mod shown;
pub mod speed;
pub mod studio;

pub use blocks::{BLOCK, Grid};
pub use run::main;
