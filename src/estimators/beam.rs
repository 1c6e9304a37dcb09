//! Beams across a ray, and at a place: what a medium scatters towards the near end of a ray, or the fluence, from all flights that come
//! near.

use super::boundary::{Beside, Boundary, Surroundings, body_part};
use super::chord::along_chord;
use super::{BeamBlur, Directional, Estimate, Kernel, OwnEnds, RayEstimate};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::{Interval, Positive, Ray, cosine_pair};
use crate::medium::Medium;
use crate::photons::beams::{Beam, BeamMap, Crossing};
use glam::DVec3;

/// How light that a medium scatters along a ray is estimated from photons' flights: beams across rays, blurred in one dimension.
///
/// Where a beam's line and the ray come nearest, at s along the ray and u apart, theta the angle between them,
///
/// L = sum sigma_s p P T(s) K_r(u) / (N sin theta),
///
/// K_r the kernel on the line across both, sigma_s and the beam's power P at its nearest point. Every flight counts wherever it passes
/// the ray, and not only where it ends: the variance falls with r in place of the r^2 of points, and at equal radii beams have less
/// of it where r is below 0.4 mean free paths. Flights through other media, and those that a body hides from the ray, do not count.
/// Where it is clipped, the part of the kernel along the common normal that is in the medium and seen makes up for them: uniform
/// isotropic light comes out right, whatever the radius.
///
/// # Limits
/// Beams exactly parallel to the ray have no nearest point and bring nothing: look along a laser by points, or aslant. Of others
/// nothing is dropped or held below a bound. Where light is isotropic 1/sin theta exceeds x in 4/(3 pi) x^-3 of what is found: the
/// variance is finite, and an estimate of it comes slowly.
///
/// # Source
/// Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, "A comprehensive theory of volumetric radiance estimation using photon points and
/// beams"
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamEstimator {
    /// How beams are weighted by their distance from the ray.
    pub kernel: Kernel,
    /// Beams that pass the ray farther away than this do not count \[L\].
    pub radius: Positive,
    /// Whether what a beam brings is divided by the part of the kernel along the common normal that is in the medium and seen from
    /// the ray.
    pub is_clipped: bool,
}

/// Bodies are looked for a little beyond a beam, so that rounding leaves none out.
const BEYOND: f64 = 1.001;

/// The least sine that a planted fault leaves.
const CLAMP: f64 = 0.01;

impl BeamEstimator {
    /// Radiance at the near end of a stretch of a ray [W/(L^2 sr)], scattered by a medium once more: beams of every order bring light
    /// of the next one.
    ///
    /// # Arguments
    /// `ray` looks away from the receiver, so that light travels against it; `span` in the `medium` of a number, and `boundary` what is
    /// about it; `passed` the part of the light from a distance along the ray \[L\] that reaches the near end
    ///
    /// # Returns
    /// not a number in a periodic cell that is smaller than the radius, or of a stretch without end there
    ///
    /// # Limits
    /// the stretch is cut square at its ends: if it is not clipped the light of a length of r tan(theta)/(2 pi) is missing at a face
    /// that the ray meets aslant (uniform kernel, isotropic light), and what bodies beside the ray hide
    pub fn radiance(
        &self,
        map: &BeamMap,
        (ray, span): (&Ray, Interval),
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
        passed: &dyn Fn(f64) -> Spectrum,
    ) -> RayEstimate {
        self.across((map, ray, span), (number, medium), boundary, |_, foot| passed(foot))
    }

