//! Layers by the modes of discrete ordinates, matched at all interfaces at once.
//!
//! In every layer p = sum p_j f_j(t), q = sum q_j f_j'(t) with f_j'' = k_j^2 f_j, plus what the beams and the source of
//! the layer bring. Radiances are the same on both sides of an interface; at the upper face those downwards, and at the
//! lower one those upwards, are what enters there. That is one linear system for the amplitudes of all layers.
//!
//! Nothing is shared with [`super::adding`]: other nodes, other algebra.

use super::problem::Problem;
use crate::error::{Error, Result, within};
use crate::incidence::Incidence;
use crate::quadrature::GAUSS_16;
use crate::slab_anisotropic::modes::Modes;
use crate::slab_anisotropic::nodes::Nodes;
use crate::slab_anisotropic::scattering::Scattering;
use crate::slab_anisotropic::solution::{Beam, SLOW, by_faces, by_halves, decayed};
use libm::{exp, expm1, sinh, tanh};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::Arc;

/// What the Legendre moments left out may be, and nodes towards the horizon and the fewest above it.
const CUT: [f64; 2] = [1e-12, 1e-9];
const LOWER: [usize; 2] = [52, 44];
const UPPER: [usize; 2] = [32, 26];

/// Moments of all phase functions, and amplitudes in one system.
const MOST: usize = 250;
const UNKNOWN: usize = 2500;

/// Roundings of a sum of terms, relative to their magnitudes, for each root of their number.
const ULPS: f64 = 16.0;

/// The azimuthal mean on one set of nodes.
pub(super) struct Matched {
    problem: Arc<Problem>,
    modes: Vec<Arc<Modes>>,
    beams: Vec<Option<Beam>>,
    /// Amplitudes of the two solutions f of every mode, by layer.
    amplitudes: Vec<[DVector<f64>; 2]>,
    /// The largest sum of magnitudes of what makes fluence, at any interface.
    magnitude: f64,
}

/// The two solutions of f'' = k^2 f in a layer of thickness `tau`, and their slopes, at depth x.
fn shapes(k: f64, tau: f64, x: f64) -> ([f64; 2], [f64; 2]) {
    let rest = tau - x;
    if k * tau > 1.0 { by_faces(k, x, rest) } else { by_halves(k, tau, x, rest) }
}

/// sinh(k s)/k.
fn swing(k: f64, s: f64) -> f64 {
    if k * s == 0.0 { s } else { sinh(k * s) / k }
}

impl Matched {
    /// # Arguments
    /// `set` 0 for the finer nodes
    pub fn new(problem: Arc<Problem>, set: usize) -> Result<Self> {
        let degree = problem.layers.iter().map(|layer| layer.phase.degree(CUT[set], usize::MAX));
        let degree = degree.fold(0, usize::max);
        within("moments", degree as f64, 0.0, MOST as f64, "at most 250 of weight with layers by ordinates")?;
        let nodes = Arc::new(Nodes::new(UPPER[set].max(2 + degree.div_ceil(2)), LOWER[set]));
        let count = problem.layers.len();
        let unknown = 2 * nodes.len() * count;
        within("layers", unknown as f64, 1.0, UNKNOWN as f64, "at most 2500 amplitudes by ordinates")?;
        let mut modes: Vec<Arc<Modes>> = Vec::with_capacity(count);
        for (i, layer) in problem.layers.iter().enumerate() {
            let like = problem.layers[..i]
                .iter()
                .position(|other| other.albedo == layer.albedo && other.phase == layer.phase);
            modes.push(match like {
                Some(i) => modes[i].clone(),
                None => {
                    let scattering = Scattering::new(layer.albedo, &layer.phase, nodes.degree, false);
                    Arc::new(Modes::new(Arc::new(scattering), nodes.clone(), 0)?)
                }
            });
        }
        let beams = match problem.incidence {
            Some(Incidence::Beam { mu0 }) => {
                let beam = |modes: &Arc<Modes>| {
                    let (pi, kappa) = modes.beam(mu0);
                    Some(Beam { beta: 1.0 / mu0, pi, kappa })
                };
                modes.iter().map(beam).collect()
            }
            _ => modes.iter().map(|_| None).collect(),
        };
        let zero = DVector::zeros(nodes.len());
        let amplitudes = vec![[zero.clone(), zero]; count];
        let mut matched = Matched { problem, modes, beams, amplitudes, magnitude: 0.0 };
        matched.solve()?;
        Ok(matched)
    }

