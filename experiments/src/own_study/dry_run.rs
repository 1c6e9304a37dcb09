//! What a study will take, before it runs.

use super::asked::asked;
use super::measure::{maps_group, reference_group};
use super::points::{Point, reach};
use super::reference::{BATCHES, batch};
use super::words;
use super::words::is_fixed;
use crate::harness::{CellId, Settings, duration};
use cpu_time::ProcessTime;
use turbid::memory::{free, in_words};
use turbid::photons::PeakBytes;
use turbid::photons::beams::{self, BeamMap};
use turbid::photons::maps::Maps;
use turbid::photons::planes::{self, PlaneMap};
use turbid::sensor::{MapSettings, RadianceMaps, SensorMaps};
use turbid::transport::NoProgress;

/// Photons of the map that is read to time estimates, and samples of the batch that is timed, at most.
const PHOTONS: u64 = 1 << 14;
const SAMPLES: u64 = 1 << 10;

/// One line of what is to come.
struct Line {
    group: String,
    cells: u64,
    seconds: f64,
    bytes: f64,
}

/// Cells, CPU time and memory of a study in words, by pilots; nothing is kept.
///
/// # Errors
/// Those of reading the study, and of its pilots
pub fn dry_run(settings: &Settings) -> anyhow::Result<String> {
    let study = asked(settings)?;
    let mut lines = Vec::new();
    for (number, point) in study.points.iter().enumerate() {
        for &photons in &study.photons {
            let (seconds, bytes) = maps(point, photons, study.file.measure.readings.0 as usize, settings)?;
            lines.push(Line { group: maps_group(number, photons), cells: study.maps, seconds, bytes });
        }
        let reference = &study.references[number];
        let samples = reference.samples.min(SAMPLES);
        let id = CellId::of(&format!("dry-run-{number:03}"), 0);
        let start = ProcessTime::now();
        batch(point, reference.sampler, samples, (settings.seed, id.stream(words::NAME)))?;
        let one = start.elapsed().as_secs_f64() / samples as f64;
        let seconds = one * reference.samples as f64;
        lines.push(Line { group: reference_group(number), cells: BATCHES, seconds, bytes: 0.0 });
    }
    let mut text = format!("{:28} {:>6} {:>14} {:>12}\n", "cells of", "number", "CPU time", "memory");
    for Line { group, cells, seconds, bytes } in &lines {
        let time = duration(seconds * *cells as f64);
        let memory = if *bytes > 0.0 { in_words(*bytes) } else { String::new() };
        text += &format!("{group:28} {cells:>6} {time:>14} {memory:>12}\n");
    }
    let cells: u64 = lines.iter().map(|line| line.cells).sum();
    let seconds: f64 = lines.iter().map(|line| line.seconds * line.cells as f64).sum();
    let most = lines.iter().map(|line| line.bytes).fold(0.0, f64::max) * settings.threads as f64;
    if let Some(free) = free().filter(|free| *free < most) {
        text += &format!(
            "more memory than the {} that are free: fewer photons, or fewer --threads\n",
            in_words(free)
        );
    }
    text += &format!(
        "in all {cells} cells, {} of CPU time, about {} on {} threads, {} of memory at most\n",
        duration(seconds),
        duration(seconds / settings.threads as f64),
        settings.threads,
        in_words(most)
    );
    Ok(text)
}

/// Most memory that maps take with so many times the photons \[bytes\].
fn most_bytes(maps: &Maps, more: f64) -> f64 {
    let of_beams = maps.beams.as_ref().map_or(0, BeamMap::stored) as f64;
    let of_planes = maps.planes.as_ref().map_or(0, PlaneMap::stored) as f64;
    let of_points = maps.stored().iter().sum::<usize>() as f64 - of_beams - of_planes;
    let of_flights = beams::PEAK_BYTES * of_beams + planes::PEAK_BYTES * of_planes;
    PeakBytes::MAPS.of(more * of_points) + more * of_flights
}

/// CPU seconds and memory of one cell of maps.
fn maps(point: &Point, photons: u64, readings: usize, settings: &Settings) -> anyhow::Result<(f64, f64)> {
    let few = photons.min(PHOTONS);
    if let Some(picture) = &point.picture {
        let of = (settings.seed, CellId::of("dry-run", 0).stream(words::NAME));
        let start = ProcessTime::now();
        let maps = picture.maps(&point.scene, few, &point.estimators, of)?;
        let filling = start.elapsed().as_secs_f64() * photons as f64 / few as f64;
        let more = photons as f64 / few as f64;
        let bytes: f64 = maps.iter().map(|maps| most_bytes(maps, more)).sum();
        let mut reading = 0.0;
        for estimator in &point.estimators {
            let start = ProcessTime::now();
            picture.by_maps(&point.scene, &maps, estimator, of)?;
            let more = if is_fixed(estimator) { photons as f64 / few as f64 } else { 1.0 };
            reading += start.elapsed().as_secs_f64() * more;
        }
        return Ok((filling + reading, bytes));
    }
    let reach = reach(&point.estimators);
    let replicate = CellId::of("dry-run", 0).stream(words::NAME);
    let radiance = RadianceMaps::of(&point.estimators);
    let of =
        |photons: u64| MapSettings { photons, seed: settings.seed, replicate, reach, readings, radiance };
    let forecast = SensorMaps::forecast(&point.scene, &of(photons))?;
    let start = ProcessTime::now();
    let maps = SensorMaps::fill(&point.scene, of(few), &NoProgress)?;
    let filling = start.elapsed().as_secs_f64() * photons as f64 / few as f64;
    let mut reading = 0.0;
    for estimator in &point.estimators {
        let start = ProcessTime::now();
        maps.read(estimator)?;
        // Fixed radii find more photons in larger maps.
        let more = if is_fixed(estimator) { photons as f64 / few as f64 } else { 1.0 };
        reading += start.elapsed().as_secs_f64() * more;
    }
    Ok((filling + reading, forecast.bytes))
}
