//! Sensors read by photons: powers tallied where photons leave or end, fluence and radiance from photon maps.

use super::reach::check_reach;
use super::{Measurement, Source, measurements, room, row_bytes};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::boundary::{Boundary, Treatment};
use crate::estimators::{
    BeamBlur, BeamLength, Estimate, Estimator, Gather, OwnEnds, PlaneEstimator, RayEnds,
};
use crate::geometry::Shape;
use crate::integrators::mapper::{MediumExtent, medium_extents, scene_size};
use crate::integrators::{March, StepRule, along};
use crate::math::{Interval, Positive, Ray};
use crate::medium::Medium;
use crate::photons::beams::{self, Beam, BeamMap, check_beams, check_whole_beams};
use crate::photons::planes::{self, Plane, PlaneMap, check_planes};
use crate::photons::tree::Radii;
use crate::photons::{
    BUILD_SECONDS, Emitter, Flags, Histories, Ledger, PEAK_BYTES, Part, Pass, Photon, PhotonMap, Run, Scores,
    Storage, periodic, score_bytes,
};
use crate::rng::{Purpose, Stream};
use crate::scene::{Binned, Orders, Quantity, Scene, Sensor};
use crate::stats::Moments;
use crate::transport::{BLOCK, NoProgress, Passage, Progress, blocks_at_once, in_parallel, transmittance};
use glam::{DVec2, DVec3};
use std::sync::atomic::{AtomicU64, Ordering};
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

/// What photons read, and where their power went.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotonReadings {
    /// One a sensor and channel: tallies have n = histories, maps n = maps.
    pub measurements: Vec<Measurement>,
    /// Powers \[W\] by history.
    pub ledger: Ledger,
    /// Estimates that found fewer than k photons within the cap.
    pub underfull: u64,
    /// Estimates without a treatment whose ball reaches beyond the medium that the point is in.
    pub beyond: u64,
    /// Estimates made.
    pub gathers: u64,
    /// Radius of the smallest ball \[L\]; infinite of none.
    pub least_radius: f64,
}

impl PhotonReadings {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        PhotonReadings {
            measurements: Vec::new(),
            ledger: Ledger::default(),
            underfull: 0,
            beyond: 0,
            gathers: 0,
            least_radius: f64::INFINITY,
        }
    }

    /// Counts an estimate at a point.
    fn book(&mut self, scene: &Scene, p: DVec3, estimate: &Estimate, treatment: Treatment) {
        self.gathers += 1;
        self.least_radius = self.least_radius.min(estimate.radius);
        self.underfull += u64::from(estimate.underfull);
        self.beyond += u64::from(treatment == Treatment::None && estimate.radius > scene.room(p));
    }
}

/// Steps of a ray through a medium, about, as far as a channel reaches: behind this optical depth lies 2e-9 of what it brings.
const STEPS: f64 = 200.0;
const DEPTH: f64 = 20.0;

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
            photons
                .iter_mut()
                .for_each(|photon| photon.position = periodic::wrap(photon.position, cell.side));
        }
        let stored = Stored { photons: vec![photons], beams: Vec::new(), planes: Vec::new(), emitted };
        let maps = maps_of(scene, (&sensors, wanted), stored, margin, (settings.seed, replicate))?;
        let mut estimates: Vec<_> = sensors.iter().map(|s| vec![Spectrum::ZERO; bins(s)]).collect();
        let asked = Asked { surroundings: &surroundings, sensors: &sensors, settings };
        asked.read(&maps, replicate, 1, &mut estimates, &mut result)?;
        push(&sensors, &mut moments, estimates);
    }
    result.measurements = rows(scene, &sensors, moments, || None)?;
    Ok(result)
}

