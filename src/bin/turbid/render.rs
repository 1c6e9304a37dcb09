//! `turbid render`: a picture of a scene, by photons, by paths, by bidirectional paths or by light tracing.

use super::compare::Compared;
use super::learn::learn;
use super::load::Source;
use super::made::{Filled, Made, MapsMade, Stages};
use super::memory::Memory;
use super::notes::{tell_empty, tell_gathers, tell_planes, tell_step, tell_variances};
use super::options;
use super::picture::{Frame, Held, Photons, Readout, ToneArgs};
use super::progress::Bar;
use super::progressive::{Progressive, Sequence, Until};
use super::provenance::{map_settings, mapper_settings};
use super::revision::revision;
use super::shared::{note, on_threads, parse_count, print, whole};
use super::statistics::{LEARNING, MAPS, print_statistics};
use anyhow::{Context, bail};
use clap::{ArgMatches, ValueEnum};
use cpu_time::ProcessTime;
use std::ops::AddAssign;
use std::path::{Path, PathBuf};
use turbid::integrators::mapper::{Mapper, Report, Settings};
use turbid::output::{Tone, auto_exposure, check_writable, is_same_file, one_line, write_exr, write_png};
use turbid::photons::maps::{MediumSamples, fill_part};
use turbid::photons::{MOST_HISTORIES, Part};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Blocks, Film, LIGHT_BYTES, LIGHT_PIXEL_BYTES, Method, PictureError, Streams};
use turbid::transport::Progress;

/// Draw the picture that a scene's camera sees, by photon maps, by paths, by bidirectional paths or by light tracing.
///
/// Writes an OpenEXR file in linear light and a PNG beside it to look at. The EXR has the channels R G B; a layer for each
/// class of light's path (emission.R, direct.R, caustic.R, indirect.R, single.R, multiple.R and so on); variance.R,
/// variance.direct.R and so on, the variance of each mean; photons.N, the photons behind a sample; and in its header, under
/// `turbid`, all that the picture was made from. The scene file needs a [camera].
///
/// The path tracer is unbiased, and noisy. Photons are fast, and blurred: they are sent out once into maps, which all
/// pixels share, so that the error of one map is seen only by making several (--maps); the variance is then that between
/// maps. The classic picture is one map and a few samples: `turbid render scene.toml -o out.exr --samples 16`.
///
/// Bidirectional paths (--with bidirectional) are those of the path tracer, each of their scatterings connected to each of a photon's that
/// leaves the lights, and photons are connected to the camera: unbiased, all layers, and less noisy by far where light that is
/// scattered twice or more comes from small or hidden lamps and from beams, and in caustics that are seen straight.
///
/// Light tracing (--with light) is unbiased too, and a second witness for caustics, which paths find badly or not at all:
/// photons start from the lights and are connected to the camera at each scattering, so that --samples counts histories a
/// pixel, wherever they are seen. It holds what scatters last on a diffuse surface or in a medium that the camera sees straight
/// or through filters. The rest is black in it: lights and emitting media seen directly, the whole emission layer, and all that is
/// seen in mirrors and through glass.
///
/// A first picture, without any file: `turbid render fogbox -o fog.exr --gather-rays 0`, in seconds; without the last
/// option it is clean, in minutes. Glass, mirrors and the sun make caustics, which need a light with an extent to be
/// compared with paths. SCENES.md beside the source says what a scene file may hold.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Render {
    #[command(flatten)]
    source: Source,
    /// The EXR file to write; the PNG has the same name with .png.
    #[arg(short, long)]
    output: PathBuf,
    /// Who makes the picture.
    #[arg(long = "with", value_enum, default_value = "photons")]
    with: With,
    /// What is done of all that some scenes require.
    #[arg(long, value_enum, default_value = "auto")]
    plan: PlanName,
    /// Samples a pixel, of each map; of light tracing histories a pixel [default: 16; of each map of a progressive picture 1].
    #[arg(long, value_parser = parse_count)]
    samples: Option<u64>,
    /// As many samples as this many seconds of processor time allow, maps included. The clock decides: the number taken
    /// is printed, and --samples with it, or --maps of a progressive picture, repeats it bit by bit.
    #[arg(long)]
    seconds: Option<f64>,
    /// Independent repetitions, with maps of their own if it is by photons; the picture is their mean [default: 1].
    #[arg(long, value_parser = parse_count)]
    maps: Option<u64>,
    #[command(flatten)]
    progressive: Progressive,
    /// Parts of each map's photons, one in memory at a time, where the radius is fixed: the picture with --adapt 0 in less memory,
    /// as many times the work of rays. Its variance is that between maps, of which there must be several.
    #[arg(long, value_parser = parse_count, default_value = "1")]
    passes: u64,
    #[command(flatten)]
    compared: Compared,
    /// Path guiding: send out this many photons, such as 2e5, and lead paths, those of --with paths and those of --compare, to where they
    /// came from, and flights through homogeneous media to where they are: for caustics, and light that comes by way of mirrors or is bright
    /// in few places. Unbiased whatever the photons say; where they say little, paths are left as they are.
    #[arg(long, value_name = "N", value_parser = whole::<u64>(1..=MOST_HISTORIES))]
    guide: Option<u64>,
    #[command(flatten)]
    frame: Frame,
    #[command(flatten)]
    shown: ToneArgs,
    /// Seed: the same seed gives the same picture, on any number of threads.
    #[arg(long, value_parser = whole::<u64>(0..=u64::MAX), allow_hyphen_values = true, default_value_t = 1)]
    seed: u64,
    /// Threads [default: all cores].
    #[arg(long, value_parser = whole::<u16>(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    memory: Memory,
    #[command(flatten, next_help_heading = "Photon maps (only --with photons)")]
    photons: Photons,
    #[command(flatten, next_help_heading = "Photon maps (only --with photons)")]
    readout: Readout,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum PlanName {
    /// What the scene requires, and nothing else.
    Auto,
    /// Everything, required or not: the same picture, slower, to measure what the other saves.
    Full,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum With {
    /// The photon mapper.
    Photons,
    /// The unbiased path tracer.
    #[value(alias = "path")]
    Paths,
    /// The unbiased path tracer whose paths are connected to subpaths from the lights.
    Bidirectional,
    /// The unbiased light tracer: without lights seen directly, without what is seen in mirrors and through glass.
    Light,
}

impl With {
    fn name(self) -> &'static str {
        match self {
            With::Photons => "photons",
            With::Paths => "paths",
            With::Bidirectional => "bidirectional",
            With::Light => "light",
        }
    }

    /// What is in the picture, for those who find the file.
    fn holds(self) -> &'static str {
        match self {
            With::Photons | With::Paths | With::Bidirectional => "all layers",
            With::Light => {
                "direct, caustic, indirect, single and multiple light that the camera sees straight or through filters; \
                 not the emission layer, and not what is seen in mirrors and through glass"
            }
        }
    }
}

