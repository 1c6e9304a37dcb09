//! The unbiased path tracer.
//!
//! Each ray collects what it would meet by itself (lights' bodies, incidence, volume sources, media that emit), in closed form
//! where there is one, times the transmittance; each event connects to every light that can be aimed at. Volume sources
//! and media that emit fill space: towards a place in them a direction is chosen, and the whole ray along it collects their light,
//! so that nothing is divided by the square of a distance. Where both can find the same light, the balance heuristic shares it between
//! them, by the densities of the direction. Towards a
//! point light a second point on the ray is sampled with equal angles, in multiple importance with the free flight:
//! connections from free flights alone would have an infinite variance, and equal angles alone miss the rays that run
//! through the light itself. For a beam the second point is sampled evenly where the beam crosses the ray: free flights
//! hardly ever end in a narrow one.

use super::{Layer, Layers, emitters};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::geometry::Hit;
use crate::light::{Light, LightSample};
use crate::math::{FOUR_PI, Interval, Ray, cosine_pair, warp};
use crate::medium::Medium;
use crate::phase::PhaseFunction;
use crate::photons::Guide;
use crate::rng::Stream;
use crate::scene::{Orders, Scene, SceneHit, Start, Target, decay};
use crate::surface::Surface;
use crate::transport::{
    Arrival, Brightness, Distances, Flags, Lobe, Roulette, Step, Visitor, Walker, WeightWindows, Windowed,
    collected, connection, emission, span, transmittance, walk,
};
use glam::DVec3;

/// Throughput, relative to the start's, below which paths play roulette. Any value gives the same mean; 1/(variance x
/// time) in a box of fog (`cargo bench --bench fogbox`) is the same from 0.3 to 1 within the noise, and three quarters of
/// that at 0.1. Lower values waste time, higher ones make variances that are harder to estimate.
pub(super) const ROULETTE: f64 = 0.4;

/// Weight, relative to the start's, above which paths led by photons are split. Each event may double it, and dozens do where light
/// scatters so often: without a bound a few paths carry all. By 2 the error of pool, cognac and of what lies below a pane of glass is the
/// same as without, and the sunbeams' a sixth less; by 4 and 8 tails are longer.
const HEAVIEST: f64 = 2.0;

/// The work of paths: rays asked what they meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rays {
    /// Segments of paths, each followed to what is ahead.
    pub segments: u64,
    /// Shadow rays: connections to lights, tested for what stands between.
    pub shadow: u64,
}

impl Rays {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.segments + self.shadow
    }
}

/// What is known of where light is, for paths to be led there: by one of these, since windows end what photons have led to bright
/// places. Every mean stays, whatever is known.
#[derive(Debug, Clone, Copy, Default)]
pub struct Guides<'a> {
    /// Weight windows, which split paths on their way to the lights and end them elsewhere: where light is found through many mean
    /// free paths.
    pub windows: Option<&'a WeightWindows>,
    /// What photons tell: where light is found by connections from few places only, behind glass and by way of mirrors, and where it is
    /// bright in a part of the media.
    pub learned: Option<&'a Guide>,
}

/// What is called with the order, the class and the contribution of what reaches a path's origin.
pub(super) type Collect<'a> = dyn FnMut(u32, Layer, Spectrum) + 'a;

/// What reaches a path's origin, split by the caller.
pub(super) struct PathVisitor<'a> {
    scene: &'a Scene,
    orders: Orders,
    collect: &'a mut Collect<'a>,
    rays: Rays,
    /// What the path's first scattering was.
    first: Flags,
    /// Distance to the body ahead of the present ray \[L\].
    end: f64,
    /// The games by which it is split and ended.
    windowed: Option<Windowed<'a>>,
    /// Where light comes from.
    guide: Option<&'a Guide>,
    /// The weight above which it is split, in those that roulette begins at.
    heaviest: f64,
    /// Orders above which light is left out of lights that do not fill space, if it is: of those that rays meet, and of delta lights.
    joined_above: Option<[u32; 2]>,
}

