//! Media in the scene file: the keys that regions and interiors share.

use super::blocks::{ColumnsFile, LayersFile, MarkovFile};
use super::values::Channels;
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::math::{Albedo, Asymmetry, NonNegative, Positive};
use crate::medium::{
    Blocks, Body, Cloud, CloudShape, Density, Grid, HeightFog, Heterogeneous, Homogeneous, Medium,
};
use crate::phase::{Legendre, Phase, Rayleigh, Schlick, Tabulated, TwoTerm};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// A phase function that is not of one parameter `g`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    reason = "the names are those of the phase functions' own constructors, which say their meaning"
)]
pub enum PhaseFile {
    TwoTerm {
        g1: Asymmetry,
        g2: Asymmetry,
        share: Albedo,
    },
    Schlick {
        k: Asymmetry,
    },
    Rayleigh {},
    Table {
        file: String,
    },
    /// Moments of degree 0, which is 1, and on.
    Legendre(Vec<f64>),
}

/// How much of a medium is where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(
    missing_docs,
    clippy::large_enum_variant,
    reason = "the names are those of the densities' own constructors; there are few of them"
)]
pub enum DensityFile {
    Grid(GridFile),
    Cloud(CloudFile),
    HeightFog { base: f64, scale_height: Positive, up: [f64; 3] },
    Columns(ColumnsFile),
    Layers(LayersFile),
    Markov(MarkovFile),
}

/// What the values of a grid are in between.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Linear between the middles of cells.
    #[default]
    Linear,
    /// Each that of its whole cell.
    Blocks,
}

/// A `.vol` or `.npy` file, or values in the scene file itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridFile {
    /// Its name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// In place of a file: the values, x fastest, then y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<NonNegative>>,
    /// How many values along x, y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<[usize; 3]>,
    /// What they are in between; linear if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<Interpolation>,
    /// What its values are multiplied by; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Positive>,
    /// Lower corner of the box that it fills \[L\], with `max` in place of the file's own, which `.npy` files have not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<[f64; 3]>,
    /// Upper corner of the box \[L\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<[f64; 3]>,
}

/// A cloud; `medium::CloudShape` says the meaning of the keys, and what they are if absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the names are those of `medium::CloudShape`")]
pub struct CloudFile {
    pub center: [f64; 3],
    pub radii: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<Body>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub octaves: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roughness: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sharpness: Option<f64>,
}

/// What regions and interiors say of a medium.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Keys<'a> {
    pub sigma_t: Option<Channels<NonNegative>>,
    pub albedo: Option<Channels<Albedo>>,
    pub sigma_a: Option<Channels<NonNegative>>,
    pub sigma_s: Option<Channels<NonNegative>>,
    pub albedo_grid: Option<&'a GridFile>,
    pub g: Option<Asymmetry>,
    pub phase: Option<&'a PhaseFile>,
    pub emission: Option<Channels<NonNegative>>,
    pub emission_by_density: Option<Channels<NonNegative>>,
    pub density: Option<&'a DensityFile>,
}

fn refuse<T>(text: &str) -> Result<T> {
    Err(Error::Scene(text.into()))
}

