//! How a slab is solved.

use clap::ValueEnum;

/// How a slab is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Isotropic: Peierls, above a thickness of 2 the better known of both, above 400 ordinates; others: ordinates.
    Auto,
    /// The Peierls equation (isotropic scattering).
    Peierls,
    /// Discrete ordinates.
    Ordinates,
    /// Adding and doubling, the second method of all slabs (thickness up to 100).
    Doubling,
}
