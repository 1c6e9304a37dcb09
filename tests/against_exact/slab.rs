//! The isotropically scattering slab, order by order: reflectance, transmittance, absorptance, fluence.
//!
//! Order by order is what catches path lengths counted differently by paths and photons, direct light counted twice and
//! albedos applied twice or not at all: in the sum they may hide behind each other.

use crate::support::run::{pass, paths};
use crate::support::scenes::{CELL, Incidence, at_depth, reflectance, slab, transmittance};
use crate::support::verdict;
use turbid::photons::{Histories, shoot};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::slab_single::{single_reflectance, single_transmittance};
use turbid_analytic::{IsotropicSlab, Value};

/// Paths a quantity and order: a bias of 0.03 of the irradiance is seen in every flux, of 0.12 in every fluence.
const PATHS: u64 = 1 << 17;
const PHOTONS: u64 = 1 << 18;
/// Orders that are told apart.
const HIGHEST: u32 = 4;

const CASES: [(f64, f64, Incidence); 6] = [
    (1.0, 0.9, Incidence::Beam(1.0)),
    (2.0, 0.5, Incidence::Beam(0.5)),
    (1.0, 1.0, Incidence::Beam(0.1)),
    (2.0, 0.9, Incidence::Diffuse),
    (0.3, 0.99, Incidence::Diffuse),
    (5.0, 1.0, Incidence::Beam(1.0)),
];

fn referee(tau: f64, albedo: f64, how: Incidence) -> IsotropicSlab {
    let incidence = match how {
        Incidence::Beam(mu0) => turbid_analytic::Incidence::Beam { mu0 },
        _ => turbid_analytic::Incidence::Diffuse,
    };
    IsotropicSlab::new(tau, albedo, incidence).unwrap()
}

/// The exact value, with room for the roundings of a path that has no other error.
fn exact(value: Value) -> (f64, f64) {
    (value.value, value.error + 16.0 * f64::EPSILON * value.value.abs())
}

#[test]
fn fluxes_of_photons_by_order() {
    for (tau, albedo, how) in CASES {
        let exact_slab = referee(tau, albedo, how);
        let scene = slab(tau, albedo, 0.0, how);
        let orders: Vec<Orders> = (0..=HIGHEST).map(Orders::only).chain([Orders::ALL]).collect();
        let sensors: Vec<(Quantity, Orders)> = orders
            .iter()
            .flat_map(|o| [(reflectance(tau), *o), (transmittance(tau), *o), (Quantity::Absorbed(0), *o)])
            .collect();
        let tallies = pass(&scene, &sensors, PHOTONS, 1, |_| false).tallies;
        for (i, order) in orders.iter().enumerate() {
            let (r, t) = match order.max {
                Some(n) => (
                    exact_slab.reflectance_of_order(n).unwrap(),
                    exact_slab.transmittance_of_order(n).unwrap(),
                ),
                None => (exact_slab.reflectance(), exact_slab.transmittance()),
            };
            let what = format!("tau {tau}, albedo {albedo}, {how:?}, {order:?}");
            verdict::agrees(&format!("R, {what}"), &tallies[3 * i][0], exact(r), 0.01, 1);
            verdict::agrees(&format!("T, {what}"), &tallies[3 * i + 1][0], exact(t), 0.01, 1);
            if order.max.is_none() {
                verdict::agrees(
                    &format!("A, {what}"),
                    &tallies[3 * i + 2][0],
                    exact(exact_slab.absorptance()),
                    0.01,
                    1,
                );
            }
        }
    }
}

#[test]
fn fluxes_of_paths_by_order() {
    for (tau, albedo, how) in CASES {
        let exact_slab = referee(tau, albedo, how);
        let scene = slab(tau, albedo, 0.0, how);
        let run = |q, orders| paths(&scene, q, orders, PATHS, 2)[0];
        let what = format!("tau {tau}, albedo {albedo}, {how:?}");
        for n in 0..=HIGHEST {
            let (r, t) =
                (exact_slab.reflectance_of_order(n).unwrap(), exact_slab.transmittance_of_order(n).unwrap());
            verdict::agrees(
                &format!("R{n}, {what}"),
                &run(reflectance(tau), Orders::only(n)),
                exact(r),
                0.03,
                2,
            );
            verdict::agrees(
                &format!("T{n}, {what}"),
                &run(transmittance(tau), Orders::only(n)),
                exact(t),
                0.03,
                2,
            );
        }
        verdict::agrees(
            &format!("R, {what}"),
            &run(reflectance(tau), Orders::ALL),
            exact(exact_slab.reflectance()),
            0.03,
            2,
        );
        verdict::agrees(
            &format!("T, {what}"),
            &run(transmittance(tau), Orders::ALL),
            exact(exact_slab.transmittance()),
            0.03,
            2,
        );
        verdict::agrees(
            &format!("A, {what}"),
            &run(Quantity::Absorbed(0), Orders::ALL),
            exact(exact_slab.absorptance()),
            0.03,
            2,
        );
    }
}

