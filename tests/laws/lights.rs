//! Lights: density against sample, one emitter in two forms (photons sent out, directions aimed at it, rays that
//! meet it), and the power that they state.

use crate::checks::light::{corner_solid_angle, photons_and_paths_cross_a_box_alike};
use crate::common::config as properties;
use crate::support::run::{numbers, paths, tallies};
use crate::support::scenes::{
    area_light, bounded, cuboid, dielectric, isotropic, outflow, point_light, rectangle, region, sphere,
    volume_source,
};
use crate::support::{unit_vector, verdict};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::geometry::{Mesh, Revolution, Shape, Sphere};
use turbid::light::{Area, Beam, Faces, Light, PrimarySample, Section, Spot, Sun};
use turbid::math::{FOUR_PI, Ray, warp};
use turbid::scene::{Interior, Object, Orders, Quantity, Scene, SceneParts};
use turbid::surface::{Black, Surface};

const N: u64 = 1 << 17;

/// Paths through a large sphere seldom meet a small light: more of them.
const MANY: u64 = 1 << 20;

/// Coloured lights about the origin, all within a distance of 1.5.
pub fn lights() -> Vec<(&'static str, Light)> {
    let color = Spectrum::rgb(1.0, 2.0, 0.5);
    let ball = sphere(DVec3::new(0.2, -0.1, 0.3), 0.8);
    let block = cuboid(DVec3::splat(-0.5), DVec3::new(0.5, 0.25, 0.75));
    let r = rectangle(DVec3::new(-0.5, -0.4, 0.1), DVec3::X, DVec3::Y * 0.8);
    // Off the lamps, so that all can stand in one scene.
    let (beside, around) = (
        rectangle(DVec3::new(-0.5, -0.4, 0.11), DVec3::X, DVec3::Y * 0.8),
        cuboid(DVec3::splat(-0.51), DVec3::new(0.51, 0.26, 0.76)),
    );
    let tilted = DVec3::new(0.6, 0.0, 0.8);
    let disc = Section::Disc { center: DVec3::new(0.1, 0.0, -0.3), radius: 0.6 };
    let emitting = |shape: Shape| Light::Area(Area::new(shape, color).unwrap());
    let spot = Spot::new(DVec3::new(0.3, 0.1, -0.2), tilted, (20.0, 40.0), color).unwrap();
    vec![
        ("point", point_light(DVec3::new(0.3, -0.2, 0.12), color)),
        ("area", area_light(r, color)),
        ("emitting sphere", emitting(sphere(DVec3::new(0.0, 0.2, -0.1), 0.4))),
        ("emitting cuboid", emitting(block.clone())),
        ("spot", Light::Spot(spot)),
        ("disc beam", Light::Beam(Beam::new(tilted, color, disc).unwrap())),
        ("rectangular beam", Light::Beam(Beam::new(DVec3::Z, color, Section::Rectangle(beside)).unwrap())),
        ("isotropic, sphere", isotropic(ball.clone(), Faces::Both)),
        ("isotropic, cuboid", isotropic(around, Faces::Both)),
        ("volume source, sphere", volume_source(ball)),
        ("volume source, cuboid", volume_source(block)),
    ]
}

/// A sun of this angular radius through a rectangle that it sees at an angle; its photons begin outside of a ball.
fn sun_through_a_portal(radius: f64) -> Light {
    let sun = Sun::new(DVec3::new(0.6, 0.0, 0.8), Spectrum::rgb(1.0, 2.0, 0.5), radius).unwrap();
    let window = rectangle(DVec3::new(-1.0, -0.5, -0.6), DVec3::X * 1.6, DVec3::Y);
    Light::Sun(sun.covering(Sphere::new(DVec3::ZERO, 2.0).unwrap()).through(window).unwrap())
}

