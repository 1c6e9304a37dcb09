//! The whole run: makings, comparison, plates, page.

use super::compare::{Making, average, compare, errors};
use super::develop::{Print, SOFT, develop, error_print, exposure};
use super::dots::dots;
use super::keep::{Facts, Kept};
use super::look::look;
use super::pictures::{ALL, Beside, Picture};
use super::predict::{Radii, predicted, radius};
use super::settings::Settings;
use super::shown::{Compared, Plate, Shown};
use super::studio::Studio;
use super::{assets, page};
use crate::harness::{duration, program_digest, say};
use anyhow::Context;
use clap::Parser;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use turbid::Spectrum;
use turbid::output::write_atomically;
use turbid::stats::Interval;
use turbid::transport::Progress;

/// The most photons that are emitted for the making from which blur is predicted, and how many times the original's at most.
const FINE: (u64, u64) = (40_000_000, 16);
/// Makings of either side that are compared.
const COMPARED: u64 = super::compare::FEWEST as u64;
/// Half of them.
const HALF: usize = super::compare::FEWEST / 2;
/// Predicted relative error above which a pixel is masked.
const LIMIT: f64 = 0.02;
/// Ends of the scale of relative errors.
const SCALE: f64 = 0.2;

/// Runs the gallery as a program.
pub fn main() -> ExitCode {
    let settings = match Settings::try_parse() {
        Ok(settings) => settings,
        Err(error) if !error.use_stderr() => {
            let written = turbid::output::print(|out| write!(out, "{error}"));
            return ExitCode::from(if written.is_ok() { 0 } else { 2 });
        }
        Err(error) => {
            say(error.to_string().trim_end());
            return ExitCode::from(2);
        }
    };
    let threads = settings.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads");
    match pool.and_then(|pool| pool.install(|| run(&settings))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error:#}"));
            ExitCode::from(2)
        }
    }
}

fn run(settings: &Settings) -> anyhow::Result<()> {
    if settings.assets {
        write(&settings.scenes.join("fogbox/het.vol"), &assets::fogbox_het()?)?;
        return write(&settings.scenes.join("window.png"), &assets::window()?);
    }
    let folder = settings.folder();
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let program = program_digest()?.to_string();
    let chosen = |p: &&Picture| settings.only.is_empty() || settings.only.iter().any(|n| n == p.name);
    for picture in ALL.iter().filter(chosen) {
        let shown = one(picture, settings, &folder, &program).with_context(|| picture.name.to_string())?;
        write(&folder.join(format!("{}.json", picture.name)), &serde_json::to_vec_pretty(&shown)?)?;
        let page = page::page(&all_shown(&folder)?, settings).into_string();
        write(&folder.join("index.html"), page.as_bytes())?;
    }
    say(&format!("the page is {}", folder.join("index.html").display()));
    Ok(())
}

/// What is there of all pictures, those of earlier runs too.
fn all_shown(folder: &Path) -> anyhow::Result<Vec<Shown>> {
    let mut found = Vec::new();
    for picture in ALL {
        let path = folder.join(format!("{}.json", picture.name));
        if let Ok(text) = std::fs::read_to_string(&path) {
            found.push(serde_json::from_str(&text).with_context(|| path.display().to_string())?);
        }
    }
    Ok(found)
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    Ok(write_atomically(path, |out| out.write_all(bytes))?)
}

/// The makings of one picture, kept in a folder.
struct Makings<'a> {
    settings: &'a Settings,
    folder: PathBuf,
    studio: &'a Studio<'a>,
}

impl Makings<'_> {
    /// A making from its file, or made now and kept.
    fn get(
        &self,
        file: &str,
        words: &str,
        work: u64,
        make: impl FnOnce(&Bar) -> anyhow::Result<Kept>,
    ) -> anyhow::Result<Kept> {
        let path = self.folder.join(format!("{file}.picture"));
        if !self.settings.fresh
            && let Ok(kept) = Kept::read(&path, self.studio.grid().pixels())
            && kept.facts.words == words
            && (self.settings.reuse || kept.facts.program == self.studio.program)
        {
            return Ok(kept);
        }
        let mut kept = make(&Bar::new(&format!("{}, {file}", self.studio.picture.name), work))?;
        kept.facts.words = words.to_string();
        kept.write(&path)?;
        Ok(kept)
    }

    fn paths(&self, file: &str, samples: u64, replicate: u64) -> anyhow::Result<Kept> {
        let (s, work) = (self.studio, self.studio.work(samples));
        self.get(file, &s.path_words(samples, replicate), work, |bar| s.paths(samples, replicate, bar))
    }

    fn photons(&self, file: &str, samples: u64, replicate: u64, factor: u64) -> anyhow::Result<Kept> {
        let (s, work) = (self.studio, self.studio.work(samples));
        let words = s.photon_words(samples, replicate, factor);
        self.get(file, &words, work, |bar| s.photons(samples, replicate, factor, bar))
    }
}

