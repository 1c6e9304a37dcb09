//! Index-matched boundaries: no events. An interior of index 1 that a medium fills is a region, by every method.

use crate::checks::ledger::{Room, layers_of_the_scene_are_those_of_paths, settings};
use crate::support::run::{histories, pass, paths};
use crate::support::scenes::{
    dielectric, emitting_sphere, filled, homogeneous, lambertian, outflow, point_light, rectangle, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::{Layer, path};
use turbid::light::Light;
use turbid::math::Ray;
use turbid::medium::Medium;
use turbid::photons::Emitter;
use turbid::photons::maps::Indirect;
use turbid::scene::{Camera, Filter, Interior, Object, Orders, Quantity, Region, Scene, SceneParts, View};
use turbid::sensor::{Film, Streams, by_light};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

const N: u64 = 1 << 14;

/// A ball of coloured fog, and a smaller one of another in it.
fn balls() -> [(Shape, Medium); 2] {
    let outer = homogeneous(Spectrum::rgb(1.0, 2.0, 0.5), Spectrum::grey(0.8), 0.5);
    let inner = homogeneous(Spectrum::rgb(3.0, 0.5, 1.0), Spectrum::rgb(0.9, 0.6, 0.7), 0.0);
    [(sphere(DVec3::ZERO, 1.0), outer), (sphere(DVec3::new(0.2, 0.1, 0.3), 0.4), inner)]
}

fn floor() -> Object {
    let floor = rectangle(DVec3::new(-3.0, -3.0, -1.2), DVec3::X * 6.0, DVec3::Y * 6.0);
    Object { shape: Shape::Rectangle(floor), surface: lambertian(Spectrum::rgb(0.7, 0.5, 0.3)) }
}

/// The same fog as regions, and as nested interiors of one index.
fn both(lights: Vec<Light>) -> [Scene; 2] {
    let regions = balls().map(|(shape, medium)| Region { shape, medium }).to_vec();
    let objects = vec![floor()];
    let as_regions =
        SceneParts { regions, objects: objects.clone(), lights: lights.clone(), ..SceneParts::default() };
    let [(outer, fog), (inner, core)] = balls();
    let walls = [(outer, dielectric(1, 0)), (inner, dielectric(2, 1))];
    let walls = walls.map(|(shape, surface)| Object { shape, surface });
    let as_interiors = SceneParts {
        interiors: vec![Interior::surroundings(), filled("fog", 1.0, fog), filled("core", 1.0, core)],
        objects: objects.into_iter().chain(walls).collect(),
        lights,
        ..SceneParts::default()
    };
    [as_regions, as_interiors].map(|parts| Scene::new(parts).unwrap())
}

/// A lamp outside, one in the inner ball, and a point light in the outer one.
fn lamps() -> Vec<Vec<Light>> {
    let point = || point_light(DVec3::new(-0.5, 0.2, -0.1), Spectrum::rgb(1.0, 0.5, 2.0));
    vec![
        vec![emitting_sphere(DVec3::new(0.5, 0.3, 2.0), 0.3)],
        vec![emitting_sphere(DVec3::new(0.3, 0.1, 0.25), 0.1), point()],
    ]
}

/// Nothing of it is specular: photons, maps and the plan know no glass.
#[test]
fn nothing_is_specular() {
    for lights in lamps() {
        let [regions, interiors] = both(lights);
        let plan = interiors.plan();
        assert!(
            plan.has_matched && plan.has_dielectrics && !plan.has_specular && plan.unreachable.is_empty()
        );
        assert!(!regions.plan().has_matched && Emitter::towards_specular(&interiors).is_none());
        let photons = pass(&interiors, &[], N, 1, |_| true).photons().collect::<Vec<_>>();
        assert!(photons.iter().any(|p| p.flags.is_direct()));
        assert!(!photons.iter().any(|p| p.flags.has(turbid::photons::Flags::SPECULAR)));
    }
    // Glass about them is, and its own boundary to what it holds is not.
    let [(outer, _), (inner, core)] = balls();
    let glass = Interior { name: "glass".into(), index: 1.5, medium: None };
    let objects = [(outer, dielectric(1, 0)), (inner, dielectric(2, 1))];
    let scene = Scene::new(SceneParts {
        interiors: vec![Interior::surroundings(), glass, filled("tea", 1.5, core)],
        objects: objects.map(|(shape, surface)| Object { shape, surface }).to_vec(),
        lights: vec![emitting_sphere(DVec3::new(0.5, 0.3, 2.0), 0.3)],
        ..SceneParts::default()
    })
    .unwrap();
    assert!(scene.plan().has_specular && scene.plan().has_matched);
    let is_specular = |i: usize| scene.objects()[i].surface.is_specular();
    assert!(is_specular(0) && !is_specular(1));
}

/// Fluence outside and in both balls, and the radiance of each class: with the noise of regions, not with that of light found
/// by chance. Fluence and multiple scattering beside a point light have a heavy tail whatever bounds the fog: single
/// scattering stands for them.
#[test]
fn paths_are_those_of_regions() {
    let compare = |what: String, [a, b]: [&Moments; 2]| {
        verdict::agree(&what, a, b, 0.5 * a.mean(), 2);
        assert!(b.variance() < 2.0 * a.variance(), "{what}: {} {}", a.variance(), b.variance());
    };
    for (set, lights) in lamps().into_iter().enumerate() {
        let scenes = both(lights);
        let places = [[-1.5, 0.3, -0.4], [-0.3, 0.5, 0.4], [0.1, 0.2, 0.05]];
        for place in places.iter().filter(|_| set == 0) {
            let [a, b] = [0, 1].map(|i| {
                paths(&scenes[i], Quantity::Fluence((*place).into()), Orders::ALL, N / 2, 2 + i as u64)
            });
            for c in 0..3 {
                compare(format!("fluence at {place:?}, channel {c}"), [&a[c], &b[c]]);
            }
        }
        // From outside through both balls to the floor, and from within.
        for origin in [DVec3::new(1.5, 0.5, 2.0), DVec3::new(0.15, 0.0, 0.4)] {
            let ray = Ray::new(origin, (DVec3::new(0.0, 0.1, -1.2) - origin).normalize());
            let classes = [Layer::Direct, Layer::Single, Layer::Multiple];
            let [a, b] = [0, 1].map(|i| {
                let (scene, seed) = (&scenes[i], 4 + i as u64);
                let within = scene.interior_at(origin);
                histories(2 * N, seed, |stream| {
                    let layers = path::layers(scene, ray, None, within, stream).0;
                    let [direct, single, multiple] = classes.map(|class| layers[class][1]);
                    Spectrum::rgb(direct, single, multiple)
                })
            });
            let counted = if set == 0 { 3 } else { 2 };
            for (class, layer) in classes.iter().enumerate().take(counted) {
                compare(format!("lamps {set}, {} from {origin}", layer.name()), [&a[class], &b[class]]);
            }
        }
    }
}

/// What photons leave in each medium, and what escapes, order by order.
#[test]
fn photons_are_those_of_regions() {
    let quantities = [Quantity::Absorbed(0), Quantity::Absorbed(1), outflow(sphere(DVec3::ZERO, 9.0))];
    let ranges = [Orders::ALL, Orders::only(0), Orders::only(1)];
    let asked: Vec<(Quantity, Orders)> =
        quantities.iter().flat_map(|quantity| ranges.map(|orders| (quantity.clone(), orders))).collect();
    for (set, lights) in lamps().into_iter().enumerate() {
        let scenes = both(lights);
        let [regions, interiors] = [0, 1].map(|i| pass(&scenes[i], &asked, 1 << 17, 6 + i as u64, |_| false));
        for (i, (quantity, orders)) in asked.iter().enumerate() {
            for c in 0..3 {
                let what = format!("lamps {set}, {quantity:?}, {orders:?}, channel {c}");
                verdict::agree(&what, &regions.tallies[i][c], &interiors.tallies[i][c], 0.05, 6);
            }
        }
    }
}

/// Light tracing sees through the boundaries too.
#[test]
fn light_tracing_is_that_of_regions() {
    let position = DVec3::new(2.5, 0.5, 1.5);
    let view = View {
        position,
        look_at: DVec3::new(0.0, 0.0, -0.3),
        up: DVec3::Z,
        fov: 50.0,
        width: 4,
        height: 4,
        filter: Filter::Box,
    };
    let camera = Camera::new(view).unwrap();
    let scenes = both(lamps().remove(0));
    let films = |i: usize| -> Vec<Film> {
        let streams = |replicate| Streams { seed: 8 + i as u64, replicate };
        (0..64).map(|r| by_light(&scenes[i], &camera, 4000, 1, streams(r), &NoProgress).unwrap()).collect()
    };
    let (a, b) = (films(0), films(1));
    for layer in [Layer::Direct, Layer::Indirect, Layer::Single, Layer::Multiple] {
        let mean = |films: &[Film]| -> Moments {
            let sum =
                |film: &Film| -> f64 { (0..16).map(|i| film.pixel(i % 4, i / 4).layers()[layer][0]).sum() };
            films.iter().map(sum).collect()
        };
        let promise = if layer == Layer::Indirect { 1.0 } else { 0.5 };
        verdict::agree(layer.name(), &mean(&a), &mean(&b), promise * mean(&a).mean(), 8);
    }
}

/// The photon mapper, class by class: a ball of denser fog hangs in the room, bounded by an interior of the same index.
#[test]
fn the_photon_mapper_is_the_path_tracer() {
    let room = Room {
        floor: lambertian(Spectrum::grey(0.6)),
        sigma_t: Spectrum::grey(0.3),
        albedo: Spectrum::grey(0.8),
        g: 0.0,
        is_colored: false,
        has_glass: true,
        has_water: false,
    };
    let mut parts = room.parts();
    let dense = homogeneous(Spectrum::grey(2.0), Spectrum::grey(0.7), 0.3);
    parts.interiors[1] = filled("dense", 1.0, dense);
    let scene = Scene::new(parts).unwrap();
    assert!(scene.plan().has_matched && !scene.plan().has_specular);
    layers_of_the_scene_are_those_of_paths(&scene, Indirect::Gathered, &settings(2), 2000, 12);
}
