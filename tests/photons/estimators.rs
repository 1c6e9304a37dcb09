//! Estimators at a point: kernels, exact small cases, symmetries. Their statistics are in
//! `estimators_statistics`.

use crate::checks::weights;
use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use turbid::estimators::boundary::{Boundary, Rejection, Treatment};
use turbid::estimators::{
    CosinePairs, Directional, Estimate, Estimator, Gather, Kernel, NeighborCount, ball_sum, count_within,
    for_each_photon,
};
use turbid::geometry::{Cuboid, Shape};
use turbid::math::{Asymmetry, FOUR_PI, Positive, exp, warp};
use turbid::phase::{HenyeyGreenstein, Isotropic, Phase};
use turbid::photons::{Flags, Photon, PhotonMap};
use turbid::rng::{Purpose, Stream};
use turbid::{Result, Spectrum};
use wide::f32x8;

fn photons(count: u64, seed: u64) -> Vec<Photon> {
    (0..count)
        .map(|history| {
            let mut stream = Stream::new(seed, Purpose::Synthetic, 0, history);
            Photon {
                position: DVec3::new(stream.unit(), stream.unit(), stream.unit()),
                dir: warp::square_to_sphere(stream.pair()).as_vec3(),
                normal: Vec3::ZERO,
                power: Vec3::new(stream.unit() as f32, stream.unit() as f32, 1.0),
                order: 0,
                flags: Flags::NONE,
            }
        })
        .collect()
}

fn map(photons: Vec<Photon>) -> PhotonMap {
    PhotonMap::new(photons, 1000).unwrap()
}

fn density(map: &PhotonMap, at: DVec3, kernel: Kernel, gather: Gather) -> Estimate {
    Estimator::new(kernel, gather).collision_density(map, at, &Boundary::UNKNOWN)
}

fn hg(g: f64) -> HenyeyGreenstein {
    HenyeyGreenstein::new(Asymmetry::new("g", g).unwrap())
}

/// Simpson's rule over [0, 1]; for the polynomials and the Gaussian below its error is under 1e-13.
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    let term = |i: i32| {
        f64::from(if i == 0 || i == n { 1 } else { 2 + 2 * (i % 2) }) * f(f64::from(i) / f64::from(n))
    };
    (0..=n).map(term).sum::<f64>() / (3.0 * f64::from(n))
}

fn is_close(a: Spectrum, b: Spectrum, relative: f64) -> bool {
    (0..3).all(|c| (a[c] - b[c]).abs() <= relative * b[c].abs())
}

#[test]
fn kernels_integrate_to_one_and_have_their_moments() {
    for kernel in Kernel::ALL {
        let density = |u: f64| kernel.peak() * kernel.profile(u * u);
        let shells = |f: &dyn Fn(f64) -> f64| integral(|u| 4.0 * PI * u * u * f(u));
        for (what, found, stated) in [
            ("integral", shells(&density), 1.0),
            ("m2", shells(&|u| u * u * density(u)), kernel.m2()),
            ("m4", shells(&|u| u * u * u * u * density(u)), kernel.m4()),
            ("roughness", shells(&|u| density(u) * density(u)), kernel.roughness()),
        ] {
            assert!((found - stated).abs() < 1e-12, "{} {what}: {found}, stated {stated}", kernel.name());
        }
    }
}

/// Shells beyond a plane, each with the part of it that the plane cuts off.
#[test]
fn kernels_cut_by_a_plane() {
    for kernel in Kernel::ALL {
        for u in [0.0, 1e-9, 0.1, 0.35, 0.5, 0.8, 0.99, 1.0, 3.0f64] {
            let shell = |s: f64| 2.0 * PI * s * (s - u) * kernel.peak() * kernel.profile(s * s);
            let length = (1.0 - u).max(0.0);
            let expected = length * integral(|t| shell(u + length * t));
            let found = kernel.beyond_plane(u);
            assert!((found - expected).abs() < 1e-12, "{} {u}: {found}, not {expected}", kernel.name());
        }
        assert!((kernel.beyond_plane(0.0) - 0.5).abs() < 1e-15);
    }
}

