//! A photon map: the photons that one pass stored, and how many that pass emitted.

use super::{Photon, PhotonTree};
use crate::error::{Error, Result};
use crate::transport::{NoProgress, Progress};
use glam::DVec3;

/// Stored photons and the number **emitted** by the pass that stored them: estimates divide by that number,
/// never by the number stored. It holds no estimator.
#[derive(Debug)]
pub struct PhotonMap {
    tree: PhotonTree,
    emitted: u64,
    run: u64,
}

impl PhotonMap {
    /// The map of one pass, its tree built by the calling thread.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `emitted` is zero, and those of [`PhotonTree::new`].
    pub fn new(photons: Vec<Photon>, emitted: u64) -> Result<Self> {
        Self::of(PhotonTree::new(photons), emitted)
    }

    /// The same map, bit for bit, built by the threads of the current pool.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn new_parallel(photons: Vec<Photon>, emitted: u64) -> Result<Self> {
        Self::new_watched(photons, emitted, &NoProgress)
    }

    /// The same, and `progress` is told of every photon that is in its place.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn new_watched(photons: Vec<Photon>, emitted: u64, progress: &dyn Progress) -> Result<Self> {
        Self::of(PhotonTree::new_watched(photons, progress), emitted)
    }

    /// The same of photons in parts, as a pass stores them, which are not brought together first.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn of_parts(parts: Vec<Vec<Photon>>, emitted: u64, progress: &dyn Progress) -> Result<Self> {
        Self::of(PhotonTree::of_parts(parts, progress), emitted)
    }

    fn of(tree: Result<PhotonTree>, emitted: u64) -> Result<Self> {
        if emitted == 0 {
            return Err(Error::out_of_range("the number of emitted photons", 0.0, "at least 1"));
        }
        let tree = tree?;
        // Other photons, other numbers.
        let first = if tree.is_empty() { DVec3::ZERO } else { tree.position(0) };
        let run = first.to_array().into_iter().fold(emitted, |mix, x| mix.rotate_left(21) ^ x.to_bits());
        Ok(PhotonMap { tree, emitted, run })
    }

    /// The same map as one of a run, whole or in parts: in all of them estimates choose alike what they choose at random.
    pub fn of_run(self, seed: u64, replicate: u64) -> Self {
        PhotonMap { run: seed.rotate_left(32) ^ replicate, ..self }
    }

    /// The photons.
    pub fn tree(&self) -> &PhotonTree {
        &self.tree
    }

    /// Number of photons that the pass sent out.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// What random choices of estimates depend on beside their place: another number for other photons, the same for all parts
    /// of a run.
    pub fn run(&self) -> u64 {
        self.run
    }

    /// Number of photons that the pass stored.
    pub fn stored(&self) -> usize {
        self.tree.len()
    }
}
