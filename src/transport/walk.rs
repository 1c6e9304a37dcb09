//! The one random walk that paths and photons share.

use super::bounce::{bounce, is_looked_through};
use super::{Flags, Flight, Roulette, free_flight, transmittance};
use crate::Spectrum;
use crate::math::Ray;
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::{SURROUNDINGS, Scene, SceneHit, Start};
use glam::DVec3;

/// Where a walk stands: a ray about to be followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// The ray ahead.
    pub ray: Ray,
    /// Power of a photon \[W\], or throughput of a path.
    pub weight: Spectrum,
    /// Number of scatterings so far by media and non-specular surfaces.
    pub order: u32,
    /// What has been met.
    pub flags: Flags,
    /// The body that the ray starts on.
    pub from: Option<Start>,
    /// Number of the interior that the ray is in.
    pub within: usize,
    /// How far behind the ray's origin its direction was chosen \[L\]: a ray starts again behind a filter or an
    /// index-matched boundary, on the same way.
    pub behind: f64,
    /// Events and boundaries met so far.
    pub events: u32,
    /// Total reflections since it was last scattered, or could cross a boundary.
    pub total_reflections: u32,
    /// Density with which the ray's direction was chosen [1/sr]; none where no other sampler could have chosen it.
    pub pdf_solid_angle: Option<f64>,
}

impl Walker {
    /// A walk that starts along a ray, in the surroundings.
    pub fn new(ray: Ray, weight: Spectrum) -> Self {
        Walker {
            ray,
            weight,
            order: 0,
            flags: Flags::NONE,
            from: None,
            within: SURROUNDINGS,
            behind: 0.0,
            events: 0,
            total_reflections: 0,
            pdf_solid_angle: None,
        }
    }
}

/// An event: the walker as it arrives, before the albedo decides.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<'a> {
    /// The walker, its weight as it arrives.
    pub walker: &'a Walker,
    /// Where \[L\].
    pub position: DVec3,
}

/// What a step of the walk tells its visitor.
#[derive(Debug, Clone, Copy)]
pub enum Step<'a> {
    /// A ray is about to be followed up to the body ahead, if there is one.
    Ahead(Option<&'a SceneHit>),
    /// Light went from the ray's origin to this distance without an event, with this weight.
    Passed(f64, Spectrum),
    /// A collision in the medium of this number.
    Collision(Arrival<'a>, usize),
    /// An arrival at a body.
    Surface(Arrival<'a>, &'a SceneHit),
    /// A photon ended at an event: this weight is absorbed there; the number of the medium, if in one.
    Absorbed(Spectrum, Option<usize>),
    /// The weight leaves the scene.
    Escaped(Spectrum),
    /// The weight is followed no further, since nobody asked for higher orders.
    Abandoned(Spectrum),
}

/// Who watches a walk.
pub trait Visitor {
    /// Whether it collects what rays meet by themselves, as paths do and photons do not: then directions keep their
    /// densities ([`Walker::pdf_solid_angle`]), and a ray of the limiting order is followed through mirrors and glass.
    const LOOKS_AHEAD: bool = true;

    /// Whether weights are those of radiance, which scales with the squared index of refraction where a photon's power
    /// does not.
    const CARRIES_RADIANCE: bool = Self::LOOKS_AHEAD;

    /// One step of the walk.
    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream);
}

/// Events after which a history plays for its life at each one, whatever it keeps: a history of so many would take longer
/// than thousands of others, and without this one that nothing ends would never come to an end.
pub const LONG: u32 = 200_000;

/// The odds of that game: about so many events more.
const LIVES: f64 = 100_000.0;

/// Counts an event, and plays the game of long histories, which keeps every mean; whether the walker goes on.
fn goes_on(walker: &mut Walker, stream: &mut Stream) -> bool {
    walker.events = walker.events.saturating_add(1);
    if walker.events <= LONG {
        return true;
    }
    let chance = 1.0 - 1.0 / LIVES;
    walker.weight = walker.weight / chance;
    stream.unit() < chance
}