/// Suns whose photons cover the boxes below; their light is everywhere, so that no sphere is crossed by all of it.
pub fn suns() -> Vec<(&'static str, Light)> {
    let covered = Sphere::new(DVec3::ZERO, 2.0).unwrap();
    let dir = DVec3::new(0.6, 0.0, 0.8);
    let sun = |radius: f64| {
        Light::Sun(Sun::new(dir, Spectrum::rgb(1.0, 2.0, 0.5), radius).unwrap().covering(covered))
    };
    vec![
        ("wide sun", sun(30.0)),
        ("sun without disc", sun(0.0)),
        ("wide sun through a portal", sun_through_a_portal(30.0)),
        ("sun without disc through a portal", sun_through_a_portal(0.0)),
    ]
}

/// All that a light sends out leaves a sphere around it: photons exactly, paths on average. A light's radiance, its
/// power, its emission and its density are then one.
#[test]
fn everything_that_is_sent_leaves_a_surrounding_sphere() {
    let around = outflow(sphere(DVec3::ZERO, 3.0));
    for (name, light) in lights() {
        let scene = bounded(Vec::new(), Vec::new(), vec![light]);
        let by_photons = tallies(&scene, &[(around.clone(), Orders::ALL)], 4096, 1);
        let by_paths = paths(&scene, around.clone(), Orders::ALL, MANY / 2, 1);
        for c in 0..3 {
            assert!((by_photons[0][c].mean() - 1.0).abs() < 1e-12, "{name}: {}", by_photons[0][c].mean());
            verdict::agrees(name, &by_paths[c], (1.0, 0.0), 0.15, 1);
        }
    }
}

/// The share that crosses a box beside or around the light: photons against paths.
#[test]
fn photons_and_paths_agree_on_a_box_beside_the_light() {
    let boxes = [
        cuboid(DVec3::new(-0.7, -0.6, 0.4), DVec3::new(0.9, 0.5, 1.6)),
        cuboid(DVec3::new(0.55, -1.0, -1.0), DVec3::new(1.2, 1.0, 1.0)),
    ];
    for (name, light) in lights().into_iter().chain(suns()) {
        for (i, shape) in boxes.clone().into_iter().enumerate() {
            // A portal is a small part of what paths look at.
            let paths = if name.contains("portal") { MANY / 2 } else { MANY / 4 };
            photons_and_paths_cross_a_box_alike(&format!("{name}, box {i}"), light.clone(), shape, paths);
        }
    }
}

#[test]
fn a_light_is_the_sum_of_its_quarters() {
    crate::checks::light::a_light_is_the_sum_of_its_quarters();
}

/// 1/density is the solid angle of the light, to some roundings, and is met by uniform rays with density 1/that.
#[test]
fn the_area_light_fills_its_solid_angle() {
    let light = area_light(rectangle(DVec3::ZERO, DVec3::X * 2.0, DVec3::Y), Spectrum::ONE);
    let p = DVec3::new(0.5, 0.25, 0.6);
    let expected =
        [(0.5, 0.25), (1.5, 0.25), (0.5, 0.75), (1.5, 0.75)].map(|(a, b)| corner_solid_angle(a, b, 0.6));
    let expected: f64 = expected.iter().sum();
    for u in [[0.1, 0.2], [0.9, 0.5]] {
        let aimed = 1.0 / light.sample(p, u).unwrap().pdf_solid_angle.unwrap();
        assert!((aimed / expected - 1.0).abs() < 1e-14, "{aimed} {expected}");
    }
    // Far away points are chosen by area.
    let far = DVec3::new(30.0, 40.0, 60.0);
    let corners =
        [(30.0, 40.0), (28.0, 40.0), (30.0, 39.0), (28.0, 39.0)].map(|(a, b)| corner_solid_angle(a, b, 60.0));
    let expected_far = corners[0] - corners[1] - corners[2] + corners[3];
    let aimed =
        numbers(N, 7, |s| light.sample(far, s.pair()).map_or(0.0, |l| 1.0 / l.pdf_solid_angle.unwrap()));
    verdict::agrees("solid angle from afar", &aimed, (expected_far, 1e-14), 0.02 * expected_far, 7);
    let met = numbers(N, 5, |s| {
        let ray = Ray::new(p, warp::square_to_sphere(s.pair()));
        FOUR_PI * light.hit(&ray, None).map_or(0.0, |hit| light.emitted(&ray, &hit).1)
    });
    verdict::agrees("density over rays", &met, (1.0, 0.0), 0.08, 5);
    // The negative control forgets the cosine.
    let wrong = numbers(N, 6, |s| {
        light.sample(p, s.pair()).map_or(0.0, |l| 1.0 / (l.pdf_solid_angle.unwrap() * l.dir.z.abs()))
    });
    verdict::rejects("without the cosine", &wrong, expected, 6);
}

