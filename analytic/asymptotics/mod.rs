//! Thick slabs, of any thickness: what half-spaces and the slowest decay say about them.
//!
//! Deep inside, light decays as P(u) e^(-kt), u the cosine to the direction of decay and k the slowest decay of the
//! medium, (1 - ku) P(u) = w sum (2l+1) chi_l f_l P_l(u), of mean 1 over all directions. With unit irradiance from mu0
//! the fluence of a half-space tends to 4 K(mu0) e^(-kt), and for a slab
//!
//! * T = m n K e^(-k tau)/(1 - l^2 e^(-2k tau)), R = R_inf - l e^(-k tau) T
//! * m = 2 int_-1^1 u P^2 du, n = 2 int_0^1 u K du, l = 2 int_0^1 u K(u) P(-u) du = e^(-2kz), z Milne's length
//! * w = 1: T = (4/3) K/((1-g)(tau + 2z)), R = 1 - T
//!
//! where T includes direct light. What is left out are the faster decays, k2 and beyond, where k2 is the next discrete
//! one or 1: T is relatively wrong by some e^(-(k2-k) tau), R absolutely by e^(-(k2+k) tau). The bound of every answer
//! is computed from the faster light itself: the half-space's at depth tau, and that which a wave from infinity
//! leaves in a layer tau below a face.
//!
//! Isotropic scattering in closed form by H; any other phase function by discrete ordinates, on two sets of nodes.
//!
//! Thin slabs scatter once: [`thin_slab`] gives the closed form and a bound on the rest.
//!
//! Source: van de Hulst 1980, chapter 5; Sobolev 1975, chapter 3.

mod closed;
mod entrance;
mod ordinates;
#[cfg(test)]
mod tests;
mod thin;

use crate::error::{Result, within};
use crate::half_space::HalfSpace;
use crate::incidence::Incidence;
use crate::infinite::modes::{Mode, Recurrence};
use crate::infinite::moments_of;
use crate::phase::Phase;
use crate::slab_anisotropic::AnisotropicMedium;
use crate::value::Value;
use entrance::{Entrance, METHOD};
use libm::{exp, expm1};
pub use thin::{ThinSlab, thin_slab};

const PATTERN: &str = "recurrence of the slowest decay";

/// The constants of thick layers of one medium.
pub struct Asymptotics {
    albedo: f64,
    moments: Vec<f64>,
    recurrence: Recurrence,
    slowest: Mode,
    second: f64,
    faces: Faces,
    /// ln l / 2k, with its sign changed: Milne's length z.
    length: Value,
    /// n.
    diffuse: Value,
}

/// How half-spaces are solved.
enum Faces {
    Closed(Box<HalfSpace>),
    Ordinates(ordinates::Ordinates),
}

/// A slab by asymptotics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThickSlab {
    /// Fraction of the incident power that leaves through the lit face \[1\].
    pub reflectance: Value,
    /// Fraction that leaves through the far face, direct light included \[1\].
    pub transmittance: Value,
    /// Fraction that is absorbed \[1\].
    pub absorptance: Value,
}

impl Asymptotics {
    /// Isotropic scattering, in closed form.
    ///
    /// # Arguments
    /// `albedo` \[1\], 0.1 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`: below 0.1, 1-k < 1e-8 and the slowest decay never stands out
    pub fn isotropic(albedo: f64) -> Result<Self> {
        within("albedo", albedo, 0.1, 1.0, "0.1 to 1 for a slowest decay")?;
        let space = HalfSpace::new(albedo)?;
        let (length, diffuse) = (space.extrapolation_length()?, closed::diffuse(&space));
        Self::of(albedo, &Phase::isotropic(), Faces::Closed(Box::new(space)), length, diffuse)
    }

