//! Estimators against closed forms and predictions, and in extremes.

use super::cases::{Case, LADDER, Method, RAMP, UNBIASED};
use super::estimators::{Estimator, halves};
use super::expected::{difference, expected};
use super::line::Line;
use super::rays::Way;
use super::series::Orders;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{Interval, Ray};
use turbid::medium::{Blocks, Density, Grid, Heterogeneous, Homogeneous, Medium};
use turbid::phase::{Isotropic, Phase};
use turbid::rng::{Purpose, Stream};
use turbid::stats::{ALPHA, Moments, student_critical};

fn stream(case: u64, index: u64) -> Stream {
    Stream::new(97, Purpose::Synthetic, case, index)
}

/// A unit of length through layers of these densities, of this extinction at density 1.
fn layers(sigma_t: f64, values: Vec<f64>) -> Line {
    let count = values.len() as f64;
    let edges: Vec<f64> = (0..=values.len()).map(|i| i as f64 / count).collect();
    let density = Density::blocks(Blocks::layers(0, edges, values).unwrap()).unwrap();
    let matter =
        Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::ZERO, Phase::Isotropic(Isotropic)).unwrap();
    let medium: Medium = Heterogeneous::new(matter, density).into();
    Line::new(medium, Ray::new(DVec3::ZERO, DVec3::X), Interval { start: 0.0, end: 1.0 }, Vec::new())
}

/// mu = 4x on (0, 1): T = e^-2, variances e^-2 (1 - e^-2), e^-4 (e^(4/3) - 1), e^-4 (e^(2/3) - 1); a place says 4U, so that
/// E e^(x Y) = (e^(4x) - 1)/(4x); the series about 2 has s^2 = 4/3.
#[test]
fn the_ramp_in_closed_form() {
    let line = RAMP.line().unwrap();
    let square = libm::exp(-4.0);
    assert!((line.depth() - 2.0).abs() < 1e-13);
    let variance = |estimator: &Estimator| {
        let e = expected(&line, estimator);
        (e.squared - e.bias * e.bias) * square
    };
    let series = |q: f64| Estimator::Series { orders: Orders::Geometric(q), pivot: 2.0 };
    for (estimator, by_hand) in [
        (Estimator::Analogue, 0.117_019_644),
        (Estimator::Ratio, 0.051_167_812),
        (Estimator::Residual(2.0), 0.017_358_354),
        (Estimator::Local, 0.051_167_812),
        (series(0.5), 0.092_843_482),
        (series(0.7), 0.055_467_907),
    ] {
        assert!(
            (variance(&estimator) / by_hand - 1.0).abs() < 1e-7,
            "{estimator:?}: {}",
            variance(&estimator)
        );
    }
    // Delta tracking ends at its first collision: 4 int e^(-2 x^2) dx = root(2 pi) erf(root 2).
    let to_collision = (2.0 * std::f64::consts::PI).sqrt() * libm::erf(2.0f64.sqrt());
    assert!((expected(&line, &Estimator::Analogue).look_ups / to_collision - 1.0).abs() < 1e-4);
    let biased = [
        (4, 0.179_746_30, -0.015_583_13),
        (8, 0.086_716_11, -0.003_731_28),
        (16, 0.042_524_30, -0.000_902_03),
    ];
    for (n, march, left) in biased {
        assert!((expected(&line, &Estimator::March(n)).bias - march).abs() < 1e-8);
        assert!((expected(&line, &Estimator::Jackknife(n)).bias - left).abs() < 1e-8);
    }
    // One comb says Y = 2 + (4/M)(U - 1/2): the mean of its exponential is sinh(2/M)/(2/M).
    let marched = expected(&line, &Estimator::Marched(line.even(), 4));
    assert!((marched.bias - (libm::sinh(0.5) / 0.5 - 1.0)).abs() < 1e-5);
    // Squared differences tend to E (a - b)^4/64 = 3 s^4/(16 n^2), n places a half: by 4 a level.
    let fall = difference(&line, 1 << 9) / difference(&line, 1 << 10);
    assert!((fall - 4.0).abs() < 0.02, "{fall}");
    assert!((difference(&line, 1 << 9) * f64::from(1u32 << 18) * 3.0 - 1.0).abs() < 0.02);
}

/// Combs of variance s^2 that are small: (0.9 + 0.1 sum P(n)/(n+1)) s^2 to leading order, since first orders of the series cancel
/// over the pivots.
#[test]
fn small_combs_vary_as_their_mean() {
    let line = RAMP.line().unwrap();
    let teeth = 200;
    let e = expected(&line, &Method::combs(&line, teeth));
    let s2 = 16.0 / 12.0 / f64::from(teeth * teeth);
    let chance = |n: usize| Orders::Seldom.reaches(n) - Orders::Seldom.reaches(n + 1);
    let leading: f64 = (0..40).map(|n| chance(n) / (n + 1) as f64).sum();
    assert!((e.squared / (leading * s2) - 1.0).abs() < 1e-3, "{}", e.squared / (leading * s2));
}

