//! A homogeneous layer doubled again and again, and the way back down to any depth.
//!
//! Light is a vector u = root(mu weight) I over the nodes, I the radiance in one azimuthal mode. A layer has a
//! reflection R, a transmission e + T of direct and of scattered light, all symmetric, and two of them make
//!
//! R' = R + (e+T) R S (e+T),  T' = e T + T e + T T + (e+T) K (e+T),  S = 1 + K = (1 - R R)^-1
//!
//! where nothing is subtracted: each number is good to a few roundings a doubling, however thin the first layer.
//! The share absorbed is doubled likewise, and e is an exponential at every level.

use super::nodes::{Nodes, legendre};
use crate::error::{Error, Result};
use libm::{exp, expm1, sqrt};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Thickness x below which the first layer lies. A collision there is followed by another with a chance c of some
/// 25 x, most of them of light that runs level. Single scattering is exact; of double scattering a share x/mu is left
/// out, where mu is the direction in which it enters or leaves, and of the rest c.
const THIN: f64 = 1e-9;

/// What one collision does, in one azimuthal mode: rates per mean free path of the vectors u.
pub(crate) struct Scattering {
    /// Sums over the moments of either parity: their sum is scattering within the hemisphere, F, their difference
    /// scattering into the other, B.
    same: DMatrix<f64>,
    other: DMatrix<f64>,
}

impl Scattering {
    /// `moments` of the phase function from l = 0.
    pub fn new(nodes: &Nodes, albedo: f64, moments: &[f64], m: usize) -> Self {
        let n = nodes.len();
        let degree = moments.len() - 1;
        let table: Vec<Vec<f64>> = nodes.mu.iter().map(|&mu| legendre(m, degree.max(m), mu)).collect();
        let scale: Vec<f64> = nodes.mu.iter().zip(&nodes.weight).map(|(mu, w)| sqrt(w / mu)).collect();
        // Sums over the moments of one parity.
        let parity = |first: usize| {
            let orders: Vec<usize> = (first..=degree).step_by(2).collect();
            let left = DMatrix::from_fn(n, orders.len(), |i, j| scale[i] * table[i][orders[j] - m]);
            let mut right = left.clone();
            for (j, &l) in orders.iter().enumerate() {
                right.column_mut(j).scale_mut(0.5 * albedo * (2.0 * l as f64 + 1.0) * moments[l]);
            }
            left * right.transpose()
        };
        Scattering { same: parity(m), other: parity(m + 1) }
    }
}

/// A layer in which light is scattered twice at most: single scattering, and what makes double scattering of vectors.
struct Thin<'a> {
    scattering: &'a Scattering,
    direct: DVector<f64>,
    /// Light scattered once.
    reflected: DMatrix<f64>,
    scattered: DMatrix<f64>,
    /// The area over which two collisions lie, by the direction between them.
    between: DVector<f64>,
    /// Share of the layer that light from outside reaches.
    share: DVector<f64>,
}

impl<'a> Thin<'a> {
    fn new(nodes: &Nodes, scattering: &'a Scattering, x: f64) -> Self {
        let n = nodes.len();
        let rate: Vec<f64> = nodes.mu.iter().map(|mu| 1.0 / mu).collect();
        let direct = DVector::from_fn(n, |i, _| exp(-rate[i] * x));
        let (same, other) = (&scattering.same, &scattering.other);
        let reflected =
            DMatrix::from_fn(n, n, |i, j| (same[(i, j)] - other[(i, j)]) * decayed(rate[i] + rate[j], x));
        let scattered = DMatrix::from_fn(n, n, |i, j| {
            let slower = if rate[i] < rate[j] { i } else { j };
            (same[(i, j)] + other[(i, j)]) * direct[slower] * decayed((rate[i] - rate[j]).abs(), x)
        });
        // x^2, less where light does not get far.
        let between = DVector::from_fn(n, |k, _| {
            let y = rate[k] * x;
            x * x * if y < 1e-4 { 1.0 - y / 3.0 } else { 2.0 * (y + expm1(-y)) / (y * y) }
        });
        let share = DVector::from_fn(n, |i, _| if x > 0.0 { decayed(rate[i], x) / x } else { 1.0 });
        Thin { scattering, direct, reflected, scattered, between, share }
    }

