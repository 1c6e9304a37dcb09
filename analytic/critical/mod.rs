//! Critical slabs and spheres: how much of a multiplying medium keeps itself going.
//!
//! Where each collision sends out c > 1 on the average, isotropically, light dies out in a thin body and grows without
//! limit in a thick one. Between the two lies one size at which phi = (c/2) K phi has a positive solution without any
//! source: the largest eigenvalue of K/2 is 1/c, with K the operator of E_1(|t-t'|) for the slab, and of the same on
//! odd functions u = r phi for the sphere. It is the one-speed critical problem of reactor physics.
//!
//! Deep inside, u is cos(kappa r) (slab) or sin(kappa r) (sphere) with c atan(kappa)/kappa = 1; near the surface decaying
//! modes fit it to the vacuum. The modes are those of discrete ordinates; the size follows from the phase
//! kappa a that leaves nothing coming in. Each answer is computed with two sets of directions, and its bound is twice
//! their difference plus rounding; the tests hold it against the eigenvalue of the integral equation, whose residual
//! bounds the error.
//!
//! Limits: c -> 1, half-thickness pi/(2 kappa) - 0.7104, radius pi/kappa - 0.7104, kappa = sqrt(3 (c-1)).
//!
//! Source: Davison 1957, chapter VIII; Case and Zweifel 1967, section 6.8; Kaper, Lindeman and Leaf 1974 (values);
//! Sood, Forster and Parsons 2003 (values).

use crate::error::{Error, Result, within};
use crate::sphere::ordinates::{decaying, directions};
use crate::value::Value;
use libm::{atan, cos, exp, expm1, sin, sqrt};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{FRAC_PI_2, PI};

const METHOD: &str = "discrete ordinates, two orders";

/// Directions to a panel.
const ORDERS: [usize; 2] = [20, 14];

/// Roundings of one answer: the fit of some 300 modes.
const ULPS: f64 = 256.0;

/// The shape of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CriticalShape {
    /// Between two parallel planes; its size is half its thickness.
    Slab,
    /// Its size is its radius.
    Sphere,
}

/// A critical body: its size, and the shape of the light that sustains itself.
pub struct Critical {
    shape: CriticalShape,
    secondaries: f64,
    orders: [Order; 2],
}

/// One set of directions.
struct Order {
    size: f64,
    kappa: f64,
    /// What the phase kappa a lacks of pi/2 (slab) or pi (sphere).
    angle: f64,
    /// Rates of the decaying modes, and what they have of the field whose slow part has amplitude 1.
    rates: Vec<f64>,
    amplitudes: Vec<f64>,
}

impl Critical {
    /// Finds the critical body.
    ///
    /// # Arguments
    /// `shape`; `secondaries` c, the mean number sent out by a collision, 1 + 1e-12 to 1000
    /// # Errors
    /// `Error::OutOfRange` naming `secondaries`
    pub fn new(shape: CriticalShape, secondaries: f64) -> Result<Self> {
        within("secondaries", secondaries, 1.0 + 1e-12, 1000.0, "1 + 1e-12 to 1000")?;
        const UNSOLVED: Error = Error::Infinite("the critical equations are singular in f64");
        let rough = Order::new(shape, secondaries, ORDERS[1], None).ok_or(UNSOLVED)?;
        let best = Order::new(shape, secondaries, ORDERS[0], Some(rough.size)).ok_or(UNSOLVED)?;
        Ok(Critical { shape, secondaries, orders: [best, rough] })
    }

    /// The body's shape.
    pub fn shape(&self) -> CriticalShape {
        self.shape
    }

    /// Mean number of secondaries a collision.
    pub fn secondaries(&self) -> f64 {
        self.secondaries
    }

    /// Half-thickness of the slab, radius of the sphere, in mean free paths.
    pub fn size(&self) -> Value {
        self.of(|order| order.size)
    }

    /// Fluence over that in the middle.
    ///
    /// # Arguments
    /// `x` distance from the middle over the half-thickness or radius, 0 to 1
    /// # Errors
    /// `Error::OutOfRange` naming `x`
    pub fn flux_ratio(&self, x: f64) -> Result<Value> {
        within("x", x, 0.0, 1.0, "0 to 1")?;
        Ok(self.of(|order| order.flux(self.shape, x) / order.flux(self.shape, 0.0)))
    }

    fn of(&self, pick: impl Fn(&Order) -> f64) -> Value {
        let (best, rough) = (pick(&self.orders[0]), pick(&self.orders[1]));
        Value::new(best, 2.0 * (best - rough).abs() + ULPS * f64::EPSILON * best.abs(), METHOD)
    }
}

/// Half-thickness of the critical slab in mean free paths.
///
/// # Arguments
/// `secondaries` c, the mean number sent out by a collision, 1 + 1e-12 to 1000
/// # Errors
/// `Error::OutOfRange` naming `secondaries`
pub fn critical_half_thickness(secondaries: f64) -> Result<Value> {
    Ok(Critical::new(CriticalShape::Slab, secondaries)?.size())
}

/// Radius of the critical sphere in mean free paths.
///
/// # Arguments
/// `secondaries` c, the mean number sent out by a collision, 1 + 1e-12 to 1000
/// # Errors
/// `Error::OutOfRange` naming `secondaries`
pub fn critical_radius(secondaries: f64) -> Result<Value> {
    Ok(Critical::new(CriticalShape::Sphere, secondaries)?.size())
}

