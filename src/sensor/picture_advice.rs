//! Advice for a picture: how many photons, which k and how many samples bring its root mean square error to a target, from
//! small pilots against paths.
//!
//! A layer that a map answers has in each pixel a **bias**, the blur of the field over the reach of an estimate, and a
//! **noise** that all samples of a map share. N photons of independent histories read within one radius have a variance v(r)/N,
//! and k/N stands for the radius: the mean squared bias is fitted as b x^p and the variance as v x^-s / N, x = k/N, to maps of two
//! sizes that are read with several k. **Samples** add their own noise, as 1/samples. What the other layers are wrong by is
//! a constant of the march. Pilots look at a lattice of the picture's own pixels, each with its true footprint.

use super::compare::{VALUES, variance};
use super::film::{Film, Sample};
use super::render::{Streams, extend_at};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::Gather;
use crate::integrators::mapper::{Mapper, Report, Settings};
use crate::integrators::{Layer, path};
use crate::math::{exp, ln};
use crate::photons::PhotonMap;
use crate::photons::maps::{Amount, Indirect, MapReport, MapSettings, MediumSamples, fill};
use crate::rng::Stream;
use crate::scene::{Camera, Scene};
use crate::stats::{Interval, fit_line, student_critical};
use crate::transport::{NoProgress, Progress};
use std::time::Instant;

/// Photons of an estimate that pilots are read with: of the larger maps, and of the smaller ones. They overlap in k/N.
const LADDERS: [&[usize]; 2] = [&[25, 50, 100, 200], &[25, 100]];
/// Which of them the noise of samples and their time is taken of.
const TYPICAL: usize = 2;
/// Photons of the smaller maps, over those of the larger.
const SMALLER: u64 = 4;
/// Fewest and most photons of an estimate that are advised.
const NEAREST: (f64, f64) = (10.0, 1000.0);
/// Most photons of a map that are advised.
const MOST_PHOTONS: f64 = 1e9;
/// Most samples a pixel that are advised.
const MOST_SAMPLES: f64 = 65_536.0;
/// By what a step of the search multiplies photons or samples.
const STEP: f64 = 1.25;
/// Exponents of k/N that are tried for the squared bias, up to that of a smooth field: 4/d in d dimensions.
const EXPONENTS: usize = 16;

/// How the pilots run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PicturePilotSettings {
    /// Photons stored in the global, the caustic and the volume map of each larger pilot.
    pub photons: [u64; 3],
    /// Independent pilot maps, at least 4.
    pub maps: u64,
    /// Samples of a pixel, of each map: at least 2.
    pub samples: u64,
    /// Samples of a pixel of the reference by paths: at least 2.
    pub reference: u64,
    /// Pixels of the lattice across, at most.
    pub across: u32,
    /// Where the global map is read.
    pub indirect: Indirect,
    /// Seed of the whole computation.
    pub seed: u64,
}

/// Maps of one size, read with one k.
struct Run {
    /// Photons in the maps, mean.
    stored: [f64; 3],
    k: f64,
    films: Vec<Film>,
    /// Time of a sample \[s\], and photons that it took from each map.
    seconds: f64,
    found: [f64; 3],
}

/// Pilots of a picture.
pub struct PicturePilot {
    reference: Film,
    runs: Vec<Run>,
    samples: f64,
    pixels: f64,
    /// Seconds of a photon sent out by the main and the caustic pass, of one stored, and photons stored of one sent out.
    emission: [f64; 2],
    build: f64,
    stored_of_emitted: [f64; 3],
}

/// What was measured of one value in one run, over the square of the total's mean.
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    bias: f64,
    variance: f64,
    sample: f64,
}

/// The laws of one layer.
#[derive(Debug, Clone, Copy)]
struct Law {
    layer: Layer,
    map: Option<usize>,
    /// b and p of b x^p; b alone without a map.
    bias: (f64, f64),
    /// v and s of v x^-s / N.
    variance: (f64, f64),
    sample: f64,
}

