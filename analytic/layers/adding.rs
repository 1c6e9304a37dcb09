//! Layers added from the ground up, and scattered light followed from the top down.
//!
//! With R_k what all below the upper face of region k returns and E_k what comes out of it by itself, R' and E' the same
//! at its lower face, a layer (R, e + T) in which s_up and s_down leave its faces makes
//!
//! R_k = R + (e+T) R' S (e+T),  E_k = s_up + (e+T) (R' S (s_down + R E') + E'),  S = 1 + K = (1 - R R')^-1
//!
//! and plates and faces that reflect r_a from above, r_b from below and let pass t
//!
//! R' = r_a + t S R_k t,  E' = t S E_k,  S = (1 - R_k r_b)^-1
//!
//! On the way down, light d on the upper face arrives at the lower one as S ((e+T) d + s_down + R E'). All terms are
//! positive. s is light of the layer's own and what it scatters of direct light, which is known without nodes and is kept
//! apart. r and t are numbers of each direction: a node is a direction in all regions, and its power passes from one to the other.

use super::grid::{Between, Ends, Grid, Rule};
use super::pile::Passed;
use super::problem::Problem;
use crate::adding_doubling::{LOWER, Layer, Nodes, Stack, ULPS, bounces, degrees, upper};
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

/// The azimuthal mean, or another mode, on one set of nodes.
pub(super) struct Added {
    grid: Grid,
    /// The part that goes with cos(m dphi).
    order: usize,
    /// Of all regions but the ground.
    slices: Vec<Arc<Slice>>,
    /// root(mu weight) of all regions: times the radiance the light in a direction, times light the power.
    roots: Vec<DVector<f64>>,
    /// Light downwards on the upper face of each region that has been scattered, and light upwards on the lower one.
    down: Vec<DVector<f64>>,
    up: Vec<DVector<f64>>,
    ends: Vec<Ends>,
    /// The largest number of reflections between a face and what lies below it.
    trapped: f64,
}

/// What a plane returns, and what comes out of it by itself.
struct Below {
    returned: DMatrix<f64>,
    emerging: DVector<f64>,
}

/// What a pile makes of light of the region above: S R and S E of the one below it.
struct Crossing {
    returned: DMatrix<f64>,
    emerging: DVector<f64>,
}

impl Added {
    /// # Arguments
    /// `set` 0 for the finer nodes; `cosines` further directions, of a layer of index `index`, for [`Self::radiance`]
    pub fn new(problem: Arc<Problem>, set: usize, index: f64, cosines: &[f64]) -> Result<Self> {
        let mut degree = Vec::with_capacity(problem.layers.len());
        for layer in &problem.layers {
            degree.push(degrees(&layer.phase)?[set]);
        }
        let most = degree.iter().copied().fold(0, usize::max);
        Self::on(problem, Self::rule(set, most), index, cosines, &degree, 0)
    }

    /// The nodes that follow moments up to `degree`.
    pub fn rule(set: usize, degree: usize) -> Rule {
        Rule { upper: upper(set, 0), lower: LOWER[set], power: 5, open: 3.0, degree }
    }

