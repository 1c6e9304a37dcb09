//! `turbid advise`: how many photons, which radius, how many samples.

use super::advice_row::AdviceRow;
use super::advise_picture::Wanted;
use super::load::Source;
use super::memory::{Memory, rounded_down};
use super::options;
use super::picture::Frame;
use super::progress::Bar;
use super::shared::{FormatName, note, on_threads, parse_count, whole};
use anyhow::Context;
use clap::{ArgMatches, ValueEnum};
use std::time::Instant;
use turbid::output::{Format, print, write_aligned, write_csv, write_json};
use turbid::photons::PeakBytes;
use turbid::scene::{Quantity, Scene};
use turbid::sensor::{Advice, PathAdvice, Pilot, PilotSettings, path_advice};

/// Say how many photons reach a wanted error, of a picture or of fluence probes, and the time that it takes.
///
/// Of a picture (a scene with a camera): pilots look at a lattice of its pixels, 32 across, with eight independent maps of two sizes and
/// several k, and at the same pixels by paths. The squared error of each layer is fitted as blur, which grows with k over
/// photons, noise of the map, which falls with the photons, and noise of the samples. Printed are the photons, k and samples that bring the
/// root mean square error of the pixels, over the picture's mean, to the target in the least time; the error of each layer;
/// and the command line. The interval is of one picture, 95 per cent. `turbid render --compare paths` measures what was predicted.
///
/// Of fluence probes: small pilot maps measure two laws about each fluence probe: the bias, which grows as the square of the radius where
/// the field bends, by comparing balls of several radii; and the noise, which falls with the photons in the ball, by
/// its spread over maps. Printed are the radius and the number of photons that bring the root mean square relative
/// error over all probes, and the channels that they have light in, to the target with the fewest photons, for the plain estimate with
/// the uniform kernel; k is what such a ball holds. Low and high are the ends of a 95 per cent interval. Seconds are this machine's.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct Advise {
    #[command(flatten)]
    source: Source,
    /// What is to reach the target [default: the picture, if the scene has a camera and no fluence probe].
    #[arg(long = "for", id = "for", value_enum)]
    subject: Option<Subject>,
    /// Wanted root mean square relative error over the fluence probes, or over the pixels of the picture, such as 1% or 0.01.
    #[arg(long, value_parser = parse_target, allow_hyphen_values = true)]
    target: f64,
    /// Photons emitted into all pilot maps together.
    #[arg(long, value_parser = parse_count, default_value = "2000000")]
    pilot: u64,
    /// Paths a probe that tell what the path tracer needs.
    #[arg(long, value_parser = parse_count, default_value = "20000")]
    samples: u64,
    #[command(flatten)]
    frame: Frame,
    /// Rays of a final gathering at each surface that is seen, as of `render`.
    #[arg(long, default_value_t = 64, value_parser = whole::<u32>(0..=1_000_000))]
    gather_rays: u32,
    /// Seed: the same seed gives the same pilots, on any number of threads, and the same advice for probes; what is advised for a
    /// picture follows measured times too.
    #[arg(long, value_parser = whole::<u64>(0..=u64::MAX), allow_hyphen_values = true, default_value_t = 1)]
    seed: u64,
    /// Threads [default: all cores].
    #[arg(long, value_parser = whole::<u16>(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    memory: Memory,
    /// Form of the output.
    #[arg(long, value_enum, default_value = "table")]
    format: FormatName,
}

/// What is to reach a target.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Subject {
    /// The picture that the camera sees.
    Picture,
    /// The fluence probes.
    Probes,
}

/// Pilot maps: enough for the variance of each ball to be known to a tenth at a single probe.
const MAPS: u64 = 256;

/// A relative error on the command line.
fn parse_target(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    match number.trim().parse::<f64>().map(|x| x * unit) {
        Ok(x) if x > 0.0 && x <= 1.0 => Ok(x),
        _ => Err("allowed: a relative error above 0, up to 100%, such as 1% or 0.01".to_string()),
    }
}

impl Advise {
    /// Advises and prints.
    pub fn run(self, given: &ArgMatches) -> anyhow::Result<()> {
        let scene = self.source.load(&[])?;
        let has_probe = scene.sensors().iter().any(|sensor| matches!(sensor.quantity, Quantity::Fluence(_)));
        let is_picture = scene.camera().is_some() && !has_probe;
        let subject = self.subject.unwrap_or(if is_picture { Subject::Picture } else { Subject::Probes });
        let (name, is_picture) = match subject {
            Subject::Picture => ("--for picture", true),
            Subject::Probes => ("--for probes", false),
        };
        options::check(given, options::ADVISE, &[name])?;
        let mut command = None;
        let (rows, notes) = if is_picture {
            let Advise { source, frame, target, gather_rays, seed, .. } = &self;
            let wanted = Wanted { source, frame, target: *target, gather_rays: *gather_rays, seed: *seed };
            let (rows, line) = on_threads(self.threads, || wanted.answer(&scene))?;
            command = Some(line);
            (rows, Vec::new())
        } else {
            on_threads(self.threads, || self.advise(&scene))?
        };
        print(|out| match self.format.format() {
            Format::Text => write_aligned(out, &lines(&rows), 1),
            Format::Csv => write_csv(out, &rows),
            Format::Json => write_json(out, &rows),
        })
        .context("standard output")?;
        match (command, self.format) {
            (Some(line), FormatName::Table) => {
                print(|out| writeln!(out, "{line}")).context("standard output")?
            }
            (Some(line), _) => note(&line)?,
            (None, _) => (),
        }
        for text in notes {
            note(&text)?;
        }
        Ok(())
    }

