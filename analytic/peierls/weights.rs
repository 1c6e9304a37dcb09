//! Weights of the logarithmically singular kernel E_1 on one panel, seen from any point.

use super::fast::e1;
use super::halves::Row;
use super::mesh::{Mesh, NODES};
use crate::quadrature::GaussLegendre;

/// Substitution z = L s^5 on up to one mean free path about the point: s^4 ln s leaves an n-point Gauss rule an
/// error of n^-10, and 52 nodes are exact for the polynomial part, of degree 99.
const POWER_NODES: usize = 52;

/// Gauss nodes on each doubling \[d, 2d\] of the distance: the logarithm's series falls by 5.8 a degree, and the
/// polynomials take 19 of the 47 degrees.
const DOUBLING_NODES: usize = 24;

pub(crate) struct Weights {
    power: GaussLegendre,
    doubling: GaussLegendre,
}

impl Weights {
    pub(crate) fn new() -> Self {
        Weights { power: GaussLegendre::rule(POWER_NODES), doubling: GaussLegendre::rule(DOUBLING_NODES) }
    }

    /// int E_1(|x-t'|) f(t') dt' as weights of f's values, for the point at distance x from a face.
    pub(crate) fn row(&self, mesh: &Mesh, x: f64) -> Row {
        let mut row = Row { same: vec![0.0; mesh.nodes.len()], other: vec![0.0; mesh.nodes.len()] };
        for p in 0..mesh.panels() {
            let range = p * NODES..(p + 1) * NODES;
            self.panel(mesh, p, x, &mut row.same[range.clone()]);
            self.panel(mesh, p, mesh.tau - x, &mut row.other[range]);
        }
        row
    }

    /// Adds int E_1(|c-y|) l_j(y) dy over panel p, for a point at coordinate c anywhere.
    fn panel(&self, mesh: &Mesh, p: usize, c: f64, out: &mut [f64]) {
        let (start, length) = mesh.panel(p);
        let end = mesh.edges[p + 1];
        let distance = (start - c).max(c - end);
        if distance >= length {
            for (j, w) in out.iter_mut().enumerate() {
                let node = p * NODES + j;
                *w += mesh.lengths[node] * e1((mesh.nodes[node] - c).abs());
            }
        } else if distance > 0.0 {
            let sign = if c < start { 1.0 } else { -1.0 };
            self.doublings(mesh, p, c, sign, distance, distance + length, out);
        } else {
            let xi = (c - start) / length;
            for (sign, reach) in [(-1.0, c - start), (1.0, end - c)] {
                let close = reach.min(1.0);
                if reach > 0.0 {
                    for (s, w) in self.power.nodes.iter().zip(&self.power.weights) {
                        let s4 = s * s * s * s;
                        let z = close * s4 * s;
                        add(mesh, xi + sign * z / length, 5.0 * w * close * s4 * e1(z), out);
                    }
                }
                self.doublings(mesh, p, c, sign, close, reach, out);
            }
        }
    }

    /// Adds the part of panel p at distances from `near` to `far` on one side of c.
    #[expect(clippy::too_many_arguments, reason = "one panel, one point, one range of distances")]
    fn doublings(&self, mesh: &Mesh, p: usize, c: f64, sign: f64, near: f64, far: f64, out: &mut [f64]) {
        let (start, length) = mesh.panel(p);
        let xi = (c - start) / length;
        let mut near = near;
        while near < far {
            // No sliver at the end: the last piece may reach 2.5 times its start.
            let next = if 2.5 * near >= far { far } else { 2.0 * near };
            for (x, w) in self.doubling.nodes.iter().zip(&self.doubling.weights) {
                let z = near + (next - near) * x;
                add(mesh, xi + sign * z / length, w * (next - near) * e1(z), out);
            }
            near = next;
        }
    }
}

fn add(mesh: &Mesh, xi: f64, weight: f64, out: &mut [f64]) {
    let mut at = [0.0; NODES];
    mesh.basis.at(xi, &mut at);
    for (w, b) in out.iter_mut().zip(&at) {
        *w += weight * b;
    }
}
