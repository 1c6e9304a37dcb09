//! `turbid map`: the photons of a scene's maps, as dots seen from its camera, and as files.

use super::load::Source;
use super::made::MapsMade;
use super::memory::{Memory, rounded_down};
use super::options;
use super::picture::{Frame, Held, Photons, ToneArgs};
use super::progress::Bar;
use super::shared::{on_threads, parse_count, print, tell_ahead, whole};
use anyhow::{Context, bail};
use clap::{ArgMatches, ValueEnum};
use std::path::{Path, PathBuf};
use std::time::Instant;
use turbid::Spectrum;
use turbid::output::{
    Curve, Tone, WriteError, auto_exposure, check_writable, is_same_file, write_photons_npy, write_ply,
    write_png,
};
use turbid::photons::maps::{Indirect, Maps, MediumSamples, fill_counted_by_importance};
use turbid::photons::{Histories, Photon, PhotonMap, shoot};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{colour, draw_photons};
use turbid::transport::NoProgress;

/// Draw the photons that a scene's maps hold, as dots seen from its camera, coloured by their power, or write them to files.
///
/// Photons behind opaque surfaces are hidden; glass hides nothing, and bends nothing here. The point cloud that --ply
/// writes opens in any viewer of PLY files; --npy writes a NumPy array of records. Both hold position, direction, power, order of
/// scattering, path class, and the number of photons emitted into the map, which powers are to be divided by; neither needs a
/// camera. With --which medium they are the photons that `measure --with photons` reads, and `measure --photons-from` reads the file.
/// Without any scene file: `turbid map fogbox -o photons.png --ply photons.ply`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Map {
    #[command(flatten)]
    source: Source,
    /// The PNG file to draw, as the scene's camera sees the photons.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// A PLY file to write the photons to, all of them, seen or not: x y z, dir_x dir_y dir_z, power_r power_g power_b, order,
    /// class (1 met a specular surface, 2 a diffuse one, 4 a medium, added up; 8 more where it lies on a surface), red green blue for
    /// viewers; `comment emitted N`, or, from several maps, a property emitted.
    #[arg(long, value_name = "FILE")]
    ply: Option<PathBuf>,
    /// A NumPy file to write the photons to: records with the fields position, direction, power (3 doubles each), order (u2), class (u1),
    /// emitted (u8).
    #[arg(long, value_name = "FILE")]
    npy: Option<PathBuf>,
    /// Which map [default: all, or medium where --photons is given].
    #[arg(long, value_enum)]
    which: Option<Which>,
    /// Photons emitted with --which medium, such as 1e6 [default: 1000000].
    #[arg(long, value_parser = parse_count)]
    photons: Option<u64>,
    #[command(flatten)]
    frame: Frame,
    #[command(flatten)]
    shown: ToneArgs,
    #[command(flatten)]
    amounts: Photons,
    #[command(flatten)]
    memory: Memory,
    /// Seed: the same seed gives the same photons, on any number of threads.
    #[arg(long, value_parser = whole::<u64>(0..=u64::MAX), allow_hyphen_values = true, default_value_t = 1)]
    seed: u64,
    /// Threads [default: all cores].
    #[arg(long, value_parser = whole::<u16>(1..=1024))]
    threads: Option<u16>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Which {
    /// Photons on surfaces, of every class.
    Global,
    /// Photons that mirrors or glass focused on surfaces.
    Caustic,
    /// Photons in media that do not come straight from a light.
    Volume,
    /// The global and the volume map; the caustics are among the surface photons.
    All,
    /// Photons in media, at every collision, emitted by power: those that `measure` reads.
    Medium,
}

/// Stops that keep places with many photons apart; a dot alone is never brighter than its colour.
fn dim(picture: &[Spectrum]) -> f64 {
    auto_exposure(picture.iter().copied()).min(0.0)
}

/// Memory that a pixel of a drawing takes \[bytes\]: its light, and its colour as it is written.
const PICTURE_BYTES: f64 = 40.0;

