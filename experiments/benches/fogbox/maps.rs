//! The photon mapper on a box of fog: error against time, beside path tracers.

use crate::{Round, WIDTH, squared_errors, timed};
use anyhow::{Context, Result};
use std::io::Write;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::March;
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::math::Positive;
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Method, Streams};
use turbid::transport::NoProgress;
use turbid_experiments::cost_model::{self, Maps, Paths};

const ROUNDS: usize = 7;
/// Photons on surfaces, in the volume, in an estimate, and samples a pixel. Photons and k grow together; other numbers of
/// samples follow from the variance between samples. The picture of 1998 has 200,000 photons in all; the third size has as many
/// on surfaces. They take about as many samples as 20 per cent of error ask for.
const SIZES: [(f64, f64, usize, u64); 5] = [
    (50_000.0, 16_250.0, 45, 4),
    (135_000.0, 65_000.0, 100, 6),
    (200_000.0, 65_000.0, 100, 6),
    (800_000.0, 260_000.0, 220, 12),
    (3_200_000.0, 1_040_000.0, 490, 8),
];
/// Errors, over the mean, at which times are compared.
const ERRORS: [f64; 7] = [0.3, 0.25, 0.2, 0.15, 0.1, 0.05, 0.03];
const PIXELS: f64 = (WIDTH * WIDTH) as f64;

/// One map and its picture, the map seen directly; the seconds that filling took, and the variance of the mean over
/// samples, mean over pixels and channels.
fn by_map(
    scene: &Scene,
    camera: &Camera,
    (surface, volume, k, samples): (f64, f64, usize, u64),
    replicate: u64,
) -> Result<(Round, f64, f64)> {
    let filling = MapSettings {
        global: Amount::Stored(surface as u64),
        caustic: Amount::Emitted(1),
        volume: Amount::Stored(volume as u64),
        media: MediumSamples::Points,
        indirect: Indirect::Seen,
        seed: 1,
        replicate,
    };
    let nearest = Gather::nearest(k, 1.0)?;
    let standard = Settings::for_size(2.0, k)?;
    let settings = Settings {
        global: (Kernel::Uniform, nearest),
        volume: Estimator { gather: nearest, ..standard.volume },
        // One random place a ray, in proportion to what reaches the eye from it: unbiased, whatever the step.
        march: March { step: Positive::new("the step", 4.0)?, adaptive: None, ..standard.march },
        ..standard
    };
    let (mut seconds, mut noise) = (0.0, 0.0);
    let round = timed(|| {
        let start = cpu_time::ThreadTime::now();
        let maps = fill(scene, &filling, &NoProgress)?;
        seconds = start.elapsed().as_secs_f64();
        let photons = Method::Photons(Mapper::new(scene, &maps, &settings));
        let film = photons.render(camera, samples, Streams { seed: 1, replicate }, &NoProgress)?;
        let variances = film.pixels().iter().filter_map(|pixel| Some(pixel.variance()?.mean()));
        noise = variances.sum::<f64>() / PIXELS;
        Ok(film)
    })?;
    Ok((round, seconds, noise))
}

/// What the rounds of one size of map say, each by itself: costs, and squared errors against the mean of all rounds of path
/// tracers and against the mean of their own.
struct Size {
    samples: f64,
    seconds: Vec<f64>,
    fill: Vec<f64>,
    noise: Vec<f64>,
    off: Vec<f64>,
    between: Vec<f64>,
}

impl Size {
    fn new(seen: Vec<(Round, f64, f64)>, samples: u64, truth: &[f64]) -> Self {
        let (fill, noise) = (seen.iter().map(|s| s.1).collect(), seen.iter().map(|s| s.2).collect());
        let rounds: Vec<Round> = seen.into_iter().map(|s| s.0).collect();
        let off = |round: &Round| {
            let squares = round.pixels.iter().zip(truth).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>() / truth.len() as f64
        };
        Size {
            samples: samples as f64,
            seconds: rounds.iter().map(|round| round.seconds).collect(),
            fill,
            noise,
            off: rounds.iter().map(off).collect(),
            between: squared_errors(&rounds),
        }
    }

    /// Of some rounds; the error of the truth is known and taken off.
    fn of(&self, chosen: &[usize], error_of_truth: f64) -> Maps {
        let n = chosen.len() as f64;
        let average = |values: &[f64]| chosen.iter().map(|&i| values[i]).sum::<f64>() / n;
        let (error, between) = (average(&self.off) - error_of_truth, average(&self.between));
        let (noise, fill, seconds) = (average(&self.noise), average(&self.fill), average(&self.seconds));
        Maps {
            fill,
            sample: (seconds - fill) / (PIXELS * self.samples),
            noise: noise * self.samples,
            spread: (between - noise).max(0.0),
            bias: (error - between).max(0.0),
        }
    }
}

/// A path tracer by some of its rounds.
fn path_tracer(rounds: &[Round], errors: &[f64], chosen: &[usize]) -> Paths {
    let n = chosen.len() as f64;
    let samples = crate::SAMPLES as f64;
    Paths {
        sample: chosen.iter().map(|&i| rounds[i].seconds).sum::<f64>() / (n * PIXELS * samples),
        noise: chosen.iter().map(|&i| errors[i]).sum::<f64>() / n * samples,
    }
}

