//! Sensors read by photons: powers tallied where photons leave or end, fluence and radiance from photon maps.

use super::from_maps::{PhotonReadings, Surroundings, outside, read_bins};
use super::order_maps::{
    Kept, OrderMaps, RadianceMaps, Stored, is_radiance, is_tallied, map_orders, maps, maps_of, max_order,
    scored,
};
use super::reach::{check_reach, empty_place, has_extinction};
use super::{Measurement, Source, measurements, room, row_bytes};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::{BeamBlur, Estimator, Gather, RayEnds};
use crate::math::wrap;
use crate::photons::beams;
use crate::photons::planes::{self, check_planes};
use crate::photons::{BUILD_SECONDS, Emitter, Histories, Part, PeakBytes, Photon, Run, Scores, score_bytes};
use crate::scene::{Binned, Orders, Quantity, Scene, Sensor};
use crate::stats::Moments;
use crate::transport::{BLOCK, NoProgress, Progress, blocks_at_once};
use glam::DVec2;
use std::sync::atomic::AtomicU64;
use std::time::Instant;

/// How many photons and maps, and how maps are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotonSettings {
    /// Photons emitted a map.
    pub photons: u64,
    /// Independent maps.
    pub maps: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Orders that count, beside each sensor's own range.
    pub orders: Orders,
    /// How maps are read.
    pub estimator: Estimator,
}

/// Reads every sensor of the scene by photons.
///
/// # Errors
/// `Error::Scene` for a sensor that a volume map cannot answer: a fluence outside all media, or a radiance where
/// surfaces reflect; `Error::OutOfRange`; `Error::NonFinite`; `Error::Cancelled`.
pub fn by_photons(
    scene: &Scene,
    settings: &PhotonSettings,
    progress: &dyn Progress,
) -> Result<PhotonReadings> {
    by_photons_in_passes(scene, settings, 1, progress)
}

/// The same with the photons of each map in so many passes, one in memory at a time: their histories are those of one
/// pass, cut into consecutive parts, and estimates in a fixed radius are sums over photons, so that those of the parts, each
/// times its part of the histories, add up to that of the whole but for rounding.
///
/// # Errors
/// those of [`by_photons`]; `Error::Scene` for several passes and the k nearest photons, which are not known before the last
/// pass; `Error::OutOfRange` for no pass, or more of them than histories.
pub fn by_photons_in_passes(
    scene: &Scene,
    settings: &PhotonSettings,
    passes: u64,
    progress: &dyn Progress,
) -> Result<PhotonReadings> {
    if passes < 1 || passes > settings.photons {
        let allowed = "at least 1, and at most one a photon";
        return Err(Error::out_of_range("the number of passes", passes as f64, allowed));
    }
    let takes_nearest =
        !matches!(settings.estimator.gather, Gather::Radius(_)) || settings.estimator.ray_k.is_some();
    if passes > 1 && takes_nearest {
        return Err(Error::Scene(
            "the k nearest photons of a map cannot be found in passes that hold a part of it each: take a fixed radius, or \
             fewer photons"
                .into(),
        ));
    }
    let (sensors, margin) = prepared(scene, settings)?;
    let mut moments: Vec<_> = sensors.iter().map(|s| vec![[Moments::new(); 3]; bins(s)]).collect();
    let mut scores = Scores::default();
    let mut result = PhotonReadings::new();
    let max_order = max_order(&sensors);
    let surroundings = Surroundings::of(scene, &settings.estimator);
    for replicate in 0..settings.maps {
        let histories = Histories { count: settings.photons, seed: settings.seed, replicate, max_order };
        let mut estimates: Vec<_> = sensors.iter().map(|s| vec![Spectrum::ZERO; bins(s)]).collect();
        for number in 0..passes {
            let booked = (result.gathers, result.underfull, result.beyond);
            let part = Part { number, of: passes };
            let wanted = RadianceMaps::of([&settings.estimator]);
            let (pass, maps) = maps(scene, (&sensors, wanted), histories, part, margin, progress)?;
            result.ledger += pass.report.ledger;
            let tallied = sensors.iter().zip(moments.iter_mut()).zip(&pass.tallies);
            for ((_, mine), tally) in tallied.filter(|((s, _), _)| is_tallied(s)) {
                for (m, t) in mine[0].iter_mut().zip(tally) {
                    m.merge(t);
                }
            }
            scores.merge(pass.scores);
            let asked = Asked { surroundings: &surroundings, sensors: &sensors, settings };
            asked.read(&maps, replicate, passes, &mut estimates, &mut result)?;
            if number > 0 {
                // The same places as those of the first pass, asked again.
                (result.gathers, result.underfull, result.beyond) = booked;
            }
        }
        push(&sensors, &mut moments, estimates);
    }
    let mut scored = scores.moments(scene, settings.photons * settings.maps);
    result.measurements = rows(scene, &sensors, moments, || scored.next())?;
    Ok(result)
}

