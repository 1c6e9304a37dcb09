//! Measuring a batch of repeats.

use super::field::{Exact, NEIGHBORS, PHOTONS, PLACES, RADII, REACH, ROWS, SETUP, is_near, place};
use super::intervals::{Answer, Kind};
use super::nulls::{LEVELS, Population, alarms};
use crate::harness::{CellId, CellOutput, Estimate, Group, MIN_MAPS, Settings};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::photons::{Histories, shoot};
use turbid::scene::Scene;
use turbid::stats::{Moments, normal_critical, student_critical};
use turbid::transport::NoProgress;

/// Maps of one repeat: the fewest that verdicts allow.
pub const MAPS: usize = MIN_MAPS as usize;
/// Repeats of one cell.
const REPEATS: usize = 20;
/// Maps that intervals are made of: the first so many of a repeat.
pub const SIZES: [usize; 4] = [8, 16, 32, MAPS];
/// Cells by preset: 2,000 repeats and 16,000.
const CELLS: (u64, u64) = (100, 400);
/// Group of the repeats.
pub const GROUP: &str = "coverage";

/// Repeats of the study.
pub fn repeats(settings: &Settings) -> u64 {
    settings.pick(CELLS.0, CELLS.1) * scaled(settings) as u64
}

/// The name of a case.
pub fn case(kind: Kind, maps: usize) -> String {
    format!("{} maps={maps}", kind.name())
}

/// The name of a case of right data.
pub fn null_case(population: Population) -> String {
    format!("null {}", population.name())
}

/// Name of the quantity that keeps one p-value a repeat.
pub fn p_name(repeat: usize) -> String {
    format!("p {repeat:02}")
}

/// Every repeat of a cell that has a p-value of its own.
pub fn p_names() -> impl Iterator<Item = String> {
    (0..REPEATS).map(p_name)
}

/// Name of the quantity that counts alarms at a level.
pub fn alarm_name(level: f64) -> String {
    format!("alarms at {level}")
}

/// All cells. The number of photons does not follow the scale: a study of fewer photons a map would be another one, so
/// the scale goes to the repeats.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let count = settings.pick(CELLS.0, CELLS.1);
    let cost = PHOTONS as f64 * (MAPS * scaled(settings)) as f64;
    let mut groups = vec![Group::new(GROUP, count, cost, measure_repeats)];
    for population in Population::ALL {
        let cost = 8.0 * tests(population, settings) as f64;
        let measure = move |settings: &Settings, cell: &CellId| Ok(measure_null(settings, cell, population));
        groups.push(Group::new(format!("null-{}", population.name()), count, cost, measure));
    }
    groups
}

/// Repeats of one cell.
fn scaled(settings: &Settings) -> usize {
    ((REPEATS as f64 * settings.photon_scale) as usize).clamp(1, REPEATS)
}

/// Tests of one cell on right data.
fn tests(population: Population, settings: &Settings) -> u64 {
    ((population.tests() as f64 * settings.photon_scale) as u64).clamp(100, population.tests())
}

/// Measures one batch of tests on right data.
fn measure_null(settings: &Settings, cell: &CellId, population: Population) -> CellOutput {
    let tests = tests(population, settings);
    let mut output = CellOutput::new();
    output.count("tests on right data", tests);
    let counts = alarms(population, tests, settings.seed, cell.stream("coverage"));
    for (level, count) in LEVELS.into_iter().zip(counts) {
        output.push(null_case(population), alarm_name(level), count as f64 / tests as f64);
    }
    output
}

/// What was found for one kind of interval of so many maps.
#[derive(Default, Clone)]
struct Tally {
    covered: Moments,
    alarms: Moments,
    by_normal: Moments,
}