#[test]
fn profiles_of_eight_are_those_of_one() {
    for kernel in Kernel::ALL {
        for step in 0..2000 {
            let u2: [f32; 8] = std::array::from_fn(|lane| (step * 8 + lane) as f32 / 15_999.0);
            for (u, profile) in u2.into_iter().zip(kernel.profiles(f32x8::new(u2)).to_array()) {
                let error = f64::from(profile) - kernel.profile(f64::from(u));
                assert!(error.abs() < 1e-6, "{} at {u}: {error}", kernel.name());
            }
        }
    }
}

#[test]
fn phase_functions_of_eight_are_those_of_one() {
    let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
    for g in [-0.999, -0.9, -1e-6, 0.0, 1e-6, 0.5, 0.9, 0.999] {
        for _ in 0..200 {
            let dirs: [Vec3; 8] = std::array::from_fn(|_| warp::square_to_sphere(stream.pair()).as_vec3());
            let dir = [0, 1, 2].map(|axis| f32x8::new(dirs.map(|d| d[axis])));
            let wo = warp::square_to_sphere(stream.pair()).as_vec3().to_array();
            let pairs = CosinePairs { dir: &dir, wo, inside: f32x8::ZERO.simd_eq(f32x8::ZERO) };
            let (fast, phase) = (hg(g).values(pairs).to_array(), hg(g));
            let slow = (|minus: f64, plus: f64| phase.value(minus, plus)).values(pairs).to_array();
            for (fast, slow) in fast.into_iter().zip(slow) {
                // Eight operations of relative error 2^-24 each, the root and the division among them.
                assert!((fast - slow).abs() <= 8.0 / 16_777_216.0 * slow, "g = {g}: {fast} for {slow}");
            }
            assert_eq!(Isotropic.values(pairs).to_array(), [(1.0 / FOUR_PI) as f32; 8]);
        }
        // The integral over the sphere is one: 1-mu = 2v, v uniform, made smooth by v = t^8 from the peak.
        let around_peak = |t: f64| {
            let v = t.powi(8);
            let (near, far) = (2.0 * v, 2.0 - 2.0 * v);
            let pair = if g >= 0.0 { (near, far) } else { (far, near) };
            FOUR_PI * hg(g).value(pair.0, pair.1) * 8.0 * t.powi(7)
        };
        assert!((integral(around_peak) - 1.0).abs() < 1e-9, "g = {g}");
    }
}

/// The other phase functions: sums and roots of the pair in single precision, some twelve operations each.
#[test]
fn every_phase_function_of_eight_is_that_of_one() {
    let mut stream = Stream::new(4, Purpose::Synthetic, 0, 0);
    for phase in Phase::specimens() {
        for _ in 0..50 {
            let dirs: [Vec3; 8] = std::array::from_fn(|_| warp::square_to_sphere(stream.pair()).as_vec3());
            let dir = [0, 1, 2].map(|axis| f32x8::new(dirs.map(|d| d[axis])));
            let wo = warp::square_to_sphere(stream.pair()).as_vec3().to_array();
            let pairs = CosinePairs { dir: &dir, wo, inside: f32x8::ZERO.simd_eq(f32x8::ZERO) };
            let fast = phase.values(pairs).to_array();
            let slow = (|minus: f64, plus: f64| phase.value(minus, plus)).values(pairs).to_array();
            for (fast, slow) in fast.into_iter().zip(slow) {
                assert!((fast - slow).abs() <= 12.0 / 16_777_216.0 * slow, "{phase:?}: {fast} for {slow}");
            }
        }
    }
}

