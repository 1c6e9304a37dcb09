//! Claim: the mean squared error of a fluence estimate falls with the number of photons as theory predicts before the
//! run: as N^(-4/7) at the best radius, as N^-1 at a fixed one down to the floor of its blur, not at all at a face.
//! Referee: exact kernel means and exact variances of independent points. Shown beside it: the exponents that the same
//! fit finds in the predictions, since those at finite N are not the asymptotic ones.
//!
//! Uncollided photons under a normal beam are independent, and their field is e^-t.

mod cases;
mod conclude;
mod figures;

mod measure;
mod predict;
mod results;

use crate::harness::Experiment;

/// The experiment.
pub const EXPERIMENT: Experiment = Experiment {
    name: "rates",
    title: "How fast do more photons help?",
    question: "With N times the photons and the best radius for them, by how much does the mean squared error fall? And \
               what becomes of it at a fixed radius, or at a face that nothing is done about?",
    groups: measure::groups,
    predict: predict::predict,
    conclude: conclude::conclude,
};
