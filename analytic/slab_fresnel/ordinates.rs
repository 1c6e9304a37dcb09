//! Modes of discrete ordinates, matched at two faces that reflect.

use super::direct::Direct;
use super::fluxes::{Fluxes, Light};
use crate::error::{Error, Result};
use crate::incidence::Incidence;
use crate::slab_anisotropic::modes::Modes;
use crate::slab_anisotropic::nodes::Nodes;
use crate::slab_anisotropic::scattering::Scattering;
use crate::slab_anisotropic::solution::{by_faces, by_halves, decayed};
use libm::{exp, expm1, log, tanh};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::Arc;

/// Light between the faces on one set of nodes: every mode is p_j f(t), q_j f'(t) with f'' = k_j^2 f.
pub(super) struct Matched {
    tau: f64,
    modes: Modes,
    basis: Basis,
    /// Amplitudes of the two solutions f of every mode.
    amplitudes: [DVector<f64>; 2],
    source: Option<Source>,
    fluxes: [Light; 3],
}

/// The two solutions f of f'' = k^2 f.
#[derive(Clone, Copy)]
enum Basis {
    /// cosh(k s)/cosh(k tau/2) and sinh(k s)/(k cosh(k tau/2)), s = t - tau/2.
    Halves,
    /// e^(-k t) and e^(-k (tau-t)): beyond a few decay lengths.
    Faces,
}

/// What the beam within the medium and its echo scatter: eta' = k^2 xi - pi e^(-beta t), xi' = eta - kappa e^(-beta t)
/// in every mode for the beam that goes down with unit irradiance.
struct Source {
    /// Irradiance of the beam on the lit face, all echoes included, and of the one upwards on the far face.
    down: f64,
    up: f64,
    beta: f64,
    pi: DVector<f64>,
    kappa: DVector<f64>,
}

/// Below this k a particular solution is a multiple of e^(-beta t), beta >= 1.
const SLOW: f64 = 0.5;

impl Source {
    /// xi, eta and the magnitude of their terms for mode j and the beam downwards.
    fn falling(&self, j: usize, k: f64, t: f64, rest: f64) -> [f64; 3] {
        let (beta, pi, kappa) = (self.beta, self.pi[j], self.kappa[j]);
        if k < SLOW {
            let x = (beta * kappa - pi) / (beta * beta - k * k);
            let e = exp(-beta * t);
            return [x * e, (kappa - beta * x) * e, (x.abs() * beta + kappa.abs()) * e * (1.0 + beta * t)];
        }
        let up = (k * kappa + pi) * exp(-beta * t) * decayed(k + beta, rest);
        let down = -(k * kappa - pi) * exp(-k.min(beta) * t) * decayed((k - beta).abs(), t);
        let size = up.abs() * (1.0 + beta * t) + down.abs() * (1.0 + k.min(beta) * t);
        [(up + down) / (2.0 * k), 0.5 * (up - down), size / (2.0 * k)]
    }

    /// The same for the beam and its echo, which sees the slab upside down.
    fn both(&self, j: usize, k: f64, t: f64, rest: f64) -> [f64; 3] {
        let (a, b) = (self.falling(j, k, t, rest), self.falling(j, k, rest, t));
        [
            self.down * a[0] + self.up * b[0],
            self.down * a[1] - self.up * b[1],
            self.down * a[2] + self.up * b[2],
        ]
    }

    /// int_0^tau xi dt.
    fn integral(&self, j: usize, k: f64, tau: f64) -> f64 {
        let falling = decayed(self.beta, tau);
        let one = if k < SLOW {
            self.falling(j, k, 0.0, tau)[0] * falling
        } else {
            let ends = self.falling(j, k, tau, 0.0)[1] - self.falling(j, k, 0.0, tau)[1];
            (ends + self.pi[j] * falling) / (k * k)
        };
        (self.down + self.up) * one
    }
}

