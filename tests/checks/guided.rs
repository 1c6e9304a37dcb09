//! Paths that are led to where photons came from.

use super::slab::{exact, referee};
use crate::support::run::numbers;
use crate::support::scenes::{Incidence, at_depth, cuboid, dielectric, lambertian, rectangle, region, slab};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::Guides;
use turbid::light::{Light, Sun};
use turbid::math::Ray;
use turbid::photons::{Guide, GuideSettings};
use turbid::scene::{Interior, Object, Orders, Quantity, Scene, SceneParts};
use turbid::sensor::sample_guided;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Fog over a table in a sun of this radius \[degrees\], below a thick pane of glass, through which no connection finds the sun.
pub fn below_a_pane(g: f64, radius: f64) -> Scene {
    let table = rectangle(DVec3::new(-1.0, -1.0, 1.0), DVec3::X * 2.0, DVec3::NEG_Z * 2.0);
    let (low, high) = (DVec3::new(-1.5, -0.1, -1.5), DVec3::new(1.5, 0.1, 1.5));
    let pane = Object { shape: cuboid(low, high), surface: dielectric(1, 0) };
    let table = Object { shape: Shape::Rectangle(table), surface: lambertian(Spectrum::rgb(0.7, 0.5, 0.3)) };
    let sun = Sun::new(DVec3::new(0.2, -1.0, 0.3), Spectrum::rgb(3.0, 2.0, 1.0), radius).unwrap();
    Scene::new(SceneParts {
        regions: vec![region(cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.3, 0.9, g)],
        interiors: vec![
            Interior::surroundings(),
            Interior { name: "glass".into(), index: 1.5, medium: None },
        ],
        objects: vec![pane, table],
        lights: vec![Light::Sun(sun)],
        ..SceneParts::default()
    })
    .unwrap()
}

/// Radiance from a place of the table.
pub fn of_the_table(scene: &Scene, guides: Guides<'_>, n: u64, seed: u64) -> Moments {
    let (eye, at) = (DVec3::new(0.6, -0.5, 0.5), DVec3::new(0.02, -1.0, 0.03));
    let radiance = Quantity::Radiance(Ray::new(eye, (at - eye).normalize()));
    numbers(n, seed, |stream| sample_guided(scene, &radiance, Orders::ALL, guides, stream).0[0])
}

/// What the photons of so many histories say.
pub fn learned(scene: &Scene, histories: u64, share: Option<f64>) -> Guide {
    let settings = GuideSettings { histories, seed: 5, replicate: 0, share };
    Guide::learn(scene, &settings, &NoProgress).unwrap()
}

/// As much as paths that nothing leads find, in isotropic fog and in one that scatters forwards.
pub fn guided_paths_find_as_much() {
    for (g, seed) in [(0.0, 1), (0.7, 3)] {
        let scene = below_a_pane(g, 4.0);
        let guide = learned(&scene, 100_000, None);
        let guides = Guides { windows: None, learned: Some(&guide) };
        let guided = of_the_table(&scene, guides, 1 << 15, seed);
        let paths = of_the_table(&scene, Guides::default(), 1 << 20, seed + 1);
        verdict::agree(&format!("g {g}"), &guided, &paths, 0.2 * paths.mean(), seed);
    }
}

/// Where light scatters dozens of times without loss, and half of all directions are learned though nothing is to be gained: without a bound
/// on weights the error is two and a half times as large, too large for the promise of a tenth.
pub fn guided_paths_stay_light() {
    let (tau, how) = (12.0, Incidence::Beam(1.0));
    let scene = slab(tau, 1.0, 0.0, how);
    let guide = learned(&scene, 10_000, Some(0.5));
    let guides = Guides { windows: None, learned: Some(&guide) };
    let moments =
        numbers(1 << 15, 1, |stream| sample_guided(&scene, &at_depth(6.0), Orders::ALL, guides, stream).0[0]);
    let value = exact(referee(tau, 1.0, how).fluence(6.0).unwrap());
    verdict::agrees("in the middle", &moments, value, 0.1 * value.0, 1);
}
