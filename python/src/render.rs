//! Pictures of a scene: by photon maps, by paths or by light tracing.

use crate::arrays::doubles;
use crate::choices::chosen;
use crate::readout::{Options, Readout};
use crate::scene::Given;
use crate::work::{self, Watch};
use anyhow::{Context, Result, anyhow, bail};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use turbid::Spectrum;
use turbid::integrators::Layer;
use turbid::integrators::mapper::Mapper;
use turbid::memory;
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{MapSettings, Maps, MediumSamples, fill_counted_by_importance, forecast};
use turbid::photons::{Guide, GuideSettings};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Film, LIGHT_BYTES, LIGHT_PIXEL_BYTES, Method, Pixel, Streams, check_camera};
use turbid::transport::Progress;

/// Most memory that a pixel takes \[bytes\]: three films of 352 at most, and 14 images of three doubles for Python.
const PIXEL_BYTES: f64 = 1450.0;

/// Who makes the picture.
#[derive(Clone, Copy, PartialEq)]
enum With {
    Photons,
    Paths,
    Bidirectional,
    Light,
}

/// What is to be made.
struct Request {
    with: With,
    width: Option<u32>,
    height: Option<u32>,
    samples: u64,
    maps: u64,
    seed: u64,
    guide: Option<u64>,
    readout: Readout,
}

impl Request {
    /// The scene's camera, in the size asked for, and able to see light.
    fn camera(&self, scene: &Scene) -> Result<Camera> {
        let camera = scene.camera().ok_or_else(|| {
            anyhow!(
                "the scene has no [camera]: add one with position, look_at, fov, width and height, or take a scene that has one, such as the built-in fogbox"
            )
        })?;
        let camera = camera.sized(self.width, self.height).context("width, height")?;
        check_camera(scene, &camera)?;
        Ok(camera)
    }

    fn check(&self, scene: &Scene, camera: &Camera) -> Result<()> {
        if self.samples > u64::from(u32::MAX) {
            bail!("samples is {}; allowed: 1 to 4294967295", self.samples);
        }
        if matches!(self.with, With::Paths | With::Bidirectional) && !scene.plan().unreachable.is_empty() {
            bail!(
                "the path tracer cannot sample every path of this scene ({}): use photons, or a light with an extent",
                scene.plan().unreachable.join("; ")
            );
        }
        if scene.periodic_cell().is_some() && self.with != With::Paths {
            bail!(
                "pictures of a scene with `cell`, which stands for an unbounded slab, are made by paths: with_ = 'paths'"
            );
        }
        let pixels = f64::from(camera.width()) * f64::from(camera.height());
        Ok(memory::check(|| format!("a picture of {pixels} pixels"), self.film_bytes(camera))?)
    }

    fn film_bytes(&self, camera: &Camera) -> f64 {
        let pixels = f64::from(camera.width()) * f64::from(camera.height());
        let has_splats = matches!(self.with, With::Light | With::Bidirectional);
        let light = if has_splats { pixels * LIGHT_PIXEL_BYTES + LIGHT_BYTES } else { 0.0 };
        pixels * PIXEL_BYTES + light
    }

    /// The maps of one repetition.
    fn maps(
        &self,
        scene: &Scene,
        camera: &Camera,
        media: MediumSamples,
        streams: Streams,
        watch: &Watch,
    ) -> Result<Maps> {
        let [global, caustic, volume] = self.readout.amounts;
        let Streams { seed, replicate } = streams;
        let indirect = self.readout.indirect();
        let settings = MapSettings { global, caustic, volume, media, indirect, seed, replicate };
        let learned = ImportanceSettings { seed, replicate, ..Default::default() };
        let learn = || Importance::of(scene, camera, indirect, &learned, watch);
        let importance = self.readout.is_by_importance().then(learn).transpose()?;
        let forecast = forecast(scene, &settings, importance.as_ref())?;
        let stored: f64 = forecast.stored.iter().sum();
        memory::check(
            || format!("{stored:.2e} photons in maps"),
            forecast.bytes(self.maps) + self.film_bytes(camera),
        )?;
        Ok(fill_counted_by_importance(scene, &settings, forecast.emitted, importance.as_ref(), watch)?)
    }

