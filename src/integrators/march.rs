//! Marching a ray through a medium in steps.

use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::{Interval, Positive, Ray, exp, exp_m1, ln_1p};
use crate::medium::Medium;
use crate::rng::Stream;
use crate::scene::decay;
use crate::transport::segment_transmittance;
use glam::DVec3;

/// How much of a source one step of a march brings to the near end of the ray; step i runs from `t` to `t + dx`.
///
/// # Source
/// Jensen and Christensen 1998, eq. 13 and 14.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepRule {
    /// The formula of 1998: the source at the near end of the step, times dx e^(-sigma_t t). What lies in the step is
    /// not attenuated within it, so that a constant source comes out high by x/(1-e^-x), x = sigma_t dx.
    NearEnd,
    /// The source in the middle of the step, times dx e^(-sigma_t (t + dx/2)): a constant source comes out low by
    /// (x/2)/sinh(x/2), which is 1 - x^2/24 to second order.
    Middle,
    /// The source in the middle of the step, held constant over it and integrated: times
    /// e^(-sigma_t t) (1 - e^-x)/sigma_t. Exact for a constant source, whatever the step.
    Integrated,
}

impl StepRule {
    /// Every rule.
    pub const ALL: [StepRule; 3] = [StepRule::NearEnd, StepRule::Middle, StepRule::Integrated];

    /// Where in the step from `t` to `t + dx` the source is asked for \[L\].
    pub fn place(self, t: f64, dx: f64) -> f64 {
        match self {
            StepRule::NearEnd => t,
            StepRule::Middle | StepRule::Integrated => t + 0.5 * dx,
        }
    }

    /// What the source there is multiplied by \[L\], `t` from the near end of the ray.
    pub fn weight(self, sigma_t: f64, t: f64, dx: f64) -> f64 {
        let dx = if planted(Fault::StepForgotten) { 1.0 } else { dx };
        let x = sigma_t * dx;
        match self {
            StepRule::NearEnd => dx * exp(-sigma_t * t),
            StepRule::Middle => dx * exp(-sigma_t * (t + 0.5 * dx)),
            StepRule::Integrated if x == 0.0 => dx,
            StepRule::Integrated => dx * exp(-sigma_t * t) * (-exp_m1(-x) / x),
        }
    }
}

/// How steps of a march become shorter where radiance changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Relative change of the source from one end of a step to the other above which the step is halved.
    pub tolerance: f64,
    /// Steps are halved as long as they are longer than this \[L\].
    pub shortest: Positive,
}

/// How a ray is marched through media.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March {
    /// Longest step \[L\].
    pub step: Positive,
    /// How much of a step's source reaches its near end.
    pub rule: StepRule,
    /// Whether places are random: the first step is then cut at random, and with [`StepRule::Integrated`] the source is
    /// asked for at a random place of each step, in proportion to what reaches its near end, so that the sum is
    /// unbiased whatever the step. If not, and where no steps are shorter, they are the fewest of one length.
    pub is_jittered: bool,
    /// Shorter steps where radiance changes; none for equal ones. Steps are chosen by shadow rays of their own from their
    /// ends towards the lights' middles, never by the random places and directions that the sum is made of: a sum
    /// that is unbiased with equal steps stays so.
    pub adaptive: Option<Adaptive>,
}

impl March {
    /// Equal steps, and the source where the rule asks for it.
    pub fn equal(step: Positive, rule: StepRule) -> Self {
        March { step, rule, is_jittered: false, adaptive: None }
    }
}

/// A ray is followed until less than this is left of what comes from farther away: far below what a picture's single
/// precision tells apart.
pub(super) const LEFT: f64 = 1e-9;

/// Where media have no end, steps grow: behind so many sizes of the scene by this part of the distance, so that a ray has some
/// hundreds. Media with an end are shorter.
const FAR: f64 = 4.0;
const GROWTH: f64 = 1.0 / 16.0;

/// What a march asks along a ray.
pub(super) trait Source {
    /// Takes in what the medium sends against the ray from a place of a step: `seen` is the part that comes from the step's near
    /// end to the eye, `weight` what a source at the place counts for at that end \[L\]. Returns how bright the light is that
    /// [`Source::probed`] does not know.
    fn take(&mut self, place: DVec3, seen: Spectrum, weight: Spectrum, stream: &mut Stream) -> f64;

