//! Estimates near a boundary: what they do where the medium ends inside the ball, and about photons behind a wall.
//!
//! With K_r the kernel of the ball about x, O the medium, z = (y - x) . n / r the depth along the inward normal n of the
//! nearest boundary point, S_j = sum p K_r z^j over the gathered photons and M_j = int_O K_r z^j:
//!
//! | treatment | estimate | in a uniform field f |
//! |---|---|---|
//! | none | S_0 | f M_0 |
//! | clipped | S_0 / M_0 | f |
//! | reflection | sum p (K_r + K_r of the photon's images) | f between flat faces |
//! | local linear | (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2) | f |
//!
//! All four are the plain estimate where the ball is whole. The radius of a k-nearest gather is set by real, accepted photons
//! alone: an image, or a rejected photon, sets none.
//!
//! Where bodies stand in the medium, photons that they hide from x are rejected, and S_0 is divided by the part of the
//! kernel that x sees: f again in any geometry, whichever treatment it is. Closed forms stay where only the medium's own
//! faces are in the ball.

mod accepted;
mod images;
mod moments;
mod rejection;
mod solid;
mod visible;

pub use moments::body_moments;
pub use rejection::Rejection;

use super::point::in_scattered_sum;
use super::{BallSum, Directional, Estimate, Gather, Kernel, ball_sum, for_each_photon};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::math::cosine_pair;
use crate::photons::{Photon, PhotonMap};
use accepted::{Accepted, accepted};
use glam::DVec3;
use images::images;
use moments::{LEAST_PART, body_part, inward_normal};
use rejection::Sieve;
use std::borrow::Cow;
use visible::Surroundings;

/// What an estimate does about the part of its ball that lies outside the medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Treatment {
    /// Nothing: it loses up to half at a face.
    None,
    /// Divides by the part of the kernel that is inside (Diggle 1985).
    Clipped,
    /// Mirrors the photons in each face, edge and corner; in a sphere in the tangent plane (Silverman 1986, 2.10).
    Reflection,
    /// Fits a constant and a slope along the normal (Jones 1993). Exact for linear fields at a flat face, at the cost of
    /// variance; may be negative, and is never clamped.
    LocalLinear,
}

impl Treatment {
    /// Every one.
    pub const ALL: [Treatment; 4] =
        [Treatment::None, Treatment::Clipped, Treatment::Reflection, Treatment::LocalLinear];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Treatment::None => "none",
            Treatment::Clipped => "clipped",
            Treatment::Reflection => "reflection",
            Treatment::LocalLinear => "local linear",
        }
    }
}

/// The boundaries that an estimate is told of.
#[derive(Debug, Clone)]
pub struct Boundary<'a> {
    /// The shape of the medium; none where it is not known, and its own faces are left untreated.
    medium: Option<Cow<'a, Shape>>,
    treatment: Treatment,
    rejection: Rejection,
    walls: &'a [Shape],
    /// Regions in the medium's shape that count instead of it.
    later: &'a [Shape],
    /// Surfaces that may part the medium.
    bodies: &'a [Shape],
    /// Whether every photon is of this medium.
    is_only: bool,
}

impl Boundary<'static> {
    /// A treatment of the surface of the medium, or of the part of it that is on the points' side of a wall.
    ///
    /// # Errors
    /// [`Error::Scene`] if `medium` is a rectangle, which has no inside.
    pub fn new(medium: Shape, treatment: Treatment) -> Result<Self> {
        if !medium.is_solid() {
            return Err(Error::Scene("a rectangle bounds no medium: name a sphere, slab or cuboid".into()));
        }
        Ok(Boundary { medium: Some(Cow::Owned(medium)), ..Boundary::unknown(treatment) })
    }

    /// Of a medium whose shape is not known: bodies alone bound it.
    pub fn unknown(treatment: Treatment) -> Self {
        Boundary {
            medium: None,
            treatment,
            rejection: Rejection::Off,
            walls: &[],
            later: &[],
            bodies: &[],
            is_only: true,
        }
    }
}

impl<'a> Boundary<'a> {
    /// A treatment of the surface of a medium of this shape, which is borrowed; none where it has no inside.
    pub fn of(medium: &'a Shape, treatment: Treatment) -> Option<Self> {
        let medium = medium.is_solid().then_some(Cow::Borrowed(medium))?;
        Some(Boundary { medium: Some(medium), ..Boundary::unknown(treatment) })
    }

    /// The same, with photons rejected that walls part from the point.
    pub fn with_walls(self, rejection: Rejection, walls: &'a [Shape]) -> Self {
        Boundary { rejection, walls, ..self }
    }

    /// The same where there is more than the medium: photons that collided elsewhere are rejected, which are those outside
    /// it and those in `later`, regions in its shape that count instead of it. One that holds the point holds the medium
    /// too, and does not count.
    pub fn among(self, later: &'a [Shape]) -> Self {
        Boundary { later, is_only: false, ..self }
    }

