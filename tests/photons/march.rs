//! The march through a photon map, against closed forms.

use crate::common::ALPHA;
use crate::support::run::histories;
use crate::support::scenes::homogeneous;
use crate::support::verdict;
use glam::DVec3;
use libm::{exp, expm1, sinh};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::{March, StepRule, along};
use turbid::math::{Asymmetry, FOUR_PI, Interval, Positive, Ray};
use turbid::medium::{Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::rng::{Purpose, Stream};
use turbid::stats::{Moments, smallest_detectable_bias, t_test};

/// Radiance along a ray from x = -3, of a source from x = 0 on, by equal steps.
fn marched(
    sigma_t: Spectrum,
    length: f64,
    step: f64,
    rule: StepRule,
    source: impl Fn(f64) -> f64,
) -> Spectrum {
    let span = Interval { start: 3.0, end: 3.0 + length };
    let equal = March::equal(Positive::new("the step", step).unwrap(), rule);
    let ray = Ray::new(-3.0 * DVec3::X, DVec3::X);
    let medium = homogeneous(sigma_t, Spectrum::ZERO, 0.0);
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    along(&medium, (&ray, span), &equal, 1e3, &mut stream, |place| Spectrum::grey(source(place.x)))
}

fn by_steps(length: f64, sigma_t: f64, step: f64, rule: StepRule, source: impl Fn(f64) -> f64) -> f64 {
    marched(Spectrum::grey(sigma_t), length, step, rule, source)[0]
}

/// A constant source, from thin to thick steps: what each rule makes of it in closed form.
#[test]
fn a_constant_source() {
    for sigma_t in [1e-9, 0.1, 1.0, 30.0] {
        for step in [0.01, 0.5, 2.0] {
            let (length, x) = (4.0, sigma_t * step);
            let exact = -expm1(-sigma_t * length) / sigma_t;
            for (rule, factor) in [
                (StepRule::NearEnd, x / -expm1(-x)),
                (StepRule::Middle, 0.5 * x / sinh(0.5 * x)),
                (StepRule::Integrated, 1.0),
            ] {
                let found = by_steps(length, sigma_t, step, rule, |_| 1.0);
                // Some hundred products and sums; the march ends where less than 1e-9 passes.
                let rounding = if sigma_t * length < 20.0 { 2e-13 } else { 1e-9 };
                let error = found / (exact * factor) - 1.0;
                assert!(error.abs() < rounding, "{rule:?} {sigma_t} {step}: {error:e}");
            }
        }
    }
}

/// q = e^(-b t): exact is (1 - e^(-(1+b) L))/(1+b). Halving the step halves the error of the rule of 1998 and quarters
/// that of the others, up to the next order, a part in the number of steps.
#[test]
fn orders_in_the_step() {
    let (length, b) = (2.0, 0.7);
    let exact = -expm1(-(1.0 + b) * length) / (1.0 + b);
    for (rule, order) in [(StepRule::NearEnd, 2.0), (StepRule::Middle, 4.0), (StepRule::Integrated, 4.0)] {
        let error = |step| by_steps(length, 1.0, step, rule, |t| exp(-b * t)) - exact;
        assert!((error(0.01) / error(0.005) / order - 1.0).abs() < 0.01, "{rule:?}");
    }
    // The sums in closed form, geometric series, at one coarse step.
    let (dx, n) = (0.5, 4.0);
    let series = expm1(-(1.0 + b) * dx * n) / expm1(-(1.0 + b) * dx);
    let near = by_steps(length, 1.0, dx, StepRule::NearEnd, |t| exp(-b * t));
    assert!((near - dx * series).abs() < 1e-15);
    let middle = by_steps(length, 1.0, dx, StepRule::Middle, |t| exp(-b * t));
    assert!((middle - dx * exp(-0.5 * (1.0 + b) * dx) * series).abs() < 1e-15);
    let integrated = by_steps(length, 1.0, dx, StepRule::Integrated, |t| exp(-b * t));
    assert!((integrated + expm1(-dx) * exp(-0.5 * b * dx) * series).abs() < 1e-15);
}

#[test]
fn steps_divide_the_stretch() {
    let count = |length: f64, step: f64| {
        let calls = std::cell::Cell::new(0);
        by_steps(length, 1.0, step, StepRule::Middle, |_| {
            calls.set(calls.get() + 1);
            1.0
        });
        calls.get()
    };
    // Whole numbers of steps, one that rounding puts above it, a remainder, a step longer than the stretch, no stretch.
    assert_eq!(
        [count(2.0, 0.05), count(0.3, 0.1), count(1.0, 0.3), count(0.1, 5.0), count(0.0, 0.1)],
        [40, 3, 4, 1, 0]
    );
    assert_eq!(by_steps(0.0, 1.0, 0.1, StepRule::NearEnd, |_| 1.0), 0.0);
    let clear = marched(Spectrum::rgb(0.0, 1.0, 2.0), 1.0, 0.5, StepRule::Integrated, |_| 1.0);
    assert!((clear[0] - 1.0).abs() < 1e-15 && (clear[2] - 0.5 * -expm1(-2.0)).abs() < 1e-15);
}

/// A uniform map of isotropic photons: any phase function scatters density/(4 pi) x albedo into every direction, and
/// each rule makes of that what it makes of a constant source. 128 maps; sees one per cent, and so the factor 1.27 of
/// the rule of 1998 at steps of half a mean free path. Behind a forward peak photons weigh unequally, (1+g^2)/(1-g^2)^2 is
/// 8 times the variance: it detects three per cent.
#[test]
fn a_uniform_map() {
    let photons = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::new(4.0, 2.0, 2.0)).unwrap();
    let step = Positive::new("the step", 0.5).unwrap();
    let estimator = Estimator::new(Kernel::Epanechnikov, Gather::radius(0.3).unwrap());
    let span = Interval { start: 0.0, end: 3.0 };
    // One watt in a volume of 16, collided: 1/16 per volume, over all directions.
    let exact = 0.8 / 16.0 / FOUR_PI * -expm1(-3.0);
    let rules = [
        (StepRule::NearEnd, 0.5 / -expm1(-0.5)),
        (StepRule::Middle, 0.25 / sinh(0.25)),
        (StepRule::Integrated, 1.0),
    ];
    for (g, promise) in [(0.0, 0.01), (0.75, 0.03)] {
        let phase = Phase::with_asymmetry(Asymmetry::new("g", g).unwrap());
        let medium = Medium::from(Homogeneous::new(Spectrum::ONE, Spectrum::grey(0.8), phase).unwrap());
        let mut measured = [Moments::new(), Moments::new(), Moments::new()];
        for replicate in 0..128 {
            let map = photons.map(Number::Exact(40_000), 11, replicate).unwrap();
            for ((rule, _), moments) in rules.iter().zip(&mut measured) {
                let one = |i: i32| {
                    let start = DVec3::new(0.5, 0.4 * f64::from(1 + i % 4), 0.4 * f64::from(1 + i / 4));
                    let (ray, phase, one) = (Ray::new(start, DVec3::X), medium.phase(), Spectrum::ONE);
                    let source = |place: DVec3| {
                        let (wo, nowhere) = (-DVec3::X, &Boundary::UNKNOWN);
                        estimator.in_scattered(&map, place, wo, phase, one, nowhere).value * 0.8
                    };
                    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
                    along(&medium, (&ray, span), &March::equal(step, *rule), 1.0, &mut stream, source)[1]
                };
                moments.push((0..16).map(one).sum::<f64>() / 16.0 / exact);
            }
        }
        for ((rule, factor), moments) in rules.iter().zip(&measured) {
            let test = t_test(moments, *factor, 1e-6);
            assert!(test.p > ALPHA, "{rule:?} g {g}: {} of {factor}, z {}", moments.mean(), test.z);
            assert!(smallest_detectable_bias(moments.std_error(), 127) < promise, "{}", moments.std_error());
        }
    }
}

