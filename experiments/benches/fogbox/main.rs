//! The path tracer on a box of fog, beside Mitsuba 3's volumetric path tracer, in turn, in one run on one thread each.
//!
//! `cargo bench -p turbid-benches --bench fogbox -- iso` runs the fogs whose name contains a word; a number among the
//! words is that of the rounds.
//!
//! Efficiency is 1/(mean squared error x processor seconds), over pixels and channels. Of path tracers the error is the
//! spread of independent rounds; that their means are right is tested beside it, on the mean radiance of the picture,
//! against converged values of an independent renderer. Of the photon mapper (`-- maps`) it is the error against the mean
//! of all path-traced rounds, split into the spread between maps and the rest, its bias. `-- lines` reads the volume map in
//! balls along each ray, about it and by beams.
//!
//! The peer renders the same scene if there is a Python that knows it: `python3 -m venv VENV &&
//! VENV/bin/pip install mitsuba numpy`, then `TURBID_PYTHON=VENV/bin/python` before the command. Its just-in-time
//! compiled variant runs too if `DRJIT_LIBLLVM_PATH` names an LLVM library that works with it.

mod lines;
mod maps;
mod peer;
mod scenes;

use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use peer::Peer;
use std::io::Write;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Film, Method, Streams};
use turbid::transport::NoProgress;

/// Width and height of the picture in pixels.
pub const WIDTH: usize = 128;
/// Rounds, if no number says otherwise.
const ROUNDS: usize = 15;
/// Samples a pixel and round: about a second of either renderer.
pub const SAMPLES: u64 = 16;
/// Mean radiance over pixels and channels by a converged independent renderer, and its standard error.
const FOGS: [(&str, f64); 3] = [("iso", 0.16394), ("hg", 0.16228), ("het", 0.16909)];
const CONVERGED_ERROR: f64 = 1e-4;

/// A picture of 128 x 128 x 3 radiances, and the processor seconds it took.
pub struct Round {
    /// Rows from the top, pixels from the left, channels.
    pub pixels: Vec<f64>,
    /// Processor time \[s\].
    pub seconds: f64,
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let (numbers, wanted): (Vec<_>, Vec<_>) = words.into_iter().partition(|word| word.parse::<u64>().is_ok());
    let rounds_wanted = numbers.first().and_then(|n| n.parse().ok()).unwrap_or(ROUNDS as u64).max(2);
    if wanted.iter().any(|word| word == "lines") {
        return lines::compare(&mut std::io::stdout().lock(), &scenes::load("iso")?, &scenes::camera()?);
    }
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word));
    let mut out = std::io::stdout().lock();
    let mut peers = Vec::new();
    for variant in ["scalar_rgb", "llvm_ad_rgb"] {
        match Peer::start(variant, &scenes::folder().join("fogbox")) {
            Ok(peer) => peers.push((variant, peer)),
            Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
        }
    }
    writeln!(
        out,
        "{WIDTH} x {WIDTH} pixels, {SAMPLES} samples per pixel and round, {rounds_wanted} rounds in turn"
    )?;
    writeln!(
        out,
        "{:4} {:20} {:>8} {:>12} {:>22} {:>9} {:>7}",
        "fog", "", "s", "1/(MSE s)", "times the first", "mean", "z"
    )?;
    for (fog, converged) in FOGS {
        let has_maps = fog == "iso" && is_wanted("maps");
        if !is_wanted(fog) && !has_maps {
            continue;
        }
        let scene = scenes::load(fog)?;
        let camera = scenes::camera()?;
        let mut rounds: Vec<(String, Vec<Round>)> =
            peers.iter().map(|(variant, _)| (format!("Mitsuba {variant}"), Vec::new())).collect();
        rounds.push(("turbid paths".into(), Vec::new()));
        for (_, peer) in &mut peers {
            peer.render(fog, 1, 0)?;
        }
        for round in 0..rounds_wanted {
            for ((_, peer), (_, rounds)) in peers.iter_mut().zip(&mut rounds) {
                rounds.push(peer.render(fog, SAMPLES, round + 1)?);
            }
            if let Some((_, ours)) = rounds.last_mut() {
                ours.push(by_paths(&scene, &camera, round)?);
            }
        }
        for (name, ours) in &rounds {
            let first = rounds.first().map_or(ours, |(_, first)| first);
            line(&mut out, fog, name, ours, first, converged)?;
        }
        if has_maps {
            maps::compare(&mut out, &scene, &camera, &rounds)?;
        }
    }
    Ok(())
}

