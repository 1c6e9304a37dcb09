//! Parts of the unit sphere that one, two or three perpendicular planes cut off, and their moments.
//!
//! Directions w = (x, y, z); every part is given by thresholds of at least 0. Areas are those of Gauss and Bonnet
//! (2 pi less the turning along the arcs and at the corners); the first moment along x is the area of the part's
//! projection on the yz plane; the second follows by parts from int x^2 acos(b/sqrt(1-x^2)) dx.

use crate::estimators::kernel::UNIT_BALL;
use libm::{acos, asin, atan2};
use std::f64::consts::{FRAC_PI_2, PI};

/// int w_x^j dw for j = 0, 1, 2 \[sr\].
pub(super) type Along = [f64; 3];

/// The whole sphere.
pub(super) const SPHERE: Along = [3.0 * UNIT_BALL, 0.0, UNIT_BALL];

/// acos of a ratio that rounding may put beyond 1.
fn angle(cos: f64) -> f64 {
    acos(cos.min(1.0))
}

fn root(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

/// The cap x > a.
pub(super) fn cap(a: f64) -> Along {
    if a >= 1.0 {
        return [0.0; 3];
    }
    [2.0 * PI * (1.0 - a), PI * (1.0 - a) * (1.0 + a), 2.0 / 3.0 * PI * (1.0 - a * a * a)]
}

/// The part x > a, y > b.
pub(super) fn pair(a: f64, b: f64) -> Along {
    if a * a + b * b >= 1.0 {
        return [0.0; 3];
    }
    let (across_a, across_b) = (root(1.0 - a * a), root(1.0 - b * b));
    let (arc_a, arc_b) = (angle(b / across_a), angle(a / across_b));
    let area = 2.0 * (corner(a, b) - a * arc_a - b * arc_b);
    let first = across_a * across_a * arc_a - b * root(1.0 - a * a - b * b);
    [area, first, 2.0 * (primitive(b, across_b, 0.0) - primitive(b, a, root(1.0 - a * a - b * b)))]
}

/// The part x > a, y > b, z > c.
pub(super) fn triple(a: f64, b: f64, c: f64) -> Along {
    let rest = 1.0 - a * a - b * b - c * c;
    if rest <= 0.0 {
        return [0.0; 3];
    }
    // Half the length of the arc that the planes of y and z leave on the circle x = a, over its radius.
    let arc = |a: f64, b: f64, c: f64| {
        let across = root(1.0 - a * a);
        angle(b / across) + angle(c / across) - FRAC_PI_2
    };
    let corners = corner(a, b) + corner(b, c) + corner(c, a);
    let area = corners - PI - a * arc(a, b, c) - b * arc(b, c, a) - c * arc(c, a, b);
    let (side_b, side_c) = (root(1.0 - a * a - b * b), root(1.0 - a * a - c * c));
    let sector = (1.0 - a * a) * arc(a, b, c);
    let first = 0.5 * (sector - b * (side_b - c) - c * (side_c - b));
    let top = root(1.0 - b * b - c * c);
    let wedge_b = primitive(b, top, c) - primitive(b, a, side_b);
    let wedge_c = primitive(c, top, b) - primitive(c, a, side_c);
    let second = wedge_b + wedge_c - FRAC_PI_2 / 3.0 * (top * top * top - a * a * a);
    [area, first, second]
}

/// The angle inside the part where the circles x = a and y = b cross.
fn corner(a: f64, b: f64) -> f64 {
    FRAC_PI_2 - atan2(a * b, root(1.0 - a * a - b * b))
}

/// Primitive in x of x^2 acos(b/sqrt(1-x^2)); `rest` is sqrt(1 - b^2 - x^2).
fn primitive(b: f64, x: f64, rest: f64) -> f64 {
    let limit2 = 1.0 - b * b;
    let inner = b * (1.0 + 0.5 * limit2);
    if rest == 0.0 {
        return FRAC_PI_2 * (1.0 - inner) / 3.0;
    }
    let turned = asin((x / root(limit2)).min(1.0));
    let whole = x * x * x * atan2(rest, b);
    (whole + atan2(b * x, rest) - inner * turned + 0.5 * b * x * rest) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same moments by slices of constant x, 40,000 of them.
    fn by_slices(a: f64, length: impl Fn(f64) -> f64) -> Along {
        let steps = 40_000;
        let mut sums = [0.0; 3];
        for i in 0..steps {
            let x = a + (1.0 - a) * (f64::from(i) + 0.5) / f64::from(steps);
            let slice = length(x) * (1.0 - a) / f64::from(steps);
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum += slice * [1.0, x, x * x][j];
            }
        }
        sums
    }

    #[test]
    fn parts_by_slices() {
        let turn = |b: f64, x: f64| angle(b / root(1.0 - x * x));
        for (a, b, c) in
            [(0.0, 0.0, 0.0), (0.3, 0.2, 0.1), (0.0, 0.7, 0.4), (0.6, 0.0, 0.5), (0.55, 0.55, 0.6)]
        {
            let cases = [
                ("cap", cap(a), by_slices(a, |_| 2.0 * PI)),
                ("pair", pair(a, b), by_slices(a, |x| 2.0 * turn(b, x))),
                ("triple", triple(a, b, c), by_slices(a, |x| (turn(b, x) + turn(c, x) - FRAC_PI_2).max(0.0))),
            ];
            for (name, exact, sliced) in cases {
                for j in 0..3 {
                    // The midpoint rule errs by h^1.5 at the root where the slices end: 4e-7 here, with its factor.
                    let off = exact[j] - sliced[j];
                    assert!(off.abs() < 4e-6, "{name} {a} {b} {c}, moment {j}: {} {}", exact[j], sliced[j]);
                }
            }
        }
    }

    #[test]
    fn halves_quarters_and_octants() {
        let close = |part: Along, share: f64, first: f64| {
            let off = [part[0] - 4.0 * PI * share, part[1] - first, part[2] - 4.0 / 3.0 * PI * share];
            off.iter().all(|x| x.abs() < 1e-15 * 16.0)
        };
        // The projection of a half is a disc, of a quarter half of one, of an octant a quarter.
        assert!(close(cap(0.0), 0.5, PI));
        assert!(close(pair(0.0, 0.0), 0.25, 0.5 * PI));
        assert!(close(triple(0.0, 0.0, 0.0), 0.125, 0.25 * PI));
        assert!([pair(0.8, 0.6), triple(0.8, 0.5, 0.5), cap(1.5)].iter().flatten().all(|x| *x == 0.0));
    }

    /// Parts at x > a, y > b are the same seen from y; and squares of the three components add up to 1.
    #[test]
    fn symmetry_and_the_sum_of_squares() {
        for (a, b, c) in [(0.3, 0.2, 0.1), (0.05, 0.7, 0.4), (0.6, 0.01, 0.5)] {
            let sum = triple(a, b, c)[2] + triple(b, c, a)[2] + triple(c, a, b)[2];
            assert!((sum - triple(a, b, c)[0]).abs() < 1e-14, "{a} {b} {c}: {sum}");
            assert!((pair(a, b)[0] - pair(b, a)[0]).abs() < 1e-14);
            // Of a pair, the halves on either side of z = 0 are triples.
            for j in 0..3 {
                assert!((pair(a, b)[j] - 2.0 * triple(a, b, 0.0)[j]).abs() < 1e-14);
            }
        }
    }
}
