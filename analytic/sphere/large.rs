//! Large spheres by discrete ordinates, with half as many directions beside them.

use super::chord;
use super::first_flight::transmittance_and_loss;
use super::ordinates::{Modes, Ordinates};
use super::point::PointSource;
use super::source::SphereSource;
use crate::error::{Error, Result};
use crate::value::Value;
use libm::{exp, expm1, log2};
use std::f64::consts::PI;

const METHOD: &str = "discrete ordinates, two orders";

/// Directions to a panel.
const ORDERS: [usize; 2] = [20, 14];

/// Roundings of one answer: sums over some 300 modes of both signs, and their fit.
const ULPS: f64 = 256.0;

/// Depth below which nothing seen from outside comes: e^(-60) of a fluence that rises by less than e^15.
const SEEN: f64 = 60.0;

/// Depth of the first comparison of the two orders.
const SKIN: f64 = 1e-9;

/// One order's answer to the two problems of light from outside and from everywhere inside, and to the asked one.
struct Order {
    slab: Ordinates,
    field: Modes,
    /// Mean over the volume under incidence, at the centre under incidence and with unit density.
    mean: f64,
    centre: f64,
    glow: f64,
    glow_mean: f64,
}

pub(super) struct Large {
    a: f64,
    albedo: f64,
    source: SphereSource,
    orders: Vec<Order>,
    point: PointSource,
    /// Relative differences of the two orders at depths that double.
    spread: Vec<f64>,
    pub(super) escape: Value,
    pub(super) absorptance: Value,
}

impl Large {
    /// # Arguments
    /// `albedo` above 0
    pub(super) fn new(a: f64, albedo: f64, source: SphereSource) -> Result<Self> {
        const SINGULAR: Error = Error::Infinite("the sphere's equations are singular in f64");
        let point = PointSource::new(albedo);
        let mut orders = Vec::new();
        for order in ORDERS {
            let slab = Ordinates::new(a, albedo, order);
            let lit = slab.incident().ok_or(SINGULAR)?;
            let glowing = slab.uniform().ok_or(SINGULAR)?;
            let (mean, centre) = (slab.mean(&lit), slab.fluence(&lit, 0.0));
            let (glow, glow_mean) = (slab.fluence(&glowing, 0.0), slab.mean(&glowing));
            let field = match source {
                SphereSource::Uniform => glowing,
                SphereSource::Incident => lit,
                SphereSource::Centre => slab.lit(|mu| point.owed(albedo, a, mu)).ok_or(SINGULAR)?,
            };
            orders.push(Order { slab, field, mean, centre, glow, glow_mean });
        }
        let of = |pick: &dyn Fn(&Order) -> f64| {
            let (best, rough) = (pick(&orders[0]), pick(&orders[1]));
            Value::new(best, 2.0 * (best - rough).abs() + ULPS * f64::EPSILON * best.abs(), METHOD)
        };
        // L_uniform = <phi_incident>/4, A_uniform = (1-w) <phi_uniform>; at the centre the same without the mean.
        let (escape, absorptance) = match source {
            SphereSource::Uniform => (of(&|o| 0.25 * o.mean), of(&|o| o.glow_mean).scaled(1.0 - albedo)),
            SphereSource::Centre => (of(&|o| 0.25 * o.centre), of(&|o| o.glow).scaled(1.0 - albedo)),
            SphereSource::Incident => {
                let absorbed = of(&|o| 0.25 * o.mean).scaled(4.0 * a / 3.0 * (1.0 - albedo));
                let left = (1.0 - absorbed.value).max(transmittance_and_loss(a).0);
                (Value::new(left, absorbed.error + f64::EPSILON, METHOD), absorbed)
            }
        };
        let mut large = Large { a, albedo, source, orders, point, spread: Vec::new(), escape, absorptance };
        large.spread = large.measure();
        Ok(large)
    }

    /// Relative differences of the two orders at depths 2^i times the first.
    fn measure(&self) -> Vec<f64> {
        let mut spread = Vec::new();
        let mut depth = SKIN;
        while depth < 2.0 * self.a {
            let (best, rough) = self.orders_at((self.a - depth).max(0.0));
            spread.push(if best == 0.0 { 0.0 } else { (best - rough).abs() / best.abs() });
            depth *= 2.0;
        }
        spread
    }

    fn orders_at(&self, r: f64) -> (f64, f64) {
        let at = |o: &Order| o.slab.fluence(&o.field, r);
        (at(&self.orders[0]), at(&self.orders[1]))
    }

    /// The modes' part of the fluence.
    fn smooth(&self, r: f64) -> (f64, f64) {
        let (best, rough) = self.orders_at(r);
        // Two doublings of depth either way: a difference may vanish by chance at one point.
        let place = log2(((self.a - r) / SKIN).max(1.0)) as usize;
        let near = &self.spread[place.saturating_sub(1).min(self.spread.len() - 1)..];
        let spread = near.iter().take(4).fold(0.0, |m: f64, s| m.max(*s));
        let relative = 2.0 * spread + ULPS * f64::EPSILON;
        (best, 2.0 * (best - rough).abs() + relative * best.abs() + f64::MIN_POSITIVE)
    }

    /// Fluence at r, all light; r > 0 for the central source.
    pub(super) fn fluence(&self, r: f64) -> Value {
        let (value, error) = self.smooth(r);
        let smooth = Value::new(value, error, METHOD);
        match self.source {
            SphereSource::Uniform => smooth.scaled(1.0 / self.volume()),
            SphereSource::Incident => smooth,
            SphereSource::Centre => {
                let (collided, bound) = self.point.collided_within(self.a, r);
                let direct = exp(-r) / (4.0 * PI * r * r);
                let whole = direct + collided / r;
                let rounding = f64::EPSILON * (ULPS + r.min(745.0)) * whole;
                Value::new(value + whole, error + bound / r + rounding + f64::MIN_POSITIVE, METHOD)
            }
        }
    }

    fn volume(&self) -> f64 {
        4.0 * PI / 3.0 * self.a * self.a * self.a
    }

    /// Radiance that leaves with cosine mu; the direct light of a central source apart.
    pub(super) fn exit_radiance(&self, mu: f64) -> Value {
        let chord = 2.0 * self.a * mu;
        let (value, error) = chord::gather_skin(self.a, mu, SEEN, &|r| self.smooth(r));
        let rounding = |v: f64| ULPS * f64::EPSILON * v + f64::MIN_POSITIVE;
        let per_steradian = self.albedo / (4.0 * PI);
        let total = |known: f64, bound: f64| {
            let value = known + per_steradian * value;
            Value::new(value, bound + per_steradian * error + rounding(value.abs()), METHOD)
        };
        match self.source {
            SphereSource::Uniform => {
                let emitted = -expm1(-chord) / (4.0 * PI);
                total(emitted, rounding(emitted)).scaled(1.0 / self.volume())
            }
            SphereSource::Incident => {
                let crossed = exp(-chord) / PI;
                total(crossed, rounding(crossed) + chord.min(745.0) * f64::EPSILON * crossed)
            }
            SphereSource::Centre => {
                let (whole, bound) =
                    chord::gather_point(self.a, mu, &|r| self.point.collided_within(self.a, r));
                total(per_steradian * whole, per_steradian * bound)
            }
        }
    }
}
