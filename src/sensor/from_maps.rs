//! What maps answer: fluence at places, and radiance along rays, of sensors and their bins.

use super::Measurement;
use super::order_maps::AskedMap;
use super::reach::has_extinction;
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::boundary::{Boundary, Treatment};
use crate::estimators::{BeamBlur, Estimate, Estimator, PlaneEstimator, RayEnds, Stretched};
use crate::geometry::Shape;
use crate::integrators::mapper::{MediumExtent, medium_extents, scene_size};
use crate::integrators::{Guides, March, StepRule, along, path};
use crate::math::{Interval, Positive, Ray};
use crate::medium::Medium;
use crate::photons::Ledger;
use crate::photons::beams::BeamMap;
use crate::rng::{Purpose, Stream};
use crate::scene::{Binned, Orders, Quantity, Scene, Sensor};
use crate::transport::{Passage, in_parallel, transmittance};
use glam::DVec3;

/// What photons read, and where their power went.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotonReadings {
    /// One a sensor and channel: tallies have n = histories, maps n = maps.
    pub measurements: Vec<Measurement>,
    /// Powers \[W\] by history.
    pub ledger: Ledger,
    /// Estimates that found fewer than k photons within the cap.
    pub underfull: u64,
    /// Estimates without a treatment whose ball reaches beyond the medium that the point is in.
    pub beyond: u64,
    /// Estimates made.
    pub gathers: u64,
    /// Radius of the smallest ball \[L\]; infinite of none.
    pub least_radius: f64,
}

impl PhotonReadings {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        PhotonReadings {
            measurements: Vec::new(),
            ledger: Ledger::default(),
            underfull: 0,
            beyond: 0,
            gathers: 0,
            least_radius: f64::INFINITY,
        }
    }

    /// Counts an estimate at a point.
    fn book(&mut self, scene: &Scene, p: DVec3, estimate: &Estimate, treatment: Treatment) {
        self.gathers += 1;
        self.least_radius = self.least_radius.min(estimate.radius);
        self.underfull += u64::from(estimate.underfull);
        self.beyond += u64::from(treatment == Treatment::None && estimate.radius > scene.room(p));
    }
}

/// Steps of a ray through a medium, about, as far as a channel reaches: behind this optical depth lies 2e-9 of what it brings.
const STEPS: f64 = 200.0;
const DEPTH: f64 = 20.0;

/// What is about the points that maps are asked at.
pub(super) struct Surroundings<'a> {
    scene: &'a Scene,
    extents: Vec<MediumExtent>,
    /// Bodies that part photons from a point, where a rule of the literature asks for them.
    walls: Option<Vec<Shape>>,
}

impl<'a> Surroundings<'a> {
    pub(super) fn of(scene: &'a Scene, estimator: &Estimator) -> Self {
        let walls = || scene.objects().iter().map(|object| object.shape.clone()).collect();
        let walls = estimator.needs_walls().then(walls);
        Surroundings { scene, extents: medium_extents(scene), walls }
    }

    /// The boundary of a medium.
    fn boundary(&self, number: usize) -> Boundary<'_> {
        let boundary = self.extents[number].boundary();
        match &self.walls {
            Some(walls) => boundary.about(&[]).with_walls(walls),
            None => boundary,
        }
    }
}

/// What a map answers for every bin of a sensor; seed, replicate and number of the sensor say where in the bins it is asked.
///
/// # Errors
/// `Error::Scene` for a bin that reaches outside of all media, and for a ball that is too small beside the map
pub(super) fn read_bins(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    sensor: &Sensor,
    estimator: &Estimator,
    (seed, replicate, number): (u64, u64, usize),
    result: &mut PhotonReadings,
) -> Result<Vec<Spectrum>> {
    map.check_radius(estimator.least_named_radius())?;
    let one = |bin: usize| {
        let number = (bin as u64) << 32 | number as u64;
        let mut stream = Stream::new(seed, Purpose::Resampling, replicate, number);
        let mut booked = PhotonReadings::new();
        let value = read(around, map, (sensor, bin), estimator, &mut stream, &mut booked);
        value.map(|value| (value, booked))
    };
    let bins = sensor.binned().map_or(1, Binned::bins);
    let mut values = Vec::with_capacity(bins);
    for read in in_parallel(bins, one) {
        let (value, booked) = read?;
        // Where the k nearest photons lie close together, the ball is known only now.
        map.check_radius(booked.least_radius)?;
        values.push(value);
        result.gathers += booked.gathers;
        result.underfull += booked.underfull;
        result.beyond += booked.beyond;
        result.least_radius = result.least_radius.min(booked.least_radius);
    }
    Ok(values)
}

