//! `turbid measure`: the sensors of a scene, by paths, bidirectional paths, photons or light tracing.

use super::given::{Given, notes as notes_of_given};
use super::learn::learn;
use super::load::Source;
use super::memory::{Memory, passes_that_fit, rounded_down};
use super::options;
use super::picture::{
    BlurName, BoundaryName, EndsName, LengthName, RejectName, beam_radius, ray_ends, ray_k, ray_radius,
};
use super::progress::Bar;
use super::reading_notes::{ledger_note, note_of_peaks, note_of_rare_turns, notes_of_gathers, without_error};
use super::revision::revision;
use super::shared::{FormatName, kernels, note, on_threads, parse_count, tell_ahead, whole};
use anyhow::{Context, bail};
use clap::{ArgMatches, ValueEnum};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::geometry::Voxels;
use turbid::integrators::Guides;
use turbid::math::Positive;
use turbid::output::{
    RunInfo, check_writable, is_same_file, npy, one_line, print, voxel_grid, write_atomically, write_rows,
};
use turbid::photons::{MOST_HISTORIES, PeakBytes, Photon};
use turbid::scene::{Binned, Orders, Quantity, Scene, Sensor, Space};
use turbid::sensor::{
    Measurement, PathSettings, PhotonSettings, Streams, TallySettings, by_bidirectional_paths,
    by_given_photons, by_guided_paths, by_photons_in_passes, by_tallies, check_paths, forecast, given_bytes,
    row_bytes, tally_bytes, usual_reach,
};
use turbid::transport::WeightWindows;

