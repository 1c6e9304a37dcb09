//! Interiors in a scene file, and the dielectric surfaces that name them.

use super::medium::Keys;
use super::medium::{DensityFile, GridFile, PhaseFile};
use super::values::Channels;
use crate::error::{Error, Result};
use crate::math::{Albedo, Asymmetry, Index, NonNegative};
use crate::scene::Interior;
use crate::surface::Dielectric;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What fills the space between dielectric surfaces; a medium if its keys are there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InteriorFile {
    /// What dielectric surfaces call it.
    pub name: String,
    /// Index of refraction \[1\], at least 1.
    pub index: Index,
    /// Extinction [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_t: Option<Channels<NonNegative>>,
    /// Single-scattering albedo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo: Option<Channels<Albedo>>,
    /// Absorption, with `sigma_s` in place of the two [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_a: Option<Channels<NonNegative>>,
    /// Scattering [1/L].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_s: Option<Channels<NonNegative>>,
    /// Albedo from place to place, times `albedo`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo_grid: Option<GridFile>,
    /// Asymmetry of the Henyey-Greenstein phase function; 0 is isotropic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g: Option<Asymmetry>,
    /// Another phase function, in place of `g`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<PhaseFile>,
    /// Emission, the same everywhere [W/(L^3 sr)]; none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Channels<NonNegative>>,
    /// Emission that follows the density, where it is 1 [W/(L^3 sr)]; none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission_by_density: Option<Channels<NonNegative>>,
    /// How much of it is where: the extinction is this times `sigma_t`; 1 everywhere if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<DensityFile>,
}

impl InteriorFile {
    pub(super) fn interior(&self, folder: &Path) -> Result<Interior> {
        let keys = Keys {
            sigma_t: self.sigma_t,
            albedo: self.albedo,
            sigma_a: self.sigma_a,
            sigma_s: self.sigma_s,
            albedo_grid: self.albedo_grid.as_ref(),
            g: self.g,
            phase: self.phase.as_ref(),
            emission: self.emission,
            emission_by_density: self.emission_by_density,
            density: self.density.as_ref(),
        };
        let medium = keys.medium(folder)?;
        Ok(Interior { name: self.name.clone(), index: self.index.get(), medium })
    }
}

/// A dielectric surface: the names of the interiors on its inner side, against its outward normal, and its outer side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DielectricFile {
    /// The inner side.
    pub inside: String,
    /// The outer side; the surroundings if absent.
    #[serde(default = "surroundings")]
    pub outside: String,
}

fn surroundings() -> String {
    Interior::surroundings().name
}

impl DielectricFile {
    pub(super) fn dielectric(&self, interiors: &[Interior]) -> Result<Dielectric> {
        Ok(Dielectric::new(number(interiors, &self.inside)?, number(interiors, &self.outside)?))
    }
}

/// The number of the interior of this name.
fn number(interiors: &[Interior], name: &str) -> Result<usize> {
    interiors.iter().position(|i| i.name == name).ok_or_else(|| {
        let names: Vec<&str> = interiors.iter().map(|i| i.name.as_str()).collect();
        let alike = |other: &&&str| strsim::jaro_winkler(name, other);
        let nearest = names.iter().max_by(|a, b| alike(a).total_cmp(&alike(b))).copied().unwrap_or_default();
        Error::Scene(format!(
            "unknown interior `{name}`; nearest: `{nearest}`; allowed: {}",
            names.join(", ")
        ))
    })
}
