//! Beams blurred in two and three dimensions, long beams, and beams at places: sums by hand, chords one by one, exact slabs, furnaces,
//! variance as predicted.

use crate::checks::beams::{Flights, across, beam, by_maps, looked_into, map, means_by_maps, reading};
use crate::checks::media::{layered, varying};
use crate::checks::slab::{exact, referee};
use crate::support::run::sensor;
use crate::support::scenes::{
    CELL, Incidence, bounded, cuboid, homogeneous, incidence, layer, point_light, region, sphere,
};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{BeamBlur, BeamEstimator, Estimator, Kernel};
use turbid::math::{FOUR_PI, Interval, Positive, Ray, cos, exp, exp_m1, sin, warp};
use turbid::photons::Photon;
use turbid::photons::beams::{Beam, BeamKind, BeamLength, BeamMap};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Henyey and Greenstein's phase function by the cosine of the angle.
fn phase(g: f64, mu: f64) -> f64 {
    // Sums of what is not negative: narrow peaks keep their digits.
    let squared = if g < 0.0 {
        (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + mu)
    } else {
        (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - mu)
    };
    (1.0 - g * g) / (FOUR_PI * squared * squared.sqrt())
}

/// The radiance along a ray from its origin over a length of 4, in a medium of extinction 1 and albedo 0.5, blurred across the ray.
fn in_2d(map: &BeamMap, kernel: Kernel, ray: Ray, g: f64) -> f64 {
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), g);
    let span = Interval { start: 0.0, end: 4.0 };
    let beer = |t: f64| Spectrum::grey(exp(-t));
    let of = (0, &medium);
    reading(kernel, 0.1).radiance_in_2d(map, (&ray, span), of, &Boundary::UNKNOWN, &beer).value[0]
}

/// One beam exactly along a ray, with it and against it, drawn and to its end, in narrow peaks too, near and far from the origin:
/// what passes along both, times five factors.
#[test]
fn a_beam_along_a_ray_by_hand() {
    let (sampled, whole) = (BeamKind::Sampled, BeamKind::Expected);
    for by in [DVec3::ZERO, DVec3::new(1e6, -3e6, 2e6)] {
        let ray = Ray::new(DVec3::new(0.0, 0.03, -1.0) + by, DVec3::Z);
        for (kind, start, dir, length, along) in [
            (sampled, DVec3::ZERO, DVec3::Z, 2.0, exp(-1.0) - exp(-3.0)),
            (whole, DVec3::ZERO, DVec3::Z, 2.0, 0.5 * (exp(-1.0) - exp(-5.0))),
            // From before the eye to behind the end of the stretch.
            (sampled, DVec3::NEG_Z * 7.0, DVec3::Z, 40.0, 1.0 - exp(-4.0)),
            (sampled, DVec3::Z * 2.0, DVec3::NEG_Z, 2.0, exp(-1.0) - exp(-3.0)),
            (whole, DVec3::Z * 2.0, DVec3::NEG_Z, 2.0, 2.0 * exp(-3.0)),
        ] {
            let map = map(vec![beam(start + by, dir, length, kind)]);
            for kernel in Kernel::ALL {
                for g in [0.0, 0.5, 0.9999, -0.9999] {
                    let value = 0.5 * phase(g, -dir.z) * kernel.disc_peak() * kernel.profile(0.09) / 0.01;
                    let (found, expected) = (in_2d(&map, kernel, ray, g), value * along);
                    let error = if by == DVec3::ZERO { 1e-12 } else { 1e-7 };
                    assert!(
                        (found / expected - 1.0).abs() < error,
                        "{kernel:?} {g} {dir}: {found} {expected}"
                    );
                }
            }
        }
        let beside = Ray::new(DVec3::new(0.0, 0.1001, -1.0) + by, DVec3::Z);
        let one = map(vec![beam(by, DVec3::Z, 2.0, sampled)]);
        assert_eq!(in_2d(&one, Kernel::Uniform, beside, 0.0), 0.0);
    }
}

