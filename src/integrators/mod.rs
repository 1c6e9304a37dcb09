//! Integrators: the path tracer.

mod path;

pub use path::{direct_flux, fluence, radiance};
