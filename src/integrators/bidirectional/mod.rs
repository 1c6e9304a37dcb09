//! The bidirectional path tracer: subpaths from the eye and from lights, every vertex of one connected to every vertex of the other.
//!
//! It is unbiased as the path tracer is, and finds light that paths find badly: what lamps that are small, or hidden behind glass,
//! throw on surfaces and into media, once it is scattered again before the eye. What is scattered once alone, and lights seen
//! straight, are the path tracer's, in its own techniques (in pictures all but caustics, which photons bring to the camera); so is,
//! at every order, the light that fills volumes or comes from all sides.

mod light;
mod pinhole;
mod sources;
#[cfg(test)]
mod tests;
mod vertex;
mod weights;

pub use pinhole::Pinhole;

use super::light_tracing::Splat;
use super::path::{Collect, PathVisitor, ROULETTE, aimed_fluence, anywhere, next_event};
use super::{Layer, Layers, Rays};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Hit;
use crate::math::Ray;
use crate::photons::check_end;
use crate::rng::Stream;
use crate::scene::{Orders, Scene, SceneHit, Start, Target};
use crate::transport::{Roulette, Step, Visitor, Walker, connection, transmittance, walk};
use glam::DVec3;
use light::subpath;
use sources::{Arriving, Sources};
use vertex::{Vertex, is_specular};
use weights::Ways;

/// Whether subpaths of light can be connected to paths from the eye.
///
/// # Errors
/// `Error::Unreachable` for scenes with a periodic cell, in each of whose copies lights would have to start; those of [`check_end`]
pub fn check(scene: &Scene) -> Result<()> {
    if scene.periodic_cell().is_some() {
        return Err(Error::Unreachable(
            "bidirectional paths do not start from lights in every copy of a periodic cell; allowed: scenes without `cell`, or \
             paths"
                .into(),
        ));
    }
    check_end(scene)
}

/// One sample of the radiance that arrives at the origin of `ray` from ahead [W/(L^2 sr)], by order and class:
/// `collect` is called with the order, the class and the contribution. The ray starts in the interior of this number.
/// Returns the work.
pub fn classes(
    scene: &Scene,
    ray: Ray,
    origin_surface: Option<Start>,
    interior: usize,
    orders: Orders,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Layer, Spectrum),
) -> Rays {
    let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
    follow((scene, None), start, orders, Rays::default(), stream, &mut collect)
}

/// One sample of the fluence at a point [W/L^2], by order, in a uniform direction and in those that [`super::fluence`] aims at.
/// Returns the work.
pub fn fluence(
    scene: &Scene,
    position: DVec3,
    orders: Orders,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Spectrum),
) -> Rays {
    let rays = aimed_fluence(scene, (position, None), orders, stream, &mut collect);
    let start = anywhere(scene, (position, None), stream);
    follow((scene, None), start, orders, rays, stream, &mut |order, _, value| collect(order, value))
}

/// A subpath of light, and a path that is connected to it.
fn follow(
    (scene, pinhole): (&Scene, Option<&Pinhole>),
    start: Walker,
    orders: Orders,
    mut rays: Rays,
    stream: &mut Stream,
    collect: &mut Collect<'_>,
) -> Rays {
    let sources = Sources::new(scene);
    // The last scattering is the eye's.
    let light = match orders.max {
        Some(max) if max < 2 => Vec::new(),
        max => subpath(scene, &sources, max.map(|max| max - 1), &mut rays, stream),
    };
    // Towards a delta light distances on the first ray are chosen too.
    let above = if pinhole.is_some() { [0, 1] } else { [1, 1] };
    let path = PathVisitor::new(scene, orders, rays, collect).without_joined_above(above);
    let mut visitor =
        Eye { scene, pinhole, sources, light, path, last: None, leaving: None, is_specular: false };
    let roulette = Roulette::below(ROULETTE * start.weight.max());
    walk(scene, start, roulette, orders.max, stream, &mut visitor);
    visitor.path.rays()
}

/// One sample of the radiance that arrives at the origin of `ray` from ahead [W/(L^2 sr)], by class, and the work.
pub fn layers(
    scene: &Scene,
    ray: Ray,
    origin_surface: Option<Start>,
    interior: usize,
    stream: &mut Stream,
) -> (Layers, Rays) {
    let mut layers = Layers::ZERO;
    let rays = classes(scene, ray, origin_surface, interior, Orders::ALL, stream, |_, layer, value| {
        layers[layer] += value
    });
    (layers, rays)
}

