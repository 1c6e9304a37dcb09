//! The periodic cell: a rectangle of an unbounded slab that stands for all of it.
//!
//! Photons start uniformly on the cell [0, X) x [0, Y) of the lit face, and their positions are taken modulo X and Y;
//! directions are untouched. Where the slab is the same everywhere, or the same again after X and Y, this is exactly the
//! slab under uniform irradiance.

use super::Photon;
use glam::{DVec2, DVec3};

/// The position modulo the cell's sides in x and y, in [0, side).
pub fn wrap(p: DVec3, side: DVec2) -> DVec3 {
    let wrapped = |x: f64, side: f64| {
        let rest = x - side * (x / side).floor();
        // A tiny negative x rounds to the side itself.
        if rest < side { rest } else { 0.0 }
    };
    DVec3::new(wrapped(p.x, side.x), wrapped(p.y, side.y), p.z)
}

/// Appends copies of the photons within `margin` of the cell's edges on the other side, so that a ball of radius
/// `margin` about any point of the cell meets what it would meet in the unbounded slab; `margin` is at most the shorter side.
pub fn surround(photons: &mut Vec<Photon>, side: DVec2, margin: f64) {
    for axis in 0..2 {
        let side = side[axis];
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
