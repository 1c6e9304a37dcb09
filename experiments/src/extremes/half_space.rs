//! Slabs too thick for a solution in depth: half-spaces, and thick slabs without absorption, isotropic scattering.

use std::f64::consts::{FRAC_PI_2, PI};
use turbid_analytic::quadrature::GaussLegendre;

/// Extrapolation length of the conservative half-space in mean free paths (Hopf 1934; Placzek and Seidel 1947).
const MILNE: f64 = 0.710_446_089_598_763;
/// Panels that halve towards 0, where the integrand has the logarithm of (1 - albedo) + x^2/3.
const PANELS: i32 = 40;

/// The H function of isotropic scattering, with a bound on its error.
///
/// ln H(mu) = -(mu/pi) int_0^(pi/2) ln(1 - albedo x cot x) / (cos^2 x + mu^2 sin^2 x) dx
/// (Chandrasekhar 1960, ch. V; Stibbs and Weir 1959).
pub fn h_function(mu: f64, albedo: f64) -> anyhow::Result<(f64, f64)> {
    let integrand = |x: f64| {
        // 1 - x cot x without cancellation: the next term of the series is x^6/4725 of the first, 1e-13 here.
        let bend = if x < 0.03 {
            let y = x * x;
            y / 3.0 * (1.0 + y / 15.0 + 2.0 * y * y / 315.0)
        } else {
            1.0 - x / libm::tan(x)
        };
        let (sin, cos) = libm::sincos(x);
        libm::log((1.0 - albedo) + albedo * bend) / (cos * cos + mu * mu * sin * sin)
    };
    let integral = |order: usize| -> anyhow::Result<f64> {
        let rule = GaussLegendre::new(order)?;
        let edge = |i: i32| FRAC_PI_2 * libm::ldexp(1.0, -i);
        let halves = (0..PANELS).map(|i| rule.integrate(edge(i + 1), edge(i), integrand));
        Ok(halves.sum::<f64>() + rule.integrate(0.0, edge(PANELS), integrand))
    };
    let (fine, coarse) = (integral(32)?, integral(24)?);
    let value = libm::exp(-mu / PI * fine);
    Ok((value, value * ((fine - coarse).abs() * mu / PI + 1e-12)))
}

/// Reflectance of a half-space under a beam: 1 - H(mu0) sqrt(1 - albedo).
pub fn half_space_reflectance(mu0: f64, albedo: f64) -> anyhow::Result<(f64, f64)> {
    let (h, error) = h_function(mu0, albedo)?;
    let root = (1.0 - albedo).sqrt();
    Ok((1.0 - h * root, error * root + f64::EPSILON))
}

/// Transmittance of a thick slab without absorption under a beam: (4/3) K / (tau + 2 q), K = (sqrt 3/4) H(mu0), q the
/// extrapolation length; what is left out falls as e^-tau (van de Hulst 1980, sec. 5).
pub fn thick_white_transmittance(mu0: f64, tau: f64) -> anyhow::Result<(f64, f64)> {
    let (h, error) = h_function(mu0, 1.0)?;
    let factor = 3f64.sqrt() / 3.0 / (tau + 2.0 * MILNE);
    Ok((factor * h, factor * (error + h * libm::exp(-tau))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid_analytic::{Incidence, IsotropicSlab};

    #[test]
    fn h_of_the_conservative_half_space() {
        let (h, error) = h_function(1.0, 1.0).unwrap();
        assert!((h - 2.907_810_529_078_606).abs() <= error && error < 1e-10, "{h} {error}");
        assert_eq!(h_function(0.0, 0.5).unwrap().0, 1.0);
    }

    /// A slab of thickness 60 is a half-space to e^-62 at albedo 0.9 (decay 0.525 a mean free path, both ways).
    #[test]
    fn thick_slabs_solved_in_depth() {
        let thick = IsotropicSlab::new(60.0, 0.9, Incidence::Beam { mu0: 0.5 }).unwrap().reflectance();
        let (r, error) = half_space_reflectance(0.5, 0.9).unwrap();
        assert!((r - thick.value).abs() <= error + thick.error, "{r} {}", thick.value);
        let white = IsotropicSlab::new(60.0, 1.0, Incidence::Beam { mu0: 1.0 }).unwrap().transmittance();
        let (t, error) = thick_white_transmittance(1.0, 60.0).unwrap();
        assert!((t - white.value).abs() <= error + white.error, "{t} {}", white.value);
    }
}