    /// The picture, and samples a pixel: one film is what it is, several are samples of it.
    fn film(&self, scene: &Scene, camera: &Camera, watch: &Watch) -> Result<Film> {
        let mut mean = Film::new(camera.width(), camera.height());
        let settings = self.readout.settings(scene)?;
        // Every map is read as the first is.
        let mut read = None;
        for replicate in 0..self.maps {
            let streams = Streams { seed: self.seed, replicate };
            let fill = |method: &Method<'_>| {
                let mut film = Film::new(camera.width(), camera.height());
                watch.stage("gathering", self.samples.saturating_mul(film.pixels().len() as u64));
                method.extend(&mut film, camera, self.samples, streams, watch)?;
                Ok::<Film, turbid::Error>(film)
            };
            let film = match self.with {
                With::Paths => {
                    let guide = learn(scene, self.guide, streams, watch)?;
                    fill(&Method::of_paths(scene, guide.as_ref()))?
                }
                With::Bidirectional => fill(&Method::Bidirectional(scene))?,
                With::Light => fill(&Method::Light(scene))?,
                With::Photons => {
                    let maps = self.maps(scene, camera, settings.media(), streams, watch)?;
                    let settings = match read {
                        Some(settings) => settings,
                        None => *read.insert(self.readout.suited(&settings, maps.stored())?),
                    };
                    fill(&Method::Photons(Mapper::new(scene, &maps, &settings)))?
                }
            };
            if self.maps == 1 {
                return Ok(film);
            }
            mean.push_film(&film);
        }
        Ok(mean)
    }
}

/// Where light comes from, by the photons of so many histories, if any are asked for.
pub fn learn(
    scene: &Scene,
    histories: Option<u64>,
    Streams { seed, replicate }: Streams,
    watch: &Watch,
) -> turbid::Result<Option<Guide>> {
    let Some(histories) = histories else { return Ok(None) };
    watch.stage("guide", histories);
    let settings = GuideSettings { histories, seed, replicate, share: None };
    Guide::learn(scene, &settings, watch).map(Some)
}

/// Three channels a pixel, row by row from the top.
fn image<'py>(
    py: Python<'py>,
    film: &Film,
    value: impl Fn(&Pixel) -> Spectrum,
) -> PyResult<Bound<'py, PyAny>> {
    let pixels = film.pixels();
    let number = |at: usize| value(&pixels[at / 3])[at % 3];
    Ok(doubles(py, (0..3 * pixels.len()).map(number))?.into_any())
}

/// Makes a picture: radiance, its layers, the variances of both, photons of a sample.
#[pyfunction]
#[pyo3(signature = (scene, parameters, folder, with, width, height, samples, maps, seed, guide, threads, readout, progress))]
#[allow(clippy::too_many_arguments, reason = "called from one place, by name")]
pub fn render<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    parameters: Option<&Bound<'py, PyDict>>,
    folder: Option<PathBuf>,
    with: &str,
    width: Option<u32>,
    height: Option<u32>,
    samples: u64,
    maps: u64,
    seed: u64,
    guide: Option<u64>,
    threads: Option<u16>,
    readout: &Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let all = [
        ("photons", With::Photons),
        ("paths", With::Paths),
        ("path", With::Paths),
        ("bidirectional", With::Bidirectional),
        ("light", With::Light),
    ];
    let with = chosen("with_", with, &all)?;
    let readout = readout.extract::<Options>()?.understood()?;
    let given = Given::read(scene, parameters, folder)?;
    let scene = given.scene()?;
    let request = Request { with, width, height, samples, maps, seed, guide, readout };
    let film = work::run(py, threads, progress.as_ref(), move |watch| {
        let make = || {
            let camera = request.camera(&scene)?;
            request.check(&scene, &camera)?;
            request.film(&scene, &camera, watch)
        };
        make().map_err(|error| given.named(error))
    })?;
    let has_variance = film.samples() >= 2;
    let (layers, variances) = (PyDict::new(py), PyDict::new(py));
    for layer in Layer::ALL {
        layers.set_item(layer.name(), image(py, &film, |pixel| pixel.layers()[layer])?)?;
        if has_variance {
            let variance = |pixel: &Pixel| pixel.layer_variance(layer).unwrap_or(Spectrum::ZERO);
            variances.set_item(layer.name(), image(py, &film, variance)?)?;
        }
    }
    let dict = PyDict::new(py);
    dict.set_item("width", film.width())?;
    dict.set_item("height", film.height())?;
    dict.set_item("radiance", image(py, &film, Pixel::total)?)?;
    let total = |pixel: &Pixel| pixel.variance().unwrap_or(Spectrum::ZERO);
    dict.set_item("variance", if has_variance { Some(image(py, &film, total)?) } else { None })?;
    dict.set_item("layers", layers)?;
    dict.set_item("layer_variances", variances)?;
    dict.set_item("photons", doubles(py, film.pixels().iter().map(Pixel::photons))?)?;
    Ok(dict)
}