/// That a fluence is asked for where a map has none.
pub(super) fn outside(sensor: &Sensor, p: DVec3) -> Error {
    Error::Scene(format!(
        "sensor {}: a photon map knows the fluence only where light of every channel collides, and ({}, {}, {}) is outside: use paths",
        sensor.name, p.x, p.y, p.z
    ))
}

/// Points of a bin that a map is asked at: other ones each time, so that few do.
const POINTS: usize = 4;

/// One estimate from a map: of a bin, the mean over some of its points.
fn read(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    (sensor, bin): (&Sensor, usize),
    estimator: &Estimator,
    stream: &mut Stream,
    result: &mut PhotonReadings,
) -> Result<Spectrum> {
    let scene = around.scene;
    match &sensor.quantity {
        Quantity::Fluence(p) => Ok(fluence_at(around, map, *p, estimator, result)),
        Quantity::Radiance(ray) => Ok(radiance(around, map, ray, sensor.orders, estimator, stream, result)),
        Quantity::Outflow { .. } | Quantity::Absorbed(_) => Ok(Spectrum::ZERO),
        Quantity::Binned(binned) => {
            let mut sum = Spectrum::ZERO;
            for _ in 0..POINTS {
                let p = binned.point(bin, scene.periodic_cell(), stream.triple());
                sum += match binned {
                    Binned::Fluence { .. } if !has_extinction(scene, p) => return Err(outside(sensor, p)),
                    Binned::Fluence { .. } => fluence_at(around, map, p, estimator, result),
                    Binned::Radiance { dir, .. } => {
                        let ray = Ray::new(p, *dir);
                        radiance(around, map, &ray, sensor.orders, estimator, stream, result)
                    }
                    Binned::Flux { .. } | Binned::Absorption { .. } => Spectrum::ZERO,
                };
            }
            Ok(sum / POINTS as f64)
        }
    }
}

/// Fluence at a point in a medium.
fn fluence_at(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    p: DVec3,
    estimator: &Estimator,
    result: &mut PhotonReadings,
) -> Spectrum {
    let scene = around.scene;
    let number = scene.medium_number_at(p);
    let boundary = number.map_or(Boundary::UNKNOWN, |number| around.boundary(number));
    let estimate = match (map, estimator.of_beams(), number) {
        (AskedMap::Points(map, _), ..) => {
            let sigma_t = number.map_or(Spectrum::ONE, |number| scene.medium(number).sigma_t(p));
            estimator.fluence(map, p, sigma_t, &boundary)
        }
        (AskedMap::Beams(map), Some(of_beams), Some(number)) => {
            let of = (number, scene.medium(number));
            match estimator.beam_blur {
                BeamBlur::OneD | BeamBlur::TwoD => of_beams.fluence(map, p, of, &boundary),
                BeamBlur::ThreeD => of_beams.fluence_in_3d(map, p, of, &boundary),
            }
        }
        // No sensor of fluence is given planes, or a place outside of all media.
        _ => return Spectrum::grey(f64::NAN),
    };
    result.book(scene, p, &estimate, estimator.treatment);
    estimate.value
}

