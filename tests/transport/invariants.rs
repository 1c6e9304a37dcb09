//! Invariants: energy, threads, seeds, scale, and the number of histories.

use crate::support::run::pass;
use crate::support::scenes::{
    self, Incidence, area_light, bounded, cuboid, homogeneous, isotropic, point_light, rectangle, sphere,
};
use crate::support::verdict;
use glam::DVec3;
use std::path::Path;
use turbid::Spectrum;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::light::Faces;
use turbid::photons::{Histories, Photon, shoot};
use turbid::scene::{BUILTIN, Orders, Region, Scene};
use turbid::sensor::{Measurement, PathSettings, PhotonSettings, by_paths, by_photons};
use turbid::stats::Moments;
use turbid::surface::{Lambertian, Mirror, Surface};
use turbid::transport::NoProgress;

/// A built-in scene with some parameters changed.
fn builtin(name: &str, changes: &[(&str, &str)]) -> Scene {
    let builtin = BUILTIN.iter().find(|b| b.name == name).unwrap();
    let mut table: toml::Table = toml::from_str(builtin.defaults).unwrap();
    for (key, value) in changes {
        let value: toml::Table = toml::from_str(&format!("value = {value}")).unwrap();
        assert!(table.insert(key.to_string(), value["value"].clone()).is_some(), "{key}");
    }
    (builtin.resolve)(&toml::to_string(&table).unwrap()).unwrap().unwrap().scene(Path::new("")).unwrap()
}

/// Fog in colour, mirrors, diffuse walls, five lights, an overlap: whatever the simulator has.
fn colorful() -> Scene {
    let (outer, inner) = (sphere(DVec3::ZERO, 2.0), cuboid(DVec3::splat(-0.5), DVec3::splat(0.8)));
    let fog = |s: [f64; 3], a: [f64; 3], g| {
        homogeneous(Spectrum::rgb(s[0], s[1], s[2]), Spectrum::rgb(a[0], a[1], a[2]), g)
    };
    let floor = turbid::geometry::Shape::Rectangle(rectangle(
        DVec3::new(-3.0, -3.0, -2.5),
        DVec3::X * 6.0,
        DVec3::Y * 6.0,
    ));
    let ball = sphere(DVec3::new(0.0, 2.5, 0.0), 0.7);
    let diffuse = Surface::Lambertian(Lambertian::new(Spectrum::rgb(0.9, 0.5, 0.1)).unwrap());
    let mirror = Surface::Mirror(Mirror::new(Spectrum::rgb(0.8, 0.9, 1.0)).unwrap());
    let lamp = rectangle(DVec3::new(-0.5, -0.5, 3.0), DVec3::Y, DVec3::X);
    bounded(
        vec![
            Region { shape: outer.clone(), medium: fog([0.5, 1.0, 0.2], [0.9, 0.3, 0.99], 0.5) },
            Region { shape: inner.clone(), medium: fog([2.0, 0.0, 3.0], [0.5, 0.5, 1.0], -0.3) },
        ],
        vec![(floor, diffuse), (ball, mirror)],
        vec![
            area_light(lamp, Spectrum::rgb(1.0, 0.5, 0.0)),
            point_light(DVec3::new(0.1, 0.2, 0.3), Spectrum::rgb(0.0, 0.0, 3.0)),
            isotropic(outer, Faces::Both),
            scenes::volume_source(inner),
            scenes::emitting_sphere(DVec3::new(-3.0, 0.0, 0.0), 0.3),
        ],
    )
}

fn all_scenes() -> Vec<(String, Scene)> {
    let mut all: Vec<(String, Scene)> =
        BUILTIN.iter().map(|b| (b.name.to_string(), builtin(b.name, &[]))).collect();
    for source in ["\"point\"", "\"incidence\""] {
        all.push((format!("sphere, {source}"), builtin("sphere", &[("source", source)])));
    }
    for (tau, mu0) in [("1e-8", "0.5"), ("20.0", "\"diffuse\""), ("2.0", "0.001")] {
        all.push((
            format!("slab, tau {tau}, mu0 {mu0}"),
            builtin("slab", &[("tau", tau), ("mu0", mu0), ("g", "0.75")]),
        ));
    }
    all.push(("in colour".to_string(), colorful()));
    all
}

