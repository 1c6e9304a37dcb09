//! Estimates near a boundary: what they do where the medium ends inside the ball, and about photons behind a wall.
//!
//! With K_r the kernel of the ball about x, O the medium, z = (y - x) . n / r the depth along the inward normal n of the
//! nearest boundary point, S_j = sum p K_r z^j over the gathered photons and M_j = int_O K_r z^j:
//!
//! | treatment | estimate | in a uniform field f |
//! |---|---|---|
//! | none | S_0 | f M_0 |
//! | clipped | S_0 / M_0 | f |
//! | reflection | sum p (K_r + K_r of the photon's images) | f between flat faces |
//! | local linear | (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2) | f |
//!
//! All four are the plain estimate where the ball is whole. The radius of a k-nearest gather is set by real, accepted photons
//! alone: an image, or a rejected photon, sets none.
//!
//! Where bodies stand in the medium, and other media beside it, all treatments but none reject photons that bodies hide from x
//! and those of the other media, and divide S_0 by the part of the kernel that x sees: f again in any geometry. Closed forms
//! stay where only the medium's own faces are in the ball.

mod accepted;
mod images;
mod moments;
mod rejection;
mod solid;
mod treatment;
mod visible;

pub use moments::body_moments;
pub use rejection::Rejection;
pub use treatment::Treatment;

pub(super) use accepted::accepted;
pub(super) use rejection::Sieve;
pub(super) use treatment::Gathered;
pub(super) use visible::Surroundings;

use crate::error::{Error, Result};
use crate::geometry::Shape;

/// The boundaries about a point that an estimate is told of.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<'a> {
    /// The shape of the medium; none where it is not known, and its own faces are left untreated.
    pub(super) medium: Option<&'a Shape>,
    pub(super) walls: &'a [Shape],
    /// Regions in the medium's shape that count instead of it.
    later: &'a [Shape],
    /// Surfaces that may part the medium.
    bodies: &'a [Shape],
    /// Whether every photon is of this medium.
    is_only: bool,
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

    /// The medium's own faces and the walls alone.
    pub(super) fn alone(self) -> Self {
        Boundary { later: &[], bodies: &[], is_only: true, ..self }
    }
}
