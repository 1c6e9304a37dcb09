//! The photon mapper on a box of fog: error against time, beside path tracers.

use crate::{Round, squared_errors, timed};
use anyhow::{Context, Result};
use std::io::Write;
use turbid::estimators::{Gather, Kernel};
use turbid::integrators::mapper::{Mapper, March, Settings};
use turbid::math::Positive;
use turbid::photons::maps::{Amount, Indirect, MapSettings, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, SURROUNDINGS, Scene};
use turbid::sensor::{Streams, render};
use turbid::transport::NoProgress;

/// Photons an estimate uses.
const K: usize = 100;
const ROUNDS: usize = 7;
/// Photons on surfaces and in the volume, as multiples of those of the picture of 1998, and samples a pixel: errors from
/// 30 per cent of the mean down to where the spread of maps with this many photons an estimate is all that is left.
const SIZES: [(f64, u64); 5] = [(0.3, 2), (1.0, 5), (2.0, 20), (4.0, 80), (16.0, 80)];
const SURFACE: f64 = 200_000.0;
const VOLUME: f64 = 65_000.0;

/// One map and its picture, the map seen directly.
fn by_map(scene: &Scene, camera: &Camera, factor: f64, samples: u64, replicate: u64) -> Result<Round> {
    let stored = |count: f64| Amount::Stored((factor * count) as u64);
    let filling = MapSettings {
        global: stored(SURFACE),
        caustic: Amount::Emitted(1),
        volume: stored(VOLUME),
        indirect: Indirect::Seen,
        seed: 1,
        replicate,
    };
    let nearest = Gather::nearest(K, 1.0)?;
    let standard = Settings::for_size(2.0, K)?;
    let settings = Settings {
        global: (Kernel::Uniform, nearest),
        volume: (Kernel::Uniform, nearest),
        // One random place a ray, in proportion to what reaches the eye from it: unbiased, whatever the step.
        march: March { step: Positive::new("the step", 4.0)?, adaptive: None, ..standard.march },
        ..standard
    };
    timed(|| {
        let maps = fill(scene, &filling, &NoProgress)?;
        let mapper = Mapper::new(scene, &maps, &settings);
        Ok(render(camera, samples, Streams { seed: 1, replicate }, &NoProgress, |ray, stream| {
            mapper.radiance(ray, None, SURROUNDINGS, stream).0
        })?)
    })
}

/// What some rounds say of one size of maps.
struct Row {
    seconds: f64,
    /// Mean squared error, and its part that varies between maps [radiance^2].
    error: f64,
    variance: f64,
}

/// Rounds of maps against the mean of all rounds of path tracers, whose own error is known and taken off.
fn row(rounds: &[Round], chosen: &[usize], truth: &[f64], error_of_truth: f64) -> Row {
    let n = chosen.len() as f64;
    let seconds = chosen.iter().map(|&i| rounds[i].seconds).sum::<f64>() / n;
    let off = |round: &Round| {
        let squares = round.pixels.iter().zip(truth).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>() / truth.len() as f64
    };
    let spread = squared_errors(rounds);
    Row {
        seconds,
        error: chosen.iter().map(|&i| off(&rounds[i])).sum::<f64>() / n - error_of_truth,
        variance: chosen.iter().map(|&i| spread[i]).sum::<f64>() / n,
    }
}

/// The error, relative to the picture's mean, at which maps and a path tracer of this efficiency take the same time:
/// between two sizes the logarithm of the ratio of times is taken to be linear in that of the error.
fn crossing(rows: &[Row], efficiency: f64, mean: f64) -> Option<f64> {
    let points: Vec<[f64; 2]> = rows
        .iter()
        .map(|row| {
            let advantage = 1.0 / (efficiency * row.error * row.seconds);
            [0.5 * libm::log(row.error), libm::log(advantage)]
        })
        .collect();
    let found = points.windows(2).find(|pair| pair[0][1] > 0.0 && pair[1][1] <= 0.0)?;
    let part = found[0][1] / (found[0][1] - found[1][1]);
    Some(libm::exp(found[0][0] + part * (found[1][0] - found[0][0])) / mean)
}

