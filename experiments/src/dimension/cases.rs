//! The cases: who asks, how many photons, within which radius.

use crate::harness::Settings;
use crate::setups::uncollided::{DEPTH, Query, places};
use crate::setups::{CELL, Maps};
use glam::DVec3;
use turbid::math::Ray;

/// Number of radii: from 0.1 to 0.8 mean free paths, four to a doubling. The best of them is within 9 % of the best
/// there is, which is worth 2 % of the error.
const RADII: usize = 13;
/// Rays of one map.
const RAYS: usize = 4;
/// Balls along a marched ray: the least radius is two steps.
const STEPS: usize = 80;

/// The ladder, from few photons to many.
pub fn sizes(settings: &Settings) -> Vec<Maps> {
    Maps::ladder(settings, 32_000, 400_000)
}

/// Cells a size: half of them tell the error of the best radius, and a verdict takes 64.
pub const CELLS: u64 = 128;

/// The radii [mfp], from the smallest.
pub fn radii() -> Vec<f64> {
    (0..RADII).map(|i| 0.1 * libm::exp2(i as f64 / 4.0)).collect()
}

/// The name of a case in tables.
pub fn name(query: Query, photons: u64, radius: f64) -> String {
    format!("{} n={photons} r={radius:.4}", query.name())
}

/// The phase of the work that reading at one radius is.
pub fn reading(query: Query, radius: f64) -> String {
    format!("{} r={radius:.4}", query.name())
}

/// The phases of the work before a question: photons shot, a tree made of points, and one of beams.
pub const SHOOTING: &str = "shooting";
/// See [`SHOOTING`].
pub const POINTS: &str = "tree of points";
/// See [`SHOOTING`].
pub const BEAMS: &str = "tree of beams";

/// The rays at the depth, once round the cell.
pub fn rays() -> impl Iterator<Item = Ray> {
    (0..RAYS).map(|i| {
        let x = (i as f64 + 0.5) * CELL / RAYS as f64;
        Ray::new(DVec3::new(x, 0.0, DEPTH), DVec3::Y)
    })
}

/// The middles of the steps of a march.
pub fn middles() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| (i as f64 + 0.5) * CELL / STEPS as f64)
}

/// Questions of each kind that a map is asked.
pub fn questions(query: Query) -> usize {
    if query.is_ray() { RAYS } else { places().len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_stay_within_the_slab_and_above_two_steps() {
        let radii = radii();
        assert!(radii[RADII - 1] < DEPTH && 2.0 * CELL / STEPS as f64 <= radii[0]);
        assert!(rays().all(|ray| ray.origin.z == DEPTH));
    }
}
