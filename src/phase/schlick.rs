//! Schlick's phase function: an ellipse, without roots.

use super::PhaseFunction;
use crate::error::Result;
use crate::math::{Asymmetry, FOUR_PI, ln_1p};

/// `p = (1-k^2) / (4 pi (1 - k mu)^2)`.
///
/// Positive `k` is forward, mu the cosine between the directions of travel; the paper has 1 + k cos of the angle
/// between the directions towards source and receiver, which is the same.
///
/// # Source
/// Blasi, Le Saec and Schlick 1993
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schlick {
    k: f64,
}

impl Schlick {
    /// The phase function of eccentricity `k`.
    pub fn new(k: Asymmetry) -> Self {
        Schlick { k: k.get() }
    }

    /// The one whose mean cosine is `g`, by bisection.
    ///
    /// # Errors
    /// `Error::OutOfRange` where no f64 below 1 is eccentric enough: g within some 7e-15 of -1 or 1
    pub fn with_mean_cosine(g: Asymmetry) -> Result<Self> {
        let g = g.get();
        let (mut low, mut high) = (-1.0f64, 1.0f64);
        while let middle = 0.5 * (low + high)
            && middle > low
            && middle < high
        {
            if (Schlick { k: middle }).moment(1) < g { low = middle } else { high = middle }
        }
        let k = if low.abs() < high.abs() { low } else { high };
        Ok(Schlick::new(Asymmetry::new("mean cosine of a Schlick phase function", k)?))
    }

    /// The eccentricity.
    pub fn k(&self) -> f64 {
        self.k
    }
}

impl PhaseFunction for Schlick {
    fn eval(&self, one_minus_mu: f64, one_plus_mu: f64) -> f64 {
        let k = self.k;
        let d = if k >= 0.0 { (1.0 - k) + k * one_minus_mu } else { (1.0 + k) - k * one_plus_mu };
        (1.0 - k) / d * ((1.0 + k) / d) / FOUR_PI
    }

    /// 1+mu = 2u(1+k)/d and 1-mu = 2(1-u)(1-k)/d with d = 1 - k + 2ku: sums of terms of one sign.
    fn sample(&self, u: f64) -> (f64, f64) {
        let (k, e) = (self.k, 1.0 - u);
        let d = if k >= 0.0 { (1.0 - k) + 2.0 * k * u } else { (1.0 + k) - 2.0 * k * e };
        (2.0 * e * ((1.0 - k) / d), 2.0 * u * ((1.0 + k) / d))
    }

    /// With z = 1/k and Legendre functions of the second kind, int P_l(x)/(z-x) dx = 2 Q_l(z), so that
    /// chi_l = -(z^2-1) Q_l'(z) = (l+1) (z Q_l - Q_(l+1)).
    ///
    /// Q_l falls with l where the recurrence's other solution grows: forward from Q_0 only where z is so near 1 that
    /// neither changes by much, else backward from far above (Miller).
    fn moment(&self, l: u32) -> f64 {
        let size = self.k.abs();
        if l == 0 || size == 0.0 {
            return if l == 0 { 1.0 } else { 0.0 };
        }
        let z = 1.0 / size;
        // z = cosh(rate), and Q_l falls as e^(-rate l).
        let rate = ln_1p((z - 1.0) + ((z - 1.0) * (z + 1.0)).sqrt());
        let q0 = 0.5 * ln_1p(2.0 * size / (1.0 - size));
        let (here, above) = if rate * f64::from(l + 1) < 1.0 {
            let (mut here, mut above) = (q0, z * q0 - 1.0);
            for n in 1..=l {
                let n = f64::from(n);
                (here, above) = (above, ((2.0 * n + 1.0) * z * above - n * here) / (n + 1.0));
            }
            (here, above)
        } else {
            // The other solution is smaller by e^(-2 rate steps): 20/rate steps leave e^-40. Ratios Q_(n+1)/Q_n do
            // not overflow.
            let start = l + 2 + (20.0 / rate).ceil() as u32;
            let (mut ratio, mut product, mut above) = (0.0, 1.0, 0.0);
            for n in (1..=start).rev() {
                // (n+1) Q_(n+1) = (2n+1) z Q_n - n Q_(n-1), divided by Q_n.
                let count = f64::from(n);
                ratio = count / ((2.0 * count + 1.0) * z - (count + 1.0) * ratio);
                match n {
                    _ if n == l + 1 => above = ratio,
                    _ if n <= l => product *= ratio,
                    _ => {}
                }
            }
            (q0 * product, q0 * product * above)
        };
        let chi = f64::from(l + 1) * (z * here - above);
        if self.k < 0.0 && l % 2 == 1 { -chi } else { chi }
    }
}
