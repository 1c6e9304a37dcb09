//! Advice: which radius and how many photons give the fluence probes of a scene a wanted error, from small pilot maps.
//!
//! A photon estimate in a ball of radius r is wrong twice over. Its **bias** is the field's bend inside the ball: the
//! mean of the field over a sphere of radius s is phi + a s^2 to second order, so that the ball reads (3/5) a r^2 too
//! much, whatever the number of photons. Its **noise** has the variance v(r)/N, N photons emitted, where v(r) r^3
//! is alpha plus beta r: the counts of independent photons, and the clustering of photons of one history. Both laws are fitted to
//! pilot maps, from a ladder of balls about each probe that share their photons. The best radius is the one that
//! reaches the target with the fewest photons; for a small r that is where the variance is 4/3 of the squared bias.
//! Neither k nor the radius is ever a constant of taste: k is what the ball then holds.
//!
//! A pilot sees the bend of the field through its own noise. What it cannot see is taken to be as in the uncollided
//! beam e^-t, whose bend is a = 1/6 of the fluence per squared mean free path: the bend of each probe has the normal
//! prior distribution of that standard deviation, and the prediction carries what remains uncertain. Where the pilot hardly sees the bend
//! and the field bends less than the beam, the prediction is too large, and the interval reaches down to the noise alone.
//!
//! All of this is by channel, of those that a probe has light in: errors are means over probes and channels.

mod laws;

use super::order_maps::{FluenceMaps, RadianceMaps, maps, max_order};
use super::paths::{self, PathSettings};
use super::photons::{PhotonForecast, check, forecast_of, margin};
use crate::error::{Error, Result};
use crate::estimators::boundary::Boundary;
use crate::estimators::{Estimator, Gather, Kernel};
use crate::integrators::Guides;
use crate::light::Light;
use crate::photons::{Histories, Part};
use crate::rng::{Purpose, Stream};
use crate::scene::{Orders, Quantity, Scene, Sensor};
use crate::stats::{Interval, Moments};
use crate::transport::Progress;
use laws::{BALLS, Law, Probe, bend_weights, radius};
use std::time::Instant;

/// It asks points.
const OF_POINTS: RadianceMaps = RadianceMaps {
    points: true,
    beams: false,
    planes: false,
    direct_beams: false,
    fluence: FluenceMaps::Points,
    whole_beams: false,
};

/// Fewest pilot maps: a variance is then known to a quarter at a single probe.
pub const MIN_MAPS: u64 = 32;
/// Sets of maps drawn behind the interval of the predicted error: each end is known to a tenth of its width.
const RESAMPLES: u64 = 400;
/// Draws of what the prior alone tells of the bends, for each of them.
const DRAWS: u64 = 10;
/// Radii tried, from the largest that is allowed down to a hundredth of it.
const TRIALS: i32 = 200;

/// How the pilot runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PilotSettings {
    /// Photons emitted a map.
    pub photons: u64,
    /// Independent maps, at least [`MIN_MAPS`].
    pub maps: u64,
    /// Seed of the whole computation.
    pub seed: u64,
}

/// What the pilot maps said of the probes.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilot {
    seed: u64,
    /// Photons emitted a map.
    photons: u64,
    probes: Vec<Probe>,
    /// Seconds a photon takes to be shot and built into a map.
    pub preparation_seconds: f64,
    /// Seconds that estimates took, and photons that they found, by ball, means over probes and maps.
    queries: [(f64, f64); BALLS],
    /// Probes that no ball can be put about: on the boundary of their medium or on the edge of a beam.
    pub on_boundary: Vec<String>,
}

/// What is advised, for the plain estimate with the uniform kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// Gather radius \[L\].
    pub radius: f64,
    /// Photons to emit.
    pub photons: u64,
    /// Photons that a ball of this radius then holds on average: least, median and largest over the probes.
    pub gathered: [f64; 3],
    /// Predicted root mean square relative error over the probes and their channels \[1\].
    pub error: f64,
    /// Its 95 per cent interval.
    pub interval: Interval,
    /// The part of it that is bias: root mean square over the probes \[1\].
    pub bias: f64,
    /// The part of it that is noise \[1\].
    pub noise: f64,
    /// The probe next to a boundary or the edge of a beam, if that and not the bend of the field limits the radius.
    pub limited_by: Option<String>,
}

/// What the path tracer needs for the same error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathAdvice {
    /// Paths a probe, every probe having as many.
    pub samples: f64,
    /// Whether the variance is too uncertain for that number to be trusted.
    pub is_heavy_tailed: bool,
}