/// Emitted = absorbed + escaped (+ truncated, where histories stop): to rounding, 1e-12 over 2^14 histories.
#[test]
fn energy_is_conserved() {
    for (name, scene) in all_scenes() {
        for max_order in [None, Some(0), Some(2)] {
            let histories = Histories { count: 1 << 14, seed: 1, replicate: 0, max_order };
            let pass = shoot(&scene, histories, scene.sensors(), |_| false, &NoProgress).unwrap();
            let ledger = pass.report.ledger;
            let settled = ledger.absorbed + ledger.escaped + ledger.truncated;
            assert!((settled / ledger.emitted - 1.0).abs() < 1e-12, "{name}, {max_order:?}: {ledger:?}");
            assert!(
                (ledger.emitted / (scene.power().sum() * pass.emitted() as f64) - 1.0).abs() < 1e-12,
                "{name}"
            );
            assert!(max_order.is_some() || ledger.truncated == 0.0);
        }
    }
}

/// Escape and absorption of one closed scene add up to 1 in each channel: sums alone could hide a channel's error.
#[test]
fn energy_is_conserved_by_channel() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let medium = homogeneous(Spectrum::rgb(0.5, 2.0, 1.0), Spectrum::rgb(0.95, 0.3, 0.6), 0.3);
    let scene = bounded(
        vec![Region { shape: ball.clone(), medium }],
        Vec::new(),
        vec![isotropic(ball.clone(), Faces::Both)],
    );
    let sum = |sensors: &[(turbid::scene::Quantity, Orders)], replicate: u64| -> [f64; 3] {
        let sensors: Vec<_> =
            sensors.iter().map(|(q, o)| crate::support::run::sensor(q.clone(), *o)).collect();
        let histories = Histories { count: 4096, seed: 2, replicate, max_order: None };
        let tallies = shoot(&scene, histories, &sensors, |_| false, &NoProgress).unwrap().tallies;
        [0, 1, 2].map(|c| tallies.iter().map(|t| t[c].mean()).sum())
    };
    let mut moments = [Moments::new(); 3];
    for replicate in 0..128 {
        let both = [
            (scenes::outflow(ball.clone()), Orders::ALL),
            (turbid::scene::Quantity::Absorbed(0), Orders::ALL),
        ];
        moments.iter_mut().zip(sum(&both, replicate)).for_each(|(m, x)| m.push(x));
    }
    for (c, m) in moments.iter().enumerate() {
        verdict::agrees(&format!("channel {c}"), m, (1.0, 1e-12), 0.01, 2);
    }
}

fn in_pool<T: Send>(threads: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(f)
}

fn path_settings(seed: u64) -> PathSettings {
    PathSettings { samples: 20_000, seed, replicate: 0, orders: Orders::ALL }
}

fn nearest() -> Gather {
    Gather::nearest(50, 1.0).unwrap()
}

fn photon_settings(seed: u64, gather: Gather) -> PhotonSettings {
    PhotonSettings {
        photons: 20_000,
        maps: 2,
        seed,
        orders: Orders::ALL,
        estimator: Estimator::new(Kernel::Epanechnikov, gather).treated(Treatment::Clipped),
    }
}

fn bits(measurements: &[Measurement]) -> Vec<(u64, Option<u64>, u64)> {
    measurements.iter().map(|r| (r.mean.to_bits(), r.std_error.map(f64::to_bits), r.n)).collect()
}

fn photon_bits(photons: &[Photon]) -> Vec<([u64; 3], [u32; 6], u16)> {
    let bits = |p: &Photon| {
        let (d, w) = (p.dir.to_array(), p.power.to_array());
        (
            p.position.to_array().map(f64::to_bits),
            [d[0], d[1], d[2], w[0], w[1], w[2]].map(f32::to_bits),
            p.order,
        )
    };
    photons.iter().map(bits).collect()
}

/// Paths, photons and maps on 1, 2 and 4 threads, and once more: the same bits; another seed: other bits.
#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    for name in ["slab", "sphere", "shaft"] {
        let scene = builtin(name, &[]);
        let all = |threads: usize, seed: u64| {
            in_pool(threads, || {
                let paths = by_paths(&scene, &path_settings(seed), &NoProgress).unwrap();
                let photons = by_photons(&scene, &photon_settings(seed, nearest()), &NoProgress).unwrap();
                (bits(&paths), bits(&photons.measurements), photons.ledger)
            })
        };
        let one = all(1, 7);
        for threads in [1, 2, 4] {
            assert!(all(threads, 7) == one, "{name} on {threads} threads");
        }
        let other = all(2, 8);
        assert!(other.0.iter().zip(&one.0).any(|(a, b)| a != b) && other.1 != one.1, "{name}: seeds");
    }
    let scene = colorful();
    let photons = |threads: usize| {
        in_pool(threads, || {
            photon_bits(&pass(&scene, &[], 20_000, 7, |_| true).photons().collect::<Vec<_>>())
        })
    };
    let one = photons(1);
    assert!(one.len() > 10_000 && photons(2) == one && photons(4) == one);
}

