//! The homogeneous slab with isotropic scattering: the Peierls equation, solved once, asked anything.
//!
//! phi(t) = phi_0(t) + (albedo/2) int_0^tau E_1(|t-t'|) phi(t') dt' for the fluence phi. Light that a beam has
//! scattered once is known in closed form; the rest is a polynomial on panels graded towards both faces, where
//! phi behaves like c + t ln t, and every answer is one more integral over it.
//!
//! The bound on every answer is a-posteriori. At the edges and middles of all panels the polynomial is put into the
//! equation; twice the largest defect of a panel, plus rounding, is its residual r. The inverse of
//! 1 - (albedo/2) K is a positive operator, so the error is at most what it makes of r, which is one more solution
//! of the same equations, and each answer carries the integral of that.
//!
//! Source: Peierls 1939; Kourganoff 1952, section 7; Case and Zweifel 1967, section 2.6.

mod equation;
mod orders;
mod ray;

use crate::beer_lambert::{direct_fluence, direct_transmittance};
use crate::error::{Error, Result};
use crate::exponential_integral::e_n;
use crate::incidence::{Incidence, check_albedo, check_depth, check_mu, check_tau};
use crate::peierls::{Halves, NODES, Operator};
use crate::slab_single::{beam_path, single_reflectance, single_transmittance};
use crate::value::Value;
use equation::{Iterate, METHOD, ULPS, flux_of, residual, source};
use libm::expm1;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

/// A solved slab: reflectance, transmittance, fluence and radiance, in all orders of scattering or one by one.
pub struct IsotropicSlab {
    tau: f64,
    albedo: f64,
    incidence: Incidence,
    operator: Arc<Operator>,
    /// The part of the fluence that is a polynomial: all of it (diffuse), all but the direct beam (beam).
    smooth: Halves,
    /// Bound on its error, at the nodes.
    bound: Halves,
    direct: Value,
    /// What the polynomial leaves out of the two fluxes: light that a beam has scattered once.
    once_up: Value,
    once_down: Value,
    iterates: Mutex<Vec<Iterate>>,
}

impl IsotropicSlab {
    /// Solves the slab.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 400; `albedo` 0 to 1; `incidence` of unit irradiance
    /// # Returns
    /// a solution whose answers have an error near 1e-13 of the fluence, and near
    /// 1e-15 tau^2 in thick slabs without absorption; the bounds say how much. They are absolute: the faint light
    /// behind a thick slab, below 1e-14 of the incident, is known relative to itself by [`crate::AnisotropicMedium`]
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo` or `mu0`
    pub fn new(tau: f64, albedo: f64, incidence: Incidence) -> Result<Self> {
        check_tau(tau)?;
        check_albedo(albedo)?;
        incidence.check()?;
        Self::solve(Arc::new(Operator::new(tau, first_panel(tau, incidence))), albedo, incidence)
    }

    /// The slab of the same thickness with another albedo or incidence: saves building the operator.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` or `mu0`
    pub fn with(&self, albedo: f64, incidence: Incidence) -> Result<Self> {
        check_albedo(albedo)?;
        incidence.check()?;
        let needed = first_panel(self.tau, incidence);
        // A mesh that is finer than needed serves too.
        if self.operator.mesh.edges[1] <= needed * (0.5 * self.tau).min(1.0) {
            Self::solve(Arc::clone(&self.operator), albedo, incidence)
        } else {
            Self::new(self.tau, albedo, incidence)
        }
    }

