//! What a picture took: times, rays, photons, memory.

use super::made::{Filled, Made, MapsMade, Stage, peak_memory};
use super::shared::print;
use std::fmt::Write;
use std::time::Duration;
use turbid::integrators::mapper::Gathers;
use turbid::photons::Ends;
use turbid::photons::maps::{MapReport, MediumSamples};

/// The stage that fills the maps: emission and building the trees.
pub const MAPS: &str = "maps";

/// The stage that learns where light comes from.
pub const LEARNING: &str = "guide";

/// Prints what a picture took.
pub fn print_statistics(made: &Made, exposure: f64) -> anyhow::Result<()> {
    let mut text = String::new();
    let pixels = made.film.pixels().len() as u64;
    let (least, most) = (made.samples.iter().min().unwrap_or(&0), made.samples.iter().max().unwrap_or(&0));
    let taken = if least == most { format!("{least}") } else { format!("{least} to {most}") };
    writeln!(text, "pixels         {} x {}", made.film.width(), made.film.height())?;
    writeln!(text, "samples        {taken} a pixel, {} repetitions", made.repetitions)?;
    writeln!(text, "exposure       {exposure} stops")?;
    for MapsMade { number, report, filled, settings } in &made.maps {
        let names = ["global", "caustic", "volume"];
        let nearest = settings.map_or([None; 3], |settings| settings.nearest());
        let of_volume = settings.map(|settings| settings.volume);
        let is_along_rays = of_volume.is_some_and(|volume| volume.reads_rays());
        let samples = settings.map_or(MediumSamples::Points, |settings| settings.media());
        for ((name, filled), k) in names.into_iter().zip(filled).zip(nearest) {
            if let Some(Filled { stored, emitted }) = filled {
                let is_volume = name == "volume";
                let k = k.filter(|_| !(is_volume && is_along_rays));
                let taken = k.map_or(String::new(), |k| format!(", the {k} nearest an estimate"));
                let line = match samples {
                    MediumSamples::Planes(None) if is_volume => {
                        format!("{stored} planes stored of {emitted} photons emitted")
                    }
                    MediumSamples::Planes(_) if is_volume => {
                        format!("{stored} planes and beams stored of {emitted} photons emitted")
                    }
                    MediumSamples::Beams(_) if is_volume => {
                        format!("{stored} beams stored of {emitted} photons emitted")
                    }
                    _ => format!("{stored} photons stored of {emitted} emitted{taken}"),
                };
                writeln!(text, "map {number:<3} {name:<8} {line}")?;
            }
        }
        for (name, pass) in [("first", &report.main), ("caustic", &report.caustic)] {
            if pass.emitted > 0 {
                let (Ends { absorbed, escaped, truncated, refused }, sent) = (pass.ends, pass.emitted);
                write!(
                    text,
                    "map {number:<3} {name} pass of {sent}: {absorbed} absorbed, {escaped} escaped, {truncated} truncated"
                )?;
                if refused > 0 {
                    write!(text, ", {refused} where a medium emits less than elsewhere or nothing")?;
                }
                if absorbed + escaped + truncated + refused > sent {
                    write!(text, "; what importance split counts by its parts")?;
                }
                writeln!(text)?;
            }
        }
        if report.aimed < 1.0 {
            writeln!(
                text,
                "map {number:<3} first pass aimed at the {:.3} % of the power that could meet anything",
                100.0 * report.aimed
            )?;
        }
        writeln!(text, "map {number:<3} memory   {:.1} MB", report.bytes as f64 / 1e6)?;
    }
    let work = &made.work;
    let total = made.total_samples.saturating_mul(pixels);
    if made.is_by_light {
        writeln!(text, "histories      {total} photons, {} flights", work.rays.segments)?;
        writeln!(text, "connections    {} to the camera", work.rays.shadow)?;
    } else {
        writeln!(
            text,
            "rays           {}, {} of them of final gatherings",
            work.rays.segments, work.gathering
        )?;
        writeln!(text, "shadow rays    {}", work.rays.shadow)?;
    }
    if !made.maps.is_empty() {
        writeln!(text, "march steps    {}", work.steps)?;
        for (map, gathers) in [("global", &work.global), ("caustic", &work.caustic), ("volume", &work.volume)]
        {
            let read = made.first_read.filter(|read| map == "volume" && read.volume.reads_rays());
            writeln!(text, "gathers        {map:<8} {}", gathered(gathers, read.map(|read| read.media())))?;
        }
    }
    let mut tracking = work.work;
    let mut cells = 0;
    for MapsMade { report, .. } in &made.maps {
        tracking += report.main.work;
        tracking += report.caustic.work;
        cells += report.projection_cells;
    }
    writeln!(
        text,
        "tracking       {} majorants, {} densities, {} transmittances, {} flights by channel; {cells} projection cells",
        tracking.majorants, tracking.densities, tracking.transmittances, tracking.channel_flights
    )?;
    writeln!(text, "non-finite     0 of {total} samples")?;
    for Stage { name, clock, processor, memory } in &made.stages.0 {
        let (clock, processor) = (clock.as_secs_f64(), processor.as_secs_f64());
        let memory = memory.map_or(String::new(), |bytes| format!(", {:.1} MB at most", bytes as f64 / 1e6));
        writeln!(text, "time           {name:<8} {clock:.3} s, {processor:.3} s of processors{memory}")?;
        if *name == MAPS {
            let sum = |time: fn(&MapReport) -> Duration| {
                made.maps.iter().map(|made| time(&made.report)).sum::<Duration>().as_secs_f64()
            };
            writeln!(
                text,
                "time           of these: emission {:.3} s, build {:.3} s",
                sum(|report| report.main.time + report.caustic.time),
                sum(|report| report.build)
            )?;
        }
    }
    if let Some(bytes) = peak_memory() {
        writeln!(text, "memory         {:.1} MB at most", bytes as f64 / 1e6)?;
    }
    print(&text)
}

/// Look-ups; `along` how whole rays are read, if they are.
fn gathered(gathers: &Gathers, along: Option<MediumSamples>) -> String {
    if gathers.count == 0 {
        return "0".to_string();
    }
    let of_each = |number: u64| number as f64 / gathers.count as f64;
    let about =
        |what: &str| format!("{:.1} {what} within {:.2e} L", of_each(gathers.found), gathers.mean_radius());
    let crossed = || format!("{:.1} planes", of_each(gathers.planes));
    let found = match along {
        None | Some(MediumSamples::Points) => about("photons"),
        Some(MediumSamples::Beams(_)) => about("beams"),
        Some(MediumSamples::Planes(None)) => crossed(),
        Some(MediumSamples::Planes(Some(_))) => format!("{} and {}", about("beams"), crossed()),
    };
    let mut text = format!("{}, {found} in the mean", gathers.count);
    if along.is_none() {
        text.push_str(&format!("; {} found fewer than k", gathers.underfull));
    }
    if gathers.unknown > 0 {
        text.push_str(&format!(
            "; {} on bodies too thin for their area to be found, taken for dark",
            gathers.unknown
        ));
    }
    text
}
