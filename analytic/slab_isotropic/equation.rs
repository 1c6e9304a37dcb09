//! What the whole light and each of its orders share: the source, and what a polynomial misses of the equation.

use crate::beer_lambert::direct_fluence;
use crate::incidence::Incidence;
use crate::peierls::{Halves, NODES, Operator};
use crate::slab_single::beam_through_e1;
use crate::value::Value;

pub(super) const METHOD: &str = "Peierls equation, residual bound";

/// Roundings of the closed forms and sums in one answer.
pub(super) const ULPS: f64 = 16.0;

/// The fluence of one order, as a polynomial, with its bound.
#[derive(Debug, Clone)]
pub(super) struct Iterate {
    pub values: Halves,
    pub bound: Halves,
}

/// The known part of the equation for the polynomial: once scattered light (beam), direct light (diffuse).
pub(super) fn source(albedo: f64, incidence: Incidence, t: f64, rest: f64) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => 0.5 * albedo * beam_through_e1(mu0, t, rest),
        Incidence::Diffuse => direct_fluence(incidence, t),
    }
}

/// Per panel: twice the largest defect met between the polynomial and what it stands for, plus rounding.
pub(super) fn residual(
    operator: &Operator,
    f: &Halves,
    at_nodes: Option<&Halves>,
    exact: impl Fn(usize) -> (f64, f64),
) -> Halves {
    let mesh = &operator.mesh;
    let count = mesh.panels();
    let probes: Vec<(f64, f64)> = (0..operator.probes.len()).map(&exact).collect();
    let global = operator.row_defect * f.largest();
    let side = |values: &[f64], defects: Option<&[f64]>, pick: fn(&(f64, f64)) -> f64| {
        let mut out = Vec::with_capacity(values.len());
        for p in 0..count {
            let range = p * NODES..(p + 1) * NODES;
            let largest = values[range.clone()].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            let mut worst = 0.0_f64;
            for (i, xi) in [(2 * p, 0.0), (2 * p + 1, 0.5), (2 * p + 2, 1.0)] {
                worst = worst.max((pick(&probes[i]) - mesh.interpolate(values, p, xi)).abs());
            }
            if let Some(defects) = defects {
                worst = defects[range].iter().fold(worst, |a, b| a.max(b.abs()));
            }
            let (start, length) = mesh.panel(p);
            // A coordinate has an error of a rounding of its distance from the face, seen on the scale of the panel.
            let rounding = f64::EPSILON * (ULPS + 2.0 * (start + length) / length) * largest;
            out.extend(std::iter::repeat_n(2.0 * worst + rounding + global, NODES));
        }
        out
    };
    Halves {
        upper: side(&f.upper, at_nodes.map(|d| d.upper.as_slice()), |p| p.0),
        lower: side(&f.lower, at_nodes.map(|d| d.lower.as_slice()), |p| p.1),
    }
}

/// (albedo/2) int f kernel dt plus what is known apart.
pub(super) fn flux_of(
    operator: &Operator,
    albedo: f64,
    f: &Halves,
    bound: &Halves,
    first: Value,
    kernel: impl Fn(f64, f64) -> f64,
) -> Value {
    let half = 0.5 * albedo;
    let value = half * operator.mesh.integrate(f, &kernel);
    let error = half * operator.mesh.integrate(bound, &kernel);
    let total = first.value + value;
    Value::new(total, first.error + error + ULPS * f64::EPSILON * total + f64::MIN_POSITIVE, METHOD)
}
