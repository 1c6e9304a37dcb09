//! The fields: which fog, which photons, where it is probed, and the exact answer.

use crate::harness::Settings;
use crate::setups::{Body, Lighting, Setup};
use turbid::scene::Orders;

/// One field.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Short name in cases.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// The medium and its light.
    pub setup: Setup,
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

/// A ball that scatters isotropically.
const fn sphere(lighting: Lighting, albedo: f64) -> Setup {
    Setup { body: Body::Sphere { radius: 2.0 }, lighting, albedo, g: 0.0 }
}

/// Every field, in the order of the report. Random streams count them: new ones go to the end.
pub static FIELDS: [&Field; 7] =
    [&UNCOLLIDED, &HALF_ALBEDO, &HIGH_ALBEDO, &FORWARD, &BACKWARD, &EMITTING_SPHERE, &LIT_SPHERE];

/// Uncollided photons, field e^-t.
pub static UNCOLLIDED: Field = Field {
    name: "uncollided",
    title: "uncollided photons, field e^-t",
    setup: Setup::slab(4.0, 0.0, 0.0),
    orders: Orders { min: 0, max: Some(0) },
    depths: &[0.0, 0.25, 1.0, 2.0],
    paths: (128, 16_384),
    slack: 1.0,
    quick: &[(10_000, 512), (100_000, 384), (1_000_000, 112)],
    full: &[(10_000, 1024), (100_000, 1024), (1_000_000, 256), (4_000_000, 64)],
};
/// Albedo 0.5, isotropic.
pub static HALF_ALBEDO: Field = Field {
    name: "albedo0.5",
    title: "albedo 0.5, isotropic",
    setup: Setup::slab(2.0, 0.5, 0.0),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.75],
    paths: (128, 4_096),
    slack: 1.0,
    quick: &[(200_000, 112)],
    full: &[(200_000, 256), (1_000_000, 64)],
};
/// Albedo 0.9, isotropic.
pub static HIGH_ALBEDO: Field = Field {
    name: "albedo0.9",
    title: "albedo 0.9, isotropic",
    setup: Setup::slab(2.0, 0.9, 0.0),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.75],
    paths: (128, 16_384),
    slack: 1.0,
    quick: &[(20_000, 512), (200_000, 112)],
    full: &[(20_000, 1024), (200_000, 256), (1_000_000, 64)],
};
/// Albedo 0.9, g = 0.75.
pub static FORWARD: Field = Field {
    name: "albedo0.9g0.75",
    title: "albedo 0.9, g = 0.75",
    setup: Setup::slab(2.0, 0.9, 0.75),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.75],
    paths: (128, 16_384),
    slack: 1.0,
    quick: &[(200_000, 112)],
    full: &[(200_000, 256), (1_000_000, 64)],
};
/// Albedo 0.9, g = −0.5.
pub static BACKWARD: Field = Field {
    name: "albedo0.9g-0.5",
    title: "albedo 0.9, g = −0.5",
    setup: Setup::slab(2.0, 0.9, -0.5),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.75],
    paths: (64, 8_192),
    slack: 3.0,
    quick: &[(50_000, 80)],
    full: &[(200_000, 128)],
};
/// Glowing sphere, albedo 0.9.
pub static EMITTING_SPHERE: Field = Field {
    name: "glow",
    title: "emitting sphere, albedo 0.9",
    setup: sphere(Lighting::Emission, 0.9),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.5],
    paths: (64, 8_192),
    slack: 3.0,
    quick: &[(50_000, 80)],
    full: &[(200_000, 128)],
};
/// Sphere lit from all sides, albedo 0.5.
pub static LIT_SPHERE: Field = Field {
    name: "lit-sphere",
    title: "sphere lit from all sides, albedo 0.5",
    setup: sphere(Lighting::Isotropic, 0.5),
    orders: Orders::ALL,
    depths: &[0.0, 0.25, 1.0, 1.5],
    paths: (64, 8_192),
    slack: 3.0,
    quick: &[(50_000, 80)],
    full: &[(200_000, 128)],
};

impl Field {
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
        let field = FIELDS.into_iter().position(|f| f.name == self.name).unwrap_or(FIELDS.len()) as u64;
        let size = self.photons(settings).iter().position(|&n| n == photons).unwrap_or(0) as u64;
        field << 48 | size << 40 | replicate
    }

    /// Whether photons of one history can be near each other in the map.
    pub fn has_clusters(&self) -> bool {
        self.orders != Orders::only(0)
    }
}
