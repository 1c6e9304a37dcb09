//! Tracking through a density that has bounds by cell: delta tracking, ratio tracking, and collected emission.
//!
//! Tentative collisions have the rate of the upper bound; one is real with the density's share of it. Nothing is
//! asked of the density where the bounds alone decide.

use crate::Spectrum;
use crate::faults::{Fault, planted, size};
use crate::math::{Interval, Ray, ln_1p};
use crate::medium::{Bound, Heterogeneous};
use crate::rng::Stream;

/// How a stretch ends.
pub(super) enum End {
    /// With a collision at a distance along the ray \[L\], with this weight.
    Collision(f64, Spectrum),
    /// At the far end, with this weight.
    Uncollided(Spectrum),
}

/// What a stretch lets pass below which a game decides whether anything does. Tracking multiplies factors, and would go on
/// until they underflow; a factor of 0.6 never does, since the smallest number times 0.6 is itself. Survivors count as much
/// as this: their variance, below its square, is out of sight of a mean of fewer than 1e24 samples of size 1.
const FAINT: f64 = 1e-12;

/// An optical depth whose exponential is 0: that of 745.2 is the last one above.
const OPAQUE: f64 = 746.0;

/// Russian roulette on what a stretch lets pass: the factor that what is faint counts with, in the mean 1; 0 if the game is
/// lost.
fn outlives(transmitted: f64, stream: &mut Stream) -> f64 {
    let chance = transmitted / FAINT;
    if chance >= 1.0 {
        1.0
    } else if chance > 0.0 && stream.unit() < chance {
        1.0 / chance
    } else {
        0.0
    }
}

/// Depth to the next event of a process of rate 1.
fn exponential(stream: &mut Stream) -> f64 {
    -ln_1p(-stream.unit()) * if planted(Fault::TrackStretched) { 1.0 + size() } else { 1.0 }
}

/// Tentative collisions on a part of a ray, in the order in which it meets them: a process of the rate [1/L] that `rate`
/// gives each stretch of bounds. Ends with what `meet` makes of one of them, or with none; an infinite rate ends it at once.
#[inline(always)]
fn tentative<T>(
    (medium, ray, part): (&Heterogeneous, &Ray, Interval),
    stream: &mut Stream,
    mut rate: impl FnMut(&Bound) -> f64,
    mut meet: impl FnMut(f64, &Bound, &mut Stream) -> Option<T>,
) -> Option<T> {
    let mut target = exponential(stream);
    for bound in medium.density().along(ray, part) {
        stream.work.majorants += 1;
        let rate = rate(&bound);
        if rate == 0.0 {
            continue;
        }
        if rate == f64::INFINITY {
            return None;
        }
        let mut at = bound.interval.start;
        loop {
            let t = at + target / rate;
            if t >= bound.interval.end {
                target = (target - rate * (bound.interval.end - at)).max(0.0);
                break;
            }
            at = t;
            let end = meet(t, &bound, stream);
            if end.is_some() {
                return end;
            }
            target = exponential(stream);
        }
    }
    None
}

/// Delta tracking, with weights that know the history where extinction differs by channel.
///
/// With weights w_c, and q_c the share of the majorant that channel c has at a tentative collision, it is real with
/// p = sum w_c q_c / sum w_c; then w_c becomes w_c q_c/p, else w_c (1-q_c)/(1-p). Each channel is unbiased, and the
/// summed weight stays as it is. With equal channels the weights do not change, and need not be kept `by_channel`.
/// `passed` is told every part of the flight, and the weights on it.
///
/// # Source
/// Woodcock et al. 1965; Miller, Georgiev and Jarosz 2019
pub(super) fn delta(
    medium: &Heterogeneous,
    ray: &Ray,
    part: Interval,
    weight: Spectrum,
    by_channel: bool,
    stream: &mut Stream,
    passed: &mut impl FnMut(Interval, Spectrum),
) -> End {
    let sigma_t = medium.matter().sigma_t();
    let scale = sigma_t.max();
    if scale == 0.0 {
        passed(part, weight);
        return End::Uncollided(weight);
    }
    let ratio = sigma_t / scale;
    let (mut weight, mut start) = (weight, part.start);
    let collision = tentative(
        (medium, ray, part),
        stream,
        |bound| bound.high * scale,
        |t, bound, stream| {
            let share = if by_channel { (weight * ratio).sum() / weight.sum() } else { 1.0 };
            let u = stream.unit() * bound.high;
            let is_real = u < bound.low * share;
            let density = if is_real { bound.low } else { density_at(medium, ray, t, bound.high, stream) };
            if is_real || u < density * share {
                passed(Interval { start, end: t }, weight);
                return Some(End::Collision(t, if by_channel { weight * ratio / share } else { weight }));
            }
            if by_channel && !planted(Fault::NullWeightForgotten) {
                passed(Interval { start, end: t }, weight);
                start = t;
                let q = density / bound.high;
                weight *= ratio.map(|r| (1.0 - r * q) / (1.0 - share * q));
            }
            None
        },
    );
    collision.unwrap_or_else(|| {
        passed(Interval { start, ..part }, weight);
        End::Uncollided(weight)
    })
}

/// The density at a distance: never above its bound, which rounding at a face between cells could break.
fn density_at(medium: &Heterogeneous, ray: &Ray, t: f64, high: f64, stream: &mut Stream) -> f64 {
    stream.work.densities += 1;
    medium.density().at(ray.at(t)).min(high)
}

