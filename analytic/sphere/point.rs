//! The point source in an infinite medium, as exponentials: what the central source is outside its boundary.
//!
//! 4 pi r phi(r) = D e^(-k r) + int_1^inf g(x) e^(-r x) dx, g(x) = 1/\[(1 - (w/x) atanh(1/x))^2 + (pi w/(2x))^2\],
//! D = 2 k^2 (1 - k^2)/(w (k^2 + w - 1)), k the root of w atanh(k)/k = 1 (Case and Zweifel 1967, section 5.2). The
//! 1 in g is the light that has not collided, e^(-r)/r.

use libm::{cosh, exp, expm1, log, log1p, sinh, tanh};
use std::f64::consts::PI;

/// Step in v = ln(x - 1). The integrand is analytic for |Im v| < pi/2 at least, where e^(-r x) still falls: the
/// trapezoidal rule has an error of e^(-pi^2/step) = 7e-18.
const STEP: f64 = 0.25;

/// Ends of v: below, e^v and above, the e^(-v) of (g - 1) e^v are under rounding.
const ENDS: (i32, i32) = (-168, 168);

/// Roundings of one term.
pub(super) const ULPS: f64 = 32.0;

struct Term {
    rate: f64,
    /// Coefficients of all light and of collided light.
    total: f64,
    collided: f64,
}

/// The field of the unit point source, 4 pi r phi, as a sum of exponentials.
pub(super) struct PointSource {
    /// The asymptotic mode first.
    terms: Vec<Term>,
}

impl PointSource {
    pub(super) fn new(albedo: f64) -> Self {
        let mut terms = Vec::new();
        if albedo == 0.0 {
            return PointSource { terms };
        }
        let (k, discrete) = discrete(albedo);
        terms.push(Term { rate: k, total: discrete, collided: discrete });
        for (x, weight, a, b) in nodes() {
            let (p, q) = (1.0 - albedo * a, albedo * b);
            let g = 1.0 / (p * p + q * q);
            let collided = (2.0 * albedo * a - albedo * albedo * (a * a + b * b)) * g;
            terms.push(Term { rate: x, total: weight * g, collided: weight * collided });
        }
        PointSource { terms }
    }

    /// Light scattered n times, n >= 1.
    pub(super) fn of_order(albedo: f64, n: u32) -> Self {
        let term = |(x, weight, a, b): (f64, f64, f64, f64)| {
            // (a + ib)^(n+1) by steps; its imaginary part over b.
            let (mut re, mut im) = (a, 1.0);
            for _ in 0..n {
                (re, im) = (albedo * (re * a - im * b * b), albedo * (re + im * a));
            }
            Term { rate: x, total: weight * im, collided: weight * im }
        };
        PointSource { terms: nodes().map(term).collect() }
    }

    /// r phi(r) of collided light, and a bound on its error.
    pub(super) fn collided(&self, r: f64) -> (f64, f64) {
        sum(&self.terms, r)
    }

    /// The same in a sphere that is large: the asymptotic mode D e^(-k r) with what the surface takes from it,
    /// D sinh(k (a-r))/sinh(k a), which does not cancel there.
    pub(super) fn collided_within(&self, a: f64, r: f64) -> (f64, f64) {
        let Some((first, rest)) = self.slow() else { return self.collided(r) };
        let (others, error) = sum(rest, r);
        let k = first.rate;
        let shape = if k == 0.0 {
            (a - r) / a
        } else {
            exp(-k * r) * expm1(-2.0 * k * (a - r)) / expm1(-2.0 * k * a)
        };
        let mode = first.collided * shape / (4.0 * PI);
        (mode + others, error + (ULPS + (k * r).min(745.0)) * f64::EPSILON * mode)
    }

    /// The asymptotic mode and the rest, where it falls so slowly that the surface takes nearly all of it; a fast one
    /// is nearly resonant with the steepest directions and better left alone.
    fn slow(&self) -> Option<(&Term, &[Term])> {
        self.terms.split_first().filter(|(first, _)| first.rate < 0.5)
    }

    /// What must come in through the face of the odd slab, beside [`Self::collided_within`] and the direct light, for
    /// nothing to come in at all.
    pub(super) fn owed(&self, albedo: f64, a: f64, mu: f64) -> f64 {
        let Some((first, rest)) = self.slow() else { return -self.incoming(albedo, a, mu) };
        let k = first.rate;
        // k/sinh(k a).
        let slope = if k == 0.0 { 1.0 / a } else { -2.0 * k * exp(-k * a) / expm1(-2.0 * k * a) };
        let mode = first.total * slope * mu / ((1.0 - k * mu) * (1.0 + k * mu));
        albedo / (8.0 * PI) * (mode - reach(rest, a, mu))
    }
    /// w/2 int_0^inf r phi(r) e^(-y/mu) dy/mu over y = r - a: what the odd slab's outside sends back in through its face.
    pub(super) fn incoming(&self, albedo: f64, a: f64, mu: f64) -> f64 {
        albedo / (8.0 * PI) * reach(&self.terms, a, mu)
    }

