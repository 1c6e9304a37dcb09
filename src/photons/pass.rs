//! A pass of histories: emission, walk, photons stored where they collide or meet surfaces, powers tallied where they leave.

use super::beams::{Beam, BeamMap, FlightBeams, MOST_CELLS};
use super::importance::{Branching, Importance};
use super::planes::{Plane, PlaneMap, check_planes, second_leg};
use super::tallies::{Scores, Tallies};
use super::{Emitter, Photon, PhotonMap, Photons, check_end};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::geometry::{Face, Shape};
use crate::math::{Ray, wrap};
use crate::rng::{Purpose, Stream, Work};
use crate::scene::{Orders, Quantity, Scene, Sensor, Target};
use crate::stats::Moments;
use crate::surface::Surface;
use crate::transport::{NoProgress, Progress, Roulette, Step, Visitor, Walker, run_blocks, walk};
use glam::{DVec2, DVec3};
use std::ops::{AddAssign, Range};
use std::time::{Duration, Instant};

/// Which histories to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Histories {
    /// How many.
    pub count: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
    /// Largest order of a collision that anybody asks for, if there is one: histories stop behind it.
    pub max_order: Option<u32>,
}

/// A part of a run's histories, whose photons are in memory at one time.
///
/// Photons stand for those of the other parts too: the mean of estimates with the same radius over the parts is that of one map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Which part, from 0.
    pub number: u64,
    /// Of how many.
    pub of: u64,
}

impl Part {
    /// All of it.
    pub const WHOLE: Part = Part { number: 0, of: 1 };

    /// Its part of so many histories.
    pub fn histories(self, count: u64) -> Range<u64> {
        let cut = |n: u64| (u128::from(count) * u128::from(n) / u128::from(self.of)) as u64;
        cut(self.number)..cut(self.number + 1)
    }
}

/// Which photons a pass stores. A function of a photon stores collisions in media.
pub trait Storage: Sync {
    /// Whether a photon that collides in a medium is stored.
    fn in_medium(&self, history: u64, photon: &Photon) -> bool;

    /// Whether a photon that meets a diffuse surface is stored.
    fn on_surface(&self, _history: u64, _photon: &Photon) -> bool {
        false
    }

    /// Whether any flights are stored as beams.
    fn has_beams(&self) -> bool {
        false
    }

    /// Whether flights are stored as far as they could go, with what passes, in place of as far as they flew.
    fn has_whole_beams(&self) -> bool {
        false
    }

    /// Whether the flight of a photon that sets out is stored as beams in the media that it crosses.
    fn on_flight(&self, _history: u64, _walker: &Walker) -> bool {
        false
    }

    /// Whether planes of any flights are stored.
    fn has_planes(&self) -> bool {
        false
    }

    /// Whether a plane of the flight of a photon that sets out is stored in each medium that it crosses.
    fn on_plane(&self, _history: u64, _walker: &Walker) -> bool {
        false
    }
}

impl<F: Fn(&Photon) -> bool + Sync> Storage for F {
    fn in_medium(&self, _history: u64, photon: &Photon) -> bool {
        self(photon)
    }
}

/// Every photon, in media and on surfaces.
#[derive(Debug, Clone, Copy)]
pub struct Everything;

impl Storage for Everything {
    fn in_medium(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }

    fn on_surface(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }
}

/// Where the emitted power went \[W\], summed over channels and histories; each history counts as though it were the
/// only one, so that divided by the histories these are the powers of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ledger {
    /// Sent out.
    pub emitted: f64,
    /// Ended in a medium or on a body.
    pub absorbed: f64,
    /// Left the scene.
    pub escaped: f64,
    /// Followed no further, since nobody asked for higher orders.
    pub truncated: f64,
}

impl AddAssign for Ledger {
    fn add_assign(&mut self, other: Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.truncated += other.truncated;
    }
}

/// How histories ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ends {
    /// In a medium or on a body.
    pub absorbed: u64,
    /// Out of the scene.
    pub escaped: u64,
    /// Where nobody asked for more.
    pub truncated: u64,
    /// Before they began: a medium was asked for a photon where it emits less than elsewhere, or is not.
    pub refused: u64,
}

/// What one pass of histories did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PassReport {
    /// Histories run.
    pub emitted: u64,
    /// How they ended.
    pub ends: Ends,
    /// Where the power went.
    pub ledger: Ledger,
    /// Collisions in media, stored or not.
    pub collisions: u64,
    /// Arrivals at diffuse surfaces, stored or not.
    pub hits: u64,
    /// Work that the scene may not require.
    pub work: Work,
    /// Time.
    pub time: Duration,
}

