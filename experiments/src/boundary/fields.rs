//! The transported fields: which body, how it is lit, how many photons, and the exact answer.

use crate::harness::{CellId, Settings};
use crate::setups::{Body, FURNACE, Lighting, Setup};
use turbid::photons::{Histories, PhotonMap, shoot};
use turbid::transport::NoProgress;

/// Which cases a field's maps are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseSet {
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
    /// The medium and its light.
    pub setup: Setup,
    /// Which cases are asked.
    pub cases: CaseSet,
    /// Emitted photons a map, and maps, by preset.
    quick: &'static [(u64, u64)],
    full: &'static [(u64, u64)],
}

/// A body lit alike from all sides.
const fn lit(body: Body, albedo: f64, g: f64) -> Setup {
    Setup { body, lighting: Lighting::Isotropic, albedo, g }
}

const SLAB: Body = Body::Slab { thickness: 2.0 };

/// Every field. The first four are furnaces; slabs of the others are lit by a normal beam, the sphere from all sides.
pub static FIELDS: [&Field; 7] =
    [&FURNACE_SLAB, &FURNACE_FORWARD, &FURNACE_SPHERE, &FURNACE_CUBOID, &LIT_SLAB, &LIT_FORWARD, &LIT_SPHERE];

/// Furnace, slab.
pub static FURNACE_SLAB: Field = Field {
    name: "slab",
    title: "furnace, slab",
    setup: lit(SLAB, 1.0, 0.0),
    cases: CaseSet::All,
    quick: &[(5_000, 144), (20_000, 144), (80_000, 64)],
    full: &[(5_000, 768), (20_000, 512), (80_000, 256), (320_000, 128)],
};
/// Furnace, slab, g = 0.75.
pub static FURNACE_FORWARD: Field = Field {
    name: "slab-g0.75",
    title: "furnace, slab, g = 0.75",
    setup: lit(SLAB, 1.0, 0.75),
    cases: CaseSet::Some,
    quick: &[(20_000, 128)],
    full: &[(20_000, 512)],
};
/// Furnace, sphere.
pub static FURNACE_SPHERE: Field = Field {
    name: "sphere",
    title: "furnace, sphere",
    setup: lit(Body::Sphere { radius: 2.0 }, 1.0, 0.0),
    cases: CaseSet::Some,
    quick: &[(20_000, 128)],
    full: &[(20_000, 768)],
};
/// Furnace, cuboid.
pub static FURNACE_CUBOID: Field = Field {
    name: "cuboid",
    title: "furnace, cuboid",
    setup: lit(Body::Cuboid { edges: [2.0, 2.5, 3.0] }, 1.0, 0.0),
    cases: CaseSet::Some,
    quick: &[(20_000, 144)],
    full: &[(20_000, 768)],
};
/// Slab lit by a beam.
pub static LIT_SLAB: Field = Field {
    name: "lit",
    title: "slab lit by a beam",
    setup: Setup::slab(2.0, 0.9, 0.0),
    cases: CaseSet::Some,
    quick: &[(20_000, 192)],
    full: &[(20_000, 768)],
};
/// Slab lit by a beam, g = 0.75.
pub static LIT_FORWARD: Field = Field {
    name: "lit-g0.75",
    title: "slab lit by a beam, g = 0.75",
    setup: Setup::slab(2.0, 0.9, 0.75),
    cases: CaseSet::Some,
    quick: &[(20_000, 80)],
    full: &[(20_000, 512)],
};
/// Sphere lit from all sides.
pub static LIT_SPHERE: Field = Field {
    name: "lit-sphere",
    title: "sphere lit from all sides",
    setup: lit(Body::Sphere { radius: 2.0 }, 0.5, 0.0),
    cases: CaseSet::Some,
    quick: &[(20_000, 80)],
    full: &[(20_000, 512)],
};

impl Field {
    /// Whether light comes in everywhere alike, and not through one face.
    pub fn is_lit_alike(&self) -> bool {
        self.setup.lighting == Lighting::Isotropic
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

    /// The photons of one cell.
    pub fn map(&self, settings: &Settings, cell: &CellId, photons: u64) -> anyhow::Result<PhotonMap> {
        let replicate = cell.stream("boundary");
        let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: None };
        let pass = shoot(&self.setup.scene()?, histories, &[], |_| true, &NoProgress)?;
        Ok(pass.into_map(0.0)?)
    }

    /// Collisions that a photon leaves in the map, roughly: for the work of a cell.
    pub fn stored_per_photon(&self) -> f64 {
        let fluence = if self.setup.is_furnace() { FURNACE } else { 2.0 };
        self.setup.density(1) * self.setup.body.volume() * fluence
    }
}
