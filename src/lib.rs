//! turbid: what does photon mapping's speed cost in accuracy, when light travels through fog, water or smoke?

pub mod error;
pub mod estimators;
pub mod math;
pub mod photons;
pub mod rng;
pub mod spectrum;

pub use error::{Error, Result};
pub use spectrum::Spectrum;
