//! The exact fluence of a slab, quick to ask at any depth.

use super::{Exact, Table};
use turbid_analytic::slab_anisotropic::AnisotropicSlab;
use turbid_analytic::{Incidence, IsotropicSlab};

/// What tabulation adds to the error of a fluence, tested in `table`.
const TABULATED: f64 = 1e-9;

/// The exact fluence of all orders against depth, per unit irradiance on the face at depth 0.
pub fn slab_fluence(tau: f64, albedo: f64, g: f64, incidence: Incidence) -> anyhow::Result<Exact> {
    if g == 0.0 {
        let slab = IsotropicSlab::new(tau, albedo, incidence)?;
        return Ok(Box::new(move |t| {
            slab.fluence_interpolated(t).map(|v| (v.value, v.error)).map_err(Into::into)
        }));
    }
    let slab = AnisotropicSlab::new(tau, albedo, g, incidence)?;
    // Modes are summed once a table point, not once a question.
    let largest = std::cell::Cell::new(0.0f64);
    let table = Table::of_fluence(tau, |t| {
        let fluence = slab.fluence(t)?;
        largest.set(largest.get().max(fluence.error));
        Ok(fluence.value)
    })?;
    let error = largest.get() + TABULATED;
    Ok(Box::new(move |t| Ok((table.at(t), error))))
}
