//! Two streams and diffusion: the approximations that are used everywhere, so that one can see how wrong they are.
//!
//! The radiance is replaced by one flux up, F+, and one down, F-. With s = F+ + F-, d = F+ - F-, b = 1/mu0 and unit
//! irradiance,
//!
//! ds/dt = c_s d - w b D e^(-bt),  dd/dt = c_d s - w b e^(-bt)  (no sources for diffuse light)
//!
//! | method | c_d | c_s | D | fluence | no light from outside |
//! |---|---|---|---|---|---|
//! | Eddington | 2 (1-w) | (3/2)(1-wg) | -(3/2) g mu0 | 2 s | s = -+d |
//! | quadrature (two Gauss directions) | sqrt 3 (1-w) | sqrt 3 (1-wg) | -sqrt 3 g mu0 | sqrt 3 s | s = -+d |
//! | diffusion | as Eddington | | | | s = -+1.0657 d: the field vanishes 0.7104/(1-wg) outside |
//! | delta-Eddington | Eddington after a share g^2 of all scattering has been declared straight on | | | | |
//!
//! Exact are: power balance, w = 0 for a beam, and for the first two light that has the assumed shape. Nothing here has
//! a bound: the numbers are [`Approximation`]s, and [`compare`] puts them beside the exact ones.
//!
//! Source: Eddington 1916; Joseph, Wiscombe and Weinman 1976 for delta; Meador and Weaver 1980 for the family.

#[cfg(test)]
mod tests;

use crate::error::{Result, within};
use crate::half_space::hopf_constant;
use crate::incidence::{Incidence, check_albedo, check_depth};
use crate::slab_anisotropic::AnisotropicSlab;
use crate::value::Value;
use libm::{exp, tanh};

/// A number that is no more than a model's opinion: it has no bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approximation {
    /// The number, in the unit that its function states.
    pub value: f64,
    /// Which approximation.
    pub method: &'static str,
}

/// An approximation beside the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The approximation.
    pub approximation: Approximation,
    /// The truth, with its bound.
    pub exact: Value,
    /// Approximation over truth less 1 \[1\]; NaN never: 0 if both vanish, infinite if only the truth does.
    pub relative_error: f64,
}

impl Comparison {
    /// Puts an approximation beside the truth.
    pub fn new(approximation: Approximation, exact: Value) -> Self {
        let difference = approximation.value - exact.value;
        let relative_error = if difference == 0.0 { 0.0 } else { difference / exact.value };
        Comparison { approximation, exact, relative_error }
    }
}

/// Which approximation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Radiance linear in the cosine.
    Eddington,
    /// Light in the two directions of Gauss's rule, cosines +-1/sqrt 3.
    Quadrature,
    /// Eddington, the forward peak counted as straight on.
    DeltaEddington,
    /// Diffusion that vanishes at the extrapolated boundary.
    Diffusion,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 4] =
        [Method::Eddington, Method::Quadrature, Method::DeltaEddington, Method::Diffusion];

    /// As it is called.
    pub fn name(self) -> &'static str {
        match self {
            Method::Eddington => "Eddington approximation",
            Method::Quadrature => "two-stream approximation, quadrature",
            Method::DeltaEddington => "delta-Eddington approximation",
            Method::Diffusion => "diffusion, extrapolated boundary",
        }
    }
}

/// A slab or half-space in one of the approximations.
#[derive(Debug, Clone)]
pub struct TwoStream {
    method: Method,
    /// Thickness, mean free paths, and how many of the approximation's go into one.
    tau: f64,
    stretch: f64,
    /// c_s, and fluence over s.
    slope: f64,
    fluence: f64,
    k: f64,
    /// Amplitudes of the two solutions without sources.
    first: f64,
    second: f64,
    beam: Vec<Particular>,
    /// Irradiance by diffuse light.
    diffuse: f64,
}

/// s = x e^(-bt), d = y e^(-bt), from direct light `direct` e^(-bt).
#[derive(Debug, Clone, Copy)]
struct Particular {
    b: f64,
    x: f64,
    y: f64,
    direct: f64,
}

impl TwoStream {
    /// A slab.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 1e12; `albedo` 0 to 1; `g` mean cosine of scattering, -1 to 1;
    /// `incidence` of unit irradiance
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo`, `g` or `mu0`
    pub fn slab(method: Method, tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Result<Self> {
        within("tau", tau, 1e-12, 1e12, "1e-12 to 1e12")?;
        Self::new(method, tau, albedo, g, incidence)
    }

    /// All of space below the lit face.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`, `g` or `mu0`
    pub fn half_space(method: Method, albedo: f64, g: f64, incidence: Incidence) -> Result<Self> {
        Self::new(method, f64::INFINITY, albedo, g, incidence)
    }

