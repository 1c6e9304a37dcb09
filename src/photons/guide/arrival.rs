//! What is learned from a photon.

use crate::photons::Photon;
use glam::{DVec3, Vec3};

/// Parts of the photons, by their histories, that know nothing of each other.
pub(super) const PARTS: u64 = 3;

/// What is learned from a photon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    pub position: DVec3,
    /// Unit direction towards where it came from.
    pub from: Vec3,
    /// Unit normal of the surface; 0 in a medium.
    pub normal: Vec3,
    /// Power of all channels together, but for a factor that all photons share.
    pub power: f32,
    /// Which part of the photons it belongs to.
    pub part: usize,
}

impl Arrival {
    pub fn new(photon: &Photon, part: usize) -> Self {
        Arrival {
            position: photon.position,
            from: -photon.dir,
            normal: photon.normal,
            power: photon.power.element_sum(),
            part,
        }
    }
}
