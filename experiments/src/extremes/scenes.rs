//! Scenes from plain numbers; extinction is 1 per unit of length unless a unit is given.

use crate::setups::{asked, region};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::{Face, Shape, Slab, Sphere};
use turbid::light::{Beam, Faces, Isotropic, Light, Section};
use turbid::scene::{Orders, Quantity, Scene, SceneParts, Sensor};
use turbid_analytic::Incidence;

/// Side of the cell that stands for a slab [mfp].
pub const CELL: f64 = 4.0;

/// A slab of fog: optical thickness, albedo, asymmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fog {
    /// Optical thickness \[1\].
    pub tau: f64,
    /// Single-scattering albedo \[1\].
    pub albedo: f64,
    /// Asymmetry \[1\].
    pub g: f64,
}

/// The slab under unit irradiance, one mean free path being `unit` scene lengths.
pub fn slab(fog: Fog, incidence: Incidence, unit: f64) -> turbid::Result<Scene> {
    let shape = Shape::Slab(Slab::new(0.0, fog.tau * unit)?);
    let light = match incidence {
        Incidence::Beam { mu0 } => {
            let dir = DVec3::new(((1.0 - mu0) * (1.0 + mu0)).sqrt(), 0.0, mu0);
            Light::Beam(Beam::new(dir, Spectrum::grey(1.0 / mu0), Section::Unbounded)?)
        }
        Incidence::Diffuse => {
            Light::Isotropic(Isotropic::new(shape.clone(), Faces::Top, Spectrum::grey(1.0 / PI))?)
        }
    };
    let regions = vec![region(shape, 1.0 / unit, fog.albedo, fog.g)?];
    Ok(asked(Scene::new(SceneParts {
        regions,
        lights: vec![light],
        cell: Some(glam::DVec2::splat(CELL * unit)),
        ..SceneParts::default()
    })?))
}

/// The slab lit alike from both sides, which absorbs nothing: fluence 4 everywhere, at any asymmetry.
pub fn furnace_slab(tau: f64, g: f64) -> turbid::Result<Scene> {
    let shape = Shape::Slab(Slab::new(0.0, tau)?);
    let light = Light::Isotropic(Isotropic::new(shape.clone(), Faces::Both, Spectrum::grey(1.0 / PI))?);
    let regions = vec![region(shape, 1.0, 1.0, g)?];
    Ok(asked(Scene::new(SceneParts {
        regions,
        lights: vec![light],
        cell: Some(glam::DVec2::splat(CELL)),
        ..SceneParts::default()
    })?))
}

/// A ball of fog of radius 1 lit alike from all sides, which absorbs nothing: fluence 4 everywhere and 4/3 collisions
/// a photon, at any asymmetry.
pub fn furnace_ball(center: DVec3, g: f64) -> turbid::Result<Scene> {
    let shape = Shape::Sphere(Sphere::new(center, 1.0)?);
    let light = Light::Isotropic(Isotropic::new(shape.clone(), Faces::Both, Spectrum::grey(1.0 / PI))?);
    Ok(asked(Scene::new(SceneParts {
        regions: vec![region(shape, 1.0, 1.0, g)?],
        lights: vec![light],
        ..SceneParts::default()
    })?))
}

/// A narrow beam along x at height `z` in a slab from 0 to 2.
pub fn beam_along(z: f64) -> turbid::Result<Scene> {
    let shape = Shape::Slab(Slab::new(0.0, 2.0)?);
    let section = Section::Disc { center: DVec3::new(0.0, 0.0, z), radius: 1e-3 };
    let light = Light::Beam(Beam::new(DVec3::X, Spectrum::ONE, section)?);
    Ok(asked(Scene::new(SceneParts {
        regions: vec![region(shape, 1.0, 0.5, 0.0)?],
        lights: vec![light],
        ..SceneParts::default()
    })?))
}

/// The power that leaves through a face of the scene's slab, or is absorbed in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flux {
    /// Through the lit face.
    Reflected,
    /// Through the other.
    Transmitted,
    /// Through neither.
    Absorbed,
}

/// The sensor of a flux.
pub fn sensor(scene: &Scene, flux: Flux, orders: Orders) -> Sensor {
    let shape = &scene.regions()[0].shape;
    let quantity = match flux {
        Flux::Reflected => Quantity::Outflow { shape: shape.clone(), face: Face::Top },
        Flux::Transmitted => Quantity::Outflow { shape: shape.clone(), face: Face::Bottom },
        Flux::Absorbed => Quantity::Absorbed(0),
    };
    Sensor { name: "flux".to_string(), label: "flux".to_string(), quantity, orders }
}

/// The point at a depth in the middle of the cell, one mean free path being `unit`.
pub fn at_depth(depth: f64, unit: f64) -> DVec3 {
    DVec3::new(0.5 * CELL, 0.5 * CELL, depth) * unit
}
