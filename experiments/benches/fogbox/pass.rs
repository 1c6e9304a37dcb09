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
use std::io::Write;
use turbid::photons::{Emitter, Histories, Photon, Run, Storage};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Scene, SceneParts};
use turbid::transport::NoProgress;

/// Histories of turbid's passes.
const HISTORIES: u64 = 400_000;
/// Particles of the peer, a pixel.
const PARTICLES: u64 = 16;
/// Names of the peer's scenes, and their bounces a particle.
const CLEAR: [(&str, f64); 2] = [("clear-5", 5.0), ("clear-17", 17.0)];

/// Every photon, in media and on surfaces.
struct Everything;

impl Storage for Everything {
    fn in_medium(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }

    fn on_surface(&self, _history: u64, _photon: &Photon) -> bool {
        true
    }
}

/// Photons a second that a pass stores [1/s], on one thread, by processor time.
fn rate(scene: &Scene, replicate: u64) -> Result<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("no thread")?;
    pool.install(|| {
        let emitter = Emitter::by_power(scene);
        let histories = Histories { count: HISTORIES, seed: 1, replicate, max_order: None };
        let start = ThreadTime::now();
        let pass = Run::new(scene, &emitter, histories).pass(&Everything, &NoProgress)?;
        let stored = pass.photons().count() + pass.surfaces.iter().map(|part| part.len()).sum::<usize>();
        Ok(stored as f64 / start.elapsed().as_secs_f64())
    })
}

/// Prints a row for each of them: the median over rounds, and the ratio to the first peer with the 95 % interval of its median.
pub fn compare(out: &mut impl Write, rounds: u64) -> Result<()> {
    let fog = scenes::load("iso")?;
    let clear = Scene::new(SceneParts {
        objects: fog.objects().to_vec(),
        lights: fog.lights().to_vec(),
        ..SceneParts::default()
    })?;
    let folder = scenes::folder().join("fogbox");
    let mut peers = Vec::new();
    for variant in VARIANTS {
        match Peer::start(variant, &folder, CLEAR[0].0) {
            Ok(mut peer) => {
                // What is compiled at the first picture of a scene is compiled before the rounds.
                peer.render(CLEAR[1].0, 1, 0)?;
                peers.push((format!("Mitsuba {variant}, bounces"), peer));
            }
            Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
        }
    }
    let mut rates: Vec<(String, Vec<f64>)> =
        peers.iter().map(|(name, _)| (name.clone(), Vec::new())).collect();
    rates.push(("turbid, stored".into(), Vec::new()));
    rates.push(("turbid in fog, stored".into(), Vec::new()));
    for round in 0..rounds {
        let (of_peers, ours) = rates.split_at_mut(peers.len());
        for ((_, peer), (_, rates)) in peers.iter_mut().zip(of_peers) {
            let [(few, few_bounces), (many, many_bounces)] = CLEAR;
            let short = peer.render(few, PARTICLES, round + 1)?.seconds;
            let long = peer.render(many, PARTICLES, round + 1)?.seconds;
            let bounces = (many_bounces - few_bounces) * (PARTICLES as usize * WIDTH * WIDTH) as f64;
            rates.push(bounces / (long - short));
        }
        ours[0].1.push(rate(&clear, round)?);
        ours[1].1.push(rate(&fog, round)?);
    }
    writeln!(out, "10^6 a second, medians of {rounds} rounds; times the first, 95 % of resampled rounds")?;
    let first = rates[0].1.clone();
    let mut stream = Stream::new(1, Purpose::Resampling, 0, 0);
    for (name, rates) in &rates {
        let mut ratios: Vec<f64> = (0..2000)
            .map(|_| {
                let chosen: Vec<usize> = rates.iter().map(|_| stream.index(rates.len())).collect();
                let of = |rates: &[f64]| median(chosen.iter().map(|index| rates[*index]).collect());
                of(rates) / of(&first)
            })
            .collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let middle = median(rates.clone());
        writeln!(
            out,
            "{name:32} {:7.2} {:7.2} ({:5.2} to {:5.2})",
            1e-6 * middle,
            middle / median(first.clone()),
            ratios[49],
            ratios[1949]
        )?;
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
