//! Radiance of scattered light at any depth, direction and azimuth.
//!
//! With theta the angle from the beam's direction, I = I_1 + I_2 + sum_m cos(m dphi) I_m: light scattered once has a
//! closed form in the phase function itself; light scattered twice is an integral over the direction in between, of
//! two values of the phase function and a closed form for the two depths; only light scattered three times and more
//! is a series in azimuth, from modes of order m, to which a moment chi_m contributes by its third power. Along the
//! ray the source of every mode is integrated analytically.
//!
//! Where the peak of the phase function had to be cut off, a fraction f straight on, all this holds in the medium
//! that is left, with p - f delta for the whole phase function: what is scattered twice loses the light that goes
//! straight on at either collision.

use super::medium::{AnisotropicMedium, Azimuth, Twice};
use super::ray::two_collisions;
use super::scattering::Scattering;
use super::solution::{Solution, Sum, rounding};
use crate::error::Result;
use crate::incidence::Incidence;
use crate::phase::Phase;
use crate::slab_single::beam_path;
use libm::{cos, sin};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// A series ends where LAST terms in a row are small beside the sum; what is left out is at most TAIL times the
/// largest of them: terms fall at least as the third power of 0.95 from one order to the next.
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

/// Light scattered twice \[1/sr\], of what is not straight on.
fn twice(phase: &Phase, scattering: &Scattering, albedo: f64, tau: f64, q: Query, rule: &Twice) -> f64 {
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
    sum *= 2.0 * PI / rule.turns as f64;
    if scattering.peak > 0.0 {
        let (minus, plus) = deflection(q.mu, -q.mu0, q.dphi);
        let first = two_collisions(tau, q.mu0, q.mu0, q.t, q.mu)[1];
        // At the horizon nothing goes straight on but the source itself.
        let second = if q.mu == 0.0 {
            beam_path(tau, q.mu0, q.t, 0.0)
        } else {
            two_collisions(tau, q.mu0, q.mu.abs(), q.t, q.mu)[usize::from(q.mu < 0.0)]
        };
        sum -= scattering.peak * phase.value_of(minus, plus) * (first + second);
    }
    albedo * albedo * sum
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
        let azimuth = medium.azimuth();
        let turning = sine(q.mu) * sine(q.mu0) > 0.0;
        let last = if turning { azimuth.degree(0) } else { 0 };
        // What a cut leaves open swings with the last moment: a quarter of a turn farther on it is not zero too.
        let modes = azimuth.modes(0, 0)?;
        // The source of light scattered twice and more is a fluence.
        let open = modes.nodes.open_fluence(tau);
        let (cut, modes) = (modes.scattering.peak > 0.0, modes.nodes.len());
        let beside = Query { dphi: q.dphi + 0.5 * PI / (azimuth.degree(0) + 1) as f64, ..q };
        let places = if cut && turning { vec![q, beside] } else { vec![q] };
        let mut totals = Vec::with_capacity(places.len());
        for place in &places {
            totals.push([closed(medium, tau, 0, *place)?, closed(medium, tau, 1, *place)?]);
        }
        let mut sum = Sum { value: totals[0][0], magnitude: totals[0][0].abs() };
        let mut paths = Default::default();
        let mut difference = (totals[0][0] - totals[0][1]).abs();
        let (mut small, mut tail) = (0, 0.0_f64);
        for order in 0..=last {
            let fine = self.term(azimuth, 0, order, tau, q, &mut paths)?;
            let coarse = self.term(azimuth, 1, order, tau, q, &mut paths)?;
            for (total, place) in totals.iter_mut().zip(&places) {
                let turn = cos(order as f64 * place.dphi);
                total[0] += fine.value * turn;
                total[1] += coarse.value * turn;
            }
            // Differences of the terms, all of one sign, so that none hides another.
            difference += (fine.value - coarse.value).abs();
            sum = Sum { value: totals[0][0], magnitude: sum.magnitude + fine.magnitude };
            let largest = fine.value.abs().max(coarse.value.abs());
            (small, tail) = if largest <= azimuth.small * sum.value.abs() {
                (small + 1, tail.max(largest))
            } else {
                (0, 0.0)
            };
            if small == LAST {
                break;
            }
        }
        if cut {
            // The two sets cut off different peaks: their terms differ, and only sums can be compared.
            difference = totals.iter().fold(0.0, |a: f64, [fine, coarse]| a.max((fine - coarse).abs()));
        }
        Ok((sum.value, 2.0 * difference + TAIL * tail + open * sum.value.abs() + rounding(sum, modes)))
    }

    /// The term of the series for one order of azimuth, on one set of nodes.
    fn term(
        &self,
        azimuth: &Azimuth,
        set: usize,
        order: usize,
        tau: f64,
        q: Query,
        paths: &mut [(usize, Vec<[f64; 2]>); 2],
    ) -> Result<Sum> {
        if order > azimuth.degree(set) {
            return Ok(Sum::ZERO);
        }
        let solution = self.solution(azimuth, set, order, tau, q.mu0)?;
        let source = solution.modes.source(q.mu.abs());
        let stretch = solution.modes.scattering.stretch;
        let t = q.t * stretch;
        let scattered = if q.mu == 0.0 {
            solution.along_horizon(t, &source)
        } else {
            solution.last_scattered(t, q.mu, &source)
        };
        if azimuth.twice.is_none() {
            return Ok(scattered);
        }
        let nodes = &solution.modes.nodes;
        // Orders with as many nodes have the same ones.
        if paths[set].0 != nodes.len() {
            let path = |&mu: &f64| two_collisions(tau * stretch, q.mu0, mu, t, q.mu);
            paths[set] = (nodes.len(), nodes.mu.iter().map(path).collect());
        }
        let twice = solution.modes.twice(q.mu0, q.mu, &paths[set].1);
        Ok(scattered.plus(-twice, twice.abs()))
    }
}

/// Light scattered once and twice, as the medium of one set has it.
fn closed(medium: &AnisotropicMedium, tau: f64, set: usize, q: Query) -> Result<f64> {
    let azimuth = medium.azimuth();
    let scattering = azimuth.modes(set, 0)?.scattering.clone();
    let (tau, albedo) = (tau * scattering.stretch, medium.albedo() / scattering.stretch);
    let q = Query { t: q.t * scattering.stretch, ..q };
    let first = once(medium.phase(), albedo, tau, q);
    let second = match &azimuth.twice {
        Some(rules) => twice(medium.phase(), &scattering, albedo, tau, q, &rules[set]),
        None => 0.0,
    };
    Ok(first + second)
}
