//! Light tracing: the photons' own walk, connected to a pinhole camera at each scattering.
//!
//! It finds light that paths from the eye find badly, or not at all: what lights and specular surfaces throw on diffuse
//! ones and into fog. It does not find what the eye sees straight, lights and specular surfaces: no photon meets a
//! pinhole by itself.

use super::{Layer, Rays};
use crate::Spectrum;
use crate::math::{Ray, cosine_pair};
use crate::phase::PhaseFunction;
use crate::photons::Emitter;
use crate::rng::Stream;
use crate::scene::{Camera, Scene, SceneHit, Start, Target};
use crate::surface::Surface;
use crate::transport::{
    Arrival, EqualAngles, Flags, Roulette, Step, Visitor, Walker, connection, span, transmittance, walk,
};
use glam::{DVec2, DVec3};

/// Light that one scattering sends to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splat {
    /// Where it is seen, in raster coordinates.
    pub at: DVec2,
    /// The class of its path.
    pub layer: Layer,
    /// What it adds to a picture: a pixel's radiance is the mean over histories of the sum of these, each weighted by
    /// the density of the pixel's filter at the place [W/(L^2 sr)].
    pub value: Spectrum,
}

/// Follows one history and calls `splat` with all that it sends to the camera. Returns the work: flights, and connections
/// tried.
///
/// A scattering at x, of a photon of power P that leaves a fraction f [1/sr] of it towards the camera (of a surface: the
/// reflection function times the cosine), at a distance d under an angle theta to the line of sight, is seen with
/// P f T / (d^2 A cos^3 theta): P f T / d^2 is the irradiance it causes across the ray, and A cos^3 theta is the solid
/// angle of a pixel of area A on the plane at distance 1.
///
/// In media collisions alone would have an infinite variance, as 1/d^2 has about the camera. A second point on each
/// flight is chosen with equal angles about the camera; where the flight is at t, the two ways share the light in the
/// ratio of the mean extinction to the density of t by equal angles, which leaves at most the inverse of the flight's
/// distance to the camera. Any share is unbiased that depends on the place alone.
pub fn light_tracing(
    scene: &Scene,
    camera: &Camera,
    emitter: &Emitter,
    stream: &mut Stream,
    mut splat: impl FnMut(Splat),
) -> Rays {
    let Some(start) = emitter.emit(scene, stream) else { return Rays::default() };
    let mut tracer = Tracer { scene, camera, flight: None, rays: Rays::default(), splat: &mut splat };
    walk(scene, start, Roulette::Analog, None, stream, &mut tracer);
    tracer.rays
}

struct Tracer<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    /// The distances on the present flight that equal angles choose from.
    flight: Option<EqualAngles>,
    rays: Rays,
    splat: &'a mut dyn FnMut(Splat),
}

/// A scattering as the camera sees it.
struct Event {
    position: DVec3,
    origin_surface: Option<Start>,
    kind: Flags,
}

impl Tracer<'_> {
    /// Sends `weight` to the camera, of which `scattered` is the fraction that leaves into a direction [1/sr].
    fn connect(
        &mut self,
        walker: &Walker,
        weight: Spectrum,
        event: Event,
        stream: &mut Stream,
        scattered: impl Fn(DVec3) -> Spectrum,
    ) {
        let Some(at) = self.camera.project(event.position) else { return };
        if !self.camera.is_near(at) {
            return;
        }
        let to_camera = self.camera.position() - event.position;
        let distance = to_camera.length();
        let ray = Ray::new(event.position, to_camera / distance);
        let fraction = scattered(ray.dir);
        if fraction.is_black() {
            return;
        }
        self.rays.shadow += 1;
        let start = (&ray, event.origin_surface, walker.interior);
        let Some(transmitted) = connection(self.scene, start, distance, None, stream) else { return };
        let cosine = -ray.dir.dot(self.camera.forward());
        let solid_angle = self.camera.pixel_area() * cosine * cosine * cosine;
        let value = weight * fraction * transmitted / (distance * distance * solid_angle);
        let is_by_specular = walker.order == 0 && walker.flags.has(Flags::SPECULAR);
        let layer = Layer::of(walker.order + 1, event.kind, is_by_specular);
        (self.splat)(Splat { at, layer, value });
    }

    /// A point on the flight ahead, chosen with equal angles.
    fn look_from_flight(&mut self, walker: &Walker, hit: Option<&SceneHit>, stream: &mut Stream) {
        self.flight = None;
        if !self.scene.plan().has_media {
            return;
        }
        let end = hit.map_or(f64::INFINITY, |h| h.hit.t);
        let Some(span) = span(self.scene, &walker.ray, end, walker.interior) else { return };
        let flight = EqualAngles::new(&walker.ray, self.camera.position(), span);
        let chosen = flight.sample(stream.unit());
        let density = |t| flight.pdf(t);
        if let Some(t) = chosen
            && let Some(segment) =
                self.scene.segments(&walker.ray, end, walker.interior).iter().find(|s| t <= s.interval.end)
            && t >= segment.interval.start
        {
            let medium = self.scene.medium(segment.medium);
            let position = walker.ray.at(t);
            let sigma_t = medium.sigma_t(position);
            let transmitted = transmittance(self.scene, &walker.ray, t, walker.interior, stream);
            let weight = walker.weight * transmitted * sigma_t / (density(t) + sigma_t.mean());
            let event = Event { position, origin_surface: None, kind: Flags::MEDIUM };
            self.connect(walker, weight, event, stream, |towards| {
                let (one_minus_mu, one_plus_mu) = cosine_pair(walker.ray.dir, towards);
                medium.albedo(position) * medium.phase().eval(one_minus_mu, one_plus_mu)
            });
        }
        self.flight = Some(flight);
    }
}

impl Visitor for Tracer<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        match step {
            Step::Ahead(hit) => {
                self.rays.segments += 1;
                self.look_from_flight(walker, hit, stream);
            }
            Step::Collision(Arrival { position, .. }, number) => {
                let medium = self.scene.medium(number);
                let sigma_t = medium.sigma_t(position).mean();
                let t = position.distance(walker.ray.origin);
                let pdf = self.flight.as_ref().map_or(0.0, |flight| flight.pdf(t));
                let weight = walker.weight * (sigma_t / (sigma_t + pdf));
                let event = Event { position, origin_surface: None, kind: Flags::MEDIUM };
                self.connect(walker, weight, event, stream, |towards| {
                    let (one_minus_mu, one_plus_mu) = cosine_pair(walker.ray.dir, towards);
                    medium.albedo(position) * medium.phase().eval(one_minus_mu, one_plus_mu)
                });
            }
            Step::Surface(Arrival { position, .. }, found) => {
                let Target::Object(index) = found.target else { return };
                let Surface::Lambertian(surface) = &self.scene.objects()[index].surface else { return };
                let outward = found.hit.normal;
                let normal = if walker.ray.dir.dot(outward) < 0.0 { outward } else { -outward };
                let reflection = surface.eval(position, found.hit.uv);
                let event = Event { position, origin_surface: Some(found.start()), kind: Flags::DIFFUSE };
                self.connect(walker, walker.weight, event, stream, |towards| {
                    reflection * towards.dot(normal).max(0.0)
                });
            }
            Step::Uncollided(..) | Step::Absorbed(..) | Step::Escaped(_) | Step::Truncated(_) => {}
        }
    }
}
