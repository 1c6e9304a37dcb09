//! Measuring one batch of estimates.

use super::cases::{Case, LEVELS, RAMP, cells, estimates, level_name};
use super::estimators::halves;
use super::rays::Way;
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::rng::{Purpose, Stream};
use turbid::stats::Moments;

/// The group of the levels of the telescoping sum.
pub const LEVELS_GROUP: &str = "levels";

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    // An estimate makes some ten look-ups and draws; ten methods.
    let cost = 30.0 * estimates(settings) as f64;
    let of_way = |way: Way| {
        let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, way);
        Group::new(way.name(), cells(settings), cost, measure)
    };
    let mut groups: Vec<Group> = Way::all().into_iter().map(of_way).collect();
    groups.push(Group::new(LEVELS_GROUP, cells(settings), cost, levels));
    groups
}

/// The stream of one estimate: those of different cases share no numbers.
fn stream(settings: &Settings, cell: &CellId, case: usize, index: u64) -> Stream {
    Stream::new(settings.seed, Purpose::Synthetic, cell.stream("transmittance"), index << 8 | case as u64)
}

/// Measures one cell: of each method the mean, the mean squared error over T^2, and the mean number of look-ups.
fn measure(settings: &Settings, cell: &CellId, way: Way) -> anyhow::Result<CellOutput> {
    let line = way.line()?;
    let exact = libm::exp(-line.depth());
    let mut output = CellOutput::new();
    for (number, case) in Case::of(way).into_iter().enumerate() {
        let estimator = case.method.on(&line);
        let (mut values, mut squares, mut look_ups) = (Moments::new(), Moments::new(), Moments::new());
        for index in 0..estimates(settings) {
            let estimate = estimator.estimate(&line, &mut stream(settings, cell, number, index));
            let error = estimate.value / exact - 1.0;
            values.push(estimate.value);
            squares.push(error * error);
            look_ups.push(estimate.look_ups as f64);
            output.count("densities looked up", estimate.look_ups);
        }
        let name = case.name();
        output.push(&name, "transmittance", values.mean());
        output.push(&name, "squared error", squares.mean());
        output.push(&name, "look-ups", look_ups.mean());
    }
    Ok(output)
}

/// Measures squared differences of marches by level, over T^2.
fn levels(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let line = RAMP.line()?;
    let exact = libm::exp(-line.depth());
    let mut output = CellOutput::new();
    for level in 0..LEVELS {
        let squared = |index| {
            let difference =
                halves(&line, 1 << level, &mut stream(settings, cell, level as usize, index)) / exact;
            difference * difference
        };
        let mean: Moments = (0..estimates(settings)).map(squared).collect();
        output.push(level_name(level), "squared difference", mean.mean());
        output.count("densities looked up", estimates(settings) << (level + 1));
    }
    Ok(output)
}
