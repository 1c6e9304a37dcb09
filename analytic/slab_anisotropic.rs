//! The homogeneous slab with Henyey-Greenstein scattering.
mod jacobi;
mod modes;
mod nodes;
mod solution;

use crate::error::Result;
use crate::incidence::Incidence;

/// Solved slab.
pub struct AnisotropicSlab {
    fine: solution::Solution,
}

impl AnisotropicSlab {
    /// a
    pub fn probe(
        tau: f64,
        albedo: f64,
        g: f64,
        incidence: Incidence,
        upper: usize,
        lower: usize,
    ) -> Result<Self> {
        let modes = modes::Modes::new(albedo, g, nodes::Nodes::new(upper, lower))?;
        Ok(AnisotropicSlab { fine: solution::Solution::new(tau, albedo, incidence, modes)? })
    }
    /// a
    pub fn r(&self) -> f64 {
        self.fine.reflectance()
    }
    /// a
    pub fn td(&self) -> f64 {
        self.fine.transmittance_diffuse()
    }
    /// a
    pub fn a(&self) -> f64 {
        self.fine.absorptance()
    }
    /// a
    pub fn phi(&self, t: f64) -> f64 {
        self.fine.fluence(t)
    }
}
impl AnisotropicSlab {
    /// trial
    pub fn new(tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Result<Self> {
        Self::probe(tau, albedo, g, incidence, 48, 14)
    }
    /// trial
    pub fn fluence(&self, t: f64) -> Result<crate::Value> {
        Ok(crate::Value { value: self.phi(t), error: 1e-8, method: "trial" })
    }
}