#[test]
fn three_photons_by_hand() -> Result<()> {
    // Distances 0.25, 0.5 and 1 from the origin, powers 1, 2 and 4, on a box that holds them exactly.
    let at = |x: f64, power: f32| Photon {
        position: DVec3::new(x, 0.0, 0.0),
        dir: Vec3::X,
        normal: Vec3::ZERO,
        power: Vec3::new(power, 0.0, 0.0),
        order: 0,
        flags: Flags::NONE,
    };
    let map = PhotonMap::new(vec![at(0.25, 1.0), at(-0.5, 2.0), at(1.0, 4.0)], 10)?;
    for kernel in Kernel::ALL {
        let k = |distance: f64, radius: f64| {
            let u = distance / radius;
            kernel.peak() * kernel.profile(u * u) / (radius * radius * radius)
        };
        let cases = [
            (Gather::radius(1.0)?, 1.0, 3, k(0.25, 1.0) + 2.0 * k(0.5, 1.0) + 4.0 * k(1.0, 1.0)),
            (Gather::radius(0.5)?, 0.5, 2, k(0.25, 0.5) + 2.0 * k(0.5, 0.5)),
            (Gather::nearest(3, 2.0)?, 1.0, 3, k(0.25, 1.0) + 2.0 * k(0.5, 1.0)),
            (Gather::nearest(2, 2.0)?, 0.5, 2, k(0.25, 0.5)),
            (Gather::nearest_biased(2, 2.0)?, 0.5, 2, k(0.25, 0.5) + 2.0 * k(0.5, 0.5)),
        ];
        for (gather, radius, found, sum) in cases {
            let estimator = Estimator::new(kernel, gather);
            let estimate = estimator.fluence(&map, DVec3::ZERO, Spectrum::grey(2.0), &Boundary::UNKNOWN);
            let expected = Spectrum::rgb(sum / 20.0, 0.0, 0.0);
            assert!(is_close(estimate.value, expected, 1e-6), "{kernel:?} {gather:?} {estimate:?} {sum}");
            let rest = Estimate { radius, found, underfull: false, coincident: 0, rejected: 0, ..estimate };
            assert_eq!(estimate, rest, "{kernel:?} {gather:?}");
        }
        // Four photons are asked for and three are there: all of them, in the largest ball.
        for gather in [Gather::nearest(4, 2.0)?, Gather::nearest_biased(4, 2.0)?] {
            let estimate = density(&map, DVec3::ZERO, kernel, gather);
            let sum = k(0.25, 2.0) + 2.0 * k(0.5, 2.0) + 4.0 * k(1.0, 2.0);
            assert!(estimate.underfull && estimate.found == 3 && estimate.radius == 2.0);
            assert!(is_close(estimate.value, Spectrum::rgb(sum / 10.0, 0.0, 0.0), 1e-6));
        }
    }
    Ok(())
}

#[test]
fn in_scattered_light_follows_the_phase_function() -> Result<()> {
    let map = map(photons(3000, 5));
    let (point, wo) = (DVec3::splat(0.5), DVec3::new(0.6, -0.48, 0.64));
    for gather in [Gather::radius(0.2)?, Gather::nearest(40, 1.0)?] {
        let mut sum = Spectrum::ZERO;
        let ball = for_each_photon(&map, point, Kernel::Biweight, gather, |photon, weight| {
            let (minus, plus) = turbid::math::cosine_pair(photon.dir.as_dvec3(), wo);
            let power = Spectrum(photon.power.as_dvec3());
            sum += power * weight * hg(0.8).value(minus, plus);
        });
        let expected = sum / ball.radius.powi(3) / (1000.0 * 3.0);
        let (estimator, sigma_t) = (Estimator::new(Kernel::Biweight, gather), Spectrum::grey(3.0));
        let found = estimator.in_scattered(&map, point, wo, &hg(0.8), sigma_t, &Boundary::UNKNOWN);
        assert!(is_close(found.value, expected, 1e-5), "{found:?} {expected:?}");
        assert_eq!((found.radius, found.found), (ball.radius, ball.found));
        // Isotropic: the fluence over 4 pi.
        let all = estimator.fluence(&map, point, sigma_t, &Boundary::UNKNOWN).value / FOUR_PI;
        let isotropic = estimator.in_scattered(&map, point, wo, &Isotropic, sigma_t, &Boundary::UNKNOWN);
        assert!(is_close(isotropic.value, all, 1e-6));
    }
    Ok(())
}

