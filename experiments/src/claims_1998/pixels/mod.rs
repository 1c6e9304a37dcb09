//! "50 to 100 photons an estimate work well": a small picture of a box of fog, its multiple scattering marched through a
//! volume map.
//!
//! The map alone is asked: light scattered once comes by shadow rays and surfaces have a map of their own. Errors are
//! fractions of the whole pixel, as an eye sees them.

pub mod conclude;
mod figure;
mod results;

use super::fogbox::{ALBEDO, SIGMA_T, VOLUME, grey, scene};
use super::maps::filled;
use super::part::STREAM;
use crate::harness::{CellId, CellOutput, Group, Settings, Unit};
use crate::prediction::Prediction;
use crate::theory::clustering;
use anyhow::Context;
use glam::{DVec2, DVec3};
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::{March, StepRule, along, path};
use turbid::math::{Interval, Positive, Ray, exp};
use turbid::photons::PhotonMap;
use turbid::photons::maps::Emitted;
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::stats::Moments;

/// The group of all cells.
pub const GROUP: &str = "pixels";
/// Numbers of neighbours.
pub const NEIGHBORS: [usize; 6] = [10, 20, 50, 100, 200, 500];
/// Pixels along a side of the picture.
pub const SIDE: usize = 5;
/// Step of the march \[L\]: a twentieth of a mean free path.
const STEP: f64 = 0.1;
/// Largest radius of a gather \[L\].
const CAP: f64 = 0.9;
/// Replicate of the pilot that predictions are made from.
const PILOT: u64 = u64::MAX;

/// Photons emitted into a map: some 65,000 are stored, as in the talk's picture.
pub fn photons(settings: &Settings) -> u64 {
    settings.photons(80_000, 80_000)
}

/// Paths of a pixel in one cell.
fn paths(settings: &Settings) -> u64 {
    settings.photons(768, 4_096)
}

/// All cells.
pub fn group(settings: &Settings) -> Group {
    let cost = 8.0 * photons(settings) as f64 + 5.0 * (paths(settings) * (SIDE * SIDE) as u64) as f64;
    Group::new(GROUP, settings.pick(64, 128), cost, measure)
}

/// The case of one pixel at one number of neighbours.
pub fn map_case(k: usize, pixel: usize) -> String {
    format!("fog box k={k} pixel {pixel}")
}

/// The case of one pixel by paths.
pub fn path_case(pixel: usize) -> String {
    format!("fog box paths pixel {pixel}")
}

/// The case of the whole picture.
pub fn case(k: usize) -> String {
    format!("fog box k={k}")
}

/// The rays through the middles of the pixels, with their ends on walls.
fn rays(scene: &Scene) -> anyhow::Result<Vec<(Ray, f64)>> {
    let side = SIDE as u32;
    let camera = scene.camera().context("the box has no camera")?.with_size(side, side)?;
    let middle = |i: usize| DVec2::new((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5);
    let ray = |i| {
        let ray = camera.ray(middle(i));
        let end = scene.hit(&ray, None).context("the box is open")?.hit.t;
        Ok((ray, end))
    };
    (0..SIDE * SIDE).map(ray).collect()
}

fn volume_map(scene: &Scene, emitted: u64, seed: u64, replicate: u64) -> anyhow::Result<PhotonMap> {
    let emitted = Emitted { volume: emitted, ..Emitted::default() };
    filled(scene, emitted, None, seed, replicate)?.volume.context("the box has no fog")
}

/// Multiple scattering and the whole radiance along a ray, by paths.
fn by_paths(scene: &Scene, ray: Ray, count: u64, mut stream: impl FnMut(u64) -> Stream) -> [f64; 2] {
    let (mut multiple, mut total) = (Moments::new(), Moments::new());
    for i in 0..count {
        let layers = path::layers(scene, ray, None, scene.interior_at(ray.origin), &mut stream(i)).0;
        multiple.push(grey(layers.multiple));
        total.push(grey(layers.total()));
    }
    [multiple.mean(), total.mean()]
}

/// Measures one cell: a map, and paths.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let (scene, replicate) = (scene()?, cell.stream(STREAM));
    let mut output = CellOutput::new();
    let emitted = photons(settings);
    let map = output.time("shooting", |_| volume_map(&scene, emitted, settings.seed, replicate))?;
    output.count("photons emitted", emitted);
    output.count("photons stored", map.stored() as u64);
    let region = scene.regions().first().context("the box has no fog")?;
    let (phase, albedo) = (region.medium.phase(), Spectrum::grey(ALBEDO));
    let boundary = Boundary::of(&region.shape)?;
    let equal = March::equal(Positive::new("the step", STEP)?, StepRule::Integrated);
    let rays = rays(&scene)?;
    for k in NEIGHBORS {
        let estimator = Estimator::new(Kernel::Uniform, Gather::nearest(k, CAP)?).treated(Treatment::Clipped);
        let mut found = 0;
        output.time(&format!("gathering k={k}"), |output| {
            for (pixel, (ray, end)) in rays.iter().enumerate() {
                let span = Interval { start: 0.0, end: *end };
                let source = |place: DVec3| {
                    let estimate =
                        estimator.in_scattered(&map, place, -ray.dir, phase, Spectrum::ONE, &boundary);
                    found += estimate.found as u64;
                    albedo * estimate.value
                };
                // Nothing is drawn.
                let mut stream = Stream::new(settings.seed, Purpose::Synthetic, 0, 0);
                let radiance = along(&region.medium, (ray, span), &equal, 1.0, &mut stream, source);
                output.push(map_case(k, pixel), "multiple", grey(radiance));
            }
        });
        output.count("photons gathered", found);
    }
    let count = paths(settings);
    output.time("paths", |output| {
        for (pixel, (ray, _)) in rays.iter().enumerate() {
            let own = |i| Stream::new(settings.seed, Purpose::Paths, replicate, pixel as u64 * count + i);
            let [multiple, total] = by_paths(&scene, *ray, count, own);
            output.push(path_case(pixel), "multiple", multiple);
            output.push(path_case(pixel), "radiance", total);
        }
    });
    output.count("paths", count * rays.len() as u64);
    Ok(output)
}

