//! Panels graded towards the face, their nodes, and polynomials on them.

use super::halves::Halves;
use crate::panels::{Basis, edges};
use crate::quadrature::GaussLegendre;

/// Nodes a panel.
pub(crate) const NODES: usize = 20;

/// Longest panel: e^(-t) keeps 12 digits of its own size on it.
const DEEPEST: f64 = 8.0;

/// The upper half of the slab, cut in panels.
pub(crate) struct Mesh {
    pub tau: f64,
    /// Panel edges from 0 to tau/2.
    pub edges: Vec<f64>,
    /// Nodes, panel by panel, and their quadrature weights.
    pub nodes: Vec<f64>,
    pub lengths: Vec<f64>,
    pub rule: GaussLegendre,
    pub basis: Basis,
}

impl Mesh {
    pub(crate) fn new(tau: f64, first: f64) -> Self {
        let edges = edges(tau, first, DEEPEST);
        let rule = GaussLegendre::rule(NODES);
        let basis = Basis::new(&rule);
        let (mut nodes, mut lengths) = (Vec::new(), Vec::new());
        for pair in edges.windows(2) {
            let length = pair[1] - pair[0];
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                nodes.push(pair[0] + length * x);
                lengths.push(length * w);
            }
        }
        Mesh { tau, edges, nodes, lengths, rule, basis }
    }

    pub(crate) fn panels(&self) -> usize {
        self.edges.len() - 1
    }

    /// Start and length of a panel.
    pub(crate) fn panel(&self, p: usize) -> (f64, f64) {
        (self.edges[p], self.edges[p + 1] - self.edges[p])
    }

    /// The panel that contains x, 0 <= x <= tau/2.
    pub(crate) fn find(&self, x: f64) -> usize {
        self.edges.partition_point(|&edge| edge <= x).clamp(1, self.panels()) - 1
    }

    /// Probe i: edges at even i, middles at odd ones.
    pub(crate) fn probe(&self, i: usize) -> f64 {
        if i.is_multiple_of(2) {
            self.edges[i / 2]
        } else {
            0.5 * (self.edges[i / 2] + self.edges[i / 2 + 1])
        }
    }

    /// Values at all nodes of f(t, tau - t), both arguments free of cancellation.
    pub(crate) fn halves(&self, f: impl Fn(f64, f64) -> f64) -> Halves {
        Halves {
            upper: self.nodes.iter().map(|&x| f(x, self.tau - x)).collect(),
            lower: self.nodes.iter().map(|&x| f(self.tau - x, x)).collect(),
        }
    }

    /// int f(t) g(t, tau-t) dt over the slab.
    pub(crate) fn integrate(&self, f: &Halves, g: impl Fn(f64, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for (i, (&x, &w)) in self.nodes.iter().zip(&self.lengths).enumerate() {
            let y = self.tau - x;
            sum += w * (f.upper[i] * g(x, y) + f.lower[i] * g(y, x));
        }
        sum
    }

    /// The polynomial of panel p at xi in \[0, 1\], from values at all nodes of that half.
    pub(crate) fn interpolate(&self, values: &[f64], p: usize, xi: f64) -> f64 {
        let mut at = [0.0; NODES];
        self.basis.at(xi, &mut at);
        at.iter().zip(&values[p * NODES..]).map(|(b, v)| b * v).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panels::{DEEP, GROWTH, LONGEST};

    #[test]
    fn panels_cover_the_half_and_grow_no_faster_than_stated() {
        for tau in [1e-12, 0.5, 2.0, 9.0, 400.0] {
            for first in [1e-8, 1e-15] {
                let mesh = Mesh::new(tau, first);
                assert_eq!(mesh.edges[0], 0.0);
                assert_eq!(mesh.edges[mesh.panels()], 0.5 * tau);
                for p in 1..mesh.panels() {
                    let (start, length) = mesh.panel(p);
                    assert!(length > 0.0 && length <= (GROWTH - 1.0 + 1e-9) * start);
                    assert!(length <= (LONGEST + 1e-9).max(DEEP * start));
                    assert_eq!(mesh.find(start), p);
                }
                let rounding = mesh.lengths.len() as f64 * f64::EPSILON;
                assert!((mesh.lengths.iter().sum::<f64>() / (0.5 * tau) - 1.0).abs() < rounding);
            }
        }
    }

    #[test]
    fn a_polynomial_of_high_degree_is_met() {
        let mesh = Mesh::new(2.0, 1e-8);
        let f = |x: f64| (0..15).fold(1.0, |sum, _| 1.0 - 0.9 * x * sum);
        let values: Vec<f64> = mesh.nodes.iter().map(|&x| f(x)).collect();
        for x in [0.0, 0.1, 0.234, 0.9, 1.0] {
            let p = mesh.find(x);
            let (start, length) = mesh.panel(p);
            let got = mesh.interpolate(&values, p, (x - start) / length);
            assert!((got - f(x)).abs() < 1e-14, "{x}");
        }
    }
}
