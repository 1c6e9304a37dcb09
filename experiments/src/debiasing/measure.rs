//! Measuring one batch of answers.

use super::cases::{
    BATCH, CELLS, Estimator, FIRST, MEAN_LEVELS, QUERIES, STOPS, beyond, constant, difference, passes,
    photons, places, radius, rays, thresholds, work,
};
use super::predict::{Expected, best, shares};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::levels::Schedule;
use crate::setups::uncollided::{Query, Uncollided, along_beams, along_points, at_place, scene};
use std::collections::BTreeMap;
use turbid::photons::beams::BeamMap;
use turbid::photons::{Emitter, Histories, PhotonMap, Run};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for query in QUERIES {
        let (all, most) = (photons(settings), work(settings));
        let cost = f64::from(STOPS + 1) * (BATCH * all) as f64;
        let measure = move |settings: &Settings, cell: &CellId| stopped(settings, cell, query);
        groups.push(Group::new(format!("stopped-{}", query.name()), CELLS, cost, measure).holding(all));
        let cost = (passes(settings, query) * constant(query).1) as f64;
        let measure = move |settings: &Settings, cell: &CellId| levels(settings, cell, query);
        groups.push(Group::new(format!("levels-{}", query.name()), CELLS, cost, measure));
        let measure = move |settings: &Settings, cell: &CellId| drawn(settings, cell, query);
        groups.push(
            Group::new(format!("drawn-{}", query.name()), CELLS, 2.0 * most as f64, measure).holding(most),
        );
    }
    groups
}

/// Passes of a cell, each with photons of its own.
struct Passes<'a> {
    query: Query,
    scene: &'a Scene,
    emitter: &'a Emitter,
    seed: u64,
    stream: u64,
    made: u64,
}

/// One pass, as what is asked of it.
enum Stored {
    Points(PhotonMap),
    Beams(BeamMap),
}

impl Passes<'_> {
    /// A pass of so many photons, none of which was in another one.
    fn fresh(&mut self, photons: u64, output: &mut CellOutput) -> anyhow::Result<Stored> {
        // Cells are below 256, and passes below 2^16: no two of the experiment share a number.
        let replicate = self.stream ^ self.made << 8;
        self.made += 1;
        let histories = Histories { count: photons, seed: self.seed, replicate, max_order: Some(0) };
        let is_beams = self.query == Query::Beams;
        let store = Uncollided { points: !is_beams, beams: is_beams };
        let mut pass = Run::new(self.scene, self.emitter, histories).pass(&store, &NoProgress)?;
        output.count("photons emitted", photons);
        Ok(match is_beams {
            false => Stored::Points(pass.into_map(FIRST)?),
            true => {
                let beams = std::mem::take(&mut pass.beams);
                let side = self.scene.periodic_cell().map(|cell| cell.side);
                Stored::Beams(BeamMap::new(beams, photons, side)?)
            }
        })
    }

    /// The estimates of all questions at a radius, over the exact value.
    fn read(&self, stored: &Stored, radius: f64) -> anyhow::Result<Vec<f64>> {
        let errors: anyhow::Result<Vec<f64>> = match stored {
            Stored::Points(map) if self.query.is_ray() => {
                rays().map(|ray| along_points(map, self.scene, &ray, radius)).collect()
            }
            Stored::Points(map) => places().map(|place| at_place(map, place, radius)).collect(),
            Stored::Beams(map) => rays().map(|ray| along_beams(map, self.scene, &ray, radius)).collect(),
        };
        Ok(errors?.into_iter().map(|error| 1.0 + error).collect())
    }

    /// Questions to a pass.
    fn questions(&self) -> usize {
        if self.query.is_ray() { rays().count() } else { places().count() }
    }

    /// The differences of a level, over the exact value.
    fn difference(&self, stored: &Stored, level: u32) -> anyhow::Result<Vec<f64>> {
        let (small, large) = (self.read(stored, radius(level + 1))?, self.read(stored, radius(level))?);
        Ok(small.iter().zip(&large).map(|(small, large)| small - large).collect())
    }
}

