//! Path classes: what a stored photon has met, what a caller can select by it, and the layers of a picture.

use crate::support::quadrature::integrate;
use crate::support::run::{pass, paths};
use crate::support::scenes::{area_light, bounded, cuboid, emitting_sphere, rectangle, region};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::Shape;
use turbid::integrators::{Guides, Layer, Layers, path};
use turbid::math::{FOUR_PI, Ray, atan2, exp};
use turbid::photons::{Flags, Histories, Photon, PhotonMap, is_in, is_indirect, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, SURROUNDINGS, Scene};
use turbid::stats::Moments;
use turbid::surface::{Lambertian, Mirror, Surface};
use turbid::transport::NoProgress;

const N: u64 = 1 << 16;
/// The light: a sphere of power 1, as far above the mirror as its image is below.
const LIGHT: DVec3 = DVec3::new(1.5, 1.0, 0.5);
const IMAGE: DVec3 = DVec3::new(1.5, 1.0, -0.5);
const LIGHT_RADIUS: f64 = 0.1;
const MIRROR: f64 = 0.8;

/// A box of fog with mean free path 1; its floor is a mirror, one wall is diffuse, the other faces are open.
fn room() -> Scene {
    room_with(LIGHT_RADIUS)
}

/// The same with another size of its light.
fn room_with(radius: f64) -> Scene {
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    let floor = Shape::Rectangle(rectangle(DVec3::ZERO, x, y));
    let wall = Shape::Rectangle(rectangle(DVec3::ZERO, y, z));
    let mirror = Surface::Mirror(Mirror::new(Spectrum::grey(MIRROR)).unwrap());
    let diffuse = Surface::Lambertian(Lambertian::new(Spectrum::grey(0.6)).unwrap());
    bounded(
        vec![region(cuboid(DVec3::ZERO, DVec3::splat(2.0)), 1.0, 0.8, 0.0)],
        vec![(floor, mirror), (wall, diffuse)],
        vec![emitting_sphere(LIGHT, radius)],
    )
}

fn whole() -> Vec<Photon> {
    pass(&room(), &[], N, 1, |_| true).photons().collect::<Vec<_>>()
}

/// Every set of flags.
fn classes() -> Vec<Flags> {
    let either = |flag: Flags, sets: Vec<Flags>| -> Vec<Flags> {
        sets.iter().flat_map(|set| [*set, set.with(flag)]).collect()
    };
    either(Flags::MEDIUM, either(Flags::DIFFUSE, either(Flags::SPECULAR, vec![Flags::NONE])))
}

/// Whether the photon's way back, straight on, meets the sphere of the light's size about `center`. Directions are held
/// in single precision: 1e-6 at these distances.
fn comes_from(photon: &Photon, center: DVec3) -> bool {
    let back = -photon.dir.as_dvec3().normalize();
    let to_center = center - photon.position;
    let along = to_center.dot(back);
    along > 0.0 && (to_center - back * along).length() < LIGHT_RADIUS + 1e-6
}

#[test]
fn every_class_occurs() {
    let photons = whole();
    assert_eq!(classes().len(), 8);
    for class in classes() {
        let count = photons.iter().filter(|p| p.flags == class).count();
        assert!(count > 100, "{class:?}: {count} of {}", photons.len());
    }
}

/// Mirrors do not scatter: they raise no order.
#[test]
fn order_0_is_light_that_nothing_scattered() {
    for photon in whole() {
        let is_scattered = photon.flags.has(Flags::DIFFUSE) || photon.flags.has(Flags::MEDIUM);
        assert_eq!(photon.order == 0, !is_scattered, "{photon:?}");
        let is_scattered_by_both = photon.flags.has(Flags::DIFFUSE.with(Flags::MEDIUM));
        assert!(!is_scattered_by_both || photon.order >= 2, "{photon:?}");
    }
}

/// The way back tells: light in a mirror is of order 0 and yet not direct. After a collision a photon may come from the
/// light's direction by chance, so those are judged by their flags alone.
#[test]
fn indirect_is_what_does_not_come_straight_from_the_light() {
    let photons = whole();
    for photon in &photons {
        if photon.flags.has(Flags::MEDIUM) {
            assert!(is_indirect(photon), "{photon:?}");
        } else {
            assert_eq!(is_indirect(photon), !comes_from(photon, LIGHT), "{photon:?}");
        }
        if photon.flags == Flags::SPECULAR {
            assert!(comes_from(photon, IMAGE), "{photon:?}");
        }
    }
    assert!(photons.iter().any(|p| p.order == 0 && is_indirect(p)));
}

