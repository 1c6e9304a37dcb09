//! Statistics: moments with merge, intervals, hypothesis tests, fits.
//!
//! Everything is deterministic: the same values in the same order give the same bits. Tests of means use Student's
//! t, since the error itself is estimated: with M = 8 maps a normal threshold of 4.9 standard errors is crossed by
//! right code once in 600 times instead of once in a million.

mod bootstrap;
mod distribution;
mod fit;
mod goodness;
mod interval;
mod mean;
mod moments;
mod multiple;
mod residuals;
mod tail;

pub use bootstrap::{Jackknife, bootstrap_interval, jackknife, jackknife_log, positive_interval};
pub use distribution::{
    chi_squared_p, normal_critical, normal_p, poisson_upper_tail, student_critical, student_p,
};
pub use fit::{Amplitude, Line, amplitude_per_map, fit_line};
pub use goodness::{
    ChiSquared, KolmogorovSmirnov, chi_squared_test, kolmogorov_smirnov_test, smallest_detectable_deviation,
    smallest_detectable_distance, smallest_detectable_noncentrality,
};
pub use interval::{Interval, mean_interval, poisson_interval, wilson_interval};
pub use mean::{MeanTest, POWER_QUANTILE, smallest_detectable_bias, t_test, z_test};
pub use moments::Moments;
pub use multiple::holm;
pub use residuals::Residuals;
pub use tail::Tail;

/// False-alarm probability of one statistical assertion: 1000 of them stay below 1e-3 together.
pub const ALPHA: f64 = 1e-6;

/// Variance of variance above which a mean has no trustworthy interval: the value at which the relative error of
/// the estimated variance is about a third (sqrt of 0.1).
pub const HEAVY_TAIL: f64 = 0.1;
