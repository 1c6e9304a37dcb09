//! The cases: who asks, how many photons, within which radius.

use crate::harness::Settings;
use crate::setups::{Body, CELL, Maps, asked, region};
use glam::{DVec2, DVec3};
use turbid::Spectrum;
use turbid::light::{Beam, Light, Section};
use turbid::math::{Interval, Ray};
use turbid::scene::{Scene, SceneParts};
use turbid_analytic::beams::Pairing;

/// Optical thickness of the slab.
const TAU: f64 = 4.0;
/// Depth of the places and rays [mfp]: the largest radius ends short of the lit face.
pub const DEPTH: f64 = 1.0;
/// Albedo; light is scattered alike into all directions.
pub const ALBEDO: f64 = 0.9;
/// Cosine of the beam's angle with the normal.
pub const MU0: f64 = 0.6;
/// Its sine. The beam runs across the rays.
pub const SINE: f64 = 0.8;
/// Number of radii: from 0.1 to 0.8 mean free paths, four to a doubling. The best of them is within 9 % of the best
/// there is, which is worth 2 % of the error.
const RADII: usize = 13;
/// Rays of one map.
const RAYS: usize = 4;
/// Places along one side of the lattice.
const SIDE: usize = 5;
/// Balls along a marched ray: the least radius is two steps.
const STEPS: usize = 80;

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

/// The ladder, from few photons to many.
pub fn sizes(settings: &Settings) -> Vec<Maps> {
    Maps::ladder(settings, 32_000, 400_000)
}

/// Cells a size: half of them tell the error of the best radius, and a verdict takes 64.
pub const CELLS: u64 = 128;

/// The slab under a beam aslant, of which the collisions of uncollided light are asked. Its cell is closed along the rays.
pub fn scene() -> anyhow::Result<Scene> {
    let shape = Body::Slab { thickness: TAU }.shape()?;
    let beam = Beam::new(DVec3::new(SINE, 0.0, MU0), Spectrum::ONE, Section::Unbounded)?;
    Ok(asked(Scene::new(SceneParts {
        regions: vec![region(shape, 1.0, ALBEDO, 0.0)?],
        lights: vec![Light::Beam(beam)],
        cell: Some(DVec2::splat(CELL)),
        ..SceneParts::default()
    })?))
}

/// The radii [mfp], from the smallest.
pub fn radii() -> Vec<f64> {
    (0..RADII).map(|i| 0.1 * libm::exp2(i as f64 / 4.0)).collect()
}

/// The name of a case in tables.
pub fn name(query: Query, photons: u64, radius: f64) -> String {
    format!("{} n={photons} r={radius:.4}", query.name())
}

/// The phase of the work that reading at one radius is.
pub fn reading(query: Query, radius: f64) -> String {
    format!("{} r={radius:.4}", query.name())
}

/// The phases of the work before a question: photons shot, a tree made of points, and one of beams.
pub const SHOOTING: &str = "shooting";
/// See [`SHOOTING`].
pub const POINTS: &str = "tree of points";
/// See [`SHOOTING`].
pub const BEAMS: &str = "tree of beams";

/// The places at the depth.
pub fn places() -> Vec<DVec3> {
    Body::Slab { thickness: TAU }.places(SIDE, DEPTH)
}

/// The rays at the depth, once round the cell.
pub fn rays() -> impl Iterator<Item = Ray> {
    (0..RAYS).map(|i| {
        let x = (i as f64 + 0.5) * CELL / RAYS as f64;
        Ray::new(DVec3::new(x, 0.0, DEPTH), DVec3::Y)
    })
}

/// The whole of a ray.
pub const SPAN: Interval = Interval { start: 0.0, end: CELL };

/// The middles of the steps of a march.
pub fn middles() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| (i as f64 + 0.5) * CELL / STEPS as f64)
}

/// Questions of each kind that a map is asked.
pub fn questions(query: Query) -> usize {
    if query.is_ray() { RAYS } else { SIDE * SIDE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_stay_within_the_slab_and_above_two_steps() {
        let radii = radii();
        assert!(radii[RADII - 1] < DEPTH && 2.0 * CELL / STEPS as f64 <= radii[0]);
        assert!(rays().all(|ray| ray.origin.z == DEPTH) && places().len() == questions(Query::Places));
    }
}
