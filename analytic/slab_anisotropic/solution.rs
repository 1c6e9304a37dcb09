//! One slab on one set of nodes: amplitudes of the modes, and what they give.

use super::matching::{half_width, match_deep, match_faces, match_halves};
use super::modes::Modes;
use crate::beer_lambert::direct_fluence;
use crate::error::{Error, Result};
use crate::exponential_integral::e_n;
use crate::incidence::Incidence;
use libm::{exp, expm1};
use nalgebra::DVector;
use std::f64::consts::PI;
use std::sync::Arc;

/// Roundings of the terms of a sum over n modes, over root n: columns count as orthogonal at root n roundings, about
/// ten, and an eigenvector, an amplitude and an exponential have a few such each.
const ULPS: f64 = 6.4;

/// A solved slab or, with an infinite thickness, half-space. Lengths are mean free paths of `modes.scattering`.
pub(crate) struct Solution {
    pub tau: f64,
    pub incidence: Incidence,
    pub modes: Arc<Modes>,
    pub basis: Basis,
    /// Amplitudes of the two solutions of every mode.
    pub first: DVector<f64>,
    pub second: DVector<f64>,
    pub beam: Option<Beam>,
}

/// The two solutions f of f'' = k^2 f by which every mode enters.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Basis {
    /// cosh(k s)/cosh(k tau/2) and sinh(k s)/(k cosh(k tau/2)), s = t - tau/2: no overflow, 1 and s for k -> 0, and
    /// the conditions on the two faces part into two systems of half the size.
    Halves,
    /// e^(-k t) and e^(-k (tau-t)): keep the relative accuracy of what little arrives at the far face.
    Faces,
    /// e^(-k t) alone: a half-space.
    Deep,
}

/// The beam's sources in every mode: eta' = k^2 xi - pi e^(-beta t), xi' = eta - kappa e^(-beta t), for
/// p = sum p_j xi_j, q = sum q_j eta_j.
pub(crate) struct Beam {
    pub beta: f64,
    pub pi: DVector<f64>,
    pub kappa: DVector<f64>,
}

/// Below this k a particular solution is a multiple of e^(-beta t), beta >= 1.
pub(crate) const SLOW: f64 = 0.5;

/// A sum over modes, with the sum of the magnitudes of its terms, each times 1 + its exponent, which carries the
/// rounding of k: rounding is a few units of the last place of that.
#[derive(Clone, Copy)]
pub(crate) struct Sum {
    pub value: f64,
    pub magnitude: f64,
}

impl Sum {
    pub const ZERO: Sum = Sum { value: 0.0, magnitude: 0.0 };

    pub fn plus(self, value: f64, magnitude: f64) -> Self {
        Sum { value: self.value + value, magnitude: self.magnitude + magnitude }
    }

    pub fn scaled(self, factor: f64) -> Self {
        Sum { value: self.value * factor, magnitude: self.magnitude * factor.abs() }
    }
}

impl std::ops::Add for Sum {
    type Output = Sum;

    fn add(self, other: Sum) -> Sum {
        self.plus(other.value, other.magnitude)
    }
}

/// int_0^x e^(-rate y) dy.
pub(crate) fn decayed(rate: f64, x: f64) -> f64 {
    if rate == 0.0 || rate * x == 0.0 { x } else { -expm1(-rate * x) / rate }
}

/// Fraction of the incident power that collides within `tau` \[1\]; of diffuse light 1 - 2 E_3(tau) = 1 - e^(-tau) +
/// tau E_2(tau).
pub(super) fn colliding(incidence: Incidence, tau: f64) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => -expm1(-tau / mu0),
        Incidence::Diffuse if tau > 700.0 => 1.0,
        Incidence::Diffuse => -expm1(-tau) + tau * e_n(2, tau),
    }
}

