//! turbid: what does photon mapping's speed cost in accuracy, when light travels through fog, water or smoke?
//!
//! By meaning, from the bottom up: [`math`], [`spectrum`], [`rng`] and [`stats`] know no light; [`phase`],
//! [`medium`], [`surface`], [`light`] and [`geometry`] are what a [`scene`] is made of; [`transport`] is the random
//! walk that paths and photons share; [`photons`] keeps what it meets, in [`photons::maps`] for pictures;
//! [`estimators`] read it; [`integrators`] make radiance by class of path: the path tracer [`integrators::path`] and the
//! photon mapper [`integrators::mapper`]; [`sensor`] turns both into numbers with standard errors, and into pictures on a
//! [`sensor::Film`]; [`input`] reads files of a bounded size, [`memory`] says what is free; [`output`] writes files that appear whole or not at all.

pub mod error;
pub mod estimators;
pub mod faults;
pub mod geometry;
pub mod input;
pub mod integrators;
pub mod light;
pub mod math;
pub mod medium;
pub mod memory;
pub mod output;
pub mod phase;
pub mod photons;
pub mod rng;
pub mod scene;
pub mod sensor;
pub mod spectrum;
pub mod stats;
pub mod surface;
pub mod transport;

pub use error::{Error, Result};
pub use spectrum::Spectrum;