/// A lamp above the plane of a point by less than any angle: a direction with numbers, or none (found by `fuzz`: a density that
/// was infinite made the balance of two densities none).
#[test]
fn lamps_seen_edge_on_have_numbers_or_none() {
    let mut sampled = 0;
    for height in [1e-3, 1e-8, 1e-16, 1e-60, 1e-140, 1e-200, 1e-290, 5e-300, 1e-306, 1e-308, 5e-324] {
        let corner = DVec3::new(15.0, 7.0, height);
        let light = area_light(rectangle(corner, DVec3::Y * 2.0, DVec3::X * 2.0), Spectrum::ONE);
        for p in
            [DVec3::ZERO, DVec3::new(14.0, 8.0, 0.0), DVec3::new(16.0, 8.0, 0.0), DVec3::new(2e3, 0.0, 0.0)]
        {
            for u in [[0.1, 0.9], [0.5, 0.5], [0.99, 0.3]] {
                let Some(sample) = light.sample(p, u) else {
                    // Then nothing is expected of a ray that meets it by chance, either.
                    let ray = Ray::new(p, (DVec3::new(16.0, 8.0, height) - p).normalize());
                    let met = light.hit(&ray, None).map_or(0.0, |hit| light.emitted(&ray, &hit).1);
                    assert!(height < 1e-150 || met == 0.0, "{height} above {p}: met with density {met}");
                    continue;
                };
                let (pdf, size) = (sample.pdf_solid_angle.unwrap(), sample.dir.length());
                let is_number = pdf.is_finite() && sample.value.is_finite() && sample.distance.is_finite();
                assert!(is_number && (size - 1.0).abs() < 1e-15, "{height} above {p}: {sample:?}");
                sampled += 1;
            }
        }
    }
    assert!(sampled > 20, "{sampled}");
}

