//! Photon estimates where the medium ends: balls cut by a face, four treatments, and false photons behind walls.
//!
//! An estimate with a kernel K_r about a probe x expects int_O W(y) f(y) dy over the medium O, W the treatment's weight
//! of a photon at y. All of it follows from the field on the spheres about the probe (and about its mirror images),
//! as far as they lie inside: A(s) = s^2 int f(x + s w) dw. Any kernel, radius and number of neighbours is then a
//! one-dimensional integral over s.

mod body;
mod false_photons;
mod nearest;
mod profile;
mod rule;
mod shell;
mod treated;
mod variance;

pub use body::Body;
pub use false_photons::{Rejection, false_photon_mean, nearest_false_photon_mean};
pub use nearest::{nearest_treated_mean, nearest_treated_mean_symmetric, nearest_treated_mean_uniform};
pub use treated::{Treatment, body_moment, treated_mean, treated_mean_symmetric, treated_mean_uniform};
pub use variance::treated_variance;
