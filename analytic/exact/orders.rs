//! A slab by orders of scattering, by whichever method serves.

use crate::phase::Named;
use crate::solved::PEIERLS_UP_TO;
use anyhow::{Result, ensure};
use turbid_analytic::orders::ScatteringOrders;
use turbid_analytic::{Incidence, IsotropicSlab, Value};

/// A slab whose orders of scattering are asked one by one.
pub enum Orders {
    /// By iterating the Peierls equation.
    Peierls(Box<IsotropicSlab>),
    /// By following light from collision to collision.
    Successive(Box<ScatteringOrders>),
}

/// The highest order by the Peierls equation.
const MOST: u32 = 1000;

impl Orders {
    /// Prepares a slab.
    pub fn new(tau: f64, albedo: f64, named: &Named, incidence: Incidence) -> Result<Self> {
        Ok(if named.is_isotropic() && tau <= PEIERLS_UP_TO {
            Orders::Peierls(Box::new(IsotropicSlab::new(tau, albedo, incidence)?))
        } else {
            Orders::Successive(Box::new(ScatteringOrders::new(tau, albedo, &named.phase, incidence)?))
        })
    }

    /// Fraction sent back after n scatterings.
    pub fn reflectance(&self, n: u32) -> Result<Value> {
        check(n)?;
        Ok(match self {
            Orders::Peierls(slab) => slab.reflectance_of_order(n)?,
            Orders::Successive(slab) => slab.reflectance(n)?,
        })
    }

    /// Fraction let through after n scatterings.
    pub fn transmittance(&self, n: u32) -> Result<Value> {
        check(n)?;
        Ok(match self {
            Orders::Peierls(slab) => slab.transmittance_of_order(n)?,
            Orders::Successive(slab) => slab.transmittance(n)?,
        })
    }

    /// Fluence of light scattered n times.
    pub fn fluence(&self, n: u32, t: f64) -> Result<Value> {
        check(n)?;
        Ok(match self {
            Orders::Peierls(slab) => slab.fluence_of_order(n, t)?,
            Orders::Successive(slab) => slab.fluence(n, t)?,
        })
    }
}

fn check(n: u32) -> Result<()> {
    ensure!(n <= MOST, "order is {n}; allowed: 0 to {MOST}");
    Ok(())
}
