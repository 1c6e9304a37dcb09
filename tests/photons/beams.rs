//! Beams across rays: sums by hand, what flights are stored, exact slabs and furnaces, blur and variance as predicted, walls, glass,
//! cells, and paths.

use super::boundary::known;
use crate::checks::beams::{
    Flights, a_laser_end_on_counts_in_full, a_line_counts_once, across, beam, by_maps,
    light_scattered_once_in_three_channels, looked_into, map, means_by_maps, one_beam_by_hand, reading,
};
use crate::checks::ledger::{Room, layers_are_those_of_paths, mirror, settings};
use crate::checks::media::{layered, varying};
use crate::support::run::{paths, sensor};
use crate::support::scenes::{Incidence, bounded, cuboid, homogeneous, point_light, region};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, PI};
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{BeamEstimator, Estimator, Gather, Kernel};
use turbid::geometry::{Rectangle, Shape};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::light::{Light, Section};
use turbid::math::{FOUR_PI, Interval, Positive, Ray, exp, warp};
use turbid::medium::Medium;
use turbid::photons::beams::{Beam, BeamKind, BeamLength, BeamMap};
use turbid::photons::maps::{Indirect, MapSettings, MediumSamples, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_given_photons, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::beams::Pairing;

#[test]
fn by_hand() {
    one_beam_by_hand();
}

#[test]
fn end_on() {
    a_laser_end_on_counts_in_full();
}

#[test]
fn kernels_of_the_line() {
    a_line_counts_once();
}

#[test]
fn scattered_once() {
    light_scattered_once_in_three_channels();
}

/// A laser through a medium that varies, behind an even one, in three channels of different extinction: what its unscattered beams carry
/// at each depth is the exponential of the optical depth in front of it, and the photons are those of a pass that stores none.
#[test]
fn beams_carry_what_passes_a_medium_that_varies() {
    let (min, max) = (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 2.0));
    let sigma_t = [0.4, 1.0, 2.5];
    let uneven =
        varying(Spectrum(sigma_t.into()), 0.8, layered((min, max), 2, |z| if z < 1.0 { 0.3 } else { 1.5 }));
    let even = homogeneous(Spectrum::rgb(0.5, 0.1, 0.3), Spectrum::grey(0.9), 0.0);
    let front = cuboid(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 0.0));
    let section = Section::Disc { center: DVec3::new(0.0, 0.0, -2.0), radius: 0.1 };
    let power = Spectrum::rgb(1.0, 2.0, 0.5);
    let irradiance = power / (PI * 0.01);
    let laser = Light::Beam(turbid::light::Beam::new(DVec3::Z, irradiance, section).unwrap());
    let regions =
        vec![Region { shape: front, medium: even }, Region { shape: cuboid(min, max), medium: uneven }];
    let scene = bounded(regions, vec![], vec![laser]);
    // The density is linear between the middles of its layers, 0.3 at 0.5 and 1.5 at 1.5.
    let depths = [
        (-1.0, 0.0),
        (0.0, 0.0),
        (0.5, 0.15),
        (1.0, 0.15 + 0.5 * 0.6),
        (1.5, 0.15 + 0.9),
        (1.999, 0.15 + 0.9 + 0.499 * 1.5),
    ];
    for is_whole in [false, true] {
        let mut found = vec![[Moments::new(); 3]; depths.len()];
        for seed in 0..200 {
            let pass = Flights { is_whole }.pass(&scene, 2000, seed);
            if seed == 0 {
                let alone = crate::support::run::pass(&scene, &[], 2000, 0, |_| true);
                assert_eq!(pass.media, alone.media);
            }
            for ((z, _), moments) in depths.iter().zip(&mut found) {
                let mut carried = Spectrum::ZERO;
                for beam in pass.beams.iter().flatten().filter(|beam| beam.order == 0) {
                    let along = z - beam.start.z;
                    if (0.0..beam.length).contains(&along) {
                        carried += beam.power_at(along, scene.medium(beam.medium as usize));
                    }
                }
                (0..3).for_each(|channel| moments[channel].push(carried[channel] / 2000.0));
            }
        }
        for ((z, depth), moments) in depths.iter().zip(&found) {
            for channel in 0..3 {
                let before = [0.5, 0.1, 0.3][channel] * (z.min(0.0) + 1.0);
                let expected = power[channel] * exp(-before - sigma_t[channel] * depth);
                let what = format!("whole {is_whole}, depth {z}, channel {channel}");
                verdict::agrees(&what, &moments[channel], (expected, 1e-6), 0.1 * expected, 0);
            }
        }
    }
}

