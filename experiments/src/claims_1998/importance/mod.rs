//! Importance: photons go where the camera looks, and no mean changes.
//!
//! The camera sees one corner of a long foggy hall that is lit at its other end. Maps of each kind are asked by the same
//! rays with the same random numbers: what differs between maps is the maps.

pub mod conclude;

use super::fogbox::grey;
use super::maps::filled;
use super::part::STREAM;
use crate::harness::{CellId, CellOutput, Group, Settings};
use anyhow::{Context, anyhow};
use glam::{DVec2, DVec3};
use std::path::Path;
use std::sync::{Arc, Mutex};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::mapper::{self, Mapper};
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{Emitted, Indirect, Maps};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Scene, SceneFile};
use turbid::transport::NoProgress;

/// The group of all cells.
pub const GROUP: &str = "importance";
/// Pixels of the picture that are looked at.
const COLUMNS: usize = 8;
const ROWS: usize = 6;
/// Pixels.
pub const PIXELS: usize = COLUMNS * ROWS;
/// Radius of all gathers \[L\].
const RADIUS: f64 = 0.6;
/// The corner that the camera sees: photons in this box count as stored where it looks.
const CORNER: [DVec3; 2] = [DVec3::splat(-0.1), DVec3::splat(3.0)];
const SCENE: &str = include_str!("../../../scenes/importance.toml");

/// How photons are sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// By the lights' power.
    Power,
    /// Where the picture needs them.
    Importance,
}

impl Way {
    /// Both.
    pub const ALL: [Way; 2] = [Way::Power, Way::Importance];

    /// The case of the maps.
    pub fn case(self) -> &'static str {
        match self {
            Way::Power => "hall by power",
            Way::Importance => "hall by importance",
        }
    }

    /// The case of a pixel.
    pub fn pixel(self, pixel: usize) -> String {
        format!("{} pixel {pixel}", self.case())
    }

    /// Photons sent out; those by importance have more events.
    fn photons(self, settings: &Settings) -> u64 {
        match self {
            Way::Power => settings.photons(30_000, 120_000).max(2_000),
            Way::Importance => settings.photons(4_000, 16_000).max(400),
        }
    }
}

/// All cells.
pub fn group(settings: &Settings) -> Group {
    let photons: u64 = Way::ALL.iter().map(|way| way.photons(settings)).sum();
    Group::new(GROUP, 64, 8.0 * photons as f64, measure).with_stream("steering")
}

/// Importance: the same for all cells, which need not learn it each for itself.
fn learned(
    output: &mut CellOutput,
    scene: &Scene,
    settings: &ImportanceSettings,
) -> anyhow::Result<Arc<Importance>> {
    static LEARNED: Mutex<Option<(ImportanceSettings, Arc<Importance>)>> = Mutex::new(None);
    let mut kept = LEARNED.lock().map_err(|_| anyhow!("another cell failed to learn"))?;
    if let Some((of, importance)) = &*kept
        && of == settings
    {
        return Ok(importance.clone());
    }
    let camera = scene.camera().context("the hall has no camera")?;
    let importance =
        output.time("learning", |_| Importance::of(scene, camera, Indirect::Seen, settings, &NoProgress))?;
    let importance = Arc::new(importance);
    *kept = Some((*settings, importance.clone()));
    Ok(importance)
}

/// Measures one cell: a map of each kind.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let file = SceneFile::from_toml(SCENE).map_err(|e| anyhow!("importance.toml: {e}"))?;
    let (scene, replicate) = (file.scene(Path::new("."))?, cell.stream(STREAM));
    let mut output = CellOutput::new();
    let learning = ImportanceSettings {
        pilot: settings.photons(1 << 15, 1 << 16).max(1 << 13),
        particles: settings.photons(1 << 15, 1 << 16).max(1 << 13),
        seed: settings.seed,
        ..Default::default()
    };
    let learned = learned(&mut output, &scene, &learning)?;
    for way in Way::ALL {
        let importance = (way == Way::Importance).then_some(&*learned);
        let maps = output.time(way.case(), |_| {
            maps(&scene, importance, way.photons(settings), settings.seed, replicate ^ (way as u64) << 20)
        })?;
        let main = maps.report.main;
        output.push(way.case(), "events", (main.collisions + main.hits) as f64);
        output.push(way.case(), "stored in view", in_view(&maps));
        for (pixel, value) in picture(&scene, &maps)?.into_iter().enumerate() {
            output.push(way.pixel(pixel), "radiance", value);
        }
    }
    Ok(output)
}

fn maps(
    scene: &Scene,
    importance: Option<&Importance>,
    photons: u64,
    seed: u64,
    replicate: u64,
) -> anyhow::Result<Maps> {
    filled(scene, Emitted { global: photons, volume: photons, caustic: 0 }, importance, seed, replicate)
}

/// Photons of both maps in the corner.
fn in_view(maps: &Maps) -> f64 {
    let [low, high] = CORNER;
    let photons = [&maps.global, &maps.volume].into_iter().flatten().flat_map(|map| map.tree().photons());
    photons.filter(|p| p.position.cmpge(low).all() && p.position.cmplt(high).all()).count() as f64
}

/// What the maps bring to each pixel.
fn picture(scene: &Scene, maps: &Maps) -> anyhow::Result<Vec<f64>> {
    let camera = scene.camera().context("the hall has no camera")?;
    let gather = Gather::radius(RADIUS)?;
    let standard = mapper::Settings::for_size(10.0, 50)?;
    let volume = Estimator { gather, ..standard.volume };
    let settings = mapper::Settings { global: (Kernel::Uniform, gather), volume, ..standard };
    let mapper = Mapper::new(scene, maps, &settings);
    let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
    let pixel = |i: usize| {
        let mut stream = Stream::new(1, Purpose::Paths, 0, i as u64);
        let at = |i: usize, of: usize| (i as f64 + 0.5) / of as f64;
        let place = DVec2::new(width * at(i % COLUMNS, COLUMNS), height * at(i / COLUMNS, ROWS));
        let layers = mapper.radiance(camera.ray(place), None, 0, &mut stream).0;
        grey(layers.indirect + layers.multiple)
    };
    Ok((0..PIXELS).map(pixel).collect())
}