    /// The light at a place that adaptive steps are chosen by.
    fn probed(&mut self, _place: DVec3, _stream: &mut Stream) -> Spectrum {
        Spectrum::ZERO
    }
}

/// Radiance at the near end of a stretch of a ray [W/(L^2 sr)], from sources along it.
///
/// int q(t) T(t) dt as a sum over steps.
///
/// # Arguments
/// `ray` looks away from the receiver, so that light travels against it; `span` in the `medium`; `size` of the scene, which
/// tells what is far \[L\]; `source` q at a place [W/(L^3 sr)], emission and in-scattering together
///
/// # Limits
/// the march ends where less than 1e-9 passes
pub fn along(
    medium: &Medium,
    (ray, span): (&Ray, Interval),
    march: &March,
    size: f64,
    stream: &mut Stream,
    source: impl FnMut(DVec3) -> Spectrum,
) -> Spectrum {
    struct Sum<S>(Spectrum, S);
    impl<S: FnMut(DVec3) -> Spectrum> Source for Sum<S> {
        fn take(&mut self, place: DVec3, seen: Spectrum, weight: Spectrum, _stream: &mut Stream) -> f64 {
            self.0 += seen * weight * self.1(place);
            0.0
        }
    }
    let mut sum = Sum(Spectrum::ZERO, source);
    self::march(medium, (ray, span), (march, size), Spectrum::ONE, stream, &mut sum);
    sum.0
}

/// Marches through a stretch of one medium; `seen` is the weight at its near end.
pub(super) fn march(
    medium: &Medium,
    (ray, span): (&Ray, Interval),
    (march, size): (&March, f64),
    mut seen: Spectrum,
    stream: &mut Stream,
    source: &mut impl Source,
) {
    // Channels that meet nothing pass for ever, and bring nothing.
    let counts = match medium.is_colliding() {
        true => medium.matter().sigma_t().map(|s| if s > 0.0 { 1.0 } else { 0.0 }),
        false => Spectrum::ONE,
    };
    let longest = match march.is_jittered || march.adaptive.is_some() || span.length() == f64::INFINITY {
        true => march.step.get(),
        // A length that is a whole number of steps but for rounding is no step longer.
        false => span.length() / (span.length() / march.step.get() * (1.0 - 4.0 * f64::EPSILON)).ceil(),
    };
    let least = LEFT * seen.max();
    let mut t = span.start;
    let mut length = if march.is_jittered { longest * (1.0 - stream.unit()) } else { longest };
    // What was probed at the near end, and the other light found last.
    let mut near: Option<Spectrum> = None;
    let mut other = 0.0;
    while t < span.end && (seen * counts).max() > least {
        let grown = GROWTH * (t - span.start - FAR * size).max(0.0);
        // What rounding leaves of the last step joins it.
        let (rest, reach) = (span.end - t, length + grown);
        let mut dx = if rest < reach * (1.0 + 1e-9) { rest } else { reach };
        if let Some(adaptive) = &march.adaptive {
            // Off the ends of the stretch, where walls may stand: shadow rays would meet them by rounding.
            let off = 1e-3 * adaptive.shortest.get();
            let mut probe =
                |t: f64| source.probed(ray.at(t.min(span.end - off).max(span.start + off)), stream);
            let first = near.unwrap_or_else(|| probe(t));
            let (change, last) = loop {
                let last = probe(t + dx);
                let change = relative_change(first, last, other);
                let shortest = adaptive.shortest.get() + grown;
                if change <= adaptive.tolerance || dx <= shortest {
                    break (change, last);
                }
                dx = (0.5 * dx).max(shortest);
            };
            near = Some(last);
            length =
                if change < 0.5 * adaptive.tolerance { (2.0 * dx).min(longest) } else { dx.min(longest) };
        } else {
            length = longest;
        }
        // Far from the ray's origin a step may be less than numbers tell apart.
        if t + dx == t {
            dx = rest;
        }
        let step = match medium {
            Medium::Homogeneous(medium) => {
                let how = (march.rule, march.is_jittered);
                Placed::in_step(how, medium.sigma_t(), seen * counts, dx, stream)
            }
            Medium::Heterogeneous(_) => Placed::in_varying_step(march, medium, (ray, t), dx, stream),
        };
        let place = ray.at(t + step.place);
        other = source.take(place, seen, step.weight, stream);
        seen *= match medium {
            Medium::Homogeneous(medium) => decay(medium.sigma_t() * dx),
            Medium::Heterogeneous(_) => {
                let behind = Interval { start: t + step.place, end: t + dx };
                step.reached * segment_transmittance(medium, ray, behind, stream)
            }
        };
        t += dx;
        if dx == rest {
            return;
        }
    }
}