proptest! {
    #![proptest_config(properties(5000))]

    /// A ray along a sampled direction meets the light where the sample says, with the same radiance and density.
    #[test]
    fn a_sampled_direction_meets_the_light(x in -6.0..6.0f64, y in -6.0..6.0f64, z in -6.0..6.0f64, u in 0.0..0.999f64, v in 0.0..1.0f64) {
        let p = DVec3::new(x, y, z);
        for (name, light) in lights().into_iter().chain(suns()) {
            let Some(sample) = light.sample(p, [u, v]) else { continue };
            prop_assert!((sample.dir.length() - 1.0).abs() < 4.0 * f64::EPSILON);
            let Some(pdf) = sample.pdf_solid_angle else { continue };
            let ray = Ray::new(p, sample.dir);
            if let Some((radiance, met)) = light.background(&ray) {
                prop_assert_eq!((radiance / pdf, met), (sample.value, pdf));
                continue;
            }
            let is_flat = name != "emitting sphere";
            let Some(hit) = light.hit(&ray, None) else {
                prop_assert!(is_flat && (u < 1e-9 || v < 1e-9 || sample.dir.z.abs() < 1e-6), "{name} missed from {p}");
                continue;
            };
            let (radiance, met) = light.emitted(&ray, &hit);
            // Flat: distances and a cosine, each to rounding over the cosine. Sphere: the half-angle only.
            let tolerance = if is_flat { 1e-13 / sample.dir.dot(hit.normal).abs() } else { 1e-13 };
            prop_assert!((hit.t - sample.distance).abs() <= tolerance * (1.0 + hit.t), "{name}");
            prop_assert!((met / pdf - 1.0).abs() < tolerance, "{name}: {met} {pdf}");
            let value = sample.value * pdf;
            prop_assert!((value.0 - radiance.0).length() < 1e-12 * radiance.max(), "{name}");
        }
    }

    /// The part of a ray that a beam lights holds the points that it lights, and no others.
    #[test]
    fn a_beam_crosses_a_ray_where_it_lights_it(x in -3.0..3.0f64, y in -3.0..3.0f64, z in -3.0..3.0f64, mu in -1.0..=1.0f64, azimuth in 0.0..6.3f64, t in 0.0..8.0f64, tilt in -1.0..=1.0f64) {
        let frame = turbid::math::Frame::new(unit_vector(tilt, 1.0 + azimuth));
        let center = DVec3::new(0.1, 0.2, -0.3);
        let corner = center - frame.x - 0.5 * frame.y;
        let square = Section::Rectangle(rectangle(corner, frame.x * 2.0, frame.y));
        for section in [square, Section::Disc { center, radius: 0.8 }] {
            let beam = Beam::new(frame.z, Spectrum::ONE, section).unwrap();
            // Any way, along the beam, and across it.
            for dir in [unit_vector(mu, azimuth), frame.z, -frame.z, frame.x] {
                let ray = Ray::new(DVec3::new(x, y, z), dir);
                let part = beam.interval(&ray);
                let is_lit = Light::Beam(beam).sample(ray.at(t), [0.5; 2]).is_some();
                let is_in = part.is_some_and(|part| (part.start..=part.end).contains(&t));
                let is_at_end = part.is_some_and(|part| (t - part.start).abs().min((t - part.end).abs()) < 1e-9);
                prop_assert!(is_lit == is_in || is_at_end, "{section:?} {ray:?} {t} {part:?}");
            }
        }
    }

    /// Seen from behind or inside nothing is sampled and nothing is met.
    #[test]
    fn lights_are_dark_from_behind(z in -1.0..=1.0f64, azimuth in 0.0..6.3f64, u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let dir = unit_vector(z, azimuth);
        let area = area_light(rectangle(DVec3::ZERO, DVec3::X, DVec3::Y), Spectrum::ONE);
        let below = DVec3::new(0.5, 0.5, -0.5);
        prop_assert!(area.sample(below, [u, v]).is_none());
        let ray = Ray::new(below, dir);
        if let Some(hit) = area.hit(&ray, None) {
            prop_assert_eq!(area.emitted(&ray, &hit), (Spectrum::ZERO, 0.0));
        }
        let ball = Light::Area(Area::new(sphere(DVec3::ZERO, 1.0), Spectrum::ONE).unwrap());
        let inside = Ray::new(dir * 0.5, unit_vector(2.0 * u - 1.0, 6.0 * v));
        prop_assert!(ball.sample(inside.origin, [u, v]).is_none());
        let hit = ball.hit(&inside, None).unwrap();
        prop_assert_eq!(ball.emitted(&inside, &hit).0, Spectrum::ZERO);
    }
}

/// A beam lights what is in its shaft, its own section included, and nothing beside or before it.
#[test]
fn a_beam_lights_its_shaft() {
    let r = rectangle(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    for section in [Section::Rectangle(r), Section::Disc { center: DVec3::ZERO, radius: 1.0 }] {
        let beam = Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, section).unwrap());
        let at = |x: f64, z: f64| beam.sample(DVec3::new(x, 0.0, z), [0.5; 2]).map(|s| s.distance);
        assert_eq!(at(0.5, 2.0), Some(2.0));
        assert_eq!(at(0.5, 0.0), Some(0.0), "{section:?}: on the section itself");
        assert_eq!(at(1.5, 2.0), None);
        assert_eq!(at(0.5, -0.1), None);
        assert_eq!(beam.sample(DVec3::new(0.0, 0.0, 1.0), [0.5; 2]).unwrap().dir, DVec3::NEG_Z);
    }
    let wrong = Beam::new(DVec3::NEG_Z, Spectrum::ONE, Section::Rectangle(r));
    assert!(wrong.is_err() && Beam::new(DVec3::ZERO, Spectrum::ONE, Section::Unbounded).is_err());
}

