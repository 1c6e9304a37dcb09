//! What leaves the faces, by integrals over the way and over direction.
//!
//! In a thin or weakly scattering slab differences of amplitudes of order 1 leave R no better than rounding over tau.
//! Here R is the flux of what is scattered once, 2 pi w int p(mu, -mu0) \[1 - e^(-tau/mu - tau/mu0)\] mu/(mu + mu0) dmu,
//! p the azimuthal mean of the whole phase function, and of what the modes scatter last, an integral of a source that
//! is known relative to itself over the thickness. Of a phase function whose peak was cut off, what is scattered once
//! is put right in every slab: beyond the peak it obeys the whole phase function (Nakajima and Tanaka 1988).

use super::medium::AnisotropicMedium;
use super::nodes::legendre;
use super::scattering::Scattering;
use super::solution::{Solution, Sum, colliding};
use crate::incidence::Incidence;
use crate::quadrature::GaussLegendre;
use crate::slab_single::beam_path;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Panels of nodes grow by this factor from a tenth of the thickness up to TOP, above which the moments turn.
const RATIO: f64 = 3.0;
const TOP: f64 = 0.05;

/// Beyond this thickness transmission is no small part of what is scattered.
const THICK: f64 = 0.1;

/// Cosines and weights on \[0, 1\], for light that varies on the scale of `tau` at the horizon and has moments up to
/// `degree`, more or fewer by `size`.
fn directions(tau: f64, degree: usize, size: f64) -> Vec<(f64, f64)> {
    let count = |least: f64, per: f64| GaussLegendre::rule((size * (least + per * degree as f64)) as usize);
    let (many, few) = (count(40.0, 0.6), count(12.0, 0.04));
    let mut all = vec![];
    let mut panel = |rule: &GaussLegendre, low: f64, high: f64| {
        let width = high - low;
        all.extend(rule.nodes.iter().zip(&rule.weights).map(|(x, w)| (low + width * x, width * w)));
    };
    panel(&many, TOP, 1.0);
    let mut high = TOP;
    let least = (0.1 * tau).min(1e-5);
    while high > 0.0 {
        let low = if high > least { high / RATIO } else { 0.0 };
        panel(&few, low, high);
        high = low;
    }
    all
}

/// int f(mu) dmu by a rule.
fn over(rule: &[(f64, f64)], mut f: impl FnMut(f64) -> f64) -> f64 {
    rule.iter().map(|&(mu, weight)| weight * f(mu)).sum()
}

/// Fraction of a beam at `mu0` that leaves one face after one scattering, in the slab that `solution` sees, with the
/// whole phase function.
fn once(medium: &AnisotropicMedium, solution: &Solution, mu0: f64, face: Face, size: f64) -> f64 {
    let degree = medium.phase().degree(1e-6, 2000);
    let scattered = medium.albedo() / solution.modes.scattering.stretch;
    let (t, sign) = face.at(solution.tau);
    over(&directions(solution.tau, degree, size), |mu| {
        let phase = medium.phase().azimuthal_mean(sign * mu, -mu0);
        2.0 * PI * scattered * mu * phase * beam_path(solution.tau, mu0, t, sign * mu)
    })
}

/// How many directions do, relative to [`directions`]: of the moments of a peak the last few hundred are so small that
/// light in them need not be followed.
pub(super) fn enough(solution: &Solution) -> f64 {
    if solution.modes.scattering.degree() > 600 { 0.7 } else { 1.0 }
}

#[derive(Clone, Copy)]
enum Face {
    Lit,
    Far,
}

impl Face {
    /// Depth, and the sign of the cosines that leave there.
    fn at(self, tau: f64) -> (f64, f64) {
        match self {
            Face::Lit => (0.0, 1.0),
            Face::Far => (tau, -1.0),
        }
    }
}

