//! Sensors read by the path tracer, and by the bidirectional one.

use super::{Measurement, Source, measurements, room};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::integrators::{Guides, Rays, bidirectional, direct_flux, fluence, radiance};
use crate::light::PeriodicCell;
use crate::math::{Frame, Ray, warp};
use crate::photons::check_end;
use crate::rng::{Purpose, Stream};
use crate::scene::{Binned, Crossing, Orders, Quantity, Scene, Sensor};
use crate::stats::{Moments, Tail};
use crate::transport::{Progress, run_blocks};
use glam::DVec3;
use std::f64::consts::PI;

/// How many paths, and which.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathSettings {
    /// Paths a sensor.
    pub samples: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
    /// Orders that count, beside each sensor's own range.
    pub orders: Orders,
}

/// Reads every sensor of the scene by paths from it; samples of different sensors are independent.
///
/// # Errors
/// `Error::Unreachable` if the scene has path classes that paths cannot sample; `Error::NonFinite`;
/// `Error::Cancelled`.
pub fn by_paths(scene: &Scene, settings: &PathSettings, progress: &dyn Progress) -> Result<Vec<Measurement>> {
    by_guided_paths(scene, settings, Guides::default(), progress)
}

/// The same by paths that are connected to subpaths from the lights.
///
/// # Errors
/// those of [`by_paths`] and of [`bidirectional::check`]
pub fn by_bidirectional_paths(
    scene: &Scene,
    settings: &PathSettings,
    progress: &dyn Progress,
) -> Result<Vec<Measurement>> {
    bidirectional::check(scene)?;
    measured(scene, settings, Walk::Bidirectional, progress)
}

/// The same by paths that are guided.
///
/// # Errors
/// those of [`by_paths`]
pub fn by_guided_paths(
    scene: &Scene,
    settings: &PathSettings,
    guides: Guides<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Measurement>> {
    measured(scene, settings, Walk::Paths(guides), progress)
}

/// How the light that a sensor reads is found.
#[derive(Clone, Copy)]
enum Walk<'a> {
    /// By paths, guided or not.
    Paths(Guides<'a>),
    /// By paths that are connected to subpaths from the lights.
    Bidirectional,
}

impl Walk<'_> {
    /// One sample of the radiance that arrives along a ray, by order, and the work.
    fn radiance(
        self,
        scene: &Scene,
        ray: Ray,
        orders: Orders,
        stream: &mut Stream,
        mut collect: impl FnMut(u32, Spectrum),
    ) -> Rays {
        let interior = scene.interior_at(ray.origin);
        match self {
            Walk::Paths(guides) => radiance(scene, (ray, interior), orders, guides, stream, collect),
            Walk::Bidirectional => {
                bidirectional::classes(scene, ray, None, interior, orders, stream, |order, _, value| {
                    collect(order, value)
                })
            }
        }
    }

    /// One sample of the fluence at a point, by order, and the work.
    fn fluence(
        self,
        scene: &Scene,
        position: DVec3,
        orders: Orders,
        stream: &mut Stream,
        collect: impl FnMut(u32, Spectrum),
    ) -> Rays {
        match self {
            Walk::Paths(guides) => fluence(scene, position, orders, guides, stream, collect),
            Walk::Bidirectional => bidirectional::fluence(scene, position, orders, stream, collect),
        }
    }
}

fn measured(
    scene: &Scene,
    settings: &PathSettings,
    by: Walk,
    progress: &dyn Progress,
) -> Result<Vec<Measurement>> {
    check_paths(scene)?;
    let (mut all, mut index) = (room(scene), 0);
    for sensor in scene.sensors() {
        for bin in 0..sensor.binned().map_or(1, Binned::bins) {
            let (moments, tails) = match sensor.binned() {
                None => moments_of(index, settings, progress, |stream| {
                    sample_by(scene, &sensor.quantity, sensor.orders.and(&settings.orders), by, stream).0
                })?,
                Some(binned) => {
                    let orders = sensor.orders.and(&settings.orders);
                    let draw =
                        |stream: &mut Stream| sample_bin_by(scene, (binned, bin), orders, by, stream).0;
                    moments_of(index, settings, progress, draw)?
                }
            };
            all.extend(measurements(scene, sensor, &moments, Some(&tails), Source::Paths, Some(bin)));
            index += 1;
        }
    }
    Ok(all)
}

/// Whether paths can sample all that the scene's light does, and come to an end.
///
/// # Errors
/// `Error::Unreachable` if not; those of [`check_end`]
pub fn check_paths(scene: &Scene) -> Result<()> {
    let fills =
        |s: &&Sensor| matches!(s.quantity, Quantity::Absorbed(number) if number >= scene.regions().len());
    if let Some(sensor) = scene.sensors().iter().find(fills) {
        return Err(Error::Unreachable(format!(
            "sensor {}: paths measure what is absorbed in a region, not in what fills an interior: use photons",
            sensor.name
        )));
    }
    if !scene.plan().unreachable.is_empty() {
        return Err(Error::Unreachable(format!(
            "the path tracer cannot sample every path of this scene ({}): use photons, or a light with an extent",
            scene.plan().unreachable.join("; ")
        )));
    }
    check_end(scene)
}