    /// The sum over beams that cross near the ray; `passed` by the place and its foot.
    fn across(
        &self,
        (map, ray, span): (&BeamMap, &Ray, Interval),
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
        passed: impl Fn(DVec3, f64) -> Spectrum,
    ) -> RayEstimate {
        let (radius, phase) = (self.radius.get(), medium.phase());
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let beside = Beside::new(boundary, ray, span, radius);
        let is_known = map.near(ray, span, radius, |beam, crossing| {
            let share = match beam.medium as usize == number {
                true => self.line_share(&beside, ray, crossing),
                false => None,
            };
            let Some(share) = share else {
                rejected += 1;
                return;
            };
            found += 1;
            let (one_minus_mu, one_plus_mu) = cosine_pair(beam.dir, -ray.dir);
            let (u, sine) = (crossing.offset / radius, crossing.sine);
            let sine = if planted(Fault::SineClamped) { sine.max(CLAMP) } else { sine };
            let weight = phase.value(one_minus_mu, one_plus_mu) * self.kernel.profile((u * u).min(1.0))
                / (sine * share);
            let place = ray.at(crossing.along_ray) + crossing.normal * crossing.offset;
            let sigma_s = medium.sigma_t(place) * medium.albedo(place);
            let power = beam.power_at(crossing.along_beam, medium);
            sum += power * sigma_s * passed(place, crossing.along_ray) * weight;
        });
        let peak = self.kernel.line_peak() * if planted(Fault::LineHalved) { 2.0 } else { 1.0 };
        let scale = peak / radius / map.emitted() as f64;
        let value = if is_known { sum * scale } else { Spectrum::grey(f64::NAN) };
        RayEstimate { value, found, rejected }
    }

    /// Fluence at a place [W/L^2]: the sum of P K_r(d)/N over the beams that pass it at a distance d, K_r the kernel on the disc across
    /// each of them, of this radius, and P the beam's power beside the place. The variance falls with r^2 in place of the r^3 of balls,
    /// and the blur lies across the beams alone.
    ///
    /// # Arguments
    /// `place` in the `medium` of a number, and `boundary` what is about it
    ///
    /// # Returns
    /// not a number in a periodic cell that is smaller than the radius
    ///
    /// # Limits
    /// a disc that is not clipped loses what lies beyond faces and behind bodies; the part of it that is left is exact where planes and flat bodies
    /// bound it, by a rule in a sphere, and else found by 32 directions
    ///
    /// # Source
    /// Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, beams at a point with a blur in two dimensions
    pub fn fluence(
        &self,
        map: &BeamMap,
        place: DVec3,
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
    ) -> Estimate {
        self.at_place(map, place, (number, medium), boundary, |_| 1.0)
    }

    /// Radiance that collisions at a place scatter into a direction of travel `wo`, over the albedo and the collision coefficient
    /// [W/(L^2 sr)]: as [`BeamEstimator::fluence`], each beam with the phase function.
    pub fn in_scattered(
        &self,
        map: &BeamMap,
        (place, wo): (DVec3, DVec3),
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
    ) -> Estimate {
        let phase = medium.phase();
        self.at_place(map, place, (number, medium), boundary, |dir| {
            let (one_minus_mu, one_plus_mu) = cosine_pair(dir, wo);
            phase.value(one_minus_mu, one_plus_mu)
        })
    }

    /// The sum over the beams about a place, each with a weight of its direction.
    fn at_place(
        &self,
        map: &BeamMap,
        place: DVec3,
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
        of: impl Fn(DVec3) -> f64,
    ) -> Estimate {
        let radius = self.radius.get();
        let is_whole = boundary.medium.is_none_or(|medium| medium.room(place) >= radius);
        let is_free = boundary.is_clear() && (is_whole || !self.is_clipped);
        let about = (!is_free).then(|| Surroundings::new(boundary, place, place, BEYOND * radius));
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let is_known = map.about(place, radius, |beam, along, squared| {
            let way = (beam.start - place) + beam.dir * along;
            if beam.medium as usize != number || about.as_ref().is_some_and(|about| !about.sees(place + way))
            {
                rejected += 1;
                return;
            }
            found += 1;
            let share = match &about {
                Some(about) if self.is_clipped && !(about.is_clear(radius) && is_whole) => {
                    let share = about.disc_share(self.kernel, beam.dir, radius, beam.start.x.to_bits());
                    share.divisor(self.kernel, squared.sqrt() / radius)
                }
                _ => 1.0,
            };
            let weight = self.kernel.profile((squared / (radius * radius)).min(1.0)) / share;
            sum += beam.power_at(along, medium) * (weight * of(beam.dir));
        });
        let scale = self.kernel.disc_peak() / (radius * radius) / map.emitted() as f64;
        let value = if is_known { sum * scale } else { Spectrum::grey(f64::NAN) };
        Estimate { value, radius, found, underfull: false, coincident: 0, rejected }
    }

