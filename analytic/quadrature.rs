//! Gauss-Legendre rules of any order, and the two ways in which everything here integrates: panels graded
//! geometrically towards a singular end, and adaptive bisection with two rules.

use crate::error::{Error, Result, within};
use crate::value::Value;
use libm::cos;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A Gauss-Legendre rule on \[0, 1\].
#[derive(Debug, Clone, PartialEq)]
pub struct GaussLegendre {
    /// Nodes in rising order, in (0, 1).
    pub nodes: Vec<f64>,
    /// Weights, of sum 1.
    pub weights: Vec<f64>,
}

impl GaussLegendre {
    /// The rule with `order` nodes, exact for polynomials of degree 2 `order` - 1.
    ///
    /// # Errors
    /// `Error::OutOfRange` unless 1 <= order <= 10000
    /// # Source
    /// Newton's method on the Legendre recurrence (Davis and Rabinowitz 1984, section 2.7)
    pub fn new(order: usize) -> Result<Self> {
        within("order", order as f64, 1.0, 1e4, "1 to 10000")?;
        Ok(Self::rule(order))
    }

    pub(crate) fn rule(order: usize) -> Self {
        let n = order as f64;
        let (mut nodes, mut weights) = (vec![0.0; order], vec![0.0; order]);
        for i in 0..order.div_ceil(2) {
            let mut x = cos(PI * (i as f64 + 0.75) / (n + 0.5));
            let mut slope = 1.0;
            // Quadratic convergence from a guess good to 1/n^2: five steps reach rounding, two more cost nothing.
            for _ in 0..7 {
                let (p, d) = legendre(order, x);
                slope = d;
                x -= p / d;
            }
            if 2 * i + 1 == order {
                x = 0.0;
                slope = legendre(order, 0.0).1;
            }
            let weight = 1.0 / ((1.0 - x * x) * slope * slope);
            nodes[i] = 0.5 * (1.0 - x);
            nodes[order - 1 - i] = 0.5 * (1.0 + x);
            weights[i] = weight;
            weights[order - 1 - i] = weight;
        }
        GaussLegendre { nodes, weights }
    }

    /// Weights of barycentric interpolation at the nodes (Wang, Huybrechs and Vandewalle 2014), up to a factor.
    pub(crate) fn barycentric(&self) -> Vec<f64> {
        // (-1)^j root((1-x^2) w).
        let weights = self.nodes.iter().zip(&self.weights).map(|(x, w)| (x * (1.0 - x) * w).sqrt());
        weights.enumerate().map(|(j, weight)| if j.is_multiple_of(2) { weight } else { -weight }).collect()
    }

    /// The rule applied to `f` on \[a, b\].
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let length = b - a;
        let sum: f64 = self.nodes.iter().zip(&self.weights).map(|(x, w)| w * f(a + length * x)).sum();
        length * sum
    }
}

/// P_n(x) and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        let next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k;
        previous = p;
        p = next;
    }
    let nf = n as f64;
    (p, nf * (previous - x * p) / ((1.0 - x) * (1.0 + x)))
}

/// Lengths that halve towards 0: `length` (1, 1/2, ..., 2^-60), then 0. Integrands with a logarithm at 0 lose
/// 2^-60 there.
fn halving(length: f64) -> impl Iterator<Item = (f64, f64)> {
    let mut high = length;
    (0..=60).map(move |level| {
        let low = if level == 60 { 0.0 } else { 0.5 * high };
        let panel = (low, high);
        high = low;
        panel
    })
}

/// The rules of 16 and 24 nodes, whose nodes are found once.
pub(crate) static GAUSS_16: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::rule(16));
pub(crate) static GAUSS_24: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::rule(24));

/// int_0^length f(z) dz for a non-negative f with a logarithmic singularity at z = 0, smooth beyond.
pub(crate) fn integrate_from_singular(length: f64, f: impl Fn(f64) -> f64, method: &'static str) -> Value {
    let (fine, coarse) = (&GAUSS_24, &GAUSS_16);
    let (mut value, mut difference) = (0.0, 0.0);
    for (low, high) in halving(length) {
        let best = fine.integrate(low, high, &f);
        difference += (best - coarse.integrate(low, high, &f)).abs();
        value += best;
    }
    // The integrands are good to a few roundings, all terms have one sign.
    Value::new(value, difference + 32.0 * f64::EPSILON * value.abs() + f64::MIN_POSITIVE, method)
}

/// int_a^b f by bisection until 24 and 16 nodes agree, with panels of every break point; the bound is the sum of
/// the last disagreements plus rounding.
pub(crate) struct Adaptive {
    tolerance: f64,
}

