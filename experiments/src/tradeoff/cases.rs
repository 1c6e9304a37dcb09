//! The cases: six slabs, how many photons light them, and how those are gathered.

use crate::harness::Settings;
use crate::theory::{Exact, slab_fluence};
use anyhow::Context;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::Gather;
use turbid::geometry::{Shape, Slab as SlabShape};
use turbid::light::{Beam, Light, Section};
use turbid::math::Asymmetry;
use turbid::medium::Homogeneous;
use turbid::phase::Phase;
use turbid::scene::{Parts, Region, Scene};
use turbid_analytic::Incidence;

/// Side of the cell that stands for the slab \[mfp\].
pub const CELL: f64 = 4.0;
/// Probes along one side of the cell.
pub const SIDE: usize = 16;
/// Layers of probes.
pub const LAYERS: usize = 16;
/// Probes in all: the queries of one map, save that wide gathers are asked of fewer ([`Setting::side`]).
pub const PROBES: usize = SIDE * SIDE * LAYERS;

/// One slab under a normal beam of irradiance 1; lengths are mean free paths.
#[derive(Debug, PartialEq)]
pub struct Slab {
    /// Short name in cases and groups.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Asymmetry.
    pub g: f64,
    /// A guess of the least fluence at a probe: what caps of nearest gathers are made from.
    least: f64,
    /// Whether a map of enough queries is to cost fewer operations than paths. An error e takes 1/e² gathered
    /// photons, more by clusters and blur, and V/e² samples of R rays. Where half of the light is uncollided and known
    /// in closed form, the relative variance V is near 0.3 and R below 4: about as many rays as photons, and clusters
    /// and blur decide against the map.
    pub pays: bool,
    /// Emitted photons of each size of map, by preset.
    quick: &'static [u64],
    full: &'static [u64],
}

/// Every slab, in the order of the report. The thick ones absorb less, since with an albedo of 0.9 hardly a photon
/// in a hundred would reach their far side.
pub const SLABS: [Slab; 6] = [
    Slab {
        name: "thin",
        title: "τ = 0.5, isotropic",
        tau: 0.5,
        albedo: 0.9,
        g: 0.0,
        least: 0.7,
        pays: false,
        quick: &[8_192, 65_536],
        full: &[8_192, 65_536, 524_288],
    },
    Slab {
        name: "thin-g0.75",
        title: "τ = 0.5, g = 0.75",
        tau: 0.5,
        albedo: 0.9,
        g: 0.75,
        least: 0.9,
        pays: true,
        quick: &[8_192, 65_536],
        full: &[8_192, 65_536, 524_288],
    },
    Slab {
        name: "moderate",
        title: "τ = 2, isotropic",
        tau: 2.0,
        albedo: 0.9,
        g: 0.0,
        least: 0.45,
        pays: true,
        quick: &[4_096, 32_768],
        full: &[4_096, 32_768, 262_144],
    },
    Slab {
        name: "moderate-g0.75",
        title: "τ = 2, g = 0.75",
        tau: 2.0,
        albedo: 0.9,
        g: 0.75,
        least: 0.8,
        pays: true,
        quick: &[4_096, 32_768],
        full: &[4_096, 32_768, 262_144],
    },
    Slab {
        name: "thick",
        title: "τ = 8, isotropic",
        tau: 8.0,
        albedo: 0.99,
        g: 0.0,
        least: 0.2,
        pays: true,
        quick: &[4_096, 16_384],
        full: &[4_096, 16_384, 131_072],
    },
    Slab {
        name: "thick-g0.75",
        title: "τ = 8, g = 0.75",
        tau: 8.0,
        albedo: 0.99,
        g: 0.75,
        least: 0.6,
        pays: true,
        quick: &[4_096, 16_384],
        full: &[4_096, 16_384, 131_072],
    },
];

impl Slab {
    /// The slab of a name.
    pub fn named(name: &str) -> anyhow::Result<&'static Slab> {
        SLABS.iter().find(|s| s.name == name).with_context(|| format!("no slab is called {name}"))
    }

    /// Emitted photons of each size of map.
    pub fn photons(&self, settings: &Settings) -> Vec<u64> {
        let scale = |&n: &u64| ((n as f64 * settings.photon_scale) as u64).max(100);
        settings.pick(self.quick, self.full).iter().map(scale).collect()
    }

    /// Depth of a layer of probes, the middle of its share of the slab \[mfp\].
    pub fn depth(&self, layer: usize) -> f64 {
        (layer as f64 + 0.5) * self.tau / LAYERS as f64
    }

    /// The depths of all layers \[mfp\].
    pub fn depths(&self) -> Vec<f64> {
        (0..LAYERS).map(|layer| self.depth(layer)).collect()
    }

    /// The exact fluence.
    pub fn exact(&self) -> anyhow::Result<Exact> {
        slab_fluence(self.tau, self.albedo, self.g, Incidence::Beam { mu0: 1.0 })
    }

    /// The scene.
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let phase = Phase::with_asymmetry(Asymmetry::new("g", self.g)?);
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::grey(self.albedo), phase)?;
        let region = Region { shape: Shape::Slab(SlabShape::new(0.0, self.tau)?), medium };
        let lights = vec![Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?)];
        Ok(Scene::new(Parts { regions: vec![region], lights, cell: Some(CELL), ..Parts::default() })?)
    }
}

/// How large a gather is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// All photons within this radius [mfp].
    Radius(f64),
    /// The k nearest photons; the k-th sets the radius and is not summed.
    Nearest(usize),
}