    /// What becomes of light u from outside: what passes, direct light included, and what returns.
    fn pass(&self, u: &DVector<f64>) -> [DVector<f64>; 2] {
        let reached = u.component_mul(&self.share);
        let twice =
            |a: &DMatrix<f64>| (a * (a * &reached).component_mul(&self.between)).component_mul(&self.share);
        let (same, other) = (twice(&self.scattering.same), twice(&self.scattering.other));
        [
            &self.scattered * u + self.direct.component_mul(u) + &same + &other,
            &self.reflected * u + same - other,
        ]
    }
}

/// A layer's answer to light from outside.
struct Layer {
    thickness: f64,
    /// e^(-thickness/mu).
    direct: DVector<f64>,
    reflected: DMatrix<f64>,
    scattered: DMatrix<f64>,
    /// Share absorbed of a vector u, over 2 pi.
    absorbed: DVector<f64>,
}

impl Layer {
    /// A layer so thin that light is scattered twice at most.
    fn thin(nodes: &Nodes, albedo: f64, scattering: &Scattering, x: f64) -> Self {
        let Thin { direct, mut reflected, mut scattered, between, share, .. } =
            Thin::new(nodes, scattering, x);
        let n = nodes.len();
        let twice = |a: &DMatrix<f64>| {
            let mut left = a.clone();
            for (mut column, between) in left.column_iter_mut().zip(&between) {
                column *= *between;
            }
            left * a
        };
        let (same, other) = (&scattering.same, &scattering.other);
        let (same_twice, other_twice) = (twice(same), twice(other));
        for j in 0..n {
            for i in 0..n {
                let (a, b, shares) = (same_twice[(i, j)], other_twice[(i, j)], share[i] * share[j]);
                reflected[(i, j)] += (a - b) * shares;
                scattered[(i, j)] += (a + b) * shares;
            }
        }
        let weight = DVector::from_fn(n, |i, _| sqrt(nodes.weight[i] / nodes.mu[i]));
        let once = weight.component_mul(&share) * x;
        let absorbed = (once + same.tr_mul(&weight.component_mul(&between))) * (1.0 - albedo);
        Layer { thickness: x, direct, reflected, scattered, absorbed }
    }

    /// (e + T) u.
    fn transmit(&self, u: &DVector<f64>) -> DVector<f64> {
        &self.scattered * u + self.direct.component_mul(u)
    }

    /// The layer twice as thick, and K.
    fn doubled(&self, nodes: &Nodes) -> Result<(Layer, DMatrix<f64>)> {
        let (r, t) = (&self.reflected, &self.scattered);
        let bounced = bounces(r * r)?;
        let mut through = t.clone();
        for (i, e) in self.direct.iter().enumerate() {
            through[(i, i)] += e;
        }
        let up = r + r * &bounced;
        let mut scattered = &through * (&bounced * &through) + t * t;
        for (j, ej) in self.direct.iter().enumerate() {
            for (i, ei) in self.direct.iter().enumerate() {
                scattered[(i, j)] += (ei + ej) * t[(i, j)];
            }
        }
        let reflected = r + &through * (up * &through);
        // What the upper layer takes at once, and both take of the light between them.
        let between = &self.absorbed + r.tr_mul(&self.absorbed);
        let between = &between + bounced.tr_mul(&between);
        let absorbed = &self.absorbed + through.tr_mul(&between);
        let thickness = 2.0 * self.thickness;
        let direct = DVector::from_fn(nodes.len(), |i, _| exp(-thickness / nodes.mu[i]));
        Ok((Layer { thickness, direct, reflected, scattered, absorbed }, bounced))
    }
}

