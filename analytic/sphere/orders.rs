//! The same sphere order by order: phi_n = (w/2) K phi_(n-1), phi_0 the direct light.
//!
//! Orders of a central source are, like the whole, those of the infinite medium and what does not come back from
//! outside. In the infinite medium 4 pi r phi_n = w^n int_1^inf e^(-r x) Im (A + iB)^(n+1)/B dx, A = atanh(1/x)/x,
//! B = pi/(2x): the whole's 1/|1 - w (A + iB)|^2 expanded in w.

use super::operator::Field;
use super::point::PointSource;
use super::shells::{METHOD, Order, Shells, ULPS, missing, outside, through};
use super::source::SphereSource;
use crate::value::Value;
use libm::exp;
use nalgebra::DVector;
use std::f64::consts::PI;
use std::sync::PoisonError;

/// Highest order of a central source: the expansion of its infinite medium cancels like n!/2^n, beyond it to worse than
/// 1e-10.
pub(super) const CENTRE_ORDERS: u32 = 7;

impl Shells {
    /// Fluence at r of light scattered n >= 1 times; r > 0 for the central source.
    pub(super) fn fluence_of_order(&self, n: u32, r: f64) -> Value {
        let mut kept = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        while kept.len() <= n as usize {
            let next = self.next_order(kept.len() as u32, kept.last());
            kept.push(next);
        }
        let depth = self.operator().radius - r;
        let (before, order) = (&kept[n as usize - 1], &kept[n as usize]);
        let known = missing(&order.outside, self.albedo(), r, depth);
        let part = through(self.operator(), self.albedo(), &before.field, known, r, depth);
        let part = Value::new(part.value, part.error + order.ulps * f64::EPSILON * known.abs(), METHOD);
        match &order.point {
            Some(point) => {
                let (collided, error) = point.collided(r);
                let value = part.value + collided / r;
                Value::new(value, part.error + error / r + f64::EPSILON * value.abs(), METHOD)
            }
            None if self.source() == SphereSource::Uniform => part.scaled(1.0 / self.volume()),
            None => part,
        }
    }

    fn next_order(&self, n: u32, before: Option<&Order>) -> Order {
        let operator = self.operator();
        let (a, albedo) = (operator.radius, self.albedo());
        let zero = || DVector::zeros(operator.radii.len());
        let centre = self.source() == SphereSource::Centre;
        let Some(before) = before else {
            // Order 0: the direct light; of a central source all of it is the infinite medium's.
            let known = |r: f64, depth: f64| if centre { 0.0 } else { self.known(r, depth) };
            let values = operator.sample(known);
            let bound = operator.residual(0.0, &values, &zero(), known, ULPS);
            return Order { field: Field { values, bound }, point: None, outside: Vec::new(), ulps: 0.0 };
        };
        let (mut shells, mut ulps) = (Vec::new(), 0.0_f64);
        if centre {
            shells = outside(a, |r| match &before.point {
                None => exp(-r) / (4.0 * PI * r),
                Some(point) => {
                    let (value, error) = point.collided(r);
                    // Far out nothing is left of either.
                    if value > 0.0 && r < a + 30.0 {
                        ulps = ulps.max(error / (f64::EPSILON * value));
                    }
                    value
                }
            });
        }
        let half = 0.5 * albedo;
        let known = |r: f64, depth: f64| missing(&shells, albedo, r, depth);
        let values = operator.sample(known) + operator.apply(&before.field.values) * half;
        let residual = operator.residual(half, &values, &before.field.values, known, ULPS + ulps);
        let bound = residual + operator.apply(&before.field.bound).abs() * half;
        let point = centre.then(|| PointSource::of_order(albedo, n));
        Order { field: Field { values, bound }, point, outside: shells, ulps }
    }
}
