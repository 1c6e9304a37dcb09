//! Light that has not met the medium yet: each direction keeps e^(-t/mu) of its radiance.
//!
//! With unit irradiance on the face the fluence is e^(-t/mu0)/mu0 (beam) or 2 E_2(t) (diffuse, radiance 1/pi), and
//! e^(-t/mu0) or 2 E_3(t) of the power crosses a thickness t.
//!
//! Limits: t = 0, fluence 1/mu0 or 2, and all of the power.
//!
//! Source: Bouguer 1729; Chandrasekhar 1960, appendix I, for E_n.

use crate::error::{Result, within};
use crate::exponential_integral::e_n;
use crate::incidence::Incidence;
use crate::value::Value;
use libm::exp;

const METHOD: &str = "closed form";

/// Fluence of the uncollided light at depth t, per unit irradiance on the face.
///
/// phi_0 = e^(-t/mu0)/mu0 (beam), 2 E_2(t) (diffuse).
/// # Arguments
/// `t` depth in mean free paths, 0 or more
/// # Returns
/// \[1\], good to rounding (of t/mu0 too: a relative error of t/mu0 roundings)
/// # Errors
/// `Error::OutOfRange` naming `mu0` or `t`
pub fn uncollided_fluence(incidence: Incidence, t: f64) -> Result<Value> {
    incidence.check()?;
    within("t", t, 0.0, f64::MAX, "0 or more")?;
    let mut value = Value::rounded(direct_fluence(incidence, t), ulps(incidence, t), METHOD);
    if let Incidence::Beam { mu0 } = incidence {
        // The smallest steps of a subnormal exponential, magnified by 1/mu0.
        value.error += 1e-323 / mu0;
    }
    Ok(value)
}

/// Fraction of the incident power that crosses an optical thickness t without a collision.
///
/// e^(-t/mu0) (beam), 2 E_3(t) (diffuse).
/// # Arguments
/// `t` optical thickness \[1\], 0 or more
/// # Returns
/// \[1\]
/// # Errors
/// `Error::OutOfRange` naming `mu0` or `t`
pub fn direct_transmittance(incidence: Incidence, t: f64) -> Result<Value> {
    incidence.check()?;
    within("t", t, 0.0, f64::MAX, "0 or more")?;
    let value = match incidence {
        Incidence::Beam { mu0 } => exp(-t / mu0),
        Incidence::Diffuse => 2.0 * e_n(3, t),
    };
    Ok(Value::rounded(value, ulps(incidence, t), METHOD))
}

/// Roundings: of the functions, and of the quotient t/mu0 in the exponent.
fn ulps(incidence: Incidence, t: f64) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => 4.0 + (t / mu0).min(800.0),
        Incidence::Diffuse => 20.0,
    }
}

pub(crate) fn direct_fluence(incidence: Incidence, t: f64) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => exp(-t / mu0) / mu0,
        Incidence::Diffuse => 2.0 * e_n(2, t),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fluence_on_the_face_and_the_flux_law() {
        let beam = Incidence::Beam { mu0: 0.25 };
        assert!(uncollided_fluence(beam, 0.0).unwrap().covers(4.0));
        assert!(uncollided_fluence(Incidence::Diffuse, 0.0).unwrap().covers(2.0));
        // The loss of flux is the fluence: -dT/dt = phi_0, by a central difference of error h^2 phi'' / 6.
        for incidence in [beam, Incidence::Diffuse] {
            let (t, h) = (0.7, 1e-4);
            let t_of = |t| direct_transmittance(incidence, t).unwrap().value;
            let slope = (t_of(t - h) - t_of(t + h)) / (2.0 * h);
            assert!((slope - uncollided_fluence(incidence, t).unwrap().value).abs() < 64.0 * h * h);
        }
    }

    #[test]
    fn extremes_are_answered_or_refused() {
        let grazing = Incidence::Beam { mu0: 1e-300 };
        assert_eq!(uncollided_fluence(grazing, 1.0).unwrap().value, 0.0);
        assert!(uncollided_fluence(Incidence::Beam { mu0: 0.0 }, 1.0).is_err());
        assert!(direct_transmittance(Incidence::Diffuse, f64::NAN).is_err());
        assert!(direct_transmittance(Incidence::Diffuse, f64::INFINITY).is_err());
    }
}