impl Order {
    /// `start` is a size to start from.
    fn new(shape: CriticalShape, c: f64, order: usize, start: Option<f64>) -> Option<Self> {
        let (mu, weights) = directions((2.0 / c).min(1.0), false, order);
        let kappa = imaginary_rate(&mu, &weights, c);
        let modes: Vec<(f64, Vec<f64>)> = decaying(&mu, &weights, (1.0 - c) / c)
            .into_iter()
            .map(|(t, differences)| (sqrt(1.0 / t), differences.iter().map(|d| d / t).collect()))
            .collect();
        // The size that the phase asks for, when the far side is at distance 2 a.
        let turn = match shape {
            CriticalShape::Slab => FRAC_PI_2,
            CriticalShape::Sphere => PI,
        };
        let phase = |a: f64| -> Option<(f64, DVector<f64>)> {
            let n = mu.len();
            let far = |k: f64| match shape {
                CriticalShape::Slab => exp(-2.0 * k * a),
                CriticalShape::Sphere => -exp(-2.0 * k * a),
            };
            // Nothing comes in: [slow part, cosine and sine] + modes = 0 for each direction, the first coefficient 1.
            let mut matrix = DMatrix::from_fn(n, n, |i, j| {
                let m = mu[i];
                if j == 0 {
                    m / (1.0 + kappa * kappa * m * m)
                } else {
                    let (k, gaps) = &modes[j - 1];
                    -((1.0 + k * m) / gaps[i] + far(*k) / (1.0 + k * m))
                }
            });
            let scales = DVector::from_iterator(n, matrix.column_iter().map(|column| 1.0 / column.amax()));
            for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
                column *= *scale;
            }
            let right = DVector::from_iterator(n, mu.iter().map(|m| 1.0 / (1.0 + kappa * kappa * m * m)));
            let solution = matrix.lu().solve(&right)?.component_mul(&scales);
            let angle = atan(kappa / solution[0]);
            Some(((turn - angle) / kappa, solution))
        };
        // a = phase(a) has the far side's e^(-2 k a) alone on its right: secant steps, from its neglect at first.
        let mut a = match start {
            Some(a) => a,
            None => phase(f64::INFINITY)?.0,
        };
        let (mut image, mut solution) = phase(a)?;
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..40 {
            let defect = image - a;
            if defect.abs() <= 4.0 * f64::EPSILON * a {
                break;
            }
            // Where a secant says nothing, the plain iteration.
            let slope = match last {
                Some((b, d)) if b != a => (defect - d) / (a - b),
                _ => -1.0,
            };
            last = Some((a, defect));
            let next = (a - defect / if slope < -0.05 { slope } else { -1.0 }).max(0.2 * a);
            let settled = (next - a).abs() <= 1e-9 * a;
            a = next;
            (image, solution) = phase(a)?;
            if settled {
                break;
            }
        }
        let b = solution[0];
        // cos (slab) or sin (sphere) of kappa a.
        let face = (kappa / b) / sqrt(1.0 + kappa / b * (kappa / b));
        Some(Order {
            size: image,
            kappa,
            angle: atan(kappa / b),
            rates: modes.iter().map(|mode| mode.0).collect(),
            amplitudes: solution.iter().skip(1).map(|d| face * d).collect(),
        })
    }

    /// The fluence at x times the size.
    fn flux(&self, shape: CriticalShape, x: f64) -> f64 {
        let a = self.size;
        let r = x * a;
        let y = self.kappa * r;
        // Both shapes vanish one extrapolation beyond the surface: sin(angle + kappa (a - r)), exact there.
        let outer = sin(self.angle + self.kappa * (1.0 - x) * a);
        let mut sum = match shape {
            CriticalShape::Slab if x > 0.5 => outer,
            CriticalShape::Slab => cos(y),
            CriticalShape::Sphere if x > 0.5 => outer / r,
            CriticalShape::Sphere if y < 1e-8 => self.kappa,
            CriticalShape::Sphere => sin(y) / r,
        };
        for (k, amplitude) in self.rates.iter().zip(&self.amplitudes) {
            if k * (a - r) > 745.0 {
                break;
            }
            let near = exp(-k * (a - r));
            sum += amplitude
                * match shape {
                    CriticalShape::Slab => near * (1.0 + exp(-2.0 * k * r)),
                    CriticalShape::Sphere if k * r < 1e-9 => near * 2.0 * k,
                    CriticalShape::Sphere => near * -expm1(-2.0 * k * r) / r,
                };
        }
        sum
    }
}

/// kappa of c sum w_i/(1 + kappa^2 mu_i^2) = 1: sum w_i m_i/(t + m_i) = (c-1)/c, t = 1/kappa^2, m_i = mu_i^2.
fn imaginary_rate(mu: &[f64], weights: &[f64], c: f64) -> f64 {
    let wanted = (c - 1.0) / c;
    let sum = |t: f64| -> f64 { mu.iter().zip(weights).map(|(m, w)| w * m * m / (t + m * m)).sum() };
    // Falling in t; bisection in its logarithm.
    let (mut low, mut high) = (1e-20_f64, 1e20_f64);
    for _ in 0..120 {
        let middle = sqrt(low) * sqrt(high);
        if sum(middle) > wanted {
            low = middle
        } else {
            high = middle
        }
        if high <= low * (1.0 + f64::EPSILON) {
            break;
        }
    }
    sqrt(1.0 / (sqrt(low) * sqrt(high)))
}

#[cfg(test)]
mod tests;