/// In a ball every collision ends a beam of its order and class, all other beams end on the surface; the photons are those of a pass
/// that stores no beams.
#[test]
fn flights_are_stored_whole() {
    let ball = crate::support::scenes::sphere(DVec3::ZERO, 1.5);
    let light = point_light(DVec3::new(0.3, 0.1, 0.0), Spectrum::ONE);
    let scene = bounded(
        vec![Region { shape: ball, medium: homogeneous(Spectrum::ONE, Spectrum::grey(0.8), 0.3) }],
        vec![],
        vec![light],
    );
    let pass = Flights { is_whole: false }.pass(&scene, 2000, 4);
    let alone = crate::support::run::pass(&scene, &[], 2000, 4, |_| true);
    assert_eq!(pass.media, alone.media);
    assert!(alone.beams.iter().all(Vec::is_empty) && alone.met_beams == 0);
    let mut photons = pass.photons().peekable();
    let (mut ended, mut left) = (0, 0);
    for beam in pass.beams.iter().flatten() {
        let end = beam.at(beam.length);
        if photons.peek().is_some_and(|photon| (photon.position - end).length() < 1e-12) {
            let photon = photons.next().unwrap();
            assert_eq!((photon.order, photon.flags), (beam.order, beam.flags));
            assert_eq!(photon.power, beam.power, "grey: the same power all along");
            ended += 1;
        } else {
            assert!((end.length() - 1.5).abs() < 1e-12, "{beam:?}");
            left += 1;
        }
    }
    assert!(photons.next().is_none() && ended > 1000 && left > 500, "{ended} {left}");
    assert_eq!(pass.met_beams, ended + left);
}

/// Flights through regions beside and in each other, past glass and in it: the length of the beams of each medium is the track length
/// that its extinction says, collisions over sigma_t.
#[test]
fn flights_are_cut_at_media() {
    let outer = cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let inner = cuboid(DVec3::new(-0.5, -0.5, -0.5), DVec3::new(0.5, 0.5, 0.0));
    let rates = [0.7, 3.0];
    let regions = [outer, inner].into_iter().zip(rates).map(|(shape, rate)| region(shape, rate, 0.9, 0.0));
    let scene =
        bounded(regions.collect(), vec![], vec![point_light(DVec3::new(0.0, 0.0, 0.7), Spectrum::ONE)]);
    let mut ratios = [Moments::new(), Moments::new()];
    for seed in 0..100 {
        let pass = Flights { is_whole: false }.pass(&scene, 1000, seed);
        let inside = |p: DVec3| p.abs().max_element() < 0.5 && p.z < 0.0;
        let mut lengths = [0.0; 2];
        for beam in pass.beams.iter().flatten() {
            assert_eq!(usize::from(inside(beam.at(0.5 * beam.length))), beam.medium as usize, "{beam:?}");
            lengths[beam.medium as usize] += beam.length;
        }
        for (medium, ratio) in ratios.iter_mut().enumerate() {
            let collisions = pass.photons().filter(|p| usize::from(inside(p.position)) == medium).count();
            ratio.push(lengths[medium] * rates[medium] - collisions as f64);
        }
    }
    for (medium, moments) in ratios.iter().enumerate() {
        verdict::agrees(&format!("medium {medium}"), moments, (0.0, 0.0), 40.0, 0);
    }
}

/// A thin medium in colour, in which first collisions are forced: light scattered once as by paths, level and aslant.
#[test]
fn forced_flights_are_stored_to_their_ends() {
    let medium = homogeneous(Spectrum::rgb(0.01, 0.03, 0.002), Spectrum::rgb(0.9, 0.5, 1.0), 0.3);
    let shape = cuboid(DVec3::ZERO, DVec3::ONE);
    let light = point_light(DVec3::new(0.4, 0.5, 0.6), Spectrum::rgb(1.0, 2.0, 0.5));
    let regions = vec![Region { shape, medium }];
    let plain = bounded(regions.clone(), vec![], vec![light.clone()]);
    assert!(plain.plan().forces_first_collision);
    let views = [
        Ray::new(DVec3::new(0.45, 0.3, -1.0), DVec3::Z),
        Ray::new(DVec3::new(-0.5, 0.3, 0.2), DVec3::new(0.8, 0.0, 0.6)),
    ];
    let (first, second) = (Orders::only(1), Orders::only(2));
    for (orders, promise, seed) in [(first, 0.12, 1), (second, 0.3, 2)] {
        let scene = Scene::new(SceneParts {
            regions: regions.clone(),
            lights: vec![light.clone()],
            sensors: views.iter().map(|ray| sensor(Quantity::Radiance(*ray), orders)).collect(),
            ..SceneParts::default()
        })
        .unwrap();
        let estimator = across(Kernel::Epanechnikov, 0.03);
        let measured = by_maps(&scene, (6000, 75), seed, &[estimator]).remove(0);
        for (view, (ray, moments)) in views.iter().zip(&measured).enumerate() {
            let reference = paths(&plain, Quantity::Radiance(*ray), orders, 1 << 15, seed);
            for channel in 0..3 {
                let expected = reference[channel].mean();
                // The blur of a point light at seven times the radius is below 1 part in 500.
                let error = libm::hypot(reference[channel].std_error(), 0.002 * expected);
                let what = format!("orders {orders:?}, view {view}, channel {channel}");
                verdict::agrees(&what, &moments[channel], (expected, error), promise * expected, seed);
            }
        }
    }
}

