//! Planes across rays: sums by hand, what is stored, the law of their tail, a laser in blocks thin and dense, paths, peaks, what is
//! refused, and threads.

use crate::checks::beams::{beam, by_maps};
use crate::checks::ledger::{Room, filling, layers_are_those_of_the_reference, mirror, reference, settings};
use crate::checks::media::{layered, varying};
use crate::checks::planes::{
    Laser, a_laser_scattered_twice, a_plane_end_on_counts_in_full, in_planes, one_plane_by_hand, read,
};
use crate::support::quadrature::integrate;
use crate::support::run::{paths, sensor};
use crate::support::scenes::{
    CELL, Incidence, bounded, cuboid, homogeneous, incidence, lambertian, layer, point_light, rectangle,
    region, sphere,
};
use crate::support::verdict;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::Shape;
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::path;
use turbid::light::{Beam, Light, Section};
use turbid::math::{FOUR_PI, Interval, Positive, Ray, cos, exp, sin, warp};
use turbid::medium::Medium;
use turbid::photons::beams::BeamKind;
use turbid::photons::maps::{Indirect, MapSettings, fill};
use turbid::photons::planes::{Plane, PlaneMap, PlaneTree};
use turbid::photons::{Emitter, Histories, Pass, Photon, Run, Storage};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Object, Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_given_photons, by_photons, by_photons_in_passes, forecast};
use turbid::stats::Moments;
use turbid::surface::{Filter, Surface};
use turbid::transport::{NoProgress, Walker};

#[test]
fn by_hand() {
    one_plane_by_hand();
}

#[test]
fn end_on() {
    a_plane_end_on_counts_in_full();
}

#[test]
fn a_laser() {
    a_laser_scattered_twice();
}

/// Light of a laser that is scattered twice, seen along a ray at a distance: published for an endless medium, by quadrature for a block
/// of a millionth of a mean free path, where first collisions are forced, and scaled for a block of a million of them.
#[test]
fn lasers_thin_and_dense() {
    let endless = Laser { unit: 1.0, sigma_t: 1.0, block: [-15.0, 30.0, 15.0] };
    assert!((endless.exact() / 3.570_231e-4 - 1.0).abs() < 2e-7, "{}", endless.exact());
    let thin = Laser { unit: 1.0, sigma_t: 1e-6, block: [0.0, 1.0, 2.0] };
    let dense = Laser { unit: 1e-6, sigma_t: 1e6, block: [-5e5, 5e5, 5e5] };
    assert!((dense.exact() / endless.exact() - 1e12).abs() < 1e3);
    // Forced collisions spread little.
    for (what, laser, counts) in
        [("endless", endless, (15_000, 100)), ("thin", thin, (4000, 64)), ("dense", dense, (15_000, 100))]
    {
        let expected = laser.exact();
        let found = laser.read(0.0, counts, 2);
        verdict::agrees(what, &found, (expected, 1e-6 * expected), 0.04 * expected, 2);
    }
}

/// Peaks of scattering, forwards and backwards, bring finite numbers.
#[test]
fn peaks_are_finite() {
    for g in [0.9999, -0.9999] {
        let block = Laser { unit: 1.0, sigma_t: 1.0, block: [0.0, 1.0, 2.0] };
        let found = block.read(g, (4000, 64), 3);
        assert!(found.mean().is_finite() && found.mean() >= 0.0, "{found:?}");
    }
}

/// Photons and planes.
struct Both(bool);

impl Storage for Both {
    fn in_medium(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }

    fn has_beams(&self) -> bool {
        true
    }

    fn on_flight(&self, _history: u64, _walker: &Walker) -> bool {
        true
    }

    fn has_planes(&self) -> bool {
        self.0
    }

    fn on_plane(&self, _history: u64, _walker: &Walker) -> bool {
        true
    }
}

fn pass(scene: &Scene, count: u64, seed: u64, has_planes: bool) -> Pass {
    let histories = Histories { count, seed, replicate: 0, max_order: None };
    Run::new(scene, &Emitter::by_power(scene), histories).pass(&Both(has_planes), &NoProgress).unwrap()
}

