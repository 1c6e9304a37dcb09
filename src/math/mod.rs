//! Elementary functions with the same bits everywhere, frames, rays, warps in pairs, numbers with a range, quadrature.

mod frame;
mod number;
pub mod quadrature;
mod ray;
pub mod warp;

pub use frame::Frame;
pub use libm::{atan2, cos, exp, expm1 as exp_m1, log as ln, log1p as ln_1p, sin, sincos as sin_cos};
pub use number::{Albedo, Asymmetry, Index, NonNegative, Positive};
pub use ray::{Interval, Ray};

/// Full solid angle \[sr\].
pub const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;

/// The pair (1-mu, 1+mu) of two unit directions, mu the cosine between them, with every digit at both peaks.
pub fn cosine_pair(a: glam::DVec3, b: glam::DVec3) -> (f64, f64) {
    (0.5 * (a - b).length_squared(), 0.5 * (a + b).length_squared())
}
