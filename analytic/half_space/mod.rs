//! The half-space with isotropic scattering: everything from Chandrasekhar's H function, in closed form or as one
//! integral of positive terms.
//!
//! The medium fills t > 0; light of unit irradiance falls on the face t = 0, or comes from infinitely deep (Milne's
//! problem). With w the albedo and k the root of w atanh(k)/k = 1,
//!
//! * ln H(mu) = -(mu/pi) int_0^inf ln(1 - w atan(x)/x) / (1 + mu^2 x^2) dx
//! * reflectance 1 - sqrt(1-w) H(mu0); radiance leaving (w/4 pi) H(mu) H(mu0)/(mu + mu0)
//! * fluence (H(mu0)/mu0) \[e^(-t/mu0) + int_0^t Phi(t') e^(-(t-t')/mu0) dt'\], with the resolvent Phi of which
//!   H - 1 is the Laplace transform: one exponential e^(-kt) and a continuum of faster ones
//! * Milne: the fluence grows like sinh(k (t + z0)), linearly for w = 1, where z0 is Hopf's 0.7104
//!
//! Limits: w -> 0, uncollided light and R = (w/2) (1 - mu0 ln(1 + 1/mu0)); w = 1, R = 1, fluence sqrt 3 H(mu0) deep
//! inside, H(1) = 2.9078. Neither limit loses digits: 1-w enters as it is, R and 1-R have a formula each.
//!
//! Source: Hopf 1934; Chandrasekhar 1960, chapter V; Stibbs and Weir 1959; Case and Zweifel 1967, chapter 6;
//! Sobolev 1975 for the resolvent.

pub(crate) mod decay;
mod h_function;
pub(crate) mod resolvent;
#[cfg(test)]
mod tests;

use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo};
use crate::quadrature::{GAUSS_16, GAUSS_24};
use crate::value::Value;
use decay::Decay;
use h_function::HFunction;
use libm::{atanh, exp, expm1, log, log1p};
use resolvent::{Resolvent, Sum, convolved, points, spectrum};
use std::f64::consts::{LN_2, PI};
use std::sync::OnceLock;

const CLOSED: &str = "closed form in H, H by the trapezoidal rule, step halved";
const SPECTRAL: &str = "spectral integral of positive terms, step halved";
const FACE: &str = "H integrated over the face, two rules";

/// A half-space of isotropic scattering: reflectance, radiance, fluence and flux at any depth, Milne's problem.
pub struct HalfSpace {
    albedo: f64,
    h: HFunction,
    decay: Decay,
    resolvent: OnceLock<Resolvent>,
}

/// Chandrasekhar's H function for isotropic scattering.
///
/// H(mu) = 1 + (albedo/2) mu H(mu) int_0^1 H(m)/(mu + m) dm.
/// # Arguments
/// `mu` 0 to 1e7; `albedo` 0 to 1
/// # Returns
/// \[1\], relative error below 1e-14
/// # Errors
/// `Error::OutOfRange` naming `mu` or `albedo`
/// # Limits
/// H(0) = 1; H(inf) = 1/sqrt(1-albedo)
/// # Source
/// Chandrasekhar 1960, chapter V; Stibbs and Weir 1959
pub fn h_function(mu: f64, albedo: f64) -> Result<Value> {
    HalfSpace::new(albedo)?.h(mu)
}

/// Hopf's constant 0.7104...: the extrapolation length of a half-space that absorbs nothing, in mean free paths.
pub fn hopf_constant() -> Value {
    length_by_spectrum(1.0, &Decay::new(1.0))
}

