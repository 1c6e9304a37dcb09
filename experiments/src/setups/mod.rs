//! Setups: a body of medium with its light, its power, its exact fluence where one is known, and places to ask.

mod asked;
mod body;
pub(crate) mod levels;
mod maps;
mod setup;
mod size;
pub(crate) mod uncollided;

pub use asked::asked;
pub use body::{Body, CELL, spiral};
pub use maps::Maps;
pub use setup::{FURNACE, Lighting, Setup, region};
pub use size::Size;
