//! The path tracer on a box of fog, beside Mitsuba 3's volumetric path tracer, in turn, in one run on one thread each.
//!
//! `cargo bench -p turbid-experiments --bench fogbox -- iso` runs the fogs whose name contains a word.
//!
//! Efficiency is 1/(mean squared error x processor seconds), with the error over pixels and channels of one round,
//! measured by the spread of independent rounds; that the rounds' means are right is tested beside it, on the mean
//! radiance of the picture, against converged values of an independent renderer.
//!
//! The peer renders the same scene if there is a Python that knows it: `python3 -m venv VENV &&
//! VENV/bin/pip install mitsuba numpy`, then `TURBID_PYTHON=VENV/bin/python` before the command. Its just-in-time
//! compiled variant runs too if `DRJIT_LIBLLVM_PATH` names an LLVM library that works with it.

mod fogbox_peer;

use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use fogbox_peer::Peer;
use std::io::Write;
use std::path::PathBuf;
use turbid::math::Ray;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Scene, SceneFile};

/// Width and height of the picture in pixels.
pub const WIDTH: usize = 128;
const ROUNDS: usize = 15;
/// Samples a pixel and round: about a second of either renderer.
const SAMPLES: u64 = 16;
/// Mean radiance over pixels and channels by a converged independent renderer, and its standard error.
const FOGS: [(&str, f64); 2] = [("iso", 0.16394), ("hg", 0.16228)];
const CONVERGED_ERROR: f64 = 1e-4;

/// A picture of 128 x 128 x 3 radiances, and the processor seconds it took.
pub struct Round {
    /// Rows from the top, pixels from the left, channels.
    pub pixels: Vec<f64>,
    /// Processor time \[s\].
    pub seconds: f64,
}

fn main() -> Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let mut out = std::io::stdout().lock();
    let mut peers = Vec::new();
    for variant in ["scalar_rgb", "llvm_ad_rgb"] {
        match Peer::start(variant, &folder().join("fogbox")) {
            Ok(peer) => peers.push((variant, peer)),
            Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
        }
    }
    writeln!(out, "{WIDTH} x {WIDTH} pixels, {SAMPLES} samples a pixel and round, {ROUNDS} rounds in turn")?;
    writeln!(
        out,
        "{:4} {:20} {:>8} {:>12} {:>22} {:>7}",
        "fog", "", "s", "1/(MSE s)", "times the first peer", "mean z"
    )?;
    for (fog, converged) in FOGS {
        if !wanted.is_empty() && !wanted.iter().any(|word| fog.contains(word)) {
            continue;
        }
        let scene = load(fog)?;
        let mut rounds: Vec<(String, Vec<Round>)> = Vec::new();
        for (variant, _) in &peers {
            rounds.push((format!("Mitsuba {variant}"), Vec::new()));
        }
        rounds.push(("turbid paths".into(), Vec::new()));
        for (_, peer) in &mut peers {
            peer.render(fog, 1, 0)?;
        }
        for round in 0..ROUNDS {
            for ((_, peer), (_, rounds)) in peers.iter_mut().zip(&mut rounds) {
                rounds.push(peer.render(fog, SAMPLES, round as u64 + 1)?);
            }
            if let Some((_, ours)) = rounds.last_mut() {
                ours.push(by_paths(&scene, round as u64));
            }
        }
        for (name, ours) in &rounds {
            let first = rounds.first().map_or(ours, |(_, first)| first);
            line(&mut out, fog, name, ours, first, converged)?;
        }
    }
    Ok(())
}

/// Where scenes are.
fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes"))
}

fn load(fog: &str) -> Result<Scene> {
    let path = folder().join(format!("fogbox-{fog}.toml"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let file: SceneFile = toml::from_str(&text).with_context(|| path.display().to_string())?;
    Ok(file.scene(&folder())?)
}

/// One round of the path tracer.
fn by_paths(scene: &Scene, round: u64) -> Round {
    let start = ThreadTime::now();
    let mut pixels = Vec::with_capacity(WIDTH * WIDTH * 3);
    for pixel in 0..(WIDTH * WIDTH) as u64 {
        let (x, y) = ((pixel % WIDTH as u64) as f64, (pixel / WIDTH as u64) as f64);
        let mut sum = turbid::Spectrum::ZERO;
        for sample in 0..SAMPLES {
            let mut stream = Stream::new(1, Purpose::Paths, round, pixel * SAMPLES + sample);
            let jitter = stream.pair();
            let ray = camera(x + jitter[0], y + jitter[1]);
            turbid::integrators::radiance(
                scene,
                ray,
                None,
                turbid::scene::SURROUNDINGS,
                Orders::ALL,
                &mut stream,
                |_, value| {
                    sum += value;
                },
            );
        }
        pixels.extend((sum / SAMPLES as f64).0.to_array());
    }
    Round { pixels, seconds: start.elapsed().as_secs_f64() }
}

/// The ray through a point of the picture in pixels: from (0, 0, 0.95) towards -z, 80 degrees wide.
fn camera(x: f64, y: f64) -> Ray {
    let half = libm::tan(40.0_f64.to_radians());
    let on_screen = |pixel: f64| (2.0 * pixel / WIDTH as f64 - 1.0) * half;
    let dir = glam::DVec3::new(on_screen(x), -on_screen(y), -1.0);
    Ray::new(glam::DVec3::new(0.0, 0.0, 0.95), dir.normalize())
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
        "{fog:4} {name:20} {seconds:8.3} {ours:12.1} {ratio:7.2} ({:5.2} to {:5.2}) {z:7.2}",
        ratios[49], ratios[1949]
    )?;
    Ok(())
}