/// What leaves a slab of one mean free path aslant, albedo 0.9, cut square at its faces: published numbers by quadrature.
#[test]
fn radiance_of_a_slab() {
    let scene = looked_into((Incidence::Beam(1.0), 0.9, 0.0), (0.5, 0.0));
    let estimators = [0.1, 0.2].map(|radius| across(Kernel::Uniform, radius));
    let measured = means_by_maps(&scene, (3000, 140), 5, &estimators);
    for ((estimator, moments), expected) in estimators.iter().zip(&measured).zip([0.093_460_6, 0.091_948_3]) {
        verdict::agrees(&estimator.name(), moments, (expected, 1e-7), 0.035 * expected, 5);
    }
    // A mean over the whole picture that is blurred, but loses nothing.
    verdict::rejects("not cut", &measured[1], 0.094_904_494, 5);
}

/// A furnace: a slab of albedo 1 with the same light from all sides. Clipped, beams come out right at any radius; cut square, they
/// lose at its faces what is predicted.
#[test]
fn a_furnace_of_one_mean_free_path() {
    let scene = looked_into((Incidence::Both, 1.0, 0.0), (0.5, 0.0));
    let square = [0.1, 0.2].map(|radius| across(Kernel::Uniform, radius));
    let clipped = [(Kernel::Uniform, 0.2), (Kernel::Cone, 0.6), (Kernel::Gaussian, 1.2)];
    let clipped = clipped.map(|(kernel, radius)| across(kernel, radius).treated(Treatment::Clipped));
    let estimators: Vec<Estimator> = square.into_iter().chain(clipped).collect();
    let exact = 0.864_664_717;
    let measured = means_by_maps(&scene, (1000, 200), 6, &estimators);
    for ((estimator, moments), expected) in
        estimators.iter().zip(&measured).zip([0.834_397_403, 0.805_994_594, exact, exact, exact])
    {
        let expected = expected / PI;
        verdict::agrees(&estimator.name(), moments, (expected, 1e-8), 0.06 * expected, 6);
    }
    verdict::rejects("square", &measured[1], exact / PI, 6);
}

/// Beams of random lines through a ball, the same everywhere and from all sides: their mean is the field, their variance is the
/// predicted one, at two radii. The contributions fall as x^-3, and so does what is known of the variance of few.
#[test]
fn variance_is_the_predicted_one() {
    let (count, size) = (300, 2.0);
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let ray = Ray::new(DVec3::new(0.1, -0.5, 0.2), DVec3::new(0.0, 0.8, 0.6));
    let span = Interval { start: 0.0, end: 1.0 };
    let readings = [(Kernel::Uniform, 0.1), (Kernel::Biweight, 0.3)];
    let mut moments = [Moments::new(); 2];
    for replicate in 0..3000 {
        let mut stream = Stream::new(3, Purpose::Synthetic, replicate, 0);
        // As many as a Poisson process has: exponential gaps.
        let (mut beams, mut arrived) = (Vec::new(), 0.0);
        loop {
            arrived -= turbid::math::ln_1p(-stream.unit());
            if arrived > f64::from(count) {
                break;
            }
            let frame = turbid::math::Frame::new(warp::square_to_sphere(stream.pair()));
            let [x, y] = [stream.unit(), stream.unit()].map(|u| size * (2.0 * u - 1.0));
            let half = (size * size - x * x - y * y).max(0.0).sqrt();
            if half > 0.0 {
                let start = frame.x * x + frame.y * y - frame.z * half;
                beams.push(beam(start, frame.z, 2.0 * half, BeamKind::Sampled));
            }
        }
        let map = map(beams);
        for ((kernel, radius), moments) in readings.iter().zip(&mut moments) {
            let reading = reading(*kernel, *radius);
            let all = |_| Spectrum::ONE;
            moments.push(reading.radiance(&map, (&ray, span), (0, &even), &Boundary::UNKNOWN, &all).value[0]);
        }
    }
    // Beams a square across their direction.
    let density = f64::from(count) / (4.0 * size * size);
    let expected = density * span.length() / FOUR_PI;
    for ((kernel, radius), moments) in readings.iter().zip(&moments) {
        verdict::agrees(&format!("{kernel:?} {radius}"), moments, (expected, 0.0), 0.2 * expected, 3);
        let way = turbid_analytic::beams::Ray { length: span.length(), extinction: 0.0 };
        let predicted = Pairing::RayIsotropicBeams.relative_variance(known(*kernel), *radius, density, way);
        let ratio = moments.variance() / (expected * expected * predicted.unwrap().value);
        assert!((ratio - 1.0).abs() < 0.2, "{kernel:?} {radius}: variance over predicted {ratio}");
    }
}