/// Most memory that [`by_given_photons`] takes for a map of so many photons \[bytes\].
///
/// # Errors
/// those of [`by_given_photons`]
pub fn given_bytes(scene: &Scene, settings: &PhotonSettings, count: u64) -> Result<f64> {
    let (sensors, margin) = prepared_for_maps(scene, settings)?;
    let all = count as f64 * around(scene, margin);
    let bytes = match RadianceMaps::of([&settings.estimator]).ranges(&sensors).points.len() {
        0 | 1 => PEAK_BYTES * all,
        // All of them may be in each range.
        maps => (size_of::<Photon>() as f64 + PEAK_BYTES * maps as f64) * all,
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

/// What is about the points that maps are asked at.
pub(super) struct Surroundings<'a> {
    scene: &'a Scene,
    extents: Vec<MediumExtent>,
    /// Bodies that part photons from a point, where a rule of the literature asks for them.
    walls: Option<Vec<Shape>>,
}

impl<'a> Surroundings<'a> {
    pub(super) fn of(scene: &'a Scene, estimator: &Estimator) -> Self {
        let walls = || scene.objects().iter().map(|object| object.shape.clone()).collect();
        let walls = estimator.needs_walls().then(walls);
        Surroundings { scene, extents: medium_extents(scene), walls }
    }

    /// The boundary of a medium.
    fn boundary(&self, number: usize) -> Boundary<'_> {
        let boundary = self.extents[number].boundary();
        match &self.walls {
            Some(walls) => boundary.about(&[]).with_walls(walls),
            None => boundary,
        }
    }
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
    let whole = forecast_of(scene, (&sensors, wanted), margin, (photons, maps, seed))?;
    Ok(PhotonForecast { bytes: whole.bytes / passes as f64, ..whole })
}

/// The same for sensors that are checked, `margin` beyond the cell: so many photons a map, so many maps, and the seed.
pub(super) fn forecast_of(
    scene: &Scene,
    (sensors, wanted): (&[Sensor], RadianceMaps),
    margin: f64,
    (photons, maps, seed): (u64, u64, u64),
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
    let of_points = match ranges.points.len() {
        0 | 1 => PEAK_BYTES * met,
        _ => size_of::<Photon>() as f64 * met + PEAK_BYTES * copied,
    };
    let copies = |met: u64, ranges: &[Orders]| if met > 0 { ranges.len().max(1) as f64 } else { 1.0 };
    let of_beams = met_beams * copies(pass.met_beams, &ranges.beams);
    let of_planes = met_planes * copies(pass.met_planes, &ranges.planes);
    let bytes = of_points + beams::PEAK_BYTES * of_beams + planes::PEAK_BYTES * of_planes;
    let copied = copied + flights.max(of_beams) + planes.max(of_planes);
    let seconds = (one * photons as f64 + BUILD_SECONDS * copied) * maps as f64 / threads;
    // The scores of the blocks that are there at a time, those that they are added to, and what the threads' histories add up.
    let (scores, history) = score_bytes(scene, &scored(sensors));
    let scores = scores * (blocks_at_once(photons.div_ceil(BLOCK)) + 1.0) + history * threads;
    let bytes = bytes + scores + row_bytes(scene);
    Ok(PhotonForecast { stored: copied, bytes, seconds })
}

/// What radiance, and fluence, is read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RadianceMaps {
    /// Photons, in balls or about rays.
    pub points: bool,
    /// Their flights.
    pub beams: bool,
    /// Planes of their flights.
    pub planes: bool,
    /// Flights that come straight from lights, beside planes.
    pub direct_beams: bool,
    /// What fluence is read from.
    pub fluence: FluenceMaps,
    /// Whether flights are stored as far as they could go.
    pub whole_beams: bool,
}

/// What fluence is read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FluenceMaps {
    /// Photons in balls.
    #[default]
    Points,
    /// Flights that pass.
    Beams,
    /// Both, by estimators of their own.
    Both,
}

