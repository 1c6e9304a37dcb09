//! Interiors in a scene file, and the dielectric surfaces that name them.

use super::Channels;
use crate::error::{Error, Result};
use crate::math::{Albedo, Asymmetry, Index, NonNegative};
use crate::medium::Homogeneous;
use crate::phase::Phase;
use crate::scene::Interior;
use crate::surface::Dielectric;
use serde::{Deserialize, Serialize};

/// What fills the space between dielectric surfaces; a medium if all of its three keys are there.
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
    /// Asymmetry of the Henyey-Greenstein phase function; 0 is isotropic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g: Option<Asymmetry>,
}

impl InteriorFile {
    pub(super) fn interior(&self) -> Result<Interior> {
        let medium = match (self.sigma_t, self.albedo, self.g) {
            (None, None, None) => None,
            (Some(sigma_t), Some(albedo), Some(g)) => {
                let phase = Phase::with_asymmetry(g);
                Some(Homogeneous::new(sigma_t.spectrum(), albedo.spectrum(), phase)?.into())
            }
            _ => {
                return Err(Error::Scene(format!(
                    "interior {} has a part of a medium; allowed: sigma_t, albedo and g, or none of them",
                    self.name
                )));
            }
        };
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
