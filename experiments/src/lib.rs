//! The laboratory: plays the simulator against exact values and writes the report.
//!
//! Each experiment is a module with a constant `EXPERIMENT`, listed in [`ALL`]; [`harness`] runs them, [`theory`] has
//! what their predictions share, and [`report`] writes what they found.

pub mod answer;
pub mod benchmarks;
pub mod bias;
pub mod blur;
pub mod boundary;
pub mod budget;
pub mod claims_1998;
pub mod cost_model;
pub mod coverage;
pub mod debiasing;
pub mod dimension;
pub mod extremes;
pub mod fuzz;
pub mod gallery;
pub mod harness;
pub mod march;
pub mod own_study;
pub mod prediction;
pub mod progressive;
pub mod rates;
pub mod report;
pub mod selection;
pub mod setups;
pub mod sweep;
pub mod theory;
pub mod tradeoff;
pub mod transmittance;

use harness::{Closing, Experiment};

/// All experiments, in the order of the report.
pub const ALL: &[Experiment] = &[
    bias::EXPERIMENT,
    blur::EXPERIMENT,
    boundary::EXPERIMENT,
    march::EXPERIMENT,
    transmittance::EXPERIMENT,
    rates::EXPERIMENT,
    dimension::EXPERIMENT,
    progressive::EXPERIMENT,
    debiasing::EXPERIMENT,
    selection::EXPERIMENT,
    tradeoff::EXPERIMENT,
    extremes::EXPERIMENT,
    coverage::EXPERIMENT,
    claims_1998::EXPERIMENT,
];

/// What is made of all of them together: what opens the report, in this order.
pub const CLOSINGS: &[Closing] = &[answer::CLOSING, budget::CLOSING];
