//! Light scattered exactly once in a slab: radiance with any phase function, fluence and the two fluxes with isotropic
//! scattering.
//!
//! Every form here is a sum of non-negative terms, so its relative error is a count of roundings.

mod azimuth;

use crate::beer_lambert::direct_fluence;
use crate::error::{Error, Result, within};
use crate::exponential_integral::{e_n, e1, eim_scaled, ein};
use crate::incidence::{Incidence, check_albedo, check_depth, check_mu, check_mu0, check_tau};
use crate::quadrature::integrate_from_singular;
use crate::value::Value;
pub use azimuth::henyey_greenstein_mean;
use libm::{cos, exp, expm1, log1p, sin};
use std::f64::consts::PI;

/// Exponents are quotients of a depth and a cosine: their rounding enters the exponential multiplied by themselves,
/// and beyond 750 the exponential is zero.
const EXPONENT_ULPS: f64 = 750.0;

/// Radiance of light scattered once, a beam incident on a slab, Henyey-Greenstein phase function.
///
/// With p the phase function \[1/sr\], m = |mu|:
/// up, I = albedo p / (mu + mu0) \[e^(-t/mu0) - e^(-tau/mu0 - (tau-t)/mu)\];
/// down, I = albedo p / (mu0 - m) \[e^(-t/mu0) - e^(-t/m)\].
/// # Arguments
/// `tau` thickness, `t` depth \[mean free paths\]; `albedo` 0 to 1; `g` in (-1, 1); `mu0` cosine of
/// incidence; `mu` signed cosine, positive towards the lit face; `dphi` azimuth of the direction of
/// travel minus that of the beam \[rad\]
/// # Returns
/// \[1/sr\] per unit irradiance on the face
/// # Errors
/// `Error::OutOfRange` naming the parameter
/// # Limits
/// mu -> 0: albedo p e^(-t/mu0)/mu0, the source function over the extinction
/// # Source
/// Chandrasekhar 1960, chapter III
pub fn single_radiance(tau: f64, albedo: f64, g: f64, mu0: f64, t: f64, mu: f64, dphi: f64) -> Result<Value> {
    within("g", g, -1.0 + f64::EPSILON, 1.0 - f64::EPSILON, "above -1, below 1")?;
    // The deviation of the cosine is a sum of squares, its rounding magnified at most by the power 3/2.
    let phase = |d: Deflection| Value::rounded(henyey_greenstein(g, d), 32.0, "closed form");
    single_radiance_of(tau, albedo, phase, mu0, t, mu, dphi)
}

/// Radiance of light scattered once, a beam incident on a slab, any phase function.
///
/// # Arguments
/// `phase` its value at a deflection, with its bound \[1/sr\]; the others as in [`single_radiance`], `tau` and `t` up to
/// 1e300 mean free paths: the half-space
/// # Returns
/// \[1/sr\] per unit irradiance on the face; the bound of `phase` and the roundings
/// # Errors
/// `Error::OutOfRange` naming the parameter; `Error::NotFinite` naming `phase`
/// # Limits
/// mu -> 0: albedo p e^(-t/mu0)/mu0, the source function over the extinction
/// # Source
/// Chandrasekhar 1960, chapter III
pub fn single_radiance_of(
    tau: f64,
    albedo: f64,
    phase: impl FnOnce(Deflection) -> Value,
    mu0: f64,
    t: f64,
    mu: f64,
    dphi: f64,
) -> Result<Value> {
    within("tau", tau, 1e-300, 1e300, "1e-300 to 1e300")?;
    check_albedo(albedo)?;
    check_mu0(mu0)?;
    check_depth(t, tau)?;
    check_mu(mu)?;
    within("dphi", dphi, -1e3, 1e3, "-1000 to 1000 rad")?;
    let deflection = Deflection::new(mu0, mu, dphi);
    let p = phase(deflection);
    if !(p.value.is_finite() && p.error.is_finite()) {
        return Err(Error::NotFinite { name: "phase", value: p.value, at: deflection.cosine() });
    }
    let path = beam_path(tau, mu0, t, mu);
    let phase = albedo * p.value.abs();
    let mut answer = Value::rounded(albedo * p.value * path, 32.0 + exponent_ulps(t, mu0), p.method);
    // Subnormal steps of the exponential, magnified by at most the inverse of the cosine's own rounding.
    answer.error += albedo * p.error * path + phase * f64::MIN_POSITIVE / mu0;
    Ok(answer)
}

fn exponent_ulps(t: f64, mu0: f64) -> f64 {
    (2.0 * t / mu0).min(2.0 * EXPONENT_ULPS)
}

