//! The isotropically scattering slab, order by order: reflectance, transmittance, absorptance, fluence.
//!
//! Order by order is what catches path lengths counted differently by paths and photons, direct light counted twice and
//! albedos applied twice or not at all: in the sum they may hide behind each other.

use crate::checks::slab as checks;
use crate::checks::slab::{exact, layer_mean, layer_means, referee};
use crate::support::run::{pass, paths};
use crate::support::scenes::{Incidence, at_depth, reflectance, slab, transmittance};
use crate::support::verdict;
use turbid::photons::is_indirect;
use turbid::scene::{Orders, Quantity};

/// Paths a quantity and order: a bias of 0.03 of the irradiance is detected in every flux, of 0.12 in every fluence.
const PATHS: u64 = 80_000;
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

#[test]
fn single_scattering_is_the_closed_form() {
    checks::single_scattering_is_the_closed_form();
}

#[test]
fn the_map_and_direct_light_add_up() {
    checks::the_map_and_direct_light_add_up(is_indirect);
}

#[test]
fn stored_power_over_extinction_is_the_fluence() {
    checks::stored_power_over_extinction_is_the_fluence(1.0);
}

#[test]
fn collisions_are_the_integral_of_the_fluence() {
    checks::collisions_are_the_integral_of_the_fluence(checks::by_histories);
}

#[test]
fn counts_of_uncollided_photons_vary_as_poisson() {
    checks::counts_vary_as_poisson(Orders::only(0));
}

#[test]
fn a_region_in_two_pieces_is_one() {
    checks::a_region_in_two_pieces_is_one();
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

/// Mean fluence of each layer and order from the photons that collide there: power over sigma_t and volume. No
/// kernel, hence no blur: what is stored is tested alone.
#[test]
fn fluence_of_photons_by_order_and_layer() {
    const ALL: usize = HIGHEST as usize + 1;
    for (tau, albedo, how) in CASES {
        let exact_slab = referee(tau, albedo, how);
        let scene = slab(tau, albedo, 0.0, how);
        let measured = layer_means::<{ ALL + 1 }>(&scene, tau, 6, |photon, add| {
            if u32::from(photon.order) <= HIGHEST {
                add(usize::from(photon.order), f64::from(photon.power.x));
            }
            add(ALL, f64::from(photon.power.x));
        });
        for (i, per_layer) in measured.iter().enumerate() {
            let n = i as u32;
            let phi = |t: f64| {
                let value =
                    if n <= HIGHEST { exact_slab.fluence_of_order(n, t) } else { exact_slab.fluence(t) };
                value.unwrap().value
            };
            for (index, moments) in per_layer.iter().enumerate() {
                let mean = layer_mean(tau, index, phi);
                let what = format!("phi{n}, layer {index}, tau {tau}, albedo {albedo}, {how:?}");
                // The quadrature is good to 1e-8 here; f32 powers to 6e-8.
                verdict::agrees(&what, moments, (mean, 1e-7 * mean), 0.1, 6);
            }
        }
    }
}