/// Follows one history to its end.
///
/// It ends by absorption, by escape, by a game of chance behind [`LONG`] events, or with a ray of order `limit`, which is
/// looked along, through mirrors, glass and filters too since they raise no order, but not flown.
pub fn walk<V: Visitor>(
    scene: &Scene,
    start: Walker,
    roulette: Roulette,
    limit: Option<u32>,
    stream: &mut Stream,
    visitor: &mut V,
) {
    let (mut walker, mut roulette) = (start, roulette);
    loop {
        if !goes_on(&mut walker, stream) {
            // What survives carries this one's share.
            visitor.visit(&walker, Step::Abandoned(Spectrum::ZERO), stream);
            return;
        }
        let hit = scene.hit(&walker.ray, walker.from);
        visitor.visit(&walker, Step::Ahead(hit.as_ref()), stream);
        if limit.is_some_and(|limit| walker.order >= limit) {
            let Some(through) = hit.filter(|found| V::LOOKS_AHEAD && is_looked_through(scene, found)) else {
                visitor.visit(&walker, Step::Abandoned(walker.weight), stream);
                return;
            };
            let seen =
                walker.weight * transmittance(scene, &walker.ray, through.hit.t, walker.within, stream);
            visitor.visit(&walker, Step::Abandoned(walker.weight - seen), stream);
            walker.weight = seen;
            match bounce(scene, &walker, &through, roulette, stream, visitor) {
                Some(next) => {
                    roulette = refracted(roulette, &walker, &next);
                    walker = next;
                }
                None => return,
            }
            continue;
        }
        let end = hit.map_or(f64::INFINITY, |h| h.hit.t);
        let forced = scene.plan().forces_first_collision && walker.order == 0 && hit.is_none();
        let arrived = walker.weight;
        match free_flight(scene, &walker.ray, end, walker.within, arrived, forced, stream) {
            Flight::Collision { t, medium: number, weight } => {
                if forced {
                    let passed = arrived - weight;
                    visitor.visit(&walker, Step::Passed(end, passed), stream);
                    visitor.visit(&walker, Step::Escaped(passed), stream);
                    roulette = roulette.scaled(weight.max() / arrived.max());
                }
                visitor.visit(&walker, Step::Passed(t, weight), stream);
                walker.weight = weight;
                let position = walker.ray.at(t);
                visitor.visit(
                    &walker,
                    Step::Collision(Arrival { walker: &walker, position }, number),
                    stream,
                );
                let medium = scene.medium(number);
                let albedo = medium.albedo(position);
                let Some(kept) = roulette.survive(weight, albedo, stream) else {
                    let lost = Roulette::lost(weight, albedo);
                    visitor.visit(&walker, Step::Absorbed(lost, Some(number)), stream);
                    return;
                };
                let before = walker.ray.dir;
                let dir = medium.phase().scatter(before, stream.pair());
                let pdf = || {
                    let (one_minus_mu, one_plus_mu) = crate::math::cosine_pair(before, dir);
                    medium.phase().eval(one_minus_mu, one_plus_mu)
                };
                walker = Walker {
                    ray: Ray::new(position, dir),
                    weight: kept,
                    order: walker.order + 1,
                    flags: walker.flags.with(Flags::MEDIUM),
                    from: None,
                    within: walker.within,
                    behind: 0.0,
                    events: walker.events,
                    total_reflections: 0,
                    pdf_solid_angle: V::LOOKS_AHEAD.then(pdf),
                };
            }
            Flight::Passed(weight) => {
                visitor.visit(&walker, Step::Passed(end, weight), stream);
                walker.weight = weight;
                let Some(found) = hit else {
                    visitor.visit(&walker, Step::Escaped(weight), stream);
                    return;
                };
                match bounce(scene, &walker, &found, roulette, stream, visitor) {
                    Some(next) => {
                        roulette = refracted(roulette, &walker, &next);
                        walker = next;
                    }
                    None => return,
                }
            }
        }
    }
}

/// The game behind a boundary: the scale of radiance is no loss, and what is refracted out again gets it back.
fn refracted(roulette: Roulette, before: &Walker, after: &Walker) -> Roulette {
    if after.within == before.within {
        return roulette;
    }
    roulette.scaled(after.weight.max() / before.weight.max())
}
