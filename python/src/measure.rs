//! The sensors of a scene, by paths, bidirectional paths, photons or light tracing.

use crate::arrays::doubles;
use crate::choices::{beam_blur, beam_length, check_about_rays, chosen, kernel, ray_ends, treatment};
use crate::error::refuse;
use crate::render::learn;
use crate::scene::Given;
use crate::work::{self, Watch};
use anyhow::{Context, anyhow};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::integrators::Guides;
use turbid::math::Positive;
use turbid::memory;
use turbid::photons::Ledger;
use turbid::photons::beams::BeamLength;
use turbid::scene::{Binned, Orders, Quantity, Scene, Sensor, Space};
use turbid::sensor::{
    Measurement, PathSettings, PhotonSettings, Streams, TallySettings, by_bidirectional_paths,
    by_guided_paths, by_photons_in_passes, by_tallies, check_paths, forecast, row_bytes, tally_bytes,
};
use turbid::transport::{Progress, WeightWindows};

/// Who measures.
#[derive(Clone, Copy, PartialEq)]
enum With {
    Paths,
    Bidirectional,
    Photons,
    Light,
}

/// What Python asks for; its side has the defaults.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    samples: u64,
    photons: u64,
    maps: u64,
    passes: u64,
    k: Option<usize>,
    radius: Option<f64>,
    max_radius: Option<f64>,
    ray_radius: Option<f64>,
    ray_k: Option<usize>,
    beam_radius: Option<f64>,
    beam_fluence: bool,
    beam_blur: String,
    beam_length: String,
    ray_ends: String,
    planes: bool,
    progressive: bool,
    kernel: String,
    boundary: String,
    orders: (u32, Option<u32>),
    weight_windows: bool,
    guide: Option<u64>,
    seed: u64,
    threads: Option<u16>,
}

/// The same, understood.
struct Request {
    with: With,
    options: Options,
    kernel: Kernel,
    treatment: Treatment,
    blur: BeamBlur,
    length: BeamLength,
    ends: RayEnds,
}

/// What was measured, and what else there is to say.
struct Readings {
    measurements: Vec<Measurement>,
    ledger: Option<Ledger>,
    /// Estimates made, those with fewer than k photons within the cap, those whose ball reaches beyond their medium.
    estimates: Option<[u64; 3]>,
}

impl Request {
    fn orders(&self) -> Orders {
        let (min, max) = self.options.orders;
        Orders { min, max }
    }

    fn read(&self, scene: &Scene, watch: &Watch) -> anyhow::Result<Readings> {
        match self.with {
            With::Paths | With::Bidirectional => self.by_paths(scene, watch),
            With::Photons => self.by_photons(scene, watch),
            With::Light => self.by_light(scene, watch),
        }
    }

    fn by_paths(&self, scene: &Scene, watch: &Watch) -> anyhow::Result<Readings> {
        let Options { samples, seed, weight_windows, guide, .. } = self.options;
        let settings = PathSettings { samples, seed, replicate: 0, orders: self.orders() };
        let bins = bins(scene);
        memory::check(|| format!("{bins} bins"), row_bytes(scene))?;
        check_paths(scene)?;
        let windows = weight_windows.then(|| WeightWindows::new(scene)).transpose()?;
        let guide = learn(scene, guide, Streams { seed, replicate: 0 }, watch)?;
        let guides = Guides { windows: windows.as_ref(), learned: guide.as_ref() };
        watch.stage("paths", samples.saturating_mul(bins));
        let measurements = match self.with {
            With::Bidirectional => by_bidirectional_paths(scene, &settings, watch)?,
            _ => by_guided_paths(scene, &settings, guides, watch)?,
        };
        Ok(Readings { measurements, ledger: None, estimates: None })
    }

    fn by_light(&self, scene: &Scene, watch: &Watch) -> anyhow::Result<Readings> {
        let Options { photons, seed, .. } = self.options;
        let settings = TallySettings { photons, seed, orders: self.orders() };
        memory::check(|| format!("{} bins", bins(scene)), tally_bytes(scene, &settings))?;
        watch.stage("photons", photons);
        let result = by_tallies(scene, &settings, watch)?;
        Ok(Readings { measurements: result.measurements, ledger: Some(result.ledger), estimates: None })
    }

