//! Panels graded towards both faces of a layer, and the polynomials on one of them.

use crate::quadrature::GaussLegendre;
use libm::{exp, log};

/// Panels grow by at most this factor from the face inwards: a function that is singular at the face is interpolated
/// on 20 nodes to 4.3^-20 = 2e-13 of its high harmonics, t ln t to 1e-16 of its size on the panel.
pub(crate) const GROWTH: f64 = 2.6;

/// Longest panel near the face: e^(-t) is interpolated on it to 1e-24, and e^(-t/mu0) to 1e-12 for mu0 = 0.1.
pub(crate) const LONGEST: f64 = 2.0;

/// Deeper, panels may be this part of their depth d: what varies there is e^(-k d) at most, and
/// e^(-k d) (0.4 k d)^20/(20! 2^39) is below 1e-20 for every k.
pub(crate) const DEEP: f64 = 0.4;

/// Edges of the panels from 0 to tau/2: the first `first` long, in units of tau/2 or of a mean free path if that is
/// less, none longer than `deepest`.
pub(crate) fn edges(tau: f64, first: f64, deepest: f64) -> Vec<f64> {
    let half = 0.5 * tau;
    // Geometric up to where a panel would be longer than LONGEST, then as long as the depth allows.
    let knee = half.min(LONGEST * GROWTH / (GROWTH - 1.0));
    let count = (log(knee / (first * half.min(1.0))) / log(GROWTH)).ceil().max(1.0);
    let ratio = exp(log(knee / (first * half.min(1.0))) / count);
    let mut edges = vec![knee];
    for _ in 0..count as usize {
        edges.push(edges[edges.len() - 1] / ratio);
    }
    edges.push(0.0);
    edges.reverse();
    let mut deep = vec![0.0];
    while knee + deep[deep.len() - 1] < half {
        let last = deep[deep.len() - 1];
        deep.push(last + LONGEST.max(DEEP * (knee + last)).min(deepest));
    }
    let reach = deep[deep.len() - 1];
    for (i, &offset) in deep.iter().enumerate().skip(1) {
        edges.push(if i + 1 == deep.len() { half } else { knee + offset * ((half - knee) / reach) });
    }
    edges
}

/// Lagrange polynomials on the nodes of a Gauss rule, in barycentric form.
pub(crate) struct Basis {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Basis {
    pub(crate) fn new(rule: &GaussLegendre) -> Self {
        Basis { nodes: rule.nodes.clone(), weights: rule.barycentric() }
    }

    /// Values of all of them at xi in \[0, 1\].
    pub(crate) fn at(&self, xi: f64, out: &mut [f64]) {
        let mut sum = 0.0;
        for (j, (node, weight)) in self.nodes.iter().zip(&self.weights).enumerate() {
            let d = xi - node;
            if d == 0.0 {
                out.fill(0.0);
                out[j] = 1.0;
                return;
            }
            out[j] = weight / d;
            sum += out[j];
        }
        let scale = 1.0 / sum;
        out.iter_mut().for_each(|value| *value *= scale);
    }
}