/// Every flight through a ball has a plane, those that leave too, and nothing else of the pass is changed by them. Second legs are
/// drawn from the phase function, with exponential depths.
#[test]
fn every_flight_has_a_plane() {
    let medium = homogeneous(Spectrum::grey(2.0), Spectrum::grey(0.8), 0.3);
    let light = point_light(DVec3::new(0.3, 0.1, 0.0), Spectrum::ONE);
    let ball = Region { shape: sphere(DVec3::ZERO, 1.5), medium };
    let scene = bounded(vec![ball], vec![], vec![light]);
    let with = pass(&scene, 4000, 4, true);
    let without = pass(&scene, 4000, 4, false);
    assert_eq!((&with.media, &with.beams), (&without.media, &without.beams));
    assert_eq!(with.report.ledger, without.report.ledger);
    assert!(without.planes.iter().all(Vec::is_empty) && without.met_planes == 0);
    let legs: Vec<_> = with.planes.iter().flatten().map(|plane| plane.leg).collect();
    let beams: Vec<_> = with.beams.iter().flatten().copied().collect();
    assert_eq!(legs, beams);
    assert_eq!(with.met_planes, legs.len() as u64);
    let (mut cosines, mut depths) = (Moments::new(), Moments::new());
    for Plane { leg, dir, depth, reach } in with.planes.iter().flatten() {
        cosines.push(leg.dir.dot(*dir));
        depths.push(*depth);
        assert!(*reach <= 0.5 * depth && (*reach == 0.5 * depth || *reach >= 1.5), "{reach} {depth}");
        assert!((dir.length() - 1.0).abs() < 1e-12);
    }
    verdict::agrees("mean cosine", &cosines, (0.3, 0.0), 0.06, 4);
    verdict::agrees("mean depth", &depths, (1.0, 0.0), 0.1, 4);
}

/// In isotropic light 1/|det| of what a ray finds exceeds x in 2 x^-2 of all, for large x: a tail without a variance.
#[test]
fn determinants_have_their_tail() {
    let most = [2.0, 5.0, 20.0];
    let mut excess = [Moments::new(); 3];
    let mut mean = Moments::new();
    for batch in 0..100 {
        let mut stream = Stream::new(9, Purpose::Synthetic, batch, 0);
        let planes = (0..40_000).map(|_| {
            let start = (DVec3::from(stream.triple()) - 0.5) * 6.0;
            let [first, dir] = [0; 2].map(|_| warp::square_to_sphere(stream.pair()));
            Plane { leg: beam(start, first, 1.0, BeamKind::Sampled), dir, depth: 1.0, reach: 1.0 }
        });
        let tree = PlaneTree::new(vec![planes.collect()]).unwrap();
        let (mut found, mut beyond, mut sum) = (0.0, [0.0; 3], 0.0);
        for _ in 0..12 {
            let dir = warp::square_to_sphere(stream.pair());
            let middle = (DVec3::from(stream.triple()) - 0.5) * 0.5;
            let ray = Ray::new(middle - dir * 0.5, dir);
            tree.met(&ray, Interval { start: 0.0, end: 1.0 }, |_, crossing| {
                found += 1.0;
                sum += crossing.determinant;
                for (beyond, most) in beyond.iter_mut().zip(most) {
                    *beyond += f64::from(u8::from(crossing.determinant < 1.0 / most));
                }
            });
        }
        for ((excess, beyond), most) in excess.iter_mut().zip(beyond).zip(most) {
            // With sin(a) = 1/x: (2/pi) [x^-2 (pi - 2a) + a - sin(2a)/2], of which 2 x^-2 is the leading term.
            let a = libm::asin(1.0 / most);
            let law = 2.0 / PI * ((PI - 2.0 * a) / (most * most) + a - 0.5 * libm::sin(2.0 * a));
            assert!((law * most * most / 2.0 - 1.0).abs() < 0.5 / most);
            excess.push(beyond - found * law);
        }
        // pi/8 l0 l1 D/V of each.
        mean.push(found / (40_000.0 * 12.0) * 216.0 / (PI / 8.0));
    }
    verdict::agrees("pairs found", &mean, (1.0, 0.0), 0.08, 9);
    for ((excess, most), promise) in excess.iter().zip(most).zip([20.0, 10.0, 2.5]) {
        verdict::agrees(&format!("beyond {most}"), excess, (0.0, 0.0), promise, 9);
    }
}