fn measure_repeats(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let (scene, exact) = (SETUP.scene()?, Exact::new()?);
    let mut output = CellOutput::new();
    let mut tallies = vec![vec![Tally::default(); SIZES.len()]; Kind::ALL.len()];
    let critical = SIZES.map(|maps| student_critical(0.05, maps as u64 - 1));
    let normal = normal_critical(0.05);
    let (mut errors, mut nearest) = ([Moments::new(); RADII.len()], Moments::new());
    for repeat in 0..scaled(settings) {
        let mut maps = Vec::with_capacity(MAPS);
        for map in 0..MAPS {
            let index = (repeat * MAPS + map) as u64;
            let replicate = cell.replicate * (REPEATS * MAPS) as u64 + index;
            let own = CellId::of(GROUP, replicate);
            maps.push(ask(&scene, &exact, settings.seed, own.stream("coverage"))?);
        }
        output.count("photons emitted", PHOTONS * MAPS as u64);
        for answer in maps.iter().flatten() {
            errors.iter_mut().zip(answer.fixed).for_each(|(m, e)| m.push(e));
            nearest.push(answer.nearest);
        }
        // One list of maps a row of places.
        let rows: Vec<Vec<Answer>> = (0..ROWS).map(|row| maps.iter().map(|m| m[row]).collect()).collect();
        for (kind, tallies) in Kind::ALL.into_iter().zip(&mut tallies) {
            let truth = kind.truth(&exact);
            for (index, own) in rows.iter().enumerate() {
                for (size, &count) in SIZES.iter().enumerate() {
                    let Some(estimate) = kind.estimate(&own[..count], &exact) else {
                        output.count("intervals that could not be made", 1);
                        continue;
                    };
                    tallies[size].add(&estimate, truth, critical[size], normal);
                    output.count("intervals", 1);
                    if index == 0 && count == MAPS {
                        output.push(case(kind, count), p_name(repeat), estimate.p(truth));
                    }
                }
            }
        }
    }
    for (kind, tallies) in Kind::ALL.into_iter().zip(&tallies) {
        for (maps, tally) in SIZES.into_iter().zip(tallies) {
            output.push(case(kind, maps), "coverage", tally.covered.mean());
            output.push(case(kind, maps), "p below 0.01", tally.alarms.mean());
            output.push(case(kind, maps), "coverage by normal", tally.by_normal.mean());
        }
    }
    for (r, moments) in RADII.into_iter().zip(errors) {
        output.push(radius_case(r), "error", moments.mean());
    }
    output.push(nearest_case(), "error", nearest.mean());
    Ok(output)
}

/// The name of the case of a fixed radius.
pub fn radius_case(r: f64) -> String {
    format!("r={r}")
}

/// The name of the case of the nearest rule.
pub fn nearest_case() -> String {
    format!("k={NEIGHBORS}")
}

impl Tally {
    /// Student's interval is made from its critical value, looked up once; [`Estimate::interval`] makes the same.
    fn add(&mut self, estimate: &Estimate, truth: f64, student: f64, normal: f64) {
        let off = (estimate.value() - truth).abs();
        let yes = |condition: bool| f64::from(u8::from(condition));
        self.covered.push(yes(off <= student * estimate.std_error()));
        self.by_normal.push(yes(off <= normal * estimate.std_error()));
        self.alarms.push(yes(estimate.p(truth) < 0.01));
    }
}

/// Shoots one map and asks it at every place.
fn ask(scene: &Scene, exact: &Exact, seed: u64, replicate: u64) -> anyhow::Result<[Answer; ROWS]> {
    let histories = Histories { count: PHOTONS, seed, replicate, max_order: Some(0) };
    let pass = shoot(scene, histories, &[], is_near, &NoProgress)?;
    let map = pass.into_map(0.0)?;
    let fixed = RADII.map(Gather::radius);
    let nearest = Gather::nearest(NEIGHBORS, REACH)?;
    let mut answers = [Answer::default(); ROWS];
    for (row, answer) in answers.iter_mut().enumerate() {
        let mut counts = Moments::new();
        for index in 0..PLACES {
            let at = place(row, index);
            let error = |gather| {
                let estimator = Estimator::new(Kernel::Uniform, gather);
                let estimate = estimator.fluence(&map, at, Spectrum::ONE, &Boundary::UNKNOWN);
                (estimate.value[0] / exact.fluence - 1.0, estimate.found)
            };
            for (i, gather) in fixed.iter().enumerate() {
                let (off, found) = error(gather.clone()?);
                answer.fixed[i] += off / PLACES as f64;
                if i == RADII.len() - 1 {
                    answer.places[index] = off;
                    counts.push(found as f64);
                }
            }
            answer.nearest += error(nearest).0 / PLACES as f64;
        }
        (answer.count, answer.count_variance) = (counts.mean(), counts.variance());
    }
    Ok(answers)
}