impl Law {
    fn of_map(&self, photons: f64, k: f64) -> f64 {
        let x = k / photons;
        self.bias.0 * libm::pow(x, self.bias.1) + self.variance.0 * libm::pow(x, -self.variance.1) / photons
    }
}

/// The laws of all layers.
#[derive(Debug, Clone)]
struct Laws {
    layers: Vec<Law>,
    /// The total's square over the sum of the layers': errors of layers are correlated.
    together: f64,
    together_samples: f64,
    /// The largest k over photons of each map that the laws were fitted to: beyond it they are not known.
    widest: [f64; 3],
}

/// Photons, k and samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plan {
    photons: [f64; 3],
    k: [f64; 3],
    samples: f64,
}

impl Laws {
    fn layer(&self, law: &Law, plan: &Plan) -> f64 {
        let own = law.map.map_or(law.bias.0, |map| law.of_map(plan.photons[map], plan.k[map]));
        own + law.sample / plan.samples
    }

    fn square(&self, plan: &Plan) -> f64 {
        let own = |law: &Law| self.layer(law, plan) - law.sample / plan.samples;
        self.together * self.layers.iter().map(own).sum::<f64>()
            + self.together_samples * self.layers.iter().map(|law| law.sample / plan.samples).sum::<f64>()
    }

    /// The k that is best for a map of so many photons.
    fn best_k(&self, map: usize, photons: f64) -> f64 {
        let of_map = |k: f64| {
            self.layers
                .iter()
                .filter(|law| law.map == Some(map))
                .map(|law| law.of_map(photons, k))
                .sum::<f64>()
        };
        let steps = 60;
        let k = |i: usize| {
            let part = i as f64 / steps as f64;
            (NEAREST.0 * exp(part * ln(NEAREST.1 / NEAREST.0))).round()
        };
        (0..=steps)
            .map(k)
            .filter(|k| *k <= (photons * self.widest[map]).max(NEAREST.0))
            .min_by(|a, b| of_map(*a).total_cmp(&of_map(*b)))
            .unwrap_or(NEAREST.0)
    }
}

/// What a wanted error takes.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureAdvice {
    /// Photons to store in the global, the caustic and the volume map; none where the picture has no light from it.
    pub photons: [Option<u64>; 3],
    /// Photons of an estimate from each.
    pub k: [usize; 3],
    /// Samples a pixel.
    pub samples: u64,
    /// Predicted root mean square error of a pixel, over the picture's mean.
    pub error: f64,
    /// 95 per cent interval of that of one picture.
    pub interval: Interval,
    /// Predicted error of each layer over its own mean.
    pub layers: Vec<(Layer, f64)>,
    /// Time of the maps \[s\].
    pub map_seconds: f64,
    /// Time of the pixels \[s\].
    pub pixel_seconds: f64,
}

/// The map that answers a layer.
fn map_of(layer: Layer) -> Option<usize> {
    match layer {
        Layer::Indirect => Some(0),
        Layer::Caustic => Some(1),
        Layer::Multiple => Some(2),
        Layer::Emission | Layer::Direct | Layer::Single => None,
    }
}