/// A spot's power is the integral of its intensity, its photons follow it, and every number carries the same power.
#[test]
fn a_spot_sends_what_it_shows() {
    let axis = DVec3::new(0.6, 0.0, 0.8);
    for (full, edge) in [(20.0, 40.0), (0.0, 90.0), (30.0, 30.0), (0.0, 180.0), (1e-3, 2e-3)] {
        let spot = Spot::new(DVec3::ZERO, axis, (full, edge), Spectrum::grey(3.0)).unwrap();
        let frame = turbid::math::Frame::new(axis);
        let one_minus_cos = |degrees: f64| {
            let half = turbid::math::sin(degrees.to_radians() / 2.0);
            2.0 * half * half
        };
        let (a, b) = (one_minus_cos(full), one_minus_cos(edge));
        let intensity = |w: f64| spot.intensity(frame.to_world(warp::direction((w, 2.0 - w), 0.3)))[0];
        // A cubic, by Simpson's rule exactly, except that 1 - cos of a direction is rounded to 1e-16 of its root.
        let simpson = |from: f64, to: f64| {
            let middle = intensity(0.5 * (from + to));
            (to - from) / 6.0 * (intensity(from) + 4.0 * middle + intensity(to))
        };
        let power = 2.0 * PI * (intensity(0.0) * a + if b > a { simpson(a, b) } else { 0.0 });
        let rounding = 1e-14 + 1e-15 / a.max(b).sqrt();
        assert!((power / 3.0 - 1.0).abs() < rounding, "{full} {edge}: {power}");
        let light = Light::Spot(spot);
        let at = |u: f64| {
            let numbers = PrimarySample { position: [0.0; 3], direction: [u, 0.3] };
            turbid::math::cosine_pair(light.emit_at(None, &numbers).ray.dir, axis).0
        };
        // The numbers are the distribution function of 1 - cos: its slope is the intensity's share.
        for i in 1..50 {
            let u = f64::from(i) / 50.0;
            let (low, high) = (at(u - 1e-4), at(u + 1e-4));
            let share = 2.0 * PI * intensity(at(u)) / 3.0;
            let slope = 2e-4 / (high - low);
            // Differences: their own curvature, largest where the intensity is small.
            assert!((slope / share - 1.0).abs() < 1e-3, "{full} {edge} at {u}: {slope} {share}");
        }
    }
    assert!(Spot::new(DVec3::ZERO, axis, (50.0, 40.0), Spectrum::ONE).is_err());
    assert!(Spot::new(DVec3::ZERO, axis, (0.0, 0.0), Spectrum::ONE).is_err());
}

/// The sun's photons cover what is in its scene, however it is tilted: fog scatters as much of them as paths find.
#[test]
fn the_sun_covers_its_scene() {
    let ball = sphere(DVec3::new(3.0, -2.0, 1.0), 0.7);
    for (radius, seed) in [(0.0, 1), (2.0, 2), (45.0, 3)] {
        let sun = Light::Sun(Sun::new(DVec3::new(-1.0, 2.0, 3.0), Spectrum::ONE, radius).unwrap());
        let scene = bounded(vec![region(ball.clone(), 1.0, 0.8, 0.3)], Vec::new(), vec![sun]);
        let quantity = outflow(ball.clone());
        let by_photons = tallies(&scene, &[(quantity.clone(), Orders::SCATTERED)], N, seed);
        let by_paths = paths(&scene, quantity, Orders::SCATTERED, N, seed);
        verdict::agree(&format!("sun of {radius}"), &by_photons[0][0], &by_paths[0], 0.02, seed);
    }
    let nothing = SceneParts { lights: suns().into_iter().map(|l| l.1).collect(), ..SceneParts::default() };
    assert!(Scene::new(nothing).is_ok(), "these are told what to cover");
    let lost = Light::Sun(Sun::new(DVec3::X, Spectrum::ONE, 1.0).unwrap());
    assert!(Scene::new(SceneParts { lights: vec![lost], ..SceneParts::default() }).is_err());
}