/// Q + Q^2 + Q^3 + ... for a symmetric Q of eigenvalues in \[0, 1).
fn bounces(q: DMatrix<f64>) -> Result<DMatrix<f64>> {
    let size = q.norm();
    if size < 0.03 {
        let (mut sum, mut power, mut left) = (q.clone(), q, size);
        while left > 0.1 * f64::EPSILON {
            sum += &power * &sum;
            left *= left;
            if left > 0.1 * f64::EPSILON {
                power = &power * &power;
            }
        }
        return Ok(sum);
    }
    let n = q.nrows();
    let rest = Cholesky::new(DMatrix::identity(n, n) - &q);
    Ok(rest.ok_or(Error::Infinite("light between two layers does not die away in f64"))?.solve(&q))
}

/// int_0^x e^(-rate y) dy.
fn decayed(rate: f64, x: f64) -> f64 {
    if rate * x == 0.0 { x } else { -expm1(-rate * x) / rate }
}

/// A slab of 2^n thin layers, with all the layers on the way.
pub(crate) struct Stack {
    pub nodes: Nodes,
    scattering: Scattering,
    layers: Vec<Layer>,
    bounced: Vec<DMatrix<f64>>,
}

impl Stack {
    /// The slab of thickness `tau`, in azimuthal mode `m`.
    pub fn new(tau: f64, albedo: f64, moments: &[f64], m: usize, nodes: Nodes) -> Result<Self> {
        let scattering = Scattering::new(&nodes, albedo, moments, m);
        let mut thickness = tau;
        let mut doublings = 0;
        while thickness > THIN {
            thickness *= 0.5;
            doublings += 1;
        }
        let mut layers = vec![Layer::thin(&nodes, albedo, &scattering, thickness)];
        let mut bounced = Vec::with_capacity(doublings);
        for level in 0..doublings {
            let (layer, between) = layers[level].doubled(&nodes)?;
            layers.push(layer);
            bounced.push(between);
        }
        Ok(Stack { nodes, scattering, layers, bounced })
    }

    /// How often the first layer was doubled.
    pub fn doublings(&self) -> usize {
        self.bounced.len()
    }

    fn whole(&self) -> &Layer {
        &self.layers[self.bounced.len()]
    }

    /// R of the slab.
    pub fn reflected(&self) -> &DMatrix<f64> {
        &self.whole().reflected
    }

    /// T of the slab, of light scattered at least once.
    pub fn scattered(&self) -> &DMatrix<f64> {
        &self.whole().scattered
    }

    /// e^(-tau/mu).
    pub fn direct(&self) -> &DVector<f64> {
        &self.whole().direct
    }

    /// Share absorbed of a vector u, over 2 pi.
    pub fn absorbed(&self) -> &DVector<f64> {
        &self.whole().absorbed
    }

    /// Light downwards and upwards at depth t, direct light included, when `top` comes in through the upper face and
    /// `bottom` through the lower one.
    pub fn field(&self, t: f64, top: DVector<f64>, bottom: DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let (mut x, mut top, mut bottom) = (t, top, bottom);
        for (layer, bounced) in self.layers.iter().zip(&self.bounced).rev() {
            let below = layer.transmit(&bottom);
            let once = layer.transmit(&top) + &layer.reflected * &below;
            let down = &once + bounced * &once;
            if x < layer.thickness {
                bottom = below + &layer.reflected * &down;
            } else {
                // Exact: x is below twice the thickness.
                x -= layer.thickness;
                top = down;
            }
        }
        let rest = (self.layers[0].thickness - x).max(0.0);
        let [above, below] = [x, rest].map(|x| Thin::new(&self.nodes, &self.scattering, x));
        let ([falling, _], [rising, _]) = (above.pass(&top), below.pass(&bottom));
        let mut down = falling.clone();
        let mut up = rising.clone();
        // To and fro between layers that return less than 1e-6: the third time is below rounding.
        for _ in 0..3 {
            let next = &falling + &above.pass(&up)[1];
            up = &rising + &below.pass(&down)[1];
            down = next;
        }
        (down, up)
    }
}