/// Most memory that a pixel takes \[bytes\]: 352 on the film, 172 in the 43 channels of the file, and what packs them.
/// Measured: see `tests/cli/memory.rs`.
const PIXEL_BYTES: f64 = 545.0;
/// The same where the picture is the mean of several: two films.
const MEAN_BYTES: f64 = 715.0;
/// One film more: where each is made in passes, and where there is a reference.
const FILM_BYTES: f64 = 352.0;

/// Samples a pixel where neither their number nor a time is given.
const SAMPLES: u64 = 16;

impl Render {
    /// Draws and writes.
    pub fn run(self, given: &ArgMatches) -> anyhow::Result<()> {
        let method = format!("--with {}", self.with.name());
        let asked = [&method, "--compare"];
        options::check(given, options::RENDER, &asked[..1 + usize::from(self.compared.is_asked_for())])?;
        let extension = self.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if !extension.eq_ignore_ascii_case("exr") {
            bail!("--output is {}; allowed: a file name that ends in .exr", self.output.display());
        }
        if let Some(seconds) = self.seconds.filter(|s| !(*s > 0.0 && s.is_finite())) {
            bail!("--seconds is {seconds}; allowed: finite and above 0");
        }
        if let Some(samples) = self.samples.filter(|n| *n > u64::from(u32::MAX)) {
            bail!("--samples is {samples}; allowed: 1 to 4294967295");
        }
        self.check_passes()?;
        self.check_progressive()?;
        let exposure = self.shown.checked()?;
        let png = self.output.with_extension("png");
        let errors = self.compared.files(&self.output);
        let mut outputs: Vec<(&str, &Path)> = vec![("--output", &self.output), ("--output", &png)];
        outputs.extend(errors.iter().map(|file| ("--compare", file.as_path())));
        outputs.extend(self.progressive.state.as_deref().map(|file| ("--state", file)));
        let (file, scene, files) = match self.progressive.state {
            Some(_) => self.source.read_digested(&outputs)?,
            None => self.source.read(&outputs).map(|(file, scene)| (file, scene, 0))?,
        };
        let scene = match (scene, self.plan) {
            (scene, PlanName::Auto) => scene,
            (_, PlanName::Full) if self.with == With::Light => bail!(
                "--plan full is for pictures by photons and paths: light tracing reads no map and looks for nothing that \
                 could be left out; allowed with --with light: auto"
            ),
            (_, PlanName::Full) if self.readout.needs_even_media() => bail!(
                "--plan full takes every medium for one that varies, which --planes and --ray-ends own cannot read; allowed with them: auto"
            ),
            (scene, PlanName::Full) => scene.with_full_plan()?,
        };
        let camera = self.frame.camera(&scene)?;
        let is_by_paths = matches!(self.with, With::Paths | With::Bidirectional);
        if is_by_paths && !scene.plan().unreachable.is_empty() {
            bail!(
                "the path tracer cannot sample every path of this scene ({}): use photons, or a light with an extent",
                scene.plan().unreachable.join("; ")
            );
        }
        if scene.periodic_cell().is_some() && self.with != With::Paths {
            bail!(
                "pictures of a scene with `cell`, which stands for an unbounded slab, are made by paths: --with paths"
            );
        }
        self.compared.check(&scene)?;
        // Before the work, not after it.
        for (_, file) in &outputs {
            check_writable(file)?;
        }
        if is_same_file(&self.output, &png)? {
            bail!("--output {} and {} lead to one file", self.output.display(), png.display());
        }
        if let Some(state) = &self.progressive.state {
            for file in [&self.output, &png] {
                if is_same_file(state, file)? {
                    bail!("--state {} and {} lead to one file", state.display(), file.display());
                }
            }
        }
        let usual = self.readout.settings(&scene, self.passes)?;
        if self.with == With::Light {
            note(&format!("the picture holds {}", self.with.holds()))?;
        }
        let pixels = camera.width() as usize * camera.height() as usize;
        self.memory.check(
            &format!("a picture of {pixels} pixels"),
            self.film_bytes(&camera),
            if matches!(self.with, With::Light | With::Bidirectional) { LIGHT_BYTES } else { 0.0 },
            |part| format!("at most {} pixels, by --width", (pixels as f64 * part) as u64),
        )?;
        if self.with == With::Photons && scene.plan().has_media {
            tell_step(&scene, &usual)?;
            tell_planes(&scene, &usual)?;
        }
        let scene_text = file.to_toml()?;
        // Every map is read as the first is.
        let mut read = None;
        let made = on_threads(self.threads, || match self.with {
            With::Photons if self.progressive.is_asked_for => {
                self.sequence(&scene, (&scene_text, files), &camera, usual)
            }
            With::Paths => self.repeat(&camera, |streams, stages, left, film| {
                let learned = |histories| stages.time(LEARNING, || learn(&scene, histories, streams));
                let guide = self.guide.map(learned).transpose()?;
                let method = Method::of_paths(&scene, guide.as_ref());
                Ok((self.fill(film, stages, left, &method, (&camera, streams))?, None))
            }),
            With::Bidirectional => self.repeat(&camera, |streams, stages, left, film| {
                let method = Method::Bidirectional(&scene);
                Ok((self.fill(film, stages, left, &method, (&camera, streams))?, None))
            }),
            With::Light => self.repeat(&camera, |streams, stages, left, film| {
                Ok((self.fill(film, stages, left, &Method::Light(&scene), (&camera, streams))?, None))
            }),
            With::Photons => self.repeat(&camera, |streams, stages, left, film| {
                let (indirect, media) = (self.readout.indirect(), usual.media());
                let settings_of_maps =
                    self.photons.settings(indirect, media, streams.seed, streams.replicate);
                let importance =
                    stages.time("pilot", || self.photons.importance(&scene, &camera, &settings_of_maps))?;
                let importance = importance.as_ref();
                let fixed = (self.film_bytes(&camera), 0.0);
                let emitted = stages.time("pilot", || {
                    let runs = self.passes.saturating_mul(self.maps());
                    let held = Held { passes: self.passes, runs, has_radius: self.readout.has_radius() };
                    self.photons.forecast(&scene, &settings_of_maps, importance, held, &self.memory, fixed)
                })?;
                let mut work = Report::default();
                let mut made = MapsMade { number: streams.replicate, ..MapsMade::default() };
                for number in 0..self.passes {
                    let part = Part { number, of: self.passes };
                    let bar = Bar::stage("emission", emitted.histories() / self.passes);
                    let maps = stages
                        .time(MAPS, || fill_part(&scene, &settings_of_maps, emitted, importance, part, &bar));
                    bar.finish();
                    let maps = maps?;
                    let settings = match read {
                        Some(settings) => settings,
                        None => *read.insert(self.readout.suited(&usual, maps.stored())?),
                    };
                    made.settings = Some(settings);
                    let method = Method::Photons(Mapper::new(&scene, &maps, &settings));
                    made.add(&maps);
                    if streams.replicate == 0 && number + 1 == self.passes && !scene.plan().is_full {
                        tell_empty(&made.filled)?;
                        self.photons.tell_sparse(&made.filled)?;
                    }
                    if self.passes == 1 {
                        work = self.fill(film, stages, left, &method, (&camera, streams))?;
                        break;
                    }
                    let mut seen = Film::new(camera.width(), camera.height());
                    work += self.fill(&mut seen, stages, left, &method, (&camera, streams))?;
                    film.add_part(&seen, self.passes);
                }
                Ok((work, Some(made)))
            }),
        })?;
        let exposure =
            exposure.unwrap_or_else(|| auto_exposure(made.film.pixels().iter().map(|p| p.total())));
        let tone = Tone { exposure, curve: self.shown.curve() };
        let provenance = self.provenance(&scene_text, &made, exposure)?;
        write_exr(&self.output, &made.film, &provenance)?;
        let png = self.output.with_extension("png");
        let pixels: Vec<[u8; 3]> = made.film.pixels().iter().map(|p| tone.pixel(p.total())).collect();
        write_png(&png, (made.film.width(), made.film.height()), &pixels)
            .with_context(|| format!("{} is written, the picture beside it is not", self.output.display()))?;
        print_statistics(&made, exposure)?;
        print(&format!(
            "written        {}, {}\n",
            one_line(&self.output.display().to_string()),
            one_line(&png.display().to_string())
        ))?;
        tell_variances(&made.film)?;
        if self.with == With::Photons && !scene.plan().is_full {
            let first = made.maps.first();
            let stored = first.map_or([None; 3], |made| made.filled.map(|map| Some(map?.stored)));
            tell_gathers(&scene, made.first_read.as_ref().unwrap_or(&usual), &made.work, stored)?;
        }
        self.compare(&scene, &camera, &made)
    }

