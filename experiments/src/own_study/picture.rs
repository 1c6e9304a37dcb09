//! The camera's picture as what is measured: means over blocks of pixels, by layer.

use super::file::PictureFile;
use super::place::Place;
use crate::harness::Unit;
use anyhow::{Context, bail, ensure};
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Kernel};
use turbid::integrators::Layer;
use turbid::integrators::mapper::{LEAST_K, Mapper, Settings};
use turbid::photons::maps::{Amount, Indirect, MapSettings, Maps, fill};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Film, Method, Streams};
use turbid::transport::NoProgress;

/// How the picture is made.
#[derive(Debug, Clone)]
pub struct Picture {
    camera: Camera,
    /// Samples a pixel of a picture from maps.
    samples: u64,
    /// Blocks across and down.
    blocks: [u32; 2],
    /// Rays of a final gathering; 0 reads the global map where the eye looks.
    gather_rays: u32,
    /// What is measured: the total, then the layers that the scene has.
    layers: Vec<Option<Layer>>,
}

/// Pixels across where the file does not say.
const WIDTH: u64 = 48;

/// Name of the sum of all layers, which errors are told of.
pub const TOTAL: &str = "total";

impl Picture {
    /// The picture that a file asks for.
    ///
    /// # Errors
    /// A scene without camera, or one that maps or paths cannot draw; blocks that are no parts of the picture
    pub fn new(scene: &Scene, file: &PictureFile) -> anyhow::Result<Self> {
        let Some(camera) = scene.camera() else {
            bail!("picture: the scene has no [camera]; allowed without: probes, lattice, rays, sensors");
        };
        ensure!(
            scene.periodic_cell().is_none(),
            "picture: maps draw no scene with `cell`; allowed there: probes, lattice, rays, sensors"
        );
        let unreachable = &scene.plan().unreachable;
        ensure!(
            unreachable.is_empty(),
            "picture: paths cannot be its reference ({}); allowed: lights with an extent",
            unreachable.join("; ")
        );
        let width = file.width.map_or(WIDTH.min(u64::from(camera.width())), |width| width.0);
        let side = |pixels: u64| {
            u32::try_from(pixels)
                .with_context(|| format!("picture: a side of {pixels} pixels; allowed: up to 16384"))
        };
        let height = file.height.map(|height| side(height.0)).transpose()?;
        let camera = camera.sized(Some(side(width)?), height)?;
        let (width, height) = (camera.width(), camera.height());
        let [across, down] = file.blocks;
        ensure!(
            (1..=width).contains(&across) && (1..=height).contains(&down),
            "picture.blocks is {across} x {down}; allowed: 1 to the {width} x {height} pixels"
        );
        let plan = scene.plan();
        let on_surfaces = [Layer::Direct, Layer::Caustic, Layer::Indirect];
        let mut layers = vec![None];
        if plan.has_surfaces {
            layers.extend(on_surfaces.map(Some));
        }
        if plan.has_media {
            layers.extend([Layer::Single, Layer::Multiple].map(Some));
        }
        let (samples, gather_rays) = (file.samples.0, file.gather_rays);
        Ok(Picture { camera, samples, blocks: file.blocks, gather_rays, layers })
    }

    /// Pixels of a block, about.
    pub fn block_pixels(&self) -> u64 {
        let pixels = u64::from(self.camera.width()) * u64::from(self.camera.height());
        pixels / u64::from(self.blocks[0] * self.blocks[1])
    }