impl RadianceMaps {
    /// What these estimators ask.
    pub fn of<'a>(estimators: impl IntoIterator<Item = &'a Estimator>) -> Self {
        let mut wanted = RadianceMaps::default();
        let mut of_fluence = [false; 2];
        for estimator in estimators {
            of_fluence[usize::from(estimator.has_beam_fluence)] = true;
            wanted.whole_beams |= estimator.beam_length == BeamLength::Whole;
            let (of_beams, of_planes) = (estimator.beam_radius.is_some(), estimator.has_planes);
            wanted.points |= !of_beams && !of_planes;
            wanted.beams |= of_beams && !of_planes;
            wanted.planes |= of_planes;
            wanted.direct_beams |= of_beams && of_planes;
        }
        wanted.fluence = match of_fluence {
            [_, false] => FluenceMaps::Points,
            [false, true] => FluenceMaps::Beams,
            [true, true] => FluenceMaps::Both,
        };
        wanted
    }

    /// Whether any sensor is read from beams.
    pub(super) fn asks_beams(self, sensors: &[Sensor]) -> bool {
        let asks = |sensor: &Sensor| match is_radiance(sensor) {
            true => self.beams || self.direct_beams,
            false => self.fluence != FluenceMaps::Points && map_orders(sensor).is_some(),
        };
        sensors.iter().any(asks)
    }

    /// The ranges of orders that need a map each.
    fn ranges(self, sensors: &[Sensor]) -> Ranges {
        let mut all = Ranges::default();
        for sensor in sensors {
            let Some(range) = map_orders(sensor) else { continue };
            let is_radiance = is_radiance(sensor);
            let of_planes = plane_orders(sensor).filter(|_| self.planes && is_radiance);
            let has_direct = self.direct_beams && is_radiance && range.contains(0);
            let add = |range: Option<Orders>, ranges: &mut Vec<Orders>| {
                if let Some(range) = range.filter(|range| !ranges.contains(range)) {
                    ranges.push(range);
                }
            };
            let of_points = if is_radiance { self.points } else { self.fluence != FluenceMaps::Beams };
            let of_beams = if is_radiance { self.beams } else { self.fluence != FluenceMaps::Points };
            add(of_points.then_some(range), &mut all.points);
            add(of_beams.then_some(range), &mut all.beams);
            add(has_direct.then_some(DIRECT), &mut all.beams);
            add(of_planes, &mut all.planes);
        }
        all
    }
}

/// The ranges of orders that need a map of points, of beams, and of planes each.
#[derive(Debug, Default)]
struct Ranges {
    points: Vec<Orders>,
    beams: Vec<Orders>,
    planes: Vec<Orders>,
}

/// Photons straight from lights.
const DIRECT: Orders = Orders { min: 0, max: Some(0) };

/// The orders of the flights whose planes answer a sensor of radiance: scattered twice they are what it asks for. None where it asks
/// for less.
fn plane_orders(sensor: &Sensor) -> Option<Orders> {
    let Orders { min, max } = sensor.orders;
    let max = match max {
        Some(max) => Some(max.checked_sub(2)?),
        None => None,
    };
    Some(Orders { min: min.saturating_sub(2), max })
}

/// Whether a sensor is read along rays.
fn is_radiance(sensor: &Sensor) -> bool {
    matches!(sensor.quantity, Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }))
}

/// What a pass keeps: what maps of any range hold.
struct Kept<'a> {
    ranges: &'a Ranges,
    whole_beams: bool,
    /// Photons, flights and planes that were kept, once a range.
    copied: [AtomicU64; 3],
}

impl Kept<'_> {
    fn holds(&self, which: usize, order: u32) -> bool {
        let Ranges { points, beams, planes } = self.ranges;
        let ranges = [points, beams, planes][which];
        let holding = ranges.iter().filter(|range| range.contains(order)).count() as u64;
        self.copied[which].fetch_add(holding, Ordering::Relaxed);
        holding > 0
    }
}

impl Storage for Kept<'_> {
    fn in_medium(&self, _history: u64, photon: &Photon) -> bool {
        self.holds(0, u32::from(photon.order))
    }

    fn has_beams(&self) -> bool {
        !self.ranges.beams.is_empty()
    }

    fn has_whole_beams(&self) -> bool {
        self.whole_beams
    }

    fn has_planes(&self) -> bool {
        !self.ranges.planes.is_empty()
    }

    fn on_plane(&self, _history: u64, order: u32, _flags: Flags) -> bool {
        self.holds(2, order)
    }

    fn on_flight(&self, _history: u64, order: u32, _flags: Flags) -> bool {
        self.holds(1, order)
    }
}

/// The maps of one pass, one for each range of orders that is asked for.
pub(super) struct OrderMaps {
    points: Vec<(Orders, PhotonMap)>,
    beams: Vec<(Orders, BeamMap)>,
    planes: Vec<(Orders, PlaneMap)>,
}

/// The map that a sensor asks.
#[derive(Clone, Copy)]
pub(super) enum AskedMap<'a> {
    /// Photons, with a radius about rays for each, where there is one.
    Points(&'a PhotonMap, Option<&'a Radii>),
    Beams(&'a BeamMap),
    /// Light scattered twice and more, and once, where a sensor asks for them.
    Planes(Option<&'a PlaneMap>, Option<&'a BeamMap>),
}