/// One beam square across a ray: its chord, whole, cut by its end, and missed; and ever nearer to the ray's direction what it is along it.
#[test]
fn a_beam_across_a_ray_by_hand() {
    let ray = Ray::new(DVec3::new(-2.0, 0.03, 0.7), DVec3::X);
    let half = (0.01f64 - 0.0009).sqrt();
    let value = 0.5 * phase(0.5, 0.0) * exp(-2.0) / (PI * 0.01);
    for (length, chord) in [
        (4.0, 2.0 * half),
        (0.65, 0.65 - 0.7 + half),
        (0.6, 0.0),
        (0.7, half),
        (0.7 + half + 1e-9, 2.0 * half),
    ] {
        let found = in_2d(
            &map(vec![beam(DVec3::ZERO, DVec3::Z, length, BeamKind::Sampled)]),
            Kernel::Uniform,
            ray,
            0.5,
        );
        assert!((found - value * chord).abs() <= 1e-12 * value, "{length}: {found} {}", value * chord);
    }
    // The part of a disc's kernel over the chord, by steps of its own.
    for kernel in Kernel::ALL {
        let steps = 100_000;
        let width = 2.0 * half / f64::from(steps);
        let over = |step: u32| {
            let z = -half + width * (f64::from(step) + 0.5);
            kernel.profile((0.0009 + z * z) / 0.01)
        };
        let chord: f64 = (0..steps).map(over).sum::<f64>() * width * kernel.disc_peak() * PI;
        let found = in_2d(&map(vec![beam(DVec3::ZERO, DVec3::Z, 4.0, BeamKind::Sampled)]), kernel, ray, 0.5);
        assert!((found / (value * chord) - 1.0).abs() < 1e-6, "{kernel:?}: {found}");
    }
    let along = Ray::new(DVec3::new(0.0, 0.03, -1.0), DVec3::Z);
    let straight =
        in_2d(&map(vec![beam(DVec3::ZERO, DVec3::Z, 2.0, BeamKind::Sampled)]), Kernel::Uniform, along, 0.5);
    for angle in [1e-3, 1e-6, 1e-9, 1e-14, 1e-17] {
        let dir = DVec3::new(sin(angle), 0.0, cos(angle));
        let found =
            in_2d(&map(vec![beam(DVec3::ZERO, dir, 2.0, BeamKind::Sampled)]), Kernel::Uniform, along, 0.5);
        // It stays within the radius; the cosine and what passes differ by the square of the angle.
        assert!((found / straight - 1.0).abs() < 3.0 * angle * angle + 1e-12, "{angle}: {found}");
    }
}

/// Fluence beside a beam, blurred in the ball about the place: published; by steps of its own for every kernel; cut by its end.
#[test]
fn a_beam_through_a_ball_by_hand() {
    let even = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.5);
    let read = |kernel: Kernel, kind: BeamKind, length: f64, radius: f64| {
        let map = map(vec![beam(DVec3::ZERO, DVec3::Z, length, kind)]);
        let place = DVec3::new(0.06, 0.0, 0.7);
        let estimate = reading(kernel, radius).fluence_in_3d(&map, place, (0, &even), &Boundary::UNKNOWN);
        assert!(estimate.found <= 1);
        estimate.value[0]
    };
    let (sampled, whole) = (BeamKind::Sampled, BeamKind::Expected);
    for (kind, length, expected) in [
        (sampled, 4.0, 38.197_186),
        (whole, 4.0, 18.988_401),
        (sampled, 0.7, 0.5 * 38.197_186),
        (sampled, 0.6199, 0.0),
    ] {
        let found = read(Kernel::Uniform, kind, length, 0.1);
        assert!((found - expected).abs() <= 3e-8 * expected, "{kind:?} {length}: {found}");
    }
    for kernel in Kernel::ALL {
        for (kind, rate) in [(sampled, 0.0), (whole, 1.0)] {
            // Larger than the beam is long, too.
            for radius in [0.1, 0.5, 9.0] {
                let steps = 200_000;
                let width = 4.0 / f64::from(steps);
                let over = |step: u32| {
                    let t = width * (f64::from(step) + 0.5);
                    let u2 = (0.0036 + (t - 0.7) * (t - 0.7)) / (radius * radius);
                    if u2 < 1.0 { exp(-rate * t) * kernel.profile(u2) } else { 0.0 }
                };
                let integral: f64 = (0..steps).map(over).sum::<f64>() * width;
                let expected = integral * kernel.peak() / (radius * radius * radius);
                let found = read(kernel, kind, 4.0, radius);
                // Two ends of the uniform kernel fall anywhere in a step.
                let error = 2e-4;
                assert!(
                    (found / expected - 1.0).abs() < error,
                    "{kernel:?} {kind:?} {radius}: {found} {expected}"
                );
            }
        }
    }
}

