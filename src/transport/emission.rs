//! Emission of media, and of sources that fill a part of a ray, collected along the ray.

use super::track;
use super::transmittance::segment_transmittance as transmittance;
use crate::Spectrum;
use crate::math::{Interval, Ray, exp_m1};
use crate::medium::{Homogeneous, Medium};
use crate::rng::Stream;
use crate::scene::{Scene, decay};

/// Radiance that media themselves send towards the ray's origin [W/(L^2 sr)], from the stretch up to distance `end` in
/// the interior of number `within`: in closed form where they are homogeneous, else an unbiased estimate.
pub fn emission(scene: &Scene, ray: &Ray, end: f64, interior: usize, stream: &mut Stream) -> Spectrum {
    if !scene.plan().has_emission {
        return Spectrum::ZERO;
    }
    let nowhere = Interval { start: end, end };
    collect(scene, (ray, end, interior), true, (nowhere, Spectrum::ZERO), stream)
}

/// Radiance towards the ray's origin [W/(L^2 sr)] from a source of emission coefficient `source` [W/(L^3 sr)] that fills
/// `part` of the ray, beside all media: as [`emission`].
pub fn collected(
    scene: &Scene,
    ray: &Ray,
    part: Interval,
    interior: usize,
    source: Spectrum,
    stream: &mut Stream,
) -> Spectrum {
    if !scene.plan().has_heterogeneous {
        return scene.collected(ray, part, interior, source);
    }
    collect(scene, (ray, part.end, interior), false, (part, source), stream)
}

fn collect(
    scene: &Scene,
    (ray, end, interior): (&Ray, f64, usize),
    own: bool,
    (part, source): (Interval, Spectrum),
    stream: &mut Stream,
) -> Spectrum {
    let (mut transmitted, mut sum, mut cursor) = (Spectrum::ONE, Spectrum::ZERO, 0.0);
    let gap =
        |from: f64, to: f64| Interval { start: from, end: to }.intersection(part).map_or(0.0, |i| i.length());
    for segment in scene.segments(ray, end, interior).iter() {
        sum += transmitted * source * gap(cursor, segment.interval.start);
        cursor = segment.interval.end;
        let medium = scene.medium(segment.medium);
        for (stretch, is_source) in pieces(segment.interval, part) {
            let uniform = if is_source { source } else { Spectrum::ZERO };
            let (light, behind) = match medium {
                Medium::Homogeneous(medium) => {
                    let emission = if own { medium.emission() + uniform } else { uniform };
                    closed(medium, stretch.length(), emission)
                }
                Medium::Heterogeneous(medium) if (own && medium.is_emitting()) || is_source => {
                    stream.work.transmittances += 1;
                    track::emitted(medium, ray, stretch, own, uniform, stream)
                }
                Medium::Heterogeneous(_) => (Spectrum::ZERO, transmittance(medium, ray, stretch, stream)),
            };
            sum += transmitted * light;
            transmitted *= behind;
        }
    }
    sum + transmitted * source * gap(cursor, end)
}

/// A stretch before, in and behind a part; whether the piece lies in it.
fn pieces(stretch: Interval, part: Interval) -> impl Iterator<Item = (Interval, bool)> {
    let (a, b) = (part.start.clamp(stretch.start, stretch.end), part.end.clamp(stretch.start, stretch.end));
    let piece = |start: f64, end: f64| Interval { start, end };
    [(piece(stretch.start, a), false), (piece(a, b), true), (piece(b, stretch.end), false)]
        .into_iter()
        .filter(|(piece, _)| piece.length() > 0.0)
}

/// int_0^s e^(-sigma_t t) dt times the emission, and e^(-sigma_t s).
fn closed(medium: &Homogeneous, length: f64, emission: Spectrum) -> (Spectrum, Spectrum) {
    let sigma_t = medium.sigma_t();
    let along = |s: f64| if s == 0.0 { length } else { -exp_m1(-s * length) / s };
    let light = match (emission.is_black(), sigma_t.is_grey()) {
        (true, _) => Spectrum::ZERO,
        (_, true) => emission * along(sigma_t[0]),
        _ => emission * sigma_t.map(along),
    };
    (light, decay(medium.depth(length)))
}
