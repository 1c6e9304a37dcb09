//! Planes across a ray: what a medium scatters towards the near end of a ray, from all planes of flights that it meets.

use super::{Directional, RayEstimate};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray, cosine_pair};
use crate::photons::planes::{Plane, PlaneCrossing, PlaneMap};
use crate::scene::Scene;

/// How light that a medium scatters along a ray is estimated from planes of photons' flights: without a kernel, and without bias.
///
/// Where a plane of legs w0 and w1 meets the ray of direction d, at s along the ray and t along the flight,
///
/// L = sum P sigma_s sigma_s' p(w1, -d) T(s) / (N |d.(w0 x w1)|),
///
/// P the flight's power at t, sigma_s there and sigma_s' at the ray. Both legs have lengths that were drawn, and nothing passes into the
/// sum beside them; the second one reaches the ray if the way is not deeper than what was drawn and no body stands in it, not even a filter.
/// Planes of flights of order n bring light of order n + 2, scattered twice at least: light that is scattered once, and light that comes
/// from a body to where it is scattered last, is read otherwise ([`super::BeamEstimator`]).
///
/// # Limits
/// The variance is infinite in diffuse light: 1/|d.(w0 x w1)| exceeds x in 2 x^-2 of what is found, and the squared error of N photons
/// falls as ln N/N. A mean has a normal distribution in the end, but a standard error between maps is too small by what maps have not
/// met yet. A ray that lies in a plane meets nothing of it.
///
/// # Source
/// Bitterli and Jarosz 2017, "Beyond points and beams: higher-dimensional photon samples for volumetric light transport"
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlaneEstimator;

/// The least determinant that a planted fault leaves.
const CLAMP: f64 = 0.01;

impl PlaneEstimator {
    /// Radiance at the near end of a stretch of a ray [W/(L^2 sr)], scattered by media twice more.
    ///
    /// # Arguments
    /// `ray` looks away from the receiver, so that light travels against it; `span` in the medium of a `number`; `passed` the part of the
    /// light from a distance along the ray \[L\] that reaches the near end
    ///
    /// # Returns
    /// not a number of a stretch without end in a periodic cell
    pub fn radiance(
        &self,
        map: &PlaneMap,
        (ray, span): (&Ray, Interval),
        (scene, number): (&Scene, usize),
        passed: &dyn Fn(f64) -> Spectrum,
    ) -> RayEstimate {
        let medium = scene.medium(number);
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let is_known = map.met(ray, span, |plane, crossing| {
            if !reaches(scene, plane, crossing) {
                rejected += 1;
                return;
            }
            found += 1;
            let (one_minus_mu, one_plus_mu) = cosine_pair(plane.dir, -ray.dir);
            let size = crossing.determinant;
            let size = if planted(Fault::DeterminantClamped) { size.max(CLAMP) } else { size };
            let weight = medium.phase().value(one_minus_mu, one_plus_mu) / size;
            let [first, second] = crossing.along_legs;
            let from = scene.medium(plane.leg.medium as usize);
            let (start, end) = (plane.leg.at(first), plane.at([first, second]));
            let turned = plane.leg.power_at(first, from) * (from.sigma_t(start) * from.albedo(start));
            let turned = turned * (medium.sigma_t(end) * medium.albedo(end));
            sum += turned * passed(crossing.along_ray) * weight;
        });
        let scale = 1.0 / map.emitted() as f64;
        let value = if is_known { sum * scale } else { Spectrum::grey(f64::NAN) };
        RayEstimate { value, found, rejected }
    }
}

/// Whether the second leg reaches the ray before it ends, or at a body.
fn reaches(scene: &Scene, plane: &Plane, crossing: &PlaneCrossing) -> bool {
    let [first, second] = crossing.along_legs;
    if planted(Fault::PlanesUnseen) {
        return true;
    }
    let way = Ray::new(plane.leg.at(first), plane.dir);
    let is_alone = scene.media().len() == 1;
    // Alone, a region is all about the way: the reach said it.
    if !is_alone && scene.optical_depth(&way, second, scene.interior_at(way.origin))[0] >= plane.depth {
        return false;
    }
    scene.hit(&way, None).is_none_or(|found| found.hit.t >= second)
}