    /// The same as [`BeamEstimator::radiance`] with a blur in two dimensions, across the ray:
    ///
    /// L = sum P/N int sigma_s p tau(t) T(s(t)) K_r(rho(t)) dt
    ///
    /// along each beam, tau what passes of it, rho its distance from the ray and s its foot there, K_r the kernel on the disc. Its mean is
    /// that of points along rays ([`super::RayEstimator`]), and its variance falls with r. No term has a singularity: beams that are
    /// parallel to the ray count as others do.
    ///
    /// # Returns
    /// as [`BeamEstimator::radiance`]
    ///
    /// # Limits
    /// the variance is r^-1 times 8/(3 pi) in place of pi/4 of the blur in one dimension (uniform kernel, isotropic light, long beams)
    pub fn radiance_in_2d(
        &self,
        map: &BeamMap,
        (ray, span): (&Ray, Interval),
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
        passed: &dyn Fn(f64) -> Spectrum,
    ) -> RayEstimate {
        self.within((map, ray, span), (number, medium), boundary, |_, foot| passed(foot))
    }

    /// The sum over the chords of beams near the ray; `passed` by the place and its foot.
    fn within(
        &self,
        (map, ray, span): (&BeamMap, &Ray, Interval),
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
        passed: impl Fn(DVec3, f64) -> Spectrum,
    ) -> RayEstimate {
        let (radius, phase) = (self.radius.get(), medium.phase());
        let rate = 2.0 * medium.highest_sigma_t().max();
        let beside = Beside::new(boundary, ray, span, radius);
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let is_known = map.chords_near(ray, span, radius, |beam, chord, here| {
            let (one_minus_mu, one_plus_mu) = cosine_pair(beam.dir, -ray.dir);
            let value = phase.value(one_minus_mu, one_plus_mu);
            let mut counts = false;
            if beam.medium as usize == number {
                along_chord(chord, rate, |t, weight| {
                    let way = (beam.start - here.origin) + beam.dir * t;
                    let s = way.dot(ray.dir);
                    let away = way - ray.dir * s;
                    let Some(share) = self.disc_share(&beside, (ray, s), away, beam) else {
                        return;
                    };
                    counts = true;
                    let u2 = (away.length_squared() / (radius * radius)).min(1.0);
                    let place = ray.at(s) + away;
                    let sigma_s = medium.sigma_t(place) * medium.albedo(place);
                    let weight = weight * self.kernel.profile(u2) * value / share;
                    sum += beam.power_at(t, medium) * sigma_s * passed(place, s) * weight;
                });
            }
            found += usize::from(chord.is_first && counts);
            rejected += usize::from(chord.is_first && !counts);
        });
        let scale = self.kernel.disc_peak() / (radius * radius) / map.emitted() as f64;
        let value = if is_known { sum * scale } else { Spectrum::grey(f64::NAN) };
        RayEstimate { value, found, rejected }
    }

