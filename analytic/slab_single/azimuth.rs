//! The azimuthal mean of the Henyey-Greenstein phase function, through a complete elliptic integral.

use crate::error::{Result, within};
use crate::phase::Phase;
use crate::value::Value;

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
/// van de Hulst 1980, section 10.3
pub fn henyey_greenstein_mean(g: f64, x: f64, y: f64) -> Result<Value> {
    let phase = Phase::henyey_greenstein(g)?;
    within("x", x, -1.0, 1.0, "-1 to 1")?;
    within("y", y, -1.0, 1.0, "-1 to 1")?;
    Ok(Value::rounded(phase.azimuthal_mean(x, y), 128.0, "complete elliptic integral"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The integral over azimuth, and the closed form, by mpmath 1.3 with 30 digits.
    #[test]
    fn the_mean_agrees_with_the_foreign() {
        for (g, x, y, want) in [
            (0.75, -0.5, -0.25, 0.122_956_532_413_721_76),
            (0.99, -0.5, -0.5, 5.850_351_038_717_165),
            (-0.9, 0.5, -0.25, 0.074_770_135_293_723_25),
            (0.999, 0.125, 0.25, 0.003_211_798_966_836_909),
        ] {
            let got = henyey_greenstein_mean(g, x, y).unwrap();
            assert!(got.covers(want), "{g} {x} {y} {got:?} {want}");
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