impl AskedMap<'_> {
    /// Checks that positions are told apart finely enough for a radius \[L\]: those of beams and planes always are.
    fn check_radius(self, radius: f64) -> Result<()> {
        match self {
            AskedMap::Points(map, _) => map.check_radius(radius),
            AskedMap::Beams(_) | AskedMap::Planes(..) => Ok(()),
        }
    }
}

impl OrderMaps {
    /// The radii of the photons about rays, of each range of orders that a sensor of radiance asks, if the estimator has some.
    pub(super) fn radii(&self, sensors: &[Sensor], estimator: &Estimator) -> Vec<(Orders, Radii)> {
        let (Some(k), Some(most)) = (estimator.ray_k, estimator.ray_radius) else { return Vec::new() };
        let asked: Vec<Orders> = sensors.iter().filter(|s| is_radiance(s)).filter_map(map_orders).collect();
        let asked = self.points.iter().filter(|(range, _)| asked.contains(range));
        asked.map(|(range, map)| (*range, map.radii(k.get(), most.get()))).collect()
    }

    /// The map that answers a sensor by an estimator, whose radii are those of [`OrderMaps::radii`].
    pub(super) fn of<'a>(
        &'a self,
        sensor: &Sensor,
        estimator: &Estimator,
        radii: &'a [(Orders, Radii)],
    ) -> Option<AskedMap<'a>> {
        let range = map_orders(sensor)?;
        if estimator.has_planes && is_radiance(sensor) {
            let of_planes = plane_orders(sensor);
            let planes = self.planes.iter().find(|(held, _)| Some(*held) == of_planes);
            let direct = self.beams.iter().find(|(held, _)| range.contains(0) && *held == DIRECT);
            let direct = direct.filter(|_| estimator.beam_radius.is_some());
            let is_filled = planes.is_some() == of_planes.is_some() && direct.is_some() == range.contains(0);
            return is_filled
                .then(|| AskedMap::Planes(planes.map(|(_, map)| map), direct.map(|(_, map)| map)));
        }
        if estimator.beam_radius.is_some() && (is_radiance(sensor) || estimator.has_beam_fluence) {
            let own = self.beams.iter().find(|(held, _)| *held == range);
            return own.map(|(_, map)| AskedMap::Beams(map));
        }
        let radii = radii.iter().find(|(held, _)| is_radiance(sensor) && *held == range);
        self.points_of(sensor).map(|map| AskedMap::Points(map, radii.map(|(_, radii)| radii)))
    }

    /// The map of photons that answers a sensor.
    pub(super) fn points_of(&self, sensor: &Sensor) -> Option<&PhotonMap> {
        let own = self.points.iter().find(|(held, _)| map_orders(sensor) == Some(*held));
        own.map(|(_, map)| map)
    }

    /// Photons that they hold, those beyond the edges of a periodic cell too, beams, and planes.
    pub(super) fn stored(&self) -> usize {
        let points: usize = self.points.iter().map(|(_, map)| map.stored()).sum();
        let planes: usize = self.planes.iter().map(|(_, map)| map.stored()).sum();
        points + planes + self.beams.iter().map(|(_, map)| map.stored()).sum::<usize>()
    }
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
    let wanted = RadianceMaps::of([&settings.estimator]);
    if wanted.asks_beams(&sensors) {
        check_beams_of(scene, wanted)?;
    }
    check_rays(scene, &sensors, &settings.estimator)?;
    check_orders(scene, &sensors, wanted)?;
    let margin = margin_of(scene, &sensors, settings.estimator.reach())?;
    Ok((sensors, margin))
}

/// Whether flights can be stored as they are wanted.
///
/// # Errors
/// those of [`check_beams`] and [`check_whole_beams`]
pub(super) fn check_beams_of(scene: &Scene, wanted: RadianceMaps) -> Result<()> {
    if wanted.whole_beams { check_whole_beams(scene) } else { check_beams(scene) }
}

