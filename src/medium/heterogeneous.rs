//! A medium whose density varies.

use super::period::Albedo;
use super::{Blocks, Density, Grid, Homogeneous};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Extinction proportional to a density; albedo the same everywhere, of a grid or of blocks; one phase function.
#[derive(Debug, Clone, PartialEq)]
pub struct Heterogeneous {
    /// What it is where the density is 1; the emission that does not follow the density.
    matter: Homogeneous,
    density: Density,
    albedo: Option<Albedo>,
    /// Emission that follows the density, at density 1 [W/(L^3 sr)].
    emission: Spectrum,
}

impl Heterogeneous {
    /// `matter` thinned and thickened by a density: extinction is density times that of `matter`; its own emission is
    /// the same everywhere.
    pub fn new(matter: Homogeneous, density: Density) -> Self {
        let density = density.bounded_for(matter.sigma_t().max());
        Heterogeneous { matter, density, albedo: None, emission: Spectrum::ZERO }
    }

    /// With an albedo that varies too: that of the grid times that of the matter.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a grid with a value above 1
    pub fn with_albedo(self, grid: Grid) -> Result<Self> {
        let highest = grid.values().iter().fold(0.0f32, |high, v| high.max(*v));
        if highest > 1.0 {
            return Err(Error::out_of_range("albedo of a grid", f64::from(highest), "0 to 1"));
        }
        Ok(Heterogeneous { albedo: Some(Albedo::Grid(Arc::new(grid), None)), ..self })
    }

    /// The same with an albedo that is constant in blocks.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a value above 1
    pub fn with_albedo_blocks(self, blocks: Blocks) -> Result<Self> {
        if blocks.high() > 1.0 {
            return Err(Error::out_of_range("albedo of a block", blocks.high(), "0 to 1"));
        }
        Ok(Heterogeneous { albedo: Some(Albedo::Blocks(Arc::new(blocks), None)), ..self })
    }

    /// The same in every period of a world with these periods.
    pub(super) fn repeated(&self, cell: DVec2) -> Result<Self> {
        Ok(Heterogeneous {
            density: self.density.repeated(cell, self.matter.sigma_t().max())?,
            albedo: self.albedo.as_ref().map(|albedo| albedo.repeated(cell)).transpose()?,
            ..self.clone()
        })
    }

    /// With an emission that follows the density: [W/(L^3 sr)] where it is 1.
    ///
    /// # Errors
    /// `Error::OutOfRange` for one that is negative or not finite
    pub fn with_emission_by_density(self, emission: Spectrum) -> Result<Self> {
        super::homogeneous::check_emission(emission)?;
        Ok(Heterogeneous { emission, ..self })
    }

    /// What it is where the density is 1.
    pub fn matter(&self) -> &Homogeneous {
        &self.matter
    }

    /// How much of it is where.
    pub fn density(&self) -> &Density {
        &self.density
    }

    /// Albedo at a point \[1\].
    pub fn albedo(&self, p: DVec3) -> Spectrum {
        let albedo = self.matter.albedo();
        self.albedo.as_ref().map_or(albedo, |varying| albedo * varying.at(p))
    }

    /// The grid that the albedo is multiplied by, where there is one.
    pub fn albedo_grid(&self) -> Option<&Grid> {
        if let Some(Albedo::Grid(grid, None)) = &self.albedo { Some(grid) } else { None }
    }

    /// The blocks that the albedo is multiplied by, where there are any.
    pub fn albedo_blocks(&self) -> Option<&Blocks> {
        if let Some(Albedo::Blocks(blocks, None)) = &self.albedo { Some(blocks) } else { None }
    }

    /// Whether the albedo varies.
    pub fn has_varying_albedo(&self) -> bool {
        self.albedo.is_some()
    }

    /// Emission where the density is known [W/(L^3 sr)].
    pub fn emission_of(&self, density: f64) -> Spectrum {
        self.matter.emission() + self.emission * density
    }

    /// Whether it depends on z alone.
    pub fn is_layered(&self) -> bool {
        self.density.is_layered() && self.albedo.as_ref().is_none_or(Albedo::is_layered)
    }

    /// Planes across z between which it is the same everywhere \[L\]; none where it varies otherwise.
    pub fn layer_planes(&self) -> Option<Vec<f64>> {
        let Density::Blocks(density) = &self.density else { return None };
        if !self.is_layered() || density.is_columns() {
            return None;
        }
        let mut planes = density.planes(2).to_vec();
        match &self.albedo {
            None => {}
            Some(Albedo::Blocks(blocks, _)) => planes.extend_from_slice(blocks.planes(2)),
            Some(Albedo::Grid(..)) => return None,
        }
        Some(planes)
    }

    /// Whether it emits anywhere.
    pub fn is_emitting(&self) -> bool {
        !self.matter.emission().is_black() || !self.emission.is_black()
    }

    /// Whether every number is the same in all channels.
    pub fn is_grey(&self) -> bool {
        self.albedo.as_ref().is_none_or(Albedo::is_grey)
            && self.matter.albedo().is_grey()
            && self.matter.sigma_t().is_grey()
            && self.matter.emission().is_grey()
            && self.emission.is_grey()
    }

    /// Optical depth of a part of a ray, where the density has an integral in closed form \[1\].
    pub fn optical_depth(&self, ray: &Ray, part: Interval) -> Option<Spectrum> {
        Some(self.matter.depth(self.density.closed_integral(ray, part)?))
    }
}
