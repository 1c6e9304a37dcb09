//! Planes: sums by hand, and light of a laser that is scattered twice.

use super::beams::{beam, by_maps};
use crate::support::quadrature::integrate;
use crate::support::run::sensor;
use crate::support::scenes::{bounded, cuboid, homogeneous, point_light, region};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel, PlaneEstimator};
use turbid::geometry::{Rectangle, Shape};
use turbid::light::{Beam, Light, Section};
use turbid::math::{FOUR_PI, Interval, Ray, cos, exp, sin};
use turbid::photons::beams::BeamKind;
use turbid::photons::planes::{Plane, PlaneMap};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::stats::Moments;
use turbid::surface::{Black, Surface};

/// A plane of power 1 in the first medium.
pub fn plane((length, kind): (f64, BeamKind), dir: DVec3, (depth, reach): (f64, f64)) -> Plane {
    Plane { leg: beam(DVec3::ZERO, DVec3::Z, length, kind), dir, depth, reach }
}

/// The map of one plane, moved.
pub fn map(plane: Plane, by: DVec3) -> PlaneMap {
    let mut plane = plane;
    plane.leg.start += by;
    PlaneMap::new(vec![vec![plane]], 1, None).unwrap()
}

/// Extinction 1, albedo 0.5, of this asymmetry, as far as 10 in all directions from a place.
fn medium(g: f64, by: DVec3) -> Region {
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), g);
    Region { shape: cuboid(by - 10.0, by + 10.0), medium }
}

fn scene(at: DVec3, regions: Vec<Region>, walls: Vec<Rectangle>) -> Scene {
    let walls = walls.into_iter().map(|wall| (Shape::Rectangle(wall), Surface::Black(Black)));
    let light = point_light(at, Spectrum::ONE);
    bounded(regions, walls.collect(), vec![light])
}

/// What planes across a ray bring to its near end as far as this, in one medium of extinction 1.
pub fn read(scene: &Scene, map: &PlaneMap, ray: &Ray, end: f64) -> f64 {
    let span = Interval { start: 0.0, end };
    PlaneEstimator.radiance(map, (ray, span), (scene, 0), &|t| Spectrum::grey(exp(-t))).value[0]
}

/// One plane and one ray through it, near and far from the origin: a product of eight factors, by hand. What is beyond a leg or the
/// stretch does not count, nor what a wall hides or another medium stops.
pub fn one_plane_by_hand() {
    let dir = DVec3::new(0.6, 0.8, 0.0);
    let way = DVec3::new(2.0, -1.0, -2.0) / 3.0;
    let origin = DVec3::new(-0.5, 0.8, 1.2);
    // Published with what passes along both legs: a drawn length has that in itself.
    let long = 0.001_531_374_1;
    let (first, second) = (exp(0.4), exp(0.5));
    let (sampled, expected) = (BeamKind::Sampled, BeamKind::Expected);
    for (what, leg, depth, end, value) in [
        ("drawn", (4.0, sampled), (1.0, 1.0), 4.0, long * first * second),
        ("to the end", (4.0, expected), (1.0, 1.0), 4.0, long * second),
        ("short first leg", (0.399, sampled), (1.0, 1.0), 4.0, 0.0),
        ("short second leg", (4.0, sampled), (0.499, 0.499), 4.0, 0.0),
        ("short stretch", (4.0, sampled), (1.0, 1.0), 1.199, 0.0),
    ] {
        for (by, error) in [(DVec3::ZERO, 3e-8), (DVec3::new(1e6, -3e6, 2e6), 1e-7)] {
            let scene = scene(by, vec![medium(0.5, by)], vec![]);
            let found = read(&scene, &map(plane(leg, dir, depth), by), &Ray::new(origin + by, way), end);
            assert!((found - value).abs() <= error * value, "{what}, {by}: {found} for {value}");
        }
    }
    let whole = plane((4.0, sampled), dir, (1.0, 1.0));
    let value = long * first * second;
    let ray = Ray::new(origin, way);
    let start = DVec3::new(0.0, 0.0, 0.4);
    // Across the second leg before the ray, behind it, and beside it.
    let across = DVec3::new(-0.8, 0.6, 0.0);
    for (at, beside, expected) in [(0.25, 0.0, 0.0), (0.75, 0.0, value), (0.25, 0.2, value)] {
        let corner = start + dir * at + across * (beside - 0.1) - DVec3::Z * 0.1;
        let wall = Rectangle::new(corner, across * 0.2, DVec3::Z * 0.2).unwrap();
        let scene = scene(start, vec![medium(0.5, DVec3::ZERO)], vec![wall]);
        let found = read(&scene, &map(whole, DVec3::ZERO), &ray, 4.0);
        assert!((found - expected).abs() <= 3e-8 * value, "wall at {at}, {beside}: {found}");
    }
    // A dense core on the way: 0.5 deep without it, more with it.
    let core = DVec3::new(0.15, 0.2, 0.4);
    let core = region(cuboid(core - 0.05, core + 0.05), 10.0, 0.5, 0.0);
    let both = scene(start, vec![medium(0.5, DVec3::ZERO), core], vec![]);
    for (depth, expected) in [(0.6, 0.0), (5.0, value)] {
        let found = read(&both, &map(Plane { depth, ..whole }, DVec3::ZERO), &ray, 4.0);
        assert!((found - expected).abs() <= 3e-8 * value, "depth {depth}: {found}");
    }
}

