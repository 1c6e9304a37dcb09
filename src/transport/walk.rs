//! The one random walk that paths and photons share.

use super::bounce::{bounce, is_looked_through};
use super::visitor::{Arrival, Step, Visitor, Walker};
use super::{Flags, Flight, Roulette, free_flight, transmittance};
use crate::Spectrum;
use crate::math::Ray;
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::Scene;

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
            visitor.visit(&walker, Step::Truncated(Spectrum::ZERO), stream);
            return;
        }
        let hit = scene.hit(&walker.ray, walker.origin_surface);
        visitor.visit(&walker, Step::Ahead(hit.as_ref()), stream);
        if limit.is_some_and(|limit| walker.order >= limit) {
            let Some(through) = hit.filter(|found| V::LOOKS_AHEAD && is_looked_through(scene, found)) else {
                visitor.visit(&walker, Step::Truncated(walker.weight), stream);
                return;
            };
            let seen =
                walker.weight * transmittance(scene, &walker.ray, through.hit.t, walker.interior, stream);
            visitor.visit(&walker, Step::Truncated(walker.weight - seen), stream);
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
        match free_flight(scene, &walker.ray, end, walker.interior, arrived, forced, stream) {
            Flight::Collision { t, medium: number, weight } => {
                if forced {
                    let transmitted = arrived - weight;
                    visitor.visit(&walker, Step::Uncollided(end, transmitted), stream);
                    visitor.visit(&walker, Step::Escaped(transmitted), stream);
                    roulette = roulette.scaled(weight.max() / arrived.max());
                }
                visitor.visit(&walker, Step::Uncollided(t, weight), stream);
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
                    origin_surface: None,
                    interior: walker.interior,
                    since_sampled: 0.0,
                    events: walker.events,
                    total_reflections: 0,
                    pdf_solid_angle: V::LOOKS_AHEAD.then(pdf),
                };
            }
            Flight::Uncollided(weight) => {
                visitor.visit(&walker, Step::Uncollided(end, weight), stream);
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
    if after.interior == before.interior {
        return roulette;
    }
    roulette.scaled(after.weight.max() / before.weight.max())
}
