//! What a field holds on a sphere of radius s about a point, as far as the sphere lies inside a body.
//!
//! On the directions w of a sphere every body here is an intersection of half-spaces: a flat face cuts s w.e, and
//! |x + s w|^2 <= a^2 is linear in w as well. Rings about an axis are cut into arcs, whose ends are known.

use super::rule::{Rule, pieces};
use crate::error::Error;
use libm::{acos, asin, cos, sin};
use std::cell::Cell;
use std::f64::consts::PI;

/// A field by what it depends on.
#[derive(Clone, Copy)]
pub(super) enum Field<'a> {
    /// 1 everywhere.
    Uniform,
    /// Of z in bodies with parallel faces, of the distance from the centre in a sphere.
    Symmetric(&'a dyn Fn(f64) -> f64),
    /// Of the place.
    Any(&'a dyn Fn([f64; 3]) -> f64),
}

/// A field, and the first number from it that cannot be used.
pub(super) struct CheckedField<'a> {
    pub(super) field: Field<'a>,
    pub(super) may_be_negative: bool,
    fault: Cell<Option<(f64, f64)>>,
}

impl<'a> CheckedField<'a> {
    pub(super) fn new(field: Field<'a>, may_be_negative: bool) -> Self {
        CheckedField { field, may_be_negative, fault: Cell::new(None) }
    }

    fn pass(&self, value: f64, at: f64) -> f64 {
        if value.is_finite() && (self.may_be_negative || value >= 0.0) {
            return value;
        }
        if self.fault.get().is_none() {
            self.fault.set(Some((value, at)));
        }
        0.0
    }

    pub(super) fn verdict(&self) -> crate::error::Result<()> {
        match self.fault.get() {
            None => Ok(()),
            Some((value, _)) if value.is_finite() => {
                Err(Error::OutOfRange { name: "field", value, allowed: "0 or more" })
            }
            Some((value, at)) => Err(Error::NotFinite { name: "field", value, at }),
        }
    }
}

/// The integrals over one shell, times s^2: of f, f c, 1, c, c^2, with c the cosine to the inward normal.
pub(super) const F0: usize = 0;
pub(super) const F1: usize = 1;
pub(super) const U0: usize = 2;
pub(super) const U1: usize = 3;
pub(super) const U2: usize = 4;
pub(super) type Sums = [f64; 5];

/// Low and high ends along x, y and z.
pub(super) type Ends = [(f64, f64); 3];

/// A body seen from a centre.
#[derive(Clone, Copy)]
pub(super) enum Region {
    /// Between the planes `ends`, which lie at `low` and `high` from the centre along the axes in their `order`.
    Box { ends: Ends, order: [usize; 3], low: [f64; 3], high: [f64; 3] },
    /// A ball; the centre of the shells lies at `distance` from its own along the polar axis.
    Ball { radius: f64, distance: f64 },
}

/// Shells about one centre.
pub(super) struct Shells {
    /// Two axes, and the polar one.
    axes: [[f64; 3]; 3],
    /// 1 if the polar axis points inwards, -1 outwards.
    sign: f64,
    centre: [f64; 3],
    region: Region,
}

impl Shells {
    /// Shells in a ball about the origin, the centre on the polar axis.
    pub(super) fn new(polar: [f64; 3], sign: f64, region: Region) -> Self {
        let distance = if let Region::Ball { distance, .. } = region { distance } else { 0.0 };
        // The axis least along the polar one, made perpendicular to it.
        let least = if polar[0].abs() <= polar[1].abs().min(polar[2].abs()) {
            0
        } else if polar[1].abs() <= polar[2].abs() {
            1
        } else {
            2
        };
        let mut u = polar.map(|p| -polar[least] * p);
        u[least] += 1.0;
        let length = u.iter().fold(0.0, |length, x| libm::hypot(length, *x));
        let u = u.map(|x| x / length);
        let v = [
            polar[1] * u[2] - polar[2] * u[1],
            polar[2] * u[0] - polar[0] * u[2],
            polar[0] * u[1] - polar[1] * u[0],
        ];
        Shells { axes: [u, v, polar], sign, centre: polar.map(|p| distance * p), region }
    }