impl Beam {
    /// xi and eta of the particular solution of mode j at depth t, and the magnitude of the terms of xi.
    ///
    /// For slow modes a multiple of e^(-beta t), beta >= 1. Beyond, psi = k xi +- eta starts from 0 on the face
    /// where it enters, so that both are integrals of positive functions and k = beta needs no care.
    pub fn particular(&self, j: usize, k: f64, t: f64, rest: f64) -> [f64; 3] {
        let (beta, pi, kappa) = (self.beta, self.pi[j], self.kappa[j]);
        if t == f64::INFINITY {
            return [0.0; 3];
        }
        if k < SLOW {
            let x = (beta * kappa - pi) / (beta * beta - k * k);
            let e = exp(-beta * t);
            return [x * e, (kappa - beta * x) * e, x.abs() * e * (1.0 + beta * t)];
        }
        let up = (k * kappa + pi) * exp(-beta * t) * decayed(k + beta, rest);
        let down = -(k * kappa - pi) * exp(-k.min(beta) * t) * decayed((k - beta).abs(), t);
        let size = up.abs() * (1.0 + beta * t) + down.abs() * (1.0 + k.min(beta) * t);
        [(up + down) / (2.0 * k), 0.5 * (up - down), size / (2.0 * k)]
    }
}

impl Solution {
    /// # Arguments
    /// `tau` 0 or more, or infinity; `incidence` diffuse only for modes of order 0
    pub fn new(tau: f64, incidence: Incidence, modes: Arc<Modes>) -> Result<Self> {
        let n = modes.nodes.len();
        let beam = if let Incidence::Beam { mu0 } = incidence {
            let (pi, kappa) = modes.beam(mu0);
            Some(Beam { beta: 1.0 / mu0, pi, kappa })
        } else {
            None
        };
        // p - q on the lit face and p + q on the far one: twice the light that enters there, less what the particular
        // solution brings.
        let mut top = if beam.is_some() { DVector::zeros(n) } else { &modes.root * (2.0 / PI) };
        let mut bottom = DVector::zeros(n);
        if let Some(beam) = &beam {
            for (t, rest, sign, side) in [(0.0, tau, -1.0, &mut top), (tau, 0.0, 1.0, &mut bottom)] {
                if t == f64::INFINITY {
                    continue;
                }
                let parts: Vec<_> = (0..n).map(|j| beam.particular(j, modes.k[j], t, rest)).collect();
                let xi = DVector::from_iterator(n, parts.iter().map(|p| p[0]));
                let eta = DVector::from_iterator(n, parts.iter().map(|p| p[1]));
                *side -= &modes.even * xi + &modes.odd * eta * sign;
            }
        }
        // Beyond one decay length the far face sees the lit one as a reflection that dies away.
        let basis = match modes.slowest() * tau {
            _ if tau == f64::INFINITY => Basis::Deep,
            lengths if lengths > 1.0 => Basis::Faces,
            _ => Basis::Halves,
        };
        let (first, second) = match basis {
            Basis::Halves => match_halves(&modes, tau, &top, &bottom),
            Basis::Faces => match_faces(&modes, tau, &top, &bottom),
            Basis::Deep => match_deep(&modes, &top),
        }
        .ok_or(Error::Infinite("the faces of the slab cannot be matched in f64"))?;
        Ok(Solution { tau, incidence, modes, basis, first, second, beam })
    }

    /// Fluence at depth t, direct light included \[1\].
    pub fn fluence(&self, t: f64) -> Sum {
        let direct = direct_fluence(self.incidence, t);
        let sum = self.scattered_fluence(t);
        match self.incidence {
            Incidence::Beam { mu0 } => sum.plus(direct, direct * (1.0 + t / mu0)),
            // Uncollided light is known exactly: the nodes' version of it is taken out.
            Incidence::Diffuse => {
                let ours = 2.0 * self.modes.nodes.sum(|mu| exp(-t / mu));
                sum.plus(direct, direct).plus(-ours, ours)
            }
        }
    }

    /// Fraction reflected \[1\].
    pub fn reflectance(&self) -> Sum {
        let entering = if self.beam.is_some() { 0.0 } else { 2.0 * self.modes.nodes.sum(|mu| mu) };
        self.net_flux_up(0.0).plus(entering, entering)
    }

