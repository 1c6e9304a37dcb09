//! Integrators: the path tracer, the photon mapper, light tracing, and the march through a photon map.

mod layers;
mod light_tracing;
pub mod mapper;
mod march;
pub mod path;

pub use layers::{Layer, Layers};
pub use light_tracing::{Splat, light_tracing};
pub use march::{StepRule, march, march_map};
pub use path::{Rays, direct_flux, fluence, radiance};
