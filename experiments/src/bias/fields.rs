//! The fields: which fog, which photons, where it is probed, and the exact answer.

use crate::harness::Settings;
use crate::theory::{Exact, Fog, slab_fluence, sphere_fluence};
use anyhow::Context;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::light::{Beam, Faces, Isotropic, Light, Section, VolumeSource};
use turbid::math::Asymmetry;
use turbid::medium::Homogeneous;
use turbid::phase::Phase;
use turbid::scene::{Orders, Parts, Region, Scene};
use turbid_analytic::{Incidence, SphereSource};

/// Side of the cell that stands for the slab [mfp].
pub const CELL: f64 = 4.0;

/// What lights the fog.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lit {
    /// A normal beam of irradiance 1 on the face of a slab.
    Beam,
    /// Light of irradiance 1 from all sides into a sphere.
    Incident,
    /// The fog itself, with power 1 per volume.
    Glow,
}

/// One field.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Short name in cases.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// The body of fog; lengths are mean free paths.
    pub fog: Fog,
    /// Its light.
    pub lit: Lit,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Asymmetry.
    pub g: f64,
    /// Orders of scattering of the photons in the map.
    pub orders: Orders,
    /// Depths of the probes [mfp].
    pub depths: &'static [f64],
    /// Batches of paths, and paths of one batch at one depth.
    pub paths: (u64, u64),
    /// Factor on the margins of claims: what fewer photons and paths than the first fields have can decide.
    pub slack: f64,
    /// Emitted photons a map, and maps, by preset.
    quick: &'static [(u64, u64)],
    full: &'static [(u64, u64)],
}

const SLAB: Fog = Fog::Slab { thickness: 2.0 };
const SPHERE: Fog = Fog::Sphere { radius: 2.0 };

/// Every field, in the order of the report. Random streams count them: new ones go to the end.
pub const FIELDS: [Field; 7] = [
    Field {
        name: "uncollided",
        title: "uncollided photons, field e^-t",
        fog: Fog::Slab { thickness: 4.0 },
        lit: Lit::Beam,
        albedo: 0.0,
        g: 0.0,
        orders: Orders { min: 0, max: Some(0) },
        depths: &[0.0, 0.25, 1.0, 2.0],
        paths: (128, 16_384),
        slack: 1.0,
        quick: &[(10_000, 512), (100_000, 384), (1_000_000, 112)],
        full: &[(10_000, 1024), (100_000, 1024), (1_000_000, 256), (4_000_000, 64)],
    },
    Field {
        name: "albedo0.5",
        title: "albedo 0.5, isotropic",
        fog: SLAB,
        lit: Lit::Beam,
        albedo: 0.5,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        paths: (128, 4_096),
        slack: 1.0,
        quick: &[(200_000, 112)],
        full: &[(200_000, 256), (1_000_000, 64)],
    },
    Field {
        name: "albedo0.9",
        title: "albedo 0.9, isotropic",
        fog: SLAB,
        lit: Lit::Beam,
        albedo: 0.9,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        paths: (128, 16_384),
        slack: 1.0,
        quick: &[(20_000, 512), (200_000, 112)],
        full: &[(20_000, 1024), (200_000, 256), (1_000_000, 64)],
    },
    Field {
        name: "albedo0.9g0.75",
        title: "albedo 0.9, g = 0.75",
        fog: SLAB,
        lit: Lit::Beam,
        albedo: 0.9,
        g: 0.75,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        paths: (128, 16_384),
        slack: 1.0,
        quick: &[(200_000, 112)],
        full: &[(200_000, 256), (1_000_000, 64)],
    },
    Field {
        name: "albedo0.9g-0.5",
        title: "albedo 0.9, g = −0.5",
        fog: SLAB,
        lit: Lit::Beam,
        albedo: 0.9,
        g: -0.5,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        paths: (64, 8_192),
        slack: 3.0,
        quick: &[(50_000, 80)],
        full: &[(200_000, 128)],
    },
    Field {
        name: "glow",
        title: "glowing sphere, albedo 0.9",
        fog: SPHERE,
        lit: Lit::Glow,
        albedo: 0.9,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.5],
        paths: (64, 8_192),
        slack: 3.0,
        quick: &[(50_000, 80)],
        full: &[(200_000, 128)],
    },
    Field {
        name: "lit-sphere",
        title: "sphere lit from all sides, albedo 0.5",
        fog: SPHERE,
        lit: Lit::Incident,
        albedo: 0.5,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.5],
        paths: (64, 8_192),
        slack: 3.0,
        quick: &[(50_000, 80)],
        full: &[(200_000, 128)],
    },
];

