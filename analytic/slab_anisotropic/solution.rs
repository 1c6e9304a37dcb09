//! One slab on one set of nodes: amplitudes of the modes, and what they give.
//!
//! With s = t - tau/2 the modes are C = cosh(k s)/cosh(k tau/2) and S = sinh(k s)/(k cosh(k tau/2)), which know no
//! overflow, tend to 1 and s for k -> 0, and part the conditions on the two faces into two systems of half the size.

use super::modes::Modes;
use crate::beer_lambert::direct_fluence;
use crate::error::{Error, Result};
use crate::incidence::Incidence;
use libm::{exp, expm1, tanh};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// A solved slab.
pub(super) struct Solution {
    tau: f64,
    albedo: f64,
    incidence: Incidence,
    modes: Modes,
    /// Amplitudes of C and S.
    even: DVector<f64>,
    odd: DVector<f64>,
    beam: Option<Beam>,
}

/// The beam's sources in every mode: eta' = k^2 xi - pi e^(-beta t), xi' = eta - kappa e^(-beta t), for
/// p = sum p_j xi_j, q = sum q_j eta_j.
struct Beam {
    beta: f64,
    pi: DVector<f64>,
    kappa: DVector<f64>,
}

impl Beam {
    /// xi and eta of the particular solution of mode `j` at depth t.
    ///
    /// For k < 1/2 a multiple of e^(-beta t), beta >= 1. Beyond, psi = k xi +- eta starts from 0 on the face
    /// where it enters, so that both are integrals of positive functions and k = beta needs no care.
    fn particular(&self, j: usize, k: f64, t: f64, rest: f64) -> (f64, f64) {
        let (beta, pi, kappa) = (self.beta, self.pi[j], self.kappa[j]);
        if k < 0.5 {
            let x = (beta * kappa - pi) / (beta * beta - k * k);
            let e = exp(-beta * t);
            return (x * e, (kappa - beta * x) * e);
        }
        let up = (k * kappa + pi) * exp(-beta * t) * decayed(k + beta, rest);
        let down = -(k * kappa - pi) * exp(-k.min(beta) * t) * decayed((k - beta).abs(), t);
        ((up + down) / (2.0 * k), 0.5 * (up - down))
    }
}

/// int_0^x e^(-rate y) dy.
fn decayed(rate: f64, x: f64) -> f64 {
    if rate * x == 0.0 { x } else { -expm1(-rate * x) / rate }
}

impl Solution {
    pub fn new(tau: f64, albedo: f64, incidence: Incidence, modes: Modes) -> Result<Self> {
        let n = modes.nodes.len();
        let beam = if let Incidence::Beam { mu0 } = incidence {
            let (pi, kappa) = modes.beam(mu0);
            Some(Beam { beta: 1.0 / mu0, pi, kappa })
        } else {
            None
        };
        // Twice the light that enters at both faces, less what the particular solution brings there.
        let mut top = if beam.is_some() { DVector::zeros(n) } else { &modes.root * (2.0 / PI) };
        let mut bottom = DVector::zeros(n);
        if let Some(beam) = &beam {
            for (t, rest, sign, side) in [(0.0, tau, -1.0, &mut top), (tau, 0.0, 1.0, &mut bottom)] {
                let parts: Vec<_> = (0..n).map(|j| beam.particular(j, modes.k[j], t, rest)).collect();
                let xi = DVector::from_iterator(n, parts.iter().map(|p| p.0));
                let eta = DVector::from_iterator(n, parts.iter().map(|p| p.1));
                *side -= &modes.even * xi + &modes.odd * eta * sign;
            }
        }
        let slope = |j: usize| tanh(0.5 * modes.k[j] * tau);
        let system = |scale_even: &dyn Fn(usize) -> f64, scale_odd: &dyn Fn(usize) -> f64| {
            DMatrix::from_fn(n, n, |i, j| {
                modes.even[(i, j)] * scale_even(j) + modes.odd[(i, j)] * scale_odd(j)
            })
        };
        let even = system(&|_| 1.0, &|j| modes.k[j] * slope(j));
        let odd = system(&|j| half_width(modes.k[j], tau), &|_| 1.0);
        let solve = |matrix: DMatrix<f64>, side: DVector<f64>| {
            matrix.lu().solve(&side).ok_or(Error::Infinite("the faces of the slab cannot be matched in f64"))
        };
        let even = solve(even, (&top + &bottom) * 0.5)?;
        let odd = solve(odd, (&bottom - &top) * 0.5)?;
        Ok(Solution { tau, albedo, incidence, modes, even, odd, beam })
    }