/// Measure the sensors of a scene by paths, bidirectional paths, photons or light tracing.
///
/// Prints the columns sensor, quantity, unit, mean, std_error, n. Paths and tallies have n = histories; estimates
/// from photon maps have n = maps: the standard error is that between independent maps, and one map has none, since all its
/// estimates share its photons. Where no error can be trusted a word says why, in CSV and JSON in the column `why`: one-map, nothing-found,
/// too-few (fewer than 1,000 paths contribute, or to a bin 10 photons), heavy-tail, which fewer than 100 maps do not tell.
///
/// An error knows what was drawn. Where few of the paths carry the mean, as those that find a void through many mean free paths
/// of a shield, a run may draw none of them, and nothing in it says so: its error is then many times too small. Take
/// --weight-windows there, and do not believe plain paths unless these agree. So it is with photon maps that rarely hold a photon of large
/// power, such as one of a faint light that alone is green: maps without any do not tell of it, however many.
///
/// A sensor with bins has a row for each: columns bin_i, bin_j, bin_k number it along each axis, x, y, z are its middle. Flux and
/// absorption are scored by photons as they pass; fluence and radiance by `photons` are estimates from maps at 4 random
/// points of the bin, by `light` scores too: of flights or collisions, and of what each scattering sends to the bin.
///
/// An option that the chosen method would ignore is refused.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Measure {
    #[command(flatten)]
    source: Source,
    /// Who measures.
    #[arg(long = "with", value_enum)]
    with: With,
    /// Split paths on their way to the lights, and end them elsewhere: for light that comes through many mean free paths. Only with
    /// paths.
    #[arg(long)]
    weight_windows: bool,
    /// Path guiding: send out this many photons, such as 2e5, and lead paths to where they came from, and flights through homogeneous media
    /// to where they are: for caustics, and light that comes by way of mirrors or is bright in few places. Unbiased whatever the photons
    /// say; where they say little, paths are left as they are. Only with paths, and not with --weight-windows.
    #[arg(long, value_name = "N", conflicts_with = "weight_windows", value_parser = whole::<u64>(1..=MOST_HISTORIES))]
    guide: Option<u64>,
    /// Paths a sensor, or a bin of one, such as 1e6.
    #[arg(long, value_parser = parse_count, default_value = "100000")]
    samples: u64,
    /// Photons emitted, for all maps together, such as 1e7.
    #[arg(long, value_parser = parse_count, default_value = "1000000")]
    photons: u64,
    /// Independent photon maps, each of an equal part of the photons.
    #[arg(long, value_parser = parse_count, default_value = "16")]
    maps: u64,
    /// Passes that the photons of a map are sent out in, one in memory at a time: the same photons and estimates, in a part
    /// of the memory. Only with --radius: the k nearest are not known before the last pass.
    #[arg(long, value_parser = parse_count, default_value = "1")]
    passes: u64,
    /// Read photons of media from a file, PLY or NumPy, in place of sending them out; several times for several independent maps. Only with
    /// photons. Columns, in NumPy fields of a record: position, direction, power (3 floats each), order, and, if they are there, class
    /// and emitted; in PLY x y z, dir_x dir_y dir_z, power_r power_g power_b, order, class, emitted. Powers [W] are those of photons that
    /// are the only ones emitted, and are divided by the number emitted. `turbid map --which medium` writes such files. Sensors that count
    /// photons on their way are left out.
    #[arg(long, value_name = "FILE")]
    photons_from: Vec<PathBuf>,
    /// Photons emitted into each map of --photons-from, where the files do not say it.
    #[arg(long, value_name = "N", value_parser = parse_count)]
    emitted: Option<u64>,
    #[command(flatten)]
    memory: Memory,
    /// Photons an estimate takes: the k nearest [default: 50].
    #[arg(long, conflicts_with = "radius")]
    k: Option<usize>,
    /// Radius within which an estimate takes all photons [L].
    #[arg(long)]
    radius: Option<f64>,
    /// The farthest that the k nearest photons are sought [L; default: half the cell, or a mean free path].
    #[arg(long, conflicts_with = "radius")]
    max_radius: Option<f64>,
    /// How an estimate weights its photons.
    #[arg(long, value_parser = kernels(), default_value = "uniform")]
    kernel: Kernel,
    /// Read rays from all photons within this distance of the ray, in place of from balls at steps along it: the beam radiance
    /// estimate. Sensors of fluence take the balls of --k or --radius. With --boundary none what lies beyond faces and behind bodies
    /// beside the ray is missing [L].
    #[arg(long, conflicts_with = "reject")]
    ray_radius: Option<f64>,
    /// Give each photon a radius of its own about rays, the distance to its k-th nearest other photon, at most --ray-radius: the beam
    /// radiance estimate as it was published, sharp where photons are many. Its blur depends on their density. Not with --progressive
    /// or --passes.
    #[arg(long, value_name = "K", requires = "ray_radius", conflicts_with_all = ["progressive", "reject", "beam_radius", "planes"], value_parser = whole::<u32>(1..=1_000_000_000))]
    ray_k: Option<u32>,
    /// Store photons' flights through media as beams, and read rays from all beams that pass within this distance of the ray: less
    /// noise than points where it is below 0.4 mean free paths. Sensors of fluence take photons in the balls of --k or
    /// --radius [L].
    #[arg(long, conflicts_with_all = ["reject", "ray_radius", "photons_from"])]
    beam_radius: Option<f64>,
    /// Read sensors of fluence from beams too: from all that pass the place within --beam-radius, in place of from photons in a ball
    /// [W/L^2]. Not with --progressive, since their radius shrinks at another rate.
    #[arg(long, requires = "beam_radius", conflicts_with_all = ["progressive", "reject", "ray_radius", "photons_from"])]
    beam_fluence: bool,
    /// In how many dimensions beams are blurred [default: 1d].
    #[arg(long, value_enum, requires = "beam_radius", conflicts_with_all = ["reject", "ray_radius", "photons_from"])]
    beam_blur: Option<BlurName>,
    /// How far beams go [default: sampled].
    #[arg(long, value_enum, requires = "beam_radius", conflicts_with_all = ["reject", "ray_radius", "photons_from"])]
    beam_length: Option<LengthName>,
    /// Where rays that are read at once end: own loses nothing at faces, and blurs the picture alone. Only for one homogeneous region
    /// with nothing in it [default: cut].
    #[arg(long, value_enum, conflicts_with = "planes")]
    ray_ends: Option<EndsName>,
    /// Read light that is scattered twice and more from planes of photons' flights, without blur or bias: each flight and a scattering on it
    /// sweep out a parallelogram. Light that is scattered once comes from beams: --beam-radius, or --orders 2.. to leave it out. The
    /// variance is infinite in diffuse light, and errors between maps are too small by what few maps have not met. Only for homogeneous
    /// media of one extinction for all channels.
    #[arg(long, conflicts_with_all = ["reject", "ray_radius", "photons_from"])]
    planes: bool,
    /// Shrink radii from map to map, so that the mean over --maps converges to the light itself: as the number of maps to the power
    /// -1/7 of --radius, -1/6 of --ray-radius, -1/5 of --beam-radius, which are those of the first map. The error is that between maps.
    #[arg(long)]
    progressive: bool,
    /// What an estimate does where a medium ends or a body stands in its ball.
    #[arg(long, value_enum, default_value = "clipped")]
    boundary: BoundaryName,
    /// A rule of the literature about photons behind walls, instead of what --boundary does about them; for the laboratory.
    #[arg(long, value_enum, default_value = "off")]
    reject: RejectName,
    /// Orders of scattering that count: `1`, `0..3` (both ends included), `1..`.
    #[arg(long, value_parser = parse_orders, default_value = "0..")]
    orders: Orders,
    /// Seed: the same seed gives the same numbers, on any number of threads.
    #[arg(long, value_parser = whole::<u64>(0..=u64::MAX), allow_hyphen_values = true, default_value_t = 1)]
    seed: u64,
    /// Threads [default: all cores].
    #[arg(long, value_parser = whole::<u16>(1..=1024))]
    threads: Option<u16>,
    /// Form of the output; CSV and JSON say too what the numbers were made with: seed, settings, version, revision.
    #[arg(long, value_enum, default_value = "table")]
    format: FormatName,
    /// Write the table to a file, in its format, and nothing to standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the sensor with bins as a NumPy array of doubles (i, j, k, channel, 2): means, then standard errors, not a
    /// number where there is none. The scene has one such sensor.
    #[arg(long, value_name = "FILE")]
    npy: Option<PathBuf>,
    /// Write the means of the sensor with voxels as a Mitsuba grid, version 3. The scene has one sensor with bins.
    #[arg(long, value_name = "FILE")]
    vol: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum With {
    /// The unbiased path tracer.
    #[value(alias = "path")]
    Paths,
    /// The unbiased path tracer whose paths are connected to subpaths from the lights.
    Bidirectional,
    /// Photons: tallies and photon maps.
    Photons,
    /// Light tracing: photons that are scored as they pass, none stored.
    Light,
}