/// A point light beside a long ray in clear air that scatters: how beams blur its light, at, within and beyond the radius.
#[test]
fn a_point_light_beside_a_ray() {
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let half = 300.0;
    let ray = Ray::new(DVec3::new(-half, 1.0, 0.0), DVec3::X);
    let span = Interval { start: 0.0, end: 2.0 * half };
    let cases = [
        (Kernel::Uniform, 0.25, 1.010_721_021),
        (Kernel::Uniform, 0.5, FRAC_PI_3),
        (Kernel::Epanechnikov, 0.5, 1.027_279_885),
        (Kernel::Uniform, 1.0, FRAC_PI_2),
        (Kernel::Uniform, 2.0, FRAC_PI_4),
    ];
    let mut moments = [Moments::new(); 5];
    let count = 8000;
    for replicate in 0..100 {
        let mut stream = Stream::new(5, Purpose::Synthetic, replicate, 0);
        let dir = |_| warp::square_to_sphere(stream.pair());
        let beams = (0..count).map(dir).map(|dir| beam(DVec3::ZERO, dir, 2.0 * half, BeamKind::Sampled));
        let map = BeamMap::new(vec![beams.collect()], count, None).unwrap();
        for ((kernel, radius, _), moments) in cases.iter().zip(&mut moments) {
            let reading = reading(*kernel, *radius);
            let all = |_| Spectrum::ONE;
            moments.push(reading.radiance(&map, (&ray, span), (0, &even), &Boundary::UNKNOWN, &all).value[0]);
        }
    }
    // Of an endless ray but for the angle that its ends leave.
    let seen = 1.0 - 2.0 / PI / half;
    for ((kernel, radius, factor), moments) in cases.iter().zip(&moments) {
        let expected = factor * seen / (16.0 * PI);
        let what = format!("{kernel:?}, radius {radius}");
        verdict::agrees(&what, moments, (expected, 1e-4 * expected), 0.06 * expected, 5);
    }
}

/// A uniform isotropic field in a box, along a ray that enters and leaves it aslant near edges, alone and beside a wall that ends half
/// way: clipped it comes out right with every kernel, unclipped it does not; what the wall hides does not count.
#[test]
fn a_uniform_field_comes_out_right_beside_walls() {
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let ray = Ray::new(DVec3::new(-0.3, 0.85, 0.1), DVec3::new(0.8, -0.1, 0.59).normalize());
    let span = whole.interval(&ray).unwrap();
    let wall = Rectangle::new(DVec3::new(0.3, 0.0, 0.3), DVec3::Y, DVec3::new(0.4, 0.0, 0.25)).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let known = Boundary::of(&whole).unwrap();
    let (count, size) = (2000, 0.9);
    let mut moments = [[[Moments::new(); 5]; 2]; 2];
    for replicate in 0..150 {
        let mut stream = Stream::new(8, Purpose::Synthetic, replicate, 0);
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
        for (boundary, moments) in [known, known.about(&walls)].iter().zip(&mut moments) {
            for (is_clipped, moments) in [true, false].into_iter().zip(moments) {
                for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
                    let reading = BeamEstimator { is_clipped, ..reading(kernel, 0.2) };
                    let way = (&ray, span);
                    let estimate = reading.radiance(&map, way, (0, &even), boundary, &|_| Spectrum::ONE);
                    moments.push(estimate.value[0]);
                }
            }
        }
    }
    let expected = f64::from(count) / (4.0 * size * size) * span.length() / FOUR_PI;
    for (name, moments) in ["alone", "beside a wall"].iter().zip(&moments) {
        for (kernel, moments) in Kernel::ALL.into_iter().zip(&moments[0]) {
            let what = format!("{name}, {kernel:?}");
            verdict::agrees(&what, moments, (expected, 0.0), 0.06 * expected, 8);
        }
        verdict::rejects(&format!("not clipped, {name}"), &moments[1][0], expected, 8);
    }
}

