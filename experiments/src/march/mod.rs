//! Claim: radiance marched through a photon map is wrong by what theory predicts before the run, step by step.
//! Referee: the exact radiance that leaves the lit face of a slab, and the exact mean of each step's estimate.
//! Shown beside it: the formula of 1998, which does not attenuate a step within itself.
//!
//! The error has a part that no photon map is needed for, the sum over steps in place of an integral, and the parts
//! that each step's estimate of the in-scattered light has where the step stands: edge, blur and clusters.

mod cases;
mod conclude;
mod figures;
mod measure;
mod predict;
mod results;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "march",
    title: "What does a march in steps cost?",
    question: "To see fog, a photon map is asked along each ray, in steps. By how much do steps of finite length make \
               the radiance wrong, with the formula of 1998 and with better weights, and do the errors of step and \
               map add up as predicted?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