/// One round of the path tracer.
fn by_paths(scene: &Scene, camera: &Camera, replicate: u64) -> Result<Round> {
    timed(|| Ok(Method::Paths(scene).render(camera, SAMPLES, Streams { seed: 1, replicate }, &NoProgress)?))
}

/// A picture and its time, on one thread.
fn timed(work: impl FnOnce() -> Result<Film> + Send) -> Result<Round> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("no thread")?;
    pool.install(|| {
        let start = ThreadTime::now();
        let film = work()?;
        let seconds = start.elapsed().as_secs_f64();
        let pixels = film.pixels().iter().flat_map(|pixel| pixel.total().0.to_array()).collect();
        Ok(Round { pixels, seconds })
    })
}

/// Squared error of a round [radiance^2], by its spread about the mean of all rounds.
fn squared_errors(rounds: &[Round]) -> Vec<f64> {
    let (count, pixels) = (rounds.len() as f64, rounds[0].pixels.len());
    let mean: Vec<f64> =
        (0..pixels).map(|i| rounds.iter().map(|r| r.pixels[i]).sum::<f64>() / count).collect();
    let spread = |round: &Round| {
        round.pixels.iter().zip(&mean).map(|(value, mean)| (value - mean) * (value - mean)).sum::<f64>()
    };
    rounds.iter().map(|round| spread(round) / pixels as f64 * count / (count - 1.0)).collect()
}

/// 1/(mean squared error x mean seconds) of the rounds of these indices.
fn efficiency(errors: &[f64], rounds: &[Round], chosen: &[usize]) -> f64 {
    let error: f64 = chosen.iter().map(|&i| errors[i]).sum();
    let seconds: f64 = chosen.iter().map(|&i| rounds[i].seconds).sum();
    (chosen.len() * chosen.len()) as f64 / (error * seconds)
}

fn line(
    out: &mut impl Write,
    fog: &str,
    name: &str,
    rounds: &[Round],
    first: &[Round],
    converged: f64,
) -> Result<()> {
    let count = rounds.len();
    let (errors, errors_of_first) = (squared_errors(rounds), squared_errors(first));
    let all: Vec<usize> = (0..count).collect();
    let ours = efficiency(&errors, rounds, &all);
    let mut stream = Stream::new(1, Purpose::Resampling, 0, 0);
    let mut ratios: Vec<f64> = (0..2000)
        .map(|_| {
            let chosen: Vec<usize> = (0..count).map(|_| stream.index(count)).collect();
            efficiency(&errors, rounds, &chosen) / efficiency(&errors_of_first, first, &chosen)
        })
        .collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let means: Vec<f64> =
        rounds.iter().map(|r| r.pixels.iter().sum::<f64>() / r.pixels.len() as f64).collect();
    let mean = means.iter().sum::<f64>() / count as f64;
    let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (count - 1) as f64;
    let z = (mean - converged) / (variance / count as f64 + CONVERGED_ERROR * CONVERGED_ERROR).sqrt();
    let seconds = rounds.iter().map(|r| r.seconds).sum::<f64>() / count as f64;
    let ratio = ours / efficiency(&errors_of_first, first, &all);
    writeln!(
        out,
        "{fog:4} {name:20} {seconds:8.3} {ours:12.1} {ratio:7.2} ({:5.2} to {:5.2}) {mean:9.5} {z:7.2}",
        ratios[49], ratios[1949]
    )?;
    Ok(())
}