    /// Compares the picture with its reference, if asked to.
    fn compare(&self, scene: &Scene, camera: &Camera, made: &Made) -> anyhow::Result<()> {
        if !self.compared.is_asked_for() {
            return Ok(());
        }
        // The repetition that the picture does not have.
        let streams = Streams { seed: self.seed, replicate: made.repetitions };
        let reference = on_threads(self.threads, || {
            let guide = self.guide.map(|histories| learn(scene, histories, streams)).transpose()?;
            let method = Method::of_paths(scene, guide.as_ref());
            self.compared.reference(&method, camera, &made.film, streams)
        })?;
        let error = match self.with {
            With::Paths | With::Bidirectional if made.film.samples() >= 2 => PictureError::ByPixel,
            _ if made.repetitions >= 2 => PictureError::ByMap(&made.block_means),
            _ => PictureError::Unknown,
        };
        self.compared.tell(&self.output, scene, (&made.film, &reference, self.guide), error)
    }

    /// Memory that the picture takes beside its maps \[bytes\].
    fn film_bytes(&self, camera: &Camera) -> f64 {
        let pixels = f64::from(camera.width()) * f64::from(camera.height());
        let films = if self.maps() == 1 { PIXEL_BYTES } else { MEAN_BYTES };
        let more = [self.passes > 1, self.compared.is_asked_for(), self.progressive.state.is_some()];
        let more: u8 = more.into_iter().map(u8::from).sum();
        let films = pixels * (films + f64::from(more) * FILM_BYTES);
        match self.with {
            With::Photons | With::Paths => films,
            With::Bidirectional => films + pixels * (LIGHT_PIXEL_BYTES + FILM_BYTES) + LIGHT_BYTES,
            With::Light => films + pixels * LIGHT_PIXEL_BYTES + LIGHT_BYTES,
        }
    }