/// The fluence sensors of a scene.
fn probes(scene: &Scene) -> Vec<Sensor> {
    scene.sensors().iter().filter(|s| matches!(s.quantity, Quantity::Fluence(_))).cloned().collect()
}

impl Pilot {
    /// Shoots the pilot maps and reads the balls about each fluence probe.
    ///
    /// # Errors
    /// `Error::Scene` if the scene has no fluence probe inside a medium and off its boundary; `Error::OutOfRange` for
    /// fewer than [`MIN_MAPS`] maps or pilot photons that leave a probe dark; those of shooting.
    pub fn run(scene: &Scene, settings: &PilotSettings, progress: &dyn Progress) -> Result<Self> {
        let (mut pilot, chosen, margin) = Self::prepared(scene, settings)?;
        for replicate in 0..settings.maps {
            pilot.read_map(scene, &chosen, margin, settings, replicate, progress)?;
        }
        let dark = pilot.probes.iter().find(|p| p.found * (settings.maps as f64) < FEWEST_FOUND);
        if let Some(probe) = dark {
            return Err(Error::Scene(format!(
                "the pilot maps found {} photons about {}; allowed: at least {FEWEST_FOUND}: ask for a larger pilot",
                probe.found * settings.maps as f64,
                probe.name
            )));
        }
        pilot.keep_channels();
        Ok(pilot)
    }

    /// One channel where all are alike, and otherwise those that there is light in.
    fn keep_channels(&mut self) {
        let are_alike = self.probes.chunks(3).all(|of| of.iter().all(|p| p.values == of[0].values));
        self.probes
            .retain(|p| if are_alike { p.channel == 0 } else { p.values.iter().any(|balls| balls[0] > 0.0) });
    }

    /// What [`Pilot::run`] will take: a pilot of the pilot, which stores nothing.
    ///
    /// # Errors
    /// those of [`Pilot::run`] before its first map
    pub fn forecast(scene: &Scene, settings: &PilotSettings) -> Result<PhotonForecast> {
        let (_, chosen, margin) = Self::prepared(scene, settings)?;
        forecast_of(scene, (&chosen, OF_POINTS), margin, (settings.photons, settings.maps, settings.seed), 1)
    }

    /// A pilot without maps, the probes that can be asked, and how far beyond the cell's edges they read \[L\].
    fn prepared(scene: &Scene, settings: &PilotSettings) -> Result<(Self, Vec<Sensor>, f64)> {
        if settings.maps < MIN_MAPS {
            return Err(Error::out_of_range("the number of pilot maps", settings.maps as f64, "at least 32"));
        }
        let sensors = probes(scene);
        let (seed, photons) = (settings.seed, settings.photons);
        let mut pilot = Pilot {
            seed,
            photons,
            probes: Vec::new(),
            preparation_seconds: 0.0,
            queries: [(0.0, 0.0); BALLS],
            on_boundary: Vec::new(),
        };
        let mut chosen: Vec<Sensor> = Vec::new();
        for sensor in sensors {
            check(scene, &sensor)?;
            let reach = reach(scene, &sensor);
            if reach > 0.0 {
                let reach_mfp = reach / mean_free_path(scene, &sensor);
                pilot.probes.extend((0..3).map(|channel| Probe {
                    name: sensor.name.clone(),
                    channel,
                    reach,
                    reach_mfp,
                    values: Vec::new(),
                    bends: Vec::new(),
                    found: 0.0,
                }));
                chosen.push(sensor);
            } else {
                pilot.on_boundary.push(sensor.name);
            }
        }
        if chosen.is_empty() {
            return Err(Error::Scene(
                "the scene has no fluence probe inside a medium: there is nothing to advise on".to_string(),
            ));
        }
        let widest = pilot.probes.iter().map(|p| p.reach).fold(0.0, f64::max);
        let margin = scene
            .periodic_cell()
            .map_or(Ok(0.0), |periodic_cell| margin(&chosen, periodic_cell.side, widest))?;
        Ok((pilot, chosen, margin))
    }

