//! Maps of one pass by ranges of orders, and which of them answers a sensor.

use crate::error::{Error, Result};
use crate::estimators::Estimator;
use crate::photons::beams::{Beam, BeamLength, BeamMap};
use crate::photons::planes::{Plane, PlaneMap};
use crate::photons::tree::Radii;
use crate::photons::{Emitter, Histories, Part, Pass, Photon, PhotonMap, Photons, Run, Storage};
use crate::scene::{Binned, Orders, Quantity, Scene, Sensor};
use crate::transport::{NoProgress, Progress, Walker};
use std::sync::atomic::{AtomicU64, Ordering};

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

    /// That one pass can store beams for all of these estimators.
    ///
    /// # Errors
    /// `Error::Scene` for beams of two lengths
    pub fn check_lengths(estimators: &[Estimator]) -> Result<()> {
        let mut lengths = estimators.iter().filter(|e| e.beam_radius.is_some()).map(|e| e.beam_length);
        let first = lengths.next();
        if lengths.any(|length| Some(length) != first) {
            return Err(Error::Scene(
                "some beams are sampled and some whole, and one pass stores either; allowed: one beam_length"
                    .into(),
            ));
        }
        Ok(())
    }

    /// The ranges of orders that need a map each.
    pub(super) fn ranges(self, sensors: &[Sensor]) -> Ranges {
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
pub(super) struct Ranges {
    pub points: Vec<Orders>,
    pub beams: Vec<Orders>,
    pub planes: Vec<Orders>,
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
pub(super) fn is_radiance(sensor: &Sensor) -> bool {
    matches!(sensor.quantity, Quantity::Radiance(_) | Quantity::Binned(Binned::Radiance { .. }))
}

/// What a pass keeps: what maps of any range hold.
pub(super) struct Kept<'a> {
    pub ranges: &'a Ranges,
    pub whole_beams: bool,
    /// Photons, flights and planes that were kept, once a range.
    pub copied: [AtomicU64; 3],
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

    fn on_plane(&self, _history: u64, walker: &Walker) -> bool {
        self.holds(2, walker.order)
    }

    fn on_flight(&self, _history: u64, walker: &Walker) -> bool {
        self.holds(1, walker.order)
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
    pub(super) fn check_radius(self, radius: f64) -> Result<()> {
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
pub(super) struct Stored {
    pub photons: Vec<Photons>,
    pub beams: Vec<Vec<Beam>>,
    pub planes: Vec<Vec<Plane>>,
    pub emitted: u64,
}

/// The maps of photons in media, one for each range of orders that a sensor needs, continued `margin` beyond the periodic cell, as
/// those of a run of a seed and replicate.
pub(super) fn maps_of(
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
    let holds = |range: Orders, order: u16| range.contains(u32::from(order));
    for (range, parts) in
        by_ranges(ranges.points, photons, |part, range| part.retain(|photon| holds(range, photon.order)))
    {
        let map = PhotonMap::periodic(parts, emitted, cell.map(|side| (side, margin)), &NoProgress)?;
        maps.points.push((range, map.of_run(seed, replicate)));
    }
    for (range, parts) in
        by_ranges(ranges.beams, beams, |part, range| retain(part, |beam| holds(range, beam.order)))
    {
        maps.beams.push((range, BeamMap::new(parts, emitted, cell)?));
    }
    for (range, parts) in
        by_ranges(ranges.planes, planes, |part, range| retain(part, |plane| holds(range, plane.leg.order)))
    {
        maps.planes.push((range, PlaneMap::new(parts, emitted, cell)?));
    }
    Ok(maps)
}

/// What is stored by ranges of orders; the last range takes what there is, and copies nothing.
fn by_ranges<P: Clone>(
    ranges: Vec<Orders>,
    mut parts: Vec<P>,
    retain: impl Fn(&mut P, Orders),
) -> impl Iterator<Item = (Orders, Vec<P>)> {
    let last = ranges.len().saturating_sub(1);
    ranges.into_iter().enumerate().map(move |(number, range)| {
        let of_range = |mut part: P| {
            retain(&mut part, range);
            part
        };
        let held = match number == last {
            true => std::mem::take(&mut parts).into_iter().map(of_range).collect(),
            false => parts.iter().cloned().map(of_range).collect(),
        };
        (range, held)
    })
}

/// Keeps what `keeps` accepts, and no room for more.
fn retain<T>(part: &mut Vec<T>, keeps: impl Fn(&T) -> bool) {
    part.retain(keeps);
    part.shrink_to_fit();
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
pub(super) fn scored(sensors: &[Sensor]) -> Vec<Sensor> {
    let is_scored = |s: &&Sensor| s.binned().is_some() && map_orders(s).is_none();
    sensors.iter().filter(is_scored).cloned().collect()
}
