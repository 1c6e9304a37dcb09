//! What maps are compared with: exact values, or batches of paths or of light tracing, which are the rival in time as well.

use super::file::{ReferenceBy, StudyFile};
use super::place::Place;
use super::points::Point;
use super::solved::{Solved, solve};
use super::words;
use crate::harness::{CellId, Settings};
use anyhow::{Context, ensure};
use turbid::scene::Orders;
use turbid::sensor::{FEWEST_PATHS, Measurement, PathSettings, Spread, TallySettings, by_paths, by_tallies};
use turbid::stats::HEAVY_TAIL;
use turbid::transport::NoProgress;

/// Batches of a sampled reference.
pub const BATCHES: u64 = 16;

/// Who samples a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampler {
    /// The path tracer, so many paths a place.
    Paths,
    /// Light tracing, so many photons in all.
    Light,
}

impl Sampler {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Sampler::Paths => "paths",
            Sampler::Light => "light tracing",
        }
    }
}

/// What one scene's maps are compared with.
pub struct Reference {
    /// The scene as a solved problem.
    pub solved: Option<Solved>,
    /// Exact value and bound of each place, where they are known.
    pub exact: Vec<Option<(f64, f64)>>,
    /// Who samples the others, and all of them as a rival.
    pub sampler: Sampler,
    /// Paths a place, or photons, of a batch.
    pub samples: u64,
    /// Whether the most that is allowed was not enough for the error that is asked for.
    pub is_cut: bool,
}

/// Paths of a pilot over all places, and fewest and most a place.
const PILOT: u64 = 1 << 18;
const PILOT_OF_PLACE: (u64, u64) = (1 << 8, 1 << 13);

/// Fewest of a batch, and fewest of a pixel: an error needs two.
const FEWEST: u64 = 64;
const FEWEST_OF_PIXEL: u64 = 2;

/// What one batch says of one place.
#[derive(Debug, Clone, Copy)]
pub struct Batch {
    /// The mean.
    pub mean: f64,
    /// Its standard error, where it has one.
    pub error: Option<f64>,
    /// How well that is known; of blocks of pixels nothing tells.
    pub spread: Option<Spread>,
}

/// Batches of heavy tails from which on all together have one. A batch of bounded values seldom looks so ([`turbid::stats::Tail::is_heavy`]: none of
/// 46 such sums), one of values without a variance most often.
const HEAVY: usize = BATCHES as usize / 4;
/// Contributing paths of a batch from which on its tail can be told: a fifth of them at most, of which 20 are needed.
const TELLING: f64 = 100.0;

/// Variance of variance of all samples of batches of so many, but for how far the means of the batches lie apart. sum d^4 of a batch is (vov +
/// 1/n) (sum d^2)^2, and sum d^2 is n (n-1) times the square of the standard error.
fn merged_vov(batches: &[Spread], samples: u64) -> f64 {
    let n = samples as f64;
    // Relative to the largest, whose fourth power may be no number.
    let largest = batches.iter().map(|spread| spread.std_error).fold(0.0, f64::max);
    let (mut fourth, mut second) = (0.0, 0.0);
    for spread in batches.iter().filter(|spread| spread.std_error > 0.0) {
        let squares = (spread.std_error / largest).powi(2) * n * (n - 1.0);
        fourth += (spread.vov + 1.0 / n) * squares * squares;
        second += squares;
    }
    if second > 0.0 { fourth / (second * second) - 1.0 / (n * batches.len() as f64) } else { 0.0 }
}

/// Whether batches of so many samples each have a standard error together: as a measurement of all of them would be asked, but that tails are
/// told batch by batch.
pub fn is_known(batches: &[Spread], samples: u64) -> bool {
    let contributing: Option<u64> = batches.iter().map(|spread| spread.contributing).sum();
    merged_vov(batches, samples) <= HEAVY_TAIL
        && contributing.is_none_or(|paths| paths >= FEWEST_PATHS)
        && batches.iter().filter(|spread| spread.is_heavy).count() < HEAVY
}

/// One batch, place by place.
///
/// # Errors
/// Those of the sampler
pub fn batch(
    point: &Point,
    sampler: Sampler,
    samples: u64,
    (seed, replicate): (u64, u64),
) -> anyhow::Result<Vec<Batch>> {
    let scene = &point.scene;
    if let Some(picture) = &point.picture {
        let blocks = picture.by_paths(scene, samples, (seed, replicate))?;
        return Ok(blocks.into_iter().map(|(mean, error)| Batch { mean, error, spread: None }).collect());
    }
    let measured: Vec<Measurement> = match sampler {
        Sampler::Paths => {
            let settings = PathSettings { samples, seed, replicate, orders: Orders::ALL };
            by_paths(scene, &settings, &NoProgress)?
        }
        Sampler::Light => {
            let seed = seed.wrapping_add(replicate);
            let settings = TallySettings { photons: samples, seed, orders: Orders::ALL };
            by_tallies(scene, &settings, &NoProgress)?.measurements
        }
    };
    Ok(measured.iter().map(|m| Batch { mean: m.mean, error: m.std_error, spread: Some(m.spread) }).collect())
}