impl<'a> PathVisitor<'a> {
    pub(super) fn new(scene: &'a Scene, orders: Orders, rays: Rays, collect: &'a mut Collect<'a>) -> Self {
        PathVisitor {
            scene,
            orders,
            collect,
            rays,
            first: Flags::NONE,
            end: f64::INFINITY,
            windowed: None,
            guide: None,
            heaviest: f64::INFINITY,
            joined_above: None,
        }
    }

    /// The same without the light above these orders of lights that do not fill space: of those that rays meet, and of delta lights.
    pub(super) fn without_joined_above(self, orders: [u32; 2]) -> Self {
        PathVisitor { joined_above: Some(orders), ..self }
    }

    /// Whether it collects a light's part in paths of an order.
    fn has(&self, light: &Light, order: u32) -> bool {
        let is_left = |above: [u32; 2]| order <= above[usize::from(light.is_delta())] || light.fills_space();
        self.joined_above.is_none_or(is_left)
    }

    /// Whether an order counts.
    pub(super) fn contains(&self, order: u32) -> bool {
        self.orders.contains(order)
    }

    /// What the path's first scattering was.
    pub(super) fn first(&self) -> Flags {
        self.first
    }

    /// The work so far.
    pub(super) fn rays(&self) -> Rays {
        self.rays
    }

    /// The work so far, to be added to.
    pub(super) fn rays_mut(&mut self) -> &mut Rays {
        &mut self.rays
    }

    pub(super) fn add(&mut self, order: u32, layer: Layer, value: Spectrum) {
        if self.orders.contains(order) && !value.is_black() {
            (self.collect)(order, layer, value);
        }
    }

    /// The class of light that the ray meets by itself.
    fn layer_ahead(&self, walker: &Walker) -> Layer {
        // Only specular surfaces turn a path without a density.
        let is_by_specular = walker.pdf_solid_angle.is_none() && walker.flags.has(Flags::SPECULAR);
        Layer::of(walker.order, self.first, is_by_specular)
    }

    /// The class of light that a connection from an event brings straight from a light.
    fn layer_connected(&self, walker: &Walker, event: Flags) -> Layer {
        let first = if walker.order == 0 { event } else { self.first };
        Layer::of(walker.order + 1, first, false)
    }

    /// What the ray meets by itself.
    fn hit_emission(&mut self, walker: &Walker, hit: Option<&SceneHit>, stream: &mut Stream) {
        if !self.orders.contains(walker.order) {
            return;
        }
        let end = hit.map_or(f64::INFINITY, |h| h.hit.t);
        let layer = self.layer_ahead(walker);
        if let Some(found) = hit
            && let Target::Light(index) = found.target
            && self.has(&self.scene.lights()[index], walker.order)
        {
            let seen_along = sampled_along(walker);
            let seen_hit =
                Hit { t: found.hit.t + walker.sampled_at.distance(walker.ray.origin), ..found.hit };
            let (radiance, pdf_light) = self.scene.lights()[index].emitted(&seen_along, &seen_hit);
            let share = walker.pdf_solid_angle.map_or(1.0, |pdf| pdf / (pdf + pdf_light));
            let transmitted = transmittance(self.scene, &walker.ray, end, walker.interior, stream);
            let seen = radiance * transmitted * share;
            self.add(walker.order, layer, walker.weight * seen);
        }
        let mut emitted = emission(self.scene, &walker.ray, end, walker.interior, stream);
        let shared = walker.pdf_solid_angle.filter(|_| !planted(Fault::EmitterShareForgotten));
        if let Some(pdf) = shared.filter(|_| !emitted.is_black()) {
            emitted *= pdf / (pdf + emitters::pdf_solid_angle(self.scene, &sampled_along(walker)));
        }
        self.add(walker.order, layer, walker.weight * emitted);
        for light in self.scene.lights() {
            let mut seen = uncollided(self.scene, light, walker, end, stream);
            if let (Light::VolumeSource(source), Some(pdf)) = (light, shared) {
                seen *= pdf / (pdf + source.pdf_solid_angle(&sampled_along(walker)));
            }
            if hit.is_none()
                && self.has(light, walker.order)
                && let Some((radiance, pdf_light)) = light.background(&walker.ray)
            {
                let share = walker.pdf_solid_angle.map_or(1.0, |pdf| pdf / (pdf + pdf_light));
                seen +=
                    radiance * transmittance(self.scene, &walker.ray, end, walker.interior, stream) * share;
            }
            self.add(walker.order, layer, walker.weight * seen);
        }
    }