impl HalfSpace {
    /// A half-space.
    ///
    /// # Arguments
    /// `albedo` single-scattering albedo \[1\], 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`
    pub fn new(albedo: f64) -> Result<Self> {
        check_albedo(albedo)?;
        let (h, decay) = (HFunction::new(albedo), Decay::new(albedo));
        Ok(HalfSpace { albedo, h, decay, resolvent: OnceLock::new() })
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// H(mu) \[1\], 0 <= mu <= 1e7.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `mu`
    pub fn h(&self, mu: f64) -> Result<Value> {
        within("mu", mu, 0.0, 1e7, "0 to 1e7")?;
        Ok(self.h.h(mu))
    }

    /// int_0^1 mu^n H(mu) dmu \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `n` above 1000
    /// # Limits
    /// n = 0: 2/(1 + sqrt(1-albedo)); n = 1, albedo = 1: 2/sqrt 3
    pub fn moment(&self, n: u32) -> Result<Value> {
        within("n", f64::from(n), 0.0, 1000.0, "0 to 1000")?;
        if n == 0 {
            return Ok(Value::rounded(2.0 / (1.0 + (1.0 - self.albedo).sqrt()), 4.0, "closed form"));
        }
        let f = |mu: f64| {
            let (h, power) = (self.h.h(mu), mu.powi(n as i32));
            (power * h.value, power * h.error)
        };
        Ok(over_face(f))
    }

    /// Fraction of the incident power that comes back \[1\], with all its digits however small.
    ///
    /// 1 - sqrt(1-albedo) H(mu0); diffuse 1 - 2 sqrt(1-albedo) int_0^1 mu H dmu.
    /// # Errors
    /// `Error::OutOfRange` naming `mu0`
    /// # Limits
    /// albedo = 1: 1
    pub fn reflectance(&self, incidence: Incidence) -> Result<Value> {
        incidence.check()?;
        if self.albedo == 1.0 {
            return Ok(Value::new(1.0, 0.0, CLOSED));
        }
        Ok(match incidence {
            Incidence::Beam { mu0 } => self.plane_reflectance(mu0),
            Incidence::Diffuse => over_face(|mu| {
                let r = self.plane_reflectance(mu);
                (2.0 * mu * r.value, 2.0 * mu * r.error)
            }),
        })
    }

    /// Fraction of the incident power that is absorbed \[1\], with all its digits however small.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `mu0`
    pub fn absorptance(&self, incidence: Incidence) -> Result<Value> {
        incidence.check()?;
        if self.albedo == 1.0 {
            return Ok(Value::new(0.0, 0.0, CLOSED));
        }
        match incidence {
            Incidence::Beam { mu0 } => {
                let (log, error) = self.log_absorptance(mu0);
                let value = exp(log);
                Ok(Value::new(value, value * (error + 2.0 * f64::EPSILON), CLOSED))
            }
            Incidence::Diffuse => Ok(self.moment(1)?.scaled(2.0 * (1.0 - self.albedo).sqrt())),
        }
    }

    /// Radiance that leaves the face in the direction of cosine `mu` \[1/sr\].
    ///
    /// (albedo/4 pi) H(mu) H(mu0)/(mu + mu0); diffuse R(mu)/pi.
    /// # Arguments
    /// `mu` cosine to the outward normal, 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `mu0` or `mu`
    pub fn radiance(&self, incidence: Incidence, mu: f64) -> Result<Value> {
        incidence.check()?;
        within("mu", mu, 0.0, 1.0, "0 to 1, out of the face")?;
        Ok(match incidence {
            Incidence::Beam { mu0 } => {
                let (h, h0) = (self.h.h(mu), self.h.h(mu0));
                let value = self.albedo / (4.0 * PI) * h.value * h0.value / (mu + mu0);
                let relative = h.error / h.value + h0.error / h0.value + 6.0 * f64::EPSILON;
                Value::new(value, value * relative, CLOSED)
            }
            Incidence::Diffuse if self.albedo == 1.0 => Value::rounded(1.0 / PI, 2.0, CLOSED),
            Incidence::Diffuse => self.plane_reflectance(mu).scaled(1.0 / PI),
        })
    }

    /// Fluence at depth t, direct light included, per unit irradiance on the face \[1\].
    ///
    /// # Arguments
    /// `t` depth in mean free paths, 0 or more; a beam with a cosine of 1e-12 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `mu0` or `t`
    /// # Limits
    /// t = 0: H(mu0)/mu0, diffuse 4/(1 + sqrt(1-albedo)); albedo = 1, deep: sqrt 3 H(mu0), diffuse 4
    pub fn fluence(&self, incidence: Incidence, t: f64) -> Result<Value> {
        self.inside(incidence, t, |_, _| 1.0, |_| 1.0, |_, convolved, _| convolved)
    }

    /// Net flux downwards at depth t, direct light included, per unit irradiance on the face \[1\].
    ///
    /// (1-albedo) times the integral of the fluence from t on.
    /// # Arguments
    /// As for [`Self::fluence`]
    /// # Errors
    /// `Error::OutOfRange` naming `mu0` or `t`
    /// # Limits
    /// t = 0: the absorptance
    pub fn flux(&self, incidence: Incidence, t: f64) -> Result<Value> {
        let absorbed = 1.0 - self.albedo;
        // (1-w)/k stays finite at w = 1.
        let over = |x: f64, slowest: bool| {
            if slowest { absorbed.sqrt() * self.decay.ratio } else { absorbed / x }
        };
        self.inside(
            incidence,
            t,
            over,
            |b| absorbed / b,
            |over_x, convolved, direct_over_b| over_x * (convolved + direct_over_b),
        )
    }

    /// Decay k of light deep inside \[1/mfp\], the root of albedo atanh(k)/k = 1.
    pub fn decay(&self) -> Value {
        Value::rounded(self.decay.k, 8.0, "Newton's method, no cancellation")
    }

    /// Milne's extrapolation length z0 in mean free paths: deep inside, light that comes from infinity is
    /// proportional to sinh(k (t + z0)), or t + z0 for albedo 1.
    ///
    /// e^(-2 k z0) = (1-k^2) / (2 (k^2+w-1) H(1/k)^2), or as an integral over the continuum of decays.
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` below 1e-300, where no light comes from infinity
    /// # Limits
    /// albedo = 1: Hopf's constant; albedo -> 0: 1/albedo
    /// # Source
    /// Case, de Hoffmann and Placzek 1953, section 19; Case and Zweifel 1967, section 6.6
    pub fn extrapolation_length(&self) -> Result<Value> {
        within("albedo", self.albedo, 1e-300, 1.0, "1e-300 to 1 for Milne's problem")?;
        Ok(if self.albedo < 0.5 { self.length_by_h() } else { length_by_spectrum(self.albedo, &self.decay) })
    }

    /// Milne's problem: radiance that leaves the face for a unit of power leaving per area \[1/sr\].
    ///
    /// w k H(mu) / (4 pi sqrt(1-w) (1 - k mu)).
    /// # Arguments
    /// `mu` cosine to the outward normal, 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `mu`, or `albedo` below 0.01
    /// # Limits
    /// albedo = 1: sqrt 3 H(mu)/(4 pi)
    pub fn milne_radiance(&self, mu: f64) -> Result<Value> {
        within("mu", mu, 0.0, 1.0, "0 to 1, out of the face")?;
        self.check_milne()?;
        let h = self.h.h(mu);
        let scale = self.albedo / (4.0 * PI * self.decay.ratio * self.decay.one_minus(mu));
        // 1 - k carries 2b times the rounding of b.
        let rounding = (16.0 + 4.0 * self.decay.b) * f64::EPSILON;
        Ok(Value::new(scale * h.value, scale * (h.error + h.value * rounding), CLOSED))
    }

    /// Milne's problem: fluence at depth t for a unit of power leaving per area \[1\].
    ///
    /// (k/sqrt(1-w)) e^(kt) \[1 + int_0^t Phi(t') e^(-kt') dt'\].
    /// # Arguments
    /// `t` depth in mean free paths, 0 to 1e4 and at most 700/k
    /// # Errors
    /// `Error::OutOfRange` naming `t`, or `albedo` below 0.01
    /// # Limits
    /// albedo = 1: 3 (t + q(t)), q Hopf's function from 1/sqrt 3 to 0.7104
    pub fn milne_fluence(&self, t: f64) -> Result<Value> {
        self.check_milne()?;
        let k = self.decay.k;
        within("t", t, 0.0, if k * 1e4 > 700.0 { 700.0 / k } else { 1e4 }, "0 to 1e4 and at most 700/k")?;
        let resolvent = self.resolvent();
        let mode = resolvent.mode.0 * convolved(2.0 * k, 0.0, t);
        let mut sum = Sum::default();
        for (i, &(x, strength)) in resolvent.continuum.iter().enumerate() {
            sum.add(i, 0.5 * self.albedo * strength * convolved(x + k, 0.0, t), 0.0);
        }
        let (continuum, error) = sum.value();
        let scale = exp(k * t) / self.decay.ratio;
        let value = scale * (1.0 + mode + continuum);
        let rounding = (24.0 + 4.0 * k * t + 4.0 * self.decay.b) * f64::EPSILON;
        Ok(Value::new(value, scale * error + rounding * value, SPECTRAL))
    }

    fn check_milne(&self) -> Result<f64> {
        within("albedo", self.albedo, 0.01, 1.0, "0.01 to 1 for Milne's problem")
    }

    /// The slowest decay.
    pub(crate) fn slowest(&self) -> &Decay {
        &self.decay
    }

    pub(crate) fn resolvent(&self) -> &Resolvent {
        self.resolvent.get_or_init(|| Resolvent::new(self.albedo, &self.h, &self.decay))
    }

    /// ln(sqrt(1-albedo) H(mu)) and its error, albedo < 1.
    fn log_absorptance(&self, mu: f64) -> (f64, f64) {
        let (log, error) = self.h.log(mu);
        let root = 0.5 * log1p(-self.albedo);
        (log + root, error + 4.0 * f64::EPSILON * (log + root.abs()))
    }

    fn plane_reflectance(&self, mu: f64) -> Value {
        let (log, error) = self.log_absorptance(mu);
        let value = -expm1(log);
        let bound = (1.0 - value) * error + 2.0 * f64::EPSILON * value;
        Value::new(value, bound + f64::MIN_POSITIVE, CLOSED)
    }

    /// A sum over the decays x of the light at depth t. For a beam the part of decay x is
    /// `part`(`over`(x), c(x), d `beam`(b)) with b = 1/mu0, d = e^(-bt) and c their convolution.
    fn inside(
        &self,
        incidence: Incidence,
        t: f64,
        over: impl Fn(f64, bool) -> f64,
        beam: impl Fn(f64) -> f64,
        part: impl Fn(f64, f64, f64) -> f64,
    ) -> Result<Value> {
        if let Incidence::Beam { mu0 } = incidence {
            within("mu0", mu0, 1e-12, 1.0, "1e-12 to 1 inside a half-space, or diffuse")?;
        }
        within("t", t, 0.0, f64::MAX, "0 or more")?;
        let (w, resolvent) = (self.albedo, self.resolvent());
        let (mode, k) = resolvent.mode;
        let mut sum = Sum::default();
        match incidence {
            Incidence::Beam { mu0 } => {
                let b = 1.0 / mu0;
                let direct = exp(-t * b);
                let behind = direct / b;
                for (i, &(x, strength)) in resolvent.continuum.iter().enumerate() {
                    let c = convolved(x, b, t);
                    sum.add(i, 0.5 * w * strength * part(over(x, false), c, behind), x.min(b) * t);
                }
                let (continuum, error) = sum.value();
                let slow = mode * part(over(k, true), convolved(k, b, t), behind);
                let own = direct * beam(b);
                let h = self.h.h(mu0);
                let total = own + slow + continuum;
                // The mode's strength carries the roundings of k, of 1 - k^2 and of H(1/k).
                let rounding = own * (4.0 + (t * b).min(750.0))
                    + slow * (64.0 + 8.0 * self.decay.b.min(400.0) + 8.0 * (k * t).min(750.0));
                let bound = error + f64::EPSILON * rounding + 1e-17 * w * own;
                let scale = h.value * b;
                let relative = h.error / h.value + 4.0 * f64::EPSILON;
                let error = scale * bound + relative * scale * total + f64::MIN_POSITIVE * b;
                Ok(Value::new(scale * total, error, SPECTRAL))
            }
            Incidence::Diffuse => {
                let absorbed = (1.0 - w).sqrt();
                for (i, &(x, strength)) in resolvent.continuum.iter().enumerate() {
                    let light = exp(-x * t) / x * over_depth(&over, &beam, x, false);
                    sum.add(i, 2.0 * absorbed * strength * light, x * t);
                }
                let (continuum, error) = sum.value();
                // C/w times sqrt(1-w)/k; for small w C vanishes like e^(-2/w).
                let slow = if mode == 0.0 {
                    0.0
                } else {
                    4.0 * mode / w * self.decay.ratio * exp(-k * t) * over_depth(&over, &beam, k, true)
                };
                let value = continuum + slow;
                let rounding = slow * (64.0 + 8.0 * self.decay.b.min(400.0) + 8.0 * (k * t).min(750.0));
                Ok(Value::new(value, error + f64::EPSILON * rounding + 1e-17, SPECTRAL))
            }
        }
    }

    fn length_by_h(&self) -> Value {
        let d = &self.decay;
        let (log_h, error) = self.h.log(1.0 / d.k);
        let terms = [LN_2, log(d.excess), 2.0 * log_h, d.log_gap()];
        let sum: f64 = terms.iter().sum();
        let magnitude: f64 = terms.iter().map(|x| x.abs()).sum();
        let error = 2.0 * error + 8.0 * f64::EPSILON * (magnitude + 1.0);
        Value::new(sum / (2.0 * d.k), error / d.k, CLOSED)
    }
}

/// What a decay x contributes to a diffuse answer: 1 to the fluence, (1-w)/x to the flux.
fn over_depth(over: &impl Fn(f64, bool) -> f64, beam: &impl Fn(f64) -> f64, x: f64, slowest: bool) -> f64 {
    if slowest { over(x, true) } else { beam(x) }
}

/// z0 = (w/2k) int_0^1 \[1 + w mu^2/(1-mu^2)\] atanh(k mu) / ((1 - w mu atanh mu)^2 + (pi w mu/2)^2) dmu.
fn length_by_spectrum(albedo: f64, decay: &Decay) -> Value {
    let mut sum = Sum::default();
    for (i, point) in points(resolvent::TO_INFINITY).enumerate() {
        let inverse = if decay.k == 0.0 { point.nu } else { atanh(decay.k * point.nu) / decay.k };
        let density = point.weight + albedo * point.nu * point.nu * point.step;
        sum.add(i, 0.5 * albedo * density * spectrum(albedo, point) * inverse, 0.0);
    }
    let (value, error) = sum.value();
    // What lies beyond the last point is below w/2 int da/(w a^2) atanh(k)/k with a = e^40.
    Value::new(value, error + 1e-16 + 16.0 * f64::EPSILON * value, SPECTRAL)
}

/// int_0^1 f dmu for an f like mu ln mu at 0, from values and errors: panels that shrink fourfold, and two rules.
fn over_face(f: impl Fn(f64) -> (f64, f64)) -> Value {
    let (mut value, mut difference, mut error) = (0.0, 0.0, 0.0);
    for i in 0..=14 {
        let (low, high) =
            (if i == 14 { 0.0 } else { libm::ldexp(1.0, -2 * i - 2) }, libm::ldexp(1.0, -2 * i));
        let fine = GAUSS_24.integrate(low, high, |mu| f(mu).0);
        difference += (fine - GAUSS_16.integrate(low, high, |mu| f(mu).0)).abs();
        error += GAUSS_16.integrate(low, high, |mu| f(mu).1);
        value += fine;
    }
    // The bounds of f vary little over a panel.
    Value::new(value, difference + 2.0 * error + 16.0 * f64::EPSILON * value + f64::MIN_POSITIVE, FACE)
}