    /// Repetitions.
    fn maps(&self) -> u64 {
        match self.maps {
            Some(maps) => maps,
            // At least: the time decides.
            None if self.progressive.is_asked_for => 2,
            None => 1,
        }
    }

    /// A progressive picture.
    fn sequence(
        &self,
        scene: &Scene,
        from: (&str, u64),
        camera: &Camera,
        usual: Settings,
    ) -> anyhow::Result<Made> {
        let sequence = Sequence {
            scene,
            camera,
            photons: &self.photons,
            readout: &self.readout,
            memory: &self.memory,
            usual,
            fixed: self.film_bytes(camera),
            seed: self.seed,
            samples: self.samples,
            until: Until::asked(self.maps, self.seconds)?,
            state: self.progressive.state.as_deref(),
            is_compared: self.compared.is_asked_for(),
        };
        sequence.make(self.made_from(from, camera, &sequence))
    }

    /// Refuses what a progressive picture cannot be made with.
    fn check_progressive(&self) -> anyhow::Result<()> {
        if !self.progressive.is_asked_for {
            if self.seconds.is_some() && self.samples.is_some() {
                bail!(
                    "--samples and --seconds both say how many samples are taken; allowed: one of them, or --progressive"
                );
            }
            return Ok(());
        }
        if self.passes > 1 {
            bail!(
                "--passes is {}; allowed with --progressive: 1, with fewer photons a map in place of it",
                self.passes
            );
        }
        if self.progressive.state.is_some() && self.compared.is_asked_for() {
            bail!("--compare needs every map's picture, and --state keeps their mean; allowed: one of them");
        }
        Until::asked(self.maps, self.seconds).map(|_| ())
    }