    fn by_photons(&self, scene: &Scene, watch: &Watch) -> anyhow::Result<Readings> {
        let Options {
            photons,
            maps,
            passes,
            k,
            radius,
            max_radius,
            ray_radius,
            ray_k,
            beam_radius,
            beam_fluence,
            planes,
            progressive,
            seed,
            ..
        } = self.options;
        if photons < maps {
            return Err(anyhow!("photons is {photons}; allowed: at least one for each of the {maps} maps"));
        }
        let gather = match radius {
            Some(radius) => Gather::radius(radius).context("radius")?,
            None => {
                let cap = max_radius.unwrap_or_else(|| default_cap(scene));
                Gather::nearest(k.unwrap_or(50), cap).context("k, max_radius")?
            }
        };
        let ray_radius = ray_radius.map(|radius| Positive::new("ray_radius", radius)).transpose()?;
        let beam_radius = beam_radius.map(|radius| Positive::new("beam_radius", radius)).transpose()?;
        if ray_radius.is_some() && beam_radius.is_some() {
            return Err(anyhow!("ray_radius reads points and beam_radius beams; allowed: one of them"));
        }
        if ray_k.is_some() && (ray_radius.is_none() || progressive) {
            return Err(anyhow!(
                "ray_k is the k nearest photons within ray_radius; allowed: with it, and not progressive, where radii shrink"
            ));
        }
        let (blur, length) = (self.blur, self.length);
        let is_told = beam_fluence || blur != BeamBlur::default() || length != BeamLength::default();
        if is_told && beam_radius.is_none() {
            return Err(anyhow!(
                "beam_fluence, beam_blur and beam_length say how beams are read; allowed: with beam_radius"
            ));
        }
        if self.ends == RayEnds::Own && (ray_radius, beam_radius) == (None, None) {
            return Err(anyhow!(
                "ray_ends is own, of rays that are read at once; allowed: with ray_radius or beam_radius"
            ));
        }
        if beam_fluence && progressive {
            return Err(anyhow!(
                "beam_fluence shrinks at another rate than rays; allowed: without progressive"
            ));
        }
        if planes && ray_radius.is_some() {
            return Err(anyhow!("ray_radius reads points and planes flights; allowed: one of them"));
        }
        if progressive && radius.is_none() && ray_radius.is_none() && beam_radius.is_none() {
            return Err(anyhow!(
                "progressive shrinks radii, and takes the k nearest photons as they are; allowed: with radius, ray_radius or beam_radius"
            ));
        }
        let is_of_balls = |s: &Sensor| {
            matches!(s.quantity, Quantity::Fluence(_) | Quantity::Binned(Binned::Fluence { .. }))
        };
        let has_balls = !beam_fluence && scene.sensors().iter().any(is_of_balls)
            || (ray_radius, beam_radius) == (None, None) && !planes;
        if !has_balls {
            check_about_rays(self.treatment)?;
            if k.is_some() || max_radius.is_some() {
                return Err(anyhow!(
                    "k and max_radius are of balls, and no sensor is read from one; allowed: with sensors of fluence, or without ray_radius, \
                     beam_radius and planes"
                ));
            }
        }
        let estimator = Estimator::new(self.kernel, gather).treated(self.treatment);
        let settings = PhotonSettings {
            photons: photons.div_ceil(maps),
            maps,
            seed,
            orders: self.orders(),
            estimator: Estimator {
                ray_radius,
                ray_k: ray_k.and_then(NonZeroUsize::new),
                beam_radius,
                beam_blur: blur,
                beam_length: length,
                has_beam_fluence: beam_fluence,
                ray_ends: self.ends,
                has_planes: planes,
                is_progressive: progressive,
                ..estimator
            },
        };
        // Refuses what passes cannot do before anything is counted.
        let forecast = forecast(scene, &settings, passes)?;
        memory::check(|| format!("a map of {:.2e} photons", forecast.stored), forecast.bytes)?;
        watch.stage("photons", settings.photons.saturating_mul(maps));
        let result = by_photons_in_passes(scene, &settings, passes, watch)?;
        Ok(Readings {
            measurements: result.measurements,
            ledger: Some(result.ledger),
            estimates: Some([result.gathers, result.underfull, result.beyond]),
        })
    }
}

fn bins(scene: &Scene) -> u64 {
    scene.sensors().iter().map(|s| s.binned().map_or(1, Binned::bins) as u64).sum()
}

/// Half the cell, or a mean free path of the densest medium.
fn default_cap(scene: &Scene) -> f64 {
    let densest = scene.regions().iter().map(|r| r.medium.highest_sigma_t().max()).fold(0.0, f64::max);
    match scene.periodic_cell() {
        Some(periodic_cell) => 0.5 * periodic_cell.side.min_element(),
        None if densest > 0.0 => 1.0 / densest,
        None => 1.0,
    }
}

/// Lengths of a sensor's axes: none for one number.
fn shape(binned: Option<&Binned>) -> Vec<usize> {
    let Some(binned) = binned else { return Vec::new() };
    let [ni, nj, nk] = binned.count();
    match binned {
        Binned::Fluence { space: Space::Shape(_), .. }
        | Binned::Absorption { space: Space::Shape(_), .. } => Vec::new(),
        Binned::Flux { .. } | Binned::Radiance { .. } => vec![ni, nj],
        Binned::Fluence { .. } | Binned::Absorption { .. } => vec![ni, nj, nk],
    }
}

