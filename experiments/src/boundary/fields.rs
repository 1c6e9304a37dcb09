//! The transported fields: which body, how it is lit, how many photons, and the exact answer.

use crate::harness::{CellId, Settings};
use crate::theory::{Exact, slab_fluence, sphere_fluence};
use anyhow::Context;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::{Cuboid, Shape, Slab, Sphere};
use turbid::light::{Beam, Faces, Isotropic, Light, Section};
use turbid::math::Asymmetry;
use turbid::medium::Homogeneous;
use turbid::phase::Phase;
use turbid::photons::{Histories, PhotonMap, shoot};
use turbid::scene::{Parts, Region, Scene};
use turbid::transport::NoProgress;
use turbid_analytic::boundary::Body;
use turbid_analytic::{Incidence, SphereSource};

/// Side of the cell that stands for a slab [mfp].
pub const CELL: f64 = 4.0;
/// Fluence in the furnace, per unit of irradiance.
pub const FURNACE: f64 = 4.0;

/// How much is asked of a field's maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Radii, numbers of neighbours and kernels.
    All,
    /// One radius and one number of neighbours, every place.
    Some,
}

/// One field.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Short name in cases and groups.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// Where the medium is; lengths in mean free paths.
    pub body: Body,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Asymmetry.
    pub g: f64,
    /// How much is asked.
    pub asked: Asked,
    /// Emitted photons a map, and maps, by preset.
    quick: &'static [(u64, u64)],
    full: &'static [(u64, u64)],
}

const SLAB: Body = Body::Slab { thickness: 2.0 };

/// Every field. The first four are furnaces; slabs of the others are lit by a normal beam, the sphere from all sides.
pub const FIELDS: [Field; 7] = [
    Field {
        name: "slab",
        title: "furnace, slab",
        body: SLAB,
        albedo: 1.0,
        g: 0.0,
        asked: Asked::All,
        quick: &[(5_000, 144), (20_000, 144), (80_000, 64)],
        full: &[(5_000, 768), (20_000, 512), (80_000, 256), (320_000, 128)],
    },
    Field {
        name: "slab-g0.75",
        title: "furnace, slab, g = 0.75",
        body: SLAB,
        albedo: 1.0,
        g: 0.75,
        asked: Asked::Some,
        quick: &[(20_000, 128)],
        full: &[(20_000, 512)],
    },
    Field {
        name: "sphere",
        title: "furnace, sphere",
        body: Body::Sphere { radius: 2.0 },
        albedo: 1.0,
        g: 0.0,
        asked: Asked::Some,
        quick: &[(20_000, 128)],
        full: &[(20_000, 768)],
    },
    Field {
        name: "cuboid",
        title: "furnace, cuboid",
        body: Body::Cuboid { edges: [2.0, 2.5, 3.0] },
        albedo: 1.0,
        g: 0.0,
        asked: Asked::Some,
        quick: &[(20_000, 144)],
        full: &[(20_000, 768)],
    },
    Field {
        name: "lit",
        title: "slab lit by a beam",
        body: SLAB,
        albedo: 0.9,
        g: 0.0,
        asked: Asked::Some,
        quick: &[(20_000, 192)],
        full: &[(20_000, 768)],
    },
    Field {
        name: "lit-g0.75",
        title: "slab lit by a beam, g = 0.75",
        body: SLAB,
        albedo: 0.9,
        g: 0.75,
        asked: Asked::Some,
        quick: &[(20_000, 80)],
        full: &[(20_000, 512)],
    },
    Field {
        name: "lit-sphere",
        title: "sphere lit from all sides",
        body: Body::Sphere { radius: 2.0 },
        albedo: 0.5,
        g: 0.0,
        asked: Asked::Some,
        quick: &[(20_000, 80)],
        full: &[(20_000, 512)],
    },
];

