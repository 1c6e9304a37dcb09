//! `turbid map`: the photons of a scene's maps, as dots seen from its camera.

use super::load::Source;
use super::made::MapsMade;
use super::memory::Memory;
use super::picture::{Frame, Held, Photons, ToneArgs};
use super::progress::Bar;
use super::shared::{on_threads, print, whole};
use anyhow::{Context, bail};
use clap::ValueEnum;
use std::path::PathBuf;
use turbid::Spectrum;
use turbid::output::{Tone, auto_exposure, check_writable, is_same_file, write_ply, write_png};
use turbid::photons::maps::{Indirect, Maps, fill_counted_by_importance};
use turbid::photons::{Photon, PhotonMap};
use turbid::sensor::{colour, draw_photons};

/// Draw the photons that a scene's maps hold, as dots seen from its camera, coloured by their power.
///
/// Photons behind opaque surfaces are hidden; glass hides nothing, and bends nothing here. The point cloud that --ply
/// writes opens in any viewer of PLY files; it has position, direction, power, order of scattering and path class.
/// Without any file: `turbid map fogbox -o photons.png --ply photons.ply`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Map {
    #[command(flatten)]
    source: Source,
    /// The PNG file to write.
    #[arg(short, long)]
    output: PathBuf,
    /// A PLY file to write the photons to, all of them, seen or not.
    #[arg(long)]
    ply: Option<PathBuf>,
    /// Which map.
    #[arg(long, value_enum, default_value = "all")]
    which: Which,
    #[command(flatten)]
    frame: Frame,
    #[command(flatten)]
    shown: ToneArgs,
    #[command(flatten)]
    photons: Photons,
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
}

/// Stops that keep places with many photons apart; a dot alone is never brighter than its colour.
fn dim(picture: &[Spectrum]) -> f64 {
    auto_exposure(picture.iter().copied()).min(0.0)
}

/// Memory that a pixel of a drawing takes \[bytes\]: its light, and its colour as it is written.
const PICTURE_BYTES: f64 = 40.0;

/// Memory that a photon takes in the list that is drawn \[bytes\]; what its record took in the pass is seldom given back.
const LIST_BYTES: f64 = 64.0;

impl Map {
    /// Draws and writes.
    pub fn run(self) -> anyhow::Result<()> {
        let extension = self.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if !extension.eq_ignore_ascii_case("png") {
            bail!("--output is {}; allowed: a file name that ends in .png", self.output.display());
        }
        if let Some(ply) = &self.ply
            && !ply.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"))
        {
            bail!("--ply is {}; allowed: a file name that ends in .ply", ply.display());
        }
        let exposure = self.shown.checked()?;
        let scene = self.source.load()?;
        let camera = self.frame.camera(&scene)?;
        check_writable(&self.output)?;
        if let Some(ply) = &self.ply {
            check_writable(ply)?;
            if is_same_file(&self.output, ply)? {
                bail!("--output {} and --ply {} lead to one file", self.output.display(), ply.display());
            }
        }
        let settings = self.photons.settings(Indirect::Gathered, self.seed, 0);
        let (photons, picture, seen) = on_threads(self.threads, || {
            let importance = self.photons.importance(&scene, &camera, &settings)?;
            let pixels = f64::from(camera.width()) * f64::from(camera.height());
            let fixed = (PICTURE_BYTES * pixels, LIST_BYTES);
            let emitted = self.photons.forecast(
                &scene,
                &settings,
                importance.as_ref(),
                Held::ALL,
                &self.memory,
                fixed,
            )?;
            let bar = Bar::stage("emission", emitted.histories());
            let maps = fill_counted_by_importance(&scene, &settings, emitted, importance.as_ref(), &bar);
            bar.finish();
            let maps = maps?;
            let mut made = MapsMade::default();
            made.add(&maps);
            self.photons.tell_sparse(&made.filled)?;
            let photons = self.chosen(maps)?;
            let (picture, seen) = draw_photons(&scene, &camera, &photons);
            Ok((photons, picture, seen))
        })?;
        let tone = Tone { exposure: exposure.unwrap_or_else(|| dim(&picture)), curve: self.shown.curve() };
        let pixels: Vec<[u8; 3]> = picture.into_iter().map(|p| tone.pixel(p)).collect();
        write_png(&self.output, (camera.width(), camera.height()), &pixels)?;
        if let Some(ply) = &self.ply {
            let white = Tone { exposure: 0.0, curve: turbid::output::Curve::Clip };
            write_ply(ply, &photons, |photon| white.pixel(colour(photon)))
                .with_context(|| format!("{} is written, the point cloud is not", self.output.display()))?;
        }
        print(&format!("photons        {}\nin the picture {seen}\n", photons.len()))
    }

    /// The photons of the maps asked for, each with the number that its map's pass emitted.
    fn chosen(&self, maps: Maps) -> anyhow::Result<Vec<(Photon, u64)>> {
        let chosen = match self.which {
            Which::Global => vec![maps.global],
            Which::Caustic => vec![maps.caustic],
            Which::Volume => vec![maps.volume],
            Which::All => vec![maps.global, maps.volume],
        };
        let maps: Vec<PhotonMap> = chosen.into_iter().flatten().collect();
        let mut photons: Vec<(Photon, u64)> = Vec::with_capacity(maps.iter().map(PhotonMap::stored).sum());
        for map in maps {
            photons.extend(map.tree().photons().map(|photon| (photon, map.emitted())));
        }
        if photons.is_empty() {
            bail!("the map is empty: the scene has no surface or medium that keeps such photons");
        }
        Ok(photons)
    }
}