/// One sample of the part of a picture along a ray of its camera [W/(L^2 sr)], by class, that [`splats`] leaves to it, and the work.
pub fn seen(
    scene: &Scene,
    pinhole: &Pinhole,
    ray: Ray,
    interior: usize,
    stream: &mut Stream,
) -> (Layers, Rays) {
    let mut layers = Layers::ZERO;
    let start = Walker { interior, ..Walker::new(ray, Spectrum::ONE) };
    let orders = Orders::ALL;
    let mut collect = |_, layer, value| layers[layer] += value;
    let rays = follow((scene, Some(pinhole)), start, orders, Rays::default(), stream, &mut collect);
    (layers, rays)
}

/// Follows a subpath of light and calls `splat` with what its scatterings send to the camera, weighted against [`seen`]: as
/// [`super::light_tracing`]. Returns the work.
///
/// What delta lights send straight to a scattering that is the only one is left out: the eye's subpath finds it by distances on its rays that
/// are chosen for these lights.
pub fn splats(scene: &Scene, pinhole: &Pinhole, stream: &mut Stream, mut splat: impl FnMut(Splat)) -> Rays {
    let (sources, mut rays) = (Sources::new(scene), Rays::default());
    let light = subpath(scene, &sources, None, &mut rays, stream);
    for vertex in &light {
        let is_by_specular = vertex.order == 1 && vertex.ways.connected == 0.0;
        if vertex.order == 1 && !is_by_specular && vertex.ways.beyond == 0.0 {
            continue;
        }
        let Some((at, dir, distance)) = pinhole.look(vertex.position) else { continue };
        let fraction = vertex.sent(dir);
        if fraction.is_black() {
            continue;
        }
        rays.shadow += 1;
        let ray = Ray::new(vertex.position, dir);
        let start = (&ray, vertex.body, vertex.interior);
        let Some(transmitted) = connection(scene, start, distance, None, stream) else { continue };
        let others = vertex.ways.others(pinhole.pdf(scene, vertex, dir), vertex.turned(dir));
        let value = vertex.weight * fraction * transmitted * pinhole.irradiance_to_radiance(dir, distance);
        let layer = Layer::of(vertex.order, vertex.kind(), is_by_specular);
        splat(Splat { at, layer, value: value / (1.0 + others) });
    }
    rays
}

/// The eye's subpath: it connects each of its vertices as it comes to it, and remembers the last one.
struct Eye<'a> {
    scene: &'a Scene,
    /// The camera that photons are connected to as well, if they are.
    pinhole: Option<&'a Pinhole<'a>>,
    sources: Sources<'a>,
    /// The subpath of light, nearest to the light first.
    light: Vec<Vertex<'a>>,
    /// What paths collect beside it.
    path: PathVisitor<'a>,
    last: Option<Vertex<'a>>,
    /// Direction in which it left its last vertex, and whether it met a specular surface since.
    leaving: Option<DVec3>,
    is_specular: bool,
}

impl<'a> Eye<'a> {
    /// The class of light of an order whose path has this vertex, by specular surfaces from the light or not.
    fn layer(&self, order: u32, vertex: &Vertex, is_by_specular: bool) -> Layer {
        let first = if vertex.order == 1 { vertex.kind() } else { self.path.first() };
        Layer::of(order, first, is_by_specular)
    }

    /// The first order at which photons that reach the eye, or are connected to its subpath, make what it finds itself.
    fn first_joined(&self) -> u32 {
        if self.pinhole.is_some() { 1 } else { 2 }
    }