/// How far a scattering turns the light, accurate at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection {
    /// 1 - cosine of the angle \[1\], 0 to 2.
    pub one_minus: f64,
    /// 1 + cosine of the angle \[1\], 0 to 2.
    pub one_plus: f64,
}

impl Deflection {
    /// From a beam of cosine `mu0` (travelling with cosine -mu0) to signed cosine `mu` at azimuth `dphi`.
    ///
    /// Half the squared chord between the directions (s0, 0, -mu0) and +-(s cos dphi, s sin dphi, mu), s the sines, as a
    /// sum of squares.
    pub(crate) fn new(mu0: f64, mu: f64, dphi: f64) -> Self {
        let sine = |c: f64| ((1.0 - c) * (1.0 + c)).sqrt();
        let (s0, s) = (sine(mu0), sine(mu));
        let lateral = if s0 + s > 0.0 { (mu - mu0) * (mu + mu0) / (s0 + s) } else { 0.0 };
        let half_chord = |turn: f64, normal: f64| {
            (0.5 * (lateral * lateral + 4.0 * s0 * s * turn * turn + normal * normal)).min(2.0)
        };
        Deflection {
            one_minus: half_chord(sin(0.5 * dphi), mu + mu0),
            one_plus: half_chord(cos(0.5 * dphi), mu - mu0),
        }
    }

    /// Cosine of the angle \[1\], -1 to 1.
    pub fn cosine(self) -> f64 {
        if self.one_minus < self.one_plus { 1.0 - self.one_minus } else { self.one_plus - 1.0 }
    }
}

/// Henyey-Greenstein phase function \[1/sr\].
fn henyey_greenstein(g: f64, deflection: Deflection) -> f64 {
    // Whichever of 1 - cos (g > 0) and 1 + cos is small at the peak.
    let chord = if g >= 0.0 { deflection.one_minus } else { deflection.one_plus };
    let a = 1.0 - g.abs();
    let d = a * a + 2.0 * g.abs() * chord;
    a * (1.0 + g.abs()) / (4.0 * PI * d * d.sqrt())
}

/// int e^(-t'/mu0)/mu0 e^(-|t-t'|/m) dt'/m along the ray that arrives at depth t with signed cosine mu.
pub(crate) fn beam_path(tau: f64, mu0: f64, t: f64, mu: f64) -> f64 {
    path(t, tau - t, mu0, mu)
}

/// The same at depth `above`, the far face `below` it.
pub(crate) fn path(above: f64, below: f64, mu0: f64, mu: f64) -> f64 {
    if mu >= 0.0 && below > 0.0 {
        let exponent = if mu == 0.0 { f64::INFINITY } else { below * (1.0 / mu0 + 1.0 / mu) };
        exp(-above / mu0) * -expm1(-exponent) / (mu + mu0)
    } else if mu > 0.0 || above == 0.0 {
        0.0
    } else {
        let m = -mu;
        if m == mu0 {
            let exponent = above / mu0;
            // Beyond it the exponential is zero, and the quotient may be infinite.
            return if exponent < 800.0 { exponent * exp(-exponent) / mu0 } else { 0.0 };
        }
        let exponent = if m == 0.0 { f64::INFINITY } else { above * ((mu0 - m).abs() / (mu0 * m)) };
        exp(-above / mu0.max(m)) * -expm1(-exponent) / (mu0 - m).abs()
    }
}

/// Fluence of light scattered once, a beam incident, isotropic scattering.
///
/// phi_1 = (albedo/2) int_0^tau E_1(|t-t'|) e^(-t'/mu0)/mu0 dt', in exponential integrals.
/// # Arguments
/// `tau` thickness, `t` depth \[mean free paths\]; `albedo` 0 to 1; `mu0` cosine of incidence
/// # Returns
/// \[1\] per unit irradiance on the face
/// # Errors
/// `Error::OutOfRange` naming the parameter
/// # Limits
/// t -> 0, half-space: (albedo/2) ln(1 + 1/mu0)
pub fn single_fluence(tau: f64, albedo: f64, mu0: f64, t: f64) -> Result<Value> {
    check_tau(tau)?;
    check_albedo(albedo)?;
    check_mu0(mu0)?;
    check_depth(t, tau)?;
    let value = 0.5 * albedo * beam_through_e1(mu0, t, tau - t);
    Ok(Value::rounded(value, 32.0 + exponent_ulps(t, mu0), "closed form"))
}

