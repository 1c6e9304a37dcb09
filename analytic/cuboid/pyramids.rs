//! Integrals over a box with a corner at a singularity, by pyramids.
//!
//! The box \[0, a\] x \[0, b\] x \[0, c\] is three pyramids whose tip is the corner: in the one about axis p, u_p = s and
//! u_q = s t_q with 0 <= t_q <= a_q/a_p, the Jacobian s^2 removes a singularity 1/d^2 there (Duffy 1982), and what is left is
//! smooth. Products of functions of one coordinate each are summed axis by axis. An endless third axis is left out.

use super::bickley::ki;
use crate::quadrature::GaussLegendre;
use libm::exp;
use std::f64::consts::PI;

/// What is integrated, with the Jacobian of the pyramids.
#[derive(Debug, Clone, Copy)]
pub(super) enum Flight {
    /// e^(-d)/(4 pi d^2), from place to place.
    Collision,
    /// From a face with this normal that sends out radiance 1/pi: u_n e^(-d)/(pi d^3).
    Face(usize),
}

/// Nodes along the axis and across.
#[derive(Debug, Clone, Copy)]
pub(super) struct Orders {
    pub(super) along: usize,
    pub(super) across: usize,
}

impl Flight {
    /// The kernel times the Jacobian, at s and slopes t (1 along the pyramid's axis).
    fn weight(self, endless: bool, s: f64, t: [f64; 3]) -> f64 {
        let slant = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
        match (self, endless) {
            (Flight::Collision, false) => exp(-s * slant) / (4.0 * PI * slant * slant),
            (Flight::Collision, true) => ki(1, s * slant) / (2.0 * PI * slant),
            (Flight::Face(n), false) => t[n] * exp(-s * slant) / (PI * slant * slant * slant),
            (Flight::Face(n), true) => 2.0 * t[n] * ki(2, s * slant) / (PI * slant * slant),
        }
    }
}

/// Nodes and weights from 0 to `end`: one panel to 1, then panels that grow threefold.
fn across(end: f64, rule: &GaussLegendre) -> Vec<(f64, f64)> {
    let (mut low, mut high, mut nodes) = (0.0, end.min(1.0), Vec::new());
    loop {
        let length = high - low;
        nodes.extend(rule.nodes.iter().zip(&rule.weights).map(|(x, w)| (low + length * x, length * w)));
        if high >= end {
            return nodes;
        }
        (low, high) = (high, end.min(3.0 * high));
    }
}

/// The integrals of all products of one function each along the axes, `count` of them, over the box `reach` from a corner.
///
/// `table(axis, u, out)` gives the functions of an axis at the distance u from the corner. The last axis varies fastest.
pub(super) fn integrals(
    flight: Flight,
    reach: [f64; 3],
    endless: bool,
    orders: Orders,
    count: [usize; 3],
    table: &dyn Fn(usize, f64, &mut [f64]),
) -> Vec<f64> {
    let axes = if endless { 2 } else { 3 };
    let mut out = vec![0.0; count[0] * count[1] * count[2]];
    if reach[..axes].contains(&0.0) {
        return out;
    }
    let stride = [count[1] * count[2], count[2], 1];
    let (long, wide) = (GaussLegendre::rule(orders.along), GaussLegendre::rule(orders.across));
    for p in 0..axes {
        let [q, r] = [[1, 2], [0, 2], [0, 1]][p];
        let slopes = |axis: usize| match endless && axis == 2 {
            true => vec![(0.0, 1.0)],
            false => across(reach[axis] / reach[p], &wide),
        };
        let (of_q, of_r) = (slopes(q), slopes(r));
        let mut along = vec![0.0; count[p]];
        let mut at_q = vec![0.0; of_q.len() * count[q]];
        let mut at_r = vec![0.0; of_r.len() * count[r]];
        let (mut row, mut plane) = (vec![0.0; count[r]], vec![0.0; count[q] * count[r]]);
        for (x, w) in long.nodes.iter().zip(&long.weights) {
            // Bickley's functions have s ln s at the tip, which s = x^2 makes smooth to seven orders.
            let (s, ws) = if endless {
                (reach[p] * x * x, 2.0 * reach[p] * x * w)
            } else {
                (reach[p] * x, reach[p] * w)
            };
            let fill = |axis: usize, u: f64, out: &mut [f64]| match endless && axis == 2 {
                true => out.fill(1.0),
                false => table(axis, u, out),
            };
            fill(p, s, &mut along);
            for (&(t, _), out) in of_q.iter().zip(at_q.chunks_exact_mut(count[q])) {
                fill(q, s * t, out);
            }
            for (&(t, _), out) in of_r.iter().zip(at_r.chunks_exact_mut(count[r])) {
                fill(r, s * t, out);
            }
            plane.fill(0.0);
            for (&(tq, wq), of_q) in of_q.iter().zip(at_q.chunks_exact(count[q])) {
                row.fill(0.0);
                for (&(tr, wr), of_r) in of_r.iter().zip(at_r.chunks_exact(count[r])) {
                    let mut t = [1.0; 3];
                    (t[q], t[r]) = (tq, tr);
                    let weight = ws * wq * wr * flight.weight(endless, s, t);
                    row.iter_mut().zip(of_r).for_each(|(sum, f)| *sum += weight * f);
                }
                for (f, plane) in of_q.iter().zip(plane.chunks_exact_mut(count[r])) {
                    plane.iter_mut().zip(&row).for_each(|(sum, g)| *sum += f * g);
                }
            }
            for (i, f) in along.iter().enumerate() {
                for (j, plane) in plane.chunks_exact(count[r]).enumerate() {
                    let at = i * stride[p] + j * stride[q];
                    for (k, g) in plane.iter().enumerate() {
                        out[at + k * stride[r]] += f * g;
                    }
                }
            }
        }
    }
    out
}
