//! Makes the pictures: photon maps and their readout, and pictures without them, each with the CPU time that it took.

use super::Grid;
use super::keep::{CachedRender, FORMAT, MapEstimates, RenderRecord};
use super::light::{ByLight, Unbiased};
use super::pictures::Picture;
use super::recipe;
use crate::harness::Digest;
use anyhow::{Context, anyhow};
use cpu_time::ProcessTime;
use std::path::Path;
use turbid::integrators::mapper;
use turbid::photons::maps::{self, Maps};
use turbid::scene::{Camera, Scene, SceneFile};
use turbid::sensor::{Film, Method, Streams};
use turbid::transport::Progress;

/// One picture's scene and camera, ready to be rendered.
pub struct Studio<'a> {
    /// Which picture.
    pub picture: &'a Picture,
    /// Its scene.
    pub scene: Scene,
    /// Its camera, in the size wanted.
    pub camera: Camera,
    /// Seed of everything.
    pub seed: u64,
    /// Digest of the program.
    pub program: String,
    /// Digest of the scene's text.
    text: String,
}

/// What the global and the caustic map hold, and what is kept of the light in media, as photons or as beams.
pub(super) fn stored(maps: &Maps) -> [u64; 3] {
    maps.stored().map(|number| number as u64)
}

impl<'a> Studio<'a> {
    /// Reads the scene of a picture from a folder of scenes.
    ///
    /// # Arguments   `scale` size of the picture over that of the scene's own camera
    pub fn open(
        picture: &'a Picture,
        folder: &Path,
        scale: f64,
        seed: u64,
        program: &str,
    ) -> anyhow::Result<Self> {
        let path = folder.join(format!("{}.toml", picture.name));
        let text = turbid::input::read_text(&path, 1 << 26)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let file = SceneFile::from_toml(&text).map_err(|e| anyhow!("{}: {e}", path.display()))?;
        let scene = file.scene(folder).with_context(|| path.display().to_string())?;
        let text = Digest::of(text.as_bytes()).to_string();
        let camera = scene.camera().with_context(|| format!("{} has no camera", path.display()))?;
        // Even, for the comparison on half the size.
        let size = |n: u32| 2 * ((f64::from(n) * 0.5 * scale).round() as u32).max(1);
        let camera = camera.with_size(size(camera.width()), size(camera.height()))?;
        Ok(Studio { picture, scene, camera, seed, program: program.to_string(), text })
    }

    /// The same at half the width and height, for what is only compared.
    pub fn halved(&self) -> anyhow::Result<Self> {
        let camera = self.camera.with_size(self.camera.width() / 2, self.camera.height() / 2)?;
        let (scene, program, text) = (self.scene.clone(), self.program.clone(), self.text.clone());
        Ok(Studio { picture: self.picture, scene, camera, seed: self.seed, program, text })
    }

    /// Size of the picture.
    pub fn grid(&self) -> Grid {
        Grid { width: self.camera.width() as usize, height: self.camera.height() as usize }
    }

    /// Samples of a whole picture with so many a pixel.
    pub fn work(&self, samples: u64) -> u64 {
        samples * self.grid().pixels() as u64
    }

    pub(super) fn words(&self, method: &str, samples: u64, replicate: u64) -> String {
        let Grid { width, height } = self.grid();
        format!(
            "{} {}, {method}, {width} x {height}, {samples} samples, seed {}, replicate {replicate}",
            self.picture.name, self.text, self.seed
        )
    }

    /// What a render by photons will be called.
    pub fn photon_words(&self, samples: u64, replicate: u64, factor: u64) -> String {
        let p = self.picture;
        let counts = format!(
            "photons {:?} x {factor}, nearest {:?} within {}, gather {} from {}, size {}{}",
            p.photons,
            p.nearest,
            p.reach,
            p.gather,
            p.near,
            p.size,
            if p.is_adaptive { "" } else { ", equal steps" }
        );
        self.words(&counts, samples, replicate)
    }