/// Light that is scattered twice and more, along rays through boxes in colour, of varying density, and of two media: as by paths.
#[test]
fn radiance_across_beams_is_that_of_paths() {
    let corners = (DVec3::splat(-1.0), DVec3::ONE);
    let even = homogeneous(Spectrum::rgb(1.0, 2.0, 0.5), Spectrum::rgb(0.9, 0.5, 0.8), 0.4);
    let density = layered(corners, 7, |z| 1.0 + 0.7 * z);
    let dense = homogeneous(Spectrum::grey(3.0), Spectrum::grey(0.95), 0.0);
    let whole = |medium: Medium| Region { shape: cuboid(corners.0, corners.1), medium };
    let core = Region { shape: cuboid(DVec3::splat(-0.4), DVec3::splat(0.3)), medium: dense };
    let orders = Orders { min: 2, max: None };
    let views = [
        Ray::new(DVec3::new(0.1, 0.2, -3.0), DVec3::Z),
        Ray::new(DVec3::new(-0.2, 0.35, 0.1), DVec3::new(0.48, 0.6, 0.64)),
    ];
    for (name, regions) in [
        ("even", vec![whole(even.clone())]),
        ("varying", vec![whole(varying(Spectrum::ONE, 0.9, density.clone()))]),
        ("varying in colour", vec![whole(varying(Spectrum::rgb(1.0, 2.0, 0.5), 0.9, density))]),
        ("two", vec![whole(even), core]),
    ] {
        let light = point_light(DVec3::new(0.5, -0.4, 0.6), Spectrum::ONE);
        let plain = bounded(regions.clone(), Vec::new(), vec![light.clone()]);
        let scene = Scene::new(SceneParts {
            regions,
            lights: vec![light],
            sensors: views.iter().map(|ray| sensor(Quantity::Radiance(*ray), orders)).collect(),
            ..SceneParts::default()
        })
        .unwrap();
        // What passes through a density is tracked once a map: a random product, which one map in two hundred hardly averages.
        let (promise, maps, histories) =
            if name == "even" { (0.3, 190, 1 << 18) } else { (0.5, 150, 1 << 17) };
        let sampled = across(Kernel::Epanechnikov, 0.15).treated(Treatment::Clipped);
        let mut estimators = vec![sampled];
        if name == "varying in colour" {
            estimators.push(sampled.of_length(BeamLength::Whole));
        }
        let of_each = |estimator: &Estimator| {
            by_maps(&scene, (4000, maps), 6, std::slice::from_ref(estimator)).remove(0)
        };
        let measured: Vec<_> = estimators.iter().map(of_each).collect();
        for (view, ray) in views.iter().enumerate() {
            let reference = paths(&plain, Quantity::Radiance(*ray), orders, histories, 3);
            for (estimator, measured) in estimators.iter().zip(&measured) {
                for channel in 0..3 {
                    let (found, expected) = (&measured[view][channel], &reference[channel]);
                    // The blur is r^2/20 = 1/900 of the second derivatives across, which are a few times the field.
                    let error = libm::hypot(expected.std_error(), 0.004 * expected.mean());
                    let what = format!("{name}, {}, view {view}, channel {channel}", estimator.name());
                    verdict::agrees(&what, found, (expected.mean(), error), promise * expected.mean(), 6);
                }
            }
        }
    }
}

/// How maps are read here: beams in place of balls.
fn of_beams(settings: Settings, radius: f64) -> Settings {
    let radius = Positive::new("the radius", radius).unwrap();
    Settings { volume: settings.volume.along_beams(radius), ..settings }
}

/// The mapper keeps its ledger by beams of both lengths: a foggy room with a mirror and a ball of glass, in colour.
#[test]
fn a_room_with_glass_keeps_its_ledger() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::rgb(0.4, 0.5, 0.6),
        albedo: Spectrum::rgb(0.8, 0.9, 0.7),
        g: 0.3,
        is_colored: true,
        has_glass: true,
        has_water: false,
    };
    let sampled = of_beams(settings(1), 0.05);
    let whole = Settings { volume: sampled.volume.of_length(BeamLength::Whole), ..sampled };
    for (read, seed) in [(sampled, 21), (whole, 23)] {
        layers_are_those_of_paths(&room, Indirect::Seen, &read, 2600, seed);
    }
}