/// Memory that a photon takes in the list that is drawn \[bytes\], beside what it took on its way into its map, which is seldom given
/// back.
const LIST_BYTES: f64 = size_of::<(Photon, u64)>() as f64;

/// The same of photons that go from their pass into the list, block by block, without a tree: measured, 70 of 1.8 x 10^6 photons.
const PASS_BYTES: f64 = 80.0;

/// Photons emitted with `--which medium` where nothing is asked for.
const USUAL: u64 = 1_000_000;

/// Histories of the pilot that says how many photons a medium stores, at most: one in 64 of the run's.
const PILOT: u64 = 1024;

impl Map {
    /// Draws and writes.
    pub fn run(self, given: &ArgMatches) -> anyhow::Result<()> {
        let ends_in = |file: &Path, end: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        if let Some(png) = self.output.as_ref().filter(|png| !ends_in(png, "png")) {
            bail!("--output is {}; allowed: a file name that ends in .png", png.display());
        }
        if let Some(ply) = self.ply.as_ref().filter(|ply| !ends_in(ply, "ply")) {
            bail!("--ply is {}; allowed: a file name that ends in .ply", ply.display());
        }
        let outputs = [("--output", &self.output), ("--ply", &self.ply), ("--npy", &self.npy)];
        let outputs: Vec<_> =
            outputs.into_iter().filter_map(|(option, file)| Some((option, file.as_deref()?))).collect();
        if outputs.is_empty() {
            bail!("no file to write; allowed: --output FILE.png, --ply FILE.ply, --npy FILE, one or several");
        }
        options::check(given, options::MAP, &self.features())?;
        let exposure = self.shown.checked()?;
        let scene = self.source.load(&outputs)?;
        let needs_camera = self.output.is_some() || self.amounts.is_by_importance;
        let camera = needs_camera.then(|| self.frame.camera(&scene)).transpose()?;
        for (number, (option, file)) in outputs.iter().enumerate() {
            check_writable(file)?;
            for (other, before) in &outputs[..number] {
                if is_same_file(before, file)? {
                    bail!("{other} {} and {option} {} lead to one file", before.display(), file.display());
                }
            }
        }
        let drawn = camera.as_ref().filter(|_| self.output.is_some());
        let (photons, picture) = on_threads(self.threads, || {
            let photons = match self.which() {
                Which::Medium => self.in_media(&scene, drawn)?,
                _ => self.in_maps(&scene, camera.as_ref())?,
            };
            if photons.is_empty() {
                bail!("the map is empty: the scene has no surface or medium that keeps such photons");
            }
            let picture = drawn.map(|camera| draw_photons(&scene, camera, &photons));
            Ok((photons, picture))
        })?;
        let mut said = format!("photons        {}\n", photons.len());
        let mut written = Vec::new();
        if let (Some(png), Some(camera), Some((picture, seen))) = (&self.output, drawn, picture) {
            let exposure = exposure.unwrap_or_else(|| dim(&picture));
            let tone = Tone { exposure, curve: self.shown.curve() };
            let pixels: Vec<[u8; 3]> = picture.into_iter().map(|p| tone.pixel(p)).collect();
            after(&written, write_png(png, (camera.width(), camera.height()), &pixels))?;
            said += &format!("in the picture {seen}\n");
            written.push(png);
        }
        if let Some(ply) = &self.ply {
            let white = Tone { exposure: 0.0, curve: Curve::Clip };
            after(&written, write_ply(ply, &photons, |photon| white.pixel(colour(photon))))?;
            written.push(ply);
        }
        if let Some(npy) = &self.npy {
            after(&written, write_photons_npy(npy, &photons))?;
        }
        print(&said)
    }

    fn which(&self) -> Which {
        self.which.unwrap_or(if self.photons.is_some() { Which::Medium } else { Which::All })
    }

