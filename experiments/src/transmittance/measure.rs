//! Measuring one batch of estimates.

use super::cases::{Case, LEVELS, RAMP, cells, estimates, level_name};
use super::estimators::{Estimator, halves};
use super::line::Line;
use super::rays::Way;
use crate::harness::{CellId, CellOutput, Group, Settings};
use anyhow::anyhow;
use std::sync::OnceLock;
use turbid::rng::{Purpose, Stream};
use turbid::stats::Moments;

/// The group of the levels of the telescoping sum.
pub const LEVELS_GROUP: &str = "levels";

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    // An estimate makes some ten look-ups and draws; ten methods.
    let cost = 30.0 * estimates(settings) as f64;
    let of_way = |way: Way| {
        // The line and its estimators are the same in all cells: some milliseconds of quadrature.
        let prepared = OnceLock::new();
        let measure = move |settings: &Settings, cell: &CellId| {
            let prepared = prepared.get_or_init(|| Prepared::new(way).map_err(|error| error.to_string()));
            Ok(measure(settings, cell, prepared.as_ref().map_err(|error| anyhow!("{error}"))?))
        };
        Group::new(way.name(), cells(settings), cost, measure)
    };
    let mut groups: Vec<Group> = Way::all().into_iter().map(of_way).collect();
    groups.push(Group::new(LEVELS_GROUP, cells(settings), cost, levels));
    groups
}

/// The stream of one estimate: those of different cases share no numbers.
fn streams(settings: &Settings, cell: &CellId) -> impl Fn(usize, u64) -> Stream {
    let (seed, replicate) = (settings.seed, cell.stream("transmittance"));
    move |case, index| Stream::new(seed, Purpose::Synthetic, replicate, index << 8 | case as u64)
}

/// A ray with the estimators that it is asked by.
struct Prepared {
    line: Line,
    exact: f64,
    cases: Vec<(Case, Estimator)>,
}

impl Prepared {
    fn new(way: Way) -> anyhow::Result<Self> {
        let line = way.line()?;
        let cases = Case::of(way).into_iter().map(|case| (case, case.method.on(&line))).collect();
        Ok(Prepared { exact: libm::exp(-line.depth()), line, cases })
    }
}

/// Measures one cell: of each method the mean, the mean squared error over T^2, and the mean number of look-ups.
fn measure(settings: &Settings, cell: &CellId, prepared: &Prepared) -> CellOutput {
    let Prepared { line, exact, cases } = prepared;
    let (mut output, stream) = (CellOutput::new(), streams(settings, cell));
    for (number, (case, estimator)) in cases.iter().enumerate() {
        let (mut values, mut squares, mut look_ups) = (Moments::new(), Moments::new(), Moments::new());
        for index in 0..estimates(settings) {
            let estimate = estimator.estimate(line, &mut stream(number, index));
            let error = estimate.value / exact - 1.0;
            values.push(estimate.value);
            squares.push(error * error);
            look_ups.push(estimate.look_ups as f64);
        }
        output.count("densities looked up", (look_ups.mean() * look_ups.n() as f64).round() as u64);
        let name = case.name();
        output.push(&name, "transmittance", values.mean());
        output.push(&name, "squared error", squares.mean());
        output.push(&name, "look-ups", look_ups.mean());
    }
    output
}

/// Measures squared differences of marches by level, over T^2.
fn levels(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let line = RAMP.line()?;
    let exact = libm::exp(-line.depth());
    let (mut output, stream) = (CellOutput::new(), streams(settings, cell));
    for level in 0..LEVELS {
        let squared = |index| {
            let difference = halves(&line, 1 << level, &mut stream(level as usize, index)) / exact;
            difference * difference
        };
        let mean: Moments = (0..estimates(settings)).map(squared).collect();
        output.push(level_name(level), "squared difference", mean.mean());
        output.count("densities looked up", estimates(settings) << (level + 1));
    }
    Ok(output)
}