/// Predicted noise of the marched pixels, root mean square over the picture [% of the pixel], as though the light were
/// the same everywhere in the box.
///
/// An estimate of k photons has the relative variance (1 + eta)/k, eta the other photons of a history in its ball. Balls
/// of radius r whose middles are d apart share the part 1 - 3 d/(4 r) + d³/(16 r³) of their photons: the sum over the
/// steps has the variance sum_ij w_i w_j share(d_ij), and the longer the ray in radii, the less. A pilot map and a few
/// paths say how many photons there are to a volume and which part of each pixel is scattered more than once.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let scene = scene()?;
    let pilot = photons(settings).min(4_000);
    let stored = volume_map(&scene, pilot, settings.seed, PILOT)?.stored() as f64;
    let density = stored / pilot as f64 * photons(settings) as f64 / VOLUME;
    let mut shares = Vec::new();
    for (pixel, (ray, end)) in rays(&scene)?.into_iter().enumerate() {
        let own = |i| Stream::new(settings.seed, Purpose::Paths, PILOT, 1000 * pixel as u64 + i);
        let [multiple, total] = by_paths(&scene, ray, 200, own);
        shares.push((multiple / total, end));
    }
    let mut predictions = Vec::new();
    for k in NEIGHBORS {
        let radius = libm::cbrt(3.0 * k as f64 / (4.0 * std::f64::consts::PI * density)).min(CAP);
        let one = (1.0 + clustering(ALBEDO, 0.0, SIGMA_T * radius)) / k as f64;
        let square = |&(share, end): &(f64, f64)| share * share * one * shared(end, radius);
        let mean = shares.iter().map(square).sum::<f64>() / shares.len() as f64;
        // The bound is what 200 paths a pixel leave open.
        let value = (mean.sqrt(), 0.1 * mean.sqrt());
        let source = "overlap of the balls along a ray in even light, after a pilot";
        predictions.push(Prediction::new(case(k), "noise", Unit::FRACTION, value, source));
    }
    Ok(predictions)
}

/// Variance of a weighted mean over the balls of one ray, over that of one.
fn shared(end: f64, radius: f64) -> f64 {
    let count = (end / STEP).ceil() as usize;
    let place = |i: usize| (i as f64 + 0.5) * end / count as f64;
    let weight = |i: usize| exp(-SIGMA_T * place(i));
    let mut sum = 0.0;
    for i in 0..count {
        for j in 0..count {
            let d = ((place(i) - place(j)) / radius).abs().min(2.0);
            sum += weight(i) * weight(j) * (1.0 - 0.75 * d + d * d * d / 16.0);
        }
    }
    let all: f64 = (0..count).map(weight).sum();
    sum / (all * all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wide balls are one ball; narrow ones share nothing but with their neighbours, so that a long ray of even weights has
    /// 3/2 radii over its length.
    #[test]
    fn balls_share_photons_by_their_overlap() {
        assert!((shared(1.0, 1e6) - 1.0).abs() < 1e-5);
        let (end, radius) = (2.0, 0.25);
        let even = 1.5 * radius / end;
        // Weights e^(-t/2) raise it by L/2 coth(L/2) / ..., here (1 - e^-2)/2 / (1 - e^-1)^2 x 1 = 1.082.
        let uneven = 0.5 * (1.0 - exp(-2.0)) / ((1.0 - exp(-1.0)) * (1.0 - exp(-1.0)));
        // The ends of the ray cut the overlaps of their balls: a part of r/L.
        assert!((shared(end, radius) / (even * uneven) - 1.0).abs() < 0.5 * radius / end + 0.02);
    }
}
