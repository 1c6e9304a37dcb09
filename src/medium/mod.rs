//! Media: one file each. A medium says its coefficients and its phase function; it never tracks.

mod homogeneous;

pub use homogeneous::Homogeneous;

/// The media at hand.
pub type Medium = Homogeneous;
