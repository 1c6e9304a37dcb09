//! Integrators: the path tracer, the photon mapper, light tracing, and the march of a ray through media.

pub mod bidirectional;
mod emitters;
mod layers;
mod light_tracing;
pub mod mapper;
mod march;
pub mod path;

pub use layers::{Layer, Layers};
pub use light_tracing::{Splat, light_tracing};
pub use march::{Adaptive, March, StepRule, along};
pub use path::{Guides, Rays, direct_flux, fluence, radiance};
