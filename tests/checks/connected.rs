//! Paths whose scatterings are connected to those of photons.

use crate::support::run::numbers;
use crate::support::scenes::{
    area_light, bounded, cuboid, dielectric, filled, homogeneous, lambertian, rectangle, region, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::{Guides, bidirectional, radiance};
use turbid::math::Ray;
use turbid::scene::{Interior, Object, Orders, Scene, SceneParts};

/// A box whose six walls are lamps of radiance 1, fog that absorbs nothing, a white ball, and a ball of glass with such fog: as bright
/// everywhere, and n^2 times that in the glass.
fn furnace() -> Scene {
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let [x, y, z] = DVec3::AXES.map(|axis| axis * 2.0);
    let walls = [(low, z, x), (high, -x, -z), (low, x, y), (high, -y, -x), (low, y, z), (high, -z, -y)];
    let white = |g| homogeneous(Spectrum::grey(1.5), Spectrum::ONE, g);
    Scene::new(SceneParts {
        regions: vec![region(cuboid(low, high), 0.8, 1.0, 0.3)],
        interiors: vec![Interior::surroundings(), filled("glass", 1.5, white(-0.2))],
        objects: vec![
            Object { shape: sphere(DVec3::new(-0.4, 0.3, -0.2), 0.4), surface: lambertian(Spectrum::ONE) },
            Object { shape: sphere(DVec3::new(0.45, -0.3, 0.1), 0.4), surface: dielectric(1, 0) },
        ],
        lights: walls.map(|(corner, u, v)| area_light(rectangle(corner, u, v), Spectrum::ONE)).to_vec(),
        ..SceneParts::default()
    })
    .unwrap()
}

/// Radiance along rays that start in the fog and in the glass.
pub fn a_furnace_of_lamps_is_as_bright_everywhere() {
    let scene = furnace();
    let rays = [
        ([0.3, 0.6, 0.8], [-0.4, 0.3, -0.2], 1.0, 1 << 15),
        ([0.3, 0.6, 0.8], [0.45, -0.3, 0.1], 1.0, 1 << 15),
        ([-0.8, -0.7, 0.5], [0.1, 1.0, 0.2], 1.0, 1 << 15),
        ([0.5, -0.2, 0.2], [0.0, -0.5, -0.3], 2.25, 1 << 17),
    ];
    for (i, (from, to, radiance, n)) in rays.into_iter().enumerate() {
        let (from, to, seed) = (DVec3::from(from), DVec3::from(to), 1 + i as u64);
        let (ray, interior) = (Ray::new(from, (to - from).normalize()), scene.interior_at(from));
        let moments = numbers(n, seed, |stream| {
            let mut sum = 0.0;
            bidirectional::classes(&scene, ray, None, interior, Orders::ALL, stream, |_, _, value| {
                sum += value[0]
            });
            sum
        });
        verdict::agrees(&format!("radiance from {from}"), &moments, (radiance, 1e-12), 0.08 * radiance, seed);
    }
}
/// A clear box with diffuse walls and a lamp: light that was reflected twice, by connections for the most part, is that of paths.
pub fn two_reflections_are_those_of_paths() {
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let [x, y, z] = DVec3::AXES.map(|axis| axis * 2.0);
    let walls = [(low, z, x), (low, x, y), (low, y, z), (high, -z, -y)];
    let walls = walls
        .map(|(corner, u, v)| (Shape::Rectangle(rectangle(corner, u, v)), lambertian(Spectrum::grey(0.6))));
    let lamp = rectangle(DVec3::new(-0.1, 0.9, -0.1), DVec3::X * 0.2, DVec3::Z * 0.2);
    let scene = bounded(Vec::new(), walls.to_vec(), vec![area_light(lamp, Spectrum::ONE)]);
    let ray = Ray::new(DVec3::new(0.2, 0.1, 0.9), DVec3::new(-0.3, -0.6, -1.0).normalize());
    let connected = numbers(1 << 15, 1, |stream| {
        let mut sum = 0.0;
        let add = |_, _, value: Spectrum| sum += value[0];
        bidirectional::classes(&scene, ray, None, 0, Orders::only(2), stream, add);
        sum
    });
    let paths = numbers(1 << 16, 2, |stream| {
        let mut sum = 0.0;
        radiance(&scene, (ray, 0), Orders::only(2), Guides::default(), stream, |_, value| sum += value[0]);
        sum
    });
    verdict::agree("two reflections", &connected, &paths, 0.1 * paths.mean(), 1);
}