/// Every method on every ray where few estimates tell its variance: mean, squared error and look-ups as predicted.
#[test]
fn estimators_do_as_predicted() {
    const BATCHES: u64 = 64;
    const EACH: u64 = 400;
    let critical = student_critical(ALPHA, BATCHES - 1);
    let mut asked = 0;
    for (number, case) in Case::all().into_iter().enumerate() {
        let line = case.way.line().unwrap();
        let estimator = case.method.on(&line);
        let theory = expected(&line, &estimator);
        if theory.squared > 3.0 {
            continue;
        }
        asked += 1;
        let exact = libm::exp(-line.depth());
        let mut all = [Moments::new(); 3];
        for batch in 0..BATCHES {
            let mut sums = [0.0; 3];
            for index in 0..EACH {
                let e = estimator.estimate(&line, &mut stream(number as u64, batch * EACH + index));
                let error = e.value / exact - 1.0;
                sums = [sums[0] + error, sums[1] + error * error, sums[2] + e.look_ups as f64];
            }
            all.iter_mut().zip(sums).for_each(|(m, sum)| m.push(sum / EACH as f64));
        }
        // Squared error and look-ups of the telescoping sum have no variance.
        let known = if case.method.has_known_spread() { 3 } else { 1 };
        // The series' rare high orders make squared errors skewed; look-ups of pieces are good to 1e-3.
        let predicted = [
            (theory.bias, 1e-5),
            (theory.squared, 1e-3 * theory.squared),
            (theory.look_ups, 1e-3 * theory.look_ups),
        ];
        for (m, (value, bound)) in all.iter().zip(predicted).take(known) {
            let off = (m.mean() - value).abs();
            let most = critical * m.std_error() + bound + 1e-12;
            assert!(off <= most, "{}: {} for {value}, {off} above {most}", case.name(), m.mean());
        }
    }
    assert!(asked > 90, "{asked}");
}

/// The test of the test: combs without what a higher order adds are a march, which the same judgement refuses.
#[test]
fn a_march_is_refused() {
    const N: u64 = 64 * 400;
    let line = RAMP.line().unwrap();
    let marched = Estimator::Marched(line.even(), 3);
    let exact = libm::exp(-2.0);
    let errors: Moments =
        (0..N).map(|i| marched.estimate(&line, &mut stream(900, i)).value / exact - 1.0).collect();
    assert!(errors.mean() > 10.0 * errors.std_error(), "{} +- {}", errors.mean(), errors.std_error());
}

/// Nothing in the way: all passes, whatever is asked, without a draw that matters.
#[test]
fn nothing_stops_where_there_is_nothing() {
    for line in [layers(0.0, vec![1.0, 2.0]), layers(3.0, vec![0.0, 0.0])] {
        for method in UNBIASED.into_iter().chain([Method::Marched, Method::March(8), Method::Jackknife(8)]) {
            let estimator = method.on(&line);
            let e = expected(&line, &estimator);
            assert!(e.bias == 0.0 && e.squared < 1e-12, "{method:?}: {e:?}");
            let found = estimator.estimate(&line, &mut stream(1, 0));
            assert!((found.value - 1.0).abs() < 1e-14, "{method:?}: {found:?}");
            assert!(found.look_ups <= 64, "{method:?}");
        }
    }
}

/// Thin: the mean is 1 - tau to rounding, of every unbiased method. Thick: every value is a finite number, and look-ups
/// stay within some times the optical depth.
#[test]
fn thin_and_thick() {
    let thin = layers(1e-6, vec![0.5, 1.5, 1.0]);
    for (number, method) in UNBIASED.into_iter().enumerate() {
        let estimator = method.on(&thin);
        let theory = expected(&thin, &estimator);
        assert!(theory.squared <= 1.000_1e-6 && theory.squared >= 0.0, "{method:?}: {theory:?}");
        let errors: Moments = (0..4000)
            .map(|i| {
                estimator.estimate(&thin, &mut stream(10 + number as u64, i)).value / libm::exp(-1e-6) - 1.0
            })
            .collect();
        // A collision has a chance of 1e-6: none of 4,000, or one or two, of delta tracking.
        assert!(errors.mean().abs() < 1e-3, "{method:?}: {}", errors.mean());
    }
    let thick = layers(700.0, vec![0.5, 1.5, 1.0]);
    for (number, method) in UNBIASED.into_iter().chain([Method::Marched, Method::Jackknife(8)]).enumerate() {
        let estimator = method.on(&thick);
        assert!(expected(&thick, &estimator).look_ups < 3e3, "{method:?}");
        for i in 0..200 {
            let found = estimator.estimate(&thick, &mut stream(40 + number as u64, i));
            assert!(found.value.is_finite(), "{method:?}: {found:?}");
        }
    }
}

/// NaN, or what is below 0, never becomes a line.
#[test]
fn no_numbers_are_refused() {
    let phase = || Phase::Isotropic(Isotropic);
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(Homogeneous::new(Spectrum::grey(bad), Spectrum::ZERO, phase()).is_err());
        let corners = (DVec3::ZERO, DVec3::ONE);
        assert!(Grid::new(corners, [2, 1, 1], 1, vec![1.0, bad as f32]).is_err());
        assert!(Blocks::layers(0, vec![0.0, 1.0], vec![bad]).is_err());
    }
}

/// The same stream gives the same bits; halves of a march are above the whole.
#[test]
fn the_same_numbers_again() {
    for case in Case::of(Way::all()[6]) {
        let line = case.way.line().unwrap();
        let estimator = case.method.on(&line);
        let once = |i| estimator.estimate(&line, &mut stream(2, i));
        assert!((0..100).all(|i| once(i).value.to_bits() == once(i).value.to_bits()));
    }
    let line = RAMP.line().unwrap();
    assert!((0..1000).all(|i| halves(&line, 4, &mut stream(3, i)) <= 0.0));
    assert!(LADDER.windows(2).all(|n| n[1] == 2 * n[0]));
}