/// Whether photons in a map answer a sensor, so that those of a file do.
pub fn is_answered_by_map(sensor: &Sensor) -> bool {
    map_orders(sensor).is_some()
}

/// Reads the sensors that maps answer, see [`is_answered_by_map`], from photons of media that others have sent out: those of one
/// map each time, and their number emitted. Of `settings`, `photons` and `maps` do not count; `seed` is that of the places that
/// bins and rays are asked at.
///
/// # Errors
/// those of [`by_photons`] and of `given`; `Error::Scene` where maps answer no sensor
pub fn by_given_photons(
    scene: &Scene,
    settings: &PhotonSettings,
    given: impl IntoIterator<Item = Result<(Vec<Photon>, u64)>>,
) -> Result<PhotonReadings> {
    let (sensors, margin) = prepared_for_maps(scene, settings)?;
    let wanted = RadianceMaps::of([&settings.estimator]);
    let mut moments: Vec<_> = sensors.iter().map(|s| vec![[Moments::new(); 3]; bins(s)]).collect();
    let mut result = PhotonReadings::new();
    let surroundings = Surroundings::of(scene, &settings.estimator);
    for (replicate, photons) in (0..).zip(given) {
        let (mut photons, emitted) = photons?;
        if let Some(cell) = scene.periodic_cell() {
            photons.iter_mut().for_each(|photon| photon.position = wrap(photon.position, cell.side));
        }
        let stored = Stored { photons: vec![photons.into()], beams: Vec::new(), planes: Vec::new(), emitted };
        let maps = maps_of(scene, (&sensors, wanted), stored, margin, (settings.seed, replicate))?;
        let mut estimates: Vec<_> = sensors.iter().map(|s| vec![Spectrum::ZERO; bins(s)]).collect();
        let asked = Asked { surroundings: &surroundings, sensors: &sensors, settings };
        asked.read(&maps, replicate, 1, &mut estimates, &mut result)?;
        push(&sensors, &mut moments, estimates);
    }
    result.measurements = rows(scene, &sensors, moments, || None)?;
    Ok(result)
}

/// Most memory that [`by_given_photons`] takes for a map of so many photons, of settings that say how many maps \[bytes\].
///
/// # Errors
/// those of [`by_given_photons`]
pub fn given_bytes(scene: &Scene, settings: &PhotonSettings, count: u64) -> Result<f64> {
    let (sensors, margin) = prepared_for_maps(scene, settings)?;
    let all = count as f64 * around(scene, margin);
    let peak = PeakBytes::of_maps(settings.maps);
    let bytes = match RadianceMaps::of([&settings.estimator]).ranges(&sensors).points.len() {
        0 | 1 => peak.of(all),
        // All of them may be in each range.
        ranges => size_of::<Photon>() as f64 * all + ranges as f64 * peak.of(all),
    };
    Ok(bytes + row_bytes(scene))
}

/// The sensors that maps answer, as [`prepared`].
fn prepared_for_maps(scene: &Scene, settings: &PhotonSettings) -> Result<(Vec<Sensor>, f64)> {
    let sensors: Vec<&Sensor> = scene.sensors().iter().filter(|s| is_answered_by_map(s)).collect();
    if sensors.is_empty() {
        let names: Vec<String> = scene.sensors().iter().map(|s| format!("{} {}", s.name, s.label)).collect();
        return Err(Error::Scene(format!(
            "photons of a file answer none of the sensors ({}): those count photons on their way; allowed: fluence, radiance, \
             mean-fluence, mean-radiance",
            names.join(", ")
        )));
    }
    if settings.estimator.beam_radius.is_some() || settings.estimator.has_planes {
        return Err(Error::Scene(
            "photons of a file are points, and no beams or planes; allowed: a radius about points or rays, k nearest photons".into(),
        ));
    }
    prepared_of(scene, sensors, settings)
}

/// Numbers that a sensor gives.
fn bins(sensor: &Sensor) -> usize {
    sensor.binned().map_or(1, Binned::bins)
}