/// Where a step is less than numbers tell apart, the rest is one step: the march ends.
#[test]
fn steps_far_from_the_origin_end() {
    let medium = homogeneous(Spectrum::rgb(1e-9, 1.0, 5e8), Spectrum::ZERO, 0.0);
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    for (start, step) in [(1e7, 1e-10), (1e17, 0.05)] {
        let step = Positive::new("the step", step).unwrap();
        let march = March { is_jittered: true, ..March::equal(step, StepRule::Integrated) };
        let span = Interval { start, end: start * (1.0 + 1e-12) };
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        let found = along(&medium, (&ray, span), &march, 1.0, &mut stream, |_| Spectrum::ONE);
        assert!(found.is_finite() && found[0] > 0.0, "{found:?}");
    }
}

/// Random places in steps of many mean free paths of one channel and few of another: a source e^(-b t) brings
/// (1 - e^(-(s+b) L))/(s+b) in each channel, and no place counts more than what all of it reaches over the chance of its
/// channel, a third where all matter alike; the first step is cut, so that there are two.
#[test]
fn random_places_in_colours() {
    let (length, b) = (20.0, 0.05);
    let sigma_t = Spectrum::rgb(0.01, 1.0, 100.0);
    let medium = homogeneous(sigma_t, Spectrum::ZERO, 0.0);
    for (step, promise) in [(20.0, 0.05), (2.0, 0.05)] {
        let march = March {
            is_jittered: true,
            ..March::equal(Positive::new("the step", step).unwrap(), StepRule::Integrated)
        };
        let (span, ray) = (Interval { start: 0.0, end: length }, Ray::new(DVec3::ZERO, DVec3::X));
        let most = sigma_t.map(|s| 2.0 * 3.001 * -expm1(-s * length) / s);
        let found = histories(1 << 16, 5, |stream| {
            let source = |place: DVec3| Spectrum::grey(exp(-b * place.x));
            let value = along(&medium, (&ray, span), &march, 1e3, stream, source);
            assert!(value.0.cmple(most.0).all(), "steps of {step}: {value:?}");
            value
        });
        for (channel, moments) in found.iter().enumerate() {
            let s = sigma_t[channel];
            let exact = -expm1(-(s + b) * length) / (s + b);
            let what = format!("steps of {step}, channel {channel}");
            verdict::agrees(&what, moments, (exact, 1e-9 * exact), promise * exact, 5);
        }
    }
}