/// Whether beams are blurred, and stretches end, as sensors of radiance can be read.
///
/// # Errors
/// `Error::Scene` for a ball about a ray, and for ends of their own beside planes, or where there is more than one homogeneous region
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
    if estimator.has_planes || !estimator.reads_rays() {
        return refuse(
            "ends of their own are those of photons and beams about rays; allowed: a ray radius or a beam radius, no planes",
        );
    }
    let is_alone = scene.regions().len() == 1 && scene.media().len() == 1 && !scene.plan().has_surfaces;
    let has_lamps = scene.lights().iter().any(|light| light.body().is_some());
    let is_layer = scene.regions().iter().all(|region| matches!(region.shape, Shape::Slab(_)));
    if !is_alone
        || has_lamps
        || !scene.medium(0).is_homogeneous()
        || (scene.periodic_cell().is_some() && !is_layer)
    {
        return refuse(
            "rays end for each photon or beam in one homogeneous region with nothing in it, in a periodic cell a slab; allowed \
             otherwise: ends that are cut",
        );
    }
    Ok(())
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

/// The largest order of a collision that any sensor asks for, if there is one.
pub(super) fn max_order(sensors: &[Sensor]) -> Option<u32> {
    sensors.iter().map(|s| s.orders.max).try_fold(0, |most, max| max.map(|m| most.max(m)))
}

/// One pass of a part of the histories and its maps, one for each range of orders that a sensor needs, continued `margin`
/// beyond the periodic cell. The pass's own photons have moved into the maps.
pub(super) fn maps(
    scene: &Scene,
    (sensors, wanted): (&[Sensor], RadianceMaps),
    histories: Histories,
    part: Part,
    margin: f64,
    progress: &dyn Progress,
) -> Result<(Pass, OrderMaps)> {
    let ranges = wanted.ranges(sensors);
    let kept = Kept { ranges: &ranges, whole_beams: wanted.whole_beams, copied: Default::default() };
    let emitter = Emitter::by_power(scene);
    let scored = scored(sensors);
    let run = Run { part, sensors, scored: &scored, ..Run::new(scene, &emitter, histories) };
    let mut pass = run.pass(&kept, progress)?;
    let stored = Stored {
        photons: std::mem::take(&mut pass.media),
        beams: std::mem::take(&mut pass.beams),
        planes: std::mem::take(&mut pass.planes),
        emitted: histories.count,
    };
    let run = (histories.seed, histories.replicate);
    let maps = maps_of(scene, (sensors, wanted), stored, margin, run)?;
    Ok((pass, maps))
}

/// What a pass stored.
struct Stored {
    photons: Vec<Vec<Photon>>,
    beams: Vec<Vec<Beam>>,
    planes: Vec<Vec<Plane>>,
    emitted: u64,
}

/// The maps of photons in media, one for each range of orders that a sensor needs, continued `margin` beyond the periodic cell, as
/// those of a run of a seed and replicate.
fn maps_of(
    scene: &Scene,
    (sensors, wanted): (&[Sensor], RadianceMaps),
    stored: Stored,
    margin: f64,
    (seed, replicate): (u64, u64),
) -> Result<OrderMaps> {
    let Stored { photons, beams, planes, emitted } = stored;
    let ranges = wanted.ranges(sensors);
    let mut maps = OrderMaps { points: Vec::new(), beams: Vec::new(), planes: Vec::new() };
    let cell = scene.periodic_cell().map(|periodic_cell| periodic_cell.side);
    for (range, parts) in by_ranges(ranges.points, photons, |photon: &Photon| photon.order) {
        let map = PhotonMap::periodic(parts, emitted, cell.map(|side| (side, margin)), &NoProgress)?;
        maps.points.push((range, map.of_run(seed, replicate)));
    }
    for (range, parts) in by_ranges(ranges.beams, beams, |beam: &Beam| beam.order) {
        maps.beams.push((range, BeamMap::new(parts, emitted, cell)?));
    }
    for (range, parts) in by_ranges(ranges.planes, planes, |plane: &Plane| plane.leg.order) {
        maps.planes.push((range, PlaneMap::new(parts, emitted, cell)?));
    }
    Ok(maps)
}

/// What is stored by ranges of orders; the last range takes what there is, and copies nothing.
fn by_ranges<T: Copy>(
    ranges: Vec<Orders>,
    mut blocks: Vec<Vec<T>>,
    order: impl Fn(&T) -> u16 + Copy,
) -> impl Iterator<Item = (Orders, Vec<Vec<T>>)> {
    let last = ranges.len().saturating_sub(1);
    ranges.into_iter().enumerate().map(move |(number, range)| {
        let holds = |stored: &T| range.contains(u32::from(order(stored)));
        let parts = match number == last {
            true => {
                let mut last = std::mem::take(&mut blocks);
                last.iter_mut().for_each(|block| block.retain(holds));
                last
            }
            false => blocks.iter().map(|block| block.iter().copied().filter(holds).collect()).collect(),
        };
        (range, parts)
    })
}

