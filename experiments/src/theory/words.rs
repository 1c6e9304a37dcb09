//! What kernels and treatments are called in figures and tables; cases and claims go by the simulator's names.

use turbid::estimators::Kernel;
use turbid::estimators::boundary::Treatment;

/// What an estimate that does nothing about the end of the medium is called.
pub const UNTREATED: &str = "untreated";

/// A kernel for readers: people's names are written with a capital.
pub fn kernel_title(kernel: Kernel) -> &'static str {
    match kernel {
        Kernel::Epanechnikov => "Epanechnikov",
        Kernel::Gaussian => "Gaussian",
        Kernel::Uniform | Kernel::Cone | Kernel::Biweight => kernel.name(),
    }
}

/// A treatment for readers.
pub fn treatment_title(treatment: Treatment) -> &'static str {
    match treatment {
        Treatment::None => UNTREATED,
        Treatment::Clipped | Treatment::Reflection | Treatment::LocalLinear => treatment.name(),
    }
}