#[test]
fn what_is_refused() {
    assert!(Gather::nearest(1, 1.0).is_err() && Gather::nearest_biased(1, 1.0).is_err());
    assert!(Gather::nearest(0, 1.0).is_err() && Gather::nearest(2, f64::INFINITY).is_err());
    assert!(Gather::radius(0.0).is_err() && Gather::radius(f64::NAN).is_err());
    assert!(PhotonMap::new(photons(5, 1), 0).is_err());
}

#[test]
fn coincident_photons_are_seen() -> Result<()> {
    let mut all = photons(500, 6);
    let point = DVec3::splat(0.5);
    for photon in &mut all[..30] {
        photon.position = point;
    }
    let map = map(all);
    let estimate = density(&map, point, Kernel::Uniform, Gather::nearest(20, 1.0)?);
    assert_eq!((estimate.coincident, estimate.found, estimate.underfull), (30, 31, false));
    assert!(estimate.value.is_finite() && estimate.radius > 0.0);
    Ok(())
}

#[test]
fn a_point_that_is_not_finite_has_no_estimate() -> Result<()> {
    let map = map(photons(500, 12));
    for x in [f64::NAN, f64::INFINITY] {
        for gather in [Gather::radius(0.3)?, Gather::nearest(20, 1.0)?] {
            let estimate = density(&map, DVec3::new(0.5, x, 0.5), Kernel::Uniform, gather);
            assert!(estimate.value[0].is_nan() && estimate.found == 0, "{estimate:?}");
        }
    }
    Ok(())
}

#[test]
fn a_million_terms_do_not_stall() -> Result<()> {
    let all = photons(1_000_000, 7);
    let mut exact = [0.0; 3];
    for photon in &all {
        for (sum, power) in exact.iter_mut().zip(photon.power.to_array()) {
            *sum += f64::from(power);
        }
    }
    let map = map(all);
    let found = ball_sum(&map, DVec3::splat(0.5), Kernel::Uniform, Gather::radius(10.0)?);
    let expected = Spectrum::rgb(exact[0], exact[1], exact[2]) * Kernel::Uniform.peak() / 1e3;
    // Rounding of each flushed lane, 32 x 2^-24 at worst, is random in sign: 1e-8 is left after 30,000
    // flushes.
    assert!(is_close(found.sum, expected, 1e-7), "{found:?} {expected:?}");
    assert_eq!(found.ball.found, 1_000_000);
    assert_eq!(count_within(&map, DVec3::splat(0.5), 10.0), 1_000_000);
    Ok(())
}

#[test]
fn the_number_of_threads_changes_no_bit() -> Result<()> {
    let map = map(photons(50_000, 8));
    let points: Vec<DVec3> = photons(3000, 9).iter().map(|photon| photon.position).collect();
    let gathers = [Gather::radius(0.05)?, Gather::nearest(30, 1.0)?];
    let ask = |point: &DVec3| {
        gathers.map(|gather| {
            let (estimator, one) = (Estimator::new(Kernel::Gaussian, gather), Spectrum::ONE);
            estimator.in_scattered(&map, *point, DVec3::Z, &hg(0.7), one, &Boundary::UNKNOWN)
        })
    };
    let alone: Vec<[Estimate; 2]> = points.iter().map(ask).collect();
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together: Vec<[Estimate; 2]> = pool.install(|| points.par_iter().map(ask).collect());
        assert!(alone == together, "{threads} threads");
    }
    // Nor does the order of the questions, although each search guesses from the last.
    let backwards: Vec<[Estimate; 2]> = points.iter().rev().map(ask).collect();
    assert!(alone.iter().eq(backwards.iter().rev()));
    Ok(())
}

