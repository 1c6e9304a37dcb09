//! The march of a ray through media: single scattering by shadow rays, the rest from the volume map.

use super::{Eye, Mapper, March, Report};
use crate::Spectrum;
use crate::estimators::boundary::{Treatment, treated_in_scattered};
use crate::estimators::in_scattered;
use crate::integrators::StepRule;
use crate::math::{Interval, Ray, cosine_pair, exp, exp_m1, ln_1p};
use crate::medium::Medium;
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::{Target, decay};
use crate::transport::{Walker, connection, passed, transmittance};
use glam::DVec3;

/// A ray is followed until less than this is left of what comes from farther away: far below what a picture's single
/// precision tells apart.
const LEFT: f64 = 1e-9;

/// Where media have no end, steps grow: behind so many sizes of the scene by this part of the distance, so that a ray has some
/// hundreds. Media with an end are shorter.
const FAR: f64 = 4.0;
const GROWTH: f64 = 1.0 / 16.0;

/// Radiance that collisions scatter into a direction, over the collisions: times sigma_t it is the source of the
/// transfer equation.
#[derive(Clone, Copy)]
pub(super) struct Scattered {
    /// Of light that comes straight from the lights.
    pub single: Spectrum,
    /// Of all other light, per collision coefficient: the volume map counts collisions, so that this is to be divided by
    /// sigma_t.
    pub multiple: Spectrum,
}

impl Mapper<'_> {
    /// What a medium scatters at a point against the direction of a walker, over sigma_t [W/(L^2 sr)].
    pub(super) fn scattered(
        &self,
        walker: &Walker,
        position: DVec3,
        number: usize,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Scattered {
        let (scene, settings) = (self.scene, self.settings);
        let medium = scene.medium(number);
        let (phase, dir) = (medium.phase(), walker.ray.dir);
        let here = Walker { ray: Ray::new(position, dir), from: None, ..*walker };
        let value = |towards: DVec3| {
            let (one_minus_mu, one_plus_mu) = cosine_pair(dir, towards);
            phase.eval(one_minus_mu, one_plus_mu)
        };
        let blind = |stream: &mut Stream| phase.scatter(dir, stream.pair());
        let single = self.direct(&here, None, report, stream, value, blind);
        let mut multiple = Spectrum::ZERO;
        if let Some(map) = &self.maps.volume {
            let (kernel, gather) = settings.volume;
            let is_plain = settings.treatment == Treatment::None && !settings.needs_walls();
            let estimate = match is_plain {
                true => in_scattered(map, position, -dir, phase, Spectrum::ONE, kernel, gather),
                false => {
                    let boundary = self.extents[number].boundary(settings.treatment);
                    let boundary = match settings.needs_walls() {
                        true => boundary.about(&[]).with_walls(settings.rejection, &self.walls),
                        false => boundary,
                    };
                    treated_in_scattered(map, position, -dir, phase, kernel, gather, &boundary).estimate
                }
            };
            report.volume.add(&estimate);
            let sigma_t = medium.sigma_t(position);
            multiple = estimate.value.over(sigma_t);
        }
        let albedo = medium.albedo(position);
        Scattered { single: albedo * single, multiple: albedo * multiple }
    }
}

impl Mapper<'_> {
    /// The light that a medium scatters once at a point against the direction of a walker, over sigma_t
    /// [W/(L^2 sr)], each light aimed at in its middle: what steps are chosen by. Lights that cannot be aimed at count
    /// nothing.
    fn probed(
        &self,
        walker: &Walker,
        position: DVec3,
        number: usize,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let (scene, dir) = (self.scene, walker.ray.dir);
        let medium = scene.medium(number);
        let sum = scene.lights().iter().enumerate().fold(Spectrum::ZERO, |sum, (index, light)| {
            let Some(sample) = light.sample(position, [0.5; 2]) else { return sum };
            let ray = Ray::new(position, sample.dir);
            report.rays.shadow += 1;
            let start = (&ray, None, walker.within);
            let towards = Some(Target::Light(index));
            let Some(passed) = connection(scene, start, sample.distance, towards, stream) else {
                return sum;
            };
            let (one_minus_mu, one_plus_mu) = cosine_pair(dir, sample.dir);
            sum + sample.value * passed * medium.phase().eval(one_minus_mu, one_plus_mu)
        });
        medium.albedo(position) * sum
    }
}

