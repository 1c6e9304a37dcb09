//! The isotropically scattering slab: single scattering, fluence by layer, collisions, counts, regions.

use crate::support::run::{pass, paths, tallies};
use crate::support::scenes::{
    CELL, Incidence, ball, bounded, outflow, reflectance, region, slab, sphere, transmittance, volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::estimators::count_within;
use turbid::photons::{Histories, Pass, Photon, shoot};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::slab_single::{single_reflectance, single_transmittance};
use turbid_analytic::{IsotropicSlab, Value};

const PATHS: u64 = 1 << 17;
const PHOTONS: u64 = 1 << 18;

/// The exact slab.
pub fn referee(tau: f64, albedo: f64, how: Incidence) -> IsotropicSlab {
    let incidence = match how {
        Incidence::Beam(mu0) => turbid_analytic::Incidence::Beam { mu0 },
        _ => turbid_analytic::Incidence::Diffuse,
    };
    IsotropicSlab::new(tau, albedo, incidence).unwrap()
}

/// The exact value, with room for the roundings of a path that has no other error.
pub fn exact(value: Value) -> (f64, f64) {
    (value.value, value.error + 16.0 * f64::EPSILON * value.value.abs())
}

/// Single scattering has a closed form of its own; with a second albedo or none it must be detected to be wrong.
pub fn single_scattering_is_the_closed_form() {
    let (tau, albedo) = (1.0, 0.5);
    let scene = slab(tau, albedo, 0.0, Incidence::Beam(0.5));
    let incidence = turbid_analytic::Incidence::Beam { mu0: 0.5 };
    let r = exact(single_reflectance(tau, albedo, incidence).unwrap());
    let t = exact(single_transmittance(tau, albedo, incidence).unwrap());
    for (name, quantity, reference) in [("R1", reflectance(tau), r), ("T1", transmittance(tau), t)] {
        let by_paths = paths(&scene, quantity.clone(), Orders::only(1), PATHS, 3)[0];
        let by_photons = pass(&scene, &[(quantity, Orders::only(1))], PHOTONS, 3, |_| false).tallies[0][0];
        for (who, moments) in [("paths", by_paths), ("photons", by_photons)] {
            verdict::agrees(&format!("{name} by {who}"), &moments, reference, 0.02, 3);
            verdict::rejects(&format!("{name} by {who}, albedo twice"), &moments, albedo * reference.0, 3);
            verdict::rejects(&format!("{name} by {who}, albedo never"), &moments, reference.0 / albedo, 3);
        }
    }
}

/// Layers of equal thickness.
pub const LAYERS: usize = 5;
const BATCHES: u64 = 128;
const PER_BATCH: u64 = 2300;

/// Sums of a number a photon over the layers of each batch, over histories and volume: no kernel, hence no blur.
/// `number` says which sum a photon belongs to and what it adds.
pub fn layer_means<const N: usize>(
    scene: &Scene,
    tau: f64,
    seed: u64,
    number: impl Fn(&Photon, &mut dyn FnMut(usize, f64)),
) -> Vec<[Moments; LAYERS]> {
    let mut moments = vec![[Moments::new(); LAYERS]; N];
    for replicate in 0..BATCHES {
        let histories = Histories { count: PER_BATCH, seed, replicate, max_order: None };
        let pass = shoot(scene, histories, &[], |_| true, &NoProgress).unwrap();
        let volume = CELL * CELL * tau / LAYERS as f64;
        let mut sums = vec![[0.0; LAYERS]; N];
        for photon in pass.photons() {
            let index = ((photon.position.z / tau * LAYERS as f64) as usize).min(LAYERS - 1);
            number(&photon, &mut |which, value| {
                sums[which][index] += value / (pass.emitted() as f64 * volume)
            });
        }
        for (m, s) in moments.iter_mut().zip(&sums) {
            m.iter_mut().zip(s).for_each(|(m, s)| m.push(*s));
        }
    }
    moments
}

/// Mean of a field over a layer. It may behave like c + t ln t at the faces: t = s^3 makes that smooth. Good to 1e-8 here
/// (measured against twice the parts).
pub fn layer_mean(tau: f64, index: usize, field: impl Fn(f64) -> f64) -> f64 {
    let width = tau / LAYERS as f64;
    let start = index as f64 * width;
    let depth = |s: f64| {
        let part = if index == LAYERS - 1 { 1.0 - s * s * s } else { s * s * s };
        (start + width * part).clamp(0.0, tau)
    };
    crate::support::quadrature::integrate(0.0, 1.0, 1, |s| field(depth(s)) * 3.0 * s * s)
}

/// Photons that were scattered, beside direct light in closed form, are the whole fluence. `keep` says which photons are
/// in the map.
pub fn the_map_and_direct_light_add_up(keep: fn(&Photon) -> bool) {
    let (tau, albedo) = (1.0, 0.5);
    let exact_slab = referee(tau, albedo, Incidence::Beam(1.0));
    let scene = slab(tau, albedo, 0.0, Incidence::Beam(1.0));
    let kept = layer_means::<1>(&scene, tau, 7, |photon, add| {
        if keep(photon) {
            add(0, f64::from(photon.power.x));
        }
    });
    for (index, moments) in kept[0].iter().enumerate() {
        let scattered = |t: f64| exact_slab.fluence(t).unwrap().value - turbid::math::exp(-t);
        let reference = layer_mean(tau, index, scattered);
        verdict::agrees(&format!("layer {index}"), moments, (reference, 1e-7), 0.1, 7);
    }
}

/// Stored power over histories, volume and extinction is the fluence. `coefficient` is what divides, of albedo 1/2 and
/// extinction 1.
pub fn stored_power_over_extinction_is_the_fluence(coefficient: f64) {
    let (tau, albedo) = (1.0, 0.5);
    let exact_slab = referee(tau, albedo, Incidence::Beam(1.0));
    let scene = slab(tau, albedo, 0.0, Incidence::Beam(1.0));
    let all = layer_means::<1>(&scene, tau, 8, |photon, add| add(0, f64::from(photon.power.x) / coefficient));
    for (index, moments) in all[0].iter().enumerate() {
        let reference = layer_mean(tau, index, |t| exact_slab.fluence(t).unwrap().value);
        verdict::agrees(&format!("layer {index}"), moments, (reference, 1e-7 * reference), 0.1, 8);
    }
}

/// Collisions over histories.
pub fn by_histories(pass: &Pass) -> f64 {
    pass.report.collisions as f64 / pass.emitted() as f64
}

/// The same, traced until 16 photons are stored and the last path cut: over the histories begun. Every history of a thick
/// slab collides, and begins with a photon of order 0.
pub fn until_so_many_are_stored(pass: &Pass) -> f64 {
    let stored = &pass.photons().collect::<Vec<_>>()[..16];
    16.0 / stored.iter().filter(|photon| photon.order == 0).count() as f64
}

/// Collisions a photon in a thick slab: the integral of the fluence, absorptance over 1 - albedo.
pub fn collisions_are_the_integral_of_the_fluence(count: fn(&Pass) -> f64) {
    let (tau, albedo) = (20.0, 0.9);
    let how = Incidence::Beam(1.0);
    let expected = referee(tau, albedo, how).absorptance().value / (1.0 - albedo);
    let scene = slab(tau, albedo, 0.0, how);
    let one = |replicate| {
        let histories = Histories { count: 32, seed: 9, replicate, max_order: None };
        count(&shoot(&scene, histories, &[], |_| true, &NoProgress).unwrap())
    };
    let moments: Moments = (0..4096).map(one).collect();
    verdict::agrees("collisions a photon", &moments, (expected, 1e-8), 0.05 * expected, 9);
}

/// Counts in balls vary as Poisson's law has it, if the photons taken are independent: variance over mean is 1, but for
/// the fixed number of histories, which leaves the variance over places of one map as it is.
pub fn counts_vary_as_poisson(orders: Orders) {
    let scene = slab(2.0, 0.9, 0.0, Incidence::Beam(1.0));
    let radius = 0.2;
    let mut pairs = Vec::new();
    for replicate in 0..128 {
        let histories = Histories { count: 1 << 14, seed: 10, replicate, max_order: orders.max };
        let keep = |photon: &Photon| {
            orders.contains(u32::from(photon.order)) && (photon.position.z - 1.0).abs() < 0.3
        };
        let pass = shoot(&scene, histories, &[], keep, &NoProgress).unwrap();
        let map = pass.into_map(0.0).unwrap();
        let place = |i: usize| DVec3::new(0.2 + 0.4 * (i % 10) as f64, 0.2 + 0.4 * (i / 10) as f64, 1.0);
        let counts: Moments = (0..100).map(|i| count_within(&map, place(i), radius) as f64).collect();
        pairs.push((counts.mean(), counts.variance()));
    }
    // The mean over all maps divides: the ratio of two numbers of one map would be biased.
    let mean = pairs.iter().map(|p| p.0).sum::<f64>() / pairs.len() as f64;
    let ratios: Moments = pairs.iter().map(|p| p.1 / mean).collect();
    verdict::agrees(&format!("variance over mean, {orders:?}"), &ratios, (1.0, 0.0), 0.15, 10);
}

/// A ball of fog, and the same ball with a smaller one of the same fog inside: the same escape and absorption.
pub fn a_region_in_two_pieces_is_one() {
    let source = || volume_source(sphere(DVec3::ZERO, 1.0));
    let one = ball(1.0, 0.9, 0.5, source());
    let pieces = [1.0, 0.5].map(|radius| region(sphere(DVec3::ZERO, radius), 1.0, 0.9, 0.5));
    let two = bounded(pieces.to_vec(), Vec::new(), vec![source()]);
    let escape = [(outflow(sphere(DVec3::ZERO, 1.0)), Orders::ALL)];
    let whole = tallies(&one, &escape, PHOTONS, 11)[0][0];
    let cut = tallies(&two, &escape, PHOTONS, 12)[0][0];
    verdict::agree("escape of a ball in one piece and in two", &whole, &cut, 0.01, 11);
    let absorbed = |scene: &Scene, regions: usize, seed: u64| -> Moments {
        let sum = |replicate| {
            let sensors: Vec<_> = (0..regions).map(|i| (Quantity::Absorbed(i), Orders::ALL)).collect();
            let parts = pass_of(scene, &sensors, 4096, seed, replicate);
            parts.tallies.iter().map(|t| t[0].mean()).sum::<f64>()
        };
        (0..64).map(sum).collect()
    };
    verdict::agree("absorption", &absorbed(&one, 1, 13), &absorbed(&two, 2, 14), 0.01, 13);
}

fn pass_of(scene: &Scene, sensors: &[(Quantity, Orders)], count: u64, seed: u64, replicate: u64) -> Pass {
    let sensors: Vec<_> = sensors.iter().map(|(q, o)| crate::support::run::sensor(q.clone(), *o)).collect();
    let histories = Histories { count, seed, replicate, max_order: None };
    shoot(scene, histories, &sensors, |_| false, &NoProgress).unwrap()
}
