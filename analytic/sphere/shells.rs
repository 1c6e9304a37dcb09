//! The sphere by its integral equation.

use super::chord;
use super::first_flight::{first_flight, mean_escape, shells, transmittance_and_loss};
use super::operator::{Field, ShellOperator};
use super::point::{self, PointSource};
use super::source::SphereSource;
use crate::error::{Error, Result};
use crate::quadrature::GAUSS_24;
use crate::value::Value;
use libm::{exp, expm1};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

pub(super) const METHOD: &str = "integral equation, residual bound";

/// Roundings of the closed forms and sums in one answer.
pub(super) const ULPS: f64 = 48.0;

/// A shell outside: its radius, its height over the surface, its weight times the infinite medium's fluence.
pub(super) struct Outside {
    r: f64,
    height: f64,
    weight: f64,
}

/// The central source's two parts: the infinite medium, and what it lacks because nothing returns from outside.
struct Centre {
    point: PointSource,
    outside: Vec<Outside>,
}

/// One order: its polynomial, and of a central source the infinite medium's part.
pub(super) struct Order {
    pub field: Field,
    pub point: Option<PointSource>,
    /// Shells outside that sent nothing back into this order, and the roundings of their sums.
    pub outside: Vec<Outside>,
    pub ulps: f64,
}

pub(super) struct Shells {
    operator: Arc<ShellOperator>,
    albedo: f64,
    source: SphereSource,
    field: Field,
    centre: Option<Centre>,
    pub(super) orders: Mutex<Vec<Order>>,
    pub(super) escape: Value,
    pub(super) absorptance: Value,
}

impl Shells {
    pub(super) fn new(operator: Arc<ShellOperator>, albedo: f64, source: SphereSource) -> Result<Self> {
        const SINGULAR: Error = Error::Infinite("the sphere's equations are singular in f64");
        let a = operator.radius;
        let factors = operator.factor(albedo);
        let solve = |f: &dyn Fn(f64, f64) -> f64, ulps: f64| {
            operator.solve(albedo, factors.as_ref(), f, ulps).ok_or(SINGULAR)
        };
        let uniform = |r: f64, depth: f64| first_flight(a, r, depth).1;
        let incident = |r: f64, depth: f64| 4.0 * first_flight(a, r, depth).0;
        let mut centre = None;
        let (field, escape, absorptance);
        match source {
            SphereSource::Uniform => {
                field = solve(&uniform, ULPS)?;
                // P = P_0 + w <phi P>, A = (1 - w) <phi>, means over the volume.
                let mean = |f: &dyn Fn(f64, f64) -> f64| mean_of(&operator, &field, f);
                let collided = mean(&|r, depth| first_flight(a, r, depth).0).scaled(albedo);
                let direct = Value::rounded(mean_escape(a).0, ULPS, METHOD);
                escape = direct.plus(collided, METHOD);
                absorptance = mean(&|_, _| 1.0).scaled(1.0 - albedo);
            }
            SphereSource::Incident => {
                field = solve(&incident, ULPS)?;
                // Over the incident power 4 pi a^2: A = (1 - w) int phi dV, and w int phi P dV leaves beside the light
                // that crosses.
                let mean = |f: &dyn Fn(f64, f64) -> f64| mean_of(&operator, &field, f).scaled(a / 3.0);
                absorptance = mean(&|_, _| 1.0).scaled(1.0 - albedo);
                let collided = mean(&|r, depth| first_flight(a, r, depth).0).scaled(albedo);
                escape = Value::rounded(transmittance_and_loss(a).0, ULPS, METHOD).plus(collided, METHOD);
            }
            SphereSource::Centre => {
                let (lit, glowing) = (solve(&incident, ULPS)?, solve(&uniform, ULPS)?);
                // Reciprocity: light from the centre leaves as light from outside arrives there.
                let at_centre = |field: &Field, known: f64| through(&operator, albedo, field, known, 0.0, a);
                escape = at_centre(&lit, incident(0.0, a)).scaled(0.25);
                absorptance = at_centre(&glowing, uniform(0.0, a)).scaled(1.0 - albedo);
                let point = PointSource::new(albedo);
                let parts = Centre { outside: outside(a, |r| point.total(r)), point };
                field = solve(&|r, depth| missing(&parts.outside, albedo, r, depth), ULPS + point::ULPS)?;
                centre = Some(parts);
            }
        }
        Ok(Shells { operator, albedo, source, field, centre, orders: Mutex::default(), escape, absorptance })
    }

    pub(super) fn albedo(&self) -> f64 {
        self.albedo
    }

    pub(super) fn source(&self) -> SphereSource {
        self.source
    }

    pub(super) fn operator(&self) -> &Arc<ShellOperator> {
        &self.operator
    }

    /// Fluence at r, all light; r > 0 for the central source.
    pub(super) fn fluence(&self, r: f64) -> Value {
        let depth = self.operator.radius - r;
        let known = self.known(r, depth);
        self.finish(r, through(&self.operator, self.albedo, &self.field, known, r, depth))
    }

    pub(super) fn fluence_interpolated(&self, r: f64) -> Value {
        let (value, bound) = self.operator.interpolate(&self.field, self.operator.radius - r);
        self.finish(r, Value::new(value, bound + ULPS * f64::EPSILON * value.abs(), METHOD))
    }

    /// The known part of the equation.
    pub(super) fn known(&self, r: f64, depth: f64) -> f64 {
        let a = self.operator.radius;
        match (&self.centre, self.source) {
            (Some(centre), _) => missing(&centre.outside, self.albedo, r, depth),
            (None, SphereSource::Incident) => 4.0 * first_flight(a, r, depth).0,
            (None, _) => first_flight(a, r, depth).1,
        }
    }

