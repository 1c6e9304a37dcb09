//! Layers added from the ground up, and light followed from the top down.
//!
//! With R_k what all below interface k returns and E_k what comes out of it by itself, a layer (R, e + T, s) on top makes
//!
//! R_k = R + (e+T) R' S (e+T),  E_k = s + (e+T) (R' S (s + R E') + E'),  S = 1 + K = (1 - R R')^-1
//!
//! where R' and E' are those of interface k + 1. On the way down, light d_k on the upper face arrives at the lower one as
//! S ((e+T) d_k + s + R E'). All terms are positive, and light scattered is kept apart from direct light.

use super::problem::Problem;
use crate::adding_doubling::{LOWER, Layer, Nodes, Stack, ULPS, bounces, degrees, entering, upper};
use crate::error::Result;
use crate::incidence::Incidence;
use libm::{exp, sqrt};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// A layer on the nodes: as a whole, and, once asked for, with all the layers on the way.
struct Slice {
    /// Where its like stands.
    tau: f64,
    albedo: f64,
    moments: Vec<f64>,
    whole: Layer,
    inside: OnceLock<Result<Stack>>,
}

/// The azimuthal mean on one set of nodes.
pub(super) struct Added {
    problem: Arc<Problem>,
    nodes: Nodes,
    slices: Vec<Arc<Slice>>,
    entering: DVector<f64>,
    /// Light downwards at the interfaces that is not direct, and all light upwards.
    scattered: Vec<DVector<f64>>,
    up: Vec<DVector<f64>>,
}

impl Added {
    /// # Arguments
    /// `set` 0 for the finer nodes; `cosines` further directions, for [`Self::radiance`]
    pub fn new(problem: Arc<Problem>, set: usize, cosines: &[f64]) -> Result<Self> {
        let mut degree = Vec::with_capacity(problem.layers.len());
        for layer in &problem.layers {
            degree.push(degrees(&layer.phase)?[set]);
        }
        let nodes = Nodes::open(upper(set, degree.iter().copied().fold(0, usize::max)), LOWER[set]);
        Self::on(problem, nodes, cosines, &degree)
    }

    /// The same on any nodes, with the moments of each layer up to its degree.
    pub fn on(problem: Arc<Problem>, nodes: Nodes, cosines: &[f64], degree: &[usize]) -> Result<Self> {
        let mut users = match problem.incidence {
            Some(Incidence::Beam { mu0 }) => vec![mu0],
            _ => Vec::new(),
        };
        users.extend(cosines);
        let nodes = nodes.with(&users);
        let mut slices: Vec<Arc<Slice>> = Vec::with_capacity(problem.layers.len());
        for (i, layer) in problem.layers.iter().enumerate() {
            let like = problem.layers[..i].iter().position(|other| {
                (other.tau, other.albedo) == (layer.tau, layer.albedo) && other.phase == layer.phase
            });
            slices.push(match like {
                Some(i) => slices[i].clone(),
                None => {
                    let moments: Vec<f64> = (0..=degree[i]).map(|l| layer.phase.moment(l)).collect();
                    let whole = Stack::new(layer.tau, layer.albedo, &moments, 0, nodes.clone())?.into_whole();
                    let (tau, albedo) = (layer.tau, layer.albedo);
                    Arc::new(Slice { tau, albedo, moments, whole, inside: OnceLock::new() })
                }
            });
        }
        let entering = problem.incidence.map_or(DVector::zeros(nodes.len()), |light| entering(&nodes, light));
        let mut added = Added { problem, nodes, slices, entering, scattered: Vec::new(), up: Vec::new() };
        added.follow()?;
        Ok(added)
    }

    /// root(mu weight): times the radiance the light in a direction, times light the power.
    fn root(&self) -> DVector<f64> {
        DVector::from_fn(self.nodes.len(), |i, _| sqrt(self.nodes.mu[i] * self.nodes.weight[i]))
    }

    /// What leaves layer i through either face of its own light.
    fn own(&self, i: usize) -> DVector<f64> {
        &self.slices[i].whole.dwelt * (self.problem.layers[i].emission / (4.0 * PI))
    }

    fn follow(&mut self) -> Result<()> {
        let (n, count) = (self.nodes.len(), self.slices.len());
        let (root, ground) = (self.root(), self.problem.ground);
        let mut returned = vec![if ground.mirror {
            DMatrix::identity(n, n)
        } else {
            &root * root.transpose() * (2.0 * ground.reflectance)
        }];
        let mut emerging = vec![root * (ground.exitance / PI)];
        let mut bounced = Vec::with_capacity(count);
        for i in (0..count).rev() {
            let layer = &self.slices[i].whole;
            let (below, rising) = (&returned[count - 1 - i], &emerging[count - 1 - i]);
            let k = bounces(&layer.reflected * below, false)?;
            let through = layer.through();
            let own = self.own(i);
            let once = &own + &layer.reflected * rising;
            let down = &once + &k * &once;
            let up = &own + &through * (below * down + rising);
            let sum = below + below * &k;
            let sum = &layer.reflected + &through * (sum * &through);
            returned.push(sum);
            emerging.push(up);
            bounced.push(k);
        }
        let mut scattered = vec![DVector::zeros(n)];
        let mut up = vec![&returned[count] * &self.entering + &emerging[count]];
        for i in 0..count {
            let layer = &self.slices[i].whole;
            let (below, rising) = (&returned[count - 1 - i], &emerging[count - 1 - i]);
            let direct = self.direct(self.problem.depths[i]);
            let arriving = &layer.scattered * &direct
                + layer.transmit(&scattered[i])
                + self.own(i)
                + &layer.reflected * rising;
            let all = direct.component_mul(&layer.direct) + &arriving;
            let light = arriving + &bounced[count - 1 - i] * all;
            up.push(below * (&light + self.direct(self.problem.depths[i + 1])) + rising);
            scattered.push(light);
        }
        (self.scattered, self.up) = (scattered, up);
        Ok(())
    }

