//! The solutions: against tables, against one another, by the laws they must obey, and for any input.
#![allow(clippy::unwrap_used, reason = "tests")]

mod any_input;
mod any_input_doubling;
mod any_input_half_space;
mod any_input_orders;
mod any_input_ordinates;
mod any_input_sphere;
mod boundary;
mod boundary_nearest;
mod boundary_points;
mod bounds;
mod critical;
mod cuboid;
mod half_space_reference;
mod layers;
mod layers_tables;
mod plates;
mod slab_anisotropic;
mod slab_fresnel;
mod slab_laws;
mod slab_radiance;
mod slab_reference;
mod slab_two_methods;
mod sphere;
mod sphere_laws;
mod support;