/// Random beams, cut into pieces by the tree, some without length and some along the ray: the parts that are near a ray, and near a place,
/// add up to what a formula of textbooks finds of each whole beam, and the first part is told once.
#[test]
fn chords_are_those_found_one_by_one() {
    let mut stream = Stream::new(31, Purpose::Synthetic, 0, 0);
    let mut met = 0;
    for trial in 0..80 {
        let size = libm::exp10(6.0 * stream.unit() - 3.0);
        let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
        let axis = warp::square_to_sphere(stream.pair());
        let beams: Vec<Beam> = (0..[1, 17, 400, 1500][trial % 4])
            .map(|which| {
                let start = far + (DVec3::from(stream.triple()) - 0.5) * size;
                let about = warp::square_to_sphere(stream.pair());
                let dir = match which % 6 {
                    0 => axis,
                    1 => -axis,
                    2 => (axis + about * 0.01).normalize(),
                    _ => about,
                };
                let length = size * [0.0, 0.05, 1.0, 30.0][which % 4] * stream.unit();
                beam(start, dir, length, BeamKind::Sampled)
            })
            .collect();
        let map = map(beams.clone());
        for which in 0..6 {
            let dir = if which < 3 { axis } else { warp::square_to_sphere(stream.pair()) };
            let through = far + (DVec3::from(stream.triple()) - 0.5) * size;
            let ray = Ray::new(through - dir * size, dir);
            let span = Interval { start: size * stream.unit(), end: size * (1.0 + stream.unit()) };
            let radius = size * [0.01, 0.1, 5.0][which % 3];
            let [mut lengths, mut firsts] = [[0.0; 2], [0.0; 2]];
            assert!(map.chords_near(&ray, span, radius, |_, chord, _| {
                lengths[0] += chord.end - chord.start;
                firsts[0] += f64::from(u8::from(chord.is_first));
            }));
            assert!(map.chords_about(through, radius, |_, chord, _| {
                lengths[1] += chord.end - chord.start;
                firsts[1] += f64::from(u8::from(chord.is_first));
            }));
            let mut expected = [0.0; 2];
            let mut count = [0.0; 2];
            for beam in &beams {
                // From where to where a squared distance a t^2 + 2 b t + c is within the radius, on the beam.
                let within = |a: f64, b: f64, c: f64| {
                    let root = b * b - a * c;
                    match a > 1e-12 {
                        true if root > 0.0 => ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a),
                        false if c <= 0.0 => (f64::NEG_INFINITY, f64::INFINITY),
                        _ => (0.0, 0.0),
                    }
                };
                let mut add = |index: usize, (from, to): (f64, f64), (low, high): (f64, f64)| {
                    let (from, to) = (from.max(0.0).max(low), to.min(beam.length).min(high));
                    if from < to {
                        expected[index] += to - from;
                        count[index] += 1.0;
                    }
                };
                let v = beam.start - ray.origin;
                let (c, vd, vw) = (dir.dot(beam.dir), v.dot(dir), v.dot(beam.dir));
                let near = within(1.0 - c * c, vw - c * vd, v.length_squared() - vd * vd - radius * radius);
                let ends = [span.start, span.end].map(|s| (s - vd) / c);
                add(0, near, (ends[0].min(ends[1]), ends[0].max(ends[1])));
                let v = beam.start - through;
                let near = within(1.0, v.dot(beam.dir), v.length_squared() - radius * radius);
                add(1, near, (f64::NEG_INFINITY, f64::INFINITY));
            }
            for index in 0..2 {
                let error = 1e-6 * expected[index] + 1e-6 * size * beams.len() as f64;
                let off = (lengths[index] - expected[index]).abs();
                assert!(off <= error, "{trial} {which} {index}: {} {}", lengths[index], expected[index]);
                assert!((firsts[index] - count[index]).abs() <= 1.0, "{trial} {which}: {firsts:?} {count:?}");
            }
            met += count[0] as u32;
        }
    }
    assert!(met > 2000, "{met}");
}

