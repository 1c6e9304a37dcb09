//! One slab on one set of nodes: amplitudes of the modes, and what they give.

use super::modes::Modes;
use crate::beer_lambert::{direct_fluence, direct_transmittance};
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
    basis: Basis,
    /// Amplitudes of the two solutions of every mode.
    first: DVector<f64>,
    second: DVector<f64>,
    beam: Option<Beam>,
}

/// The two solutions f of f'' = k^2 f by which every mode enters.
enum Basis {
    /// cosh(k s)/cosh(k tau/2) and sinh(k s)/(k cosh(k tau/2)), s = t - tau/2: no overflow, 1 and s for k -> 0, and
    /// the conditions on the two faces part into two systems of half the size.
    Halves,
    /// e^(-k t) and e^(-k (tau-t)): keep the relative accuracy of what little arrives at the far face.
    Faces,
}

/// The beam's sources in every mode: eta' = k^2 xi - pi e^(-beta t), xi' = eta - kappa e^(-beta t), for
/// p = sum p_j xi_j, q = sum q_j eta_j.
struct Beam {
    beta: f64,
    pi: DVector<f64>,
    kappa: DVector<f64>,
}

/// A sum over modes, with the sum of the magnitudes of its terms, each times 1 + its exponent, which carries the
/// rounding of k: rounding is a few units of the last place of that.
#[derive(Clone, Copy)]
pub(super) struct Sum {
    pub value: f64,
    pub magnitude: f64,
}

impl Sum {
    fn plus(self, value: f64, magnitude: f64) -> Self {
        Sum { value: self.value + value, magnitude: self.magnitude + magnitude }
    }