/// Rays through many copies of a cell, from far outside it: met is what all copies, asked one by one, say.
#[test]
fn rays_run_through_the_copies_of_a_cell() {
    let side = DVec2::new(2.0, 3.0);
    let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
    let planes: Vec<Plane> = (0..200)
        .map(|_| {
            let start = DVec3::from(stream.triple()) * side.extend(1.0);
            let [first, dir] = [0; 2].map(|_| warp::square_to_sphere(stream.pair()));
            let [length, reach] = stream.pair().map(|u| 4.0 * u);
            Plane { leg: beam(start, first, length, BeamKind::Sampled), dir, depth: 1.0, reach }
        })
        .collect();
    let map = PlaneMap::new(vec![planes.clone()], 1, Some(side)).unwrap();
    let world: Vec<Plane> = (-16..=16)
        .flat_map(|i| (-12..=12).map(move |j| DVec3::new(2.0 * f64::from(i), 3.0 * f64::from(j), 0.0)))
        .flat_map(|shift| {
            planes.iter().map(move |plane| {
                let leg = turbid::photons::beams::Beam { start: plane.leg.start + shift, ..plane.leg };
                Plane { leg, ..*plane }
            })
        })
        .collect();
    let world = PlaneMap::new(vec![world], 1, None).unwrap();
    let mut found = 0.0;
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
        let sums = [&map, &world].map(|map| {
            let mut sum = [0.0; 3];
            assert!(map.met(&ray, span, |_, crossing| {
                sum = [sum[0] + 1.0, sum[1] + crossing.along_ray, sum[2] + crossing.along_legs[1]];
            }));
            sum
        });
        assert_eq!(sums[0][0], sums[1][0], "{trial}");
        assert!(
            (DVec3::from(sums[0]) - DVec3::from(sums[1])).length() < 1e-9 * sums[1][1].max(1.0),
            "{trial}"
        );
        found += sums[1][0];
    }
    assert!(found > 2000.0, "{found}");
    assert!(!map.met(
        &Ray::new(DVec3::ZERO, DVec3::X),
        Interval { start: 0.0, end: f64::INFINITY },
        |_, _| ()
    ));
    let far = Plane { reach: 1e6, ..planes[0] };
    let error = PlaneMap::new(vec![vec![far]], 1, Some(side)).unwrap_err().to_string();
    assert!(error.contains("copies of the periodic cell"), "{error}");
}

/// Light scattered twice and more through a cuboid, a ball and two media in each other, whose albedos have colours: as by paths. With
/// beams beside them planes bring light that is scattered once, too.
#[test]
fn radiance_in_planes_is_that_of_paths() {
    let even = homogeneous(Spectrum::ONE, Spectrum::rgb(0.9, 0.5, 0.8), 0.4);
    let dense = homogeneous(Spectrum::grey(3.0), Spectrum::rgb(0.95, 0.9, 0.4), -0.2);
    let cube = || cuboid(DVec3::splat(-1.0), DVec3::ONE);
    let core = Region { shape: cuboid(DVec3::splat(-0.4), DVec3::splat(0.3)), medium: dense };
    let whole = |shape: Shape| Region { shape, medium: even.clone() };
    let views = [
        Ray::new(DVec3::new(0.1, 0.2, -3.0), DVec3::Z),
        Ray::new(DVec3::new(-0.2, 0.35, 0.1), DVec3::new(0.48, 0.6, 0.64)),
    ];
    let twice = Orders { min: 2, max: None };
    let beside = in_planes().along_beams(Positive::new("the radius", 0.05).unwrap());
    for (name, regions, orders, estimator) in [
        ("cuboid", vec![whole(cube())], twice, in_planes()),
        ("ball", vec![whole(sphere(DVec3::ZERO, 1.2))], twice, in_planes()),
        ("two", vec![whole(cube()), core], twice, in_planes()),
        ("all orders", vec![whole(cube())], Orders::ALL, beside),
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
        let measured = by_maps(&scene, (4000, 200), 6, &[estimator]).remove(0);
        for (view, ray) in views.iter().enumerate() {
            let reference = paths(&plain, Quantity::Radiance(*ray), orders, 1 << 17, 3);
            for channel in 0..3 {
                let (found, expected) = (&measured[view][channel], &reference[channel]);
                let what = format!("{name}, view {view}, channel {channel}");
                // The blur of a point light at ten times the radius is below 1 part in 500.
                let blur = if orders == Orders::ALL { 0.002 * expected.mean() } else { 0.0 };
                let error = libm::hypot(expected.std_error(), blur);
                verdict::agrees_with_a_tail(
                    &what,
                    found,
                    (expected.mean(), error),
                    0.35 * expected.mean(),
                    6,
                );
            }
        }
    }
}

