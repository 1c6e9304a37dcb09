//! Numbers: random words at their ends, transmittance over its whole range, moments by hand, long sums.

use crate::support::scenes::{Incidence, bounded};
use crate::support::scenes::{at_depth, cuboid, region, slab, volume_source};
use crate::support::verdict;
use glam::DVec3;
use turbid::math::{Ray, exp, ln_1p};
use turbid::rng::half_open;
use turbid::scene::{Quantity, SURROUNDINGS, decay};
use turbid::stats::{Moments, student_p, t_test};

/// The largest word gives a number below 1, and the optical depth of a flight from it is finite.
pub fn the_largest_word_is_below_one() {
    assert_eq!(half_open(0), 0.0);
    let largest = half_open(u64::MAX);
    assert_eq!(largest, 1.0 - f64::EPSILON / 2.0);
    assert!((-ln_1p(-largest) - 53.0 * std::f64::consts::LN_2).abs() < 1e-13);
}

/// The transmittance of a slab keeps its digits from 1e-12 to 700 mean free paths: the depth itself rounds once, which
/// e^-depth magnifies by the depth.
pub fn transmittance_keeps_its_digits() {
    for depth in [1e-12, 1e-3, 1.0, 16.0, 40.0, 88.0, 104.0, 300.0, 700.0] {
        let scene = slab(depth, 0.5, 0.0, Incidence::Beam(1.0));
        let Quantity::Fluence(top) = at_depth(0.0) else { unreachable!() };
        let transmitted =
            decay(scene.optical_depth(&Ray::new(top, DVec3::Z), f64::INFINITY, SURROUNDINGS))[0];
        let off = (transmitted / exp(-depth) - 1.0).abs();
        assert!(
            off < 4.0 * f64::EPSILON * (1.0 + depth),
            "depth {depth}: {transmitted:e} differs by {off:e}"
        );
    }
}

/// A box of fog seen along each axis and obliquely: its optical depth is its length.
pub fn a_box_is_seen_along_its_axes() {
    let body = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    let scene = bounded(vec![region(body.clone(), 0.5, 0.5, 0.0)], Vec::new(), vec![volume_source(body)]);
    let center = DVec3::new(0.5, 1.0, 1.5);
    let directions = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 2.0, 3.0)];
    for direction in directions {
        // Through the centre, from face to face: the first face met cuts the direction.
        let across = [0, 1, 2]
            .map(|i| if direction[i] > 0.0 { (i as f64 + 1.0) / direction[i] } else { f64::INFINITY });
        let expected = 0.5 * direction.length() * across.into_iter().fold(f64::INFINITY, f64::min);
        for sign in [1.0, -1.0] {
            let dir = sign * direction.normalize();
            let depth =
                scene.optical_depth(&Ray::new(center - 10.0 * dir, dir), f64::INFINITY, SURROUNDINGS)[0];
            assert!((depth / expected - 1.0).abs() < 1e-14, "along {dir}: {depth}");
        }
    }
}

/// One to five: variance 5/2, standard error sqrt(1/2), skewness 0; and their t test against 2.
pub fn moments_by_hand() {
    let m: Moments = [1.0, 2.0, 3.0, 4.0, 5.0].iter().collect();
    assert_eq!((m.n(), m.mean(), m.skew()), (5, 3.0, 0.0));
    assert!((m.variance() - 2.5).abs() < 1e-15, "variance {}", m.variance());
    assert!((m.std_dev() - 2.5f64.sqrt()).abs() < 1e-15);
    assert!((m.std_error() - 0.5f64.sqrt()).abs() < 1e-15, "standard error {}", m.std_error());
    assert!((m.vov() - 0.14).abs() < 1e-15);
    // 0, 0, 0, 4: mean 1, squares 12, cubes 24: skewness 2 24 / 12^(3/2).
    let skewed: Moments = [0.0, 0.0, 0.0, 4.0].iter().collect();
    assert!((skewed.skew() - 48.0 / (12.0 * 12.0f64.sqrt())).abs() < 1e-14, "{}", skewed.skew());
    let test = t_test(&m, 2.0, 0.0);
    assert!((test.z - 2f64.sqrt()).abs() < 1e-14 && test.p == student_p(test.z, 4), "{test:?}");
}

/// What is not finite is counted and makes the mean not finite.
pub fn nothing_non_finite_is_dropped() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let m: Moments = [2.0, bad, 1.0].iter().collect();
        assert!(m.n() == 3 && !m.mean().is_finite() && m.is_heavy_tailed(), "{bad}: {m:?}");
        assert_eq!(t_test(&m, 1.5, 0.0).p, 0.0);
    }
}

/// A ramp from 0 to 1 in 2^26 steps has the mean 1/2: each step rounds a few times, 2^-53 of a mean below 1. Half a
/// second; a running mean in single precision stays behind from a quarter on.
pub fn a_long_mean_does_not_drift() {
    const N: u32 = 1 << 26;
    let m: Moments = (0..N).map(|i| (f64::from(i) + 0.5) / f64::from(N)).collect();
    assert!((m.mean() - 0.5).abs() < f64::from(N) * f64::EPSILON, "mean {}", m.mean());
}

/// False alarms at 1 % over 20,000 right sets of 8 numbers, judged by `p` of z.
pub fn false_alarms_are_as_rare_as_promised(p: fn(f64) -> f64) {
    const SETS: u64 = 20_000;
    let alarms = (0..SETS).filter(|&set| {
        let mut stream = turbid::rng::Stream::new(11, turbid::rng::Purpose::Synthetic, set, 0);
        // Sums of twelve uniform numbers: normal to a kurtosis of -0.1, which Student's t does not feel.
        let values = (0..8).map(|_| (0..12).map(|_| stream.unit()).sum::<f64>() - 6.0);
        p(t_test(&values.collect(), 0.0, 0.0).z) < 0.01
    });
    verdict::rate("alarms at 1 %", alarms.count() as u64, SETS, 0.01, 0.006, 11);
}