#[test]
fn the_caller_decides_what_a_pass_keeps() {
    let everything = pass(&room(), &[], N, 1, |_| true);
    let stored = everything.photons().count();
    let selected = |keep: &(dyn Fn(&Photon) -> bool + Sync)| {
        let kept = pass(&room(), &[], N, 1, keep);
        assert_eq!((kept.emitted(), kept.report.collisions), (N, everything.report.collisions));
        let expected: Vec<Photon> = everything.photons().filter(|p| keep(p)).collect();
        let kept = kept.photons().collect::<Vec<_>>();
        assert!(kept == expected, "{} kept, not {}", kept.len(), expected.len());
        kept
    };
    assert_eq!(stored as u64, everything.report.collisions);
    let by_class: usize = classes().iter().map(|class| selected(&|p| p.flags == *class).len()).sum();
    assert_eq!(by_class, stored);
    let mut by_order = selected(&is_in(Orders { min: 4, max: None })).len();
    for order in 0..4 {
        let kept = selected(&is_in(Orders::only(order)));
        assert!(!kept.is_empty() && kept.iter().all(|p| u32::from(p.order) == order));
        by_order += kept.len();
    }
    assert_eq!(by_order, stored);
    let direct = selected(&|p| !is_indirect(p)).len();
    assert_eq!(direct + selected(&is_indirect).len(), stored);
    assert!(selected(&|_| false).is_empty());
}

/// Fluence at a distance from the centre of a light of radius a, in fog of extinction 1: its radiance 1/(4 pi^2 a^2)
/// over the cone that it fills, each ray with its own length to the sphere.
fn fluence_of(a: f64, distance: f64) -> f64 {
    let a2 = a * a;
    let sine2 = a2 / (distance * distance);
    // c = 1 - (1 - cos of the cone) (1 - x^2): the square root at the cone's edge becomes smooth.
    let height = sine2 / (1.0 + (1.0 - sine2).sqrt());
    let cone = integrate(0.0, 1.0, 1, |x| {
        let cosine = 1.0 - height * (1.0 - x * x);
        let chord2 = a2 - distance * distance * (1.0 - cosine) * (1.0 + cosine);
        2.0 * x * height * exp(-(distance * cosine - chord2.max(0.0).sqrt()))
    });
    2.0 * PI * cone / (PI * FOUR_PI * a2)
}

fn fluence_of_the_light(distance: f64) -> f64 {
    fluence_of(LIGHT_RADIUS, distance)
}

/// Mean of that fluence over a ball about a point at that distance: at a distance s from the light lie
/// pi s (r^2 - (s - d)^2) / d of the ball's volume.
fn mean_over_a_ball(distance: f64, radius: f64) -> f64 {
    let sum = integrate(distance - radius, distance + radius, 1, |s| {
        fluence_of_the_light(s) * PI * s * (radius * radius - (s - distance) * (s - distance)) / distance
    });
    sum / (FOUR_PI / 3.0 * radius * radius * radius)
}

/// Photons that met the mirror and nothing else are the light of the image behind it: their fluence in a ball is the
/// image's mean over the ball, times the mirror's reflectance.
#[test]
fn photons_off_the_mirror_are_the_light_of_the_image() {
    const MAPS: u64 = 64;
    const PHOTONS: u64 = 90_000;
    let (scene, place, radius) = (room(), DVec3::new(0.7, 1.0, 0.6), 0.3);
    let (mut by_mirror, mut uncollided) = (Moments::new(), Moments::new());
    for replicate in 0..MAPS {
        let histories = Histories { count: PHOTONS, seed: 2, replicate, max_order: Some(0) };
        let photons = shoot(&scene, histories, &[], is_in(Orders::only(0)), &NoProgress)
            .unwrap()
            .photons()
            .collect::<Vec<_>>();
        let estimate = |photons: Vec<Photon>| {
            let map = PhotonMap::new(photons, PHOTONS).unwrap();
            let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius).unwrap());
            estimator.fluence(&map, place, Spectrum::ONE, &Boundary::UNKNOWN).value[0]
        };
        let specular = photons.iter().filter(|p| p.flags == Flags::SPECULAR).copied().collect();
        by_mirror.push(estimate(specular));
        uncollided.push(estimate(photons));
    }
    let direct = mean_over_a_ball(place.distance(LIGHT), radius);
    let image = MIRROR * mean_over_a_ball(place.distance(IMAGE), radius);
    verdict::agrees("off the mirror", &by_mirror, (image, 1e-9), 0.1 * image, 2);
    verdict::agrees("order 0", &uncollided, (direct + image, 1e-9), 0.05 * (direct + image), 2);
    // A mirror that keeps everything, and light told apart by its order alone, would be seen.
    verdict::rejects("a perfect mirror", &by_mirror, image / MIRROR, 2);
    verdict::rejects("order 0 as though it were direct", &uncollided, direct, 2);
    // The closed form itself, from afar: the inverse square and exp(-d), times the mean over the light's disc of what
    // its near side saves, exp(a c) with c the cosine on the sphere: 1 + 2a/3 to the first order of a.
    let far = fluence_of_the_light(50.0) * FOUR_PI * 2500.0 / exp(-50.0);
    assert!((far - 1.0 - 2.0 * LIGHT_RADIUS / 3.0).abs() < LIGHT_RADIUS * LIGHT_RADIUS, "{far}");
}

