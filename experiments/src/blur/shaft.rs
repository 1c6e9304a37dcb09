//! The shaft: a rectangular beam into a box of fog that only absorbs.

use crate::harness::Settings;
use crate::setups::asked;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::{Cuboid, Rectangle, Shape};
use turbid::light::{Beam, Light, Section};
use turbid::medium::Homogeneous;
use turbid::phase::{Isotropic, Phase};
use turbid::scene::{Region, Scene, SceneParts};

/// Depth of the probes [mfp].
pub const DEPTH: f64 = 1.0;
/// Farthest that any photon is taken from [mfp]: no ball touches the lit face, the far one, or another edge than its
/// own.
pub const CAP: f64 = 0.9;
/// The shaft between its two edges [mfp]: probes up to 1.1 inside one see nothing of the other.
pub const WIDTH: f64 = 2.0;
/// The shaft along its edges [mfp].
pub const LENGTH: f64 = 4.0;
/// Thickness of the fog [mfp].
pub const THICKNESS: f64 = 2.0;

/// Emitted photons a map, and maps, by preset.
const QUICK: [(u64, u64); 3] = [(2_000, 512), (16_000, 512), (64_000, 384)];
const FULL: [(u64, u64); 4] = [(2_000, 2048), (16_000, 2048), (64_000, 1024), (512_000, 256)];

/// Emitted photons a map, and maps.
pub fn sizes(settings: &Settings) -> Vec<(u64, u64)> {
    let sizes = settings.pick(QUICK.as_slice(), FULL.as_slice());
    settings.sizes(sizes)
}

/// Photons stored per volume inside the shaft at the depth of the probes [1/mfp^3].
pub fn density(photons: u64) -> f64 {
    photons as f64 * fluence() / (WIDTH * LENGTH)
}

/// Exact fluence inside the shaft at the depth of the probes, per unit of irradiance.
pub fn fluence() -> f64 {
    libm::exp(-DEPTH)
}

/// Fog of albedo 0 around and beyond the shaft, lengths in mean free paths, irradiance 1.
pub fn scene() -> anyhow::Result<Scene> {
    let medium = Homogeneous::new(Spectrum::ONE, Spectrum::ZERO, Phase::Isotropic(Isotropic))?;
    let corner = DVec3::new(-1.0, -1.0, 0.0);
    let fog = Cuboid::new(corner, DVec3::new(WIDTH + 1.0, LENGTH + 1.0, THICKNESS))?;
    let section = Rectangle::new(DVec3::new(0.0, 0.0, -0.5), DVec3::X * WIDTH, DVec3::Y * LENGTH)?;
    let beam = Beam::new(DVec3::Z, Spectrum::ONE, Section::Rectangle(section))?;
    let regions = vec![Region { shape: Shape::Cuboid(fog), medium: medium.into() }];
    Ok(asked(Scene::new(SceneParts { regions, lights: vec![Light::Beam(beam)], ..SceneParts::default() })?))
}