/// Optical depth of a step below which light reaches its near end from everywhere, within what a double tells apart.
const CLEAR: f64 = 1e-16;

/// The integral of e^(-s x) over a step \[L\].
fn reaching(s: f64, dx: f64) -> f64 {
    if s * dx < CLEAR { dx } else { -exp_m1(-s * dx) / s }
}

/// A place of a step, of density e^(-s x) over that integral \[L\].
fn place_reaching(s: f64, dx: f64, unit: f64) -> f64 {
    if s * dx < CLEAR { unit * dx } else { (-ln_1p(unit * exp_m1(-s * dx)) / s).min(dx) }
}

/// The largest difference of channels over the largest channel, `floor` added to both.
fn relative_change(a: Spectrum, b: Spectrum, floor: f64) -> f64 {
    let largest = a.max().max(b.max()) + floor;
    if largest > 0.0 { (a - b).map(f64::abs).max() / largest } else { 0.0 }
}

/// Where the source of a step is asked for, from its near end, and what it counts there \[L\].
struct Placed {
    place: f64,
    weight: Spectrum,
    /// The part of the light that passes from there to the near end, where the medium varies; not asked for elsewhere.
    reached: Spectrum,
}

impl Placed {
    /// In a medium of constant extinction; `counts` is how much the light of each channel matters, more than 0 for one of them.
    fn in_step(
        (rule, is_jittered): (StepRule, bool),
        sigma_t: Spectrum,
        counts: Spectrum,
        dx: f64,
        stream: &mut Stream,
    ) -> Self {
        if rule == StepRule::Integrated && is_jittered {
            let unit = stream.unit();
            if sigma_t.is_grey() {
                let s = sigma_t.mean();
                let (place, weight) = (place_reaching(s, dx, unit), Spectrum::grey(reaching(s, dx)));
                return Placed { place, weight, reached: Spectrum::ONE };
            }
            // By the extinction of one channel, chosen by what matters. Over the mean of the channels' densities no channel has
            // a weight beyond reach over chance, whatever the others are.
            let chances = counts / (counts[0] + counts[1] + counts[2]);
            let (mut channel, mut below) = (0, 0.0);
            while channel < 2 && unit >= below + chances[channel] {
                below += chances[channel];
                channel += 1;
            }
            // Rounding may leave a number for a channel that has no chance.
            if chances[channel] == 0.0 {
                channel = if chances[0] > 0.0 { 0 } else { 1 };
            }
            let rest = ((unit - below) / chances[channel]).clamp(0.0, 1.0 - f64::EPSILON);
            let place = place_reaching(sigma_t[channel], dx, rest);
            let transmitted = sigma_t.map(|s| exp(-s * place));
            let densities = transmitted / sigma_t.map(|s| reaching(s, dx));
            let weight = transmitted / (chances * densities).0.element_sum();
            return Placed { place, weight, reached: Spectrum::ONE };
        }
        let weight = sigma_t.map(|c| rule.weight(c, 0.0, dx));
        Placed { place: rule.place(0.0, dx), weight, reached: Spectrum::ONE }
    }

    /// The same where the medium varies along the ray, the step beginning at `t`. Random places are uniform, and count what passes
    /// from there, which is unbiased as the homogeneous rule is; [`StepRule::Integrated`] without jitter holds the extinction
    /// of the middle over the step, as it does the source.
    fn in_varying_step(
        march: &March,
        medium: &Medium,
        (ray, t): (&Ray, f64),
        dx: f64,
        stream: &mut Stream,
    ) -> Self {
        let is_random = march.is_jittered && march.rule == StepRule::Integrated;
        let place = if is_random { stream.unit() * dx } else { march.rule.place(0.0, dx) };
        let reached = segment_transmittance(medium, ray, Interval { start: t, end: t + place }, stream);
        let weight = match march.rule {
            StepRule::NearEnd => Spectrum::grey(dx),
            StepRule::Integrated if !is_random => {
                medium.sigma_t(ray.at(t + place)).map(|s| march.rule.weight(s, 0.0, dx))
            }
            StepRule::Middle | StepRule::Integrated => reached * dx,
        };
        Placed { place, weight, reached }
    }
}
