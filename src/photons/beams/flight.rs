//! The beams of a flight: one a stretch of medium, and of a periodic cell.

use super::beam::{Beam, BeamKind, sampled};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::Interval;
use crate::medium::Medium;
use crate::photons::periodic;
use crate::scene::{Scene, decay};
use crate::transport::Walker;
use glam::DVec2;

/// Periodic cells that one flight may cross, at most: each has a beam of its own.
pub(in crate::photons) const MOST_CELLS: usize = 100_000;

/// An optical depth whose exponential is 0.
const OPAQUE: f64 = 746.0;

/// Checks that flights through a scene's media can be stored as beams.
///
/// # Errors
/// `Error::Scene` where a medium varies and its extinction differs by channel: what a flight carries at a place of it depends on
/// what it met
pub fn check_beams(scene: &Scene) -> Result<()> {
    match scene.media().iter().all(|medium| medium.is_homogeneous() || medium.has_grey_extinction()) {
        true => Ok(()),
        false => Err(Error::Scene(
            "beams cannot be stored in a medium that varies and whose extinction differs by channel; allowed: points along rays \
             (a ray radius), or points in balls"
                .into(),
        )),
    }
}

/// Checks that they can be stored as far as they could go.
///
/// # Errors
/// `Error::Scene` where a medium varies: what passes through it is not known in closed form
pub fn check_whole_beams(scene: &Scene) -> Result<()> {
    match scene.media().iter().all(Medium::is_homogeneous) {
        true => Ok(()),
        false => Err(Error::Scene(
            "beams that go on to the end of a medium cannot be stored in one that varies; allowed: as far as the sampled flight".into(),
        )),
    }
}

/// A flight that was flown.
pub(in crate::photons) struct FlightBeams<'a> {
    /// Where.
    pub scene: &'a Scene,
    /// The photon as it sets out.
    pub walker: &'a Walker,
    /// How far it flew \[L\]; may be infinite.
    pub end: f64,
    /// Whether it is stored to the end of each medium, with what passes, as where its first collision was forced.
    pub is_forced: bool,
    /// The factor on powers.
    pub parts: f64,
    /// Sides of the periodic cells that beams are cut at, if they are \[L\].
    pub period: Option<DVec2>,
}

impl FlightBeams<'_> {
    /// Offers its beams, in order; false where it crosses more than [`MOST_CELLS`] cells, or has no end.
    pub fn each(&self, mut store: impl FnMut(Beam)) -> bool {
        let FlightBeams { scene, walker, end, is_forced, parts, period } = *self;
        let kind = if is_forced { BeamKind::Expected } else { BeamKind::Sampled };
        let mut power = walker.weight * parts;
        let mut cells = 0;
        for segment in scene.segments(&walker.ray, end, walker.interior).iter() {
            let medium = scene.medium(segment.medium);
            let span = seen(medium, segment.interval);
            if is_scattering(medium) && power.sum() > 0.0 {
                if span.end == f64::INFINITY {
                    return false;
                }
                let mut one = |ray: &crate::math::Ray, part: Interval| {
                    let here = behind(power, kind, medium, part.start - span.start);
                    if part.length() > 0.0 {
                        store(Beam {
                            start: ray.at(part.start),
                            dir: ray.dir,
                            length: part.length(),
                            power: here.0.as_vec3(),
                            medium: segment.medium as u32,
                            order: u16::try_from(walker.order).unwrap_or(u16::MAX),
                            flags: walker.flags,
                            kind,
                        });
                    }
                };
                match period {
                    None => one(&walker.ray, span),
                    Some(side) => {
                        for (ray, part) in periodic::in_cells(&walker.ray, span, side) {
                            cells += 1;
                            if cells > MOST_CELLS {
                                return false;
                            }
                            one(&ray, part);
                        }
                    }
                }
            }
            power = behind(power, kind, medium, segment.interval.length());
        }
        true
    }
}

/// Whether light is scattered in a medium.
fn is_scattering(medium: &Medium) -> bool {
    medium.is_colliding()
        && match medium {
            Medium::Homogeneous(even) => !(even.sigma_t() * even.albedo()).is_black(),
            Medium::Heterogeneous(varying) => {
                varying.has_varying_albedo() || !varying.matter().albedo().is_black()
            }
        }
}

/// A stretch as far as anything passes in a channel that scatters.
fn seen(medium: &Medium, span: Interval) -> Interval {
    let Medium::Homogeneous(even) = medium else { return span };
    let rates = even.sigma_t().0.to_array().into_iter().filter(|rate| *rate > 0.0);
    let reach = rates.map(|rate| OPAQUE / rate).fold(0.0, f64::max);
    Interval { end: span.end.min(span.start + reach), ..span }
}

/// What a flight carries behind a length of a medium.
fn behind(power: Spectrum, kind: BeamKind, medium: &Medium, length: f64) -> Spectrum {
    match (kind, medium) {
        (BeamKind::Sampled, Medium::Homogeneous(even)) => sampled(power, even.sigma_t(), length),
        (BeamKind::Sampled, Medium::Heterogeneous(_)) => power,
        (BeamKind::Expected, _) => power * decay(medium.matter().depth(length)),
    }
}
