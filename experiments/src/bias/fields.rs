//! The fields: which slab, which photons, where it is probed, and the exact answer.

use crate::harness::Settings;
use crate::theory::{Exact, slab_fluence};
use anyhow::Context;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::{Shape, Slab};
use turbid::light::{Beam, Light, Section};
use turbid::math::Asymmetry;
use turbid::medium::Homogeneous;
use turbid::phase::Phase;
use turbid::scene::{Orders, Parts, Region, Scene};
use turbid_analytic::Incidence;

/// Side of the cell that stands for the slab [mfp].
pub const CELL: f64 = 4.0;

/// One field.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Short name in cases.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Asymmetry.
    pub g: f64,
    /// Orders of scattering of the photons in the map.
    pub orders: Orders,
    /// Depths of the probes [mfp].
    pub depths: &'static [f64],
    /// Emitted photons a map, and maps, by preset.
    quick: &'static [(u64, u64)],
    full: &'static [(u64, u64)],
}

/// Every field, in the order of the report.
pub const FIELDS: [Field; 4] = [
    Field {
        name: "uncollided",
        title: "uncollided photons, field e^-t",
        tau: 4.0,
        albedo: 0.0,
        g: 0.0,
        orders: Orders { min: 0, max: Some(0) },
        depths: &[0.0, 0.25, 1.0, 2.0],
        quick: &[(10_000, 512), (100_000, 512), (1_000_000, 128)],
        full: &[(10_000, 1024), (100_000, 1024), (1_000_000, 256), (4_000_000, 64)],
    },
    Field {
        name: "albedo0.5",
        title: "albedo 0.5, isotropic",
        tau: 2.0,
        albedo: 0.5,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        quick: &[(200_000, 112)],
        full: &[(200_000, 256), (1_000_000, 64)],
    },
    Field {
        name: "albedo0.9",
        title: "albedo 0.9, isotropic",
        tau: 2.0,
        albedo: 0.9,
        g: 0.0,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        quick: &[(20_000, 512), (200_000, 112)],
        full: &[(20_000, 1024), (200_000, 256), (1_000_000, 64)],
    },
    Field {
        name: "albedo0.9g0.75",
        title: "albedo 0.9, g = 0.75",
        tau: 2.0,
        albedo: 0.9,
        g: 0.75,
        orders: Orders::ALL,
        depths: &[0.0, 0.25, 1.0, 1.75],
        quick: &[(200_000, 112)],
        full: &[(200_000, 256), (1_000_000, 64)],
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

    /// The slab under a normal beam of irradiance 1; lengths are mean free paths.
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let phase = Phase::with_asymmetry(Asymmetry::new("g", self.g)?);
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::grey(self.albedo), phase)?;
        let region = Region { shape: Shape::Slab(Slab::new(0.0, self.tau)?), medium };
        let beam = Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?;
        let lights = vec![Light::Beam(beam)];
        Ok(Scene::new(Parts { regions: vec![region], lights, cell: Some(CELL), ..Parts::default() })?)
    }

    /// The exact fluence.
    pub fn exact(&self) -> anyhow::Result<Exact> {
        if !self.has_clusters() {
            return Ok(Box::new(|t| Ok((libm::exp(-t), 0.0))));
        }
        slab_fluence(self.tau, self.albedo, self.g, Incidence::Beam { mu0: 1.0 })
    }
}
