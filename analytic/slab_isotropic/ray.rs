//! int f e^(-z/m) dz/m along a ray through the panels.

use crate::peierls::{Halves, Mesh, NODES};
use libm::exp;

/// Longest piece of a ray in units of |mu|: on it e^(-v) times a polynomial is integrated to rounding.
const PIECE: f64 = 4.0;

/// Beyond this e^(-v) is zero.
const REACH: f64 = 750.0;

/// The integral of `f` and of the largest `bound` of each panel, for the ray arriving at depth t with cosine mu.
pub(super) fn integrate(mesh: &Mesh, t: f64, mu: f64, f: &Halves, bound: &Halves) -> (f64, f64) {
    let (mut value, mut error) = (0.0, 0.0);
    let upwards = mu > 0.0;
    let m = mu.abs();
    for (values, bounds, centre, outwards) in
        [(&f.upper, &bound.upper, t, upwards), (&f.lower, &bound.lower, mesh.tau - t, !upwards)]
    {
        for p in 0..mesh.panels() {
            let (start, length) = mesh.panel(p);
            let end = mesh.edges[p + 1];
            // The part of the panel on the side that the light comes from, as distances from the point.
            let (near, far, sign) = if outwards {
                ((start - centre).max(0.0), end - centre, 1.0)
            } else {
                ((centre - end).max(0.0), centre - start, -1.0)
            };
            if far <= near || near / m > REACH {
                continue;
            }
            let largest = bounds[p * NODES..(p + 1) * NODES].iter().fold(0.0, |a: f64, &b| a.max(b));
            let pieces = ((far - near) / m / PIECE).ceil().clamp(1.0, REACH / PIECE);
            let step = ((far - near) / m / pieces).min(PIECE);
            let mut i = 0.0;
            while i < pieces {
                for (x, w) in mesh.rule.nodes.iter().zip(&mesh.rule.weights) {
                    let v = near / m + (i + x) * step;
                    let weight = w * step * exp(-v);
                    let xi = (centre - start) / length + sign * (near + (i + x) * step * m) / length;
                    value += weight * mesh.interpolate(values, p, xi);
                    error += weight * largest;
                }
                i += 1.0;
            }
        }
    }
    (value, error)
}
