//! Bickley's functions, which are to an endless duct what exponentials are to space.

use libm::{cosh, exp};
use std::sync::LazyLock;

/// Finest step of the trapezoidal rule.
const STEP: f64 = 0.0625;

/// cosh t at the nodes, to where 1/cosh t is below rounding.
static COSH: LazyLock<Vec<f64>> =
    LazyLock::new(|| (0..=640_u32).map(|i| cosh(STEP * f64::from(i))).collect());

/// Ki_n(x) = int_0^oo e^(-x cosh t)/cosh^n t dt for x >= 0 and n = 1 or 2.
///
/// The integrand is analytic for |Im t| < pi/2: with step h the rule errs by e^(-pi^2/h), 7e-18 at 1/4, and, as e^(-x t^2/2) narrows,
/// by e^(-2 pi^2/(x h^2)), which wants shorter steps.
///
/// # Source
/// Bickley and Nayler 1935; the trapezoidal rule: Trefethen and Weideman 2014
pub(super) fn ki(n: i32, x: f64) -> f64 {
    let stride = match x {
        x if x < 0.5 => 4,
        x if x < 20.0 => 2,
        _ => 1,
    };
    let term = |c: f64| if n == 1 { exp(-x * c) / c } else { exp(-x * c) / (c * c) };
    let first = term(1.0);
    let mut sum = 0.5 * first;
    for &c in COSH[stride..].iter().step_by(stride) {
        let next = term(c);
        sum += next;
        if next < 1e-18 * first {
            break;
        }
    }
    STEP * stride as f64 * sum
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
        // As int_0^(pi/2) sin^(n-1) a e^(-x/sin a) da, another integral, by bisection.
        let adaptive = crate::quadrature::Adaptive::new(1e-15);
        for x in [0.3, 0.6, 2.0, 10.0, 40.0] {
            let by_angle = |f: &dyn Fn(f64) -> f64| {
                adaptive.integrate(&[0.0, FRAC_PI_2], "f", "", |a| Ok(f(libm::sin(a)))).unwrap().value
            };
            let (one, two) = (by_angle(&|s| exp(-x / s)), by_angle(&|s| s * exp(-x / s)));
            assert!((ki(1, x) / one - 1.0).abs() < 1e-13 && (ki(2, x) / two - 1.0).abs() < 1e-13, "{x}");
        }
    }
}