    /// Connects an event to every light; `scattered` is the fraction scattered into a direction [1/sr].
    fn connect(
        &mut self,
        (walker, event): (&Walker, Flags),
        position: DVec3,
        origin_surface: Option<Start>,
        stream: &mut Stream,
        scattered: impl Fn(DVec3) -> (Spectrum, f64),
        delta_share: impl Fn(&Light) -> f64,
    ) {
        if !self.orders.contains(walker.order + 1) || !has_next_event(self.scene) {
            return;
        }
        let layer = self.layer_connected(walker, event);
        for index in 0..self.scene.lights().len() {
            let light = &self.scene.lights()[index];
            if !self.has(light, walker.order + 1) {
                continue;
            }
            let place = (position, origin_surface, walker.interior);
            let found = next_event(self.scene, index, place, stream, &mut self.rays);
            let Some((sample, received)) = found else { continue };
            let (fraction, pdf) = scattered(sample.dir);
            let share = match sample.pdf_solid_angle {
                Some(pdf_light) => pdf_light / (pdf_light + pdf),
                None => delta_share(light),
            };
            let order = if planted(Fault::OrderOffByOne) { walker.order } else { walker.order + 1 };
            self.add(order, layer, walker.weight * fraction * received * share);
        }
        if let Some((dir, pdf_light)) = emitters::sample(self.scene, position, stream) {
            let (fraction, pdf) = scattered(dir);
            if !fraction.is_black() {
                let place = (Ray::new(position, dir), origin_surface, walker.interior);
                let seen = emitted_along(self.scene, place, stream, &mut self.rays);
                self.add(walker.order + 1, layer, walker.weight * fraction * seen / (pdf_light + pdf));
            }
        }
    }

    /// Remembers a scattering, if it is the first.
    fn scattered(&mut self, walker: &Walker, event: Flags) {
        if walker.order == 0 {
            self.first = event;
        }
    }

    /// A connection from a point of the ray that is chosen for each light for which distances are.
    fn connect_from_ray(&mut self, walker: &Walker, hit: Option<&SceneHit>, stream: &mut Stream) {
        let (scene, ray) = (self.scene, &walker.ray);
        let plan = scene.plan();
        if plan.distance_lights.is_empty() || !plan.has_media || !self.orders.contains(walker.order + 1) {
            return;
        }
        let end = hit.map_or(f64::INFINITY, |h| h.hit.t);
        let Some(span) = span(scene, ray, end, walker.interior) else { return };
        for &index in &plan.distance_lights {
            if !self.has(&scene.lights()[index], walker.order + 1) {
                continue;
            }
            let Some(distances) = Distances::of(&scene.lights()[index], ray, span) else { continue };
            let Some(t) = distances.sample(stream.unit()) else { continue };
            let segments = scene.segments(ray, end, walker.interior);
            let Some(segment) = segments.iter().find(|s| t <= s.interval.end) else { continue };
            if t < segment.interval.start {
                continue;
            }
            let medium = scene.medium(segment.medium);
            let position = ray.at(t);
            let place = (position, None, walker.interior);
            let Some((sample, received)) = next_event(scene, index, place, stream, &mut self.rays) else {
                continue;
            };
            let (one_minus_mu, one_plus_mu) = cosine_pair(ray.dir, sample.dir);
            let fraction = medium.albedo(position) * medium.phase().eval(one_minus_mu, one_plus_mu);
            let density = transmittance(scene, ray, t, walker.interior, stream) * medium.sigma_t(position);
            // Balance heuristic of the two densities; their sum divides, so neither can be small alone.
            let sum = distances.pdf(t) + flight_pdf(scene, walker, (t, medium), ray, end);
            let layer = self.layer_connected(walker, Flags::MEDIUM);
            self.add(walker.order + 1, layer, walker.weight * fraction * density * received / sum);
        }
    }
}