    /// Shells among planes, the polar axis along one of the coordinate axes.
    pub(super) fn in_box(centre: [f64; 3], axis: usize, sign: f64, ends: Ends) -> Self {
        let order = [(axis + 1) % 3, (axis + 2) % 3, axis];
        let unit = |i: usize| {
            let mut e = [0.0; 3];
            e[i] = 1.0;
            e
        };
        let low = order.map(|i| ends[i].0 - centre[i]);
        let high = order.map(|i| ends[i].1 - centre[i]);
        Shells { axes: order.map(unit), sign, centre, region: Region::Box { ends, order, low, high } }
    }

    /// Radii up to `end` between which the integrals are smooth: distances to faces, edges and corners.
    pub(super) fn radii(&self, end: f64) -> Vec<f64> {
        let between = match self.region {
            Region::Ball { radius, distance } => vec![(radius - distance).abs(), radius + distance],
            Region::Box { low, high, .. } => {
                let choices = |i: usize| [0.0, low[i] * low[i], high[i] * high[i]];
                let mut all = Vec::with_capacity(27);
                for x in choices(0) {
                    for y in choices(1) {
                        all.extend(choices(2).map(|z| (x + y + z).sqrt()));
                    }
                }
                all
            }
        };
        pieces(0.0, end, between)
    }

    /// The integrals over the part of the shell of radius s inside the body.
    pub(super) fn sums(&self, s: f64, rule: &Rule, asked: &CheckedField) -> Sums {
        let mut sums = [0.0; 5];
        let ends = match self.cosines(s) {
            Some(ends) => ends,
            None => return sums,
        };
        for pair in ends.windows(2) {
            for (c, w) in rule.on(pair[0], pair[1]) {
                let (held, arc) = self.ring(s, c, rule, asked);
                let inward = self.sign * c;
                sums[F0] += w * held;
                sums[F1] += w * held * inward;
                sums[U0] += w * arc;
                sums[U1] += w * arc * inward;
                sums[U2] += w * arc * c * c;
            }
        }
        sums.map(|sum| s * s * sum)
    }

    /// Cosines to the polar axis between which rings inside the body change smoothly.
    fn cosines(&self, s: f64) -> Option<Vec<f64>> {
        let (low, high, between) = match self.region {
            Region::Ball { radius, distance } => {
                let above = (radius - distance) * (radius + distance) - s * s;
                let below = 2.0 * distance * s;
                let bound = if above >= below {
                    1.0
                } else if above <= -below {
                    -1.0
                } else {
                    above / below
                };
                (-1.0, bound, Vec::new())
            }
            Region::Box { low, high, .. } => {
                let mut between = Vec::new();
                let choices = |i: usize| [0.0, low[i] * low[i], high[i] * high[i]];
                for x in choices(0) {
                    for y in choices(1) {
                        let square = (x + y) / (s * s);
                        if square > 0.0 && square < 1.0 {
                            let c = (1.0 - square).sqrt();
                            between.extend([-c, c]);
                        }
                    }
                }
                ((low[2] / s).clamp(-1.0, 1.0), (high[2] / s).clamp(-1.0, 1.0), between)
            }
        };
        (low < high).then(|| pieces(low, high, between))
    }

    /// The integral of the field over the ring's arcs inside the body, and their length in radians.
    fn ring(&self, s: f64, c: f64, rule: &Rule, asked: &CheckedField) -> (f64, f64) {
        let rho = s * ((1.0 - c) * (1.0 + c)).max(0.0).sqrt();
        let arcs = match self.region {
            Region::Ball { .. } => Arcs::whole(),
            Region::Box { low, high, .. } => Arcs::new(rho, [low[0], low[1]], [high[0], high[1]]),
        };
        let length = arcs.length();
        let held = match asked.field {
            Field::Uniform => length,
            Field::Symmetric(f) => {
                let x = match self.region {
                    Region::Box { low, high, .. } => (s * c - low[2]).clamp(0.0, high[2] - low[2]),
                    Region::Ball { radius, distance } => {
                        let across = (distance - s) * (distance - s) + 2.0 * distance * s * (1.0 + c);
                        across.max(0.0).sqrt().min(radius)
                    }
                };
                length * asked.pass(f(x), x)
            }
            Field::Any(f) => arcs.integrate(rule, |phi| {
                let y = self.point(rho * cos(phi), rho * sin(phi), s * c);
                asked.pass(f(y), s)
            }),
        };
        (held, length)
    }

