//! Integrators: the path tracer.

mod path;

pub use path::{Rays, direct_flux, fluence, radiance};
