//! The path tracer on a box of fog, and on scenes that are no boxes, beside Mitsuba 3's volumetric path tracer, in turn, in one run on one
//! thread each.
//!
//! `cargo bench -p turbid-benches --bench fogbox -- iso` runs the scenes whose name contains a word; a number among the
//! words is that of the rounds.
//!
//! Efficiency is 1/(mean squared error x processor seconds), over pixels and channels. Of path tracers the error is the
//! spread of independent rounds; that their means are right is tested beside it, on the mean radiance of the picture,
//! against converged values of an independent renderer, outside of the box against the first row. Of the photon mapper
//! (`-- maps`) it is the error against the mean of all path-traced rounds, split into the spread between maps and the rest, its bias. `-- lines` reads the volume map in
//! balls along each ray, about it and by beams; `-- guided` leads paths to where photons came from, in scenes of the gallery too (a name
//! beside it: that one alone); `-- pass` is the photon pass.
//!
//! The peer renders the same scene if there is a Python that knows it: `python3 -m venv VENV &&
//! VENV/bin/pip install mitsuba numpy`, then `TURBID_PYTHON=VENV/bin/python` before the command. Its just-in-time
//! compiled variant runs too if `DRJIT_LIBLLVM_PATH` names an LLVM library that works with it.

mod guided;
mod lines;
mod maps;
mod others;
mod pass;
mod peer;
mod scenes;

use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use peer::Peer;
use std::io::Write;
use std::path::Path;
use turbid::exchange::to_mitsuba;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Film, Method, Streams};
use turbid::stats::Moments;
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

/// The variants of Mitsuba.
pub const VARIANTS: [&str; 2] = ["scalar_rgb", "llvm_ad_rgb"];

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
    if wanted.iter().any(|word| word == "pass") {
        return pass::compare(&mut std::io::stdout().lock(), rounds_wanted);
    }
    if wanted.iter().any(|word| word == "lines") {
        return lines::compare(&mut std::io::stdout().lock(), &scenes::load("iso")?, &scenes::camera()?);
    }
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word));
    let mut out = std::io::stdout().lock();
    if wanted.iter().any(|word| word == "guided") {
        let names: Vec<&String> = wanted.iter().filter(|word| *word != "guided").collect();
        let is_named = |name: &str| names.is_empty() || names.iter().any(|word| name == *word);
        head(&mut out, guided::NAMES)?;
        return guided::compare(&mut out, &is_named, rounds_wanted);
    }
    writeln!(
        out,
        "{WIDTH} x {WIDTH} pixels, {SAMPLES} samples per pixel and round, {rounds_wanted} rounds in turn"
    )?;
    head(&mut out, 5)?;
    for (fog, converged) in FOGS {
        let has_maps = fog == "iso" && is_wanted("maps");
        if !is_wanted(fog) && !has_maps {
            continue;
        }
        let (scene, camera) = (scenes::load(fog)?, scenes::camera()?);
        let folder = scenes::folder().join("fogbox");
        let rounds = in_turn(&mut out, fog, &folder, (&scene, &camera), rounds_wanted)?;
        lines_of(&mut out, fog, &rounds, Some((converged, CONVERGED_ERROR)))?;
        if has_maps {
            maps::compare(&mut out, &scene, &camera, &rounds)?;
        }
    }
    for name in others::OTHERS.into_iter().filter(|name| is_wanted(name)) {
        let (scene, peers) = others::load(name)?;
        let camera = scene.camera().context("no camera")?;
        let folder = tempfile::tempdir()?;
        let exported = to_mitsuba(&peers, name)?;
        std::fs::write(folder.path().join(format!("{name}.xml")), &exported.text)?;
        for file in &exported.files {
            std::fs::write(folder.path().join(&file.name), &file.bytes)?;
        }
        let rounds = in_turn(&mut out, name, folder.path(), (&scene, camera), rounds_wanted)?;
        lines_of(&mut out, name, &rounds, None)?;
    }
    Ok(())
}

/// The names of the columns, the first of this width.
fn head(out: &mut impl Write, width: usize) -> Result<()> {
    Ok(writeln!(
        out,
        "{:width$} {:20} {:>8} {:>12} {:>22} {:>9} {:>7}",
        "", "", "s", "1/(MSE s)", "times the first", "mean", "z"
    )?)
}

/// Rounds of the peer's variants that render the scene of this name in a folder, and of the path tracer, in turn.
fn in_turn(
    out: &mut impl Write,
    name: &str,
    folder: &Path,
    (scene, camera): (&Scene, &Camera),
    count: u64,
) -> Result<Vec<(String, Vec<Round>)>> {
    let (mut peers, mut rounds) = (Vec::new(), Vec::new());
    for variant in VARIANTS {
        match Peer::start(variant, folder, name) {
            Ok(peer) => {
                peers.push(peer);
                rounds.push((format!("Mitsuba {variant}"), Vec::new()));
            }
            Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
        }
    }
    let mut ours = Vec::new();
    for round in 0..count {
        for (peer, (_, rounds)) in peers.iter_mut().zip(&mut rounds) {
            rounds.push(peer.render(name, SAMPLES, round + 1)?);
        }
        ours.push(by_paths(scene, camera, round)?);
    }
    rounds.push(("turbid paths".into(), ours));
    Ok(rounds)
}

/// The rows of a scene; means are compared with a known value and its standard error, or with the first row's.
fn lines_of(
    out: &mut impl Write,
    name: &str,
    rounds: &[(String, Vec<Round>)],
    known: Option<(f64, f64)>,
) -> Result<()> {
    let (_, first) = &rounds[0];
    let known = known.unwrap_or_else(|| mean_of(first));
    rounds.iter().try_for_each(|(row, ours)| line(out, (name, row), ours, first, known))
}

/// Mean radiance of the pictures of all rounds, and its standard error.
fn mean_of(rounds: &[Round]) -> (f64, f64) {
    let means: Moments =
        rounds.iter().map(|r| r.pixels.iter().sum::<f64>() / r.pixels.len() as f64).collect();
    (means.mean(), means.std_error())
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
    (scene, name): (&str, &str),
    rounds: &[Round],
    first: &[Round],
    (known, known_error): (f64, f64),
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
    let (mean, mean_error) = mean_of(rounds);
    let z = (mean - known) / (mean_error * mean_error + known_error * known_error).sqrt();
    let seconds = rounds.iter().map(|r| r.seconds).sum::<f64>() / count as f64;
    let ratio = ours / efficiency(&errors_of_first, first, &all);
    writeln!(
        out,
        "{scene:5} {name:20} {seconds:8.3} {ours:12.1} {ratio:7.2} ({:5.2} to {:5.2}) {mean:9.5} {z:7.2}",
        ratios[49], ratios[1949]
    )?;
    Ok(())
}
