//! The surfaces about a point: faces of its medium, walls, bodies, other media.

use crate::error::{Error, Result};
use crate::geometry::Shape;

/// The boundaries about a point that an estimate is told of.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<'a> {
    /// The shape of the medium; none where it is not known, and its own faces are left untreated.
    pub(in crate::estimators) medium: Option<&'a Shape>,
    pub(in crate::estimators) walls: &'a [Shape],
    /// Regions in the medium's shape that count instead of it.
    pub(super) later: &'a [Shape],
    /// Surfaces that may part the medium.
    pub(super) bodies: &'a [Shape],
    /// Whether every photon is of this medium.
    pub(in crate::estimators) is_only: bool,
}

impl Boundary<'static> {
    /// None are known.
    pub const UNKNOWN: Self = Boundary { medium: None, walls: &[], later: &[], bodies: &[], is_only: true };
}

impl<'a> Boundary<'a> {
    /// The surface of the medium, or of the part of it that is on the points' side of a wall.
    ///
    /// # Errors
    /// [`Error::Scene`] if `medium` has no inside, as a rectangle.
    pub fn of(medium: &'a Shape) -> Result<Self> {
        if !medium.is_solid() {
            return Err(Error::Scene("a rectangle bounds no medium: name a sphere, slab or cuboid".into()));
        }
        Ok(Boundary { medium: Some(medium), ..Boundary::UNKNOWN })
    }

    /// The same with walls, by which an estimator may reject photons.
    pub fn with_walls(self, walls: &'a [Shape]) -> Self {
        Boundary { walls, ..self }
    }

    /// The same where there is more than the medium: photons that collided elsewhere are rejected, which are those outside
    /// it and those in `later`, regions in its shape that count instead of it. One that holds the point holds the medium
    /// too, and does not count.
    pub fn among(self, later: &'a [Shape]) -> Self {
        Boundary { later, is_only: false, ..self }
    }

    /// The same where these surfaces stand in the medium: photons that they hide from the point are rejected.
    pub fn about(self, bodies: &'a [Shape]) -> Self {
        Boundary { bodies, ..self }
    }

    /// Whether every photon is of the medium and seen, whoever asks.
    pub(in crate::estimators) fn is_clear(&self) -> bool {
        self.is_only && self.later.is_empty() && self.bodies.is_empty()
    }

    /// The medium's own faces and the walls alone.
    pub(in crate::estimators) fn alone(self) -> Self {
        Boundary { later: &[], bodies: &[], is_only: true, ..self }
    }
}
