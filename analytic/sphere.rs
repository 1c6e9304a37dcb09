//! The sphere of isotropic scattering, index matched.
//!
//! In a ball of radius a (mean free paths) whose surface does not reflect, the fluence obeys
//! phi(r) = phi_0(r) + (w/2) int_0^a (r'/r) \[E_1(|r-r'|) - E_1(r+r')\] phi(r') dr', phi_0 the light that has not
//! collided: for u = r phi the equation of the slab of thickness 2a, restricted to odd functions. Three sources:
//!
//! * uniform isotropic emission of unit power: phi_0 = (1 - P(r))/V, with P(r) the escape probability of
//!   [`escape_from`] and V = (4/3) pi a^3;
//! * a point at the centre of unit power: phi_0 = e^(-r)/(4 pi r^2). The singularity is taken out exactly:
//!   phi = phi_inf + psi, with phi_inf the field of the point in an infinite medium and psi, smooth, the light that
//!   this medium's outside would have sent back, negative;
//! * light falling on the surface from everywhere, of radiance 1/pi and irradiance 1: phi_0 = 4 P(r).
//!
//! They are related: phi_incident = 4 \[1 - (1-w) V phi_uniform\], A_incident = (4a/3)(1-w) L_uniform and
//! L_centre = phi_incident(0)/4 for the escape L and the absorptance A.
//!
//! The polynomial that solves the equation at the nodes misses it between them; on each panel the largest defect
//! met, doubled, plus rounding, is its residual. The inverse of 1 - (w/2) K is a positive operator, so the error is
//! at most what it makes of the residual, and each answer carries the integral of that.
//!
//! Limits: a -> 0, first flights ([`escape_uniform`] -> 1 - 3a/4); w = 0, closed forms; w = 1, phi = 4 under incidence.
//!
//! Source: Davison 1957, chapter VI; Case and Zweifel 1967, chapters 2 and 6.

mod chord;
mod first_flight;
pub(crate) mod operator;
mod point;
mod shells;

use crate::error::{Error, Result, within};
use crate::incidence::check_albedo;
use crate::value::Value;
pub use first_flight::{absorbing_transmittance, escape_from, escape_uniform};
use libm::exp;
use operator::ShellOperator;
use shells::Shells;
use std::f64::consts::PI;
use std::sync::Arc;

/// Where the light of a sphere comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SphereSource {
    /// Isotropic emission of unit power, spread evenly over the volume.
    Uniform,
    /// An isotropic point source of unit power at the centre.
    Centre,
    /// Radiance 1/pi from outside on the whole surface: irradiance 1, power 4 pi a^2.
    Incident,
}

/// A solved sphere.
pub struct Sphere {
    radius: f64,
    albedo: f64,
    source: SphereSource,
    shells: Shells,
}

impl Sphere {
    /// Solves the sphere.
    ///
    /// # Arguments
    /// `radius` in mean free paths, 1e-12 to 100; `albedo` 0 to 1; `source` of unit power (incident: irradiance 1)
    /// # Returns
    /// a solution whose answers have an error near 1e-13 of the fluence, near 1e-15 a^2 in large spheres
    /// without absorption; the bounds say how much
    /// # Errors
    /// `Error::OutOfRange` naming `radius` or `albedo`
    pub fn new(radius: f64, albedo: f64, source: SphereSource) -> Result<Self> {
        check_radius(radius)?;
        check_albedo(albedo)?;
        Self::solve(Arc::new(ShellOperator::new(radius)), albedo, source)
    }

    /// The sphere of the same radius with another albedo or source: saves building the operator.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`
    pub fn with(&self, albedo: f64, source: SphereSource) -> Result<Self> {
        check_albedo(albedo)?;
        Self::solve(Arc::clone(self.shells.operator()), albedo, source)
    }

    fn solve(operator: Arc<ShellOperator>, albedo: f64, source: SphereSource) -> Result<Self> {
        let radius = operator.radius;
        Ok(Sphere { radius, albedo, source, shells: Shells::new(operator, albedo, source)? })
    }