impl PicturePilot {
    /// Renders the pilots.
    ///
    /// # Errors
    /// `Error::Unreachable` where paths cannot be the reference; `Error::OutOfRange` for fewer than 4 maps or 2 samples, and
    /// for a picture without light; those of photon passes and of pictures
    pub fn run(
        scene: &Scene,
        camera: &Camera,
        pilot: &PicturePilotSettings,
        read: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let unreachable = &scene.plan().unreachable;
        if !unreachable.is_empty() {
            let why = unreachable.join("; ");
            return Err(Error::Unreachable(format!("paths cannot be the reference of this picture: {why}")));
        }
        for (name, number, least) in [
            ("pilot maps", pilot.maps, 4),
            ("samples", pilot.samples, 2),
            ("reference samples", pilot.reference, 2),
        ] {
            if number < least {
                return Err(Error::out_of_range(name, number as f64, "at least 4 maps and 2 samples"));
            }
        }
        let width = pilot.across.clamp(1, camera.width());
        let height = f64::from(width) * f64::from(camera.height()) / f64::from(camera.width());
        let height = (height.round() as u32).clamp(1, camera.height());
        let along = |i: u32, few: u32, all: u32| {
            ((2 * u64::from(i) + 1) * u64::from(all) / (2 * u64::from(few))) as u32
        };
        let place = |x: u32, y: u32| (along(x, width, camera.width()), along(y, height, camera.height()));
        let interior = scene.interior_at(camera.position());
        let pixels = u64::from(width) * u64::from(height);

        progress.stage("reference", pilot.reference * pixels);
        let mut reference = Film::new(width, height);
        // A replicate that no map has.
        let streams = Streams { seed: pilot.seed, replicate: pilot.maps };
        extend_at(
            &mut reference,
            (camera, place),
            pilot.reference,
            streams,
            progress,
            |ray, stream: &mut Stream, _: &mut Report| path::layers(scene, ray, None, interior, stream).0,
        )?;

        let all: usize = LADDERS.iter().map(|ladder| ladder.len()).sum();
        progress.stage("pilots", all as u64 * pilot.maps * pilot.samples * pixels);
        let blank = |k: &usize| Run {
            stored: [0.0; 3],
            k: *k as f64,
            films: Vec::new(),
            seconds: 0.0,
            found: [0.0; 3],
        };
        let mut runs: Vec<Run> = LADDERS.iter().flat_map(|ladder| ladder.iter().map(blank)).collect();
        let (mut report, mut stored, mut emitted) = (MapReport::default(), [0.0; 3], [0.0; 3]);
        for replicate in 0..pilot.maps {
            let mut number = 0;
            for (size, ladder) in LADDERS.iter().enumerate() {
                let fewer = if size == 0 { 1 } else { SMALLER };
                let [global, caustic, volume] = pilot.photons.map(|n| Amount::Stored((n / fewer).max(1)));
                let settings = MapSettings {
                    global,
                    caustic,
                    volume,
                    media: MediumSamples::Points,
                    indirect: pilot.indirect,
                    seed: pilot.seed,
                    replicate,
                };
                let maps = fill(scene, &settings, &NoProgress)?;
                let held = [&maps.global, &maps.caustic, &maps.volume];
                let counts = held.map(|map| map.as_ref().map_or(0.0, |m| m.stored() as f64));
                if size == 0 {
                    report.add_part(&maps.report);
                    for i in 0..3 {
                        stored[i] += counts[i];
                        emitted[i] += held[i].as_ref().map_or(0.0, |m: &PhotonMap| m.emitted() as f64);
                    }
                }
                for k in *ladder {
                    let run = &mut runs[number];
                    let mut read = *read;
                    for gather in [&mut read.global.1, &mut read.caustic.1, &mut read.volume.gather] {
                        *gather = Gather::nearest(*k, gather.cap())?;
                    }
                    let mapper = Mapper::new(scene, &maps, &read);
                    mapper.check_radii()?;
                    let mut film = Film::new(width, height);
                    let streams = Streams { seed: pilot.seed, replicate };
                    let start = Instant::now();
                    let work = extend_at(
                        &mut film,
                        (camera, place),
                        pilot.samples,
                        streams,
                        progress,
                        |ray, stream: &mut Stream, work: &mut Report| {
                            let (layers, report) = mapper.radiance(ray, None, interior, stream);
                            *work += report;
                            Sample::from(layers)
                        },
                    )?;
                    let each = 1.0 / (pilot.maps * pilot.samples * pixels) as f64;
                    run.seconds += start.elapsed().as_secs_f64() * each;
                    for (i, map) in [work.global, work.caustic, work.volume].iter().enumerate() {
                        run.found[i] += map.found as f64 * each;
                        run.stored[i] += counts[i] / pilot.maps as f64;
                    }
                    run.films.push(film);
                    number += 1;
                }
            }
        }
        let per = |seconds: f64, count: f64| if count > 0.0 { seconds / count } else { 0.0 };
        let pilot_of = PicturePilot {
            reference,
            runs,
            samples: pilot.samples as f64,
            pixels: f64::from(camera.width()) * f64::from(camera.height()),
            emission: [&report.main, &report.caustic]
                .map(|pass| per(pass.time.as_secs_f64(), pass.emitted as f64)),
            build: per(report.build.as_secs_f64(), stored.iter().sum()),
            stored_of_emitted: [0, 1, 2].map(|i| per(stored[i], emitted[i])),
        };
        if pilot_of.mean(None) <= 0.0 {
            return Err(Error::out_of_range(
                "the picture's mean",
                pilot_of.mean(None),
                "a picture with light",
            ));
        }
        Ok(pilot_of)
    }

