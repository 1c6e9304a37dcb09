//! What theory says, shared by the experiments: exact fields, kernels as the referee knows them, clusters of photons.

mod clusters;
mod curve;
mod fit;
mod gathers;
mod means;
mod returns;
mod slab;
mod sphere;
mod table;
mod words;

pub use clusters::{clustering, nearest_clustering};
pub use curve::{Curve, best_by_halves};
pub use fit::{exponent, exponent_of_means};
pub use gathers::{GATHER_TERMS, Gathers, NearestGather};
pub use slab::slab_fluence;
pub use sphere::sphere_fluence;
pub use table::Table;
pub use words::{UNTREATED, kernel_title, treatment_title};

use turbid::estimators::Kernel;
use turbid_analytic::kernel as referee;

/// An exact fluence at a place, such as a depth, with the bound on its error.
pub type Exact = Box<dyn Fn(f64) -> anyhow::Result<(f64, f64)> + Sync + Send>;

/// The kernel as the referee knows it.
pub fn referee_kernel(kernel: Kernel) -> referee::Kernel {
    match kernel {
        Kernel::Uniform => referee::Kernel::Uniform,
        Kernel::Epanechnikov => referee::Kernel::Epanechnikov,
        Kernel::Cone => referee::Kernel::Cone { kappa: 1.0 },
        Kernel::Biweight => referee::Kernel::Biweight,
        Kernel::Gaussian => referee::Kernel::TruncatedGaussian,
    }
}
