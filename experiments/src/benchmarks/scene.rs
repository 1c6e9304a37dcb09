//! What a set asks the simulator with: scenes that are kept beside the page, and how many histories.

use super::comparison::{Comparison, Row};
use anyhow::{Context, bail};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::Guides;
use turbid::scene::{Orders, Scene, SceneFile};
use turbid::sensor::{
    Measurement, PathSettings, PhotonSettings, TallySettings, by_guided_paths, by_paths, by_photons,
    by_tallies,
};
use turbid::transport::{NoProgress, WeightWindows};
use turbid_analytic::Value;

/// Larger tables are none.
const MOST_BYTES: u64 = 1 << 26;

/// A run of the benchmarks, as a set sees it.
pub struct Bench {
    /// Folder of the scenes.
    scenes: PathBuf,
    is_quick: bool,
    seed: u64,
    /// A file with numbers of another code.
    theirs: Option<PathBuf>,
    /// Questions asked: each has random numbers of its own.
    asked: AtomicU64,
}

impl Bench {
    /// A run of one set, whose scenes are kept in a folder.
    pub(super) fn new(scenes: PathBuf, is_quick: bool, seed: u64, theirs: Option<PathBuf>) -> Self {
        Bench { scenes, is_quick, seed, theirs, asked: AtomicU64::new(0) }
    }

    /// One of two numbers: that of a quick run, or that of a full one.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        if self.is_quick { quick } else { full }
    }

    /// Seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Numbers of another code, if the user has a file of them: its name and its text.
    ///
    /// # Errors
    /// If it cannot be read
    pub fn theirs(&self) -> anyhow::Result<Option<(String, String)>> {
        let Some(path) = &self.theirs else { return Ok(None) };
        let name = path.display().to_string();
        let text = turbid::input::read(path, MOST_BYTES).with_context(|| name.clone())?;
        Ok(Some((name.clone(), String::from_utf8(text).with_context(|| format!("{name}: not UTF-8"))?)))
    }

    /// Keeps a file that a scene reads.
    ///
    /// # Errors
    /// If it cannot be written
    pub fn file(&self, name: &str, text: &str) -> anyhow::Result<()> {
        keep(&self.scenes, name, text)
    }

    /// Keeps a scene as a file, and reads it.
    ///
    /// # Errors
    /// If it cannot be written, or is none
    pub fn scene(&self, name: &str, text: &str) -> anyhow::Result<Scene> {
        let file = format!("{name}.toml");
        keep(&self.scenes, &file, text)?;
        let read = SceneFile::from_toml(text).with_context(|| file.clone())?;
        read.scene(&self.scenes).context(file)
    }

    fn replicate(&self) -> u64 {
        self.asked.fetch_add(1, Ordering::Relaxed)
    }

    /// A scene that is not kept.
    ///
    /// # Errors
    /// If it is none
    pub fn parsed(&self, text: &str) -> anyhow::Result<Scene> {
        Ok(SceneFile::from_toml(text)?.scene(&self.scenes)?)
    }

    /// Every sensor of a scene by paths.
    ///
    /// # Errors
    /// Those of the path tracer
    pub fn paths(&self, scene: &Scene, samples: u64) -> anyhow::Result<Vec<Measurement>> {
        let settings =
            PathSettings { samples, seed: self.seed, replicate: self.replicate(), orders: Orders::ALL };
        Ok(by_paths(scene, &settings, &NoProgress)?)
    }

    /// The same by paths that weight windows lead to the lights.
    ///
    /// # Errors
    /// Those of the path tracer
    pub fn windowed_paths(&self, scene: &Scene, samples: u64) -> anyhow::Result<Vec<Measurement>> {
        let settings =
            PathSettings { samples, seed: self.seed, replicate: self.replicate(), orders: Orders::ALL };
        let windows = WeightWindows::new(scene)?;
        let guides = Guides { windows: Some(&windows), learned: None };
        Ok(by_guided_paths(scene, &settings, guides, &NoProgress)?)
    }

    /// Every sensor of a scene by 64 photon maps of so many photons, counted evenly in balls of this radius.
    ///
    /// # Errors
    /// Those of the photon pass
    pub fn maps(&self, scene: &Scene, photons: u64, radius: f64) -> anyhow::Result<Vec<Measurement>> {
        let settings = PhotonSettings {
            photons,
            maps: 64,
            seed: self.seed.wrapping_add(self.replicate() << 32),
            orders: Orders::ALL,
            estimator: Estimator::new(Kernel::Uniform, Gather::radius(radius)?),
        };
        Ok(by_photons(scene, &settings, &NoProgress)?.measurements)
    }

    /// Every sensor of a scene by each of 64 independent photon maps of so many photons, counted evenly in balls of this radius,
    /// photons beyond faces being none: for means over sensors that share photons.
    ///
    /// # Errors
    /// Those of the photon pass
    pub fn each_map(&self, scene: &Scene, photons: u64, radius: f64) -> anyhow::Result<Vec<Vec<f64>>> {
        let seed = self.seed.wrapping_add(self.replicate() << 32);
        let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
        let of = |map: u64| {
            let seed = seed.wrapping_add(map);
            let settings = PhotonSettings { photons, maps: 1, seed, orders: Orders::ALL, estimator };
            let found = by_photons(scene, &settings, &NoProgress)?.measurements;
            Ok(found.iter().map(|m| m.mean).collect())
        };
        (0..64).into_par_iter().map(of).collect()
    }

    /// Every sensor of a scene by light tracing.
    ///
    /// # Errors
    /// Those of the photon pass
    pub fn light(&self, scene: &Scene, photons: u64) -> anyhow::Result<Vec<Measurement>> {
        self.light_of(scene, photons, self.replicate() << 32)
    }

    /// The same for one of many scenes, which each have a number.
    ///
    /// # Errors
    /// Those of the photon pass
    pub fn light_of(&self, scene: &Scene, photons: u64, number: u64) -> anyhow::Result<Vec<Measurement>> {
        let seed = self.seed.wrapping_add(number);
        let settings = TallySettings { photons, seed, orders: Orders::ALL };
        Ok(by_tallies(scene, &settings, &NoProgress)?.measurements)
    }
}

fn keep(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    Ok(turbid::output::write_atomically(folder.join(name), |out| out.write_all(text.as_bytes()))?)
}

/// An exact value as ours of a row.
pub fn exact(value: Value) -> (f64, Option<f64>) {
    (value.value, Some(value.error))
}

/// A measured value as ours of a row.
pub fn measured(m: &Measurement) -> (f64, Option<f64>) {
    (m.mean, m.std_error)
}

/// A comparison with the time that it took.
///
/// # Errors
/// Those of the rows
pub fn timed(by: &str, rows: impl FnOnce() -> anyhow::Result<Vec<Row>>) -> anyhow::Result<Comparison> {
    let start = Instant::now();
    let rows = rows()?;
    let wrong = rows
        .iter()
        .find(|row| !row.ours.is_finite() || row.our_error.is_some_and(|error| !error.is_finite()));
    if let Some(row) = wrong {
        bail!("{by}, {}, {}: {} is not a finite number", row.case, row.quantity, row.ours);
    }
    Ok(Comparison { by: by.to_string(), rows, seconds: start.elapsed().as_secs_f64() })
}
