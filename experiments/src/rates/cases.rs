//! The cases: how many photons, at which depth, within which radius.

use crate::harness::Settings;
use crate::setups::{CELL, Maps, Setup};
use glam::DVec3;

/// Optical thickness of the slab, which only absorbs.
pub const TAU: f64 = 4.0;
/// The slab under a normal beam.
pub const SETUP: Setup = Setup::slab(TAU, 0.0, 0.0);
/// Depth at which whole balls lie in the medium [mfp].
pub const INSIDE: f64 = 1.0;
/// The lit face.
pub const FACE: f64 = 0.0;
/// Depths of the probes [mfp].
pub const DEPTHS: [f64; 2] = [INSIDE, FACE];
/// Number of radii: from 0.08 to 0.905 mean free paths, six to a doubling. The best of them is within 6 % of the best
/// there is, which is worth 2 % of the error.
const RADII: usize = 22;
/// Place of the fixed radius at which noise rules, 0.45 mean free paths, and of the largest, at which the blur does.
pub const NOISY: usize = 15;
/// See [`NOISY`].
pub const BLURRED: usize = RADII - 1;
/// Probes along one side of the lattice.
const SIDE: usize = 5;

/// The ladder, from few photons to many.
pub fn sizes(settings: &Settings) -> Vec<Maps> {
    Maps::ladder(settings, 100_000, 400_000)
}

/// Cells a size.
pub fn cells(settings: &Settings) -> u64 {
    settings.pick(256, 512)
}

/// The radii [mfp], from the smallest.
pub fn radii() -> Vec<f64> {
    (0..RADII).map(|i| 0.08 * libm::exp2(i as f64 / 6.0)).collect()
}

/// The name of a case in tables.
pub fn name(photons: u64, depth: f64, radius: f64) -> String {
    format!("n={photons} t={depth} r={radius:.4}")
}

/// The probes at a depth: the largest balls about them stay within the cell.
pub fn probes(depth: f64) -> impl Iterator<Item = DVec3> {
    let margin = 0.91;
    let place = move |i: usize| margin + (CELL - 2.0 * margin) * i as f64 / (SIDE - 1) as f64;
    (0..SIDE * SIDE).map(move |i| DVec3::new(place(i % SIDE), place(i / SIDE), depth))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_stay_within_the_cell_and_inside_the_slab() {
        let largest = radii()[BLURRED];
        assert!(largest <= INSIDE && (radii()[NOISY] - 0.4525).abs() < 1e-3);
        let mut all = probes(INSIDE);
        assert!(all.all(|p| p.min_element() >= largest && p.x <= CELL - largest && p.y <= CELL - largest));
    }

    #[test]
    fn the_ladder_spans_a_decade_and_a_half() {
        let sizes = sizes(&Settings::new("unused"));
        let ends = (sizes[0].photons as f64, sizes[sizes.len() - 1].photons as f64);
        assert!(libm::log10(ends.1 / ends.0) > 1.5);
    }
}