/// A mirror raises no order, so that what is seen in it is there however few orders are asked for: in vacuum, all of it.
#[test]
fn light_in_a_mirror_does_not_depend_on_the_largest_order() {
    let rho = Spectrum::rgb(1.0, 0.5, 0.2);
    let plane = rectangle(DVec3::new(-50.0, -50.0, 0.0), DVec3::X * 100.0, DVec3::Y * 100.0);
    let mirror = (Shape::Rectangle(plane), Surface::Mirror(Mirror::new(rho).unwrap()));
    // A square of side 2 at height 1 that shines down, the probe half way under its centre.
    let square = rectangle(DVec3::new(-1.0, 1.0, 1.0), DVec3::X * 2.0, DVec3::Y * -2.0);
    let lights = vec![area_light(square, Spectrum::ONE)];
    let probe = DVec3::new(0.0, 0.0, 0.5);
    let solid_angle = |height: f64| 4.0 * atan2(1.0, height * (2.0 + height * height).sqrt());
    let vacuum = bounded(Vec::new(), vec![mirror.clone()], lights.clone());
    let seen = |scene: &Scene, quantity, max| {
        paths(scene, quantity, Orders { min: 0, max }, 1 << 18, 3).map(|m| (m.mean(), m))
    };
    let all = seen(&vacuum, Quantity::Fluence(probe), None);
    for max in [0, 1, 5] {
        let up_to = seen(&vacuum, Quantity::Fluence(probe), Some(max));
        for c in 0..3 {
            // The same histories: the same numbers, but for rounding.
            assert!(
                (up_to[c].0 / all[c].0 - 1.0).abs() < 1e-12,
                "to order {max}: {} {}",
                up_to[c].0,
                all[c].0
            );
            let expected = solid_angle(0.5) + rho[c] * solid_angle(1.5);
            let what = format!("fluence to order {max}, channel {c}");
            verdict::agrees(&what, &up_to[c].1, (expected, 1e-13), 0.03 * expected, 3);
            verdict::rejects(&format!("{what}, no mirror"), &up_to[c].1, solid_angle(0.5), 3);
        }
    }
    // Straight down: half a length to the mirror and one back to the light, in fog as in vacuum.
    let down = Quantity::Radiance(Ray::new(probe, -DVec3::Z));
    let fog = region(cuboid(DVec3::splat(-2.0), DVec3::splat(2.0)), 1.0, 0.8, 0.0);
    let foggy = bounded(vec![fog], vec![mirror], lights);
    for (scene, expected) in [(&vacuum, 1.0), (&foggy, exp(-1.5))] {
        let radiance = seen(scene, down.clone(), Some(0));
        for c in 0..3 {
            assert!(
                (radiance[c].0 / (rho[c] * expected) - 1.0).abs() < 1e-12,
                "channel {c}: {}",
                radiance[c].0
            );
        }
    }
}

/// Moments of one class at one order [W/(L^2 sr)], channel 0.
fn class_of_order(scene: &Scene, ray: Ray, layer: Layer, order: u32, n: u64, seed: u64) -> Moments {
    crate::support::run::numbers(n, seed, |stream| {
        let mut sum = 0.0;
        path::classes(scene, ray, None, SURROUNDINGS, Orders::only(order), stream, |_, class, value| {
            sum += if class == layer { value[0] } else { 0.0 };
        });
        sum
    })
}

