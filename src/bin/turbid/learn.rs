//! `--guide`: where photons come from, for paths to be led there.

use super::progress::Bar;
use super::shared::note;
use anyhow::Context;
use turbid::photons::{Guide, GuideSettings};
use turbid::scene::Scene;
use turbid::sensor::Streams;

/// Learns from the photons of so many histories.
pub fn learn(scene: &Scene, histories: u64, Streams { seed, replicate }: Streams) -> anyhow::Result<Guide> {
    let settings = GuideSettings { histories, seed, replicate, share: None };
    let bar = Bar::stage("guide", histories);
    let learned = Guide::learn(scene, &settings, &bar);
    bar.finish();
    let learned = learned.context("--guide")?;
    if replicate == 0 && !learned.is_used() {
        note(
            "--guide changes nothing: by its photons no other choice of directions or distances gains enough",
        )?;
    }
    Ok(learned)
}