    /// What is asked for, as [`options::MAP`] calls it.
    fn features(&self) -> Vec<&'static str> {
        let mut features = vec![match self.which() {
            Which::Global => "--which global",
            Which::Caustic => "--which caustic",
            Which::Volume => "--which volume",
            Which::All => "--which all",
            Which::Medium => "--which medium",
        }];
        features.extend(self.output.is_some().then_some("--output"));
        features.extend(self.amounts.is_by_importance.then_some("--importance"));
        features
    }

    /// Memory that a picture takes, if there is one \[bytes\].
    fn picture_bytes(camera: Option<&Camera>) -> f64 {
        camera.map_or(0.0, |camera| PICTURE_BYTES * f64::from(camera.width()) * f64::from(camera.height()))
    }

    /// The photons that collide in media, with the number emitted.
    fn in_media(&self, scene: &Scene, drawn: Option<&Camera>) -> anyhow::Result<Vec<(Photon, u64)>> {
        let emitted = self.photons.unwrap_or(USUAL);
        let histories = |count| Histories { count, seed: self.seed, replicate: 0, max_order: None };
        let (pilot, start) = (emitted.div_ceil(64).min(PILOT), Instant::now());
        let stored = shoot(scene, histories(pilot), &[], |_| false, &NoProgress)?.report.collisions as f64;
        let times = emitted as f64 / pilot as f64;
        let (stored, fixed) = (stored * times, Self::picture_bytes(drawn));
        let bytes = PASS_BYTES * stored + fixed;
        self.memory.check(&format!("{stored:.2e} photons of media"), bytes, fixed, |part| {
            format!("--photons {}", rounded_down(emitted as f64 * part))
        })?;
        let seconds = start.elapsed().as_secs_f64() * times / rayon::current_num_threads() as f64;
        tell_ahead(&format!("{emitted:.2e} photons to send out, {stored:.2e} to store"), seconds, bytes)?;
        let bar = Bar::stage("emission", emitted);
        let pass = shoot(scene, histories(emitted), &[], |_| true, &bar);
        bar.finish();
        let pass = pass?;
        let mut photons = Vec::with_capacity(pass.media.iter().map(|part| part.len()).sum());
        for part in pass.media {
            photons.extend(part.iter().map(|photon| (photon, emitted)));
        }
        Ok(photons)
    }

    /// The photons of the maps asked for, each with the number that its map's pass emitted.
    fn in_maps(&self, scene: &Scene, camera: Option<&Camera>) -> anyhow::Result<Vec<(Photon, u64)>> {
        let settings = self.amounts.settings(Indirect::Gathered, MediumSamples::Points, self.seed, 0);
        let importance = match camera {
            Some(camera) => self.amounts.importance(scene, camera, &settings)?,
            None => None,
        };
        let importance = importance.as_ref();
        let drawn = camera.filter(|_| self.output.is_some());
        let fixed = (Self::picture_bytes(drawn), LIST_BYTES);
        let emitted = self.amounts.forecast(scene, &settings, importance, Held::ALL, &self.memory, fixed)?;
        let bar = Bar::stage("emission", emitted.histories());
        let maps = fill_counted_by_importance(scene, &settings, emitted, importance, &bar);
        bar.finish();
        let maps = maps?;
        let mut made = MapsMade::default();
        made.add(&maps);
        self.amounts.tell_sparse(&made.filled)?;
        Ok(self.chosen(maps))
    }

    fn chosen(&self, maps: Maps) -> Vec<(Photon, u64)> {
        let chosen = match self.which() {
            Which::Global => vec![maps.global],
            Which::Caustic => vec![maps.caustic],
            Which::Volume | Which::Medium => vec![maps.volume],
            Which::All => vec![maps.global, maps.volume],
        };
        let maps: Vec<PhotonMap> = chosen.into_iter().flatten().collect();
        let mut photons: Vec<(Photon, u64)> = Vec::with_capacity(maps.iter().map(PhotonMap::stored).sum());
        for map in maps {
            photons.extend(map.tree().photons().map(|photon| (photon, map.emitted())));
        }
        photons
    }
}

/// What could not be written, beside what is there already.
fn after(written: &[&PathBuf], result: Result<(), WriteError>) -> anyhow::Result<()> {
    let Some(last) = written.last() else { return Ok(result?) };
    result.with_context(|| format!("{} is written, the next file is not", last.display()))
}
