//! Phase functions: density, moments and samples.

use crate::support::quadrature::{integrate, legendre};
use crate::support::run::numbers;
use crate::support::verdict;
use std::f64::consts::PI;
use turbid::math::{exp, ln};
use turbid::phase::{Phase, PhaseFunction};

/// The integral over mu of 2 pi p f, where x = ln((1-mu)/(1+mu)) runs from `a` to `b`.
///
/// In x both peaks are wide: the nearest singularities of the integrand lie at a height of pi, so that 20 Gauss
/// nodes on each part of width 1 at most are exact to rounding; kinks of the density are ends of parts.
fn over(phase: &Phase, (a, b): (f64, f64), f: impl Fn(f64, f64) -> f64) -> f64 {
    let kinks = phase.kinks().into_iter().rev().map(|(m, p)| ln(m) - ln(p)).filter(|x| a < *x && *x < b);
    let mut ends: Vec<f64> = kinks.collect();
    ends.push(b);
    let mut low = a;
    let mut sum = 0.0;
    for high in ends {
        let parts = (high - low).ceil().max(1.0) as u32;
        sum += integrate(low, high, parts, |x| {
            let s = exp(x);
            let (one_minus_mu, one_plus_mu) = (2.0 * s / (1.0 + s), 2.0 / (1.0 + s));
            let slope = 2.0 * s / ((1.0 + s) * (1.0 + s));
            2.0 * PI * phase.eval(one_minus_mu, one_plus_mu) * f(one_minus_mu, one_plus_mu) * slope
        });
        low = high;
    }
    sum
}

/// How far a stated mean cosine may differ by its own rounding. That of Henyey-Greenstein is its parameter, that of
/// Rayleigh 0; others are sums of a few terms near 1.
fn rounding_of_g(phase: &Phase) -> f64 {
    match phase {
        Phase::Isotropic(_) | Phase::HenyeyGreenstein(_) | Phase::Rayleigh(_) => 0.0,
        Phase::TwoTerm(_) | Phase::Schlick(_) | Phase::Tabulated(_) | Phase::Legendre(_) => {
            32.0 * f64::EPSILON
        }
    }
}

/// Beyond 90 the integrand is below e^-90 times the peak, at most 2/(1-g)^2 = 2e18.
const ALL: (f64, f64) = (-90.0, 90.0);

/// A sum of n = 3600 terms of one sign rounds n times, each term some 20 times: (n + 20) eps/2 at most.
const ROUNDING: f64 = 3620.0 * f64::EPSILON / 2.0;

/// Normalisation, and the moments that each phase function states.
pub fn density_has_the_moments_it_states() {
    for phase in Phase::specimens() {
        let total = over(&phase, ALL, |_, _| 1.0);
        assert!((total - 1.0).abs() < ROUNDING, "{phase:?}: {total}");
        for l in 1..=6 {
            let moment = over(&phase, ALL, |m, p| legendre(l, 0.5 * (p - m)));
            assert!((moment - phase.moment(l)).abs() < 2.0 * ROUNDING, "{phase:?}, l = {l}: {moment}");
        }
        // 1 - g and 1 + g keep every digit at the peaks, and so g its sign.
        let (backward, forward) = (over(&phase, ALL, |m, _| m), over(&phase, ALL, |_, p| p));
        let g = phase.moment(1);
        let slack = rounding_of_g(&phase);
        assert!((backward - (1.0 - g)).abs() < ROUNDING * (1.0 - g) + slack, "{phase:?}: {backward}");
        assert!((forward - (1.0 + g)).abs() < ROUNDING * (1.0 + g) + slack, "{phase:?}: {forward}");
    }
}

/// The density over what lies between two samples is the difference of their numbers: density = 1 / Jacobian, in
/// integral form, from cell to cell towards both ends.
pub fn density_between_samples_is_the_step_in_u() {
    let log_ratio = |(m, p): (f64, f64)| ln(m) - ln(p);
    for phase in Phase::specimens() {
        let steps: Vec<f64> = (0..30).map(|k| exp(-f64::from(k)) * 0.5).collect();
        for pair in steps.windows(2) {
            for (low, high) in [(pair[1], pair[0]), (1.0 - pair[0], 1.0 - pair[1])] {
                // Far below the peak's width the pair near 2 moves by less than its ulp, but the other moves freely.
                let ends = (log_ratio(phase.sample(high)), log_ratio(phase.sample(low)));
                let part = over(&phase, ends, |_, _| 1.0);
                // An end carries some 16 roundings of the sampler and, as a logarithm up to 80, its own: an error
                // of 100 eps in x moves the part by at most that times p dmu/dx < u (1-u), which is of the order of the
                // step; ln and exp of up to 80 amplify by 80.
                assert!(
                    ((part - (high - low)) / (high - low)).abs() < 400.0 * f64::EPSILON,
                    "{phase:?} {low}..{high}: {part}"
                );
            }
        }
    }
}

/// First and second moments of drawn directions, sign included: a negative g sampled as isotropic and a large g clamped
/// would both fail here.
pub fn drawn_moments_are_those_stated() {
    const N: u64 = 1 << 18;
    for phase in Phase::specimens() {
        for l in [1, 2] {
            let drawn = numbers(N, 3, |stream| {
                let (m, p) = phase.sample(stream.unit());
                legendre(l, 0.5 * (p - m))
            });
            // A standard deviation of at most 1 over 2^18 values: 7.3 of 1/512 at worst. Peaks are resolved by their
            // own spread, which is heavy-tailed beyond |g| = 0.99: those have the exact tests above.
            if phase.moment(1).abs() < 0.99 && phase.moment(2).abs() < 0.99 {
                verdict::agrees(&format!("{phase:?}, P_{l}"), &drawn, (phase.moment(l), 0.0), 0.015, 3);
            }
        }
    }
}