    /// The same where these surfaces stand in the medium: photons that they hide from the point are rejected.
    pub fn about(self, bodies: &'a [Shape]) -> Self {
        Boundary { bodies, ..self }
    }

    /// Distance to the medium's surface \[L\]; endless where that is not known.
    fn room(&self, point: DVec3) -> f64 {
        self.medium.as_ref().map_or(f64::INFINITY, |medium| medium.room(point))
    }
}

/// An estimate near a boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Treated {
    /// The estimate; `found` counts accepted photons, no images.
    pub estimate: Estimate,
    /// Rejected photons in the ball.
    pub rejected: usize,
}

/// Fluence at a point [W/L^2] as [`treated_density`] estimates it: density over sigma_t.
///
/// # Arguments
/// `sigma_t` [1/L] at the point, above zero in every channel, as in [`fluence`](super::fluence)
pub fn treated_fluence(
    map: &PhotonMap,
    point: DVec3,
    sigma_t: Spectrum,
    kernel: Kernel,
    gather: Gather,
    boundary: &Boundary<'_>,
) -> Treated {
    let mut treated = treated_density(map, point, kernel, gather, boundary);
    treated.estimate.value = treated.estimate.value.over(sigma_t);
    treated
}

/// Density of collisions at a point, by power [W/L^3], with a treatment of boundaries.
///
/// # Arguments
/// `point` inside the medium or on its boundary. Reflection in a slab, or a cuboid, is exact for radii up to the
/// distance of opposite faces
/// # Limits
/// with a whole ball and nothing rejected it is [`collision_density`](super::collision_density), bit by bit
/// # Source
/// Jones 1993, "Simple boundary correction for kernel density estimation"
pub fn treated_density(
    map: &PhotonMap,
    point: DVec3,
    kernel: Kernel,
    gather: Gather,
    boundary: &Boundary<'_>,
) -> Treated {
    let point = map.place(point, gather.cap());
    let plain = || ball_sum(map, point, kernel, gather);
    treated(map, (point, point), kernel, gather, boundary, plain, &|_| 1.0)
}

/// In-scattered radiance times sigma_t [W/(L^3 sr)], with a treatment of boundaries: each photon weighted by the phase
/// function, images of photons by that of their own directions.
///
/// # Arguments
/// `wo` unit direction of travel after the scattering; the rest as in [`treated_density`]
pub fn treated_in_scattered(
    map: &PhotonMap,
    point: DVec3,
    wo: DVec3,
    phase: &impl Directional,
    kernel: Kernel,
    gather: Gather,
    boundary: &Boundary<'_>,
) -> Treated {
    let point = map.place(point, gather.cap());
    let plain = || in_scattered_sum(map, point, wo, phase, kernel, gather);
    let value = |photon: &Photon| {
        let (one_minus_mu, one_plus_mu) = cosine_pair(photon.dir.as_dvec3(), wo);
        phase.value(one_minus_mu, one_plus_mu)
    };
    // A step of a march may begin on a body, and goes on from there.
    let eye = point - wo * (AHEAD * gather.cap());
    treated(map, (point, eye), kernel, gather, boundary, plain, &value)
}

/// Bodies and photons are looked for a little beyond a ball, so that rounding leaves none in it out.
const BEYOND: f64 = 1.001;

/// How far ahead of the point is looked from, in parts of the largest radius.
const AHEAD: f64 = 1e-9;

/// The treated sum of power x weight at a point where the tree may be asked; `plain` is the untreated one. The second point is
/// where bodies are looked at from.
fn treated(
    map: &PhotonMap,
    (point, eye): (DVec3, DVec3),
    kernel: Kernel,
    gather: Gather,
    boundary: &Boundary<'_>,
    plain: impl FnOnce() -> BallSum,
    value: &dyn Fn(&Photon) -> f64,
) -> Treated {
    let sieve = Sieve::new(boundary.rejection, boundary.walls, point, gather.cap());
    let (mut whole, mut hidden) = (None, None);
    if sieve.is_none() {
        let plain = plain();
        let radius = plain.ball.radius;
        let about = Surroundings::new(boundary, point, eye, BEYOND * radius);
        let count = about.count_rejected(map.tree(), point, BEYOND * radius);
        hidden = Some(count);
        if count == 0 {
            // The sum over accepted photons is the plain one.
            let is_whole = boundary.treatment == Treatment::None || about.is_clear(radius);
            whole = Some(match is_whole {
                true => treated_sum(map, point, kernel, gather, boundary, plain, value),
                false => BallSum { sum: plain.sum / about.share(kernel, radius, map.run()), ..plain },
            });
        }
    }
    let (BallSum { sum, ball }, rejected) = match whole {
        Some(plain) => (plain, 0),
        None => {
            let about = Surroundings::new(boundary, point, eye, BEYOND * gather.cap());
            let keeps = |place: usize| {
                sieve.as_ref().is_none_or(|sieve| sieve.keeps(&map.tree().photon(place)))
                    && about.keeps(map.tree().position(place))
            };
            let gathered = accepted(map.tree(), point, gather, &keeps, hidden);
            sifted_sum((map.run(), point), kernel, boundary, &about, gathered, value)
        }
    };
    let estimate = Estimate {
        value: sum / map.emitted() as f64,
        radius: ball.radius,
        found: ball.found,
        underfull: ball.underfull,
        coincident: ball.coincident,
    };
    Treated { estimate, rejected }
}

