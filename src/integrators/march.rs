//! Marching a ray through a photon map in steps.

use crate::Spectrum;
use crate::estimators::{Gather, Kernel, in_scattered};
use crate::faults::{Fault, planted};
use crate::math::{Interval, Positive, Ray, exp, exp_m1};
use crate::medium::Homogeneous;
use crate::photons::PhotonMap;

/// How much of a source one step of a march brings to the near end of the ray; step i runs from `t` to `t + dx`.
///
/// # Source
/// Jensen and Christensen 1998, eq. 13 and 14.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepRule {
    /// The formula of 1998: the source at the near end of the step, times dx e^(-sigma_t t). What lies in the step is
    /// not attenuated within it, so that a constant source reads high by x/(1-e^-x), x = sigma_t dx.
    NearEnd,
    /// The source in the middle of the step, times dx e^(-sigma_t (t + dx/2)): a constant source reads low by
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

/// Radiance at the near end of a stretch of a ray [W/(L^2 sr)], from sources along it, in a homogeneous medium.
///
/// int_0^s q(t) e^(-sigma_t t) dt as a sum over the fewest equal steps that are no longer than `step`.
///
/// # Arguments
/// `sigma_t` [1/L]; `span` of finite length; `source` q [W/(L^3 sr)] at a distance along the ray, emission and
/// in-scattering together
pub fn march(
    sigma_t: Spectrum,
    span: Interval,
    step: Positive,
    rule: StepRule,
    mut source: impl FnMut(f64) -> Spectrum,
) -> Spectrum {
    // A length that is a whole number of steps but for rounding is no step longer.
    let count = (span.length() / step.get() * (1.0 - 4.0 * f64::EPSILON)).ceil();
    let dx = span.length() / count;
    let mut sum = Spectrum::ZERO;
    let mut i = 0.0;
    while i < count {
        let t = i * dx;
        sum += source(span.start + rule.place(t, dx)) * sigma_t.map(|s| rule.weight(s, t, dx));
        i += 1.0;
    }
    sum
}

/// Radiance that a photon map scatters towards the near end of a stretch of a ray [W/(L^2 sr)].
///
/// # Arguments
/// `ray` looks away from the receiver, so that light travels against it; `span` of finite length in `medium`
///
/// # Limits
/// What is in the map is scattered, no more: light that comes straight from behind the stretch is not in it.
pub fn march_map(
    map: &PhotonMap,
    medium: &Homogeneous,
    ray: &Ray,
    span: Interval,
    (step, rule): (Positive, StepRule),
    (kernel, gather): (Kernel, Gather),
) -> Spectrum {
    march(medium.sigma_t(), span, step, rule, |t| {
        // sigma_s/sigma_t is the albedo: channels that nothing scatters divide nothing by zero.
        let collided = in_scattered(map, ray.at(t), -ray.dir, medium.phase(), Spectrum::ONE, kernel, gather);
        medium.albedo() * collided.value
    })
}