    /// Mode `order` on any nodes, with the moments of each layer up to its degree.
    pub fn on(
        problem: Arc<Problem>,
        rule: Rule,
        index: f64,
        cosines: &[f64],
        degree: &[usize],
        order: usize,
    ) -> Result<Self> {
        let mut users = match problem.incidence {
            Some(Incidence::Beam { mu0 }) => vec![(1.0, mu0)],
            _ => Vec::new(),
        };
        users.extend(cosines.iter().map(|&mu| (index, mu)));
        let grid = Grid::new(problem.clone(), rule, &users);
        let mut slices: Vec<Arc<Slice>> = Vec::with_capacity(problem.layers.len());
        let scattering = problem.scattering();
        for (at, &i) in scattering.iter().enumerate() {
            let layer = &problem.layers[i];
            let like = scattering[..at].iter().position(|&other| {
                let other = &problem.layers[other];
                (other.tau, other.albedo, other.index) == (layer.tau, layer.albedo, layer.index)
                    && other.phase == layer.phase
            });
            slices.push(match like {
                Some(i) => slices[i].clone(),
                None => {
                    let moments: Vec<f64> = (0..=degree[i]).map(|l| layer.phase.moment(l)).collect();
                    let nodes = grid.regions[at].nodes.clone();
                    let whole = Stack::new(layer.tau, layer.albedo, &moments, order, nodes)?.into_whole();
                    let (tau, albedo) = (layer.tau, layer.albedo);
                    Arc::new(Slice { tau, albedo, moments, whole, inside: OnceLock::new() })
                }
            });
        }
        let root = |nodes: &Nodes| DVector::from_fn(nodes.len(), |i, _| sqrt(nodes.mu[i] * nodes.weight[i]));
        let roots = grid.regions.iter().map(|region| root(&region.nodes)).collect();
        let mut added = Added {
            grid,
            order,
            slices,
            roots,
            down: Vec::new(),
            up: Vec::new(),
            ends: Vec::new(),
            trapped: 0.0,
        };
        added.follow()?;
        Ok(added)
    }

    /// Direct light on the upper and lower face of a region, as its nodes have it.
    fn direct(&self, region: usize) -> [DVector<f64>; 2] {
        let power = &self.grid.regions[region].direct;
        [0, 1]
            .map(|face| self.roots[region].map_with_location(|i, _, root| power[face][i] / (2.0 * PI * root)))
    }

    /// What starts in a region, in all directions alike.
    fn emission(&self, region: usize) -> f64 {
        let alike = if self.order == 0 { 1.0 } else { 0.0 };
        alike * self.grid.problem.layers[self.grid.regions[region].layer].emission
    }

    /// What leaves a region through its upper and lower face of its own light and after scattering direct light.
    fn started(&self, region: usize) -> [DVector<f64>; 2] {
        let [top, bottom] = self.direct(region);
        let slice = &self.slices[region].whole;
        let emission = self.emission(region);
        let own = &slice.dwelt * (emission / (4.0 * PI));
        [
            &slice.reflected * &top + &slice.scattered * &bottom + &own,
            &slice.scattered * &top + &slice.reflected * &bottom + own,
        ]
    }

    fn follow(&mut self) -> Result<()> {
        let regions = self.grid.regions.len();
        let ground = self.grid.problem.ground;
        let mut below = match self.grid.between.get(regions) {
            // The mirror is in the pile, and nothing lies below it.
            Some(_) => Below { returned: DMatrix::zeros(0, 0), emerging: DVector::zeros(0) },
            None => {
                let root = &self.roots[regions - 1];
                let arrived = self.grid.problem.arrived()?.value;
                // A Lambertian ground keeps nothing of an azimuth.
                let alike = if self.order == 0 { 1.0 } else { 0.0 };
                Below {
                    returned: root * root.transpose() * (2.0 * alike * ground.reflectance),
                    emerging: root * (alike * (ground.exitance + ground.reflectance * arrived) / PI),
                }
            }
        };
        let mut crossings: Vec<Crossing> = Vec::with_capacity(regions + 1);
        let mut bounced: Vec<(Below, DMatrix<f64>, [DVector<f64>; 2])> = Vec::with_capacity(regions);
        for at in (0..self.grid.between.len()).rev() {
            let (crossing, above) = self.cross(at, below)?;
            crossings.push(crossing);
            if at == 0 {
                break;
            }
            let layer = &self.slices[at - 1].whole;
            let [up, down] = self.started(at - 1);
            let k = bounces(&layer.reflected * &above.returned, false)?;
            let through = layer.through();
            let once = &down + &layer.reflected * &above.emerging;
            let light = &once + &k * &once;
            let emerging = &up + &through * (&above.returned * light + &above.emerging);
            let sum = &above.returned + &above.returned * &k;
            below = Below { returned: &layer.reflected + &through * (sum * &through), emerging };
            bounced.push((above, k, [up, down]));
        }
        crossings.reverse();
        bounced.reverse();
        let mut light = DVector::zeros(0);
        for (at, crossing) in crossings.iter().enumerate().take(regions) {
            let [falling, rising] = self.crossed(at, crossing, &light);
            if at == self.slices.len() {
                let ends = self.powers(at, [&falling, &rising], None);
                self.ends.push(ends);
                break;
            }
            let layer = &self.slices[at].whole;
            let (above, k, [_, down]) = &bounced[at];
            let arriving = layer.transmit(&falling) + down + &layer.reflected * &above.emerging;
            light = &arriving + k * &arriving;
            let up = &above.returned * &light + &above.emerging;
            let ends = self.powers(at, [&falling, &rising], Some([&light, &up]));
            self.ends.push(ends);
            self.down.push(falling);
            self.up.push(up);
        }
        Ok(())
    }