/// Beams of both lengths, read in one and in two dimensions.
fn of_length(radius: f64, blur: BeamBlur, length: BeamLength) -> Estimator {
    across(Kernel::Uniform, radius).blurred(blur).of_length(length)
}

/// What leaves a slab aslant: in two dimensions what points along rays have, published, in one what beams have; the same by long beams,
/// with less variance from the same photons.
#[test]
fn radiance_of_a_slab_by_every_blur_and_length() {
    let scene = looked_into((Incidence::Beam(1.0), 0.9, 0.0), (0.5, 0.0));
    let cases = [
        (0.1, BeamBlur::OneD, 0.093_460_6),
        (0.2, BeamBlur::OneD, 0.091_948_3),
        (0.1, BeamBlur::TwoD, 0.090_417_852),
        (0.2, BeamBlur::TwoD, 0.086_054_367),
    ];
    let mut variances = Vec::new();
    for length in BeamLength::ALL {
        let estimators = cases.map(|(radius, blur, _)| of_length(radius, blur, length));
        let measured = means_by_maps(&scene, (1500, 115), 35, &estimators);
        for ((estimator, moments), (.., expected)) in estimators.iter().zip(&measured).zip(cases) {
            verdict::agrees(&estimator.name(), moments, (expected, 1e-7), 0.05 * expected, 35);
        }
        verdict::rejects("the blur of one dimension", &measured[3], cases[1].2, 35);
        variances.push(measured[1].variance());
    }
    assert!(variances[1] < 0.9 * variances[0], "{variances:?}");
}

/// Along a beam that falls into a slab: in one dimension light scattered once is not found, in two nothing is lost, at any radius.
#[test]
fn looking_along_the_light() {
    let scene = looked_into((Incidence::Beam(1.0), 0.9, 0.0), (1.0, 0.0));
    for (length, seed) in BeamLength::ALL.into_iter().zip([36, 37]) {
        let estimators = [
            of_length(0.1, BeamBlur::TwoD, length),
            of_length(0.6, BeamBlur::TwoD, length),
            of_length(0.1, BeamBlur::OneD, length),
        ];
        let measured = means_by_maps(&scene, (3000, 150), seed, &estimators);
        let expected = 0.066_845_328;
        for (estimator, moments) in estimators.iter().zip(&measured).take(2) {
            verdict::agrees(&estimator.name(), moments, (expected, 1e-8), 0.06 * expected, seed);
        }
        verdict::rejects("in one dimension", &measured[2], expected, seed);
    }
}

/// A furnace, clipped: right at any radius in two dimensions too, by beams of both lengths.
#[test]
fn a_furnace_by_every_blur_and_length() {
    let scene = looked_into((Incidence::Both, 1.0, 0.0), (0.5, 0.0));
    let expected = 0.864_664_717 / PI;
    for (length, seed) in BeamLength::ALL.into_iter().zip([38, 39]) {
        let specimens = [
            (Kernel::Uniform, 0.2, BeamBlur::TwoD),
            (Kernel::Cone, 0.6, BeamBlur::TwoD),
            (Kernel::Biweight, 0.3, BeamBlur::OneD),
        ];
        let estimators = specimens.map(|(kernel, radius, blur)| {
            across(kernel, radius).blurred(blur).of_length(length).treated(Treatment::Clipped)
        });
        let measured = means_by_maps(&scene, (500, 64), seed, &estimators);
        for (estimator, moments) in estimators.iter().zip(&measured) {
            verdict::agrees(&estimator.name(), moments, (expected, 1e-4 * expected), 0.1 * expected, seed);
        }
    }
}

