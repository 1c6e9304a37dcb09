//! Heterogeneous media: where a grid's samples are, and what passes by channel.

use crate::support::run::histories;
use crate::support::scenes::{bounded, cuboid, volume_source};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{Ray, exp};
use turbid::medium::{Density, Grid, Heterogeneous, Homogeneous, Medium};
use turbid::phase::{Isotropic, Phase};
use turbid::scene::{Region, SURROUNDINGS, Scene};
use turbid::transport::{Flight, free_flight, transmittance};

/// A medium of extinction `sigma_t` where the density is 1.
pub fn varying(sigma_t: Spectrum, albedo: f64, density: Density) -> Medium {
    let matter = Homogeneous::new(sigma_t, Spectrum::grey(albedo), Phase::Isotropic(Isotropic)).unwrap();
    Heterogeneous::new(matter, density).into()
}

/// A density of layers along z, in the box of both corners.
pub fn layered((min, max): (DVec3, DVec3), count: usize, f: impl Fn(f64) -> f64) -> Density {
    Density::grid(Grid::sampled((min, max), [1, 1, count], |p| f(p.z)).unwrap()).unwrap()
}

/// Samples lie in the middles of cells, with lines between them and constants outside.
pub fn samples_lie_in_the_middles_of_cells() {
    let grid = Grid::new((DVec3::ZERO, DVec3::splat(4.0)), [1, 1, 4], 1, vec![1.0, 3.0, 2.0, 6.0]).unwrap();
    let at = |z: f64| grid.at(DVec3::new(2.0, 1.0, z));
    for (z, value) in [(0.5, 1.0), (1.5, 3.0), (2.5, 2.0), (3.5, 6.0), (1.0, 2.0), (3.25, 5.0)] {
        assert_eq!(at(z), value, "{z}");
    }
    for (z, value) in [(-1.0, 1.0), (0.0, 1.0), (0.4, 1.0), (3.6, 6.0), (9.0, 6.0)] {
        assert_eq!(at(z), value, "{z}");
    }
}

/// A cuboid of height 2 whose density rises, falls and vanishes along z, chromatic, absorbing.
fn slab() -> (Scene, Ray) {
    let corners = (DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0));
    let density = layered(corners, 24, |z| (1.5 - (z - 0.8).abs() * 2.0).max(0.0) * (1.0 + z));
    let medium = varying(Spectrum::rgb(0.3, 1.0, 1.7), 0.0, density);
    let shape = cuboid(corners.0, corners.1);
    let scene =
        bounded(vec![Region { shape: shape.clone(), medium }], Vec::new(), vec![volume_source(shape)]);
    (scene, Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z))
}

/// Flights pass, and ratio tracking estimates, each channel's exponential of its own depth.
pub fn each_channel_passes_as_its_depth_says() {
    const N: u64 = 1 << 17;
    let (scene, ray) = slab();
    let depth = scene.optical_depth(&ray, f64::INFINITY, SURROUNDINGS);
    let weight = Spectrum::rgb(1.0, 0.5, 2.0);
    let flown = histories(N, 5, |stream| {
        match free_flight(&scene, &ray, f64::INFINITY, SURROUNDINGS, weight, false, stream) {
            Flight::Uncollided(weight) => weight,
            Flight::Collision { .. } => Spectrum::ZERO,
        }
    });
    let tracked = histories(N, 6, |stream| transmittance(&scene, &ray, f64::INFINITY, SURROUNDINGS, stream));
    for c in 0..3 {
        let transmitted = exp(-depth[c]);
        verdict::agrees(&format!("flights, channel {c}"), &flown[c], (weight[c] * transmitted, 0.0), 0.05, 5);
        verdict::agrees(&format!("ratio tracking, channel {c}"), &tracked[c], (transmitted, 0.0), 0.05, 6);
    }
}
