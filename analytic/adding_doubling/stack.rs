//! A homogeneous layer doubled again and again, and the way back down to any depth.
//!
//! Light is a vector u = root(mu weight) I over the nodes, I the radiance in one azimuthal mode. A layer has a
//! reflection R, a transmission e + T of direct and of scattered light, all symmetric, and two of them make
//!
//! R' = R + (e+T) R S (e+T),  T' = e T + T e + T T + (e+T) K (e+T),  S = 1 + K = (1 - R R)^-1
//!
//! where nothing is subtracted: each number is good to a few roundings a doubling, however thin the first layer.
//! The length that light spends in the layer, its fluence over depth, is doubled likewise, and e is an exponential at
//! every level. By reciprocity that length is also what leaves the layer of light that starts evenly within it.

use super::nodes::{Nodes, legendre};
use crate::error::{Error, Result};
use libm::{exp, expm1, sqrt};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::PI;

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

    /// Integral over depth of the fluence that a vector u brings, over 2 pi.
    fn dwelt(&self, nodes: &Nodes, x: f64) -> DVector<f64> {
        let weight = DVector::from_fn(nodes.len(), |i, _| sqrt(nodes.weight[i] / nodes.mu[i]));
        let once = weight.component_mul(&self.share) * x;
        once + self.scattering.same.tr_mul(&weight.component_mul(&self.between))
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
pub(crate) struct Layer {
    thickness: f64,
    /// e^(-thickness/mu).
    pub direct: DVector<f64>,
    /// R, and T of light scattered at least once.
    pub reflected: DMatrix<f64>,
    pub scattered: DMatrix<f64>,
    /// Integral over depth of the fluence that a vector u brings, over 2 pi; over 4 pi it is the vector that leaves
    /// through either face of light that starts evenly within the layer, one per area and mean free path.
    pub dwelt: DVector<f64>,
    /// Integral over depth of the fluence of that light.
    pub own: f64,
}

impl Layer {
    /// A layer so thin that light is scattered twice at most.
    fn thin(nodes: &Nodes, albedo: f64, scattering: &Scattering, x: f64) -> Self {
        let thin = Thin::new(nodes, scattering, x);
        let dwelt = thin.dwelt(nodes, x);
        let Thin { direct, mut reflected, mut scattered, between, share, .. } = thin;
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
        // Half the light starts up; a share of it collides, and starts again.
        let once: f64 = (0..nodes.count).map(|i| 0.5 * nodes.weight[i] / nodes.mu[i] * between[i]).sum();
        let own = once + albedo * once * once / x;
        Layer { thickness: x, direct, reflected, scattered, dwelt, own }
    }

    /// (e + T) u.
    pub fn transmit(&self, u: &DVector<f64>) -> DVector<f64> {
        &self.scattered * u + self.direct.component_mul(u)
    }

    /// e + T.
    pub fn through(&self) -> DMatrix<f64> {
        let mut through = self.scattered.clone();
        for (i, e) in self.direct.iter().enumerate() {
            through[(i, i)] += e;
        }
        through
    }

    /// The layer twice as thick, and K.
    fn doubled(&self, nodes: &Nodes) -> Result<(Layer, DMatrix<f64>)> {
        let (r, t) = (&self.reflected, &self.scattered);
        let bounced = bounces(r * r, true)?;
        let through = self.through();
        let up = r + r * &bounced;
        let mut scattered = &through * (&bounced * &through) + t * t;
        for (j, ej) in self.direct.iter().enumerate() {
            for (i, ei) in self.direct.iter().enumerate() {
                scattered[(i, j)] += (ei + ej) * t[(i, j)];
            }
        }
        let reflected = r + &through * (up * &through);
        // In the upper layer at once, and in both of the light between them.
        let between = &self.dwelt + r.tr_mul(&self.dwelt);
        let between = &between + bounced.tr_mul(&between);
        let dwelt = &self.dwelt + through.tr_mul(&between);
        // What starts in one half goes to and fro as well: a vector dwelt/(4 pi) leaves it.
        let own = 2.0 * self.own + self.dwelt.dot(&between);
        let thickness = 2.0 * self.thickness;
        let direct = DVector::from_fn(nodes.len(), |i, _| exp(-thickness / nodes.mu[i]));
        Ok((Layer { thickness, direct, reflected, scattered, dwelt, own }, bounced))
    }
}

/// Q + Q^2 + Q^3 + ... for a Q of eigenvalues in \[0, 1).
pub(crate) fn bounces(q: DMatrix<f64>, symmetric: bool) -> Result<DMatrix<f64>> {
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
    let rest = DMatrix::identity(n, n) - &q;
    let sum = if symmetric { Cholesky::new(rest).map(|rest| rest.solve(&q)) } else { rest.lu().solve(&q) };
    sum.ok_or(Error::Infinite("light between two layers does not die away in f64"))
}

/// int_0^x e^(-rate y) dy.
fn decayed(rate: f64, x: f64) -> f64 {
    if rate * x == 0.0 { x } else { -expm1(-rate * x) / rate }
}

/// A slab of 2^n thin layers, with all the layers on the way.
pub(crate) struct Stack {
    pub nodes: Nodes,
    albedo: f64,
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
        Ok(Stack { nodes, albedo, scattering, layers, bounced })
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

    /// The slab without the layers on the way.
    pub fn into_whole(mut self) -> Layer {
        self.layers.swap_remove(self.bounced.len())
    }

    /// Share absorbed of a vector u, over 2 pi.
    pub fn absorbed(&self) -> DVector<f64> {
        &self.whole().dwelt * (1.0 - self.albedo)
    }

    /// Light downwards and upwards at depth t, direct light included, when `top` comes in through the upper face and
    /// `bottom` through the lower one.
    pub fn field(&self, t: f64, top: DVector<f64>, bottom: DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        self.field_of(t, top, bottom, 0.0)
    }

    /// [`Self::field`] when `started` per area and mean free path starts within the slab, evenly and in all directions.
    pub fn field_of(
        &self,
        t: f64,
        top: DVector<f64>,
        bottom: DVector<f64>,
        started: f64,
    ) -> (DVector<f64>, DVector<f64>) {
        let (mut x, mut top, mut bottom) = (t, top, bottom);
        let started = started / (4.0 * PI);
        let begin = |mut u: DVector<f64>, dwelt: &DVector<f64>| {
            if started > 0.0 {
                u.axpy(started, dwelt, 1.0);
            }
            u
        };
        for (layer, bounced) in self.layers.iter().zip(&self.bounced).rev() {
            let below = begin(layer.transmit(&bottom), &layer.dwelt);
            let once = begin(layer.transmit(&top) + &layer.reflected * &below, &layer.dwelt);
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
        let falling = begin(falling, &above.dwelt(&self.nodes, x));
        let rising = begin(rising, &below.dwelt(&self.nodes, rest));
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
