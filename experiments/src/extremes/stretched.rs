//! Stretched maps: independent photons of uniform density whose map one distant photon makes so long that stored
//! positions lie on planes as far apart as gathers are wide. What an estimate then reads is predicted exactly.
//!
//! The photons fill a cube from the origin; the distant one is at x = -1.5 u, u = 2^24 times the wanted distance of
//! the planes. The cube is then at 0.75 u from the middle of the map, where single precision has that spacing.

use super::lattice::kernel_on_lattice;
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::Size;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Kernel};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{Photon, PhotonMap};
use turbid_analytic::nearest::nearest_expectation;

/// Powers of two of the distance between planes; the last is far below any radius.
pub const POWERS: [i32; 4] = [-1, -2, -5, -20];
/// Side of the cube of photons.
const SIDE: f64 = 6.0;
/// Radii of fixed gathers.
const RADII: [f64; 5] = [0.15, 0.25, 0.4, 0.6, 1.0];
/// Sizes of nearest gathers.
const NEIGHBORS: [usize; 2] = [10, 50];
/// Farthest photon of a nearest gather: over a thousand photons are nearer.
const CAP: f64 = 1.2;
/// Probes along one side of their lattice.
const PROBES: u32 = 6;
/// What single precision does besides, at most: sums are good to 2 parts in a million, distances to a quarter of one.
/// The photons' first storage, in a map of the cube alone, has planes 2^-21 apart: nothing beside the coarser ones, and
/// the same fine ones where they are finest.
const ROUNDING: f64 = 3e-6;

/// One question to a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Power of two of the distance between planes.
    pub power: i32,
    /// Gather.
    pub size: Size,
    /// Kernel.
    pub kernel: Kernel,
}

impl Case {
    /// Everything that maps of one spacing are asked.
    pub fn all(power: i32) -> Vec<Case> {
        let mut cases = Vec::new();
        for (index, radius) in RADII.into_iter().enumerate() {
            for kernel in Kernel::ALL {
                if index % 2 == 1 || matches!(kernel, Kernel::Uniform | Kernel::Epanechnikov) {
                    cases.push(Case { power, size: Size::Radius(radius), kernel });
                }
            }
        }
        for k in NEIGHBORS {
            for kernel in [Kernel::Uniform, Kernel::Epanechnikov] {
                cases.push(Case { power, size: Size::Nearest(k), kernel });
            }
        }
        cases
    }

    /// Distance between planes.
    pub fn spacing(&self) -> f64 {
        libm::ldexp(1.0, self.power)
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        format!("planes 2^{} apart, {} {}", self.power, self.size.name(), self.kernel.name())
    }

    fn estimator(&self) -> turbid::Result<Estimator> {
        Ok(Estimator::new(self.kernel, self.size.gather(CAP)?))
    }

    /// Error of the estimate over the density, and a bound on its own error.
    pub fn predicted(&self, settings: &Settings) -> anyhow::Result<(f64, f64)> {
        let h = self.spacing();
        match self.size {
            Size::Radius(r) => {
                let (value, error) = kernel_on_lattice(self.kernel, h / r)?;
                Ok((value - 1.0, error + ROUNDING))
            }
            Size::Nearest(k) => {
                let density = photons(settings) as f64 / (SIDE * SIDE * SIDE);
                nearest_on_lattice(self.kernel, k, CAP, density, h)
            }
        }
    }
}

/// Error of a nearest estimate on planes `h` apart in a uniform field of `density` photons per volume.
pub fn nearest_on_lattice(
    kernel: Kernel,
    k: usize,
    cap: f64,
    density: f64,
    h: f64,
) -> anyhow::Result<(f64, f64)> {
    let mean = |kernel, r: f64| kernel_on_lattice(kernel, h / r).map_or(f64::NAN, |(value, _)| value);
    let number = |r: f64| density * 4.0 / 3.0 * PI * r * r * r * mean(Kernel::Uniform, r);
    let value = nearest_expectation(u32::try_from(k)?, cap, number, |r| mean(kernel, r))?;
    Ok((value.value - 1.0, value.error + ROUNDING))
}

/// Expected photons of a map: the same in both presets, since gathers and planes are fixed lengths.
fn photons(settings: &Settings) -> u64 {
    settings.photons(26_000, 26_000)
}

/// The group of cells of a spacing.
pub fn group(power: i32) -> String {
    format!("stretched-{}", -power)
}

/// The maps.
pub fn groups(settings: &Settings) -> impl Iterator<Item = Group> {
    let (maps, cost) = (settings.pick(64, 256), photons(settings) as f64 * 10.0);
    POWERS.into_iter().map(move |power| {
        Group::new(group(power), maps, cost, move |settings, cell| measure(settings, cell, power))
    })
}

/// Measures one map.
fn measure(settings: &Settings, cell: &CellId, power: i32) -> anyhow::Result<CellOutput> {
    let synthetic = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::splat(SIDE))?;
    let map = synthetic.map(Number::Expected(photons(settings)), settings.seed, cell.stream("extremes"))?;
    let mut photons: Vec<Photon> = map.tree().photons().collect();
    let far = DVec3::new(-libm::ldexp(1.5, power + 24), 0.5 * SIDE, 0.5 * SIDE);
    if let Some(&first) = photons.first() {
        photons.push(Photon { position: far, ..first });
    }
    let mut output = CellOutput::new();
    output.count("synthetic photons", photons.len() as u64);
    let map = PhotonMap::new(photons, map.emitted())?;
    let exact = synthetic.density(DVec3::splat(0.5 * SIDE));
    for case in Case::all(power) {
        let estimator = case.estimator()?;
        // A gather and the two roundings stay in the cube.
        let margin = estimator.gather.cap() + case.spacing();
        let step = (SIDE - 2.0 * margin) / f64::from(PROBES);
        let place = |i: u32| margin + (f64::from(i) + 0.5) * step;
        let mut sum = 0.0;
        for i in 0..PROBES * PROBES * PROBES {
            let probe =
                DVec3::new(place(i % PROBES), place(i / PROBES % PROBES), place(i / (PROBES * PROBES)));
            sum += estimator.collision_density(&map, probe, &Boundary::UNKNOWN).value[0];
        }
        let count = PROBES * PROBES * PROBES;
        output.count("estimates", u64::from(count));
        output.push(case.name(), "error", sum / f64::from(count) / exact - 1.0);
    }
    Ok(output)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planes far apart against the radius leave a disc: k nearest in a plane, whose number grows as r^2.
    #[test]
    fn nearest_estimates_on_fine_and_coarse_planes() {
        let error = |h: f64| nearest_on_lattice(Kernel::Uniform, 50, CAP, 120.0, h).unwrap().0;
        assert!(error(1e-6).abs() < 1e-6);
        assert!(error(1.0 / 64.0).abs() < 1e-3);
        // One plane only: n h pi r^2 photons. (k-1)/(n V(r_k)) over E(1/r_k^3) of a gamma variable s = n h pi r^2.
        let (n, h, k) = (120.0, 4.0, 50.0);
        let mean = libm::exp(libm::lgamma(k - 1.5) - libm::lgamma(k)) * libm::pow(n * h * PI, 1.5);
        let one_plane = (k - 1.0) / (n * 4.0 / 3.0 * PI) * mean;
        assert!((1.0 + error(h) - one_plane).abs() < 1e-6 * one_plane, "{} {one_plane}", error(h));
    }
}