#[test]
fn moments_do_not_depend_on_the_threads() {
    crate::checks::threads::moments_do_not_depend_on_the_threads();
}

/// The slab in units of 2^-20 and 2^20 mean free paths: the same bits, positions scaled.
#[test]
fn scale_changes_no_bit() {
    let small = 1.0 / 1_048_576.0;
    let measurements = |scale: f64| {
        let scene = builtin("slab", &[("scale", &format!("{scale:e}")), ("mu0", "0.5"), ("g", "0.75")]);
        let gather = |r: f64| photon_settings(3, Gather::radius(r * scale).unwrap());
        let nearest = photon_settings(3, Gather::nearest(50, scale).unwrap());
        (
            bits(&by_paths(&scene, &path_settings(3), &NoProgress).unwrap()),
            bits(&by_photons(&scene, &gather(0.25), &NoProgress).unwrap().measurements),
            bits(&by_photons(&scene, &nearest, &NoProgress).unwrap().measurements),
        )
    };
    let one = measurements(1.0);
    for scale in [small, 1.0 / small] {
        let scaled = measurements(scale);
        assert!(scaled.0 == one.0, "paths at scale {scale}");
        assert!(scaled.1 == one.1, "photons, fixed radius, at scale {scale}");
        assert!(scaled.2 == one.2, "photons, k nearest, at scale {scale}");
    }
}

/// A longer run starts with the shorter one, photon by photon; estimates divide by what was emitted, so that four times
/// the photons leave the mean where it was. Powers that nobody divides by the number emitted, or somebody divides
/// twice, would fail here.
#[test]
fn the_number_of_histories_changes_no_mean() {
    let scene = builtin("slab", &[]);
    let short = pass(&scene, &[], 10_000, 5, |_| true).photons().collect::<Vec<_>>();
    let long = pass(&scene, &[], 40_000, 5, |_| true).photons().collect::<Vec<_>>();
    assert!(photon_bits(&long)[..short.len()] == photon_bits(&short)[..]);
    let fluence = |photons: u64, seed: u64| -> Moments {
        let settings =
            PhotonSettings { photons, maps: 64, ..photon_settings(seed, Gather::radius(0.4).unwrap()) };
        let result = by_photons(&scene, &settings, &NoProgress).unwrap();
        let measurement = &result.measurements[6];
        assert_eq!((measurement.quantity.as_str(), measurement.n), ("fluence", 64));
        // Mean and error of the maps, as two values that have them.
        let half = measurement.std_error.unwrap() * 63f64.sqrt();
        (0..64).map(|i| measurement.mean + half * if i % 2 == 0 { 1.0 } else { -1.0 }).collect()
    };
    verdict::agree("fluence at 4,000 and 16,000 photons", &fluence(4_000, 6), &fluence(16_000, 7), 0.3, 6);
    let paths = |n| crate::support::run::paths(&scene, scenes::at_depth(1.0), Orders::ALL, n, 8)[0];
    verdict::agree("paths at 2^16 and 2^19", &paths(1 << 16), &paths(1 << 19), 0.1, 8);
}

/// Sensors do not disturb each other: a scene with one sensor less reads the same tallies, and photons kept or not, the
/// same ledger.
#[test]
fn what_is_asked_does_not_change_the_answer() {
    let scene = scenes::slab(2.0, 0.9, 0.5, Incidence::Beam(0.5));
    let (r, t) = ((scenes::reflectance(2.0), Orders::ALL), (scenes::transmittance(2.0), Orders::ALL));
    let both = pass(&scene, &[r, t.clone()], 10_000, 9, |_| true);
    let one = pass(&scene, &[t], 10_000, 9, |_| false);
    assert_eq!(both.tallies[1], one.tallies[0]);
    assert_eq!(both.report.ledger, one.report.ledger);
}