impl Matched {
    /// With r the reflectance at each node, (1-r) p - (1+r) q on the lit face and (1-r) p + (1+r) q on the far one
    /// are twice the light that enters there.
    pub fn new(
        direct: &Direct,
        scattering: Arc<Scattering>,
        rule: crate::adding_doubling::Nodes,
    ) -> Result<Self> {
        let tau = direct.tau;
        let degree = scattering.degree();
        let modes = Modes::new(scattering, Arc::new(Nodes::of(rule.mu, rule.weight, degree)), 0)?;
        let n = modes.nodes.len();
        let faces: Vec<(f64, f64)> =
            modes.nodes.mu.iter().map(|&mu| direct.face.reflected_inside(mu)).collect();
        let source = direct.beam().map(|mu| {
            let (pi, kappa) = modes.beam(mu);
            let down = direct.entering();
            Source { down, up: down * direct.echo(mu), beta: 1.0 / mu, pi, kappa }
        });
        // (1-r) p and (1+r) q.
        let (mut even, mut odd) = (modes.even.clone(), modes.odd.clone());
        for (i, &(r, through)) in faces.iter().enumerate() {
            even.row_mut(i).scale_mut(through);
            odd.row_mut(i).scale_mut(1.0 + r);
        }
        let mut top = match direct.incidence {
            Incidence::Beam { .. } => DVector::zeros(n),
            Incidence::Diffuse => {
                DVector::from_fn(n, |i, _| modes.root[i] * faces[i].1 * direct.face.spread() * 2.0 / PI)
            }
        };
        let mut bottom = DVector::zeros(n);
        if let Some(source) = &source {
            for (t, rest, sign, side) in [(0.0, tau, -1.0, &mut top), (tau, 0.0, 1.0, &mut bottom)] {
                let parts: Vec<_> = (0..n).map(|j| source.both(j, modes.k[j], t, rest)).collect();
                let xi = DVector::from_iterator(n, parts.iter().map(|p| p[0]));
                let eta = DVector::from_iterator(n, parts.iter().map(|p| p[1]));
                *side -= &even * xi + &odd * eta * sign;
            }
        }
        let columns = |a: OfDecay, b: OfDecay| {
            let mut matrix = DMatrix::zeros(n, n);
            for (j, &k) in modes.k.iter().enumerate() {
                matrix.set_column(j, &(even.column(j) * a(k) + odd.column(j) * b(k)));
            }
            matrix
        };
        let slowest = modes.slowest();
        let (basis, amplitudes) = if slowest * tau > 1.0 {
            (Basis::Faces, match_faces(&columns, slowest, tau, &top, &bottom))
        } else {
            let width = |k: f64| if k * tau == 0.0 { 0.5 * tau } else { tanh(0.5 * k * tau) / k };
            let first = columns(&|_| 1.0, &|k| k * tanh(0.5 * k * tau)).lu().solve(&((&top + &bottom) * 0.5));
            let second = columns(&width, &|_| 1.0).lu().solve(&((&bottom - &top) * 0.5));
            (Basis::Halves, first.zip(second))
        };
        let (first, second) =
            amplitudes.ok_or(Error::Infinite("the faces of the slab cannot be matched in f64"))?;
        let amplitudes = [first, second];
        let mut matched = Matched { tau, modes, basis, amplitudes, source, fluxes: [Light::default(); 3] };
        matched.fluxes = matched.solve_fluxes(direct, &faces)?;
        Ok(matched)
    }

    pub fn fluxes(&self) -> Fluxes {
        let [reflected, transmitted, absorbed] = self.fluxes;
        Fluxes { reflected, transmitted, absorbed }
    }

    fn solve_fluxes(&self, direct: &Direct, faces: &[(f64, f64)]) -> Result<[Light; 3]> {
        let nodes = &self.modes.nodes;
        let leaving = |t: f64, sign: f64| {
            let light = self.light(t, sign);
            light.iter().enumerate().fold(Light::default(), |sum, (i, light)| {
                sum.plus(light.scaled(2.0 * PI * self.modes.root[i] * nodes.mu[i] * faces[i].1))
            })
        };
        let (mut reflected, mut transmitted) = (leaving(0.0, 1.0), leaving(self.tau, -1.0));
        let lost = self.modes.scattering.lost;
        let mut absorbed = self.integral();
        if direct.incidence == Incidence::Diffuse {
            // The nodes carry the light that was never scattered as well: it is taken out.
            let spread = direct.face.spread();
            let unscattered = |f: &dyn Fn(f64, f64, f64) -> f64| {
                let terms = nodes.mu.iter().zip(faces).zip(&nodes.weight).map(|((&mu, &(r, through)), w)| {
                    let e = exp(-self.tau / mu);
                    2.0 * w * spread * through * f(mu, r, e) / (1.0 - r * r * e * e)
                });
                terms.sum::<f64>()
            };
            let back = unscattered(&|mu, r, e| mu * (1.0 - r) * r * e * e);
            let through = unscattered(&|mu, r, e| mu * (1.0 - r) * e);
            let inside = unscattered(&|mu, r, e| mu * -expm1(-self.tau / mu) * (1.0 + r * e));
            reflected = reflected.plus(Light::of(-back));
            transmitted = transmitted.plus(Light::of(-through));
            absorbed = absorbed.plus(Light::of(-inside));
        }
        absorbed = absorbed.plus(Light::of(direct.collided()?.value)).scaled(lost);
        Ok([reflected, transmitted, absorbed])
    }

