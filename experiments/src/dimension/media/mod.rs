//! Error against time in four media: thin, thick, peaked and bounded.
//!
//! Light scattered twice and more, which is all that planes bring, along rays that are alike: points in balls, points along rays, beams,
//! planes, and a debiased sum over beams. Planes and debiased sums have no variance, so that medians and quantiles of the error are told
//! of everything, from the errors of all rays of all maps.

mod cases;
mod conclude;
mod crossing;
mod exact;
mod figures;
mod measure;
mod predict;
mod results;
mod sentences;

pub use conclude::conclude;
pub use measure::groups;
pub use predict::predict;
