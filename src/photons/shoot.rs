//! Shooting: histories from the lights, photons kept where they collide, powers tallied where they leave.

use super::{Emitter, Flags, Photon, check_end, fold};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Face, Shape};
use crate::math::Ray;
use crate::rng::{Purpose, Stream};
use crate::scene::{Orders, Quantity, Scene, Sensor};
use crate::stats::Moments;
use crate::transport::{Progress, Roulette, Step, Visitor, Walker, run_blocks, walk};
use std::ops::Range;

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
    pub abandoned: f64,
}

impl Ledger {
    /// Adds the powers of another.
    pub fn add(&mut self, other: &Ledger) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.abandoned += other.abandoned;
    }
}

/// What one pass of histories brought.
#[derive(Debug, Clone, Default)]
pub struct Pass {
    /// Photons kept, in the order of their histories.
    pub photons: Vec<Photon>,
    /// The same while the pass runs, a block each: joined once at its end.
    blocks: Vec<Vec<Photon>>,
    /// Histories run: what estimates divide by.
    pub emitted: u64,
    /// One a sensor and channel, over histories; 0 for sensors that photons in a map answer.
    pub tallies: Vec<[Moments; 3]>,
    /// Where the power went.
    pub ledger: Ledger,
    /// Collisions in media, kept or not.
    pub collisions: u64,
    /// Contributions that were not finite; each fails the run.
    pub non_finite: u64,
}

/// Runs histories, keeping the photons that `keep` accepts and tallying the sensors that need no map.
///
/// # Errors
/// `Error::Cancelled`, or `Error::NonFinite` if a contribution was not finite.
pub fn shoot(
    scene: &Scene,
    histories: Histories,
    sensors: &[Sensor],
    keep: impl Fn(&Photon) -> bool + Sync,
    progress: &dyn Progress,
) -> Result<Pass> {
    shoot_from(scene, &Emitter::by_power(scene), histories, sensors, keep, progress)
}

/// The same with photons that leave the lights otherwise.
///
/// # Errors
/// As [`shoot`].
pub fn shoot_from(
    scene: &Scene,
    emitter: &Emitter,
    histories: Histories,
    sensors: &[Sensor],
    keep: impl Fn(&Photon) -> bool + Sync,
    progress: &dyn Progress,
) -> Result<Pass> {
    let all = 0..histories.count;
    let (mut pass, blocks) = shoot_blocks(scene, emitter, histories, all, sensors, keep, progress)?;
    pass.photons = blocks.concat();
    Ok(pass)
}

/// The same with a part of the histories, and the photons block by block: those of consecutive parts are those of the whole.
///
/// # Errors
/// As [`shoot`].
pub(crate) fn shoot_blocks(
    scene: &Scene,
    emitter: &Emitter,
    histories: Histories,
    part: Range<u64>,
    sensors: &[Sensor],
    keep: impl Fn(&Photon) -> bool + Sync,
    progress: &dyn Progress,
) -> Result<(Pass, Vec<Vec<Photon>>)> {
    scene.check_emission()?;
    check_end(scene)?;
    let power = if sensors.is_empty() { Spectrum::ONE } else { scene.power() };
    let block = |range: Range<u64>| {
        let mut visitor = Tallier {
            scene,
            emitter,
            sensors,
            keep: &keep,
            power,
            scores: vec![Spectrum::ZERO; sensors.len()],
            pass: Pass { tallies: vec![Default::default(); sensors.len()], ..Pass::default() },
        };
        for history in range {
            let number = part.start + history;
            let mut stream = Stream::new(histories.seed, Purpose::Photons, histories.replicate, number);
            visitor.run(histories.max_order, &mut stream);
        }
        let mut pass = visitor.pass;
        pass.photons.shrink_to_fit();
        pass.blocks.push(std::mem::take(&mut pass.photons));
        pass
    };
    let pass = run_blocks(part.end - part.start, progress, block, Pass::merged)?;
    let pass =
        pass.unwrap_or_else(|| Pass { tallies: vec![Default::default(); sensors.len()], ..Pass::default() });
    let mut pass = pass;
    let blocks = std::mem::take(&mut pass.blocks);
    if scene.plan().is_grey {
        pass.tallies.iter_mut().for_each(|tally| *tally = [tally[0]; 3]);
    }
    if pass.non_finite > 0 {
        return Err(Error::NonFinite { count: pass.non_finite, place: "photon histories" });
    }
    Ok((pass, blocks))
}