    /// Shoots one map and reads the balls about each probe.
    fn read_map(
        &mut self,
        scene: &Scene,
        chosen: &[Sensor],
        margin: f64,
        settings: &PilotSettings,
        replicate: u64,
        progress: &dyn Progress,
    ) -> Result<()> {
        let max_order = max_order(chosen);
        let histories = Histories { count: settings.photons, seed: settings.seed, replicate, max_order };
        let start = Instant::now();
        let (_, maps) = maps(scene, (chosen, OF_POINTS), histories, Part::WHOLE, margin, progress)?;
        self.preparation_seconds += start.elapsed().as_secs_f64() / (settings.photons * settings.maps) as f64;
        let queries = chosen.len() as f64 * settings.maps as f64;
        let weights = FIT.get_or_init(bend_weights);
        for (sensor, probes) in chosen.iter().zip(self.probes.chunks_mut(3)) {
            let Some(map) = maps.points_of(sensor) else {
                continue;
            };
            let Quantity::Fluence(p) = sensor.quantity else { continue };
            let sigma_t = scene.medium_at(p).map_or(crate::Spectrum::ONE, |m| m.sigma_t(p));
            let reach = probes[0].reach;
            let mut values = [[0.0; BALLS]; 3];
            for ball in 0..BALLS {
                let gather = Gather::radius(radius(reach, ball))?;
                map.check_radius(gather.cap())?;
                let uniform = Estimator::new(Kernel::Uniform, gather);
                let start = Instant::now();
                let estimate = uniform.fluence(map, p, sigma_t, &Boundary::UNKNOWN);
                let (seconds, found) = &mut self.queries[ball];
                *seconds += start.elapsed().as_secs_f64() / queries;
                *found += estimate.found as f64 / queries;
                for (probe, values) in probes.iter_mut().zip(&mut values) {
                    values[ball] = estimate.value[probe.channel];
                    if ball == 0 {
                        probe.found += estimate.found as f64 / settings.maps as f64;
                    }
                }
            }
            for (probe, values) in probes.iter_mut().zip(values) {
                probe.bends.push(values.iter().zip(weights).map(|(x, w)| w * x).sum());
                probe.values.push(values);
            }
        }
        Ok(())
    }

    /// Seconds that an estimate from so many photons takes: those of the smallest ball, and those that the largest takes more for
    /// each photon more. In maps much larger than the pilot's, which do not fit the caches, it takes longer.
    pub fn estimate_seconds(&self, photons: f64) -> f64 {
        let ((most, many), (least, few)) = (self.queries[0], self.queries[BALLS - 1]);
        let each = if many > few { ((most - least) / (many - few)).max(0.0) } else { 0.0 };
        least + each * (photons - few).max(0.0)
    }

    /// The radius and the number of photons that bring the root mean square relative error over the probes to `target`.
    ///
    /// # Errors
    /// `Error::OutOfRange` unless `target` is above 0 and at most 1.
    pub fn advise(&self, target: f64) -> Result<Advice> {
        if !(target > 0.0 && target <= 1.0) {
            return Err(Error::out_of_range("the target", target, "a relative error above 0, to 1"));
        }
        let maps = self.probes[0].values.len();
        let laws = self.laws(&vec![1.0; maps]);
        let tightest = self.probes.iter().fold(&self.probes[0], |a, b| if b.reach < a.reach { b } else { a });
        let Some((radius, needed)) = self.choose(&laws, target).filter(|(_, needed)| *needed < MOST) else {
            return Err(Error::Scene(format!(
                "no radius from {} to {} L reaches this error with fewer than {MOST:e} photons",
                0.01 * tightest.reach,
                tightest.reach
            )));
        };
        let photons = round_up(needed);
        let (bias2, noise2) = (self.bias2(&laws, radius), self.variance(&laws, radius) / photons);
        let mut gathered: Vec<f64> =
            self.probes.iter().map(|p| p.found(radius) * photons / self.photons as f64).collect();
        gathered.sort_by(f64::total_cmp);
        Ok(Advice {
            radius,
            photons: photons as u64,
            gathered: [gathered[0], gathered[gathered.len() / 2], gathered[gathered.len() - 1]],
            error: (bias2 + noise2).sqrt(),
            interval: self.interval(&laws, target, (radius, photons), bias2 + noise2),
            bias: bias2.sqrt(),
            noise: noise2.sqrt(),
            limited_by: (radius > 0.99 * tightest.reach).then(|| tightest.name.clone()),
        })
    }

    /// The laws of all probes, each map counted as often as `counts` says.
    fn laws(&self, counts: &[f64]) -> Vec<Law> {
        self.probes.iter().map(|p| p.law(counts)).collect()
    }

    /// Expected squared relative bias, mean over the probes.
    fn bias2(&self, laws: &[Law], r: f64) -> f64 {
        let of =
            |(p, law): (&Probe, &Law)| p.bias_of(law.mean, r).powi(2) + p.bias_of(law.deviation, r).powi(2);
        self.probes.iter().zip(laws).map(of).sum::<f64>() / self.probes.len() as f64
    }

