//! A slab by orders of scattering, by whichever method serves.

use crate::phase::Named;
use crate::solved::{PEIERLS_UP_TO, THICK, better};
use anyhow::{Result, bail, ensure};
use turbid_analytic::orders::ScatteringOrders;
use turbid_analytic::{Incidence, IsotropicSlab, Value};

/// A slab whose orders of scattering are asked one by one, in either way or both; of both the better known is given.
pub struct Orders {
    /// By iterating the Peierls equation: bounds are absolute.
    peierls: Option<IsotropicSlab>,
    /// By following light from collision to collision: bounds are relative.
    successive: Option<ScatteringOrders>,
}

/// The highest order by the Peierls equation.
const MOST: u32 = 1000;

/// The highest order by following light.
const MOST_FOLLOWED: u32 = 100;

impl Orders {
    /// Prepares a slab.
    pub fn new(tau: f64, albedo: f64, named: &Named, incidence: Incidence) -> Result<Self> {
        let followed = || ScatteringOrders::new(tau, albedo, &named.phase, incidence);
        if !named.is_isotropic() || tau > PEIERLS_UP_TO {
            return Ok(Orders { peierls: None, successive: Some(followed()?) });
        }
        let peierls = Some(IsotropicSlab::new(tau, albedo, incidence)?);
        // Grazing beams are not followed.
        let successive = if tau > THICK { followed().ok() } else { None };
        Ok(Orders { peierls, successive })
    }

    fn ask(
        &self,
        n: u32,
        peierls: impl Fn(&IsotropicSlab) -> turbid_analytic::Result<Value>,
        successive: impl Fn(&ScatteringOrders) -> turbid_analytic::Result<Value>,
    ) -> Result<Value> {
        check(n)?;
        match (&self.peierls, &self.successive) {
            (Some(slab), Some(other)) if n <= MOST_FOLLOWED => Ok(better(peierls(slab)?, successive(other)?)),
            (Some(slab), _) => Ok(peierls(slab)?),
            (None, Some(other)) => Ok(successive(other)?),
            (None, None) => bail!("a slab without orders of scattering: a fault of ours"),
        }
    }

    /// Fraction sent back after n scatterings.
    pub fn reflectance(&self, n: u32) -> Result<Value> {
        self.ask(n, |slab| slab.reflectance_of_order(n), |slab| slab.reflectance(n))
    }

    /// Fraction let through after n scatterings.
    pub fn transmittance(&self, n: u32) -> Result<Value> {
        self.ask(n, |slab| slab.transmittance_of_order(n), |slab| slab.transmittance(n))
    }

    /// Fluence of light scattered n times.
    pub fn fluence(&self, n: u32, t: f64) -> Result<Value> {
        self.ask(n, |slab| slab.fluence_of_order(n, t), |slab| slab.fluence(n, t))
    }
}

fn check(n: u32) -> Result<()> {
    ensure!(n <= MOST, "order is {n}; allowed: 0 to {MOST}");
    Ok(())
}
