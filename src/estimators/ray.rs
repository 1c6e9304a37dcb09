//! Points along a ray: what a medium scatters towards the near end of a ray, from all photons about the ray at once.

use super::boundary::{Beside, BesideRows, Boundary};
use super::point::LaneSum;
use super::{CosinePairs, Directional, Kernel, OwnEnds, Transmitted};
use crate::Spectrum;
use crate::math::{Interval, Positive, Ray, cosine_pair};
use crate::medium::Medium;
use crate::photons::tree::{Neighbors, Radii};
use crate::photons::{Photon, PhotonMap};
use crate::scene::decay;
use glam::DVec3;
use wide::f32x8;

/// How light that a medium scatters along a ray is estimated from the photons about the ray: the beam radiance estimate.
///
/// With rho the distance of a photon from the ray, s its foot on it, p the phase function and T what passes from there,
///
/// L = sum albedo power p T(s) K_r(rho) / N,
///
/// K_r the kernel on the disc across the ray. Its mean is the integral of T over the source blurred across the ray, so that no step
/// is left to choose; the variance falls with r^2 in place of the r^3 of balls. Photons of other media, and those that a body hides from
/// their foot, do not count. Where it is clipped, what is left of the disc makes up for them, and for what lies beyond the medium's faces:
/// a uniform source comes out right, whatever the radius.
///
/// # Source
/// Jarosz, Zwicker and Jensen 2008, "The beam radiance estimate for volumetric photon mapping"; with a fixed radius, or with theirs
/// ([`RayEstimator::radiance_by_radii`])
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayEstimator {
    /// How photons are weighted by their distance from the ray.
    pub kernel: Kernel,
    /// Photons farther from the ray than this do not count \[L\]: the radius of all, or the largest that one of them has.
    pub radius: Positive,
    /// Whether what a photon brings is divided by the part of the disc about its foot, or nearly there, that is in the medium and seen.
    pub is_clipped: bool,
}

/// An estimate along a ray, and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayEstimate {
    /// Radiance at the near end of the stretch [W/(L^2 sr)].
    pub value: Spectrum,
    /// Photons about the ray that count.
    pub found: usize,
    /// Photons about the ray that do not, since they are of another medium, or a body hides them from their foot.
    pub rejected: usize,
}

impl RayEstimator {
    /// Radiance at the near end of a stretch of a ray [W/(L^2 sr)], scattered by a medium once more: photons of every order
    /// bring light of the next one.
    ///
    /// # Arguments
    /// `ray` looks away from the receiver, so that light travels against it; `span` in the `medium`, and `boundary` what is about
    /// it; `passed` the part of the light from a distance along the ray \[L\] that reaches the near end. Where it has a closed form
    /// ([`Transmitted::decay`]) photons are summed by rows, in single precision, within some 10^-6, but for those beside bodies that are
    /// not flat and beside other media; near faces and bodies the part of the disc is then the mean over a stretch of a quarter of
    /// the radius. One by one beside anything where the stretch is longer than 256 radii, and everywhere where the radius is below
    /// 10^-3 of the map or the map is thicker than some 16 mean free paths
    ///
    /// # Returns
    /// not a number in a periodic cell that holds no copies as far as the radius, or of a stretch without end there
    ///
    /// # Limits
    /// the stretch is cut square at its ends: if it is not clipped the light of a length of (2/(3 pi)) r tan(theta) is missing at a
    /// face that the ray meets aslant (uniform kernel), and what bodies beside the ray hide; clipped beside
    /// curved bodies, among other media, and beside any body in a ball a photon is divided by no less than 1/32 of the kernel within its
    /// distance, so that gaps thinner than a twentieth of the radius come out too dark there
    pub fn radiance(
        &self,
        map: &PhotonMap,
        (ray, span): (&Ray, Interval),
        medium: &Medium,
        boundary: &Boundary<'_>,
        passed: &dyn Transmitted,
    ) -> RayEstimate {
        let radius = self.radius.get();
        let mut rows = passed.decay().and_then(|decay| Rows::new(self, map, (ray, medium), decay));
        let rest = self.summed(
            map,
            (ray, span),
            (medium, boundary),
            |_, foot| passed.from(foot),
            |beside, visit| {
                let mut visit = |photon, foot, squared| visit(photon, radius, foot, squared);
                if let Some(rows) = &mut rows {
                    let clipping = (self.kernel, radius, self.is_clipped);
                    let mut about = BesideRows::new(beside, (map.tree(), ray, span), clipping, map.run());
                    let parts = about.parts().to_vec();
                    let way = (ray, span, radius);
                    if map
                        .along_by_rows(way, &parts, &mut visit, |row, feet| rows.add(&row, feet, &mut about))
                    {
                        return true;
                    }
                }
                map.along(ray, span, radius, visit)
            },
        );
        match rows {
            Some(rows) => RayEstimate {
                value: rest.value + rows.sum.total() * rows.before * self.scale(map, radius),
                found: rest.found + number(rows.found),
                rejected: rest.rejected + number(rows.told - rows.found),
            },
            None => rest,
        }
    }

