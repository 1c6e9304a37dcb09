//! What the tests share: verdicts on means, scenes, double-double numbers, a quadrature rule.
#![allow(dead_code, reason = "the faults use a part")]

pub mod double;
pub mod quadrature;
pub mod run;
pub mod scenes;
pub mod verdict;

/// A unit vector from its height and azimuth.
pub fn unit_vector(z: f64, azimuth: f64) -> glam::DVec3 {
    let (s, c) = turbid::math::sin_cos(azimuth);
    let r = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    glam::DVec3::new(r * c, r * s, z).normalize()
}