/// Fog of albedo 1 with the same radiance from all sides is as bright everywhere, near its faces too.
#[test]
fn a_furnace_of_fog() {
    let cube = cuboid(DVec3::ZERO, DVec3::splat(2.0));
    let scene = bounded(
        vec![Region { shape: cube.clone(), medium: homogeneous(Spectrum::ONE, Spectrum::ONE, 0.6) }],
        Vec::new(),
        vec![crate::support::scenes::isotropic(cube, turbid::light::Faces::Both)],
    );
    let settings = of_beams(settings(1), 0.3);
    for length in BeamLength::ALL {
        let mut moments = Moments::new();
        for replicate in 0..64 {
            let filling = crate::checks::ledger::filling(4000, Indirect::Seen, 2, replicate);
            let filling = MapSettings { media: MediumSamples::Beams(length), ..filling };
            let maps = fill(&scene, &filling, &NoProgress).unwrap();
            assert!(maps.volume.is_none() && maps.beams.as_ref().is_some_and(|beams| beams.stored() > 4000));
            let mapper = Mapper::new(&scene, &maps, &settings);
            mapper.check_radii().unwrap();
            let mut sum = 0.0;
            for history in 0..50 {
                let mut stream = Stream::new(2, Purpose::Paths, replicate, history);
                let [y, z] = stream.pair().map(|u| 0.02 + 1.96 * u);
                let ray = Ray::new(DVec3::new(0.4, y, z), DVec3::X);
                sum += mapper.radiance(ray, None, 0, &mut stream).0.total()[1];
            }
            moments.push(sum / 50.0 * PI);
            let of_points = Mapper::new(&scene, &maps, &crate::checks::ledger::settings(1)).check_radii();
            assert!(of_points.is_err(), "beams are no points");
        }
        verdict::agrees(length.name(), &moments, (1.0, 1e-12), 0.1, 2);
    }
}

/// Rays through many copies of a cell, either way, level and steep, from far outside it: found is what all copies, asked one by one,
/// say; a radius larger than the cell, or a stretch without end, is not known.
#[test]
fn rays_run_through_the_copies_of_a_cell() {
    let side = DVec2::new(2.0, 3.0);
    let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
    let mut beams = Vec::new();
    for _ in 0..300 {
        let start = DVec3::from(stream.triple()) * side.extend(1.0);
        // Its end stays in the cell.
        let end = DVec3::from(stream.triple()) * side.extend(1.0);
        beams.push(beam(start, (end - start).normalize(), (end - start).length(), BeamKind::Sampled));
    }
    let map = BeamMap::new(vec![beams.clone()], 1, Some(side)).unwrap();
    let mut found = 0;
    for trial in 0..60 {
        let dir = match trial % 6 {
            0 => DVec3::X,
            1 => DVec3::NEG_Y,
            2 => DVec3::new(-1.0, 1e-3, 1e-4).normalize(),
            _ => warp::square_to_sphere(stream.pair()),
        };
        let through = (DVec3::from(stream.triple()) - 0.5) * DVec3::new(8.0, 9.0, 1.0) + 0.5 * DVec3::Z;
        let ray = Ray::new(through - dir * 5.0, dir);
        let span = Interval { start: 4.0 * stream.unit(), end: 6.0 + 6.0 * stream.unit() };
        let radius = [0.05, 0.4, 1.9][trial % 3];
        let mut sum = [0.0; 3];
        assert!(map.near(&ray, span, radius, |_, crossing| {
            sum = [sum[0] + 1.0, sum[1] + crossing.along_ray, sum[2] + crossing.offset.abs()];
        }));
        let mut expected = [0.0; 3];
        for (i, j) in (-12..=12).flat_map(|i| (-8..=8).map(move |j| (i, j))) {
            let shift = DVec3::new(f64::from(i) * side.x, f64::from(j) * side.y, 0.0);
            for beam in &beams {
                let (v, c) = (ray.origin - beam.start - shift, dir.dot(beam.dir));
                let s = (c * v.dot(beam.dir) - v.dot(dir)) / (1.0 - c * c);
                let t = (v.dot(beam.dir) - c * v.dot(dir)) / (1.0 - c * c);
                let apart = (v + dir * s - beam.dir * t).length();
                if span.start <= s && s < span.end && (0.0..beam.length).contains(&t) && apart <= radius {
                    expected = [expected[0] + 1.0, expected[1] + s, expected[2] + apart];
                }
            }
        }
        assert_eq!(sum[0], expected[0], "{trial}");
        assert!((sum[1] - expected[1]).abs() < 1e-9 * expected[1].max(1.0), "{trial}");
        assert!((sum[2] - expected[2]).abs() < 1e-9 * expected[2].max(1.0), "{trial}");
        found += expected[0] as u64;
    }
    assert!(found > 2000, "{found}");
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    assert!(!map.near(&ray, Interval { start: 0.0, end: 1.0 }, 2.01, |_, _| ()));
    assert!(!map.near(&ray, Interval { start: 0.0, end: f64::INFINITY }, 0.1, |_, _| ()));
}