    /// r phi(r) of all light: e^(-r)/(4 pi r) and what has collided.
    pub(super) fn total(&self, r: f64) -> f64 {
        exp(-r) / (4.0 * PI * r) + self.collided(r).0
    }
}

/// x, the trapezoidal weight dx, A = atanh(1/x)/x and B = pi/(2x).
fn nodes() -> impl Iterator<Item = (f64, f64, f64, f64)> {
    (ENDS.0..=ENDS.1).map(|i| {
        let v = f64::from(i) * STEP;
        let e = exp(v);
        let x = 1.0 + e;
        let a = 0.5 * (if v > 0.0 { log1p(2.0 / e) } else { log(2.0 + e) - v }) / x;
        (x, STEP * e, a, 0.5 * PI / x)
    })
}

/// The sum of collided light over 4 pi, and a bound on its error.
fn sum(terms: &[Term], r: f64) -> (f64, f64) {
    let (mut sum, mut absolute) = (0.0, 0.0);
    for term in terms {
        let path = term.rate * r;
        if path < 745.0 {
            let value = term.collided * exp(-path);
            sum += value;
            absolute += value.abs() * (ULPS + path);
        }
    }
    (sum / (4.0 * PI), absolute * f64::EPSILON / (4.0 * PI))
}

/// sum of coefficients e^(-rate a)/(1 + rate mu).
fn reach(terms: &[Term], a: f64, mu: f64) -> f64 {
    let near = terms.iter().filter(|term| term.rate * a < 745.0);
    near.map(|term| term.total * exp(-term.rate * a) / (1.0 + term.rate * mu)).sum()
}

/// Rate k and coefficient D of the asymptotic mode, k = tanh t with t coth t = 1/w.
fn discrete(albedo: f64) -> (f64, f64) {
    let excess = (1.0 - albedo) / albedo;
    if excess == 0.0 {
        return (0.0, 3.0);
    }
    // t coth t - 1 rises, is convex, and at t = 1/w at least as large as wanted: Newton's steps only fall.
    let mut t = 1.0 / albedo;
    for _ in 0..200 {
        let (value, slope) = coth_excess(t);
        let step = (value - excess) / slope;
        t -= step;
        if step.abs() <= 2.0 * f64::EPSILON * t {
            break;
        }
    }
    let k = tanh(t);
    let cosh = if t < 350.0 { cosh(t) } else { f64::INFINITY };
    let complement = 1.0 / (cosh * cosh);
    // k^2 + w - 1 = k^2 - (1 - w), at least two thirds of k^2.
    (k, 2.0 * k * k * complement / (albedo * (k * k - (1.0 - albedo))))
}

/// t coth t - 1 and its slope.
fn coth_excess(t: f64) -> (f64, f64) {
    if t < 0.5 {
        // (t cosh t - sinh t)/sinh t = sum 2n t^(2n+1)/(2n+1)! over sinh t, and the slope of it.
        let y = t * t;
        let (mut term, mut top, mut n) = (t, 0.0, 0.0);
        while n < 9.0 {
            n += 1.0;
            term *= y / ((2.0 * n) * (2.0 * n + 1.0));
            top += 2.0 * n * term;
        }
        let s = sinh(t);
        let value = top / s;
        // d/dt (t coth t) = coth t - t/sinh^2 t = (cosh t sinh t - t)/sinh^2 t, and sinh(2t)/2 - t by its series.
        let (mut term, mut top, mut n) = (t, 0.0, 0.0);
        while n < 12.0 {
            n += 1.0;
            term *= 4.0 * y / ((2.0 * n) * (2.0 * n + 1.0));
            top += term;
        }
        return (value, top / (s * s));
    }
    // 1 - e^(-2t) = d: coth t = (2 - d)/d, 1/sinh^2 t = 4 (1 - d)/d^2.
    let d = -expm1(-2.0 * t);
    let coth = (2.0 - d) / d;
    (t * coth - 1.0, coth - t * 4.0 * (1.0 - d) / (d * d))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r phi_1(r) -> w pi/16 at the source and all later orders vanish there.
    #[test]
    fn collided_light_at_the_source() {
        for albedo in [1e-6, 1e-3, 0.03, 0.06, 0.2, 0.5, 0.9, 0.999, 0.999_999_9, 1.0] {
            let (u, error) = PointSource::new(albedo).collided(0.0);
            let known = albedo * PI / 16.0;
            assert!((u - known).abs() < 4.0 * error + 1e-15, "{albedo}: {u} {known} {error:e}");
            assert!((u / known - 1.0).abs() < 1e-12, "{albedo}: {u} {known}");
        }
    }

    /// int phi dV = 1/(1-w): 1 without collision, w/(1-w) collided; int r u e^(-x r) = 1/x^2.
    #[test]
    fn collided_light_adds_up() {
        for albedo in [1e-3, 0.05, 0.3, 0.9, 0.999] {
            let sum: f64 =
                PointSource::new(albedo).terms.iter().map(|t| t.collided / (t.rate * t.rate)).sum();
            let known = albedo / (1.0 - albedo);
            assert!((sum / known - 1.0).abs() < 1e-11, "{albedo}: {sum} {known}");
        }
    }
}