/// Irradiance at normal incidence is what the sun states: by directions towards it, and by rays that meet its disc.
#[test]
fn the_sun_lights_a_plane_as_it_states() {
    let sun = Light::Sun(Sun::new(DVec3::NEG_Z, Spectrum::grey(2.0), 30.0).unwrap());
    let aimed = numbers(N, 7, |s| sun.sample(DVec3::ZERO, s.pair()).map_or(0.0, |l| l.value[0] * l.dir.z));
    verdict::agrees("aimed", &aimed, (2.0, 1e-14), 0.01, 7);
    let met = numbers(N, 8, |s| {
        let dir = warp::square_to_cosine_hemisphere(s.pair());
        PI * sun.background(&Ray::new(DVec3::ZERO, dir)).map_or(0.0, |(radiance, _)| radiance[0])
    });
    verdict::agrees("met", &met, (2.0, 1e-14), 0.08, 8);
    assert!(
        Sun::new(DVec3::ZERO, Spectrum::ONE, 1.0).is_err()
            && Sun::new(DVec3::X, Spectrum::ONE, 60.0).is_err()
    );
}

/// Behind a portal there is the light that a window in black walls lets through, and as much of it: by photons, by
/// directions towards the sun, and by rays that meet its disc.
#[test]
fn a_portal_is_a_window_in_a_dark_wall() {
    let power = Spectrum::rgb(1.0, 2.0, 0.5);
    let window = rectangle(DVec3::new(-0.2, -0.3, 0.0), DVec3::X * 0.4, DVec3::Y * 0.6);
    // Far enough to be walls to every ray that the fog sends back.
    let walls = [
        ((-9.0, -9.0), (18.0, 8.7)),
        ((-9.0, 0.3), (18.0, 8.7)),
        ((-9.0, -0.3), (8.8, 0.6)),
        ((0.2, -0.3), (8.8, 0.6)),
    ]
    .map(|((x, y), (u, v))| {
        let shape = rectangle(DVec3::new(x, y, 0.0), DVec3::X * u, DVec3::Y * v);
        (Shape::Rectangle(shape), Surface::Black(Black))
    });
    let room = cuboid(DVec3::new(-0.8, -0.8, 0.01), DVec3::new(1.2, 0.8, 1.6));
    for (radius, seed) in [(0.0, 1), (20.0, 2)] {
        let sun = Sun::new(DVec3::new(0.6, 0.1, 0.8), power, radius).unwrap();
        let fog = || vec![region(room.clone(), 1.0, 0.7, 0.2)];
        let scenes = [
            bounded(fog(), Vec::new(), vec![Light::Sun(sun.through(window).unwrap())]),
            bounded(fog(), walls.to_vec(), vec![Light::Sun(sun)]),
        ];
        let [open, walled] = scenes.each_ref().map(|scene| scene.lights()[0].power(None)[1]);
        let exact = 2.0 * 0.24 * 0.8 / DVec3::new(0.6, 0.1, 0.8).length();
        assert!((open / exact - 1.0).abs() < 1e-14, "{open} {exact}");
        // Shares of each light's power: of the sun without a portal most is lost on the walls.
        let what = format!("sun of {radius}");
        let absorbed = Quantity::Absorbed(0);
        let by_photons = tallies(&scenes[0], &[(absorbed.clone(), Orders::ALL)], N, seed)[0][1];
        let by_paths = paths(&scenes[0], absorbed.clone(), Orders::ALL, N, seed)[1];
        verdict::agree(&format!("{what}: absorbed"), &by_photons, &by_paths, 0.15, seed);
        // Path by path; absorbed light is a share of each light's power, and most of the open sun's is lost on the walls.
        let at = |x, y, z| (Quantity::Fluence(DVec3::new(x, y, z)), 1.0);
        for (quantity, share) in [(absorbed, walled / open), at(0.15, 0.05, 0.3), at(-0.5, 0.2, 0.8)] {
            let [a, b] = scenes
                .each_ref()
                .map(|scene| paths(scene, quantity.clone(), Orders::ALL, 1 << 13, seed)[1].mean());
            assert!(a > 0.0 && (b * share / a - 1.0).abs() < 1e-9, "{what}: {quantity:?} {a} {b}");
        }
    }
    // Near a window all of whose points a wide disc fills, the sun's radiance times the window's solid angle; behind it
    // nothing, but where its lines come from.
    let (small, at) = (rectangle(DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.1), DVec3::new(0.0, 0.0, 0.5));
    let wide = Light::Sun(Sun::new(DVec3::Z, Spectrum::ONE, 30.0).unwrap().through(small).unwrap());
    let expected = corner_solid_angle(0.1, 0.1, 0.5) / (0.25 * PI);
    let aimed = numbers(N, 4, |s| wide.sample(at, s.pair()).map_or(0.0, |l| l.value[0]));
    verdict::agrees("aimed", &aimed, (expected, 1e-14), 0.1 * expected, 4);
    let met = numbers(N, 5, |s| {
        let ray = Ray::new(at, warp::square_to_cone(s.pair(), 0.5) * -1.0);
        PI * wide.background(&ray).map_or(0.0, |(radiance, _)| radiance[0])
    });
    verdict::agrees("met", &met, (expected, 1e-14), 0.2 * expected, 5);
    for bad in [-DVec3::Z, DVec3::X, DVec3::new(1.0, 0.0, 0.5)] {
        let refused = Sun::new(bad, Spectrum::ONE, 30.0).unwrap().through(small).unwrap_err().to_string();
        assert!(refused.contains("portal") && refused.contains("allowed: below 60"), "{refused}");
    }
    assert!(Sun::new(DVec3::new(1.0, 0.0, 0.5), Spectrum::ONE, 0.0).unwrap().through(small).is_ok());
}

