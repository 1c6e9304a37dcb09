//! Layers by the modes of discrete ordinates, matched at all interfaces at once.
//!
//! In every layer p = sum p_j f_j(t), q = sum q_j f_j'(t) with f_j'' = k_j^2 f_j, plus what the beams and the source of
//! the layer bring. At a face light downwards is what the layer above lets pass and what the face returns of light
//! upwards, and the other way round; at the lit face light enters, and the ground returns its share. That is one linear
//! system for the amplitudes of all layers.
//!
//! With [`super::adding`] it shares the kind of directions and what the faces do to them: other nodes, other algebra.

use super::grid::{Between, Ends, Grid, Region, Rule};
use super::pile::Passed;
use super::problem::{Layer, Problem};
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
    grid: Grid,
    /// Of all regions but the ground.
    modes: Vec<Arc<Modes>>,
    beams: Vec<Option<Lit>>,
    /// Amplitudes of the two solutions f of every mode.
    amplitudes: Vec<[DVector<f64>; 2]>,
    /// Where those of a region stand in the system.
    starts: Vec<usize>,
    ends: Vec<Ends>,
    /// The largest sum of magnitudes of what makes fluence, at any interface.
    magnitude: f64,
}

/// The beam in a region: its power per area downwards on the upper face and upwards on the lower one, and what it brings.
struct Lit {
    power: [f64; 2],
    beam: Beam,
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
        let rule = Rule { upper: UPPER[set], lower: LOWER[set], power: 4, open: 2.0, degree };
        let grid = Grid::new(problem.clone(), rule, &[]);
        let scattering = problem.scattering();
        let mut starts = vec![0];
        for region in grid.regions.iter().take(scattering.len()) {
            starts.push(starts[starts.len() - 1] + 2 * region.nodes.count);
        }
        let unknown = starts[scattering.len()];
        within("layers", unknown as f64, 0.0, UNKNOWN as f64, "at most 2500 amplitudes by ordinates")?;
        let mut modes: Vec<Arc<Modes>> = Vec::with_capacity(scattering.len());
        for (at, &i) in scattering.iter().enumerate() {
            let layer = &problem.layers[i];
            let like = scattering[..at].iter().map(|&other| &problem.layers[other]).position(|other| {
                (other.albedo, other.index) == (layer.albedo, layer.index) && other.phase == layer.phase
            });
            modes.push(match like {
                Some(i) => modes[i].clone(),
                None => {
                    let crate::adding_doubling::Nodes { mu, weight, .. } = grid.regions[at].nodes.clone();
                    let scattering = Scattering::new(layer.albedo, &layer.phase, degree, false);
                    Arc::new(Modes::new(Arc::new(scattering), Arc::new(Nodes::of(mu, weight, degree)), 0)?)
                }
            });
        }
        let lit = |(modes, &layer): (&Arc<Modes>, &usize)| {
            let (mu, power) = problem.beam(layer)?;
            let (pi, kappa) = modes.beam(mu);
            Some(Lit { power, beam: Beam { beta: 1.0 / mu, pi, kappa } })
        };
        let beams = modes.iter().zip(&scattering).map(lit).collect();
        let mut matched = Matched {
            problem: problem.clone(),
            grid,
            modes,
            beams,
            amplitudes: Vec::new(),
            starts,
            ends: Vec::new(),
            magnitude: 0.0,
        };
        matched.solve()?;
        Ok(matched)
    }

    fn layer(&self, at: usize) -> &Layer {
        &self.problem.layers[self.grid.regions[at].layer]
    }

    /// 2 pi mu and the root of the weight: times light the power, and over 2 pi mu the light of a radiance of 1.
    fn slant(&self, at: usize) -> DVector<f64> {
        let nodes = &self.grid.regions[at].nodes;
        DVector::from_fn(nodes.count, |i, _| 2.0 * PI * nodes.mu[i] * nodes.weight[i].sqrt())
    }

    /// xi, eta and the magnitude of xi of what beams and source bring to mode j, at depth x of region i.
    fn particular(&self, i: usize, j: usize, x: f64) -> [f64; 3] {
        let (layer, modes) = (self.layer(i), &self.modes[i]);
        let (k, rest) = (modes.k[j], layer.tau - x);
        let mut sum = [0.0; 3];
        if let Some(Lit { power: [down, up], beam }) = &self.beams[i] {
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

    /// p and q at depth x of region i that beams and source bring.
    fn brought(&self, i: usize, x: f64) -> [DVector<f64>; 2] {
        let n = self.modes[i].k.len();
        let parts: Vec<_> = (0..n).map(|j| self.particular(i, j, x)).collect();
        let of = |which: usize| DVector::from_iterator(n, parts.iter().map(|part| part[which]));
        [&self.modes[i].even * of(0), &self.modes[i].odd * of(1)]
    }

    /// Matrices of p and of q at depth x of region i, for the amplitudes of both solutions.
    fn columns(&self, i: usize, x: f64) -> [DMatrix<f64>; 2] {
        let (modes, tau, n) = (&self.modes[i], self.layer(i).tau, self.modes[i].k.len());
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
        let count = self.modes.len();
        let ground = self.problem.ground;
        let unknown = self.starts[count];
        let mut matrix = DMatrix::zeros(unknown, unknown);
        let mut right = DVector::zeros(unknown);
        let slants: Vec<DVector<f64>> = (0..self.grid.regions.len()).map(|at| self.slant(at)).collect();
        // What the faces let pass of light of one region, by the light of the other one.
        let passing = |passed: &[Passed], from: &DVector<f64>, to: &DVector<f64>| {
            let common = from.len().min(to.len());
            let (from_start, to_start) = (from.len() - common, to.len() - common);
            (0..common)
                .map(move |j| {
                    let (i, k) = (from_start + j, to_start + j);
                    (i, k, passed[i].arrived * from[i] / to[k])
                })
                .collect::<Vec<_>>()
        };
        for i in 0..count {
            let (n, start) = (self.modes[i].k.len(), self.starts[i]);
            // Twice the light that leaves a face into the region is (1-r) p -+ (1+r) q.
            for (x, sign, row, passed) in [
                (0.0, -1.0, start, &self.grid.between[i].up),
                (self.layer(i).tau, 1.0, start + n, &self.grid.between[i + 1].down),
            ] {
                let [mut p, mut q] = self.columns(i, x);
                let [mut own_p, mut own_q] = self.brought(i, x);
                for k in 0..n {
                    let r = passed[k].reflected;
                    p.row_mut(k).scale_mut(1.0 - r);
                    q.row_mut(k).scale_mut(sign * (1.0 + r));
                    own_p[k] *= 1.0 - r;
                    own_q[k] *= sign * (1.0 + r);
                }
                matrix.view_mut((row, start), (n, 2 * n)).copy_from(&(p + q));
                right.rows_mut(row, n).copy_from(&-(own_p + own_q));
            }
            // Light from the region above and from that below.
            for (other, x, sign, row) in [
                (i.checked_sub(1), None, -1.0, start),
                ((i + 1 < count).then_some(i + 1), Some(0.0), 1.0, start + n),
            ] {
                let Some(other) = other else { continue };
                let x = x.unwrap_or(self.layer(other).tau);
                let between = &self.grid.between[i.max(other)];
                let passed = if other < i { &between.down } else { &between.up };
                let ([p, q], [own_p, own_q]) = (self.columns(other, x), self.brought(other, x));
                let (light, own) = (p + q * sign, own_p + own_q * sign);
                for (from, to, t) in passing(passed, &slants[other], &slants[i]) {
                    let width = light.ncols();
                    matrix
                        .view_mut((row + to, self.starts[other]), (1, width))
                        .copy_from(&(light.row(from) * -t));
                    right[row + to] += t * own[from];
                }
            }
        }
        let diffuse = self.problem.incidence == Some(Incidence::Diffuse);
        if diffuse && count > 0 {
            let nodes = &self.grid.regions[0].nodes;
            let n = self.problem.index(self.grid.regions[0].layer);
            for k in 0..nodes.count {
                let power = 2.0 * n * n * nodes.mu[k] * nodes.weight[k] * self.grid.between[0].up[k].arrived;
                right[k] += 2.0 * power / slants[0][k];
            }
        }
        // The ground has the radiance (rho F + M)/(pi (1 - rho h)), h what the faces over it return, F what arrives from
        // the regions and in beams.
        let mut shining = 0.0;
        let mut lit = Vec::new();
        let arrived = if diffuse && count > 0 { 0.0 } else { self.problem.arrived()?.value };
        if let Some(last) = self.grid.regions.get(count) {
            let up = &self.grid.between[count].up;
            let power = |k: usize| 2.0 * last.nodes.mu[k] * last.nodes.weight[k];
            let back: f64 = (0..last.nodes.count).map(|k| power(k) * up[k].reflected).sum();
            let open = 1.0 / (PI * (1.0 - ground.reflectance * back));
            shining = (ground.reflectance * arrived + ground.exitance) * open;
            if count > 0 {
                let (i, tau) = (count - 1, self.layer(count - 1).tau);
                let (n, start) = (self.modes[i].k.len(), self.starts[i]);
                let down = &self.grid.between[count].down;
                let mut falling = DVector::zeros(n);
                let mut rising = DVector::zeros(n);
                for (from, to, t) in passing(up, &slants[count], &slants[i]) {
                    rising[to] = t * last.nodes.weight[from].sqrt();
                    falling[to] = ground.reflectance * open * down[to].arrived * slants[i][to];
                }
                let ([p, q], [own_p, own_q]) = (self.columns(i, tau), self.brought(i, tau));
                let (columns, own) = (falling.transpose() * (p - q), falling.dot(&(own_p - own_q)));
                let mut block = matrix.view_mut((start + n, start), (n, 2 * n));
                block -= &rising * columns;
                let mut rows = right.rows_mut(start + n, n);
                rows += &rising * (own + 2.0 * shining);
                lit = vec![falling];
            }
        }
        const SINGULAR: Error = Error::Infinite("the interfaces of the layers cannot be matched in f64");
        let mut sum = right.clone();
        if unknown > 0 {
            let solver = matrix.clone().lu();
            sum = solver.solve(&right).ok_or(SINGULAR)?;
            // What elimination loses, the residual brings back.
            for _ in 0..2 {
                sum += solver.solve(&(&right - &matrix * &sum)).ok_or(SINGULAR)?;
            }
        }
        for i in 0..count {
            let n = self.modes[i].k.len();
            let of = |which: usize| sum.rows(self.starts[i] + which * n, n).into_owned();
            let amplitudes = [of(0), of(1)];
            self.amplitudes.push(amplitudes);
        }
        for i in 0..count {
            let ends = [0.0, self.layer(i).tau].map(|x| self.power(i, x));
            let [top, bottom] = ends;
            self.ends.push(Ends { top, bottom });
        }
        if let Some(last) = self.grid.regions.get(count) {
            if let Some(falling) = lit.first() {
                let [p, q] = self.fields(count - 1, self.layer(count - 1).tau);
                shining += 0.5 * falling.dot(&(p - q));
            }
            let Between { down, up, .. } = &self.grid.between[count];
            let rising: Vec<f64> = (0..last.nodes.count)
                .map(|k| 2.0 * PI * last.nodes.mu[k] * last.nodes.weight[k] * shining)
                .collect();
            let mut falling: Vec<f64> =
                rising.iter().zip(up).map(|(power, passed)| power * passed.reflected).collect();
            if let Some(above) = self.ends.last() {
                let power = &above.bottom[0];
                let common = power.len().min(falling.len());
                let start = falling.len() - common;
                for (j, i) in (power.len() - common..power.len()).enumerate() {
                    falling[start + j] += power[i] * down[i].arrived;
                }
            }
            self.ends.push(Ends { top: [falling, rising], bottom: [Vec::new(), Vec::new()] });
        }
        let faces = (0..count).flat_map(|i| [(i, 0.0), (i, self.layer(i).tau)]);
        self.magnitude = faces.map(|(i, x)| self.size(i, x)).fold(0.0, f64::max);
        Ok(())
    }

    fn size(&self, i: usize, x: f64) -> f64 {
        let modes = &self.modes[i];
        let terms = modes.k.iter().enumerate().map(|(j, &k)| {
            let ([a, b], _) = shapes(k, self.layer(i).tau, x);
            let [first, second] = &self.amplitudes[i];
            let size = (first[j] * a).abs() + (second[j] * b).abs() + self.particular(i, j, x)[2];
            (2.0 * PI * modes.fluence[j] * size).abs()
        });
        terms.sum()
    }

    /// What roundings may come to, relative to an answer and absolute.
    pub fn rounding(&self) -> [f64; 2] {
        let terms = (self.starts[self.modes.len()] as f64).sqrt();
        [0.0, ULPS * terms * f64::EPSILON * self.magnitude]
    }

    /// f and f' of mode j at depth x of region i.
    fn mode(&self, i: usize, j: usize, x: f64) -> [f64; 2] {
        let ([a, b], [da, db]) = shapes(self.modes[i].k[j], self.layer(i).tau, x);
        let [first, second] = &self.amplitudes[i];
        let part = self.particular(i, j, x);
        [first[j] * a + second[j] * b + part[0], first[j] * da + second[j] * db + part[1]]
    }

    /// p and q at depth x of region i.
    fn fields(&self, i: usize, x: f64) -> [DVector<f64>; 2] {
        let modes = &self.modes[i];
        let n = modes.k.len();
        let values: Vec<_> = (0..n).map(|j| self.mode(i, j, x)).collect();
        let of = |which: usize| DVector::from_iterator(n, values.iter().map(|value| value[which]));
        [&modes.even * of(0), &modes.odd * of(1)]
    }

    /// Power of scattered light at every node, downwards and upwards, at depth x of region i.
    fn power(&self, i: usize, x: f64) -> [Vec<f64>; 2] {
        let ([p, q], slant) = (self.fields(i, x), self.slant(i));
        let Region { nodes, direct, .. } = &self.grid.regions[i];
        let rest = self.layer(i).tau - x;
        let of = |sign: f64, direct: &[f64], x: f64| {
            let one = |k: usize| 0.5 * slant[k] * (p[k] + sign * q[k]) - direct[k] * exp(-x / nodes.mu[k]);
            (0..nodes.count).map(one).collect()
        };
        [of(-1.0, &direct[0], x), of(1.0, &direct[1], rest)]
    }

    /// int e^(-d/mu) dmu by the nodes in a layer.
    pub fn transmission(&self, layer: usize, d: f64) -> Option<f64> {
        self.grid.transmission(layer, d)
    }

    /// Scattered light that leaves through the upper face, and that arrives at the ground.
    pub fn leaving(&self) -> [f64; 2] {
        self.grid.leaving(&self.ends)
    }

    /// Integral over layer i of the fluence; over a plate, of scattered light.
    pub fn dwelt(&self, layer: usize) -> f64 {
        let Some(i) = self.grid.region(layer) else { return self.grid.dwelt_in_plate(layer, &self.ends) };
        let (tau, modes) = (self.layer(i).tau, &self.modes[i]);
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
        let direct = match &self.beams[i] {
            Some(Lit { power: [down, up], beam }) => (down + up) * -expm1(-beam.beta * tau),
            None => 0.0,
        };
        2.0 * PI * sum + direct
    }

    /// Integral over region i of xi, of what beams and source bring to mode j.
    fn brought_to(&self, i: usize, j: usize) -> f64 {
        let (layer, modes) = (self.layer(i), &self.modes[i]);
        let (k, tau) = (modes.k[j], layer.tau);
        let mut sum = 0.0;
        if let Some(Lit { power: [down, up], beam }) = &self.beams[i] {
            let falling = decayed(beam.beta, tau);
            let (upper, lower) = (beam.particular(j, k, 0.0, tau), beam.particular(j, k, tau, 0.0));
            let one = if k < SLOW {
                upper[0] * falling
            } else {
                (lower[1] - upper[1] + beam.pi[j] * falling) / (k * k)
            };
            sum += one * (down + up);
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

    /// Fluence, power downwards and upwards of scattered light at depth x of a layer.
    pub fn light(&self, layer: usize, x: f64) -> Result<[f64; 3]> {
        let Some(i) = self.grid.region(layer) else {
            return Ok(self.grid.light_in_plate(layer, x, &self.ends));
        };
        let [down, up] = self.power(i, x);
        let nodes = &self.grid.regions[i].nodes;
        let fluence = (0..nodes.count).map(|k| (down[k] + up[k]) / nodes.mu[k]).sum();
        Ok([fluence, down.iter().sum(), up.iter().sum()])
    }
}
