//! Scores of photons in bins: flux through faces, fluence and absorption in volumes, radiance by connections.

use crate::Spectrum;
use crate::math::{Interval, Ray, cosine_pair, wrap};
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::{Binned, Crossing, Quantity, Scene, SceneHit, Scoring, Sensor, Space, Start, Target};
use crate::stats::Moments;
use crate::surface::Surface;
use crate::transport::{Step, Walker, connection};
use glam::{DVec2, DVec3};

/// A position as the bins of a scene know it: in the cell, where there is one.
fn wrapped(scene: &Scene, p: DVec3) -> DVec3 {
    scene.periodic_cell().map_or(p, |periodic_cell| wrap(p, periodic_cell.side))
}

/// The period of a scene along x and y \[L\].
fn period(scene: &Scene) -> Option<DVec2> {
    scene.periodic_cell().map(|periodic_cell| periodic_cell.side)
}

/// Channels that are told apart.
fn channels(scene: &Scene) -> usize {
    if scene.plan().is_grey { 1 } else { 3 }
}

/// Memory of the scores of a block of histories, and of what histories add to one after another \[bytes\].
pub(crate) fn score_bytes(scene: &Scene, sensors: &[Sensor]) -> (f64, f64) {
    let bins: usize = sensors.iter().filter_map(Sensor::binned).map(Binned::bins).sum();
    let block = bins * channels(scene) * size_of::<Moments>();
    (block as f64, (bins * (size_of::<Spectrum>() + 1)) as f64)
}

/// What histories brought to all bins of some sensors, in the order of sensors, bins and channels: moments of those that
/// brought something.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scores(Vec<Moments>);

impl Scores {
    /// Adds those of other histories.
    pub fn merge(&mut self, other: Scores) {
        if self.0.is_empty() {
            *self = other;
            return;
        }
        self.0.iter_mut().zip(&other.0).for_each(|(mine, others)| mine.merge(others));
    }

    /// The moments over so many histories, by channel, of all bins in the order of sensors.
    pub fn moments(&self, scene: &Scene, histories: u64) -> impl Iterator<Item = [Moments; 3]> {
        let channels = channels(scene);
        self.0.chunks_exact(channels).map(move |bin| {
            [0, 1, 2].map(|channel| {
                let mut m = bin[channel.min(channels - 1)];
                m.merge(&Moments::zeros(histories - m.n()));
                m
            })
        })
    }
}

/// The scores of a block of histories.
pub(super) struct Tallies<'a> {
    scene: &'a Scene,
    sensors: Vec<&'a Sensor>,
    /// The first bin of each sensor, counted over all, and what its scores are divided by.
    first: Vec<(usize, f64)>,
    /// What the present history brought, before that division; the bins that it came to, and whether it did.
    scores: Vec<Spectrum>,
    met: Vec<usize>,
    is_met: Vec<bool>,
    moments: Vec<Moments>,
    /// Where it last collided.
    collision: DVec3,
}

impl<'a> Tallies<'a> {
    /// Sensors that have bins are scored.
    pub(super) fn new(scene: &'a Scene, sensors: &'a [Sensor]) -> Self {
        let mut bins = 0;
        let (mut binned, mut first) = (Vec::new(), Vec::new());
        for sensor in sensors {
            if let Some(quantity) = sensor.binned() {
                binned.push(sensor);
                first.push((bins, quantity.size(scene.periodic_cell())));
                bins += quantity.bins();
            }
        }
        Tallies {
            scene,
            sensors: binned,
            first,
            scores: vec![Spectrum::ZERO; bins],
            met: Vec::new(),
            is_met: vec![false; bins],
            moments: vec![Moments::new(); bins * channels(scene)],
            collision: DVec3::ZERO,
        }
    }

    /// Counts the present history; how many of its scores are not finite.
    pub(super) fn end_history(&mut self) -> u64 {
        let channels = channels(self.scene);
        let mut non_finite = 0;
        for bin in self.met.drain(..) {
            let sensor = self.first.partition_point(|(first, _)| *first <= bin) - 1;
            let value = self.scores[bin] / self.first[sensor].1;
            non_finite += u64::from(!value.is_finite());
            (0..channels).for_each(|c| self.moments[channels * bin + c].push(value[c]));
            self.scores[bin] = Spectrum::ZERO;
            self.is_met[bin] = false;
        }
        non_finite
    }

    pub(super) fn into_scores(self) -> Scores {
        Scores(self.moments)
    }

    fn add(&mut self, bin: usize, value: Spectrum) {
        if !self.is_met[bin] {
            self.is_met[bin] = true;
            self.met.push(bin);
        }
        self.scores[bin] += value;
    }

