//! Estimators at a point: kernels, exact small cases, symmetries. Their statistics are in
//! `estimators_statistics`.

use crate::checks::weights;
use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;
use rayon::prelude::*;
use std::f64::consts::PI;
use turbid::estimators::{
    CosinePairs, Directional, Estimate, Gather, Kernel, ball_sum, collision_density, count_within, fluence,
    for_each_photon, in_scattered,
};
use turbid::math::{Asymmetry, FOUR_PI, exp, warp};
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
            for (found, u2) in kernel.profiles(f32x8::new(u2)).to_array().into_iter().zip(u2) {
                let error = (f64::from(found) - kernel.profile(f64::from(u2))).abs();
                assert!(error < 1e-6, "{} at u2 = {u2}: off by {error}", kernel.name());
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
            let estimate = fluence(&map, DVec3::ZERO, Spectrum::grey(2.0), kernel, gather);
            let expected = Spectrum::rgb(sum / 20.0, 0.0, 0.0);
            assert!(is_close(estimate.value, expected, 1e-6), "{kernel:?} {gather:?} {estimate:?} {sum}");
            let rest = Estimate { value: estimate.value, radius, found, underfull: false, coincident: 0 };
            assert_eq!(estimate, rest, "{kernel:?} {gather:?}");
        }
        // Four photons are asked for and three are there: all of them, in the largest ball.
        for gather in [Gather::nearest(4, 2.0)?, Gather::nearest_biased(4, 2.0)?] {
            let estimate = collision_density(&map, DVec3::ZERO, kernel, gather);
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
        let found = in_scattered(&map, point, wo, &hg(0.8), Spectrum::grey(3.0), Kernel::Biweight, gather);
        assert!(is_close(found.value, expected, 1e-5), "{found:?} {expected:?}");
        assert_eq!((found.radius, found.found), (ball.radius, ball.found));
        // Isotropic: the fluence over 4 pi.
        let all = fluence(&map, point, Spectrum::grey(3.0), Kernel::Biweight, gather).value / FOUR_PI;
        let isotropic =
            in_scattered(&map, point, wo, &Isotropic, Spectrum::grey(3.0), Kernel::Biweight, gather);
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
    let estimate = collision_density(&map, point, Kernel::Uniform, Gather::nearest(20, 1.0)?);
    assert_eq!((estimate.coincident, estimate.found, estimate.underfull), (30, 31, false));
    assert!(estimate.value.is_finite() && estimate.radius > 0.0);
    Ok(())
}

#[test]
fn a_point_that_is_not_finite_has_no_estimate() -> Result<()> {
    let map = map(photons(500, 12));
    for x in [f64::NAN, f64::INFINITY] {
        for gather in [Gather::radius(0.3)?, Gather::nearest(20, 1.0)?] {
            let estimate = collision_density(&map, DVec3::new(0.5, x, 0.5), Kernel::Uniform, gather);
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
        gathers.map(|g| in_scattered(&map, *point, DVec3::Z, &hg(0.7), Spectrum::ONE, Kernel::Gaussian, g))
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
                let estimate = in_scattered(&map, at, DVec3::Y, &phase, Spectrum::grey(2.0), kernel, gather);
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

const GATHERS: usize = 3;

fn gathers(scale: f64) -> [Gather; GATHERS] {
    [
        Gather::radius(0.3 * scale).unwrap(),
        Gather::nearest(20, scale).unwrap(),
        Gather::nearest_biased(20, scale).unwrap(),
    ]
}

proptest! {
    #![proptest_config(crate::common::config(60))]

    /// Powers times a constant give the estimate times it; a power of two changes no bit.
    #[test]
    fn linear_in_power(count in 1u64..400, seed in any::<u64>(), exponent in -60i32..60, which in 0..5usize) {
        let plain = photons(count, seed);
        let factor = libm::ldexp(1.0, exponent);
        let scaled = plain.iter().map(|p| Photon { power: p.power * factor as f32, ..*p }).collect();
        let (plain, scaled) = (map(plain), map(scaled));
        for gather in gathers(1.0) {
            let ask = |map| collision_density(map, DVec3::splat(0.5), Kernel::ALL[which], gather);
            prop_assert_eq!(ask(&plain).value * factor, ask(&scaled).value);
        }
    }

    /// At a fixed radius two maps of one emission add up to the map of both.
    #[test]
    fn additive_over_maps(count in 2u64..400, seed in any::<u64>(), part in 0.0..1.0f64, which in 0..5usize) {
        let all = photons(count, seed);
        let (a, b) = all.split_at((part * count as f64) as usize);
        // Corners that hold the box in place: the parts are then stored as they are in the whole.
        let corners = [0.0, 1.0].map(|c| Photon { position: DVec3::splat(c), power: Vec3::ZERO, ..all[0] });
        let with_corners = |part: &[Photon]| map([part, &corners].concat());
        let ask = |part: &[Photon]| {
            let (at, kernel) = (DVec3::splat(0.5), Kernel::ALL[which]);
            collision_density(&with_corners(part), at, kernel, gathers(1.0)[0]).value
        };
        // Sums of at most 400 non-negative terms: each rounds within 32 x 2^-24.
        prop_assert!(is_close(ask(a) + ask(b), ask(&all), 4e-6));
    }

    /// The order of arrival changes no bit.
    #[test]
    fn invariant_under_permutation(count in 2u64..400, seed in any::<u64>(), which in 0..5usize) {
        let all = photons(count, seed);
        let reversed = map(all.iter().rev().copied().collect());
        let all = map(all);
        for gather in gathers(1.0) {
            let ask = |map| collision_density(map, DVec3::splat(0.5), Kernel::ALL[which], gather);
            prop_assert_eq!(ask(&all), ask(&reversed));
        }
    }

    /// Lengths times a power of two s: the same photons, and the fluence times s^-2, bit for bit.
    #[test]
    fn lengths_scale_the_fluence(
        count in 1u64..400,
        seed in any::<u64>(),
        exponent in -30i32..30,
        which in 0..5usize,
    ) {
        let s = libm::ldexp(1.0, exponent);
        let plain = photons(count, seed);
        let larger = map(plain.iter().map(|p| Photon { position: p.position * s, ..*p }).collect());
        let plain = map(plain);
        for (gather, scaled) in gathers(1.0).into_iter().zip(gathers(s)) {
            let at = DVec3::splat(0.5);
            let a = fluence(&plain, at, Spectrum::grey(0.7), Kernel::ALL[which], gather);
            let b = fluence(&larger, at * s, Spectrum::grey(0.7 / s), Kernel::ALL[which], scaled);
            prop_assert_eq!(a.value, b.value * (s * s));
            prop_assert_eq!((a.radius * s, a.found, a.underfull), (b.radius, b.found, b.underfull));
        }
    }

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
        for gather in &gathers(1.0)[..2] {
            let ask = |map, at, wo| {
                in_scattered(map, at, wo, &hg(0.6), Spectrum::ONE, Kernel::Biweight, *gather)
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
