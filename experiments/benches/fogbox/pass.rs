//! The photon pass beside Mitsuba's particle tracer, which knows no media: on one thread each, in turn, in the box without fog.
//!
//! turbid's row counts photons stored on surfaces, and times whole passes, emission included. The peer's counts bounces, each of which it
//! connects to the camera where turbid stores: 12 more of them a particle, over the time that these take, so that its emission is left
//! out. It is asked for no roulette, and its lamp reflects, so that no particle ends. Another row of turbid is the box with its fog, in
//! media and on surfaces.

use crate::peer::Peer;
use crate::{VARIANTS, WIDTH, scenes};
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use paired::Ratio;
use std::io::Write;
use turbid::photons::{Emitter, Everything, Histories, Run};
use turbid::scene::{Scene, SceneParts};
use turbid::transport::NoProgress;

/// Histories of turbid's passes.
const HISTORIES: u64 = 400_000;
/// Particles of the peer, a pixel.
const PARTICLES: u64 = 16;
/// Names of the peer's scenes, and their bounces a particle.
const CLEAR: [(&str, f64); 2] = [("clear-5", 5.0), ("clear-17", 17.0)];

/// Processor time of a pass over the photons that it stores \[s\], on one thread.
fn stored(scene: &Scene, replicate: u64) -> Result<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("no thread")?;
    pool.install(|| {
        let emitter = Emitter::by_power(scene);
        let histories = Histories { count: HISTORIES, seed: 1, replicate, max_order: None };
        let start = ThreadTime::now();
        let pass = Run::new(scene, &emitter, histories).pass(&Everything, &NoProgress)?;
        let stored = pass.photons().count() + pass.surfaces.iter().map(|part| part.len()).sum::<usize>();
        Ok(start.elapsed().as_secs_f64() / stored as f64)
    })
}

/// Processor time of one of the peer's bounces \[s\].
fn bounced(peer: &mut Peer, seed: u64) -> Result<f64> {
    let [(few, few_bounces), (many, many_bounces)] = CLEAR;
    let short = peer.render(few, PARTICLES, seed)?.seconds;
    let long = peer.render(many, PARTICLES, seed)?.seconds;
    Ok((long - short) / ((many_bounces - few_bounces) * (PARTICLES as usize * WIDTH * WIDTH) as f64))
}

/// Prints a row for each of them: a second's number by the median over rounds, and its ratio to the first.
pub fn compare(out: &mut impl Write, rounds: u64) -> Result<()> {
    let fog = scenes::load("iso")?;
    let clear = Scene::new(SceneParts {
        objects: fog.objects().to_vec(),
        lights: fog.lights().to_vec(),
        ..SceneParts::default()
    })?;
    let folder = scenes::folder().join("fogbox");
    let (mut names, mut peers) = (Vec::new(), Vec::new());
    for variant in VARIANTS {
        match Peer::start(variant, &folder, CLEAR[0].0) {
            Ok(mut peer) => {
                // What is compiled at the first picture of a scene is compiled before the rounds.
                peer.render(CLEAR[1].0, 1, 0)?;
                peers.push(peer);
                names.push(format!("Mitsuba {variant}, bounces"));
            }
            Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
        }
    }
    names.extend(["turbid, stored".into(), "turbid in fog, stored".into()]);
    let mut times: Vec<Vec<f64>> = Vec::new();
    for round in 0..rounds {
        let mut seconds = Vec::new();
        for peer in &mut peers {
            seconds.push(bounced(peer, round + 1)?);
        }
        seconds.extend([stored(&clear, round)?, stored(&fog, round)?]);
        times.push(seconds);
    }
    writeln!(out, "10^6 a second, medians of {rounds} rounds; times the first, 95 % of resampled rounds")?;
    for (row, name) in names.iter().enumerate() {
        let pairs: Vec<[f64; 2]> = times.iter().map(|seconds| [seconds[0], seconds[row]]).collect();
        let Ratio { ratio, interval: [low, high], seconds } = Ratio::of(&pairs);
        writeln!(out, "{name:32} {:7.2} {ratio:7.2} ({low:5.2} to {high:5.2})", 1e-6 / seconds[1])?;
    }
    Ok(())
}
