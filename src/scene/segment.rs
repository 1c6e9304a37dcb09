//! Stretches of medium on a ray.

use crate::math::Interval;

/// A stretch of one medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where it is on the ray \[L\].
    pub interval: Interval,
    /// Number of the medium.
    pub medium: usize,
}
