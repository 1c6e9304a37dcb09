//! Regions of the scenes that are built in.

use crate::error::Result;
use crate::math::{Albedo, Asymmetry, NonNegative};
use crate::scene::file::{Channels, RegionFile, ShapeFile};

pub(super) fn region(shape: ShapeFile, sigma_t: f64, albedo: Albedo, g: Asymmetry) -> Result<RegionFile> {
    Ok(RegionFile {
        shape,
        sigma_t: Some(grey(NonNegative::new("sigma_t", sigma_t)?)),
        albedo: Some(grey(albedo)),
        sigma_a: None,
        sigma_s: None,
        albedo_grid: None,
        g: Some(g),
        phase: None,
        emission: None,
        emission_by_density: None,
        density: None,
    })
}

pub(super) fn grey<T: Copy>(value: T) -> Channels<T> {
    Channels([value; 3])
}