    fn advise(&self, scene: &Scene) -> anyhow::Result<(Vec<AdviceRow>, Vec<String>)> {
        let settings = PilotSettings { photons: self.pilot.div_ceil(MAPS), maps: MAPS, seed: self.seed };
        let forecast = Pilot::forecast(scene, &settings)?;
        self.memory.check(
            &format!("a pilot map of {:.2e} photons", forecast.stored),
            forecast.bytes,
            0.0,
            |part| {
                format!(
                    "--pilot {}",
                    rounded_down(self.pilot as f64 * PeakBytes::of_maps(MAPS).part_in(part, forecast.stored))
                )
            },
        )?;
        let bar = Bar::new(settings.photons.saturating_mul(MAPS));
        let pilot = Pilot::run(scene, &settings, &bar);
        bar.finish();
        let pilot = pilot?;
        let advice = pilot.advise(self.target)?;
        let mut rows = photon_rows(&pilot, &advice);
        let mut notes = photon_notes(&pilot, &advice);

        let probes = scene.sensors().len() as u64;
        let bar = Bar::new(self.samples.saturating_mul(probes));
        let start = Instant::now();
        let paths = path_advice(scene, self.samples, self.seed, self.target, &bar);
        let path_seconds = start.elapsed().as_secs_f64() / self.samples as f64;
        bar.finish();
        match paths {
            Ok(PathAdvice { samples, is_heavy_tailed }) => {
                let row = |quantity: &str, unit, value| AdviceRow {
                    quantity: quantity.into(),
                    unit,
                    value,
                    low: None,
                    high: None,
                };
                rows.push(row("path tracer: paths a probe", "1", samples.ceil()));
                rows.push(row("path tracer: time", "s", samples * path_seconds));
                if is_heavy_tailed {
                    notes.push(
                        "the path tracer's variance is heavy-tailed here: its number of paths is a lower bound"
                            .to_string(),
                    );
                }
            }
            Err(turbid::Error::Unreachable(why)) => notes.push(why),
            Err(other) => return Err(other.into()),
        }
        Ok((rows, notes))
    }
}

fn photon_rows(pilot: &Pilot, advice: &Advice) -> Vec<AdviceRow> {
    let plain = |quantity: &str, unit, value| AdviceRow {
        quantity: quantity.into(),
        unit,
        value,
        low: None,
        high: None,
    };
    let [least, median, most] = advice.gathered;
    vec![
        plain("radius", "L", advice.radius),
        plain("photons to emit", "1", advice.photons as f64),
        AdviceRow {
            low: Some(least),
            high: Some(most),
            ..plain("photons a ball holds (k): median, least, most", "1", median)
        },
        AdviceRow {
            low: Some(100.0 * advice.interval.low),
            high: Some(100.0 * advice.interval.high),
            ..plain("predicted error", "%", 100.0 * advice.error)
        },
        plain("its bias", "%", 100.0 * advice.bias),
        plain("its noise", "%", 100.0 * advice.noise),
        plain(
            "photon map: shooting and building, at the pilot's rate",
            "s",
            pilot.preparation_seconds * advice.photons as f64,
        ),
        plain("photon map: an estimate, at the pilot's rate", "us", 1e6 * pilot.estimate_seconds(median)),
    ]
}

fn photon_notes(pilot: &Pilot, advice: &Advice) -> Vec<String> {
    let mut notes = Vec::new();
    if !pilot.on_boundary.is_empty() {
        notes.push(format!(
            "left out: {}, on the boundary of the medium or the edge of a beam, where the plain estimate reads the \
             mean of both sides at any radius",
            pilot.on_boundary.join(", ")
        ));
    }
    if let Some(probe) = &advice.limited_by {
        notes.push(format!(
            "the radius goes to the boundary or the beam's edge next to {probe}: without that probe, or with a treatment \
             of the boundary, fewer photons would do"
        ));
    }
    notes
}

fn lines(rows: &[AdviceRow]) -> Vec<[String; 5]> {
    let number = |x: f64| {
        if x >= 1000.0 || x == 0.0 { format!("{x:.0}") } else { format!("{x:.3}") }
    };
    let mut lines = vec![["quantity", "unit", "value", "low", "high"].map(str::to_string)];
    for row in rows {
        let end = |x: Option<f64>| x.map_or_else(String::new, number);
        let (quantity, unit) = (row.quantity.clone(), row.unit.to_string());
        lines.push([quantity, unit, number(row.value), end(row.low), end(row.high)]);
    }
    lines
}
