//! Paths led by photons beside paths that are not: what learning is worth, its own time included. In the boxes of fog Mitsuba is beside
//! them.

use crate::peer::Peer;
use crate::{Round, VARIANTS, WIDTH, lines_of, scenes, timed};
use anyhow::{Context, Result};
use std::io::Write;
use turbid::photons::{Guide, GuideSettings};
use turbid::scene::{Camera, Scene, SceneFile};
use turbid::sensor::{Film, Method, Streams};
use turbid::transport::NoProgress;

/// Histories that are learned from.
const HISTORIES: u64 = 200_000;
/// Samples a pixel and round.
const SAMPLES: u64 = 64;
/// Width of the column of scenes.
pub const NAMES: usize = 11;
/// The boxes of fog.
const BOXES: [&str; 3] = ["iso", "hg", "het"];
/// They, and scenes of the gallery.
const SCENES: [&str; 9] =
    [BOXES[0], BOXES[1], BOXES[2], "cornell-fog", "cloud", "dusty-room", "cognac", "pool", "sunbeams"];

fn load(name: &str) -> Result<(Scene, Camera)> {
    if BOXES.contains(&name) {
        return Ok((scenes::load(name)?, scenes::camera()?));
    }
    let path = scenes::folder().join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let scene = SceneFile::from_toml(&text)?.scene(&scenes::folder())?;
    let camera = scene.camera().context("no camera")?;
    let height = WIDTH as u64 * u64::from(camera.height()) / u64::from(camera.width());
    let camera = camera.sized(Some(WIDTH as u32), Some(height as u32))?;
    Ok((scene, camera))
}

/// Prints two rows a scene, in turn, and what learning took and led.
pub fn compare(out: &mut impl Write, wanted: &dyn Fn(&str) -> bool, count: u64) -> Result<()> {
    writeln!(out, "{SAMPLES} samples a pixel, led by {HISTORIES} histories")?;
    for name in SCENES.into_iter().filter(|name| wanted(name)) {
        let (scene, camera) = load(name)?;
        let (mut paths, mut guided) = (Vec::<Round>::new(), Vec::<Round>::new());
        let (mut learning, mut led, mut flights) = (0.0, [[0; 2]; 2], 0.0);
        let mut peers: Vec<(String, Peer, Vec<Round>)> = Vec::new();
        for variant in VARIANTS.into_iter().filter(|_| BOXES.contains(&name)) {
            match Peer::start(variant, &scenes::folder().join("fogbox"), name) {
                Ok(peer) => peers.push((format!("Mitsuba {variant}"), peer, Vec::new())),
                Err(why) => writeln!(out, "Mitsuba {variant} is not beside it: {why:#}.")?,
            }
        }
        for replicate in 0..count {
            for (_, peer, rounds) in &mut peers {
                rounds.push(peer.render(name, SAMPLES, replicate + 1)?);
            }
            let streams = Streams { seed: 1, replicate };
            let picture = |method: Method<'_>, streams: Streams| -> Result<Film> {
                Ok(method.render(&camera, SAMPLES, streams, &NoProgress)?)
            };
            paths.push(timed(|| picture(Method::Paths(&scene), streams))?);
            let mut spent = None;
            guided.push(timed(|| {
                let start = cpu_time::ThreadTime::now();
                let settings = GuideSettings { histories: HISTORIES, seed: 1, replicate, share: None };
                let guide = Guide::learn(&scene, &settings, &NoProgress)?;
                led = guide.counts();
                flights = guide.brightness().map_or(0.0, |brightness| brightness.share);
                spent = Some(start.elapsed().as_secs_f64());
                picture(Method::Guided(&scene, &guide), Streams { seed: 2, ..streams })
            })?);
            learning += spent.unwrap_or_default() / count as f64;
        }
        let mut rows = vec![("paths".into(), paths), ("guided paths".into(), guided)];
        rows.extend(peers.into_iter().map(|(name, _, rounds)| (name, rounds)));
        lines_of(out, &format!("{name:NAMES$}"), &rows, None)?;
        let [[media, in_media], [surfaces, on_surfaces]] = led;
        writeln!(
            out,
            "{:NAMES$} learning takes {learning:.2} s; led in {in_media} of {media} cells in media, {on_surfaces} of {surfaces} on surfaces, a share of {flights} of flights",
            ""
        )?;
    }
    Ok(())
}
