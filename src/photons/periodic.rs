//! The periodic cell: a square of an unbounded slab that stands for all of it.
//!
//! Photons start uniformly on the cell [0, W) x [0, W) of the lit face, and their positions are taken modulo W;
//! directions are untouched. By translation invariance this is exactly the slab under uniform irradiance.

use super::Photon;
use glam::DVec3;

/// The position modulo the cell's side in x and y, in [0, side).
pub fn wrap(p: DVec3, side: f64) -> DVec3 {
    let wrapped = |x: f64| {
        let rest = x - side * (x / side).floor();
        // A tiny negative x rounds to the side itself.
        if rest < side { rest } else { 0.0 }
    };
    DVec3::new(wrapped(p.x), wrapped(p.y), p.z)
}

/// Appends copies of the photons within `margin` of the cell's edges on the other side, so that a ball of radius
/// `margin` about any point of the cell meets what it would meet in the unbounded slab; `margin` is at most the side.
pub fn surround(photons: &mut Vec<Photon>, side: f64, margin: f64) {
    for axis in 0..2 {
        for index in 0..photons.len() {
            let photon = photons[index];
            let x = photon.position[axis];
            for (is_near, shift) in [(x <= margin, side), (x >= side - margin, -side)] {
                if is_near {
                    let mut copy = photon;
                    copy.position[axis] = x + shift;
                    photons.push(copy);
                }
            }
        }
    }
}