    /// Fraction transmitted after at least one scattering \[1\].
    pub fn transmittance_diffuse(&self) -> Sum {
        let uncollided = match self.incidence {
            Incidence::Beam { .. } => 0.0,
            Incidence::Diffuse => 2.0 * self.modes.nodes.sum(|mu| mu * exp(-self.tau / mu)),
        };
        let up = self.net_flux_up(self.tau);
        Sum { value: -up.value - uncollided, magnitude: up.magnitude + uncollided }
    }

    /// Fraction transmitted after at least one scattering, into a peak that was cut off too: what passes the slab
    /// uncollided here and not in the true one, of thickness `whole` \[1\].
    pub fn transmittance_scattered(&self, whole: f64) -> Sum {
        if self.tau == f64::INFINITY {
            return Sum::ZERO;
        }
        let straight = match self.incidence {
            Incidence::Beam { mu0 } => exp(-self.tau / mu0) * -expm1(-(whole - self.tau) / mu0),
            Incidence::Diffuse => 2.0 * (e_n(3, self.tau) - e_n(3, whole)),
        };
        self.transmittance_diffuse().plus(straight, straight)
    }

    /// Net flux downwards at depth t, direct light included \[1\].
    pub fn flux(&self, t: f64) -> Sum {
        let up = self.net_flux_up(t).scaled(-1.0);
        match self.incidence {
            Incidence::Beam { mu0 } => {
                let direct = exp(-t / mu0);
                up.plus(direct, direct * (1.0 + t / mu0))
            }
            // Uncollided light is known exactly: the nodes' version of it is taken out.
            Incidence::Diffuse => {
                let ours = 2.0 * self.modes.nodes.sum(|mu| mu * exp(-t / mu));
                let exact = 2.0 * e_n(3, t);
                up.plus(exact, exact).plus(-ours, ours)
            }
        }
    }

    /// Fraction absorbed \[1\], from the integral of the fluence.
    pub fn absorptance(&self) -> Sum {
        let first = self.first_collisions();
        self.absorbed_later().plus(self.modes.scattering.lost * first, self.modes.scattering.lost * first)
    }

    /// Fraction of the incident power that collides at all \[1\].
    pub fn first_collisions(&self) -> f64 {
        colliding(self.incidence, self.tau)
    }