    fn powers(&self, region: usize, top: [&DVector<f64>; 2], bottom: Option<[&DVector<f64>; 2]>) -> Ends {
        let power = |u: &DVector<f64>| -> Vec<f64> {
            u.iter().zip(&self.roots[region]).map(|(u, root)| 2.0 * PI * root * u).collect()
        };
        Ends {
            top: top.map(power),
            bottom: bottom.map_or([Vec::new(), Vec::new()], |bottom| bottom.map(power)),
        }
    }

    /// Light of the region above as that below has it, and the other way round: t, and the unit of light.
    fn through(&self, at: usize) -> [Vec<f64>; 2] {
        let Between { down, up, .. } = &self.grid.between[at];
        if at == 0 || down.is_empty() || up.is_empty() {
            return [Vec::new(), Vec::new()];
        }
        let (above, below) = (&self.roots[at - 1], &self.roots[at]);
        let common = above.len().min(below.len());
        let pairs = above.iter().skip(above.len() - common).zip(below.iter().skip(below.len() - common));
        let units: Vec<f64> = pairs.map(|(above, below)| above / below).collect();
        let of = |passed: &Passed, unit: f64| passed.arrived * unit;
        [
            down[down.len() - common..].iter().zip(&units).map(|(p, unit)| of(p, *unit)).collect(),
            up[up.len() - common..].iter().zip(&units).map(|(p, unit)| of(p, 1.0 / unit)).collect(),
        ]
    }

    /// What the plane above the pile `at` returns when `below` lies below it.
    fn cross(&mut self, at: usize, below: Below) -> Result<(Crossing, Below)> {
        let Between { pile, down, up, .. } = &self.grid.between[at];
        let Below { mut returned, mut emerging } = below;
        if pile.is_nothing() {
            let crossing = Crossing { returned: returned.clone(), emerging: emerging.clone() };
            return Ok((crossing, Below { returned, emerging }));
        }
        if up.iter().any(|passed| passed.reflected > 0.0) {
            let mut turned = returned.clone();
            for (mut column, passed) in turned.column_iter_mut().zip(up) {
                column *= passed.reflected;
            }
            let k = bounces(turned, false)?;
            self.trapped = k.diagonal().iter().fold(self.trapped, |a, &b| a.max(b));
            emerging += &k * &emerging;
            returned += &k * &returned;
        }
        let [onto, back] = self.through(at);
        let (n, common) = (down.len(), onto.len());
        let start = returned.nrows() - common;
        let mut all = DMatrix::from_fn(n, n, |i, j| if i == j { down[i].reflected } else { 0.0 });
        let mut light = DVector::zeros(n);
        for i in 0..common {
            for j in 0..common {
                all[(n - common + i, n - common + j)] += back[i] * returned[(start + i, start + j)] * onto[j];
            }
            light[n - common + i] = back[i] * emerging[start + i];
        }
        Ok((Crossing { returned, emerging }, Below { returned: all, emerging: light }))
    }

