//! Double-double numbers: 106 bits, for references that f64 cannot give.
//!
//! Source: Dekker 1971; Hida, Li and Bailey 2001. Products are split, so that no fused operation is needed.

use std::ops::{Add, Div, Mul, Sub};

/// The unevaluated sum of two f64, the second below half an ulp of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Double(pub f64, pub f64);

fn two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let t = s - a;
    Double(s, (a - (s - t)) + (b - t))
}

fn quick_two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    Double(s, b - (s - a))
}

fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> Double {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Double(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Double(x, 0.0)
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, other: Double) -> Double {
        let (s, t) = (two_sum(self.0, other.0), two_sum(self.1, other.1));
        let s = quick_two_sum(s.0, s.1 + t.0);
        quick_two_sum(s.0, s.1 + t.1)
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, other: Double) -> Double {
        self + Double(-other.0, -other.1)
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, other: Double) -> Double {
        let p = two_product(self.0, other.0);
        quick_two_sum(p.0, p.1 + self.0 * other.1 + self.1 * other.0)
    }
}

impl Div for Double {
    type Output = Double;
    fn div(self, other: Double) -> Double {
        let q1 = self.0 / other.0;
        let r = self - other * Double::from(q1);
        let q2 = r.0 / other.0;
        let r = r - other * Double::from(q2);
        quick_two_sum(q1, q2) + Double::from(r.0 / other.0)
    }
}

impl Double {
    /// Square root of a positive number, by one step of Newton from the f64 root.
    pub fn sqrt(self) -> Double {
        let root = Double::from(self.0.sqrt());
        root + (self - root * root) / (root + root)
    }

    /// How far an f64 is from this number, relative to it.
    pub fn relative_error_of(self, x: f64) -> f64 {
        ((Double::from(x) - self) / self).0.abs()
    }
}

#[test]
fn thirty_digits() {
    let third = Double::from(1.0) / Double::from(3.0);
    let one = third + third + third;
    assert!((one - Double::from(1.0)).0.abs() < 1e-31);
    let root = Double::from(2.0).sqrt();
    assert!((root * root - Double::from(2.0)).0.abs() < 1e-30);
}
