//! The one random walk that paths and photons share.

use super::bounce::{bounce, is_looked_through, learned};
use super::visitor::{Arrival, Step, Visitor, Walker};
use super::{Flags, Flight, Roulette, free_flight, transmittance};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::Ray;
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::{Scene, SceneHit};

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

/// Parts split off one history after which it is split no more: a guess that grows faster than light would split for ever.
const MOST_SPLIT: usize = 10_000;

/// What is left of a history to follow, and how much was split off it so far.
#[derive(Default)]
struct Split {
    waiting: Vec<Waiting>,
    count: usize,
}

/// A part of a history that was split off on a flight.
struct Waiting {
    walker: Walker,
    roulette: Roulette,
    /// What is ahead of its ray, and how far it has flown.
    hit: Option<SceneHit>,
    flown: f64,
}

/// Follows one history to its end, and all that is split off it.
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
    let mut split = Split::default();
    follow(scene, (start, roulette), None, limit, &mut split, stream, visitor);
    while let Some(Waiting { walker, roulette, hit, flown }) = split.waiting.pop() {
        visitor.resume(hit.as_ref());
        follow(scene, (walker, roulette), Some((hit, flown)), limit, &mut split, stream, visitor);
    }
}

/// Follows one part of a history; `resumed` if it is already on its flight.
fn follow<V: Visitor>(
    scene: &Scene,
    (start, roulette): (Walker, Roulette),
    mut resumed: Option<(Option<SceneHit>, f64)>,
    limit: Option<u32>,
    split: &mut Split,
    stream: &mut Stream,
    visitor: &mut V,
) {
    let (mut walker, mut roulette) = (start, roulette);
    loop {
        let (hit, flown) = match resumed.take() {
            Some(flight) => flight,
            None => {
                let Some(hit) = look_ahead(scene, &mut walker, stream, visitor) else { return };
                (hit, 0.0)
            }
        };
        if limit.is_some_and(|limit| walker.order >= limit) {
            let Some(through) = hit.filter(|found| V::LOOKS_AHEAD && is_looked_through(scene, found)) else {
                visitor.visit(&walker, Step::Truncated(walker.weight), stream);
                return;
            };
            let seen =
                walker.weight * transmittance(scene, &walker.ray, through.hit.t, walker.interior, stream);
            visitor.visit(&walker, Step::Truncated(walker.weight - seen), stream);
            walker.weight = seen;
            match bounce(scene, &walker, &through, &mut roulette, stream, visitor) {
                Some(next) => walker = next,
                None => return,
            }
            continue;
        }
        let end = hit.map_or(f64::INFINITY, |h| h.hit.t);
        let forced = scene.plan().forces_first_collision && walker.order == 0 && hit.is_none();
        let flight =
            fly(scene, (&mut walker, &mut roulette), (hit, flown, end), forced, split, stream, visitor);
        let Some(flight) = flight else { return };
        let arrived = walker.weight;
        match flight {
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
                let own = |stream: &mut Stream| medium.phase().scatter(before, stream.pair());
                let lobe = visitor.lobe_in_medium(position);
                let dir = match lobe {
                    None => own(stream),
                    Some(lobe) => lobe.sample(stream, own),
                };
                let pdf = || {
                    let (one_minus_mu, one_plus_mu) = crate::math::cosine_pair(before, dir);
                    medium.phase().eval(one_minus_mu, one_plus_mu)
                };
                let (factor, mixed) = learned(lobe, dir, pdf);
                let kept = kept * factor;
                if lobe.is_some() && kept.max() < f64::MIN_POSITIVE {
                    visitor.visit(&walker, Step::Truncated(Spectrum::ZERO), stream);
                    return;
                }
                roulette = roulette.led(factor);
                walker = Walker {
                    ray: Ray::new(position, dir),
                    weight: kept,
                    order: walker.order + 1,
                    flags: walker.flags.with(Flags::MEDIUM),
                    origin_surface: None,
                    interior: walker.interior,
                    sampled_at: position,
                    events: walker.events,
                    total_reflections: 0,
                    pdf_solid_angle: V::LOOKS_AHEAD.then(|| mixed.unwrap_or_else(pdf)),
                };
            }
            Flight::Uncollided(weight) => {
                visitor.visit(&walker, Step::Uncollided(end, weight), stream);
                walker.weight = weight;
                let Some(found) = hit else {
                    visitor.visit(&walker, Step::Escaped(weight), stream);
                    return;
                };
                match bounce(scene, &walker, &found, &mut roulette, stream, visitor) {
                    Some(next) => walker = next,
                    None => return,
                }
            }
        }
    }
}