impl AddAssign for PassReport {
    fn add_assign(&mut self, other: Self) {
        self.emitted += other.emitted;
        self.ends.absorbed += other.ends.absorbed;
        self.ends.escaped += other.ends.escaped;
        self.ends.truncated += other.ends.truncated;
        self.ends.refused += other.ends.refused;
        self.ledger += other.ledger;
        self.collisions += other.collisions;
        self.hits += other.hits;
        self.work += other.work;
        self.time += other.time;
    }
}

/// What a pass brought: photons in the order of their histories, in parts.
#[derive(Debug, Clone, Default)]
pub struct Pass {
    /// Photons that met surfaces.
    pub surfaces: Vec<Photons>,
    /// Photons that collided in media.
    pub media: Vec<Photons>,
    /// Flights through media, where they are stored.
    pub beams: Vec<Vec<Beam>>,
    /// Beams that are to be stored; those of a pilot are counted only.
    pub met_beams: u64,
    /// Planes of flights, where they are stored.
    pub planes: Vec<Vec<Plane>>,
    /// Planes that are to be stored; those of a pilot are counted only.
    pub met_planes: u64,
    /// Photons that met surfaces and media and are to be stored; those of a pilot are counted only.
    pub met: [u64; 2],
    /// One a sensor and channel, over histories; 0 for sensors that photons in a map answer.
    pub tallies: Vec<[Moments; 3]>,
    /// Those of the sensors that have bins and are scored.
    pub scores: Scores,
    /// What it did.
    pub report: PassReport,
    /// Contributions that were not finite; each fails the run.
    non_finite: u64,
    /// Flights that are too long for beams; each fails the run.
    overlong: u64,
    /// Sides of the periodic cell, if the scene has one \[L\].
    period: Option<DVec2>,
}

impl Pass {
    /// Histories run: what estimates divide by.
    pub fn emitted(&self) -> u64 {
        self.report.emitted
    }

    /// Photons that collided in media.
    pub fn photons(&self) -> impl Iterator<Item = Photon> {
        self.media.iter().flat_map(Photons::iter)
    }

    /// The map of the photons that collided in media, for balls that reach so far beyond the periodic cell \[L\], if there is one.
    ///
    /// # Errors
    /// those of [`PhotonMap::periodic`]
    pub fn into_map(self, reach: f64) -> Result<PhotonMap> {
        PhotonMap::periodic(
            self.media,
            self.report.emitted,
            self.period.map(|side| (side, reach)),
            &NoProgress,
        )
    }

    /// The map of the beams.
    ///
    /// # Errors
    /// those of [`BeamMap::new`]
    pub fn into_beams(self) -> Result<BeamMap> {
        BeamMap::new(self.beams, self.report.emitted, self.period)
    }

    /// The map of the planes.
    ///
    /// # Errors
    /// those of [`PlaneMap::new`]
    pub fn into_planes(self) -> Result<PlaneMap> {
        PlaneMap::new(self.planes, self.report.emitted, self.period)
    }

    fn merged(mut self, other: Pass) -> Pass {
        Photons::join(&mut self.surfaces, other.surfaces);
        Photons::join(&mut self.media, other.media);
        self.beams.extend(other.beams);
        self.met_beams += other.met_beams;
        self.planes.extend(other.planes);
        self.met_planes += other.met_planes;
        self.overlong += other.overlong;
        self.met = [0, 1].map(|i| self.met[i] + other.met[i]);
        for (mine, others) in self.tallies.iter_mut().flatten().zip(other.tallies.iter().flatten()) {
            mine.merge(others);
        }
        self.scores.merge(other.scores);
        self.report += other.report;
        self.non_finite += other.non_finite;
        self
    }
}

/// Runs histories from all lights, keeping the collisions that `keep` accepts and tallying the sensors that need no map.
///
/// # Errors
/// those of [`Run::pass`]
pub fn shoot(
    scene: &Scene,
    histories: Histories,
    sensors: &[Sensor],
    keep: impl Fn(&Photon) -> bool + Sync,
    progress: &dyn Progress,
) -> Result<Pass> {
    Run { sensors, ..Run::new(scene, &Emitter::by_power(scene), histories) }.pass(&keep, progress)
}

