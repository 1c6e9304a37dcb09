//! Decays of light in an unbounded medium: discrete modes e^(-kr) with k < 1 and a continuum beyond.
//!
//! The Legendre moments psi_l of the light of decay x = 1/nu obey nu h_l psi_l = (l+1) psi_(l+1) + l psi_(l-1) with
//! h_l = (2l+1)(1 - w chi_l), l >= 1. Beyond the last moment chi_L this is the recurrence of the Legendre functions
//! P_l and Q_l, so that nothing is cut off: with g_l the solution that starts from g_0 = 1, g_1 = nu h_0,
//! W(nu) = (L+1) (g_(L+1) Q_L - g_L Q_(L+1)) vanishes at the modes nu = 1/k > 1, and 1/|W|^2 is the spectrum on
//! nu < 1, where Q_l is complex. The recurrence is that of a symmetric matrix, so that the modes slower than k are as
//! many as the changes of sign of g_l.

use libm::{asinh, atanh, ceil, cosh, expm1, sinh, tanh};
use std::f64::consts::FRAC_PI_2;

/// Modes with atanh(k) beyond this have 1 - k^2 < 1e-16, and a strength of that order.
const LAST: f64 = 19.0;

/// h_0 to h_L; beyond, h_l = 2l+1.
pub(crate) struct Recurrence {
    pub h: Vec<f64>,
}

/// A discrete mode: strength N in N e^(-kr)/(4 pi r).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    pub k: f64,
    pub strength: f64,
}

impl Recurrence {
    /// Of an albedo and the moments chi_0 = 1 to chi_L.
    pub fn new(albedo: f64, moments: &[f64]) -> Self {
        let mut h: Vec<f64> = moments
            .iter()
            .enumerate()
            .map(|(l, chi)| (2 * l + 1) as f64 * ((1.0 - albedo) + albedo * (1.0 - chi)))
            .collect();
        if h.len() == 1 {
            h.push(3.0);
        }
        Recurrence { h }
    }

    /// |W|^2 for 0 < nu < 1, where a = atanh(nu).
    pub fn spectrum(&self, nu: f64, a: f64) -> f64 {
        let (mut g, mut p, mut q) = ([1.0, nu * self.h[0]], [1.0, nu], [a, nu * a - 1.0]);
        for (l, &h) in self.h.iter().enumerate().skip(1) {
            let n = l as f64;
            let (up, down, own) = ((2.0 * n + 1.0) / (n + 1.0) * nu, n / (n + 1.0), h / (n + 1.0) * nu);
            g = [g[1], own * g[1] - down * g[0]];
            p = [p[1], up * p[1] - down * p[0]];
            q = [q[1], up * q[1] - down * q[0]];
        }
        let n = self.h.len() as f64;
        let real = n * (g[1] * q[0] - g[0] * q[1]);
        let imaginary = FRAC_PI_2 * n * (g[1] * p[0] - g[0] * p[1]);
        real * real + imaginary * imaginary
    }

    /// All modes, the slowest first: parted by their count, then Newton's method within brackets.
    pub fn modes(&self) -> Vec<Mode> {
        let slow = usize::from(self.h[0] == 0.0);
        let mut modes = Vec::new();
        if slow == 1 {
            // k = 0: 2 k^2/(2 h_0) with k^2 = h_0 h_1.
            modes.push(Mode { k: 0.0, strength: self.h[1] });
        }
        let mut parts = vec![(1e-12, slow, LAST, self.slower_than(LAST))];
        while let Some((low, below, high, to)) = parts.pop() {
            let middle = (low * high).sqrt();
            match to.saturating_sub(below) {
                0 => {}
                1 => modes.push(self.refine(low, high, to)),
                _ if middle <= low || middle >= high => modes.push(self.refine(low, high, to)),
                _ => {
                    let count = self.slower_than(middle).clamp(below, to);
                    parts.push((middle, count, high, to));
                    parts.push((low, below, middle, count));
                }
            }
        }
        modes
    }

    /// The mode number `j`, the only one with atanh(k) between two bounds.
    fn refine(&self, mut low: f64, mut high: f64, j: usize) -> Mode {
        let mut b = (low * high).sqrt();
        for step in 1..=200 {
            let (defect, norm) = self.balance(b);
            let c = cosh(b);
            let newton = b + tanh(b) * defect / (norm - defect) * c * c;
            let settled = (newton - b).abs() <= 4.0 * f64::EPSILON * b;
            if settled || high - low <= 4.0 * f64::EPSILON * low {
                break;
            }
            if self.slower_than(b) >= j {
                high = b
            } else {
                low = b
            }
            // A bisection now and then, lest Newton's method creep along a pole.
            b = if step % 4 != 0 && newton > low && newton < high { newton } else { (low * high).sqrt() };
        }
        let k = tanh(b);
        Mode { k, strength: 2.0 * k * k / self.balance(b).1 }
    }

    /// How many modes have atanh(k) < b.
    fn slower_than(&self, b: f64) -> usize {
        let nu = 1.0 / tanh(b);
        let mut count = 0;
        let mut ratio = f64::INFINITY;
        // Two terms more: after the last change of sign among the moments the ratio is positive again.
        for l in 0..self.h.len() + 2 {
            let n = l as f64;
            let h = self.h.get(l).copied().unwrap_or(2.0 * n + 1.0);
            ratio = (nu * h - n / ratio) / (n + 1.0);
            if ratio <= 0.0 {
                count += 1;
                ratio = ratio.min(-1e-300);
            }
        }
        // Beyond, g = alpha P + beta Q changes its sign once more if alpha is negative.
        let last = self.h.len() + 1;
        if ratio > 0.0 && ratio < legendre_ratio(last, b, nu) { count + 1 } else { count }
    }