/// What beams cannot do is refused by name: photons of a file, flights without end.
#[test]
fn what_beams_cannot_do_is_refused() {
    let corners = (DVec3::ZERO, DVec3::ONE);
    let estimator = across(Kernel::Uniform, 0.1);
    let settings = PhotonSettings { photons: 100, maps: 1, seed: 1, orders: Orders::ALL, estimator };
    let of = |medium: Medium| {
        Scene::new(SceneParts {
            regions: vec![Region { shape: cuboid(corners.0, corners.1), medium }],
            lights: vec![point_light(DVec3::splat(0.4), Spectrum::ONE)],
            sensors: vec![sensor(Quantity::Radiance(Ray::new(DVec3::ZERO, DVec3::Z)), Orders::SCATTERED)],
            ..SceneParts::default()
        })
        .unwrap()
    };
    let grey = of(varying(Spectrum::ONE, 0.5, layered(corners, 3, |z| z)));
    let read = by_photons(&grey, &settings, &NoProgress).unwrap();
    assert_eq!((read.measurements.len(), read.gathers), (1, 1));
    let error = by_given_photons(&grey, &settings, [Ok((Vec::new(), 1))]).unwrap_err().to_string();
    assert!(error.contains("no beams"), "{error}");
    // Level flights in a slab cross cells without end where nothing stops them.
    let balls = Estimator::new(Kernel::Uniform, Gather::radius(0.1).unwrap());
    assert!(balls.along_beams(Positive::ONE).along_rays(Positive::ONE).beam_radius.is_none());
}

/// One beam past a place, by hand: beside it, at the edge of the disc, before its start and behind its end; long ones by what passes.
#[test]
fn a_beam_past_a_place_by_hand() {
    let even = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.5);
    let read = |kernel: Kernel, kind: BeamKind, length: f64, place: DVec3| {
        let map = map(vec![beam(DVec3::ZERO, DVec3::Z, length, kind)]);
        let estimate = reading(kernel, 0.1).fluence(&map, place, (0, &even), &Boundary::UNKNOWN);
        (estimate.value[0], estimate.found)
    };
    let place = DVec3::new(0.06, 0.0, 0.7);
    for (kernel, kind, expected) in [
        (Kernel::Uniform, BeamKind::Expected, 15.806_801),
        (Kernel::Epanechnikov, BeamKind::Expected, 20.232_705),
        (Kernel::Uniform, BeamKind::Sampled, 100.0 / PI),
    ] {
        let (found, count) = read(kernel, kind, 4.0, place);
        assert!((found / expected - 1.0).abs() < 5e-8 && count == 1, "{kernel:?} {kind:?}: {found}");
    }
    for (length, place) in [
        (0.69, place),
        (4.0, DVec3::new(0.06, 0.0, -1e-9)),
        (4.0, DVec3::new(0.0, 0.100_000_1, 0.7)),
        (0.7, place),
    ] {
        assert_eq!(read(Kernel::Uniform, BeamKind::Sampled, length, place), (0.0, 0), "{length} {place}");
    }
    // Of another medium.
    let other = map(vec![Beam { medium: 1, ..beam(DVec3::ZERO, DVec3::Z, 4.0, BeamKind::Sampled) }]);
    let estimate = reading(Kernel::Uniform, 0.1).fluence(&other, place, (0, &even), &Boundary::UNKNOWN);
    assert_eq!((estimate.value, estimate.found, estimate.rejected), (Spectrum::ZERO, 0, 1));
}

/// Random beams, whole and cut, of any length: found about a place are those that a formula of its own finds one by one, each once.
#[test]
fn beams_about_a_place_are_those_found_one_by_one() {
    let mut stream = Stream::new(21, Purpose::Synthetic, 0, 0);
    let mut found = 0;
    for trial in 0..60 {
        let size = libm::exp10(8.0 * stream.unit() - 4.0);
        let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
        let count = [0, 1, 16, 17, 300, 2000][trial % 6];
        let beams: Vec<Beam> = (0..count)
            .map(|which| {
                let start = far + (DVec3::from(stream.triple()) - 0.5) * size;
                let length = size * [0.0, 0.1, 1.0, 30.0][which % 4] * stream.unit();
                beam(start, warp::square_to_sphere(stream.pair()), length, BeamKind::Sampled)
            })
            .collect();
        let map = map(beams.clone());
        for which in 0..8 {
            let place = far + (DVec3::from(stream.triple()) - 0.5) * 1.2 * size;
            let radius = size * [1e-3, 0.03, 0.3, 20.0][which % 4];
            let mut seen = Vec::new();
            let is_known = map.about(place, radius, |beam, along, squared| {
                let off = place.distance(beam.at(along));
                assert!((off * off - squared).abs() <= 1e-9 * (squared + size * size), "{off} {squared}");
                seen.push(beam.start.to_array().map(f64::to_bits));
            });
            assert!(is_known);
            found += seen.len();
            let mut expected = Vec::new();
            let mut undecided = 0;
            for beam in &beams {
                let (a, b) = (beam.start, beam.at(beam.length));
                let whole = (b - a).length_squared();
                let t = (place - a).dot(b - a) / whole;
                let off = (place - a).cross(b - a).length() / whole.sqrt();
                // What rounding decides may be either.
                let error = 1e-11 * (1.0 + far.length() / size) * (1.0 + size / beam.length);
                let is_sure = (t.abs() > error)
                    && ((t - 1.0).abs() > error)
                    && (off / radius - 1.0).abs() > error * size / radius;
                undecided += usize::from(!is_sure);
                if is_sure && (0.0..1.0).contains(&t) && off <= radius {
                    expected.push(beam.start.to_array().map(f64::to_bits));
                }
            }
            seen.sort_unstable();
            let all = seen.len();
            seen.dedup();
            assert_eq!(seen.len(), all, "twice");
            assert!(expected.iter().all(|key| seen.binary_search(key).is_ok()), "{trial} {which}: missed");
            assert!(seen.len() <= expected.len() + undecided, "{trial} {which}: too many");
        }
    }
    assert!(found > 5000, "{found}");
}

