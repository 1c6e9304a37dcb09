//! An albedo that varies with depth, by many layers.

use super::problem::{Ground, Layer};
use super::stratified::StratifiedSlab;
use crate::error::{Error, Result, within};
use crate::incidence::Incidence;
use crate::phase::Phase;
use crate::quadrature::GaussLegendre;
use crate::value::Value;

const METHOD: &str = "layers of the mean albedo, extrapolated from two layerings";

/// A slab whose albedo is a smooth function of depth, between two layerings of it.
///
/// Layers of equal thickness h with the mean albedo of each are wrong by c h^2 and less: of n and of 2n layers,
/// (4 f_2n - f_n)/3 is right to the next order, and the difference of that from f_2n is the bound, with those of both.
pub struct VaryingAlbedo {
    coarse: StratifiedSlab,
    fine: StratifiedSlab,
}

impl VaryingAlbedo {
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-6 to 400; `albedo` as a function of depth in mean free paths, 0 to 1 and smooth: a
    /// step belongs between layers; `layers` of the coarser layering, 2 to 200; the rest as for [`StratifiedSlab::new`]
    /// # Returns
    /// answers that are wrong by 1/`layers`^4 of themselves, if the albedo varies over the whole depth; every layer takes
    /// a tenth of a second
    /// # Errors
    /// `Error::NotFinite` naming `albedo`; `Error::OutOfRange` naming `tau`, `albedo`, `layers`, `mu0` or the first
    /// Legendre moment left out
    pub fn new(
        tau: f64,
        albedo: impl Fn(f64) -> f64,
        phase: &Phase,
        ground: Ground,
        incidence: Option<Incidence>,
        layers: usize,
    ) -> Result<Self> {
        within("tau", tau, 1e-6, 400.0, "1e-6 to 400")?;
        within("layers", layers as f64, 2.0, 200.0, "2 to 200")?;
        let rule = GaussLegendre::rule(3);
        let solve = |count: usize| {
            let thickness = tau / count as f64;
            let layer = |i: usize| {
                let mut mean = 0.0;
                for (x, weight) in rule.nodes.iter().zip(&rule.weights) {
                    let at = (i as f64 + x) * thickness;
                    let value = albedo(at);
                    if !value.is_finite() {
                        return Err(Error::NotFinite { name: "albedo", value, at });
                    }
                    mean += weight * within("albedo", value, 0.0, 1.0, "0 to 1 at every depth")?;
                }
                Layer::new(thickness, mean.min(1.0), phase)
            };
            let layers = (0..count).map(layer).collect::<Result<Vec<Layer>>>()?;
            StratifiedSlab::new(&layers, ground, incidence)
        };
        Ok(VaryingAlbedo { coarse: solve(layers)?, fine: solve(2 * layers)? })
    }

    /// The two layerings, the finer first.
    pub fn layerings(&self) -> [&StratifiedSlab; 2] {
        [&self.fine, &self.coarse]
    }

    /// Power that leaves through the lit face \[1\].
    pub fn reflectance(&self) -> Value {
        extrapolated(self.fine.reflectance(), self.coarse.reflectance())
    }

    /// Power that arrives at the ground, direct light included \[1\].
    ///
    /// # Errors
    /// none for a slab that was solved
    pub fn transmittance(&self) -> Result<Value> {
        Ok(extrapolated(self.fine.transmittance()?, self.coarse.transmittance()?))
    }

    /// Fluence at depth t, direct light included \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        Ok(extrapolated(self.fine.fluence(t)?, self.coarse.fluence(t)?))
    }

    /// Net flux downwards at depth t, direct light included \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn flux(&self, t: f64) -> Result<Value> {
        Ok(extrapolated(self.fine.flux(t)?, self.coarse.flux(t)?))
    }

    /// Mean over azimuth of the radiance, as [`StratifiedSlab::radiance`].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu` or `cosines`
    pub fn radiance(&self, t: f64, cosines: &[f64]) -> Result<Vec<Value>> {
        let (fine, coarse) = (self.fine.radiance(t, cosines)?, self.coarse.radiance(t, cosines)?);
        Ok(fine.into_iter().zip(coarse).map(|(fine, coarse)| extrapolated(fine, coarse)).collect())
    }
}

/// Both layerings taken together.
fn extrapolated(fine: Value, coarse: Value) -> Value {
    let step = (fine.value - coarse.value) / 3.0;
    let error = step.abs() + (4.0 * fine.error + coarse.error) / 3.0;
    Value::new(fine.value + step, error, METHOD)
}
