//! Gauss-Legendre quadrature, by Newton's method on the Legendre polynomials.

/// Legendre polynomials of degree n and n - 1 at x.
fn legendre_pair(n: u32, x: f64) -> (f64, f64) {
    let (mut previous, mut p) = (1.0, x);
    for k in 1..n {
        let k = f64::from(k);
        (previous, p) = (p, ((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0));
    }
    (p, previous)
}

/// The Legendre polynomial of degree `l` at x.
pub fn legendre(l: u32, x: f64) -> f64 {
    if l == 0 { 1.0 } else { legendre_pair(l, x).0 }
}

/// Nodes and weights on [-1, 1].
pub fn gauss(n: u32) -> Vec<(f64, f64)> {
    let nf = f64::from(n);
    (0..n)
        .map(|i| {
            let mut x = turbid::math::cos(std::f64::consts::PI * (f64::from(i) + 0.75) / (nf + 0.5));
            let mut slope = 0.0;
            for _ in 0..8 {
                let (p, previous) = legendre_pair(n, x);
                slope = nf * (x * p - previous) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The integral of f over [a, b] in `parts` equal parts of 20 nodes each.
pub fn integrate(a: f64, b: f64, parts: u32, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss(20);
    let width = (b - a) / f64::from(parts);
    (0..parts)
        .map(|part| {
            let middle = a + width * (f64::from(part) + 0.5);
            0.5 * width * rule.iter().map(|(x, w)| w * f(middle + 0.5 * width * x)).sum::<f64>()
        })
        .sum()
}

#[test]
fn degree_39_is_exact() {
    let sum: f64 = gauss(20).iter().map(|(x, w)| w * (0..38).fold(1.0, |p, _| p * x)).sum();
    assert!((sum - 2.0 / 39.0).abs() < 1e-15);
}