    /// Pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.camera.width()) * u64::from(self.camera.height())
    }

    /// What is measured: every block of every layer.
    pub fn places(&self) -> Vec<Place> {
        let [across, down] = self.blocks;
        let blocks = (0..down).flat_map(|j| (0..across).map(move |i| (i, j)));
        let of = |(layer, (i, j)): (&Option<Layer>, (u32, u32))| {
            let group = layer.map_or(TOTAL, Layer::name);
            let at = [f64::from(i), f64::from(j), 0.0];
            let (name, unit) = (format!("{group} [{i} {j}]"), Unit::RADIANCE);
            Place { name, group, sensor: 0, bin: 0, channel: 0, unit, at }
        };
        self.layers.iter().flat_map(|layer| blocks.clone().map(move |block| (layer, block))).map(of).collect()
    }

    /// The means of a film's blocks, channels averaged, each with its standard error between samples.
    fn means(&self, film: &Film) -> Vec<(f64, Option<f64>)> {
        let [across, down] = self.blocks;
        let (width, height) = (film.width(), film.height());
        let mut all = Vec::new();
        for layer in &self.layers {
            for (j, i) in (0..down).flat_map(|j| (0..across).map(move |i| (j, i))) {
                let (mut sum, mut square, mut count) = (0.0, Some(0.0), 0.0);
                for y in j * height / down..(j + 1) * height / down {
                    for x in i * width / across..(i + 1) * width / across {
                        let pixel = &film.pixels()[(y * width + x) as usize];
                        sum += pixel.mean_of(*layer).mean();
                        // Channels of one path rise and fall together, at most.
                        square = square.zip(pixel.variance_of(*layer)).map(|(sum, v)| sum + v.mean());
                        count += 1.0;
                    }
                }
                all.push((sum / count, square.map(|square| f64::sqrt(square) / count)));
            }
        }
        all
    }

    /// How maps are read by an estimator in media, and its kernel and gather on surfaces.
    ///
    /// # Errors
    /// None is known
    pub fn settings(&self, scene: &Scene, estimator: &Estimator) -> turbid::Result<Settings> {
        let mut settings = Settings::for_scene(scene, LEAST_K)?;
        settings.volume = *estimator;
        settings.global = (estimator.kernel, estimator.gather);
        settings.caustic = (Kernel::Cone, estimator.gather);
        settings.clips_discs = estimator.treatment != Treatment::None;
        settings.gather_rays = self.gather_rays.max(1);
        Ok(settings)
    }

    /// The maps of one replicate, of so many photons emitted each, by the same histories: one for all estimators that read the same of
    /// media.
    ///
    /// # Errors
    /// Those of the photon pass
    pub fn maps(
        &self,
        scene: &Scene,
        photons: u64,
        estimators: &[Estimator],
        (seed, replicate): (u64, u64),
    ) -> turbid::Result<Vec<Maps>> {
        let amount = Amount::Emitted(photons);
        let indirect = if self.gather_rays == 0 { Indirect::Seen } else { Indirect::Gathered };
        let mut all: Vec<Maps> = Vec::new();
        for estimator in estimators {
            let media = self.settings(scene, estimator)?.media();
            if all.iter().all(|maps| maps.media != media) {
                let (global, caustic, volume) = (amount, amount, amount);
                let settings = MapSettings { global, caustic, volume, media, indirect, seed, replicate };
                all.push(fill(scene, &settings, &NoProgress)?);
            }
        }
        Ok(all)
    }

    /// The picture by one estimator, from those of the maps that hold what it reads of media.
    ///
    /// # Errors
    /// Those of the photon mapper; `Error::Scene` if there are no such maps
    pub fn by_maps(
        &self,
        scene: &Scene,
        maps: &[Maps],
        estimator: &Estimator,
        (seed, replicate): (u64, u64),
    ) -> turbid::Result<(Vec<f64>, f64)> {
        let settings = self.settings(scene, estimator)?;
        let Some(maps) = maps.iter().find(|maps| maps.media == settings.media()) else {
            return Err(turbid::Error::Scene(format!("no map holds what {} reads", estimator.name())));
        };
        let method = Method::Photons(Mapper::new(scene, maps, &settings));
        let mut film = Film::new(self.camera.width(), self.camera.height());
        let streams = Streams { seed, replicate };
        let work = method.extend(&mut film, &self.camera, self.samples, streams, &NoProgress)?;
        let (found, under) = [work.global, work.caustic, work.volume]
            .iter()
            .fold((0, 0), |(count, under), gathers| (count + gathers.count, under + gathers.underfull));
        let means = self.means(&film).into_iter().map(|(mean, _)| mean).collect();
        Ok((means, under as f64 / found.max(1) as f64))
    }

    /// The picture by paths, so many a pixel: means and their standard errors.
    ///
    /// # Errors
    /// Those of the path tracer
    pub fn by_paths(
        &self,
        scene: &Scene,
        samples: u64,
        (seed, replicate): (u64, u64),
    ) -> turbid::Result<Vec<(f64, Option<f64>)>> {
        let streams = Streams { seed, replicate };
        let film = Method::Paths(scene).render(&self.camera, samples, streams, &NoProgress)?;
        Ok(self.means(&film))
    }
}