    /// Relative variance times the photons emitted, mean over the probes.
    fn variance(&self, laws: &[Law], r: f64) -> f64 {
        let sum: f64 = self.probes.iter().zip(laws).map(|(p, law)| p.variance(law, r)).sum();
        self.photons as f64 * sum / self.probes.len() as f64
    }

    /// The radius that needs the fewest photons for the target, and how many.
    fn choose(&self, laws: &[Law], target: f64) -> Option<(f64, f64)> {
        let widest = self.probes.iter().map(|p| p.reach).fold(f64::INFINITY, f64::min);
        let step = libm::log2(100.0) / f64::from(TRIALS);
        let mut best = None;
        for trial in 0..=TRIALS {
            let r = widest * libm::exp2(-f64::from(trial) * step);
            let left = target * target - self.bias2(laws, r);
            let needed = self.variance(laws, r) / left;
            if left > 0.0 && needed > 0.0 && best.is_none_or(|(_, least)| needed < least) {
                best = Some((r, needed));
            }
        }
        best
    }

    /// The errors that the maps allow at this radius with so many photons, 95 per cent of them, about the predicted square.
    ///
    /// Whole maps are drawn again with replacement, since all probes share them, and the laws fitted anew; what the
    /// prior alone tells of each bend is drawn on top. The radius was chosen on the same maps, so that they promise a
    /// little too much of it: how much a drawn set promises too much of its own choice, against the laws of all maps,
    /// and more than of a radius not chosen on it, is added to all squared errors.
    ///
    /// Squares of bends that are known badly are too large on average, and all the more those of bends drawn about them: the lower end is
    /// as far below the prediction as the upper one is above it, if that is lower, and no lower than the noise alone.
    fn interval(&self, laws: &[Law], target: f64, (radius, photons): (f64, f64), predicted: f64) -> Interval {
        let maps = self.probes[0].values.len();
        let square = |laws: &[Law], r: f64, n: f64| self.bias2(laws, r) + self.variance(laws, r) / n;
        let (mut squares, mut noises, mut promised) = (Vec::new(), Vec::new(), Moments::new());
        for set in 0..RESAMPLES {
            let mut stream = Stream::new(self.seed, Purpose::Resampling, set, 0);
            let mut counts = vec![0.0; maps];
            for _ in 0..maps {
                counts[stream.index(maps)] += 1.0;
            }
            let drawn = self.laws(&counts);
            if let Some((r, n)) = self.choose(&drawn, target) {
                let chosen = square(laws, r, n) - square(&drawn, r, n);
                promised.push(chosen - (square(laws, radius, photons) - square(&drawn, radius, photons)));
            }
            let noise = self.variance(&drawn, radius) / photons;
            noises.push(noise);
            for _ in 0..DRAWS {
                let mut bias2 = 0.0;
                for (p, law) in self.probes.iter().zip(&drawn) {
                    let [first, _] = normals(&mut stream);
                    bias2 += p.bias_of(law.mean + law.unseen * first, radius).powi(2);
                }
                squares.push(bias2 / self.probes.len() as f64 + noise);
            }
        }
        let optimism = if promised.n() > 0 { promised.mean().max(0.0) } else { 0.0 };
        let quantile = |of: &mut [f64], part: f64| {
            of.sort_by(f64::total_cmp);
            of[(part * of.len() as f64) as usize]
        };
        let low = quantile(&mut squares, 0.025) + optimism;
        let high = quantile(&mut squares, 0.975) + optimism;
        let low = low.min((2.0 * predicted - high).max(quantile(&mut noises, 0.025)));
        Interval::new(low.sqrt(), high.sqrt())
    }
}

/// Two independent normal numbers (Box and Muller 1958).
fn normals(stream: &mut Stream) -> [f64; 2] {
    let size = (-2.0 * crate::math::ln(stream.open_unit())).sqrt();
    let (sin, cos) = crate::math::sin_cos(std::f64::consts::TAU * stream.unit());
    [size * cos, size * sin]
}

/// Most photons that are advised: a map of more does not fit the photon tree's numbers many times over.
const MOST: f64 = 1e15;

/// Fewest photons about a probe in all pilot maps: below, not even the fluence is known to a tenth.
const FEWEST_FOUND: f64 = 100.0;

static FIT: std::sync::OnceLock<[f64; BALLS]> = std::sync::OnceLock::new();