/// Ratio tracking: an unbiased estimate of the transmittance of a stretch.
///
/// The lower bound passes in closed form; what is above it meets tentative collisions of the rate of the difference
/// of the bounds, and each lets 1 minus its share pass. The rate is that of the densest channel that still lets anything
/// pass.
///
/// # Source
/// Novak, Selle and Jarosz 2014
pub(super) fn ratio(medium: &Heterogeneous, ray: &Ray, part: Interval, stream: &mut Stream) -> Spectrum {
    let matter = medium.matter();
    let mut alive = matter.sigma_t();
    let (mut transmitted, mut left) = (Spectrum::ONE, part);
    let (mut control, mut before) = (0.0, 0.0);
    let thinnest = matter.sigma_t().min();
    loop {
        let scale = alive.max();
        let Some(densest) = (0..3).find(|c| alive[*c] == scale && scale > 0.0) else { return transmitted };
        let shares = alive / scale;
        let lost = tentative(
            (medium, ray, left),
            stream,
            |bound| {
                before = control;
                if bound.low > 0.0 {
                    control += bound.low * bound.interval.length();
                }
                // Nothing passes that has a number: what lies behind is not asked for.
                if control * thinnest > OPAQUE { f64::INFINITY } else { (bound.high - bound.low) * scale }
            },
            |t, bound, stream| {
                let density = density_at(medium, ray, t, bound.high, stream).max(bound.low);
                let q = (density - bound.low) / (bound.high - bound.low);
                transmitted *= shares.map(|s| 1.0 - s * q);
                let factor = outlives(transmitted[densest], stream);
                transmitted *= shares.map(|s| if s == 1.0 { factor } else { 1.0 });
                (factor == 0.0).then_some((t, bound.low * (t - bound.interval.start)))
            },
        );
        let Some((t, within)) = lost else {
            return transmitted * crate::scene::decay(matter.depth(control));
        };
        alive = alive.map(|sigma_t| if sigma_t == scale { 0.0 } else { sigma_t });
        (left.start, control) = (t, before + within);
    }
}

/// What passes from the near end of a stretch to each place of it: a step function, unbiased at every place. Its steps are where
/// they begin \[L\], and what passes from there on.
///
/// With `controls` it is that of what is above the lower bounds, which they are told of.
pub(crate) fn steps(
    medium: &Heterogeneous,
    ray: &Ray,
    part: Interval,
    mut controls: Option<&mut Controls>,
    stream: &mut Stream,
) -> Vec<(f64, Spectrum)> {
    let sigma_t = medium.matter().sigma_t();
    let scale = sigma_t.max();
    if scale == 0.0 {
        return Vec::new();
    }
    let shares = sigma_t / scale;
    let has_controls = controls.is_some();
    let low = |bound: &Bound| if has_controls { bound.low } else { 0.0 };
    let (mut steps, mut passed) = (Vec::new(), Spectrum::ONE);
    let rate = |bound: &Bound| {
        if let Some(controls) = &mut controls {
            controls.push(bound);
        }
        (bound.high - low(bound)) * scale
    };
    tentative((medium, ray, part), stream, rate, |t, bound, stream| {
        let density = density_at(medium, ray, t, bound.high, stream).max(low(bound));
        let q = (density - low(bound)) / (bound.high - low(bound));
        passed *= shares.map(|s| 1.0 - s * q);
        passed *= outlives(passed.max(), stream);
        steps.push((t, passed));
        passed.is_black().then_some(())
    });
    steps
}

/// Lower bounds of a density along a stretch, in order.
#[derive(Debug, Default)]
pub(crate) struct Controls(Vec<(Interval, f64, f64)>);

impl Controls {
    fn push(&mut self, bound: &Bound) {
        if bound.low > 0.0 {
            self.0.push((bound.interval, self.to(bound.interval.start), bound.low));
        }
    }

    /// Their integral to a distance \[L\].
    pub fn to(&self, t: f64) -> f64 {
        let behind = self.0.partition_point(|(interval, ..)| interval.start < t);
        behind.checked_sub(1).map_or(0.0, |last| {
            let (interval, before, low) = self.0[last];
            before + low * (t.min(interval.end) - interval.start)
        })
    }
}

/// What a stretch emits towards the near end of the ray [W/(L^2 sr)], and its transmittance: both unbiased.
///
/// `uniform` [W/(L^3 sr)] is emitted beside what the medium emits itself, which counts if `own`. At a tentative collision
/// of rate m, emission over m is collected, and 1 minus extinction over m passes; m is at least one a stretch, so that
/// what emits but does not collide is met.
pub(super) fn emitted(
    medium: &Heterogeneous,
    ray: &Ray,
    part: Interval,
    own: bool,
    uniform: Spectrum,
    stream: &mut Stream,
) -> (Spectrum, Spectrum) {
    let sigma_t = medium.matter().sigma_t();
    // A stretch shorter than 5.6e-309 has no finite rate, and sends nothing that counts.
    let least = 1.0 / part.length();
    let least = if least.is_finite() { least } else { 0.0 };
    let rate = |bound: &Bound| (bound.high * sigma_t.max()).max(least);
    let (mut transmitted, mut sum) = (Spectrum::ONE, Spectrum::ZERO);
    tentative((medium, ray, part), stream, rate, |t, bound, stream| {
        let rate = rate(bound);
        let density = density_at(medium, ray, t, bound.high, stream);
        let emission = if own { medium.emission_of(density) } else { Spectrum::ZERO };
        sum += transmitted * (emission + uniform) / rate;
        transmitted *= sigma_t.map(|s| 1.0 - s * density / rate);
        transmitted *= outlives(transmitted.max(), stream);
        transmitted.is_black().then_some(())
    });
    (sum, transmitted)
}
