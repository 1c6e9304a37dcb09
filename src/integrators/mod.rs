//! Integrators: the path tracer, and the march through a photon map.

mod march;
mod path;

pub use march::{StepRule, march, march_map};
pub use path::{Rays, direct_flux, fluence, radiance};
