//! Light that media scatter twice and more, by the ways to read a volume map along a ray: marched in balls, from points about the
//! ray, from beams across it, and from planes beside beams.

use crate::{Round, WIDTH, squared_errors, timed};
use anyhow::Result;
use std::io::Write;
use turbid::estimators::{Estimator, Gather};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::{Layer, March};
use turbid::math::Positive;
use turbid::photons::maps::{Amount, Indirect, MapSettings, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{Film, Method, Streams};
use turbid::transport::NoProgress;

/// Independent maps of each way.
const ROUNDS: usize = 8;
/// Photons, or flights, stored in each, and samples a pixel.
const POINTS: u64 = 65_000;
const BEAMS: u64 = 5_000;
const SAMPLES: u64 = 1;
/// Radii of a gather within which steps of a march share one.
const SPACING: f64 = 1.5;
/// Radii about rays [mean free paths are 2].
const RADII: [f64; 3] = [0.1, 0.2, 0.3];
/// Paths of the reference: samples a pixel of each of its rounds.
const REFERENCE: (usize, u64) = (8, 512);

/// A way to read the map.
struct Way {
    name: String,
    stored: u64,
    settings: Settings,
    rounds: Vec<Round>,
    /// Photons or beams that all rays together looked at, mean of the rounds.
    looked_at: f64,
}

/// The marches first, then rays, then beams.
fn ways() -> Result<Vec<Way>> {
    let standard = Settings::for_size(2.0, 100)?;
    // One random place a ray, in proportion to what reaches the eye from it: unbiased, whatever the step.
    let march = March { step: Positive::new("the step", 4.0)?, adaptive: None, ..standard.march };
    let mut ways = Vec::new();
    let mut add = |name: String, stored, volume: Estimator, march: March, spacing: f64| {
        let settings = Settings { volume, march, spacing, ..standard };
        ways.push(Way { name, stored, settings, rounds: Vec::new(), looked_at: 0.0 });
    };
    for k in [30, 100] {
        let volume = Estimator { gather: Gather::nearest(k, 1.0)?, ..standard.volume };
        add(format!("march, k = {k}"), POINTS, volume, standard.march, 0.0);
        add(format!("march, one place, k = {k}"), POINTS, volume, march, 0.0);
    }
    for k in [100, 150] {
        let volume = Estimator { gather: Gather::nearest(k, 1.0)?, ..standard.volume };
        add(format!("march, shared, k = {k}"), POINTS, volume, standard.march, SPACING);
    }
    for radius in RADII {
        let of_rays = standard.volume.along_rays(Positive::new("the radius", radius)?);
        add(format!("points about rays, r = {radius}"), POINTS, of_rays, march, 0.0);
    }
    // The best march and the best radius with twice the photons.
    let twice = Estimator { gather: Gather::nearest(200, 1.0)?, ..standard.volume };
    add("march, k = 200, twice".into(), 2 * POINTS, twice, standard.march, 0.0);
    let of_rays = standard.volume.along_rays(Positive::new("the radius", 0.2)?);
    add("points, r = 0.2, twice".into(), 2 * POINTS, of_rays, march, 0.0);
    for radius in RADII {
        let of_beams = standard.volume.along_beams(Positive::new("the radius", radius)?);
        add(format!("beams, r = {radius}"), BEAMS, of_beams, march, 0.0);
    }
    let of_beams = standard.volume.along_beams(Positive::new("the radius", 0.1)?);
    add("planes, beams r = 0.1".into(), BEAMS, of_beams.in_planes(), march, 0.0);
    Ok(ways)
}

/// The layer alone, of a picture.
fn layer(film: &Film) -> Vec<f64> {
    let mean = |pixel: &turbid::sensor::Pixel| pixel.mean_of(Some(Layer::Multiple)).0.to_array();
    film.pixels().iter().flat_map(mean).collect()
}

/// One map, its picture of the layer, and the time of both without that of a picture that reads no volume map; beside it how many
/// photons were looked at.
fn round(scene: &Scene, camera: &Camera, way: &Way, replicate: u64) -> Result<(Round, f64)> {
    let settings = &way.settings;
    let filling = MapSettings {
        global: Amount::Emitted(1),
        caustic: Amount::Emitted(1),
        volume: Amount::Stored(way.stored),
        media: settings.media(),
        indirect: Indirect::Seen,
        seed: 1,
        replicate,
    };
    let streams = Streams { seed: 1, replicate };
    let (mut without, mut looked_at) = (None, 0);
    let mut pixels = Vec::new();
    let with = timed(|| {
        let mut maps = fill(scene, &filling, &NoProgress)?;
        let photons = Method::Photons(Mapper::new(scene, &maps, settings));
        let mut film = Film::new(camera.width(), camera.height());
        let found = photons.extend(&mut film, camera, SAMPLES, streams, &NoProgress)?.volume;
        looked_at = found.found + found.planes;
        pixels = layer(&film);
        (maps.volume, maps.beams, maps.planes) = (None, None, None);
        let start = cpu_time::ThreadTime::now();
        let nothing = Method::Photons(Mapper::new(scene, &maps, settings));
        nothing.render(camera, SAMPLES, streams, &NoProgress)?;
        without = Some(start.elapsed().as_secs_f64());
        Ok(film)
    })?;
    Ok((Round { pixels, seconds: with.seconds - 2.0 * without.unwrap_or(0.0) }, looked_at as f64))
}

/// Prints the efficiency of each way, and over that of the best march.
pub fn compare(out: &mut impl Write, scene: &Scene, camera: &Camera) -> Result<()> {
    let (count, samples) = REFERENCE;
    let paths: Vec<Round> = (0..count as u64)
        .map(|replicate| {
            let film =
                Method::Paths(scene).render(camera, samples, Streams { seed: 2, replicate }, &NoProgress)?;
            Ok(Round { pixels: layer(&film), seconds: 0.0 })
        })
        .collect::<Result<_>>()?;
    let size = WIDTH * WIDTH * 3;
    let truth: Vec<f64> =
        (0..size).map(|i| paths.iter().map(|r| r.pixels[i]).sum::<f64>() / count as f64).collect();
    let mean = truth.iter().sum::<f64>() / size as f64;
    let error_of_truth = squared_errors(&paths).iter().sum::<f64>() / (count * count) as f64;
    writeln!(
        out,
        "\nLight scattered twice and more in media, {POINTS} photons, twice as many, or {BEAMS} flights a map and how many a ray looks at, {ROUNDS} maps; errors in % of the mean, \
         reference +- {:.2} %",
        100.0 * error_of_truth.sqrt() / mean
    )?;
    writeln!(
        out,
        "{:26} {:>8} {:>8} {:>8} {:>8} {:>12} {:>24}",
        "", "s", "a ray", "error", "bias", "1/(MSE s)", "times the best march"
    )?;
    let mut ways = ways()?;
    // In turn.
    for replicate in 0..ROUNDS as u64 {
        for way in &mut ways {
            let (round, looked_at) = round(scene, camera, way, replicate)?;
            way.rounds.push(round);
            way.looked_at += looked_at / ROUNDS as f64;
        }
    }
    let off = |round: &Round| {
        let squares = round.pixels.iter().zip(&truth).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>() / size as f64 - error_of_truth
    };
    let errors: Vec<Vec<f64>> = ways.iter().map(|way| way.rounds.iter().map(off).collect()).collect();
    let average = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / ROUNDS as f64;
    let efficiency = |way: usize, chosen: &[usize]| {
        let error = average(&mut chosen.iter().map(|&i| errors[way][i]));
        1.0 / (error * average(&mut chosen.iter().map(|&i| ways[way].rounds[i].seconds)))
    };
    let is_march = |way: &usize| ways[*way].name.starts_with("march");
    let all: Vec<usize> = (0..ROUNDS).collect();
    let marches = (0..ways.len()).filter(is_march);
    let best =
        marches.max_by(|a, b| efficiency(*a, &all).total_cmp(&efficiency(*b, &all))).unwrap_or_default();
    let mut stream = Stream::new(1, Purpose::Resampling, 2, 0);
    let draws: Vec<Vec<usize>> =
        (0..1000).map(|_| (0..ROUNDS).map(|_| stream.index(ROUNDS)).collect()).collect();
    for (which, way) in ways.iter().enumerate() {
        let error = average(&mut errors[which].iter().copied());
        let between = average(&mut squared_errors(&way.rounds).into_iter());
        let percent = |square: f64| 100.0 * square.max(0.0).sqrt() / mean;
        let mut ratios: Vec<f64> =
            draws.iter().map(|chosen| efficiency(which, chosen) / efficiency(best, chosen)).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        writeln!(
            out,
            "{:26} {:8.3} {:8.0} {:8.2} {:8.2} {:12.1} {:9.2} ({:5.2} to {:5.2})",
            way.name,
            average(&mut way.rounds.iter().map(|round| round.seconds)),
            way.looked_at / (WIDTH * WIDTH) as f64,
            percent(error),
            percent(error - between),
            efficiency(which, &all),
            efficiency(which, &all) / efficiency(best, &all),
            ratios[25],
            ratios[974]
        )?;
    }
    Ok(())
}