/// Everything of one picture.
fn one(picture: &Picture, settings: &Settings, folder: &Path, program: &str) -> anyhow::Result<Shown> {
    let studio = Studio::open(picture, &settings.scenes, settings.scale(), settings.seed, program)?;
    let makings = Makings { settings, folder: settings.makings().join(picture.name), studio: &studio };
    std::fs::create_dir_all(&makings.folder)?;
    let ours = makings.photons("photons", picture.samples, 0, 1)?;
    let beside = if settings.draft { None } else { Some(beside(&makings, &ours)?) };
    let plates = plates(&studio, folder, &ours, beside.as_ref())?;
    Ok(Shown {
        name: picture.name.to_string(),
        command: command(picture),
        size: (studio.grid().width, studio.grid().height),
        ours: ours.facts,
        equal: beside.as_ref().map(|b| b.equal.facts.clone()),
        twin: beside.as_ref().map(|b| b.cost),
        compared: beside.map(|b| b.compared),
        plates,
    })
}

/// What stands beside the photon mapper's picture.
struct Others {
    /// The path tracer's picture in the same time.
    equal: Kept,
    /// The twin, its samples a pixel and its CPU seconds.
    twin: Making,
    cost: (u64, f64),
    /// Which pixels were masked.
    masked: Vec<bool>,
    compared: Compared,
}

fn beside(makings: &Makings, ours: &Kept) -> anyhow::Result<Others> {
    let (studio, picture) = (makings.studio, makings.studio.picture);
    let words = format!("{} in {} s", studio.path_words(0, 0), ours.facts.seconds);
    let equal = makings.get("equal", &words, 0, |bar| studio.paths_for(ours.facts.seconds, 0, bar))?;
    let samples = (picture.twin / if makings.settings.quick { 8 } else { 2 }).max(2);
    let ours_samples = (picture.samples / 8).max(1);
    let Both { ours: again, twin, shown, seconds } = both(makings, ours_samples, samples)?;
    let prediction = predict(makings, ours)?;
    let comparison = compare(studio.grid(), &again, &twin, &prediction, LIMIT);
    let found = errors(&again, &twin);
    let rms = errors(&[ours.scattered(), ours.scattered()], &twin).rms.low;
    // Paths have no error that stays: that of a pass, for the number of samples that fitted into the time.
    let pass = errors(&twin[..HALF], &twin[HALF..]).rms;
    let factor = (samples as f64 / equal.facts.samples as f64).sqrt();
    let equal_rms = Interval { low: factor * pass.low, high: factor * pass.high };
    Ok(Others {
        equal,
        twin: shown,
        cost: (samples * twin.len() as u64, seconds),
        masked: prediction.iter().map(|&e| e > LIMIT).collect(),
        compared: Compared::new(&comparison, &found, (again.len(), ours_samples), rms, equal_rms),
    })
}

/// Independent makings of both sides, without light that is seen directly.
struct Both {
    ours: Vec<Making>,
    twin: Vec<Making>,
    /// The twin's picture with that light.
    shown: Making,
    /// CPU seconds of the twin.
    seconds: f64,
}

fn both(makings: &Makings, ours: u64, samples: u64) -> anyhow::Result<Both> {
    let ours = (0..COMPARED)
        .map(|n| Ok(makings.photons(&format!("maps-{n:03}"), ours, 1 + n, 1)?.scattered()))
        .collect::<anyhow::Result<Vec<Making>>>()?;
    let (mut twin, mut seen, mut seconds) = (Vec::new(), Vec::new(), 0.0);
    for n in 0..COMPARED {
        let kept = makings.paths(&format!("twin-{n:03}"), samples, 1 + n)?;
        seconds += kept.facts.seconds;
        twin.push(kept.scattered());
        seen.push(kept.layers.iter().map(|l| l.emission).collect());
    }
    let sum = |(a, b): (&Spectrum, &Spectrum)| *a + *b;
    let shown = average(twin.iter()).iter().zip(&average(seen.iter())).map(sum).collect();
    Ok(Both { ours, twin, shown, seconds })
}