/// Density of the free flight at a distance in a medium [1/L]: transmittance times extinction, its mean over channels, and
/// conditioned on a collision where the flight is forced. Where the transmittance has no closed form, about that.
///
/// It weighs two ways of sampling against each other, so it must be the same number wherever it is asked for: it does
/// not know the walker's weight, which a flight through a coloured medium changes, and estimates nothing at random. Any
/// number that the place alone decides leaves the mean as it is.
fn flight_pdf(scene: &Scene, walker: &Walker, (t, medium): (f64, &Medium), ray: &Ray, end: f64) -> f64 {
    let depth = scene
        .segments(ray, t, walker.interior)
        .iter()
        .fold(Spectrum::ZERO, |sum, s| sum + scene.medium(s.medium).depth_by_bounds(ray, s.interval));
    let density = decay(depth) * medium.sigma_t(ray.at(t));
    let forced = scene.plan().forces_first_collision && walker.order == 0 && end.is_infinite();
    if forced {
        density.mean() / -crate::math::exp_m1(-scene.optical_depth(ray, end, walker.interior).mean())
    } else {
        density.mean()
    }
}

impl Visitor for PathVisitor<'_> {
    fn windowed(&self) -> Option<Windowed<'_>> {
        self.windowed
    }

    #[inline(always)]
    fn heaviest(&self) -> f64 {
        self.heaviest
    }

    #[inline(always)]
    fn lobe_in_medium(&self, position: DVec3) -> Option<&Lobe> {
        self.guide?.in_medium(position)
    }

    #[inline(always)]
    fn lobe_on_surface(&self, position: DVec3, normal: DVec3) -> Option<&Lobe> {
        self.guide?.on_surface(position, normal)
    }

    #[inline(always)]
    fn brightness(&self) -> Option<&Brightness> {
        self.guide?.brightness()
    }

    /// Classes of paths that are split are not told apart: only what they bring in all is asked for.
    fn resume(&mut self, hit: Option<&SceneHit>) {
        self.end = hit.map_or(f64::INFINITY, |h| h.hit.t);
    }

    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        match step {
            Step::Ahead(hit) => {
                self.rays.segments += 1;
                self.end = hit.map_or(f64::INFINITY, |h| h.hit.t);
                self.hit_emission(walker, hit, stream);
                self.connect_from_ray(walker, hit, stream);
            }
            Step::Collision(Arrival { position, .. }, number) => {
                let medium = self.scene.medium(number);
                let before = walker.ray.dir;
                let albedo = medium.albedo(position);
                let lobe = self.guide.and_then(|guide| guide.in_medium(position));
                let scattered = |towards: DVec3| {
                    let (one_minus_mu, one_plus_mu) = cosine_pair(before, towards);
                    let p = medium.phase().eval(one_minus_mu, one_plus_mu);
                    (albedo * p, lobe.map_or(p, |lobe| lobe.mixed(towards, p)))
                };
                let scene = self.scene;
                let end = if planted(Fault::WallForgotten) { f64::INFINITY } else { self.end };
                let delta_share = |light: &Light| {
                    let t = position.distance(walker.ray.origin);
                    let Some(span) = span(scene, &walker.ray, end, walker.interior) else { return 1.0 };
                    let pdf =
                        Distances::of(light, &walker.ray, span).map_or(0.0, |distances| distances.pdf(t));
                    // Where distances have no density the flight stands alone, be its own ever so small.
                    if pdf == 0.0 {
                        return 1.0;
                    }
                    let flight = flight_pdf(scene, walker, (t, medium), &walker.ray, end);
                    flight / (flight + pdf)
                };
                self.connect((walker, Flags::MEDIUM), position, None, stream, scattered, delta_share);
                self.scattered(walker, Flags::MEDIUM);
            }
            Step::Surface(Arrival { position, .. }, found) => {
                let Target::Object(index) = found.target else { return };
                let Surface::Lambertian(surface) = &self.scene.objects()[index].surface else { return };
                let normals = found.hit.normals(walker.ray.dir);
                let fraction = surface.eval(position, found.hit.uv);
                let lobe = self.guide.and_then(|learned| learned.on_surface(position, normals.geometric));
                let scattered = |towards: DVec3| {
                    let cosine = normals.cosine(towards);
                    let again = if planted(Fault::CosineTwice) { cosine } else { 1.0 };
                    let pdf = warp::pdf_cosine_hemisphere(cosine);
                    (fraction * cosine * again, lobe.map_or(pdf, |lobe| lobe.mixed(towards, pdf)))
                };
                self.connect(
                    (walker, Flags::DIFFUSE),
                    position,
                    Some(found.start()),
                    stream,
                    scattered,
                    |_| 1.0,
                );
                self.scattered(walker, Flags::DIFFUSE);
            }
            Step::Uncollided(..) | Step::Absorbed(..) | Step::Escaped(_) | Step::Truncated(_) => {}
        }
    }
}

