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
//! at most what it makes of the residual, and each answer carries the integral of that. Spheres beyond
//! a radius of 64 are solved by discrete ordinates, u = sum c_j sinh(k_j r), and the bound is twice the change from
//! another set of directions.
//!
//! Limits: a -> 0, first flights ([`escape_uniform`] -> 1 - 3a/4); w = 0, closed forms; w = 1, phi = 4 under incidence.
//!
//! Source: Davison 1957, chapter VI; Case and Zweifel 1967, chapters 2 and 6.

mod chord;
mod first_flight;
mod large;
pub(crate) mod operator;
mod orders;
pub(crate) mod ordinates;
mod point;
mod shells;
mod source;

use crate::error::{Error, Result, within};
use crate::incidence::check_albedo;
use crate::value::Value;
pub use first_flight::{absorbing_transmittance, escape_from, escape_uniform};
use large::Large;
use libm::{exp, expm1};
use operator::ShellOperator;
use orders::CENTRE_ORDERS;
use shells::Shells;
pub use source::SphereSource;
use std::f64::consts::PI;
use std::sync::Arc;

/// A solved sphere.
pub struct Sphere {
    radius: f64,
    albedo: f64,
    source: SphereSource,
    solution: Solution,
}

enum Solution {
    Shells(Shells),
    Large(Large),
    /// No scattering: closed forms.
    Direct,
}

const CLOSED: &str = "closed form";

/// Radii up to this are solved by the integral equation.
const LARGE: f64 = 64.0;

impl Sphere {
    /// Solves the sphere.
    ///
    /// # Arguments
    /// `radius` in mean free paths, 1e-12 to 1e6; `albedo` 0 to 1, beyond a radius of 64
    /// either 0 or 1e-12 to 1; `source` of unit power (incident: irradiance 1)
    /// # Returns
    /// a solution whose answers have an error near 1e-13 of the fluence, up to 1e-10 of it in large
    /// spheres without absorption and deep in absorbing ones; the bounds say how much
    /// # Errors
    /// `Error::OutOfRange` naming `radius` or `albedo`
    pub fn new(radius: f64, albedo: f64, source: SphereSource) -> Result<Self> {
        check_radius(radius)?;
        check_albedo(albedo)?;
        if radius > LARGE {
            return Self::large(radius, albedo, source);
        }
        Self::solve(Arc::new(ShellOperator::new(radius)), albedo, source)
    }

    /// The sphere of the same radius with another albedo or source: saves building the operator.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`
    pub fn with(&self, albedo: f64, source: SphereSource) -> Result<Self> {
        check_albedo(albedo)?;
        match &self.solution {
            Solution::Shells(shells) => Self::solve(Arc::clone(shells.operator()), albedo, source),
            _ => Self::large(self.radius, albedo, source),
        }
    }

    fn solve(operator: Arc<ShellOperator>, albedo: f64, source: SphereSource) -> Result<Self> {
        let radius = operator.radius;
        let shells = Shells::new(operator, albedo, source)?;
        Ok(Sphere { radius, albedo, source, solution: Solution::Shells(shells) })
    }

    fn large(radius: f64, albedo: f64, source: SphereSource) -> Result<Self> {
        let solution = if albedo == 0.0 {
            Solution::Direct
        } else {
            within("albedo", albedo, 1e-12, 1.0, "0, or 1e-12 to 1 for a radius above 64")?;
            Solution::Large(Large::new(radius, albedo, source)?)
        };
        Ok(Sphere { radius, albedo, source, solution })
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
        match &self.solution {
            Solution::Shells(shells) => Ok(shells.fluence(self.check_r(r)?)),
            Solution::Large(large) => Ok(large.fluence(self.check_r(r)?)),
            Solution::Direct => self.fluence_direct(r),
        }
    }

    /// Fluence at r from the polynomial alone: some hundred nanoseconds instead of some ten microseconds.
    ///
    /// # Returns
    /// as [`Self::fluence`], with a bound of its own, larger close to the surface
    /// # Errors
    /// `Error::OutOfRange` naming `r`; `Error::Infinite` at a central source
    pub fn fluence_interpolated(&self, r: f64) -> Result<Value> {
        match &self.solution {
            Solution::Shells(shells) => Ok(shells.fluence_interpolated(self.check_r(r)?)),
            _ => self.fluence(r),
        }
    }