/// int_0^tau E_1(|t-t'|) e^(-t'/mu0)/mu0 dt' where `above` = t and `below` = tau - t.
pub(crate) fn beam_through_e1(mu0: f64, above: f64, below: f64) -> f64 {
    let b = 1.0 / mu0;
    let from_above = if above > 0.0 {
        let u = above / mu0;
        // b int_0^t e^(-b (t-s)) E_1(s) ds; the last term is e^(-t) e^(-(b-1)t) Eim((b-1)t).
        -expm1(-u) * e1(above) + exp(-u) * ein(above) + exp(-above) * eim_scaled((1.0 - mu0) * u)
    } else {
        0.0
    };
    let from_below = if below > 0.0 {
        let u = below / mu0;
        // b int_0^s e^(-b s) E_1(s) ds.
        let integral = if below > 1.0 {
            log1p(b) - exp(-u) * e1(below) + e1(below + u)
        } else {
            -expm1(-u) * e1(below) + ein(below + u) - ein(below)
        };
        exp(-above / mu0) * integral
    } else {
        0.0
    };
    from_above + from_below
}

/// Fraction of the incident power that leaves the lit face after one isotropic scattering.
///
/// R_1 = (albedo/2) int_0^tau phi_0(t) E_2(t) dt; a half-space: (albedo/2) \[1 - mu0 ln(1 + 1/mu0)\].
/// # Arguments
/// `tau` thickness \[mean free paths\]; `albedo` 0 to 1; `incidence` of unit irradiance
/// # Returns
/// \[1\]; two Gauss rules on panels that halve towards the face, both of positive terms
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn single_reflectance(tau: f64, albedo: f64, incidence: Incidence) -> Result<Value> {
    check_tau(tau)?;
    check_albedo(albedo)?;
    incidence.check()?;
    let length = reach(tau, incidence);
    let integral = integrate_from_singular(
        length,
        |t| direct_fluence(incidence, t) * e_n(2, t),
        "graded Gauss, two rules",
    );
    Ok(with_exponent(integral.scaled(0.5 * albedo)))
}

/// Fraction of the incident power that leaves the far face after one isotropic scattering.
///
/// T_1 = (albedo/2) int_0^tau phi_0(t) E_2(tau-t) dt.
/// # Arguments
/// `tau` thickness \[mean free paths\]; `albedo` 0 to 1; `incidence` of unit irradiance
/// # Returns
/// \[1\]; two Gauss rules on panels that halve towards both faces, both of positive terms
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn single_transmittance(tau: f64, albedo: f64, incidence: Incidence) -> Result<Value> {
    check_tau(tau)?;
    check_albedo(albedo)?;
    incidence.check()?;
    const METHOD: &str = "graded Gauss, two rules";
    let sum = match incidence {
        Incidence::Diffuse => {
            let half = 0.5 * tau;
            // Symmetric about the middle.
            integrate_from_singular(half, |t| 2.0 * e_n(2, t) * e_n(2, tau - t), METHOD).scaled(2.0)
        }
        Incidence::Beam { mu0 } => {
            // Up to the middle from the lit face, where the beam has its layer; from the far face, where E_2 is
            // singular.
            let near = integrate_from_singular(
                reach(0.5 * tau, incidence),
                |t| direct_fluence(incidence, t) * e_n(2, tau - t),
                METHOD,
            );
            let far = integrate_from_singular(0.5 * tau, |s| exp(-(tau - s) / mu0) / mu0 * e_n(2, s), METHOD);
            Value::new(near.value + far.value, near.error + far.error, METHOD)
        }
    };
    Ok(with_exponent(sum.scaled(0.5 * albedo)))
}

/// The depth beyond which the uncollided light is zero in f64.
fn reach(tau: f64, incidence: Incidence) -> f64 {
    match incidence {
        Incidence::Beam { mu0 } => tau.min(EXPONENT_ULPS * mu0),
        Incidence::Diffuse => tau,
    }
}

