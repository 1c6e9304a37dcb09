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

/// The octahedron |x| + |y| + |z| = 1 unfolded onto the square [-1, 1]^2: the upper half in the middle, the faces of the lower one at
/// the corners.
///
/// # Returns    where a direction is; one that is not of unit length counts as the one along it
/// # Source     Praun and Hoppe 2003, "Spherical parametrization and remeshing"
pub fn octahedral(dir: DVec3) -> DVec2 {
    let p = dir / (dir.x.abs() + dir.y.abs() + dir.z.abs());
    let folded = DVec2::new(p.x, p.y);
    if p.z >= 0.0 { folded } else { unfolded(folded) }
}

/// The unit direction at a place of the square: the inverse of [`octahedral`].
pub fn from_octahedral(place: DVec2) -> DVec3 {
    let z = 1.0 - place.x.abs() - place.y.abs();
    let folded = if z >= 0.0 { place } else { unfolded(place) };
    folded.extend(z).normalize()
}

/// Area of the square over solid angle, about a unit direction [1/sr]: |p|^3 at the place p of the octahedron.
///
/// A face lies at 1/sqrt(3) from the middle, so that dA cos/|p|^2 = dA/(sqrt(3) |p|^3), and its area is sqrt(3) times that of its
/// shadow, which is the square's.
pub fn octahedral_density(dir: DVec3) -> f64 {
    let p = 1.0 / (dir.x.abs() + dir.y.abs() + dir.z.abs());
    p * p * p
}

/// The reflection of a place about the edge of the inner square that is next to it.
fn unfolded(place: DVec2) -> DVec2 {
    (DVec2::ONE - DVec2::new(place.y.abs(), place.x.abs())) * DVec2::new(sign(place.x), sign(place.y))
}

/// 1 or -1; 1 at both zeros.
fn sign(x: f64) -> f64 {
    if x >= 0.0 { 1.0 } else { -1.0 }
}
