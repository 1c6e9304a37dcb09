//! Directions of one hemisphere: a Gauss rule that integrates the phase function, and decades towards the horizon.

use crate::quadrature::GaussLegendre;
use libm::{ceil, exp, log};
use std::f64::consts::LN_10;

/// In ln mu the light on a decade is analytic in a strip of half width pi/2, so that n nodes on it leave
/// rho^(-2n), rho = x + sqrt(1 + x^2) with x = pi/ln 10.
const DECADE: f64 = 3.055;

/// Cosines and weights of a rule on (0, 1].
pub(super) struct Directions {
    /// Cosines \[1\].
    pub mu: Vec<f64>,
    /// Weights of sum 1.
    pub weight: Vec<f64>,
}

impl Directions {
    /// Products of two polynomials of degree `degree` at most are integrated to rounding; light that changes on the
    /// scale mu ~ `scale` or above is integrated to about `cut`.
    pub fn new(degree: usize, scale: f64, cut: f64) -> Self {
        let upper = (degree / 2 + 2).max(ceil(-log(cut)) as usize);
        let b = 2.0 / upper as f64;
        let mut out = Directions { mu: Vec::new(), weight: Vec::new() };
        out.panel(&GaussLegendre::rule(upper), b, 1.0);
        let mut high = b;
        // Light below mu is at most the part mu/scale of what there is.
        while high > cut * scale {
            let share = (high / scale).min(1.0);
            let needed = ceil(log(share / cut) / (2.0 * log(DECADE)));
            // A polynomial of the highest degree turns by 4 radians between 0 and b.
            let fewest = if high == b { 12.0 } else { 3.0 };
            let low = 0.1 * high;
            // Gauss in ln mu.
            let rule = GaussLegendre::rule(needed.max(fewest) as usize);
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                let mu = high * exp((x - 1.0) * LN_10);
                out.mu.push(mu);
                out.weight.push(LN_10 * w * mu);
            }
            high = low;
        }
        out.panel(&GaussLegendre::rule(2), 0.0, high);
        let sum: f64 = out.weight.iter().sum();
        out.weight.iter_mut().for_each(|w| *w /= sum);
        out
    }

    fn panel(&mut self, rule: &GaussLegendre, low: f64, high: f64) {
        self.mu.extend(rule.nodes.iter().map(|x| low + (high - low) * x));
        self.weight.extend(rule.weights.iter().map(|w| (high - low) * w));
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.mu.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_of_any_depth_are_integrated() {
        for (scale, depths) in [(1.0, [1e-9, 1e-4, 0.3]), (1e-12, [1e-16, 1e-13, 1e-12])] {
            for cut in [1e-12, 1e-9] {
                let rule = Directions::new(40, scale, cut);
                for t in depths {
                    let sum: f64 =
                        rule.mu.iter().zip(&rule.weight).map(|(mu, w)| w * -libm::expm1(-t / mu)).sum();
                    // 1 - E_2(t) = 1 - e^(-t) + t E_1(t).
                    let exact = -libm::expm1(-t) + t * crate::exponential_integral::e1(t);
                    assert!((sum - exact).abs() < 50.0 * cut * scale, "{scale:e} {t:e} {:e}", sum - exact);
                }
            }
        }
    }
}
