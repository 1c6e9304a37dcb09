//! Elementary functions with the same bits everywhere, frames, rays, warps in pairs, numbers with a range, quadrature.

mod frame;
mod number;
mod periodic;
pub mod quadrature;
mod ray;
pub mod warp;

pub use frame::Frame;
pub use libm::{atan2, cos, exp, expm1 as exp_m1, log as ln, log1p as ln_1p, sin, sincos as sin_cos};
pub use number::{Albedo, Asymmetry, Index, NonNegative, Positive};
pub use periodic::wrap;
pub use ray::{Interval, Ray};

/// Full solid angle \[sr\].
pub const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;

/// The pair (1-mu, 1+mu) of two unit directions, mu the cosine between them, with every digit at both peaks.
pub fn cosine_pair(a: glam::DVec3, b: glam::DVec3) -> (f64, f64) {
    (0.5 * (a - b).length_squared(), 0.5 * (a + b).length_squared())
}

/// The point of this number, from 1 on, of those that fill a unit cube evenly: fractional parts of multiples of three irrational numbers,
/// those of 1/x, 1/x^2 and 1/x^3 with x^4 = x + 1 (Roberts 2018).
pub fn evenly_in_cube(number: u32) -> [f64; 3] {
    const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    STEPS.map(|step| (f64::from(number) * step).fract())
}
