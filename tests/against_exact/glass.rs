//! Refraction: the cavity, the slab between refracting faces, nested boundaries.

use crate::checks::glass;
use crate::checks::glass::{faces, referee};
use crate::support::run::paths;
use crate::support::scenes::{Incidence, fresnel_slab};
use crate::support::verdict;
use turbid::scene::Orders;

#[test]
fn a_cavity_is_brighter_by_the_squared_index() {
    glass::a_cavity_is_brighter_by_the_squared_index();
}

#[test]
fn photons_in_a_cavity_collide_as_its_fluence() {
    glass::photons_in_a_cavity_collide_as_its_fluence();
}

#[test]
fn photons_cross_a_refracting_slab() {
    glass::photons_cross_a_refracting_slab();
}

/// Paths find light with an extent only: Lambertian incidence, by radiance that arrives at the faces of the layer around.
#[test]
fn paths_cross_a_refracting_slab() {
    for (tau, albedo, g, index) in [(1.0, 0.9, 0.0, 1.5), (2.0, 1.0, -0.5, 1.33), (0.3, 0.5, 0.75, 2.0)] {
        let exact = referee(tau, albedo, g, index, Incidence::Diffuse);
        let scene = fresnel_slab(tau, albedo, g, index, Incidence::Diffuse);
        let what = format!("tau {tau}, albedo {albedo}, g {g}, n {index}");
        for (name, quantity, value) in [
            ("R", faces(tau)[0].clone(), exact.reflectance()),
            ("T", faces(tau)[1].clone(), exact.transmittance()),
        ] {
            let moments = paths(&scene, quantity, Orders::ALL, 1 << 16, 4)[0];
            verdict::agrees(&format!("{name}, {what}"), &moments, (value.value, value.error), 0.02, 4);
        }
    }
}
