//! Weight windows, the variance of the k nearest, and the noise that is advised.

use crate::support::quadrature::integrate;
use crate::support::run::sensor;
use crate::support::scenes::{self, isotropic, sphere};
use crate::support::verdict;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::light::Faces;
use turbid::math::exp;
use turbid::photons::{Flags, Histories, Photon, PhotonMap, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Scene, SceneParts};
use turbid::sensor::{Pilot, PilotSettings};
use turbid::stats::Moments;
use turbid::transport::window;
use turbid::transport::{NoProgress, Roulette};

/// How many photons go on, in the mean over evenly spaced random numbers, times the factor on their weight: 1, to the last
/// bit, for every ratio that the numbers resolve.
pub fn a_window_keeps_the_weight() {
    const STEPS: u32 = 1 << 12;
    let ratios = (0..=16 * 64).map(|i| f64::from(i) / 64.0).chain([1e-300, 1e-9, 0.1, 1e9, f64::INFINITY]);
    for ratio in ratios {
        let (mut count, mut factors) = (0u64, Vec::new());
        for step in 0..STEPS {
            let (copies, factor) = window(ratio, || (f64::from(step) + 0.5) / f64::from(STEPS));
            count += copies as u64;
            factors.push(factor);
        }
        factors.dedup();
        assert_eq!(factors.len(), 1, "the factor depends on chance at {ratio}");
        let kept = count as f64 / f64::from(STEPS) * factors[0];
        // A chance of 0.1 is no multiple of 2^-12.
        let bound = if ratio < 0.125 { 0.5 * factors[0] / f64::from(STEPS) } else { 2.0 * f64::EPSILON };
        assert!((kept - 1.0).abs() <= bound, "{kept} of the weight at {ratio}");
    }
}

/// Of 8 million photons that collide at albedo 0.9 as many go on as it says, to a thousandth, with their power unchanged;
/// coloured ones and paths carry the albedo by channel, exactly.
pub fn photons_survive_as_the_albedo_says() {
    const BLOCK: u64 = 1 << 15;
    let albedo = Spectrum::grey(0.9);
    let survived: u64 = (0..256)
        .map(|history| {
            let mut stream = Stream::new(84, Purpose::Synthetic, 0, history);
            (0..BLOCK)
                .filter(|_| Roulette::Analog.survive(Spectrum::ONE, albedo, &mut stream).is_some())
                .count() as u64
        })
        .sum();
    verdict::rate("survivors", survived, 256 * BLOCK, 0.9, 9e-4, 84);
    let (weight, albedo) = (Spectrum::rgb(1.0, 0.5, 2.0), Spectrum::rgb(0.2, 0.9, 0.6));
    let mut stream = Stream::new(85, Purpose::Synthetic, 0, 0);
    let path = Roulette::below(1e-3).survive(weight, albedo, &mut stream).unwrap();
    let photon = (0..64).find_map(|_| Roulette::Analog.survive(weight, albedo, &mut stream)).unwrap();
    for c in 0..3 {
        let kept = weight[c] * albedo[c];
        assert!((path[c] / kept - 1.0).abs() < 1e-15, "{path:?}");
        // All photons keep the summed power.
        let sum = (weight * albedo).sum();
        assert!((photon[c] / (kept * weight.sum() / sum) - 1.0).abs() < 1e-14, "{photon:?}");
    }
}

/// One photon of power 1, emitted alone, in a ball of radius r about it: 3/(4 pi r^3), to single precision.
pub fn one_photon_is_one_over_its_ball() {
    let photon = Photon {
        position: DVec3::new(0.1, -0.2, 0.3),
        dir: Vec3::Z,
        normal: Vec3::ZERO,
        power: Vec3::ONE,
        order: 1,
        flags: Flags::MEDIUM,
    };
    let map = PhotonMap::new(vec![photon], 1).unwrap();
    for r in [0.01, 0.5, 7.0] {
        let estimator = Estimator::new(Kernel::Uniform, Gather::radius(r).unwrap());
        let found = estimator.collision_density(&map, photon.position, &Boundary::UNKNOWN).value[0];
        let expected = 3.0 / (4.0 * PI * r * r * r);
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected}");
    }
}

