//! The referee: exact values of light transport in fog, water and smoke, each with an absolute error bound.
//!
//! One file a problem. Every public answer is a [`Value`]: the number, a bound on its error that was earned
//! (a residual, a second rule, a count of roundings), and how it is known. Questions outside the range in which
//! the answer is known are refused by an [`Error`] that names the parameter.
//!
//! Conventions: lengths in mean free paths; a slab 0 <= t <= tau with t growing downwards from the lit face; unit
//! irradiance on that face; the signed cosine mu > 0 points up, towards the lit face.
//!
//! * Special functions and rules: [`exponential_integral`], [`quadrature`]; phase functions: [`phase`]
//! * Slab: [`slab`], by the best of [`slab_isotropic`], [`slab_anisotropic`] and [`adding_doubling`]; [`beer_lambert`],
//!   [`slab_single`]; between refracting faces [`slab_fresnel`]; by order of scattering [`orders`];
//!   of layers [`layers`]; thick [`asymptotics`]; approximations [`two_stream`]
//! * Half-space: [`half_space`]; infinite medium: [`infinite`]; X and Y functions: [`xy`]
//! * Sphere: [`sphere`], [`cavity`]; cuboid and duct: [`cuboid`], [`emitting_cube`], [`nested`]; critical bodies: [`critical`]; path lengths: [`mean_path`]
//! * Kernel density estimation: [`kernel`], [`ball_mean`], [`blur`], [`edge`], [`volumes`], [`slab_kernel`],
//!   [`nearest`], [`progressive`], [`beams`]; where the medium ends: [`boundary`]

pub mod adding_doubling;
pub mod asymptotics;
pub mod ball_mean;
pub mod beams;
pub mod beer_lambert;
pub mod blur;
pub mod boundary;
pub mod cavity;
pub mod critical;
pub mod cuboid;
pub mod edge;
pub mod emitting_cube;
pub mod error;
pub mod exponential_integral;
pub mod half_space;
pub mod incidence;
pub mod infinite;
pub mod kernel;
pub mod layers;
pub mod mean_path;
pub mod nearest;
pub mod nested;
pub mod orders;
mod panels;
mod peierls;
pub mod phase;
mod poisson;
pub mod power_series;
pub mod progressive;
pub mod quadrature;
pub mod slab;
pub mod slab_anisotropic;
pub mod slab_fresnel;
pub mod slab_isotropic;
pub mod slab_kernel;
pub mod slab_single;
pub mod sphere;
pub mod two_stream;
pub mod value;
pub mod volumes;
mod work;
pub mod xy;

pub use adding_doubling::AddingDoubling;
pub use asymptotics::Asymptotics;
pub use cavity::Cavity;
pub use critical::{Critical, CriticalShape};
pub use cuboid::{Cuboid, CuboidSource};
pub use emitting_cube::EmittingCube;
pub use error::{Error, Result};
pub use half_space::HalfSpace;
pub use incidence::Incidence;
pub use infinite::InfiniteMedium;
pub use kernel::{Dimension, Kernel};
pub use layers::{Ground, Layer, StratifiedSlab, VaryingAlbedo};
pub use nested::NestedCuboids;
pub use orders::ScatteringOrders;
pub use phase::Phase;
pub use slab::{Slab, SlabMedium, SlabOrders};
pub use slab_anisotropic::{AnisotropicMedium, AnisotropicSlab};
pub use slab_fresnel::FresnelSlab;
pub use slab_isotropic::IsotropicSlab;
pub use sphere::{Sphere, SphereSource};
pub use two_stream::TwoStream;
pub use value::Value;
pub use xy::XAndY;

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