fn interval(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_unstable_by(f64::total_cmp);
    let (last, cut) = (values.len() - 1, values.len() / 40);
    [values[cut], values[last - cut]]
}

/// Prints error against time, and where path tracers become faster.
pub fn compare(
    out: &mut impl Write,
    scene: &Scene,
    camera: &Camera,
    paths: &[(String, Vec<Round>)],
) -> Result<()> {
    let count = paths.first().context("no path tracer")?.1[0].pixels.len();
    let errors: Vec<Vec<f64>> = paths.iter().map(|(_, rounds)| squared_errors(rounds)).collect();
    // Every renderer's rounds weigh as much as their spread allows.
    let mut truth = vec![0.0; count];
    let mut total = 0.0;
    for ((_, rounds), errors) in paths.iter().zip(&errors) {
        let weight = rounds.len() as f64 / errors.iter().sum::<f64>();
        for round in rounds {
            truth.iter_mut().zip(&round.pixels).for_each(|(sum, value)| *sum += weight * value);
            total += weight;
        }
    }
    truth.iter_mut().for_each(|sum| *sum /= total);
    let mean = truth.iter().sum::<f64>() / count as f64;
    let percent = |square: f64| 100.0 * square.max(0.0).sqrt() / mean;

    writeln!(out, "\nPhoton maps seen directly, {ROUNDS} maps of each size; errors in % of the mean")?;
    writeln!(
        out,
        "{:>9} {:>9} {:>4} {:>7} {:>7} {:>10} {:>7} {:>7} {:>10} {:>7} {:>7}",
        "surface", "volume", "k", "samples", "fill s", "us/sample", "error", "noise/1", "spread", "bias", "s"
    )?;
    let mut stream = Stream::new(1, Purpose::Resampling, 1, 0);
    let draws: Vec<Vec<usize>> =
        (0..300).map(|_| (0..ROUNDS).map(|_| stream.index(ROUNDS)).collect()).collect();
    let (mut whole, mut resampled) = (Vec::new(), vec![Vec::new(); draws.len()]);
    for size in SIZES {
        let seen =
            (0..ROUNDS as u64).map(|round| by_map(scene, camera, size, round)).collect::<Result<Vec<_>>>()?;
        let (surface, volume, k, samples) = size;
        let rounds = Size::new(seen, samples, &truth);
        let of = |chosen: &[usize]| rounds.of(chosen, 1.0 / total);
        let maps = of(&(0..ROUNDS).collect::<Vec<_>>());
        writeln!(
            out,
            "{surface:>9.0} {volume:>9.0} {k:>4} {samples:>7} {:>7.3} {:>10.2} {:>7.2} {:>7.2} {:>10.2} {:>7.2} {:>7.3}",
            maps.fill,
            1e6 * maps.sample,
            percent(maps.square(samples as f64)),
            percent(maps.noise),
            percent(maps.spread),
            percent(maps.bias),
            maps.fill + PIXELS * samples as f64 * maps.sample,
        )?;
        out.flush()?;
        resampled.iter_mut().zip(&draws).for_each(|(sizes, chosen)| sizes.push(of(chosen)));
        whole.push(maps);
    }
    for ((name, rounds), errors) in paths.iter().zip(&errors) {
        let all = path_tracer(rounds, errors, &(0..rounds.len()).collect::<Vec<_>>());
        let others: Vec<Paths> = draws
            .iter()
            .map(|_| {
                let chosen: Vec<usize> = (0..rounds.len()).map(|_| stream.index(rounds.len())).collect();
                path_tracer(rounds, errors, &chosen)
            })
            .collect();
        writeln!(
            out,
            "\nTime of {name} over that of the cheapest map, of the map of 1998, and of that with 200,000 on surfaces"
        )?;
        for error in ERRORS {
            let square = error * error * mean * mean;
            let gain = |maps: &[Maps], paths: &Paths| {
                cost_model::cheapest(maps, PIXELS, square).map_or(0.0, |c| paths.cost(PIXELS, square) / c.1)
            };
            let ratios = |maps: fn(&[Maps]) -> &[Maps]| {
                let found = resampled.iter().zip(&others).map(|(m, p)| gain(maps(m), p)).collect();
                let [low, high] = interval(found);
                format!("{:6.2} ({low:5.2} to {high:5.2})", gain(maps(&whole), &all))
            };
            let samples = whole[1].samples(square).map_or("-".into(), |n| format!("{n:.1}"));
            writeln!(
                out,
                "{:>5.0} %  {}   {}   {}   {samples} samples per pixel",
                100.0 * error,
                ratios(|all| all),
                ratios(|all| &all[1..2]),
                ratios(|all| &all[2..3])
            )?;
        }
        let crossing = |maps: &[Maps], paths: &Paths| 100.0 * cost_model::crossing(maps, paths, PIXELS, mean);
        let [low, high] = interval(resampled.iter().zip(&others).map(|(m, p)| crossing(m, p)).collect());
        let at = crossing(&whole, &all);
        if at > 100.0 * cost_model::RANGE.0 {
            writeln!(out, "{name} is faster below an error of {at:.2} % ({low:.2} to {high:.2})")?;
        } else {
            // The floor of the largest maps was too small to be told from the noise of their samples.
            writeln!(out, "{name} is not faster above an error of {high:.2} % (upper end of 95 %)")?;
        }
    }
    Ok(())
}