    /// The same where each beam ends for itself ([`OwnEnds`]), blurred in one dimension or in two: the radiance at the ray's origin blurred
    /// across the ray, of which nothing is lost at faces, whatever the radius, and so not clipped. Not a number of a blur in three.
    pub fn radiance_of_own_ends(
        &self,
        map: &BeamMap,
        (ray, ends): (&Ray, &OwnEnds<'_>),
        of: (usize, &Medium),
        blur: BeamBlur,
    ) -> RayEstimate {
        let whole = BeamEstimator { is_clipped: false, ..*self };
        let way = (map, ray, ends.span());
        let passed = |place: DVec3, foot: f64| ends.passed(place, foot);
        match blur {
            BeamBlur::OneD => whole.across(way, of, &Boundary::UNKNOWN, passed),
            BeamBlur::TwoD => whole.within(way, of, &Boundary::UNKNOWN, passed),
            BeamBlur::ThreeD => RayEstimate { value: Spectrum::grey(f64::NAN), found: 0, rejected: 0 },
        }
    }

    /// The same as [`BeamEstimator::fluence`] with a blur in three dimensions: the sum of P/N int tau(t) K_r(d(t)) dt along each beam, d
    /// its distance from the place, K_r the kernel on the ball. Its mean is that of points in balls, and its variance falls with r^2.
    ///
    /// # Returns
    /// as [`BeamEstimator::fluence`]
    ///
    /// # Source
    /// Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, beams at a point with a blur in three dimensions
    pub fn fluence_in_3d(
        &self,
        map: &BeamMap,
        place: DVec3,
        (number, medium): (usize, &Medium),
        boundary: &Boundary<'_>,
    ) -> Estimate {
        let radius = self.radius.get();
        let ending = boundary.medium.filter(|medium| medium.room(place) < radius);
        let is_free = boundary.is_clear() && (ending.is_none() || !self.is_clipped);
        let about = (!is_free).then(|| Surroundings::new(boundary, place, place, BEYOND * radius));
        let share = match &about {
            Some(about) if self.is_clipped && !about.is_clear(radius) => {
                about.share(self.kernel, radius, map.salt())
            }
            _ => match ending.filter(|_| self.is_clipped) {
                Some(medium) => body_part(self.kernel, medium, place, radius),
                None => 1.0,
            },
        };
        let rate = medium.highest_sigma_t().max();
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let is_known = map.chords_about(place, radius, |beam, chord, here| {
            let mut counts = false;
            if beam.medium as usize == number {
                along_chord(chord, rate, |t, weight| {
                    let way = (beam.start - here) + beam.dir * t;
                    if about.as_ref().is_some_and(|about| !about.sees(place + way)) {
                        return;
                    }
                    counts = true;
                    let u2 = (way.length_squared() / (radius * radius)).min(1.0);
                    sum += beam.power_at(t, medium) * (weight * self.kernel.profile(u2));
                });
            }
            found += usize::from(chord.is_first && counts);
            rejected += usize::from(chord.is_first && !counts);
        });
        let scale = self.kernel.peak() / (radius * radius * radius) / share / map.emitted() as f64;
        let value = if is_known { sum * scale } else { Spectrum::grey(f64::NAN) };
        Estimate { value, radius, found, underfull: false, coincident: 0, rejected }
    }

    /// What a place of a beam, `away` from its foot on the ray, is divided by; none if a body hides it from there.
    fn disc_share(
        &self,
        beside: &Beside<'_>,
        (ray, along): (&Ray, f64),
        away: DVec3,
        beam: &Beam,
    ) -> Option<f64> {
        let (radius, seen) = (self.radius.get(), away.length());
        let at = (along, radius, seen);
        let sees = |about: &Surroundings<'_>| about.sees(ray.at(along) + away);
        let share =
            beside.disc_share(self.kernel, at, (self.is_clipped, true), beam.start.x.to_bits(), sees)?;
        Some(share.divisor(self.kernel, seen / radius))
    }

    /// What a beam is divided by; none if a body hides it from the ray.
    fn line_share(&self, beside: &Beside<'_>, ray: &Ray, crossing: &Crossing) -> Option<f64> {
        let (radius, along, seen) = (self.radius.get(), crossing.along_ray, crossing.offset.abs());
        beside.line_divisor(self.kernel, (along, radius, seen), self.is_clipped, crossing.normal, |about| {
            about.sees(ray.at(along) + crossing.normal * crossing.offset)
        })
    }
}
