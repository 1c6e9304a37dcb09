//! Who asks which photons.

use super::field::{MU0, SINE};
use turbid_analytic::beams::Pairing;

/// Who asks which photons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Query {
    /// A place, points: balls.
    Places,
    /// A place, the flights that pass it.
    BeamsAtPlaces,
    /// A ray, points, in balls step by step.
    Marched,
    /// A ray, points about the whole of it.
    Rays,
    /// A ray, the flights that pass it.
    Beams,
}

impl Query {
    /// All, the most dispersed first.
    pub const ALL: [Query; 5] =
        [Query::Places, Query::BeamsAtPlaces, Query::Marched, Query::Rays, Query::Beams];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Query::Places => "places",
            Query::BeamsAtPlaces => "beams-at-places",
            Query::Marched => "marched",
            Query::Rays => "rays",
            Query::Beams => "beams",
        }
    }

    /// Its title in figures and tables.
    pub fn title(self) -> &'static str {
        match self {
            Query::Places => "points at a place",
            Query::BeamsAtPlaces => "beams at a place",
            Query::Marched => "points in balls along a ray",
            Query::Rays => "points along a ray",
            Query::Beams => "beams along a ray",
        }
    }

    /// What blurs as it does.
    pub fn blurs_as(self) -> Pairing {
        match self {
            Query::Places | Query::Marched => Pairing::PointPoints,
            Query::Rays => Pairing::RayPoints,
            Query::BeamsAtPlaces => Pairing::PointBeams,
            Query::Beams => Pairing::RayBeams { sine: 1.0 },
        }
    }

    /// How fast the field falls, as an exponential, where the blur is [1/mfp]: along its gradient, or, of beams, across them, where it
    /// leans on it.
    pub fn slope(self) -> f64 {
        match self {
            Query::Places | Query::Marched | Query::Rays => 1.0 / MU0,
            Query::BeamsAtPlaces | Query::Beams => SINE / MU0,
        }
    }

    /// Exponent c of the radius in the variance.
    pub fn codimension(self) -> f64 {
        match self {
            Query::Places => 3.0,
            Query::BeamsAtPlaces | Query::Marched | Query::Rays => 2.0,
            Query::Beams => 1.0,
        }
    }

    /// Whether a ray asks.
    pub fn is_ray(self) -> bool {
        !matches!(self, Query::Places | Query::BeamsAtPlaces)
    }

    /// Whether flights are asked.
    pub fn is_of_beams(self) -> bool {
        matches!(self, Query::BeamsAtPlaces | Query::Beams)
    }
}
