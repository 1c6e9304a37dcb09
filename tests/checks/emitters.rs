//! Light that fills volumes: what paths find of it by directions towards it and by chance, together.

use crate::support::run::paths;
use crate::support::scenes::{cuboid, dielectric, filled, homogeneous, isotropic, sphere};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::light::{Faces, Light, VolumeSource};
use turbid::math::{Asymmetry, FOUR_PI};
use turbid::medium::{Cloud, CloudShape, Density, Heterogeneous, Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::scene::{Interior, Object, Orders, Quantity, Region, Scene, SceneParts};

/// A medium whose emission over absorption is `source`, whatever its albedo.
fn in_balance(sigma_t: f64, albedo: f64, g: f64, source: f64) -> Homogeneous {
    let phase = Phase::with_asymmetry(Asymmetry::try_from(g).unwrap());
    let medium = Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::grey(albedo), phase).unwrap();
    medium.with_emission(Spectrum::grey(sigma_t * (1.0 - albedo) * source)).unwrap()
}

/// Where every medium emits what it absorbs of radiance 1/pi, and the same comes in from outside, radiance is 1/pi everywhere, n^2
/// times that behind refracting boundaries, and the fluence is 4: in even media and clouds, media in media, behind
/// boundaries that are matched or not, and where a volume source stands for a medium's own emission.
fn furnace() -> Scene {
    let b = 1.0 / PI;
    let region = |shape, medium: Medium| Region { shape, medium };
    let cloud = Cloud::new(CloudShape::plain(DVec3::new(0.0, 1.1, 0.0), DVec3::splat(0.4))).unwrap();
    let puffs = Heterogeneous::new(
        Homogeneous::new(
            Spectrum::grey(6.0),
            Spectrum::grey(0.5),
            Phase::with_asymmetry(Asymmetry::try_from(0.5).unwrap()),
        )
        .unwrap(),
        Density::Cloud(cloud.into()),
    );
    let puffs = puffs.with_emission_by_density(Spectrum::grey(3.0 * b)).unwrap();
    let block = cuboid(DVec3::new(-1.3, -0.4, -0.4), DVec3::new(-0.7, 0.4, 0.4));
    // Power by volume: 4 pi times what the block absorbs of radiance b.
    let source = VolumeSource::new(block.clone(), Spectrum::grey(FOUR_PI * 2.0 * 0.8 * b)).unwrap();
    let (glass, drop) = (sphere(DVec3::new(0.0, -1.0, 0.5), 0.4), sphere(DVec3::new(0.0, -0.3, -1.2), 0.3));
    Scene::new(SceneParts {
        regions: vec![
            region(sphere(DVec3::ZERO, 2.0), in_balance(0.3, 0.9, 0.3, b).into()),
            region(sphere(DVec3::new(1.0, 0.0, 0.0), 0.4), in_balance(3.0, 0.4, -0.3, b).into()),
            region(cuboid(DVec3::new(-0.5, 0.6, -0.5), DVec3::new(0.5, 1.6, 0.5)), puffs.into()),
            region(block, homogeneous(Spectrum::grey(2.0), Spectrum::grey(0.2), 0.0)),
        ],
        interiors: vec![
            Interior::surroundings(),
            filled("glass", 1.5, in_balance(2.0, 0.5, 0.0, 2.25 * b).into()),
            filled("drop", 1.0, in_balance(4.0, 0.3, 0.0, b).into()),
        ],
        objects: vec![
            Object { shape: glass, surface: dielectric(1, 0) },
            Object { shape: drop, surface: dielectric(2, 0) },
        ],
        lights: vec![isotropic(sphere(DVec3::ZERO, 2.0), Faces::Both), Light::VolumeSource(source)],
        ..SceneParts::default()
    })
    .unwrap()
}

/// The fluence of the furnace beside, before and in what emits, and the radiance along rays.
pub fn a_furnace_is_as_bright_everywhere() {
    let scene = furnace();
    let places = [[0.1, 0.0, 0.0], [-0.6, 0.1, 0.2], [1.0, 0.1, 0.1], [0.0, -0.3, -1.3], [1.7, 0.3, -0.4]];
    for (i, place) in places.into_iter().enumerate() {
        let seed = 1 + i as u64;
        let fluence = paths(&scene, Quantity::Fluence(place.into()), Orders::ALL, 1 << 14, seed);
        verdict::agrees(&format!("fluence at {place:?}"), &fluence[0], (4.0, 1e-12), 0.15, seed);
    }
}