/// Adds the rounding of exponents: relative, at most the largest exponent that leaves anything.
fn with_exponent(value: Value) -> Value {
    Value { error: value.error + EXPONENT_ULPS * f64::EPSILON * value.value, ..value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::GaussLegendre;
    use libm::log;

    /// Direct double evaluation of the source integral by brute force.
    fn brute_radiance(tau: f64, mu0: f64, t: f64, mu: f64) -> f64 {
        let rule = GaussLegendre::rule(200);
        let m = mu.abs();
        let (a, b) = if mu > 0.0 { (t, tau) } else { (0.0, t) };
        rule.integrate(a, b, |s| exp(-s / mu0) / mu0 * exp(-(t - s).abs() / m) / m)
    }

    #[test]
    fn radiance_is_the_source_integral() {
        for (tau, mu0, t, mu) in [
            (1.0, 0.5, 0.3, 0.7),
            (1.0, 0.5, 0.3, -0.5),
            (2.0, 1.0, 2.0, -0.999_999),
            (2.0, 0.3, 0.0, 0.2),
            (0.1, 0.9, 0.05, -0.1),
        ] {
            let got = beam_path(tau, mu0, t, mu);
            let want = brute_radiance(tau, mu0, t, mu);
            assert!((got - want).abs() < 1e-13 * want, "{tau} {mu0} {t} {mu}: {got} {want}");
        }
    }

    #[test]
    fn phase_function_integrates_to_one_and_has_mean_cosine_g() {
        let (mu_rule, turns) = (GaussLegendre::rule(64), 64);
        for g in [-0.7, 0.0, 0.3, 0.75] {
            for mu0 in [0.2, 1.0] {
                let (mut one, mut mean) = (0.0, 0.0);
                for (x, w) in mu_rule.nodes.iter().zip(&mu_rule.weights) {
                    let mu = 2.0 * x - 1.0;
                    for i in 0..turns {
                        let dphi = 2.0 * PI * f64::from(i) / f64::from(turns);
                        let p = henyey_greenstein(g, Deflection::new(mu0, mu, dphi)) * w * 4.0 * PI
                            / f64::from(turns);
                        let sines = ((1.0 - mu0 * mu0) * (1.0 - mu * mu)).sqrt();
                        one += p;
                        mean += p * (-mu0 * mu + sines * libm::cos(dphi));
                    }
                }
                // 64 nodes leave 0.75^64 = 1e-8 of a series in g^l.
                assert!((one - 1.0).abs() < 1e-7 && (mean - g).abs() < 1e-7, "{g} {mu0} {one} {mean}");
            }
        }
    }

    #[test]
    fn forward_peak_keeps_its_digits() {
        // Straight on: (1-g^2)/(4 pi (1-g)^3) = (1+g)/(4 pi (1-g)^2).
        let g = 1.0 - 1e-9;
        let peak = (1.0 + g) / (4.0 * PI * (1.0 - g) * (1.0 - g));
        assert!((henyey_greenstein(g, Deflection::new(0.6, -0.6, 0.0)) / peak - 1.0).abs() < 1e-14);
        assert!((henyey_greenstein(-g, Deflection::new(1.0, 1.0, 0.3)) / peak - 1.0).abs() < 1e-14);
        // Backwards, dphi = pi: the half angle's cosine is 6e-17, its square nothing beside (1-g)^2.
        assert!((henyey_greenstein(-g, Deflection::new(0.6, 0.6, PI)) / peak - 1.0).abs() < 1e-12);
    }

    #[test]
    fn any_phase_function_and_any_thickness() {
        // Rayleigh at its right angle, 3/(16 pi), against the isotropic 1/(4 pi).
        let rayleigh = |d: Deflection| {
            Value::rounded(3.0 / (16.0 * PI) * (1.0 + d.cosine() * d.cosine()), 8.0, "closed form")
        };
        let got = single_radiance_of(2.0, 0.9, rayleigh, 1.0, 0.5, 0.0, 0.0).unwrap();
        let isotropic = single_radiance(2.0, 0.9, 0.0, 1.0, 0.5, 0.0, 0.0).unwrap();
        assert!((got.value / isotropic.value - 0.75).abs() < 1e-15);
        // The half-space, from above: p albedo/(mu + mu0).
        let got = single_radiance_of(1e300, 1.0, rayleigh, 0.5, 0.0, 1.0, 0.0).unwrap();
        assert!((got.value - 3.0 * 1.25 / (16.0 * PI) / 1.5).abs() <= got.error);
        for (t, mu) in [(1e300, -1e-300), (1e299, -1e-300), (1e300, 5e-324), (1e-10, -5e-324)] {
            let got = single_radiance_of(1e300, 1.0, rayleigh, 1e-300, t, mu, 0.0).unwrap();
            assert!(got.value.is_finite() && got.error.is_finite(), "{got:?}");
        }
        let bad = single_radiance_of(1.0, 1.0, |_| Value::new(f64::NAN, 0.0, ""), 1.0, 0.0, 1.0, 0.0);
        assert!(bad.unwrap_err().to_string().starts_with("phase returned NaN"));
    }

    #[test]
    fn fluence_is_the_integral_of_e1() {
        for (tau, mu0) in [(1.0, 1.0), (1.0, 0.1), (0.01, 0.5), (5.0, 0.7), (30.0, 1.0), (1.0, 1e-4)] {
            for fraction in [0.0, 1e-6, 0.3, 0.9, 1.0] {
                let t = fraction * tau;
                let got = single_fluence(tau, 0.8, mu0, t).unwrap();
                let side = |length: f64, sign: f64| {
                    if length == 0.0 {
                        return 0.0;
                    }
                    // Halving towards the target for E_1; 2^13 uniform pieces would do for the beam's layer, but
                    // z <= t keeps e^(-(t-z)/mu0) smooth on panels of at most mu0.
                    let mut sum = 0.0;
                    let mut high = length;
                    let rule = GaussLegendre::rule(32);
                    for _ in 0..60 {
                        let low = 0.5 * high;
                        let pieces = ((high - low) / mu0).ceil().max(1.0);
                        let step = (high - low) / pieces;
                        let mut i = 0.0;
                        while i < pieces {
                            sum += rule.integrate(low + i * step, low + (i + 1.0) * step, |z| {
                                e1(z) * exp(-(t + sign * z) / mu0) / mu0
                            });
                            i += 1.0;
                        }
                        high = low;
                    }
                    sum
                };
                let want = 0.4 * (side(t, -1.0) + side(tau - t, 1.0));
                assert!(
                    // The brute sum of up to 1e5 panels carries its own roundings.
                    (got.value - want).abs() <= got.error + 2e-13 * want,
                    "{tau} {mu0} {t}: {} {want}",
                    got.value
                );
            }
        }
    }

    /// (b G(tau, b), rounding bound) for b > 0, closed.
    fn closed_up(tau: f64, b: f64) -> (f64, f64) {
        let m = (log1p(b) - exp(-b * tau) * e1(tau) + e1((1.0 + b) * tau)) / b;
        (1.0 - exp(-b * tau) * e_n(2, tau) - m, 16.0 * f64::EPSILON * (1.0 + m + log1p(b) / b))
    }

    #[test]
    fn fluxes_agree_with_the_closed_form() {
        for tau in [0.1, 1.0, 4.0, 30.0] {
            for mu0 in [0.1, 0.5, 1.0] {
                let b = 1.0 / mu0;
                let got = single_reflectance(tau, 0.9, Incidence::Beam { mu0 }).unwrap();
                let (closed, rounding) = closed_up(tau, b);
                let want = 0.45 * closed;
                assert!((got.value - want).abs() <= got.error + rounding, "R1 {tau} {mu0}: {got:?} {want}");
                // T_1 = (albedo/2 mu0) e^(-tau/mu0) G(tau, -1/mu0), with Ei for the negative argument.
                let got = single_transmittance(tau, 0.9, Incidence::Beam { mu0 }).unwrap();
                let scaled_m = if mu0 == 1.0 {
                    // e^(-tau) M(-1) = E_1 + e^(-tau) (gamma + ln tau).
                    e1(tau) + exp(-tau) * (crate::exponential_integral::EULER_GAMMA + log(tau))
                } else {
                    // e^(-b tau) (e^(b tau) E_1 - ln|1-b| + Ei((b-1) tau)) / b
                    let y = (b - 1.0) * tau;
                    let ei = eim_scaled(y) + exp(-y) * (crate::exponential_integral::EULER_GAMMA + log(y));
                    (e1(tau) - exp(-b * tau) * log(b - 1.0) + exp(-tau) * ei) / b
                };
                let closed = -exp(-b * tau) + e_n(2, tau) + scaled_m;
                let want = 0.45 * closed;
                let size = exp(-b * tau) * (1.0 + log(b).abs()) + e_n(2, tau) + scaled_m.abs();
                let rounding = 64.0 * f64::EPSILON * size;
                assert!((got.value - want).abs() <= got.error + rounding, "T1 {tau} {mu0}: {got:?} {want}");
            }
        }
    }

    #[test]
    fn half_space_and_thin_limits() {
        let mu0 = 0.4;
        let r = single_reflectance(60.0, 1.0, Incidence::Beam { mu0 }).unwrap();
        assert!((r.value - 0.5 * (1.0 - mu0 * log(1.0 + 1.0 / mu0))).abs() < r.error + 1e-15);
        // tau -> 0: R_1 = T_1 = albedo tau/(2 mu0), to order tau ln tau.
        let tau = 1e-12;
        for flux in [single_reflectance, single_transmittance] {
            let got = flux(tau, 0.5, Incidence::Beam { mu0 }).unwrap();
            assert!((got.value / (0.25 * tau / mu0) - 1.0).abs() < 1e-10, "{got:?}");
        }
    }
}