    /// Fluence at r of the light that has not collided.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `r`; `Error::Infinite` at a central source
    pub fn fluence_direct(&self, r: f64) -> Result<Value> {
        self.check_r(r)?;
        let a = self.radius;
        // Four exponential integrals, and a depth that may differ by a rounding of the radius.
        let ulps = 48.0 + a.min(745.0);
        let (escape, collision) = first_flight::first_flight(a, r, a - r);
        let value = match self.source {
            SphereSource::Uniform => collision / self.volume(),
            SphereSource::Incident => 4.0 * escape,
            SphereSource::Centre => exp(-r) / (4.0 * PI * r * r),
        };
        Ok(Value::rounded(value, ulps, CLOSED))
    }

    /// Fluence at r of light scattered exactly n times.
    ///
    /// phi_n = (w/2) int_0^a (r'/r) \[E_1(|r-r'|) - E_1(r+r')\] phi_(n-1)(r') dr', phi_0 the direct light.
    /// # Arguments
    /// `n` order, 0 to 1000, of a central source 0 to 7; `r` 0 to the radius. Radii up to 64, or order 0
    /// # Errors
    /// `Error::OutOfRange` naming `n`, `r` or `radius`; `Error::Infinite` at a central source
    pub fn fluence_of_order(&self, n: u32, r: f64) -> Result<Value> {
        let (most, allowed) = match self.source {
            SphereSource::Centre => (CENTRE_ORDERS, "0 to 7 for a central source"),
            _ => (1000, "0 to 1000"),
        };
        within("n", f64::from(n), 0.0, f64::from(most), allowed)?;
        self.check_r(r)?;
        match &self.solution {
            _ if n == 0 => self.fluence_direct(r),
            Solution::Shells(shells) => Ok(shells.fluence_of_order(n, r)),
            Solution::Direct => Ok(Value::new(0.0, 0.0, CLOSED)),
            Solution::Large(_) => {
                let allowed = "up to 64 for light scattered a given number of times";
                Err(Error::OutOfRange { name: "radius", value: self.radius, allowed })
            }
        }
    }

    /// Fraction of the power that leaves the sphere \[1\]; of the incident power, the fraction not absorbed.
    pub fn escape(&self) -> Value {
        match &self.solution {
            Solution::Shells(shells) => shells.escape,
            Solution::Large(large) => large.escape,
            Solution::Direct => self.direct_balance().0,
        }
    }

    /// Fraction of the power that is absorbed \[1\].
    pub fn absorptance(&self) -> Value {
        match &self.solution {
            Solution::Shells(shells) => shells.absorptance,
            Solution::Large(large) => large.absorptance,
            Solution::Direct => self.direct_balance().1,
        }
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
            return Err(Error::Infinite(
                "the radiance through a point source is infinite; allowed: mu below 1",
            ));
        }
        let chord = 2.0 * self.radius * mu;
        Ok(match (&self.solution, self.source) {
            (Solution::Shells(shells), _) => shells.exit_radiance(mu),
            (Solution::Large(large), _) => large.exit_radiance(mu),
            (Solution::Direct, SphereSource::Uniform) => {
                Value::rounded(-expm1(-chord) / (4.0 * PI * self.volume()), 16.0, CLOSED)
            }
            (Solution::Direct, SphereSource::Incident) => {
                Value::rounded(exp(-chord) / PI, 16.0 + chord.min(745.0), CLOSED)
            }
            (Solution::Direct, SphereSource::Centre) => Value::new(0.0, 0.0, CLOSED),
        })
    }

    /// Escape and absorptance without scattering.
    fn direct_balance(&self) -> (Value, Value) {
        let a = self.radius;
        let (leaves, stays) = match self.source {
            SphereSource::Uniform => first_flight::mean_escape(a),
            SphereSource::Incident => first_flight::transmittance_and_loss(a),
            SphereSource::Centre => (exp(-a), -expm1(-a)),
        };
        (Value::rounded(leaves, 48.0, CLOSED), Value::rounded(stays, 48.0, CLOSED))
    }

    fn check_r(&self, r: f64) -> Result<f64> {
        within("r", r, 0.0, self.radius, "0 to the radius")?;
        if self.source == SphereSource::Centre && 1.0 / (r * r) == f64::INFINITY {
            return Err(Error::Infinite("the fluence at a point source is infinite; allowed: r above 0"));
        }
        Ok(r)
    }

    fn volume(&self) -> f64 {
        4.0 * PI / 3.0 * self.radius * self.radius * self.radius
    }
}

fn check_radius(radius: f64) -> Result<f64> {
    within("radius", radius, 1e-12, 1e6, "1e-12 to 1e6")
}

#[cfg(test)]
mod tests;
