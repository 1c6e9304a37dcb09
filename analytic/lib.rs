//! The referee: exact values of light transport in fog, water and smoke, each with an absolute error bound.
//!
//! One file a problem. Every public answer is a [`Value`]: the number, a bound on its error that was earned
//! (a residual, a second rule, a count of roundings), and how it is known. Questions outside the range in which
//! the answer is known are refused by an [`Error`] that names the parameter.
//!
//! Conventions: lengths in mean free paths; a slab 0 <= t <= tau with t growing downwards from the lit face; unit
//! irradiance on that face; the signed cosine mu > 0 points up, towards the lit face.
//!
//! * Special functions and rules: [`exponential_integral`], [`quadrature`]
//! * Phase functions: [`phase`]
//! * Slab: [`beer_lambert`], [`slab_single`], [`slab_isotropic`], [`slab_anisotropic`]
//! * Half-space: [`half_space`]; infinite medium: [`infinite`]
//! * Sphere: [`sphere`] (uniform, central and incident light; the absorbing sphere), [`cavity`]
//! * Any convex body: [`mean_path`]; bodies that sustain themselves: [`critical`]
//! * Kernel density estimation: [`kernel`], [`ball_mean`], [`blur`], [`edge`], [`volumes`], [`slab_kernel`],
//!   [`nearest`], [`progressive`]; where the medium ends: [`boundary`]

pub mod ball_mean;
pub mod beer_lambert;
pub mod blur;
pub mod boundary;
pub mod cavity;
pub mod critical;
pub mod edge;
pub mod error;
pub mod exponential_integral;
pub mod half_space;
pub mod incidence;
pub mod infinite;
pub mod kernel;
pub mod mean_path;
pub mod nearest;
mod peierls;
pub mod phase;
mod poisson;
pub mod progressive;
pub mod quadrature;
pub mod slab_anisotropic;
pub mod slab_isotropic;
pub mod slab_kernel;
pub mod slab_single;
pub mod sphere;
pub mod value;
pub mod volumes;

pub use cavity::Cavity;
pub use critical::{Critical, CriticalShape};
pub use error::{Error, Result};
pub use half_space::HalfSpace;
pub use incidence::Incidence;
pub use infinite::InfiniteMedium;
pub use kernel::{Dimension, Kernel};
pub use phase::Phase;
pub use slab_anisotropic::{AnisotropicMedium, AnisotropicSlab};
pub use slab_isotropic::IsotropicSlab;
pub use sphere::{Sphere, SphereSource};
pub use value::Value;

/// The same cases on every run, and no files left behind.
#[cfg(test)]
pub(crate) fn fixed_cases(cases: u32) -> proptest::prelude::ProptestConfig {
    proptest::prelude::ProptestConfig {
        cases,
        rng_seed: proptest::test_runner::RngSeed::Fixed(20_260_101),
        failure_persistence: None,
        ..Default::default()
    }
}
