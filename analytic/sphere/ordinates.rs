//! The odd slab by discrete ordinates: the sphere's second method, and the first for large ones.
//!
//! u = r phi is the scalar flux of a slab -a < r < a that is odd under reflection. With directions mu_i and weights
//! w_i on (0, 1) the modes are e^(+-k r) with 1 = w sum w_i/(1 - k^2 mu_i^2), k^2 one root between each two poles and
//! one below them, and the odd ones, sinh(k r), are fitted to what comes in at r = a. Light falling on the sphere with
//! radiance 1/pi comes in as I(a, -mu) = 2 (a + mu).

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::quadrature::GaussLegendre;
use libm::{cosh, exp, sinh, sqrt};

/// Growth of the panels of directions away from grazing.
const GROWTH: f64 = 3.0;

/// End of the most grazing panel over min(a, 1): what is slanted more lives in a skin of that depth.
const FIRST: f64 = 1e-9;

/// One mode: its rate, and 1 - k^2 mu_i^2 for every direction.
struct Mode {
    /// k^2, 0 in a sphere that does not absorb.
    square: f64,
    k: f64,
    gaps: Vec<f64>,
}

impl Mode {
    /// (s, s') at r of the odd mode, scaled to stay finite at r = a: sinh(k r)/(k a) or 2 e^(-k a) sinh(k r).
    fn odd(&self, a: f64, r: f64) -> (f64, f64) {
        let y = self.k * r;
        if self.k * a < 1.0 {
            (r / a * sinh_ratio(y), cosh(y) / a)
        } else {
            let (near, far) = (exp(self.k * (r - a)), exp(-self.k * (r + a)));
            let s = if y < 0.5 { 2.0 * exp(-self.k * a) * sinh(y) } else { near - far };
            (s, self.k * (near + far))
        }
    }

    /// int_0^a r s(r) dr.
    fn moment(&self, a: f64) -> f64 {
        let y = self.k * a;
        if y < 1.0 {
            // (y cosh y - sinh y)/y^3 = sum 2n y^(2n-2)/(2n+1)!.
            return a * a * moment_series(y);
        }
        let e = exp(-2.0 * y);
        (a * (1.0 + e) - (1.0 - e) / self.k) / self.k
    }
}

/// sinh(y)/y.
fn sinh_ratio(y: f64) -> f64 {
    if y < 1e-8 { 1.0 } else { sinh(y) / y }
}

/// (y cosh y - sinh y)/y^3 for y < 1.
fn moment_series(y: f64) -> f64 {
    let (mut power, mut sum, mut n) = (1.0, 0.0, 0.0);
    while n < 10.0 {
        n += 1.0;
        power /= (2.0 * n) * (2.0 * n + 1.0);
        sum += 2.0 * n * power;
        power *= y * y;
    }
    sum
}

/// Directions and weights on (0, 1), graded towards grazing for features of size `scale`, `order` to a panel; towards
/// the normal too if e^(-x/mu) matters at depths x up to the underflow.
pub(crate) fn directions(scale: f64, steep: bool, order: usize) -> (Vec<f64>, Vec<f64>) {
    let rule = GaussLegendre::rule(order);
    let mut edges = if steep { vec![1.0, 0.99, 0.96, 0.8] } else { vec![1.0] };
    edges.push(1.0 / GROWTH);
    while edges[edges.len() - 1] > FIRST * scale {
        edges.push(edges[edges.len() - 1] / GROWTH);
    }
    edges.push(0.0);
    let (mut mu, mut weights) = (Vec::new(), Vec::new());
    // From the steepest down.
    for pair in edges.windows(2) {
        let length = pair[0] - pair[1];
        for (x, w) in rule.nodes.iter().zip(&rule.weights) {
            mu.push(pair[0] - length * x);
            weights.push(length * w);
        }
    }
    (mu, weights)
}