/// Fluence at depths of a slab by beams at places, blurred across them and in balls, of both lengths: uncollided light of a beam along
/// the normal is exact across it at any radius, and all of it is the exact one but for a blur far below the noise.
#[test]
fn fluence_of_a_slab() {
    let depths = [0.1, 0.5, 0.9];
    let slab = referee(1.0, 0.9, Incidence::Beam(1.0));
    let places = depths.map(|t| Quantity::Fluence(DVec3::new(0.3 * CELL, (0.2 + 0.5 * t) * CELL, t)));
    for (orders, radius, promise, seed) in [(Orders::only(0), 0.5, 0.09, 40), (Orders::ALL, 0.1, 0.2, 41)] {
        let scene = Scene::new(SceneParts {
            lights: vec![incidence(layer(1.0), Incidence::Beam(1.0))],
            regions: vec![region(layer(1.0), 1.0, 0.9, 0.0)],
            sensors: places.iter().map(|place| sensor(place.clone(), orders)).collect(),
            cell: Some(DVec2::splat(CELL)),
            ..SceneParts::default()
        })
        .unwrap();
        for length in BeamLength::ALL {
            let of = |blur: BeamBlur| {
                of_length(radius, blur, length).treated(Treatment::Clipped).with_beam_fluence()
            };
            let blurs = if orders == Orders::ALL { &BeamBlur::ALL[1..] } else { &BeamBlur::ALL[..1] };
            let estimators: Vec<Estimator> = blurs.iter().map(|blur| of(*blur)).collect();
            let maps = if orders == Orders::ALL { 110 } else { 64 };
            let measured = by_maps(&scene, (8000, maps), seed, &estimators);
            for (estimator, measured) in estimators.iter().zip(&measured) {
                for (t, moments) in depths.iter().zip(measured) {
                    let (expected, error) = match orders == Orders::ALL {
                        true => exact(slab.fluence(*t).unwrap()),
                        false => (exp(-t), 1e-12),
                    };
                    // The bend of the fluence is below three of itself: r^2/10 of it.
                    let error =
                        error + if orders == Orders::ALL { 0.3 * radius * radius * expected } else { 0.0 };
                    let what = format!("depth {t}, {}", estimator.name());
                    verdict::agrees(&what, &moments[0], (expected, error), promise * expected, seed);
                }
            }
        }
    }
}