/// Root mean square of the relative errors of the first group of places; none while one is not known.
fn relative_error(point: &Point, measured: &[Batch]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (batch, _) in measured.iter().zip(&point.places).filter(|(_, place)| point.is_main(place)) {
        sum += (batch.error? / batch.mean).powi(2);
        count += 1.0;
    }
    f64::is_finite(sum).then(|| (sum / count).sqrt())
}

/// The least part of the paths that bring something to a place of the first group; 1 of what tells nothing of it.
fn share(point: &Point, measured: &[Batch], samples: u64) -> f64 {
    let main = measured.iter().zip(&point.places).filter(|(_, place)| point.is_main(place));
    let paths = main.filter_map(|(batch, _)| batch.spread.and_then(|spread| spread.contributing));
    paths.map(|paths| paths as f64 / samples as f64).fold(1.0, f64::min)
}

impl Reference {
    /// Looks for exact values, and asks a pilot how much the rest takes.
    ///
    /// # Errors
    /// Those of the samplers; light tracing of sensors without bins
    pub fn plan(
        study: &StudyFile,
        point: &Point,
        number: usize,
        settings: &Settings,
    ) -> anyhow::Result<Self> {
        let by = study.reference.with;
        let solved =
            if by == ReferenceBy::Auto && point.picture.is_none() { solve(&point.scene) } else { None };
        let value = |place: &Place| solved.as_ref().and_then(|solved| solved.value(&point.scene, place));
        let exact: Vec<Option<(f64, f64)>> = point.places.iter().map(value).collect();
        // A rival alone need not be known as well as a reference.
        let is_needed = exact.iter().any(Option::is_none);
        let wanted =
            if is_needed { study.reference.error } else { study.reference.error.max(0.2 * study.target) };
        let scene = &point.scene;
        let has_bins =
            point.picture.is_none() && scene.sensors().iter().all(|sensor| sensor.binned().is_some());
        ensure!(
            has_bins || by != ReferenceBy::Light,
            "reference.with is \"light\": light tracing answers sensors with bins alone; allowed here: auto, paths"
        );
        let places = scene.sensors().iter().map(|s| s.binned().map_or(1, turbid::scene::Binned::bins) as u64);
        let places = places.sum::<u64>().max(1);
        // Of a picture places are blocks of pixels, and samples are those of a pixel.
        let (places, shared) = match &point.picture {
            Some(picture) => (picture.pixels(), picture.block_pixels().max(1)),
            None => (places, 1),
        };
        let pilot_samples = match point.picture {
            Some(_) => (PILOT / places).clamp(FEWEST_OF_PIXEL, PILOT_OF_PLACE.1),
            None => (PILOT / places).clamp(PILOT_OF_PLACE.0, PILOT_OF_PLACE.1),
        };
        let fewest = if point.picture.is_some() { FEWEST_OF_PIXEL } else { FEWEST };
        let most = study.reference.most.0.div_ceil(shared);
        let pilot = |sampler: Sampler, samples: u64| -> anyhow::Result<Option<f64>> {
            let id = CellId::of(&format!("pilot-{number:03}-{}", sampler.name()), 0);
            let of = (settings.seed, id.stream(words::NAME));
            let measured = batch(point, sampler, samples, of).context("reference")?;
            // Samples that bring the error, and paths enough to trust it.
            let telling = BATCHES as f64 * TELLING / share(point, &measured, samples);
            Ok(relative_error(point, &measured)
                .map(|error| (samples as f64 * (error / wanted) * (error / wanted)).max(telling)))
        };
        let by_paths = match by {
            ReferenceBy::Light => None,
            _ => Some((Sampler::Paths, pilot(Sampler::Paths, pilot_samples)?, places)),
        };
        let by_light = match by {
            ReferenceBy::Paths => None,
            _ if !has_bins => None,
            ReferenceBy::Auto | ReferenceBy::Light => {
                let samples = pilot_samples * places;
                Some((Sampler::Light, pilot(Sampler::Light, samples)?, 1))
            }
        };
        // Histories in all say which is the cheaper: the same on every machine.
        let cost = |of: &(Sampler, Option<f64>, u64)| of.1.map_or(f64::INFINITY, |n| n * of.2 as f64);
        let chosen = [by_paths, by_light].into_iter().flatten();
        let chosen = chosen.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let (sampler, needed, _) = chosen.context("reference: nobody samples it")?;
        let most = if sampler == Sampler::Light { most.saturating_mul(places) } else { most };
        let is_cut = needed.is_none_or(|needed| needed > most as f64);
        // An error of few paths is too small as often as not: half as much again.
        let all = needed.map_or(most as f64, |needed| (1.5 * needed).min(most as f64));
        let samples = ((all / BATCHES as f64).ceil() as u64).max(fewest);
        Ok(Reference { solved, exact, sampler, samples, is_cut })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::{Purpose, Stream};
    use turbid::stats::{Moments, Tail};

    const SAMPLES: u64 = 2000;

    /// Batches of numbers made of uniform ones.
    fn batches(seed: u64, number: impl Fn(f64) -> f64) -> Vec<Spread> {
        let one = |batch: u64| {
            let mut stream = Stream::new(31, Purpose::Synthetic, seed, batch);
            let (mut moments, mut tail) = (Moments::new(), Tail::default());
            for _ in 0..SAMPLES {
                let x = number(stream.unit());
                moments.push(x);
                tail.push(x);
            }
            Spread {
                std_error: moments.std_error(),
                vov: moments.vov(),
                contributing: Some(tail.contributing()),
                is_heavy: tail.is_heavy(&moments),
            }
        };
        (0..BATCHES).map(one).collect()
    }

    /// Exponential numbers have an error, and so have rare ones of one size; those without a variance have none, nor have too few.
    #[test]
    fn errors_that_a_measurement_would_not_have_are_refused() {
        let exponential = |u: f64| -turbid::math::ln(1.0 - u);
        let rare = |u: f64| f64::from(u8::from(u < 0.1));
        let known = |number: &dyn Fn(f64) -> f64| {
            (0..20).filter(|&seed| is_known(&batches(seed, number), SAMPLES)).count()
        };
        assert_eq!((known(&exponential), known(&rare)), (20, 20));
        // Shapes of 0.7 and 1: an infinite variance.
        assert_eq!(known(&|u| libm::pow(1.0 - u, -0.7)), 0);
        assert_eq!(known(&|u| 1.0 / (1.0 - u)), 0);
        assert_eq!(known(&|u| f64::from(u8::from(u < 0.01))), 0);
    }

    /// The variance of variance of all samples is put together from those of the batches, as exactly as their means agree: each is off by a
    /// standard error of its own, which is 1/sqrt(n) of the spread.
    #[test]
    fn variances_of_variances_are_put_together() {
        let numbers: [fn(f64) -> f64; 3] =
            [|u| u, |u| -turbid::math::ln(1.0 - u), |u| 1e-150 * libm::pow(1.0 - u, -0.3)];
        for number in numbers {
            let mut all = Moments::new();
            let mut one = |batch: u64| {
                let mut stream = Stream::new(32, Purpose::Synthetic, 0, batch);
                let values: Vec<f64> = (0..SAMPLES).map(|_| number(stream.unit())).collect();
                let moments: Moments = values.iter().collect();
                // In a unit in which fourth powers are numbers.
                let unit = moments.mean();
                values.iter().for_each(|x| all.push(x / unit));
                let scaled: Moments = values.iter().map(|x| x / unit).collect::<Vec<f64>>().iter().collect();
                Spread { std_error: moments.std_error(), vov: scaled.vov(), ..Spread::default() }
            };
            let batches: Vec<Spread> = (0..BATCHES).map(&mut one).collect();
            let put_together = merged_vov(&batches, SAMPLES);
            assert!((put_together / all.vov() - 1.0).abs() < 0.03, "{put_together} {}", all.vov());
        }
        // One batch that has it all.
        let alone = |vov| Spread { std_error: 1.0, vov, ..Spread::default() };
        let with_all: Vec<Spread> = std::iter::once(alone(0.25)).chain(vec![Spread::default(); 15]).collect();
        assert!(!is_known(&with_all, SAMPLES) && is_known(&[alone(0.25); 16], SAMPLES));
        // A few batches may look heavy, and no more.
        let heavy = |count: usize| {
            let batches: Vec<Spread> =
                (0..16).map(|i| Spread { is_heavy: i < count, ..alone(0.01) }).collect();
            is_known(&batches, SAMPLES)
        };
        assert!(heavy(0) && heavy(HEAVY - 1) && !heavy(HEAVY));
    }
}
