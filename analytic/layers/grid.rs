//! The directions in which scattered light is followed, and the faces that it meets on its way.
//!
//! At a smooth face n root(1 - mu^2) stays the same. One set of nodes in that number therefore serves all layers: light of
//! a node stays with it, reflected by r and transmitted by 1 - r, and a layer of index n has those nodes that exist in it.
//! Every index in the pile is the horizon of its own layers and the edge of total reflection of the denser ones; between
//! two of them lies a panel of nodes in the cosine of the denser, crowded towards its horizon. In rising order of cosines the nodes of two
//! layers are the same from the end on.
//!
//! Layers that neither scatter nor shine are plates of the piles between the others, which are regions; a ground that is not a
//! mirror is the last region.

use super::pile::{Passed, Pile, cosine};
use super::problem::{Layer, Problem};
use crate::adding_doubling::{Nodes, Panels};
use crate::incidence::Incidence;
use libm::{exp, expm1, sqrt};
use std::f64::consts::PI;
use std::sync::Arc;

/// How fine the directions are to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule {
    /// The fewest nodes of a panel away from its horizon, and those towards it, in the root of this power.
    pub upper: usize,
    pub lower: usize,
    pub power: i32,
    /// Times 1/(`upper` + 2) of a panel of one hemisphere is crowded.
    pub open: f64,
    /// The highest Legendre moment to be followed.
    pub degree: usize,
}

/// A layer that scatters or shines, or the ground.
pub(super) struct Region {
    /// The number of the layer; that of layers is the ground.
    pub layer: usize,
    pub index: f64,
    pub nodes: Nodes,
    /// Power of light that has not been scattered, at every node: downwards on the upper face, upwards on the lower one.
    pub direct: [Vec<f64>; 2],
}

/// What lies between two regions.
pub(super) struct Between {
    pub pile: Pile,
    /// The number of its first plate among the layers.
    first: usize,
    /// Of light of the region above, by node, and of the region below, which sees the pile upside down.
    pub down: Vec<Passed>,
    pub up: Vec<Passed>,
}

/// Power of scattered light at every node of a region: downwards and upwards at either face.
#[derive(Clone)]
pub(super) struct Ends {
    pub top: [Vec<f64>; 2],
    pub bottom: [Vec<f64>; 2],
}

/// The regions on their nodes.
pub(super) struct Grid {
    pub problem: Arc<Problem>,
    pub regions: Vec<Region>,
    /// One more than there are regions, or as many over a ground that is no mirror: before each region, and over a mirror.
    pub between: Vec<Between>,
}

/// The nodes of every index: where they lie in panels, each with an index and a cosine there.
struct Anchored {
    /// From the densest index down.
    panels: Vec<(f64, Nodes, f64)>,
}

impl Anchored {
    fn new(problem: &Problem, rule: Rule) -> Self {
        let Rule { upper: least, lower, power, open, degree } = rule;
        let indices = problem.indices();
        let turns = degree as f64;
        let panels = indices.iter().enumerate().map(|(i, &n)| {
            let top = match i {
                0 => 1.0,
                _ => sqrt((n - indices[i - 1]) * (n + indices[i - 1])) / n,
            };
            let upper = match (i, indices.len()) {
                (0, 1) => least.max(5 + degree / 2),
                // Polynomials in the cosine of another index are none in this one.
                (0, _) => least.max(16 + (0.6 * turns) as usize),
                _ => least.max(16 + (0.6 * top * turns) as usize),
            };
            // Where no light is lost along this horizon, reflectances change beyond it with the cosine, and no logarithm does
            // unless light goes to and fro for long.
            let lossy = |layer: &Layer| layer.tau > 0.0 && (layer.index == n || layer.tau < 0.1);
            let lower = if problem.layers.iter().any(lossy) { lower } else { lower / 2 };
            let edge = top * open / (upper as f64 + 2.0);
            let mut panels = Panels::default();
            panels.power(0.0, edge, power, lower);
            panels.plain(edge, top, upper);
            (n, panels.finish(), top)
        });
        let mut panels: Vec<_> = panels.collect();
        panels.reverse();
        Anchored { panels }
    }

