//! Radiance of scattered light at any depth, direction and azimuth.
//!
//! With theta the angle from the beam's direction, I = I_1 + I_2 + sum_m cos(m dphi) I_m: light scattered once has a
//! closed form in the phase function itself; light scattered twice is an integral over the direction in between, of
//! two values of the phase function and a closed form for the two depths; only light scattered three times and more
//! is a series in azimuth, from modes of order m, to which a moment chi_m contributes by its third power. Along the
//! ray the source of every mode is integrated analytically.
//!
//! Where the peak of the phase function had to be cut off (moments beyond l = 148 that count), light scattered twice
//! belongs to the series too.

use super::medium::{AnisotropicMedium, Azimuth, Twice};
use super::ray::two_collisions;
use super::rounding;
use super::solution::{Solution, Sum};
use crate::error::Result;
use crate::incidence::Incidence;
use crate::phase::Phase;
use crate::slab_single::beam_path;
use libm::{cos, sin};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// A series ends where LAST terms in a row are below SMALL of the sum; what is left out is at most TAIL times the
/// largest of them: terms fall at least as the third power of 0.95 from one order to the next.
const SMALL: f64 = 1e-11;
const LAST: usize = 4;
const TAIL: f64 = 8.0;

/// Solutions of one slab by azimuth, solved when first asked for.
pub(super) struct Orders {
    solutions: [Vec<OnceLock<Result<Solution>>>; 2],
}

/// What is asked: depth, signed cosine, azimuth, of a beam at mu0.
#[derive(Clone, Copy)]
pub(super) struct Query {
    pub t: f64,
    pub mu: f64,
    pub dphi: f64,
    pub mu0: f64,
}

fn sine(c: f64) -> f64 {
    ((1.0 - c) * (1.0 + c)).sqrt()
}

/// One minus and one plus the cosine between (x, azimuth) and (y, 0), both as sums of squares.
fn deflection(x: f64, y: f64, azimuth: f64) -> (f64, f64) {
    let (s, r) = (sine(x), sine(y));
    let lateral = if s + r > 0.0 { (x - y) * (x + y) / (s + r) } else { 0.0 };
    let chord =
        |normal: f64, turn: f64| 0.5 * (lateral * lateral + 4.0 * s * r * turn * turn + normal * normal);
    (chord(x - y, sin(0.5 * azimuth)), chord(x + y, cos(0.5 * azimuth)))
}

/// Light scattered once \[1/sr\].
fn once(phase: &Phase, albedo: f64, tau: f64, q: Query) -> f64 {
    let (minus, plus) = deflection(q.mu, -q.mu0, q.dphi);
    albedo * phase.value_of(minus, plus) * beam_path(tau, q.mu0, q.t, q.mu)
}

/// Light scattered twice \[1/sr\].
fn twice(phase: &Phase, albedo: f64, tau: f64, q: Query, rule: &Twice) -> f64 {
    let turns: Vec<(f64, f64)> = (0..rule.turns)
        .map(|i| {
            let azimuth = 2.0 * PI * i as f64 / rule.turns as f64;
            (cos(azimuth), cos(azimuth - q.dphi))
        })
        .collect();
    let (s, s0) = (sine(q.mu), sine(q.mu0));
    let mut sum = 0.0;
    for (&between, &weight) in rule.nodes.mu.iter().zip(&rule.nodes.weight) {
        let paths = two_collisions(tau, q.mu0, between, q.t, q.mu);
        let r = sine(between);
        for (path, x) in paths.into_iter().zip([between, -between]) {
            if path == 0.0 {
                continue;
            }
            let density = |cosine: f64| phase.value(cosine.clamp(-1.0, 1.0));
            let pairs: f64 = turns
                .iter()
                .map(|&(from, to)| density(s0 * r * from - q.mu0 * x) * density(s * r * to + q.mu * x))
                .sum();
            sum += weight * path * pairs;
        }
    }
    albedo * albedo * sum * 2.0 * PI / rule.turns as f64
}

impl Orders {
    pub fn new(azimuth: &Azimuth) -> Self {
        let row = |set: usize| (0..=azimuth.degree(set)).map(|_| OnceLock::new()).collect();
        Orders { solutions: [row(0), row(1)] }
    }

    fn solution(&self, azimuth: &Azimuth, set: usize, order: usize, tau: f64, mu0: f64) -> Result<&Solution> {
        self.solutions[set][order]
            .get_or_init(|| {
                let modes = azimuth.modes(set, order)?;
                let stretch = modes.scattering.stretch;
                Solution::new(tau * stretch, Incidence::Beam { mu0 }, modes)
            })
            .as_ref()
            .map_err(Clone::clone)
    }

    /// Radiance under a beam, and its bound.
    pub fn beam(&self, medium: &AnisotropicMedium, tau: f64, q: Query) -> Result<(f64, f64)> {
        let (phase, albedo, azimuth) = (medium.phase(), medium.albedo(), medium.azimuth());
        let mut closed = [0.0; 2];
        let mut paths: [(usize, Vec<[f64; 2]>); 2] = Default::default();
        for (set, closed) in closed.iter_mut().enumerate() {
            let modes = azimuth.modes(set, 0)?;
            let stretch = modes.scattering.stretch;
            let scaled = Query { t: q.t * stretch, ..q };
            *closed = once(phase, albedo / stretch, tau * stretch, scaled);
            if let Some(rules) = &azimuth.twice {
                *closed += twice(phase, albedo, tau, q, &rules[set]);
            }
        }
        let turning = sine(q.mu) * sine(q.mu0) > 0.0;
        let last = if turning { azimuth.degree(0) } else { 0 };
        let mut sum = Sum { value: closed[0], magnitude: closed[0] };
        // Differences of the terms, all of one sign, so that none hides another.
        let mut difference = (closed[0] - closed[1]).abs();
        let (mut small, mut tail) = (0, 0.0_f64);
        for order in 0..=last {
            let mut terms = [Sum::ZERO; 2];
            for (set, term) in terms.iter_mut().enumerate() {
                if order > azimuth.degree(set) {
                    continue;
                }
                let solution = self.solution(azimuth, set, order, tau, q.mu0)?;
                let source = solution.modes.source(q.mu.abs());
                let t = q.t * solution.modes.scattering.stretch;
                *term = if q.mu == 0.0 {
                    solution.along_horizon(t, &source)
                } else {
                    solution.last_scattered(t, q.mu, &source)
                };
                if azimuth.twice.is_some() {
                    let nodes = &solution.modes.nodes;
                    // Orders with as many nodes have the same ones.
                    if paths[set].0 != nodes.len() {
                        let path = |&mu: &f64| two_collisions(tau, q.mu0, mu, q.t, q.mu);
                        paths[set] = (nodes.len(), nodes.mu.iter().map(path).collect());
                    }
                    let twice = solution.modes.twice(q.mu0, q.mu, &paths[set].1);
                    *term = term.plus(-twice, twice.abs());
                }
            }
            let [fine, coarse] = terms;
            let value = fine.value * cos(order as f64 * q.dphi);
            sum = sum.plus(value, fine.magnitude);
            difference += (fine.value - coarse.value).abs();
            if fine.value.abs().max(coarse.value.abs()) <= SMALL * sum.value.abs() {
                (small, tail) = (small + 1, tail.max(fine.value.abs()));
            } else {
                (small, tail) = (0, 0.0);
            }
            if small == LAST {
                break;
            }
        }
        Ok((sum.value, 2.0 * difference + TAIL * tail + rounding(sum)))
    }
}