/// Roots t = 1/k^2 of sum w_i m_i/(t - m_i) = excess, m_i = mu_i^2 falling, in rising order of k; each with all
/// t - m_i. For excess <= 0 the first root is not among them.
pub(crate) fn decaying(mu: &[f64], weights: &[f64], excess: f64) -> Vec<(f64, Vec<f64>)> {
    let n = mu.len();
    let differences = |b: usize, offset: f64| -> Vec<f64> {
        mu.iter().map(|m| offset + (mu[b] - m) * (mu[b] + m)).collect()
    };
    let high = |b: usize, offset: f64| {
        let mut sum = -excess;
        for (m, w) in mu.iter().zip(weights) {
            sum += w * m * m / (offset + (mu[b] - m) * (mu[b] + m));
        }
        sum > 0.0
    };
    // The sum falls with t. Bisection in the logarithm of the distance from the nearer pole.
    let bisect = |b: usize, sign: f64, reach: f64| {
        let (mut low, mut far) = (1e-60 * reach, reach);
        for _ in 0..120 {
            let middle = sqrt(low) * sqrt(far);
            // Above a pole the sum is positive nearby, below it negative.
            if high(b, sign * middle) == (sign > 0.0) {
                low = middle
            } else {
                far = middle
            }
            if far <= low * (1.0 + f64::EPSILON) {
                break;
            }
        }
        sign * sqrt(low) * sqrt(far)
    };
    let mut roots = Vec::with_capacity(n);
    if excess > 0.0 {
        let offset = bisect(0, 1.0, 1e20);
        roots.push((mu[0] * mu[0] + offset, differences(0, offset)));
    }
    for b in 0..n - 1 {
        let gap = (mu[b] - mu[b + 1]) * (mu[b] + mu[b + 1]);
        let (base, sign) = if high(b, -0.5 * gap) { (b, -1.0) } else { (b + 1, 1.0) };
        let offset = bisect(base, sign, 0.5 * gap);
        roots.push((mu[base] * mu[base] + offset, differences(base, offset)));
    }
    roots
}

/// The odd slab of one radius and albedo, ready for any light coming in.
pub(crate) struct Ordinates {
    pub a: f64,
    pub albedo: f64,
    pub mu: Vec<f64>,
    modes: Vec<Mode>,
    /// k^2/(1-w) of the slowest mode.
    ratio: f64,
    lu: LU<f64, Dyn, Dyn>,
    scales: DVector<f64>,
}

/// A field u = r phi as a sum of modes.
pub(crate) struct Modes {
    coefficients: DVector<f64>,
    /// What is added: nothing, or the particular solution of a uniform source of unit density.
    uniform: bool,
}

