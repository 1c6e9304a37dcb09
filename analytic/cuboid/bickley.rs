//! Bickley's functions, which are to an endless duct what exponentials are to space.

use libm::{cosh, exp};
use std::sync::LazyLock;

/// Step of the trapezoidal rule: the integrand is analytic for |Im t| < pi/2, so that its error is
/// e^(-2 pi (pi/2)/h) = 7e-18.
const STEP: f64 = 0.25;

/// cosh t at the nodes, to where 1/cosh t is below rounding.
static COSH: LazyLock<Vec<f64>> =
    LazyLock::new(|| (0..=160_u32).map(|i| cosh(STEP * f64::from(i))).collect());

/// Ki_n(x) = int_0^oo e^(-x cosh t)/cosh^n t dt for x >= 0 and n = 1 or 2.
///
/// # Source
/// Bickley and Nayler 1935; the trapezoidal rule: Trefethen and Weideman 2014
pub(super) fn ki(n: i32, x: f64) -> f64 {
    let term = |c: f64| if n == 1 { exp(-x * c) / c } else { exp(-x * c) / (c * c) };
    let first = term(1.0);
    let mut sum = 0.5 * first;
    for &c in &COSH[1..] {
        let next = term(c);
        sum += next;
        if next < 1e-18 * first {
            break;
        }
    }
    STEP * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn values_at_zero_and_a_table() {
        assert!((ki(1, 0.0) - FRAC_PI_2).abs() < 3e-15 && (ki(2, 0.0) - 1.0).abs() < 3e-15);
        // Ki_2' = -Ki_1, by a central difference of third order with h = 1e-4: 1e-8/6 of K_1, which is 1.84 Ki_1 at 1 and less beyond.
        for x in [1.0, 5.0, 30.0] {
            let slope = (ki(2, x + 1e-4) - ki(2, x - 1e-4)) / 2e-4;
            assert!((slope + ki(1, x)).abs() < 3.4e-9 * ki(1, x), "{x}");
        }
        // As int_0^(pi/2) sin^(n-1) a e^(-x/sin a) da, another integral, by Gauss.
        let rule = crate::quadrature::GaussLegendre::rule(200);
        for x in [0.3, 2.0, 10.0] {
            let one = rule.integrate(0.0, FRAC_PI_2, |a| exp(-x / libm::sin(a)));
            let two = rule.integrate(0.0, FRAC_PI_2, |a| libm::sin(a) * exp(-x / libm::sin(a)));
            assert!((ki(1, x) / one - 1.0).abs() < 1e-12 && (ki(2, x) / two - 1.0).abs() < 1e-12, "{x}");
        }
    }
}