    fn nodes(&self) -> &Nodes {
        &self.modes[0].nodes
    }

    /// xi, eta and the magnitude of xi of what beams and source bring to mode j, at depth x of layer i.
    fn particular(&self, i: usize, j: usize, x: f64) -> [f64; 3] {
        let (layer, modes) = (&self.problem.layers[i], &self.modes[i]);
        let (k, rest) = (modes.k[j], layer.tau - x);
        let mut sum = [0.0; 3];
        if let Some(beam) = &self.beams[i] {
            let down = self.problem.beam(self.problem.depths[i]);
            let up = self.problem.beam(self.problem.back(self.problem.depths[i + 1]));
            let (a, b) = (beam.particular(j, k, x, rest), beam.particular(j, k, rest, x));
            sum = [down * a[0] + up * b[0], down * a[1] - up * b[1], down * a[2] + up * b[2]];
        }
        if layer.emission > 0.0 {
            let pi = modes.fluence[j] * layer.emission / (2.0 * PI);
            let s = x - 0.5 * layer.tau;
            let [xi, eta] = if k * layer.tau > 1.0 {
                [pi / (k * k), 0.0]
            } else {
                // (1 - cosh(k s))/k^2, which is -s^2/2 at k = 0.
                let half = swing(k, 0.5 * s);
                [-2.0 * pi * half * half, -pi * swing(k, s)]
            };
            sum = [sum[0] + xi, sum[1] + eta, sum[2] + xi.abs()];
        }
        sum
    }

    /// p and q at depth x of layer i that beams and source bring.
    fn brought(&self, i: usize, x: f64) -> [DVector<f64>; 2] {
        let n = self.nodes().len();
        let parts: Vec<_> = (0..n).map(|j| self.particular(i, j, x)).collect();
        let of = |which: usize| DVector::from_iterator(n, parts.iter().map(|part| part[which]));
        [&self.modes[i].even * of(0), &self.modes[i].odd * of(1)]
    }

    /// Matrices of p and of q at depth x of layer i, for the amplitudes of both solutions.
    fn columns(&self, i: usize, x: f64) -> [DMatrix<f64>; 2] {
        let (modes, tau, n) = (&self.modes[i], self.problem.layers[i].tau, self.nodes().len());
        let (mut p, mut q) = (DMatrix::zeros(n, 2 * n), DMatrix::zeros(n, 2 * n));
        for (j, &k) in modes.k.iter().enumerate() {
            let (shapes, slopes) = shapes(k, tau, x);
            for which in 0..2 {
                p.set_column(which * n + j, &(modes.even.column(j) * shapes[which]));
                q.set_column(which * n + j, &(modes.odd.column(j) * slopes[which]));
            }
        }
        [p, q]
    }