    /// Scores a step; `stream` is that of the scores, which the walk knows nothing of.
    pub(super) fn visit(&mut self, walker: &Walker, step: &Step, stream: &mut Stream) {
        if let Step::Collision(arrival, _) = step {
            self.collision = arrival.position;
        }
        for number in 0..self.sensors.len() {
            let (sensor, (first, _)) = (self.sensors[number], self.first[number]);
            let Quantity::Binned(binned) = &sensor.quantity else { continue };
            let counts = sensor.orders.contains(walker.order);
            match (binned, step) {
                (Binned::Flux { bins, crossing }, Step::Uncollided(t, weight)) if counts => {
                    let Some(at) = bins.distance(&walker.ray).filter(|at| at < t) else { continue };
                    let Some(bin) = bins.bin_at(wrapped(self.scene, walker.ray.at(at))) else { continue };
                    let is_along = walker.ray.dir.dot(bins.rectangle().normal()) > 0.0;
                    match (crossing, is_along) {
                        (Crossing::Along, true) | (Crossing::Against, false) | (Crossing::Net, true) => {
                            self.add(first + bin, *weight);
                        }
                        (Crossing::Net, false) => self.add(first + bin, *weight * -1.0),
                        _ => {}
                    }
                }
                (Binned::Radiance { bins, dir }, _) if sensor.orders.contains(walker.order + 1) => {
                    let Some((position, start, scattered)) = self.scattering(walker, step, -*dir) else {
                        continue;
                    };
                    let ray = Ray::new(position, -*dir);
                    let Some(distance) = bins.distance(&ray) else { continue };
                    let Some(bin) = bins.bin_at(wrapped(self.scene, ray.at(distance))) else { continue };
                    let place = (&ray, start, walker.interior);
                    let Some(passed) = connection(self.scene, place, distance, None, stream) else {
                        continue;
                    };
                    // A bin's area across the line.
                    let cosine = dir.dot(bins.rectangle().normal()).abs();
                    self.add(first + bin, walker.weight * scattered * passed / cosine);
                }
                (Binned::Fluence { space, scoring: Scoring::TrackLength }, Step::Uncollided(t, weight))
                    if counts =>
                {
                    let flight = Interval { start: 0.0, end: *t };
                    self.along(space, &walker.ray, flight, |tallies, bin, part| {
                        tallies.add(first + bin, *weight * part.length());
                    });
                }
                (
                    Binned::Fluence { space, scoring: Scoring::Collision },
                    Step::Collision(arrival, medium),
                ) if counts => {
                    let Some(bin) = self.bin_at(space, arrival.position) else { continue };
                    let sigma_t = self.scene.medium(*medium).sigma_t(arrival.position);
                    self.add(first + bin, arrival.walker.weight.over(sigma_t));
                }
                (
                    Binned::Absorption { space, scoring: Scoring::TrackLength },
                    Step::Uncollided(t, weight),
                ) if counts => {
                    let scene = self.scene;
                    for segment in scene.segments(&walker.ray, *t, walker.interior).iter() {
                        let medium = scene.medium(segment.medium);
                        self.along(space, &walker.ray, segment.interval, |tallies, bin, part| {
                            // A point of the part stands for it.
                            let at = match medium.is_homogeneous() {
                                true => part.start,
                                false => part.start + stream.unit() * part.length(),
                            };
                            let sigma_a = medium.sigma_a(walker.ray.at(at));
                            tallies.add(first + bin, *weight * sigma_a * part.length());
                        });
                    }
                }
                (
                    Binned::Absorption { space, scoring: Scoring::Collision },
                    Step::Collision(arrival, medium),
                ) if counts => {
                    let Some(bin) = self.bin_at(space, arrival.position) else { continue };
                    let albedo = self.scene.medium(*medium).albedo(arrival.position);
                    self.add(first + bin, arrival.walker.weight * (Spectrum::ONE - albedo));
                }
                (Binned::Absorption { space, scoring: Scoring::Analog }, Step::Absorbed(weight, Some(_)))
                    if counts =>
                {
                    let Some(bin) = self.bin_at(space, self.collision) else { continue };
                    self.add(first + bin, *weight);
                }
                _ => {}
            }
        }
    }

    /// Where a step scatters, the body there, and the fraction that leaves into a direction [1/sr].
    fn scattering(
        &self,
        walker: &Walker,
        step: &Step,
        towards: DVec3,
    ) -> Option<(DVec3, Option<Start>, Spectrum)> {
        match step {
            Step::Collision(arrival, number) => {
                let medium = self.scene.medium(*number);
                let (one_minus_mu, one_plus_mu) = cosine_pair(walker.ray.dir, towards);
                let phase = medium.phase().eval(one_minus_mu, one_plus_mu);
                Some((arrival.position, None, medium.albedo(arrival.position) * phase))
            }
            Step::Surface(arrival, SceneHit { target: Target::Object(index), hit }) => {
                let Surface::Lambertian(surface) = &self.scene.objects()[*index].surface else { return None };
                let normal = if walker.ray.dir.dot(hit.normal) < 0.0 { hit.normal } else { -hit.normal };
                let start = SceneHit { target: Target::Object(*index), hit: *hit }.start();
                let reflected = surface.eval(arrival.position, hit.uv) * towards.dot(normal).max(0.0);
                (!reflected.is_black()).then_some((arrival.position, Some(start), reflected))
            }
            _ => None,
        }
    }

    fn bin_at(&self, space: &Space, p: DVec3) -> Option<usize> {
        match space {
            Space::Voxels(voxels) => voxels.bin_at(wrapped(self.scene, p)),
            Space::Shape(shape) => shape.contains(p).then_some(0),
        }
    }

    /// The bins on a stretch of a ray.
    fn along(
        &mut self,
        space: &Space,
        ray: &Ray,
        stretch: Interval,
        mut add: impl FnMut(&mut Self, usize, Interval),
    ) {
        let period = period(self.scene);
        match space {
            Space::Voxels(voxels) => voxels.along(ray, stretch, period, |bin, part| add(self, bin, part)),
            Space::Shape(shape) => {
                let part = shape.interval(ray).and_then(|inside| inside.intersection(stretch));
                if let Some(part) = part.filter(|part| part.end.is_finite()) {
                    add(self, 0, part);
                }
            }
        }
    }
}
