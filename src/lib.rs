//! turbid: what does photon mapping's speed cost in accuracy, when light travels through fog, water or smoke?

pub mod error;
pub mod math;
pub mod photons;
pub mod rng;
pub mod spectrum;
pub mod stats;

pub use error::{Error, Result};
pub use spectrum::Spectrum;
pub mod geometry;
pub mod integrators;
pub mod light;
pub mod medium;
pub mod phase;
pub mod scene;
pub mod surface;
pub mod transport;