/// A pass to be run.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Where.
    pub scene: &'a Scene,
    /// How photons leave the lights.
    pub emitter: &'a Emitter,
    /// The importance that they follow, if any.
    pub importance: Option<&'a Importance>,
    /// What the random numbers are for.
    pub purpose: Purpose,
    /// All histories.
    pub histories: Histories,
    /// Which of them are run; powers are multiplied by the number of parts.
    pub part: Part,
    /// What is tallied.
    pub sensors: &'a [Sensor],
    /// Sensors with bins that are scored.
    pub scored: &'a [Sensor],
    /// Whether photons are counted and not kept.
    pub is_pilot: bool,
}

impl<'a> Run<'a> {
    /// All of the histories, and nothing tallied.
    pub fn new(scene: &'a Scene, emitter: &'a Emitter, histories: Histories) -> Self {
        Run {
            scene,
            emitter,
            importance: None,
            purpose: Purpose::Photons,
            histories,
            part: Part::WHOLE,
            sensors: &[],
            scored: &[],
            is_pilot: false,
        }
    }

    /// Runs its part of the histories: the same bits on any number of threads, and those of all parts are those of the whole.
    ///
    /// # Errors
    /// `Error::Cancelled`, or `Error::NonFinite` if a contribution was not finite; those of [`check_end`]; where planes are stored,
    /// those of [`check_planes`], where beams or planes are, `Error::Scene` for a flight that has no end, or crosses too many periodic cells.
    pub fn pass(&self, store: &dyn Storage, progress: &dyn Progress) -> Result<Pass> {
        self.scene.check_emission()?;
        check_end(self.scene)?;
        if store.has_planes() {
            check_planes(self.scene)?;
        }
        let start = Instant::now();
        let part = self.part.histories(self.histories.count);
        let power = if self.sensors.is_empty() { Spectrum::ONE } else { self.scene.power() };
        let empty = || Pass {
            tallies: vec![Default::default(); self.sensors.len()],
            period: self.scene.periodic_cell().map(|periodic_cell| periodic_cell.side),
            ..Pass::default()
        };
        let block = |range: Range<u64>| {
            let mut block = Block {
                run: self,
                store,
                power,
                history: 0,
                scores: vec![Spectrum::ZERO; self.sensors.len()],
                surface: Photons::default(),
                medium: Photons::default(),
                beams: Vec::new(),
                planes: Vec::new(),
                has_beams: store.has_beams(),
                has_planes: store.has_planes(),
                ahead: f64::INFINITY,
                bins: Tallies::new(self.scene, self.scored),
                scoring: Stream::new(0, Purpose::Scores, 0, 0),
                tracking: Stream::new(0, Purpose::Beams, 0, 0),
                turning: Stream::new(0, Purpose::Planes, 0, 0),
                pass: empty(),
            };
            for history in range {
                block.follow(part.start + history);
            }
            let Block { mut surface, mut medium, mut beams, mut planes, bins, mut pass, .. } = block;
            pass.scores = bins.into_scores();
            surface.shrink_to_fit();
            medium.shrink_to_fit();
            beams.shrink_to_fit();
            planes.shrink_to_fit();
            pass.beams.push(beams);
            pass.planes.push(planes);
            pass.surfaces.push(surface);
            pass.media.push(medium);
            pass
        };
        let mut pass =
            run_blocks(part.end - part.start, progress, block, Pass::merged)?.unwrap_or_else(empty);
        if self.scene.plan().is_grey {
            pass.tallies.iter_mut().for_each(|tally| *tally = [tally[0]; 3]);
        }
        pass.report.time = start.elapsed();
        if pass.overlong > 0 {
            let larger = if pass.period.is_some() { ", a larger cell" } else { "" };
            return Err(Error::Scene(format!(
                "photons that fly on without end, or across more than {MOST_CELLS} periodic cells, cannot be stored as beams or planes, and {} \
                 of those sent out do; allowed: points along rays (a ray radius){larger}",
                pass.overlong
            )));
        }
        match pass.non_finite {
            0 => Ok(pass),
            count => Err(Error::NonFinite { count, place: "photon histories" }),
        }
    }
}

/// Follows the histories of one block.
struct Block<'a> {
    run: &'a Run<'a>,
    store: &'a dyn Storage,
    power: Spectrum,
    history: u64,
    /// What the present history brought each sensor \[W\].
    scores: Vec<Spectrum>,
    surface: Photons,
    medium: Photons,
    beams: Vec<Beam>,
    planes: Vec<Plane>,
    has_beams: bool,
    has_planes: bool,
    /// How far the next surface is ahead of the present flight \[L\].
    ahead: f64,
    bins: Tallies<'a>,
    /// Random numbers of scores: what is scored does not change the walk.
    scoring: Stream,
    /// Random numbers of what beams carry, which do not change the walk either.
    tracking: Stream,
    /// Those of second legs of planes, likewise.
    turning: Stream,
    pass: Pass,
}

