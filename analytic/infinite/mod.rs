//! A point source in unbounded fog: fluence and flux at any distance, any phase function, all orders of scattering.
//!
//! An isotropic source of unit power stands at r = 0; w is the albedo, chi_l are the Legendre moments of the phase
//! function, h_l = (2l+1)(1 - w chi_l). The Fourier transform of the fluence is a continued fraction, and deforming
//! the integral that inverts it to the poles and the cut gives a sum of positive terms,
//!
//! * int phi(r) e^(i s.r) d^3r = 1/(h_0 + s^2/(h_1 + 4 s^2/(h_2 + 9 s^2/(h_3 + ...))))
//! * phi(r) = (1/4 pi r) \[sum_j N_j e^(-k_j r) + int_0^1 e^(-r/nu) / |W(nu)|^2 dnu/nu^2\]
//!
//! isotropic: N = 2 k^2 (1-k^2)/(w (k^2+w-1)), |W|^2 = (1 - w nu atanh nu)^2 + (pi w nu/2)^2. The k_j are the
//! imaginary zeros of the fraction; a forward peak has several. The slowest is the diffusion that is seen far away.
//!
//! Limits: r -> 0 or w = 0, e^(-r)/(4 pi r^2); w = 1, k = 0 and 3 (1-g)/(4 pi r) far away; diffusion theory (P1) has
//! the right integral of phi and of r^2 phi and is otherwise wrong by a factor that grows without limit.
//!
//! Source: Case, de Hoffmann and Placzek 1953; Grosjean 1956; Case and Zweifel 1967, chapter 5; van de Hulst 1980,
//! chapter 5, for the continued fraction.

pub(crate) mod modes;
mod moments;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result, within};
use crate::half_space::resolvent::{Sum, TO_ONE, points};
use crate::incidence::check_albedo;
use crate::phase::Phase;
use crate::value::Value;
use libm::exp;
use modes::{Mode, Recurrence};
pub use moments::{mean_cosine, mean_square_displacement};
use std::f64::consts::PI;

const SPECTRAL: &str = "spectral integral of positive terms, step halved";
const ROOTS: &str = "bisection by the count of sign changes";

/// Moments below this change nothing in f64.
const CUT: f64 = 1e-18;

/// An unbounded medium, solved once, asked at any distance.
pub struct InfiniteMedium {
    albedo: f64,
    g: f64,
    recurrence: Recurrence,
    modes: Vec<Mode>,
    /// Decay 1/nu and strength of the continuum.
    continuum: Vec<(f64, f64)>,
}

impl InfiniteMedium {
    /// A medium with any phase function.
    ///
    /// # Arguments
    /// `albedo` \[1\], 0 to 1; `phase` with moments that have died away at l = 4500, as those of
    /// Henyey-Greenstein with |g| up to 0.99
    /// # Errors
    /// `Error::OutOfRange` naming `albedo`, `phase function` or `moment` (-1 or 1: no scattering at all)
    pub fn new(albedo: f64, phase: &Phase) -> Result<Self> {
        Ok(Self::solve(albedo, &moments_of(albedo, phase)?))
    }

    /// A medium with Henyey-Greenstein scattering.
    ///
    /// # Arguments
    /// `albedo` \[1\], 0 to 1; `g` mean cosine of scattering, -0.99 to 0.99
    /// # Errors
    /// `Error::OutOfRange` naming `albedo` or `g`
    pub fn henyey_greenstein(albedo: f64, g: f64) -> Result<Self> {
        check_albedo(albedo)?;
        within("g", g, -0.99, 0.99, "-0.99 to 0.99")?;
        let mut moments = vec![1.0];
        let mut power = g;
        while power.abs() > CUT {
            moments.push(power);
            power *= g;
        }
        Ok(Self::solve(albedo, &moments))
    }