/// A mesh of squares of half side 1/2 about the z axis at these heights, that face up.
fn plates(heights: &[f64]) -> Shape {
    let corners =
        |z: f64| [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| DVec3::new(x, y, z));
    let positions: Vec<DVec3> = heights.iter().flat_map(|z| corners(*z)).collect();
    let triangles: Vec<[u32; 3]> = (0..heights.len() as u32)
        .flat_map(|i| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| 4 * i + c)))
        .collect();
    Shape::Mesh(Arc::new(Mesh::new(&positions, &triangles, None).unwrap()))
}

/// A ball of triangles, inscribed in one of radius 1/2 about the origin.
fn faceted() -> Shape {
    const ROWS: u32 = 24;
    let point = |row: u32, column: u32| {
        let (polar, azimuth) =
            (PI * f64::from(row) / f64::from(ROWS), PI * f64::from(column) / f64::from(ROWS));
        0.5 * unit_vector(libm::cos(polar), azimuth)
    };
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (row, column) in (0..ROWS).flat_map(|row| (0..2 * ROWS).map(move |column| (row, column))) {
        let first = positions.len() as u32;
        positions.extend(
            [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
                .map(|(r, c)| point(r, c)),
        );
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    Shape::Mesh(Arc::new(Mesh::new(&positions, &triangles, None).unwrap()))
}

/// One light in two forms: a rectangle and two triangles, a sphere and a fine mesh; and of two plates, one behind the other,
/// the front one alone is seen. Fluence is the solid angle, from straight above and from the side.
#[test]
fn meshes_shine_as_what_they_are_made_like() {
    let emitting = |shape: Shape| Light::Area(Area::new(shape, Spectrum::ONE).unwrap());
    let square = rectangle(DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y);
    let (above, beside) = (DVec3::new(0.0, 0.0, 0.8), DVec3::new(0.5, 0.5, 0.7));
    let ball = 2.0 * PI * (1.0 - (1.0 - 0.25 / beside.length_squared()).sqrt());
    // Facets of an angle of pi/24 lie within cos(pi/48) of the sphere: 0.4 per cent of its area, of which a fifth counts.
    for (i, (name, shape, p, expected, off)) in [
        ("rectangle", Shape::Rectangle(square), above, 4.0 * corner_solid_angle(0.5, 0.5, 0.8), 1e-12),
        ("two triangles", plates(&[0.0]), above, 4.0 * corner_solid_angle(0.5, 0.5, 0.8), 1e-12),
        ("two triangles, beside", plates(&[0.0]), beside, corner_solid_angle(1.0, 1.0, 0.7), 1e-12),
        ("two plates", plates(&[0.0, -0.4]), above, 4.0 * corner_solid_angle(0.5, 0.5, 0.8), 1e-12),
        ("sphere", sphere(DVec3::ZERO, 0.5), beside, ball, 1e-12),
        ("fine mesh", faceted(), beside, ball, 0.004 / 5.0),
    ]
    .into_iter()
    .enumerate()
    {
        let scene = bounded(Vec::new(), Vec::new(), vec![emitting(shape)]);
        let seed = 60 + i as u64;
        let found = paths(&scene, Quantity::Fluence(p), Orders::ALL, 1 << 15, seed)[0];
        verdict::agrees(name, &found, (expected, off * expected), 0.1 * expected, seed);
    }
}

/// Lamps with parts that stand before each other: photons that meet their own lamp end there, and no path sees through it.
#[test]
fn lamps_hide_themselves() {
    let color = Spectrum::rgb(1.0, 2.0, 0.5);
    let profile = [(0.0, -0.9), (0.4, -0.6), (0.1, -0.2), (0.1, 0.2), (0.4, 0.6), (0.0, 0.9)];
    let profile = profile.map(|(radius, height)| DVec2::new(radius, height));
    let dumbbell = Shape::Revolution(Arc::new(Revolution::new(DVec3::ZERO, DVec3::Z, &profile).unwrap()));
    let around = cuboid(DVec3::new(-0.7, -0.6, -0.2), DVec3::new(0.9, 0.5, 0.3));
    for (name, shape) in [("two plates", plates(&[0.1, -0.1])), ("dumbbell", dumbbell)] {
        let light = Light::Area(Area::new(shape, color).unwrap());
        photons_and_paths_cross_a_box_alike(name, light, around.clone(), MANY / 16);
    }
}

/// A lamp inside a ball of glass, some of whose light the glass keeps for long: photons and paths.
#[test]
fn light_leaves_glass() {
    let glass = Interior { name: "glass".into(), index: 1.5, medium: None };
    let scene = Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), glass],
        objects: vec![Object { shape: sphere(DVec3::ZERO, 0.6), surface: dielectric(1, 0) }],
        lights: vec![Light::Area(Area::new(sphere(DVec3::new(0.2, 0.0, 0.0), 0.2), Spectrum::ONE).unwrap())],
        ..SceneParts::default()
    })
    .unwrap();
    let beside = outflow(cuboid(DVec3::new(0.7, -1.0, -1.0), DVec3::new(1.2, 1.0, 1.0)));
    let photons = tallies(&scene, &[(beside.clone(), Orders::ALL)], N, 70);
    let found = paths(&scene, beside, Orders::ALL, 4 * N, 71);
    verdict::agree("beside the glass", &photons[0][0], &found[0], 0.05, 70);
}
