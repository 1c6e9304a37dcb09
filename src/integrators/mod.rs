//! Integrators: the path tracer, the photon mapper, and the march through a photon map.

mod layers;
pub mod mapper;
mod march;
pub mod path;

pub use layers::{Layer, Layers};
pub use march::{StepRule, march, march_map};
pub use path::{Rays, direct_flux, fluence, radiance};