    fn solve(operator: Arc<Operator>, albedo: f64, incidence: Incidence) -> Result<Self> {
        const SINGULAR: Error = Error::Infinite("the slab's equations are singular in f64");
        let half = 0.5 * albedo;
        let mesh = &operator.mesh;
        let source = mesh.halves(|t, rest| source(albedo, incidence, t, rest));
        let factors = operator.factor(albedo);
        let mut smooth = factors.solve(&source).ok_or(SINGULAR)?;
        let defect = |f: &Halves| {
            let image = operator.apply(f);
            source.zip(&image, |s, k| s + half * k).zip(f, |a, f| a - f)
        };
        let correction = factors.solve(&defect(&smooth)).ok_or(SINGULAR)?;
        smooth = smooth.zip(&correction, |f, c| f + c);

        let at_nodes = defect(&smooth);
        let exact = |i: usize| {
            let probe = &operator.probes[i];
            let (upper, lower) = operator.at_probe(probe, &smooth);
            let rest = mesh.tau - probe.x;
            (
                self::source(albedo, incidence, probe.x, rest) + half * upper,
                self::source(albedo, incidence, rest, probe.x) + half * lower,
            )
        };
        let residual = residual(&operator, &smooth, Some(&at_nodes), exact);
        let image = operator.apply(&residual);
        let spread = factors.solve(&image.zip(&image, |k, _| half * k)).ok_or(SINGULAR)?;
        let bound = residual.zip(&spread, |r, s| r + s.abs());
        let (once_up, once_down) = match incidence {
            Incidence::Beam { .. } => (
                single_reflectance(mesh.tau, albedo, incidence)?,
                single_transmittance(mesh.tau, albedo, incidence)?,
            ),
            Incidence::Diffuse => (Value::new(0.0, 0.0, METHOD), Value::new(0.0, 0.0, METHOD)),
        };
        Ok(IsotropicSlab {
            tau: mesh.tau,
            direct: direct_transmittance(incidence, mesh.tau)?,
            once_up,
            once_down,
            albedo,
            incidence,
            smooth,
            bound,
            iterates: Mutex::new(Vec::new()),
            operator,
        })
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// How the light falls on the lit face.
    pub fn incidence(&self) -> Incidence {
        self.incidence
    }

    /// Fraction of the incident power that leaves through the lit face \[1\].
    ///
    /// R = (albedo/2) int phi(t) E_2(t) dt.
    pub fn reflectance(&self) -> Value {
        self.flux(self.once_up, |t, _| e_n(2, t))
    }

    /// Fraction of the incident power that leaves through the far face after at least one scattering \[1\].
    ///
    /// T_diffuse = (albedo/2) int phi(t) E_2(tau-t) dt.
    pub fn transmittance_diffuse(&self) -> Value {
        self.flux(self.once_down, |_, rest| e_n(2, rest))
    }

    /// Fraction of the incident power that crosses the slab without a collision \[1\].
    pub fn transmittance_direct(&self) -> Value {
        self.direct
    }

    /// Fraction of the incident power that leaves through the far face, direct light included \[1\].
    pub fn transmittance(&self) -> Value {
        self.transmittance_direct().plus(self.transmittance_diffuse(), METHOD)
    }

    /// Fraction of the incident power that is absorbed \[1\].
    ///
    /// A = (1 - albedo) int phi(t) dt.
    pub fn absorptance(&self) -> Value {
        let direct = match self.incidence {
            Incidence::Beam { mu0 } => -expm1(-self.tau / mu0),
            Incidence::Diffuse => 0.0,
        };
        let mesh = &self.operator.mesh;
        let value = direct + mesh.integrate(&self.smooth, |_, _| 1.0);
        let error = mesh.integrate(&self.bound, |_, _| 1.0) + ULPS * f64::EPSILON * value + f64::MIN_POSITIVE;
        Value::new(value, error, METHOD).scaled(1.0 - self.albedo)
    }

    /// Fluence at depth t, direct light included, per unit irradiance on the lit face \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    /// # Limits
    /// mu0 phi(0) and mu0 phi(tau) are Chandrasekhar's X(mu0) and Y(mu0)
    pub fn fluence(&self, t: f64) -> Result<Value> {
        check_depth(t, self.tau)?;
        let rest = self.tau - t;
        let (image, bound) = self.through_kernel(t, &self.smooth, &self.bound);
        let value = source(self.albedo, self.incidence, t, rest) + image;
        Ok(self.with_direct(t, value, bound))
    }

    /// Fluence at depth t from the polynomial alone: some hundred nanoseconds instead of some ten microseconds.
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Returns
    /// \[1\], with a bound of its own, larger than that of [`Self::fluence`] near the faces
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence_interpolated(&self, t: f64) -> Result<Value> {
        check_depth(t, self.tau)?;
        let mesh = &self.operator.mesh;
        let below = t > 0.5 * self.tau;
        let x = if below { self.tau - t } else { t };
        let (values, bounds) = if below {
            (&self.smooth.lower, &self.bound.lower)
        } else {
            (&self.smooth.upper, &self.bound.upper)
        };
        let p = mesh.find(x);
        let (start, length) = mesh.panel(p);
        let value = mesh.interpolate(values, p, (x - start) / length);
        let bound = bounds[p * NODES..(p + 1) * NODES].iter().fold(0.0, |a: f64, &b| a.max(b));
        Ok(self.with_direct(t, value, bound))
    }

    /// Radiance of scattered light at depth t in the direction of signed cosine mu \[1/sr\].
    ///
    /// Up: (albedo/4 pi) int_t^tau phi(t') e^(-(t'-t)/mu) dt'/mu; down likewise from the lit face.
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau; `mu` -1 to 1, positive towards the lit face
    /// # Errors
    /// `Error::OutOfRange` naming `t` or `mu`
    /// # Limits
    /// mu -> 0: the source function (albedo/4 pi) phi(t), which is the value given at mu = 0
    pub fn radiance(&self, t: f64, mu: f64) -> Result<Value> {
        check_depth(t, self.tau)?;
        check_mu(mu)?;
        let per_steradian = self.albedo / (4.0 * PI);
        if mu == 0.0 {
            return Ok(self.fluence(t)?.scaled(per_steradian));
        }
        let (mut value, mut error) = ray::integrate(&self.operator.mesh, t, mu, &self.smooth, &self.bound);
        if let Incidence::Beam { mu0 } = self.incidence {
            let single = beam_path(self.tau, mu0, t, mu);
            value += single;
            error += 2.0 * (t / mu0).min(750.0) * f64::EPSILON * single + f64::MIN_POSITIVE / mu0;
        }
        error += 2.0 * ULPS * f64::EPSILON * value + f64::MIN_POSITIVE;
        Ok(Value::new(value, error, METHOD).scaled(per_steradian))
    }

    /// (albedo/2) int E_1(|t-t'|) f(t') dt' and the same of a bound.
    fn through_kernel(&self, t: f64, f: &Halves, bound: &Halves) -> (f64, f64) {
        let half = 0.5 * self.albedo;
        if t <= 0.5 * self.tau {
            let row = self.operator.row(t);
            (half * row.apply(f), half * row.apply(bound))
        } else {
            let row = self.operator.row(self.tau - t);
            (half * row.apply_mirrored(f), half * row.apply_mirrored(bound))
        }
    }

    /// Adds what the polynomial leaves out, and roundings.
    fn with_direct(&self, t: f64, value: f64, bound: f64) -> Value {
        let mut rounding = ULPS * value.abs();
        let mut total = value;
        if let Incidence::Beam { mu0 } = self.incidence {
            let direct = direct_fluence(self.incidence, t);
            total += direct;
            // And the smallest steps of a subnormal exponential, magnified by 1/mu0.
            rounding += (ULPS + (t / mu0).min(750.0)) * direct + f64::MIN_POSITIVE / mu0;
        }
        Value::new(total, bound + rounding * f64::EPSILON + f64::MIN_POSITIVE, METHOD)
    }

    fn flux(&self, first: Value, kernel: impl Fn(f64, f64) -> f64) -> Value {
        flux_of(&self.operator, self.albedo, &self.smooth, &self.bound, first, kernel)
    }
}

/// Length of the first panel over min(tau/2, 1). In it t ln t is interpolated to about 1e-3 of the length, which
/// its width multiplies once more: 1e-7 leaves 1e-17. A grazing beam needs panels below its depth mu0.
fn first_panel(tau: f64, incidence: Incidence) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => (1e-5 * mu0 / (0.5 * tau).min(1.0)).clamp(1e-15, 1e-7),
        Incidence::Diffuse => 1e-7,
    }
}
