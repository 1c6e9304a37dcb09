//! The closed box of fog with two blocks, extinction 0.5 and albedo 0.8.

use crate::setups::asked;
use anyhow::anyhow;
use std::path::Path;
use turbid::Spectrum;
use turbid::scene::{Scene, SceneFile};

const SCENE: &str = include_str!("../../scenes/fogbox-iso.toml");
/// Extinction of the fog [1/L].
pub const SIGMA_T: f64 = 0.5;
/// Albedo of the fog.
pub const ALBEDO: f64 = 0.8;
/// Volume of the box [L^3].
pub const VOLUME: f64 = 8.0;

/// The box.
pub fn scene() -> anyhow::Result<Scene> {
    let file = SceneFile::from_toml(SCENE).map_err(|e| anyhow!("fogbox-iso.toml: {e}"))?;
    Ok(asked(file.scene(Path::new("."))?))
}

/// What is seen, as one number.
pub fn grey(s: Spectrum) -> f64 {
    s.mean()
}
