//! Refraction: radiance over the squared index, and power, are what a boundary keeps.

use crate::support::run::{pass, paths, tallies};
use crate::support::scenes::{Incidence, around, fresnel_slab, refracting_cavity};
use crate::support::verdict;
use glam::DVec3;
use turbid::geometry::Face;
use turbid::math::FOUR_PI;
use turbid::scene::{Orders, Quantity};
use turbid::stats::Moments;
use turbid_analytic::FresnelSlab;

/// Isotropic light outside is isotropic light inside, n^2 times as bright: a point in a ball under irradiance 1 has the
/// fluence 4 n^2, and each path says so by itself, since nothing is absorbed.
pub fn a_cavity_is_brighter_by_the_squared_index() {
    for (index, sigma_t, g) in [(1.5, 0.5, 0.0), (1.33, 2.0, 0.75), (2.4, 0.1, -0.5), (1.0, 1.0, 0.0)] {
        let scene = refracting_cavity(index, sigma_t, g);
        for p in [DVec3::new(0.1, -0.05, 0.2), DVec3::new(0.7, 0.5, -0.4)] {
            let moments = paths(&scene, Quantity::Fluence(p), Orders::ALL, 500, 5)[0];
            let expected = 4.0 * index * index;
            let off = (moments.mean() - expected).abs().max(moments.std_error());
            assert!(off < 1e-12 * expected, "n {index}: {} for {expected}", moments.mean());
        }
        let outside = paths(&scene, Quantity::Fluence(DVec3::new(0.0, 1.2, 0.3)), Orders::ALL, 500, 6)[0];
        assert!((outside.mean() - 4.0).abs() < 1e-12, "{}", outside.mean());
    }
}

/// The same by photons: they arrive in the ball with sigma_t x fluence x volume, of as much power as was sent.
pub fn photons_in_a_cavity_collide_as_its_fluence() {
    let (index, sigma_t) = (1.5, 0.5);
    let scene = refracting_cavity(index, sigma_t, 0.3);
    // In a ball of 80 per cent of the radius: it is the field that is right, not the sum alone.
    let inner = 0.8f64;
    let mut moments = Moments::new();
    for seed in 0..64 {
        let pass = pass(&scene, &[], 1 << 11, seed, |photon| photon.position.length() < inner);
        let power: f64 = pass.photons().map(|photon| f64::from(photon.power.x)).sum();
        moments.push(power / pass.emitted() as f64);
    }
    let volume = FOUR_PI / 3.0 * inner.powi(3);
    let expected = sigma_t * 4.0 * index * index * volume;
    verdict::agrees("collisions in the ball", &moments, (expected, 0.0), 0.15 * expected, 0);
}

/// Reflectance and transmittance of a refracting slab by photons, against discrete ordinates.
pub fn photons_cross_a_refracting_slab() {
    let cases = [
        (1.0, 0.9, 0.0, 1.5, Incidence::Beam(1.0)),
        (0.5, 0.5, 0.75, 1.33, Incidence::Beam(0.5)),
        (2.0, 1.0, -0.5, 1.5, Incidence::Diffuse),
        (1.0, 0.0, 0.0, 1.5, Incidence::Beam(0.2)),
    ];
    for (tau, albedo, g, index, how) in cases {
        let exact = referee(tau, albedo, g, index, how);
        let scene = fresnel_slab(tau, albedo, g, index, how);
        let [r, t] = faces(tau).map(|q| (q, Orders::ALL));
        let measured = tallies(&scene, &[r, t, (Quantity::Absorbed(0), Orders::ALL)], 1 << 17, 3);
        let what = format!("tau {tau}, albedo {albedo}, g {g}, n {index}, {how:?}");
        let values = [exact.reflectance(), exact.transmittance(), exact.absorptance()];
        for ((name, m), value) in ["R", "T", "A"].iter().zip(&measured).zip(values) {
            if value.value > 0.0 && value.value < 1.0 {
                verdict::agrees(&format!("{name}, {what}"), &m[0], (value.value, value.error), 0.015, 3);
            }
        }
    }
}

/// Light that leaves through the faces of the layer around a refracting slab.
pub fn faces(tau: f64) -> [Quantity; 2] {
    [Face::Top, Face::Bottom].map(|face| Quantity::Outflow { shape: around(tau), face })
}

/// The exact slab.
pub fn referee(tau: f64, albedo: f64, g: f64, index: f64, how: Incidence) -> FresnelSlab {
    let incidence = match how {
        Incidence::Beam(mu0) => turbid_analytic::Incidence::Beam { mu0 },
        Incidence::Diffuse | Incidence::Both => turbid_analytic::Incidence::Diffuse,
    };
    FresnelSlab::new(tau, albedo, g, index, incidence).unwrap()
}
