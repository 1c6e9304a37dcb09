//! The player against the referee: path tracer and photons against exact values, order by order and in all.

mod bins;
mod cavity;
mod cuboid;
mod emitting_sphere;
mod equiangular;
mod furnace;
mod glass;
pub mod henyey_greenstein;
mod infinite;
mod mean_path;
mod periodic;
mod phase;
mod planes;
mod radiance;
mod slab;
pub mod sphere;
pub mod sphere_fields;
mod structure;
mod surfaces;
mod varying;