    /// Mean of the reference.
    fn mean(&self, layer: Option<Layer>) -> f64 {
        let pixels = self.reference.pixels();
        pixels.iter().map(|pixel| pixel.mean_of(layer).mean()).sum::<f64>() / pixels.len() as f64
    }

    /// What the maps that `counts` says of a layer, of a run.
    fn parts(&self, run: &Run, layer: Option<Layer>, counts: &dyn Fn(usize) -> bool) -> Parts {
        let films: Vec<&Film> =
            run.films.iter().enumerate().filter(|(i, _)| counts(*i)).map(|(_, f)| f).collect();
        let (n, pixels) = (films.len() as f64, self.reference.pixels().len());
        let mean = self.mean(None);
        let over = 1.0 / (pixels as f64 * mean * mean);
        let mut parts = Parts::default();
        for (i, truth) in self.reference.pixels().iter().enumerate() {
            let values = || films.iter().map(|film| film.pixels()[i].mean_of(layer));
            let x = values().fold(Spectrum::ZERO, |sum, x| sum + x) / n;
            let between = values().fold(Spectrum::ZERO, |sum, v| sum + (v - x) * (v - x)) / (n - 1.0);
            let within =
                films.iter().fold(Spectrum::ZERO, |sum, film| sum + variance(&film.pixels()[i], layer)) / n;
            let d = x - truth.mean_of(layer);
            parts.bias += over * (d * d - between / n - variance(truth, layer)).mean();
            parts.variance += over * (between - within).mean();
            parts.sample += over * self.samples * within.mean();
        }
        parts
    }

    /// The laws by the maps that count.
    fn laws(&self, counts: &dyn Fn(usize) -> bool) -> Laws {
        let of = |layer: Option<Layer>| -> Vec<Parts> {
            self.runs.iter().map(|run| self.parts(run, layer, counts)).collect()
        };
        let mut layers = Vec::new();
        let mut sums = vec![Parts::default(); self.runs.len()];
        for layer in VALUES.into_iter().flatten() {
            let parts = of(Some(layer));
            for (sum, part) in sums.iter_mut().zip(&parts) {
                sum.bias += part.bias + part.variance;
                sum.sample += part.sample;
            }
            let map = map_of(layer).filter(|map| self.runs[0].stored[*map] > 0.0);
            let sample = parts[TYPICAL].sample.max(0.0);
            let constant = parts.iter().map(|p| p.bias).sum::<f64>() / parts.len() as f64;
            let law = Law { layer, map, bias: (constant.max(0.0), 0.0), variance: (0.0, 0.0), sample };
            layers.push(match map {
                None => law,
                Some(map) => {
                    let x: Vec<f64> = self.runs.iter().map(|run| run.k / run.stored[map]).collect();
                    let n: Vec<f64> = self.runs.iter().map(|run| run.stored[map]).collect();
                    let dimension = if map == 2 { 3.0 } else { 2.0 };
                    Law {
                        bias: fit_bias(&x, &parts, dimension),
                        variance: fit_variance(&x, &n, &parts),
                        ..law
                    }
                }
            });
        }
        let total = of(None);
        let ratio = |own: f64, sum: f64| if sum > 0.0 { (own / sum).clamp(0.5, 3.0) } else { 1.0 };
        let whole: f64 = total.iter().map(|p| p.bias + p.variance).sum();
        Laws {
            layers,
            widest: [0, 1, 2].map(|map| {
                let x = self.runs.iter().map(|run| run.k / run.stored[map].max(1.0));
                x.fold(0.0, f64::max)
            }),
            together: ratio(whole, sums.iter().map(|p| p.bias).sum()),
            together_samples: ratio(total[TYPICAL].sample, sums[TYPICAL].sample),
        }
    }