    fn solve(&mut self) -> Result<()> {
        let (n, count) = (self.nodes().len(), self.problem.layers.len());
        let (root, ground) = (self.modes[0].root.clone(), self.problem.ground);
        let slant = DVector::from_fn(n, |i, _| root[i] * self.nodes().mu[i]);
        let mut matrix = DMatrix::zeros(2 * n * count, 2 * n * count);
        let mut right = DVector::zeros(2 * n * count);
        // p - q on the upper face is twice the light that enters.
        let ([p, q], brought) = (self.columns(0, 0.0), self.brought(0, 0.0));
        matrix.view_mut((0, 0), (n, 2 * n)).copy_from(&(p - q));
        let entering = if self.problem.incidence == Some(Incidence::Diffuse) { 2.0 / PI } else { 0.0 };
        right.rows_mut(0, n).copy_from(&(&root * entering - &brought[0] + &brought[1]));
        // p + q on the ground is what p - q makes of it: 2 rho root (slant . (p - q)), or the same.
        let [p, q] = self.columns(count - 1, self.problem.layers[count - 1].tau);
        let [own_p, own_q] = self.brought(count - 1, self.problem.layers[count - 1].tau);
        let row = 2 * n * count - n;
        let (left, own) = if ground.mirror {
            (q * 2.0, own_q * 2.0)
        } else {
            let back = 2.0 * ground.reflectance;
            let (falling, own) = (&p - &q, &own_p - &own_q);
            (
                p + q - &root * (slant.transpose() * falling) * back,
                own_p + own_q - &root * slant.dot(&own) * back,
            )
        };
        matrix.view_mut((row, 2 * n * (count - 1)), (n, 2 * n)).copy_from(&left);
        let arriving = if ground.mirror { 0.0 } else { self.problem.beam(self.problem.tau()) };
        let light = 2.0 / PI * (ground.reflectance * arriving + ground.exitance);
        right.rows_mut(row, n).copy_from(&(&root * light - own));
        for i in 1..count {
            let tau = self.problem.layers[i - 1].tau;
            let (above, below) = (self.columns(i - 1, tau), self.columns(i, 0.0));
            let (over, under) = (self.brought(i - 1, tau), self.brought(i, 0.0));
            for which in 0..2 {
                let row = (2 * i - 1 + which) * n;
                matrix.view_mut((row, 2 * n * (i - 1)), (n, 2 * n)).copy_from(&above[which]);
                matrix.view_mut((row, 2 * n * i), (n, 2 * n)).copy_from(&-&below[which]);
                right.rows_mut(row, n).copy_from(&(&under[which] - &over[which]));
            }
        }
        const SINGULAR: Error = Error::Infinite("the interfaces of the layers cannot be matched in f64");
        let solver = matrix.clone().lu();
        let mut sum = solver.solve(&right).ok_or(SINGULAR)?;
        // What elimination loses, the residual brings back.
        for _ in 0..2 {
            sum += solver.solve(&(&right - &matrix * &sum)).ok_or(SINGULAR)?;
        }
        for (i, amplitudes) in self.amplitudes.iter_mut().enumerate() {
            *amplitudes = [0, 1].map(|which| sum.rows((2 * i + which) * n, n).into_owned());
        }
        let faces = (0..count).flat_map(|i| [(i, 0.0), (i, self.problem.layers[i].tau)]);
        self.magnitude = faces.map(|(i, x)| self.size(i, x)).fold(0.0, f64::max);
        Ok(())
    }

    fn size(&self, i: usize, x: f64) -> f64 {
        let modes = &self.modes[i];
        let terms = modes.k.iter().enumerate().map(|(j, &k)| {
            let ([a, b], _) = shapes(k, self.problem.layers[i].tau, x);
            let [first, second] = &self.amplitudes[i];
            let size = (first[j] * a).abs() + (second[j] * b).abs() + self.particular(i, j, x)[2];
            (2.0 * PI * modes.fluence[j] * size).abs()
        });
        terms.sum()
    }

    /// What roundings may come to, relative to an answer and absolute.
    pub fn rounding(&self) -> [f64; 2] {
        let terms = ((2 * self.nodes().len() * self.modes.len()) as f64).sqrt();
        [0.0, ULPS * terms * f64::EPSILON * self.magnitude]
    }

    /// f and f' of mode j at depth x of layer i.
    fn mode(&self, i: usize, j: usize, x: f64) -> [f64; 2] {
        let ([a, b], [da, db]) = shapes(self.modes[i].k[j], self.problem.layers[i].tau, x);
        let [first, second] = &self.amplitudes[i];
        let part = self.particular(i, j, x);
        [first[j] * a + second[j] * b + part[0], first[j] * da + second[j] * db + part[1]]
    }

