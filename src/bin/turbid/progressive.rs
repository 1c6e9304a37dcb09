//! `turbid render --progressive`: as many maps as one likes, radii that shrink from map to map, and a picture that can be resumed.

use super::made::{Made, MapsMade, Stages};
use super::memory::Memory;
use super::notes::tell_empty;
use super::picture::{Held, Photons, Readout};
use super::progress::Bar;
use super::provenance::mapper_settings;
use super::shared::note;
use super::state::{FOUND, State};
use super::statistics::MAPS;
use anyhow::bail;
use cpu_time::ProcessTime;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use turbid::estimators::Gather;
use turbid::integrators::mapper::{Gathers, Mapper, Report, Settings};
use turbid::photons::Part;
use turbid::photons::importance::Importance;
use turbid::photons::maps::{Emitted, MapSettings, Maps, fill_part};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Blocks, Film, Method, Streams};
use turbid::transport::{NoProgress, Progress};

/// Whether radii shrink, and where the picture is kept.
#[derive(clap::Args)]
pub struct Progressive {
    /// Shrink fixed radii from map to map, so that the mean over maps converges to the light itself, in the memory of one map: as
    /// the number of maps to the power -1/7 in the volume, -1/6 on surfaces and about rays, -1/5 about beams. Takes as many maps
    /// as --seconds allow, or --maps. Without --radius the first radii are those of the k nearest photons in a pilot, where most of
    /// them are.
    #[arg(long = "progressive", id = "progressive")]
    pub is_asked_for: bool,
    /// Keep what a progressive picture is the mean of, written after the first map, every 20 seconds and at the end; where the file is
    /// there, resume from it: for --seconds more, or until there are --maps. The same bits as a run that was never stopped. A run
    /// that is killed loses 20 seconds at most; --maps 2 makes a picture of what its state holds. A second run on a state that one is
    /// at work on is refused.
    #[arg(long, value_name = "FILE", requires = "progressive")]
    pub state: Option<PathBuf>,
}

/// Samples a pixel of each map, where their number is not given: there are many maps.
const SAMPLES: u64 = 1;

/// Pixels of the pilot, about: its radii are means over all of them.
const PILOT_PIXELS: f64 = 4096.0;

/// The map of the pilot, which no picture has.
const PILOT: u64 = u64::MAX;

/// Time between two writings of the state.
const EVERY: Duration = Duration::from_secs(20);

/// A radius that a map cannot tell from none.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct TooSmall(turbid::Error);

/// A sequence of maps: what it is made of, and how far it goes.
pub struct Sequence<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub photons: &'a Photons,
    pub readout: &'a Readout,
    pub memory: &'a Memory,
    /// How maps are read, as it is asked for.
    pub usual: Settings,
    /// Bytes beside the maps.
    pub fixed: f64,
    pub seed: u64,
    pub samples: Option<u64>,
    /// Maps in all, or the time of processors \[s\].
    pub until: Until,
    pub state: Option<&'a Path>,
    /// Whether block means of each map are kept.
    pub is_compared: bool,
}

/// How far a sequence goes.
#[derive(Clone, Copy)]
pub enum Until {
    /// So many maps in all.
    Maps(u64),
    /// So long \[s of processors\].
    Seconds(f64),
}

impl Until {
    /// What is asked for: one of the two, and at least the two maps that an error bar takes.
    pub fn asked(maps: Option<u64>, seconds: Option<f64>) -> anyhow::Result<Self> {
        match (maps, seconds) {
            (Some(_), Some(_)) => bail!("--progressive has both --maps and --seconds; allowed: one of them"),
            (None, None) => {
                bail!("--progressive needs an end; allowed: --seconds, such as 60, or --maps, at least 2")
            }
            (Some(maps), None) if !(2..=u64::from(u32::MAX)).contains(&maps) => bail!(
                "--maps is {maps}; allowed with --progressive: 2 to 4294967295, since its error is that between maps"
            ),
            (Some(maps), None) => Ok(Until::Maps(maps)),
            (None, Some(seconds)) => Ok(Until::Seconds(seconds)),
        }
    }
}

