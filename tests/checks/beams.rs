//! Beams: sums by hand, and light scattered once in slabs in channels of their own.

use crate::support::run::sensor;
use crate::support::scenes::{CELL, Incidence, homogeneous, incidence, layer, region};
use crate::support::verdict;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::FRAC_PI_4;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{BeamEstimator, Estimator, Gather, Kernel};
use turbid::math::{FOUR_PI, Interval, Positive, Ray, cos, exp, exp_m1, sin, sin_cos};
use turbid::photons::beams::{Beam, BeamKind, BeamMap};
use turbid::photons::{Emitter, Flags, Histories, Pass, Photon, Run, Storage};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{MapSettings, RadianceMaps, SensorMaps};
use turbid::stats::Moments;
use turbid::transport::{NoProgress, Walker};

/// A beam of power 1 in the first medium.
pub fn beam(start: DVec3, dir: DVec3, length: f64, kind: BeamKind) -> Beam {
    Beam { start, dir, length, power: Vec3::ONE, medium: 0, order: 0, flags: Flags::NONE, kind }
}

pub fn map(beams: Vec<Beam>) -> BeamMap {
    BeamMap::new(vec![beams], 1, None).unwrap()
}

pub fn reading(kernel: Kernel, radius: f64) -> BeamEstimator {
    BeamEstimator { kernel, radius: Positive::new("the radius", radius).unwrap(), is_clipped: false }
}

/// The radiance along a ray from its origin, in a medium of extinction 1 and albedo 0.5.
fn read(map: &BeamMap, kernel: Kernel, ray: Ray, g: f64) -> f64 {
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), g);
    let span = Interval { start: 0.0, end: 4.0 };
    let beer = |t: f64| Spectrum::grey(exp(-t));
    let of = (0, &medium);
    reading(kernel, 0.1).radiance(map, (&ray, span), of, &Boundary::UNKNOWN, &beer).value[0]
}

/// One beam and one ray across it, square and aslant: products of six factors, by hand.
pub fn one_beam_by_hand() {
    let square = Ray::new(DVec3::new(-2.0, 0.03, 0.7), DVec3::X);
    let aslant = Ray::new(DVec3::new(-1.0, 0.03, -0.5), DVec3::new(0.5, 0.0, 0.75f64.sqrt()));
    let long = |length| map(vec![beam(DVec3::ZERO, DVec3::Z, length, BeamKind::Expected)]);
    let short = |length| map(vec![beam(DVec3::ZERO, DVec3::Z, length, BeamKind::Sampled)]);
    for (what, map, kernel, ray, expected) in [
        ("long", long(4.0), Kernel::Uniform, square, 0.007_175_155),
        ("long", long(4.0), Kernel::Epanechnikov, square, 0.009_794_087),
        ("long", long(4.0), Kernel::Biweight, square, 0.011_140_773),
        ("short", short(4.0), Kernel::Uniform, square, 0.014_448_988),
        ("too short", short(0.6), Kernel::Uniform, square, 0.0),
        ("aslant", long(4.0), Kernel::Uniform, aslant, 0.003_827_174),
    ] {
        let found = read(&map, kernel, ray, 0.5);
        assert!((found - expected).abs() <= 2e-7 * expected, "{what}, {kernel:?}: {found}");
    }
    // Beyond the radius, and behind the end of the stretch.
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.5);
    for (radius, end) in [(0.0299, 4.0), (0.1, 1.99)] {
        let span = Interval { start: 0.0, end };
        let of = (0, &medium);
        let all = |_| Spectrum::ONE;
        let estimate = reading(Kernel::Uniform, radius).radiance(
            &short(4.0),
            (&square, span),
            of,
            &Boundary::UNKNOWN,
            &all,
        );
        assert_eq!((estimate.value, estimate.found), (Spectrum::ZERO, 0));
    }
}