/// Moments and tails by channel of one sensor; `index` keeps the streams of sensors apart.
pub(super) fn read(
    scene: &Scene,
    sensor: &Sensor,
    index: u64,
    settings: &PathSettings,
    guides: Guides<'_>,
    progress: &dyn Progress,
) -> Result<([Moments; 3], [Tail; 3])> {
    let orders = sensor.orders.and(&settings.orders);
    moments_of(index, settings, progress, |stream| {
        sample_guided(scene, &sensor.quantity, orders, guides, stream).0
    })
}

/// Moments and tails by channel of what `draw` makes of each stream.
fn moments_of(
    index: u64,
    settings: &PathSettings,
    progress: &dyn Progress,
    draw: impl Fn(&mut Stream) -> Spectrum + Sync,
) -> Result<([Moments; 3], [Tail; 3])> {
    let block = |range: std::ops::Range<u64>| {
        let (mut moments, mut tails, mut non_finite) = <([Moments; 3], [Tail; 3], u64)>::default();
        for history in range {
            // The sensor, or its bin, takes the upper bits of the history: no run has 2^40 of them.
            let mut stream =
                Stream::new(settings.seed, Purpose::Paths, settings.replicate, index << 40 | history);
            let value = draw(&mut stream);
            non_finite += u64::from(!value.is_finite());
            for (channel, (m, tail)) in moments.iter_mut().zip(&mut tails).enumerate() {
                m.push(value[channel]);
                // What a net flux loses has a tail too.
                tail.push(value[channel].abs());
            }
        }
        (moments, tails, non_finite)
    };
    type Read = ([Moments; 3], [Tail; 3], u64);
    let merge = |mut a: Read, b: Read| {
        a.0.iter_mut().zip(&b.0).for_each(|(mine, others)| mine.merge(others));
        a.1.iter_mut().zip(&b.1).for_each(|(mine, others)| mine.merge(others));
        (a.0, a.1, a.2 + b.2)
    };
    let (moments, tails, non_finite) =
        run_blocks(settings.samples, progress, block, merge)?.unwrap_or_default();
    if non_finite > 0 {
        return Err(Error::NonFinite { count: non_finite, place: "paths" });
    }
    Ok((moments, tails))
}

/// One sample of a quantity.
pub fn sample(scene: &Scene, quantity: &Quantity, orders: Orders, stream: &mut Stream) -> Spectrum {
    sample_counted(scene, quantity, orders, stream).0
}

/// One sample of a quantity, and the rays it took.
pub fn sample_counted(
    scene: &Scene,
    quantity: &Quantity,
    orders: Orders,
    stream: &mut Stream,
) -> (Spectrum, Rays) {
    sample_guided(scene, quantity, orders, Guides::default(), stream)
}

/// The same by paths that are guided.
pub fn sample_guided(
    scene: &Scene,
    quantity: &Quantity,
    orders: Orders,
    guides: Guides<'_>,
    stream: &mut Stream,
) -> (Spectrum, Rays) {
    sample_by(scene, quantity, orders, Walk::Paths(guides), stream)
}

fn sample_by(
    scene: &Scene,
    quantity: &Quantity,
    orders: Orders,
    by: Walk,
    stream: &mut Stream,
) -> (Spectrum, Rays) {
    let side = PeriodicCell::side(scene.periodic_cell());
    let mut sum = Spectrum::ZERO;
    let mut rays = Rays::default();
    match quantity {
        Quantity::Fluence(p) => rays = by.fluence(scene, *p, orders, stream, |_, value| sum += value),
        Quantity::Radiance(ray) => {
            rays = by.radiance(scene, *ray, orders, stream, |_, value| sum += value);
        }
        Quantity::Outflow { shape, face } => {
            let (position, normal, area) = shape.sample_boundary(*face, side, stream.triple());
            sum = flux(scene, (position, normal), orders, by, stream, &mut rays);
            sum = per_power(sum * area, scene.power());
        }
        Quantity::Absorbed(region) => {
            let region = *region;
            let (position, volume) = scene.regions()[region].shape.sample_inside(side, stream.triple());
            // Where a later region covers this one nothing of it is left to absorb.
            if scene.medium_number_at(position) == Some(region) {
                rays = by.fluence(scene, position, orders, stream, |_, value| sum += value);
            }
            sum = sum * scene.regions()[region].medium.sigma_a(position) * volume;
            sum = per_power(sum, scene.power());
        }
        Quantity::Binned(binned) => {
            let bin = stream.index(binned.bins());
            (sum, rays) = sample_bin_by(scene, (binned, bin), orders, by, stream);
        }
    }
    (sum, rays)
}

