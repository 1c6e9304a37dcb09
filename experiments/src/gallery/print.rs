//! Pictures at the size of print, of what the page has compared: the photon map, its medium read along rays, the rival in the same
//! time, the reference.

use super::beside::{FIRST, rivals};
use super::cache::Cache;
use super::develop::{develop, tone};
use super::keep::RenderRecord;
use super::lines::Stored;
use super::pictures::Picture;
use super::settings::Settings;
use super::shown::PageEntry;
use super::studio::Studio;
use crate::harness::{duration, say};
use anyhow::{Context, anyhow};
use serde::{Deserialize, Serialize};
use std::path::Path;
use turbid::Spectrum;

/// Columns of pixels.
const WIDTH: f64 = 960.0;
/// One in so many of the page's samples per pixel: there are up to fourteen times as many pixels, and with all samples the nine scenes would
/// take some 16 hours of CPU time: six times the page's seconds by the ratio of pixels.
const FEWER: u64 = 4;
/// Passes of the reference, each of the rival's method and samples, so that its error is half of the rival's; a stopped run loses a part of
/// one.
const PASSES: u64 = 4;

/// How the pictures of a scene were made.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Printed {
    /// Columns and rows of pixels.
    pub size: (usize, usize),
    /// The photon mapper's picture.
    pub ours: RenderRecord,
    /// The same with its medium read along whole rays, by the name of the file.
    #[serde(default)]
    pub along: Vec<(String, RenderRecord)>,
    /// The rival's name.
    pub rival: String,
    /// Its picture in the same time.
    pub equal: RenderRecord,
    /// Samples per pixel and CPU seconds of the reference.
    pub reference: (u64, f64),
    /// The method of the reference; older pictures do not tell it.
    #[serde(default)]
    pub by: Option<String>,
}

/// Makes the pictures of one scene.
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
    let grid = studio.grid();
    let write = |kind: &str, radiance: &[Spectrum]| {
        let file = folder.join(format!("{}-{kind}.png", picture.name));
        develop(grid, radiance, tone(picture.exposure)).write(&file)
    };
    let ours = cache.photons("photons", picture.samples.div_ceil(FEWER), 0)?;
    write("photons", &ours.total)?;
    let mut along = Vec::new();
    for of in Stored::of(picture) {
        let render = cache.lines(of, &ours.facts)?;
        write(of.1.kind(), &render.total)?;
        along.push((of.1.kind().to_string(), render.facts));
    }
    let equal = cache.rival("equal", rival, ours.facts.seconds)?;
    write("rival", &equal.total)?;
    let mut reference = vec![Spectrum::ZERO; grid.pixels()];
    let mut seconds = 0.0;
    for n in 0..PASSES {
        let pass = cache.reference(&format!("reference-{n:02}"), rival, equal.facts.samples, FIRST.0 + n)?;
        seconds += pass.facts.seconds;
        reference.iter_mut().zip(&pass.total).for_each(|(sum, x)| *sum += *x * (1.0 / PASSES as f64));
    }
    write("reference", &reference)?;
    let beside = along.iter().map(|(_, facts)| facts.seconds).sum::<f64>();
    let all = ours.facts.seconds + beside + equal.facts.seconds + seconds;
    say(&format!("{}: {} of CPU time", picture.name, duration(all)));
    Ok(Printed {
        size: (grid.width, grid.height),
        ours: ours.facts,
        along,
        rival: compared.rival.clone(),
        reference: (equal.facts.samples * PASSES, seconds),
        by: Some(rival.name().to_string()),
        equal: equal.facts,
    })
}