    /// Direct light at depth `t`, as the nodes have it.
    fn direct(&self, t: f64) -> DVector<f64> {
        DVector::from_fn(self.nodes.len(), |i, _| self.entering[i] * exp(-t / self.nodes.mu[i]))
    }

    /// Power per area that a vector of light carries through a plane, without a beam.
    fn power(&self, u: &DVector<f64>) -> f64 {
        let (mu, weight) = (&self.nodes.mu, &self.nodes.weight);
        2.0 * PI * (0..self.nodes.count).map(|i| sqrt(mu[i] * weight[i]) * u[i]).sum::<f64>()
    }

    /// Roundings of the sums, relative to each: of the doublings, the layers, and all along the way of a photon.
    pub fn rounding(&self) -> [f64; 2] {
        let doublings = self.problem.layers.iter().map(|layer| 4.0 + libm::log2(layer.tau * 1e9).max(0.0));
        let most = doublings.fold(0.0, f64::max) + 2.0 * self.slices.len() as f64;
        [ULPS * f64::EPSILON * most * (1.0 + 2.0 * self.problem.tau()), 0.0]
    }

    /// Sum over the nodes of weight times `f`(mu).
    pub fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.nodes.sum(f)
    }

    /// Power per area that leaves through the upper face, the beam in a mirror left out, and that arrives at the
    /// lower one, direct light left out.
    pub fn leaving(&self) -> [f64; 2] {
        [self.power(&self.up[0]), self.power(&self.scattered[self.slices.len()])]
    }

    /// Integral over layer i of the fluence.
    pub fn dwelt(&self, i: usize) -> f64 {
        let light = self.direct(self.problem.depths[i]) + &self.scattered[i] + &self.up[i + 1];
        let whole = &self.slices[i].whole;
        2.0 * PI * whole.dwelt.dot(&light) + self.problem.layers[i].emission * whole.own
    }

    /// Light downwards and upwards at depth `x` of layer i.
    fn field(&self, i: usize, x: f64) -> Result<(DVector<f64>, DVector<f64>)> {
        let top = || self.direct(self.problem.depths[i]) + &self.scattered[i];
        if x == 0.0 {
            return Ok((top(), self.up[i].clone()));
        }
        let slice = &self.slices[i];
        if x == slice.tau {
            let down = self.direct(self.problem.depths[i + 1]) + &self.scattered[i + 1];
            return Ok((down, self.up[i + 1].clone()));
        }
        let solve = || Stack::new(slice.tau, slice.albedo, &slice.moments, 0, self.nodes.clone());
        let stack = slice.inside.get_or_init(solve).as_ref().map_err(Clone::clone)?;
        Ok(stack.field_of(x, top(), self.up[i + 1].clone(), self.problem.layers[i].emission))
    }

    /// Fluence, power downwards and upwards at depth `x` of layer i, direct light as it is and not as the nodes have it.
    pub fn light(&self, i: usize, x: f64) -> Result<[f64; 3]> {
        let (down, up) = self.field(i, x)?;
        let t = self.problem.depths[i] + x;
        let (mu, weight) = (&self.nodes.mu, &self.nodes.weight);
        let sum: f64 = (0..self.nodes.count).map(|i| sqrt(weight[i] / mu[i]) * (down[i] + up[i])).sum();
        let (mut fluence, mut falling) = (2.0 * PI * sum, self.power(&down));
        if self.problem.incidence == Some(Incidence::Diffuse) {
            fluence -= 2.0 * self.nodes.sum(|mu| exp(-t / mu));
            falling -= 2.0 * self.nodes.sum(|mu| mu * exp(-t / mu));
        }
        let direct = self.problem.direct(t)?;
        Ok([fluence + direct.fluence, falling + direct.down, self.power(&up) + direct.up])
    }

    /// Radiance in the further direction `user`, downwards and upwards, at depth `x` of layer i.
    pub fn radiance(&self, i: usize, x: f64, user: usize) -> Result<[f64; 2]> {
        let beam = usize::from(matches!(self.problem.incidence, Some(Incidence::Beam { .. })));
        let j = self.nodes.count + beam + user;
        let root = sqrt(self.nodes.mu[j] * self.nodes.weight[j]);
        let (down, up) = self.field(i, x)?;
        Ok([down[j] / root, up[j] / root])
    }
}
