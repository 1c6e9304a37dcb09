//! What both ways of solving a half-space find.

use crate::value::Value;

pub(super) const METHOD: &str = "asymptotics of thick slabs, faster decays bounded";

/// What one incidence does to a half-space.
#[derive(Clone, Copy)]
pub(super) struct Entrance {
    /// K: a quarter of the fluence that decays slowest, at the face.
    pub escape: Value,
    /// R_inf.
    pub reflected: Value,
    /// 1 - R_inf.
    pub absorbed: Value,
}
