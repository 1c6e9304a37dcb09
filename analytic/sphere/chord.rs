//! Light along a chord of the sphere, gathered where it leaves.

use super::operator::{Field, ShellOperator};
use crate::quadrature::GaussLegendre;
use libm::{asinh, cosh, exp, expm1, sinh};
use std::sync::LazyLock;

/// Longest piece of a chord: on it e^(-s) times a polynomial of degree 38 is integrated to rounding.
const PIECE: f64 = 4.0;

/// Beyond this e^(-s) is zero.
const REACH: f64 = 745.0;

/// Gauss nodes a piece. A panel's polynomial in depth has twice its degree along the chord.
static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::rule(32));

/// Below this cosine a chord stays within 1e-20 of the radius from the surface: the field is that of the surface, to
/// 50 times that (x ln x).
const GRAZING: f64 = 1e-10;

/// A chord that stays within this many panels of the surface sees the logarithm that the polynomials miss there.
const SHALLOW: usize = 4;

/// int_0^(2 a mu) f(r(s)) e^(-s) ds of a field and of its bound, for the chord that leaves with cosine mu > 0.
/// `exact` gives f and its bound at a radius and depth without the polynomials, for grazing chords.
pub(super) fn gather(
    operator: &ShellOperator,
    field: &Field,
    mu: f64,
    exact: &dyn Fn(f64, f64) -> (f64, f64),
) -> (f64, f64) {
    let a = operator.radius;
    if mu < GRAZING {
        return graze(a, mu, exact(a, 0.0));
    }
    let half = a * mu;
    let closest = a * ((1.0 - mu) * (1.0 + mu)).sqrt();
    let deepest = half * half / (a + closest);
    // Distance y from the end of the chord at depth x: half - sqrt(half^2 - x (2a - x)), without cancellation.
    let distance = |x: f64| {
        let below = x * (2.0 * a - x);
        below / (half + (half * half - below).max(0.0).sqrt())
    };
    let (mut value, mut error) = (0.0, 0.0);
    let shallow = deepest < operator.mesh.edges[SHALLOW.min(operator.mesh.panels())];
    for p in 0..operator.mesh.panels() {
        let (start, length) = operator.mesh.panel(p);
        if start >= deepest {
            break;
        }
        let near = distance(start);
        let far = if start + length >= deepest { half } else { distance(start + length) };
        if near > REACH || far <= near {
            continue;
        }
        let pieces = ((far - near) / PIECE).ceil().clamp(1.0, REACH / PIECE);
        let step = ((far - near) / pieces).min(PIECE);
        let largest = field.bound.rows(p * crate::peierls::NODES, crate::peierls::NODES).amax();
        let mut i = 0.0;
        while i < pieces {
            for (x, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let y = near + (i + x) * step;
                let along = half - y;
                let r = (closest * closest + along * along).sqrt();
                let depth = y * (half + along) / (a + r);
                // Both halves of the chord at once.
                let weight = w * step * exp(-y) * (1.0 + exp(-2.0 * along));
                let (f, bound) = if shallow {
                    exact(r, depth)
                } else {
                    let xi = ((depth - start) / length).clamp(0.0, 1.0);
                    (operator.mesh.interpolate(field.values.as_slice(), p, xi), largest)
                };
                value += weight * f;
                error += weight * bound;
            }
            i += 1.0;
        }
    }
    (value, error)
}

/// The surface's field along a chord that does not leave it.
fn graze(a: f64, mu: f64, (value, error): (f64, f64)) -> (f64, f64) {
    let seen = -expm1(-2.0 * a * mu);
    (value * seen, error * seen)
}

/// The same of a point source's field, given r phi(r) of its collided light, the direct light included; mu < 1.
///
/// With l = b sinh v along the chord, b its distance from the centre, phi dl = (r phi) dv.
pub(super) fn gather_point(radius: f64, mu: f64, collided: &dyn Fn(f64) -> (f64, f64)) -> (f64, f64) {
    let half = radius * mu;
    let closest = radius * ((1.0 - mu) * (1.0 + mu)).sqrt();
    let mut high = asinh(half / closest);
    let (mut value, mut error) = (0.0, 0.0);
    while high > 0.0 {
        // At most one in v, PIECE along the chord.
        let low = (high - 1.0).max(asinh((closest * sinh(high) - PIECE) / closest)).max(0.0);
        if half - closest * sinh(high) > REACH {
            break;
        }
        for (x, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let v = low + (high - low) * x;
            let (along, r) = (closest * sinh(v), closest * cosh(v));
            let left = half - along;
            let weight = w * (high - low) * exp(-left) * (1.0 + exp(-2.0 * along));
            let (collided, bound) = collided(r.min(radius));
            let direct = exp(-r) / (4.0 * std::f64::consts::PI * r);
            value += weight * (direct + collided);
            // Distances lose a few roundings of the radius.
            error += weight * (bound + (32.0 + 4.0 * radius) * f64::EPSILON * (direct + collided));
        }
        if low >= high {
            break;
        }
        high = low;
    }
    (value, error)
}

/// The integral of a field given point by point, graded towards the surface and seen to the depth `seen` along the
/// chord.
pub(super) fn gather_skin(a: f64, mu: f64, seen: f64, field: &dyn Fn(f64) -> (f64, f64)) -> (f64, f64) {
    const GROWTH: f64 = 3.0;
    const STEP: f64 = 2.0;
    if mu < GRAZING {
        return graze(a, mu, field(a));
    }
    let half = a * mu;
    let closest = a * ((1.0 - mu) * (1.0 + mu)).sqrt();
    let end = half.min(seen);
    let (mut value, mut error) = (0.0, 0.0);
    // On the first panel f = c + y ln y is met to 1e-3 of its length.
    let mut near = 0.0;
    let mut far = end * 1e-8;
    while near < end {
        for (x, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let y = near + (far - near) * x;
            let along = half - y;
            let r = (closest * closest + along * along).sqrt().min(a);
            let weight = w * (far - near) * exp(-y) * (1.0 + exp(-2.0 * along));
            let (f, bound) = field(r);
            value += weight * f;
            error += weight * bound;
        }
        near = far;
        far = (GROWTH * near).min(near + STEP).min(end);
    }
    (value, error)
}
