//! Slabs whose density varies with depth: only the optical depth counts, so that the homogeneous slab's exact values are
//! theirs; a constant grid is the first of them.

use crate::checks::media::{layered, varying};
use crate::checks::slab::{exact, referee};
use crate::support::run::{pass, paths, sensor};
use crate::support::scenes::{
    CELL, Incidence, incidence, isotropic, layer, outflow, point_light, reflectance, sphere, transmittance,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{Interval, Positive, Ray};
use turbid::medium::{Density, Grid, HeightFog, Medium};
use turbid::photons::{Histories, shoot};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

const PATHS: u64 = 10_000;
const PHOTONS: u64 = 20_000;
const THICKNESS: f64 = 3.0;
const ALBEDO: f64 = 0.9;

fn grid(count: usize, f: impl Fn(f64) -> f64) -> Density {
    layered((DVec3::ZERO, DVec3::new(1.0, 1.0, THICKNESS)), count, f)
}

/// Name and density: constant, a smooth and a broken profile, and fog that thins out upwards (z grows with depth).
fn profiles() -> Vec<(&'static str, Density)> {
    let fog = HeightFog::new(-DVec3::Z, -2.0, Positive::try_from(0.8).unwrap()).unwrap();
    vec![
        ("constant grid", grid(7, |_| 1.25)),
        ("wave", grid(40, |z| 1.0 + 0.9 * turbid::math::sin(4.0 * z))),
        ("gap", grid(12, |z| if (z - 1.5).abs() < 0.6 { 0.0 } else { 4.0 })),
        ("height fog", Density::HeightFog(fog)),
    ]
}

fn down() -> Ray {
    Ray::new(DVec3::ZERO, DVec3::Z)
}

/// The slab of a density, scaled so that its optical depth is `tau`.
fn slab(density: Density, tau: f64, how: Incidence) -> Scene {
    let whole = Interval { start: 0.0, end: THICKNESS };
    let sigma_t = tau / density.integral(&down(), whole);
    let shape = layer(THICKNESS);
    Scene::new(SceneParts {
        regions: vec![Region {
            shape: shape.clone(),
            medium: varying(Spectrum::grey(sigma_t), ALBEDO, density),
        }],
        lights: vec![incidence(shape, how)],
        cell: Some(glam::DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap()
}

#[test]
fn fluxes_depend_on_the_optical_depth_alone() {
    for (name, density) in profiles() {
        for (tau, how) in [(2.0, Incidence::Beam(0.5)), (1.0, Incidence::Diffuse)] {
            let scene = slab(density.clone(), tau, how);
            let exact_slab = referee(tau, ALBEDO, how);
            let sensors = [reflectance(THICKNESS), transmittance(THICKNESS), Quantity::Absorbed(0)];
            let references = [exact_slab.reflectance(), exact_slab.transmittance(), exact_slab.absorptance()];
            let asked = sensors.clone().map(|quantity| (quantity, Orders::ALL));
            let tallies = pass(&scene, &asked, PHOTONS, 21, |_| false).tallies;
            for (i, quantity) in sensors.iter().enumerate() {
                let what = format!("{name}, tau {tau}, {how:?}, flux {i}");
                let reference = exact(references[i]);
                verdict::agrees(&format!("{what} by photons"), &tallies[i][0], reference, 0.03, 21);
                let by_paths = paths(&scene, quantity.clone(), Orders::ALL, PATHS, 22)[0];
                verdict::agrees(&format!("{what} by paths"), &by_paths, reference, 0.08, 22);
            }
        }
    }
}

/// The height at which half the depth is above, and three quarters.
fn depth_at(medium: &Medium, t: f64) -> f64 {
    let (mut low, mut high) = (0.0, THICKNESS);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let above = medium.integrated_depth(&down(), Interval { start: 0.0, end: middle })[0];
        if above < t { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn fluence_is_that_of_the_same_depth() {
    let (tau, how) = (2.0, Incidence::Beam(1.0));
    let exact_slab = referee(tau, ALBEDO, how);
    for (name, density) in profiles() {
        let scene = slab(density, tau, how);
        for t in [0.5, 1.5] {
            let z = depth_at(&scene.regions()[0].medium, t);
            let reference = exact_slab.fluence(t).unwrap();
            let at = DVec3::new(0.5 * CELL, 0.5 * CELL, z);
            let by_paths = paths(&scene, Quantity::Fluence(at), Orders::ALL, PATHS, 23)[0];
            verdict::agrees(&format!("{name}, depth {t}"), &by_paths, exact(reference), 0.2, 23);
        }
    }
}

/// Photons stored between two depths carry the fluence's integral over the optical depth between them, wherever that
/// is: the estimate divides by the extinction at each photon.
#[test]
fn stored_photons_carry_the_fluence_of_their_depths() {
    let (tau, how, parts) = (2.0, Incidence::Beam(1.0), 4usize);
    let exact_slab = referee(tau, ALBEDO, how);
    for (name, density) in profiles() {
        let scene = slab(density, tau, how);
        let medium = &scene.regions()[0].medium;
        let mut moments = vec![Moments::new(); parts];
        for replicate in 0..64 {
            let histories = Histories { count: 400, seed: 24, replicate, max_order: None };
            let pass = shoot(&scene, histories, &[], |_| true, &NoProgress).unwrap();
            let map = pass.clone().into_map(0.0).unwrap();
            let mut sums = vec![0.0; parts];
            for photon in pass.photons() {
                let depth =
                    medium.integrated_depth(&down(), Interval { start: 0.0, end: photon.position.z })[0];
                let part = ((depth / tau * parts as f64) as usize).min(parts - 1);
                sums[part] += f64::from(photon.power.x) / map.emitted() as f64;
            }
            moments.iter_mut().zip(&sums).for_each(|(m, sum)| m.push(sum / (CELL * CELL)));
        }
        for (part, m) in moments.iter().enumerate() {
            let width = tau / parts as f64;
            let fluence = |t: f64| exact_slab.fluence_interpolated(t).unwrap().value;
            let low = part as f64 * width;
            let integral = crate::support::quadrature::integrate(low, low + width, 4, fluence);
            // The interpolated fluence has a kink of t ln t at the faces: good to 1e-5 of it.
            verdict::agrees(&format!("{name}, part {part}"), m, (integral, 1e-4 * integral), 0.1, 24);
        }
    }
}

/// A chromatic ball of a medium, homogeneous or a constant grid that reaches beyond it, lit by a point beside it and a
/// surface source, with a sensor of every kind.
fn ball(medium: Medium) -> Scene {
    let shape = sphere(DVec3::ZERO, 1.0);
    let sensors = [
        Quantity::Fluence(DVec3::new(0.3, 0.0, 0.1)),
        Quantity::Radiance(Ray::new(DVec3::new(0.2, -2.0, 0.1), DVec3::Y)),
        outflow(shape.clone()),
        Quantity::Absorbed(0),
    ];
    Scene::new(SceneParts {
        regions: vec![Region { shape: shape.clone(), medium }],
        lights: vec![
            point_light(DVec3::new(-1.6, 0.1, 0.0), Spectrum::rgb(9.0, 18.0, 9.0)),
            isotropic(shape, turbid::light::Faces::Both),
        ],
        sensors: sensors.map(|quantity| sensor(quantity, Orders::ALL)).to_vec(),
        ..SceneParts::default()
    })
    .unwrap()
}

/// The two forms of one medium agree in every sensor, by paths and by photons, in every channel.
#[test]
fn a_constant_grid_is_the_homogeneous_medium() {
    let sigma_t = Spectrum::rgb(0.5, 1.0, 2.0);
    let box_of_grid = (DVec3::splat(-0.9), DVec3::splat(0.9));
    let density = Density::grid(Grid::sampled(box_of_grid, [5, 1, 3], |_| 2.0).unwrap()).unwrap();
    let homogeneous = ball(crate::support::scenes::homogeneous(sigma_t, Spectrum::grey(ALBEDO), 0.0));
    let gridded = ball(varying(sigma_t * 0.5, ALBEDO, density));
    for (i, asked) in homogeneous.sensors().iter().enumerate() {
        let of = |scene: &Scene, seed: u64| paths(scene, asked.quantity.clone(), Orders::ALL, 1 << 14, seed);
        let (a, b) = (of(&homogeneous, 51), of(&gridded, 52));
        for c in 0..3 {
            verdict::agree(&format!("sensor {i}, channel {c}, by paths"), &a[c], &b[c], 0.5, 51);
        }
    }
    let by_maps = |scene: &Scene, seed: u64| -> Vec<Moments> {
        let mut moments = vec![Moments::new(); 12];
        for map in 0..64 {
            let gather = Gather::radius(0.4).unwrap();
            let settings = PhotonSettings {
                photons: 4096,
                maps: 1,
                seed: seed + map,
                orders: Orders::ALL,
                estimator: Estimator::new(Kernel::Uniform, gather),
            };
            let read = by_photons(scene, &settings, &NoProgress).unwrap();
            assert_eq!(read.measurements.len(), 12);
            moments.iter_mut().zip(&read.measurements).for_each(|(m, r)| m.push(r.mean));
        }
        moments
    };
    let (a, b) = (by_maps(&homogeneous, 1000), by_maps(&gridded, 2000));
    for (i, (a, b)) in a.iter().zip(&b).enumerate() {
        verdict::agree(&format!("measurement {i} by photons"), a, b, 0.7, 1000);
    }
}