/// The same lines in a box, whole or beside a wall: the fluence at places in the middle, at a face, in an edge and behind the wall's
/// rim comes out right for every kernel; without clipping it does not.
#[test]
fn a_uniform_fluence_comes_out_right_beside_walls() {
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let wall = Rectangle::new(DVec3::new(0.3, 0.0, 0.3), DVec3::Y, DVec3::new(0.4, 0.0, 0.25)).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let known = Boundary::of(&whole).unwrap();
    let places = [[0.5, 0.5, 0.5], [0.05, 0.4, 0.6], [0.9, 0.95, 0.1], [0.6, 0.5, 0.4]].map(DVec3::from);
    let (count, size) = (2000, 0.9);
    let mut moments = [[[Moments::new(); 5]; 2]; 2];
    for replicate in 0..600 {
        let mut stream = Stream::new(9, Purpose::Synthetic, replicate, 0);
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
        for (boundary, moments) in [known, known.about(&walls)].iter().zip(&mut moments) {
            for (is_clipped, moments) in [true, false].into_iter().zip(moments) {
                for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
                    let reading = BeamEstimator { is_clipped, ..reading(kernel, 0.2) };
                    let of = |place: &DVec3| reading.fluence(&map, *place, (0, &even), boundary).value[0];
                    moments.push(places.iter().map(of).sum::<f64>() / places.len() as f64);
                }
            }
        }
    }
    let expected = f64::from(count) / (4.0 * size * size);
    for (name, moments) in ["alone", "beside a wall"].iter().zip(&moments) {
        for (kernel, moments) in Kernel::ALL.into_iter().zip(&moments[0]) {
            let what = format!("fluence {name}, {kernel:?}");
            verdict::agrees(&what, moments, (expected, 0.0), 0.03 * expected, 12);
        }
        verdict::rejects(&format!("fluence, not clipped, {name}"), &moments[1][0], expected, 12);
    }
}

/// Beams about a place in a periodic cell are those of the world that it stands for; a radius beyond the cell is not a number.
#[test]
fn places_find_the_copies_of_a_cell() {
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let mut stream = Stream::new(10, Purpose::Synthetic, 0, 0);
    let side = DVec2::new(1.0, 1.5);
    let beams: Vec<Beam> = (0..400)
        .map(|_| {
            let start = DVec3::from(stream.triple()) * DVec3::new(1.0, 1.5, 2.0);
            let dir = warp::square_to_sphere(stream.pair());
            // Cut at the cell, as a pass stores them.
            let inside =
                cuboid(DVec3::ZERO, DVec3::new(1.0, 1.5, 2.0)).interval(&Ray::new(start, dir)).unwrap();
            beam(start, dir, inside.end * 0.9, BeamKind::Sampled)
        })
        .collect();
    let world: Vec<Beam> = (-2..=2)
        .flat_map(|i| (-2..=2).map(move |j| DVec3::new(f64::from(i), 1.5 * f64::from(j), 0.0)))
        .flat_map(|shift| beams.iter().map(move |beam| Beam { start: beam.start + shift, ..*beam }))
        .collect();
    let (cell, world) = (BeamMap::new(vec![beams], 1, Some(side)).unwrap(), map(world));
    for _ in 0..100 {
        let place = DVec3::from(stream.triple()) * DVec3::new(1.0, 1.5, 2.0);
        let read = |map: &BeamMap, place: DVec3, radius: f64| {
            reading(Kernel::Cone, radius).fluence(map, place, (0, &even), &Boundary::UNKNOWN).value[0]
        };
        let expected = read(&world, place, 0.4);
        let elsewhere = place + DVec3::new(3.0, -6.0, 0.0);
        for found in [read(&cell, place, 0.4), read(&cell, elsewhere, 0.4)] {
            assert!((found - expected).abs() <= 1e-9 * expected, "{found} {expected}");
        }
        assert!(read(&cell, place, 1.1).is_nan());
    }
}