    /// The lights that the ray meets by itself.
    fn meet(&mut self, walker: &Walker, hit: Option<&SceneHit>, stream: &mut Stream) {
        let (Some(last), Some(leaving)) = (self.last, self.leaving) else { return };
        if last.order < self.first_joined() {
            return;
        }
        if !self.path.contains(walker.order) {
            return;
        }
        for index in self.sources.numbers() {
            let light = &self.scene.lights()[index];
            let seen_along = Ray::new(walker.sampled_at, walker.ray.dir);
            let found = match hit {
                Some(found) if found.target == Target::Light(index) => {
                    let t = found.hit.t + walker.sampled_at.distance(walker.ray.origin);
                    let hit = Hit { t, ..found.hit };
                    Some((light.emitted(&seen_along, &hit), t))
                }
                None => light.background(&walker.ray).map(|seen| (seen, f64::INFINITY)),
                _ => None,
            };
            let Some(((radiance, pdf_light), t)) = found.filter(|((radiance, _), _)| !radiance.is_black())
            else {
                continue;
            };
            let scale = self.is_specular.then(|| self.sources.scale(last.interior, walker.interior));
            let arriving = Arriving::met(radiance, pdf_light, t);
            let [share, _] = self.sources.shares(&last, leaving, &arriving, scale);
            let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
            let transmitted = transmittance(self.scene, &walker.ray, end, walker.interior, stream);
            let layer = self.layer(last.order, &last, self.is_specular);
            self.path.add(walker.order, layer, walker.weight * radiance * transmitted * share);
        }
    }

    /// A scattering: connected to the lights and to their subpath.
    fn scatter(&mut self, mut vertex: Vertex<'a>, stream: &mut Stream) {
        vertex.ways = match (self.last, self.leaving, self.pinhole) {
            (Some(last), Some(leaving), _) => last.ways_to(self.scene, &vertex, leaving, !self.is_specular),
            (None, _, Some(pinhole)) if !self.is_specular => pinhole.ways(self.scene, &vertex),
            _ => Ways::FIRST,
        };
        if vertex.order >= self.first_joined() && self.path.contains(vertex.order) {
            self.aim(&vertex, stream);
        }
        self.connect(&vertex, stream);
        (self.last, self.leaving, self.is_specular) = (Some(vertex), None, false);
    }

    /// Next-event estimation.
    fn aim(&mut self, vertex: &Vertex, stream: &mut Stream) {
        let (scene, layer) = (self.scene, self.layer(vertex.order, vertex, false));
        let place = (vertex.position, vertex.body, vertex.interior);
        let numbers: Vec<usize> = self.sources.numbers().collect();
        for index in numbers {
            if vertex.order == 1 && scene.lights()[index].is_delta() {
                continue;
            }
            let found = next_event(scene, index, place, stream, self.path.rays_mut());
            let Some((sample, received)) = found else { continue };
            let fraction = vertex.gathered(sample.dir);
            if fraction.is_black() {
                continue;
            }
            let [_, share] = self.sources.shares(vertex, sample.dir, &Arriving::aimed(&sample), None);
            self.path.add(vertex.order, layer, vertex.weight * fraction * received * share);
        }
    }

    /// Connections with the subpath of light.
    fn connect(&mut self, vertex: &Vertex, stream: &mut Stream) {
        let (scene, layer) = (self.scene, self.layer(2, vertex, false));
        for light in &self.light {
            let order = vertex.order + light.order;
            if !self.path.contains(order) {
                continue;
            }
            let between = light.position - vertex.position;
            let squared = between.length_squared();
            let distance = squared.sqrt();
            let dir = between / distance;
            if !dir.is_finite() {
                continue;
            }
            let scattered = vertex.gathered(dir) * light.sent(-dir);
            if scattered.is_black() {
                continue;
            }
            self.path.rays_mut().shadow += 1;
            let ray = Ray::new(vertex.position, dir);
            let start = (&ray, vertex.body, vertex.interior);
            let towards = light.body.map(|body| body.target);
            let Some(transmitted) = connection(scene, start, distance, towards, stream) else { continue };
            let share = light.share(scene, vertex, dir, distance);
            let value = vertex.weight * scattered * transmitted * light.weight * (share / squared);
            self.path.add(order, layer, value);
        }
    }
}

impl Visitor for Eye<'_> {
    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        self.path.visit(walker, step, stream);
        match step {
            Step::Ahead(hit) => {
                self.leaving.get_or_insert(walker.ray.dir);
                self.meet(walker, hit, stream);
            }
            Step::Collision(arrival, number) => {
                self.scatter(Vertex::in_medium(self.scene, &arrival, number), stream);
            }
            Step::Surface(arrival, found) => match Vertex::on_surface(self.scene, &arrival, found) {
                Some(vertex) => self.scatter(vertex, stream),
                None => self.is_specular |= is_specular(self.scene, found),
            },
            Step::Uncollided(..) | Step::Absorbed(..) | Step::Escaped(_) | Step::Truncated(_) => {}
        }
    }
}