/// Relative variance of the k nearest by its definition, q E(S^2) E(1/V_k^2) - 1 with E(1/V^2) by quadrature of the gamma
/// density, and E(S^2) of k - 1 uniform places from the kernel's own moments: in balls and on discs, from k = 3 on.
pub fn the_k_nearest_vary_as_their_volume() {
    for kernel in Kernel::ALL {
        for is_disc in [false, true] {
            // Where uniform places are: 3 u^2 du in a ball, 2 u du on a disc. The kernel is over its mean of 1 there.
            let value = |u: f64| match is_disc {
                true => kernel.disc_peak() * kernel.profile(u * u) * PI,
                false => kernel.peak() * kernel.profile(u * u) * 4.0 / 3.0 * PI,
            };
            let place = |u: f64| if is_disc { 2.0 * u } else { 3.0 * u * u };
            let first = integrate(0.0, 1.0, 8, |u| place(u) * value(u));
            let second = integrate(0.0, 1.0, 8, |u| place(u) * value(u) * value(u));
            assert!((first - 1.0).abs() < 1e-9, "{kernel:?} integrates to {first}");
            for k in [3u32, 4, 5, 7, 10, 30] {
                let n = f64::from(k) - 1.0;
                // x^(k-1) e^-x/(k-1)! over x^2.
                let factorial: f64 = (1..k).map(f64::from).product();
                let inverse = integrate(0.0, 200.0, 200, |x| {
                    (0..k - 3).fold(exp(-x), |product, _| product * x) / factorial
                });
                for (q, density) in [(1.0, 1.0), (2.5, 40.0)] {
                    let expected = (n * q * second + n * (n - 1.0)) * inverse - 1.0;
                    let gather = Gather::nearest(k as usize, 1e9).unwrap();
                    let found = match is_disc {
                        true => gather.expected_disc_variance(kernel, density, q),
                        false => gather.expected_relative_variance(kernel, density, q),
                    };
                    let what = format!("{kernel:?}, disc {is_disc}, k {k}, q {q}: {found} for {expected}");
                    assert!((found / expected - 1.0).abs() < 1e-8, "{what}");
                }
            }
        }
    }
}

/// Pilots of a ball without absorption in isotropic light, whose field does not bend, so that each takes the largest
/// radius: the mean of the noise that they promise of `PHOTONS` photons against what 1,024 maps of as many show.
pub fn advised_noise_is_that_of_maps() {
    const PHOTONS: u64 = 512;
    const MAPS: u64 = 1024;
    let at = [0.0, 1.3, -1.3].map(|x| DVec3::new(x, 0.0, 0.0));
    let whole = || sphere(DVec3::ZERO, 2.0);
    let scene = scenes::ball(2.0, 1.0, 0.0, isotropic(whole(), Faces::Both));
    let scene = Scene::new(SceneParts {
        regions: scene.regions().to_vec(),
        lights: scene.lights().to_vec(),
        sensors: at.map(|p| sensor(Quantity::Fluence(p), Orders::ALL)).to_vec(),
        ..SceneParts::default()
    })
    .unwrap();
    let advised: Vec<_> = (0..64)
        .map(|seed| {
            let settings = PilotSettings { photons: PHOTONS, maps: 32, seed: 3000 + seed };
            Pilot::run(&scene, &settings, &NoProgress).unwrap().advise(0.2).unwrap()
        })
        .collect();
    let radius = 0.7;
    assert!(advised.iter().all(|a| a.radius <= radius * (1.0 + 1e-12)), "no room for more");
    // Read where most pilots read, and scaled to one number of photons.
    let noise: Moments = advised
        .iter()
        .filter(|a| a.radius > 0.99 * radius)
        .map(|a| a.noise * a.noise * a.photons as f64 / PHOTONS as f64)
        .collect::<Vec<f64>>()
        .iter()
        .collect();
    let mut squares = Moments::new();
    for replicate in 0..MAPS {
        let histories = Histories { count: PHOTONS, seed: 83, replicate, max_order: None };
        let pass = shoot(&scene, histories, &[], |_| true, &NoProgress).unwrap();
        let map = pass.into_map(0.0).unwrap();
        let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius).unwrap());
        // The fluence is 4 everywhere, but for photons that a ball loses nowhere.
        let error = |p: &DVec3| {
            estimator.fluence(&map, *p, Spectrum::ONE, &Boundary::UNKNOWN).value.mean() / 4.0 - 1.0
        };
        squares.push(at.iter().map(|p| error(p) * error(p)).sum::<f64>() / at.len() as f64);
    }
    let promise = 0.25 * squares.mean();
    verdict::println_line(&format!("{} of 64 pilots at the largest radius", noise.n()));
    verdict::agree("squared noise, advised and of maps", &noise, &squares, promise, 83);
}