    /// Fluence at depth t, direct light included \[1\].
    pub fn fluence(&self, t: f64) -> f64 {
        let rest = self.tau - t;
        let mut sum = 0.0;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let (c, s) = self.shapes(k, t, rest);
            let mut f = self.even[j] * c + self.odd[j] * s;
            if let Some(beam) = &self.beam {
                f += beam.particular(j, k, t, rest).0;
            }
            sum += self.modes.fluence[j] * f;
        }
        let direct = direct_fluence(self.incidence, t);
        match self.incidence {
            Incidence::Beam { .. } => direct + 2.0 * PI * sum,
            // Uncollided light is known exactly: the nodes' version of it is taken out.
            Incidence::Diffuse => 2.0 * PI * sum + (direct - 2.0 * self.modes.nodes.sum(|mu| exp(-t / mu))),
        }
    }

    /// Fraction reflected \[1\].
    pub fn reflectance(&self) -> f64 {
        let entering = if self.beam.is_some() { 0.0 } else { 2.0 * self.modes.nodes.sum(|mu| mu) };
        entering + self.scattered_flux(0.0)
    }

    /// Fraction transmitted after at least one scattering \[1\].
    pub fn transmittance_diffuse(&self) -> f64 {
        let uncollided = match self.incidence {
            Incidence::Beam { .. } => 0.0,
            Incidence::Diffuse => 2.0 * self.modes.nodes.sum(|mu| mu * exp(-self.tau / mu)),
        };
        -self.scattered_flux(self.tau) - uncollided
    }

    /// Fraction absorbed \[1\], from the integral of the fluence.
    pub fn absorptance(&self) -> f64 {
        let tau = self.tau;
        let mut sum = 0.0;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let mut f = 2.0 * self.even[j] * half_width(k, tau);
            if let Some(beam) = &self.beam {
                let falling = decayed(beam.beta, tau);
                f += if k < 0.5 {
                    beam.particular(j, k, 0.0, tau).0 * falling
                } else {
                    let ends = beam.particular(j, k, tau, 0.0).1 - beam.particular(j, k, 0.0, tau).1;
                    (ends + beam.pi[j] * falling) / (k * k)
                };
            }
            sum += self.modes.fluence[j] * f;
        }
        let direct = if let Incidence::Beam { mu0 } = self.incidence { -expm1(-tau / mu0) } else { 0.0 };
        (1.0 - self.albedo) * (direct + 2.0 * PI * sum)
    }

    /// Net flux upwards at depth t, of light in the nodes.
    fn scattered_flux(&self, t: f64) -> f64 {
        let rest = self.tau - t;
        let mut sum = 0.0;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let (c, s) = self.shapes(k, t, rest);
            let mut f = self.even[j] * k * k * s + self.odd[j] * c;
            if let Some(beam) = &self.beam {
                f += beam.particular(j, k, t, rest).1;
            }
            sum += self.modes.flux[j] * f;
        }
        2.0 * PI * sum
    }

    /// C and S at depth t, `rest` = tau - t. Their slopes are k^2 S and C.
    fn shapes(&self, k: f64, t: f64, rest: f64) -> (f64, f64) {
        let (near, gap) = (t.min(rest), (rest - t).abs());
        let share = exp(-k * near) / (1.0 + exp(-k * self.tau));
        let far = exp(-k * gap);
        let s = share * decayed(k, gap);
        (share * (1.0 + far), if t < rest { -s } else { s })
    }
}

/// tanh(k tau/2)/k.
fn half_width(k: f64, tau: f64) -> f64 {
    if k * tau == 0.0 { 0.5 * tau } else { tanh(0.5 * k * tau) / k }
}