/// A ray that meets a plane ever more end-on: all of 1/|det| counts; a ray in the plane meets nothing.
pub fn a_plane_end_on_counts_in_full() {
    let scene = scene(DVec3::ZERO, vec![medium(0.0, DVec3::ZERO)], vec![]);
    let laser = map(plane((4.0, BeamKind::Sampled), DVec3::X, (1.0, 1.0)), DVec3::ZERO);
    let at = DVec3::new(0.5, 0.0, 0.4);
    for angle in [1.0, 0.1, 1e-3, 1e-6, 1e-9] {
        let way = DVec3::new(0.6 * cos(angle), sin(angle), 0.8 * cos(angle));
        let found = read(&scene, &laser, &Ray::new(at - way * 1.2, way), 4.0);
        let expected = 0.25 * exp(-1.2) / FOUR_PI / sin(angle);
        assert!((found / expected - 1.0).abs() < 1e-15 / angle + 1e-12, "{angle}: {found} for {expected}");
    }
    for way in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, 0.0, 0.8)] {
        assert_eq!(read(&scene, &laser, &Ray::new(at - way * 1.2, way), 4.0), 0.0);
    }
}

/// An estimator of planes alone.
pub fn in_planes() -> Estimator {
    Estimator::new(Kernel::Uniform, Gather::radius(1e-30).unwrap()).in_planes()
}

/// A laser of power 1 along z through a block, which a ray crosses at a distance.
pub struct Laser {
    /// The length that all others are in \[L\].
    pub unit: f64,
    /// Extinction \[1/L\]; the albedo is 0.5.
    pub sigma_t: f64,
    /// Where the block begins and ends along z, the laser starting at 0 or before it, and half its width along y.
    pub block: [f64; 3],
}

impl Laser {
    /// The scene, with one sensor: light that is scattered twice.
    pub fn scene(&self, g: f64) -> Scene {
        let Laser { unit, sigma_t, block: [low, high, half] } = *self;
        let shape = cuboid(DVec3::new(-2.0, -half, low) * unit, DVec3::new(2.0, half, high) * unit);
        let radius = 1e-9 * unit;
        let center = DVec3::Z * (if low < 0.0 { 0.0 } else { -0.5 } * unit);
        let section = Section::Disc { center, radius };
        let irradiance = Spectrum::grey(1.0 / (PI * radius * radius));
        let ray = Ray::new(DVec3::new(-3.0, 0.5, 0.7) * unit, DVec3::X);
        Scene::new(SceneParts {
            regions: vec![region(shape, sigma_t, 0.5, g)],
            lights: vec![Light::Beam(Beam::new(DVec3::Z, irradiance, section).unwrap())],
            sensors: vec![sensor(Quantity::Radiance(ray), Orders::only(2))],
            ..SceneParts::default()
        })
        .unwrap()
    }

    /// The exact radiance, by quadrature along ray and laser: with r the way between them, of isotropic scattering,
    /// L = sigma_s^2/(4 pi)^2 int int e^(-sigma_t (s + t + r))/r^2 dt ds.
    pub fn exact(&self) -> f64 {
        let tau = self.sigma_t * self.unit;
        let [low, high, _] = self.block;
        let (low, high) = (low.max(0.0), high.min(30.0));
        let along = |x: f64| {
            integrate(low, high, 60, |z| {
                let squared = x * x + 0.25 + (0.7 - z) * (0.7 - z);
                exp(-tau * (x + 2.0 + z - low + squared.sqrt())) / squared
            })
        };
        let factor = 0.5 * self.sigma_t / FOUR_PI;
        factor * factor * integrate(-2.0, 2.0, 30, along)
    }

    /// Readings of so many photons a map and maps.
    pub fn read(&self, g: f64, counts: (u64, u64), seed: u64) -> Moments {
        by_maps(&self.scene(g), counts, seed, &[in_planes()])[0][0][0]
    }
}

/// A laser through a block of one mean free path: most of its flights leave without a collision, and count. A ray at a distance from a
/// laser meets its planes with a variance that is finite.
pub fn a_laser_scattered_twice() {
    let block = Laser { unit: 1.0, sigma_t: 1.0, block: [0.0, 1.0, 2.0] };
    let expected = block.exact();
    verdict::agrees(
        "block",
        &block.read(0.0, (4000, 100), 1),
        (expected, 1e-9 * expected),
        0.2 * expected,
        1,
    );
}
