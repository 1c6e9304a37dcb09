//! Estimates from independent points of known density.

use crate::support::verdict;
use glam::DVec3;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::photons::PhotonMap;
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::stats::Moments;

const SEED: u64 = 41;
const MAPS: u64 = 512;
const PHOTONS: u64 = 4000;
const RADIUS: f64 = 0.12;
const CAP: f64 = 0.2;
/// k of the rules compared.
pub const K: usize = 20;

/// The right rule.
pub fn nearest() -> Gather {
    Gather::nearest(K, CAP).unwrap()
}

/// All k photons summed.
pub fn nearest_biased() -> Gather {
    Gather::nearest_biased(K, CAP).unwrap()
}

/// 27 places whose largest balls neither leave the box nor meet.
fn probes() -> impl Iterator<Item = DVec3> {
    let at = |i: usize| [0.2, 0.5, 0.8][i];
    (0..27).map(move |i| DVec3::new(at(i % 3), at(i / 3 % 3), at(i / 9)))
}

/// One number a map of unit density, of which a share is stored: the mean over the places.
fn means(kept: f64, gather: Gather, factor: fn(&PhotonMap) -> f64) -> Moments {
    let points = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::ONE).unwrap().thinned(kept).unwrap();
    let estimator = Estimator::new(Kernel::Uniform, gather);
    let mean = |replicate| {
        let map = points.map(Number::Exact(PHOTONS), SEED, replicate).unwrap();
        let at = |p: DVec3| estimator.collision_density(&map, p, &Boundary::UNKNOWN).value.mean();
        factor(&map) * probes().map(at).sum::<f64>() / 27.0
    };
    (0..MAPS).map(mean).collect()
}

/// A gather reads a uniform field as it is.
pub fn a_uniform_field_is_read_as_it_is(gather: Gather) {
    let moments = means(1.0, gather, |_| 1.0);
    verdict::agrees(&format!("{gather:?}"), &moments, (1.0, 0.0), 0.03, SEED);
}

/// Nine in ten photons are stored: estimates are nine tenths. `factor` corrects what a map reads.
pub fn a_thinned_field_is_read_as_what_is_left(factor: fn(&PhotonMap) -> f64) {
    let moments = means(0.9, Gather::radius(RADIUS).unwrap(), factor);
    verdict::agrees("thinned", &moments, (0.9, 0.0), 0.02, SEED);
}