impl Keys<'_> {
    /// Extinction and albedo, by whichever pair of keys says them.
    fn coefficients(&self) -> Result<Option<(Spectrum, Spectrum)>> {
        match (self.sigma_t, self.albedo, self.sigma_a, self.sigma_s) {
            (Some(sigma_t), Some(albedo), None, None) => Ok(Some((sigma_t.spectrum(), albedo.spectrum()))),
            (None, None, Some(sigma_a), Some(sigma_s)) => {
                let sigma_t = sigma_a.spectrum() + sigma_s.spectrum();
                Ok(Some((sigma_t, sigma_s.spectrum().over(sigma_t))))
            }
            (None, None, None, None) => Ok(None),
            (sigma_t, albedo, sigma_a, sigma_s) => {
                let keys = [
                    ("sigma_t", sigma_t.is_some()),
                    ("albedo", albedo.is_some()),
                    ("sigma_a", sigma_a.is_some()),
                    ("sigma_s", sigma_s.is_some()),
                ];
                let given: Vec<&str> =
                    keys.iter().filter(|(_, is_there)| *is_there).map(|(key, _)| *key).collect();
                refuse(&format!(
                    "a medium with {}; allowed: sigma_t and albedo, or sigma_a and sigma_s",
                    given.join(", ")
                ))
            }
        }
    }

    /// The medium, or none if no key is there.
    pub(super) fn medium(&self, folder: &Path) -> Result<Option<Medium>> {
        let Keys { albedo_grid, g, phase, emission, emission_by_density, density, .. } = *self;
        let (sigma_t, albedo) = match self.coefficients()? {
            Some(coefficients) if g.is_some() || phase.is_some() => coefficients,
            None if g.is_none() && phase.is_none() && density.is_none() && emission.is_none() => {
                return Ok(None);
            }
            _ => {
                return refuse(
                    "a part of a medium; allowed: sigma_t, albedo (or sigma_a, sigma_s) and g (or phase), or none of them",
                );
            }
        };
        let phase = match (g, phase) {
            (Some(g), None) => Phase::with_asymmetry(g),
            (None, Some(phase)) => phase.phase(folder)?,
            _ => return refuse("g and phase; allowed: one of the two"),
        };
        let mut matter = Homogeneous::new(sigma_t, albedo, phase)?;
        if let Some(emission) = emission {
            matter = matter.with_emission(emission.spectrum())?;
        }
        let Some(density) = density else {
            if albedo_grid.is_some() || emission_by_density.is_some() {
                return refuse("albedo_grid or emission_by_density without density; allowed: beside density");
            }
            return Ok(Some(matter.into()));
        };
        let (density, own_albedo) = density.density(folder)?;
        let mut medium = Heterogeneous::new(matter, density);
        match (own_albedo, albedo_grid) {
            (Some(_), Some(_)) => {
                return refuse("albedo_grid and layers with an albedo; allowed: one of the two");
            }
            (Some(blocks), None) => medium = medium.with_albedo_blocks(blocks)?,
            (None, Some(grid)) => {
                medium = match grid.sampled(folder).map_err(|e| e.within("albedo_grid"))? {
                    Sampled::Grid(grid) => medium.with_albedo(grid)?,
                    Sampled::Blocks(blocks) => medium.with_albedo_blocks(blocks)?,
                }
            }
            (None, None) => {}
        }
        if let Some(emission) = emission_by_density {
            medium = medium.with_emission_by_density(emission.spectrum())?;
        }
        Ok(Some(medium.into()))
    }
}

impl PhaseFile {
    fn phase(&self, folder: &Path) -> Result<Phase> {
        Ok(match self {
            PhaseFile::TwoTerm { g1, g2, share } => Phase::TwoTerm(TwoTerm::new(*g1, *g2, *share)),
            PhaseFile::Schlick { k } => Phase::Schlick(Schlick::new(*k)),
            PhaseFile::Rayleigh {} => Phase::Rayleigh(Rayleigh),
            PhaseFile::Legendre(moments) => Phase::Legendre(Arc::new(Legendre::new(moments)?)),
            PhaseFile::Table { file } => Phase::Tabulated(Arc::new(Tabulated::read(&folder.join(file))?)),
        })
    }
}

