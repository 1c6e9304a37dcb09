//! Claim: what each boundary treatment and each rejection of false photons makes of an estimate is what theory predicts.
//! Referee: exact means of truncated kernels in slab, sphere and cuboid, at fixed radius and with the k nearest
//! (turbid_analytic::boundary), over the exact fluence.
//!
//! *The furnace*, albedo 1 and isotropic light from all sides, has the fluence 4 at irradiance 1 everywhere, so that
//! all error is geometry. *Lit* slabs, isotropic and with a forward peak, and a *lit sphere* add fields that bend towards
//! the surface, flat or curved. *The sheet*, thin and opaque between two
//! uniform fields of independent photons, makes false photons and nothing else. *Independent photons* in a uniform field
//! show what a treatment costs in variance.

mod cases;
mod claims;
mod conclude;
mod exact;
mod fields;
mod figures;
mod measure;
mod predict;
mod results;
mod section;
mod sheet;
mod spread;
mod tables;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "boundary",
    title: "What can be done at an edge of the fog, and behind a thin wall?",
    question: "Where the fog ends inside the ball that an estimate gathers from, the estimate is too dark; where a thin \
               wall stands in the ball, photons from the other side leak in. Which remedies cure which of the two \
               faults, at what price? In particular: what does looking at the photons' incoming direction cure?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