/// A ray that looks along a laser within a thousandth of it: all of 1/sin(theta) counts.
pub fn a_laser_end_on_counts_in_full() {
    let (angle, expected) = (1e-3, 26.924_108);
    let ray = Ray::new(DVec3::new(-angle, 0.03, 0.0), DVec3::new(sin(angle), 0.0, cos(angle)));
    let laser = map(vec![beam(DVec3::ZERO, DVec3::Z, 4.0, BeamKind::Expected)]);
    let found = read(&laser, Kernel::Uniform, ray, 0.0);
    assert!((found / expected - 1.0).abs() < 1e-7, "{found}");
    // Ever nearer the light grows as 1/sin(theta), here down to a millionth of a degree.
    for angle in [1e-4, 1e-6, 2e-8] {
        let ray = Ray::new(DVec3::new(-angle, 0.03, 0.0), DVec3::new(sin(angle), 0.0, cos(angle)));
        let found = read(&laser, Kernel::Uniform, ray, 0.0);
        assert!((found * angle / (expected * 1e-3) - 1.0).abs() < 1e-5, "{angle}: {found}");
    }
    // Exactly parallel it has no nearest point.
    assert_eq!(read(&laser, Kernel::Uniform, Ray::new(DVec3::new(0.0, 0.03, -1.0), DVec3::Z), 0.0), 0.0);
}

/// The whole of a line's kernel counts once, and half of it on each side.
pub fn a_line_counts_once() {
    for kernel in Kernel::ALL {
        let mut sum = 0.0;
        let steps = 20_000;
        for step in 0..steps {
            let u = (f64::from(step) + 0.5) / f64::from(steps);
            let laser = map(vec![beam(DVec3::new(0.0, 0.1 * u, 0.0), DVec3::Z, 4.0, BeamKind::Sampled)]);
            sum += read(&laser, kernel, Ray::new(DVec3::new(-2.0, 0.0, 0.7), DVec3::X), 0.0);
            if step % 1000 == 0 {
                let within = 0.1 * sum / f64::from(steps) * FOUR_PI / (0.5 * exp(-2.0));
                let end = f64::from(step + 1) / f64::from(steps);
                assert!((within - 0.5 * kernel.within_line(end)).abs() < 1e-6, "{kernel:?} {u}");
            }
        }
        let whole = 2.0 * 0.1 * sum / f64::from(steps) * FOUR_PI / (0.5 * exp(-2.0));
        assert!((whole - 1.0).abs() < 1e-6, "{kernel:?}: {whole}");
    }
}

/// An estimator of beams across rays.
pub fn across(kernel: Kernel, radius: f64) -> Estimator {
    let balls = Estimator::new(kernel, Gather::radius(0.1).unwrap());
    balls.along_beams(Positive::new("the radius", radius).unwrap())
}

/// What every sensor says by every estimator, told map by map.
fn every_map(
    scene: &Scene,
    (photons, maps): (u64, u64),
    seed: u64,
    estimators: &[Estimator],
    mut tell: impl FnMut(usize, &[Vec<Spectrum>]),
) {
    let reach = estimators.iter().map(Estimator::reach).fold(0.0, f64::max);
    let radiance = RadianceMaps::of(estimators);
    for replicate in 0..maps {
        let settings = MapSettings { photons, seed, replicate, reach, readings: 1, radiance };
        let maps = SensorMaps::fill(scene, settings, &NoProgress).unwrap();
        for (index, estimator) in estimators.iter().enumerate() {
            tell(index, &maps.read(estimator).unwrap().values);
        }
    }
}

/// Moments of every sensor and channel by every estimator, over maps.
pub fn by_maps(
    scene: &Scene,
    counts: (u64, u64),
    seed: u64,
    estimators: &[Estimator],
) -> Vec<Vec<[Moments; 3]>> {
    let mut all = vec![vec![[Moments::new(); 3]; scene.sensors().len()]; estimators.len()];
    every_map(scene, counts, seed, estimators, |index, values| {
        for (values, moments) in values.iter().zip(&mut all[index]) {
            (0..3).for_each(|channel| moments[channel].push(values[0][channel]));
        }
    });
    all
}