    /// The moments f_0 = 1 to f_L of the mode that decays by k: its light is sum (2l+1) f_l P_l(u).
    pub fn pattern(&self, k: f64) -> Vec<f64> {
        let last = self.h.len() - 1;
        if k == 0.0 {
            return vec![1.0];
        }
        let b = atanh(k);
        let ratios = self.ratios(b);
        let mut f = vec![1.0];
        for ratio in ratios.iter().take(last) {
            f.push(f[f.len() - 1] * ratio);
        }
        f
    }

    /// D = h_0 - k f_1 and sum h_l f_l^2 for the moments f_l, f_0 = 1, that are proportional to Q_l from L on: D = 0 for
    /// a mode, and dD/dk = -(sum - D)/k.
    fn balance(&self, b: f64) -> (f64, f64) {
        let k = tanh(b);
        let last = self.h.len() - 1;
        let ratios = self.ratios(b);
        let tail = ratios[last];
        let (mut f, mut sum) = (1.0, self.h[0]);
        for l in 1..=last {
            f *= ratios[l - 1];
            sum += self.h[l] * f * f;
        }
        // sum_(l>L) (2l+1) Q_l^2 = (L+1)^2 sinh^2 b (Q_(L+1)^2 - 2 nu Q_(L+1) Q_L + Q_L^2).
        let n = last as f64 + 1.0;
        let over = 2.0 / expm1(2.0 * b);
        let rest = (1.0 - tail) * (1.0 - tail) - 2.0 * over * tail;
        let scale = n * sinh(b) * f;
        (self.h[0] - k * ratios[0], sum + (scale * scale * rest).max(0.0))
    }
}

impl Recurrence {
    /// f_(l+1)/f_l of the mode with k = tanh(b), l = 0 to L.
    fn ratios(&self, b: f64) -> Vec<f64> {
        let nu = 1.0 / tanh(b);
        let last = self.h.len() - 1;
        let mut ratios = vec![legendre_ratio(last, b, nu); last + 1];
        for l in (0..last).rev() {
            let n = l as f64;
            let below = nu * self.h[l + 1] - (n + 2.0) * ratios[l + 1];
            ratios[l] = (n + 1.0) / if below == 0.0 { 1e-300 } else { below };
        }
        ratios
    }
}

/// Q_(l+1)(nu)/Q_l(nu) for nu = coth b > 1.
fn legendre_ratio(l: usize, b: f64, nu: f64) -> f64 {
    // Solutions grow and fall like e^(+-eta l) with cosh(eta) = nu.
    let eta = asinh(1.0 / sinh(b));
    let steps = ceil(20.0 / eta) + 4.0;
    if steps < 12.0 * l as f64 + 1000.0 {
        // Downwards, any start is forgotten.
        let mut ratio = 0.0;
        for m in (l..l + steps as usize).rev() {
            let n = m as f64;
            ratio = (n + 1.0) / ((2.0 * n + 3.0) * nu - (n + 2.0) * ratio);
        }
        return ratio;
    }
    // Here eta l < 2: upwards, nothing grows by more than e^4.
    let mut q = [b, nu * b - 1.0];
    for m in 1..=l {
        let n = m as f64;
        q = [q[1], ((2.0 * n + 1.0) * nu * q[1] - n * q[0]) / (n + 1.0)];
    }
    q[1] / q[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::half_space::decay::Decay;

    fn henyey_greenstein(albedo: f64, g: f64) -> Recurrence {
        let moments: Vec<f64> = (0..4000).map(|l| g.powi(l)).take_while(|chi| chi.abs() > 1e-18).collect();
        Recurrence::new(albedo, &moments)
    }

    #[test]
    fn the_ratio_of_legendre_functions_both_ways() {
        for b in [1e-6, 0.5, 2.0, 5.0, 8.0, 12.0] {
            let nu = 1.0 / tanh(b);
            // Q_1/Q_0 = nu - 1/b.
            let exact = if b < 1e-3 { b / 3.0 } else { nu - 1.0 / b };
            let got = legendre_ratio(0, b, nu);
            assert!((got / exact - 1.0).abs() < 1e-12, "{b} {got} {exact}");
        }
    }

    #[test]
    fn one_mode_in_isotropic_fog() {
        for w in [0.15, 0.5, 0.9, 1.0 - 1e-15, 1.0] {
            let modes = Recurrence::new(w, &[1.0]).modes();
            let exact = Decay::new(w);
            assert_eq!(modes.len(), 1);
            assert!((modes[0].k - exact.k).abs() <= 1e-15 * exact.k, "{w} {modes:?}");
            let strength =
                if w == 1.0 { 3.0 } else { 2.0 * exact.k * exact.k * exact.gap / (w * exact.excess) };
            assert!((modes[0].strength / strength - 1.0).abs() < 1e-13, "{w} {modes:?} {strength}");
        }
    }

    /// The second mode at w = 1, to the four digits that the literature on the scaling of thick layers gives.
    #[test]
    fn peaks_have_several_modes() {
        for (g, second) in
            [(0.5, 0.9887), (0.75, 0.7110), (0.85, 0.4820), (0.9, 0.3403), (0.95, 0.1798), (-0.9, 0.8044)]
        {
            let modes = henyey_greenstein(1.0, g).modes();
            assert_eq!(modes[0].k, 0.0);
            assert!((modes[1].k - second).abs() < 6e-5, "{g} {modes:?}");
        }
        for g in [0.3, 0.4] {
            assert!(henyey_greenstein(1.0, g).modes().get(1).is_none_or(|mode| mode.k > 0.999_99));
        }
    }
}