impl Pass {
    fn merged(mut self, other: Pass) -> Pass {
        self.blocks.extend(other.blocks);
        self.emitted += other.emitted;
        for (mine, others) in self.tallies.iter_mut().zip(&other.tallies) {
            for (m, o) in mine.iter_mut().zip(others) {
                m.merge(o);
            }
        }
        self.ledger.add(&other.ledger);
        self.collisions += other.collisions;
        self.non_finite += other.non_finite;
        self
    }
}

/// Follows the histories of one block.
struct Tallier<'a, K: Fn(&Photon) -> bool> {
    scene: &'a Scene,
    emitter: &'a Emitter,
    sensors: &'a [Sensor],
    keep: &'a K,
    power: Spectrum,
    /// What the present history brought each sensor \[W\].
    scores: Vec<Spectrum>,
    pass: Pass,
}

impl<K: Fn(&Photon) -> bool> Tallier<'_, K> {
    fn run(&mut self, max_order: Option<u32>, stream: &mut Stream) {
        self.scores.fill(Spectrum::ZERO);
        self.pass.emitted += 1;
        if let Some(start) = self.emitter.emit(self.scene, stream) {
            self.pass.ledger.emitted += start.weight.sum();
            // Photons of order n arrive by a flight of order n: flights stop one later.
            walk(self.scene, start, Roulette::Analog, max_order.map(|n| n.saturating_add(1)), stream, self);
        }
        let channels = if self.scene.plan().is_grey { 1 } else { 3 };
        for (sensor, score) in self.scores.iter().enumerate() {
            if !is_tallied(&self.sensors[sensor]) {
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

    fn score(&mut self, sensor: usize, order: u32, weight: Spectrum) {
        if self.sensors[sensor].orders.contains(order) {
            self.scores[sensor] += weight;
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

impl<K: Fn(&Photon) -> bool> Visitor for Tallier<'_, K> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Passed(t, weight) => {
                for sensor in 0..self.sensors.len() {
                    if let Quantity::Outflow { shape, face } = &self.sensors[sensor].quantity
                        && leaves(shape, *face, &walker.ray, t)
                    {
                        self.score(sensor, walker.order, weight);
                    }
                }
            }
            Step::Collision(arrival, _) => {
                self.pass.collisions += 1;
                let weight = arrival.walker.weight;
                self.pass.non_finite += u64::from(!weight.is_finite() || !arrival.position.is_finite());
                let photon = Photon {
                    position: self
                        .scene
                        .stage()
                        .map_or(arrival.position, |s| fold::into_cell(arrival.position, s.side)),
                    dir: walker.ray.dir.as_vec3(),
                    normal: glam::Vec3::ZERO,
                    power: weight.0.as_vec3(),
                    order: u16::try_from(walker.order).unwrap_or(u16::MAX),
                    flags: walker.flags,
                };
                if (self.keep)(&photon) {
                    self.pass.photons.push(photon);
                }
            }
            Step::Absorbed(weight, number) => {
                self.pass.ledger.absorbed += weight.sum();
                for sensor in 0..self.sensors.len() {
                    if let Quantity::Absorbed(of) = self.sensors[sensor].quantity
                        && number == Some(of)
                    {
                        self.score(sensor, walker.order, weight);
                    }
                }
            }
            Step::Escaped(weight) => self.pass.ledger.escaped += weight.sum(),
            Step::Abandoned(weight) => self.pass.ledger.abandoned += weight.sum(),
            Step::Ahead(_) | Step::Surface(..) => {}
        }
    }
}

/// Whether a photon is in a range of orders.
pub fn is_in(orders: Orders) -> impl Fn(&Photon) -> bool + Sync {
    move |photon| orders.contains(u32::from(photon.order))
}

/// Whether a photon belongs in the volume map of Jensen and Christensen (1998): it does not come straight from a light.
pub fn is_indirect(photon: &Photon) -> bool {
    photon.flags != Flags::NONE
}