    /// Fraction absorbed after at least one scattering \[1\].
    pub fn absorbed_later(&self) -> Sum {
        let tau = self.tau;
        let lost = self.modes.scattering.lost;
        if lost == 0.0 {
            return Sum::ZERO;
        }
        let mut sum = Sum::ZERO;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let integrals = match self.basis {
                Basis::Halves => [2.0 * half_width(k, tau), 0.0],
                Basis::Faces => [decayed(k, tau); 2],
                Basis::Deep => [1.0 / k, 0.0],
            };
            let mut terms = [self.first[j] * integrals[0], self.second[j] * integrals[1], 0.0];
            if let Some(beam) = &self.beam {
                let falling = decayed(beam.beta, tau);
                terms[2] = if k < SLOW {
                    beam.particular(j, k, 0.0, tau)[0] * falling
                } else {
                    let ends = beam.particular(j, k, tau, 0.0)[1] - beam.particular(j, k, 0.0, tau)[1];
                    (ends + beam.pi[j] * falling) / (k * k)
                };
            }
            let weight = 2.0 * PI * self.modes.fluence[j];
            sum = terms.iter().fold(sum, |sum, term| sum.plus(weight * term, (weight * term).abs()));
        }
        if self.incidence == Incidence::Diffuse {
            // The nodes' version of what has not been scattered.
            let ours = 2.0 * self.modes.nodes.sum(|mu| mu * -expm1(-tau / mu));
            sum = sum.plus(-ours, ours);
        }
        sum.scaled(lost)
    }

    fn scattered_fluence(&self, t: f64) -> Sum {
        let rest = self.tau - t;
        let mut sum = Sum::ZERO;
        for (j, &k) in self.modes.k.iter().enumerate() {
            let (shapes, _) = self.shapes(k, t, rest);
            let part = self.beam.as_ref().map_or([0.0; 3], |beam| beam.particular(j, k, t, rest));
            sum = sum + self.term(j, t, shapes).plus(part[0], part[2]).scaled(self.modes.fluence[j]);
        }
        sum.scaled(2.0 * PI)
    }

    /// Net flux upwards at depth t, of light in the nodes.
    fn net_flux_up(&self, t: f64) -> Sum {
        let rest = self.tau - t;
        let mut sum = Sum::ZERO;
        for (j, &k) in self.modes.k.iter().enumerate() {
            if t == f64::INFINITY {
                continue;
            }
            let (_, slopes) = self.shapes(k, t, rest);
            let part = self.beam.as_ref().map_or([0.0; 3], |beam| beam.particular(j, k, t, rest));
            // eta is k times xi where both are sums of one pair of terms.
            let size = if k < SLOW { part[1].abs() } else { k * part[2] };
            sum = sum + self.term(j, t, slopes).plus(part[1], size).scaled(self.modes.flux[j]);
        }
        sum.scaled(2.0 * PI)
    }

    /// p and q at node i and depth t.
    #[cfg(test)]
    pub fn light(&self, i: usize, t: f64) -> [f64; 2] {
        let rest = self.tau - t;
        let (mut p, mut q) = (0.0, 0.0);
        for (j, &k) in self.modes.k.iter().enumerate() {
            let (shapes, slopes) = self.shapes(k, t, rest);
            let part = self.beam.as_ref().map_or([0.0; 3], |beam| beam.particular(j, k, t, rest));
            p += self.modes.even[(i, j)] * (self.term(j, t, shapes).value + part[0]);
            q += self.modes.odd[(i, j)] * (self.term(j, t, slopes).value + part[1]);
        }
        [p, q].map(|x| x / self.modes.root[i])
    }

    /// The two solutions of mode j times their amplitudes.
    fn term(&self, j: usize, t: f64, shapes: [f64; 2]) -> Sum {
        let (k, rest) = (self.modes.k[j], self.tau - t);
        let (f, g) = (self.first[j] * shapes[0], self.second[j] * shapes[1]);
        let lengths = match self.basis {
            Basis::Halves => [k * t.min(rest); 2],
            Basis::Faces => [k * t, k * rest],
            Basis::Deep => [k * t, 0.0],
        };
        Sum { value: f + g, magnitude: f.abs() * (1.0 + lengths[0]) + g.abs() * (1.0 + lengths[1]) }
    }

    /// The two solutions of a mode at depth t, `rest` = tau - t, and their slopes.
    pub fn shapes(&self, k: f64, t: f64, rest: f64) -> ([f64; 2], [f64; 2]) {
        match self.basis {
            Basis::Halves => by_halves(k, self.tau, t, rest),
            Basis::Faces => by_faces(k, t, rest),
            Basis::Deep => {
                let down = exp(-k * t);
                ([down, 0.0], [-k * down, 0.0])
            }
        }
    }
}

/// cosh(k s)/cosh(k tau/2) and sinh(k s)/(k cosh(k tau/2)), s = t - tau/2, and their slopes; `rest` = tau - t.
pub(crate) fn by_halves(k: f64, tau: f64, t: f64, rest: f64) -> ([f64; 2], [f64; 2]) {
    let (near, gap) = (t.min(rest), (rest - t).abs());
    let share = exp(-k * near) / (1.0 + exp(-k * tau));
    let c = share * (1.0 + exp(-k * gap));
    let s = (share * decayed(k, gap)).copysign(t - rest);
    ([c, s], [k * k * s, c])
}

/// e^(-k t) and e^(-k rest), and their slopes.
pub(crate) fn by_faces(k: f64, t: f64, rest: f64) -> ([f64; 2], [f64; 2]) {
    let (down, up) = (exp(-k * t), exp(-k * rest));
    ([down, up], [-k * down, k * up])
}

/// Rounding of a sum over modes.
pub(super) fn rounding(sum: Sum, modes: usize) -> f64 {
    ULPS * (modes.max(100) as f64).sqrt() * f64::EPSILON * sum.magnitude
}