    /// What a render without photon maps will be called.
    pub fn unbiased_words(&self, by_light: ByLight, samples: u64, replicate: u64) -> String {
        self.words(
            &format!("{} {}", by_light.name(), by_light.permille.max(by_light.guide)),
            samples,
            replicate,
        )
    }

    /// Fills the maps of a replicate, with `factor` times the photons of the original.
    pub fn maps(&self, replicate: u64, factor: u64) -> anyhow::Result<Maps> {
        let settings = recipe::maps(self.picture, factor, self.seed, replicate);
        Ok(maps::fill(&self.scene, &settings, &turbid::transport::NoProgress)?)
    }

    /// A picture from one set of maps.
    pub fn photons(
        &self,
        samples: u64,
        replicate: u64,
        factor: u64,
        progress: &dyn Progress,
    ) -> anyhow::Result<CachedRender> {
        let start = ProcessTime::now();
        let maps = self.maps(replicate, factor)?;
        let map_seconds = start.elapsed().as_secs_f64();
        let settings = recipe::readout(self.picture, factor)?;
        let method = Method::Photons(mapper::Mapper::new(&self.scene, &maps, &settings));
        let mut film = Film::new(self.camera.width(), self.camera.height());
        let report = method.extend(&mut film, &self.camera, samples, self.streams(replicate), progress)?;
        let gathers = [report.global, report.caustic, report.volume];
        let asked = settings.nearest();
        let facts = RenderRecord {
            format: FORMAT,
            words: self.photon_words(samples, replicate, factor),
            program: self.program.clone(),
            seconds: start.elapsed().as_secs_f64(),
            map_seconds,
            samples,
            emitted: [maps.report.main.emitted, maps.report.caustic.emitted],
            stored: stored(&maps),
            radii: gathers.map(|g| g.mean_radius()),
            estimates: Some([0, 1, 2].map(|map| MapEstimates::new(asked[map], &gathers[map]))),
        };
        Ok(CachedRender::new(facts, film.pixels().iter().map(|p| p.layers()).collect()))
    }

    /// A picture without photon maps.
    pub fn unbiased(
        &self,
        by_light: ByLight,
        samples: u64,
        replicate: u64,
        progress: &dyn Progress,
    ) -> anyhow::Result<CachedRender> {
        let start = ProcessTime::now();
        let mut picture = Unbiased::new(by_light, &self.scene, &self.camera, self.streams(replicate))?;
        picture.extend(samples, progress)?;
        Ok(self.render_of(&picture, start))
    }

    /// A picture without photon maps that takes about so many CPU seconds: whole passes over all pixels, at least one. The number
    /// of samples depends on the clock; a render of that number repeats it but for rounding.
    pub fn unbiased_for(
        &self,
        by_light: ByLight,
        seconds: f64,
        replicate: u64,
        progress: &dyn Progress,
    ) -> anyhow::Result<CachedRender> {
        let start = ProcessTime::now();
        let mut picture = Unbiased::new(by_light, &self.scene, &self.camera, self.streams(replicate))?;
        picture.extend(1, progress)?;
        loop {
            let spent = start.elapsed().as_secs_f64();
            let each = spent / picture.samples() as f64;
            // Half of what is left, as long as that is more than a sample: late passes are timed best.
            let more = (0.5 * (seconds - spent) / each) as u64;
            if spent + 0.5 * each >= seconds {
                return Ok(self.render_of(&picture, start));
            }
            picture.extend(more.max(1), progress)?;
        }
    }

    pub(super) fn streams(&self, replicate: u64) -> Streams {
        Streams { seed: self.seed, replicate }
    }

    fn render_of(&self, picture: &Unbiased, start: ProcessTime) -> CachedRender {
        let samples = picture.samples();
        let facts = RenderRecord {
            format: FORMAT,
            words: self.unbiased_words(picture.by_light, samples, picture.streams.replicate),
            program: self.program.clone(),
            seconds: start.elapsed().as_secs_f64(),
            map_seconds: 0.0,
            samples,
            emitted: [0; 2],
            stored: [0; 3],
            radii: [0.0; 3],
            estimates: None,
        };
        CachedRender::new(facts, picture.layers())
    }
}