    /// What a progressive picture is made from, but for the number of maps.
    fn made_from(
        &self,
        (scene_text, files): (&str, u64),
        camera: &Camera,
        sequence: &Sequence<'_>,
    ) -> serde_json::Value {
        let maps = self.photons.settings(self.readout.indirect(), sequence.usual.media(), self.seed, 0);
        serde_json::json!({
            "program": format!("turbid {}", env!("CARGO_PKG_VERSION")),
            "plan": if self.plan == PlanName::Full { "full" } else { "auto" },
            "size": [camera.width(), camera.height()],
            "seed": self.seed,
            "importance": self.photons.is_by_importance,
            "samples": sequence.samples(),
            "map settings": map_settings(&maps),
            "mapper settings": mapper_settings(&sequence.usual),
            "radius": self.readout.has_radius(),
            "revision": revision(),
            "scene": scene_text,
            "digest of the scene's files": files,
        })
    }

    /// Refuses what cannot be made in passes.
    fn check_passes(&self) -> anyhow::Result<()> {
        if self.passes == 1 {
            return Ok(());
        }
        let refuse = |why: &str| bail!("--passes is {}, {why}", self.passes);
        match () {
            () if !self.readout.has_radius() => refuse(
                "which needs --radius: the k nearest photons are not known before the last pass; allowed without it: 1",
            ),
            () if self.readout.has_ray_k() => refuse(
                "and --ray-k takes the k nearest photons, which are not known before the last pass; allowed with it: 1",
            ),
            () if self.readout.is_adaptive() => refuse(
                "which needs --adapt 0: steps that depend on what the maps say would differ from pass to pass; allowed \
                 otherwise: 1",
            ),
            () if self.seconds.is_some() => {
                refuse("which needs --samples in place of --seconds; allowed otherwise: 1")
            }
            () if self.maps() == 1 => refuse(
                "which needs several --maps: the variance of a picture made in passes is that between maps; allowed with one \
                 map: 1",
            ),
            () => Ok(()),
        }
    }

