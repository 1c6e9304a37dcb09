//! The cells: the maps of one replicate, read by every estimator; one batch of the reference.

use super::asked::{OwnStudy, asked};
use super::picture::Picture;
use super::points::{Point, reach};
use super::reference::{BATCHES, Sampler, batch};
use super::words;
use crate::harness::{CellId, CellOutput, Group, Settings};
use anyhow::Context;
use std::sync::Arc;
use turbid::photons::maps::Maps;
use turbid::sensor::{MapSettings, RadianceMaps, SensorMaps};
use turbid::transport::NoProgress;

/// Name of the group of maps of a scene.
pub fn maps_group(point: usize, photons: u64) -> String {
    format!("scene{point:03}-n{photons}")
}

/// Name of the group of batches of a scene's reference.
pub fn reference_group(point: usize) -> String {
    format!("scene{point:03}-reference")
}

/// Estimates of a pixel, about.
const PIXEL: f64 = 50.0;

/// Work of one estimate beside that of a photon emitted, about.
const GATHER: f64 = 10.0;

/// The groups; none of a file that cannot be studied, which [`super::check`] refuses before.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let Ok(study) = asked(settings) else { return Vec::new() };
    let mut groups = Vec::new();
    for (number, point) in study.points.iter().enumerate() {
        for &photons in &study.photons {
            let own = study.clone();
            let asked =
                point.picture.as_ref().map_or(point.places.len() as f64, |p| PIXEL * p.pixels() as f64);
            let reads = asked * point.estimators.len() as f64;
            let cost = photons as f64 + GATHER * reads;
            let measure = move |settings: &Settings, id: &CellId| maps(&own, number, photons, settings, id);
            groups.push(Group::new(maps_group(number, photons), study.maps, cost, measure).holding(photons));
        }
        let (own, reference) = (study.clone(), &study.references[number]);
        let each = match (&point.picture, reference.sampler) {
            (Some(picture), _) => picture.pixels() as f64,
            (None, Sampler::Paths) => point.places.len() as f64,
            (None, Sampler::Light) => 1.0,
        };
        let measure = move |settings: &Settings, id: &CellId| sampled(&own, number, settings, id);
        groups.push(Group::new(reference_group(number), BATCHES, each * reference.samples as f64, measure));
    }
    groups
}

fn map_settings(
    study: &OwnStudy,
    point: &Point,
    photons: u64,
    settings: &Settings,
    id: &CellId,
) -> MapSettings {
    MapSettings {
        photons,
        seed: settings.seed,
        replicate: id.stream(words::NAME),
        reach: reach(&point.estimators),
        readings: study.file.measure.readings.0 as usize,
        radiance: RadianceMaps::of(&point.estimators),
    }
}

/// Photons of the maps that say whether they can be read.
const FEW: u64 = 256;

/// Refuses what maps of few photons refuse already, before anything is measured: a radius below what the positions of these tell apart.
/// Pictures are not tried.
///
/// # Errors
/// Those of the maps, with the estimator's name
pub fn try_estimators(study: &OwnStudy, settings: &Settings) -> anyhow::Result<()> {
    for point in study.points.iter().filter(|point| point.picture.is_none()) {
        let of =
            MapSettings { readings: 1, ..map_settings(study, point, FEW, settings, &CellId::of("trial", 0)) };
        let maps = SensorMaps::fill(&point.scene, of, &NoProgress)?;
        for estimator in &point.estimators {
            maps.read(estimator).with_context(|| format!("the estimator \"{}\"", estimator.name()))?;
        }
    }
    Ok(())
}

fn maps(
    study: &Arc<OwnStudy>,
    number: usize,
    photons: u64,
    settings: &Settings,
    id: &CellId,
) -> anyhow::Result<CellOutput> {
    let point: &Point = &study.points[number];
    let mut out = CellOutput::new();
    if let Some(picture) = &point.picture {
        return pictures(point, picture, photons, settings, id);
    }
    let of = map_settings(study, point, photons, settings, id);
    let maps = out.time(words::FILLING, |_| SensorMaps::fill(&point.scene, of, &NoProgress))?;
    out.count("photons emitted", photons);
    out.count("photons stored", maps.stored() as u64);
    out.push(words::maps(point, photons), "photons stored", maps.stored() as f64);
    for (index, estimator) in point.estimators.iter().enumerate() {
        let reading = out.time(&words::reading(index), |_| maps.read(estimator))?;
        let case = words::case(point, photons, estimator);
        for place in &point.places {
            out.push(
                case.as_str(),
                place.name.as_str(),
                reading.values[place.sensor][place.bin][place.channel],
            );
        }
        out.push(case.as_str(), "under-full share", reading.underfull as f64 / reading.gathers.max(1) as f64);
        out.count("estimates", reading.gathers);
    }
    Ok(out)
}

/// The picture from the maps of one replicate, by every estimator.
fn pictures(
    point: &Point,
    picture: &Picture,
    photons: u64,
    settings: &Settings,
    id: &CellId,
) -> anyhow::Result<CellOutput> {
    let mut out = CellOutput::new();
    let of = (settings.seed, id.stream(words::NAME));
    let maps = out.time(words::FILLING, |_| picture.maps(&point.scene, photons, &point.estimators, of))?;
    let stored: usize = maps.iter().flat_map(Maps::stored).sum();
    out.count("photons emitted", photons);
    out.count("photons stored", stored as u64);
    out.push(words::maps(point, photons), "photons stored", stored as f64);
    for (index, estimator) in point.estimators.iter().enumerate() {
        let read = |_: &mut CellOutput| picture.by_maps(&point.scene, &maps, estimator, of);
        let (values, underfull) = out.time(&words::reading(index), read)?;
        let case = words::case(point, photons, estimator);
        for (place, value) in point.places.iter().zip(values) {
            out.push(case.as_str(), place.name.as_str(), value);
        }
        out.push(case.as_str(), "under-full share", underfull);
    }
    Ok(out)
}

fn sampled(
    study: &Arc<OwnStudy>,
    number: usize,
    settings: &Settings,
    id: &CellId,
) -> anyhow::Result<CellOutput> {
    let (point, reference) = (&study.points[number], &study.references[number]);
    let mut out = CellOutput::new();
    let of = (settings.seed, id.stream(words::NAME));
    let measured = out.time(words::SAMPLING, |_| batch(point, reference.sampler, reference.samples, of))?;
    let case = words::reference(point);
    let [errors, vovs, contributing, heavy] = words::spread(point);
    for (place, batch) in point.places.iter().zip(&measured) {
        let mut push = |case: &str, number: f64| out.push(case, place.name.as_str(), number);
        push(&case, batch.mean);
        let Some(spread) = batch.spread else { continue };
        push(&errors, spread.std_error);
        // Of what is too small for its fourth power nothing is known.
        push(&vovs, if spread.vov.is_finite() { spread.vov } else { 1.0 });
        push(&heavy, f64::from(u8::from(spread.is_heavy)));
        if let Some(paths) = spread.contributing {
            push(&contributing, paths as f64);
        }
    }
    out.count("samples of references", reference.samples);
    Ok(out)
}
