//! The beams of a flight: one a stretch of medium, and of a periodic cell.

use super::beam::{Beam, BeamKind, sampled};
use crate::Spectrum;
use crate::math::{Interval, Ray};
use crate::medium::{Heterogeneous, Medium};
use crate::photons::periodic;
use crate::rng::Stream;
use crate::scene::{Scene, decay};
use crate::transport::{Walker, flight_by_stretch, steps};
use glam::DVec2;

/// Periodic cells that one flight may cross, at most: each has a beam of its own.
pub(in crate::photons) const MOST_CELLS: usize = 100_000;

/// An optical depth whose exponential is 0.
const OPAQUE: f64 = 746.0;

/// A flight that was flown.
pub(in crate::photons) struct FlightBeams<'a> {
    /// Where.
    pub scene: &'a Scene,
    /// The photon as it sets out.
    pub walker: &'a Walker,
    /// How far it flew \[L\]; may be infinite.
    pub end: f64,
    /// How far the next surface is ahead \[L\]; may be infinite.
    pub ahead: f64,
    /// Whether it is stored to the end of each medium, with what passes, as where its first collision was forced.
    pub is_forced: bool,
    /// The factor on powers.
    pub parts: f64,
    /// Sides of the periodic cells that beams are cut at, if they are \[L\].
    pub period: Option<DVec2>,
}

impl FlightBeams<'_> {
    /// Offers its beams, in order; false where it crosses more than [`MOST_CELLS`] cells, or has no end.
    ///
    /// What a flight carries through a medium that varies, where extinction differs by channel, depends on what it met, which nobody
    /// kept: the beams are those of the same photon flown once more. What would go on to the end of a medium that varies is tracked:
    /// a step function, unbiased at every place.
    pub fn each(&self, tracking: &mut Stream, store: impl FnMut(Beam)) -> bool {
        let FlightBeams { scene, walker, parts, .. } = *self;
        let mut stretches = Stretches { flight: self, store, cells: 0, is_short: true };
        let mut power = walker.weight * parts;
        let forgets = |medium: &Medium| !medium.is_homogeneous() && !medium.has_grey_extinction();
        if !self.is_forced && scene.media().iter().any(forgets) {
            let passed = &mut |medium, span, power| stretches.add((medium, BeamKind::Sampled), span, power);
            flight_by_stretch(scene, &walker.ray, self.ahead, walker.interior, power, tracking, passed);
            return stretches.is_short;
        }
        for segment in scene.segments(&walker.ray, self.end, walker.interior).iter() {
            let (number, span) = (segment.medium, segment.interval);
            let medium = scene.medium(number);
            power = match medium {
                Medium::Heterogeneous(varying) if self.is_forced => {
                    stretches.track((number, varying), span, power, tracking)
                }
                _ => {
                    let kind = if self.is_forced { BeamKind::Expected } else { BeamKind::Sampled };
                    stretches.add((number, kind), span, power);
                    behind(power, kind, medium, span.length())
                }
            };
        }
        stretches.is_short
    }
}

/// The beams of a flight, one after the other.
struct Stretches<'a, S> {
    flight: &'a FlightBeams<'a>,
    store: S,
    cells: usize,
    /// No more than [`MOST_CELLS`] cells so far, and no stretch without an end.
    is_short: bool,
}

impl<S: FnMut(Beam)> Stretches<'_, S> {
    /// Offers a stretch of a medium that begins with a power.
    fn add(&mut self, (number, kind): (usize, BeamKind), span: Interval, power: Spectrum) {
        let FlightBeams { scene, walker, period, .. } = *self.flight;
        let medium = scene.medium(number);
        let counts = is_scattering(medium) && power.sum() > 0.0;
        if !self.is_short || !counts {
            return;
        }
        let span = seen(medium, span);
        if span.end == f64::INFINITY {
            self.is_short = false;
            return;
        }
        let mut one = |ray: &Ray, part: Interval| {
            if part.length() > 0.0 {
                (self.store)(Beam {
                    start: ray.at(part.start),
                    dir: ray.dir,
                    length: part.length(),
                    power: behind(power, kind, medium, part.start - span.start).0.as_vec3(),
                    medium: number as u32,
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
                    self.cells += 1;
                    self.is_short &= self.cells <= MOST_CELLS;
                    if !self.is_short {
                        return;
                    }
                    one(&ray, part);
                }
            }
        }
    }

    /// Offers what passes each part of a stretch of a medium that varies; what passes all of it.
    fn track(
        &mut self,
        (number, medium): (usize, &Heterogeneous),
        span: Interval,
        power: Spectrum,
        tracking: &mut Stream,
    ) -> Spectrum {
        let (mut start, mut passed) = (span.start, Spectrum::ONE);
        for (at, then) in steps(medium, &self.flight.walker.ray, span, None, tracking) {
            self.add((number, BeamKind::Sampled), Interval { start, end: at }, power * passed);
            (start, passed) = (at, then);
        }
        self.add((number, BeamKind::Sampled), Interval { start, ..span }, power * passed);
        power * passed
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