    fn scaled(self, factor: f64) -> Self {
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
fn decayed(rate: f64, x: f64) -> f64 {
    if rate * x == 0.0 { x } else { -expm1(-rate * x) / rate }
}

impl Beam {
    /// xi and eta of the particular solution of mode j at depth t, and the magnitude of the terms of xi.
    ///
    /// For k < 1/2 a multiple of e^(-beta t), beta >= 1. Beyond, psi = k xi +- eta starts from 0 on the face
    /// where it enters, so that both are integrals of positive functions and k = beta needs no care.
    fn particular(&self, j: usize, k: f64, t: f64, rest: f64) -> [f64; 3] {
        let (beta, pi, kappa) = (self.beta, self.pi[j], self.kappa[j]);
        if k < 0.5 {
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
    pub fn new(tau: f64, albedo: f64, incidence: Incidence, modes: Modes) -> Result<Self> {
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
                let parts: Vec<_> = (0..n).map(|j| beam.particular(j, modes.k[j], t, rest)).collect();
                let xi = DVector::from_iterator(n, parts.iter().map(|p| p[0]));
                let eta = DVector::from_iterator(n, parts.iter().map(|p| p[1]));
                *side -= &modes.even * xi + &modes.odd * eta * sign;
            }
        }
        // Beyond one decay length the far face sees the lit one as a reflection that dies away.
        let basis = if modes.slowest() * tau > 1.0 { Basis::Faces } else { Basis::Halves };
        let (first, second) = match basis {
            Basis::Halves => match_halves(&modes, tau, &top, &bottom),
            Basis::Faces => match_faces(&modes, tau, &top, &bottom),
        }
        .ok_or(Error::Infinite("the faces of the slab cannot be matched in f64"))?;
        Ok(Solution { tau, albedo, incidence, modes, basis, first, second, beam })
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

    /// Fraction absorbed \[1\], from the integral of the fluence.
    pub fn absorptance(&self) -> Result<Sum> {
        let tau = self.tau;
        let mut sum = Sum { value: 0.0, magnitude: 0.0 };
        for (j, &k) in self.modes.k.iter().enumerate() {
            let integrals = match self.basis {
                Basis::Halves => [2.0 * half_width(k, tau), 0.0],
                Basis::Faces => [decayed(k, tau); 2],
            };
            let mut terms = [self.first[j] * integrals[0], self.second[j] * integrals[1], 0.0];
            if let Some(beam) = &self.beam {
                let falling = decayed(beam.beta, tau);
                terms[2] = if k < 0.5 {
                    beam.particular(j, k, 0.0, tau)[0] * falling
                } else {
                    let ends = beam.particular(j, k, tau, 0.0)[1] - beam.particular(j, k, 0.0, tau)[1];
                    (ends + beam.pi[j] * falling) / (k * k)
                };
            }
            let weight = 2.0 * PI * self.modes.fluence[j];
            sum = terms.iter().fold(sum, |sum, term| sum.plus(weight * term, (weight * term).abs()));
        }
        if let Incidence::Beam { mu0 } = self.incidence {
            let direct = -expm1(-tau / mu0);
            sum = sum.plus(direct, direct);
        } else {
            let ours = 1.0 - 2.0 * self.modes.nodes.sum(|mu| mu * exp(-tau / mu));
            let exact = 1.0 - direct_transmittance(self.incidence, tau)?.value;
            sum = sum.plus(exact - ours, 2.0);
        }
        Ok(sum.scaled(1.0 - self.albedo))
    }

    fn scattered_fluence(&self, t: f64) -> Sum {
        let rest = self.tau - t;
        let mut sum = Sum { value: 0.0, magnitude: 0.0 };
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
        let mut sum = Sum { value: 0.0, magnitude: 0.0 };
        for (j, &k) in self.modes.k.iter().enumerate() {
            let (_, slopes) = self.shapes(k, t, rest);
            let part = self.beam.as_ref().map_or([0.0; 3], |beam| beam.particular(j, k, t, rest));
            // eta is k times xi where both are sums of one pair of terms.
            let size = if k < 0.5 { part[1].abs() } else { k * part[2] };
            sum = sum + self.term(j, t, slopes).plus(part[1], size).scaled(self.modes.flux[j]);
        }
        sum.scaled(2.0 * PI)
    }

    /// The two solutions of mode j times their amplitudes.
    fn term(&self, j: usize, t: f64, shapes: [f64; 2]) -> Sum {
        let (k, rest) = (self.modes.k[j], self.tau - t);
        let (f, g) = (self.first[j] * shapes[0], self.second[j] * shapes[1]);
        let lengths = match self.basis {
            Basis::Halves => [k * t.min(rest); 2],
            Basis::Faces => [k * t, k * rest],
        };
        Sum { value: f + g, magnitude: f.abs() * (1.0 + lengths[0]) + g.abs() * (1.0 + lengths[1]) }
    }

    /// The two solutions of a mode at depth t, `rest` = tau - t, and their slopes.
    fn shapes(&self, k: f64, t: f64, rest: f64) -> ([f64; 2], [f64; 2]) {
        match self.basis {
            Basis::Halves => {
                let (near, gap) = (t.min(rest), (rest - t).abs());
                let share = exp(-k * near) / (1.0 + exp(-k * self.tau));
                let c = share * (1.0 + exp(-k * gap));
                let s = (share * decayed(k, gap)).copysign(t - rest);
                ([c, s], [k * k * s, c])
            }
            Basis::Faces => {
                let (down, up) = (exp(-k * t), exp(-k * rest));
                ([down, up], [-k * down, k * up])
            }
        }
    }
}

/// tanh(k tau/2)/k.
fn half_width(k: f64, tau: f64) -> f64 {
    if k * tau == 0.0 { 0.5 * tau } else { tanh(0.5 * k * tau) / k }
}

/// The matrix of columns p_j a(k_j) + q_j b(k_j).
fn columns(modes: &Modes, a: impl Fn(f64) -> f64, b: impl Fn(f64) -> f64) -> DMatrix<f64> {
    let n = modes.nodes.len();
    let mut matrix = DMatrix::zeros(n, n);
    for (j, &k) in modes.k.iter().enumerate() {
        matrix.set_column(j, &(modes.even.column(j) * a(k) + modes.odd.column(j) * b(k)));
    }
    matrix
}

/// The even half sees the sum of both faces, the odd half their difference.
fn match_halves(
    modes: &Modes,
    tau: f64,
    top: &DVector<f64>,
    bottom: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let even = columns(modes, |_| 1.0, |k| k * tanh(0.5 * k * tau));
    let odd = columns(modes, |k| half_width(k, tau), |_| 1.0);
    let first = even.lu().solve(&((top + bottom) * 0.5))?;
    let second = odd.lu().solve(&((bottom - top) * 0.5))?;
    Some((first, second))
}

/// Light goes to and fro between the faces, each passage dimmed by e^(-k tau) at least: passages are added until
/// twice as many have gone as rounding would need.
fn match_faces(
    modes: &Modes,
    tau: f64,
    top: &DVector<f64>,
    bottom: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let leaving = columns(modes, |_| 1.0, |k| k).lu();
    let arriving = columns(modes, |k| exp(-k * tau), |k| -k * exp(-k * tau));
    let mut first = leaving.solve(top)?;
    let mut second = leaving.solve(&(bottom - &arriving * &first))?;
    let mut passages = 2.0 * -libm::log(f64::EPSILON) / (modes.slowest() * tau);
    while passages > 0.0 {
        first = leaving.solve(&(top - &arriving * &second))?;
        second = leaving.solve(&(bottom - &arriving * &first))?;
        passages -= 2.0;
    }
    Some((first, second))
}
