//! The furnace: without absorption, light that comes in isotropically is isotropic everywhere, with fluence 4 per unit
//! of irradiance, whatever the shape, its thickness and the phase function.

use crate::support::run::paths;
use crate::support::scenes::{Incidence, at_depth, bounded, cuboid, isotropic, region, slab, sphere};
use crate::support::verdict;
use glam::DVec3;
use turbid::geometry::Shape;
use turbid::light::Faces;
use turbid::photons::{Histories, shoot};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

const PATHS: u64 = 9000;
const ASYMMETRIES: [f64; 4] = [0.0, 0.95, -0.5, 0.9999];

fn furnace(shape: Shape, g: f64) -> Scene {
    bounded(vec![region(shape.clone(), 2.0, 1.0, g)], Vec::new(), vec![isotropic(shape, Faces::Both)])
}

#[test]
fn fluence_is_four_everywhere() {
    let body = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.3));
    for g in ASYMMETRIES {
        let mut places = Vec::new();
        for p in [DVec3::ZERO, DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.3, -0.2, 0.5)] {
            places.push((furnace(sphere(DVec3::ZERO, 1.0), g), Quantity::Fluence(p)));
        }
        for p in [DVec3::ZERO, DVec3::new(0.5, 2.0, 0.15), DVec3::new(0.5, 1.0, 0.15)] {
            places.push((furnace(body.clone(), g), Quantity::Fluence(p)));
        }
        for t in [0.0, 1.0, 3.0] {
            places.push((slab(3.0, 1.0, g, Incidence::Both), at_depth(t)));
        }
        for (scene, quantity) in places {
            let moments = paths(&scene, quantity.clone(), Orders::ALL, PATHS, 1)[0];
            verdict::agrees(&format!("{quantity:?}, g {g}"), &moments, (4.0, 1e-13), 0.3, 1);
        }
    }
}

/// Photons fill a furnace evenly: power of collisions per volume is 4 sigma_t in each eighth of a box.
#[test]
fn photons_fill_the_furnace_evenly() {
    let edge = DVec3::new(1.0, 2.0, 0.3);
    let scene = furnace(cuboid(DVec3::ZERO, edge), 0.5);
    let mut eighths = [Moments::new(); 8];
    for replicate in 0..64 {
        let histories = Histories { count: 2048, seed: 3, replicate, max_order: None };
        let pass = shoot(&scene, histories, &[], |_| true, &NoProgress).unwrap();
        let mut sums = [0.0; 8];
        for photon in pass.photons() {
            let upper = photon.position.cmpgt(0.5 * edge);
            sums[upper.bitmask() as usize] += f64::from(photon.power.x);
        }
        let volume = edge.element_product() / 8.0;
        for (m, sum) in eighths.iter_mut().zip(sums) {
            m.push(sum / (pass.emitted() as f64 * 2.0 * volume));
        }
    }
    for (i, moments) in eighths.iter().enumerate() {
        verdict::agrees(&format!("eighth {i}"), moments, (4.0, 1e-6), 0.4, 3);
    }
}
