//! Gauss rules on pieces whose ends may be singular: x = 3 tau^2 - 2 tau^3, and Gauss nodes in tau.
//!
//! The square roots with which a sphere leaves an edge become smooth in tau, and t ln t becomes tau^3 ln tau.
//! Everything is done at rising orders until two of them agree; their difference is the bound.

use crate::error::Result;
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{asin, sin};
use std::sync::LazyLock;

/// Orders that are tried one after the other.
const ORDERS: [usize; 4] = [12, 20, 32, 48];

/// Relative agreement of two orders at which the higher one is taken.
const AGREEMENT: f64 = 1e-10;

/// Roundings of sums of some ten thousand terms, most of them of one sign.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

static RULES: LazyLock<[Rule; ORDERS.len()]> = LazyLock::new(|| ORDERS.map(Rule::new));

/// One rule, on \[0, 1\].
pub(super) struct Rule {
    gauss: GaussLegendre,
    places: Vec<f64>,
    weights: Vec<f64>,
    barycentric: Vec<f64>,
}

impl Rule {
    fn new(order: usize) -> Self {
        let gauss = GaussLegendre::rule(order);
        let places = gauss.nodes.iter().map(|&tau| place(tau)).collect();
        let weights = gauss.nodes.iter().zip(&gauss.weights).map(|(&tau, w)| w * slope(tau)).collect();
        let barycentric = gauss.barycentric();
        Rule { gauss, places, weights, barycentric }
    }

    /// The rule of lowest order, for questions that need few digits.
    pub(super) fn coarse() -> &'static Rule {
        &RULES[0]
    }

    /// Number of nodes.
    pub(super) fn order(&self) -> usize {
        self.places.len()
    }

    /// Nodes and weights on \[a, b\].
    pub(super) fn on(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
        self.places.iter().zip(&self.weights).map(move |(x, w)| (a + (b - a) * x, (b - a) * w))
    }

    /// int_a^b f.
    pub(super) fn integrate(&self, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        self.on(a, b).map(|(x, w)| w * f(x)).sum()
    }

    /// int f over consecutive pieces between `ends`, which rise.
    pub(super) fn integrate_pieces(&self, ends: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        ends.windows(2).map(|pair| self.integrate(pair[0], pair[1], &f)).sum()
    }

    /// Nodes and weights on the part \[a, x\] of the piece \[a, b\], with the tau of each on the whole piece.
    pub(super) fn on_part(&self, a: f64, b: f64, x: f64) -> impl Iterator<Item = (f64, f64, f64)> {
        let end = tau_of((x - a) / (b - a));
        self.gauss.nodes.iter().zip(&self.gauss.weights).map(move |(node, w)| {
            let tau = end * node;
            (tau, a + (b - a) * place(tau), (b - a) * w * end * slope(tau))
        })
    }

    /// The polynomial in tau through values at the nodes.
    pub(super) fn interpolate<const N: usize>(&self, values: &[[f64; N]], tau: f64) -> [f64; N] {
        let (mut above, mut below) = ([0.0; N], 0.0);
        for (i, value) in values.iter().enumerate() {
            let distance = tau - self.gauss.nodes[i];
            if distance == 0.0 {
                return *value;
            }
            let weight = self.barycentric[i] / distance;
            for (sum, v) in above.iter_mut().zip(value) {
                *sum += weight * v;
            }
            below += weight;
        }
        above.map(|sum| sum / below)
    }
}

fn place(tau: f64) -> f64 {
    tau * tau * (3.0 - 2.0 * tau)
}

fn slope(tau: f64) -> f64 {
    6.0 * tau * (1.0 - tau)
}

/// The inverse of `place`.
pub(super) fn tau_of(x: f64) -> f64 {
    (0.5 - sin(asin((1.0 - 2.0 * x).clamp(-1.0, 1.0)) / 3.0)).clamp(0.0, 1.0)
}

/// Rising numbers from `low` to `high`, with those of `between` that lie between.
pub(super) fn pieces(low: f64, high: f64, mut between: Vec<f64>) -> Vec<f64> {
    // Pieces as short as roundings of their ends hold nothing.
    let apart = |a: f64, b: f64| b - a > 1e-13 * a.abs().max(b.abs());
    between.retain(|x| apart(low, *x) && apart(*x, high));
    between.push(low);
    between.sort_by(f64::total_cmp);
    between.dedup_by(|b, a| !apart(*a, *b));
    between.push(high);
    between
}

/// The answer of rising orders: the first that agrees with the one before it, or the last; `spread` is how much larger
/// than the answer the terms are that it is made of.
pub(super) fn settle(
    method: &'static str,
    mut answer: impl FnMut(&Rule) -> Result<(f64, f64)>,
) -> Result<Value> {
    let (mut before, mut spread) = answer(&RULES[0])?;
    let mut difference = f64::INFINITY;
    for rule in &RULES[1..] {
        let (value, now) = answer(rule)?;
        difference = (value - before).abs();
        (before, spread) = (value, now);
        if difference <= AGREEMENT * value.abs() {
            break;
        }
    }
    Ok(Value::new(before, difference + ROUNDING * spread * before.abs() + f64::MIN_POSITIVE, method))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_roots_and_logarithms_at_the_ends() {
        let mut first = None;
        for rule in RULES.iter() {
            // int_0^2 x^(3/2) (2-x)^(1/2) dx = pi/2; the next singularity, tau = 3/2, leaves 3.7^(-2 order).
            let got = rule.integrate(0.0, 2.0, |x| x * (x * (2.0 - x)).sqrt());
            assert!((got - 0.5 * std::f64::consts::PI).abs() < 1e-13, "{} {got}", rule.order());
            // tau^3 ln tau leaves an error that falls like (order + 1/2)^(-8), down to roundings.
            let n = rule.order() as f64 + 0.5;
            let error = (rule.integrate(0.0, 1.0, |x| x * libm::log(x)) + 0.25).abs();
            let expected = *first.get_or_insert(error * libm::pow(n, 8.0)) * libm::pow(n, -8.0);
            assert!((error - expected).abs() < 0.1 * expected + 1e-15, "{} {error:e} {expected:e}", n);
            for x in [0.0, 1e-9, 0.2, 0.5, 0.9, 1.0] {
                assert!((place(tau_of(x)) - x).abs() < 4.0 * f64::EPSILON);
            }
        }
    }

    #[test]
    fn parts_of_a_piece_come_from_its_own_nodes() {
        let f = |x: f64| x.sqrt() * (3.0 - x).sqrt() * libm::exp(x);
        for rule in RULES.iter() {
            let values: Vec<[f64; 1]> = rule.on(1.0, 3.0).map(|(x, _)| [f(x - 1.0)]).collect();
            let got: f64 =
                rule.on_part(1.0, 3.0, 2.2).map(|(tau, _, w)| w * rule.interpolate(&values, tau)[0]).sum();
            let want = RULES[3].integrate(0.0, 1.2, f);
            // In tau the nearest singularity, 3 - x = 0, lies on the ellipse of sum 2.64 of the half axes.
            let allowed = libm::pow(2.64, -(rule.order() as f64)).max(1e-13);
            assert!((got - want).abs() < allowed, "{} {got} {want}", rule.order());
        }
    }
}