/// Radiance along a ray: uncollided light in closed form, and what media scatter, marched in random steps, so that the integral
/// along the ray has no step bias.
fn radiance(
    around: &Surroundings<'_>,
    map: AskedMap<'_>,
    ray: &Ray,
    orders: Orders,
    estimator: &Estimator,
    stream: &mut Stream,
    result: &mut PhotonReadings,
) -> Spectrum {
    let (scene, mut sum) = (around.scene, Spectrum::ZERO);
    let end = scene.hit(ray, None).map_or(f64::INFINITY, |h| h.hit.t);
    let (interior, size) = (scene.interior_at(ray.origin), scene_size(scene));
    if orders.contains(0) {
        let only_direct = Orders::only(0);
        path::radiance(scene, (*ray, interior), only_direct, Guides::default(), stream, |_, value| {
            sum += value
        });
    }
    if estimator.ray_ends == RayEnds::Own {
        let stored = match map {
            AskedMap::Points(map, radii) => Stretched::Points(map, radii),
            AskedMap::Beams(map) => Stretched::Beams(map),
            AskedMap::Planes(..) => return Spectrum::grey(f64::NAN),
        };
        sum += estimator.radiance_of_own_ends(scene, stored, ray).value;
        result.gathers += 1;
        return sum;
    }
    for segment in scene.segments(ray, end, interior).iter() {
        let medium = scene.medium(segment.medium);
        let boundary = around.boundary(segment.medium);
        if estimator.reads_rays() {
            let before = transmittance(scene, ray, segment.interval.start, interior, stream);
            let span = seen(medium, segment.interval);
            let passage = Passage::new(medium, ray, span, stream);
            let (way, passed) = ((ray, span), |t: f64| passage.to(t));
            let across = |map: &BeamMap| {
                let (of_beams, of) = (estimator.of_beams()?, (segment.medium, medium));
                Some(match estimator.beam_blur {
                    BeamBlur::OneD => of_beams.radiance(map, way, of, &boundary, &passed).value,
                    BeamBlur::TwoD => of_beams.radiance_in_2d(map, way, of, &boundary, &passed).value,
                    BeamBlur::ThreeD => Spectrum::grey(f64::NAN),
                })
            };
            let value = match map {
                AskedMap::Points(map, radii) => estimator.of_rays().map(|of_rays| match radii {
                    Some(radii) => {
                        of_rays.radiance_by_radii((map, radii), way, medium, &boundary, &passed).value
                    }
                    None => of_rays.radiance(map, way, medium, &boundary, &passage).value,
                }),
                AskedMap::Beams(map) => across(map),
                AskedMap::Planes(planes, direct) => {
                    let of_planes =
                        |map| PlaneEstimator.radiance(map, way, (scene, segment.medium), &passed).value;
                    let once = direct.and_then(across);
                    Some(planes.map_or(Spectrum::ZERO, of_planes) + once.unwrap_or(Spectrum::ZERO))
                }
            };
            let Some(value) = value else { continue };
            result.gathers += 1;
            sum += before * value;
            continue;
        }
        let AskedMap::Points(map, _) = map else { continue };
        let mut source = |p: DVec3| {
            if medium.sigma_t(p).is_black() {
                return Spectrum::ZERO;
            }
            let (wo, phase) = (-ray.dir, medium.phase());
            let estimate = estimator.in_scattered(map, p, wo, phase, Spectrum::ONE, &boundary);
            result.book(scene, p, &estimate, estimator.treatment);
            medium.albedo(p) * estimate.value
        };
        for (span, step) in stretches(medium, segment.interval) {
            let before = transmittance(scene, ray, span.start, interior, stream);
            if !before.is_black() {
                let march = March { is_jittered: true, ..March::equal(step, StepRule::Integrated) };
                sum += before * along(medium, (ray, span), &march, size, stream, &mut source);
            }
        }
    }
    sum
}

/// The part of a span that is seen: as far as the thinnest channel reaches, where that is known.
fn seen(medium: &Medium, span: Interval) -> Interval {
    let colliding = medium.highest_sigma_t().0.to_array().into_iter().filter(|s| *s > 0.0);
    let reach = colliding.map(|s| DEPTH / s).fold(0.0, f64::max);
    let end = if medium.is_homogeneous() { span.end.min(span.start + reach) } else { span.end };
    Interval { end, ..span }
}

/// How a span of a medium is marched through: parts of it with their steps \[L\], one as far as each channel reaches, so that
/// the densest is not one step among those of the thinnest; none where nothing collides.
fn stretches(medium: &Medium, span: Interval) -> Vec<(Interval, Positive)> {
    let colliding = medium.highest_sigma_t().0.to_array().into_iter().filter(|s| *s > 0.0);
    // Where the density varies it may be far below its bound.
    let is_short = !medium.is_homogeneous() && span.length() < f64::INFINITY;
    let reach = |s: f64| if is_short { span.length() } else { span.length().min(DEPTH / s) };
    let mut reaches: Vec<f64> = colliding.map(reach).collect();
    reaches.sort_by(f64::total_cmp);
    reaches.dedup();
    let last = reaches.len().saturating_sub(1);
    let mut start = span.start;
    let part = |(number, reach): (usize, f64)| {
        let end = if number == last { span.end } else { span.start + reach };
        let part = Interval { start, end };
        start = end;
        Some((part, Positive::new("the step", reach / STEPS).ok()?))
    };
    reaches.into_iter().enumerate().filter_map(part).collect()
}
