//! Scenes that are no boxes, and as the peer renders them.

use anyhow::{Context, Result};
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::{Mesh, Shape};
use turbid::math::{cos, exp, sin};
use turbid::medium::{Density, Grid, HeightFog, Heterogeneous, Medium};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Object, Region, Scene, SceneFile, SceneParts};
use turbid::surface::{Lambertian, Surface};

/// Their names: a ring of 300,000 triangles in height fog under a spot; a cloud under the sun; milk in glass.
pub const OTHERS: [&str; 3] = ["mist", "cloud", "milk"];

/// A scene, and the same for the peer, which knows no height fog: by a grid of 256 layers.
pub fn load(name: &str) -> Result<(Scene, Scene)> {
    let text = match name {
        "mist" => include_str!("mist.toml"),
        "cloud" => include_str!("cloud.toml"),
        _ => include_str!("milk.toml"),
    };
    let file: SceneFile = toml::from_str(text).with_context(|| format!("{name}.toml"))?;
    let scene = file.scene(&super::scenes::folder())?;
    match name {
        "mist" => {
            let mut parts = parts_of(&scene);
            let ring = Surface::Lambertian(Lambertian::new(Spectrum::rgb(0.7, 0.5, 0.3))?);
            parts.objects.push(Object { shape: Shape::Mesh(ring_of(600, 250)?.into()), surface: ring });
            let scene = Scene::new(parts)?;
            let up = HeightFog::new(DVec3::Y, 0.0, 0.7.try_into()?)?;
            let corners = (DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 3.0, 2.0));
            let layers = Grid::sampled(corners, [2, 256, 2], |p| up.at(p))?;
            let peers = with_density(&scene, layers)?;
            Ok((scene, peers))
        }
        "cloud" => {
            let cloud = with_density(&scene, cumulus()?)?;
            Ok((cloud.clone(), cloud))
        }
        _ => Ok((scene.clone(), scene)),
    }
}

fn parts_of(scene: &Scene) -> SceneParts {
    SceneParts {
        regions: scene.regions().to_vec(),
        interiors: scene.interiors().to_vec(),
        objects: scene.objects().to_vec(),
        lights: scene.lights().to_vec(),
        camera: scene.camera().cloned(),
        ..SceneParts::default()
    }
}

/// The scene with this density in its region.
fn with_density(scene: &Scene, grid: Grid) -> Result<Scene> {
    let mut parts = parts_of(scene);
    let Region { shape, medium } = parts.regions.remove(0);
    let varying = Heterogeneous::new(medium.matter().clone(), Density::grid(grid)?);
    let medium = Medium::Heterogeneous(varying.into());
    parts.regions.push(Region { shape, medium });
    Ok(Scene::new(parts)?)
}

/// A bumpy, wavy ring of `around` by `across` patches, two triangles each.
fn ring_of(around: u32, across: u32) -> Result<Mesh> {
    let place = |i: u32, j: u32| {
        let (u, v) =
            (2.0 * PI * f64::from(i) / f64::from(around), 2.0 * PI * f64::from(j) / f64::from(across));
        let tube = 0.28 * (1.0 + 0.12 * sin(9.0 * u + 3.0 * v) + 0.05 * sin(31.0 * u - 17.0 * v));
        let out = 0.62 + tube * cos(v);
        DVec3::new(out * cos(u), 0.42 + tube * sin(v) + 0.15 * sin(2.0 * u), out * sin(u))
    };
    let places = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let corners: Vec<DVec3> = places.clone().map(|(i, j)| place(i, j)).collect();
    let number = |i: u32, j: u32| (i % around) * across + j % across;
    let triangles: Vec<[u32; 3]> = places
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| number(i + x, j + y));
            [[a, d, c], [a, c, b]]
        })
        .collect();
    Ok(Mesh::new(&corners, &triangles, None)?)
}

/// Fourteen puffs, ragged at the edge: 64 by 48 by 64 samples.
fn cumulus() -> Result<Grid> {
    let mut stream = Stream::new(5, Purpose::Synthetic, 0, 0);
    let mut between = |low: f64, high: f64| low + (high - low) * stream.unit();
    let puffs: Vec<(DVec3, f64)> = (0..14)
        .map(|_| {
            let middle = DVec3::new(between(-0.75, 0.75), between(0.6, 1.2), between(-0.75, 0.75));
            (middle, between(0.24, 0.66))
        })
        .collect();
    let corners = (DVec3::new(-1.5, 0.0, -1.5), DVec3::new(1.5, 2.0, 1.5));
    let ragged = |p: DVec3| sin(13.0 * p.x + 4.0 * p.z) * sin(18.0 * p.y) * cos(14.0 * p.z - 3.0 * p.x);
    let density = |p: DVec3| {
        let inside: f64 = puffs
            .iter()
            .map(|(middle, radius)| exp(-2.0 * p.distance_squared(*middle) / (radius * radius)))
            .sum();
        (2.5 * (inside * (1.0 + 0.35 * ragged(p)) - 0.25)).clamp(0.0, 1.0)
    };
    Ok(Grid::sampled(corners, [64, 48, 64], density)?)
}
