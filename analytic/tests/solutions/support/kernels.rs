//! Kernels of finite radius, and agreement within bounds.

use turbid_analytic::{Kernel, Value};

/// Volume of the unit ball.
pub const BALL: f64 = 4.0 / 3.0 * std::f64::consts::PI;

/// Every kernel that ends.
pub const KERNELS: [Kernel; 5] = [
    Kernel::Uniform,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone { kappa: 1.0 },
    Kernel::TruncatedGaussian,
];

/// Two values agree within their bounds.
pub fn agree(a: Value, b: Value) -> bool {
    (a.value - b.value).abs() <= a.error + b.error
}