/// Counts the estimates from a map.
fn push(sensors: &[Sensor], moments: &mut [Vec<[Moments; 3]>], estimates: Vec<Vec<Spectrum>>) {
    let read = sensors.iter().zip(moments).zip(estimates);
    for ((_, moments), values) in read.filter(|((s, _), _)| map_orders(s).is_some()) {
        for (moments, value) in moments.iter_mut().zip(values) {
            for (channel, m) in moments.iter_mut().enumerate() {
                m.push(value[channel]);
            }
        }
    }
}

/// The measurements of all sensors; those of scores come from `scored`.
fn rows(
    scene: &Scene,
    sensors: &[Sensor],
    moments: Vec<Vec<[Moments; 3]>>,
    mut scored: impl FnMut() -> Option<[Moments; 3]>,
) -> Result<Vec<Measurement>> {
    let mut rows = room(scene);
    for (sensor, moments) in sensors.iter().zip(moments) {
        let source = match map_orders(sensor) {
            Some(_) => Source::Maps,
            None if is_tallied(sensor) => Source::Tally,
            None => Source::Scores,
        };
        for (bin, moments) in moments.into_iter().enumerate() {
            let moments = if source == Source::Scores { scored().unwrap_or(moments) } else { moments };
            let non_finite = moments.iter().filter(|m| !m.mean().is_finite()).count() as u64;
            if non_finite > 0 {
                return Err(Error::NonFinite { count: non_finite, place: "estimates from photon maps" });
            }
            rows.extend(measurements(scene, sensor, &moments, None, source, Some(bin)));
        }
    }
    Ok(rows)
}

/// What maps are asked.
struct Asked<'a> {
    surroundings: &'a Surroundings<'a>,
    sensors: &'a [Sensor],
    settings: &'a PhotonSettings,
}

impl Asked<'_> {
    /// Adds the estimates of every sensor that maps answer from the maps of one of so many passes of a run.
    fn read(
        &self,
        maps: &OrderMaps,
        replicate: u64,
        passes: u64,
        estimates: &mut [Vec<Spectrum>],
        result: &mut PhotonReadings,
    ) -> Result<()> {
        let Asked { surroundings, sensors, settings } = *self;
        let estimator = settings.estimator.in_map(replicate);
        let radii = maps.radii(sensors, &estimator);
        for (number, (sensor, sums)) in sensors.iter().zip(&mut *estimates).enumerate() {
            let Some(map) = maps.of(sensor, &estimator, &radii) else { continue };
            // Every pass asks at the same places.
            let index = sensors[..number].iter().filter(|s| map_orders(s) == map_orders(sensor)).count();
            let of = (settings.seed, replicate, index);
            let values = read_bins(surroundings, map, sensor, &estimator, of, result)?;
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value / passes as f64;
            }
        }
        Ok(())
    }
}

/// What a measurement by photons will take, by a pilot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotonForecast {
    /// Photons that one map holds, about.
    pub stored: f64,
    /// Most memory of one pass, about \[bytes\].
    pub bytes: f64,
    /// Time of shooting and building all maps at the pilot's rate \[s\].
    pub seconds: f64,
}

/// Histories of the pilot of a measurement, at most: one in 64 of the run's, so that it costs little beside it.
const FORECAST: u64 = 1024;

/// What [`by_photons_in_passes`] will take: the pilot runs the first of the run's own histories, and stores nothing.
///
/// # Errors
/// those of [`by_photons_in_passes`]
pub fn forecast(scene: &Scene, settings: &PhotonSettings, passes: u64) -> Result<PhotonForecast> {
    let (sensors, margin) = prepared(scene, settings)?;
    let PhotonSettings { photons, maps, seed, .. } = *settings;
    let wanted = RadianceMaps::of([&settings.estimator]);
    forecast_of(scene, (&sensors, wanted), margin, (photons, maps, seed), passes)
}

