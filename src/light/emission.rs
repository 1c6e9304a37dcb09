//! What lights send: photons, and light towards a point.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Slab;
use crate::math::Ray;
use glam::{DVec2, DVec3};

/// What unbounded lights need to start photons: the one slab of the scene and the sides of its cell \[L\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicCell {
    /// The layer.
    pub slab: Slab,
    /// Sides of the cell [0, side.x) x [0, side.y) that stands for the whole layer \[L\].
    pub side: DVec2,
}

impl PeriodicCell {
    /// Sides of the cell \[L\]; 0 where there is none.
    pub fn side(periodic_cell: Option<&PeriodicCell>) -> DVec2 {
        periodic_cell.map_or(DVec2::ZERO, |s| s.side)
    }
}

/// A photon on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emission {
    /// Where it starts and where to.
    pub ray: Ray,
    /// The part of the light's body that it starts on; 0 without parts.
    pub primitive: u32,
    /// Power \[W\], as though it were the only one.
    pub power: Spectrum,
    /// Chance that it leaves at all; 1 but for media.
    pub chance: f64,
}

/// A direction towards a light, with its contribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit direction from the point towards the light.
    pub dir: DVec3,
    /// How far the light is \[L\], where it begins if it fills a volume; infinite for an unbounded beam and the sun.
    pub distance: f64,
    /// Radiance over density, or irradiance for a delta light [W/L^2]; of a volume source what would come through nothing.
    pub value: Spectrum,
    /// Density of the direction [1/sr], or none for a delta light.
    pub pdf_solid_angle: Option<f64>,
}

/// A radiance, irradiance or power whose channels are finite, not negative and not all 0.
pub(super) fn emissive(name: &'static str, value: Spectrum) -> Result<Spectrum> {
    match (0..3).map(|c| value[c]).find(|v| !(*v >= 0.0 && v.is_finite())) {
        Some(bad) => Err(Error::out_of_range(name, bad, "finite and at least 0")),
        None if value.is_black() => Err(Error::out_of_range(name, 0.0, "above 0 in at least one channel")),
        None => Ok(value),
    }
}