fn with_passes(
    settings: &Settings,
    cell: &CellId,
    query: Query,
    measure: impl FnOnce(&mut Passes<'_>, &mut CellOutput) -> anyhow::Result<()>,
) -> anyhow::Result<CellOutput> {
    let scene = scene()?;
    let emitter = Emitter::by_power(&scene);
    let (seed, stream) = (settings.seed, cell.stream("debiasing"));
    let mut passes = Passes { query, scene: &scene, emitter: &emitter, seed, stream, made: 0 };
    let mut output = CellOutput::new();
    measure(&mut passes, &mut output)?;
    Ok(output)
}

fn add(sum: &mut [f64], values: &[f64], factor: f64) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

/// Error and squared error of some answers.
fn push(output: &mut CellOutput, name: &str, values: &[f64]) {
    let errors: Vec<f64> = values.iter().map(|value| value - 1.0).collect();
    output.push(name, "error", errors.iter().collect::<Moments>().mean());
    output.push(name, "squared error", errors.iter().map(|e| e * e).collect::<Moments>().mean());
}

/// Plain estimates of one pass, and sums of as many photons; means over the batch.
fn stopped(settings: &Settings, cell: &CellId, query: Query) -> anyhow::Result<CellOutput> {
    with_passes(settings, cell, query, |passes, output| {
        let all = photons(settings);
        let best = best(query, all)?;
        let stops = (1..=STOPS).map(|levels| shares(query, levels, all));
        let stops = stops.collect::<anyhow::Result<Vec<_>>>()?;
        let mut means = BTreeMap::new();
        for _ in 0..BATCH {
            for (estimator, values) in batch((all, best, &stops), passes, output)? {
                let [errors, squares]: &mut [Moments; 2] = means.entry(estimator.name(query)).or_default();
                values.iter().for_each(|value| errors.push(value - 1.0));
                values.iter().for_each(|value| squares.push((value - 1.0) * (value - 1.0)));
            }
        }
        for (name, [errors, squares]) in means {
            output.push(&name, "error", errors.mean());
            output.push(&name, "squared error", squares.mean());
        }
        Ok(())
    })
}

/// One of the batch: so many photons, the best radius, and the shares of stopped sums.
fn batch(
    (all, best, stops): (u64, f64, &[Vec<u64>]),
    passes: &mut Passes<'_>,
    output: &mut CellOutput,
) -> anyhow::Result<Vec<(Estimator, Vec<f64>)>> {
    let mut answers = Vec::new();
    let plain = passes.fresh(all, output)?;
    for levels in 0..=STOPS {
        answers.push((Estimator::Plain(levels), passes.read(&plain, radius(levels))?));
    }
    answers.push((Estimator::Best, passes.read(&plain, best)?));
    for (levels, shares) in (1..).zip(stops) {
        let first = passes.fresh(shares[0], output)?;
        let mut sum = passes.read(&first, FIRST)?;
        if levels == MEAN_LEVELS {
            answers.push((Estimator::Off, sum.clone()));
        }
        for (level, &share) in shares[1..].iter().enumerate() {
            let own = passes.fresh(share, output)?;
            add(&mut sum, &passes.difference(&own, level as u32)?, 1.0);
        }
        answers.push((Estimator::Stopped(levels), sum));
    }
    Ok(answers)
}

/// Magnitudes of differences of one number of photons.
fn levels(settings: &Settings, cell: &CellId, query: Query) -> anyhow::Result<CellOutput> {
    with_passes(settings, cell, query, |made, output| {
        let (levels, photons) = constant(query);
        let mut magnitudes = vec![Moments::new(); levels as usize];
        for _ in 0..passes(settings, query) {
            let stored = made.fresh(photons, output)?;
            let mut large = made.read(&stored, FIRST)?;
            for (level, magnitudes) in magnitudes.iter_mut().enumerate() {
                let small = made.read(&stored, radius(level as u32 + 1))?;
                small.iter().zip(&large).for_each(|(small, large)| magnitudes.push((small - large).abs()));
                large = small;
            }
        }
        for (level, magnitudes) in magnitudes.iter().enumerate() {
            output.push(difference(query, level as u32), "magnitude", magnitudes.mean());
        }
        Ok(())
    })
}

/// Sums whose level is drawn, and the plain estimate of as much work at its best radius.
fn drawn(settings: &Settings, cell: &CellId, query: Query) -> anyhow::Result<CellOutput> {
    with_passes(settings, cell, query, |passes, output| {
        let (schedule, work) = (Schedule::of(query.codimension()), work(settings));
        let replicates = schedule.replicates(work);
        let mut levels = Stream::new(passes.seed, Purpose::Synthetic, passes.stream, 0);
        let mut mean = vec![0.0; passes.questions()];
        let before = output.counters.get("photons emitted").copied().unwrap_or(0);
        for _ in 0..replicates {
            let level = schedule.level(levels.unit());
            let first = passes.fresh(schedule.first, output)?;
            add(&mut mean, &passes.read(&first, FIRST)?, 1.0 / replicates as f64);
            let own = passes.fresh(schedule.photons(level), output)?;
            let factor = 1.0 / (schedule.chance(level) * replicates as f64);
            add(&mut mean, &passes.difference(&own, level)?, factor);
        }
        let used = output.counters.get("photons emitted").copied().unwrap_or(0) - before;
        let plain = passes.fresh(work, output)?;
        let plain = passes.read(&plain, best(query, work)?)?;
        let unit = Expected::new(settings, query, Estimator::Equal)?.squared.sqrt();
        for (estimator, values) in [(Estimator::Drawn, mean), (Estimator::Equal, plain)] {
            let name = estimator.name(query);
            push(output, &name, &values);
            for threshold in thresholds() {
                let far = values.iter().filter(|&value| (value - 1.0).abs() > threshold * unit).count();
                output.push(&name, beyond(threshold), far as f64 / values.len() as f64);
            }
        }
        output.push(Estimator::Drawn.name(query), "photons", used as f64);
        Ok(())
    })
}
