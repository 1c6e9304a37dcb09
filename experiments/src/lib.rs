//! The laboratory: plays the simulator against exact values and writes the report.
//!
//! Each experiment is a module with a constant `EXPERIMENT`, listed in [`ALL`]; [`harness`] runs them, [`theory`] has
//! what their predictions share, and [`report`] writes what they found.

pub mod bias;
pub mod blur;
pub mod harness;
pub mod report;
pub mod theory;

use harness::Experiment;

/// All experiments, in the order of the report.
pub const ALL: &[Experiment] = &[bias::EXPERIMENT, blur::EXPERIMENT];
