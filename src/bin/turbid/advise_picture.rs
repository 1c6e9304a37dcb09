//! `turbid advise` for a picture: photons, k and samples by pilots against paths, and the command line that takes them.

use super::advice_row::AdviceRow;
use super::load::Source;
use super::picture::{Frame, Readout};
use super::progress::Bar;
use anyhow::bail;
use clap::Parser;
use turbid::integrators::mapper::Settings;
use turbid::scene::{Camera, Scene};
use turbid::sensor::{PictureAdvice, PicturePilot, PicturePilotSettings};

/// Photons of the larger pilot maps: half of what `render` stores.
const PHOTONS: [u64; 3] = [100_000, 25_000, 32_500];
/// Pilot maps, samples of each, samples of the reference, pixels across.
const MAPS: u64 = 8;
const SAMPLES: u64 = 4;
const REFERENCE: u64 = 256;
const ACROSS: u32 = 32;
/// Part of the squared target above which the march's error is halved away, and how often at most.
const MARCH: f64 = 0.25;
const HALVINGS: usize = 2;

/// The readout as `render` takes it, by its own defaults.
#[derive(Parser)]
struct Read {
    #[command(flatten)]
    readout: Readout,
}

/// The readout with these rays of a final gathering and this step.
fn read(scene: &Scene, gather_rays: u32, step: Option<f64>) -> anyhow::Result<(Readout, Settings)> {
    let mut words = vec!["turbid".to_string(), format!("--gather-rays={gather_rays}")];
    words.extend(step.map(|step| format!("--step={step}")));
    let readout = Read::try_parse_from(words)?.readout;
    let settings = readout.settings(scene, 1)?;
    Ok((readout, settings))
}

/// What is asked.
pub struct Wanted<'a> {
    /// Where the scene comes from, and in which size it is seen.
    pub source: &'a Source,
    pub frame: &'a Frame,
    pub target: f64,
    pub gather_rays: u32,
    pub seed: u64,
}

impl Wanted<'_> {
    /// The rows of the answer, and the command line.
    pub fn answer(&self, scene: &Scene) -> anyhow::Result<(Vec<AdviceRow>, String)> {
        let camera = self.frame.camera(scene)?;
        if scene.periodic_cell().is_some() {
            bail!(
                "pictures of a scene with `cell` are made by paths: there is nothing to advise; allowed: --for probes"
            );
        }
        let (mut step, mut pilot) = (None, self.pilot(scene, &camera, None)?);
        let usual = read(scene, self.gather_rays, None)?.1.march.step.get();
        for halving in 1..=HALVINGS {
            let error = pilot.march_error();
            if !scene.plan().has_media || error < MARCH * self.target * self.target {
                break;
            }
            let shorter = usual / f64::from(1 << halving);
            let other = self.pilot(scene, &camera, Some(shorter))?;
            // What a shorter step does not lower is no error of the step.
            if other.march_error() > 0.7 * error {
                break;
            }
            (step, pilot) = (Some(shorter), other);
        }
        let advice = pilot.advise(self.target)?;
        Ok((self.rows(&advice), self.command(&advice, step)))
    }

    fn pilot(&self, scene: &Scene, camera: &Camera, step: Option<f64>) -> anyhow::Result<PicturePilot> {
        let (readout, settings) = read(scene, self.gather_rays, step)?;
        let pilot = PicturePilotSettings {
            photons: PHOTONS,
            maps: MAPS,
            samples: SAMPLES,
            reference: REFERENCE,
            across: ACROSS,
            indirect: readout.indirect(),
            seed: self.seed,
        };
        let bar = Bar::stage("reference", 1);
        let pilot = PicturePilot::run(scene, camera, &pilot, &settings, &bar);
        bar.finish();
        Ok(pilot?)
    }

    fn rows(&self, advice: &PictureAdvice) -> Vec<AdviceRow> {
        let row = |quantity: String, unit, value| AdviceRow { quantity, unit, value, low: None, high: None };
        let mut rows = Vec::new();
        for (map, name) in ["global", "caustic", "volume"].into_iter().enumerate() {
            if let Some(photons) = advice.photons[map] {
                rows.push(row(format!("{name} map: photons to store"), "1", photons as f64));
                rows.push(row(format!("{name} map: photons of an estimate (k)"), "1", advice.k[map] as f64));
            }
        }
        rows.push(row("samples a pixel".into(), "1", advice.samples as f64));
        rows.push(AdviceRow {
            low: Some(100.0 * advice.interval.low),
            high: Some(100.0 * advice.interval.high),
            ..row("predicted RMSE of pixels, of the picture's mean".into(), "%", 100.0 * advice.error)
        });
        for (layer, error) in &advice.layers {
            rows.push(row(
                format!("the same of layer {}, of its own mean", layer.name()),
                "%",
                100.0 * error,
            ));
        }
        rows.push(row("time of the maps, at the pilot's rate".into(), "s", advice.map_seconds));
        rows.push(row("time of the pixels, at the pilot's rate".into(), "s", advice.pixel_seconds));
        rows
    }

    fn command(&self, advice: &PictureAdvice, step: Option<f64>) -> String {
        let mut words = vec!["turbid render".to_string(), self.source.words(), "-o picture.exr".to_string()];
        words.extend(self.frame.words());
        for (map, (name, k)) in
            [("global", "k"), ("caustic", "caustic-k"), ("volume", "volume-k")].into_iter().enumerate()
        {
            if let Some(photons) = advice.photons[map] {
                words.push(format!("--{name} {photons} --{k} {}", advice.k[map]));
            }
        }
        words.push(format!("--samples {} --gather-rays {}", advice.samples, self.gather_rays));
        words.extend(step.map(|step| format!("--step {step}")));
        words.join(" ")
    }
}
