//! "Photon maps are faster than Monte Carlo": down to which error?
//!
//! A small picture of the box of fog by maps of several sizes, photons and k grown together, seen directly, and by paths.
//! Of the picture's pixels one in sixteen is looked at, and costs are those of the whole picture.

pub mod conclude;
mod data;
mod figure;
mod results;

use super::fogbox::{self, grey};
use super::maps::filled;
use super::part::STREAM;
use crate::harness::{CellId, CellOutput, Group, Parameters, Settings};
use anyhow::Context;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::mapper::{self, Mapper};
use turbid::integrators::path;
use turbid::integrators::{Layers, March};
use turbid::math::{Positive, Ray};
use turbid::photons::maps::Emitted;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Camera, Scene};
use turbid::stats::Moments;

/// The group of all cells.
pub const GROUP: &str = "equal-error";
/// Pixels along a side of the picture.
pub const SIDE: u32 = 32;
/// Pixels along a side of the blocks of which one pixel is looked at.
const BLOCK: u32 = 4;
/// Pixels looked at.
pub const PIXELS: usize = ((SIDE / BLOCK) * (SIDE / BLOCK)) as usize;
/// Samples of a pixel from one map.
pub fn samples(settings: &Settings) -> u64 {
    settings.photons(24, 24).clamp(4, 24)
}

/// A size of map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Photons sent out.
    pub photons: u64,
    /// Photons an estimate.
    pub k: usize,
}

impl Size {
    /// With k ~ n^(4/7): noise 1/k and squared blur (k/n)^(4/3) fall together.
    fn new(photons: u64) -> Self {
        let k = 100.0 * libm::pow(photons as f64 / 80_000.0, 4.0 / 7.0);
        Size { photons, k: (k.round() as usize).max(4) }
    }

    /// What its maps are asked, as columns of the results.
    pub fn parameters(self) -> Parameters {
        Parameters { photons: Some(self.photons), k: Some(self.k), ..Parameters::default() }
    }

    /// The case of the whole picture.
    pub fn case(self) -> String {
        format!("fog box maps of {} photons", self.photons)
    }

    /// The case of one pixel.
    pub fn pixel(self, pixel: usize) -> String {
        format!("{} pixel {pixel}", self.case())
    }
}

/// The sizes of maps, the smallest first; the 80,000 photons of the talk's picture are between the two largest of the full
/// study, and twice as many as the quick one's.
pub fn sizes(settings: &Settings) -> Vec<Size> {
    let base: &[u64] = settings.pick(&[2_500, 10_000, 40_000], &[10_000, 40_000, 160_000, 640_000]);
    let mut sizes: Vec<Size> = base.iter().map(|&n| Size::new(settings.photons(n, n))).collect();
    sizes.dedup();
    sizes
}

/// Paths of a pixel in one cell.
fn paths(settings: &Settings) -> u64 {
    settings.photons(160, 1024).max(4)
}

/// The case of the picture by paths.
pub const PATHS: &str = "fog box picture by paths";

/// The case of a pixel by paths.
pub fn path_pixel(pixel: usize) -> String {
    format!("{PATHS} pixel {pixel}")
}

/// All cells.
pub fn group(settings: &Settings) -> Group {
    let photons: u64 = sizes(settings).iter().map(|size| size.photons).sum();
    let cost = 5.0 * photons as f64 + 10.0 * (paths(settings) * PIXELS as u64) as f64;
    Group::new(GROUP, 64, cost, measure).with_stream("race")
}

/// Column and row of a pixel that is looked at: places within blocks go round.
fn place(pixel: usize) -> (u32, u32) {
    let (pixel, row) = (pixel as u32, SIDE / BLOCK);
    let (i, j) = (pixel % row, pixel / row);
    (BLOCK * i + (i + 2 * j) % BLOCK, BLOCK * j + (2 * i + j) % BLOCK)
}

/// Measures one cell: all pixels by a map of each size in turn, and by paths.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let (scene, replicate) = (fogbox::scene()?, cell.stream(STREAM));
    let camera = scene.camera().context("the box has no camera")?.with_size(SIDE, SIDE)?;
    let mut output = CellOutput::new();
    for (index, size) in sizes(settings).into_iter().enumerate() {
        by_map(settings, &mut output, (&scene, &camera), (index, size), replicate)?;
    }
    let (count, interior) = (paths(settings), scene.interior_at(camera.position()));
    let mut rays = 0;
    let pixels = output.time("paths", |_| {
        look(&camera, settings.seed, replicate, count, |ray, stream| {
            let (layers, work) = path::layers(&scene, ray, None, interior, stream);
            rays += work.total();
            layers
        })
    });
    for (pixel, moments) in pixels.iter().enumerate() {
        output.push(path_pixel(pixel), "radiance", moments.mean());
    }
    let all = (count * PIXELS as u64) as f64;
    output.push(PATHS, "noise", mean_variance(&pixels));
    output.push(PATHS, "rays a sample", rays as f64 / all);
    output.push(PATHS, "samples", all);
    Ok(output)
}

