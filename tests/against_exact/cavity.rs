//! The Lambertian cavity, empty and filled: its wall reflects a part rho, and by symmetry the irradiance E on it (before
//! reflection) is the same everywhere.
//!
//! The wall of radius 1 + 2^-20 encloses a ball of radius 1, with or without medium; through the ball's surface goes out
//! what falls on the wall. Light that the wall sends into the gap, past the ball, is 2e-6 of what it reflects: every
//! reference has an error of 1e-5 of itself for that. A wall that emits is isotropic incidence on the ball.

use crate::support::run::{paths, tallies};
use crate::support::scenes::{
    bounded, isotropic, lambertian, outflow, point_light, region, sphere, volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::light::{Faces, Light};
use turbid::math::FOUR_PI;
use turbid::scene::{Orders, Quantity, Scene};
use turbid_analytic::{Cavity, Sphere, SphereSource};

const PHOTONS: u64 = 1 << 15;
const PATHS: u64 = 1 << 14;
/// Albedos of the wall.
const WALLS: [f64; 2] = [0.5, 0.9];
/// Albedo and mean cosine of what fills it; none is empty.
const FILLINGS: [Option<(f64, f64)>; 4] = [None, Some((0.9, 0.0)), Some((1.0, 0.0)), Some((1.0, 0.75))];

fn ball() -> Shape {
    sphere(DVec3::ZERO, 1.0)
}

fn closed(rho: f64, filling: Option<(f64, f64)>, light: Light) -> Scene {
    let wall = sphere(DVec3::ZERO, 1.0 + 1.0 / f64::from(1u32 << 20));
    let regions = filling.map(|(albedo, g)| region(ball(), 1.0, albedo, g)).into_iter().collect();
    bounded(regions, vec![(wall, lambertian(Spectrum::grey(rho)))], vec![light])
}

/// Where the light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Wall,
    Centre,
    Volume,
}

impl Source {
    fn light(self) -> Light {
        match self {
            Source::Wall => isotropic(ball(), Faces::Both),
            Source::Centre => point_light(DVec3::ZERO, Spectrum::ONE),
            Source::Volume => volume_source(ball()),
        }
    }
}

/// The exact cavity. Without absorption the phase function of what fills it does not matter.
fn referee(rho: f64, filling: Option<(f64, f64)>) -> Cavity {
    match filling {
        Some((albedo, _)) => Cavity::filled(1.0, rho, albedo).unwrap(),
        None => Cavity::empty(1.0, rho).unwrap(),
    }
}

/// Power that falls on the wall over the power emitted.
fn on_the_wall(rho: f64, filling: Option<(f64, f64)>, source: Source) -> f64 {
    let cavity = referee(rho, filling);
    match source {
        Source::Wall => cavity.irradiance_wall().value,
        Source::Centre => cavity.irradiance_centre().value * FOUR_PI,
        Source::Volume => {
            let albedo = filling.map(|(albedo, _)| albedo);
            let first =
                albedo.map_or(1.0, |w| Sphere::new(1.0, w, SphereSource::Uniform).unwrap().escape().value);
            cavity.irradiance_mean(first / FOUR_PI).unwrap().value * FOUR_PI
        }
    }
}

#[test]
fn irradiance_on_the_wall() {
    for rho in WALLS {
        for filling in FILLINGS {
            for source in [Source::Wall, Source::Centre, Source::Volume] {
                let what = format!("{source:?}, wall {rho}, filling {filling:?}");
                let expected = on_the_wall(rho, filling, source);
                let scene = closed(rho, filling, source.light());
                let mut sensors = vec![(outflow(ball()), Orders::ALL)];
                if matches!(filling, Some((albedo, _)) if albedo < 1.0) {
                    sensors.push((Quantity::Absorbed(0), Orders::ALL));
                }
                let photons = tallies(&scene, &sensors, PHOTONS, 1);
                let reference = (expected, 1e-5 * expected);
                verdict::agrees(&format!("photons: {what}"), &photons[0][0], reference, 0.05 * expected, 1);
                if let Some(absorbed) = photons.get(1) {
                    let reference = (1.0 - (1.0 - rho) * expected, 1e-5);
                    verdict::agrees(&format!("photons: absorbed, {what}"), &absorbed[0], reference, 0.02, 1);
                }
                // Rays past a point light in a medium have a variance that diverges, if only as a logarithm.
                if source != Source::Centre || filling.is_none() {
                    let by_paths = paths(&scene, outflow(ball()), Orders::ALL, PATHS, 2)[0];
                    verdict::agrees(&format!("paths: {what}"), &by_paths, reference, 0.03 * expected, 2);
                }
            }
        }
    }
}

#[test]
fn fluence_at_the_centre() {
    for rho in WALLS {
        for filling in FILLINGS {
            let expected = referee(rho, filling).fluence_wall(0.0).unwrap().value;
            let scene = closed(rho, filling, Source::Wall.light());
            let by_paths = paths(&scene, Quantity::Fluence(DVec3::ZERO), Orders::ALL, PATHS, 3)[0];
            let what = format!("wall {rho}, filling {filling:?}");
            verdict::agrees(&what, &by_paths, (expected, 1e-5 * expected), 0.03 * expected, 3);
        }
    }
}

/// A wall that reflects half a per cent more is detected.
#[test]
fn a_wall_half_a_per_cent_off() {
    for filling in [None, Some((0.9, 0.0))] {
        let expected = on_the_wall(0.9, filling, Source::Centre);
        let scene = closed(0.9 * 1.005, filling, Source::Centre.light());
        let moments = tallies(&scene, &[(outflow(ball()), Orders::ALL)], 1 << 17, 4)[0][0];
        verdict::rejects(&format!("filling {filling:?}"), &moments, expected, 4);
    }
}