/// What the maps of a sequence share.
struct Shared {
    maps: MapSettings,
    importance: Option<Importance>,
    emitted: Emitted,
    /// How the first map is read.
    first: Settings,
}

impl Sequence<'_> {
    /// Samples a pixel of each map.
    pub fn samples(&self) -> u64 {
        self.samples.unwrap_or(SAMPLES)
    }

    /// Makes the maps, each read once, and the picture that is their mean.
    ///
    /// # Arguments
    /// `made_from` what the state must have been made from, beside what a pilot finds
    pub fn make(&self, mut made_from: serde_json::Value) -> anyhow::Result<Made> {
        let start = ProcessTime::now();
        let (width, height) = (self.camera.width(), self.camera.height());
        let mut made = Made {
            film: Film::new(0, 0),
            repetitions: 0,
            total_samples: 0,
            samples: Vec::new(),
            first_read: None,
            work: Report::default(),
            maps: Vec::new(),
            stages: Stages::default(),
            block_means: Vec::new(),
            is_by_light: false,
        };
        let shared = self.shared(&mut made.stages)?;
        made.first_read = Some(shared.first);
        let [emitted, radii] = FOUND;
        made_from[emitted] = serde_json::json!(shared.emitted.histories());
        made_from[radii] = mapper_settings(&shared.first);
        let made_from = &made_from;
        let mut state = match self.state {
            Some(file) if file.exists() => State::read(file, (width, height), made_from)?,
            _ => State::new(width, height),
        };
        let before = state.film.samples();
        let began = start.elapsed().as_secs_f64();
        let (bar, mut kept) = (self.bar(before, began), Instant::now());
        let mut spent = began;
        loop {
            let done = state.film.samples();
            let of_this_run = done - before;
            let is_enough = match self.until {
                Until::Maps(maps) => done >= maps,
                // As much again as the mean map took.
                Until::Seconds(seconds) => {
                    done >= 2 && of_this_run >= 1 && spent + (spent - began) / of_this_run as f64 > seconds
                }
            };
            if is_enough {
                break;
            }
            let settings = shared.first.in_map(done);
            let (film, maps_made) = match self.one(&shared, &settings, done, &mut made) {
                // What there is stays.
                Err(error) if done >= 2 && error.downcast_ref::<TooSmall>().is_some() => {
                    note(&format!("{error:#}; the picture is that of {done} maps"))?;
                    break;
                }
                made => made?,
            };
            if self.is_compared {
                made.block_means.push(Blocks::of(width, height).means(&film));
            }
            state.film.push_film(&film);
            if done == 0 {
                tell_empty(&maps_made.filled)?;
                self.photons.tell_sparse(&maps_made.filled)?;
            }
            // The first and the last say how all were filled and read.
            made.maps.truncate(1);
            made.maps.push(maps_made);
            let now = start.elapsed().as_secs_f64();
            bar.advance(1);
            spent = now;
            if let Some(file) = self.state.filter(|_| of_this_run == 0 || kept.elapsed() > EVERY) {
                state.write(file, made_from)?;
                kept = Instant::now();
            }
        }
        bar.finish();
        if let Some(file) = self.state {
            state.write(file, made_from)?;
            if before > 0 {
                note(&format!(
                    "{} held {before} maps, and now holds {}",
                    file.display(),
                    state.film.samples()
                ))?;
            }
        }
        made.samples = vec![self.samples()];
        made.repetitions = state.film.samples();
        made.total_samples = made.repetitions.saturating_mul(self.samples());
        made.film = state.film;
        Ok(made)
    }

    /// The bar, after so many maps and seconds.
    fn bar(&self, before: u64, spent: f64) -> Bar {
        match self.until {
            Until::Maps(maps) => Bar::stage("maps", maps.saturating_sub(before)),
            Until::Seconds(seconds) => Bar::timed("maps", seconds - spent),
        }
    }

    /// One map, and the picture from it.
    fn one(
        &self,
        shared: &Shared,
        settings: &Settings,
        number: u64,
        made: &mut Made,
    ) -> anyhow::Result<(Film, MapsMade)> {
        let streams = Streams { seed: self.seed, replicate: number };
        let maps = self.filled(shared, number, &mut made.stages)?;
        let mut film = Film::new(self.camera.width(), self.camera.height());
        let mapper = Mapper::new(self.scene, &maps, settings);
        mapper.check_radii().map_err(|error| anyhow::Error::new(TooSmall(error)))?;
        let method = Method::Photons(mapper);
        let read = || method.extend(&mut film, self.camera, self.samples(), streams, &NoProgress);
        made.work += made.stages.time("samples", read)?;
        let mut maps_made = MapsMade { number, settings: Some(*settings), ..MapsMade::default() };
        maps_made.add(&maps);
        Ok((film, maps_made))
    }

    fn filled(&self, shared: &Shared, replicate: u64, stages: &mut Stages) -> anyhow::Result<Maps> {
        let settings = MapSettings { replicate, ..shared.maps };
        let (emitted, importance) = (shared.emitted, shared.importance.as_ref());
        let fill = || fill_part(self.scene, &settings, emitted, importance, Part::WHOLE, &NoProgress);
        Ok(stages.time(MAPS, fill)?)
    }

    /// What is found out once: what leads photons, how many are sent out, and the first radii.
    fn shared(&self, stages: &mut Stages) -> anyhow::Result<Shared> {
        let maps = self.photons.settings(self.readout.indirect(), self.usual.media(), self.seed, 0);
        let importance = stages.time("pilot", || self.photons.importance(self.scene, self.camera, &maps))?;
        let emitted = stages.time("pilot", || {
            let fixed = (self.fixed, 0.0);
            let held = Held { runs: u64::MAX, ..Held::ALL };
            self.photons.forecast(self.scene, &maps, importance.as_ref(), held, self.memory, fixed)
        })?;
        let mut shared = Shared { maps, importance, emitted, first: self.usual };
        shared.first.volume.is_progressive = true;
        if self.readout.has_radius() {
            return Ok(shared);
        }
        let piloted = self.piloted(&shared, stages)?;
        let first = &mut shared.first;
        let radii = [&mut first.global.1, &mut first.caustic.1, &mut first.volume.gather];
        let mut told = Vec::new();
        for ((gather, gathers), name) in radii.into_iter().zip(piloted).zip(["global", "caustic", "volume"]) {
            // Where nothing was found there is the farthest that photons would have been taken from.
            let found = gathers.radius_by_density();
            let radius = found.unwrap_or(gather.cap());
            *gather = Gather::radius(radius)?;
            if found.is_some() && !(name == "volume" && self.usual.volume.reads_rays()) {
                told.push(format!("{radius:.3e} L in the {name} map"));
            }
        }
        if !told.is_empty() {
            note(&format!("first radii, those of the k nearest photons in a pilot: {}", told.join(", ")))?;
        }
        Ok(shared)
    }

    /// Look-ups in a global, a caustic and a volume map by the k nearest photons.
    fn piloted(&self, shared: &Shared, stages: &mut Stages) -> anyhow::Result<[Gathers; 3]> {
        let part =
            (PILOT_PIXELS / (f64::from(self.camera.width()) * f64::from(self.camera.height()))).min(1.0);
        let side = |pixels: u32| ((f64::from(pixels) * part.sqrt()) as u32).max(1);
        let (width, height) = (side(self.camera.width()), side(self.camera.height()));
        let camera = self.camera.sized(Some(width), Some(height))?;
        let maps = self.filled(shared, PILOT, stages)?;
        let mut settings = self.readout.suited(&self.usual, maps.stored())?;
        // Balls say what a radius may be; tubes have theirs by what is asked for.
        settings.volume.ray_radius = None;
        let method = Method::Photons(Mapper::new(self.scene, &maps, &settings));
        let mut film = Film::new(width, height);
        let streams = Streams { seed: self.seed, replicate: PILOT };
        let read = || method.extend(&mut film, &camera, 1, streams, &NoProgress);
        let Report { global, caustic, volume, .. } = stages.time("pilot", read)?;
        Ok([global, caustic, volume])
    }
}