/// Single scattering has a closed form of its own; with a second albedo or none it must be seen to be wrong.
#[test]
fn single_scattering_is_the_closed_form() {
    let (tau, albedo) = (1.0, 0.5);
    let scene = slab(tau, albedo, 0.0, Incidence::Beam(0.5));
    let incidence = turbid_analytic::Incidence::Beam { mu0: 0.5 };
    let r = exact(single_reflectance(tau, albedo, incidence).unwrap());
    let t = exact(single_transmittance(tau, albedo, incidence).unwrap());
    for (name, quantity, reference) in [("R1", reflectance(tau), r), ("T1", transmittance(tau), t)] {
        let by_paths = paths(&scene, quantity, Orders::only(1), PATHS, 3)[0];
        let by_photons = pass(&scene, &[(quantity, Orders::only(1))], PHOTONS, 3, |_| false).tallies[0][0];
        for (who, moments) in [("paths", by_paths), ("photons", by_photons)] {
            verdict::agrees(&format!("{name} by {who}"), &moments, reference, 0.02, 3);
            verdict::rejects(&format!("{name} by {who}, albedo twice"), &moments, albedo * reference.0, 3);
            verdict::rejects(&format!("{name} by {who}, albedo never"), &moments, reference.0 / albedo, 3);
        }
    }
}

#[test]
fn fluence_of_paths_by_order() {
    for (tau, albedo, how) in CASES {
        let exact_slab = referee(tau, albedo, how);
        let scene = slab(tau, albedo, 0.0, how);
        for part in [0.0, 0.3, 1.0] {
            let t = part * tau;
            let what = format!("t {t}, tau {tau}, albedo {albedo}, {how:?}");
            for n in [0, 1, 3] {
                let moments = paths(&scene, at_depth(t), Orders::only(n), PATHS, 4)[0];
                verdict::agrees(
                    &format!("phi{n}, {what}"),
                    &moments,
                    exact(exact_slab.fluence_of_order(n, t).unwrap()),
                    0.12,
                    4,
                );
            }
            let moments = paths(&scene, at_depth(t), Orders::ALL, PATHS, 5)[0];
            verdict::agrees(
                &format!("phi, {what}"),
                &moments,
                exact(exact_slab.fluence(t).unwrap()),
                0.12,
                5,
            );
        }
    }
}

/// Layers of equal thickness.
const LAYERS: usize = 5;
const BATCHES: u64 = 128;

/// Mean fluence of each layer and order from the photons that collide there: power over sigma_t and volume. No
/// kernel, hence no blur: what is stored is tested alone. One set of moments over batches.
fn layer_fluences(scene: &Scene, tau: f64, seed: u64) -> Vec<[Moments; LAYERS]> {
    const PER_BATCH: u64 = 4096;
    let mut moments = vec![[Moments::new(); LAYERS]; HIGHEST as usize + 2];
    for replicate in 0..BATCHES {
        let histories = Histories { count: PER_BATCH, seed, replicate, max_order: None };
        let pass = shoot(scene, histories, &[], |_| true, &NoProgress).unwrap();
        let volume = CELL * CELL * tau / LAYERS as f64;
        let mut sums = vec![[0.0; LAYERS]; moments.len()];
        for photon in &pass.photons {
            let index = ((photon.position.z / tau * LAYERS as f64) as usize).min(LAYERS - 1);
            let share = f64::from(photon.power.x) / (pass.emitted as f64 * volume);
            if u32::from(photon.order) <= HIGHEST {
                sums[usize::from(photon.order)][index] += share;
            }
            sums[HIGHEST as usize + 1][index] += share;
        }
        for (m, s) in moments.iter_mut().zip(&sums) {
            m.iter_mut().zip(s).for_each(|(m, s)| m.push(*s));
        }
    }
    moments
}

#[test]
fn fluence_of_photons_by_order_and_layer() {
    for (tau, albedo, how) in CASES {
        let exact_slab = referee(tau, albedo, how);
        let measured = layer_fluences(&slab(tau, albedo, 0.0, how), tau, 6);
        for (i, per_layer) in measured.iter().enumerate() {
            let n = i as u32;
            let phi = |t: f64| {
                let value =
                    if n <= HIGHEST { exact_slab.fluence_of_order(n, t) } else { exact_slab.fluence(t) };
                value.unwrap().value
            };
            for (index, moments) in per_layer.iter().enumerate() {
                let width = tau / LAYERS as f64;
                let start = index as f64 * width;
                // phi = c + t ln t at the faces: t = s^3 makes it smooth; mean over the layer.
                let depth = |s: f64| {
                    if index == LAYERS - 1 {
                        start + width * (1.0 - s * s * s)
                    } else {
                        start + width * s * s * s
                    }
                };
                let mean = crate::support::quadrature::integrate(0.0, 1.0, 1, |s| {
                    phi(depth(s).clamp(0.0, tau)) * 3.0 * s * s
                });
                let what = format!("phi{n}, layer {index}, tau {tau}, albedo {albedo}, {how:?}");
                // The quadrature is good to 1e-8 here (measured against twice the parts); f32 powers to 6e-8.
                verdict::agrees(&what, moments, (mean, 1e-7 * mean), 0.1, 6);
            }
        }
    }
}
