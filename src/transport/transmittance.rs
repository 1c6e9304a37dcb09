//! Transmittance: the fraction of light that passes a stretch of media without a collision.

use super::track;
use crate::Spectrum;
use crate::math::{Interval, Ray};
use crate::medium::Medium;
use crate::rng::Stream;
use crate::scene::{Scene, decay};

/// The fraction of light that passes up to distance `end` \[1\], in the interior of number `within`: exact where the
/// optical depth has a closed form, else an unbiased estimate by ratio tracking.
pub fn transmittance(scene: &Scene, ray: &Ray, end: f64, within: usize, stream: &mut Stream) -> Spectrum {
    if !scene.plan().has_heterogeneous {
        return decay(scene.optical_depth(ray, end, within));
    }
    let (mut depth, mut tracked) = (Spectrum::ZERO, Spectrum::ONE);
    for segment in scene.segments(ray, end, within).iter() {
        let medium = scene.medium(segment.medium);
        match medium.optical_depth(ray, segment.interval) {
            Some(closed) => depth += closed,
            None => tracked *= passed(medium, ray, segment.interval, stream),
        }
    }
    decay(depth) * tracked
}

/// The same of a stretch of one medium.
pub fn passed(medium: &Medium, ray: &Ray, part: Interval, stream: &mut Stream) -> Spectrum {
    match medium {
        Medium::Homogeneous(medium) => decay(medium.depth(part.length())),
        Medium::Heterogeneous(varying) => match varying.optical_depth(ray, part) {
            Some(closed) => decay(closed),
            None => {
                stream.work.transmittances += 1;
                track::ratio(varying, ray, part, stream)
            }
        },
    }
}
