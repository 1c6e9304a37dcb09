//! Transmittance: the fraction of light that passes a stretch of media without a collision.

use super::track::{self, Controls};
use crate::Spectrum;
use crate::math::{Interval, Ray};
use crate::medium::Medium;
use crate::rng::Stream;
use crate::scene::{Scene, Start, Target, decay};

/// The fraction of light that passes up to distance `end` \[1\], in the interior of number `within`: exact where the
/// optical depth has a closed form, else an unbiased estimate by ratio tracking.
pub fn transmittance(scene: &Scene, ray: &Ray, end: f64, interior: usize, stream: &mut Stream) -> Spectrum {
    if !scene.plan().has_heterogeneous {
        return decay(scene.optical_depth(ray, end, interior));
    }
    let (mut depth, mut tracked) = (Spectrum::ZERO, Spectrum::ONE);
    for segment in scene.segments(ray, end, interior).iter() {
        let medium = scene.medium(segment.medium);
        match medium.optical_depth(ray, segment.interval) {
            Some(closed) => depth += closed,
            None => tracked *= segment_transmittance(medium, ray, segment.interval, stream),
        }
    }
    decay(depth) * tracked
}

/// The fraction of light that passes straight from a place (ray, body that it starts on, interior) to distance `end` \[1\],
/// not counting the body at the far end, `towards`, if there is one: through media, filters and index-matched boundaries.
/// None if another body stands in the way, or nothing passes.
pub fn connection(
    scene: &Scene,
    (ray, origin_surface, interior): (&Ray, Option<Start>, usize),
    end: f64,
    towards: Option<Target>,
    stream: &mut Stream,
) -> Option<Spectrum> {
    let filtered = match towards {
        Some(target) => scene.passes(ray, origin_surface, end, target),
        None => scene.sees(ray, origin_surface, end),
    }?;
    let transmitted = match scene.plan().has_matched {
        true => across(scene, (ray, origin_surface, interior), end, towards, stream),
        false => transmittance(scene, ray, end, interior, stream),
    };
    Some(filtered * transmitted)
}

/// The transmittance of a way that nothing blocks, from interior to interior.
fn across(
    scene: &Scene,
    (ray, origin_surface, interior): (&Ray, Option<Start>, usize),
    end: f64,
    towards: Option<Target>,
    stream: &mut Stream,
) -> Spectrum {
    let (mut ray, mut origin_surface, mut interior, mut end, mut transmitted) =
        (*ray, origin_surface, interior, end, Spectrum::ONE);
    loop {
        let next = scene.hit(&ray, origin_surface).filter(|f| f.hit.t < end && Some(f.target) != towards);
        let straight = next.and_then(|found| Some((found, scene.straight_on(&ray, &found, interior)?.1)));
        let Some((found, behind)) = straight else {
            return transmitted * transmittance(scene, &ray, end, interior, stream);
        };
        transmitted *= transmittance(scene, &ray, found.hit.t, interior, stream);
        ray = Ray::new(ray.at(found.hit.t), ray.dir);
        (origin_surface, interior, end) = (Some(found.start()), behind, end - found.hit.t);
    }
}

/// What passes through a stretch of one medium from its near end to any place of it.
#[derive(Debug)]
pub struct Passage<'a> {
    way: (&'a Medium, &'a Ray, f64),
    /// None where the optical depth has a closed form.
    tracked: Option<(Controls, Vec<(f64, Spectrum)>)>,
}

impl<'a> Passage<'a> {
    /// The passage through a stretch: exact where the optical depth has a closed form, else unbiased at every place, by one tracking of
    /// the stretch.
    pub fn new(medium: &'a Medium, ray: &'a Ray, part: Interval, stream: &mut Stream) -> Self {
        let tracked = match medium {
            Medium::Homogeneous(_) => None,
            Medium::Heterogeneous(varying) => match varying.optical_depth(ray, part) {
                Some(_) => None,
                None => {
                    stream.work.transmittances += 1;
                    let mut controls = Controls::default();
                    let steps = track::steps(varying, ray, part, Some(&mut controls), stream);
                    Some((controls, steps))
                }
            },
        };
        Passage { way: (medium, ray, part.start), tracked }
    }

    /// Where the stretch starts \[L\] and the rate of decay from there [1/L], where the medium is the same everywhere.
    pub fn rate(&self) -> Option<(f64, Spectrum)> {
        match self.way {
            (Medium::Homogeneous(medium), _, start) => Some((start, medium.sigma_t())),
            _ => None,
        }
    }

    /// The fraction of light that passes from the near end to a distance `t` along the ray \[1\].
    pub fn to(&self, t: f64) -> Spectrum {
        let (medium, ray, start) = self.way;
        match &self.tracked {
            Some((controls, steps)) => {
                let behind = steps.partition_point(|(from, _)| *from < t);
                let tracked = behind.checked_sub(1).map_or(Spectrum::ONE, |last| steps[last].1);
                decay(medium.matter().depth(controls.to(t))) * tracked
            }
            // A closed form of the whole is one of each part.
            None => decay(medium.integrated_depth(ray, Interval { start, end: t })),
        }
    }
}

/// The transmittance of a stretch of one medium.
pub fn segment_transmittance(medium: &Medium, ray: &Ray, part: Interval, stream: &mut Stream) -> Spectrum {
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