    /// Light downwards and upwards on the upper face of region `at`, when `light` falls on the pile over it.
    fn crossed(&self, at: usize, crossing: &Crossing, light: &DVector<f64>) -> [DVector<f64>; 2] {
        let onto = self.through(at)[0].clone();
        let n = self.roots[at].len();
        let mut falling = DVector::zeros(n);
        for (i, t) in onto.iter().enumerate() {
            falling[n - onto.len() + i] = t * light[light.len() - onto.len() + i];
        }
        let rising = &crossing.returned * &falling + &crossing.emerging;
        for (i, passed) in self.grid.between[at].up.iter().enumerate() {
            falling[i] += passed.reflected * rising[i];
        }
        [falling, rising]
    }

    /// Roundings of the sums, relative to each: of the doublings, the layers, and all along the way of a photon.
    pub fn rounding(&self) -> [f64; 2] {
        let doublings = self.slices.iter().map(|slice| 4.0 + libm::log2(slice.tau * 1e9).max(0.0));
        let most = doublings.fold(4.0, f64::max) + 2.0 * self.grid.problem.layers.len() as f64;
        [ULPS * f64::EPSILON * most * (1.0 + 2.0 * self.grid.problem.tau() + self.trapped), 0.0]
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
    pub fn dwelt(&self, i: usize) -> f64 {
        let Some(region) = self.grid.region(i) else { return self.grid.dwelt_in_plate(i, &self.ends) };
        let [top, bottom] = self.direct(region);
        let light = top + bottom + &self.down[region] + &self.up[region];
        let whole = &self.slices[region].whole;
        2.0 * PI * whole.dwelt.dot(&light) + self.emission(region) * whole.own
    }

    /// Power of scattered light at every node, downwards and upwards, at depth `x` of a region.
    fn field(&self, region: usize, x: f64) -> Result<[Vec<f64>; 2]> {
        let (slice, ends) = (&self.slices[region], &self.ends[region]);
        if x == 0.0 {
            return Ok(ends.top.clone());
        }
        if x == slice.tau {
            return Ok(ends.bottom.clone());
        }
        let nodes = &self.grid.regions[region].nodes;
        let solve = || Stack::new(slice.tau, slice.albedo, &slice.moments, self.order, nodes.clone());
        let stack = slice.inside.get_or_init(solve).as_ref().map_err(Clone::clone)?;
        let [top, bottom] = self.direct(region);
        let emission = self.emission(region);
        let (down, up) = stack.field_of(x, top + &self.down[region], bottom + &self.up[region], emission);
        let mut power = self.powers(region, [&down, &up], None).top;
        let rest = slice.tau - x;
        for (i, mu) in nodes.mu.iter().enumerate() {
            let [falling, rising] = [0, 1].map(|which| self.grid.regions[region].direct[which][i]);
            power[0][i] -= falling * exp(-x / mu);
            power[1][i] -= rising * exp(-rest / mu);
        }
        Ok(power)
    }

    /// Fluence, power downwards and upwards of scattered light at depth `x` of layer i.
    pub fn light(&self, i: usize, x: f64) -> Result<[f64; 3]> {
        let Some(region) = self.grid.region(i) else { return Ok(self.grid.light_in_plate(i, x, &self.ends)) };
        let [down, up] = self.field(region, x)?;
        let nodes = &self.grid.regions[region].nodes;
        let fluence = (0..nodes.count).map(|i| (down[i] + up[i]) / nodes.mu[i]).sum();
        Ok([fluence, down[..nodes.count].iter().sum(), up[..nodes.count].iter().sum()])
    }

    /// Scattered radiance in the further direction `user`, downwards and upwards, at depth `x` of layer i.
    pub fn radiance(&self, i: usize, x: f64, user: usize) -> Result<[f64; 2]> {
        let beam = usize::from(matches!(self.grid.problem.incidence, Some(Incidence::Beam { .. })));
        if let Some(region) = self.grid.region(i) {
            let j = self.grid.regions[region].nodes.count + beam + user;
            let root = self.roots[region][j];
            return Ok(self.field(region, x)?.map(|power| power[j] / (2.0 * PI * root * root)));
        }
        Ok(self.grid.radiance_in_plate(i, x, beam + user, &self.ends))
    }
}