/// No body is in the ball, and nothing is rejected: the sums are those of other estimates.
fn treated_sum(
    map: &PhotonMap,
    point: DVec3,
    kernel: Kernel,
    gather: Gather,
    boundary: &Boundary<'_>,
    mut plain: BallSum,
    value: &dyn Fn(&Photon) -> f64,
) -> BallSum {
    let r = plain.ball.radius;
    let Some(medium) = boundary.medium.as_ref().filter(|medium| medium.room(point) < r) else {
        return plain;
    };
    match boundary.treatment {
        Treatment::None => {}
        Treatment::Clipped => plain.sum = plain.sum / body_part(kernel, medium, point, r),
        Treatment::Reflection => {
            let images = images(medium, point, r);
            // The uniform kernel's weight is the part of each photon that counts: images of the k-th count no more than
            // the k-th does, not even on a face, where they are as far away.
            let whole = Kernel::Uniform.peak();
            for_each_photon(map, point, Kernel::Uniform, gather, |photon, share| {
                let weight: f64 =
                    images.iter().map(|image| image_weight(kernel, (photon.position - image) / r)).sum();
                let weight = share / whole * weight / (r * r * r) * value(&photon);
                plain.sum += Spectrum(photon.power.as_dvec3()) * weight;
            });
        }
        Treatment::LocalLinear => {
            let normal = inward_normal(medium, point);
            let mut first = Spectrum::ZERO;
            for_each_photon(map, point, kernel, gather, |photon, weight| {
                let z = (photon.position - point).dot(normal) / r;
                first += Spectrum(photon.power.as_dvec3()) * (weight * z / (r * r * r) * value(&photon));
            });
            plain.sum = linear(body_moments(kernel, medium, point, r), plain.sum, first);
        }
    }
    plain
}

/// The same over accepted photons, and how many were rejected.
fn sifted_sum(
    (run, point): (u64, DVec3),
    kernel: Kernel,
    boundary: &Boundary<'_>,
    about: &Surroundings<'_>,
    gathered: Accepted,
    value: &dyn Fn(&Photon) -> f64,
) -> (BallSum, usize) {
    let Accepted { photons, ball, rejected } = gathered;
    let (medium, r) = (boundary.medium.as_ref(), ball.radius);
    let sum = |weight: &dyn Fn(DVec3) -> f64| {
        photons.iter().fold(Spectrum::ZERO, |sum, (photon, share)| {
            let weight = share * weight(photon.position) / (r * r * r) * value(photon);
            sum + Spectrum(photon.power.as_dvec3()) * weight
        })
    };
    // All gathered photons are in the ball, whatever rounding says of the last.
    let weight = |place: DVec3| {
        let u2 = (place - point).length_squared() / (r * r);
        kernel.peak() * kernel.profile(u2.min(1.0))
    };
    let nowhere = if point.is_finite() { 0.0 } else { f64::NAN };
    let plain = sum(&weight) + Spectrum::grey(nowhere);
    let is_clear = about.is_clear(r);
    let sum = match (boundary.treatment, medium) {
        (Treatment::None, _) => plain,
        _ if !is_clear => plain / about.share(kernel, r, run),
        _ if boundary.room(point) >= r => plain,
        (Treatment::Clipped, Some(medium)) => plain / body_part(kernel, medium, point, r),
        (_, None) => plain,
        (Treatment::Reflection, Some(medium)) => images(medium, point, r)
            .into_iter()
            .fold(plain, |all, image| all + sum(&|place| image_weight(kernel, (place - image) / r))),
        (Treatment::LocalLinear, Some(medium)) => {
            let normal = inward_normal(medium, point);
            let first = sum(&|place| weight(place) * (place - point).dot(normal) / r);
            linear(body_moments(kernel, medium, point, r), plain, first)
        }
    };
    (BallSum { sum, ball }, rejected)
}

/// The kernel of radius 1 at a vector, 0 beyond its ball.
fn image_weight(kernel: Kernel, away: DVec3) -> f64 {
    let u2 = away.length_squared();
    if u2 <= 1.0 { kernel.peak() * kernel.profile(u2) } else { 0.0 }
}

/// The constant of the straight line fitted to a field with moments S_0 and S_1; that of a constant, in a body too thin for a
/// line.
fn linear([m0, m1, m2]: [f64; 3], s0: Spectrum, s1: Spectrum) -> Spectrum {
    let determinant = m0 * m2 - m1 * m1;
    if determinant > 0.0 { (s0 * m2 - s1 * m1) / determinant } else { s0 / m0.max(LEAST_PART) }
}
