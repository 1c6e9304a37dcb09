//! What the columns `class` and `emitted` may hold.

use crate::photons::Photon;
use glam::Vec3;

/// Added to the class of a photon that lies on a surface.
pub const ON_SURFACE: u8 = 8;

/// Photons that were sent out, at most: above, not every whole number is an f64.
pub const MOST_EMITTED: f64 = 9e15;

/// The column `class` of a photon.
pub fn class(photon: &Photon) -> u8 {
    photon.flags.bits() + if photon.normal == Vec3::ZERO { 0 } else { ON_SURFACE }
}