/// The orders of the photons that answer a sensor; none where tallies do. Photons of order n are the fluence of
/// order n, and scatter into the radiance of order n + 1.
pub(super) fn map_orders(sensor: &Sensor) -> Option<Orders> {
    let Orders { min, max } = sensor.orders;
    match sensor.quantity {
        Quantity::Fluence(_) | Quantity::Binned(Binned::Fluence { .. }) => Some(sensor.orders),
        Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }) if max == Some(0) => {
            Some(Orders { min: 1, max: Some(0) })
        }
        Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }) => {
            Some(Orders { min: min.saturating_sub(1), max: max.map(|m| m - 1) })
        }
        Quantity::Outflow { .. } | Quantity::Absorbed(_) | Quantity::Binned(_) => None,
    }
}

/// Whether photons answer a sensor with one number as they pass, without a map.
pub(super) fn is_tallied(sensor: &Sensor) -> bool {
    matches!(sensor.quantity, Quantity::Outflow { .. } | Quantity::Absorbed(_))
}

/// The sensors with bins that photons score as they pass, beside maps.
fn scored(sensors: &[Sensor]) -> Vec<Sensor> {
    let is_scored = |s: &&Sensor| s.binned().is_some() && map_orders(s).is_none();
    sensors.iter().filter(is_scored).cloned().collect()
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
            let p = periodic::wrap(p, side);
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

/// That a fluence is asked for where a map has none.
fn outside(sensor: &Sensor, p: DVec3) -> Error {
    Error::Scene(format!(
        "sensor {}: a photon map knows the fluence inside a medium only, and ({}, {}, {}) is outside: use paths",
        sensor.name, p.x, p.y, p.z
    ))
}

/// Whether a volume map can answer a sensor.
pub(super) fn check(scene: &Scene, sensor: &Sensor) -> Result<()> {
    match sensor.quantity {
        Quantity::Fluence(p) if scene.medium_at(p).is_none_or(|m| m.sigma_t(p).min() == 0.0) => {
            Err(outside(sensor, p))
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

/// What a map answers for every bin of a sensor; seed, replicate and number of the sensor say where in the bins it is asked.
///
/// # Errors
/// `Error::Scene` for a bin that reaches outside of all media, and for a ball that is too small beside the map
pub(super) fn read_bins(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    sensor: &Sensor,
    estimator: &Estimator,
    (seed, replicate, number): (u64, u64, usize),
    result: &mut PhotonReadings,
) -> Result<Vec<Spectrum>> {
    map.check_radius(estimator.least_named_radius())?;
    let one = |bin: usize| {
        let number = (bin as u64) << 32 | number as u64;
        let mut stream = Stream::new(seed, Purpose::Resampling, replicate, number);
        let mut booked = PhotonReadings::new();
        let value = read(around, map, (sensor, bin), estimator, &mut stream, &mut booked);
        value.map(|value| (value, booked))
    };
    let bins = sensor.binned().map_or(1, Binned::bins);
    let mut values = Vec::with_capacity(bins);
    for read in in_parallel(bins, one) {
        let (value, booked) = read?;
        // Where the k nearest photons lie close together, the ball is known only now.
        map.check_radius(booked.least_radius)?;
        values.push(value);
        result.gathers += booked.gathers;
        result.underfull += booked.underfull;
        result.beyond += booked.beyond;
        result.least_radius = result.least_radius.min(booked.least_radius);
    }
    Ok(values)
}

/// Points of a bin that a map is asked at: other ones each time, so that few do.
const POINTS: usize = 4;

/// One estimate from a map: of a bin, the mean over some of its points.
fn read(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    (sensor, bin): (&Sensor, usize),
    estimator: &Estimator,
    stream: &mut Stream,
    result: &mut PhotonReadings,
) -> Result<Spectrum> {
    let scene = around.scene;
    match &sensor.quantity {
        Quantity::Fluence(p) => Ok(fluence_at(around, map, *p, estimator, result)),
        Quantity::Radiance(ray) => Ok(radiance(around, map, ray, sensor.orders, estimator, stream, result)),
        Quantity::Outflow { .. } | Quantity::Absorbed(_) => Ok(Spectrum::ZERO),
        Quantity::Binned(binned) => {
            let mut sum = Spectrum::ZERO;
            for _ in 0..POINTS {
                let p = binned.point(bin, scene.periodic_cell(), stream.triple());
                sum += match binned {
                    Binned::Fluence { .. }
                        if scene.medium_at(p).is_none_or(|m| m.sigma_t(p).min() == 0.0) =>
                    {
                        return Err(outside(sensor, p));
                    }
                    Binned::Fluence { .. } => fluence_at(around, map, p, estimator, result),
                    Binned::Radiance { dir, .. } => {
                        let ray = Ray::new(p, *dir);
                        radiance(around, map, &ray, sensor.orders, estimator, stream, result)
                    }
                    Binned::Flux { .. } | Binned::Absorption { .. } => Spectrum::ZERO,
                };
            }
            Ok(sum / POINTS as f64)
        }
    }
}

/// Fluence at a point in a medium.
fn fluence_at(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    p: DVec3,
    estimator: &Estimator,
    result: &mut PhotonReadings,
) -> Spectrum {
    let scene = around.scene;
    let number = scene.medium_number_at(p);
    let boundary = number.map_or(Boundary::UNKNOWN, |number| around.boundary(number));
    let estimate = match (map, estimator.of_beams(), number) {
        (AskedMap::Points(map, _), ..) => {
            let sigma_t = number.map_or(Spectrum::ONE, |number| scene.medium(number).sigma_t(p));
            estimator.fluence(map, p, sigma_t, &boundary)
        }
        (AskedMap::Beams(map), Some(of_beams), Some(number)) => {
            let of = (number, scene.medium(number));
            match estimator.beam_blur {
                BeamBlur::OneD | BeamBlur::TwoD => of_beams.fluence(map, p, of, &boundary),
                BeamBlur::ThreeD => of_beams.fluence_in_3d(map, p, of, &boundary),
            }
        }
        // No sensor of fluence is given planes, or a place outside of all media.
        _ => return Spectrum::grey(f64::NAN),
    };
    result.book(scene, p, &estimate, estimator.treatment);
    estimate.value
}

/// Radiance along a ray: uncollided light in closed form, and what media scatter, marched in random steps, so that the integral
/// along the ray has no step bias.
fn radiance(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    ray: &Ray,
    orders: Orders,
    estimator: &Estimator,
    stream: &mut Stream,
    result: &mut PhotonReadings,
) -> Spectrum {
    let (scene, mut sum) = (around.scene, Spectrum::ZERO);
    let end = scene.hit(ray, None).map_or(f64::INFINITY, |h| h.hit.t);
    let (interior, size) = (scene.interior_at(ray.origin), scene_size(scene));
    if orders.contains(0) {
        let only_direct = Orders::only(0);
        crate::integrators::radiance(scene, (*ray, interior), only_direct, None, stream, |_, value| {
            sum += value
        });
    }
    if estimator.ray_ends == RayEnds::Own {
        sum += radiance_of_own_ends(scene, map, ray, estimator);
        result.gathers += 1;
        return sum;
    }
    for segment in scene.segments(ray, end, interior).iter() {
        let medium = scene.medium(segment.medium);
        let boundary = around.boundary(segment.medium);
        if estimator.reads_rays() {
            let before = transmittance(scene, ray, segment.interval.start, interior, stream);
            let span = seen(medium, segment.interval);
            let passage = Passage::new(medium, ray, span, stream);
            let (way, passed) = ((ray, span), |t: f64| passage.to(t));
            let across = |map: &BeamMap| {
                let (of_beams, of) = (estimator.of_beams()?, (segment.medium, medium));
                Some(match estimator.beam_blur {
                    BeamBlur::OneD => of_beams.radiance(map, way, of, &boundary, passed).value,
                    BeamBlur::TwoD => of_beams.radiance_in_2d(map, way, of, &boundary, passed).value,
                    BeamBlur::ThreeD => Spectrum::grey(f64::NAN),
                })
            };
            let value = match map {
                AskedMap::Points(map, radii) => estimator.of_rays().map(|of_rays| match radii {
                    Some(radii) => {
                        of_rays.radiance_by_radii((map, radii), way, medium, &boundary, passed).value
                    }
                    None => of_rays.radiance(map, way, medium, &boundary, passed).value,
                }),
                AskedMap::Beams(map) => across(map),
                AskedMap::Planes(planes, direct) => {
                    let of_planes =
                        |map| PlaneEstimator.radiance(map, way, (scene, segment.medium), passed).value;
                    let once = direct.and_then(across);
                    Some(planes.map_or(Spectrum::ZERO, of_planes) + once.unwrap_or(Spectrum::ZERO))
                }
            };
            let Some(value) = value else { continue };
            result.gathers += 1;
            sum += before * value;
            continue;
        }
        let AskedMap::Points(map, _) = map else { continue };
        let mut source = |p: DVec3| {
            if medium.sigma_t(p).is_black() {
                return Spectrum::ZERO;
            }
            let (wo, phase) = (-ray.dir, medium.phase());
            let estimate = estimator.in_scattered(map, p, wo, phase, Spectrum::ONE, &boundary);
            result.book(scene, p, &estimate, estimator.treatment);
            medium.albedo(p) * estimate.value
        };
        for (span, step) in stretches(medium, segment.interval) {
            let before = transmittance(scene, ray, span.start, interior, stream);
            if !before.is_black() {
                let march = March { is_jittered: true, ..March::equal(step, StepRule::Integrated) };
                sum += before * along(medium, (ray, span), &march, size, stream, &mut source);
            }
        }
    }
    sum
}

/// What the one medium of a scene scatters along a ray, each photon or beam ending for itself.
fn radiance_of_own_ends(scene: &Scene, map: AskedMap<'_>, ray: &Ray, estimator: &Estimator) -> Spectrum {
    let (Some(region), Medium::Homogeneous(even)) = (scene.regions().first(), scene.medium(0)) else {
        return Spectrum::grey(f64::NAN);
    };
    let medium = scene.medium(0);
    let ends = |radius: Positive| OwnEnds::new(even, &region.shape, ray, radius.get());
    let value = match (map, estimator.of_rays(), estimator.of_beams()) {
        (AskedMap::Points(map, radii), Some(of_rays), _) => ends(of_rays.radius)
            .map(|ends| of_rays.radiance_of_own_ends((map, radii), (ray, &ends), medium).value),
        (AskedMap::Beams(map), _, Some(of_beams)) => ends(of_beams.radius).map(|ends| {
            of_beams.radiance_of_own_ends(map, (ray, &ends), (0, medium), estimator.beam_blur).value
        }),
        _ => Some(Spectrum::grey(f64::NAN)),
    };
    value.unwrap_or(Spectrum::ZERO)
}

/// The part of a span that is seen: as far as the thinnest channel reaches, where that is known.
fn seen(medium: &Medium, span: Interval) -> Interval {
    let colliding = medium.highest_sigma_t().0.to_array().into_iter().filter(|s| *s > 0.0);
    let reach = colliding.map(|s| DEPTH / s).fold(0.0, f64::max);
    let end = if medium.is_homogeneous() { span.end.min(span.start + reach) } else { span.end };
    Interval { end, ..span }
}

/// How a span of a medium is marched through: parts of it with their steps \[L\], one as far as each channel reaches, so that
/// the densest is not one step among those of the thinnest; none where nothing collides.
fn stretches(medium: &Medium, span: Interval) -> Vec<(Interval, Positive)> {
    let colliding = medium.highest_sigma_t().0.to_array().into_iter().filter(|s| *s > 0.0);
    // Where the density varies it may be far below its bound.
    let is_short = !medium.is_homogeneous() && span.length() < f64::INFINITY;
    let reach = |s: f64| if is_short { span.length() } else { span.length().min(DEPTH / s) };
    let mut reaches: Vec<f64> = colliding.map(reach).collect();
    reaches.sort_by(f64::total_cmp);
    reaches.dedup();
    let last = reaches.len().saturating_sub(1);
    let mut start = span.start;
    let part = |(number, reach): (usize, f64)| {
        let end = if number == last { span.end } else { span.start + reach };
        let part = Interval { start, end };
        start = end;
        Some((part, Positive::new("the step", reach / STEPS).ok()?))
    };
    reaches.into_iter().enumerate().filter_map(part).collect()
}