/// The bits of one small map's estimates, the same on every machine, target and number of threads.
#[test]
fn golden_bits() -> Result<()> {
    let map = map(photons(2000, 11));
    let mut digest = 0u64;
    for kernel in Kernel::ALL {
        for gather in [Gather::radius(0.2)?, Gather::nearest(50, 1.0)?, Gather::nearest_biased(50, 1.0)?] {
            for at in [0.1, 0.3, 0.5, 0.9] {
                let (at, phase) = (DVec3::new(at, 0.4, 0.6), hg(0.8));
                let (estimator, sigma_t) = (Estimator::new(kernel, gather), Spectrum::grey(2.0));
                let estimate =
                    estimator.in_scattered(&map, at, DVec3::Y, &phase, sigma_t, &Boundary::UNKNOWN);
                for word in [estimate.value[0], estimate.value[2], estimate.radius] {
                    digest = (digest ^ word.to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
                }
            }
        }
    }
    assert_eq!(format!("{digest:016x}"), "249af00df0bc0bac");
    Ok(())
}

#[test]
fn expected_blur_is_the_second_moment_and_misses_the_fourth() -> Result<()> {
    // For exp(-b x) the kernel mean over the local value is 1 + m2 (b r)^2/6 + m4 (b r)^4/120 + ..., and what
    // is left after the fourth order is below (b r)^6/5040 x 1.1 for b r <= 1.
    for kernel in Kernel::ALL {
        for br in [0.1, 0.3, 1.0] {
            let sinh = |x: f64| if x == 0.0 { 1.0 } else { (exp(x) - exp(-x)) / (2.0 * x) };
            let mean = integral(|u| 4.0 * PI * u * u * kernel.peak() * kernel.profile(u * u) * sinh(br * u));
            let gather = Gather::radius(br)?;
            let blur = gather.expected_bias(kernel, 1.0, 1.0, 1.0);
            let fourth = kernel.m4() * br.powi(4) / 120.0;
            let left = mean - 1.0 - blur - fourth;
            assert!((0.0..1.1 * br.powi(6) / 5040.0 + 1e-12).contains(&(left + 1e-12)), "{kernel:?} {left}");
        }
    }
    Ok(())
}

/// Every estimator, of a size that suits these maps at a scale of lengths.
fn specimens(scale: f64) -> Vec<Estimator> {
    let radius = Positive::new("the radius", 0.3 * scale).unwrap();
    Estimator::specimens(radius, NeighborCount::new(20).unwrap())
}

/// The cube of the photons, as the medium that they are in.
fn cube(scale: f64) -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::splat(scale)).unwrap())
}

/// A place in the cube.
fn place() -> [impl Strategy<Value = f64>; 3] {
    // On faces, edges and corners of the cube, in its middle, and anywhere.
    [0, 1, 2].map(|_| prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.0..1.0])
}

/// The size of the sums that an estimate is made of: its own, but for a fitted line, which cancels them and multiplies what is
/// left, by up to some hundred in a corner.
fn summed(estimator: &Estimator, own: Spectrum, ask: impl Fn(&Estimator) -> Spectrum) -> Spectrum {
    match estimator.treatment {
        Treatment::None | Treatment::Clipped | Treatment::Reflection => own,
        Treatment::LocalLinear => ask(&estimator.treated(Treatment::Reflection)) * 100.0,
    }
}

#[test]
fn every_estimator_has_a_name_of_its_own() {
    let radius = Positive::new("the radius", 0.25).unwrap();
    let specimens = Estimator::specimens(radius, NeighborCount::new(50).unwrap());
    let rejecting = |estimator: &Estimator| Rejection::ALL.map(|rejection| estimator.rejecting(rejection));
    let all: Vec<Estimator> = specimens.iter().flat_map(rejecting).collect();
    let names: BTreeSet<String> = all.iter().map(Estimator::name).collect();
    assert_eq!((names.len(), specimens.len()), (all.len(), Kernel::ALL.len() * 3 * Treatment::ALL.len()));
    for name in ["uniform, r=0.25", "cone, k=50, clipped", "gaussian, k=50(biased), local linear, visible"] {
        assert!(names.contains(name), "{name}");
    }
}

