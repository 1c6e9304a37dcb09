//! A slab by orders of scattering, in whichever way knows each best.

use super::{PEIERLS_UP_TO, THICK, better};
use crate::error::{Result, within};
use crate::incidence::Incidence;
use crate::orders::ScatteringOrders;
use crate::phase::Phase;
use crate::slab_isotropic::IsotropicSlab;
use crate::value::Value;

/// The highest order by the Peierls equation, and by following light from collision to collision.
const MOST: u32 = 1000;
const MOST_FOLLOWED: u32 = 100;

/// A slab whose orders of scattering are asked one by one.
pub struct SlabOrders(Ways);

/// By iterating the Peierls equation, whose bounds are absolute; by following light, whose bounds are relative; or both.
enum Ways {
    Peierls(Box<IsotropicSlab>),
    Followed(Box<ScatteringOrders>),
    Both(Box<IsotropicSlab>, Box<ScatteringOrders>),
}

impl SlabOrders {
    /// Prepares a slab; an order is computed when it is first asked for.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e300; `albedo` 0 to 1; `phase` as for [`ScatteringOrders::new`];
    /// `incidence` of unit irradiance
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `mu0` or `phase moment 1200`
    pub fn new(tau: f64, albedo: f64, phase: &Phase, incidence: Incidence) -> Result<Self> {
        let followed = || ScatteringOrders::new(tau, albedo, phase, incidence).map(Box::new);
        if !phase.is_isotropic() || tau > PEIERLS_UP_TO {
            return Ok(SlabOrders(Ways::Followed(followed()?)));
        }
        let peierls = Box::new(IsotropicSlab::new(tau, albedo, incidence)?);
        // Grazing beams are not followed.
        Ok(SlabOrders(match if tau > THICK { followed().ok() } else { None } {
            Some(other) => Ways::Both(peierls, other),
            None => Ways::Peierls(peierls),
        }))
    }

    fn ask(
        &self,
        n: u32,
        peierls: impl Fn(&IsotropicSlab) -> Result<Value>,
        followed: impl Fn(&ScatteringOrders) -> Result<Value>,
    ) -> Result<Value> {
        within("order", f64::from(n), 0.0, f64::from(MOST), "0 to 1000")?;
        match &self.0 {
            Ways::Both(slab, other) if n <= MOST_FOLLOWED => Ok(better(peierls(slab)?, followed(other)?)),
            Ways::Peierls(slab) | Ways::Both(slab, _) => peierls(slab),
            Ways::Followed(other) => followed(other),
        }
    }

    /// Fraction of the incident power that leaves the lit face after exactly n scatterings \[1\].
    ///
    /// # Arguments
    /// `n` order, 0 (direct light) to 100, to 1000 with isotropic scattering up to thickness 400
    /// # Errors
    /// `Error::OutOfRange` naming `order`
    pub fn reflectance(&self, n: u32) -> Result<Value> {
        self.ask(n, |slab| slab.reflectance_of_order(n), |slab| slab.reflectance(n))
    }

    /// Fraction of the incident power that leaves the far face after exactly n scatterings \[1\].
    ///
    /// # Errors
    /// as [`Self::reflectance`]
    pub fn transmittance(&self, n: u32) -> Result<Value> {
        self.ask(n, |slab| slab.transmittance_of_order(n), |slab| slab.transmittance(n))
    }

    /// Fluence at depth t of light scattered exactly n times, per unit irradiance \[1\].
    ///
    /// # Errors
    /// as [`Self::reflectance`], and naming `t`
    pub fn fluence(&self, n: u32, t: f64) -> Result<Value> {
        self.ask(n, |slab| slab.fluence_of_order(n, t), |slab| slab.fluence(n, t))
    }
}