impl Ordinates {
    /// # Arguments
    /// `albedo` above 0; `order` directions to a panel
    pub(crate) fn new(a: f64, albedo: f64, order: usize) -> Self {
        let (mu, weights) = directions(a.min(1.0), a > 20.0 && albedo < 0.95, order);
        let excess = (1.0 - albedo) / albedo;
        let mut modes = Vec::with_capacity(mu.len());
        if excess == 0.0 {
            modes.push(Mode { square: 0.0, k: 0.0, gaps: vec![1.0; mu.len()] });
        }
        for (t, differences) in decaying(&mu, &weights, excess) {
            let gaps = differences.iter().map(|d| d / t).collect();
            modes.push(Mode { square: 1.0 / t, k: sqrt(1.0 / t), gaps });
        }
        let sum: f64 = (0..mu.len()).map(|i| weights[i] * mu[i] * mu[i] / modes[0].gaps[i]).sum();
        let n = mu.len();
        let mut matrix = DMatrix::from_fn(n, n, |i, j| {
            let (mode, m) = (&modes[j], mu[i]);
            if mode.k * a < 1.0 {
                let (s, slope) = mode.odd(a, a);
                (s + m * slope) / mode.gaps[i]
            } else {
                // (1 - e + k mu (1 + e))/(1 - k^2 mu^2), e = e^(-2 k a).
                let (km, e) = (mode.k * m, exp(-2.0 * mode.k * a));
                (1.0 + km) / mode.gaps[i] - e / (1.0 + km)
            }
        });
        let scales = DVector::from_iterator(n, matrix.column_iter().map(|c| 1.0 / c.amax()));
        for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
            column *= *scale;
        }
        Ordinates { a, albedo, mu, modes, ratio: 1.0 / (albedo * sum), lu: matrix.lu(), scales }
    }

    /// The field of light coming in, `incoming` its I(a, -mu).
    pub(crate) fn lit(&self, incoming: impl Fn(f64) -> f64) -> Option<Modes> {
        let right =
            DVector::from_iterator(self.mu.len(), self.mu.iter().map(|&m| 2.0 / self.albedo * incoming(m)));
        let coefficients = self.lu.solve(&right)?.component_mul(&self.scales);
        Some(Modes { coefficients, uniform: false })
    }

    /// The field of light falling on the sphere with radiance 1/pi.
    pub(crate) fn incident(&self) -> Option<Modes> {
        self.lit(|m| 2.0 * (self.a + m))
    }

    /// The field of a uniform source of unit density.
    ///
    /// r/(1-w) is a particular solution, and so is \[r - sinh(k r)/k\]/(1-w) with the slowest k, which stays finite
    /// as w -> 1.
    pub(crate) fn uniform(&self) -> Option<Modes> {
        let first = &self.modes[0];
        let (a, y) = (self.a, first.k * self.a);
        let mut field = if y < 1.0 {
            let (s, c) = (a * sinh_ratio(y), cosh(y));
            let (cubic, square) = (moment_cubic(y), moment_square(y));
            self.lit(|m| {
                let gap = 1.0 - first.square * m * m;
                // Minus the particular solution's own I(a, -mu).
                0.5 * self.ratio * a * a * (a * cubic + m * square)
                    - 0.5 * (1.0 - self.ratio * m * m) / gap * (s + m * c)
            })?
        } else {
            self.lit(|m| -0.5 * (a + m) / (1.0 - self.albedo))?
        };
        field.uniform = true;
        Some(field)
    }

    /// phi(r) = u(r)/r.
    pub(crate) fn fluence(&self, field: &Modes, r: f64) -> f64 {
        let mut sum = 0.0;
        for (mode, c) in self.modes.iter().zip(field.coefficients.iter()) {
            if mode.k * (self.a - r) > 745.0 {
                break;
            }
            let (s, slope) = mode.odd(self.a, r);
            // Near the centre s/r is s'(0), to (k r)^2/6.
            sum += c * if mode.k * r < 1e-9 { slope } else { s / r };
        }
        if field.uniform {
            let y = self.modes[0].k * r;
            sum += if self.modes[0].k * self.a < 1.0 {
                -self.ratio * r * r * moment_cubic(y)
            } else {
                1.0 / (1.0 - self.albedo)
            };
        }
        sum
    }

    /// Mean of phi over the volume.
    pub(crate) fn mean(&self, field: &Modes) -> f64 {
        let a = self.a;
        let mut sum = 0.0;
        for (mode, c) in self.modes.iter().zip(field.coefficients.iter()) {
            sum += c * mode.moment(a);
        }
        let mut mean = 3.0 / (a * a * a) * sum;
        if field.uniform {
            let y = self.modes[0].k * a;
            mean += if y < 1.0 {
                // 3/a^3 int r (r - sinh(k r)/k)/(1-w) = (ratio/k^2) \[1 - 3 (y cosh y - sinh y)/y^3\].
                -self.ratio * a * a * moment_fifth(y)
            } else {
                1.0 / (1.0 - self.albedo)
            };
        }
        mean
    }
}

/// (sinh y - y)/y^3, y < 1.
fn moment_cubic(y: f64) -> f64 {
    series(y, |n| 1.0 / ((2.0 * n + 2.0) * (2.0 * n + 3.0)), 1.0 / 6.0)
}

/// (cosh y - 1)/y^2, y < 1.
fn moment_square(y: f64) -> f64 {
    series(y, |n| 1.0 / ((2.0 * n + 1.0) * (2.0 * n + 2.0)), 0.5)
}

/// \[3 (y cosh y - sinh y)/y^3 - 1\]/y^2 = sum_(n>=1) 6 (n+1) y^(2n-2)/(2n+3)!, y < 1.
fn moment_fifth(y: f64) -> f64 {
    let (mut factorial, mut power, mut sum, mut n) = (6.0, 1.0, 0.0, 0.0);
    while n < 10.0 {
        n += 1.0;
        factorial *= (2.0 * n + 2.0) * (2.0 * n + 3.0);
        sum += 6.0 * (n + 1.0) * power / factorial;
        power *= y * y;
    }
    sum
}

/// sum c_n y^(2n-2), c_1 = `first`, c_(n+1) = c_n `next`(n).
fn series(y: f64, next: impl Fn(f64) -> f64, first: f64) -> f64 {
    let (mut term, mut sum, mut n) = (first, first, 0.0);
    while n < 10.0 {
        n += 1.0;
        term *= y * y * next(n);
        sum += term;
    }
    sum
}