    /// The same with a radius for each photon in place of one for all, none of them above it: with r(y) that of a photon at y its mean
    /// is the integral of T over that of K_{r(y)}(y - x) f(y) over y, f the source, and its bias (m2/4) of the Laplacian of r^2 f
    /// across the ray, which is not r^2 times that of f.
    ///
    /// # Limits
    /// radii of the k nearest are those of the map's own photons, and depend on what they weigh: at few of them the mean is another one;
    /// beside a face they grow, since half of the neighbours is missing, and a uniform source comes out too dark within a radius of it
    ///
    /// # Source
    /// Jarosz, Zwicker and Jensen 2008, as published: k nearest photons at each photon
    pub fn radiance_by_radii(
        &self,
        (map, radii): (&PhotonMap, &Radii),
        (ray, span): (&Ray, Interval),
        medium: &Medium,
        boundary: &Boundary<'_>,
        passed: &dyn Fn(f64) -> Spectrum,
    ) -> RayEstimate {
        self.summed(
            map,
            (ray, span),
            (medium, boundary),
            |_, foot| passed(foot),
            |_, visit| map.along_by_radii(ray, span, radii, visit),
        )
    }

    /// The same where each photon ends for itself ([`OwnEnds`]): the radiance at the ray's origin blurred across the ray, of which nothing
    /// is lost at faces, whatever the radius, and so not clipped. With one radius for all, or with those of photons.
    pub fn radiance_of_own_ends(
        &self,
        (map, radii): (&PhotonMap, Option<&Radii>),
        (ray, ends): (&Ray, &OwnEnds<'_>),
        medium: &Medium,
    ) -> RayEstimate {
        let whole = RayEstimator { is_clipped: false, ..*self };
        let of = (medium, &Boundary::UNKNOWN);
        let radius = self.radius.get();
        let passed = |place: DVec3, foot: f64| ends.passed(place, foot);
        whole.summed(map, (ray, ends.span()), of, passed, |_, visit| match radii {
            Some(radii) => map.along_by_radii(ray, ends.span(), radii, visit),
            None => map.along(ray, ends.span(), radius, |photon, foot, squared| {
                visit(photon, radius, foot, squared)
            }),
        })
    }

    /// The sum over the photons that `each` tells, with their radius, their foot along the ray and their squared distance from it.
    fn summed(
        &self,
        map: &PhotonMap,
        (ray, span): (&Ray, Interval),
        (medium, boundary): (&Medium, &Boundary<'_>),
        passed: impl Fn(DVec3, f64) -> Spectrum,
        each: impl FnOnce(&Beside<'_>, &mut dyn FnMut(Photon, f64, f64, f64)) -> bool,
    ) -> RayEstimate {
        let phase = medium.phase();
        let (mut sum, mut found, mut rejected) = (Spectrum::ZERO, 0, 0);
        let beside = Beside::new(boundary, ray, span, self.radius.get());
        let is_known = each(&beside, &mut |photon, radius, foot, squared| {
            let place = (photon.position, radius, squared);
            let Some(share) = self.share(map, (boundary, &beside), place, foot) else {
                rejected += 1;
                return;
            };
            found += 1;
            let (one_minus_mu, one_plus_mu) = cosine_pair(photon.dir.as_dvec3(), -ray.dir);
            let area = radius * radius;
            let weight =
                phase.value(one_minus_mu, one_plus_mu) * self.kernel.profile((squared / area).min(1.0));
            let albedo = medium.albedo(photon.position);
            sum += Spectrum(photon.power.as_dvec3())
                * albedo
                * passed(photon.position, foot)
                * (weight / (area * share));
        });
        let value = if is_known { sum * self.scale(map, 1.0) } else { Spectrum::grey(f64::NAN) };
        RayEstimate { value, found, rejected }
    }

    /// What a sum of photons is multiplied by whose kernels are relative to a radius.
    fn scale(&self, map: &PhotonMap, radius: f64) -> f64 {
        self.kernel.disc_peak() / (radius * radius) / map.emitted() as f64
    }

    /// What a photon is divided by; none if it is of another medium, or a body hides it from its foot on the ray.
    fn share(
        &self,
        map: &PhotonMap,
        (boundary, beside): (&Boundary<'_>, &Beside<'_>),
        (photon, radius, squared): (DVec3, f64, f64),
        foot: f64,
    ) -> Option<f64> {
        let seen = squared.sqrt();
        let (at, asked) = ((foot, radius, seen), (self.is_clipped, boundary.is_only));
        let share = beside.disc_share(self.kernel, at, asked, map.run(), |about| about.keeps(photon))?;
        Some(share.divisor(self.kernel, seen / radius))
    }
}

/// The sum of whole numbers in lanes.
fn number(lanes: f32x8) -> usize {
    lanes.as_array().iter().map(|lane| *lane as usize).sum()
}

/// Optical depths of the map's unit above this are asked in double precision: exponents in single precision have 10^-7 of it.
const THICK: f64 = 16.0;

/// Exponents beyond this are those of a stretch that holds no photon.
const NOWHERE: f64 = 64.0;

/// The sum over photons about a ray by rows, of a medium that is the same everywhere.
struct Rows<'a> {
    kernel: Kernel,
    medium: &'a Medium,
    /// Direction of travel towards the near end.
    wo: [f32; 3],
    /// What passes from the feet, in the tree's unit; the first of them where all channels are the same.
    decays: [Decay; 3],
    is_grey: bool,
    /// What passes from where feet count, times the albedo.
    before: Spectrum,
    sum: LaneSum,
    /// How many photons count, and all that were told of, by lanes.
    found: f32x8,
    told: f32x8,
}

impl<'a> Rows<'a> {
    /// None where the medium is too thick for single precision.
    fn new(
        of: &RayEstimator,
        map: &PhotonMap,
        (ray, medium): (&Ray, &'a Medium),
        (start, rate): (f64, Spectrum),
    ) -> Option<Self> {
        let (unit, middle) = (map.tree().unit(), map.tree().middle_of(ray));
        let depth = rate.map(|rate| (rate * (middle - start)).max(-NOWHERE));
        (rate.max() * unit <= THICK).then(|| Rows {
            kernel: of.kernel,
            medium,
            wo: (-ray.dir).as_vec3().to_array(),
            decays: rate.0.to_array().map(|rate| Decay::new(rate * unit)),
            is_grey: rate.is_grey(),
            before: decay(depth) * medium.albedo(ray.at(start)),
            sum: LaneSum::default(),
            found: f32x8::ZERO,
            told: f32x8::ZERO,
        })
    }

    #[inline(always)]
    fn add(&mut self, row: &Neighbors<'_>, feet: f32x8, about: &mut BesideRows<'_>) {
        let (kept, shares) = about.kept(row, feet);
        self.found += kept & f32x8::ONE;
        self.told += row.inside() & f32x8::ONE;
        let pairs = CosinePairs { dir: row.dir(), wo: self.wo, inside: kept };
        let value = self.kernel.profiles(row.u2()) * self.medium.phase().values(pairs) / shares;
        let weight = |decay: &Decay| kept & (value * decay.of(feet));
        if self.is_grey {
            self.sum.add(weight(&self.decays[0]), row.power());
        } else {
            self.sum.add_each(self.decays.each_ref().map(weight), row.power());
        }
    }
}

/// exp(-rate t) in single precision.
#[derive(Clone, Copy)]
struct Decay {
    /// The rate over 2^squarings.
    rate: f32,
    squarings: u32,
}

impl Decay {
    /// For |t| up to 2: what is squared is within [exp(-1/8), exp(1/8)].
    fn new(rate: f64) -> Self {
        let (mut rate, mut squarings) = (-rate, 0);
        while rate < -0.0625 {
            rate *= 0.5;
            squarings += 1;
        }
        Decay { rate: rate as f32, squarings }
    }

    /// Taylor's series to the fifth power: its remainder is below 6 x 10^-9, and what rounding leaves doubles with each squaring: 10^-5 in the thickest.
    #[inline(always)]
    fn of(&self, t: f32x8) -> f32x8 {
        let x = t * f32x8::splat(self.rate);
        let x2 = x * x;
        // By pairs, which do not wait for each other.
        let pair = |even: f32, odd: f32| f32x8::splat(1.0 / even) + x * f32x8::splat(1.0 / odd);
        let mut power = pair(1.0, 1.0) + x2 * (pair(2.0, 6.0) + x2 * pair(24.0, 120.0));
        for _ in 0..self.squarings {
            power *= power;
        }
        power
    }
}