/// A laser along the axis of a ball that scatters forwards or backwards by far the most, seen nearly along its light from all around it:
/// scattered twice, by quadrature,
///
/// L = sigma_s^2 int int p(w0, w) p(w, -d) e^(-sigma_t (z + r + s))/r^2 ds dz.
#[test]
fn lasers_in_peaked_media() {
    let shape = sphere(DVec3::Z * 6.0, 10.0);
    let turned = |angle: f64, v: DVec3| DQuat::from_rotation_z(angle) * v;
    let (away, origin) = (DVec3::new(sin(0.3), 0.0, cos(0.3)), DVec3::new(1.2, 0.5, 6.0));
    let end = shape.interval(&Ray::new(origin, -away)).unwrap().end;
    for (g, promise, seed) in [(0.9, 0.2, 11), (0.95, 0.25, 12), (-0.9, 0.3, 13)] {
        let phase = |a: DVec3, b: DVec3| {
            let way = 1.0 + g * g - 2.0 * g * a.dot(b);
            (1.0 - g * g) / FOUR_PI / (way * way.sqrt())
        };
        let seen = |s: f64| {
            let at = origin - away * s;
            integrate(0.0, 16.0, 100, |z| {
                let way = at - DVec3::Z * z;
                let r = way.length();
                phase(DVec3::Z, way / r) * phase(way / r, away) * exp(-(z + r + s)) / (r * r)
            })
        };
        let expected = 0.25 * integrate(0.0, end, 60, seen);
        let radius = 1e-9;
        let section = Section::Disc { center: DVec3::ZERO, radius };
        let irradiance = Spectrum::grey(1.0 / (PI * radius * radius));
        let light = Light::Beam(Beam::new(DVec3::Z, irradiance, section).unwrap());
        let scene = bounded(vec![region(shape.clone(), 1.0, 0.5, g)], vec![], vec![light]);
        let mut moments = Moments::new();
        for replicate in 0..100 {
            let histories = Histories { count: 8000, seed, replicate, max_order: Some(0) };
            let run = Run::new(&scene, &Emitter::by_power(&scene), histories).pass(&Both(true), &NoProgress);
            let map = run.unwrap().into_planes().unwrap();
            let look = |k: u32| {
                let [origin, dir] = [origin, -away].map(|v| turned(f64::from(k) * PI / 50.0, v));
                read(&scene, &map, &Ray::new(origin, dir), end)
            };
            moments.push((0..100).map(look).sum::<f64>() / 100.0);
        }
        verdict::agrees(&format!("g {g}"), &moments, (expected, 1e-6 * expected), promise * expected, seed);
    }
}

