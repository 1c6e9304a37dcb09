//! Phase functions: sampler against density, normalisation, signed moments, both ends, every digit.

use crate::checks::phase;
use crate::common::config as properties;
use crate::support::double::Double;
use crate::support::{unit_vector, verdict};
use proptest::prelude::*;
use turbid::math::{Asymmetry, FOUR_PI, cosine_pair, exp};
use turbid::phase::{HenyeyGreenstein, Phase, PhaseFunction};
use turbid::rng::{Purpose, Stream};

/// 0, the smallest number, the smallest and the largest that a stream can give.
const ENDS: [f64; 4] = [0.0, f64::MIN_POSITIVE, 1.0 / 9_007_199_254_740_992.0, 1.0 - f64::EPSILON / 2.0];

#[test]
fn density_is_normalised_and_has_the_moments_it_states() {
    phase::density_has_the_moments_it_states();
}

#[test]
fn density_between_samples_is_the_step_in_u() {
    phase::density_between_samples_is_the_step_in_u();
}

#[test]
fn samples_at_both_ends_are_directions() {
    for phase in Phase::specimens() {
        for u in ENDS {
            let (m, p) = phase.sample(u);
            assert!((0.0..=2.0).contains(&m) && (0.0..=2.0).contains(&p), "{phase:?}, u = {u}: {m}, {p}");
            assert!((m + p - 2.0).abs() <= 8.0 * f64::EPSILON, "{phase:?}, u = {u}: {m} + {p}");
            let density = phase.eval(m, p);
            assert!(density.is_finite() && density > 0.0, "{phase:?}, u = {u}: {density}");
        }
        assert_eq!(phase.sample(0.0).1, 0.0);
    }
}

/// The pair in 106 bits, by the same identity: 1 - mu = 2 (1-u) (1-g)^2 (1+gu) / (1-g+2gu)^2, and its mirror image.
fn exact_pair(g: f64, u: f64) -> (Double, Double) {
    let [one, two, g, u] = [1.0, 2.0, g, u].map(Double::from);
    let d = one - g + two * g * u;
    let (back, front) = ((one - g) / d, (one + g) / d);
    let one_minus_mu = two * (one - u) * back * back * (one + g * u);
    let one_plus_mu = two * u * front * front * ((one - g) + g * u);
    (one_minus_mu, one_plus_mu)
}

/// The textbook's inversion: mu = (1 + g^2 - ((1-g^2)/(1-g+2gu))^2) / (2g).
fn textbook_mu(g: f64, u: f64) -> Double {
    let [one, two, g, u] = [1.0, 2.0, g, u].map(Double::from);
    let s = (one - g * g) / (one - g + two * g * u);
    (one + g * g - s * s) / (two * g)
}

fn asymmetry() -> impl Strategy<Value = f64> {
    let size = prop_oneof![
        0.0..1.0f64,
        (0.0..27.0f64).prop_map(|x| exp(-x)),
        (0.0..20.7f64).prop_map(|x| 1.0 - exp(-x)),
    ];
    (size, any::<bool>()).prop_map(|(g, negative)| if negative { -g } else { g })
}

fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..1.0f64,
        // A double-double needs its second half to be a normal number too: 1e-282 and up.
        (0.0..650.0f64).prop_map(|x| exp(-x)),
        (0.0..36.0f64).prop_map(|x| 1.0 - exp(-x)),
        prop::sample::select(&[0.0, ENDS[2], ENDS[3]][..]),
    ]
}

