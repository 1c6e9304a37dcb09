//! Depths: panels graded towards both faces, a polynomial on each.

use crate::panels::{Basis, edges};
use crate::quadrature::GaussLegendre;

/// Longest panel: 16 nodes interpolate e^(-t) on it to 2/16! = 1e-13 of its largest value.
const DEEPEST: f64 = 4.0;

/// The slab cut in panels, symmetric about its middle.
pub(super) struct Mesh {
    pub tau: f64,
    /// Edges of the upper half, from 0 to tau/2.
    edges: Vec<f64>,
    /// Nodes and weights on one panel.
    pub rule: GaussLegendre,
    basis: Basis,
    /// Depth of every node, panel after panel from the lit face.
    pub depth: Vec<f64>,
    /// Distance of every node from the far face.
    pub height: Vec<f64>,
    /// Quadrature weights of the nodes.
    pub weight: Vec<f64>,
}

impl Mesh {
    /// `nodes` on each panel; the first panel is `first` of the slab or of a mean free path.
    pub fn new(tau: f64, first: f64, nodes: usize) -> Self {
        let edges = edges(tau, first, DEEPEST);
        let rule = GaussLegendre::rule(nodes);
        let basis = Basis::new(&rule);
        let (mut depth, mut weight) = (Vec::new(), Vec::new());
        for pair in edges.windows(2) {
            let length = pair[1] - pair[0];
            depth.extend(rule.nodes.iter().map(|x| pair[0] + length * x));
            weight.extend(rule.weights.iter().map(|w| length * w));
        }
        let mirrored: Vec<f64> = depth.iter().rev().map(|x| tau - x).collect();
        let height = mirrored.iter().rev().copied().chain(depth.iter().rev().copied()).collect();
        depth.extend(mirrored);
        weight.extend_from_within(..);
        let half = weight.len() / 2;
        weight[half..].reverse();
        Mesh { tau, edges, rule, basis, depth, height, weight }
    }

    /// Nodes on a panel.
    pub fn nodes(&self) -> usize {
        self.rule.nodes.len()
    }

    /// Panels in one half.
    pub fn classes(&self) -> usize {
        self.edges.len() - 1
    }

    /// Panels in the slab.
    pub fn panels(&self) -> usize {
        2 * self.classes()
    }

    /// The panel of the upper half that has the same length.
    pub fn class(&self, panel: usize) -> usize {
        panel.min(self.panels() - 1 - panel)
    }

    /// Length of the panels of a class.
    pub fn length(&self, class: usize) -> f64 {
        self.edges[class + 1] - self.edges[class]
    }

    /// The panel that contains depth t, and where in it, 0 to 1.
    pub fn find(&self, t: f64) -> (usize, f64) {
        let mirrored = t > 0.5 * self.tau;
        let x = if mirrored { self.tau - t } else { t };
        let class = self.edges.partition_point(|&edge| edge <= x).clamp(1, self.classes()) - 1;
        let xi = (x - self.edges[class]) / self.length(class);
        if mirrored { (self.panels() - 1 - class, 1.0 - xi) } else { (class, xi) }
    }

    /// Values of the Lagrange polynomials of a panel at xi.
    pub fn basis(&self, xi: f64) -> Vec<f64> {
        let mut out = vec![0.0; self.nodes()];
        self.basis.at(xi, &mut out);
        out
    }

    /// The polynomial through `values` at all nodes, at depth t.
    pub fn interpolate(&self, values: &[f64], t: f64) -> f64 {
        let (panel, xi) = self.find(t);
        let nodes = &values[panel * self.nodes()..][..self.nodes()];
        self.basis(xi).iter().zip(nodes).map(|(b, v)| b * v).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use libm::{exp, log};

    #[test]
    fn the_slab_is_covered_and_smooth_functions_are_met() {
        for tau in [1e-12, 0.5, 9.0, 300.0] {
            let mesh = Mesh::new(tau, 1e-10, 20);
            let rounding = mesh.weight.len() as f64 * f64::EPSILON;
            assert!((mesh.weight.iter().sum::<f64>() / tau - 1.0).abs() < rounding);
            let f = |x: f64| {
                let x = x / tau.min(1.0);
                if x == 0.0 { 0.0 } else { x * log(x) * exp(-x) }
            };
            let values: Vec<f64> = mesh.depth.iter().zip(&mesh.height).map(|(&t, &h)| f(t) + f(h)).collect();
            for share in [0.0, 1e-11, 1e-7, 0.01, 0.3, 0.5, 0.9, 1.0 - 1e-7, 1.0] {
                let t = share * tau;
                let got = mesh.interpolate(&values, t);
                assert!((got - f(t) - f(tau - t)).abs() < 1e-11, "{tau} {share} {got}");
            }
        }
    }
}