/// Orders on the command line.
fn parse_orders(text: &str) -> Result<Orders, String> {
    const ALLOWED: &str =
        "allowed: an order such as 1, or a range such as 0..3 or 1.. (both ends included), up to 65534";
    // Photons keep their order in 16 bits, the last value standing for itself and all above.
    let number = |part: &str| {
        let order = part.trim().parse::<u16>().ok().filter(|&order| order < u16::MAX);
        order.map(u32::from).ok_or_else(|| ALLOWED.to_string())
    };
    let orders = match text.split_once("..") {
        None => Orders::only(number(text)?),
        Some((min, "")) => Orders { min: number(min)?, max: None },
        Some((min, max)) => Orders { min: number(min)?, max: Some(number(max)?) },
    };
    if orders.max.is_some_and(|max| max < orders.min) { Err(ALLOWED.to_string()) } else { Ok(orders) }
}

impl Measure {
    /// Measures and prints.
    pub fn run(self, given: &ArgMatches) -> anyhow::Result<()> {
        options::check(given, options::MEASURE, &[self.method()])?;
        let scene = self.source.load(&self.outputs())?;
        if scene.sensors().is_empty() {
            bail!("{}: the scene has no sensors: nothing to measure", self.source.name());
        }
        let array = self.array(&scene)?;
        self.check_files()?;
        let (mut measurements, mut notes) = on_threads(self.threads, || match self.with {
            With::Paths | With::Bidirectional => self.measure_by_paths(&scene),
            With::Photons if !self.photons_from.is_empty() => self.measure_by_given(&scene),
            With::Photons => self.measure_by_photons(&scene),
            With::Light => self.measure_by_light(&scene),
        })?;
        // Names come from files, and go to terminals.
        for measurement in &mut measurements {
            measurement.sensor = one_line(&measurement.sensor);
            measurement.quantity = one_line(&measurement.quantity);
        }
        notes.extend(without_error(&measurements));
        if let Some(binned) = array {
            self.write_files(&measurements, binned)?;
        }
        let (run, format) = (self.run_info(&scene)?, self.format.format());
        match &self.out {
            Some(file) => write_atomically(file, |out| write_rows(out, &measurements, &run, format))?,
            None => print(|out| write_rows(out, &measurements, &run, format)).context("standard output")?,
        }
        for text in notes {
            note(&text)?;
        }
        Ok(())
    }