/// What a ray meets up to the first body that is an event, by `seen`, which is given the walker and the distance to the
/// body ahead \[L\]: filters and index-matched boundaries bend nothing, and what is behind them is seen straight.
pub(in crate::integrators) fn seen_straight(
    scene: &Scene,
    mut walker: Walker,
    rays: &mut u64,
    stream: &mut Stream,
    seen: impl Fn(&Walker, f64, &mut Stream) -> Spectrum,
) -> Spectrum {
    let mut sum = Spectrum::ZERO;
    loop {
        *rays += 1;
        let hit = scene.hit(&walker.ray, walker.origin_surface);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        sum += walker.weight * seen(&walker, end, stream);
        let straight =
            hit.and_then(|found| Some((found, scene.straight_on(&walker.ray, &found, walker.interior)?)));
        let Some((found, (fraction, interior))) = straight else { return sum };
        let transmitted = transmittance(scene, &walker.ray, end, walker.interior, stream);
        let weight = walker.weight * transmitted * fraction;
        if weight.is_black() {
            return sum;
        }
        let ray = Ray::new(walker.ray.at(end), walker.ray.dir);
        walker = Walker { ray, weight, interior, origin_surface: Some(found.start()), ..walker };
    }
}

/// Uncollided radiance from a light that fills the ray's far end or its way [W/(L^2 sr)]: incidence and volume
/// sources.
pub(in crate::integrators) fn uncollided(
    scene: &Scene,
    light: &Light,
    walker: &Walker,
    end: f64,
    stream: &mut Stream,
) -> Spectrum {
    let (ray, interior) = (&walker.ray, walker.interior);
    match light {
        Light::Isotropic(light) if light.is_lit_against(ray.dir) => match light.shape().interval(ray) {
            Some(inside) if inside.end < end => {
                light.radiance() * transmittance(scene, ray, inside.end, interior, stream)
            }
            // A point on the boundary is inside: light comes in against a ray that leaves at once.
            None if light.shape().contains(ray.origin) => light.radiance(),
            _ => Spectrum::ZERO,
        },
        Light::VolumeSource(light) => {
            let inside =
                light.shape().interval(ray).and_then(|i| i.intersection(Interval { start: 0.0, end }));
            inside.map_or(Spectrum::ZERO, |inside| {
                collected(scene, ray, inside, interior, light.emission(), stream)
            })
        }
        _ => Spectrum::ZERO,
    }
}

