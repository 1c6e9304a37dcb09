//! The boxes of fog, as the peer renders them.

use anyhow::{Context, Result};
use glam::DVec3;
use std::f64::consts::PI;
use std::path::PathBuf;
use turbid::Spectrum;
use turbid::math::{Asymmetry, cos, sin};
use turbid::medium::{Density, Grid, Heterogeneous, Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::scene::{Camera, Filter, Region, Scene, SceneFile, SceneParts, View};

/// Where scenes are.
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes"))
}

/// The box with the fog of this name.
pub fn load(fog: &str) -> Result<Scene> {
    if fog == "het" {
        return uneven();
    }
    let path = folder().join(format!("fogbox-{fog}.toml"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let file: SceneFile = toml::from_str(&text).with_context(|| path.display().to_string())?;
    Ok(file.scene(&folder())?)
}

/// The camera in the box.
pub fn camera() -> Result<Camera> {
    Ok(Camera::new(View {
        position: DVec3::new(0.0, 0.0, 0.95),
        look_at: DVec3::ZERO,
        up: DVec3::Y,
        fov: 80.0,
        width: crate::WIDTH as u32,
        height: crate::WIDTH as u32,
        filter: Filter::Box,
    })?)
}

/// The box with fog of uneven density: 32 samples an axis, mean extinction 0.5, g = 0.5.
fn uneven() -> Result<Scene> {
    let even = load("iso")?;
    let corners = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let shape = |p: DVec3| {
        let turns = |x: f64| 2.0 * PI * x;
        let DVec3 { x, y, z } = 0.5 * (p + 1.0);
        let wide = sin(turns(1.5 * x + 0.2)) * cos(turns(y)) * sin(turns(1.2 * z + 0.1));
        (1.0 + 0.6 * wide + 0.35 * sin(turns(3.0 * x + 2.0 * y + 2.5 * z))).max(0.02)
    };
    let rough = Grid::sampled(corners, [32; 3], shape)?;
    let mean = rough.values().iter().map(|v| f64::from(*v)).sum::<f64>() / 32768.0;
    let density = Density::grid(Grid::sampled(corners, [32; 3], |p| 0.5 * shape(p) / mean)?)?;
    let phase = Phase::with_asymmetry(Asymmetry::try_from(0.5)?);
    let matter = Homogeneous::new(Spectrum::ONE, Spectrum::grey(0.8), phase)?;
    let medium = Medium::Heterogeneous(Heterogeneous::new(matter, density).into());
    let regions = even.regions().iter().map(|r| Region { shape: r.shape.clone(), medium: medium.clone() });
    Ok(Scene::new(SceneParts {
        regions: regions.collect(),
        objects: even.objects().to_vec(),
        lights: even.lights().to_vec(),
        ..SceneParts::default()
    })?)
}