    /// int_0^tau of the fluence of the modes.
    fn integral(&self) -> Light {
        let tau = self.tau;
        let mut sum = Light::default();
        for (j, &k) in self.modes.k.iter().enumerate() {
            let integrals = match self.basis {
                Basis::Halves if k * tau == 0.0 => [tau, 0.0],
                Basis::Halves => [2.0 * tanh(0.5 * k * tau) / k, 0.0],
                Basis::Faces => [decayed(k, tau); 2],
            };
            let weight = 2.0 * PI * self.modes.fluence[j];
            for (amplitude, integral) in self.amplitudes.iter().zip(integrals) {
                sum = sum.plus(Light::of(weight * amplitude[j] * integral));
            }
            if let Some(source) = &self.source {
                sum = sum.plus(Light::of(weight * source.integral(j, k, tau)));
            }
        }
        sum
    }

    /// Root of the weight times the radiance upwards (`sign` 1) or downwards (-1) at every node.
    fn light(&self, t: f64, sign: f64) -> Vec<Light> {
        let n = self.modes.nodes.len();
        let terms: Vec<_> = (0..n).map(|j| self.mode(j, t)).collect();
        (0..n)
            .map(|i| {
                terms.iter().enumerate().fold(Light::default(), |sum, (j, &[f, slope, size])| {
                    let (p, q) = (self.modes.even[(i, j)], sign * self.modes.odd[(i, j)]);
                    let value = 0.5 * (p * f + q * slope);
                    let magnitude = 0.5 * (p.abs() + q.abs() * self.modes.k[j].max(1.0)) * size;
                    sum.plus(Light { value, magnitude })
                })
            })
            .collect()
    }

    /// f and f' of mode j at depth t, the beam's part included, and the magnitude of the terms.
    fn mode(&self, j: usize, t: f64) -> [f64; 3] {
        let (k, rest) = (self.modes.k[j], self.tau - t);
        let ([c, s], [dc, ds]) = self.shapes(k, t, rest);
        let (a, b) = (self.amplitudes[0][j], self.amplitudes[1][j]);
        let part = self.source.as_ref().map_or([0.0; 3], |source| source.both(j, k, t, rest));
        let lengths = match self.basis {
            Basis::Halves => [k * t.min(rest); 2],
            Basis::Faces => [k * t, k * rest],
        };
        let size = (a * c).abs() * (1.0 + lengths[0])
            + (b * s).abs().max((b * ds).abs() / k.max(1.0)) * (1.0 + lengths[1]);
        [a * c + b * s + part[0], a * dc + b * ds + part[1], size + part[2]]
    }

    /// The two solutions of a mode at depth t, `rest` = tau - t, and their slopes.
    fn shapes(&self, k: f64, t: f64, rest: f64) -> ([f64; 2], [f64; 2]) {
        match self.basis {
            Basis::Halves => by_halves(k, self.tau, t, rest),
            Basis::Faces => by_faces(k, t, rest),
        }
    }

    /// Fluence of scattered light at depth t.
    pub fn fluence(&self, t: f64, direct: &Direct) -> Light {
        let mut sum = Light::default();
        for j in 0..self.modes.nodes.len() {
            let [f, _, size] = self.mode(j, t);
            let weight = 2.0 * PI * self.modes.fluence[j];
            sum = sum.plus(Light { value: weight * f, magnitude: (weight * size).abs() });
        }
        if direct.incidence == Incidence::Diffuse {
            let unscattered = 2.0 * self.modes.nodes.sum(|mu| direct.radiance(mu, t));
            sum = sum.plus(Light::of(-unscattered));
        }
        sum
    }
}

/// A factor of a mode, by its inverse decay length.
type OfDecay<'a> = &'a dyn Fn(f64) -> f64;

/// Light goes to and fro between the faces, each passage dimmed by e^(-k tau) at least: passages are added until
/// twice as many have gone as rounding would need.
fn match_faces(
    columns: &dyn Fn(OfDecay, OfDecay) -> DMatrix<f64>,
    slowest: f64,
    tau: f64,
    top: &DVector<f64>,
    bottom: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let leaving = columns(&|_| 1.0, &|k| k).lu();
    let arriving = columns(&|k| exp(-k * tau), &|k| -k * exp(-k * tau));
    let mut first = leaving.solve(top)?;
    let mut second = leaving.solve(&(bottom - &arriving * &first))?;
    let mut passages = 2.0 * -log(f64::EPSILON) / (slowest * tau);
    while passages > 0.0 {
        first = leaving.solve(&(top - &arriving * &second))?;
        second = leaving.solve(&(bottom - &arriving * &first))?;
        passages -= 2.0;
    }
    Some((first, second))
}