    /// The repetitions, and their mean: one film is what it is, several are samples of it.
    fn repeat(
        &self,
        camera: &Camera,
        mut one: impl FnMut(
            Streams,
            &mut Stages,
            Option<f64>,
            &mut Film,
        ) -> anyhow::Result<(Report, Option<MapsMade>)>,
    ) -> anyhow::Result<Made> {
        let blank = || Film::new(camera.width(), camera.height());
        let mut made = Made {
            film: if self.maps() == 1 { Film::new(0, 0) } else { blank() },
            repetitions: self.maps(),
            samples: Vec::new(),
            total_samples: 0,
            first_read: None,
            work: Report::default(),
            maps: Vec::new(),
            stages: Stages::default(),
            block_means: Vec::new(),
            is_by_light: self.with == With::Light,
        };
        for replicate in 0..self.maps() {
            let streams = Streams { seed: self.seed, replicate };
            // Each repetition has an equal part of the time that is left.
            let start = ProcessTime::now();
            let until = self.seconds.map(|s| s / self.maps() as f64);
            let mut film = blank();
            let left = until.map(|s| s + start.as_duration().as_secs_f64());
            let (work, maps) = one(streams, &mut made.stages, left, &mut film)?;
            made.work += work;
            made.first_read = made.first_read.or(maps.as_ref().and_then(|maps: &MapsMade| maps.settings));
            made.maps.extend(maps);
            // A film of passes holds their mean alone.
            let taken = if self.passes == 1 { film.samples() } else { self.samples.unwrap_or(SAMPLES) };
            made.samples.push(taken);
            made.total_samples += taken;
            if self.maps() == 1 {
                made.film = film;
            } else {
                if self.compared.is_asked_for() {
                    made.block_means.push(Blocks::of(film.width(), film.height()).means(&film));
                }
                made.film.push_film(&film);
            }
        }
        Ok(made)
    }

    /// Fills a film with the samples asked for, or until the processor has worked so long.
    fn fill(
        &self,
        film: &mut Film,
        stages: &mut Stages,
        until: Option<f64>,
        method: &Method<'_>,
        (camera, streams): (&Camera, Streams),
    ) -> anyhow::Result<Report> {
        let pixels = film.pixels().len() as u64;
        let name = if matches!(method, Method::Light(_)) { "photons" } else { "gathering" };
        let mut take = |film: &mut Film, samples: u64, bar: &dyn Progress| {
            stages.time("samples", || method.extend(film, camera, samples, streams, bar))
        };
        let Some(until) = until else {
            let samples = self.samples.unwrap_or(SAMPLES);
            // A photon beside each path.
            let walks = if matches!(method, Method::Bidirectional(_)) { 2 } else { 1 };
            let bar = Bar::stage(name, samples.saturating_mul(walks * pixels));
            let work = take(film, samples, &bar);
            bar.finish();
            return Ok(work?);
        };
        let spent = || ProcessTime::now().as_duration().as_secs_f64();
        let bar = Bar::timed(name, until - spent());
        let (start, mut work, mut next) = (spent(), Report::default(), 1);
        loop {
            work.add_assign(take(film, next, &bar)?);
            let (now, taken) = (spent(), film.samples());
            // As many more as fit at the speed so far, half of them at most at once.
            let fit = ((until - now) / ((now - start) / taken as f64)).max(0.0) as u64;
            if fit == 0 {
                bar.finish();
                return Ok(work);
            }
            next = fit.div_ceil(2).max(1);
        }
    }

    /// All that the picture was made from: no path, no time.
    fn provenance(&self, scene_text: &str, made: &Made, exposure: f64) -> anyhow::Result<serde_json::Value> {
        let by_photons = self.with == With::Photons;
        let media = made.first_read.map_or(MediumSamples::Points, |read| read.media());
        let maps = self.photons.settings(self.readout.indirect(), media, self.seed, 0);
        // Of a progressive picture a run may know some of the maps alone.
        let filled = (!self.progressive.is_asked_for)
            .then(|| made.maps.iter().map(|made| made.filled).collect::<Vec<[Option<Filled>; 3]>>());
        Ok(serde_json::json!({
            "program": format!("turbid {}", env!("CARGO_PKG_VERSION")),
            "revision": revision(),
            "with": self.with.name(),
            "holds": self.with.holds(),
            "plan": if self.plan == PlanName::Full { "full" } else { "auto" },
            "width": made.film.width(),
            "height": made.film.height(),
            "seed": self.seed,
            "guide": self.guide.filter(|_| self.with == With::Paths),
            "importance": by_photons && self.photons.is_by_importance,
            "repetitions": made.repetitions,
            "progressive": self.progressive.is_asked_for,
            "passes": self.passes,
            "samples": made.samples,
            "variance": if made.repetitions == 1 { "between samples" } else { "between repetitions" },
            "exposure": exposure,
            "map_settings": by_photons.then(|| map_settings(&maps)),
            "mapper_settings": made.first_read.as_ref().map(mapper_settings),
            "maps_global_caustic_volume": filled,
            "scene": scene_text,
        }))
    }
}