/// The mapper keeps its ledger by planes, with beams for what comes from bodies: a foggy room with a mirror and a tinted pane, read
/// where the eye looks and by a final gathering.
#[test]
fn a_room_with_a_mirror_and_a_pane_keeps_its_ledger() {
    let room = Room {
        floor: mirror(),
        sigma_t: Spectrum::grey(0.5),
        albedo: Spectrum::rgb(0.9, 0.6, 0.8),
        g: 0.3,
        is_colored: true,
        has_glass: false,
        has_water: false,
    };
    let mut parts = room.parts();
    let pane = rectangle(DVec3::new(1.2, 0.2, 0.3), DVec3::new(0.6, 0.5, 0.0), DVec3::Z);
    let tinted = Filter::new(Spectrum::rgb(0.7, 0.8, 0.3)).unwrap();
    parts.objects.push(Object { shape: Shape::Rectangle(pane), surface: Surface::Filter(tinted) });
    let scene = Scene::new(parts).unwrap();
    let paths = reference(&scene, 31);
    let radius = Positive::new("the radius", 0.05).unwrap();
    for (rays, indirect, seed) in [(1, Indirect::Seen, 31), (4, Indirect::Gathered, 32)] {
        let usual = settings(rays);
        let read = Settings { volume: usual.volume.along_beams(radius).in_planes(), ..usual };
        layers_are_those_of_the_reference((&scene, &paths), indirect, &read, 4000, seed);
    }
}

/// A tinted shell within a ball of fog, which light crosses between two scatterings more often than not: each flight that a ray meets is
/// read once, from planes up to the shell and from beams behind it. Without the beams a good part is missing.
#[test]
fn planes_end_at_a_pane_and_beams_begin_there() {
    let medium = homogeneous(Spectrum::grey(2.0), Spectrum::rgb(0.9, 0.6, 0.8), 0.3);
    let ball = Region { shape: sphere(DVec3::ZERO, 1.0), medium };
    let tinted = Surface::Filter(Filter::new(Spectrum::rgb(0.9, 0.7, 0.8)).unwrap());
    let shell = (sphere(DVec3::ZERO, 0.7), tinted);
    let light = point_light(DVec3::new(0.5, 2.0, -1.5), Spectrum::ONE);
    let scene = bounded(vec![ball], vec![shell], vec![light]);
    // One in each cell of a grid.
    let ray = |history: u64, stream: &mut Stream| {
        let ([u, v], [i, j]) = (stream.pair(), [history % 10, history / 10 % 10].map(|cell| cell as f64));
        let [x, y] = [i + u, j + v].map(|cells| cells / 5.0 - 1.0);
        Ray::new(DVec3::new(x, y, -3.0), DVec3::Z)
    };
    let mut reference = Moments::new();
    for history in 0..100_000 {
        let stream = &mut Stream::new(41, Purpose::Paths, 0, history);
        reference.push(path::layers(&scene, ray(history, stream), None, 0, stream).0.multiple[0]);
    }
    let usual = settings(1);
    let radius = Positive::new("the radius", 0.03).unwrap();
    let both = Settings { volume: usual.volume.along_beams(radius).in_planes(), ..usual };
    let alone = Settings { volume: usual.volume.in_planes(), ..usual };
    let mut measured = [Moments::new(), Moments::new()];
    for replicate in 0..64 {
        let filling = MapSettings { media: both.media(), ..filling(1000, Indirect::Seen, 41, replicate) };
        let maps = fill(&scene, &filling, &NoProgress).unwrap();
        for (moments, read) in measured.iter_mut().zip([&both, &alone]) {
            let mapper = Mapper::new(&scene, &maps, read);
            let seen = (0..200).map(|history| {
                let stream = &mut Stream::new(41, Purpose::Paths, replicate + 1, history);
                mapper.radiance(ray(history, stream), None, 0, stream).0.multiple[0]
            });
            moments.push(seen.sum::<f64>() / 200.0);
        }
    }
    let expected = reference.mean();
    let reference = (expected, reference.std_error());
    // Less than what beams bring, so that light read twice would be found too.
    let promise = 0.15;
    verdict::agrees_with_a_tail("planes and beams", &measured[0], reference, promise * expected, 41);
    verdict::rejects("planes alone", &measured[1], expected, 41);
    assert!(measured[1].mean() < (1.0 - promise) * expected, "{:?}", measured[1]);
}

