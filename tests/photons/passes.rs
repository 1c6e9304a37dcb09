//! Photons in passes of bounded memory: the same estimates as in one pass, and the same bits on any number of threads.

use crate::support::scenes::{Incidence, at_depth, reflectance};
use crate::support::scenes::{bounded, cuboid, homogeneous, outflow, point_light, slab, sphere};
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::Ray;
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts, Sensor};
use turbid::sensor::{PhotonReadings, PhotonSettings, by_photons, by_photons_in_passes, forecast};
use turbid::transport::NoProgress;

fn with_sensors(scene: &Scene, quantities: &[(Quantity, Orders)]) -> Scene {
    let sensors = quantities.iter().enumerate().map(|(i, (quantity, orders))| {
        let (name, label) = (format!("sensor {i}"), format!("sensor {i}"));
        Sensor { name, label, quantity: quantity.clone(), orders: *orders }
    });
    Scene::new(SceneParts {
        regions: scene.regions().to_vec(),
        lights: scene.named_lights().to_vec(),
        cell: scene.periodic_cell().map(|periodic_cell| periodic_cell.side),
        sensors: sensors.collect(),
        ..SceneParts::default()
    })
    .unwrap()
}

fn settings(photons: u64, gather: Gather) -> PhotonSettings {
    let estimator = Estimator::new(Kernel::Epanechnikov, gather).treated(Treatment::Clipped);
    PhotonSettings { photons, maps: 3, seed: 4, orders: Orders::ALL, estimator }
}

/// A slab and a ball in colour: fluences at the cell's edge too, radiances with light that nothing scattered, tallies.
fn scenes() -> [Scene; 2] {
    let two = Orders { min: 0, max: Some(2) };
    let layer = with_sensors(
        &slab(2.0, 0.9, 0.5, Incidence::Beam(0.7)),
        &[
            (at_depth(0.7), Orders::ALL),
            (Quantity::Fluence(DVec3::new(0.05, 3.9, 1.1)), two),
            (reflectance(2.0), Orders::ALL),
            (Quantity::Radiance(Ray::new(DVec3::new(1.0, 1.0, -1.0), DVec3::Z)), Orders::ALL),
        ],
    );
    let medium = homogeneous(Spectrum::rgb(1.0, 2.0, 0.5), Spectrum::rgb(0.9, 0.5, 0.8), 0.3);
    let region = Region { shape: sphere(DVec3::ZERO, 1.5), medium };
    let light = point_light(DVec3::new(0.4, 0.0, 0.1), Spectrum::rgb(1.0, 3.0, 2.0));
    let ball = with_sensors(
        &bounded(vec![region], Vec::new(), vec![light]),
        &[
            (Quantity::Fluence(DVec3::new(-0.5, 0.2, 0.1)), Orders::ALL),
            (outflow(cuboid(DVec3::splat(-0.3), DVec3::splat(0.8))), two),
        ],
    );
    [layer, ball]
}

fn in_passes(scene: &Scene, settings: &PhotonSettings, passes: u64, threads: usize) -> PhotonReadings {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| by_photons_in_passes(scene, settings, passes, &NoProgress).unwrap())
}

/// Sums of the same single-precision numbers in another order, and balls of photons whose places are rounded relative to
/// another box: 1e-5 is far above the first, and a photon that changes sides of a ball, one in 1e6, would be detected.
#[test]
fn passes_change_no_estimate() {
    for scene in scenes() {
        let settings = settings(20_000, Gather::radius(0.3).unwrap());
        let one = by_photons(&scene, &settings, &NoProgress).unwrap();
        for passes in [2, 7] {
            let many = in_passes(&scene, &settings, passes, 2);
            assert_eq!(many.measurements.len(), one.measurements.len());
            for (a, b) in one.measurements.iter().zip(&many.measurements) {
                assert!(a.mean > 0.0 && (b.mean / a.mean - 1.0).abs() < 1e-5, "{passes} passes: {a:?} {b:?}");
                let (a, b) = (a.std_error.unwrap(), b.std_error.unwrap());
                assert!((b / a - 1.0).abs() < 1e-3, "{passes} passes: error {a} {b}");
            }
            let (a, b) = (one.ledger, many.ledger);
            assert!(
                (b.emitted / a.emitted - 1.0).abs() < 1e-12 && (b.absorbed / a.absorbed - 1.0).abs() < 1e-12
            );
            assert_eq!((one.gathers, one.underfull, one.beyond), (many.gathers, many.underfull, many.beyond));
        }
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let [scene, _] = scenes();
    let settings = settings(20_000, Gather::radius(0.3).unwrap());
    assert_eq!(in_passes(&scene, &settings, 3, 1), in_passes(&scene, &settings, 3, 4));
    // A pass may be shorter than a block, and there may be one a photon.
    let few = PhotonSettings { photons: 5, ..settings };
    let (many, one) = (in_passes(&scene, &few, 5, 2), by_photons(&scene, &few, &NoProgress).unwrap());
    assert!((many.ledger.emitted / one.ledger.emitted - 1.0).abs() < 1e-12);
}

#[test]
fn what_cannot_be_cut_is_refused() {
    let [scene, _] = scenes();
    let refused = |settings: &PhotonSettings, passes: u64| {
        by_photons_in_passes(&scene, settings, passes, &NoProgress).unwrap_err().to_string()
    };
    let nearest = settings(1000, Gather::nearest(20, 0.3).unwrap());
    assert!(refused(&nearest, 2).contains("k nearest"));
    let fixed = settings(1000, Gather::radius(0.3).unwrap());
    assert!(refused(&fixed, 0).contains("the number of passes is 0"));
    assert!(refused(&fixed, 1001).contains("at most one a photon"));
}

/// The pilot's number is that of the run, and passes divide what is in memory.
#[test]
fn a_forecast_says_what_is_stored() {
    let [scene, _] = scenes();
    let settings = settings(200_000, Gather::radius(0.3).unwrap());
    let (one, four) = (forecast(&scene, &settings, 1).unwrap(), forecast(&scene, &settings, 4).unwrap());
    assert_eq!((one.stored, one.bytes), (four.stored, 4.0 * four.bytes));
    // Collisions a history, from 1024 of them; each is in the maps of all orders, and fewer in those of two.
    let plain =
        crate::support::run::pass(&slab(2.0, 0.9, 0.5, Incidence::Beam(0.7)), &[], 20_000, 9, |_| true);
    let collisions = plain.photons().count() as f64 / 20_000.0 * 200_000.0;
    let ratio = one.stored / collisions;
    // Three ranges of orders, one of them up to 2; copies of a margin of 0.3 beyond a cell of 4, (1 + 0.15)^2.
    assert!(ratio > 2.0 && ratio < 3.0 * 1.33 * 1.2, "{ratio}");
}
