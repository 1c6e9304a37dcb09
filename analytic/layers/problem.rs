//! What a stratified slab is made of, and the light in it that has not met the medium.

use crate::adding_doubling::degrees;
use crate::beer_lambert::{direct_fluence, direct_transmittance};
use crate::error::{Result, within};
use crate::incidence::{Incidence, check_albedo};
use crate::phase::Phase;
use libm::exp;

/// Thickness of a layer, and the most of all layers together.
const THICKEST: f64 = 100.0;
const THICKEST_STACK: f64 = 400.0;

/// Light that starts in a layer thinner than this is not known well enough: see the first layer of a doubling.
const THINNEST_SOURCE: f64 = 1e-6;

/// A homogeneous layer of a stratified slab.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    pub(super) tau: f64,
    pub(super) albedo: f64,
    pub(super) phase: Phase,
    pub(super) emission: f64,
}

impl Layer {
    /// A layer without a source.
    ///
    /// # Arguments
    /// `tau` optical thickness \[1\], 1e-12 to 100; `albedo` 0 to 1; `phase` any whose Legendre moments beyond l = 450
    /// are below 1e-9
    /// # Errors
    /// `Error::OutOfRange` naming `tau`, `albedo` or the first moment left out
    pub fn new(tau: f64, albedo: f64, phase: &Phase) -> Result<Self> {
        within("tau", tau, 1e-12, THICKEST, "1e-12 to 100 in one layer")?;
        check_albedo(albedo)?;
        degrees(phase)?;
        Ok(Layer { tau, albedo, phase: phase.clone(), emission: 0.0 })
    }

    /// The same with a source: light that starts evenly and in all directions.
    ///
    /// # Arguments
    /// `emission` power that starts per area and mean free path of depth, over the irradiance on the lit face \[1\], 0 to
    /// 1e12: 4 pi (1-w) B where the layer has the Planck radiance B; Q/sigma_t of Q per volume. Where `emission` is
    /// above 0, `tau` is 1e-6 or more
    /// # Errors
    /// `Error::OutOfRange` naming `emission` or `tau`
    pub fn emitting(mut self, emission: f64) -> Result<Self> {
        self.emission = within("emission", emission, 0.0, 1e12, "0 to 1e12")?;
        if emission > 0.0 {
            within("tau", self.tau, THINNEST_SOURCE, THICKEST, "1e-6 to 100 in a layer that emits")?;
        }
        Ok(self)
    }

    /// Optical thickness \[1\].
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Single-scattering albedo \[1\].
    pub fn albedo(&self) -> f64 {
        self.albedo
    }

    /// How the layer scatters.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// Power that starts per area and mean free path, over the irradiance on the lit face \[1\].
    pub fn emission(&self) -> f64 {
        self.emission
    }
}

/// What lies below the last layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    pub(super) mirror: bool,
    pub(super) reflectance: f64,
    pub(super) exitance: f64,
}

impl Ground {
    /// Nothing comes back.
    pub fn black() -> Self {
        Ground { mirror: false, reflectance: 0.0, exitance: 0.0 }
    }

    /// Reflects the same radiance in all directions.
    ///
    /// # Errors
    /// `Error::OutOfRange` naming `ground`, its reflectance, unless 0 to 1
    pub fn lambertian(reflectance: f64) -> Result<Self> {
        Ok(Ground { reflectance: within("ground", reflectance, 0.0, 1.0, "0 to 1")?, ..Ground::black() })
    }

    /// Reflects everything, as a plane of symmetry does: the slab and its image below it.
    pub fn mirror() -> Self {
        Ground { mirror: true, reflectance: 1.0, exitance: 0.0 }
    }

    /// The same with light of its own, in all directions alike.
    ///
    /// # Arguments
    /// `exitance` power per area, over the irradiance on the lit face \[1\], 0 to 1e12: pi (1-R) B of a ground of
    /// reflectance R and Planck radiance B
    /// # Errors
    /// `Error::OutOfRange` naming `exitance`
    pub fn emitting(mut self, exitance: f64) -> Result<Self> {
        self.exitance = within("exitance", exitance, 0.0, 1e12, "0 to 1e12")?;
        Ok(self)
    }
}

/// Layers from the top down, the ground and the light.
pub(super) struct Problem {
    pub layers: Vec<Layer>,
    pub ground: Ground,
    pub incidence: Option<Incidence>,
    /// Depths of the interfaces, both faces included.
    pub depths: Vec<f64>,
}

/// Light that has not been scattered: fluence, power per area downwards and upwards.
pub(super) struct Direct {
    pub fluence: f64,
    pub down: f64,
    pub up: f64,
}

impl Problem {
    pub fn new(layers: &[Layer], ground: Ground, incidence: Option<Incidence>) -> Result<Self> {
        within("layers", layers.len() as f64, 1.0, 1000.0, "1 to 1000 of them")?;
        if let Some(Incidence::Beam { mu0 }) = incidence {
            within("mu0", mu0, 1e-5, 1.0, "1e-5 to 1 with layers, or diffuse")?;
        }
        let mut depths = vec![0.0];
        depths.extend(layers.iter().scan(0.0, |depth, layer| {
            *depth += layer.tau;
            Some(*depth)
        }));
        let tau = depths[layers.len()];
        within("tau", tau, 1e-12, THICKEST_STACK, "at most 400 in all layers together")?;
        Ok(Problem { layers: layers.to_vec(), ground, incidence, depths })
    }

    pub fn tau(&self) -> f64 {
        self.depths[self.layers.len()]
    }

    /// The layer that holds depth `t`, and how deep `t` is in it.
    pub fn place(&self, t: f64) -> (usize, f64) {
        let last = self.layers.len() - 1;
        let i = self.depths[1..=last].partition_point(|&depth| depth <= t);
        (i, (t - self.depths[i]).clamp(0.0, self.layers[i].tau))
    }

    /// The share of the beam that a depth of `t`, on the way that it goes, has left over.
    pub fn beam(&self, t: f64) -> f64 {
        match self.incidence {
            Some(Incidence::Beam { mu0 }) => exp(-t / mu0),
            _ => 0.0,
        }
    }

    /// Length of the beam's way, in depth, to where it arrives from below at depth `t`; infinite if it does not.
    pub fn back(&self, t: f64) -> f64 {
        if self.ground.mirror { 2.0 * self.tau() - t } else { f64::INFINITY }
    }

    /// Direct light at depth `t`. Upwards it is the beam in a mirror; what a mirror returns of diffuse light, nodes have.
    pub fn direct(&self, t: f64) -> Result<Direct> {
        let Some(incidence) = self.incidence else {
            return Ok(Direct { fluence: 0.0, down: 0.0, up: 0.0 });
        };
        let down = direct_transmittance(incidence, t)?.value;
        let up = self.beam(self.back(t));
        let Incidence::Beam { mu0 } = incidence else {
            return Ok(Direct { fluence: direct_fluence(incidence, t), down, up: 0.0 });
        };
        Ok(Direct { fluence: (down + up) / mu0, down, up })
    }
}