    /// The nodes in a medium of index `n`.
    fn nodes(&self, n: f64) -> Nodes {
        let (mut mu, mut weight) = (Vec::new(), Vec::new());
        for (from, nodes, top) in self.panels.iter().filter(|panel| panel.0 <= n) {
            for (&there, w) in nodes.mu.iter().zip(&nodes.weight) {
                let here = cosine(n, *from, there).unwrap_or(there);
                mu.push(here);
                weight.push(if n == *from {
                    top * w
                } else {
                    top * w * from * from * there / (n * n * here)
                });
            }
        }
        let sum: f64 = weight.iter().sum();
        weight.iter_mut().for_each(|w| *w /= sum);
        let count = mu.len();
        Nodes { mu, weight, count }
    }
}

impl Grid {
    /// # Arguments
    /// `users` further directions, each as an index and a cosine there
    pub fn new(problem: Arc<Problem>, rule: Rule, users: &[(f64, f64)]) -> Self {
        let anchored = Anchored::new(&problem, rule);
        let ground = (!problem.ground.mirror).then_some(problem.layers.len());
        let mut regions: Vec<Region> = Vec::new();
        let mut between = Vec::new();
        let mut first = 0;
        for layer in problem.scattering().into_iter().chain(ground) {
            let index = problem.index(layer);
            let like = regions.iter().find(|region| region.index == index);
            let nodes = match like {
                Some(region) => region.nodes.clone(),
                None => {
                    // A direction that cannot be here has no light: any cosine will do.
                    let here: Vec<f64> =
                        users.iter().map(|&(n, mu)| cosine(index, n, mu).unwrap_or(1.0)).collect();
                    anchored.nodes(index).with(&here)
                }
            };
            between.push(Between::new(&problem, first, layer, regions.last(), Some((index, &nodes)), users));
            regions.push(Region { layer, index, nodes, direct: [Vec::new(), Vec::new()] });
            first = layer + 1;
        }
        if problem.ground.mirror {
            between.push(Between::new(&problem, first, problem.layers.len(), regions.last(), None, users));
        }
        let mut grid = Grid { problem, regions, between };
        grid.enter(users.len());
        grid
    }

    /// Direct light on the nodes: what is Lambertian, and a beam in the first of the further directions.
    fn enter(&mut self, users: usize) {
        let pile = self.problem.pile();
        for region in &mut self.regions {
            let Nodes { mu, weight, count } = &region.nodes;
            let n = region.index;
            for i in 0..mu.len() {
                let (power, passed) = match self.problem.incidence {
                    Some(Incidence::Beam { mu0 }) if i == *count && users > 0 => {
                        (1.0, pile.passed(|m| cosine(m, 1.0, mu0)))
                    }
                    Some(Incidence::Diffuse) if i < *count => {
                        let power = 2.0 * n * n * mu[i] * weight[i];
                        (power, pile.passed(|m| cosine(m, n, mu[i])))
                    }
                    _ => (0.0, Passed { specular: 0.0, reflected: 0.0, arrived: 0.0, within: Vec::new() }),
                };
                let [down, up] = match passed.within.get(region.layer) {
                    Some(&within) => within,
                    None => [passed.arrived, 0.0],
                };
                region.direct[0].push(power * down);
                region.direct[1].push(power * up);
            }
        }
    }

    /// Scattered light that leaves through the lit face, and that arrives at the ground.
    pub fn leaving(&self, ends: &[Ends]) -> [f64; 2] {
        let of = |passed: &[Passed], power: &[f64], f: fn(&Passed) -> f64| -> f64 {
            passed.iter().zip(power).map(|(passed, power)| f(passed) * power).sum()
        };
        let (Some(first), Some(last)) = (ends.first(), ends.last()) else { return [0.0; 2] };
        let up = of(&self.between[0].up, &first.top[1], |passed| passed.arrived);
        let down = match self.between.get(self.regions.len()) {
            Some(over) => of(&over.down, &last.bottom[0], |passed| passed.arrived),
            None => last.top[0].iter().sum(),
        };
        [up, down]
    }