    fn solve(albedo: f64, moments: &[f64]) -> Self {
        let recurrence = Recurrence::new(albedo, moments);
        let continuum = points(TO_ONE)
            .map(|p| (1.0 / p.nu, p.weight / (p.nu * p.nu * recurrence.spectrum(p.nu, p.a))))
            .collect();
        let modes = recurrence.modes();
        InfiniteMedium { albedo, g: moments.get(1).copied().unwrap_or(0.0), recurrence, modes, continuum }
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// Mean cosine of scattering \[1\].
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Fluence at distance r from a source of unit power \[1/mfp^2\].
    ///
    /// # Arguments
    /// `r` mean free paths, 1e-12 to 1e6
    /// # Errors
    /// `Error::OutOfRange` naming `r`
    /// # Limits
    /// r -> 0: e^(-r)/(4 pi r^2)
    pub fn fluence(&self, r: f64) -> Result<Value> {
        check_radius(r)?;
        let sum = self.sum(r, |_| 1.0, |_| 1.0);
        Ok(sum.scaled(1.0 / (4.0 * PI * r)))
    }

    /// Net flux outwards at distance r \[1/mfp^2\]: what is not absorbed within r, over 4 pi r^2.
    ///
    /// # Arguments
    /// `r` mean free paths, 1e-12 to 1e6
    /// # Errors
    /// `Error::OutOfRange` naming `r`
    /// # Limits
    /// albedo = 1: 1/(4 pi r^2)
    pub fn flux(&self, r: f64) -> Result<Value> {
        check_radius(r)?;
        if self.albedo == 1.0 {
            return Ok(Value::rounded(1.0 / (4.0 * PI * r * r), 4.0, SPECTRAL));
        }
        let absorbed = 1.0 - self.albedo;
        let beyond = |x: f64| absorbed * (1.0 + x * r) / (x * x);
        Ok(self.sum(r, beyond, beyond).scaled(1.0 / (4.0 * PI * r * r)))
    }

    /// The part of the fluence that decays most slowly \[1/mfp^2\], which is what remains far away: 0 if there is none.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `r`, 1e-12 to 1e6
    pub fn asymptotic_fluence(&self, r: f64) -> Result<Value> {
        check_radius(r)?;
        let slowest = self.modes.first().map_or(0.0, |mode| mode.strength * exp(-mode.k * r));
        let rounding =
            self.mode_rounding() * (1.0 + self.modes.first().map_or(0.0, |m| (m.k * r).min(750.0)));
        Ok(Value::rounded(slowest / (4.0 * PI * r), rounding, "slowest mode"))
    }

    /// Diffusion theory's fluence \[1/mfp^2\]: exact as a number, an approximation of the truth.
    ///
    /// 3 (1-wg) e^(-kr)/(4 pi r), k^2 = 3 (1-w)(1-wg).
    /// # Errors
    /// `Error::OutOfRange` naming `r`, 1e-12 to 1e6
    pub fn diffusion_fluence(&self, r: f64) -> Result<Value> {
        check_radius(r)?;
        let transport = 1.0 - self.albedo * self.g;
        let k = (3.0 * (1.0 - self.albedo) * transport).sqrt();
        let value = 3.0 * transport * exp(-k * r) / (4.0 * PI * r);
        Ok(Value::rounded(value, 8.0 + 4.0 * (k * r).min(750.0), "P1 formula"))
    }

    /// The discrete decays k below 1 \[1/mfp\], the slowest first: 0 for albedo 1. Those within 1e-16 of 1 are left out.
    pub fn decays(&self) -> Vec<Value> {
        let rounding = self.mode_rounding();
        self.modes.iter().map(|mode| Value::rounded(mode.k, rounding, ROOTS)).collect()
    }

    /// int phi d^3r = 1/(1-albedo) \[mfp\].
    ///
    /// # Errors
    /// `Error::Infinite` for albedo 1
    pub fn total_fluence(&self) -> Result<Value> {
        self.absorbing()?;
        Ok(Value::rounded(1.0 / (1.0 - self.albedo), 2.0, "power balance"))
    }

    /// Mean square distance from the source, weighted by fluence \[mfp^2\]: 2/((1-albedo)(1-albedo g)).
    ///
    /// # Errors
    /// `Error::Infinite` for albedo 1
    pub fn mean_square_radius(&self) -> Result<Value> {
        self.absorbing()?;
        let value = 2.0 / ((1.0 - self.albedo) * (1.0 - self.albedo * self.g));
        Ok(Value::rounded(value, 8.0, "second moment of the transport equation"))
    }

    /// int phi(r) e^(i s.r) d^3r \[mfp\], by the continued fraction.
    ///
    /// Its convergents lie in turn above and below the limit: two of them are the bound.
    /// # Arguments
    /// `s` wave number \[1/mfp\], 0 to 1e5
    /// # Errors
    /// `Error::OutOfRange` naming `s`; `Error::Infinite` for albedo 1 and s = 0 or near it
    /// # Limits
    /// s = 0: 1/(1-albedo); no scattering: atan(s)/s
    pub fn transform(&self, s: f64) -> Result<Value> {
        within("s", s, 0.0, 1e5, "0 to 1e5")?;
        if s == 0.0 {
            return self.total_fluence();
        }
        let h = |l: usize| self.recurrence.h.get(l).copied().unwrap_or((2 * l + 1) as f64);
        // Remainders and roundings shrink by (root - 1)/(root + 1) a term, root = sqrt(1 + s^2).
        let root = (1.0 + s * s).sqrt();
        let rate = 2.0 * libm::asinh(1.0 / s);
        let terms = self.recurrence.h.len() + (38.0 / rate) as usize + 4;
        let mut near = h(terms);
        // Where the remainder is known best: the recurrence's growing solution.
        let mut far = h(terms) + (terms as f64 + 1.0) * s * s / (root + 1.0);
        for l in (0..terms).rev() {
            let square = (l + 1) as f64 * (l + 1) as f64 * s * s;
            near = h(l) + square / near;
            far = h(l) + square / far;
        }
        let value = 1.0 / far;
        if !value.is_finite() {
            return Err(Error::Infinite(
                "without absorption the transform at so small an s exceeds f64; allowed: larger s",
            ));
        }
        let error = (value - 1.0 / near).abs() + (8.0 + 4.0 / rate) * f64::EPSILON * value;
        Ok(Value::new(value, error, "continued fraction, two convergents"))
    }

    fn absorbing(&self) -> Result<()> {
        if self.albedo == 1.0 {
            Err(Error::Infinite("without absorption the fluence fills all space; allowed: albedo below 1"))
        } else {
            Ok(())
        }
    }

    /// Roundings of a mode: each of the recurrence's steps may add a few.
    fn mode_rounding(&self) -> f64 {
        16.0 + 4.0 * self.recurrence.h.len() as f64
    }

    /// sum of N e^(-xr) times a factor that depends on the decay.
    fn sum(&self, r: f64, slow: impl Fn(f64) -> f64, fast: impl Fn(f64) -> f64) -> Value {
        let mut sum = Sum::default();
        for (i, &(x, strength)) in self.continuum.iter().enumerate() {
            sum.add(i, strength * fast(x) * exp(-x * r), x * r);
        }
        let (mut value, mut error) = sum.value();
        error += f64::EPSILON * self.mode_rounding() * value;
        for mode in &self.modes {
            let term = mode.strength * slow(mode.k) * exp(-mode.k * r);
            value += term;
            error += f64::EPSILON * self.mode_rounding() * (1.0 + (mode.k * r).min(750.0)) * term;
        }
        // Modes within 1e-16 of the continuum.
        error += 1e-15 * exp(-r) * fast(1.0) + f64::MIN_POSITIVE;
        Value::new(value, error, SPECTRAL)
    }
}

/// The moments of `phase` up to the last that changes anything.
pub(crate) fn moments_of(albedo: f64, phase: &Phase) -> Result<Vec<f64>> {
    check_albedo(albedo)?;
    let last = phase.degree(CUT, 4500);
    if last == 4500 {
        let name = "Legendre moment 4500 of the phase function";
        within(name, phase.moment(last), -CUT, CUT, "at most 1e-18 in an unbounded medium")?;
    }
    let moments: Vec<f64> = (0..=last).map(|l| phase.moment(l)).collect();
    for &moment in moments.iter().skip(1) {
        within("moment", moment, f64::EPSILON - 1.0, 1.0 - f64::EPSILON, "between -1 and 1")?;
    }
    Ok(moments)
}

fn check_radius(r: f64) -> Result<f64> {
    within("r", r, 1e-12, 1e6, "1e-12 to 1e6")
}