/// A slab of one mean free path, looked into under a cosine `mu` along eight azimuths, from places of its own each at a depth.
pub fn looked_into((how, albedo, g): (Incidence, f64, f64), (mu, depth): (f64, f64)) -> Scene {
    let looking = |n: u32| {
        let (sin, cos) = sin_cos(FRAC_PI_4 * f64::from(n));
        let across = (1.0 - mu * mu).max(0.0).sqrt();
        let place = DVec3::new(f64::from(n % 4), f64::from(n / 4) * 2.0, 4.0 * depth / CELL) * CELL / 4.0;
        let dir = DVec3::new(cos * across, sin * across, mu);
        sensor(Quantity::Radiance(Ray::new(place, dir.normalize())), Orders::SCATTERED)
    };
    Scene::new(SceneParts {
        lights: vec![incidence(layer(1.0), how)],
        regions: vec![region(layer(1.0), 1.0, albedo, g)],
        sensors: (0..8).map(looking).collect(),
        cell: Some(DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap()
}

/// Photons and their flights, whole or as they were sampled.
pub struct Flights {
    pub is_whole: bool,
}

impl Storage for Flights {
    fn in_medium(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }

    fn has_beams(&self) -> bool {
        true
    }

    fn has_whole_beams(&self) -> bool {
        self.is_whole
    }

    fn on_flight(&self, _history: u64, _walker: &Walker) -> bool {
        true
    }
}

impl Flights {
    /// A pass that stores them.
    pub fn pass(self, scene: &Scene, count: u64, seed: u64) -> Pass {
        let histories = Histories { count, seed, replicate: 0, max_order: None };
        Run::new(scene, &Emitter::by_power(scene), histories).pass(&self, &NoProgress).unwrap()
    }
}

/// Moments of the mean of all sensors by every estimator, over maps.
pub fn means_by_maps(scene: &Scene, counts: (u64, u64), seed: u64, estimators: &[Estimator]) -> Vec<Moments> {
    let mut all = vec![Moments::new(); estimators.len()];
    every_map(scene, counts, seed, estimators, |index, values| {
        all[index].push(values.iter().map(|values| values[0][0]).sum::<f64>() / values.len() as f64);
    });
    all
}

/// Light of a beam that leaves a slab after one scattering, in three channels of different extinction: beams meet the rays level,
/// so that no radius changes anything.
pub fn light_scattered_once_in_three_channels() {
    let (sigma_t, albedo) = ([0.5, 1.0, 2.0], [0.9, 0.5, 0.7]);
    let mus = [0.5, 0.9];
    let shape = layer(1.0);
    let looks = mus.map(|mu: f64| {
        let travel = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, -mu);
        Ray::new(DVec3::new(0.5 * CELL, 0.5 * CELL, 0.0), -travel)
    });
    let medium = homogeneous(Spectrum(sigma_t.into()), Spectrum(albedo.into()), 0.0);
    let scene = Scene::new(SceneParts {
        lights: vec![incidence(shape.clone(), Incidence::Beam(1.0))],
        regions: vec![Region { shape, medium }],
        sensors: looks.iter().map(|ray| sensor(Quantity::Radiance(*ray), Orders::only(1))).collect(),
        cell: Some(DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap();
    let estimators = [across(Kernel::Uniform, 0.2), across(Kernel::Biweight, 0.8)];
    let measured = by_maps(&scene, (1500, 300), 3, &estimators);
    for (estimator, measured) in estimators.iter().zip(&measured) {
        for (mu, moments) in mus.iter().zip(measured) {
            for channel in 0..3 {
                let depth = sigma_t[channel] * (1.0 + 1.0 / mu);
                let expected = -albedo[channel] / FOUR_PI / (1.0 + mu) * exp_m1(-depth);
                let what = format!("{}, mu {mu}, channel {channel}", estimator.name());
                verdict::agrees(&what, &moments[channel], (expected, 1e-12), 0.2 * expected, 3);
            }
        }
    }
}