    /// Radius in mean free paths.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// Where the light comes from.
    pub fn source(&self) -> SphereSource {
        self.source
    }

    /// Fluence at distance r from the centre, direct light included.
    ///
    /// # Arguments
    /// `r` in mean free paths, 0 to the radius
    /// # Returns
    /// \[1/mean free path^2\] per unit of emitted power; \[1\] per unit irradiance for incident light
    /// # Errors
    /// `Error::OutOfRange` naming `r`; `Error::Infinite` at a central source
    pub fn fluence(&self, r: f64) -> Result<Value> {
        self.check_r(r)?;
        Ok(self.shells.fluence(r))
    }

    /// Fluence at r from the polynomial alone: some hundred nanoseconds instead of some ten microseconds.
    ///
    /// # Returns
    /// as [`Self::fluence`], with a bound of its own, larger close to the surface
    /// # Errors
    /// `Error::OutOfRange` naming `r`; `Error::Infinite` at a central source
    pub fn fluence_interpolated(&self, r: f64) -> Result<Value> {
        self.check_r(r)?;
        Ok(self.shells.fluence_interpolated(r))
    }

    /// Fluence at r of the light that has not collided.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `r`; `Error::Infinite` at a central source
    pub fn fluence_direct(&self, r: f64) -> Result<Value> {
        self.check_r(r)?;
        let a = self.radius;
        // Four exponential integrals, and a depth that may be off by a rounding of the radius.
        let ulps = 48.0 + a;
        let (escape, collision) = first_flight::first_flight(a, r, a - r);
        let value = match self.source {
            SphereSource::Uniform => collision / self.volume(),
            SphereSource::Incident => 4.0 * escape,
            SphereSource::Centre => exp(-r) / (4.0 * PI * r * r),
        };
        Ok(Value::rounded(value, ulps, "closed form"))
    }

    /// Fraction of the power that leaves the sphere \[1\]; of the incident power, the fraction not absorbed.
    pub fn escape(&self) -> Value {
        self.shells.escape
    }

    /// Fraction of the power that is absorbed \[1\].
    pub fn absorptance(&self) -> Value {
        self.shells.absorptance
    }

    /// Radiance that leaves the surface with cosine mu to the outward normal.
    ///
    /// I = int_0^(2 a mu) S(r(s)) e^(-s) ds, r^2 = a^2 - 2 a mu s + s^2, S = (source + w phi)/(4 pi).
    /// # Arguments
    /// `mu` 0 to 1
    /// # Returns
    /// \[1/(mean free path^2 sr)\] per unit of emitted power; \[1/sr\] per unit irradiance for incident light, that
    /// which crosses without collision, e^(-2 a mu)/pi, included. A central source: of scattered light; the direct
    /// flux e^(-a)/(4 pi a^2) leaves at mu = 1 alone
    /// # Errors
    /// `Error::OutOfRange` naming `mu`; `Error::Infinite` at mu = 1 from a central source
    /// # Limits
    /// scattered light of a central source grows like w e^(-a)/(16 pi a sqrt(1-mu^2)) as mu -> 1
    pub fn exit_radiance(&self, mu: f64) -> Result<Value> {
        within("mu", mu, 0.0, 1.0, "0 to 1")?;
        if self.source == SphereSource::Centre && mu == 1.0 {
            return Err(Error::Infinite("the radiance through a point source is infinite"));
        }
        Ok(self.shells.exit_radiance(mu))
    }

    fn check_r(&self, r: f64) -> Result<f64> {
        within("r", r, 0.0, self.radius, "0 to the radius")?;
        if self.source == SphereSource::Centre && 1.0 / (r * r) == f64::INFINITY {
            return Err(Error::Infinite("the fluence at a point source is infinite"));
        }
        Ok(r)
    }

    fn volume(&self) -> f64 {
        4.0 * PI / 3.0 * self.radius * self.radius * self.radius
    }
}

fn check_radius(radius: f64) -> Result<f64> {
    within("radius", radius, 1e-12, 100.0, "1e-12 to 100")
}
