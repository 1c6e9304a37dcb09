//! The periodic cell: a rectangle of an unbounded slab that stands for all of it.
//!
//! Photons start uniformly on the cell [0, X) x [0, Y) of the lit face, and their positions are taken modulo X and Y;
//! directions are untouched. Where the slab is the same everywhere, or the same again after X and Y, this is exactly the
//! slab under uniform irradiance.

use super::Photons;
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// The stretches of a ray in the cells that it runs through, the ray moved into the first cell each time. `span` has an end.
pub fn in_cells(ray: &Ray, span: Interval, side: DVec2) -> impl Iterator<Item = (Ray, Interval)> {
    let (ray, start) = (*ray, ray.at(span.start));
    let mut cell = [0, 1].map(|axis| (start[axis] / side[axis]).floor());
    let mut t = span.start;
    std::iter::from_fn(move || {
        if t >= span.end {
            return None;
        }
        let leaves = [0, 1].map(|axis| {
            let (cell, d) = (cell[axis], ray.dir[axis]);
            let face = (if d > 0.0 { cell + 1.0 } else { cell }) * side[axis];
            if d == 0.0 { f64::INFINITY } else { (face - ray.origin[axis]) / d }
        });
        let axis = usize::from(leaves[1] < leaves[0]);
        let moved = DVec3::new(cell[0] * side.x, cell[1] * side.y, 0.0);
        let end = leaves[axis].min(span.end).max(t);
        let stretch = Interval { start: t, end };
        t = end;
        cell[axis] += ray.dir[axis].signum();
        Some((Ray::new(ray.origin - moved, ray.dir), stretch))
    })
}

/// Appends copies of the photons within `margin` of the cell's edges on the other side, so that a ball of radius
/// `margin` about any point of the cell meets what it would meet in the unbounded slab; `margin` is at most the shorter side.
pub fn surround(photons: &mut Photons, side: DVec2, margin: f64) {
    for axis in 0..2 {
        let side = side[axis];
        for index in 0..photons.len() {
            let photon = photons.get(index);
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