/// So many samples of each pixel that is looked at.
fn look(
    camera: &Camera,
    seed: u64,
    replicate: u64,
    count: u64,
    mut see: impl FnMut(Ray, &mut Stream) -> Layers,
) -> Vec<Moments> {
    let pixel = |pixel: usize| {
        let mut moments = Moments::new();
        for i in 0..count {
            let mut stream = Stream::new(seed, Purpose::Paths, replicate, (pixel as u64) << 32 | i);
            let (x, y) = place(pixel);
            let ray = camera.sample(x, y, stream.pair());
            moments.push(grey(see(ray, &mut stream).total()));
        }
        moments
    };
    (0..PIXELS).map(pixel).collect()
}

fn mean_variance(pixels: &[Moments]) -> f64 {
    pixels.iter().map(Moments::variance).sum::<f64>() / pixels.len() as f64
}

/// The talk's eye: direct light by shadow rays, maps seen directly; light scattered into a ray is asked for at one random
/// place on it, in proportion to what reaches the eye from there.
fn eye(k: usize) -> anyhow::Result<mapper::Settings> {
    let nearest = Gather::nearest(k, 1.0)?;
    let standard = mapper::Settings::for_size(2.0, k)?;
    Ok(mapper::Settings {
        global: (Kernel::Uniform, nearest),
        volume: Estimator { gather: nearest, ..standard.volume },
        march: March { step: Positive::new("the step", 4.0)?, adaptive: None, ..standard.march },
        ..standard
    })
}

fn by_map(
    settings: &Settings,
    output: &mut CellOutput,
    (scene, camera): (&Scene, &Camera),
    (index, size): (usize, Size),
    replicate: u64,
) -> anyhow::Result<()> {
    let (seed, count) = (settings.seed, samples(settings));
    // No two sizes share their histories.
    let replicate = replicate ^ (index as u64 + 1) << 20;
    let emitted = Emitted { global: size.photons, volume: size.photons, caustic: 0 };
    let case = size.case();
    let maps = output.time(&format!("fill {case}"), |_| filled(scene, emitted, None, seed, replicate))?;
    let (settings, interior) = (eye(size.k)?, scene.interior_at(camera.position()));
    let eye = Mapper::new(scene, &maps, &settings);
    let mut report = mapper::Report::default();
    let pixels = output.time(&format!("look {case}"), |_| {
        look(camera, seed, replicate, count, |ray, stream| {
            let (layers, work) = eye.radiance(ray, None, interior, stream);
            report += work;
            layers
        })
    });
    for (pixel, moments) in pixels.iter().enumerate() {
        output.push(size.pixel(pixel), "radiance", moments.mean());
    }
    let all = (count * PIXELS as u64) as f64;
    let main = maps.report.main;
    let stored = [&maps.global, &maps.volume].into_iter().flatten().map(|map| map.stored()).sum::<usize>();
    output.push(&case, "noise", mean_variance(&pixels));
    output.push(&case, "samples", all);
    output.push(&case, "rays to fill", (main.collisions + main.hits) as f64);
    output.push(&case, "photons stored", stored as f64);
    output.push(&case, "rays a sample", report.rays.total() as f64 / all);
    output.push(&case, "photons a sample", (report.global.found + report.volume.found) as f64 / all);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pixel_of_each_block_and_all_places_within_them() {
        let (mut blocks, mut within) = (std::collections::BTreeSet::new(), [0; 16]);
        for pixel in 0..PIXELS {
            let (x, y) = place(pixel);
            assert!(x < SIDE && y < SIDE);
            blocks.insert((x / BLOCK, y / BLOCK));
            within[(x % BLOCK * BLOCK + y % BLOCK) as usize] += 1;
        }
        assert_eq!(blocks.len(), PIXELS);
        assert!(within.iter().filter(|&&n| n > 0).count() >= 8, "{within:?}");
    }
}
