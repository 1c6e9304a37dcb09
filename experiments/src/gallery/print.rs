//! Pictures at the size of print, of what the page has compared: the photon map, its rival in the same time, the reference.

use super::beside::{FIRST, rivals};
use super::cache::Cache;
use super::develop::{develop, tone};
use super::keep::RenderRecord;
use super::pictures::Picture;
use super::settings::Settings;
use super::shown::PageEntry;
use super::studio::Studio;
use crate::harness::{duration, say};
use anyhow::{Context, anyhow};
use serde::Serialize;
use std::path::Path;
use turbid::Spectrum;

/// Columns of pixels.
const WIDTH: f64 = 960.0;
/// Passes of the reference: a stopped run loses a part of one.
const PASSES: u64 = 16;

/// How three pictures were made.
#[derive(Debug, Clone, Serialize)]
pub struct Printed {
    /// Columns and rows of pixels.
    size: (usize, usize),
    /// The photon mapper's picture.
    ours: RenderRecord,
    /// The rival's name.
    rival: String,
    /// Its picture in the same time.
    equal: RenderRecord,
    /// Samples per pixel and CPU seconds of the reference.
    reference: (u64, f64),
}

/// Makes the three pictures of one scene.
///
/// # Arguments
/// `page` what the gallery's page has found for it; `folder` of the pictures
///
/// # Errors
/// where the page has compared nothing; those of rendering and of files
pub fn print(
    picture: &Picture,
    page: &PageEntry,
    settings: &Settings,
    folder: &Path,
    program: &str,
) -> anyhow::Result<Printed> {
    let of_page = Studio::open(picture, &settings.scenes, 1.0, settings.seed, program)?;
    let scale = WIDTH / f64::from(of_page.camera.width());
    let studio = Studio::open(picture, &settings.scenes, scale, settings.seed, program)?;
    let cache = Cache { settings, folder: settings.cache().join(picture.name), studio: &studio };
    let compared = page.compared.as_ref().context("the page has no comparison of it")?;
    let rival = rivals(&studio)
        .into_iter()
        .find(|method| method.name() == compared.rival)
        .ok_or_else(|| anyhow!("the page's rival, {}, is none that the scene permits", compared.rival))?;
    let ours = cache.photons("photons", picture.samples, 0)?;
    let equal = cache.rival("equal", rival, ours.facts.seconds)?;
    // As many samples per pixel as the page's reference has, and never fewer than what stands beside it.
    let wanted = page.reference.map_or(0, |(samples, _)| samples).max(equal.facts.samples + 1);
    let samples = wanted.div_ceil(PASSES);
    let mut reference = vec![Spectrum::ZERO; studio.grid().pixels()];
    let mut seconds = 0.0;
    for n in 0..PASSES {
        let pass = cache.reference(&format!("reference-{n:02}"), samples, FIRST.0 + n)?;
        seconds += pass.facts.seconds;
        reference.iter_mut().zip(&pass.total).for_each(|(sum, x)| *sum += *x * (1.0 / PASSES as f64));
    }
    let grid = studio.grid();
    for (kind, radiance) in [("photons", &ours.total), ("rival", &equal.total), ("reference", &reference)] {
        let file = folder.join(format!("{}-{kind}.png", picture.name));
        develop(grid, radiance, tone(picture.exposure)).write(&file)?;
    }
    let all = ours.facts.seconds + equal.facts.seconds + seconds;
    say(&format!("{}: {} of CPU time", picture.name, duration(all)));
    Ok(Printed {
        size: (grid.width, grid.height),
        ours: ours.facts,
        rival: compared.rival.clone(),
        equal: equal.facts,
        reference: (samples * PASSES, seconds),
    })
}
