//! Bodies that rays meet.

use crate::geometry::Hit;

/// A body that a ray can meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// The object of this index.
    Object(usize),
    /// The light of this index.
    Light(usize),
}

/// Where a ray starts, if it starts on a body: what it must not meet again at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Start {
    /// Which body.
    pub target: Target,
    /// Which part of its shape; 0 of a shape without parts.
    pub primitive: u32,
}

impl Start {
    /// The part that a ray starts on, if it starts on this body.
    pub(super) fn on(start: Option<Start>, target: Target) -> Option<u32> {
        start.filter(|s| s.target == target).map(|s| s.primitive)
    }
}

/// The nearest body on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneHit {
    /// Which body.
    pub target: Target,
    /// Where, and its normal.
    pub hit: Hit,
}

impl SceneHit {
    /// Rays from here start on this body.
    pub fn start(&self) -> Start {
        Start { target: self.target, primitive: self.hit.primitive }
    }
}