/// What reflection gains where light scattered once sees the whole phase function and not its moments up to a degree.
pub(super) fn gain(medium: &AnisotropicMedium, solution: &Solution, size: f64) -> f64 {
    let scattering: &Scattering = &solution.modes.scattering;
    if scattering.stretch == 1.0 {
        return 0.0;
    }
    let (tau, degree) = (solution.tau.min(1e6), scattering.degree());
    let rule = directions(tau, degree, size);
    let table = |mu: &[(f64, f64)]| {
        DMatrix::from_columns(
            &mu.iter().map(|&(mu, _)| DVector::from_vec(legendre(0, degree, mu))).collect::<Vec<_>>(),
        )
    };
    let lit = match solution.incidence {
        Incidence::Beam { mu0 } => vec![(mu0, 1.0)],
        Incidence::Diffuse => rule.iter().map(|&(mu0, weight)| (mu0, 2.0 * mu0 * weight)).collect(),
    };
    let mut lit_table = table(&lit);
    for (l, mut row) in lit_table.row_iter_mut().enumerate() {
        let parity = if l % 2 == 0 { 1.0 } else { -1.0 };
        row *= parity * (2 * l + 1) as f64 * scattering.moments[l] / (4.0 * PI);
    }
    let cut = table(&rule).transpose() * lit_table;
    let whole = medium.albedo() / scattering.stretch;
    let [from, to] = [&lit, &rule].map(|list| list.iter().map(|&(mu, _)| mu).collect::<Vec<_>>());
    let means = medium.phase().azimuthal_means(&to, &from.iter().map(|mu0| -mu0).collect::<Vec<_>>());
    let mut sum = 0.0;
    for (j, &(mu0, share)) in lit.iter().enumerate() {
        for (i, &(mu, weight)) in rule.iter().enumerate() {
            let more = whole * means[(i, j)] - scattering.albedo * cut[(i, j)];
            sum += share * weight * 2.0 * PI * mu * more * beam_path(tau, mu0, 0.0, mu);
        }
    }
    sum
}

/// R, diffuse T and A of both solutions, each relative to itself.
pub(super) fn fluxes(
    medium: &AnisotropicMedium,
    tau: f64,
    incidence: Incidence,
    solutions: &[Solution; 2],
) -> [[Sum; 2]; 3] {
    let leaving = |set: usize, face: Face| {
        let solution = &solutions[set];
        let size = enough(solution) * [1.0, 0.8][set];
        let first = match incidence {
            Incidence::Beam { mu0 } => once(medium, solution, mu0, face, size),
            Incidence::Diffuse => gain(medium, solution, size),
        };
        let (t, sign) = face.at(solution.tau);
        let mut magnitude = first.abs();
        let rule = directions(solution.tau, solution.modes.scattering.degree(), size);
        let rest: f64 = rule
            .iter()
            .map(|&(mu, weight)| {
                let source = solution.modes.source(mu);
                let sum = solution.last_scattered(t, sign * mu, &source).scaled(2.0 * PI * mu * weight);
                magnitude += sum.magnitude;
                sum.value
            })
            .sum();
        Sum { value: first + rest, magnitude }
    };
    let reflected: [Sum; 2] = std::array::from_fn(|set| leaving(set, Face::Lit));
    let absorbed = solutions.each_ref().map(Solution::absorptance);
    let whole = solutions.iter().all(|solution| solution.modes.scattering.stretch == 1.0);
    let transmitted = std::array::from_fn(|set| {
        if tau == f64::INFINITY {
            return Sum::ZERO;
        }
        if whole {
            return leaving(set, Face::Far);
        }
        if tau > THICK {
            return solutions[set].transmittance_scattered(tau);
        }
        // What collides, less what leaves above and what is absorbed: at the first collision a part 1 - w of it, so
        // that w of it is left, with all its digits, and what was cut off as straight on.
        let solution = &solutions[set];
        let (first, whole) = (solution.first_collisions(), colliding(incidence, tau));
        let scattered = (whole - first) + solution.modes.scattering.albedo * first;
        let (r, a) = (reflected[set], solution.absorbed_later());
        Sum { value: scattered - r.value - a.value, magnitude: scattered + r.magnitude + a.magnitude }
    });
    [reflected, transmitted, absorbed]
}