impl Field {
    /// The field of a name.
    pub fn named(name: &str) -> anyhow::Result<&'static Field> {
        FIELDS.iter().find(|f| f.name == name).with_context(|| format!("no field is called {name}"))
    }

    /// Emitted photons a map, and maps: at least as many as verdicts ask for.
    pub fn sizes(&self, settings: &Settings) -> Vec<(u64, u64)> {
        let sizes = settings.pick(self.quick, self.full);
        settings.sizes(sizes)
    }

    /// Emitted photons a map.
    pub fn photons(&self, settings: &Settings) -> Vec<u64> {
        self.sizes(settings).into_iter().map(|(photons, _)| photons).collect()
    }

    /// The number that random streams take for a repetition: different for every field and number of photons, so that
    /// no two groups of cells share their histories.
    pub fn replicate(&self, settings: &Settings, photons: u64, replicate: u64) -> u64 {
        let field = FIELDS.iter().position(|f| f.name == self.name).unwrap_or(FIELDS.len()) as u64;
        let size = self.photons(settings).iter().position(|&n| n == photons).unwrap_or(0) as u64;
        field << 48 | size << 40 | replicate
    }

    /// Whether photons of one history can be near each other in the map.
    pub fn has_clusters(&self) -> bool {
        self.orders != Orders::only(0)
    }

    /// The scene, of extinction 1.
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let shape = self.fog.shape()?;
        let phase = Phase::with_asymmetry(Asymmetry::new("g", self.g)?);
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::grey(self.albedo), phase)?;
        let light = match self.lit {
            Lit::Beam => Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?),
            Lit::Incident => {
                Light::Isotropic(Isotropic::new(shape.clone(), Faces::Both, Spectrum::grey(1.0 / PI))?)
            }
            Lit::Glow => Light::VolumeSource(VolumeSource::new(shape.clone(), Spectrum::ONE)?),
        };
        let cell = matches!(self.fog, Fog::Slab { .. }).then_some(CELL);
        let regions = vec![Region { shape, medium: medium.into() }];
        Ok(Scene::new(Parts { regions, lights: vec![light], cell, ..Parts::default() })?)
    }

    /// The power of the light.
    pub fn power(&self) -> f64 {
        match (self.fog, self.lit) {
            (Fog::Slab { .. }, _) => CELL * CELL,
            (Fog::Sphere { radius }, Lit::Glow) => 4.0 / 3.0 * PI * radius * radius * radius,
            (Fog::Sphere { radius }, _) => 4.0 * PI * radius * radius,
        }
    }

    /// Photons per volume where the fluence is 1: photons over power.
    pub fn density(&self, photons: u64) -> f64 {
        photons as f64 / self.power()
    }

    /// Where probes of depth 0 are.
    pub fn surface(&self) -> &'static str {
        match self.fog {
            Fog::Slab { .. } => "lit face",
            Fog::Sphere { .. } => "surface",
        }
    }

    /// Where the exact fluence comes from.
    pub fn source(&self) -> &'static str {
        match self.fog {
            Fog::Slab { .. } => "exact solution of the slab",
            Fog::Sphere { .. } => "exact solution of the sphere",
        }
    }

    /// The exact fluence against depth.
    pub fn exact(&self) -> anyhow::Result<Exact> {
        match self.fog {
            Fog::Slab { .. } if !self.has_clusters() => Ok(Box::new(|t| Ok((libm::exp(-t), 0.0)))),
            Fog::Slab { thickness } => {
                slab_fluence(thickness, self.albedo, self.g, Incidence::Beam { mu0: 1.0 })
            }
            Fog::Sphere { radius } if self.lit == Lit::Glow => {
                // The referee's source has the power 1 in all.
                let (of_unit, power) =
                    (sphere_fluence(radius, self.albedo, SphereSource::Uniform)?, self.power());
                Ok(Box::new(move |t| of_unit(t).map(|(value, error)| (power * value, power * error))))
            }
            Fog::Sphere { radius } => sphere_fluence(radius, self.albedo, SphereSource::Incident),
        }
    }
}
