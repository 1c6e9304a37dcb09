//! A guess of how much light is where, by which paths are split and ended on their way to it.

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::geometry::Shape;
use crate::light::Light;
use crate::math::{FOUR_PI, Ray, exp, ln};
use crate::phase::PhaseFunction;
use crate::scene::{SURROUNDINGS, Scene, Target};
use crate::surface::Surface;
use glam::DVec3;

/// Weights between these parts of what they should be are left alone: a game for less costs more than it saves.
const WINDOW: (f64, f64) = (0.5, 2.0);
/// A history ends with nine tenths at most, and is split into eight at most, so that a value guessed wrongly does little.
const LEAST: f64 = 0.1;
const MOST: f64 = 8.0;

/// Bodies on the way to a light after which the rest of it is taken to lie where the way has come to.
const BODIES: u32 = 64;

/// How many histories go on for one whose weight is `ratio` times as large as it should be, and the factor on the weight of
/// each: their expected product is 1, whatever the ratio.
///
/// # Arguments
/// `unit` gives a number in [0, 1), asked for at most once
/// # Source
/// Wagner and Haghighat 1998: weight windows
pub fn window(ratio: f64, unit: impl FnOnce() -> f64) -> (usize, f64) {
    if ratio < WINDOW.0 {
        let chance = ratio.max(LEAST);
        (usize::from(unit() < chance), 1.0 / chance)
    } else if ratio > WINDOW.1 {
        let split = ratio.min(MOST);
        let shared = if planted(Fault::WindowUnfair) { split.round() } else { split };
        ((split + unit()) as usize, 1.0 / shared)
    } else {
        (1, 1.0)
    }
}

/// How much light is where, about: each light is taken to send its power straight to a place, with the decay of a diffuse field, at a rate of
/// sigma_t min(1, sqrt(3 (1 - albedo) (1 - albedo g))), whatever surfaces stand between. A wrong guess costs time, and no more:
/// what is split or ended keeps its mean.
#[derive(Debug, Clone)]
pub struct WeightWindows {
    lights: Vec<(Aim, f64)>,
    /// By medium, its highest rate of decay [1/L].
    rates: Vec<f64>,
    /// Whether a medium fills a body, so that what stands between is asked where such media begin and end.
    is_filled: bool,
}

/// Where a light is.
#[derive(Debug, Clone, Copy)]
enum Aim {
    /// About a place, no nearer than the second number \[L\].
    Place(DVec3, f64),
    /// Far away in this direction.
    Direction(DVec3),
}