proptest! {
    #![proptest_config(crate::common::config(20))]

    /// Powers times a constant give the estimate times it; a power of two changes no bit. Every estimator, anywhere.
    #[test]
    fn linear_in_power(count in 1u64..400, seed in any::<u64>(), exponent in -60i32..60, at in place()) {
        let plain = photons(count, seed);
        let factor = libm::ldexp(1.0, exponent);
        let scaled = plain.iter().map(|p| Photon { power: p.power * factor as f32, ..*p }).collect();
        let (plain, scaled, medium) = (map(plain), map(scaled), cube(1.0));
        let (at, boundary) = (DVec3::from(at), Boundary::of(&medium).unwrap());
        for estimator in specimens(1.0) {
            let ask = |map| estimator.collision_density(map, at, &boundary).value;
            prop_assert_eq!(ask(&plain) * factor, ask(&scaled), "{}", estimator.name());
        }
    }

    /// At a fixed radius two maps of one emission add up to the map of both, for every estimator, anywhere.
    #[test]
    fn additive_over_maps(count in 2u64..400, seed in any::<u64>(), part in 0.0..1.0f64, at in place()) {
        let all = photons(count, seed);
        let (a, b) = all.split_at((part * count as f64) as usize);
        // Corners that hold the box in place: the parts are then stored as they are in the whole.
        let corners = [0.0, 1.0].map(|c| Photon { position: DVec3::splat(c), power: Vec3::ZERO, ..all[0] });
        let [a, b, all] = [a, b, &all].map(|part| map([part, &corners].concat()));
        let medium = cube(1.0);
        let (at, boundary) = (DVec3::from(at), Boundary::of(&medium).unwrap());
        for estimator in specimens(1.0).into_iter().filter(|e| e.gather.k().is_none()) {
            let ask = |map| estimator.collision_density(map, at, &boundary).value;
            let size = summed(&estimator, ask(&all), |mirrored| {
                mirrored.collision_density(&all, at, &boundary).value
            });
            // Sums of at most 400 non-negative terms: each rounds within 32 x 2^-24.
            let off = (ask(&a) + ask(&b) - ask(&all)).0.abs();
            prop_assert!(off.cmple(4e-6 * size.0).all(), "{}: {off} of {size:?}", estimator.name());
        }
    }

    /// The order of arrival changes no bit, of any estimator.
    #[test]
    fn invariant_under_permutation(count in 2u64..400, seed in any::<u64>(), at in place()) {
        let all = photons(count, seed);
        let reversed = map(all.iter().rev().copied().collect());
        let (all, medium) = (map(all), cube(1.0));
        let (at, boundary) = (DVec3::from(at), Boundary::of(&medium).unwrap());
        for estimator in specimens(1.0) {
            let ask = |map| estimator.collision_density(map, at, &boundary);
            prop_assert_eq!(ask(&all), ask(&reversed), "{}", estimator.name());
        }
    }

    /// Lengths times a power of two s: the same photons, and the fluence times s^-2, bit for bit, of every estimator.
    #[test]
    fn lengths_scale_the_fluence(
        count in 1u64..400,
        seed in any::<u64>(),
        exponent in -30i32..30,
        at in place(),
    ) {
        let s = libm::ldexp(1.0, exponent);
        let plain = photons(count, seed);
        let larger = map(plain.iter().map(|p| Photon { position: p.position * s, ..*p }).collect());
        let (plain, at, media) = (map(plain), DVec3::from(at), [cube(1.0), cube(s)]);
        let [boundary, scaled] = [0, 1].map(|i| Boundary::of(&media[i]).unwrap());
        for (one, other) in specimens(1.0).into_iter().zip(specimens(s)) {
            let a = one.fluence(&plain, at, Spectrum::grey(0.7), &boundary);
            let b = other.fluence(&larger, at * s, Spectrum::grey(0.7 / s), &scaled);
            prop_assert_eq!(a.value, b.value * (s * s), "{}", one.name());
            prop_assert_eq!((a.radius * s, a.found, a.underfull), (b.radius, b.found, b.underfull));
        }
    }

    /// In-scattered radiance of an isotropic phase function is the fluence over 4 pi, of every estimator, anywhere; and no
    /// place that is not finite is dark.
    #[test]
    fn isotropic_scattering_is_the_fluence(count in 1u64..400, seed in any::<u64>(), at in place()) {
        let (map, medium, sigma_t) = (map(photons(count, seed)), cube(1.0), Spectrum::rgb(0.5, 1.0, 2.0));
        let (at, boundary) = (DVec3::from(at), Boundary::of(&medium).unwrap());
        for estimator in specimens(1.0) {
            let found = estimator.in_scattered(&map, at, DVec3::Z, &Isotropic, sigma_t, &boundary);
            let fluence = estimator.fluence(&map, at, sigma_t, &boundary).value / FOUR_PI;
            let off = (found.value - fluence).0.abs();
            let size = summed(&estimator, fluence, |mirrored| {
                mirrored.fluence(&map, at, sigma_t, &boundary).value / FOUR_PI
            });
            prop_assert!(off.cmple(1e-6 * size.0).all(), "{}: {off}", estimator.name());
            let nowhere = estimator.fluence(&map, DVec3::new(0.5, f64::NAN, 0.5), sigma_t, &boundary).value;
            prop_assert!(nowhere[0].is_nan(), "{}: {nowhere:?}", estimator.name());
        }
    }
}