impl Adaptive {
    /// Panels are halved until their rules agree to `tolerance` of the whole integral of |f|.
    pub(crate) fn new(tolerance: f64) -> Self {
        Adaptive { tolerance }
    }

    /// Integrates between consecutive `breaks` (rising). `name` is how an error calls the integrand.
    pub(crate) fn integrate(
        &self,
        breaks: &[f64],
        name: &'static str,
        method: &'static str,
        mut f: impl FnMut(f64) -> Result<f64>,
    ) -> Result<Value> {
        let mut panels = Vec::new();
        let mut magnitude = 0.0;
        let mut evaluate = |a: f64, b: f64| -> Result<(f64, f64, f64)> {
            let (best, absolute) = self.sum(&GAUSS_24, a, b, name, &mut f)?;
            let (rough, _) = self.sum(&GAUSS_16, a, b, name, &mut f)?;
            Ok((best, (best - rough).abs(), absolute))
        };
        for pair in breaks.windows(2) {
            if pair[1] > pair[0] {
                let panel = evaluate(pair[0], pair[1])?;
                magnitude += panel.2;
                panels.push((pair[0], pair[1], panel, 0));
            }
        }
        let (mut value, mut error) = (0.0, 0.0);
        let mut budget = 2000_u32;
        while let Some((a, b, (best, difference, absolute), depth)) = panels.pop() {
            let middle = 0.5 * (a + b);
            // Whatever disagreement is left at the last halving, or when the budget of a noisy integrand is spent,
            // is part of the bound.
            let settled = difference <= self.tolerance * magnitude;
            if settled || depth >= 40 || budget == 0 || middle <= a || middle >= b {
                value += best;
                error += difference + 8.0 * f64::EPSILON * absolute;
            } else {
                budget -= 1;
                panels.push((a, middle, evaluate(a, middle)?, depth + 1));
                panels.push((middle, b, evaluate(middle, b)?, depth + 1));
            }
        }
        Ok(Value::new(value, error + f64::MIN_POSITIVE, method))
    }

    fn sum(
        &self,
        rule: &GaussLegendre,
        a: f64,
        b: f64,
        name: &'static str,
        f: &mut impl FnMut(f64) -> Result<f64>,
    ) -> Result<(f64, f64)> {
        let (mut sum, mut absolute) = (0.0, 0.0);
        for (x, w) in rule.nodes.iter().zip(&rule.weights) {
            let at = a + (b - a) * x;
            let value = f(at)?;
            if !value.is_finite() {
                return Err(Error::NotFinite { name, value, at });
            }
            sum += w * value;
            absolute += w * value.abs();
        }
        Ok(((b - a) * sum, (b - a) * absolute))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_weights_agree_with_the_oracle() {
        for order in [2, 3, 5, 16, 24, 48, 101] {
            let ours = GaussLegendre::new(order).unwrap();
            let oracle = gauss_quad::GaussLegendre::new(order.try_into().unwrap());
            let mut theirs: Vec<(f64, f64)> =
                oracle.as_node_weight_pairs().iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
            theirs.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (i, (x, w)) in theirs.iter().enumerate() {
                assert!((ours.nodes[i] - x).abs() < 4.0 * f64::EPSILON, "{order} node {i}");
                assert!((ours.weights[i] - w).abs() < 1e-14 * w + 1e-15, "{order} weight {i}");
            }
        }
    }

    #[test]
    fn exact_up_to_degree_2n_minus_1() {
        for order in [1, 2, 7, 16, 48] {
            let rule = GaussLegendre::new(order).unwrap();
            for degree in [0, 1, 2 * order - 1] {
                let got = rule.integrate(0.0, 1.0, |x| libm::pow(x, degree as f64));
                assert!((got * (degree as f64 + 1.0) - 1.0).abs() < 1e-13, "{order} {degree}");
            }
        }
        assert!(GaussLegendre::new(0).is_err());
    }

    #[test]
    fn a_logarithm_is_integrated_within_the_bound() {
        // int_0^2 -ln(z/2) dz = 2.
        let got = integrate_from_singular(2.0, |z| -libm::log(0.5 * z), "test");
        assert!(got.covers(2.0) && got.error < 1e-13, "{got:?}");
        let got =
            Adaptive::new(1e-15).integrate(&[0.0, 0.3, 2.0], "f", "test", |z| Ok(libm::log(z))).unwrap();
        let truth = 2.0 * libm::log(2.0) - 2.0;
        assert!(got.covers(truth) && got.error < 1e-10, "{got:?}");
    }
}