    /// Scattered light in a plate, by direction of a region next to it, which with the number of the direction comes first:
    /// cosine, power downwards on its upper face and upwards on the lower one.
    fn plate(&self, layer: usize, ends: &[Ends]) -> Vec<(&Region, usize, f64, [f64; 2])> {
        let at = self.regions.iter().position(|region| region.layer > layer).unwrap_or(self.regions.len());
        let (between, n) = (&self.between[at], self.problem.index(layer));
        let place = layer - between.first;
        let mut all = Vec::new();
        let mut add = |region: usize, i: usize, light: [f64; 2]| {
            let region = &self.regions[region];
            if let Some(mu) = cosine(n, region.index, region.nodes.mu[i]) {
                all.push((region, i, mu, light));
            }
        };
        if at > 0 {
            for (i, power) in ends[at - 1].bottom[0].iter().enumerate() {
                let [down, up] = between.down[i].within[place];
                add(at - 1, i, [power * down, power * up]);
            }
        }
        if at < self.regions.len() {
            for (i, power) in ends[at].top[1].iter().enumerate() {
                // Upside down.
                let [up, down] = between.up[i].within[between.pile.taus.len() - 1 - place];
                add(at, i, [power * down, power * up]);
            }
        }
        all
    }

    /// Fluence, power downwards and upwards of scattered light at depth x of a plate.
    pub fn light_in_plate(&self, layer: usize, x: f64, ends: &[Ends]) -> [f64; 3] {
        let rest = self.problem.layers[layer].tau - x;
        sum(self.plate(layer, ends).into_iter().map(|(_, _, mu, [down, up])| carried(mu, down, up, x, rest)))
    }

    /// Scattered radiance in a further direction, which is one of the plate, downwards and upwards at depth x of it.
    pub fn radiance_in_plate(&self, layer: usize, x: f64, user: usize, ends: &[Ends]) -> [f64; 2] {
        let (n, rest) = (self.problem.index(layer), self.problem.layers[layer].tau - x);
        let mut sum = [0.0; 2];
        for (region, i, mu, [down, up]) in self.plate(layer, ends) {
            if i == region.nodes.count + user {
                // Radiance over the square of the index stays the same.
                let share = n * n / (region.index * region.index);
                let unit = share / (2.0 * PI * region.nodes.mu[i] * region.nodes.weight[i]);
                sum = [sum[0] + unit * down * exp(-x / mu), sum[1] + unit * up * exp(-rest / mu)];
            }
        }
        sum
    }

    /// Integral over a plate of the fluence of scattered light.
    pub fn dwelt_in_plate(&self, layer: usize, ends: &[Ends]) -> f64 {
        let tau = self.problem.layers[layer].tau;
        self.plate(layer, ends)
            .into_iter()
            .map(|(_, _, mu, [down, up])| (down + up) * -expm1(-tau / mu))
            .sum()
    }

    /// The region that a layer is.
    pub fn region(&self, layer: usize) -> Option<usize> {
        self.regions.iter().position(|region| region.layer == layer)
    }

    /// int e^(-d/mu) dmu by the nodes in a layer; those of a plate are those of a region.
    pub fn transmission(&self, layer: usize, d: f64) -> Option<f64> {
        let region = self.region(layer).map_or(self.regions.first(), |i| self.regions.get(i))?;
        Some(region.nodes.sum(|mu| exp(-d / mu)))
    }
}

impl Between {
    fn new(
        problem: &Problem,
        first: usize,
        end: usize,
        above: Option<&Region>,
        below: Option<(f64, &Nodes)>,
        users: &[(f64, f64)],
    ) -> Self {
        let pile = problem.part(first, end);
        let none = || Passed {
            specular: 0.0,
            reflected: 0.0,
            arrived: 0.0,
            within: vec![[0.0; 2]; pile.taus.len()],
        };
        let each = |pile: &Pile, index: f64, nodes: &Nodes| -> Vec<Passed> {
            let one = |i: usize| match i.checked_sub(nodes.count).map(|user| users[user]) {
                None => pile.passed(|m| cosine(m, index, nodes.mu[i])),
                Some((n, mu)) if cosine(index, n, mu).is_some() => pile.passed(|m| cosine(m, n, mu)),
                Some(_) => none(),
            };
            (0..nodes.len()).map(one).collect()
        };
        let down = above.map_or(Vec::new(), |region| each(&pile, region.index, &region.nodes));
        let up = below.map_or(Vec::new(), |(index, nodes)| each(&pile.reversed(), index, nodes));
        Between { pile, first, down, up }
    }
}

/// Fluence, power downwards and upwards in one direction.
fn carried(mu: f64, down: f64, up: f64, x: f64, rest: f64) -> [f64; 3] {
    let (down, up) = (down * exp(-x / mu), up * exp(-rest / mu));
    [(down + up) / mu, down, up]
}

fn sum(terms: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    terms.fold([0.0; 3], |a, b| std::array::from_fn(|i| a[i] + b[i]))
}