/// The same for sensors that are checked, `margin` beyond the cell: so many photons a map, so many maps, and the seed; the memory is
/// that of one of so many passes of a map.
pub(super) fn forecast_of(
    scene: &Scene,
    (sensors, wanted): (&[Sensor], RadianceMaps),
    margin: f64,
    (photons, maps, seed): (u64, u64, u64),
    passes: u64,
) -> Result<PhotonForecast> {
    let ranges = wanted.ranges(sensors);
    let count = photons.div_ceil(64).min(FORECAST);
    let histories = Histories { count, seed, replicate: 0, max_order: max_order(sensors) };
    let kept = Kept { ranges: &ranges, whole_beams: wanted.whole_beams, copied: Default::default() };
    let emitter = Emitter::by_power(scene);
    let run = Run { is_pilot: true, ..Run::new(scene, &emitter, histories) };
    let start = Instant::now();
    let pass = run.pass(&kept, &NoProgress)?;
    // The pilot is one block of histories and runs on one thread.
    let threads = rayon::current_num_threads() as f64;
    let one = start.elapsed().as_secs_f64() / count as f64;
    let [copied, copied_beams, copied_planes] = kept.copied.map(AtomicU64::into_inner);
    let a_history = |number: u64| number as f64 / count as f64 * photons as f64;
    let [met, copied] = [pass.met[1], copied].map(|n| a_history(n) * around(scene, margin));
    // A flight that crosses cells has several beams.
    let [met_beams, flights] = [pass.met_beams, copied_beams].map(a_history);
    let [met_planes, planes] = [pass.met_planes, copied_planes].map(a_history);
    // Where several ranges of orders have a map each, the photons of all stay until the last one.
    let peak = PeakBytes::of_maps(maps.saturating_mul(passes));
    let [met_a_pass, copied_a_pass] = [met, copied].map(|n| n / passes as f64);
    let of_points = match ranges.points.len() {
        0 | 1 => peak.of(met_a_pass),
        _ => size_of::<Photon>() as f64 * met_a_pass + peak.of(copied_a_pass),
    };
    let copies = |met: u64, ranges: &[Orders]| if met > 0 { ranges.len().max(1) as f64 } else { 1.0 };
    let of_beams = met_beams * copies(pass.met_beams, &ranges.beams);
    let of_planes = met_planes * copies(pass.met_planes, &ranges.planes);
    let bytes = of_points + (beams::PEAK_BYTES * of_beams + planes::PEAK_BYTES * of_planes) / passes as f64;
    let copied = copied + flights.max(of_beams) + planes.max(of_planes);
    let seconds = (one * photons as f64 + BUILD_SECONDS * copied) * maps as f64 / threads;
    // The scores of the blocks that are there at a time, those that they are added to, and what the threads' histories add up.
    let (scores, history) = score_bytes(scene, &scored(sensors));
    let scores = scores * (blocks_at_once(photons.div_ceil(BLOCK)) + 1.0) + history * threads;
    let bytes = bytes + scores + row_bytes(scene);
    Ok(PhotonForecast { stored: copied, bytes, seconds })
}

/// How many times the photons of a cell a map holds that is continued beyond its edges.
fn around(scene: &Scene, margin: f64) -> f64 {
    scene.periodic_cell().map_or(1.0, |cell| (DVec2::ONE + 2.0 * margin / cell.side).element_product())
}

/// The sensors with the orders that count, and how far beyond the cell's edges they read \[L\].
fn prepared(scene: &Scene, settings: &PhotonSettings) -> Result<(Vec<Sensor>, f64)> {
    prepared_of(scene, scene.sensors(), settings)
}

/// The same of some of the sensors.
fn prepared_of<'a>(
    scene: &Scene,
    sensors: impl IntoIterator<Item = &'a Sensor>,
    settings: &PhotonSettings,
) -> Result<(Vec<Sensor>, f64)> {
    let sensors: Vec<Sensor> =
        sensors.into_iter().map(|s| Sensor { orders: s.orders.and(&settings.orders), ..s.clone() }).collect();
    for sensor in &sensors {
        check(scene, sensor)?;
        // Estimates from maps are of media, where photons are; scores are of all that they cross.
        if sensor.binned().is_some() && map_orders(sensor).is_none() {
            check_reach(scene, sensor)?;
        }
    }
    check_rays(scene, &sensors, &settings.estimator)?;
    check_orders(scene, &sensors, RadianceMaps::of([&settings.estimator]))?;
    let margin = margin_of(scene, &sensors, settings.estimator.reach())?;
    Ok((sensors, margin))
}

/// The least part across a periodic slab of a direction of rays with ends of their own.
const LEAST_ACROSS: f64 = 0.01;