/// The way along which a walker's direction was sampled: it begins on the far side of filters and index-matched boundaries.
fn sampled_along(walker: &Walker) -> Ray {
    Ray::new(walker.sampled_at, walker.ray.dir)
}

/// Whether any light has directions to choose.
fn has_next_event(scene: &Scene) -> bool {
    scene.plan().has_next_event || emitters::has_direction(scene)
}

/// Light that arrives at a place (point, body, interior) straight from the light of this index, along one sampled direction: radiance
/// over density, or the irradiance of a delta light [W/L^2].
pub(in crate::integrators) fn next_event(
    scene: &Scene,
    index: usize,
    (position, origin_surface, interior): (DVec3, Option<Start>, usize),
    stream: &mut Stream,
    rays: &mut Rays,
) -> Option<(LightSample, Spectrum)> {
    let light = &scene.lights()[index];
    if !light.has_direction_from(position) {
        return None;
    }
    if let Light::VolumeSource(source) = light {
        let sample = source.sample(position, stream.triple())?;
        let ray = Ray::new(position, sample.dir);
        let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
        let seen = seen_straight(scene, start, &mut rays.shadow, stream, |walker, end, stream| {
            uncollided(scene, light, walker, end, stream)
        });
        return Some((sample, seen / sample.pdf_solid_angle?));
    }
    let sample = light.sample(position, stream.pair())?;
    let ray = Ray::new(position, sample.dir);
    rays.shadow += 1;
    let towards = Some(Target::Light(index));
    let transmitted = connection(scene, (&ray, origin_surface, interior), sample.distance, towards, stream)?;
    Some((sample, sample.value * transmitted))
}

/// Radiance that arrives along a ray straight from media that emit [W/(L^2 sr)].
fn emitted_along(
    scene: &Scene,
    (ray, origin_surface, interior): (Ray, Option<Start>, usize),
    stream: &mut Stream,
    rays: &mut Rays,
) -> Spectrum {
    let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
    seen_straight(scene, start, &mut rays.shadow, stream, |walker, end, stream| {
        emission(scene, &walker.ray, end, walker.interior, stream)
    })
}

/// Power that uncollided light of beams and point lights carries through a surface element along its normal
/// [W/L^2]: rays cannot meet it, so that it is added to what they find.
pub fn direct_flux(
    scene: &Scene,
    position: DVec3,
    normal: DVec3,
    stream: &mut Stream,
    rays: &mut Rays,
) -> Spectrum {
    let interior = scene.interior_at(position);
    let mut sum = Spectrum::ZERO;
    for (index, light) in scene.lights().iter().enumerate() {
        if light.is_delta()
            && let Some((sample, received)) =
                next_event(scene, index, (position, None, interior), stream, rays)
        {
            sum += received * (-sample.dir.dot(normal)).max(0.0);
        }
    }
    sum
}

/// One sample of the radiance that arrives at the origin of `ray` from ahead [W/(L^2 sr)], by order and class:
/// `collect` is called with the order, the class and the contribution. The ray starts in the interior of number `within`.
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
    let visitor = PathVisitor::new(scene, orders, Rays::default(), &mut collect);
    let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
    follow(visitor, start, Guides::default(), stream)
}

/// Follows a path, and all that is split off it. Returns the work.
fn follow<'a>(mut visitor: PathVisitor<'a>, start: Walker, guides: Guides<'a>, stream: &mut Stream) -> Rays {
    let (scene, limit) = (visitor.scene, visitor.orders.max);
    // Roulette compares with the weight that a walk started with; windows take its place.
    let roulette =
        Roulette::below(if guides.windows.is_some() { 0.0 } else { ROULETTE * start.weight.max() });
    let place = (start.ray.origin, start.interior);
    visitor.windowed = guides.windows.map(|windows| Windowed::new(windows, scene, place, start.weight));
    if let Some(guide) = guides.learned.filter(|guide| guide.is_used()) {
        visitor.guide = Some(guide);
        visitor.heaviest = HEAVIEST / ROULETTE;
    }
    walk(scene, start, roulette, limit, stream, &mut visitor);
    visitor.rays
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