    /// A point of the body, roundings beyond its faces taken back.
    fn point(&self, u: f64, v: f64, w: f64) -> [f64; 3] {
        match self.region {
            Region::Box { ends, order, .. } => {
                let mut y = self.centre;
                for (i, offset) in order.into_iter().zip([u, v, w]) {
                    y[i] = (y[i] + offset).clamp(ends[i].0, ends[i].1);
                }
                y
            }
            Region::Ball { radius, .. } => {
                let [a, b, p] = self.axes;
                let mut y = [0.0; 3];
                for (i, slot) in y.iter_mut().enumerate() {
                    *slot = self.centre[i] + u * a[i] + v * b[i] + w * p[i];
                }
                let length = y.iter().fold(0.0, |length, x| libm::hypot(length, *x));
                if length > radius { y.map(|x| x * (radius / length)) } else { y }
            }
        }
    }
}

/// The arcs of a circle of radius rho inside a rectangle.
struct Arcs {
    ends: [f64; 10],
    count: usize,
    low: [f64; 2],
    high: [f64; 2],
    rho: f64,
}

impl Arcs {
    fn whole() -> Self {
        Arcs { ends: [0.0; 10], count: 0, low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2], rho: 0.0 }
    }

    fn new(rho: f64, low: [f64; 2], high: [f64; 2]) -> Self {
        let mut arcs = Arcs { ends: [0.0; 10], count: 0, low, high, rho };
        for (i, bounds) in [[low[0], high[0]], [low[1], high[1]]].into_iter().enumerate() {
            for bound in bounds {
                if bound.abs() < rho {
                    let (first, second) = if i == 0 {
                        let angle = acos(bound / rho);
                        (angle, 2.0 * PI - angle)
                    } else {
                        let angle = asin(bound / rho);
                        (if angle < 0.0 { angle + 2.0 * PI } else { angle }, PI - angle)
                    };
                    arcs.ends[arcs.count] = first;
                    arcs.ends[arcs.count + 1] = second;
                    arcs.count += 2;
                }
            }
        }
        arcs.ends[..arcs.count].sort_by(f64::total_cmp);
        if arcs.count > 0 {
            arcs.ends[arcs.count] = arcs.ends[0] + 2.0 * PI;
        }
        arcs
    }

    fn holds(&self, phi: f64) -> bool {
        let (x, y) = (self.rho * cos(phi), self.rho * sin(phi));
        x >= self.low[0] && x <= self.high[0] && y >= self.low[1] && y <= self.high[1]
    }

    /// Arcs inside, each by its two ends.
    fn inside(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..self.count)
            .map(|i| (self.ends[i], self.ends[i + 1]))
            .filter(|(from, to)| to > from && self.holds(0.5 * (from + to)))
    }

    fn length(&self) -> f64 {
        if self.count == 0 {
            return if self.holds(0.0) { 2.0 * PI } else { 0.0 };
        }
        self.inside().map(|(from, to)| to - from).sum()
    }

    fn integrate(&self, rule: &Rule, f: impl Fn(f64) -> f64) -> f64 {
        if self.count == 0 {
            if !self.holds(0.0) {
                return 0.0;
            }
            // Equal steps around a whole circle.
            let steps = 2 * rule.order();
            let step = 2.0 * PI / steps as f64;
            return step * (0..steps).map(|i| f(step * (i as f64 + 0.5))).sum::<f64>();
        }
        self.inside().map(|(from, to)| rule.integrate(from, to, &f)).sum()
    }
}
