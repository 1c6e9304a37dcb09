//! The cases: who asks, and which radii, levels and numbers of photons the sums have.

use crate::harness::Settings;
use crate::setups::CELL;
use crate::setups::uncollided::{DEPTH, Query};
use glam::DVec3;
use turbid::math::Ray;

/// Who asks: c = 3, 2, 1.
pub const QUERIES: [Query; 3] = [Query::Places, Query::Rays, Query::Beams];
/// The first radius of all sums [mfp]. Each level halves it.
pub const FIRST: f64 = 0.8;
/// The most levels of a sum that is stopped.
pub const STOPS: u32 = 4;
/// Levels of the sum whose mean is judged.
pub const MEAN_LEVELS: u32 = 2;
/// Cells a group.
pub const CELLS: u64 = 128;
/// Places along one side of the lattice: two radii of the smallest balls of a stopped sum apart, and more.
const SIDE: usize = 20;
/// Rays, by the same rule.
const RAYS: usize = 20;

/// The radius behind so many levels.
pub fn radius(levels: u32) -> f64 {
    FIRST * libm::exp2(-f64::from(levels))
}

/// Photons of a plain estimate, and of a sum that is stopped.
pub fn photons(settings: &Settings) -> u64 {
    settings.photons(2_000, 8_000)
}

/// Plain estimates and sums of one cell.
pub const BATCH: u64 = 4;

/// Photons of a sum that is drawn at random, on average, and of the plain estimate beside it.
pub fn work(settings: &Settings) -> u64 {
    settings.photons(16_000, 64_000)
}

/// Differences of one number of photons: how many levels, and how many photons. The last balls, discs and strips hold a photon seldom.
pub fn constant(query: Query) -> (u32, u64) {
    match query {
        Query::Places | Query::BeamsAtPlaces | Query::Marched => (5, 1000),
        Query::Rays => (6, 100),
        Query::Beams => (8, 100),
    }
}

/// Passes of such a number in one cell: more photons where fewer of them count.
pub fn passes(settings: &Settings, query: Query) -> u64 {
    let quick = match query {
        Query::Places | Query::BeamsAtPlaces | Query::Marched => 32_000,
        Query::Rays => 16_000,
        Query::Beams => 8_000,
    };
    (settings.photons(quick, 4 * quick) / constant(query).1).max(1)
}

/// How far off an answer is, in units of the plain estimate's root mean square error at its best radius.
pub fn thresholds() -> Vec<f64> {
    (-6..=10).map(|i| libm::exp2(0.5 * f64::from(i))).collect()
}

/// The threshold 1.
pub const ONE: usize = 6;

/// The quantity that is the part of the answers beyond a threshold.
pub fn beyond(threshold: f64) -> String {
    format!("beyond {threshold:.4}")
}

/// Which estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// One radius, behind so many levels.
    Plain(u32),
    /// The radius that theory finds best.
    Best,
    /// The sum of so many levels, photons shared out between them.
    Stopped(u32),
    /// The first radius of a sum alone: its levels are switched off.
    Off,
    /// Levels drawn at random.
    Drawn,
    /// The best radius for as much work.
    Equal,
}

impl Estimator {
    /// Those of one number of photons.
    pub fn of_photons() -> Vec<Estimator> {
        let plain = (0..=STOPS).map(Estimator::Plain);
        let stopped = (1..=STOPS).map(Estimator::Stopped);
        plain.chain([Estimator::Best]).chain(stopped).chain([Estimator::Off]).collect()
    }

    /// The name of a case in tables.
    pub fn name(self, query: Query) -> String {
        let asked = query.name();
        match self {
            Estimator::Plain(levels) => format!("{asked} plain r={}", radius(levels)),
            Estimator::Best => format!("{asked} plain best"),
            Estimator::Stopped(levels) => format!("{asked} stopped levels={levels}"),
            Estimator::Off => format!("{asked} levels off"),
            Estimator::Drawn => format!("{asked} drawn"),
            Estimator::Equal => format!("{asked} plain best, equal work"),
        }
    }
}

/// The name of the case of a difference.
pub fn difference(query: Query, level: u32) -> String {
    format!("{} difference level={level}", query.name())
}

/// The places at the depth.
pub fn places() -> impl Iterator<Item = DVec3> {
    let step = CELL / SIDE as f64;
    (0..SIDE * SIDE).map(move |i| {
        DVec3::new((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5, 0.0) * step + DVec3::Z * DEPTH
    })
}

/// The rays at the depth, once round the cell.
pub fn rays() -> impl Iterator<Item = Ray> {
    (0..RAYS).map(|i| Ray::new(DVec3::new((i as f64 + 0.5) * CELL / RAYS as f64, 0.0, DEPTH), DVec3::Y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_rays_lie_at_the_depth() {
        assert!(places().all(|p| p.z == DEPTH && p.x > 0.0 && p.x < CELL && p.y > 0.0 && p.y < CELL));
        assert!(rays().all(|ray| ray.origin.z == DEPTH));
        assert!(2.0 * radius(STOPS) < CELL / SIDE as f64 && thresholds()[ONE] == 1.0);
    }
}
