//! Warps of uniform numbers, in pairs: the map and its density.

use super::{FOUR_PI, sin_cos};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// The unit vector with the pair (1-mu, 1+mu) of its cosine to the z axis and azimuth `2 pi u`.
pub fn direction((one_minus_mu, one_plus_mu): (f64, f64), u: f64) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u);
    let sin_theta = (one_minus_mu * one_plus_mu).sqrt();
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, 0.5 * (one_plus_mu - one_minus_mu))
}

/// A uniform direction on the sphere, from two numbers in [0, 1).
pub fn square_to_sphere([u, v]: [f64; 2]) -> DVec3 {
    direction((2.0 * u, 2.0 * (1.0 - u)), v)
}

/// Density of [`square_to_sphere`] [1/sr].
pub fn pdf_sphere() -> f64 {
    1.0 / FOUR_PI
}

/// A direction on the hemisphere about z with density proportional to its cosine.
///
/// mu = sqrt(1-u), so the pair is (u/(1+mu), 1+mu): no digit is lost at the pole.
pub fn square_to_cosine_hemisphere([u, v]: [f64; 2]) -> DVec3 {
    let mu = (1.0 - u).sqrt();
    direction((u / (1.0 + mu), 1.0 + mu), v)
}

/// Density of [`square_to_cosine_hemisphere`] [1/sr].
pub fn pdf_cosine_hemisphere(mu: f64) -> f64 {
    mu.max(0.0) / PI
}

/// A uniform point on the unit disc.
pub fn square_to_disc([u, v]: [f64; 2]) -> DVec2 {
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * v);
    DVec2::new(cos_phi, sin_phi) * u.sqrt()
}

/// Density of [`square_to_disc`] [1/L^2] for the unit disc.
pub fn pdf_disc() -> f64 {
    1.0 / PI
}

/// A uniform direction within the cone about z whose cosine to z is 1 - `one_minus_mu_max` or more.
pub fn square_to_cone([u, v]: [f64; 2], one_minus_mu_max: f64) -> DVec3 {
    let one_minus_mu = u * one_minus_mu_max;
    direction((one_minus_mu, 2.0 - one_minus_mu), v)
}

/// Density of [`square_to_cone`] [1/sr].
pub fn pdf_cone(one_minus_mu_max: f64) -> f64 {
    1.0 / (2.0 * PI * one_minus_mu_max)
}
