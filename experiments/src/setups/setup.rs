//! A body of medium with its light.

use super::asked::asked;
use super::body::{Body, CELL};
use crate::theory::{Exact, slab_fluence, sphere_fluence};
use anyhow::bail;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::light::{Beam, Faces, Isotropic, Light, Section, VolumeSource};
use turbid::math::Asymmetry;
use turbid::medium::Homogeneous;
use turbid::phase::Phase;
use turbid::scene::{Region, Scene, SceneParts};
use turbid_analytic::{Incidence, SphereSource};

/// What lights a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lighting {
    /// A normal beam of irradiance 1 on the face of a slab at depth 0.
    Beam,
    /// Isotropic light of irradiance 1 on the whole surface.
    Isotropic,
    /// The medium itself emits the power 1 per volume.
    Emission,
}

/// A body of medium with its light; extinction 1, lengths in mean free paths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Where the medium is.
    pub body: Body,
    /// Its light.
    pub lighting: Lighting,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Asymmetry of the phase function of Henyey and Greenstein.
    pub g: f64,
}

/// Fluence in the furnace, per unit of irradiance.
pub const FURNACE: f64 = 4.0;

/// A region of homogeneous medium with the phase function of Henyey and Greenstein.
pub fn region(shape: Shape, sigma_t: f64, albedo: f64, g: f64) -> turbid::Result<Region> {
    let phase = Phase::with_asymmetry(Asymmetry::new("g", g)?);
    let medium = Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::grey(albedo), phase)?;
    Ok(Region { shape, medium: medium.into() })
}

impl Setup {
    /// A slab under a normal beam.
    pub const fn slab(thickness: f64, albedo: f64, g: f64) -> Self {
        Setup { body: Body::Slab { thickness }, lighting: Lighting::Beam, albedo, g }
    }

    /// Whether the fluence is the same everywhere: nothing is absorbed, and light comes in from all sides alike.
    pub fn is_furnace(&self) -> bool {
        self.albedo == 1.0 && self.lighting == Lighting::Isotropic
    }

    /// The scene.
    ///
    /// # Errors
    /// A beam on anything but a slab, or values out of range.
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let shape = self.body.shape()?;
        let is_slab = matches!(self.body, Body::Slab { .. });
        let light = match self.lighting {
            Lighting::Beam if !is_slab => bail!("a beam lights slabs alone, not {:?}", self.body),
            Lighting::Beam => Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?),
            Lighting::Isotropic => {
                Light::Isotropic(Isotropic::new(shape.clone(), Faces::Both, Spectrum::grey(1.0 / PI))?)
            }
            Lighting::Emission => Light::VolumeSource(VolumeSource::new(shape.clone(), Spectrum::ONE)?),
        };
        let regions = vec![region(shape, 1.0, self.albedo, self.g)?];
        let cell = is_slab.then_some(CELL);
        Ok(asked(Scene::new(SceneParts {
            regions,
            lights: vec![light],
            cell: cell.map(glam::DVec2::splat),
            ..SceneParts::default()
        })?))
    }

    /// Emitted power, of a slab that of the cell.
    pub fn power(&self) -> f64 {
        match self.lighting {
            Lighting::Beam => CELL * CELL,
            Lighting::Isotropic => self.body.surface(),
            Lighting::Emission => self.body.volume(),
        }
    }

    /// Photons per volume where the fluence is 1: photons over power.
    pub fn density(&self, photons: u64) -> f64 {
        photons as f64 / self.power()
    }

    /// The exact fluence against depth, of all orders of scattering.
    ///
    /// # Errors
    /// If no exact solution is known.
    pub fn exact(&self) -> anyhow::Result<Exact> {
        match (self.body, self.lighting) {
            _ if self.is_furnace() => Ok(Box::new(|_| Ok((FURNACE, 0.0)))),
            (Body::Slab { .. }, Lighting::Beam) if self.albedo == 0.0 => {
                Ok(Box::new(|t| Ok((libm::exp(-t), 0.0))))
            }
            (Body::Slab { thickness }, Lighting::Beam) => {
                slab_fluence(thickness, self.albedo, self.g, Incidence::Beam { mu0: 1.0 })
            }
            (Body::Sphere { radius }, Lighting::Isotropic) if self.g == 0.0 => {
                sphere_fluence(radius, self.albedo, SphereSource::Incident)
            }
            (Body::Sphere { radius }, Lighting::Emission) if self.g == 0.0 => {
                // The referee's source has the power 1 in all.
                let (of_unit, power) =
                    (sphere_fluence(radius, self.albedo, SphereSource::Uniform)?, self.power());
                Ok(Box::new(move |t| of_unit(t).map(|(value, error)| (power * value, power * error))))
            }
            _ => bail!("no exact fluence is known of {self:?}"),
        }
    }

    /// Where the exact fluence comes from.
    pub fn source(&self) -> &'static str {
        match self.body {
            _ if self.is_furnace() => "the furnace",
            Body::Slab { .. } => "exact solution of the slab",
            Body::Sphere { .. } => "exact solution of the sphere",
            Body::Cuboid { .. } => "the furnace",
        }
    }

    /// What the surface at depth 0 is called.
    pub fn surface(&self) -> &'static str {
        match self.body {
            Body::Slab { .. } => "lit face",
            Body::Sphere { .. } | Body::Cuboid { .. } => "surface",
        }
    }

    /// Collisions of a history, on average: the integral of the fluence over the medium, per unit of power.
    ///
    /// # Errors
    /// As [`Body::total`].
    pub fn collisions(&self, exact: &Exact, panels: u32) -> anyhow::Result<f64> {
        Ok(self.body.total(exact, panels)? / self.power())
    }
}