/// One sample of the radiance that arrives at the origin of `ray`, which starts on no surface, from ahead [W/(L^2 sr)], by order and
/// class, by guided paths. Returns the work.
pub fn guided_classes(
    scene: &Scene,
    (ray, interior): (Ray, usize),
    orders: Orders,
    guides: Guides<'_>,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Layer, Spectrum),
) -> Rays {
    let visitor = PathVisitor::new(scene, orders, Rays::default(), &mut collect);
    let start = Walker { interior, ..Walker::new(ray, Spectrum::ONE) };
    follow(visitor, start, guides, stream)
}

/// The same by order.
pub fn radiance(
    scene: &Scene,
    from: (Ray, usize),
    orders: Orders,
    guides: Guides<'_>,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Spectrum),
) -> Rays {
    guided_classes(scene, from, orders, guides, stream, |order, _, value| collect(order, value))
}

/// One sample of the fluence at a point [W/L^2], by order.
///
/// Uncollided light from lights that can be aimed at comes by next-event estimation, in multiple importance with
/// the direction that everything else comes by: a uniform one, or one that was learned. Returns the work.
pub fn fluence(
    scene: &Scene,
    position: DVec3,
    orders: Orders,
    guides: Guides<'_>,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Spectrum),
) -> Rays {
    let lobe = guides.learned.and_then(|guide| guide.in_medium(position));
    let rays = aimed_fluence(scene, (position, lobe), orders, stream, &mut collect);
    let start = anywhere(scene, (position, lobe), stream);
    let mut collect = |order, _: Layer, value| collect(order, value);
    let visitor = PathVisitor::new(scene, orders, rays, &mut collect);
    follow(visitor, start, guides, stream)
}

/// The part of the fluence at a point that directions are chosen for [W/L^2]. Returns the work.
pub(super) fn aimed_fluence(
    scene: &Scene,
    (position, lobe): (DVec3, Option<&Lobe>),
    orders: Orders,
    stream: &mut Stream,
    mut collect: impl FnMut(u32, Spectrum),
) -> Rays {
    let mut rays = Rays::default();
    if !orders.contains(0) {
        return rays;
    }
    let pdf_met = |dir: DVec3| lobe.map_or(warp::pdf_sphere(), |lobe| lobe.mixed(dir, warp::pdf_sphere()));
    let interior = scene.interior_at(position);
    for index in 0..scene.lights().len() {
        if let Some((sample, received)) =
            next_event(scene, index, (position, None, interior), stream, &mut rays)
        {
            let share = sample.pdf_solid_angle.map_or(1.0, |pdf| pdf / (pdf + pdf_met(sample.dir)));
            collect(0, received * share);
        }
    }
    if let Some((dir, pdf)) = emitters::sample(scene, position, stream) {
        let seen = emitted_along(scene, (Ray::new(position, dir), None, interior), stream, &mut rays);
        collect(0, seen / (pdf + pdf_met(dir)));
    }
    rays
}

/// A path from a point in a direction that is uniform, or was learned in part, weighted for the fluence.
pub(super) fn anywhere(
    scene: &Scene,
    (position, lobe): (DVec3, Option<&Lobe>),
    stream: &mut Stream,
) -> Walker {
    let uniform = |stream: &mut Stream| warp::square_to_sphere(stream.pair()).normalize();
    let (dir, weight, pdf) = match lobe {
        None => (uniform(stream), FOUR_PI, warp::pdf_sphere()),
        Some(lobe) => {
            let dir = lobe.sample(stream, uniform);
            let pdf = lobe.mixed(dir, warp::pdf_sphere());
            (dir, 1.0 / pdf, pdf)
        }
    };
    Walker {
        interior: scene.interior_at(position),
        pdf_solid_angle: Some(pdf),
        ..Walker::new(Ray::new(position, dir), Spectrum::grey(weight))
    }
}