    /// Who measures, as it is asked for.
    fn method(&self) -> &'static str {
        match self.with {
            With::Paths => "--with paths",
            With::Bidirectional => "--with bidirectional",
            With::Photons if !self.photons_from.is_empty() => "--photons-from",
            With::Photons => "--with photons",
            With::Light => "--with light",
        }
    }

    /// What the numbers are made with.
    fn run_info(&self, scene: &Scene) -> anyhow::Result<RunInfo> {
        let by = |methods: &[&str]| methods.contains(&self.method());
        let orders = match self.orders {
            Orders { min, max: None } => format!("{min}.."),
            Orders { min, max: Some(max) } if min == max => min.to_string(),
            Orders { min, max: Some(max) } => format!("{min}..{max}"),
        };
        let mut run = RunInfo {
            with: self.method().trim_start_matches("--").trim_start_matches("with ").to_string(),
            seed: self.seed,
            orders,
            samples: by(&["--with paths", "--with bidirectional"]).then_some(self.samples),
            weight_windows: self.weight_windows.then_some(true),
            guide: self.guide,
            photons: by(&["--with photons", "--with light"]).then_some(self.photons),
            version: env!("CARGO_PKG_VERSION").to_string(),
            revision: revision().map(str::to_string),
            ..RunInfo::default()
        };
        if by(&["--with photons", "--photons-from"]) {
            let maps = if self.photons_from.is_empty() { self.maps } else { self.photons_from.len() as u64 };
            let Estimator {
                kernel,
                gather,
                treatment,
                rejection,
                ray_radius,
                ray_k,
                beam_radius,
                beam_blur,
                beam_length,
                has_beam_fluence,
                ray_ends,
                has_planes,
                is_progressive,
            } = self.settings(scene, 1, 1)?.estimator;
            run.maps = Some(maps);
            match gather {
                Gather::Radius(radius) => run.radius = Some(radius.get()),
                _ => (run.k, run.max_radius) = (gather.k(), Some(gather.cap())),
            }
            run.ray_ends = (ray_ends != RayEnds::Cut).then(|| ray_ends.name().to_string());
            run.progressive = is_progressive.then_some(true);
            run.ray_radius = ray_radius.map(Positive::get);
            run.ray_k = ray_k.map(NonZeroUsize::get);
            run.beam_radius = beam_radius.map(Positive::get);
            if beam_radius.is_some() {
                run.beam_blur = Some(beam_blur.name().to_string());
                run.beam_length = Some(beam_length.name().to_string());
                run.beam_fluence = has_beam_fluence.then_some(true);
            }
            run.planes = has_planes.then_some(true);
            run.kernel = Some(kernel.name().to_string());
            run.boundary = Some(treatment.name().replace(' ', "-"));
            run.reject = Some(rejection.name().replace(' ', "-"));
        }
        Ok(run)
    }

    /// The sensor that goes to files, if one does.
    fn array<'a>(&self, scene: &'a Scene) -> anyhow::Result<Option<&'a Binned>> {
        let files = [("--npy", &self.npy), ("--vol", &self.vol)];
        let Some((option, _)) = files.iter().find(|(_, file)| file.is_some()) else { return Ok(None) };
        let binned: Vec<&Binned> = scene.sensors().iter().filter_map(Sensor::binned).collect();
        let [one] = binned[..] else {
            bail!("{option} writes one sensor with bins; this scene has {}", binned.len());
        };
        if self.vol.is_some() && voxels(one).is_none() {
            bail!("--vol writes voxels; the sensor with bins of this scene has none: use --npy");
        }
        Ok(Some(one))
    }

    /// The files to write, each with its option.
    fn outputs(&self) -> Vec<(&'static str, &Path)> {
        let files = [("--npy", &self.npy), ("--vol", &self.vol), ("--out", &self.out)];
        files.into_iter().filter_map(|(option, file)| Some((option, file.as_deref()?))).collect()
    }

    /// Refuses files that could not be written, or would be written over, before any work.
    fn check_files(&self) -> anyhow::Result<()> {
        let files = self.outputs();
        let is_same = |a: &Path, b: &Path| is_same_file(a, b).unwrap_or(false);
        for (number, (option, file)) in files.iter().enumerate() {
            if self.photons_from.iter().any(|photons| is_same(file, photons)) {
                bail!("{option} and --photons-from name one file, {}", file.display());
            }
            if let Some((other, _)) = files[..number].iter().find(|(_, other)| is_same(file, other)) {
                bail!("{other} and {option} name one file, {}", file.display());
            }
            check_writable(file)?;
        }
        Ok(())
    }

    fn write_files(&self, measurements: &[Measurement], binned: &Binned) -> anyhow::Result<()> {
        let rows: Vec<&Measurement> = measurements.iter().filter(|row| row.bin.is_some()).collect();
        if let Some(file) = &self.npy {
            write_atomically(file, |out| out.write_all(&npy(&rows, binned.count())))?;
        }
        if let (Some(file), Some(voxels)) = (&self.vol, voxels(binned)) {
            let bytes = voxel_grid(&rows, voxels).context("--vol")?.to_bytes();
            write_atomically(file, |out| out.write_all(&bytes))?;
        }
        Ok(())
    }

    fn measure_by_light(&self, scene: &Scene) -> anyhow::Result<(Vec<Measurement>, Vec<String>)> {
        let settings = TallySettings { photons: self.photons, seed: self.seed, orders: self.orders };
        self.check_bins(scene, tally_bytes(scene, &settings))?;
        let bar = Bar::new(self.photons);
        let result = by_tallies(scene, &settings, &bar);
        bar.finish();
        let result = result.with_context(|| self.source.name())?;
        Ok((result.measurements, vec![ledger_note(&result.ledger)]))
    }

    /// Refuses bins that take more memory than there is.
    fn check_bins(&self, scene: &Scene, bytes: f64) -> anyhow::Result<()> {
        let bins: usize = scene.sensors().iter().filter_map(Sensor::binned).map(Binned::bins).sum();
        self.memory.check(&format!("{bins} bins"), bytes, 0.0, |part| {
            format!("{} bins", rounded_down(bins as f64 * part))
        })
    }

    fn measure_by_paths(&self, scene: &Scene) -> anyhow::Result<(Vec<Measurement>, Vec<String>)> {
        let settings =
            PathSettings { samples: self.samples, seed: self.seed, replicate: 0, orders: self.orders };
        self.check_bins(scene, row_bytes(scene))?;
        let bins: u64 = scene.sensors().iter().map(|s| s.binned().map_or(1, Binned::bins) as u64).sum();
        check_paths(scene).with_context(|| self.source.name())?;
        let windows = self.weight_windows.then(|| WeightWindows::new(scene)).transpose();
        let windows = windows.with_context(|| self.source.name())?;
        let streams = Streams { seed: self.seed, replicate: 0 };
        let guide = self.guide.map(|histories| learn(scene, histories, streams)).transpose();
        let guide = guide.with_context(|| self.source.name())?;
        let guides = Guides { windows: windows.as_ref(), learned: guide.as_ref() };
        let bar = Bar::new(self.samples.saturating_mul(bins));
        let measurements = match self.with {
            With::Bidirectional => by_bidirectional_paths(scene, &settings, &bar),
            _ => by_guided_paths(scene, &settings, guides, &bar),
        };
        bar.finish();
        let notes = note_of_rare_turns(scene, self.samples).into_iter().collect();
        Ok((measurements.with_context(|| self.source.name())?, notes))
    }

    /// How maps are read, each of so many photons.
    fn settings(&self, scene: &Scene, photons: u64, maps: u64) -> anyhow::Result<PhotonSettings> {
        let gather = match self.radius {
            Some(radius) => Gather::radius(radius).context("--radius")?,
            None => {
                let cap = self.max_radius.unwrap_or_else(|| usual_reach(scene));
                Gather::nearest(self.k.unwrap_or(50), cap).context("--k, --max-radius")?
            }
        };
        let estimator = Estimator::new(self.kernel, gather).treated(self.boundary.treatment());
        let estimator = estimator.rejecting(self.reject.rejection());
        let (ray_radius, beam_radius) = (ray_radius(self.ray_radius)?, beam_radius(self.beam_radius)?);
        let is_of_balls = |sensor: &Sensor| {
            matches!(sensor.quantity, Quantity::Fluence(_) | Quantity::Binned(Binned::Fluence { .. }))
        };
        let is_along_rays = |sensor: &Sensor| {
            matches!(sensor.quantity, Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }))
        };
        if !scene.sensors().iter().any(is_along_rays) {
            for (option, is_given, more) in [
                ("--planes", self.planes, ""),
                ("--ray-radius", ray_radius.is_some(), ""),
                ("--beam-radius", beam_radius.is_some() && !self.beam_fluence, ", or with --beam-fluence"),
            ] {
                if is_given {
                    bail!(
                        "{option} is of radiances, and no sensor measures one; allowed: with sensors of radiance{more}"
                    );
                }
            }
        }
        let has_radii = (ray_radius, beam_radius) != (None, None);
        let has_balls =
            !self.beam_fluence && scene.sensors().iter().any(is_of_balls) || !(has_radii || self.planes);
        if self.progressive && (has_balls || !has_radii) && self.radius.is_none() {
            bail!(
                "--progressive shrinks radii, and takes the k nearest photons as they are; allowed: with --radius, or, for sensors of \
                 radiance alone, --ray-radius or --beam-radius"
            );
        }
        if !has_balls {
            self.boundary.check_about_rays()?;
            for (option, is_given) in [("--k", self.k.is_some()), ("--max-radius", self.max_radius.is_some())]
            {
                if is_given {
                    bail!(
                        "{option} is of balls, and no sensor is read from one; allowed: with sensors of fluence, or without --ray-radius, \
                         --beam-radius and --planes"
                    );
                }
            }
        }
        let (has_planes, is_progressive) = (self.planes, self.progressive);
        let ray_k = ray_k(self.ray_k);
        let beam_blur = self.beam_blur.map_or(BeamBlur::default(), BlurName::blur);
        let beam_length = self.beam_length.map(LengthName::length).unwrap_or_default();
        let estimator =
            Estimator { ray_ends: ray_ends(self.ray_ends, (ray_radius, beam_radius))?, ..estimator };
        let estimator =
            Estimator { beam_blur, beam_length, has_beam_fluence: self.beam_fluence, ..estimator };
        let estimator = Estimator { ray_radius, ray_k, beam_radius, has_planes, is_progressive, ..estimator };
        Ok(PhotonSettings { photons, maps, seed: self.seed, orders: self.orders, estimator })
    }

    fn measure_by_given(&self, scene: &Scene) -> anyhow::Result<(Vec<Measurement>, Vec<String>)> {
        let files = self.photons_from.len() as u64;
        if self.progressive && files < 2 {
            bail!(
                "--photons-from names one file; allowed with --progressive: at least 2, since radii shrink from map to map"
            );
        }
        let settings = self.settings(scene, 1, files)?;
        let given = Given::open(&self.photons_from, self.emitted)?;
        let most = given.most();
        let bytes = given_bytes(scene, &settings, most).with_context(|| self.source.name())?;
        self.memory.check(&format!("a map of {most} photons"), bytes, 0.0, |part| {
            format!(
                "files of at most {} photons",
                rounded_down(most as f64 * PeakBytes::of_maps(files).part_in(part, most as f64))
            )
        })?;
        let mut has_uncollided = false;
        let see = |photons: &[Photon]| has_uncollided |= photons.iter().any(|photon| photon.order == 0);
        let readings = by_given_photons(scene, &settings, given.photons(see))?;
        let is_fluence = |quantity: &Quantity| {
            matches!(quantity, Quantity::Fluence(_) | Quantity::Binned(Binned::Fluence { .. }))
        };
        let counts_uncollided =
            scene.sensors().iter().any(|s| is_fluence(&s.quantity) && s.orders.and(&self.orders).contains(0));
        let mut notes = notes_of_given(scene, has_uncollided, counts_uncollided);
        notes.extend(notes_of_gathers(scene, &readings, &settings.estimator));
        notes.extend(note_of_peaks(scene, self.photons_from.len() as u64));
        Ok((readings.measurements, notes))
    }

    fn measure_by_photons(&self, scene: &Scene) -> anyhow::Result<(Vec<Measurement>, Vec<String>)> {
        if self.progressive && self.maps < 2 {
            bail!(
                "--maps is {}; allowed with --progressive: at least 2, since radii shrink from map to map",
                self.maps
            );
        }
        if self.photons < self.maps {
            bail!("--photons is {}; allowed: at least one for each of the {} maps", self.photons, self.maps);
        }
        let settings = self.settings(scene, self.photons.div_ceil(self.maps), self.maps)?;
        if self.passes > 1 && self.radius.is_none() {
            bail!(
                "--passes is {}, which needs --radius: the k nearest photons are not known before the last pass; allowed \
                 without it: 1, with fewer --photons",
                self.passes
            );
        }
        if self.passes > 1 && self.ray_k.is_some() {
            bail!(
                "--passes is {}, and --ray-k takes the k nearest photons, which are not known before the last pass; allowed with it: 1, \
                 with fewer --photons",
                self.passes
            );
        }
        if self.passes > settings.photons {
            bail!(
                "--passes is {}; allowed: at most one a photon of a map, {}",
                self.passes,
                settings.photons
            );
        }
        let forecast = forecast(scene, &settings, self.passes).with_context(|| self.source.name())?;
        self.memory.check(
            &format!("a map of {:.2e} photons", forecast.stored),
            forecast.bytes,
            0.0,
            |part| {
                let peak = PeakBytes::of_maps(settings.maps.saturating_mul(self.passes));
                let part = peak.part_in(part, forecast.stored / self.passes as f64);
                let fewer = rounded_down(self.photons as f64 * part);
                let passes = passes_that_fit(self.passes, part);
                match self.radius {
                    Some(_) => format!("--photons {fewer}, or --passes {passes}"),
                    None => format!("--photons {fewer}, or a fixed --radius with --passes {passes}"),
                }
            },
        )?;
        let photons = forecast.stored * self.maps as f64;
        tell_ahead(&format!("{photons:.2e} photons to store in all"), forecast.seconds, forecast.bytes)?;
        let bar = Bar::new(settings.photons.saturating_mul(settings.maps));
        let result = by_photons_in_passes(scene, &settings, self.passes, &bar);
        bar.finish();
        let result = result.with_context(|| self.source.name())?;
        let mut notes = vec![ledger_note(&result.ledger)];
        notes.extend(notes_of_gathers(scene, &result, &settings.estimator));
        notes.extend(note_of_peaks(scene, self.maps));
        Ok((result.measurements, notes))
    }
}

/// The voxels of a sensor, if it has some.
fn voxels(binned: &Binned) -> Option<&Voxels> {
    match binned {
        Binned::Fluence { space: Space::Voxels(voxels), .. }
        | Binned::Absorption { space: Space::Voxels(voxels), .. } => Some(voxels),
        _ => None,
    }
}
