//! The directions of discrete ordinates: a Gauss rule on [b, 1], and nodes that crowd towards the horizon.

use crate::quadrature::GaussLegendre;

/// Nodes mu = b x^4 of a Gauss rule in x cover [0, b]. At depth t, light with mu below t has settled and light above
/// it has not; in ln mu that step is analytic in a strip of half width pi/2, so a spacing h = d(ln mu) leaves
/// exp(-pi^2/h) of it, and the light it concerns is a fraction mu of all. The fourth power lets h grow as fast as mu
/// falls.
const POWER: i32 = 4;

/// Directions on one hemisphere, in rising order of mu.
pub(super) struct Nodes {
    /// Cosines \[1\], in (0, 1).
    pub mu: Vec<f64>,
    /// Weights of sum 1.
    pub weight: Vec<f64>,
    /// Highest Legendre moment of the phase function that the rule integrates to rounding.
    pub degree: usize,
}

impl Nodes {
    /// A Gauss rule of `upper` nodes on \[b, 1\] and of `lower` nodes in x on \[0, b\], where b = 2/`upper`.
    ///
    /// The light on \[b, 1\] is analytic but for mu = 0, so its rule converges like e^(-4 upper sqrt(b)), and a
    /// Legendre polynomial of the highest moment, 2 `upper` - 2, turns by 4 radians on \[0, b\].
    pub fn new(upper: usize, lower: usize) -> Self {
        let b = 2.0 / upper as f64;
        let (inner, outer) = (GaussLegendre::rule(lower), GaussLegendre::rule(upper));
        let power = f64::from(POWER);
        let mut mu: Vec<f64> = inner.nodes.iter().map(|x| b * x.powi(POWER)).collect();
        let mut weight: Vec<f64> =
            inner.nodes.iter().zip(&inner.weights).map(|(x, w)| power * b * x.powi(POWER - 1) * w).collect();
        mu.extend(outer.nodes.iter().map(|x| b + (1.0 - b) * x));
        weight.extend(outer.weights.iter().map(|w| (1.0 - b) * w));
        // The weights are good to a few roundings each, and their sum must be 1: photons are counted with them.
        let sum: f64 = weight.iter().sum();
        weight.iter_mut().for_each(|w| *w /= sum);
        Nodes { mu, weight, degree: 2 * upper - 2 }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.mu.len()
    }

    /// sum over the nodes of weight times `f`(mu).
    pub fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.mu.iter().zip(&self.weight).map(|(&mu, w)| w * f(mu)).sum()
    }
}

/// P_0(x) to P_degree(x).
pub(super) fn legendre(degree: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for l in 2..=degree {
        let n = l as f64;
        p.push(((2.0 * n - 1.0) * x * p[l - 1] - (n - 1.0) * p[l - 2]) / n);
    }
    p.truncate(degree + 1);
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moment_up_to_the_degree_is_integrated() {
        let nodes = Nodes::new(64, 40);
        // int_0^1 P_l P_m over even l, m vanishes unless l = m, where it is 1/(2l+1).
        let table: Vec<Vec<f64>> = nodes.mu.iter().map(|&mu| legendre(nodes.degree, mu)).collect();
        for l in (0..=nodes.degree).step_by(2) {
            for m in [0, 2] {
                let sum: f64 = table.iter().zip(&nodes.weight).map(|(p, w)| w * p[l] * p[m]).sum();
                let exact = if l == m { 1.0 / (2.0 * l as f64 + 1.0) } else { 0.0 };
                // Degree l + 2 at most 2 upper: the very last product is one degree beyond the rule.
                if l + m <= nodes.degree {
                    assert!((sum - exact).abs() < 64.0 * f64::EPSILON, "{l} {m} {:e}", sum - exact);
                }
            }
        }
    }

    #[test]
    fn the_horizon_is_resolved() {
        // int_0^1 (1 - e^(-t/mu)) dmu = 1 - E_2(t).
        let nodes = Nodes::new(64, 40);
        for t in [1e-8, 1e-6, 1e-4, 1e-2, 1.0] {
            let sum = nodes.sum(|mu| -libm::expm1(-t / mu));
            let exact = 1.0 - crate::exponential_integral::e_n(2, t);
            assert!((sum - exact).abs() < 1e-9, "{t:e} {:e}", sum - exact);
        }
    }
}
