//! Directions for adding and doubling: Gauss panels, a horizon that is resolved, and users' angles of no weight.

use crate::quadrature::GaussLegendre;
use libm::sqrt;

/// Weight of a user's direction: nothing reaches the others through it, and its root squared is still a number.
const NOTHING: f64 = 1e-40;

/// Directions on one hemisphere.
#[derive(Clone)]
pub(crate) struct Nodes {
    /// Cosines \[1\], in (0, 1].
    pub mu: Vec<f64>,
    /// Weights, of sum 1 but for the users' directions.
    pub weight: Vec<f64>,
    /// How many of them are quadrature; what follows are users' directions.
    pub count: usize,
}

impl Nodes {
    /// A Gauss rule of `upper` nodes on \[b, 1\], b = 3/(`upper` + 2), and mu = b x^5 with `lower` nodes in x below.
    pub fn open(upper: usize, lower: usize) -> Self {
        let b = 3.0 / (upper as f64 + 2.0);
        let mut panels = Panels::default();
        panels.power(0.0, b, 5, lower);
        panels.plain(b, 1.0, upper);
        panels.finish()
    }

    /// The same with further directions, which see the light and add nothing to it.
    pub fn with(mut self, cosines: &[f64]) -> Self {
        self.mu.extend(cosines);
        self.weight.extend(cosines.iter().map(|_| NOTHING));
        self
    }

    /// Quadrature and users' directions together.
    pub fn len(&self) -> usize {
        self.mu.len()
    }

    /// sum over the quadrature of weight times `f`(mu).
    pub fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.mu.iter().zip(&self.weight).take(self.count).map(|(&mu, w)| w * f(mu)).sum()
    }
}

/// A rule on \[0, 1\] made of pieces.
#[derive(Default)]
pub(crate) struct Panels {
    mu: Vec<f64>,
    weight: Vec<f64>,
}

impl Panels {
    /// Gauss on \[a, b\].
    pub fn plain(&mut self, a: f64, b: f64, order: usize) {
        for (x, w) in rule(order) {
            self.push(a + (b - a) * x, (b - a) * w);
        }
    }

    /// Gauss in x on \[a, b\], mu = a + (b-a) x^power: for light that changes with ln(mu - a), or with its root.
    pub fn power(&mut self, a: f64, b: f64, power: i32, order: usize) {
        for (x, w) in rule(order) {
            self.push(a + (b - a) * x.powi(power), f64::from(power) * (b - a) * x.powi(power - 1) * w);
        }
    }

    fn push(&mut self, mu: f64, weight: f64) {
        self.mu.push(mu);
        self.weight.push(weight);
    }

    /// The nodes; photons are counted with the weights, so that their sum is made 1 to rounding.
    pub fn finish(mut self) -> Nodes {
        let sum: f64 = self.weight.iter().sum();
        self.weight.iter_mut().for_each(|w| *w /= sum);
        let count = self.mu.len();
        Nodes { mu: self.mu, weight: self.weight, count }
    }
}

fn rule(order: usize) -> impl Iterator<Item = (f64, f64)> {
    let rule = GaussLegendre::rule(order);
    rule.nodes.into_iter().zip(rule.weights)
}

/// Normalised associated Legendre functions Lambda_l^m(x), l = m to `degree`:
/// root((l-m)!/(l+m)!) P_l^m(x) without the sign (-1)^m.
pub(crate) fn legendre(m: usize, degree: usize, x: f64) -> Vec<f64> {
    let order = m as f64;
    let sine = sqrt((1.0 - x) * (1.0 + x));
    // root((2m)!)/(2^m m!) sine^m
    let start = (1..=m).fold(1.0, |p, k| p * sine * sqrt((2 * k - 1) as f64 / (2 * k) as f64));
    let mut p = vec![start];
    for l in m..degree {
        let n = l as f64;
        let before = if l == m { 0.0 } else { sqrt((n - order) * (n + order)) * p[l - m - 1] };
        let next = (2.0 * n + 1.0) * x * p[l - m] - before;
        p.push(next / sqrt((n + 1.0 - order) * (n + 1.0 + order)));
    }
    p
}