/// The layers of a path are its contributions by order, added up otherwise: the same histories, the same sum.
#[test]
fn layers_add_up_to_the_radiance() {
    let scene = room();
    let ray = Ray::new(DVec3::new(1.9, 0.3, 1.2), DVec3::new(-1.0, 0.4, -0.5).normalize());
    let mut seen = Layers::ZERO;
    for history in 0..20_000 {
        let stream = || Stream::new(5, Purpose::Paths, 0, history);
        let (layers, rays) = path::layers(&scene, ray, None, SURROUNDINGS, &mut stream());
        let mut sum = Spectrum::ZERO;
        let same = path::radiance(
            &scene,
            (ray, SURROUNDINGS),
            Orders::ALL,
            Guides::default(),
            &mut stream(),
            |_, value| sum += value,
        );
        assert_eq!(rays, same);
        // A dozen terms, all positive, in another order.
        let difference = (layers.total() - sum).max().abs();
        assert!(difference <= 64.0 * f64::EPSILON * sum.max(), "{history}: {difference:e}");
        seen += layers;
    }
    for (layer, value) in seen.iter().filter(|(layer, _)| *layer != Layer::Emission) {
        assert!(value.max() > 0.0, "{} never occurs", layer.name());
    }
}

/// A wall in vacuum, lit by the lamp and by its image in the floor: irradiance pi L (a/d)^2 cos, exactly, for a sphere
/// in full view. Seen straight, the layers are those of the light; seen in the mirror, the same, times the mirror.
#[test]
fn direct_and_caustic_light_of_a_wall_in_closed_form() {
    let fog_free = {
        let scene = room();
        let objects = scene.objects().iter().map(|o| (o.shape.clone(), o.surface.clone())).collect();
        // Large, so that paths by way of the mirror find it often.
        bounded(Vec::new(), objects, vec![emitting_sphere(LIGHT, 0.4)])
    };
    let place = DVec3::new(0.0, 0.7, 0.9);
    let reflected = |from: DVec3| {
        let towards = from - place;
        let cosine = towards.x / towards.length();
        // Radiance 1/(4 pi^2 a^2), so that the power is 1.
        0.6 / PI * cosine / (FOUR_PI * towards.length_squared())
    };
    let straight = DVec3::new(1.2, 0.4, 1.6);
    let in_mirror = DVec3::new(1.0, 1.8, 0.8);
    let below = DVec3::new(place.x, place.y, -place.z);
    for (eye, target, mirror) in [(straight, place, 1.0), (in_mirror, below, MIRROR)] {
        let ray = Ray::new(eye, (target - eye).normalize());
        for (layer, from, by) in [(Layer::Direct, LIGHT, 1.0), (Layer::Caustic, IMAGE, MIRROR)] {
            let expected = mirror * by * reflected(from);
            let got = class_of_order(&fog_free, ray, layer, 1, 1 << 17, 6);
            let what = format!("{} of the wall, mirror {mirror}", layer.name());
            verdict::agrees(&what, &got, (expected, 1e-12), 0.2 * expected, 6);
            let wrong = if layer == Layer::Direct { IMAGE } else { LIGHT };
            verdict::rejects(&format!("{what}, classes exchanged"), &got, mirror * reflected(wrong), 6);
        }
    }
}

/// A line of sight through the fog and out of it, past the lamp, which hides no part of its image from there: light
/// scattered once, straight from the lamp and by way of the mirror.
#[test]
fn light_scattered_once_by_way_of_the_lamp_and_of_its_image() {
    const RADIUS: f64 = 0.3;
    let scene = room_with(RADIUS);
    let (eye, target) = (DVec3::new(0.9, 0.05, 0.3), DVec3::new(0.3, 2.0, 0.3));
    let ray = Ray::new(eye, (target - eye).normalize());
    let along = |source: DVec3| {
        integrate(0.0, eye.distance(target), 4, |t| {
            0.8 * exp(-t) * fluence_of(RADIUS, ray.at(t).distance(source)) / FOUR_PI
        })
    };
    for (layer, source, by) in [(Layer::Single, LIGHT, 1.0), (Layer::Multiple, IMAGE, MIRROR)] {
        let expected = by * along(source);
        let got = class_of_order(&scene, ray, layer, 1, 1 << 17, 7);
        verdict::agrees(&format!("{} of order 1", layer.name()), &got, (expected, 1e-9), 0.2 * expected, 7);
    }
}