/// Whether beams are blurred, and stretches end, as sensors of radiance can be read.
///
/// # Errors
/// `Error::Scene` for a ball about a ray, and for ends of their own beside planes, where there is more than one homogeneous region, or of rays
/// along the faces of a periodic slab
pub(super) fn check_rays(scene: &Scene, sensors: &[Sensor], estimator: &Estimator) -> Result<()> {
    let Some(sensor) = sensors.iter().find(|sensor| is_radiance(sensor)) else { return Ok(()) };
    let refuse = |why: &str| Err(Error::Scene(format!("sensor {}: {why}", sensor.name)));
    if estimator.beam_radius.is_some() && estimator.beam_blur == BeamBlur::ThreeD {
        return refuse(
            "a blur of beams in three dimensions is about places, and rays have none; allowed: 1d, 2d",
        );
    }
    if estimator.ray_ends == RayEnds::Cut {
        return Ok(());
    }
    estimator.check_ends(scene).map_err(|error| error.within(&format!("sensor {}", sensor.name)))?;
    let along_faces = |sensor: &&Sensor| match &sensor.quantity {
        Quantity::Radiance(ray) => ray.dir.z.abs() < LEAST_ACROSS,
        Quantity::Binned(Binned::Radiance { dir, .. }) => dir.z.abs() < LEAST_ACROSS,
        _ => false,
    };
    match sensors.iter().find(along_faces) {
        Some(sensor) if scene.periodic_cell().is_some() => Err(Error::Scene(format!(
            "sensor {}: rays with ends of their own that run along the faces of a periodic slab pass cells without end; allowed: directions \
             whose z is {LEAST_ACROSS} or more of either sign, ends that are cut",
            sensor.name
        ))),
        _ => Ok(()),
    }
}

/// Whether planes can be stored and answer sensors of radiance, where they are asked to.
///
/// # Errors
/// those of [`check_planes`]; `Error::Scene` for light that is scattered once and no beams that bring it
pub(super) fn check_orders(scene: &Scene, sensors: &[Sensor], wanted: RadianceMaps) -> Result<()> {
    if !wanted.planes || !sensors.iter().any(is_radiance) {
        return Ok(());
    }
    check_planes(scene)?;
    let asks_once = |sensor: &&Sensor| is_radiance(sensor) && sensor.orders.contains(1);
    match sensors.iter().find(asks_once) {
        Some(sensor) if !wanted.direct_beams => Err(Error::Scene(format!(
            "sensor {}: planes bring light that is scattered twice and more; allowed: a beam radius beside them, for light that is \
             scattered once, or orders from 2",
            sensor.name
        ))),
        _ => Ok(()),
    }
}

/// How far beyond the edges of the scene's cell, if it has one, the sensors' balls of radius `cap` may reach \[L\].
///
/// # Errors
/// As [`margin`]
pub(super) fn margin_of(scene: &Scene, sensors: &[Sensor], cap: f64) -> Result<f64> {
    scene.periodic_cell().map_or(Ok(0.0), |cell| margin(sensors, cell.side, cap))
}

/// How far beyond the cell's edges the sensors' balls of radius `cap` may reach \[L\]; rays may pass any point.
///
/// # Errors
/// `Error::Scene` beyond the side of the cell: copies are made once, and a ball that reaches past them would miss
/// photons.
pub(super) fn margin(sensors: &[Sensor], side: DVec2, cap: f64) -> Result<f64> {
    let beyond = sensors.iter().map(|sensor| match sensor.quantity {
        Quantity::Fluence(p) => {
            let p = wrap(p, side);
            cap - p.x.min(p.y).min(side.x - p.x).min(side.y - p.y)
        }
        Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. } | Binned::Fluence { .. }) => cap,
        Quantity::Outflow { .. } | Quantity::Absorbed(_) | Quantity::Binned(_) => 0.0,
    });
    let margin = beyond.fold(0.0, f64::max);
    let shorter = side.min_element();
    if margin > shorter {
        return Err(Error::Scene(format!(
            "a gather radius of {cap} L reaches {margin} L beyond the periodic cell; allowed: at most its shorter side, {shorter} L"
        )));
    }
    Ok(margin)
}

/// Whether a volume map can answer a sensor.
pub(super) fn check(scene: &Scene, sensor: &Sensor) -> Result<()> {
    match sensor.quantity {
        Quantity::Fluence(p) if !has_extinction(scene, p) => Err(outside(sensor, p)),
        Quantity::Binned(ref binned @ Binned::Fluence { .. }) => {
            empty_place(scene, binned).map_or(Ok(()), |p| Err(outside(sensor, p)))
        }
        Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }) if scene.plan().has_surfaces => {
            Err(Error::Scene(format!(
                "sensor {}: the volume map alone does not know what surfaces reflect: use paths",
                sensor.name
            )))
        }
        _ => Ok(()),
    }
}