    fn new(method: Method, tau: f64, albedo: f64, g: f64, incidence: Incidence) -> Result<Self> {
        check_albedo(albedo)?;
        within("g", g, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, "above -1, below 1")?;
        incidence.check()?;
        let mut lost = 1.0 - albedo;
        let (mut w, mut g, mut stretch) = (albedo, g, 1.0);
        if method == Method::DeltaEddington {
            let f = g * g;
            stretch = 1.0 - f * albedo;
            (w, lost, g) = ((1.0 - f) * albedo / stretch, lost / stretch, g / (1.0 + g));
        }
        let root = 3f64.sqrt();
        let (fall, slope, turn, fluence) = match method {
            Method::Quadrature => (root * lost, root * (1.0 - w * g), root, root),
            _ => (2.0 * lost, 1.5 * (1.0 - w * g), 1.5, 2.0),
        };
        // Diffusion: s -+ 1.5 (1-wg) z d with z = 0.7104/(1-wg).
        let reach = if method == Method::Diffusion { 1.5 * hopf_constant().value } else { 1.0 };
        let k = (fall * slope).sqrt();
        let particular = |b: f64, share: f64| {
            // b D = -turn g; for b = k see below.
            let x = share * w * b * (-turn * g - slope) / (b * b - k * k);
            Particular { b, x, y: share * w - fall * x / b, direct: share * b }
        };
        let beam = match incidence {
            Incidence::Diffuse => vec![],
            Incidence::Beam { mu0 } => {
                let b = 1.0 / mu0;
                // At b = k the solution is t e^(-bt), which is the mean of two neighbours to 1e-8.
                if (b - k).abs() < 1e-4 * k {
                    vec![particular(k * (1.0 + 2e-4), 0.5), particular(k * (1.0 - 2e-4), 0.5)]
                } else {
                    vec![particular(b, 1.0)]
                }
            }
        };
        let depth = tau * stretch;
        // What must enter: s - reach d = top on the lit face, s + reach d = bottom on the other.
        let (mut top, mut bottom) = (if beam.is_empty() { 2.0 } else { 0.0 }, 0.0);
        for p in &beam {
            top -= p.x - reach * p.y;
            bottom -= (p.x + reach * p.y) * exp(-p.b * depth);
        }
        let (first, second) = if k * depth > 1.0 {
            // e^(-kt) and e^(-k(tau-t)).
            let (e, rho) = (exp(-k * depth), reach * k / slope);
            let (near, far) = (1.0 + rho, e * (1.0 - rho));
            let det = near * near - far * far;
            ((near * top - far * bottom) / det, (near * bottom - far * top) / det)
        } else if depth == f64::INFINITY {
            // Nothing is absorbed: s is constant.
            (top, 0.0)
        } else {
            // cosh(ku)/cosh(k tau/2) and sinh(ku)/(k cosh(k tau/2)), u = t - tau/2.
            let half = half_width(k, depth);
            (
                (top + bottom) / (2.0 * (1.0 + reach * fall * half)),
                (bottom - top) / (2.0 * (half + reach / slope)),
            )
        };
        let diffuse = if beam.is_empty() { 1.0 } else { 0.0 };
        Ok(TwoStream { method, tau, stretch, slope, fluence, k, first, second, beam, diffuse })
    }

    /// Fraction of the incident power that leaves through the lit face \[1\].
    pub fn reflectance(&self) -> Approximation {
        self.named(self.diffuse + self.at(0.0)[1])
    }

    /// Fraction of the incident power that leaves through the far face, direct light included \[1\].
    pub fn transmittance(&self) -> Approximation {
        let depth = self.tau * self.stretch;
        if depth == f64::INFINITY {
            return self.named(0.0);
        }
        let direct: f64 = self.beam.iter().map(|p| p.direct / p.b * exp(-p.b * depth)).sum();
        self.named(direct - self.at(depth)[1])
    }

    /// Fraction of the incident power that is absorbed \[1\]: what is left.
    pub fn absorptance(&self) -> Approximation {
        self.named(1.0 - self.reflectance().value - self.transmittance().value)
    }

    /// Fluence at depth t, direct light included, per unit irradiance on the lit face \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 to tau
    /// # Errors
    /// `Error::OutOfRange` naming `t`
    pub fn fluence(&self, t: f64) -> Result<Approximation> {
        check_depth(t, self.tau.min(f64::MAX))?;
        let t = t * self.stretch;
        let direct: f64 = self.beam.iter().map(|p| p.direct * exp(-p.b * t)).sum();
        Ok(self.named(self.fluence * self.at(t)[0] + direct))
    }

    fn named(&self, value: f64) -> Approximation {
        Approximation { value, method: self.method.name() }
    }

    /// s and d.
    fn at(&self, t: f64) -> [f64; 2] {
        let (k, depth) = (self.k, self.tau * self.stretch);
        let rest = depth - t;
        let (shape, tilt) = if k * depth > 1.0 {
            let (down, up) = (self.first * exp(-k * t), self.second * exp(-k * rest));
            (down + up, k * (up - down))
        } else if depth == f64::INFINITY {
            (self.first, 0.0)
        } else {
            let u = 0.5 * (t - rest);
            let (cosh, over) =
                (libm::cosh(0.5 * k * depth), if k == 0.0 { u } else { libm::sinh(k * u) / k });
            let even = libm::cosh(k * u);
            (
                (self.first * even + self.second * over) / cosh,
                (self.first * k * k * over + self.second * even) / cosh,
            )
        };
        let particular = self.beam.iter().fold([0.0; 2], |[s, d], p| {
            let e = exp(-p.b * t);
            [s + p.x * e, d + p.y * e]
        });
        [shape + particular[0], tilt / self.slope + particular[1]]
    }
}

/// Reflectance, transmittance (direct light included) and absorptance of a slab with Henyey-Greenstein scattering, in
/// one of the approximations and exactly.
///
/// # Arguments
/// Those of [`AnisotropicSlab::new`]
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn compare(
    method: Method,
    tau: f64,
    albedo: f64,
    g: f64,
    incidence: Incidence,
) -> Result<[Comparison; 3]> {
    let (model, exact) = (
        TwoStream::slab(method, tau, albedo, g, incidence)?,
        AnisotropicSlab::new(tau, albedo, g, incidence)?,
    );
    Ok([
        Comparison::new(model.reflectance(), exact.reflectance()),
        Comparison::new(model.transmittance(), exact.transmittance()),
        Comparison::new(model.absorptance(), exact.absorptance()),
    ])
}

/// tanh(k tau/2)/k.
fn half_width(k: f64, tau: f64) -> f64 {
    if k * tau == 0.0 { 0.5 * tau } else { tanh(0.5 * k * tau) / k }
}