/// One sample of the mean over a bin, and the rays it took: the field at a uniform point of the bin.
pub fn sample_bin(
    scene: &Scene,
    (binned, bin): (&Binned, usize),
    orders: Orders,
    stream: &mut Stream,
) -> (Spectrum, Rays) {
    sample_bin_by(scene, (binned, bin), orders, Walk::Paths(Guides::default()), stream)
}

fn sample_bin_by(
    scene: &Scene,
    (binned, bin): (&Binned, usize),
    orders: Orders,
    by: Walk,
    stream: &mut Stream,
) -> (Spectrum, Rays) {
    let position = binned.point(bin, scene.periodic_cell(), stream.triple());
    let mut sum = Spectrum::ZERO;
    let rays = match binned {
        Binned::Flux { bins, crossing } => {
            let normal = bins.rectangle().normal();
            let mut rays = Rays::default();
            for (along, sign) in [(normal, 1.0), (-normal, -1.0)] {
                match (crossing, sign > 0.0) {
                    (Crossing::Net, _) => {
                        sum += flux(scene, (position, along), orders, by, stream, &mut rays) * sign
                    }
                    (Crossing::Along, true) | (Crossing::Against, false) => {
                        sum += flux(scene, (position, along), orders, by, stream, &mut rays);
                    }
                    _ => {}
                }
            }
            rays
        }
        Binned::Radiance { dir, .. } => {
            by.radiance(scene, Ray::new(position, *dir), orders, stream, |_, value| sum += value)
        }
        Binned::Fluence { .. } => by.fluence(scene, position, orders, stream, |_, value| sum += value),
        Binned::Absorption { .. } => {
            let sigma_a = scene.medium_at(position).map_or(Spectrum::ZERO, |m| m.sigma_a(position));
            match sigma_a.is_black() {
                true => Rays::default(),
                false => by.fluence(scene, position, orders, stream, |_, value| sum += value * sigma_a),
            }
        }
    };
    (sum, rays)
}

/// One sample of the power by area that crosses a plane at a point, along its normal [W/L^2].
fn flux(
    scene: &Scene,
    (position, normal): (DVec3, DVec3),
    orders: Orders,
    by: Walk,
    stream: &mut Stream,
    rays: &mut Rays,
) -> Spectrum {
    let dir = Frame::new(-normal).to_world(warp::square_to_cosine_hemisphere(stream.pair()));
    let mut sum = Spectrum::ZERO;
    let work = by.radiance(scene, Ray::new(position, dir), orders, stream, |_, value| sum += value);
    *rays = Rays { segments: rays.segments + work.segments, shadow: rays.shadow + work.shadow };
    sum *= PI;
    if orders.contains(0) {
        sum += direct_flux(scene, position, normal, stream, rays);
    }
    sum
}

/// By channel, 0 where nothing is emitted.
fn per_power(value: Spectrum, power: Spectrum) -> Spectrum {
    let ratio = |c: usize| if power[c] == 0.0 { 0.0 } else { value[c] / power[c] };
    Spectrum::rgb(ratio(0), ratio(1), ratio(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Shape, Slab};
    use crate::light::{Beam, Light, Section};
    use crate::medium::Homogeneous;
    use crate::phase::Phase;
    use crate::scene::{Region, SceneParts};
    use glam::DVec3;

    /// In a slab under a beam a path of order n has n + 1 segments and meets n collisions, each with a shadow ray;
    /// uncollided light has one more. With orders up to 1 every path has a first segment, and a second one, looked
    /// along but not flown, if it collides: shadow rays and segments are equal in number.
    #[test]
    fn rays_are_counted() {
        let phase = Phase::with_asymmetry(crate::math::Asymmetry::new("g", 0.0).unwrap());
        let medium = Homogeneous::new(Spectrum::ONE, Spectrum::ONE, phase).unwrap();
        let region = Region { shape: Shape::Slab(Slab::new(0.0, 1.0).unwrap()), medium: medium.into() };
        let beam = Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded).unwrap();
        let parts = SceneParts {
            regions: vec![region],
            lights: vec![Light::Beam(beam)],
            cell: Some(glam::DVec2::splat(4.0)),
            ..SceneParts::default()
        };
        let scene = Scene::new(parts).unwrap();
        let fluence = Quantity::Fluence(DVec3::new(2.0, 2.0, 0.5));
        let (mut one, mut two) = (0, 0);
        for history in 0..1000 {
            let mut stream = Stream::new(1, Purpose::Paths, 0, history);
            let (_, rays) = sample_counted(&scene, &fluence, Orders { min: 0, max: Some(1) }, &mut stream);
            assert_eq!(rays.segments, rays.shadow);
            assert_eq!(rays.total(), 2 * rays.segments);
            one += u64::from(rays.segments == 1);
            two += u64::from(rays.segments == 2);
            let mut stream = Stream::new(1, Purpose::Paths, 0, history);
            let (_, direct) = sample_counted(&scene, &fluence, Orders::only(0), &mut stream);
            assert_eq!((direct.segments, direct.shadow), (1, 1));
        }
        assert!(one + two == 1000 && one > 100 && two > 100, "{one} {two}");
    }
}
