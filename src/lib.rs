//! turbid: what does photon mapping's speed cost in accuracy, when light travels through fog, water or smoke?

pub mod error;
pub mod math;
pub mod output;
pub mod photons;
pub mod rng;
pub mod spectrum;
pub mod stats;

pub use error::{Error, Result};
pub use spectrum::Spectrum;