/// The numbers of one sensor: `rows` has channels fastest, then the first axis of its bins.
fn group<'py>(
    py: Python<'py>,
    binned: Option<&Binned>,
    rows: &[Measurement],
    channels: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let shape = shape(binned);
    let count = binned.map_or([1; 3], Binned::count);
    let [ni, nj, nk] = count;
    // As NumPy has it: the last axis fastest.
    let order: Vec<&Measurement> = (0..ni * nj * nk)
        .flat_map(|at| {
            let (i, j, k) = (at / (nj * nk), at / nk % nj, at % nk);
            let first = channels * (i + ni * (j + nj * k));
            &rows[first..first + channels]
        })
        .collect();
    let dict = PyDict::new(py);
    let first = &rows[0];
    let name = if channels == 3 { first.quantity.trim_end_matches(".r") } else { &first.quantity };
    dict.set_item("sensor", &first.sensor)?;
    dict.set_item("quantity", name)?;
    dict.set_item("unit", first.unit)?;
    dict.set_item("n", first.n)?;
    dict.set_item("channels", channels)?;
    dict.set_item("mean", doubles(py, order.iter().map(|row| row.mean))?)?;
    dict.set_item("std_error", doubles(py, order.iter().map(|row| row.std_error.unwrap_or(f64::NAN)))?)?;
    let why: Vec<&str> = order.iter().map(|row| row.no_error.map_or("", |why| why.word())).collect();
    let why = if why.iter().all(|word| word.is_empty()) { None } else { Some(why) };
    dict.set_item("why", why)?;
    let middles: Option<Vec<f64>> = if shape.is_empty() {
        None
    } else {
        let bin = |row: &&Measurement| row.bin.and_then(|bin| bin.middle).unwrap_or([f64::NAN; 3]);
        Some(order.iter().step_by(channels).flat_map(bin).collect())
    };
    dict.set_item("middle", middles.map(|numbers| doubles(py, numbers.into_iter())).transpose()?)?;
    dict.set_item("shape", shape)?;
    Ok(dict)
}

fn ledger_dict<'py>(py: Python<'py>, ledger: &Ledger) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, power) in
        [("absorbed", ledger.absorbed), ("escaped", ledger.escaped), ("truncated", ledger.truncated)]
    {
        dict.set_item(name, power / ledger.emitted)?;
    }
    Ok(dict)
}

/// Measures: the sensors one by one, parts of the emitted power, counts of estimates.
#[pyfunction]
#[pyo3(signature = (scene, parameters, folder, with, options, progress))]
pub fn measure<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    parameters: Option<&Bound<'py, PyDict>>,
    folder: Option<PathBuf>,
    with: &str,
    options: &Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let all = [
        ("paths", With::Paths),
        ("path", With::Paths),
        ("bidirectional", With::Bidirectional),
        ("photons", With::Photons),
        ("light", With::Light),
    ];
    let with = chosen("with_", with, &all)?;
    let options: Options = options.extract()?;
    if options.radius.is_some() && (options.k.is_some() || options.max_radius.is_some()) {
        return Err(refuse("radius takes all photons within it; allowed with radius: no k, no max_radius"));
    }
    if options.weight_windows && with != With::Paths {
        return Err(refuse("weight_windows splits paths; allowed: with_ = 'paths'"));
    }
    if options.weight_windows && options.guide.is_some() {
        return Err(refuse("weight_windows and guide both lead paths; allowed: one of them"));
    }
    let (kernel, treatment) = (kernel("kernel", &options.kernel)?, treatment(&options.boundary)?);
    let (blur, length) = (beam_blur(&options.beam_blur)?, beam_length(&options.beam_length)?);
    let ends = ray_ends(&options.ray_ends)?;
    let request = Request { with, options, kernel, treatment, blur, length, ends };
    let given = Given::read(scene, parameters, folder)?;
    let scene = given.scene()?;
    if scene.sensors().is_empty() {
        return Err(crate::error::refused(
            &given.named(anyhow!("the scene has no sensors: nothing to measure")),
        ));
    }
    let threads = request.options.threads;
    let (scene, readings) = work::run(py, threads, progress.as_ref(), move |watch| {
        let readings = request.read(&scene, watch).map_err(|error| given.named(error))?;
        Ok((scene, readings))
    })?;
    let channels = if scene.plan().is_grey { 1 } else { 3 };
    let (list, mut rest) = (PyList::empty(py), readings.measurements.as_slice());
    for sensor in scene.sensors() {
        let binned = sensor.binned();
        let (rows, others) = rest.split_at(channels * binned.map_or(1, Binned::bins));
        list.append(group(py, binned, rows, channels)?)?;
        rest = others;
    }
    let dict = PyDict::new(py);
    dict.set_item("sensors", list)?;
    dict.set_item("ledger", readings.ledger.map(|ledger| ledger_dict(py, &ledger)).transpose()?)?;
    dict.set_item("estimates", readings.estimates)?;
    Ok(dict)
}
