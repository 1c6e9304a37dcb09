//! Sensors read by light tracing: photons are followed and scored as they pass, and none is stored.

use super::order_maps::{is_tallied, max_order};
use super::reach::{check_reach, empty_place};
use super::{Measurement, Source, measurements, room, row_bytes};
use crate::error::{Error, Result};
use crate::light::Light;
use crate::photons::{Emitter, Histories, Ledger, Part, Photon, Run, Scores, score_bytes};
use crate::scene::{Binned, Orders, Quantity, Scene, Scoring, Sensor};
use crate::stats::Moments;
use crate::transport::{BLOCK, Progress, blocks_at_once};

/// How many photons, and which.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TallySettings {
    /// Photons emitted.
    pub photons: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Orders that count, beside each sensor's own range.
    pub orders: Orders,
}

/// What photons scored, and where their power went.
#[derive(Debug, Clone, PartialEq)]
pub struct TallyReadings {
    /// One a sensor, bin and channel; n = histories.
    pub measurements: Vec<Measurement>,
    /// Powers \[W\] by history.
    pub ledger: Ledger,
}

/// Memory that the scores of the blocks of a pass would take, all at a time \[bytes\], unless [`FEWEST`] blocks take more.
const SCORES: f64 = 2.7e8;
/// Blocks at a time, at least and at most: enough for the threads of a large machine, where bins are few.
const FEWEST: u64 = 8;
const MOST: u64 = 512;

/// Blocks of histories of a pass. They depend on the scene alone, not on the machine, and so
/// does the order in which scores are added up.
fn blocks_at_a_time(scene: &Scene, sensors: &[Sensor]) -> u64 {
    let (block, _) = score_bytes(scene, sensors);
    ((SCORES / block.max(1.0)) as u64).clamp(FEWEST, MOST)
}

/// Most memory that [`by_tallies`] takes, about \[bytes\].
pub fn tally_bytes(scene: &Scene, settings: &TallySettings) -> f64 {
    let (block, history) = score_bytes(scene, scene.sensors());
    let blocks = blocks_at_a_time(scene, scene.sensors()).min(settings.photons.div_ceil(BLOCK));
    let scores = block * (blocks_at_once(blocks) + 2.0) + history * rayon::current_num_threads() as f64;
    // Measurements are made when the last block is merged.
    scores.max(block + row_bytes(scene))
}

/// Reads every sensor of the scene by light tracing.
///
/// # Errors
/// `Error::Unreachable` for a sensor that no photon meets: a fluence at a point, a radiance along one ray, radiance that
/// specular surfaces or lights themselves send; `Error::Scene` for a fluence scored by collisions where nothing collides;
/// `Error::NonFinite`; `Error::Cancelled`.
pub fn by_tallies(scene: &Scene, settings: &TallySettings, progress: &dyn Progress) -> Result<TallyReadings> {
    let narrowed = |s: &Sensor| Sensor { orders: s.orders.and(&settings.orders), ..s.clone() };
    let sensors: Vec<Sensor> = scene.sensors().iter().map(narrowed).collect();
    sensors.iter().try_for_each(|sensor| check(scene, sensor).and_then(|()| check_reach(scene, sensor)))?;
    let emitter = Emitter::by_power(scene);
    let histories = Histories {
        count: settings.photons,
        seed: settings.seed,
        replicate: 0,
        max_order: max_order(&sensors),
    };
    let run = Run { sensors: &sensors, scored: &sensors, ..Run::new(scene, &emitter, histories) };
    let (mut ledger, mut scores) = (Ledger::default(), Scores::default());
    let mut tallies = vec![[Moments::new(); 3]; sensors.len()];
    let of = settings.photons.div_ceil(BLOCK * blocks_at_a_time(scene, &sensors));
    for number in 0..of {
        let pass = Run { part: Part { number, of }, ..run }.pass(&|_: &Photon| false, progress)?;
        ledger += pass.report.ledger;
        scores.merge(pass.scores);
        for (mine, others) in tallies.iter_mut().flatten().zip(pass.tallies.iter().flatten()) {
            mine.merge(others);
        }
    }
    let mut scored = scores.moments(scene, settings.photons);
    let mut all = room(scene);
    for (sensor, tally) in sensors.iter().zip(&tallies) {
        match sensor.binned() {
            None => all.extend(measurements(scene, sensor, tally, None, Source::Tally, None)),
            Some(binned) => {
                for (bin, moments) in scored.by_ref().take(binned.bins()).enumerate() {
                    all.extend(measurements(scene, sensor, &moments, None, Source::Scores, Some(bin)));
                }
            }
        }
    }
    Ok(TallyReadings { measurements: all, ledger })
}

/// Whether photons meet what a sensor measures.
fn check(scene: &Scene, sensor: &Sensor) -> Result<()> {
    let refuse =
        |text: &str| Err(Error::Unreachable(format!("sensor {}: light tracing {text}", sensor.name)));
    match &sensor.quantity {
        Quantity::Binned(Binned::Radiance { .. }) => {
            if scene.objects().iter().any(|o| o.surface.is_specular()) {
                return refuse("cannot sample radiance that comes by mirrors or glass: use paths");
            }
            if sensor.orders.contains(0) && !scene.lights().iter().all(Light::is_delta) {
                return refuse(
                    "cannot sample radiance that comes from lights themselves: give it `min_order = 1`, or use paths",
                );
            }
            Ok(())
        }
        Quantity::Binned(binned @ Binned::Fluence { scoring: Scoring::Collision, .. }) => {
            empty_place(scene, binned).map_or(Ok(()), |p| {
                Err(Error::Scene(format!(
                    "sensor {}: no light collides at ({}, {}, {}); allowed for a fluence there: `scoring = \
                     \"track-length\"`",
                    sensor.name, p.x, p.y, p.z
                )))
            })
        }
        Quantity::Binned(_) => Ok(()),
        _ if is_tallied(sensor) => Ok(()),
        _ => {
            refuse("measures means over bins, not a fluence or a radiance in one point: use paths or photons")
        }
    }
}