/// The relative error that blur and edges may cause, by pixel.
fn predict(makings: &Makings, ours: &Kept) -> anyhow::Result<Vec<f64>> {
    let (studio, picture) = (makings.studio, makings.studio.picture);
    let emitted = ours.facts.emitted;
    let factor = (FINE.0 / emitted[0].max(emitted[1]).max(1)).clamp(2, FINE.1);
    let fine = makings.photons("fine", picture.samples.max(4), 1 + COMPARED, factor)?;
    let power = studio.scene.power().sum();
    let [_, _, volume] = ours.facts.radii;
    let radii: Vec<Radii> = fine
        .layers
        .iter()
        .map(|l| {
            let reach = |map: usize, radiance: Spectrum| {
                let each = power / emitted[map].max(1) as f64;
                radius(picture.nearest[map], each, radiance.sum(), 0.1 * picture.size)
            };
            let seen = if picture.gather == 0 { reach(0, l.indirect) } else { 0.0 };
            let caustic = if emitted[1] > 0 { reach(1, l.caustic) } else { 0.0 };
            Radii { global: seen, caustic, volume }
        })
        .collect();
    let views = look(&studio.scene, &studio.camera, |i| radii[i].global.max(radii[i].caustic));
    Ok(predicted(studio.grid(), &views, &fine.layers, &radii, studio.camera.pixel_area().sqrt()))
}

fn plates(
    studio: &Studio,
    folder: &Path,
    ours: &Kept,
    others: Option<&Others>,
) -> anyhow::Result<Vec<Plate>> {
    let (picture, grid) = (studio.picture, studio.grid());
    let mut plates = Vec::new();
    let mut plate = |kind: &str, caption: String, print: &Print| -> anyhow::Result<()> {
        let file = format!("{}-{kind}.png", picture.name);
        write(&folder.join(&file), &print.png()?)?;
        plates.push(Plate { file, caption });
        Ok(())
    };
    let exposed = |radiance: &[Spectrum]| develop(grid, radiance, picture.exposure);
    let told = |method: &str, facts: &Facts| {
        format!("{method}, {} samples a pixel, {}", facts.samples, duration(facts.seconds))
    };
    plate("photons", told("Photon maps", &ours.facts), &exposed(&ours.total))?;
    if let Some(Others { equal, twin, masked, .. }) = others {
        plate("paths", told("Paths", &equal.facts), &exposed(&equal.total))?;
        plate("twin", "The twin: paths, converged".to_string(), &exposed(twin))?;
        let print = error_print(grid, &ours.total, twin, Some(masked), SCALE);
        let caption = format!(
            "Photon maps minus twin, relative, means over {SOFT} by {SOFT} pixels: blue too dark, red too bright, \
             grey masked beforehand"
        );
        plate("error", caption, &print)?;
    }
    match picture.beside {
        Beside::Single => {
            let single: Making = ours.layers.iter().map(|l| l.emission + l.direct + l.single).collect();
            plate("single", "Single scattering alone".to_string(), &exposed(&single))?;
        }
        Beside::Maps => {
            let maps = studio.maps(0, 1)?;
            let all = [("global", &maps.global), ("caustic", &maps.caustic), ("volume", &maps.volume)];
            for (name, map) in all {
                if let Some(map) = map.as_ref().filter(|map| map.stored() > 1000) {
                    let picture = dots(&studio.scene, &studio.camera, std::iter::once(map));
                    let caption = format!("The {name} map: {} photons", map.stored());
                    plate(name, caption, &develop(grid, &picture, exposure(&picture).min(0.6)))?;
                }
            }
        }
    }
    Ok(plates)
}

/// The command that renders a picture as EXR.
fn command(picture: &Picture) -> String {
    let [global, caustic, volume] = picture.nearest;
    format!(
        "turbid render experiments/scenes/{0}.toml -o {0}.exr --with photons --samples {1}  # k = {global}, {caustic}, {volume}",
        picture.name, picture.samples
    )
}

/// Progress with remaining time, on standard error, a line every ten seconds.
struct Bar {
    what: String,
    total: u64,
    done: AtomicU64,
    start: Instant,
    told: AtomicU64,
}

impl Bar {
    fn new(what: &str, total: u64) -> Self {
        Bar { what: what.to_string(), total, done: 0.into(), start: Instant::now(), told: 0.into() }
    }
}

impl Progress for Bar {
    fn advance(&self, histories: u64) {
        let done = self.done.fetch_add(histories, Ordering::Relaxed) + histories;
        let spent = self.start.elapsed();
        let tens = spent.as_secs() / 10;
        if self.told.fetch_max(tens, Ordering::Relaxed) < tens {
            let left = if self.total == 0 {
                String::new()
            } else {
                let share = (done as f64 / self.total as f64).min(1.0);
                let left = Duration::as_secs_f64(&spent) * (1.0 - share) / share.max(1e-9);
                format!(", {:.0} %, about {} left", 100.0 * share, duration(left))
            };
            say(&format!("  {}{left}", self.what));
        }
    }
}