    /// Adds the infinite medium (centre), divides by the volume (uniform).
    fn finish(&self, r: f64, value: Value) -> Value {
        match (&self.centre, self.source) {
            (Some(centre), _) => {
                let (collided, error) = centre.point.collided(r);
                let direct = exp(-r) / (4.0 * PI * r * r);
                let whole = direct + collided / r;
                let rounding = f64::EPSILON * ((ULPS + r.min(745.0)) * direct + ULPS * (collided / r).abs());
                Value::new(
                    value.value + whole,
                    value.error + error / r + rounding + f64::MIN_POSITIVE,
                    METHOD,
                )
            }
            (None, SphereSource::Uniform) => value.scaled(1.0 / self.volume()),
            (None, _) => value,
        }
    }

    pub(super) fn volume(&self) -> f64 {
        let a = self.operator.radius;
        4.0 * PI / 3.0 * a * a * a
    }

    /// Radiance that leaves with cosine mu > 0 to the outward normal; the direct light of a central source apart.
    pub(super) fn exit_radiance(&self, mu: f64) -> Value {
        let a = self.operator.radius;
        let chord = 2.0 * a * mu;
        let exact = |r: f64, depth: f64| {
            let known = self.known(r, depth);
            let v = through(&self.operator, self.albedo, &self.field, known, r, depth);
            (v.value, v.error)
        };
        let (value, error) = chord::gather(&self.operator, &self.field, mu, &exact);
        let rounding = |v: f64| ULPS * f64::EPSILON * v + f64::MIN_POSITIVE;
        let collided = Value::new(value, error + rounding(value.abs()), METHOD);
        let per_steradian = self.albedo / (4.0 * PI);
        match (&self.centre, self.source) {
            (Some(centre), _) => {
                let (whole, bound) = chord::gather_point(a, mu, &|r| centre.point.collided(r));
                let whole = Value::new(whole, bound, METHOD);
                whole.plus(collided, METHOD).scaled(per_steradian)
            }
            (None, SphereSource::Uniform) => {
                let emitted = -expm1(-chord);
                let emitted = Value::new(emitted, rounding(emitted), METHOD);
                emitted
                    .scaled(1.0 / (4.0 * PI))
                    .plus(collided.scaled(per_steradian), METHOD)
                    .scaled(1.0 / self.volume())
            }
            (None, _) => {
                let crossed = exp(-chord) / PI;
                let crossed = Value::new(
                    crossed,
                    rounding(crossed) + chord.min(745.0) * f64::EPSILON * crossed,
                    METHOD,
                );
                crossed.plus(collided.scaled(per_steradian), METHOD)
            }
        }
    }
}

/// -(w/2) int_a^inf (r'/r) \[E_1(r'-r) - E_1(r'+r)\] phi_inf(r') dr': the light that does not come back.
pub(super) fn missing(outside: &[Outside], albedo: f64, r: f64, depth: f64) -> f64 {
    let sum: f64 = outside.iter().map(|o| o.weight * shells(r, o.r, depth + o.height)).sum();
    -0.5 * albedo * sum
}

/// Gauss nodes over the surface. The kernel's logarithm lies at or below the surface: on panels \[h, 6h\] it is
/// integrated to 2.4^-48. `field` is r phi(r).
pub(super) fn outside(a: f64, mut field: impl FnMut(f64) -> f64) -> Vec<Outside> {
    const GROWTH: f64 = 6.0;
    // What lies below 1e-17 of a mean free path or of the radius weighs 40 times that.
    let mut edge = 1e-17 * a.min(1.0);
    let mut nodes = Vec::new();
    // E_1(64) is 1e-30 of E_1 at the surface.
    while edge < 64.0 {
        let next = if edge < 1.0 { (GROWTH * edge).min(1.0) } else { 2.0 * edge };
        for (x, w) in GAUSS_24.nodes.iter().zip(&GAUSS_24.weights) {
            let height = edge + (next - edge) * x;
            let r = a + height;
            nodes.push(Outside { r, height, weight: w * (next - edge) * field(r) / r });
        }
        edge = next;
    }
    nodes
}

/// known + (w/2) (K f)(r), with what the bound of f makes of it.
pub(super) fn through(
    operator: &ShellOperator,
    albedo: f64,
    field: &Field,
    known: f64,
    r: f64,
    depth: f64,
) -> Value {
    let half = 0.5 * albedo;
    let (mut image, mut absolute, mut bound) = (0.0, 0.0, 0.0);
    if albedo > 0.0 {
        let row = operator.row(r, depth);
        image = half * row.dot(&field.values);
        absolute = (half * row.dot(&field.values.abs())).abs();
        bound = half * row.dot(&field.bound);
    }
    let rounding = f64::EPSILON * ((ULPS + point::ULPS + depth.min(745.0)) * known.abs() + ULPS * absolute);
    Value::new(
        known + image,
        bound.abs() + operator.row_defect * absolute + rounding + f64::MIN_POSITIVE,
        METHOD,
    )
}

/// Mean of f g over the volume.
fn mean_of(operator: &ShellOperator, field: &Field, g: &dyn Fn(f64, f64) -> f64) -> Value {
    let a = operator.radius;
    let scale = 3.0 / (a * a * a);
    let value = scale * operator.integrate(&field.values, g);
    let error = scale * operator.integrate(&field.bound, g);
    Value::new(value, error + ULPS * f64::EPSILON * value + f64::MIN_POSITIVE, METHOD)
}