impl DensityFile {
    /// The density, and the albedo that comes with it, if one does.
    fn density(&self, folder: &Path) -> Result<(Density, Option<Blocks>)> {
        let density = match self {
            DensityFile::Columns(columns) => Density::blocks(columns.blocks(folder)?),
            DensityFile::Layers(layers) => {
                let (blocks, albedo) = layers.blocks()?;
                return Ok((Density::blocks(blocks)?, albedo));
            }
            DensityFile::Markov(mixture) => {
                let (blocks, albedo) = mixture.blocks()?;
                return Ok((Density::blocks(blocks)?, albedo));
            }
            DensityFile::Grid(grid) => match grid.sampled(folder)? {
                Sampled::Grid(grid) => Density::grid(grid),
                Sampled::Blocks(blocks) => Density::blocks(blocks),
            }
            .map_err(|e| match &grid.file {
                Some(file) => e.within(&format!("grid {}", folder.join(file).display())),
                None => e,
            }),
            DensityFile::Cloud(cloud) => {
                let plain = CloudShape::plain(cloud.center.into(), cloud.radii.into());
                let look = CloudShape {
                    body: cloud.body.unwrap_or(plain.body),
                    seed: cloud.seed.unwrap_or(plain.seed),
                    frequency: cloud.frequency.unwrap_or(plain.frequency),
                    octaves: cloud.octaves.unwrap_or(plain.octaves),
                    gain: cloud.gain.unwrap_or(plain.gain),
                    roughness: cloud.roughness.unwrap_or(plain.roughness),
                    sharpness: cloud.sharpness.unwrap_or(plain.sharpness),
                    ..plain
                };
                Ok(Density::Cloud(Arc::new(Cloud::new(look)?)))
            }
            DensityFile::HeightFog { base, scale_height, up } => {
                Ok(Density::HeightFog(HeightFog::new((*up).into(), *base, *scale_height)?))
            }
        };
        Ok((density?, None))
    }
}

/// Samples with what they are in between.
enum Sampled {
    Grid(Grid),
    Blocks(Blocks),
}

impl GridFile {
    fn sampled(&self, folder: &Path) -> Result<Sampled> {
        let is_blocks = self.interpolation == Some(Interpolation::Blocks);
        match (&self.file, &self.values, self.count) {
            (Some(file), None, None) => {
                let grid = self.placed(self.read(file, folder)?)?;
                Ok(if is_blocks { Sampled::Blocks(Blocks::of_grid(&grid)?) } else { Sampled::Grid(grid) })
            }
            (None, Some(values), Some(count)) => {
                let (Some(min), Some(max)) = (self.min, self.max) else {
                    return refuse("values of a grid without min and max; allowed: both");
                };
                let corners = (min.into(), max.into());
                let scale = self.scale.map_or(1.0, Positive::get);
                let values = values.iter().map(|value| value.get() * scale);
                Ok(match is_blocks {
                    true => Sampled::Blocks(Blocks::uniform(corners, count, 1, values.collect())?),
                    false => {
                        let single = values.map(|value| value as f32).collect();
                        Sampled::Grid(Grid::new(corners, count, 1, single)?)
                    }
                })
            }
            _ => refuse("a grid needs `file`, or `values` and `count` in its place; allowed: one of the two"),
        }
    }

    /// The file's grid; a NumPy array states no box of its own.
    fn read(&self, file: &str, folder: &Path) -> Result<Grid> {
        let path = folder.join(file);
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy")) {
            return Grid::read(&path);
        }
        match (self.min, self.max) {
            (Some(min), Some(max)) => Grid::read_npy(&path, (min.into(), max.into())),
            _ => Err(Error::Scene(format!(
                "grid {} without min and max, which a NumPy array does not state; allowed: both",
                path.display()
            ))),
        }
    }

    fn placed(&self, grid: Grid) -> Result<Grid> {
        let (min, max) = grid.corners();
        match (self.min, self.max, self.scale) {
            (None, None, None) => Ok(grid),
            (None, None, Some(scale)) => grid.placed((min, max), scale.get()),
            (Some(min), Some(max), scale) => {
                let scale = scale.filter(|_| !planted(Fault::GridScaleForgotten));
                grid.placed((min.into(), max.into()), scale.map_or(1.0, Positive::get))
            }
            _ => refuse("a grid with one of min and max; allowed: both, or neither"),
        }
    }
}
