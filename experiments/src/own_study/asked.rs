//! The study that a file asks, read once.

use super::file::StudyFile;
use super::points::{self, Point};
use super::reference::Reference;
use crate::harness::{Question, Settings};
use anyhow::{Context, bail, ensure};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A study that was read.
pub struct OwnStudy {
    /// What the file says.
    pub file: StudyFile,
    /// Photons emitted a map, rising.
    pub photons: Vec<u64>,
    /// Independent maps of each number.
    pub maps: u64,
    /// The scenes.
    pub points: Vec<Point>,
    /// What the maps of each point are compared with.
    pub references: Vec<Reference>,
}

/// Most cells, and most numbers in all of them.
const MOST_CELLS: u64 = 100_000;
const MOST_NUMBERS: f64 = 3e7;

impl OwnStudy {
    fn read(question: &Question, settings: &Settings) -> anyhow::Result<Self> {
        let name = question.path.display().to_string();
        let file = StudyFile::read(&name, &question.text)?;
        let folder = question.path.parent().unwrap_or(Path::new(""));
        let mut photons: Vec<u64> = settings
            .sizes(&file.photons.iter().map(|n| (n.0, 0)).collect::<Vec<_>>())
            .iter()
            .map(|s| s.0)
            .collect();
        photons.sort_unstable();
        ensure!(
            photons.windows(2).all(|pair| pair[0] != pair[1]),
            "{name}: photons names one number twice, or --photons makes two of them one"
        );
        let scenes = file.axes.values().try_fold(1u64, |n, values| n.checked_mul(values.len() as u64));
        let cells =
            scenes.and_then(|n| n.checked_mul(photons.len() as u64)).and_then(|n| n.checked_mul(file.maps.0));
        match cells {
            Some(cells) if cells <= MOST_CELLS => {}
            _ => bail!(
                "{name}: axes, photons and maps are {} runs; allowed: up to {MOST_CELLS}",
                cells.map_or("more than 1.8e19".to_string(), |cells| cells.to_string())
            ),
        }
        let points = points::points(&file, folder).with_context(|| name.clone())?;
        let numbers: f64 = points.iter().map(|p| (p.places.len() * p.estimators.len()) as f64).sum::<f64>()
            * photons.len() as f64
            * file.maps.0 as f64;
        ensure!(
            numbers <= MOST_NUMBERS,
            "{name}: places, estimators and runs make {numbers:.1e} numbers; allowed: up to {MOST_NUMBERS:.0e}"
        );
        let reference =
            |(number, point)| Reference::plan(&file, point, number, settings).with_context(|| name.clone());
        let references = points.iter().enumerate().map(reference).collect::<anyhow::Result<_>>()?;
        Ok(OwnStudy { maps: file.maps.0, photons, points, references, file })
    }
}

/// What a study depends on: the digest of its files, its seed, its factor on photons.
type Key = (String, u64, u64);

/// The study that the settings ask, read once.
pub fn asked(settings: &Settings) -> anyhow::Result<Arc<OwnStudy>> {
    static STUDY: Mutex<Option<(Key, Arc<OwnStudy>)>> = Mutex::new(None);
    let question = settings.question.as_ref().context("no file asks anything")?;
    let key = (question.digest.clone(), settings.seed, settings.photon_scale.to_bits());
    let mut known = STUDY.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, study)) = &*known
        && *of == key
    {
        return Ok(study.clone());
    }
    let study = Arc::new(OwnStudy::read(question, settings)?);
    *known = Some((key, study.clone()));
    Ok(study)
}
