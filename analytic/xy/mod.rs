//! Chandrasekhar's X and Y functions: all the light that leaves a slab of isotropic scattering, by two functions of one
//! cosine.
//!
//! With w the albedo, tau the thickness, a_0 = int_0^1 X dmu, b_0 = int_0^1 Y dmu and unit irradiance at cosine mu_0:
//!
//! * X(mu) = mu phi(0), Y(mu) = mu phi(tau), with phi the fluence for mu_0 = mu
//! * X = 1 + (w/2) mu int (X X' - Y Y')/(mu + mu') dmu', Y = e^(-tau/mu) + (w/2) mu int (Y X' - X Y')/(mu - mu') dmu'
//! * radiance leaving the lit face (w/4 pi) (X X_0 - Y Y_0)/(mu + mu_0), the other (w/4 pi) (Y X_0 - X Y_0)/(mu - mu_0)
//! * R = 1 - X_0 (1 - w a_0/2) - Y_0 w b_0/2, T = Y_0 (1 - w a_0/2) + X_0 w b_0/2
//! * (1 - w a_0/2)^2 - (w b_0/2)^2 = 1 - w
//!
//! The two integral equations have more than one solution (for w = 1 a family), so that it is the fluences that are
//! computed here, from the Peierls equation. The other method is the growth of the slab layer by layer,
//! dX/dtau = Y J, dY/dtau = -Y/mu + X J, J = (w/2) int Y dmu/mu.
//!
//! Limits: tau -> 0, X = 1 and Y = e^(-tau/mu); tau -> inf, w < 1: X = H and Y = 0.
//!
//! Source: Chandrasekhar 1960, chapter VIII; Mullikin 1964; Sobolev 1975; van de Hulst 1980, chapter 7.

#[cfg(test)]
mod tests;

use crate::error::{Result, within};
use crate::incidence::Incidence;
use crate::slab_isotropic::IsotropicSlab;
use crate::value::Value;
use std::f64::consts::PI;

const METHOD: &str = "X and Y from the Peierls equation";

/// The X and Y functions of one slab.
pub struct XAndY {
    /// Lit from everywhere: half its fluences on the faces are the integrals of X and Y.
    diffuse: IsotropicSlab,
}

impl XAndY {
    /// Prepares a slab.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 400; `albedo` 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `tau` or `albedo`
    pub fn new(tau: f64, albedo: f64) -> Result<Self> {
        Ok(XAndY { diffuse: IsotropicSlab::new(tau, albedo, Incidence::Diffuse)? })
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.diffuse.tau()
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.diffuse.albedo()
    }

    /// X(mu) and Y(mu) \[1\].
    ///
    /// # Arguments
    /// `mu` 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `mu`
    /// # Limits
    /// mu = 0: 1 and 0
    pub fn at(&self, mu: f64) -> Result<[Value; 2]> {
        within("mu", mu, 0.0, 1.0, "0 to 1")?;
        if mu < 1e-300 {
            // X - 1 and Y are below mu (1 + ln(1/mu)).
            return Ok([Value::new(1.0, 1e-297, METHOD), Value::new(0.0, 1e-297, METHOD)]);
        }
        let slab = self.diffuse.with(self.albedo(), Incidence::Beam { mu0: mu })?;
        let named = |v: Value| Value { method: METHOD, ..v.scaled(mu) };
        Ok([named(slab.fluence(0.0)?), named(slab.fluence(self.tau())?)])
    }

    /// a_0 = int_0^1 X dmu and b_0 = int_0^1 Y dmu \[1\].
    pub fn integrals(&self) -> Result<[Value; 2]> {
        let named = |v: Value| Value { method: METHOD, ..v.scaled(0.5) };
        Ok([named(self.diffuse.fluence(0.0)?), named(self.diffuse.fluence(self.tau())?)])
    }

    /// Radiance leaving the lit face at cosine `mu`, per unit irradiance at `mu0` \[1/sr\].
    ///
    /// # Arguments
    /// `mu`, `mu0` 0 to 1, not both 0
    /// # Errors
    /// `Error::OutOfRange` naming `mu` or `mu0`
    pub fn radiance_up(&self, mu0: f64, mu: f64) -> Result<Value> {
        let ([x, y], [x0, y0]) = (self.at(mu)?, self.at_entrance(mu0)?);
        let value = x.value * x0.value - y.value * y0.value;
        Ok(bilinear([(x, x0), (y, y0)], value).scaled(self.albedo() / (4.0 * PI) / (mu + mu0)))
    }

    /// Radiance of scattered light leaving the far face at cosine `mu`, per unit irradiance at `mu0` \[1/sr\].
    ///
    /// As mu approaches mu0 two close numbers are subtracted, and the bound grows.
    /// # Arguments
    /// `mu`, `mu0` 0 to 1, different by 1e-6 at least
    /// # Errors
    /// `Error::OutOfRange` naming `mu` or `mu0`
    pub fn radiance_down(&self, mu0: f64, mu: f64) -> Result<Value> {
        let ([x, y], [x0, y0]) = (self.at(mu)?, self.at_entrance(mu0)?);
        within("mu", (mu - mu0).abs(), 1e-6, 1.0, "different from mu0 by 1e-6 or more")?;
        let value = (y.value * x0.value - x.value * y0.value) * (mu - mu0).signum();
        Ok(bilinear([(y, x0), (x, y0)], value).scaled(self.albedo() / (4.0 * PI) / (mu - mu0).abs()))
    }

    /// Fractions reflected and transmitted, direct light included \[1\], by X, Y and their integrals.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `mu0`
    pub fn fluxes(&self, mu0: f64) -> Result<[Value; 2]> {
        let ([x, y], [a, b]) = (self.at_entrance(mu0)?, self.integrals()?);
        let half = 0.5 * self.albedo();
        let (out, across) = (1.0 - half * a.value, half * b.value);
        let size = x.value + y.value;
        let error = (x.error + y.error) * (out.abs() + across)
            + size * (half * (a.error + b.error) + 4.0 * f64::EPSILON)
            + 4.0 * f64::EPSILON;
        let reflected = 1.0 - x.value * out - y.value * across;
        let transmitted = y.value * out + x.value * across;
        Ok([reflected, transmitted].map(|value| Value::new(value, error, METHOD)))
    }

    /// X and Y at a cosine that is called mu0.
    fn at_entrance(&self, mu0: f64) -> Result<[Value; 2]> {
        within("mu0", mu0, 1e-300, 1.0, "1e-300 to 1")?;
        self.at(mu0)
    }
}

/// `value`, a difference of two products, with the bound that their factors give.
fn bilinear(products: [(Value, Value); 2], value: f64) -> Value {
    let error = products
        .iter()
        .map(|(a, b)| {
            a.error * (b.value.abs() + b.error)
                + a.value.abs() * (b.error + 2.0 * f64::EPSILON * b.value.abs())
        })
        .sum();
    Value::new(value, error, METHOD)
}