    /// Fluence, power downwards and upwards at depth x of layer i, as the nodes have it, without beams.
    fn carried(&self, i: usize, x: f64) -> [f64; 3] {
        let (modes, nodes) = (&self.modes[i], self.nodes());
        let values: Vec<_> = (0..nodes.len()).map(|j| self.mode(i, j, x)).collect();
        let of = |which: usize| DVector::from_iterator(values.len(), values.iter().map(|value| value[which]));
        let (p, q) = (&modes.even * of(0), &modes.odd * of(1));
        let power = |u: DVector<f64>| -> f64 {
            PI * (0..nodes.len()).map(|i| modes.root[i] * nodes.mu[i] * u[i]).sum::<f64>()
        };
        [2.0 * PI * modes.root.dot(&p), power(&p - &q), power(p + q)]
    }

    /// Sum over the nodes of weight times `f`(mu).
    pub fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.nodes().sum(f)
    }

    /// Power per area that leaves through the upper face, the beam in a mirror left out, and that arrives at the
    /// lower one, direct light left out.
    pub fn leaving(&self) -> [f64; 2] {
        let last = self.modes.len() - 1;
        let mut down = self.carried(last, self.problem.layers[last].tau)[1];
        if self.problem.incidence == Some(Incidence::Diffuse) {
            down -= 2.0 * self.nodes().sum(|mu| mu * exp(-self.problem.tau() / mu));
        }
        [self.carried(0, 0.0)[2], down]
    }

    /// Integral over layer i of the fluence.
    pub fn dwelt(&self, i: usize) -> f64 {
        let (layer, modes) = (&self.problem.layers[i], &self.modes[i]);
        let (tau, depths) = (layer.tau, &self.problem.depths);
        let [first, second] = &self.amplitudes[i];
        let mut sum = 0.0;
        for (j, &k) in modes.k.iter().enumerate() {
            let [a, b] = match k * tau {
                lengths if lengths > 1.0 => [decayed(k, tau); 2],
                0.0 => [tau, 0.0],
                _ => [2.0 * tanh(0.5 * k * tau) / k, 0.0],
            };
            sum += modes.fluence[j] * (first[j] * a + second[j] * b + self.brought_to(i, j));
        }
        let beams = self.problem.beam(depths[i]) + self.problem.beam(self.problem.back(depths[i + 1]));
        let direct = match self.problem.incidence {
            Some(Incidence::Beam { mu0 }) => beams * -expm1(-tau / mu0),
            _ => 0.0,
        };
        2.0 * PI * sum + direct
    }

    /// Integral over layer i of xi, of what beams and source bring to mode j.
    fn brought_to(&self, i: usize, j: usize) -> f64 {
        let (layer, modes, depths) = (&self.problem.layers[i], &self.modes[i], &self.problem.depths);
        let (k, tau) = (modes.k[j], layer.tau);
        let mut sum = 0.0;
        if let Some(beam) = &self.beams[i] {
            let falling = decayed(beam.beta, tau);
            let (upper, lower) = (beam.particular(j, k, 0.0, tau), beam.particular(j, k, tau, 0.0));
            let one = if k < SLOW {
                upper[0] * falling
            } else {
                (lower[1] - upper[1] + beam.pi[j] * falling) / (k * k)
            };
            sum += one * (self.problem.beam(depths[i]) + self.problem.beam(self.problem.back(depths[i + 1])));
        }
        if layer.emission > 0.0 {
            let pi = modes.fluence[j] * layer.emission / (2.0 * PI);
            sum += if k * tau > 1.0 {
                pi * tau / (k * k)
            } else {
                GAUSS_16
                    .integrate(-0.5 * tau, 0.5 * tau, |s| -2.0 * pi * swing(k, 0.5 * s) * swing(k, 0.5 * s))
            };
        }
        sum
    }

    /// Fluence, power downwards and upwards at depth x of layer i, direct light as it is and not as the nodes have it.
    pub fn light(&self, i: usize, x: f64) -> Result<[f64; 3]> {
        let [mut fluence, mut down, up] = self.carried(i, x);
        let t = self.problem.depths[i] + x;
        if self.problem.incidence == Some(Incidence::Diffuse) {
            fluence -= 2.0 * self.nodes().sum(|mu| exp(-t / mu));
            down -= 2.0 * self.nodes().sum(|mu| mu * exp(-t / mu));
        }
        let direct = self.problem.direct(t)?;
        Ok([fluence + direct.fluence, down + direct.down, up + direct.up])
    }
}
