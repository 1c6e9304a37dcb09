//! Claim: a radius that is chosen from the photons themselves need not cost much: the interval test (differences of nested estimates
//! within five standard deviations, then half the last radius) stays within a known factor of the best radius on every field, plug-in
//! rules are nearly as good as the best where the field is smooth and are caught by their first radius where it is not, and fixed rules
//! are right nowhere for long.
//! Referee: exact kernel means and exact variances of independent photons, and the radius of the least mean squared error, which nobody
//! has who needs an estimate.
//!
//! Six questions, among them a dip that is narrower than the first radius, a face, and the surroundings of a point light.

mod cases;
mod conclude;
mod fields;
mod figures;
mod measure;
mod predict;
mod results;
mod select;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "selection",
    title: "What does it cost to choose the radius from the photons?",
    question: "The best radius of a gather follows from the field, which is what is looked for. How much worse than with it does one \
               do who chooses the radius from the same photons, by a plug-in rule or by an interval test, or who takes a rule of \
               thumb?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
