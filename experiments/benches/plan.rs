//! What a scene does not require costs nothing: the plan of a scene against everything forced on, in turn, in one run on
//! one thread, by paths and by photons: maps filled and a picture made.
//!
//! `cargo bench -p turbid-benches --bench plan`

use anyhow::{Context, Result};
use paired::compare;
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::scene::{Scene, SceneFile};
use turbid::sensor::{Method, Streams};
use turbid::transport::NoProgress;

/// Pairs of rounds.
const PAIRS: usize = 30;
/// Width and height of the pictures in pixels.
const WIDTH: u32 = 48;

fn main() -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "time of the full plan over that of the scene's own, {PAIRS} pairs in turn")?;
    writeln!(out, "{:32} {:>9} {:>9} {:>8}", "", "full, s", "own, s", "ratio")?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (name, scene) in scenes()? {
        let full = scene.with_full_plan()?;
        for (how, picture) in [("paths", by_paths as fn(&Scene)), ("photons", by_photons)] {
            // The one thread of the pool is timed, from inside.
            let ratio = pool.install(|| compare(PAIRS, || picture(&full), || picture(&scene)));
            let [low, high] = ratio.interval;
            writeln!(
                out,
                "{:32} {:9.4} {:9.4} {:8.2} ({low:.2} to {high:.2})",
                format!("{name}, {how}"),
                ratio.seconds[0],
                ratio.seconds[1],
                ratio.ratio
            )?;
        }
    }
    Ok(())
}

/// The box of fog, and the same box in clear air.
fn scenes() -> Result<[(&'static str, Scene); 2]> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes"));
    let path = folder.join("fogbox-iso.toml");
    let load = |text: &str| -> Result<Scene> {
        let file: SceneFile = toml::from_str(text).with_context(|| path.display().to_string())?;
        Ok(file.scene(&folder)?)
    };
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let mut table: toml::Table = toml::from_str(&text)?;
    table.remove("regions");
    Ok([("homogeneous fog", load(&text)?), ("clear air", load(&toml::to_string(&table)?)?)])
}

const STREAMS: Streams = Streams { seed: 1, replicate: 0 };

fn by_paths(scene: &Scene) {
    let Some(camera) = scene.camera().and_then(|camera| camera.with_size(WIDTH, WIDTH).ok()) else { return };
    let _ = black_box(Method::Paths(scene).render(&camera, 8, STREAMS, &NoProgress));
}

fn by_photons(scene: &Scene) {
    let Some(camera) = scene.camera().and_then(|camera| camera.with_size(WIDTH, WIDTH).ok()) else { return };
    let amount = Amount::Emitted(20_000);
    let of_maps = MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect: Indirect::Seen,
        seed: 1,
        replicate: 0,
    };
    let made = fill(scene, &of_maps, &NoProgress)
        .and_then(|maps| Ok((maps, Settings::for_size(2.0, 50)?)))
        .and_then(|(maps, settings)| {
            let photons = Method::Photons(Mapper::new(scene, &maps, &settings));
            photons.render(&camera, 1, STREAMS, &NoProgress)
        });
    let _ = black_box(made);
}