    /// Mean square of what single scattering is wrong by after infinitely many samples, over the square of the picture's mean: the
    /// march's.
    pub fn march_error(&self) -> f64 {
        let parts = self.runs.iter().map(|run| self.parts(run, Some(Layer::Single), &|_| true).bias);
        (parts.sum::<f64>() / self.runs.len() as f64).max(0.0)
    }

    /// Time of the maps and of the pixels of a plan \[s\].
    fn seconds(&self, plan: &Plan, has: [bool; 3]) -> (f64, f64) {
        let sent = |map: usize| {
            let part = self.stored_of_emitted[map];
            if has[map] && part > 0.0 { plan.photons[map] / part } else { 0.0 }
        };
        let stored: f64 = (0..3).filter(|map| has[*map]).map(|map| plan.photons[map]).sum();
        let maps = self.emission[0] * sent(0).max(sent(2)) + self.emission[1] * sent(1) + self.build * stored;
        // A sample takes a + b times the photons found.
        let found = |run: &Run| run.found.iter().sum::<f64>();
        let (low, high) = (&self.runs[0], &self.runs[LADDERS[0].len() - 1]);
        let slope = ((high.seconds - low.seconds) / (found(high) - found(low)).max(1.0)).max(0.0);
        let typical = &self.runs[TYPICAL];
        let more: f64 = (0..3).map(|map| typical.found[map] * (plan.k[map] / typical.k - 1.0)).sum();
        let each = (typical.seconds + slope * more).max(0.1 * typical.seconds);
        (maps, each * self.pixels * plan.samples)
    }

    /// The plan that reaches the target soonest, found by steps that lower the squared error most for their time.
    ///
    /// # Errors
    /// `Error::OutOfRange` if 10^9 photons a map and 65536 samples do not reach it
    pub fn advise(&self, target: f64) -> Result<PictureAdvice> {
        let laws = self.laws(&|_| true);
        let has = [0, 1, 2].map(|map| {
            laws.layers.iter().any(|law| law.map == Some(map) && (law.bias.0 > 0.0 || law.variance.0 > 0.0))
        });
        let mut plan = Plan { photons: [1000.0; 3], k: [NEAREST.0; 3], samples: 1.0 };
        let with_map = |plan: &Plan, map: usize, photons: f64| {
            let mut next = *plan;
            next.photons[map] = photons;
            next.k[map] = laws.best_k(map, photons);
            next
        };
        plan = (0..3).fold(plan, |plan, map| with_map(&plan, map, plan.photons[map]));
        while laws.square(&plan) > target * target {
            let mut moves = vec![Plan { samples: (STEP * plan.samples).ceil(), ..plan }];
            moves.extend((0..3).filter(|m| has[*m]).map(|m| with_map(&plan, m, STEP * plan.photons[m])));
            moves.retain(|next| {
                next.samples <= MOST_SAMPLES && next.photons.iter().all(|n| *n <= MOST_PHOTONS)
            });
            let time = |plan: &Plan| {
                let (maps, pixels) = self.seconds(plan, has);
                maps + pixels
            };
            let gain =
                |next: &Plan| (laws.square(&plan) - laws.square(next)) / (time(next) - time(&plan)).max(1e-6);
            let best = moves.into_iter().max_by(|a, b| gain(a).total_cmp(&gain(b)));
            let Some(next) = best.filter(|next| laws.square(next) < laws.square(&plan) * (1.0 - 1e-6)) else {
                let reached = laws.square(&plan).sqrt();
                return Err(Error::Scene(format!(
                    "the target of {:.2} % is out of reach: with fewer than 1e9 photons a map and 65536 samples a pixel the predicted \
                     error is {:.2} %",
                    100.0 * target,
                    100.0 * reached
                )));
            };
            plan = next;
        }
        let square = laws.square(&plan);
        let deviation = self.deviation(&laws, &plan);
        let freedom = self.runs[0].films.len() as u64 - 1;
        let half = 0.5 * student_critical(0.05, freedom) * deviation;
        let layers = laws.layers.iter().filter_map(|law| {
            let mean = self.mean(Some(law.layer));
            (mean > 0.0).then(|| (law.layer, laws.layer(law, &plan).sqrt() * self.mean(None) / mean))
        });
        let (map_seconds, pixel_seconds) = self.seconds(&plan, has);
        Ok(PictureAdvice {
            photons: [0, 1, 2].map(|map| has[map].then(|| plan.photons[map].ceil() as u64)),
            k: plan.k.map(|k| k as usize),
            samples: plan.samples as u64,
            error: square.sqrt(),
            interval: Interval::new(square.sqrt() * exp(-half), square.sqrt() * exp(half)),
            layers: layers.collect(),
            map_seconds,
            pixel_seconds,
        })
    }