    /// Any phase function, by discrete ordinates.
    ///
    /// # Arguments
    /// `albedo` \[1\], 0.1 to 1; `phase` as for [`AnisotropicMedium::new`]
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` (also where no decay is slower than 0.98), `phase function` or `moment`
    pub fn new(albedo: f64, phase: &Phase) -> Result<Self> {
        within("albedo", albedo, 0.1, 1.0, "0.1 to 1 for a slowest decay")?;
        let ordinates = ordinates::Ordinates::new(AnisotropicMedium::new(albedo, phase)?)?;
        let length = ordinates.length();
        let diffuse = ordinates.diffuse()?;
        Self::of(albedo, phase, Faces::Ordinates(ordinates), length, diffuse)
    }

    fn of(albedo: f64, phase: &Phase, faces: Faces, length: Value, diffuse: Value) -> Result<Self> {
        let moments = moments_of(albedo, phase)?;
        let recurrence = Recurrence::new(albedo, &moments);
        let modes = recurrence.modes();
        let none = Mode { k: 1.0, strength: 0.0 };
        let slowest = *modes.first().unwrap_or(&none);
        if let Faces::Ordinates(_) = faces {
            within(
                "albedo",
                albedo,
                if slowest.k < 0.999 { 0.1 } else { 2.0 },
                1.0,
                "those with a slowest decay below 0.999, of isotropic scattering from 0.263 on",
            )?;
        }
        let second = modes.get(1).unwrap_or(&none).k;
        Ok(Asymptotics { albedo, moments, recurrence, slowest, second, faces, length, diffuse })
    }

    /// k: the slowest decay \[1/mfp\].
    pub fn decay(&self) -> Value {
        Value::rounded(self.slowest.k, self.roundings(), PATTERN)
    }

    /// k2: the next decay \[1/mfp\], or 1 where the continuum begins.
    pub fn second_decay(&self) -> Value {
        Value::rounded(self.second, self.roundings(), PATTERN)
    }

    /// P(u): radiance deep inside towards cosine `u` to the direction of decay, of mean 1.
    ///
    /// # Arguments
    /// `u` -1 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `u`
    /// # Limits
    /// albedo = 1: 1; isotropic w/(1 - ku)
    pub fn pattern(&self, u: f64) -> Result<Value> {
        within("u", u, -1.0, 1.0, "-1 to 1")?;
        if self.slowest.k == 0.0 {
            return Ok(Value::new(1.0, 0.0, PATTERN));
        }
        let (mut sum, mut size) = (0.0, 0.0);
        let (mut before, mut p) = (0.0, 1.0);
        for (l, (f, chi)) in self.recurrence.pattern(self.slowest.k).iter().zip(&self.moments).enumerate() {
            let n = l as f64;
            let term = (2.0 * n + 1.0) * chi * f * p;
            sum += term;
            size += (2.0 * n + 1.0) * (chi * f).abs();
            (before, p) = (p, ((2.0 * n + 1.0) * u * p - n * before) / (n + 1.0));
        }
        let scale = self.albedo / (1.0 - self.slowest.k * u);
        let relative = self.roundings() / (1.0 - self.slowest.k * u.abs());
        Ok(Value::new(scale * sum, scale * size * relative * f64::EPSILON, PATTERN))
    }

    /// m = 2 int_-1^1 u P^2 du \[1\].
    pub fn m(&self) -> Value {
        Value::rounded(8.0 * self.slowest.k / self.slowest.strength, 4.0 * self.roundings(), PATTERN)
    }

    /// n = 2 int_0^1 u K du \[1\], which is K for diffuse light.
    pub fn n(&self) -> Value {
        self.diffuse
    }

    /// l = 2 int_0^1 u K(u) P(-u) du \[1\]: how much of a decaying wave a face turns back.
    pub fn l(&self) -> Value {
        let value = exp(-2.0 * self.slowest.k * self.length.value);
        let error = 2.0 * self.slowest.k * self.length.error * (1.0 + self.slowest.k * self.length.error);
        Value::new(value, value * (error + self.roundings() * f64::EPSILON), METHOD)
    }

    /// Milne's extrapolation length z \[mfp\]: light from infinitely deep grows like sinh(k (t + z)).
    ///
    /// # Limits
    /// albedo = 1: (1-g) z is 0.7104 to 0.7150 for g >= 0
    pub fn extrapolation_length(&self) -> Value {
        self.length
    }

    /// K: a quarter of the fluence of the half-space that decays slowest, carried back to the face \[1\].
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `mu0`
    /// # Limits
    /// albedo = 1, isotropic: (sqrt 3/4) H(mu0)
    pub fn escape(&self, incidence: Incidence) -> Result<Value> {
        Ok(self.entrance(incidence, f64::INFINITY)?.0.escape)
    }

    /// A slab of thickness `tau`.
    ///
    /// # Arguments
    /// `tau` \[1\], 1 to 1e15; `incidence` of unit irradiance, a beam with a cosine of 1e-5 to 1
    /// # Returns
    /// fluxes with bounds that say how much the faster decays may still do; in thin slabs these are as large as the
    /// answer
    /// # Errors
    /// `Error::OutOfRange` naming `tau` or `mu0`
    pub fn slab(&self, tau: f64, incidence: Incidence) -> Result<ThickSlab> {
        within("tau", tau, 1.0, 1e15, "1 to 1e15 by asymptotics")?;
        let (entrance, faster, echo) = self.entrance(incidence, tau)?;
        let Mode { k, strength } = self.slowest;
        let (escape, n, z) = (entrance.escape, self.diffuse, self.length);
        // m/(1 - l^2 e^(-2k tau)) with m = 8k/N, l^2 e^(-2k tau) = e^(-2k (tau + 2z)).
        let around = tau + 2.0 * z.value;
        let passes = if k == 0.0 {
            4.0 / (strength * around)
        } else {
            8.0 * k / (-expm1(-2.0 * k * around) * strength)
        };
        let e = exp(-k * tau);
        let value = passes * n.value * escape.value * e;
        let roundings = self.roundings() * (8.0 + (k * tau).min(750.0));
        let relative = escape.error / escape.value
            + n.error / n.value
            + 4.0 * z.error / around
            + roundings * f64::EPSILON;
        // Faster light crosses beside the slow; what the far face turns back arrives at the lit one, and round again.
        let slope = value * strength / n.value;
        let transmittance = Value::new(
            value,
            value * relative + 2.0 * faster + 2.0 * value * strength * echo + f64::MIN_POSITIVE,
            METHOD,
        );
        let l = self.l();
        let turned = l.value * e * value;
        let turned_error = (l.error / l.value + roundings * f64::EPSILON) * turned
            + l.value * e * transmittance.error
            + 2.0 * (slope + faster) * echo
            + f64::MIN_POSITIVE;
        let reflected = entrance.reflected.value - turned;
        let reflectance = Value::new(
            reflected,
            entrance.reflected.error + turned_error + f64::EPSILON * reflected.abs(),
            METHOD,
        );
        let absorptance = if self.albedo == 1.0 {
            Value::new(0.0, 0.0, METHOD)
        } else {
            let absorbed = entrance.absorbed.value + turned - value;
            let error = entrance.absorbed.error + turned_error + transmittance.error;
            Value::new(absorbed.max(0.0), error + 2.0 * f64::EPSILON * entrance.absorbed.value, METHOD)
        };
        Ok(ThickSlab { reflectance, transmittance, absorptance })
    }

    /// The half-space, a bound on the flux of its faster light at depth `tau`, and one on the flux at a face of the
    /// faster light that a wave of unit slope of fluence, from infinity, leaves `tau` away.
    fn entrance(&self, incidence: Incidence, tau: f64) -> Result<(Entrance, f64, f64)> {
        if let Incidence::Beam { mu0 } = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1, or diffuse")?;
        }
        match &self.faces {
            Faces::Closed(space) => closed::entrance(space, incidence, tau),
            Faces::Ordinates(ordinates) => {
                let entered = ordinates.entrance(incidence)?;
                let faster = ordinates.faster(&entered.solutions, tau);
                Ok((entered.entrance, faster, ordinates.echo(tau)))
            }
        }
    }

    /// Roundings of a decay: each of the recurrence's steps may add a few.
    fn roundings(&self) -> f64 {
        16.0 + 4.0 * self.recurrence.h.len() as f64
    }
}
