//! The decay of light deep inside a medium that scatters isotropically.

use libm::{cosh, exp, log, log1p, tanh};

/// The positive root k of w atanh(k)/k = 1, held as b = atanh(k), tanh(b)/b = w: neither k nor 1 - k^2 loses digits,
/// at w = 1 where k vanishes or for small w where 1 - k^2 is about 4 e^(-2/w).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decay {
    /// atanh(k), infinite for w = 0.
    pub b: f64,
    /// Decay per mean free path.
    pub k: f64,
    /// 1 - k^2.
    pub gap: f64,
    /// k^2 + w - 1.
    pub excess: f64,
    /// sqrt(1-w)/k, 1/sqrt 3 for w = 1.
    pub ratio: f64,
}

impl Decay {
    /// For an albedo between 0 and 1.
    pub fn new(albedo: f64) -> Self {
        let absorbed = 1.0 - albedo;
        if absorbed == 0.0 {
            return Decay { b: 0.0, k: 0.0, gap: 1.0, excess: 0.0, ratio: 1.0 / 3f64.sqrt() };
        }
        // Above b = 20 tanh(b) is 1 in f64.
        let mut b = if albedo < 0.4 { 1.0 / albedo } else { (3.0 * absorbed / albedo).sqrt() };
        if albedo > 0.05 {
            // Newton's method on 1 - tanh(b)/b = 1 - w, whose slope is (k^2 - 1 + tanh(b)/b)/b.
            for _ in 0..12 {
                let (k, f) = (tanh(b), defect(b));
                b -= (f - absorbed) * b / (k * k - f);
            }
        }
        let k = tanh(b);
        let e = exp(-2.0 * b);
        let gap = if b > 20.0 { 4.0 * e } else { 1.0 / (cosh(b) * cosh(b)) };
        let excess = if albedo > 0.5 { k * k - absorbed } else { albedo - gap };
        Decay { b, k, gap, excess, ratio: absorbed.sqrt() / k }
    }

    /// 1 - k mu for 0 <= mu <= 1, without cancellation.
    pub fn one_minus(&self, mu: f64) -> f64 {
        let e = exp(-2.0 * self.b);
        (1.0 - mu) + mu * if self.b > 1.0 { 2.0 * e / (1.0 + e) } else { 1.0 - self.k }
    }

    /// -ln(1 - k^2).
    pub fn log_gap(&self) -> f64 {
        2.0 * (self.b + log1p(exp(-2.0 * self.b)) - log(2.0))
    }
}

/// 1 - tanh(b)/b.
fn defect(b: f64) -> f64 {
    if b > 2.0 {
        return 1.0 - tanh(b) / b;
    }
    // tanh(b) = b/(1 + b^2/(3 + b^2/(5 + ...))), whose remainders fall by (b/2n)^2 a term.
    let y = b * b;
    let c = (1..20).rev().fold(41.0, |below, n| f64::from(2 * n + 1) + y / below);
    let c = y / c;
    c / (1.0 + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roots found with 40 digits.
    #[test]
    fn known_roots() {
        for (w, k) in [(0.5, 0.957_504_024_077_268_7), (0.9, 0.525_429_512_658_008_7)] {
            let d = Decay::new(w);
            assert!((d.k - k).abs() < 4.0 * f64::EPSILON * k, "{w} {}", d.k);
        }
        let d = Decay::new(1e-3);
        assert!((d.b - 1000.0).abs() < 1e-12 && d.gap == 0.0 && d.excess == 1e-3);
        assert_eq!(Decay::new(0.0).k, 1.0);
    }

    /// k^2 = 3 e (1 - 4 e/5 + ...) with e = 1 - w, and atanh(k) w = k.
    #[test]
    fn the_equation_holds() {
        for i in 1..2000 {
            let w = f64::from(i) / 2000.0;
            let d = Decay::new(w);
            assert!((tanh(d.b) / d.b - w).abs() < 4.0 * f64::EPSILON, "{w}");
        }
        for e in [1e-15, 1e-12, 1e-9] {
            let w: f64 = 1.0 - e;
            let e = 1.0 - w;
            let d = Decay::new(w);
            assert!((d.k * d.k / (3.0 * e * (1.0 - 0.8 * e)) - 1.0).abs() < 1e-15 + 10.0 * e * e, "{e}");
            assert!((d.excess / (2.0 * e) - 1.0).abs() < 2.0 * e + 1e-15, "{e}");
        }
    }
}