/// Light scattered once in channels of different extinction, by long beams: in closed form.
#[test]
fn long_beams_in_three_channels() {
    let (sigma_t, albedo, mu) = ([0.5, 1.0, 2.0], [0.9, 0.5, 0.7], 0.5);
    let travel = DVec3::new((1.0f64 - mu * mu).sqrt(), 0.0, -mu);
    let ray = Ray::new(DVec3::new(0.5 * CELL, 0.5 * CELL, 0.0), -travel);
    let medium = homogeneous(Spectrum(sigma_t.into()), Spectrum(albedo.into()), 0.0);
    let scene = Scene::new(SceneParts {
        lights: vec![incidence(layer(1.0), Incidence::Beam(1.0))],
        regions: vec![Region { shape: layer(1.0), medium }],
        sensors: vec![sensor(Quantity::Radiance(ray), Orders::only(1))],
        cell: Some(DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap();
    let measured = by_maps(&scene, (1500, 200), 42, &[of_length(0.3, BeamBlur::OneD, BeamLength::Whole)]);
    for channel in 0..3 {
        let depth = sigma_t[channel] * (1.0 + 1.0 / mu);
        let expected = -albedo[channel] / FOUR_PI / (1.0 + mu) * exp_m1(-depth);
        let what = format!("channel {channel}");
        verdict::agrees(&what, &measured[0][0][channel], (expected, 1e-12), 0.2 * expected, 42);
    }
}

/// In a ball every flight is stored to the surface, with the power that it leaves with, and the walk goes on from where it was: the
/// photons are those of a pass that stores no beams. A blur in a ball is refused of rays.
#[test]
fn flights_are_stored_to_the_end_of_the_medium() {
    let ball = sphere(DVec3::ZERO, 1.5);
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.8), 0.3);
    let light = point_light(DVec3::new(0.3, 0.1, 0.0), Spectrum::ONE);
    let scene = bounded(vec![Region { shape: ball, medium }], vec![], vec![light.clone()]);
    let pass = Flights { is_whole: true }.pass(&scene, 2000, 4);
    let alone = crate::support::run::pass(&scene, &[], 2000, 4, |_| true);
    assert_eq!(pass.media, alone.media);
    let mut photons = pass.photons().peekable();
    let (mut collided, mut left) = (0, 0);
    for beam in pass.beams.iter().flatten() {
        assert!(
            (beam.at(beam.length).length() - 1.5).abs() < 1e-12 && beam.kind == BeamKind::Expected,
            "{beam:?}"
        );
        let is_its = |photon: &&Photon| {
            let way = photon.position - beam.start;
            let along = way.dot(beam.dir);
            photon.order == beam.order && (way - beam.dir * along).length() < 1e-12 && along < beam.length
        };
        match photons.peek().filter(|photon| is_its(photon)) {
            Some(photon) => {
                assert_eq!(photon.power, beam.power);
                photons.next();
                collided += 1;
            }
            None => left += 1,
        }
    }
    assert!(photons.next().is_none() && collided > 1000 && left > 500, "{collided} {left}");
    let corners = (DVec3::ZERO, DVec3::ONE);
    let uneven = varying(Spectrum::ONE, 0.5, layered(corners, 3, |z| z));
    let look = sensor(Quantity::Radiance(Ray::new(DVec3::ZERO, DVec3::Z)), Orders::SCATTERED);
    let scene = Scene::new(SceneParts {
        regions: vec![Region { shape: cuboid(corners.0, corners.1), medium: uneven }],
        lights: vec![point_light(DVec3::splat(0.4), Spectrum::ONE)],
        sensors: vec![look],
        ..SceneParts::default()
    })
    .unwrap();
    let of = |estimator: Estimator| {
        let settings = PhotonSettings { photons: 100, maps: 1, seed: 1, orders: Orders::ALL, estimator };
        by_photons(&scene, &settings, &NoProgress)
    };
    assert!(of(of_length(0.1, BeamBlur::TwoD, BeamLength::Sampled)).is_ok());
    let told = of(of_length(0.1, BeamBlur::ThreeD, BeamLength::Sampled)).unwrap_err().to_string();
    assert!(told.contains("rays have none; allowed: 1d, 2d"), "{told}");
}

/// Random lines through a ball, the same everywhere and from all sides: the mean in two dimensions is the field, and its variance over
/// that of one dimension that of lines and rays without end, 32/(3 pi^2), less what the ray's ends take of the longest chords.
#[test]
fn variance_in_two_dimensions() {
    let (count, size, radius) = (300, 2.0, 0.01);
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let ray = Ray::new(DVec3::new(0.1, -0.5, 0.2), DVec3::new(0.0, 0.8, 0.6));
    let span = Interval { start: 0.0, end: 1.0 };
    let reading = reading(Kernel::Uniform, radius);
    let (mut moments, mut squares) = (Moments::new(), 0.0);
    let maps = 6000;
    for replicate in 0..maps {
        let mut stream = Stream::new(43, Purpose::Synthetic, replicate, 0);
        let beams = (0..count).filter_map(|_| {
            let frame = turbid::math::Frame::new(warp::square_to_sphere(stream.pair()));
            let [x, y] = [stream.unit(), stream.unit()].map(|u| size * (2.0 * u - 1.0));
            let half = (size * size - x * x - y * y).max(0.0).sqrt();
            let start = frame.x * x + frame.y * y - frame.z * half;
            (half > 0.0).then(|| beam(start, frame.z, 2.0 * half, BeamKind::Sampled))
        });
        let map = map(beams.collect());
        let all = |_| Spectrum::ONE;
        let value = reading.radiance_in_2d(&map, (&ray, span), (0, &even), &Boundary::UNKNOWN, &all).value[0];
        moments.push(value);
        squares += value * value;
    }
    let density = f64::from(count) / (4.0 * size * size);
    let expected = density * span.length() / FOUR_PI;
    verdict::agrees("mean", &moments, (expected, 0.0), 0.25 * expected, 43);
    // Few lines are near: the variance is the mean square of one of them, less the square of the mean over their number.
    let variance = squares / maps as f64 - expected * expected * (1.0 - 1.0 / f64::from(count));
    let unit = density * span.length() / radius / (FOUR_PI * FOUR_PI);
    let ratio = variance / unit;
    assert!((0.76..0.86).contains(&ratio), "{ratio} for 0.849 of endless ones");
}

/// A uniform field of lines in a box, beside a wall too: places read in balls come out right, clipped, with every kernel; and rays in two
/// dimensions do, at a radius larger than the box.
#[test]
fn uniform_fields_come_out_right_beside_walls() {
    use turbid::geometry::{Rectangle, Shape};
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let wall = Rectangle::new(DVec3::new(0.3, 0.0, 0.3), DVec3::Y, DVec3::new(0.4, 0.0, 0.25)).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let known = Boundary::of(&whole).unwrap();
    let places = [[0.5, 0.5, 0.5], [0.05, 0.4, 0.6], [0.9, 0.95, 0.1], [0.6, 0.5, 0.4]].map(DVec3::from);
    let ray = Ray::new(DVec3::new(-0.3, 0.85, 0.1), DVec3::new(0.8, -0.1, 0.59).normalize());
    let span = whole.interval(&ray).unwrap();
    let (count, size) = (1000, 0.9);
    let mut balls = [[Moments::new(); 5]; 2];
    let mut discs = [Moments::new(); 4];
    for replicate in 0..300 {
        let mut stream = Stream::new(44, Purpose::Synthetic, replicate, 0);
        let mut beams: Vec<Beam> = Vec::new();
        for _ in 0..count {
            let frame = turbid::math::Frame::new(warp::square_to_sphere(stream.pair()));
            let [x, y] = [stream.unit(), stream.unit()].map(|u| size * (2.0 * u - 1.0));
            let line = Ray::new(DVec3::splat(0.5) + frame.x * x + frame.y * y - frame.z * 2.0, frame.z);
            if let Some(inside) = whole.interval(&line) {
                beams.push(beam(line.at(inside.start), line.dir, inside.length(), BeamKind::Sampled));
            }
        }
        let map = map(beams);
        for (boundary, moments) in [known, known.about(&walls)].iter().zip(&mut balls) {
            for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
                let reading = BeamEstimator { is_clipped: true, ..reading(kernel, 0.2) };
                let of = |place: &DVec3| reading.fluence_in_3d(&map, *place, (0, &even), boundary).value[0];
                moments.push(places.iter().map(of).sum::<f64>() / places.len() as f64);
            }
        }
        for (n, (radius, boundary, is_clipped)) in
            [(0.2, known, true), (0.2, known.about(&walls), true), (0.2, known, false), (3.0, known, true)]
                .into_iter()
                .enumerate()
        {
            if n == 1 && replicate >= 100 {
                continue;
            }
            let radius = Positive::new("the radius", radius).unwrap();
            let reading = BeamEstimator { kernel: Kernel::Uniform, radius, is_clipped };
            let all = |_| Spectrum::ONE;
            discs[n].push(reading.radiance_in_2d(&map, (&ray, span), (0, &even), &boundary, &all).value[0]);
        }
    }
    let fluence = f64::from(count) / (4.0 * size * size);
    for (name, moments) in ["alone", "beside a wall"].iter().zip(&balls) {
        for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
            let error = 0.003 * fluence;
            verdict::agrees(
                &format!("balls {name}, {kernel:?}"),
                moments,
                (fluence, error),
                0.08 * fluence,
                44,
            );
        }
    }
    let radiance = fluence / FOUR_PI * span.length();
    // Of 32 directions across the ray: of a disc far larger than the box each sees to its end.
    for (name, moments, part) in [
        ("discs", &discs[0], 0.003),
        ("discs beside a wall", &discs[1], 0.003),
        ("large discs", &discs[3], 0.02),
    ] {
        verdict::agrees(name, moments, (radiance, part * radiance), 0.2 * radiance, 44);
    }
    verdict::rejects("not clipped", &discs[2], radiance, 44);
}