/// One sensor of radiance in a medium.
fn looked_into(medium: Medium, orders: Orders, objects: bool) -> Scene {
    let wall = turbid::scene::Object {
        shape: Shape::Rectangle(rectangle(DVec3::splat(2.0), DVec3::X, DVec3::Y)),
        surface: lambertian(Spectrum::ONE),
    };
    Scene::new(SceneParts {
        regions: vec![Region { shape: cuboid(DVec3::ZERO, DVec3::ONE), medium }],
        objects: objects.then_some(wall).into_iter().collect(),
        lights: vec![point_light(DVec3::splat(0.4), Spectrum::ONE)],
        sensors: vec![sensor(Quantity::Radiance(Ray::new(DVec3::ZERO, DVec3::Z)), orders)],
        ..SceneParts::default()
    })
    .unwrap()
}

/// What planes cannot do is refused by name: media that vary, extinction that differs by channel, bodies, light scattered once without
/// beams, and photons of a file. Nothing that is asked for is left out in silence.
#[test]
fn what_planes_cannot_do_is_refused() {
    let twice = Orders { min: 2, max: None };
    let settings =
        |estimator| PhotonSettings { photons: 200, maps: 1, seed: 1, orders: Orders::ALL, estimator };
    let even = || homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.0);
    let colored = homogeneous(Spectrum::rgb(1.0, 2.0, 3.0), Spectrum::grey(0.5), 0.0);
    let uneven = varying(Spectrum::ONE, 0.5, layered((DVec3::ZERO, DVec3::ONE), 3, |z| z));
    for (scene, words) in [
        (looked_into(colored, twice, false), "extinction differs by channel"),
        (looked_into(uneven, twice, false), "media that vary"),
        (looked_into(even(), twice, true), "does not know what surfaces reflect"),
        (looked_into(even(), Orders::ALL, false), "sensor test: planes bring light that is scattered twice"),
    ] {
        let error = by_photons(&scene, &settings(in_planes()), &NoProgress).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let scene = looked_into(even(), twice, false);
    let error =
        by_given_photons(&scene, &settings(in_planes()), [Ok((Vec::new(), 1))]).unwrap_err().to_string();
    assert!(error.contains("no beams or planes"), "{error}");
    let of = |orders: Orders| {
        let scene = looked_into(even(), orders, false);
        by_photons(&scene, &settings(in_planes()), &NoProgress).unwrap().measurements[0].mean
    };
    assert!(of(twice) > 0.0 && of(Orders::only(0)) == 0.0);
}

/// The same bits on any number of threads; passes share out the histories of one.
#[test]
fn readings_do_not_depend_on_threads() {
    let scene = Scene::new(SceneParts {
        lights: vec![incidence(layer(1.0), Incidence::Diffuse)],
        regions: vec![region(layer(1.0), 1.0, 0.9, 0.5)],
        sensors: vec![sensor(
            Quantity::Radiance(Ray::new(DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.6, 0.0, 0.8))),
            Orders::SCATTERED,
        )],
        cell: Some(DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap();
    let balls = Estimator::new(Kernel::Uniform, Gather::radius(0.1).unwrap());
    let estimator = balls.in_planes().along_beams(Positive::new("the radius", 0.1).unwrap());
    let settings = PhotonSettings { photons: 20_000, maps: 2, seed: 1, orders: Orders::ALL, estimator };
    let read = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| by_photons(&scene, &settings, &NoProgress).unwrap().measurements)
    };
    let alone = read(1);
    assert_eq!(alone, read(5));
    let passes = by_photons_in_passes(&scene, &settings, 3, &NoProgress).unwrap().measurements;
    assert!((passes[0].mean / alone[0].mean - 1.0).abs() < 1e-5, "{} {}", passes[0].mean, alone[0].mean);
    let forecast = forecast(&scene, &settings, 1).unwrap();
    assert!(forecast.stored > 20_000.0 && forecast.bytes > 20_000.0 * 900.0, "{forecast:?}");
}