impl Size {
    /// In words.
    pub fn name(self) -> String {
        match self {
            Size::Radius(r) => format!("r={r}"),
            Size::Nearest(k) => format!("k={k}"),
        }
    }
}

/// What is done where the medium ends inside the ball.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    /// Nothing: the estimate of 1998.
    Plain,
    /// The estimate is divided by the part of the ball that lies in the medium.
    Clipped,
}

impl Treatment {
    /// Both.
    pub const ALL: [Treatment; 2] = [Treatment::Plain, Treatment::Clipped];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Treatment::Plain => "plain",
            Treatment::Clipped => "clipped",
        }
    }
}

/// What one map is asked, at every probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The slab.
    pub slab: &'static Slab,
    /// Photons emitted into the map.
    pub photons: u64,
    /// Gather size.
    pub size: Size,
}

/// Radii of fixed gathers \[mfp\].
const RADII: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// Sizes of nearest gathers.
const NEIGHBORS: [usize; 8] = [10, 20, 50, 100, 200, 500, 1000, 2000];
/// Photons that a fixed ball may hold where the fluence is 1: fewer are noise, more are far beyond the best.
const FILLING: (f64, f64) = (2.0, 9000.0);
/// Gathers of more photons are asked of every fourth probe along each side: their balls overlap all the same.
const WIDE: f64 = 400.0;
/// Fewest emitted photons for each one gathered: below, the ball is no longer local.
const MIN_SHARE: u64 = 32;
/// Room of a nearest gather: the cap would hold so many times k photons at the least fluence, and half of it, as at a
/// face, three times: an under-full gather is one in 10^5 at k = 10.
const ROOM: f64 = 6.0;

impl Setting {
    /// Everything that maps of one slab and number of photons are asked.
    pub fn all(slab: &'static Slab, photons: u64) -> Vec<Setting> {
        let held = |r: &f64| Setting { slab, photons, size: Size::Radius(*r) }.held();
        let radii =
            RADII.into_iter().filter(|r| (FILLING.0..=FILLING.1).contains(&held(r))).map(Size::Radius);
        let nearest = NEIGHBORS.into_iter().filter(|&k| k as u64 * MIN_SHARE <= photons).map(Size::Nearest);
        radii.chain(nearest).map(|size| Setting { slab, photons, size }).collect()
    }

    /// Every setting of a study.
    pub fn every(settings: &Settings) -> Vec<Setting> {
        let of_slab =
            |slab: &'static Slab| slab.photons(settings).into_iter().flat_map(move |n| Setting::all(slab, n));
        SLABS.iter().flat_map(of_slab).collect()
    }

    /// Emitted photons per square mean free path of the face: photons stored per cubic mean free path where the
    /// fluence is 1.
    pub fn density(&self) -> f64 {
        self.photons as f64 / (CELL * CELL)
    }

    /// Photons in a whole ball where the fluence is 1.
    fn held(&self) -> f64 {
        match self.size {
            Size::Radius(r) => self.density() * 4.0 / 3.0 * PI * r * r * r,
            Size::Nearest(k) => k as f64,
        }
    }

    /// Probes along one side of the cell that are asked.
    pub fn side(&self) -> usize {
        if self.held() > WIDE { SIDE / 4 } else { SIDE }
    }

    /// Probes that are asked in one layer.
    pub fn lateral(&self) -> usize {
        self.side() * self.side()
    }

    /// The group of cells that answer it, and the case of whole maps.
    pub fn group(slab: &Slab, photons: u64) -> String {
        format!("{}-n{photons}", slab.name)
    }

    /// The name in tables, whatever is done at the faces.
    pub fn name(&self) -> String {
        format!("{} n={} {}", self.slab.name, self.photons, self.size.name())
    }

    /// The name in tables with what is done at the faces.
    pub fn case(&self, treatment: Treatment) -> String {
        format!("{} {}", self.name(), treatment.name())
    }

    /// Largest radius of the gather \[mfp\].
    pub fn cap(&self) -> f64 {
        match self.size {
            Size::Radius(r) => r,
            Size::Nearest(k) => {
                let volume = ROOM * k as f64 / (self.slab.least * self.density());
                libm::cbrt(3.0 * volume / (4.0 * PI)).min(CELL)
            }
        }
    }

    /// The gather as the estimator takes it.
    pub fn gather(&self) -> turbid::Result<Gather> {
        match self.size {
            Size::Radius(r) => Gather::radius(r),
            Size::Nearest(k) => Gather::nearest(k, self.cap()),
        }
    }
}

/// The probes of one layer, so many along each side.
pub fn probes(side: usize, depth: f64) -> impl Iterator<Item = DVec3> {
    let place = move |i: usize| (i as f64 + 0.5) * CELL / side as f64;
    (0..side * side).map(move |i| DVec3::new(place(i % side), place(i / side), depth))
}

/// The group of a slab's path batches.
pub fn paths_group(slab: &Slab) -> String {
    format!("{}-paths", slab.name)
}

/// The name of a path tracer's case.
pub fn paths_case(slab: &Slab, layer: usize) -> String {
    format!("{} paths t={}", slab.name, slab.depth(layer))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The guessed least fluence is below the true one, so that caps have the room they claim, but not by much.
    #[test]
    fn caps_have_room() {
        for slab in &SLABS {
            let exact = slab.exact().unwrap();
            let least = slab.depths().iter().map(|&t| exact(t).unwrap().0).fold(f64::INFINITY, f64::min);
            assert!(slab.least <= least && least <= 2.0 * slab.least, "{}: {least}", slab.name);
        }
    }
}
