//! `--guide`: where photons come from, for paths to be led there.

use super::progress::Bar;
use super::shared::note;
use anyhow::Context;
use turbid::photons::{DirectionSettings, Directions};
use turbid::scene::Scene;
use turbid::sensor::Streams;

/// Learns from the photons of so many histories.
pub fn learn(
    scene: &Scene,
    histories: u64,
    Streams { seed, replicate }: Streams,
) -> anyhow::Result<Directions> {
    let settings = DirectionSettings { histories, seed, replicate, share: None };
    let bar = Bar::stage("directions", histories);
    let learned = Directions::learn(scene, &settings, &bar);
    bar.finish();
    let learned = learned.context("--guide")?;
    if replicate == 0 && learned.counts().iter().all(|[_, used]| *used == 0) {
        note(
            "--guide changes nothing: its photons know no place where another choice of directions would gain a fifth",
        )?;
    }
    Ok(learned)
}