    /// Standard deviation of the logarithm of the squared error: of the laws over maps (jackknife), of what they leave over, of the pixels that
    /// were looked at, and of one map to the next.
    fn deviation(&self, laws: &Laws, plan: &Plan) -> f64 {
        let maps = self.runs[0].films.len();
        let logs: Vec<f64> =
            (0..maps).map(|left_out| ln(self.laws(&|i| i != left_out).square(plan).max(1e-300))).collect();
        let mean = logs.iter().sum::<f64>() / maps as f64;
        let n = maps as f64;
        let of_laws = (n - 1.0) / n * logs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();

        let mut left_over = 0.0;
        for run in &self.runs {
            let parts = self.parts(run, None, &|_| true);
            let own = Plan { photons: run.stored.map(|n| n.max(1.0)), k: [run.k; 3], samples: self.samples };
            let measured = parts.bias + parts.variance + parts.sample / self.samples;
            let off = if measured > 0.0 { ln(laws.square(&own) / measured) } else { 1.0 };
            left_over += off * off / self.runs.len() as f64;
        }

        // Of the run that is read most as the plan is.
        let map = (0..3).filter(|map| self.runs[0].stored[*map] > 0.0).max_by(|a, b| {
            let of = |map: usize| {
                laws.layers.iter().filter(|l| l.map == Some(map)).map(|l| laws.layer(l, plan)).sum::<f64>()
            };
            of(*a).total_cmp(&of(*b))
        });
        let distance = |run: &&Run| {
            map.map_or(0.0, |map| ln(run.k / run.stored[map] * plan.photons[map] / plan.k[map]).abs())
        };
        let Some(run) = self.runs.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return 0.0;
        };
        let truth = self.reference.pixels();
        let square = |film: &Film, i: usize| {
            let d = film.pixels()[i].mean_of(None) - truth[i].mean_of(None);
            (d * d - variance(&truth[i], None)).mean()
        };
        let relative = |values: Vec<f64>| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0).max(1.0);
            variance / (mean * mean).max(1e-300)
        };
        let by_pixel =
            (0..truth.len()).map(|i| run.films.iter().map(|film| square(film, i)).sum::<f64>() / n);
        let of_pixels = relative(by_pixel.collect()) / truth.len() as f64;
        let by_map = run.films.iter().map(|film| (0..truth.len()).map(|i| square(film, i)).sum::<f64>());
        let of_map = relative(by_map.collect());
        (of_laws + left_over + of_pixels + of_map).sqrt().min(3.0)
    }
}

