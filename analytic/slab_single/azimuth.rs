//! The azimuthal mean of the Henyey-Greenstein phase function, through a complete elliptic integral.

use crate::error::{Result, within};
use crate::value::Value;
use std::f64::consts::PI;

/// Mean over azimuth of the Henyey-Greenstein phase function between directions of cosines x and y.
///
/// (1/2 pi) int p dphi = (1-g^2) E(m) / (2 pi^2 (a-b) sqrt(a+b)), a = 1 + g^2 - 2 g x y,
/// b = 2 |g| sqrt((1-x^2)(1-y^2)), m = 2b/(a+b), E the complete elliptic integral of the second kind.
/// # Arguments
/// `g` in (-1, 1); `x`, `y` signed cosines of the two directions to the same axis, -1 to 1
/// # Returns
/// \[1/sr\]; 4 pi times it is sum_l (2l+1) g^l P_l(x) P_l(y)
/// # Errors
/// `Error::OutOfRange` naming `g`, `x` or `y`
/// # Limits
/// x = 1 or y = 1: the phase function itself
/// # Source
/// van de Hulst 1980, section 10.3; the integral by the arithmetic-geometric mean (Abramowitz and Stegun 1964, 17.6)
pub fn henyey_greenstein_mean(g: f64, x: f64, y: f64) -> Result<Value> {
    within("g", g, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, "above -1, below 1")?;
    within("x", x, -1.0, 1.0, "-1 to 1")?;
    within("y", y, -1.0, 1.0, "-1 to 1")?;
    let sine = |c: f64| ((1.0 - c) * (1.0 + c)).sqrt();
    let (sx, sy, sign) = (sine(x), sine(y), if g < 0.0 { -1.0 } else { 1.0 });
    // a -+ b = (1-|g|)^2 + 2 |g| (1 - sign x y -+ sx sy): half the squared chord between the directions at equal and
    // at opposite azimuth, as sums of squares.
    let lateral = if sx + sy > 0.0 { (x - y) * (x + y) / (sx + sy) } else { 0.0 };
    let normal = x - sign * y;
    let near = 0.5 * (lateral * lateral + normal * normal);
    let far = 0.5 * ((sx + sy) * (sx + sy) + normal * normal);
    let (h, gap) = (g.abs(), 1.0 - g.abs());
    let (least, most) = (gap * gap + 2.0 * h * near, gap * gap + 2.0 * h * far);
    let value = gap * (1.0 + h) * elliptic_e(least / most) / (2.0 * PI * PI * least * most.sqrt());
    Ok(Value::rounded(value, 64.0, "complete elliptic integral"))
}

/// E(m) = int_0^(pi/2) sqrt(1 - m sin^2) for m = 1 - `complement`, 0 to 1, by the arithmetic-geometric mean.
pub(crate) fn elliptic_e(complement: f64) -> f64 {
    if complement <= 0.0 {
        return 1.0;
    }
    // E/K = 1 - sum 2^(n-1) c_n^2, c_0^2 = m. Near m = 1 it cancels by the factor K, which for any f64 is below 40.
    let (mut a, mut b) = (1.0_f64, complement.sqrt());
    let (mut sum, mut power) = (0.5 * (1.0 - complement), 1.0);
    for _ in 0..40 {
        let c = 0.5 * (a - b);
        if c.abs() <= 1e-17 * a {
            break;
        }
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        sum += power * c * c;
        power *= 2.0;
    }
    (0.5 * PI / a) * (1.0 - sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;

    #[test]
    fn elliptic_integrals_agree_with_the_published_and_with_quadrature() {
        // ellipe(m) of mpmath 1.3, 30 digits.
        let published = [
            (0.5, 1.350_643_881_047_675_5),
            (0.1, 1.104_774_732_704_073_4),
            (1e-6, 1.000_003_897_026_172_1),
            (1e-15, 1.000_000_000_000_009),
        ];
        for (complement, want) in published {
            assert!((elliptic_e(complement) / want - 1.0).abs() < 1e-14, "{complement:e}");
        }
        let rule = GaussLegendre::rule(200);
        for m in [0.0, 1e-9, 0.1, 0.5, 0.9] {
            let want = rule.integrate(0.0, 0.5 * PI, |x| (1.0 - m * libm::sin(x) * libm::sin(x)).sqrt());
            assert!((elliptic_e(1.0 - m) / want - 1.0).abs() < 1e-14, "{m}");
        }
    }

    #[test]
    fn the_mean_is_the_legendre_series() {
        for g in [-0.95_f64, -0.3, 1e-9, 0.5, 0.9] {
            for x in [-1.0, -0.8, 0.0, 0.3, 1.0] {
                for y in [-0.9, 0.3, 0.31, 1.0] {
                    let (mut sum, mut size) = (0.0, 0.0);
                    let (mut px, mut py) = ([0.0, 1.0], [0.0, 1.0]);
                    let mut power = 1.0;
                    for l in 0..800 {
                        let n = f64::from(l);
                        let term = (2.0 * n + 1.0) * power * px[1] * py[1] / (4.0 * PI);
                        sum += term;
                        size += term.abs();
                        let next =
                            |p: [f64; 2], c: f64| [p[1], ((2.0 * n + 1.0) * c * p[1] - n * p[0]) / (n + 1.0)];
                        (px, py, power) = (next(px, x), next(py, y), power * g);
                    }
                    let got = henyey_greenstein_mean(g, x, y).unwrap();
                    let rounding = 16.0 * f64::EPSILON * size;
                    assert!((got.value - sum).abs() <= got.error + rounding, "{g} {x} {y} {got:?} {sum}");
                }
            }
        }
        assert!(henyey_greenstein_mean(1.0, 0.0, 0.0).is_err());
    }
}
