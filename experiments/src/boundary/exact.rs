//! What the referee says of a uniform field.

use turbid::estimators::boundary::Treatment;
use turbid_analytic::boundary::{self as referee, Body, treated_mean_uniform};
use turbid_analytic::kernel::Kernel;

/// The treatment as the referee knows it.
pub fn referee(treatment: Treatment) -> referee::Treatment {
    match treatment {
        Treatment::None => referee::Treatment::None,
        Treatment::Clipped => referee::Treatment::Clipped,
        Treatment::Reflection => referee::Treatment::Reflection,
        Treatment::LocalLinear => referee::Treatment::LocalLinear,
    }
}

/// The exact mean over a uniform field of 1, and its bound.
pub fn uniform_mean(
    treatment: referee::Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
) -> anyhow::Result<(f64, f64)> {
    let mean = treated_mean_uniform(treatment, kernel, body, at, radius)?;
    Ok((mean.value, mean.error))
}