/// What is ahead, told to the visitor; none where a long history ends.
fn look_ahead<V: Visitor>(
    scene: &Scene,
    walker: &mut Walker,
    stream: &mut Stream,
    visitor: &mut V,
) -> Option<Option<SceneHit>> {
    if !goes_on(walker, stream) {
        // What survives carries this one's share.
        visitor.visit(walker, Step::Truncated(Spectrum::ZERO), stream);
        return None;
    }
    let hit = scene.hit(&walker.ray, walker.origin_surface);
    visitor.visit(walker, Step::Ahead(hit.as_ref()), stream);
    Some(hit)
}

/// A flight to a collision or to the end of the ray; with games on the way, if the visitor has weight windows: then none where they are lost.
/// What is too heavy flies in equal parts.
///
/// A flight forgets how far it came: at each stop what goes on flies on from there, each for itself. All of the ray was
/// looked along before.
fn fly<V: Visitor>(
    scene: &Scene,
    (walker, roulette): (&mut Walker, &mut Roulette),
    (hit, mut flown, end): (Option<SceneHit>, f64, f64),
    forced: bool,
    split: &mut Split,
    stream: &mut Stream,
    visitor: &V,
) -> Option<Flight> {
    let Some(windowed) = visitor.windowed() else {
        let (weight, heaviest) = (walker.weight.max(), roulette.times(visitor.heaviest()));
        if weight > heaviest && split.count < MOST_SPLIT {
            let copies = (weight / heaviest).ceil().min(MOST_SPLIT as f64) as usize;
            walker.weight *= 1.0 / copies as f64;
            split.count += copies - 1;
            let others = if planted(Fault::PartLost) { copies - 2 } else { copies - 1 };
            let waiting = || Waiting { walker: *walker, roulette: *roulette, hit, flown };
            split.waiting.extend(std::iter::repeat_with(waiting).take(others));
        }
        let ahead = (hit.as_ref(), end, walker.interior);
        let brightness = visitor.brightness().filter(|_| !forced);
        let led = brightness.and_then(|by| by.fly(scene, &walker.ray, ahead, walker.weight, stream));
        if let Some((flight, factor)) = led {
            *roulette = roulette.flown(factor);
            return Some(flight);
        }
        return Some(free_flight(scene, &walker.ray, end, walker.interior, walker.weight, forced, stream));
    };
    loop {
        let (ray, interior) = (walker.ray, walker.interior);
        let (copies, factor) = windowed.copies(&ray, flown, interior, walker.weight, || stream.unit());
        let (copies, factor) =
            if split.count < MOST_SPLIT { (copies, factor) } else { (copies.min(1), factor.max(1.0)) };
        walker.weight *= factor;
        split.count += copies.saturating_sub(1);
        for _ in 1..copies {
            split.waiting.push(Waiting { walker: *walker, roulette: *roulette, hit, flown });
        }
        if copies == 0 {
            return None;
        }
        let stop = windowed.stop(&ray, (flown, end), interior);
        let onward = Ray::new(ray.at(flown), ray.dir);
        match free_flight(scene, &onward, stop - flown, interior, walker.weight, false, stream) {
            Flight::Collision { t, medium, weight } => {
                return Some(Flight::Collision { t: flown + t, medium, weight });
            }
            Flight::Uncollided(weight) if stop >= end => return Some(Flight::Uncollided(weight)),
            Flight::Uncollided(weight) => (walker.weight, flown) = (weight, stop),
        }
    }
}
