//! An albedo that varies with depth, by many layers.

use super::problem::{Ground, Layer};
use super::stratified::StratifiedSlab;
use crate::error::{Error, Result, within};
use crate::incidence::Incidence;
use crate::phase::Phase;
use crate::quadrature::GaussLegendre;
use crate::value::Value;

const METHOD: &str = "layers of the mean albedo, extrapolated from three layerings";

/// A slab whose albedo is a function of depth, between three layerings of it.
///
/// Layers with the mean albedo of each are wrong by c h^2 and less, h their thickness, so that of n and of 2n layers
/// (4 f_2n - f_n)/3 is closer. The answer is that of 2n and 4n layers; its difference from that of n and 2n is the
/// bound, with those of the layerings. c is another one within a layer, so that fields are known where all three have
/// an interface.
pub struct VaryingAlbedo {
    /// The finest first.
    layerings: [StratifiedSlab; 3],
}

impl VaryingAlbedo {
    /// Solves the slab in three layerings.
    ///
    /// # Arguments
    /// `breaks` depths in mean free paths, from 0 to that of the ground in rising order, 1e-6 or more apart: where fields are
    /// wanted, and where the albedo has steps or bends; `albedo` as a function of depth, 0 to 1, smooth between breaks;
    /// `layers` between two breaks in the coarsest layering, 1 to 100; the rest as for [`StratifiedSlab::new`]
    /// # Returns
    /// answers whose bounds fall about as 1/`layers`^2; every layer takes a tenth of a second
    /// # Errors
    /// `Error::NotFinite` naming `albedo`; `Error::OutOfRange` naming `breaks`, `albedo`, `layers`, `tau`, `mu0` or the first
    /// Legendre moment left out
    pub fn new(
        breaks: &[f64],
        albedo: impl Fn(f64) -> f64,
        phase: &Phase,
        ground: Ground,
        incidence: Option<Incidence>,
        layers: usize,
    ) -> Result<Self> {
        within("breaks", breaks.len() as f64, 2.0, 100.0, "2 to 100 depths")?;
        within("breaks", breaks[0], 0.0, 0.0, "0 first")?;
        within("layers", layers as f64, 1.0, 100.0, "1 to 100 in the coarsest of three layerings")?;
        for pair in breaks.windows(2) {
            within(
                "breaks",
                pair[1],
                pair[0] + 1e-6,
                400.0,
                "in rising order, 1e-6 or more apart, up to 400",
            )?;
        }
        let rule = GaussLegendre::rule(3);
        let layer = |low: f64, high: f64| {
            let mut mean = 0.0;
            for (x, weight) in rule.nodes.iter().zip(&rule.weights) {
                let at = low + (high - low) * x;
                let value = albedo(at);
                if !value.is_finite() {
                    return Err(Error::NotFinite { name: "albedo", value, at });
                }
                mean += weight * within("albedo", value, 0.0, 1.0, "0 to 1 at every depth")?;
            }
            Layer::new(high - low, mean.min(1.0), phase)
        };
        let solve = |count: usize| {
            let mut stack = Vec::new();
            for pair in breaks.windows(2) {
                let at = |i: usize| pair[0] + (pair[1] - pair[0]) * (i as f64 / count as f64);
                for i in 0..count {
                    stack.push(layer(at(i), at(i + 1))?);
                }
            }
            StratifiedSlab::new(&stack, ground, incidence)
        };
        Ok(VaryingAlbedo { layerings: [solve(4 * layers)?, solve(2 * layers)?, solve(layers)?] })
    }

    /// The three layerings, the finest first.
    pub fn layerings(&self) -> &[StratifiedSlab; 3] {
        &self.layerings
    }

    /// Depths in mean free paths at which fields are known: the interfaces of the coarsest layering.
    pub fn depths(&self) -> &[f64] {
        self.layerings[2].depths()
    }

    /// Power that leaves through the lit face \[1\].
    pub fn reflectance(&self) -> Value {
        extrapolated(self.layerings.each_ref().map(StratifiedSlab::reflectance))
    }

    /// Power that arrives at the ground, direct light included \[1\].
    pub fn transmittance(&self) -> Result<Value> {
        self.at(0.0, |slab, _| slab.transmittance())
    }

    /// Fluence at depth t, direct light included \[1\].
    ///
    /// # Arguments
    /// `t` one of [`Self::depths`], to 1e-9 of itself
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Value> {
        self.at(t, StratifiedSlab::fluence)
    }

    /// Net flux downwards at depth t, direct light included \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn flux(&self, t: f64) -> Result<Value> {
        self.at(t, StratifiedSlab::flux)
    }

    /// Mean over azimuth of the radiance, as [`StratifiedSlab::radiance`].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `t`, `mu` or `cosines`
    pub fn radiance(&self, t: f64, cosines: &[f64]) -> Result<Vec<Value>> {
        let [a, b, c] = self.all(t, |slab, t| slab.radiance(t, cosines))?;
        Ok((0..cosines.len()).map(|i| extrapolated([a[i], b[i], c[i]])).collect())
    }

    fn at(&self, t: f64, answer: impl Fn(&StratifiedSlab, f64) -> Result<Value>) -> Result<Value> {
        Ok(extrapolated(self.all(t, answer)?))
    }

    /// What the layerings answer at an interface that is common to all, whose depths differ by rounding.
    fn all<T>(&self, t: f64, answer: impl Fn(&StratifiedSlab, f64) -> Result<T>) -> Result<[T; 3]> {
        let found = self.depths().iter().position(|depth| (depth - t).abs() <= 1e-9 * depth);
        let (name, allowed) = ("t", "an interface of the coarsest layering, such as a break");
        let i = found.ok_or(Error::OutOfRange { name, value: t, allowed })?;
        let one = |slab: &StratifiedSlab, times: usize| answer(slab, slab.depths()[times * i]);
        let [a, b, c] = &self.layerings;
        Ok([one(a, 4)?, one(b, 2)?, one(c, 1)?])
    }
}

/// The layerings taken together, the finest first.
fn extrapolated([fine, middle, coarse]: [Value; 3]) -> Value {
    let of = |fine: Value, coarse: Value| fine.value + (fine.value - coarse.value) / 3.0;
    let (best, other) = (of(fine, middle), of(middle, coarse));
    let layers = (4.0 * fine.error + 5.0 * middle.error + coarse.error) / 3.0;
    Value::new(best, (best - other).abs() + layers, METHOD)
}
