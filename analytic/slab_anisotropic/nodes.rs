//! The directions of discrete ordinates: a Gauss rule on [b, 1], and nodes that crowd towards the horizon.

use crate::quadrature::GaussLegendre;
use libm::exp;
use std::f64::consts::PI;

/// Nodes mu = b x^4 of a Gauss rule in x cover [0, b]. At depth t, light with mu below t has settled and light above
/// it has not; in ln mu that step is analytic in a strip of half width pi/2, so a spacing h = d(ln mu) leaves
/// exp(-pi^2/h) of it, and the light it concerns is a fraction mu of all. The fourth power lets h grow as fast as mu
/// falls.
const POWER: i32 = 4;

/// Nodes of a Gauss rule on [0, 1] lie pi root(u (1-u))/n apart. A peak is as wide in the angle from the zenith
/// everywhere, where it spans the fewest nodes at the zenith itself: with 1 - mu in proportion to u + SKEW u^2 the
/// fewest are TIGHT n in a radian over pi, there and in the middle, and not root 2 n.
const SKEW: f64 = 0.6;

/// Moments to each of n nodes that are tighter at the zenith: the product of two Legendre polynomials turns by both
/// their degrees in a radian, and a rule holds while that is below 2 TIGHT n, TIGHT = 1.6, less a little at its edge.
const TURNS: f64 = 3.1;

/// Directions on one hemisphere, in rising order of mu.
pub(crate) struct Nodes {
    /// Cosines \[1\], in (0, 1).
    pub mu: Vec<f64>,
    /// Weights of sum 1.
    pub weight: Vec<f64>,
    /// Highest Legendre moment of the phase function that the rule integrates to rounding.
    pub degree: usize,
    /// b and the number of nodes below it, if they crowd there.
    crowd: Option<(f64, f64)>,
}

impl Nodes {
    /// A Gauss rule of `upper` nodes on \[b, 1\] and of `lower` nodes in x on \[0, b\], where b = 2/`upper`.
    ///
    /// The light on \[b, 1\] is analytic but for mu = 0, so its rule converges like e^(-4 upper sqrt(b)), and a
    /// Legendre polynomial of the highest moment, 2 `upper` - 2, turns by 4 radians on \[0, b\].
    pub fn new(upper: usize, lower: usize) -> Self {
        Nodes::skewed(upper, lower, 0.0, 2 * upper - 2)
    }

    /// As many nodes for a peak, tighter at the zenith: for moments that fall so slowly that a rule cannot have them all.
    pub fn peaked(upper: usize, lower: usize) -> Self {
        Nodes::skewed(upper, lower, SKEW, (TURNS * (upper - 1) as f64) as usize)
    }

    fn skewed(upper: usize, lower: usize, skew: f64, degree: usize) -> Self {
        let b = 2.0 / upper as f64;
        let (inner, outer) = (GaussLegendre::rule(lower), GaussLegendre::rule(upper));
        let power = f64::from(POWER);
        let mut mu: Vec<f64> = inner.nodes.iter().map(|x| b * x.powi(POWER)).collect();
        let mut weight: Vec<f64> =
            inner.nodes.iter().zip(&inner.weights).map(|(x, w)| power * b * x.powi(POWER - 1) * w).collect();
        // 1 - mu = (1-b) (u + skew u^2)/(1 + skew), u = 1 - x, from the horizon up.
        let (steep, width) = (1.0 + skew, 1.0 - b);
        mu.extend(outer.nodes.iter().map(|x| {
            let u = 1.0 - x;
            b + width * x * (1.0 + skew * u / steep)
        }));
        let slope = |x: f64| (1.0 + 2.0 * skew * (1.0 - x)) / steep;
        weight.extend(outer.nodes.iter().zip(&outer.weights).map(|(x, w)| width * w * slope(*x)));
        Nodes { crowd: Some((b, lower as f64)), ..Nodes::of(mu, weight, degree) }
    }

    /// One Gauss rule of `half` nodes on \[0, 1\]: as many streams as twice that, by the usual count.
    pub fn double_gauss(half: usize) -> Self {
        let rule = GaussLegendre::rule(half);
        Nodes::of(rule.nodes, rule.weights, 2 * half - 1)
    }

    /// Any rule on \[0, 1\] in rising order, and the highest moment it can carry.
    pub fn of(mu: Vec<f64>, mut weight: Vec<f64>, degree: usize) -> Self {
        // The weights are good to a few roundings each, and their sum must be 1: photons are counted with them.
        let sum: f64 = weight.iter().sum();
        weight.iter_mut().for_each(|w| *w /= sum);
        Nodes { mu, weight, degree, crowd: None }
    }

