//! Cells: batches of sampled rows, the checked rows, one large map, and the maps of the storage questions.

use super::cases::{BATCHES, Class};
use super::checks;
use super::sampled;
use super::scenes::{CELL, Flux, Fog, at_depth, sensor, slab};
use super::{storage, stretched};
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::estimators::count_within;
use turbid::photons::{Histories, Photon, shoot};
use turbid::scene::Orders;
use turbid::transport::NoProgress;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::{Dimension, Incidence, Kernel};

/// The group of the checked rows.
const CHECKED: &str = "checked";
/// The group of the one large map.
const LARGE: &str = "large";
/// The slab of the large map: black, so that counts are binomial.
const BLACK: Fog = Fog { tau: 4.0, albedo: 0.0, g: 0.0 };
/// Depth and radius of the large map's gather [mfp].
const BALL: (f64, f64) = (0.5, 0.2);

/// Photons emitted into the large map.
pub fn large(settings: &Settings) -> u64 {
    settings.photons(1_000_000, 100_000_000)
}

/// The cases of the large map, with the probability that a photon counts and the bound on its error.
pub fn large_cases(settings: &Settings) -> anyhow::Result<Vec<(String, f64, f64)>> {
    let photons = large(settings);
    let (depth, radius) = BALL;
    let ball = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
    let mean = exponential_mean(Kernel::Uniform, Dimension::Three, radius)?;
    let in_ball = ball * libm::exp(-depth) / (CELL * CELL);
    Ok(vec![
        (format!("one pass of {photons}, tau=4 w=0 transmitted"), libm::exp(-BLACK.tau), f64::EPSILON),
        (
            format!("one map of {photons}, photons in a ball"),
            in_ball * mean.value,
            in_ball * mean.error + f64::EPSILON,
        ),
    ])
}

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups: Vec<Group> = Class::SAMPLED
        .into_iter()
        .map(|class| {
            let rows = sampled::all().into_iter().filter(|row| row.class == class);
            let cost = rows.map(|row| row.histories(settings) as f64 * 4.0).sum();
            let measure =
                move |settings: &Settings, cell: &CellId| measure_sampled(settings, class, cell.replicate);
            Group::new(format!("sampled-{}", class.name()), BATCHES, cost, measure)
        })
        .collect();
    let checked = 2e6 * settings.photon_scale;
    groups.push(Group::new(CHECKED, 1, checked, |settings, _| measure_checked(settings)));
    let photons = large(settings);
    groups.push(Group::new(LARGE, 1, photons as f64, measure_large).holding(photons));
    groups.push(storage::group(settings));
    groups.extend(stretched::groups(settings));
    groups
}

/// Numbers that are not finite are counted and left out, so that the report can say where they were met.
fn push_finite(output: &mut CellOutput, case: &str, quantity: &str, value: f64) -> f64 {
    if value.is_finite() {
        output.push(case, quantity, value);
    }
    f64::from(u8::from(!value.is_finite()))
}

fn measure_sampled(settings: &Settings, class: Class, batch: u64) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    for row in sampled::all().into_iter().filter(|row| row.class == class) {
        let brought = row.measure(settings, batch)?;
        output.count("histories", row.histories(settings));
        let lost = push_finite(&mut output, &row.name, "value", brought.value);
        output.push(&row.name, "non-finite", brought.non_finite as f64 + lost);
    }
    Ok(output)
}

fn measure_checked(settings: &Settings) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    for row in checks::all(settings)? {
        let name = format!("{}: {}", row.class.name(), row.name);
        let lost = push_finite(&mut output, &name, "value", row.value);
        output.push(&name, "exact", row.exact);
        output.push(&name, "bound", row.bound);
        output.push(&name, "non-finite", lost);
    }
    Ok(output)
}

/// One map of as many photons as the machine's memory allows to emit: those in the middle of the cell are kept.
fn measure_large(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let scene = slab(BLACK, Incidence::Beam { mu0: 1.0 }, 1.0)?;
    let sensors = [sensor(&scene, Flux::Transmitted, Orders::ALL)];
    let replicate = cell.stream("extremes");
    let histories = Histories { count: large(settings), seed: settings.seed, replicate, max_order: None };
    let (depth, radius) = BALL;
    let centre = at_depth(depth, 1.0);
    let keep = |photon: &Photon| (photon.position - centre).abs().max_element() <= 2.0 * radius;
    let pass = shoot(&scene, histories, &sensors, keep, &NoProgress)?;
    let mut output = CellOutput::new();
    let emitted = pass.emitted();
    output.count("photons emitted", emitted);
    let transmitted = (pass.tallies[0][0].mean() * emitted as f64).round();
    let counts = [transmitted, count_within(&pass.into_map(0.0)?, centre, radius) as f64];
    for ((case, ..), count) in large_cases(settings)?.iter().zip(counts) {
        output.push(case, "count", count);
        output.push(case, "emitted", emitted as f64);
    }
    Ok(output)
}