/// b and p of b x^p, b at least 0, p up to that of a smooth field; weights fall with the noise that the squared bias was found in.
fn fit_bias(x: &[f64], parts: &[Parts], dimension: f64) -> (f64, f64) {
    let weight = |part: &Parts| {
        let error = part.variance.abs() + 0.2 * part.bias.abs();
        if error > 0.0 { 1.0 / (error * error) } else { 0.0 }
    };
    let fit = |p: f64| {
        let (mut xy, mut xx) = (0.0, 0.0);
        for (x, part) in x.iter().zip(parts) {
            let power = libm::pow(*x, p);
            xy += weight(part) * power * part.bias;
            xx += weight(part) * power * power;
        }
        let b = if xx > 0.0 { (xy / xx).max(0.0) } else { 0.0 };
        let off = |(x, part): (&f64, &Parts)| {
            let off = b * libm::pow(*x, p) - part.bias;
            weight(part) * off * off
        };
        (b, p, x.iter().zip(parts).map(off).sum::<f64>())
    };
    let exponents = (0..=EXPONENTS).map(|i| 4.0 / dimension * i as f64 / EXPONENTS as f64);
    let best = exponents.map(fit).min_by(|a, b| a.2.total_cmp(&b.2));
    best.map_or((0.0, 0.0), |(b, p, _)| (b, p))
}

/// v and s of v x^-s / N, s from 0, photons spread over the whole picture, to 1, those of one estimate alone.
fn fit_variance(x: &[f64], photons: &[f64], parts: &[Parts]) -> (f64, f64) {
    let points: Vec<(f64, f64, f64)> = x
        .iter()
        .zip(photons)
        .zip(parts)
        .filter(|((x, _), part)| part.variance > 0.0 && **x > 0.0)
        .map(|((x, n), part)| (ln(*x), ln(part.variance * n), 1.0))
        .collect();
    if points.is_empty() {
        return (0.0, 0.0);
    }
    let slope = fit_line(&points).map_or(-0.5, |line| line.slope).clamp(-1.0, 0.0);
    let of =
        |i: usize| points.iter().map(|p| if i == 0 { p.0 } else { p.1 }).sum::<f64>() / points.len() as f64;
    (exp(of(1) - slope * of(0)), -slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Laws that are put in come out, and the k that balances them is that of the closed form: of b x^p + v x^-s / N the least
    /// is at x^(p + s) = s v / (p b N).
    #[test]
    fn laws_that_are_put_in_come_out() {
        let (b, p, v, s) = (3.0, 1.0, 0.02, 0.75);
        let n = [50_000.0, 50_000.0, 50_000.0, 50_000.0, 12_500.0, 12_500.0];
        let k = [25.0, 50.0, 100.0, 200.0, 25.0, 100.0];
        let x: Vec<f64> = k.iter().zip(n).map(|(k, n)| k / n).collect();
        let parts: Vec<Parts> = x
            .iter()
            .zip(n)
            .map(|(x, n)| Parts {
                bias: b * libm::pow(*x, p),
                variance: v * libm::pow(*x, -s) / n,
                sample: 0.0,
            })
            .collect();
        let (found_b, found_p) = fit_bias(&x, &parts, 2.0);
        let (found_v, found_s) = fit_variance(&x, &n, &parts);
        for (found, expected) in [(found_b, b), (found_p, p), (found_v, v), (found_s, s)] {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        }
        let law = Law { layer: Layer::Multiple, map: Some(2), bias: (b, p), variance: (v, s), sample: 0.0 };
        let laws = Laws { layers: vec![law], together: 1.0, together_samples: 1.0, widest: [1.0; 3] };
        let photons = 1e6;
        let best = photons * libm::pow(s * v / (p * b * photons), 1.0 / (p + s));
        // Steps of the search are 8 per cent of k.
        assert!((laws.best_k(2, photons) / best - 1.0).abs() < 0.05, "{best}");
    }
}