impl Field {
    /// The field of a name.
    pub fn named(name: &str) -> anyhow::Result<&'static Field> {
        FIELDS.iter().find(|f| f.name == name).with_context(|| format!("no field is called {name}"))
    }

    /// Whether the fluence is [`FURNACE`] everywhere.
    pub fn is_furnace(&self) -> bool {
        self.albedo == 1.0
    }

    /// Whether light comes in everywhere alike, and not through one face.
    pub fn is_lit_alike(&self) -> bool {
        self.is_furnace() || !matches!(self.body, Body::Slab { .. })
    }

    /// Where the exact fluence comes from.
    pub fn source(&self) -> &'static str {
        match self.body {
            _ if self.is_furnace() => "the furnace",
            Body::Sphere { .. } => "exact solution of the sphere",
            _ => "exact solution of the slab",
        }
    }

    /// Emitted photons a map, and maps.
    pub fn sizes(&self, settings: &Settings) -> Vec<(u64, u64)> {
        let sizes = settings.pick(self.quick, self.full);
        settings.sizes(sizes)
    }

    /// The number of photons of the maps that everything is asked of.
    pub fn main_size(&self, settings: &Settings) -> u64 {
        let sizes = self.sizes(settings);
        sizes[usize::from(sizes.len() > 1)].0
    }

    /// The body as the simulator knows it.
    pub fn shape(&self) -> turbid::Result<Shape> {
        Ok(match self.body {
            Body::HalfSpace => Shape::Slab(Slab::new(0.0, f64::MAX)?),
            Body::Slab { thickness } => Shape::Slab(Slab::new(0.0, thickness)?),
            Body::Sphere { radius } => Shape::Sphere(Sphere::new(DVec3::ZERO, radius)?),
            Body::Cuboid { edges } => Shape::Cuboid(Cuboid::new(DVec3::ZERO, DVec3::from_array(edges))?),
        })
    }

    /// The scene, of irradiance 1; extinction 1.
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let shape = self.shape()?;
        let phase = Phase::with_asymmetry(Asymmetry::new("g", self.g)?);
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::grey(self.albedo), phase)?;
        let light = if self.is_lit_alike() {
            Light::Isotropic(Isotropic::new(shape.clone(), Faces::Both, Spectrum::grey(1.0 / PI))?)
        } else {
            Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?)
        };
        let cell = matches!(shape, Shape::Slab(_)).then_some(CELL);
        let regions = vec![Region { shape, medium: medium.into() }];
        Ok(Scene::new(Parts { regions, lights: vec![light], cell, ..Parts::default() })?)
    }

    /// Photons per volume where the fluence is 1: photons over power.
    pub fn density(&self, photons: u64) -> f64 {
        let area = match self.body {
            Body::Sphere { radius } => 4.0 * PI * radius * radius,
            Body::Cuboid { edges: [a, b, c] } => 2.0 * (a * b + b * c + c * a),
            _ if self.is_furnace() => 2.0 * CELL * CELL,
            _ => CELL * CELL,
        };
        photons as f64 / area
    }

    /// The exact fluence against depth.
    pub fn exact(&self) -> anyhow::Result<Exact> {
        match self.body {
            Body::Slab { thickness } if !self.is_furnace() => {
                slab_fluence(thickness, self.albedo, self.g, Incidence::Beam { mu0: 1.0 })
            }
            Body::Sphere { radius } if !self.is_furnace() => {
                sphere_fluence(radius, self.albedo, SphereSource::Incident)
            }
            _ => Ok(Box::new(|_| Ok((FURNACE, 0.0)))),
        }
    }

    /// The photons of one cell.
    pub fn map(&self, settings: &Settings, cell: &CellId, photons: u64) -> anyhow::Result<PhotonMap> {
        let replicate = cell.stream("boundary");
        let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: None };
        let pass = shoot(&self.scene()?, histories, &[], |_| true, &NoProgress)?;
        Ok(pass.into_map(0.0)?)
    }

    /// Collisions that a photon leaves in the map, roughly: for the work of a cell.
    pub fn stored_per_photon(&self) -> f64 {
        let volume = match self.body {
            Body::Sphere { radius } => 4.0 / 3.0 * PI * radius * radius * radius,
            Body::Cuboid { edges: [a, b, c] } => a * b * c,
            _ => 2.0 * CELL * CELL,
        };
        self.density(1) * volume * if self.is_furnace() { FURNACE } else { 2.0 }
    }
}