/// How far a ball about the probe may reach \[L\]: inside the medium, at most a mean free path, half the cell, half way to
/// a point light, next to which no bend of second order tells the field, and up to the edge of a beam, across which it
/// jumps; 0 on the boundary of its medium and on that edge.
fn reach(scene: &Scene, sensor: &Sensor) -> f64 {
    let Quantity::Fluence(p) = sensor.quantity else { return 0.0 };
    let half_cell =
        scene.periodic_cell().map_or(f64::INFINITY, |periodic_cell| 0.5 * periodic_cell.side.min_element());
    let walls = scene.objects().iter().map(|o| o.shape.room(p).abs()).filter(|r| *r > 0.0);
    let others = scene.regions().iter().map(|r| r.shape.room(p).abs());
    let lights = scene.lights().iter().filter_map(|light| match light {
        Light::Beam(beam) => Some(beam.distance_to_edge(p)),
        _ => light.apex().map(|apex| 0.5 * p.distance(apex)),
    });
    let nearest = walls.chain(others).chain(lights).fold(half_cell, f64::min);
    nearest.min(mean_free_path(scene, sensor)).min(scene.room(p))
}

/// The mean free path where a probe is \[L\]; infinite outside all media.
fn mean_free_path(scene: &Scene, sensor: &Sensor) -> f64 {
    let Quantity::Fluence(p) = sensor.quantity else { return f64::INFINITY };
    scene.medium_at(p).map_or(f64::INFINITY, |medium| 1.0 / medium.sigma_t(p).max())
}

/// The next number with two digits.
fn round_up(x: f64) -> f64 {
    let unit = libm::pow(10.0, (libm::log10(x) - 1.0).floor().max(0.0));
    (x / unit).ceil() * unit
}

/// What the path tracer needs for a root mean square relative error of `target` over the fluence probes and their channels.
///
/// # Errors
/// Those of [`super::by_paths`]; `Error::Scene` if a pilot of paths finds no light at a probe.
pub fn path_advice(
    scene: &Scene,
    samples: u64,
    seed: u64,
    target: f64,
    progress: &dyn Progress,
) -> Result<PathAdvice> {
    paths::check_paths(scene)?;
    let settings = PathSettings { samples, seed, replicate: 0, orders: Orders::ALL };
    let sensors = probes(scene);
    let (mut variance, mut is_heavy_tailed) = (0.0, false);
    for (index, sensor) in sensors.iter().enumerate() {
        let (channels, tails) =
            paths::read(scene, sensor, index as u64, &settings, Guides::default(), progress)?;
        let of_channel = |m: &Moments| m.variance() / (m.mean() * m.mean());
        let relative: Moments = channels.iter().filter(|m| m.mean() > 0.0).map(of_channel).collect();
        if relative.n() == 0 {
            return Err(Error::Scene(format!("{samples} paths from {} found no light", sensor.name)));
        }
        variance += relative.mean() / sensors.len() as f64;
        is_heavy_tailed |=
            channels.iter().zip(&tails).any(|(m, tail)| super::is_heavy_tailed(m) || tail.is_heavy(m));
    }
    Ok(PathAdvice { samples: (variance / (target * target)).max(1.0), is_heavy_tailed })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Estimates that take 1 us and 10 ns a photon, in a pilot whose balls hold a tenth of the photons asked for or fewer.
    #[test]
    fn an_estimate_takes_as_long_as_its_photons() {
        let queries = std::array::from_fn(|ball| {
            let found = 300.0 * radius(1.0, ball).powi(3);
            (1e-6 + 1e-8 * found, found)
        });
        let (probes, on_boundary) = (Vec::new(), Vec::new());
        let pilot = Pilot { seed: 1, photons: 1, probes, preparation_seconds: 0.0, queries, on_boundary };
        assert!((pilot.estimate_seconds(3000.0) - 3.1e-5).abs() < 1e-12);
        // A pilot that finds no more in larger balls tells its own time.
        let same = Pilot { queries: [(2e-6, 5.0); BALLS], ..pilot };
        assert_eq!(same.estimate_seconds(3000.0), 2e-6);
    }

    #[test]
    fn numbers_are_rounded_up_to_two_digits() {
        for (x, rounded) in
            [(1.0, 1.0), (9.2, 10.0), (101.0, 110.0), (123_456.0, 130_000.0), (130_000.0, 130_000.0)]
        {
            assert_eq!(round_up(x), rounded);
        }
    }
}