proptest! {
    #![proptest_config(properties(20_000))]

    /// The identity behind the pair is the textbook's formula, to the 32 digits less what the textbook cancels.
    #[test]
    fn the_pair_is_the_textbook_inversion(size in 0.05..0.95f64, negative: bool, u in 0.0..1.0f64) {
        let g = if negative { -size } else { size };
        let (m, p) = exact_pair(g, u);
        let mu = textbook_mu(g, u);
        prop_assert!((Double::from(1.0) - mu - m).0.abs() < 1e-26 && (Double::from(1.0) + mu - p).0.abs() < 1e-26);
    }

    /// Both members of the sampled pair hold every digit: relative error below 1e-15 for all g and u.
    #[test]
    fn sampled_pair_holds_every_digit(g in asymmetry(), u in unit()) {
        let phase = HenyeyGreenstein::new(Asymmetry::try_from(g).unwrap());
        let (m, p) = phase.sample(u);
        let (exact_m, exact_p) = exact_pair(g, u);
        prop_assert!(exact_m.relative_error_of(m) < 1e-15, "{m}, {exact_m:?}");
        prop_assert!(u == 0.0 && p == 0.0 || exact_p.relative_error_of(p) < 1e-15, "{p}, {exact_p:?}");
    }

    /// The density against 106 bits: 12 roundings, the root halves those under it, so below 1.5e-15.
    #[test]
    fn density_holds_every_digit(g in asymmetry(), u in unit()) {
        let phase = HenyeyGreenstein::new(Asymmetry::try_from(g).unwrap());
        let (m, p) = phase.sample(u);
        let [one, two, dg, four_pi] = [1.0, 2.0, g, FOUR_PI].map(Double::from);
        let d = if g >= 0.0 {
            (one - dg) * (one - dg) + two * dg * Double::from(m)
        } else {
            (one + dg) * (one + dg) - two * dg * Double::from(p)
        };
        let exact = (one - dg) * (one + dg) / (four_pi * d * d.sqrt());
        prop_assert!(exact.relative_error_of(phase.eval(m, p)) < 1.5e-15);
    }

    /// A scattered direction makes the sampled angle with the one before, to the rounding of its coordinates.
    #[test]
    fn scattering_keeps_the_angle(g in asymmetry(), u in unit(), v in 0.0..1.0f64, z in -1.0..=1.0f64, azimuth in 0.0..6.3f64) {
        let phase = Phase::with_asymmetry(Asymmetry::try_from(g).unwrap());
        let dir = unit_vector(z, azimuth);
        let out = phase.scatter(dir, [u, v]);
        prop_assert!((out.length() - 1.0).abs() <= 2.0 * f64::EPSILON);
        // sqrt(2 (1-mu)) is the distance of the tips: the six coordinates round a few times each.
        let ((m, p), (m_out, p_out)) = (phase.sample(u), cosine_pair(dir, out));
        prop_assert!(((2.0 * m).sqrt() - (2.0 * m_out).sqrt()).abs() < 16.0 * f64::EPSILON, "{m} {m_out}");
        prop_assert!(((2.0 * p).sqrt() - (2.0 * p_out).sqrt()).abs() < 16.0 * f64::EPSILON, "{p} {p_out}");
    }
}

/// Stream, sampler and density together: the cumulated density of the samples is uniform. The negative control is drawn
/// with g wrong by 0.005.
#[test]
fn samples_of_a_stream_follow_the_density() {
    const N: u64 = 1 << 20;
    let draw = |g: f64, seed: u64| -> Vec<f64> {
        let phase = Phase::with_asymmetry(Asymmetry::try_from(g).unwrap());
        let mu = |(m, p): (f64, f64)| 0.5 * (p - m);
        (0..N).map(|i| mu(phase.sample(Stream::new(seed, Purpose::Synthetic, 0, i).unit()))).collect()
    };
    // Cumulated from -1: (1-g^2)/(2g) (1/sqrt(1+g^2-2g mu) - 1/(1+g)).
    let cdf = |g: f64| {
        move |mu: f64| {
            (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 + g * g - 2.0 * g * mu).sqrt() - 1.0 / (1.0 + g))
        }
    };
    for (seed, g) in [(1, -0.75), (2, 0.3), (3, 0.75), (4, 0.95)] {
        verdict::fits(&format!("g = {g}"), verdict::cumulated(&draw(g, seed), cdf(g)), 5e-3, seed);
        let control = verdict::cumulated(&draw(g + 0.005, seed), cdf(g));
        verdict::misfits(&format!("g = {g}, drawn with 0.005 more"), control, seed);
    }
}

#[test]
fn drawn_moments_are_those_stated() {
    phase::drawn_moments_are_those_stated();
}