impl WeightWindows {
    /// The guess for a scene.
    ///
    /// # Errors
    /// `Error::Scene` if one of its lights is in no place and no direction: its paths would be ended for others
    pub fn new(scene: &Scene) -> Result<Self> {
        let rate = |number: usize| {
            let medium = scene.medium(number);
            let (albedo, g) = (medium.matter().albedo().mean(), medium.phase().moment(1));
            medium.highest_sigma_t().max() * (3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt().min(1.0)
        };
        let rates: Vec<f64> = (0..scene.media().len()).map(rate).collect();
        let shortest = 1.0 / rates.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let aim = |light| Self::aim(scene, light, shortest);
        let lights: Option<Vec<(Aim, f64)>> = scene.lights().iter().map(aim).collect();
        let lights = lights.ok_or_else(|| {
            Error::Scene("weight windows need lights in a place or from a direction: isotropic light into a body, and sources in a slab without end, are on all sides".into())
        })?;
        let is_filled = (0..scene.interiors().len()).any(|interior| scene.filling(interior).is_some());
        Ok(WeightWindows { lights, rates, is_filled })
    }

    /// Where a light is, and the fluence that it brings to a distance of 1, or to everywhere.
    fn aim(scene: &Scene, light: &Light, shortest: f64) -> Option<(Aim, f64)> {
        let power = light.power(scene.periodic_cell()).mean() / FOUR_PI;
        let about =
            |ball: Option<(DVec3, f64)>| ball.map(|(center, radius)| (Aim::Place(center, radius), power));
        let from = |dir: DVec3, value: Spectrum| Some((Aim::Direction(dir), value.mean()));
        match light {
            Light::Point(_) | Light::Spot(_) => light.apex().map(|p| (Aim::Place(p, shortest), power)),
            Light::Area(area) => about(area.shape().bounds()),
            // Those of a slab without end are on all sides.
            Light::VolumeSource(_) | Light::MediumEmission(_) if scene.periodic_cell().is_some() => None,
            Light::VolumeSource(source) => about(source.shape().bounds()),
            Light::MediumEmission(emission) => about(emission.ball()),
            // What has scattered comes into a slab the short way, however aslant the light itself does.
            Light::Beam(beam) if scene.periodic_cell().is_some() => {
                from(DVec3::NEG_Z * beam.dir().z.signum(), beam.irradiance())
            }
            Light::Beam(beam) => from(-beam.dir(), beam.irradiance()),
            Light::Sun(sun) => from(-sun.dir(), sun.irradiance()),
            // From the top of a slab.
            Light::Isotropic(light) if matches!(light.shape(), Shape::Slab(_)) => {
                from(DVec3::NEG_Z, light.radiance())
            }
            Light::Isotropic(_) => None,
        }
    }

    /// The logarithm of the fluence at a place, about.
    pub fn ln_fluence(&self, scene: &Scene, p: DVec3, interior: usize) -> f64 {
        let one = |(aim, value): &(Aim, f64)| {
            let (ray, end, spread) = match aim {
                Aim::Place(center, radius) => {
                    let way = *center - p;
                    let distance = way.length();
                    let dir = way.try_normalize().unwrap_or(DVec3::Z);
                    (Ray::new(p, dir), distance, 2.0 * ln(distance.max(*radius)))
                }
                Aim::Direction(dir) => (Ray::new(p, *dir), f64::INFINITY, 0.0),
            };
            ln(*value) - spread - self.depth(scene, ray, end, interior)
        };
        let (mut largest, mut sum) = (f64::NEG_INFINITY, 0.0);
        for light in &self.lights {
            let term = one(light);
            if term > largest {
                sum = sum * exp(largest - term) + 1.0;
                largest = term;
            } else if term > f64::NEG_INFINITY {
                sum += exp(term - largest);
            }
        }
        largest + ln(sum)
    }

    /// The decay on the straight way to `end`, through all bodies, from interior to interior \[1\].
    fn depth(&self, scene: &Scene, mut ray: Ray, mut end: f64, mut interior: usize) -> f64 {
        let within = |ray: &Ray, end: f64, interior: usize| {
            let segments = scene.segments(ray, end, interior);
            segments.iter().map(|s| self.rates[s.medium] * s.interval.length()).sum::<f64>()
        };
        let (mut depth, mut start) = (0.0, None);
        for _ in 0..if self.is_filled { BODIES } else { 0 } {
            let Some(found) = scene.hit(&ray, start) else {
                // Rounding has put the place behind the face that it is before.
                interior = SURROUNDINGS;
                break;
            };
            if found.hit.t >= end {
                break;
            }
            depth += within(&ray, found.hit.t, interior);
            if let Target::Object(index) = found.target
                && let Surface::Dielectric(boundary) = &scene.objects()[index].surface
            {
                interior = boundary.sides(ray.dir, found.hit.normal).1;
            }
            ray = Ray::new(ray.at(found.hit.t), ray.dir);
            (start, end) = (Some(found.start()), end - found.hit.t);
        }
        depth + within(&ray, end, interior)
    }

    /// How far a flight goes from `flown` on before a game is played: one length of decay, or to its end.
    fn stop(&self, scene: &Scene, ray: &Ray, (flown, end): (f64, f64), interior: usize) -> f64 {
        let mut left = 1.0;
        let onward = Ray::new(ray.at(flown), ray.dir);
        for segment in scene.segments(&onward, end - flown, interior).iter() {
            let depth = self.rates[segment.medium] * segment.interval.length();
            if depth > left {
                return (flown + segment.interval.start + left / self.rates[segment.medium]).min(end);
            }
            left -= depth;
        }
        end
    }
}

/// The games of the histories of one start.
#[derive(Debug, Clone, Copy)]
pub struct Windowed<'a> {
    windows: &'a WeightWindows,
    scene: &'a Scene,
    /// The logarithm of weight times fluence that histories keep.
    kept: f64,
    /// Whether the guess knows no light at the start: then weights alone are kept.
    is_blind: bool,
}

impl<'a> Windowed<'a> {
    /// For histories that start at a place with a weight.
    pub fn new(
        windows: &'a WeightWindows,
        scene: &'a Scene,
        (p, interior): (DVec3, usize),
        weight: Spectrum,
    ) -> Self {
        let fluence = windows.ln_fluence(scene, p, interior);
        let is_blind = !fluence.is_finite();
        let kept = ln(weight.mean()) + if is_blind { 0.0 } else { fluence };
        Windowed { windows, scene, kept, is_blind }
    }

    /// How many histories go on along a ray from `flown` on, and the factor on the weight of each.
    pub(super) fn copies(
        &self,
        ray: &Ray,
        flown: f64,
        interior: usize,
        weight: Spectrum,
        unit: impl FnOnce() -> f64,
    ) -> (usize, f64) {
        let fluence =
            if self.is_blind { 0.0 } else { self.windows.ln_fluence(self.scene, ray.at(flown), interior) };
        window(exp(ln(weight.mean()) + fluence - self.kept), unit)
    }

    /// How far it goes before the next game.
    pub(super) fn stop(&self, ray: &Ray, part: (f64, f64), interior: usize) -> f64 {
        self.windows.stop(self.scene, ray, part, interior)
    }
}
