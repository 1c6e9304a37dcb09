//! Half-spaces of isotropic scattering: constants by H, faster light by the continuum of the resolvent.

use super::entrance::{Entrance, METHOD};
use crate::error::Result;
use crate::half_space::HalfSpace;
use crate::half_space::resolvent::convolved;
use crate::incidence::Incidence;
use crate::value::Value;
use libm::exp;

/// n = C sqrt(1-w)/(w k), C the strength of the slowest decay in the resolvent.
pub(super) fn diffuse(space: &HalfSpace) -> Value {
    let decay = space.slowest();
    let strength = space.resolvent().mode.0;
    let roundings = 96.0 + 16.0 * decay.b;
    Value::rounded(strength * decay.ratio / space.albedo(), roundings, METHOD)
}

/// As `Asymptotics::entrance`.
pub(super) fn entrance(space: &HalfSpace, incidence: Incidence, tau: f64) -> Result<(Entrance, f64, f64)> {
    let decay = space.slowest();
    let resolvent = space.resolvent();
    let (strength, k) = resolvent.mode;
    let half = 0.5 * space.albedo();
    let roundings = (96.0 + 16.0 * decay.b) * f64::EPSILON;
    let (escape, faster) = match incidence {
        // The fluence is H(mu0)/mu0 times the convolution of the resolvent and e^(-t/mu0).
        Incidence::Beam { mu0 } => {
            let h = space.h(mu0)?;
            let value = 0.25 * strength * h.value / decay.one_minus(mu0);
            let b = 1.0 / mu0;
            let own = exp(-b * tau) * (1.0 + strength / (b - k));
            let rest: f64 = resolvent.continuum.iter().map(|&(x, s)| half * s * convolved(x, b, tau)).sum();
            (Value::new(value, value * (h.error / h.value + roundings), METHOD), h.value * b * (own + rest))
        }
        Incidence::Diffuse => {
            let rest: f64 = resolvent.continuum.iter().map(|&(x, s)| s / x * exp(-x * tau)).sum();
            (diffuse(space), 2.0 * (1.0 - space.albedo()).sqrt() * rest)
        }
    };
    // Milne's fluence is proportional to e^(kt) (1 + C/2k + (w/2) sum s/(x+k)) less e^(-kt) C/2k less the faster.
    let (mut echo, mut growing) = (0.0, 2.0 * k + strength);
    for &(x, s) in &resolvent.continuum {
        echo += half * s * exp(-x * tau) / (x + k);
        growing += 2.0 * k * half * s / (x + k);
    }
    let entrance = Entrance {
        escape,
        reflected: space.reflectance(incidence)?,
        absorbed: space.absorptance(incidence)?,
    };
    Ok((entrance, faster, echo / growing))
}
