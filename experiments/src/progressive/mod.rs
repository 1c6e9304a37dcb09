//! Claim: where radii shrink from map to map as r ~ i^(-(1-a)/c), a = 4/(c + 4), the mean over n maps of bounded memory has a mean squared
//! error that falls as n^(-a), within 9 % of the best fixed radius for all photons together.
//! Referee: exact kernel means and exact variances of independent photons in an exponential field.
//!
//! The setup, who asks and what is read are those of the experiment `dimension`.

mod cases;
mod conclude;
mod figures;
mod measure;
mod predict;
mod results;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "progressive",
    title: "What does it cost to shrink radii from map to map?",
    question: "A picture can be the mean over as many photon maps as time allows, each read within a smaller radius than the last, so that it \
               converges in the memory of one map. How fast does it converge, what does it lose to the best fixed radius, and does the \
               spread between maps tell its error?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
