//! The slab under a beam aslant, and where it is asked.

use crate::setups::{Body, CELL, asked, region};
use glam::{DVec2, DVec3};
use turbid::Spectrum;
use turbid::light::{Beam, Light, Section};
use turbid::math::Interval;
use turbid::scene::{Scene, SceneParts};

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
/// Places along one side of the lattice.
const SIDE: usize = 5;

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

/// The places at the depth.
pub fn places() -> Vec<DVec3> {
    Body::Slab { thickness: TAU }.places(SIDE, DEPTH)
}

/// The whole of a ray.
pub const SPAN: Interval = Interval { start: 0.0, end: CELL };