/// Prints error against time, and where path tracers become faster.
pub fn compare(
    out: &mut impl Write,
    scene: &Scene,
    camera: &Camera,
    paths: &[(String, Vec<Round>)],
) -> Result<()> {
    let count = paths.first().context("no path tracer")?.1[0].pixels.len();
    let all: Vec<&Round> = paths.iter().flat_map(|(_, rounds)| rounds).collect();
    // Every renderer's rounds weigh as much as their spread allows.
    let weights: Vec<f64> = paths
        .iter()
        .flat_map(|(_, rounds)| {
            let error = squared_errors(rounds).iter().sum::<f64>() / rounds.len() as f64;
            rounds.iter().map(move |_| 1.0 / error)
        })
        .collect();
    let total: f64 = weights.iter().sum();
    let truth: Vec<f64> = (0..count)
        .map(|i| all.iter().zip(&weights).map(|(round, w)| w * round.pixels[i]).sum::<f64>() / total)
        .collect();
    let mean = truth.iter().sum::<f64>() / count as f64;

    let sizes = SIZES.map(|(factor, samples)| -> Result<Vec<Round>> {
        (0..ROUNDS as u64).map(|round| by_map(scene, camera, factor, samples, round)).collect()
    });
    let sizes = sizes.into_iter().collect::<Result<Vec<_>>>()?;
    let rows = |chosen: &[usize]| -> Vec<Row> {
        sizes.iter().map(|rounds| row(rounds, chosen, &truth, 1.0 / total)).collect()
    };
    writeln!(
        out,
        "\nPhoton maps seen directly, {K} photons an estimate, {ROUNDS} maps of each size; % of the mean"
    )?;
    write!(
        out,
        "{:>9} {:>9} {:>7} {:>8} {:>7} {:>7} {:>7} {:>10}",
        "surface", "volume", "samples", "s", "error", "spread", "bias", "1/(MSE s)"
    )?;
    let efficiencies: Vec<(&str, f64)> = paths
        .iter()
        .map(|(name, rounds)| {
            let error = squared_errors(rounds).iter().sum::<f64>();
            let seconds = rounds.iter().map(|r| r.seconds).sum::<f64>();
            (name.as_str(), (rounds.len() * rounds.len()) as f64 / (error * seconds))
        })
        .collect();
    for (name, _) in &efficiencies {
        write!(out, " {:>28}", format!("times {name}"))?;
    }
    writeln!(out)?;
    let mut stream = Stream::new(1, Purpose::Resampling, 1, 0);
    let resampled: Vec<Vec<Row>> =
        (0..1000).map(|_| rows(&(0..ROUNDS).map(|_| stream.index(ROUNDS)).collect::<Vec<_>>())).collect();
    let whole = rows(&(0..ROUNDS).collect::<Vec<_>>());
    let interval = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        [values[values.len() / 40], values[values.len() - 1 - values.len() / 40]]
    };
    for (i, (factor, samples)) in SIZES.into_iter().enumerate() {
        let row = &whole[i];
        let percent = |square: f64| 100.0 * square.max(0.0).sqrt() / mean;
        write!(
            out,
            "{:>9.0} {:>9.0} {samples:>7} {:>8.3} {:>7.2} {:>7.2} {:>7.2} {:>10.1}",
            factor * SURFACE,
            factor * VOLUME,
            row.seconds,
            percent(row.error),
            percent(row.variance),
            percent(row.error - row.variance),
            1.0 / (row.error * row.seconds)
        )?;
        for (_, efficiency) in &efficiencies {
            let times = |row: &Row| 1.0 / (row.error * row.seconds * efficiency);
            let [low, high] = interval(resampled.iter().map(|rows| times(&rows[i])).collect());
            write!(out, " {:>9.2} ({low:7.2} to {high:6.2})", times(row))?;
        }
        writeln!(out)?;
    }
    for (name, efficiency) in efficiencies {
        match crossing(&whole, efficiency, mean) {
            Some(at) => {
                let found = resampled.iter().filter_map(|rows| crossing(rows, efficiency, mean)).collect();
                let [low, high] = interval(found);
                writeln!(
                    out,
                    "{name} is faster below an error of {:.2} % ({:.2} to {:.2})",
                    100.0 * at,
                    100.0 * low,
                    100.0 * high
                )?;
            }
            None => writeln!(out, "{name}: no crossing at these sizes")?,
        }
    }
    Ok(())
}
