//! Free flight: how far light goes before it collides.

use super::track::{self, End};
use crate::Spectrum;
use crate::faults::{Fault, planted, size};
use crate::math::{Interval, Ray, exp_m1, ln_1p};
use crate::medium::{Homogeneous, Medium};
use crate::rng::Stream;
use crate::scene::{Scene, decay};

/// How a flight ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flight {
    /// With a collision.
    Collision {
        /// Distance flown \[L\].
        t: f64,
        /// Number of the medium.
        medium: usize,
        /// Weight after the flight.
        weight: Spectrum,
    },
    /// At the end of the ray, with this weight.
    Uncollided(Spectrum),
}

/// Samples the distance to the next collision on a ray, up to distance `end` \[L\], in the interior of number `within`.
///
/// Grey media: the optical depth is -ln(1-u), exactly, and the weight is unchanged. Where extinction differs by
/// channel, one channel is chosen in proportion to its weight and the result is weighted by the balance heuristic,
/// which keeps the summed weight. If `forced`, the flight collides for certain (where anything is in its way) and
/// the weight carries the probability: the caller owns what passes. Heterogeneous media are tracked by tentative
/// collisions, and no flight through them is forced.
pub fn free_flight(
    scene: &Scene,
    ray: &Ray,
    end: f64,
    interior: usize,
    weight: Spectrum,
    forced: bool,
    stream: &mut Stream,
) -> Flight {
    if !scene.plan().has_media {
        return Flight::Uncollided(weight);
    }
    if scene.plan().has_heterogeneous {
        return flight_by_stretch(scene, ray, end, interior, weight, stream, &mut |_, _, _| ());
    }
    let is_grey = scene.plan().has_grey_extinction;
    stream.work.channel_flights += u64::from(!is_grey);
    let channel = if is_grey { 0 } else { choose(weight, stream.unit()) };
    let mut target = -ln_1p(-stream.unit());
    if planted(Fault::FlightStretched) {
        target *= 1.0 + size();
    }
    let mut weight = weight;
    if forced {
        let depth = scene.optical_depth(ray, end, interior)[channel];
        if depth == 0.0 {
            return Flight::Uncollided(weight);
        }
        // exp(-target) is uniform in (0, 1]: stretched over [exp(-depth), 1].
        let collides = -exp_m1(-depth);
        target = -ln_1p(collides * exp_m1(-target)).min(depth);
        weight *= collides;
    }
    let segments = scene.segments(ray, end, interior);
    let mut last = None;
    for segment in segments.iter() {
        let sigma_t = scene.medium(segment.medium).matter().sigma_t();
        if sigma_t[channel] == 0.0 {
            continue;
        }
        let depth = sigma_t[channel] * segment.interval.length();
        if target < depth || (forced && target == depth) {
            let t = segment.interval.start + target / sigma_t[channel];
            return collision(scene, ray, t, interior, segment.medium, weight);
        }
        if !planted(Fault::DepthForgotten) {
            target -= depth;
        }
        last = Some(segment);
    }
    match last {
        // A forced flight whose rounding carried it past the end collides at the end.
        Some(segment) if forced => {
            collision(scene, ray, segment.interval.end, interior, segment.medium, weight)
        }
        _ => uncollided(scene, ray, end, interior, weight),
    }
}

/// The flight of media of which some are heterogeneous: stretch by stretch, since each forgets what was before it.
///
/// Homogeneous ones in closed form, with the balance heuristic over channels; others by delta tracking. Both keep the
/// summed weight, and each channel's expectation given the weights that come in. `passed` is told every part of the flight, with the
/// number of its medium and the weight at its near end: in homogeneous media the weight all along it follows from that, in others it
/// stays.
pub(crate) fn flight_by_stretch(
    scene: &Scene,
    ray: &Ray,
    end: f64,
    interior: usize,
    weight: Spectrum,
    stream: &mut Stream,
    passed: &mut impl FnMut(usize, Interval, Spectrum),
) -> Flight {
    let mut weight = weight;
    for segment in scene.segments(ray, end, interior).iter() {
        let passed = &mut |part: Interval, weight: Spectrum| passed(segment.medium, part, weight);
        let stretch = match scene.medium(segment.medium) {
            Medium::Homogeneous(medium) => {
                let stretch = closed(medium, segment.interval, weight, stream);
                let end = if let End::Collision(t, _) = stretch { t } else { segment.interval.end };
                passed(Interval { end, ..segment.interval }, weight);
                stretch
            }
            Medium::Heterogeneous(medium) => {
                let by_channel = scene.plan().is_full || !medium.matter().sigma_t().is_grey();
                stream.work.channel_flights += u64::from(by_channel);
                track::delta(medium, ray, segment.interval, weight, by_channel, stream, passed)
            }
        };
        match stretch {
            End::Collision(t, weight) => return Flight::Collision { t, medium: segment.medium, weight },
            End::Uncollided(transmitted) => weight = transmitted,
        }
    }
    Flight::Uncollided(weight)
}

/// One stretch of a homogeneous medium.
fn closed(medium: &Homogeneous, part: Interval, weight: Spectrum, stream: &mut Stream) -> End {
    let sigma_t = medium.sigma_t();
    let is_grey = sigma_t.is_grey() || planted(Fault::StretchColorIgnored);
    if sigma_t.is_black() {
        return End::Uncollided(weight);
    }
    stream.work.channel_flights += u64::from(!is_grey);
    let channel = if is_grey { 0 } else { choose(weight, stream.unit()) };
    let stretched = if planted(Fault::PieceStretched) { 1.0 + size() } else { 1.0 };
    let target = -ln_1p(-stream.unit()) * stretched;
    let flown = if sigma_t[channel] == 0.0 { f64::INFINITY } else { target / sigma_t[channel] };
    let kept = |weighted: Spectrum| weighted * (weight.sum() / weighted.sum());
    if flown >= part.length() {
        let transmitted = if is_grey { weight } else { kept(weight * decay(medium.depth(part.length()))) };
        return End::Uncollided(transmitted);
    }
    let after = if is_grey { weight } else { kept(weight * decay(medium.depth(flown)) * sigma_t) };
    End::Collision(part.start + flown, after)
}

/// What arrives at the end of a ray through homogeneous media.
pub(super) fn uncollided(scene: &Scene, ray: &Ray, end: f64, interior: usize, weight: Spectrum) -> Flight {
    if scene.plan().has_grey_extinction {
        return Flight::Uncollided(weight);
    }
    let transmitted = decay(scene.optical_depth(ray, end, interior));
    Flight::Uncollided(weight * transmitted * (weight.sum() / (weight * transmitted).sum()))
}

/// A collision in a homogeneous medium.
pub(super) fn collision(
    scene: &Scene,
    ray: &Ray,
    t: f64,
    interior: usize,
    medium: usize,
    weight: Spectrum,
) -> Flight {
    if scene.plan().has_grey_extinction {
        return Flight::Collision { t, medium, weight };
    }
    let density = decay(scene.optical_depth(ray, t, interior)) * scene.medium(medium).matter().sigma_t();
    let weighted = weight * density;
    Flight::Collision { t, medium, weight: weighted * (weight.sum() / weighted.sum()) }
}

/// A channel, in proportion to its weight.
pub(super) fn choose(weight: Spectrum, u: f64) -> usize {
    let target = u * weight.sum();
    if target < weight[0] {
        0
    } else if target < weight[0] + weight[1] || weight[2] == 0.0 {
        1
    } else {
        2
    }
}