impl Block<'_> {
    fn follow(&mut self, history: u64) {
        let Run { scene, emitter, importance, purpose, histories, .. } = *self.run;
        let mut stream = Stream::new(histories.seed, purpose, histories.replicate, history);
        self.history = history;
        self.scores.fill(Spectrum::ZERO);
        if !self.run.scored.is_empty() {
            self.scoring = Stream::new(histories.seed, Purpose::Scores, histories.replicate, history);
        }
        if self.has_beams {
            self.tracking = Stream::new(histories.seed, Purpose::Beams, histories.replicate, history);
        }
        if self.has_planes {
            self.turning = Stream::new(histories.seed, Purpose::Planes, histories.replicate, history);
        }
        self.pass.report.emitted += 1;
        match emitter.emit(scene, &mut stream) {
            Some(first) => {
                self.pass.report.ledger.emitted += first.weight.sum();
                // Photons of order n arrive by a flight of order n: flights stop one later.
                let limit = histories.max_order.map(|n| n.saturating_add(1));
                match importance {
                    None => walk(scene, first, Roulette::Analog, limit, &mut stream, self),
                    Some(importance) => importance.walk(scene, first, limit, &mut stream, self),
                }
            }
            None => self.pass.report.ends.refused += 1,
        }
        self.pass.report.work += stream.work;
        self.pass.non_finite += self.bins.end_history();
        let channels = if scene.plan().is_grey { 1 } else { 3 };
        for (sensor, score) in self.scores.iter().enumerate() {
            if !is_tallied(&self.run.sensors[sensor]) {
                continue;
            }
            for channel in 0..channels {
                let power = self.power[channel];
                let fraction = if power == 0.0 { 0.0 } else { score[channel] / power };
                self.pass.non_finite += u64::from(!fraction.is_finite());
                self.pass.tallies[sensor][channel].push(fraction);
            }
        }
    }

    /// A photon at a collision, or with the outward normal of the surface that it met.
    fn photon(&mut self, walker: &Walker, position: DVec3, outward: DVec3) -> Photon {
        self.pass.non_finite += u64::from(!(walker.weight.is_finite() && position.is_finite()));
        let side = if walker.ray.dir.dot(outward) < 0.0 { outward } else { -outward };
        Photon {
            position: self.pass.period.map_or(position, |side| wrap(position, side)),
            dir: walker.ray.dir.as_vec3(),
            normal: side.as_vec3(),
            power: (walker.weight * self.run.part.of as f64).0.as_vec3(),
            order: u16::try_from(walker.order).unwrap_or(u16::MAX),
            flags: walker.flags,
        }
    }

    /// Stores a flight that is over, `arrives` its power there.
    fn store_flight(&mut self, walker: &Walker, end: f64, arrives: Spectrum) {
        let Run { scene, part, is_pilot, .. } = *self.run;
        let is_forced =
            scene.plan().forces_first_collision && walker.order == 0 && self.ahead == f64::INFINITY;
        // A forced flight is told of twice, as what passes and as what collides. One beam to the end is both.
        let is_told = is_forced && end < f64::INFINITY;
        if is_told {
            return;
        }
        let is_kept = [
            self.has_beams && self.store.on_flight(self.history, walker),
            self.has_planes && self.store.on_plane(self.history, walker),
        ];
        if is_kept == [false; 2] {
            return;
        }
        let weight = if planted(Fault::BeamsArrive) { arrives } else { walker.weight };
        let walker = Walker { weight, ..*walker };
        let period = self.pass.period;
        let (ahead, parts) = (self.ahead, part.of as f64);
        let flight = FlightBeams { scene, walker: &walker, end, ahead, is_forced, parts, period };
        let mut is_short = true;
        if is_kept[0] {
            let (beams, met) = (&mut self.beams, &mut self.pass.met_beams);
            let (end, is_forced) = match self.store.has_whole_beams() {
                true => (self.ahead, true),
                false => (end, is_forced),
            };
            is_short &= FlightBeams { end, is_forced, ..flight }.each(&mut self.tracking, |beam| {
                *met += 1;
                if !is_pilot {
                    beams.push(beam);
                }
            });
        }
        if is_kept[1] && !(planted(Fault::PlanesCollided) && end == f64::INFINITY) {
            let (planes, met, turning) = (&mut self.planes, &mut self.pass.met_planes, &mut self.turning);
            // Planes reach beyond cells anyway.
            is_short &= FlightBeams { period: None, ..flight }.each(&mut self.tracking, |leg| {
                *met += 1;
                if !is_pilot {
                    let start = period.map_or(leg.start, |side| wrap(leg.start, side));
                    planes.push(second_leg(scene, Beam { start, ..leg }, turning));
                }
            });
        }
        self.pass.overlong += u64::from(!is_short);
    }

    fn score(&mut self, order: u32, weight: Spectrum, is_met: impl Fn(&Quantity) -> bool) {
        for (sensor, score) in self.run.sensors.iter().zip(&mut self.scores) {
            if sensor.orders.contains(order) && is_met(&sensor.quantity) {
                *score += weight;
            }
        }
    }
}