proptest! {
    #![proptest_config(crate::common::config(60))]

    /// Rotated and moved, the estimate stays, to the rounding of positions.
    #[test]
    fn invariant_under_motions(
        count in 30u64..400,
        seed in any::<u64>(),
        angles in [0.0..6.0, 0.0..6.0, 0.0..6.0],
        shift in -100.0..100.0f64,
    ) {
        let [a, b, c] = angles;
        let turn = DMat3::from_rotation_z(a) * DMat3::from_rotation_x(b) * DMat3::from_rotation_z(c);
        let moved = |p: DVec3| turn * p + shift;
        let plain = photons(count, seed);
        let turned = map(
            plain
                .iter()
                .map(|p| Photon {
                    position: moved(p.position),
                    dir: (turn * p.dir.as_dvec3()).as_vec3(),
                    ..*p
                })
                .collect(),
        );
        let plain = map(plain);
        let (at, wo) = (DVec3::splat(0.5), DVec3::X);
        // A kernel that falls to zero smoothly: a photon that rounding moves across the edge brings nothing.
        // Distances move by a few 1e-7, weights by as much over u = 1; sums of photons near the edge by more
        // of themselves, so the tolerance is of the largest weight.
        for gather in [Gather::radius(0.3).unwrap(), Gather::nearest(20, 1.0).unwrap()] {
            let ask = |map, at, wo| {
                let (estimator, one) = (Estimator::new(Kernel::Biweight, gather), Spectrum::ONE);
                estimator.in_scattered(map, at, wo, &hg(0.6), one, &Boundary::UNKNOWN)
            };
            let (a, b) = (ask(&plain, at, wo), ask(&turned, moved(at), turn * wo));
            let peak = 20.0 * Kernel::Biweight.peak() / (a.radius.powi(3) * 1000.0);
            let error = (a.value - b.value).0.abs().max_element();
            prop_assert!(error <= 1e-5 * peak, "{:?} {:?}", a, b);
            let resolution = plain.tree().resolution() + turned.tree().resolution();
            prop_assert!((a.radius - b.radius).abs() <= 4.0 * resolution + 1e-6 * a.radius);
        }
    }
}

#[test]
fn the_k_nearest_vary_as_their_volume() {
    weights::the_k_nearest_vary_as_their_volume();
}

#[test]
fn one_photon_is_one_over_its_ball() {
    weights::one_photon_is_one_over_its_ball();
}
