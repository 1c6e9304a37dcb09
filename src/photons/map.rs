//! A photon map: the photons that one pass stored, and how many that pass emitted.

use super::{Photon, PhotonTree};
use crate::error::{Error, Result};
use crate::transport::{NoProgress, Progress};

/// Stored photons and the number **emitted** by the pass that stored them: estimates divide by that number,
/// never by the number stored. It holds no estimator.
#[derive(Debug)]
pub struct PhotonMap {
    tree: PhotonTree,
    emitted: u64,
}

impl PhotonMap {
    /// The map of one pass, its tree built by the calling thread.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `emitted` is zero, and those of [`PhotonTree::new`].
    pub fn new(photons: Vec<Photon>, emitted: u64) -> Result<Self> {
        check_emitted(emitted)?;
        Ok(PhotonMap { tree: PhotonTree::new(photons)?, emitted })
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
        check_emitted(emitted)?;
        Ok(PhotonMap { tree: PhotonTree::new_watched(photons, progress)?, emitted })
    }

    /// The same of photons in parts, as a pass stores them, which are not brought together first.
    ///
    /// # Errors
    /// As [`PhotonMap::new`].
    pub fn of_parts(parts: Vec<Vec<Photon>>, emitted: u64, progress: &dyn Progress) -> Result<Self> {
        check_emitted(emitted)?;
        Ok(PhotonMap { tree: PhotonTree::of_parts(parts, progress)?, emitted })
    }

    /// The photons.
    pub fn tree(&self) -> &PhotonTree {
        &self.tree
    }

    /// Number of photons that the pass sent out.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// Number of photons that the pass stored.
    pub fn stored(&self) -> usize {
        self.tree.len()
    }
}

fn check_emitted(emitted: u64) -> Result<()> {
    if emitted == 0 {
        return Err(Error::out_of_range("the number of emitted photons", 0.0, "at least 1"));
    }
    Ok(())
}