impl Branching for Block<'_> {}

impl Visitor for Block<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        if !self.run.scored.is_empty() {
            self.bins.visit(walker, &step, &mut self.scoring);
        }
        if self.has_beams || self.has_planes {
            match step {
                Step::Ahead(hit) => self.ahead = hit.map_or(f64::INFINITY, |found| found.hit.t),
                Step::Uncollided(end, arrives) => self.store_flight(walker, end, arrives),
                _ => {}
            }
        }
        let PassReport { ends, ledger, .. } = &mut self.pass.report;
        match step {
            Step::Uncollided(t, weight) => self.score(walker.order, weight, |quantity| match quantity {
                Quantity::Outflow { shape, face } => leaves(shape, *face, &walker.ray, t),
                _ => false,
            }),
            Step::Collision(arrival, _) => {
                self.pass.report.collisions += 1;
                let photon = self.photon(arrival.walker, arrival.position, DVec3::ZERO);
                if self.store.in_medium(self.history, &photon) {
                    self.pass.met[1] += 1;
                    if !self.run.is_pilot {
                        self.medium.push(photon);
                    }
                }
            }
            Step::Surface(arrival, found) => {
                let Target::Object(index) = found.target else { return };
                if !is_diffuse(&self.run.scene.objects()[index].surface) {
                    return;
                }
                self.pass.report.hits += 1;
                let photon = self.photon(arrival.walker, arrival.position, found.hit.normal);
                if self.store.on_surface(self.history, &photon) {
                    self.pass.met[0] += 1;
                    if !self.run.is_pilot {
                        self.surface.push(photon);
                    }
                }
            }
            Step::Absorbed(weight, number) => {
                ends.absorbed += 1;
                ledger.absorbed += weight.sum();
                let is_of = |quantity: &Quantity| match quantity {
                    Quantity::Absorbed(of) => number == Some(*of),
                    _ => false,
                };
                self.score(walker.order, weight, is_of);
            }
            Step::Escaped(weight) => {
                ends.escaped += 1;
                ledger.escaped += weight.sum();
            }
            Step::Truncated(weight) => {
                ends.truncated += 1;
                ledger.truncated += weight.sum();
            }
            Step::Ahead(_) => {}
        }
    }
}

/// Whether photons answer a sensor as they pass, without a map.
fn is_tallied(sensor: &Sensor) -> bool {
    matches!(sensor.quantity, Quantity::Outflow { .. } | Quantity::Absorbed(_))
}

/// Whether going from the ray's origin to distance `t` leaves the shape, through `face` if it is a slab.
fn leaves(shape: &Shape, face: Face, ray: &Ray, t: f64) -> bool {
    let is_through = !matches!(shape, Shape::Slab(_)) || ray.dir.dot(face.normal()) > 0.0;
    is_through && shape.interval(ray).is_some_and(|inside| inside.end <= t && inside.end.is_finite())
}

/// Whether photons are stored on a surface: some light leaves it in other than specular directions.
pub(super) fn is_diffuse(surface: &Surface) -> bool {
    matches!(surface, Surface::Lambertian(_))
}

/// Whether a photon is in a range of orders.
pub fn is_in(orders: Orders) -> impl Fn(&Photon) -> bool + Sync {
    move |photon| orders.contains(u32::from(photon.order))
}

/// Whether a photon belongs in the volume map of Jensen and Christensen (1998): it does not come straight from a light.
pub fn is_indirect(photon: &Photon) -> bool {
    !photon.flags.is_direct()
}