    /// What the spacing of the nodes leaves open of the light of a slab of thickness `tau`, relative to what is
    /// scattered: a fraction min(tau, b) of it goes lower than tau, and exp(-pi^2/h) of that is not resolved.
    pub fn horizon(&self, tau: f64) -> f64 {
        let Some((b, _)) = self.crowd else { return 0.0 };
        let least = tau.min(0.5 * b);
        least * self.unresolved(least)
    }

    /// What the spacing leaves open of the fluence of light that is scattered once in a slab of thickness `tau`, relative to the fluence that it is
    /// scattered from: int (1 - e^(-t/mu)) dmu is settled by a tenth of t only, where nodes lie farther apart. Of the sets in use the error of the
    /// rule is up to 2.9 times the product below, for t from 1e-12 to 1e-2.
    pub fn open_fluence(&self, tau: f64) -> f64 {
        let Some((b, _)) = self.crowd else { return 0.0 };
        let least = tau.min(0.5 * b);
        4.0 * least * self.unresolved(0.1 * least)
    }

    /// exp(-pi^2/h) by the spacing of the nodes about a cosine below b.
    fn unresolved(&self, mu: f64) -> f64 {
        let Some((b, lower)) = self.crowd else { return 0.0 };
        let x = (mu / b).sqrt().sqrt();
        // Gauss nodes in x lie pi root(x (1-x))/n apart.
        let h = f64::from(POWER) * PI * (x * (1.0 - x)).sqrt() / (lower * x);
        exp(-PI * PI / h)
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

/// Nodes by which moments up to `degree` are well inside what [`Nodes::peaked`] carries.
pub(crate) fn peaked(degree: usize) -> usize {
    2 + (degree as f64 / (TURNS - 0.5)) as usize
}

/// root((l-m)!/(l+m)!) P_l^m(x) for l = m to `degree`, without the sign (-1)^m: the square integrates to 2/(2l+1),
/// and m = 0 is P_l.
pub(crate) fn legendre(m: usize, degree: usize, x: f64) -> Vec<f64> {
    let sine = ((1.0 - x) * (1.0 + x)).sqrt();
    let first = (1..=m).fold(1.0, |a, i| a * sine * ((2.0 * i as f64 - 1.0) / (2.0 * i as f64)).sqrt());
    let mut p = Vec::with_capacity(degree + 2 - m.min(degree));
    p.push(first);
    let order = m as f64;
    let root = |l: f64| ((l - order) * (l + order)).sqrt();
    p.push((2.0 * order + 1.0) * x * first / root(order + 1.0));
    for l in m + 2..=degree {
        let n = l as f64;
        let (one, two) = (p[l - m - 1], p[l - m - 2]);
        p.push(((2.0 * n - 1.0) * x * one - root(n - 1.0) * two) / root(n));
    }
    p.truncate(degree + 1 - m);
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moment_up_to_the_degree_is_integrated() {
        let nodes = Nodes::new(64, 40);
        // int_0^1 P_l P_m over even l, m vanishes unless l = m, where it is 1/(2l+1).
        let table: Vec<Vec<f64>> = nodes.mu.iter().map(|&mu| legendre(0, nodes.degree, mu)).collect();
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
    fn functions_of_every_azimuth_are_orthogonal() {
        let rule = GaussLegendre::rule(40);
        for m in [0, 1, 2, 7, 20] {
            for (l, n) in [(m, m), (m + 1, m + 1), (m + 3, m + 1), (m + 8, m + 8)] {
                let sum = rule.integrate(-1.0, 1.0, |x| {
                    let p = legendre(m, m + 8, x);
                    p[l - m] * p[n - m]
                });
                let exact = if l == n { 2.0 / (2.0 * l as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-15, "{m} {l} {n} {sum} {exact}");
            }
        }
        assert_eq!(legendre(5, 5, 0.3).len(), 1);
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
        // The sets in use, each within what it says of itself; beside it the last digit of 1 - E_2.
        for (upper, lower) in [(32, 60), (26, 50), (32, 40), (26, 34), (100, 60)] {
            let nodes = Nodes::new(upper, lower);
            for i in 0..60 {
                let t = libm::pow(10.0, -12.0 + f64::from(i) / 6.0);
                let sum = nodes.sum(|mu| -libm::expm1(-t / mu));
                let off = (sum - (1.0 - crate::exponential_integral::e_n(2, t))).abs();
                let most = nodes.open_fluence(t) + 4.0 * f64::EPSILON;
                assert!(off <= most, "{upper} {lower}, {t:e}: {off:e} above {most:e}");
            }
        }
    }
}