impl Eye<'_, '_> {
    /// Adds what media bring to the ray up to distance `end`.
    pub(super) fn march(&mut self, walker: &Walker, end: f64, stream: &mut Stream) {
        let scene = self.mapper.scene;
        for segment in scene.segments(&walker.ray, end, walker.within).iter() {
            let seen = walker.weight
                * transmittance(scene, &walker.ray, segment.interval.start, walker.within, stream);
            // Of media that vary it is an estimate of its own for each segment: what one of them says ends no other.
            if seen.max() < LEFT * walker.weight.max() {
                continue;
            }
            self.march_segment(walker, seen, segment.interval, segment.medium, stream);
        }
    }

    /// Marches through a stretch of one medium; `seen` is the weight at its near end.
    fn march_segment(
        &mut self,
        walker: &Walker,
        mut seen: Spectrum,
        span: Interval,
        number: usize,
        stream: &mut Stream,
    ) {
        let mapper = self.mapper;
        let march = &mapper.settings.march;
        let medium = mapper.scene.medium(number);
        let is_full = mapper.scene.plan().is_full;
        if !medium.is_colliding() && (!is_full || span.end == f64::INFINITY) {
            return;
        }
        // Channels that meet nothing pass for ever, and bring nothing.
        let counts = match medium.is_colliding() {
            true => medium.matter().sigma_t().map(|s| if s > 0.0 { 1.0 } else { 0.0 }),
            false => Spectrum::ONE,
        };
        let (longest, least) = (march.step.get(), LEFT * seen.max());
        let mut t = span.start;
        let mut length = if march.is_jittered { longest * (1.0 - stream.unit()) } else { longest };
        // What the near end scatters of direct light, and the multiple scattering found last.
        let mut near: Option<Spectrum> = None;
        let mut multiple = 0.0;
        while t < span.end && (seen * counts).max() > least {
            let grown = GROWTH * (t - span.start - FAR * mapper.size).max(0.0);
            // What rounding leaves of the last step joins it.
            let (rest, reach) = (span.end - t, length + grown);
            let mut dx = if rest < reach * (1.0 + 1e-9) { rest } else { reach };
            if let Some(adaptive) = &march.adaptive {
                // Off the ends of the stretch, where walls may stand: shadow rays would meet them by rounding.
                let off = 1e-3 * adaptive.shortest.get();
                let mut probe = |t: f64, report: &mut Report| {
                    let t = t.min(span.end - off).max(span.start + off);
                    mapper.probed(walker, walker.ray.at(t), number, report, stream)
                };
                let first = near.unwrap_or_else(|| probe(t, &mut self.report));
                let (change, last) = loop {
                    let last = probe(t + dx, &mut self.report);
                    let change = relative_change(first, last, multiple);
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
            let step = match medium {
                Medium::Homogeneous(medium) => {
                    Placed::in_step(march.rule, march.is_jittered, medium.sigma_t(), dx, stream)
                }
                Medium::Heterogeneous(_) => {
                    Placed::in_varying_step(march, medium, (&walker.ray, t), dx, stream)
                }
            };
            self.report.steps += 1;
            let position = walker.ray.at(t + step.place);
            let sigma_t = medium.sigma_t(position);
            let scattered = if sigma_t.is_black() && !is_full {
                Scattered { single: Spectrum::ZERO, multiple: Spectrum::ZERO }
            } else {
                mapper.scattered(walker, position, number, &mut self.report, stream)
            };
            multiple = scattered.multiple.max();
            let weight = seen * sigma_t * step.weight;
            self.layers.single += weight * scattered.single;
            self.layers.multiple += weight * scattered.multiple;
            seen *= match medium {
                Medium::Homogeneous(_) => decay(sigma_t * dx),
                Medium::Heterogeneous(_) => {
                    let behind = Interval { start: t + step.place, end: t + dx };
                    step.reached * passed(medium, &walker.ray, behind, stream)
                }
            };
            t += dx;
            if dx == rest {
                return;
            }
        }
    }
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
    fn in_step(rule: StepRule, is_jittered: bool, sigma_t: Spectrum, dx: f64, stream: &mut Stream) -> Self {
        if rule == StepRule::Integrated && is_jittered {
            // Density s e^(-s x)/(1 - e^(-s dx)) with s the mean over channels; one channel's weight is e^(-s_c x) over it.
            let s = sigma_t.mean();
            let collides = -exp_m1(-s * dx);
            let place = (-ln_1p(-stream.unit() * collides) / s).min(dx);
            let weight = match sigma_t.is_grey() {
                true => Spectrum::grey(collides / s),
                false => sigma_t.map(|c| exp((s - c) * place)) * (collides / s),
            };
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
        let reached = passed(medium, ray, Interval { start: t, end: t + place }, stream);
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
